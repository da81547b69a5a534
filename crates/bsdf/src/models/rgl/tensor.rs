//! The container of the `.bsdf` files: arrays with names, little-endian.
//!
//! ```text
//! "tensor_file\0"   version u8 u8 = 1, 0   fields u32
//! for each field    name's length u16, name, rank u16, type u8, offset u64, shape u64 × rank
//! then the arrays, each at its offset from the start of the file, last index fastest             [Dupuy18]
//! ```

use std::fmt;

const MAGIC: &[u8; 12] = b"tensor_file\0";
/// Fields of one file: those of the database have 12.
const MOST_FIELDS: u32 = 64;
/// Indices of one array: those of the database have 5.
const MOST_RANK: u16 = 8;
/// Where arrays start, and what their starts are multiples of, in files that are written here.
const ALIGNMENT: usize = 8;
/// Types by their number, with the bytes of each.
const TYPES: [(&str, usize); 12] = [
    ("nothing", 0),
    ("u8", 1),
    ("i8", 1),
    ("u16", 2),
    ("i16", 2),
    ("u32", 4),
    ("i32", 4),
    ("u64", 8),
    ("i64", 8),
    ("f16", 2),
    ("f32", 4),
    ("f64", 8),
];
const U8: u8 = 1;
const F32: u8 = 10;

/// Is it such a file, judging by its first bytes?
pub fn is_tensor_file(start: &[u8]) -> bool {
    start.starts_with(MAGIC)
}

/// An array of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Lengths, slowest index first.
    pub shape: Vec<usize>,
    /// The numbers.
    pub data: Vec<f32>,
}

/// What a field of a file holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// Of type u8, in one dimension.
    Bytes(Vec<u8>),
    /// Of type f32.
    Numbers(Array),
}

struct Field<'a> {
    name: &'a [u8],
    kind: u8,
    shape: Vec<usize>,
    data: &'a [u8],
}

/// The fields of a file.
pub struct Tensors<'a> {
    fields: Vec<Field<'a>>,
}

impl<'a> Tensors<'a> {
    /// Finds the fields; nothing is copied yet, and nothing is longer than the file.
    ///
    /// # Errors
    /// What is wrong with the file, in one sentence.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, String> {
        if !is_tensor_file(bytes) {
            return Err("does not begin with `tensor_file` as an RGL .bsdf file does; is it another format?".to_owned());
        }
        let mut rest = Rest(&bytes[MAGIC.len()..]);
        let short = || format!("is cut off: has {} bytes, too few for its header; fetch the file again", bytes.len());
        let version = rest.take(2).ok_or_else(short)?;
        if version != [1, 0] {
            return Err(format!("has version {}.{} of the format, 1.0 is understood", version[0], version[1]));
        }
        let count = rest.number::<4>().ok_or_else(short)? as u32;
        if count > MOST_FIELDS {
            return Err(format!("its header says {count} fields, more than the {MOST_FIELDS} that are understood; fetch the file again"));
        }
        let mut fields = Vec::new();
        for _ in 0..count {
            fields.push(rest.field(bytes).ok_or_else(short)??);
        }
        Ok(Self { fields })
    }

    /// Does the file have such a field?
    pub fn has(&self, name: &str) -> bool {
        self.fields.iter().any(|field| field.name == name.as_bytes())
    }

    fn field(&self, name: &str, kind: u8) -> Result<&Field<'a>, String> {
        let field = self
            .fields
            .iter()
            .find(|field| field.name == name.as_bytes())
            .ok_or_else(|| format!("has no field `{name}`; give a .bsdf file of the RGL material database"))?;
        if field.kind != kind {
            return Err(format!("its field `{name}` is of type {}, not {}", type_name(field.kind), type_name(kind)));
        }
        Ok(field)
    }

    /// The bytes of a field.
    ///
    /// # Errors
    /// No such field, or one of another type.
    pub fn bytes(&self, name: &str) -> Result<&'a [u8], String> {
        Ok(self.field(name, U8)?.data)
    }

    /// The numbers of a field with `rank` indices, all finite.
    ///
    /// # Errors
    /// No such field, one of another type or rank, or a number that is not finite.
    pub fn numbers(&self, name: &str, rank: usize) -> Result<Array, String> {
        let field = self.field(name, F32)?;
        if field.shape.len() != rank {
            return Err(format!("its field `{name}` has the shape {}, not one of {rank} indices", Shape(&field.shape)));
        }
        let data: Vec<f32> = field.data.as_chunks::<4>().0.iter().map(|four| f32::from_le_bytes(*four)).collect();
        match data.iter().position(|number| !number.is_finite()) {
            Some(at) => Err(format!("its field `{name}` holds {} at index {at}, not a finite number; fetch the file again", data[at])),
            None => Ok(Array { shape: field.shape.clone(), data }),
        }
    }
}

