//! Reading files that may not be what they seem.

use std::io;
use std::path::Path;

/// The bytes of a regular file; folders, pipes and devices are refused, since reading them may never end.
pub fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file"));
    }
    std::fs::read(path)
}
