//! A report appears whole or not at all.
//!
//! Files are made in a hidden folder beside their place; only when all are there are they moved, the page last. Moving within a disk
//! cannot run out of space. Files of an older report that the new one lacks are removed; anything else in the folder is left alone.

use crate::LabError;
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};
use tempfile::TempDir;

/// The file that lists what belongs to a report.
pub const MANIFEST: &str = "report.json";
/// The page, moved last: who opens it finds everything it names.
pub const PAGE: &str = "index.html";

/// A report in the making. Dropping it removes everything made so far.
#[derive(Debug)]
pub struct Staging {
    files: BTreeSet<String>,
    // Dropped in this order: what is in the target goes before the target.
    folder: TempDir,
    target: Target,
}

/// The report's folder; one that was made and is still empty goes away again.
#[derive(Debug)]
struct Target {
    path: PathBuf,
    made: bool,
}

impl Drop for Target {
    fn drop(&mut self) {
        if self.made {
            // Fails where the folder holds a report, as it should.
            let _ = fs::remove_dir(&self.path);
        }
    }
}

impl Staging {
    /// Prepares to write a report to `target`, which is made if it is missing.
    ///
    /// # Errors
    /// When the folder cannot be made or written to: better now than after an hour of rendering.
    pub fn new(target: &Path) -> Result<Self, LabError> {
        if target.exists() && !target.is_dir() {
            return Err(LabError::NotAFolder { folder: target.to_path_buf() });
        }
        let failed = |reason| LabError::Folder { folder: target.to_path_buf(), reason };
        let made = !target.exists();
        fs::create_dir_all(target).map_err(failed)?;
        let folder = tempfile::Builder::new().prefix(".kajo-report-").tempdir_in(target).map_err(failed)?;
        Ok(Self { files: BTreeSet::new(), folder, target: Target { path: target.to_path_buf(), made } })
    }

    /// Where to write the file that will be `name` (relative, `/` between folders); its folder exists then.
    ///
    /// # Errors
    /// When its folder cannot be made.
    pub fn place(&mut self, name: &str) -> Result<PathBuf, LabError> {
        debug_assert!(is_inside(name), "{name}");
        let path = self.folder.path().join(name);
        let folder = path.parent().expect("a file in the staging folder");
        fs::create_dir_all(folder).map_err(|reason| self.failed(reason))?;
        self.files.insert(name.to_owned());
        Ok(path)
    }

    /// Writes a small file.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), LabError> {
        let path = self.place(name)?;
        fs::write(path, bytes).map_err(|reason| self.failed(reason))
    }

    /// Names of all files so far, sorted.
    pub fn files(&self) -> Vec<String> {
        self.files.iter().cloned().collect()
    }

    /// Moves everything to its place.
    ///
    /// # Errors
    /// When a file cannot be moved, for instance onto a folder of its name.
    pub fn publish(self) -> Result<(), LabError> {
        let old = files_of_report(&self.target.path.join(MANIFEST));
        let order = self.files.iter().filter(|f| *f != PAGE).chain(self.files.iter().filter(|f| *f == PAGE));
        for name in order {
            let to = self.target.path.join(name);
            let folder = to.parent().expect("a file in the report's folder");
            fs::create_dir_all(folder).and_then(|()| fs::rename(self.folder.path().join(name), &to)).map_err(|r| self.failed(r))?;
        }
        for stale in old.difference(&self.files) {
            remove_with_empty_folders(&self.target.path, stale);
        }
        Ok(())
    }

    fn failed(&self, reason: io::Error) -> LabError {
        LabError::Folder { folder: self.target.path.clone(), reason }
    }
}

/// What an older report lists as its own; nothing when it is missing or is not ours. Names that leave the folder are not believed.
fn files_of_report(manifest: &Path) -> BTreeSet<String> {
    let parsed = fs::read(manifest).ok().and_then(|bytes| serde_json::from_slice::<serde_json::Value>(&bytes).ok());
    let names = parsed.as_ref().filter(|json| json["kajo"].is_string()).and_then(|json| json["files"].as_array());
    names.into_iter().flatten().filter_map(|name| name.as_str()).filter(|name| is_inside(name)).map(str::to_owned).collect()
}

fn is_inside(name: &str) -> bool {
    !name.is_empty() && Path::new(name).components().all(|part| matches!(part, Component::Normal(_)))
}

/// A stale file that cannot be removed does no harm, so failures are left.
fn remove_with_empty_folders(target: &Path, name: &str) {
    let path = target.join(name);
    if fs::remove_file(&path).is_err() {
        return;
    }
    for folder in path.ancestors().skip(1).take_while(|folder| *folder != target) {
        if fs::remove_dir(folder).is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(target: &Path, files: &[&str]) {
        let mut staging = Staging::new(target).unwrap();
        for name in files {
            staging.write(name, name.as_bytes()).unwrap();
        }
        let mut listed = staging.files();
        listed.push(MANIFEST.into());
        staging.write(MANIFEST, serde_json::json!({"kajo": "0", "files": listed}).to_string().as_bytes()).unwrap();
        staging.publish().unwrap();
    }

    fn list(target: &Path) -> Vec<String> {
        let mut found = Vec::new();
        let mut folders = vec![target.to_path_buf()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
                if entry.is_dir() {
                    folders.push(entry);
                } else {
                    found.push(entry.strip_prefix(target).unwrap().to_str().unwrap().replace('\\', "/"));
                }
            }
        }
        found.sort();
        found
    }

    #[test]
    fn a_new_report_replaces_the_old_one_and_nothing_else() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("a/b");
        report(&target, &[PAGE, "images/x/old.png", "images/both.png"]);
        fs::write(target.join("notes.txt"), "mine").unwrap();
        fs::write(target.join("images/mine.png"), "mine").unwrap();
        report(&target, &[PAGE, "images/both.png", "images/y/new.png"]);
        assert_eq!(list(&target), ["images/both.png", "images/mine.png", "images/y/new.png", PAGE, "notes.txt", MANIFEST]);
        assert!(!target.join("images/x").exists(), "an empty folder of the old report is gone");
    }

    #[test]
    fn an_unfinished_report_leaves_the_old_one_untouched() {
        let dir = tempfile::tempdir().unwrap();
        report(dir.path(), &[PAGE]);
        let mut staging = Staging::new(dir.path()).unwrap();
        staging.write(PAGE, b"half").unwrap();
        drop(staging);
        assert_eq!(fs::read_to_string(dir.path().join(PAGE)).unwrap(), PAGE);
        assert_eq!(list(dir.path()), [PAGE, MANIFEST]);
    }

    /// A manifest made by someone else must not delete files outside the folder.
    #[test]
    fn names_that_leave_the_folder_are_not_believed() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("report");
        fs::create_dir(&target).unwrap();
        fs::write(dir.path().join("precious"), "x").unwrap();
        fs::write(target.join(MANIFEST), r#"{"kajo": "0", "files": ["../precious", "/etc/hostname"]}"#).unwrap();
        report(&target, &[PAGE]);
        assert!(dir.path().join("precious").exists());
    }

    #[test]
    fn a_file_in_the_way_is_named() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("taken");
        fs::write(&path, "x").unwrap();
        assert!(Staging::new(&path).unwrap_err().to_string().contains("it is a file"));
    }
}
