//! Files of factored BRDFs: a few lines of text, then numbers.
//!
//! ```text
//! kajo-nmf 1                  the kind of file and its version
//! theta_h 64                  one count a line, in the order of the kind
//! …
//! end                         and, after its line break, little-endian f32
//! ```

use super::Grid;
use crate::models::ModelError;
use std::fs::File;
use std::io::Read;

/// Counts are at most this large.
const MOST: usize = 4096;
/// Numbers are at most this many: 64 MiB.
const MOST_NUMBERS: usize = 1 << 24;
/// The text is at most this long.
const LONGEST_HEADER: usize = 512;

/// The counts of a grid, which every kind of file begins with.
const GRID: [&str; 5] = ["theta_h", "phi_h", "theta_o", "phi_o", "channels"];

/// A kind of file.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// Its first word.
    pub name: &'static str,
    /// The counts after those of the grid, with the largest that each may be.
    pub counts: &'static [(&'static str, usize)],
    /// How many numbers follow.
    pub length: fn(Grid, &[usize]) -> usize,
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Contents {
    /// The nodes.
    pub grid: Grid,
    /// The other counts of the format, in its order.
    pub counts: Vec<usize>,
    /// All finite.
    pub numbers: Vec<f32>,
}

impl Format {
    /// Reads a file.
    ///
    /// # Errors
    /// [`ModelError::File`] where it is missing or not of this format.
    pub fn read(&self, path: &str) -> Result<Contents, ModelError> {
        let wrong = |problem: String| ModelError::File { file: path.to_owned(), problem };
        let mut bytes = Vec::new();
        File::open(path)
            .and_then(|file| file.take((LONGEST_HEADER + 4 * MOST_NUMBERS) as u64 + 1).read_to_end(&mut bytes))
            .map_err(|error| wrong(format!("cannot be read: {error}; give a file that `kajo bsdf factor` wrote")))?;
        self.decode(&bytes).map_err(wrong)
    }

    /// The contents of a file, from its bytes.
    ///
    /// # Errors
    /// What is wrong with them, in one sentence.
    pub fn decode(&self, bytes: &[u8]) -> Result<Contents, String> {
        let mut rest = bytes;
        let mut line = || -> Option<&str> {
            let end = rest.iter().take(LONGEST_HEADER).position(|&b| b == b'\n')?;
            let (line, after) = rest.split_at(end);
            rest = &after[1..];
            std::str::from_utf8(line).ok()
        };
        let first = format!("{} 1", self.name);
        match line() {
            Some(found) if found == first => {}
            Some(found) if found.starts_with("kajo-") && found.len() < 40 => {
                return Err(format!("begins with \"{found}\", not with \"{first}\"; take the model of that name"));
            }
            _ => return Err(format!("does not begin with \"{first}\"; give a file that `kajo bsdf factor` wrote")),
        }
        let mut counts = Vec::new();
        let limits = GRID.iter().map(|&name| (name, if name == "channels" { 3 } else { MOST })).chain(self.counts.iter().copied());
        for (name, most) in limits {
            let least = if name.starts_with("theta") || name == "phi_h" { 2 } else { 1 };
            let found = line().unwrap_or("nothing");
            let count = found.strip_prefix(name).and_then(|rest| rest.strip_prefix(' ')).and_then(|count| count.parse().ok());
            match count {
                Some(count) if (least..=most).contains(&count) && (name != "channels" || count != 2) => counts.push(count),
                _ => return Err(format!("has \"{found:.40}\" where \"{name} N\" should stand, N from {least} to {most}")),
            }
        }
        if line() != Some("end") {
            return Err("its list of counts does not stop with \"end\"".into());
        }
        let others = counts.split_off(GRID.len());
        let [theta_h, phi_h, theta_o, phi_o, channels] = std::array::from_fn(|i| counts[i]);
        let grid = Grid { theta_h, phi_h, theta_o, phi_o, channels };
        let length = (self.length)(grid, &others);
        if length > MOST_NUMBERS {
            return Err(format!("announces {length} numbers, more than {MOST_NUMBERS}"));
        }
        if rest.len() != 4 * length {
            return Err(format!("has {} bytes of numbers, and its counts announce {}; write it again", rest.len(), 4 * length));
        }
        let numbers: Vec<f32> = rest.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        // Sums of products of five of them stay finite.
        match numbers.iter().position(|v| !v.is_finite() || v.abs() > 1e30) {
            Some(i) => Err(format!("number {i} is {}, not a finite one of common size; write the file again", numbers[i])),
            None => Ok(Contents { grid, counts: others, numbers }),
        }
    }

