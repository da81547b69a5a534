//! Pixels: lines by their distance, text by an 8 × 8 font.

use super::{Anchor, Canvas};
use font8x8::UnicodeFonts;

/// RGB, row by row from the top.
pub(super) struct Raster {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

/// Width and height of a letter, pixels.
const LETTER: f64 = 8.0;

impl Raster {
    pub fn new([width, height]: [f64; 2]) -> Self {
        let (width, height) = (width as usize, height as usize);
        Self { width, height, pixels: vec![255; width * height * 3] }
    }

    pub fn finish(self) -> Vec<u8> {
        let mut out = Vec::new();
        let mut encoder = png::Encoder::new(&mut out, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder
            .write_header()
            .and_then(|mut writer| writer.write_image_data(&self.pixels))
            .expect("memory takes a picture whose size fits its pixels");
        out
    }

    fn blend(&mut self, x: usize, y: usize, colour: [u8; 3], share: f64) {
        if x < self.width && y < self.height {
            for (channel, ink) in colour.into_iter().enumerate() {
                let pixel = &mut self.pixels[(y * self.width + x) * 3 + channel];
                *pixel = (f64::from(*pixel) * (1.0 - share) + f64::from(ink) * share).round() as u8;
            }
        }
    }
}

impl Canvas for Raster {
    fn line(&mut self, points: &[[f64; 2]], colour: [u8; 3], width: f64) {
        // A pixel is covered once, by the nearest segment, however many end in it.
        let mut cover = std::collections::BTreeMap::<(usize, usize), f64>::new();
        for pair in points.windows(2) {
            let ([x0, y0], [x1, y1]) = (pair[0], pair[1]);
            let reach = width / 2.0 + 1.0;
            let span = |a: f64, b: f64, size: usize| {
                let from = (a.min(b) - reach).floor().clamp(0.0, size as f64) as usize;
                from..((a.max(b) + reach).ceil().clamp(0.0, size as f64) as usize)
            };
            let length2 = (x1 - x0).powi(2) + (y1 - y0).powi(2);
            for y in span(y0, y1, self.height) {
                for x in span(x0, x1, self.width) {
                    let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                    let along = (((px - x0) * (x1 - x0) + (py - y0) * (y1 - y0)) / length2.max(1e-12)).clamp(0.0, 1.0);
                    let distance = (px - x0 - along * (x1 - x0)).hypot(py - y0 - along * (y1 - y0));
                    let share = (width / 2.0 + 0.5 - distance).clamp(0.0, 1.0);
                    let most = cover.entry((x, y)).or_default();
                    *most = most.max(share);
                }
            }
        }
        for ((x, y), share) in cover {
            self.blend(x, y, colour, share);
        }
    }

    fn cell(&mut self, area: [f64; 4], colour: [u8; 3]) {
        let [left, top, right, bottom] = area.map(|edge| edge.round().max(0.0) as usize);
        for y in top..bottom {
            for x in left..right {
                self.blend(x, y, colour, 1.0);
            }
        }
    }

    fn text(&mut self, [x, y]: [f64; 2], text: &str, anchor: Anchor, upwards: bool) {
        let length = text.chars().count() as f64 * LETTER;
        let start = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -length / 2.0,
            Anchor::End => -length,
        };
        for (k, letter) in text.chars().enumerate() {
            let glyph = font8x8::BASIC_FONTS.get(letter).unwrap_or([0x7e; 8]);
            for (row, bits) in glyph.into_iter().enumerate() {
                for column in (0..8).filter(|column| bits >> column & 1 == 1) {
                    let along = start + k as f64 * LETTER + f64::from(column);
                    let down = row as f64 - LETTER / 2.0;
                    let (px, py) = if upwards { (x + down, y - along) } else { (x + along, y + down) };
                    self.blend(px.max(0.0) as usize, py.max(0.0) as usize, super::INK, 1.0);
                }
            }
        }
    }
}