/// What of the header was not read yet.
struct Rest<'a>(&'a [u8]);

impl<'a> Rest<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    /// Of N bytes.
    fn number<const N: usize>(&mut self) -> Option<u64> {
        Some(self.take(N)?.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
    }

    /// `None` where the header ends before the field does.
    fn field(&mut self, file: &'a [u8]) -> Option<Result<Field<'a>, String>> {
        let length = self.number::<2>()? as usize;
        let name = self.take(length)?;
        let rank = self.number::<2>()? as u16;
        let kind = self.number::<1>()? as u8;
        let offset = self.number::<8>()?;
        let shown = String::from_utf8_lossy(name);
        let Some(&(_, size)) = TYPES.get(usize::from(kind)).filter(|_| kind != 0) else {
            return Some(Err(format!("its field `{shown}` is of type {kind}, which the format does not have; fetch the file again")));
        };
        if rank > MOST_RANK {
            return Some(Err(format!("its field `{shown}` has {rank} indices, more than the {MOST_RANK} that are understood")));
        }
        let shape: Vec<u64> = (0..rank).map(|_| self.number::<8>()).collect::<Option<_>>()?;
        let length = shape.iter().try_fold(size as u64, |product, n| product.checked_mul(*n));
        let range = length.and_then(|length| Some(usize::try_from(offset).ok()?..usize::try_from(offset.checked_add(length)?).ok()?));
        Some(match range.and_then(|range| file.get(range)) {
            // Lengths of arrays within the file, or of empty ones.
            Some(data) => Ok(Field { name, kind, shape: shape.into_iter().map(|n| n as usize).collect(), data }),
            None => Err(format!(
                "its field `{shown}` of shape {} at byte {offset} does not lie within the {} bytes of the file; fetch the file again",
                Shape(&shape),
                file.len()
            )),
        })
    }
}

/// The contents of a file with these fields.
pub fn to_bytes(fields: &[(&str, Content)]) -> Vec<u8> {
    let one_index = |bytes: &Vec<u8>| vec![bytes.len()];
    let shape = |content: &Content| match content {
        Content::Bytes(bytes) => one_index(bytes),
        Content::Numbers(array) => array.shape.clone(),
    };
    let header: usize = 18 + fields.iter().map(|(name, content)| 13 + name.len() + 8 * shape(content).len()).sum::<usize>();
    let mut out = MAGIC.to_vec();
    out.extend([1, 0]);
    out.extend((fields.len() as u32).to_le_bytes());
    let mut data = Vec::new();
    for (name, content) in fields {
        data.resize((header + data.len()).next_multiple_of(ALIGNMENT) - header, 0);
        out.extend((name.len() as u16).to_le_bytes());
        out.extend(name.as_bytes());
        let shape = shape(content);
        out.extend((shape.len() as u16).to_le_bytes());
        out.push(if matches!(content, Content::Bytes(_)) { U8 } else { F32 });
        out.extend(((header + data.len()) as u64).to_le_bytes());
        shape.iter().for_each(|n| out.extend((*n as u64).to_le_bytes()));
        match content {
            Content::Bytes(bytes) => data.extend(bytes),
            Content::Numbers(array) => array.data.iter().for_each(|number| data.extend(number.to_le_bytes())),
        }
    }
    out.extend(data);
    out
}

fn type_name(kind: u8) -> &'static str {
    TYPES[usize::from(kind)].0
}

/// Lengths, as 8 × 32 × 32.
pub struct Shape<'a, T>(pub &'a [T]);

impl<T: fmt::Display> fmt::Display for Shape<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, n) in self.0.iter().enumerate() {
            write!(f, "{}{n}", if i > 0 { " × " } else { "" })?;
        }
        if self.0.is_empty() { f.write_str("(none)") } else { Ok(()) }
    }
}
