//! ETC1S images in BasisLZ streams: blocks of 4 × 4 texels name a colour and a pattern in two code books.
//! \[KTX2], "BasisLZ bitstream specification" and "ETC1S slice data"
//!
//! Every decoder accepts any bytes and stops at the first thing that cannot be.

use super::bits::{Bits, Huffman, Malformed};

/// Distance of the four colours of a block from its base colour.    \[KDF], "ETC1S"
const MODIFIERS: [[i32; 4]; 8] = [
    [-8, -2, 2, 8],
    [-17, -5, 5, 17],
    [-29, -9, 9, 29],
    [-42, -13, 13, 42],
    [-60, -18, 18, 60],
    [-80, -24, 24, 80],
    [-106, -33, 33, 106],
    [-183, -47, 47, 183],
];

/// A base colour of 5 bits a channel, and the index of its modifiers.
#[derive(Clone, Copy)]
struct Endpoint {
    color: [u8; 3],
    modifiers: u8,
}

impl Endpoint {
    /// The four colours of a block.
    fn colors(self) -> [[u8; 3]; 4] {
        let base = self.color.map(|c| i32::from(c << 3 | c >> 2));
        MODIFIERS[usize::from(self.modifiers)].map(|modifier| base.map(|c| (c + modifier).clamp(0, 255) as u8))
    }
}

/// Two bits for each texel of a block: one byte a row, the left texel in the lowest bits.
type Selectors = [u8; 4];

/// Code books and Huffman codes that all slices of a file share.
pub struct Codebooks {
    endpoints: Vec<Endpoint>,
    selectors: Vec<Selectors>,
    prediction: Huffman,
    endpoint_delta: Huffman,
    selector: Huffman,
    selector_run: Huffman,
    history: usize,
}

/// Image of the first level: where its slices are in the level's bytes.
pub struct Slices {
    /// The colours.
    pub color: std::ops::Range<usize>,
    /// The alpha channel, stored as green; empty where there is none.
    pub alpha: std::ops::Range<usize>,
}

impl Codebooks {
    /// Reads the global data of a KTX 2 file with `images` images: the code books, and the slices of the first image.
    pub fn read(global: &[u8], images: usize) -> Result<(Self, Slices), Malformed> {
        const SHORT: Malformed = "the global data is truncated";
        let word = |at: usize| global.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize).ok_or(SHORT);
        let counts = word(0)?;
        let descriptions = images.checked_mul(20).ok_or(SHORT)?;
        let mut rest = global.get(20..).and_then(|rest| rest.get(descriptions..)).ok_or(SHORT)?;
        let mut part = |length: usize| {
            let (head, tail) = rest.split_at_checked(length).ok_or(SHORT)?;
            rest = tail;
            Ok::<_, Malformed>(head)
        };
        let [endpoints, selectors, tables] = [part(word(4)?)?, part(word(8)?)?, part(word(12)?)?];
        if word(20)? & 2 != 0 {
            return Err("it is a video");
        }
        let slice = |at: usize| Ok::<_, Malformed>(word(at)?..word(at)?.saturating_add(word(at + 4)?));
        let slices = Slices { color: slice(24)?, alpha: slice(32)? };

        let mut bits = Bits::new(tables);
        let [prediction, endpoint_delta, selector, selector_run] =
            [Huffman::read(&mut bits)?, Huffman::read(&mut bits)?, Huffman::read(&mut bits)?, Huffman::read(&mut bits)?];
        let history = bits.take(13) as usize;
        bits.check()?;
        let endpoints = read_endpoints(endpoints, counts & 0xffff)?;
        let selectors = read_selectors(selectors, counts >> 16)?;
        Ok((Self { endpoints, selectors, prediction, endpoint_delta, selector, selector_run, history }, slices))
    }

    /// Decodes a slice of `width × height` texels; `set` takes a texel's index and its colour.
    pub fn decode(&self, slice: &[u8], width: usize, height: usize, mut set: impl FnMut(usize, [u8; 3])) -> Result<(), Malformed> {
        self.blocks(slice, width.div_ceil(4), height.div_ceil(4), |block_x, block_y, endpoint, selectors| {
            let colors = endpoint.colors();
            for (y, row) in (4 * block_y..height.min(4 * block_y + 4)).zip(selectors) {
                for (x, shift) in (4 * block_x..width.min(4 * block_x + 4)).zip([0, 2, 4, 6]) {
                    set(y * width + x, colors[usize::from(row >> shift & 3)]);
                }
            }
        })
    }

    /// Runs over the blocks of a slice, row by row.
    fn blocks(
        &self,
        slice: &[u8],
        columns: usize,
        rows: usize,
        mut emit: impl FnMut(usize, usize, Endpoint, Selectors),
    ) -> Result<(), Malformed> {
        let mut bits = Bits::new(slice);
        let mut endpoints = EndpointDecoder::new(self, columns);
        let mut selectors = SelectorDecoder::new(self);
        for row in 0..rows {
            for column in 0..columns {
                let endpoint = endpoints.next(&mut bits, column, row)?;
                let selector = selectors.next(&mut bits)?;
                let endpoint = *self.endpoints.get(endpoint).ok_or("a block names an endpoint that is not there")?;
                let selector = *self.selectors.get(selector).ok_or("a block names a selector that is not there")?;
                emit(column, row, endpoint, selector);
            }
            bits.check()?;
        }
        Ok(())
    }
}

