//! Filters of decoded attributes.    \[EXT_meshopt], appendix B
//!
//! Values whose result the specification leaves open (a "one" of 0, exponents beyond ±100) give some value, never a panic.

use super::{Filter, Malformed};

/// Whether a filter can be applied to elements of this size.
pub fn check(filter: Filter, stride: usize) -> Result<(), Malformed> {
    match filter {
        Filter::Octahedral if stride != 4 && stride != 8 => Err("byteStride of the filter OCTAHEDRAL must be 4 or 8"),
        Filter::Quaternion if stride != 8 => Err("byteStride of the filter QUATERNION must be 8"),
        _ => Ok(()),
    }
}

/// Applies a filter to elements of `stride` bytes.
pub fn apply(filter: Filter, stride: usize, elements: &mut [u8]) {
    match filter {
        Filter::None => {}
        Filter::Octahedral if stride == 4 => {
            for element in elements.chunks_exact_mut(4) {
                let [x, y, one] = [0, 1, 2].map(|i| f32::from(element[i] as i8));
                let unit = octahedral(x, y, one);
                for (byte, value) in element.iter_mut().zip(unit) {
                    *byte = (value * 127.0).round() as i8 as u8;
                }
            }
        }
        Filter::Octahedral => each_i16x4(elements, |[x, y, one, w]| {
            let [x, y, z] = octahedral(f32::from(x), f32::from(y), f32::from(one)).map(snorm16);
            [x, y, z, w]
        }),
        Filter::Quaternion => each_i16x4(elements, quaternion),
        Filter::Exponential => {
            for word in elements.chunks_exact_mut(4) {
                let bits = i32::from_le_bytes([word[0], word[1], word[2], word[3]]);
                let value = f64::from(bits << 8 >> 8) * f64::from(bits >> 24).exp2();
                word.copy_from_slice(&(value as f32).to_le_bytes());
            }
        }
    }
}

fn each_i16x4(elements: &mut [u8], filter: impl Fn([i16; 4]) -> [i16; 4]) {
    for element in elements.chunks_exact_mut(8) {
        let input = [0, 1, 2, 3].map(|i| i16::from_le_bytes([element[2 * i], element[2 * i + 1]]));
        for (bytes, value) in element.chunks_exact_mut(2).zip(filter(input)) {
            bytes.copy_from_slice(&value.to_le_bytes());
        }
    }
}

fn snorm16(value: f32) -> i16 {
    (value * 32767.0).round() as i16
}

/// The unit vector at (x, y) / one of the octahedral map; the lower half is folded outwards.    \[Cigolle14] section 3
fn octahedral(x: f32, y: f32, one: f32) -> [f32; 3] {
    let (x, y) = (x / one, y / one);
    let z = 1.0 - x.abs() - y.abs();
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

/// The largest component follows from the other three, which are stored times √2; its place is in the lowest two bits of the fourth number.
fn quaternion([x, y, z, one]: [i16; 4]) -> [i16; 4] {
    let scale = std::f32::consts::FRAC_1_SQRT_2 / f32::from(one | 3);
    let [x, y, z] = [x, y, z].map(|component| f32::from(component) * scale);
    let largest = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let mut out = [0; 4];
    for (offset, value) in [largest, x, y, z].into_iter().enumerate() {
        out[((one & 3) as usize + offset) % 4] = snorm16(value);
    }
    out
}
