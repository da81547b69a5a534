//! Running the command as a user does.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The built command, in `folder`, without a terminal.
pub fn kajo(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_kajo"));
    command.current_dir(folder);
    command
}

/// Runs `kajo` with `words`.
pub fn run(folder: &Path, words: &[&str]) -> Output {
    kajo(folder).args(words).output().expect("kajo starts")
}

/// Runs and expects exit code 0; standard output.
#[allow(dead_code, reason = "not every test file needs every helper")]
pub fn succeed(folder: &Path, words: &[&str]) -> String {
    let output = run(folder, words);
    assert!(output.status.success(), "kajo {}\n{}", words.join(" "), String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// Runs with `--json` and parses what it prints.
#[allow(dead_code, reason = "not every test file needs every helper")]
pub fn json(folder: &Path, words: &[&str]) -> serde_json::Value {
    serde_json::from_str(&succeed(folder, &[words, &["--json"]].concat())).expect("JSON")
}

/// A scene of the test assets, which are `$KAJO_ASSETS` or a folder beside the workspace; says so when it is not there.
#[allow(dead_code, reason = "not every test file needs every helper")]
pub fn asset(name: &str) -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let assets = std::env::var_os("KAJO_ASSETS").map_or_else(|| root.join("../shared/assets"), PathBuf::from);
    let path = assets.join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: there is no {}; set KAJO_ASSETS", path.display());
    None
}
