//! `kajo view`: the interactive viewer.

use crate::arguments::ViewCommand;
use crate::failure::Outcome;
use kajo_viewer::Options;

/// Opens the window and stays until it is closed.
pub fn run(arguments: &ViewCommand) -> Outcome {
    let options = Options {
        scene: arguments.scene.clone(),
        environment: arguments.env.clone(),
        size: arguments.size.0,
        spp: arguments.reference_spp,
        traced_by: arguments.reference,
        script: arguments.script.clone(),
        frames: arguments.frames,
        screenshot: arguments.screenshot.clone(),
        offscreen: arguments.offscreen,
    };
    Ok(kajo_viewer::run(&options)?)
}
