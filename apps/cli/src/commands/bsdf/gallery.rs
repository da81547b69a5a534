//! `kajo bsdf plot --gallery`: every picture of the models, and the page that shows them.

use crate::arguments::Common;
use crate::arguments::bsdf::Plot;
use crate::failure::Outcome;
use crate::{output, progress};
use indicatif::ProgressBar;
use kajo_gallery::{Folder, Options, Watch, gallery};
use kajo_lab::Staging;
use std::io;
use std::path::PathBuf;

/// Makes the gallery beside its place and moves it there when it is whole.
pub fn run(common: &Common, arguments: &Plot) -> Outcome {
    let options =
        Options { width: arguments.width.unwrap_or(Options::WIDTH), spp: arguments.spp.unwrap_or(Options::SPP), command: String::new() };
    let command = format!("kajo bsdf plot --gallery --width {} --spp {} -o {}", options.width, options.spp, arguments.output.display());
    let options = Options { command, ..options };
    let mut folder = Staged(Staging::new(&arguments.output)?);
    let watched = Watched(progress::bar(common.quiet, "gallery"));
    let result = gallery(&options, &mut folder, &watched);
    watched.0.finish_and_clear();
    let gallery = result?;
    folder.0.publish()?;
    if common.json {
        return output::json(&gallery);
    }
    if common.quiet {
        return Ok(());
    }
    for check in gallery.checks().filter(|check| !check.holds) {
        eprintln!("note: {}: found {}", check.what, check.measured);
    }
    let held = gallery.checks().filter(|check| check.holds).count();
    let page = arguments.output.join("index.html");
    output::text(&format!("{held} of {} measurements hold\n{}\n", gallery.checks().count(), page.display()))
}

struct Staged(Staging);

impl Folder for Staged {
    fn place(&mut self, name: &str) -> io::Result<PathBuf> {
        self.0.place(name).map_err(io::Error::other)
    }
}

struct Watched(ProgressBar);

impl Watch for Watched {
    fn at(&self, what: &str, fraction: f64) {
        self.0.set_position((fraction * 1000.0) as u64);
        if self.0.message() != what {
            self.0.set_message(what.to_owned());
        }
    }

    fn interrupted(&self) -> bool {
        progress::interrupted()
    }
}
