//! `kajo view`: a scene under the techniques of the registry, beside the path-traced reference, live.
//!
//! [`run`] opens the window. What it shows is a model (`model`) that panels (`panels`) and picture (`viewport`) read and change; three threads
//! load scenes, render frames and path trace the reference (`worker`, `frames`, `reference`), a fourth measures the error (`errors`). None of them
//! knows the window, so all of it also runs without one.

mod app;
mod camera;
mod canvas;
mod command;
mod error;
mod errors;
mod frames;
#[cfg(test)]
mod hand_tests;
mod headless;
mod layout;
mod metering;
mod model;
mod options;
mod paint;
mod panels;
mod reference;
mod save;
mod script;
mod selection;
mod show;
mod stage;
#[cfg(test)]
mod tests;
mod textures;
mod usage;
mod viewport;
mod window;
mod worker;

pub use error::Error;
pub use options::Options;
pub use reference::TracedBy;

/// Shows a scene until the window is closed, or until the script ends.
///
/// # Errors
/// When no window can be opened, and when a script fails; everything else is said in the window.
pub fn run(options: &Options) -> Result<(), Error> {
    let mut app = app::App::new();
    app.model.spp = options.spp;
    app.model.traced_by = options.traced_by;
    if let Some(reference) = &options.scene {
        app.open(stage::Source { reference: reference.clone(), environment: options.environment.clone() });
    }
    let mut script = options.steps()?.map(|(file, steps)| script::Runner::new(&file, steps));
    match &mut script {
        Some(script) if options.offscreen => headless::run(&mut app, script, options.size),
        _ => window::run(options, app, script),
    }
}
