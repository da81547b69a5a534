//! Numbers and pictures for people.

use crate::report::short;
use base64::Engine;
use kajo_image::{Image, encode_png};
use kajo_units::Srgb8;
use std::collections::BTreeMap;

/// What stands for a number that was not measured.
pub const NONE: &str = "–";

/// Three digits, or a dash.
pub fn number(value: Option<f64>) -> String {
    value.map_or_else(|| NONE.into(), short)
}

/// A share as percent: `0 %`, `0.012 %`, `4.5 %`.
pub fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| NONE.into(), |v| format!("{} %", short(100.0 * v)))
}

/// Bytes with a binary prefix.
pub fn bytes(value: u64) -> String {
    match value {
        0..1024 => format!("{value} B"),
        1024..1_048_576 => format!("{} KiB", short(value as f64 / 1024.0)),
        1_048_576..1_073_741_824 => format!("{} MiB", short(value as f64 / 1_048_576.0)),
        _ => format!("{} GiB", short(value as f64 / 1_073_741_824.0)),
    }
}

/// Counts with a decimal prefix: 1.9 G.
pub fn count(value: u64) -> String {
    match value {
        0..10_000 => value.to_string(),
        10_000..1_000_000 => format!("{} k", short(value as f64 / 1e3)),
        1_000_000..1_000_000_000 => format!("{} M", short(value as f64 / 1e6)),
        _ => format!("{} G", short(value as f64 / 1e9)),
    }
}

/// A duration.
pub fn seconds(value: f64) -> String {
    match value {
        ..1.0 => format!("{} ms", short(value * 1e3)),
        1.0..120.0 => format!("{} s", short(value)),
        120.0..7200.0 => format!("{} min", short(value / 60.0)),
        _ => format!("{} h", short(value / 3600.0)),
    }
}

/// Widest picture that a page embeds, px; the files beside it have every pixel.
const MAX_WIDTH: u32 = 960;

/// `data:` address of a picture, reduced by whole factors to at most [`MAX_WIDTH`].
pub fn data_uri(image: &Image<Srgb8>) -> String {
    let factor = image.width().div_ceil(MAX_WIDTH);
    let png = if factor > 1 { encode_png(&reduced(image, factor), &BTreeMap::new()) } else { encode_png(image, &BTreeMap::new()) };
    let png = png.expect("pictures of the report are not empty");
    format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(png))
}

/// Means of `factor × factor` pixels, in linear light.
fn reduced(image: &Image<Srgb8>, factor: u32) -> Image<Srgb8> {
    let size = (image.size() / factor).max(glam::UVec2::ONE);
    Image::from_fn(size, |x, y| {
        let pixels = (0..factor).flat_map(|v| (0..factor).map(move |u| (x * factor + u, y * factor + v)));
        let inside: Vec<_> = pixels.filter(|&(u, v)| u < image.width() && v < image.height()).collect();
        let sum: kajo_units::LinearRgb = inside.iter().map(|&(u, v)| image.get(u, v).to_linear()).sum();
        (sum / inside.len() as f32).to_srgb8()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn units_are_readable() {
        assert_eq!(bytes(0), "0 B");
        assert_eq!(bytes(16 << 20), "16 MiB");
        assert_eq!(count(1_900_000_000), "1.9 G");
        assert_eq!(seconds(0.25), "250 ms");
        assert_eq!(seconds(300.0), "5 min");
        assert_eq!(percent(Some(0.000_12)), "0.012 %");
        assert_eq!(number(None), "–");
    }

    #[test]
    fn wide_pictures_are_reduced_and_keep_their_mean() {
        let wide = Image::from_fn(UVec2::new(1920, 2), |x, _| Srgb8([if x % 2 == 0 { 255 } else { 0 }; 3]));
        let small = reduced(&wide, 2);
        assert_eq!(small.size(), UVec2::new(960, 1));
        assert!(small.pixels().iter().all(|p| *p == Srgb8([188; 3])), "half the light is sRGB 188");
        assert!(data_uri(&wide).starts_with("data:image/png;base64,iVBOR"));
    }
}
