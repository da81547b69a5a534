//! EXT_meshopt_compression: buffer views that hold compressed vertex attributes or indices.    \[EXT_meshopt], appendices A and B
//!
//! Each mode is its own bit stream ([`attributes`], [`indices`]); filters change decoded attributes in place ([`filters`]). Every decoder
//! accepts any bytes: it answers with the elements or with what is wrong, and allocates no more than the stream can describe.

mod attributes;
mod filters;
mod indices;
mod reader;

/// What is wrong with a compressed stream.
pub type Malformed = &'static str;

/// How a stream was compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Vertex attributes and other arrays of structures.
    Attributes,
    /// Triangle lists.
    Triangles,
    /// Other index sequences.
    Indices,
}

/// What is applied to decoded attributes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// Nothing.
    None,
    /// Unit vectors.
    Octahedral,
    /// Unit quaternions.
    Quaternion,
    /// Floats with a shared precision.
    Exponential,
}

/// Decodes `count` elements of `stride` bytes, little endian.
///
/// # Errors
/// When the sizes do not suit the mode or the filter, or the stream is truncated, too long or inconsistent.
pub fn decode(mode: Mode, filter: Filter, count: usize, stride: usize, stream: &[u8]) -> Result<Vec<u8>, Malformed> {
    match mode {
        Mode::Attributes => {
            filters::check(filter, stride)?;
            let mut elements = attributes::decode(count, stride, stream)?;
            filters::apply(filter, stride, &mut elements);
            Ok(elements)
        }
        _ if filter != Filter::None => Err("filters are for the mode ATTRIBUTES only"),
        Mode::Triangles => pack(indices::decode_triangles(count, stream)?, stride),
        Mode::Indices => pack(indices::decode_sequence(count, stream)?, stride),
    }
}

/// Stores indices in 2 or 4 bytes each.
fn pack(indices: Vec<u32>, stride: usize) -> Result<Vec<u8>, Malformed> {
    match stride {
        2 => indices
            .into_iter()
            .map(|index| u16::try_from(index).map(u16::to_le_bytes))
            .collect::<Result<Vec<_>, _>>()
            .map(|bytes| bytes.concat())
            .map_err(|_| "an index does not fit into 2 bytes"),
        4 => Ok(indices.into_iter().flat_map(u32::to_le_bytes).collect()),
        _ => Err("byteStride of indices must be 2 or 4"),
    }
}

#[cfg(test)]
mod tests;
