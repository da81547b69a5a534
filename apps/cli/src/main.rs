//! The command `kajo`: thin. It iterates over the registries and knows no technique by name.

mod arguments;
mod commands;
mod coverage;
mod failure;
mod output;
mod path_tracing;
mod progress;
mod view;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = arguments::Kajo::parse();
    output::start_log(arguments.common.quiet);
    progress::watch_for_interrupt();
    match commands::run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
