//! Passes over the lines of OBJ and MTL files for what the parser skips without a word or does not survive.

use crate::{Ignored, SceneError};

/// Digits of an index that no real file needs, and that overflow the parser's arithmetic.
const LONGEST_INDEX: usize = 11;

/// A foreign file has a new kind of statement on every line; a few are enough to say so.
const MOST_KINDS: usize = 32;

/// What stands in an OBJ file beside its geometry.
pub struct Scan {
    /// Notes on every kind of statement that is ignored.
    pub notes: Vec<Ignored>,
    /// Materials that faces ask for, each with its first line.
    pub materials: Vec<(String, usize)>,
}

/// Looks over an OBJ file.
///
/// # Errors
/// A face whose index cannot be meant.
pub fn scan(file: &str, bytes: &[u8]) -> Result<Scan, SceneError> {
    let mut materials: Vec<(String, usize)> = Vec::new();
    let mut kinds: Vec<(&str, usize, usize)> = Vec::new();
    let mut smooth = None;
    // Positions, texture coordinates and normals so far.
    let mut counts = [0_usize; 3];
    for (index, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        // Lines that are not text are the parser's to refuse.
        let Ok(line) = std::str::from_utf8(line) else { continue };
        let mut words = line.split_whitespace();
        let Some(keyword) = words.next() else { continue };
        match keyword {
            "v" => counts[0] += 1,
            "vt" => counts[1] += 1,
            "o" | "g" | "mtllib" => {}
            "usemtl" => {
                let name = line.split_once(' ').map_or("", |(_, name)| name.trim());
                if !materials.iter().any(|(known, _)| known == name) {
                    materials.push((name.into(), index + 1));
                }
            }
            "vn" => counts[2] += 1,
            "f" => {
                if let Some(problem) = words.find_map(|word| corner_problem(word, counts)) {
                    return Err(SceneError::Syntax { file: file.into(), line: index + 1, column: 1, problem });
                }
            }
            "s" => {
                if !matches!(words.next(), Some("off" | "0")) {
                    smooth = smooth.or(Some(index + 1));
                }
            }
            comment if comment.starts_with('#') => {}
            other => match kinds.iter().position(|(kind, ..)| *kind == other) {
                Some(known) => kinds[known].2 += 1,
                None if kinds.len() < MOST_KINDS => kinds.push((other, index + 1, 1)),
                None => {}
            },
        }
    }
    let note = |line: usize, feature: String, consequence: &str| Ignored {
        file: file.into(),
        place: format!("line {line}"),
        feature,
        consequence: consequence.into(),
    };
    let mut notes: Vec<_> = kinds
        .into_iter()
        .map(|(kind, line, count)| {
            let consequence = match kind {
                "p" | "l" => "points and lines are not drawn",
                "vp" | "cstype" | "deg" | "curv" | "curv2" | "surf" | "parm" | "trim" | "hole" | "end" | "step" | "bmat" => {
                    "free-form curves and surfaces are not drawn"
                }
                _ => "unknown statement",
            };
            note(line, format!("{kind} ({count}x)"), consequence)
        })
        .collect();
    if let (Some(line), false) = (smooth, counts[2] > 0) {
        notes.push(note(line, "s".into(), "smoothing groups are not evaluated: faces without normals are flat"));
    }
    Ok(Scan { notes, materials })
}

/// What is wrong with `v/vt/vn`, a corner of a face after `counts` of each: no index has so many digits, and a negative one counts back from
/// the last. The parser does not look, and its sum wraps round. What is not a number, or points forward, is its own to refuse.
fn corner_problem(corner: &str, counts: [usize; 3]) -> Option<String> {
    corner.split('/').zip(counts).find_map(|(text, count)| match text.parse::<i64>() {
        _ if text.len() > LONGEST_INDEX => Some(format!("`{text}` is no index of a vertex")),
        Ok(index) if index < 0 && index.unsigned_abs() > count as u64 => {
            Some(format!("index {text} counts back from {count} given so far; it must be -{count} or nearer"))
        }
        _ => None,
    })
}

/// A material library as the parser survives it: a colour of one number, which the format allows, becomes a grey of three; colours in
/// other forms are left out, with a note on the second list.
pub fn library(text: &str) -> (String, Vec<String>) {
    let mut notes = Vec::new();
    let mut lines = String::with_capacity(text.len());
    for (index, line) in text.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().take(4).collect();
        match words.as_slice() {
            [key @ ("Ka" | "Kd" | "Ks" | "Ke"), values @ ..] if values.len() < 3 || values[0].parse::<f32>().is_err() => match values {
                [grey] if grey.parse::<f32>().is_ok() => lines.push_str(&format!("{key} {grey} {grey} {grey}")),
                _ => notes.push(format!("line {}: {key} is no colour of one or three numbers; left out", index + 1)),
            },
            _ => lines.push_str(line),
        }
        lines.push('\n');
    }
    (lines, notes)
}
