//! The `.binary` files of the MERL database: three little-endian i32 with the numbers of bins, then f64 of every bin, first all red ones, then green, then
//! blue, each channel by its own scale; negative where nothing was measured.    \[Matusik03]

use super::table::{BINS, MISSING, Table};
use crate::models::ModelError;
use std::fs::File;
use std::io::Read;

/// What a stored number is multiplied by, red, green and blue.
const SCALE: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
const HEADER: usize = 12;
const COUNT: usize = BINS[0] * BINS[1] * BINS[2];
/// Bytes of a file.
const LENGTH: usize = HEADER + 3 * 8 * COUNT;

impl Table {
    /// Reads a file.
    ///
    /// # Errors
    /// [`ModelError::File`] where it is missing or not such a table.
    pub fn read(path: &str) -> Result<Self, ModelError> {
        let wrong = |problem: String| ModelError::File { file: path.to_owned(), problem };
        let mut bytes = Vec::new();
        // One byte more than a table has, not a film that was named by mistake.
        File::open(path)
            .and_then(|file| file.take(LENGTH as u64 + 1).read_to_end(&mut bytes))
            .map_err(|error| wrong(format!("cannot be read: {error}; give the path of a .binary file of the MERL database")))?;
        Self::from_bytes(&bytes).map_err(wrong)
    }

    /// Writes a file that every reader of the format understands.
    ///
    /// # Errors
    /// [`ModelError::File`] where that is not possible.
    pub fn write(&self, path: &str) -> Result<(), ModelError> {
        std::fs::write(path, self.to_bytes()).map_err(|error| ModelError::File {
            file: path.to_owned(),
            problem: format!("cannot be written: {error}; give a path in a folder that exists"),
        })
    }

    /// From the contents of a file.
    ///
    /// # Errors
    /// What is wrong with them, in one sentence.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let [h, d, p] = BINS;
        let expected = format!("a MERL table of {h} × {d} × {p} bins");
        if bytes.len() < HEADER {
            return Err(format!("has {} bytes, too few for the header of {expected}", bytes.len()));
        }
        let bins: [i32; 3] = std::array::from_fn(|i| i32::from_le_bytes(four(&bytes[4 * i..])));
        if bins.map(i64::from) != BINS.map(|count| count as i64) {
            return Err(format!("its header says {} × {} × {} bins, not {expected}; is it another format?", bins[0], bins[1], bins[2]));
        }
        if bytes.len() != LENGTH {
            let what = if bytes.len() < LENGTH { "is cut off" } else { "goes on after the last bin" };
            let got = if bytes.len() < LENGTH { bytes.len().to_string() } else { format!("more than {LENGTH}") };
            return Err(format!("{what}: has {got} bytes, {expected} has {LENGTH}; fetch the file again"));
        }
        let number = |channel: usize, bin: usize| {
            let at = HEADER + 8 * (channel * COUNT + bin);
            (f64::from_le_bytes(eight(&bytes[at..])) * SCALE[channel]) as f32
        };
        let bins: Vec<[f32; 3]> = (0..COUNT).map(|bin| std::array::from_fn(|channel| number(channel, bin))).collect();
        for (index, bin) in bins.iter().enumerate() {
            if let Some(channel) = bin.iter().position(|v| !v.is_finite()) {
                let name = ["red", "green", "blue"][channel];
                return Err(format!("the {name} value of bin {index} is {}, not a finite number; fetch the file again", bin[channel]));
            }
        }
        Ok(Self::of_bins(bins.into_iter().map(|bin| if bin.iter().any(|v| *v < 0.0) { MISSING } else { bin }).collect()))
    }

    /// The contents of a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(LENGTH);
        for count in BINS {
            bytes.extend_from_slice(&(count as i32).to_le_bytes());
        }
        for (channel, scale) in SCALE.iter().enumerate() {
            for bin in self.bins() {
                let stored = if bin[channel] < 0.0 { -1.0 } else { f64::from(bin[channel]) / scale };
                bytes.extend_from_slice(&stored.to_le_bytes());
            }
        }
        bytes
    }
}

fn four(bytes: &[u8]) -> [u8; 4] {
    std::array::from_fn(|i| bytes[i])
}

fn eight(bytes: &[u8]) -> [u8; 8] {
    std::array::from_fn(|i| bytes[i])
}
