//! Structs that are written on both sides: is the Rust one what the shader reads?

use crate::{Linked, ShaderError};

/// Place of a field in a struct, bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldLayout {
    /// Field name.
    pub name: String,
    /// From the start of the struct.
    pub offset: u32,
    /// Without padding behind it; for a runtime-sized array one element.
    pub size: u32,
}

/// A struct of a shader, as it lies in a buffer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StructLayout {
    /// Name in the file that declares it.
    pub name: String,
    /// Module that declares it, e.g. `shader_lib::frame`; `None` for the root file.
    pub module: Option<String>,
    /// Bytes, padding at the end included.
    pub size: u32,
    /// In order of declaration.
    pub fields: Vec<FieldLayout>,
}

/// A struct of Rust that is copied into a buffer. Fields whose names start with `_` are padding and have no partner in WGSL.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RustLayout {
    /// Name of the type.
    pub name: &'static str,
    /// Bytes.
    pub size: u32,
    /// Name, offset and size in bytes, in order of declaration.
    pub fields: Vec<(&'static str, u32, u32)>,
}

/// Gives the layout of a `#[repr(C)]` struct with named fields; derive it.
pub trait ShaderLayout {
    /// Names, offsets and sizes.
    fn layout() -> RustLayout;
}

impl Linked {
    /// Compares `T` with the WGSL struct `name`: the same fields in the same order at the same offsets with the same sizes, and the
    /// same size as a whole.
    ///
    /// # Errors
    /// [`ShaderError::Layout`] with every difference, [`ShaderError::Missing`] when no buffer holds a struct of that name.
    pub fn check_layout<T: ShaderLayout>(&self, name: &str) -> Result<(), ShaderError> {
        let differences = differences(&T::layout(), self.structure(name)?);
        if differences.is_empty() {
            Ok(())
        } else {
            Err(ShaderError::Layout { file: self.file(), name: name.to_owned(), differences: differences.join("\n") })
        }
    }
}

fn differences(rust: &RustLayout, wgsl: &StructLayout) -> Vec<String> {
    let ours: Vec<_> = rust.fields.iter().filter(|(name, ..)| !name.starts_with('_')).collect();
    let theirs: Vec<_> = wgsl.fields.iter().filter(|field| !field.name.starts_with('_')).collect();
    let mut out = Vec::new();
    for (&&(name, offset, size), field) in ours.iter().zip(&theirs) {
        if (name, offset, size) != (field.name.as_str(), field.offset, field.size) {
            let (theirs, at, bytes) = (&field.name, field.offset, field.size);
            out.push(format!("  Rust has `{name}` at byte {offset} ({size} bytes), WGSL has `{theirs}` at byte {at} ({bytes} bytes)"));
        }
    }
    out.extend(ours.iter().skip(theirs.len()).map(|(name, ..)| format!("  only Rust has `{name}`")));
    out.extend(theirs.iter().skip(ours.len()).map(|field| format!("  only WGSL has `{}`", field.name)));
    if rust.size != wgsl.size {
        out.push(format!("  Rust has {} bytes, WGSL has {} bytes", rust.size, wgsl.size));
    }
    out
}
