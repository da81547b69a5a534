//! Modes 1 and 2: triangle lists, coded by the edges and vertices they share with recent triangles, and plain index sequences, coded as
//! deltas.    \[EXT_meshopt], appendix A

use super::Malformed;
use super::reader::Reader;

const TRIANGLES_HEADER: u8 = 0xe1;
const SEQUENCE_HEADER: u8 = 0xd1;

/// The last 16 values pushed, newest first; slots never written hold zeros.
struct Fifo<T> {
    values: [T; 16],
    next: usize,
}

impl<T: Copy + Default> Fifo<T> {
    fn new() -> Self {
        Self { values: [T::default(); 16], next: 0 }
    }

    fn push(&mut self, value: T) {
        self.values[self.next & 15] = value;
        self.next = self.next.wrapping_add(1);
    }

    /// The value pushed `age` pushes before the newest.
    fn get(&self, age: u8) -> T {
        self.values[self.next.wrapping_sub(1 + usize::from(age)) & 15]
    }
}

/// What the decoder of triangles remembers.
struct Triangles<'a> {
    data: Reader<'a>,
    /// The next index that no triangle has used yet.
    next: u32,
    /// The last index that was stored as a delta.
    last: u32,
    edges: Fifo<[u32; 2]>,
    vertices: Fifo<u32>,
}

/// Decodes `count` indices of a triangle list.
pub fn decode_triangles(count: usize, stream: &[u8]) -> Result<Vec<u32>, Malformed> {
    if !count.is_multiple_of(3) {
        return Err("the count of triangle indices is not a multiple of 3");
    }
    let body = stream.len().checked_sub(16).ok_or("the stream is truncated")?;
    let (body, table) = stream.split_at(body);
    let mut reader = Reader(body);
    if reader.byte()? != TRIANGLES_HEADER {
        return Err("the stream of triangles does not begin with 0xe1");
    }
    let codes = reader.take(count / 3)?;
    let mut state = Triangles { data: reader, next: 0, last: 0, edges: Fifo::new(), vertices: Fifo::new() };
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        let triangle = match code {
            0x00..=0xef => state.edge_and_vertex(code >> 4, code & 15)?,
            0xf0..=0xfd => state.three_vertices(0, table[usize::from(code & 15)])?,
            0xfe | 0xff => {
                let aux = state.data.byte()?;
                if aux == 0 {
                    state.next = 0;
                }
                state.three_vertices(if code == 0xfe { 0 } else { 15 }, aux)?
            }
        };
        indices.extend(triangle);
    }
    if state.data.0.is_empty() { Ok(indices) } else { Err("the stream goes on after its last triangle") }
}

impl Triangles<'_> {
    /// A triangle on a recent edge.
    fn edge_and_vertex(&mut self, edge: u8, vertex: u8) -> Result<[u32; 3], Malformed> {
        let [a, b] = self.edges.get(edge);
        let c = match vertex {
            0 => self.fresh(),
            1..=12 => self.vertices.get(vertex),
            13 => self.near(u32::MAX),
            14 => self.near(1),
            _ => self.stored()?,
        };
        if !(1..=12).contains(&vertex) {
            self.vertices.push(c);
        }
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Ok([a, b, c])
    }

    /// A triangle whose vertices are each the next fresh one (0), a recent one (1 … 14) or stored (15): the first by `first`, the
    /// others by the nibbles of `aux`. All fresh ones are numbered before stored ones are read, as are the recent ones looked up.
    fn three_vertices(&mut self, first: u8, aux: u8) -> Result<[u32; 3], Malformed> {
        let kinds = [first, aux >> 4, aux & 15];
        let mut triangle = kinds.map(|kind| match kind {
            0 => self.fresh(),
            15 => 0,
            age => self.vertices.get(age - 1),
        });
        for (vertex, _) in triangle.iter_mut().zip(kinds).filter(|&(_, kind)| kind == 15) {
            *vertex = self.stored()?;
        }
        for (&vertex, _) in triangle.iter().zip(kinds).filter(|&(_, kind)| kind == 0 || kind == 15) {
            self.vertices.push(vertex);
        }
        let [a, b, c] = triangle;
        self.edges.push([b, a]);
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Ok(triangle)
    }

    fn fresh(&mut self) -> u32 {
        let vertex = self.next;
        self.next = vertex.wrapping_add(1);
        vertex
    }

    fn near(&mut self, step: u32) -> u32 {
        self.last = self.last.wrapping_add(step);
        self.last
    }

    fn stored(&mut self) -> Result<u32, Malformed> {
        let value = self.data.varint()?;
        Ok(self.near(unzigzag(value)))
    }
}

/// Decodes `count` indices, each a delta to one of two earlier ones.
pub fn decode_sequence(count: usize, stream: &[u8]) -> Result<Vec<u32>, Malformed> {
    let body = stream.len().checked_sub(4).ok_or("the stream is truncated")?;
    let mut reader = Reader(&stream[..body]);
    if reader.byte()? != SEQUENCE_HEADER {
        return Err("the stream of indices does not begin with 0xd1");
    }
    if count > body {
        return Err("the stream is too short for its count");
    }
    let mut baselines = [0u32; 2];
    let mut indices = Vec::with_capacity(count);
    for _ in 0..count {
        let value = reader.varint()?;
        let baseline = &mut baselines[(value & 1) as usize];
        *baseline = baseline.wrapping_add(unzigzag(value >> 1));
        indices.push(*baseline);
    }
    if reader.0.is_empty() { Ok(indices) } else { Err("the stream goes on after its last index") }
}

/// The two's-complement number behind a zigzag code.
fn unzigzag(value: u32) -> u32 {
    (value >> 1) ^ (value & 1).wrapping_neg()
}
