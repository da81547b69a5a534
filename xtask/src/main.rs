//! Developer commands: `cargo xtask demo | test | setup | new-technique ROLE/NAME`. Depends on nothing, so that it builds in a second.

mod demo;
mod new_technique;
mod setup;
mod shell;

use std::process::ExitCode;

const USAGE: &str = "usage: cargo xtask <command>

  demo                  set up, build, compare the shadow techniques on two scenes, print the report's path
  test                  set up, then run every test
  setup                 find a GPU adapter; where none answers, install Mesa's software Vulkan driver
  new-technique ID      make the folder of a technique, e.g. shadow/pcss, and print the two lines that register it
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match words.as_slice() {
        ["demo"] => demo::run(),
        ["test", rest @ ..] => setup::run().and_then(|()| {
            setup::display();
            test(rest)
        }),
        ["setup"] => setup::run(),
        ["new-technique", id] => new_technique::run(id),
        ["--help" | "-h" | "help"] | [] => {
            print!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        _ => {
            eprint!("unknown command `{}`\n\n{USAGE}", words.join(" "));
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Tells Mesa's software driver to compile shaders quickly rather than well: tests compile many and draw little. Other drivers do not know it.
const QUICK_SHADERS: (&str, &str) = ("GALLIVM_PERF", "nopt");

/// All tests, with nextest where it is installed. Further arguments go to the runner.
fn test(rest: &[&str]) -> Result<(), String> {
    let runner: &[&str] = if shell::succeeds("cargo", &["nextest", "--version"]) { &["nextest", "run"] } else { &["test"] };
    let arguments = [runner, &["--release", "--workspace"], rest].concat();
    shell::run_with(&[QUICK_SHADERS], "cargo", &arguments)
}
