//! Atomic writes: a reader sees the old file or the whole new one, never a part.

use crate::ImageError;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Writes `bytes` to `path`: into a temporary file of the same directory, to the disk, then renamed over `path`.
///
/// A symbolic link keeps pointing where it pointed; a device or a pipe (`/dev/null`) is written to, never replaced.
///
/// # Errors
/// A missing directory, missing permission, a full disk; nothing is left behind then, and an older file is untouched.
pub fn write_atomic(path: &Path, bytes: &[u8]) -> Result<(), ImageError> {
    let failed = |reason| ImageError::from_write(path, bytes.len(), reason);
    let target = match fs::metadata(path) {
        Ok(found) if found.is_dir() => return Err(failed(io::Error::other("it is a directory"))),
        Ok(found) if !found.is_file() => return fs::write(path, bytes).map_err(failed),
        Ok(_) => fs::canonicalize(path).map_err(failed)?,
        Err(_) => path.to_path_buf(),
    };
    let directory = directory_of(&target);
    if !directory.is_dir() {
        return Err(ImageError::NoDirectory { path: path.to_path_buf(), directory });
    }
    let mut file = temporary_in(&directory).map_err(failed)?;
    file.write_all(bytes).and_then(|()| file.as_file().sync_all()).map_err(failed)?;
    file.persist(&target).map_err(|e| failed(e.error))?;
    sync_directory(&directory);
    Ok(())
}

fn directory_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// With the permissions of an ordinary new file: the default of temporary files would hide it from other users.
fn temporary_in(directory: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".kajo-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(directory)
}

/// Makes the rename last through a power cut. Some file systems refuse to sync a directory; the data itself is safe then too.
fn sync_directory(directory: &Path) {
    #[cfg(unix)]
    if let Ok(handle) = fs::File::open(directory) {
        let _ = handle.sync_all();
    }
    #[cfg(not(unix))]
    let _ = directory;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_a_file_and_leaves_nothing_else() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.bin");
        write_atomic(&path, b"old").unwrap();
        write_atomic(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn missing_directory_is_named() {
        let error = write_atomic(Path::new("/no-such-directory/a.png"), b"x").unwrap_err();
        assert!(matches!(error, ImageError::NoDirectory { .. }));
        assert!(error.to_string().contains("/no-such-directory does not exist"), "{error}");
    }

    #[test]
    fn a_directory_is_not_overwritten() {
        let dir = tempfile::tempdir().unwrap();
        assert!(write_atomic(dir.path(), b"x").unwrap_err().to_string().contains("it is a directory"));
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_written_to_and_links_are_followed() {
        write_atomic(Path::new("/dev/null"), b"x").unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
        let dir = tempfile::tempdir().unwrap();
        let (target, link) = (dir.path().join("target"), dir.path().join("link"));
        fs::write(&target, b"old").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        write_atomic(&link, b"new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&target).unwrap(), b"new");
    }

    #[cfg(unix)]
    #[test]
    fn a_full_disk_is_said_so() {
        let error = write_atomic(Path::new("/dev/full"), b"x");
        if Path::new("/dev/full").exists() {
            assert!(matches!(error, Err(ImageError::DiskFull { bytes: 1, .. })), "{error:?}");
        }
    }
}