/// Deltas of colours and modifiers, each in the code of the previous value's range.
fn read_endpoints(stream: &[u8], count: usize) -> Result<Vec<Endpoint>, Malformed> {
    let mut bits = Bits::new(stream);
    let color_deltas = [Huffman::read(&mut bits)?, Huffman::read(&mut bits)?, Huffman::read(&mut bits)?];
    let modifier_delta = Huffman::read(&mut bits)?;
    let gray = bits.bit() == 1;
    let mut previous = Endpoint { color: [16; 3], modifiers: 0 };
    let mut endpoints = Vec::with_capacity(count);
    for _ in 0..count {
        previous.modifiers = (u32::from(previous.modifiers) + modifier_delta.symbol(&mut bits)?) as u8 & 7;
        for channel in &mut previous.color[..if gray { 1 } else { 3 }] {
            let code = &color_deltas[usize::from(*channel > 9) + usize::from(*channel > 21)];
            *channel = (u32::from(*channel) + code.symbol(&mut bits)?) as u8 & 31;
        }
        if gray {
            previous.color = [previous.color[0]; 3];
        }
        endpoints.push(previous);
    }
    bits.check()?;
    Ok(endpoints)
}

/// Rows as they are, or as differences to those of the previous selectors.
fn read_selectors(stream: &[u8], count: usize) -> Result<Vec<Selectors>, Malformed> {
    let mut bits = Bits::new(stream);
    if bits.take(2) != 0 {
        return Err("its selectors are stored in a way that KTX 2 does not allow");
    }
    let raw = bits.bit() == 1;
    let delta = if raw { Huffman::default() } else { Huffman::read(&mut bits)? };
    let mut previous = Selectors::default();
    let mut selectors = Vec::with_capacity(count);
    for index in 0..count {
        for row in &mut previous {
            *row = if raw || index == 0 { bits.take(8) as u8 } else { *row ^ delta.symbol(&mut bits)? as u8 };
        }
        selectors.push(previous);
    }
    bits.check()?;
    Ok(selectors)
}

/// Endpoints: predicted from the left, upper or upper-left block, or a delta to the previous one. Two bits a block say which; those of 2 × 2
/// blocks are one symbol, which may repeat.
struct EndpointDecoder<'a> {
    books: &'a Codebooks,
    /// Endpoints of the blocks of the upper row, overwritten by those of this row.
    above: Vec<usize>,
    upper_left: usize,
    previous: usize,
    /// Predictions of the row below, four bits for two blocks.
    below: Vec<u32>,
    current: u32,
    symbol: u32,
    repeats: u32,
}

impl<'a> EndpointDecoder<'a> {
    fn new(books: &'a Codebooks, columns: usize) -> Self {
        let pairs = columns.div_ceil(2);
        Self { books, above: vec![0; columns], upper_left: 0, previous: 0, below: vec![0; pairs], current: 0, symbol: 0, repeats: 0 }
    }

    fn next(&mut self, bits: &mut Bits<'_>, column: usize, row: usize) -> Result<usize, Malformed> {
        const REPEAT: u32 = 256;
        if column.is_multiple_of(2) {
            if row.is_multiple_of(2) {
                if self.repeats > 0 {
                    self.repeats -= 1;
                } else {
                    match self.books.prediction.symbol(bits)? {
                        REPEAT => self.repeats = bits.variable(4).saturating_add(2),
                        symbol => self.symbol = symbol,
                    }
                }
                self.current = self.symbol;
                self.below[column / 2] = self.symbol >> 4;
            } else {
                self.current = self.below[column / 2];
            }
        }
        let prediction = self.current & 3;
        self.current >>= 2;
        const OUTSIDE: Malformed = "a block is predicted from outside the image";
        let endpoint = match prediction {
            0 if column == 0 => return Err(OUTSIDE),
            0 => self.previous,
            1 if row == 0 => return Err(OUTSIDE),
            1 => self.above[column],
            2 if row == 0 || column == 0 => return Err(OUTSIDE),
            2 => self.upper_left,
            _ => {
                let sum = self.previous + self.books.endpoint_delta.symbol(bits)? as usize;
                if sum >= self.books.endpoints.len() { sum - self.books.endpoints.len() } else { sum }
            }
        };
        self.upper_left = std::mem::replace(&mut self.above[column], endpoint);
        self.previous = endpoint;
        Ok(endpoint)
    }
}

/// Selectors: an index, a place in the history of recent ones, or a run of its first place.
struct SelectorDecoder<'a> {
    books: &'a Codebooks,
    /// Recent selectors, approximately moved to the front when used.
    history: Vec<usize>,
    /// Where the next new one goes, in the rear half.
    rover: usize,
    run: u32,
}

impl<'a> SelectorDecoder<'a> {
    fn new(books: &'a Codebooks) -> Self {
        Self { books, history: vec![0; books.history], rover: books.history / 2, run: 0 }
    }

    fn next(&mut self, bits: &mut Bits<'_>) -> Result<usize, Malformed> {
        let known = self.books.selectors.len();
        let mut symbol = known;
        if self.run > 0 {
            self.run -= 1;
        } else {
            symbol = self.books.selector.symbol(bits)? as usize;
            if symbol == known + self.history.len() {
                self.run = match self.books.selector_run.symbol(bits)? {
                    63 => bits.variable(7).saturating_add(2),
                    run => run + 2,
                };
                symbol = known;
            }
        }
        if symbol < known {
            if let Some(slot) = self.history.get_mut(self.rover) {
                *slot = symbol;
                self.rover += 1;
                if self.rover == self.history.len() {
                    self.rover /= 2;
                }
            }
            return Ok(symbol);
        }
        let place = symbol - known;
        let selector = *self.history.get(place).ok_or("a block names a selector beyond the history")?;
        self.history.swap(place / 2, place);
        Ok(selector)
    }
}
