//! Buffers, buffer views and the files beside a glTF file.

use super::json::{BufferView, Document, MeshoptView};
use super::meshopt::{self, Filter, Mode};
use super::uri::{self, Target};
use crate::SceneError;
use crate::limits::Budget;
use std::borrow::Cow;
use std::cell::OnceCell;
use std::io;
use std::path::PathBuf;

/// Hands out the files that a glTF file refers to.
pub trait ResourceReader {
    /// The bytes of a file.
    ///
    /// # Errors
    /// When there is no such file, or it cannot be read.
    fn read(&self, relative_path: &str) -> io::Result<Vec<u8>>;
}

/// The folder that a glTF file lies in.
pub struct Folder(pub PathBuf);

impl ResourceReader for Folder {
    fn read(&self, relative_path: &str) -> io::Result<Vec<u8>> {
        kajo_image::read_file(&self.0.join(relative_path))
    }
}

/// Nothing beside the file: for files that must be self-contained.
pub struct NoResources;

impl ResourceReader for NoResources {
    fn read(&self, _: &str) -> io::Result<Vec<u8>> {
        Err(io::Error::new(io::ErrorKind::NotFound, "the file must be self-contained here"))
    }
}

/// A document and its binary data, loaded when first asked for.
pub struct Resources<'a> {
    /// The file, for messages.
    pub file: &'a str,
    pub document: &'a Document,
    pub budget: &'a Budget,
    binary_chunk: Option<&'a [u8]>,
    reader: &'a dyn ResourceReader,
    buffers: Vec<OnceCell<Cow<'a, [u8]>>>,
    decoded_views: Vec<OnceCell<Vec<u8>>>,
}

impl<'a> Resources<'a> {
    pub fn new(
        file: &'a str,
        document: &'a Document,
        binary_chunk: Option<&'a [u8]>,
        reader: &'a dyn ResourceReader,
        budget: &'a Budget,
    ) -> Self {
        Self {
            file,
            document,
            budget,
            binary_chunk,
            reader,
            buffers: document.buffers.iter().map(|_| OnceCell::new()).collect(),
            decoded_views: document.buffer_views.iter().map(|_| OnceCell::new()).collect(),
        }
    }

    /// An error at a place of this file.
    pub fn invalid(&self, place: impl Into<String>, problem: impl Into<String>) -> SceneError {
        SceneError::invalid(self.file, place, problem)
    }

    /// The object that `index` names in one of the document's lists.
    pub fn get<'t, T>(&self, list: &'t [T], kind: &str, index: usize, place: &str) -> Result<&'t T, SceneError> {
        list.get(index).ok_or_else(|| self.invalid(place, format!("it refers to {kind} {index}, but the file has {}", list.len())))
    }

    /// What a URI stands for: embedded bytes, or a file.
    pub fn fetch(&self, uri: &str, place: &str) -> Result<Vec<u8>, SceneError> {
        match uri::resolve(uri).map_err(|problem| self.invalid(place, problem))? {
            Target::Data(bytes) => Ok(bytes),
            Target::Path(path) => {
                self.reader.read(&path).map_err(|source| SceneError::Read { file: format!("{path}, {place} of {}", self.file), source })
            }
        }
    }

    /// The bytes of a buffer view, decompressed, and the view.
    pub fn view(&self, index: usize, place: &str) -> Result<(&[u8], &BufferView), SceneError> {
        let view = self.get(&self.document.buffer_views, "buffer view", index, place)?;
        let place = format!("buffer view {index}");
        let bytes = match &view.extensions.meshopt {
            None => self.range(view.buffer, view.byte_offset, view.byte_length, &place)?,
            Some(compressed) => get_or_try_init(&self.decoded_views[index], || self.decompress(compressed, view, &place))?,
        };
        Ok((bytes, view))
    }

    fn decompress(&self, compressed: &MeshoptView, view: &BufferView, place: &str) -> Result<Vec<u8>, SceneError> {
        let mode = match compressed.mode.as_str() {
            "ATTRIBUTES" => Mode::Attributes,
            "TRIANGLES" => Mode::Triangles,
            "INDICES" => Mode::Indices,
            other => return Err(self.invalid(place, format!("EXT_meshopt_compression has no mode `{other}`"))),
        };
        let filter = match compressed.filter.as_deref() {
            None | Some("NONE") => Filter::None,
            Some("OCTAHEDRAL") => Filter::Octahedral,
            Some("QUATERNION") => Filter::Quaternion,
            Some("EXPONENTIAL") => Filter::Exponential,
            Some(other) => return Err(self.invalid(place, format!("EXT_meshopt_compression has no filter `{other}`"))),
        };
        if compressed.count.checked_mul(compressed.byte_stride) != Some(view.byte_length) {
            let (count, stride, length) = (compressed.count, compressed.byte_stride, view.byte_length);
            return Err(self.invalid(place, format!("{count} compressed elements of {stride} bytes do not fill its {length} bytes")));
        }
        let stream = self.range(compressed.buffer, compressed.byte_offset, compressed.byte_length, place)?;
        self.budget.claim(self.file, place, compressed.count, compressed.byte_stride)?;
        meshopt::decode(mode, filter, compressed.count as usize, compressed.byte_stride as usize, stream)
            .map_err(|problem| self.invalid(place, format!("EXT_meshopt_compression: {problem}")))
    }

    /// A range of a buffer, checked.
    fn range(&self, buffer: usize, offset: u64, length: u64, place: &str) -> Result<&[u8], SceneError> {
        let bytes = self.buffer(buffer, place)?;
        let end = offset.checked_add(length).filter(|&end| end <= bytes.len() as u64);
        match end {
            Some(end) => Ok(&bytes[offset as usize..end as usize]),
            None => Err(self
                .invalid(place, format!("it spans {length} bytes from byte {offset} of buffer {buffer}, which has {} bytes", bytes.len()))),
        }
    }

    fn buffer(&self, index: usize, place: &str) -> Result<&[u8], SceneError> {
        let buffer = self.get(&self.document.buffers, "buffer", index, place)?;
        let place = format!("buffer {index}");
        let bytes = get_or_try_init(&self.buffers[index], || {
            if let Some(uri) = &buffer.uri {
                return self.fetch(uri, &place).map(Cow::Owned);
            }
            match self.binary_chunk {
                Some(chunk) if index == 0 => Ok(Cow::Borrowed(chunk)),
                _ if buffer.extensions.meshopt.as_ref().is_some_and(|meshopt| meshopt.fallback) => {
                    Err(self.invalid(&place, "it is a placeholder without data, but an uncompressed buffer view reads it"))
                }
                _ => Err(self.invalid(&place, "it has neither a URI nor a binary chunk")),
            }
        })?;
        if (bytes.len() as u64) < buffer.byte_length {
            let problem = format!("truncated: byteLength says {}, but there are {} bytes", buffer.byte_length, bytes.len());
            return Err(self.invalid(place, problem));
        }
        Ok(&bytes[..buffer.byte_length as usize])
    }
}

/// `OnceCell::get_or_try_init`, which the standard library does not offer yet.
fn get_or_try_init<T>(cell: &OnceCell<T>, make: impl FnOnce() -> Result<T, SceneError>) -> Result<&T, SceneError> {
    match cell.get() {
        Some(value) => Ok(value),
        None => {
            let value = make()?;
            Ok(cell.get_or_init(|| value))
        }
    }
}

/// `kind 3 "name"`, for messages.
pub fn label(kind: &str, index: usize, name: &str) -> String {
    if name.is_empty() { format!("{kind} {index}") } else { format!("{kind} {index} {:?}", uri::short(name)) }
}
