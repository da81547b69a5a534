//! Where tests find the real scenes.

use std::path::{Path, PathBuf};

/// The directory of the real test scenes: `$KAJO_ASSETS`, else `../shared/assets` beside the workspace; where neither is there, says that the
/// calling test is skipped.
pub(crate) fn directory() -> Option<PathBuf> {
    let path =
        std::env::var_os("KAJO_ASSETS").map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/assets"), PathBuf::from);
    if path.is_dir() {
        return Some(path);
    }
    eprintln!("skipped: no test scenes at {}; set KAJO_ASSETS", path.display());
    None
}
