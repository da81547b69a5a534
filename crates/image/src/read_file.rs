//! Reading files that may not be what they seem.

use std::io;
use std::path::Path;

/// The bytes of a regular file; folders, pipes and devices are refused, since reading them may never end.
///
/// # Errors
/// Those of the system, and [`io::ErrorKind::InvalidInput`] for what is no regular file.
pub fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file"));
    }
    std::fs::read(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_and_endless_devices_are_refused() {
        for path in [std::env::temp_dir().as_path(), Path::new("/dev/zero")] {
            if path.exists() {
                assert_eq!(read_file(path).unwrap_err().to_string(), "it is not a regular file", "{}", path.display());
            }
        }
        assert_eq!(read_file(Path::new("/no/such/file")).unwrap_err().kind(), io::ErrorKind::NotFound);
    }
}
