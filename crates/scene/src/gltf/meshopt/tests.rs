//! Streams made by the reference encoder (meshoptimizer 0.25, vertex codec 0, index codec 1), and the example of the specification.

use super::*;

/// 20 elements of 4 bytes: a counter, a counter times 5, a constant with one outlier, a counter times 97.
const ATTRIBUTES: &[u8] =
    b"\xa0\x05\x2a\xaa\xaa\xaa\xaa\x00\x00\x00\x0a\x0a\xaa\xaa\xaa\xaa\xaa\xaa\xaa\xaa\xaa\x00\x00\x00\x00\x00\x00\x01\x00\x03\xc0\
    \x00\x75\x76\x07\x00\xc2\xc2\xc2\xc2\xc2\xc2\xc2\xc2\xc2\xc2\xc2\xc2\xc2\xc2\xc2\xff\x00\x00\x00\xc2\xc2\xc2\xc2\x00\x00\x00\
    \x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x03\x00";
const TRIANGLES: &[u8] = b"\xe1\xf0\x10\x0f\xff\xff\xff\xc8\x01\xf3\xc7\x01\x0a\xf4\xc0\x01\xbb\x01\xf8\x03\xc6\x0f\
\x00\x76\x87\x56\x67\x78\xa9\x86\x65\x89\x68\x98\x01\x69\x00\x00";
const INDICES: &[u8] = b"\xd1\x00\x04\xcd\x01\x04\x07\x98\x1f\x00\x00\x00\x00";

fn u32s(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect()
}

/// Elements stored with byte codes: one data block of raw deltas a byte, as the simplest encoder would.
fn raw_stream(elements: &[u8], stride: usize) -> Vec<u8> {
    assert!(elements.len() / stride <= 16);
    let mut stream = vec![0xa0];
    for byte in 0..stride {
        stream.push(3);
        let mut previous = elements[byte];
        for index in 0..16 {
            let value = elements.get(index * stride + byte).copied().unwrap_or(previous);
            let delta = value.wrapping_sub(previous);
            stream.push((delta << 1) ^ (((delta as i8) >> 7) as u8));
            previous = value;
        }
    }
    stream.resize(stream.len() + 32usize.saturating_sub(stride), 0);
    stream.extend(&elements[..stride]);
    stream
}

#[test]
fn attributes_of_the_reference_encoder_decode() {
    let want: Vec<u8> = (0..20u8).flat_map(|i| [i, i * 5, if i == 7 { 200 } else { 3 }, i.wrapping_mul(97)]).collect();
    assert_eq!(decode(Mode::Attributes, Filter::None, 20, 4, ATTRIBUTES).unwrap(), want);
}

#[test]
fn triangles_of_the_reference_encoder_decode() {
    let want = [0, 1, 2, 2, 1, 3, 2, 3, 100, 0, 5, 2, 101, 7, 3, 5, 1000, 1];
    assert_eq!(u32s(&decode(Mode::Triangles, Filter::None, 18, 4, TRIANGLES).unwrap()), want);
    let narrow = decode(Mode::Triangles, Filter::None, 18, 2, TRIANGLES).unwrap();
    assert_eq!(narrow.chunks_exact(2).map(|b| u32::from(u16::from_le_bytes([b[0], b[1]]))).collect::<Vec<_>>(), want);
}

#[test]
fn indices_of_the_reference_encoder_decode() {
    assert_eq!(u32s(&decode(Mode::Indices, Filter::None, 6, 4, INDICES).unwrap()), [0, 1, 51, 2, 49, 1000]);
}

/// The example of appendix A, in front of nothing: 16 deltas in 4 bits each with two escapes.
#[test]
fn the_example_of_the_specification_decodes() {
    let group = [0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5];
    let mut stream = vec![0xa0, 2];
    stream.extend(group);
    stream.extend([0, 0, 0]); // the other three bytes of each element do not change
    stream.extend([0; 32]);
    let elements = decode(Mode::Attributes, Filter::None, 16, 4, &stream).unwrap();
    let mut sum = 0i8;
    for (element, delta) in elements.chunks_exact(4).zip([-1i8, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]) {
        sum = sum.wrapping_add(delta);
        assert_eq!(element, [sum as u8, 0, 0, 0]);
    }
}

