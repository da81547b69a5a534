//! `demo`: what Kajo is for, in one command.

use crate::{setup, shell};

const REPORT: &str = "report";

/// Compares every shadow technique on a built-in scene and a glTF file, and prints where the report is.
pub fn run() -> Result<(), String> {
    setup::run()?;
    let kajo = shell::workspace_root().join("target/release/kajo").display().to_string();
    let scenes = ["builtin:cornell", "assets/still-life.gltf"];
    let options = ["--role", "direct-visibility", "--all", "--size", "640x360", "--reference-spp", "64", "-o", REPORT];
    shell::run(&kajo, &[&["compare"][..], &scenes, &options].concat())?;
    println!("\nOpen {}", shell::workspace_root().join(REPORT).join("index.html").display());
    Ok(())
}
