//! `new-technique`: the folder of a technique with everything that must be there.

use crate::shell;
use std::fs;

/// Makes `crates/techniques/src/GROUP/NAME/` and prints the two lines that register it.
pub fn run(id: &str) -> Result<(), String> {
    let (group, name) = id
        .split_once('/')
        .filter(|(g, n)| is_id(g) && is_id(n))
        .ok_or(format!("`{id}` is no technique id; expected group/name in lower case with hyphens, e.g. shadow/pcss"))?;
    let module = name.replace('-', "_");
    let techniques = shell::workspace_root().join("crates/techniques/src");
    let group_folder = techniques.join(group.replace('-', "_"));
    if !group_folder.join("mod.rs").exists() {
        return Err(format!("there is no group `{group}`: {} does not exist", group_folder.join("mod.rs").display()));
    }
    let folder = group_folder.join(&module);
    fs::create_dir(&folder).map_err(|error| format!("cannot make {}: {error}", folder.display()))?;
    let fill = |template: &str| template.replace("{id}", id).replace("{module}", &module);
    for (file, template) in [
        ("mod.rs".to_string(), include_str!("template/mod.rs.txt")),
        (format!("{module}.wesl"), include_str!("template/technique.wesl.txt")),
        ("doc.md".to_string(), include_str!("template/doc.md.txt")),
        ("tests.rs".to_string(), include_str!("template/tests.rs.txt")),
    ] {
        let path = folder.join(file);
        fs::write(&path, fill(template)).map_err(|error| format!("cannot write {}: {error}", path.display()))?;
    }
    println!("made {}", folder.display());
    println!("register it in {}:", group_folder.join("mod.rs").display());
    println!("    pub mod {module};                 // with the other modules");
    println!("    &{module}::TECHNIQUE,             // in ALL, where it shall stand in every list");
    Ok(())
}

fn is_id(word: &str) -> bool {
    !word.is_empty() && word.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-')
}
