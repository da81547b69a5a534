use super::*;
use crate::test_images::{noise8, scene, with_noise};
use glam::UVec2;
use kajo_units::Srgb8;

const SIZE: UVec2 = UVec2::new(64, 48);

fn decoded(image: &Image<Srgb8>) -> Image<LinearRgb> {
    image.map(|p| p.to_linear())
}

/// Pairs of 8-bit pictures: noise, moved edges, added noise, a colour cast, opposites.
fn pairs() -> Vec<(&'static str, Image<Srgb8>, Image<Srgb8>)> {
    let eight = |image: Image<LinearRgb>| image.map(|p| p.to_srgb8());
    let reference = scene(SIZE, 0.0);
    vec![
        ("noise", noise8(SIZE, 1), noise8(SIZE, 2)),
        ("moved", eight(scene(SIZE, 3.0)), eight(reference.clone())),
        ("noisy", eight(with_noise(&reference, 0.05, 9)), eight(reference.clone())),
        ("cast", eight(reference.map(|p| LinearRgb::new(p[0] * 0.9, p[1], p[2] * 1.05))), eight(reference.clone())),
        ("opposite", eight(reference.map(|_| LinearRgb::WHITE)), eight(reference.map(|_| LinearRgb::BLACK))),
    ]
}

/// Means, and pixels 0, 700, 1500, 2222, 3071 of the maps that NVIDIA's implementation (nv-flip 0.1.2) gives for [`pairs`].
const NVIDIA: [(f64, [f32; 5]); 5] = [
    (0.470_667_125_9, [0.599_230_65, 0.347_162_43, 0.318_172_3, 0.245_265_36, 0.567_107_86]),
    (0.122_282_672_4, [0.0, 0.000_639_899_17, 0.744_740_9, 0.038_886_584, 0.0]),
    (0.103_802_210_9, [0.047_532_313, 0.097_686_276, 0.130_247_8, 0.092_818_23, 0.181_771_19]),
    (0.127_926_206_6, [0.087_964_1, 0.167_723_91, 0.092_177_01, 0.155_199_66, 0.168_005_56]),
    (0.967_387_855_1, [0.967_387_86; 5]),
];

#[test]
fn ldr_map_is_that_of_the_authors() {
    for ((name, image, reference), (expected, pixels)) in pairs().into_iter().zip(NVIDIA) {
        let map = flip(&decoded(&image), &decoded(&reference), PIXELS_PER_DEGREE).unwrap();
        assert!((mean(&map) - expected).abs() < 1e-5, "{name}: {} for {expected}", mean(&map));
        for (index, pixel) in [0, 700, 1500, 2222, 3071].into_iter().zip(pixels) {
            assert!((map.pixels()[index] - pixel).abs() < 1e-4, "{name}, pixel {index}: {} for {pixel}", map.pixels()[index]);
        }
    }
}

/// Every pixel, also of a photograph when the assets are there, and at another viewing distance.
#[cfg(feature = "nv-flip")]
#[test]
fn ldr_map_is_that_of_the_authors_at_every_pixel() {
    let mut pairs = pairs();
    let assets = std::env::var_os("KAJO_ASSETS").unwrap_or_else(|| "../../../shared/assets".into());
    match kajo_image::read_image(&std::path::Path::new(&assets).join("AnisotropyBarnLamp/AnisotropyBarnLamp_basecolor.jpeg")) {
        Ok(photo) => {
            let part = |shift: u32| Image::from_fn(UVec2::splat(256), |x, y| photo.get(x + 500 + shift, y + 700).to_srgb8());
            pairs.push(("photograph", part(2), part(0)));
        }
        Err(error) => eprintln!("skipped: {error}; set KAJO_ASSETS"),
    }
    for (name, image, reference) in pairs {
        for pixels_per_degree in [PIXELS_PER_DEGREE, 30.0] {
            let theirs = |i: &Image<Srgb8>| nv_flip::FlipImageRgb8::with_data(i.width(), i.height(), bytemuck::cast_slice(i.pixels()));
            let expected = nv_flip::flip(theirs(&reference), theirs(&image), pixels_per_degree).to_vec();
            let map = flip(&decoded(&image), &decoded(&reference), pixels_per_degree).unwrap();
            let worst = map.pixels().iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0f32, f32::max);
            assert!(worst < 3e-4, "{name} at {pixels_per_degree} px/degree: {worst}");
        }
    }
}

#[test]
fn equal_is_zero_and_opposite_is_near_one() {
    let image = scene(SIZE, 0.0);
    assert_eq!(mean(&flip(&image, &image, PIXELS_PER_DEGREE).unwrap()), 0.0);
    let (black, white) = (image.map(|_| LinearRgb::BLACK), image.map(|_| LinearRgb::WHITE));
    assert!(mean(&flip(&black, &white, PIXELS_PER_DEGREE).unwrap()) > 0.96);
}

#[test]
fn planted_faults_are_seen() {
    let image = scene(SIZE, 0.0);
    let swapped = image.map(|p| LinearRgb::new(p[2], p[1], p[0]));
    assert!(mean(&flip(&swapped, &image, PIXELS_PER_DEGREE).unwrap()) > 0.2);
    assert!(mean(&flip(&scene(SIZE, 3.0), &image, PIXELS_PER_DEGREE).unwrap()) > 0.05);
}