#[test]
fn octahedral_filter_gives_unit_vectors() {
    let elements = [127, 0, 127, 9, 0, 0, 127, 8, (-127i8) as u8, 127, 127, 7, 64, 0, 127, 6];
    let out = decode(Mode::Attributes, Filter::Octahedral, 4, 4, &raw_stream(&elements, 4)).unwrap();
    assert_eq!(out[..4], [127, 0, 0, 9], "+x, the fourth component as it was");
    assert_eq!(out[4..8], [0, 0, 127, 8], "the middle is +z");
    assert_eq!(out[8..12], [0, 0, (-127i8) as u8, 7], "a corner is −z");
    assert_eq!(out[12..15], [91, 0, 89], "64 of 127 towards the border is just beyond 45°: (64, 63)/√(64² + 63²)");
}

/// A rotation of 90° about y is (0, √½, 0, √½): stored without w (component 3) as √2·(0, √½, 0) = (0, 1, 0), in 12 bits.
#[test]
fn quaternion_filter_restores_the_largest_component() {
    let stored: Vec<u8> = [0i16, 2047, 0, (2047 & !3) | 3].iter().flat_map(|v| v.to_le_bytes()).collect();
    let out = decode(Mode::Attributes, Filter::Quaternion, 1, 8, &raw_stream(&stored, 8)).unwrap();
    let out: Vec<i16> = out.chunks_exact(2).map(|b| i16::from_le_bytes([b[0], b[1]])).collect();
    // Component 3 is the largest; the stored ones follow it cyclically: x, y, z.
    assert_eq!(out, [0, 23170, 0, 23170]);
}

#[test]
fn exponential_filter_is_mantissa_times_power_of_two() {
    let word = |e: i32, m: i32| ((e << 24) | (m & 0xff_ffff)).to_le_bytes();
    let stored = [word(0, 5), word(-2, -3), word(10, 1)].concat();
    let out = decode(Mode::Attributes, Filter::Exponential, 1, 12, &raw_stream(&stored, 12)).unwrap();
    let out: Vec<f32> = u32s(&out).into_iter().map(f32::from_bits).collect();
    assert_eq!(out, [5.0, -0.75, 1024.0]);
}

#[test]
fn every_truncation_is_an_error() {
    for (mode, count, stream) in [(Mode::Attributes, 20, ATTRIBUTES), (Mode::Triangles, 18, TRIANGLES), (Mode::Indices, 6, INDICES)] {
        assert!(decode(mode, Filter::None, count, 4, stream).is_ok());
        for length in 0..stream.len() {
            assert!(decode(mode, Filter::None, count, 4, &stream[..length]).is_err(), "{mode:?} cut to {length} bytes");
        }
    }
}

#[test]
fn lying_counts_and_sizes_are_errors() {
    for (mode, stream) in [(Mode::Attributes, ATTRIBUTES), (Mode::Triangles, TRIANGLES), (Mode::Indices, INDICES)] {
        for count in [usize::MAX, usize::MAX / 3 * 3, 1 << 40, 3000] {
            assert!(decode(mode, Filter::None, count, 4, stream).is_err(), "{mode:?} with {count} elements");
        }
        for stride in [0, 3, 260, usize::MAX] {
            assert!(decode(mode, Filter::None, 6, stride, stream).is_err(), "{mode:?} with a stride of {stride}");
        }
    }
    assert!(decode(Mode::Triangles, Filter::None, 17, 4, TRIANGLES).is_err());
    assert!(decode(Mode::Indices, Filter::Octahedral, 6, 4, INDICES).is_err());
    assert!(decode(Mode::Attributes, Filter::Quaternion, 20, 4, ATTRIBUTES).is_err());
}

#[test]
fn indices_too_large_for_two_bytes_are_errors() {
    let stream = b"\xd1\x80\x80\x20\x00\x00\x00\x00"; // one index, 131072
    assert_eq!(u32s(&decode(Mode::Indices, Filter::None, 1, 4, stream).unwrap()), [131_072]);
    assert!(decode(Mode::Indices, Filter::None, 1, 2, stream).is_err());
}
