//! Mode 0: arrays of elements, stored as byte-wise deltas between neighbours in groups of 16.    \[EXT_meshopt], appendix A

use super::Malformed;
use super::reader::Reader;

const HEADER: u8 = 0xa0;
/// Elements that share a bit width.
const GROUP: usize = 16;
/// The first element stands verbatim at the end of the stream, padded in front to this size.
const TAIL: usize = 32;

/// Decodes `count` elements of `stride` bytes.
pub fn decode(count: usize, stride: usize, stream: &[u8]) -> Result<Vec<u8>, Malformed> {
    if stride == 0 || stride > 256 || !stride.is_multiple_of(4) {
        return Err("byteStride of attributes must be a multiple of 4 of at most 256");
    }
    let tail = stride.max(TAIL);
    let body = stream.len().checked_sub(tail).ok_or("the stream is truncated")?;
    let mut reader = Reader(&stream[..body]);
    if reader.byte()? != HEADER {
        return Err("the stream of attributes does not begin with 0xa0");
    }
    // A byte of the body describes at most four groups; so a lying count cannot ask for more than 64 times the stream.
    if count.div_ceil(4 * GROUP).checked_mul(stride).is_none_or(|least| least > body) {
        return Err("the stream is too short for its count");
    }

    let mut previous = stream[stream.len() - stride..].to_vec();
    let mut elements = vec![0; count * stride];
    for block in elements.chunks_mut(block_elements(stride) * stride) {
        decode_block(&mut reader, block, &mut previous)?;
    }
    if reader.0.is_empty() { Ok(elements) } else { Err("the stream goes on after its last element") }
}

/// Elements a block: as many as keep it within 8 KiB, in whole groups, at most 256.
fn block_elements(stride: usize) -> usize {
    ((8192 / stride) & !(GROUP - 1)).min(256)
}

/// One byte position of all elements after the other; `previous` is the element before the block, and then its last one.
fn decode_block(reader: &mut Reader<'_>, block: &mut [u8], previous: &mut [u8]) -> Result<(), Malformed> {
    let stride = previous.len();
    let groups = (block.len() / stride).div_ceil(GROUP);
    for (byte, last) in previous.iter_mut().enumerate() {
        let headers = reader.take(groups.div_ceil(4))?;
        for (group, elements) in block.chunks_mut(GROUP * stride).enumerate() {
            let deltas = decode_group(reader, (headers[group / 4] >> (group % 4 * 2)) & 3)?;
            for (element, delta) in elements.chunks_mut(stride).zip(deltas) {
                *last = last.wrapping_add((delta >> 1) ^ (delta & 1).wrapping_neg());
                element[byte] = *last;
            }
        }
    }
    Ok(())
}

/// The 16 zigzag-encoded deltas of a group, in 0, 2, 4 or 8 bits each; a value with all bits set is followed by a byte behind the group.
fn decode_group(reader: &mut Reader<'_>, mode: u8) -> Result<[u8; GROUP], Malformed> {
    let mut deltas = [0; GROUP];
    match mode {
        0 => {}
        3 => deltas.copy_from_slice(reader.take(GROUP)?),
        _ => {
            let bits = 2 * usize::from(mode);
            let per_byte = 8 / bits;
            let escape = (1 << bits) - 1;
            let packed = reader.take(GROUP / per_byte)?;
            for (index, delta) in deltas.iter_mut().enumerate() {
                let value = (packed[index / per_byte] >> (8 - bits - index % per_byte * bits)) & escape;
                *delta = if value == escape { reader.byte()? } else { value };
            }
        }
    }
    Ok(deltas)
}
