//! One file a command.

mod coverage;
mod devices;
mod metrics;
mod scenes;

use crate::arguments::{Command, Kajo};
use crate::failure::Outcome;

/// Carries out the command.
pub fn run(arguments: &Kajo) -> Outcome {
    let common = &arguments.common;
    match &arguments.command {
        Command::Coverage { status } => coverage::run(common, status.as_deref()),
        Command::Devices { plain } => devices::run(common, *plain),
        Command::Metrics(arguments) => metrics::run(common, arguments),
        Command::Scenes => scenes::run(common),
        _ => unreachable!(),
    }
}
