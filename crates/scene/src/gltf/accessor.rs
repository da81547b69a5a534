//! Accessors: typed arrays in buffer views, with sparse replacements.    glTF 2.0, section 3.6.2
//!
//! Every read is checked against the bytes that exist; numbers come out as finite 32-bit floats or as unsigned integers.

use super::json::{Accessor, Sparse};
use super::resources::Resources;
use crate::SceneError;

/// Which elements of an accessor are wanted.
#[derive(Clone, Copy)]
pub enum Selection<'a> {
    /// All of them.
    All,
    /// These, ascending, all within the accessor.
    Only(&'a [u32]),
}

/// The type of one component.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn from_code(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The component in `bytes`; normalised integers as section 3.6.2.2 decodes them.
    fn float(self, b: &[u8], normalized: bool) -> f32 {
        let scaled = |value: f32, max: f32| if normalized { (value / max).max(-1.0) } else { value };
        match self {
            Self::I8 => scaled(f32::from(b[0] as i8), 127.0),
            Self::U8 => scaled(f32::from(b[0]), 255.0),
            Self::I16 => scaled(f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            Self::U16 => scaled(f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            Self::U32 => scaled(u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32, u32::MAX as f32),
            Self::F32 => f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }

    /// The unsigned integer in `bytes`; `None` for types that are not one.
    fn unsigned(self, b: &[u8]) -> Option<u32> {
        match self {
            Self::U8 => Some(u32::from(b[0])),
            Self::U16 => Some(u32::from(u16::from_le_bytes([b[0], b[1]]))),
            Self::U32 => Some(u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            _ => None,
        }
    }
}

/// Elements of `size` bytes at a stride.
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Strided<'a> {
    fn get(&self, index: usize) -> &'a [u8] {
        &self.bytes[index * self.stride..][..self.size]
    }
}

impl Resources<'_> {
    /// Number of elements of an accessor.
    pub fn count(&self, accessor: usize, purpose: &str) -> Result<u64, SceneError> {
        Ok(self.get(&self.document.accessors, "accessor", accessor, purpose)?.count)
    }

    /// The type of an accessor's elements: `SCALAR`, `VEC2`, ….
    pub fn kind(&self, accessor: usize, purpose: &str) -> Result<&str, SceneError> {
        Ok(&self.get(&self.document.accessors, "accessor", accessor, purpose)?.kind)
    }

    /// Elements of `N` finite floats, integers converted. `purpose` says in messages what the accessor is for.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] when the accessor has another shape, reaches beyond its buffer, or holds NaN or infinity.
    pub fn floats<const N: usize>(&self, accessor: usize, purpose: &str, selection: Selection<'_>) -> Result<Vec<[f32; N]>, SceneError> {
        let place = format!("accessor {accessor} ({purpose})");
        let normalized = self.get(&self.document.accessors, "accessor", accessor, purpose)?.normalized;
        let elements = self.read(accessor, &place, selection, [0.0; N], |component, bytes| Ok(component.float(bytes, normalized)))?;
        match elements.iter().position(|element| !element.iter().all(|value| value.is_finite())) {
            None => Ok(elements),
            Some(index) => Err(self.invalid(place, format!("element {index} is {:?}, but numbers must be finite", elements[index]))),
        }
    }

    /// Elements of `N` unsigned integers.
    ///
    /// # Errors
    /// As [`floats`](Self::floats); also when the components are not unsigned integers.
    pub fn integers<const N: usize>(&self, accessor: usize, purpose: &str, selection: Selection<'_>) -> Result<Vec<[u32; N]>, SceneError> {
        let place = format!("accessor {accessor} ({purpose})");
        self.read(accessor, &place, selection, [0; N], |component, bytes| {
            component.unsigned(bytes).ok_or_else(|| self.invalid(&place, "its components are not unsigned integers"))
        })
    }

    fn read<T: Copy, const N: usize>(
        &self,
        index: usize,
        place: &str,
        selection: Selection<'_>,
        zero: [T; N],
        component_value: impl Fn(Component, &[u8]) -> Result<T, SceneError>,
    ) -> Result<Vec<[T; N]>, SceneError> {
        let accessor = self.get(&self.document.accessors, "accessor", index, place)?;
        let component = self.component(accessor.component_type, place)?;
        let want = match N {
            1 => "SCALAR",
            2 => "VEC2",
            3 => "VEC3",
            4 => "VEC4",
            16 => "MAT4",
            _ => unreachable!("no attribute has {N} components"),
        };
        if accessor.kind != want {
            return Err(self.invalid(place, format!("its type is `{}`, but {want} is needed", super::uri::short(&accessor.kind))));
        }
        let element = |bytes: &[u8]| -> Result<[T; N], SceneError> {
            let mut values = zero;
            for (value, bytes) in values.iter_mut().zip(bytes.chunks_exact(component.size())) {
                *value = component_value(component, bytes)?;
            }
            Ok(values)
        };
        let size = N * component.size();
        let base = self.base(accessor, size, place)?;
        let count = match selection {
            Selection::All => accessor.count,
            Selection::Only(indices) => indices.len() as u64,
        };
        self.budget.claim(self.file, place, count, size_of::<[T; N]>() as u64)?;
        let read = |index: usize| base.as_ref().map_or(Ok(zero), |base| element(base.get(index)));
        let mut elements: Vec<[T; N]> = match selection {
            Selection::All => (0..count as usize).map(read).collect::<Result<_, _>>()?,
            Selection::Only(indices) => indices.iter().map(|&index| read(index as usize)).collect::<Result<_, _>>()?,
        };
        if let Some(sparse) = &accessor.sparse {
            let (indices, values) = self.sparse(sparse, accessor.count, size, place)?;
            for (at, &index) in indices.iter().enumerate() {
                let slot = match selection {
                    Selection::All => Some(index as usize),
                    Selection::Only(wanted) => wanted.binary_search(&index).ok(),
                };
                if let Some(slot) = slot {
                    elements[slot] = element(values.get(at))?;
                }
            }
        }
        Ok(elements)
    }

    fn component(&self, code: u32, place: &str) -> Result<Component, SceneError> {
        Component::from_code(code).ok_or_else(|| self.invalid(place, format!("it has no valid component type ({code})")))
    }

    /// The elements in the accessor's own buffer view, if it has one.
    fn base(&self, accessor: &Accessor, size: usize, place: &str) -> Result<Option<Strided<'_>>, SceneError> {
        let Some(index) = accessor.buffer_view else { return Ok(None) };
        let (bytes, view) = self.view(index, place)?;
        let stride = view.byte_stride.unwrap_or(size as u64);
        if stride < size as u64 {
            return Err(
                self.invalid(place, format!("its elements of {size} bytes do not fit the byteStride {stride} of buffer view {index}"))
            );
        }
        self.strided(bytes, accessor.byte_offset, accessor.count, stride, size, place, index).map(Some)
    }

    /// The indices (ascending, in range) and the values that replace elements.
    fn sparse(&self, sparse: &Sparse, count: u64, size: usize, place: &str) -> Result<(Vec<u32>, Strided<'_>), SceneError> {
        let component = self.component(sparse.indices.component_type, place)?;
        let tight = |view: usize, offset: u64, size: usize| {
            let (bytes, _) = self.view(view, place)?;
            self.strided(bytes, offset, sparse.count, size as u64, size, place, view)
        };
        let stored = tight(sparse.indices.buffer_view, sparse.indices.byte_offset, component.size())?;
        let values = tight(sparse.values.buffer_view, sparse.values.byte_offset, size)?;
        let indices: Option<Vec<u32>> = (0..sparse.count as usize).map(|at| component.unsigned(stored.get(at))).collect();
        let indices = indices.ok_or_else(|| self.invalid(place, "its sparse indices are not unsigned integers"))?;
        if indices.last().is_some_and(|&last| u64::from(last) >= count) || !indices.is_sorted_by(|a, b| a < b) {
            return Err(self.invalid(place, format!("its sparse indices do not ascend within its {count} elements")));
        }
        Ok((indices, values))
    }

    /// `count` elements from `offset`, the last one complete.
    #[expect(clippy::too_many_arguments, reason = "the numbers are those of one accessor and are used once")]
    fn strided<'b>(
        &self,
        bytes: &'b [u8],
        offset: u64,
        count: u64,
        stride: u64,
        size: usize,
        place: &str,
        view: usize,
    ) -> Result<Strided<'b>, SceneError> {
        let length =
            count.saturating_sub(1).checked_mul(stride).and_then(|before| before.checked_add(if count == 0 { 0 } else { size as u64 }));
        let end = length.and_then(|length| length.checked_add(offset)).filter(|&end| end <= bytes.len() as u64);
        match end {
            Some(end) => Ok(Strided { bytes: &bytes[offset.min(end) as usize..end as usize], stride: stride as usize, size }),
            None => Err(self.invalid(
                place,
                format!(
                    "{count} elements of {size} bytes from byte {offset} reach beyond buffer view {view}, which has {} bytes",
                    bytes.len()
                ),
            )),
        }
    }
}
