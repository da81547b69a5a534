//! The binary container.    glTF 2.0, section 4

use crate::SceneError;

const MAGIC: &[u8] = b"glTF";
const JSON: u32 = 0x4e4f_534a;
const BIN: u32 = 0x004e_4942;

/// The JSON text of a file and its binary chunk: those of a GLB, or the file itself where it is text.
///
/// # Errors
/// [`SceneError::Invalid`] for what is neither, and for a GLB that is truncated or has no JSON.
pub fn split<'a>(file: &str, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>), SceneError> {
    let invalid = |problem: String| SceneError::invalid(file, "GLB container", problem);
    if !bytes.starts_with(MAGIC) {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        return match text.iter().find(|byte| !byte.is_ascii_whitespace()) {
            Some(b'{') => Ok((text, None)),
            _ => {
                Err(SceneError::invalid(file, "file", "it is neither glTF JSON (which begins with `{`) nor GLB (which begins with `glTF`)"))
            }
        };
    }
    let word = |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let truncated = || invalid(format!("truncated: the file has only {} bytes", bytes.len()));
    let version = word(4).ok_or_else(truncated)?;
    if version != 2 {
        return Err(invalid(format!("version {version} is not supported; convert the file to glTF 2.0")));
    }
    let length = word(8).ok_or_else(truncated)? as usize;
    if length > bytes.len() {
        return Err(invalid(format!("truncated: the header says {length} bytes, the file has {}", bytes.len())));
    }

    let (mut json, mut bin) = (None, None);
    let mut at = 12;
    while at + 8 <= length {
        let (size, kind) = word(at).zip(word(at + 4)).ok_or_else(truncated)?;
        let size = size as usize;
        let chunk = bytes[..length].get(at + 8..).and_then(|rest| rest.get(..size));
        let chunk = chunk.ok_or_else(|| invalid(format!("the chunk at byte {at} says {size} bytes, but the file ends before")))?;
        match kind {
            JSON if json.is_none() && at == 12 => json = Some(chunk),
            BIN if bin.is_none() => bin = Some(chunk),
            _ => {}
        }
        at += 8 + size;
    }
    json.map(|json| (json, bin)).ok_or_else(|| invalid("the first chunk is not JSON".into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(chunks: &[(u32, &[u8])]) -> Vec<u8> {
        let body: Vec<u8> =
            chunks.iter().flat_map(|(kind, data)| [&(data.len() as u32).to_le_bytes(), &kind.to_le_bytes(), *data].concat()).collect();
        [MAGIC, &2u32.to_le_bytes(), &(12 + body.len() as u32).to_le_bytes(), &body].concat()
    }

    #[test]
    fn chunks_are_found_and_unknown_ones_skipped() {
        let file = glb(&[(JSON, b"{}  "), (7, b"1234"), (BIN, b"data")]);
        assert_eq!(split("a.glb", &file).unwrap(), (&b"{}  "[..], Some(&b"data"[..])));
        assert_eq!(split("a.glb", &glb(&[(JSON, b"{}  ")])).unwrap(), (&b"{}  "[..], None));
    }

    #[test]
    fn text_is_passed_through_without_its_byte_order_mark() {
        assert_eq!(split("a.gltf", b"\xef\xbb\xbf {}").unwrap(), (&b" {}"[..], None));
    }

    #[test]
    fn every_truncation_is_one_clear_sentence() {
        let file = glb(&[(JSON, b"{}  "), (BIN, b"data")]);
        for length in 0..file.len() {
            let message = split("a.glb", &file[..length]).unwrap_err().to_string();
            assert!(message.starts_with("`a.glb`: "), "{message}");
            assert!(message.contains("truncated") || (length < 4 && message.contains("neither")), "cut to {length}: {message}");
        }
    }

    #[test]
    fn wrong_containers_are_named() {
        let message = |bytes: &[u8]| split("a.glb", bytes).unwrap_err().to_string();
        assert!(message(b"PK\x03\x04").contains("neither glTF JSON"));
        assert!(message(b"glTF\x01\0\0\0\x0c\0\0\0").contains("version 1 is not supported"));
        assert!(message(&glb(&[(BIN, b"data")])).contains("the first chunk is not JSON"));
        let mut lying = glb(&[(JSON, b"{}  ")]);
        lying[12] = 200;
        assert!(message(&lying).contains("says 200 bytes"));
    }
}
