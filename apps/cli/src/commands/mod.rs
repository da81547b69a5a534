//! One file a command.

mod bench_environment;
mod bench_rays;
mod bench_render;
mod bsdf;
mod compare;
mod coverage;
mod devices;
mod info;
mod metrics;
mod render;
mod scenes;
mod study;
mod techniques;
mod view;

use crate::arguments::{Bench, Command, Kajo};
use crate::failure::Outcome;

/// Carries out the command.
pub fn run(arguments: &Kajo) -> Outcome {
    let common = &arguments.common;
    match &arguments.command {
        Command::Bench(Bench::Environment(arguments)) => bench_environment::run(common, arguments),
        Command::Bench(Bench::Rays(arguments)) => bench_rays::run(common, arguments),
        Command::Bench(Bench::Render(arguments)) => bench_render::run(common, arguments),
        Command::Bsdf(command) => bsdf::run(common, command),
        Command::Compare(arguments) => compare::run(common, arguments),
        Command::Coverage { status } => coverage::run(common, status.as_deref()),
        Command::Devices { plain } => devices::run(common, *plain),
        Command::Info(arguments) => info::run(common, arguments),
        Command::Metrics(arguments) => metrics::run(common, arguments),
        Command::Render(arguments) => render::run(common, arguments),
        Command::Study(arguments) => study::run(common, arguments),
        Command::Scenes => scenes::run(common),
        Command::View(arguments) => view::run(arguments),
        Command::Techniques { id, markdown } => techniques::run(common, id.as_deref(), *markdown),
    }
}