    /// The bytes of a file.
    pub fn encode(&self, contents: &Contents) -> Vec<u8> {
        let g = contents.grid;
        let mut text = format!("{} 1\n", self.name);
        for (name, count) in GRID.iter().zip([g.theta_h, g.phi_h, g.theta_o, g.phi_o, g.channels]) {
            text += &format!("{name} {count}\n");
        }
        for ((name, _), count) in self.counts.iter().zip(&contents.counts) {
            text += &format!("{name} {count}\n");
        }
        text += "end\n";
        text.bytes().chain(contents.numbers.iter().flat_map(|v| v.to_le_bytes())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMAT: Format = Format { name: "kajo-trial", counts: &[("terms", 8)], length: |grid, counts| grid.theta_h * counts[0] };

    fn contents() -> Contents {
        let grid = Grid { theta_h: 3, phi_h: 2, theta_o: 2, phi_o: 1, channels: 1 };
        Contents { grid, counts: vec![2], numbers: vec![1.0, -2.0, 3.5, 0.0, 1e-20, 7.0] }
    }

    #[test]
    fn what_is_encoded_is_decoded() {
        let bytes = FORMAT.encode(&contents());
        assert_eq!(FORMAT.decode(&bytes).unwrap(), contents());
        let mut fault = bytes;
        let last = fault.len() - 2;
        fault[last] ^= 1;
        assert_ne!(FORMAT.decode(&fault).unwrap(), contents(), "planted fault");
    }

    #[test]
    fn what_is_no_such_file_is_refused_in_a_sentence() {
        let good = FORMAT.encode(&contents());
        let text = |from: &str, to: &str| {
            let at = good.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
            [&good[..at], to.as_bytes(), &good[at + from.len()..]].concat()
        };
        let nan = [&good[..good.len() - 4], &f32::NAN.to_le_bytes()].concat();
        for (bytes, says) in [
            (b"PNG".to_vec(), "does not begin with \"kajo-trial 1\""),
            (vec![b'\n'; 4000], "does not begin with"),
            (text("kajo-trial 1", "kajo-nmf 1"), "begins with \"kajo-nmf 1\", not with \"kajo-trial 1\""),
            (text("theta_h 3", "theta_h 1"), "\"theta_h N\" should stand, N from 2 to 4096"),
            (text("theta_h 3", "theta_h 99999999999999999999999"), "should stand"),
            (text("channels 1", "channels 2"), "has \"channels 2\""),
            (text("terms 2", "terms 9"), "N from 1 to 8"),
            (text("phi_o 1", "phi 1"), "\"phi_o N\""),
            (text("end\n", "fin\n"), "does not stop with \"end\""),
            (text("theta_h 3", "theta_h 4"), "has 24 bytes of numbers, and its counts announce 32"),
            (good[..good.len() - 1].to_vec(), "has 23 bytes of numbers"),
            (good[..40].to_vec(), "should stand"),
            (nan, "number 5 is NaN"),
        ] {
            let error = FORMAT.decode(&bytes).unwrap_err();
            assert!(error.contains(says), "no `{says}` in `{error}`");
        }
        assert!(FORMAT.read("/nowhere/at/all").unwrap_err().to_string().starts_with("`/nowhere/at/all`: cannot be read"));
    }
}
