//! What the denoiser keeps and what it takes, on pictures whose truth is known; worse filters must fail the same tests.

use crate::{DenoiseError, Input, Tile, denoise, planes, tile};
use glam::{UVec2, Vec3};
use kajo_image::Image;
use kajo_sampling::Rng;
use kajo_units::LinearRgb;

const SIZE: UVec2 = UVec2::new(96, 64);

/// A picture with its truth.
struct Scene {
    truth: Image<LinearRgb>,
    color: Image<LinearRgb>,
    emission: Image<LinearRgb>,
    variance: Image<LinearRgb>,
    coverage: Image<f32>,
    albedo: Image<LinearRgb>,
    normal: Image<Vec3>,
    depth: Image<f32>,
}

/// Left and right half are surfaces of different normal and depth; the upper half of each has a texture of stripes 2 px wide. Light falls off to the
/// right, and a shadow edge without any feature crosses at the diagonal.
fn truth(x: u32, y: u32) -> (LinearRgb, LinearRgb, Vec3, f32) {
    let left = x < SIZE.x / 2;
    let stripe = y < SIZE.y / 2 && (x / 2).is_multiple_of(2);
    let albedo = if stripe { LinearRgb::new(0.8, 0.2, 0.1) } else { LinearRgb::new(0.4, 0.5, 0.3) };
    let light = if left { 1.0 } else { 0.4 } * (1.2 - x as f32 / SIZE.x as f32) * if lit(x, y) { 1.0 } else { 0.3 };
    (albedo * light, albedo, if left { Vec3::Z } else { Vec3::X }, if left { 2.0 } else { 3.0 })
}

fn lit(x: u32, y: u32) -> bool {
    x > y
}

/// `samples` of each pixel are exponentially distributed: mean μ, variance μ².
fn scene(samples: u32, seed: u64) -> Scene {
    let mut rng = Rng::new(seed);
    let truth_image = Image::from_fn(SIZE, |x, y| truth(x, y).0);
    let mut moments = |mean: f32| {
        let draws: Vec<f32> = (0..samples).map(|_| -mean * (1.0 - rng.next_1d()).ln()).collect();
        let average = draws.iter().sum::<f32>() / samples as f32;
        let scatter = draws.iter().map(|d| (d - average).powi(2)).sum::<f32>() / (samples as f32 - 1.0);
        (average, if samples > 1 { scatter / samples as f32 } else { f32::INFINITY })
    };
    let noisy: Vec<[(f32, f32); 3]> = truth_image.pixels().iter().map(|c| c.0.to_array().map(&mut moments)).collect();
    let image = |pick: fn(&(f32, f32)) -> f32| {
        Image::from_pixels(SIZE, noisy.iter().map(|p| LinearRgb(Vec3::from_array([0, 1, 2].map(|c| pick(&p[c]))))).collect())
    };
    Scene {
        color: image(|p| p.0),
        emission: Image::from_fn(SIZE, |_, _| LinearRgb::BLACK),
        variance: image(|p| p.1),
        coverage: Image::from_fn(SIZE, |_, _| 1.0),
        albedo: Image::from_fn(SIZE, |x, y| truth(x, y).1),
        normal: Image::from_fn(SIZE, |x, y| truth(x, y).2),
        depth: Image::from_fn(SIZE, |x, y| truth(x, y).3),
        truth: truth_image,
    }
}

impl Scene {
    fn input(&self) -> Input<'_> {
        Input {
            color: &self.color,
            emission: &self.emission,
            variance: &self.variance,
            coverage: &self.coverage,
            albedo: &self.albedo,
            normal: &self.normal,
            depth: &self.depth,
        }
    }

    fn denoised(&self) -> Image<LinearRgb> {
        denoise(&self.input()).unwrap()
    }

    /// Mean squared error of an image over that of the noisy picture.
    fn error_left(&self, image: &Image<LinearRgb>) -> f64 {
        let error = |image: &Image<LinearRgb>| -> f64 {
            let pairs = image.pixels().iter().zip(self.truth.pixels());
            pairs.map(|(a, b)| f64::from((a.0 - b.0).length_squared())).sum()
        };
        error(image) / error(&self.color)
    }

    /// Contrast between the columns left and right of the edge between the surfaces, below the texture, relative to the true one.
    fn edge_contrast(&self, image: &Image<LinearRgb>) -> f64 {
        let contrast = |image: &Image<LinearRgb>| -> f64 {
            let rows = SIZE.y / 2..SIZE.y;
            rows.map(|y| f64::from(image.get(SIZE.x / 2 - 1, y).luminance() - image.get(SIZE.x / 2, y).luminance())).sum()
        };
        contrast(image) / contrast(&self.truth)
    }

    /// The same between neighbouring stripes of the texture.
    fn texture_contrast(&self, image: &Image<LinearRgb>) -> f64 {
        let contrast = |image: &Image<LinearRgb>| -> f64 {
            let red = |x, y| f64::from(image.get(x, y)[0]);
            (2..SIZE.y / 2 - 2)
                .flat_map(|y| (8..SIZE.x / 2 - 8).step_by(4).map(move |x| (x, y)))
                .map(|(x, y)| red(x, y) - red(x + 2, y))
                .sum()
        };
        contrast(image) / contrast(&self.truth)
    }

    fn mean_ratio(&self, image: &Image<LinearRgb>) -> f64 {
        let mean = |image: &Image<LinearRgb>| image.pixels().iter().map(|p| f64::from(p.0.element_sum())).sum::<f64>();
        mean(image) / mean(&self.truth)
    }
}

/// The mean of 5 × 5 pixels: the planted fault.
fn blurred(image: &Image<LinearRgb>) -> Image<LinearRgb> {
    Image::from_fn(image.size(), |x, y| {
        let around: Vec<_> = crate::around(image.size(), x, y, 2).collect();
        around.iter().fold(LinearRgb::BLACK, |sum, &(x, y)| sum + *image.get(x, y)) * (1.0 / around.len() as f32)
    })
}

#[test]
fn error_falls_by_much_at_every_number_of_samples() {
    for (samples, limit) in [(1, 0.25), (4, 0.15), (16, 0.15), (64, 0.2)] {
        let scene = scene(samples, 1);
        let left = scene.error_left(&scene.denoised());
        assert!(left < limit, "{samples} samples: {left} of the error is left");
    }
}

#[test]
fn edges_textures_and_energy_are_kept_where_a_blur_loses_them() {
    let scene = scene(16, 2);
    let (ours, blur) = (scene.denoised(), blurred(&scene.color));
    let (edge, texture, mean) = (scene.edge_contrast(&ours), scene.texture_contrast(&ours), scene.mean_ratio(&ours));
    assert!((edge - 1.0).abs() < 0.1 && (texture - 1.0).abs() < 0.1 && (mean - 1.0).abs() < 0.01, "{edge} {texture} {mean}");
    assert!(scene.edge_contrast(&blur) < 0.5 && scene.texture_contrast(&blur) < 0.5, "a blur must fail");
    let dimmed = ours.map(|&c| c * 0.97);
    assert!((scene.mean_ratio(&dimmed) - 1.0).abs() > 0.01, "lost energy must fail");
}

#[test]
fn without_features_the_edges_that_only_they_show_are_lost() {
    let mut scene = scene(1, 3);
    let with = scene.texture_contrast(&scene.denoised());
    scene.albedo = scene.albedo.map(|_| LinearRgb::splat(0.5));
    let without = scene.texture_contrast(&scene.denoised());
    assert!(without < 0.8 * with, "{without} {with}");
}

#[test]
fn a_picture_without_noise_stays_as_it_is() {
    let mut scene = scene(4, 4);
    scene.color = scene.truth.clone();
    scene.variance = scene.variance.map(|_| LinearRgb::BLACK);
    for (a, b) in scene.denoised().pixels().iter().zip(scene.truth.pixels()) {
        assert!((a.0 - b.0).abs().max_element() < 1e-4, "{a:?} {b:?}");
    }
}

#[test]
fn light_that_comes_straight_from_a_lamp_does_not_bleed() {
    let mut scene = scene(4, 8);
    let lamp = |x: u32, y: u32| (30..40).contains(&x) && (40..44).contains(&y);
    let before = scene.denoised();
    scene.emission = Image::from_fn(SIZE, |x, y| LinearRgb::splat(if lamp(x, y) { 500.0 } else { 0.0 }));
    for ((color, emission), variance) in scene.color.pixels_mut().iter_mut().zip(scene.emission.pixels()).zip(scene.variance.pixels_mut()) {
        *color += *emission;
        *variance += *emission * 100.0;
    }
    let after = scene.denoised();
    for y in 0..SIZE.y {
        for x in 0..SIZE.x {
            let (light, expected) = (after.get(x, y).0, before.get(x, y).0 + scene.emission.get(x, y).0);
            assert!((light - expected).abs().max_element() < 0.1, "{light} and {expected} at {x}, {y}");
        }
    }
    let blur = blurred(&scene.color);
    assert!(blur.get(29, 42).0.x > 10.0, "a blur must fail");
}

#[test]
fn every_processor_has_the_same_bits() {
    let scene = scene(4, 5);
    let planes = planes(&scene.input(), 1.0);
    for tile in Tile::cover(SIZE) {
        let chosen = tile::filter(&planes, tile);
        for (path, pixels) in tile::by_every_path(&planes, tile) {
            assert!(pixels == chosen, "{path}");
        }
    }
}

/// A body before nothing, whose silhouette fills half of the pixels of a column: half of their light is left after filtering. Features that do not know how much
/// is covered make it whole.
#[test]
fn silhouettes_keep_their_share_of_light() {
    let edge = SIZE.x / 2;
    let mut scene = scene(8, 9);
    let share = |x: u32| if x < edge { 1.0 } else { f32::from(u8::from(x == edge)) * 0.5 };
    let light = |y: u32| 0.5 + 0.5 * y as f32 / SIZE.y as f32;
    let mut rng = Rng::new(10);
    scene.truth = Image::from_fn(SIZE, |x, y| LinearRgb::splat(share(x) * light(y)));
    scene.variance = Image::from_fn(SIZE, |x, y| LinearRgb::splat(0.3 * (share(x) * light(y)).powi(2)));
    // Uniform noise of that variance.
    scene.color = Image::from_fn(SIZE, |x, y| *scene.truth.get(x, y) * (1.0 + (rng.next_1d() - 0.5) * (12.0f32 * 0.3).sqrt()));
    scene.coverage = Image::from_fn(SIZE, |x, _| share(x));
    let covers = |x: u32| f32::from(u8::from(x <= edge));
    scene.albedo = Image::from_fn(SIZE, |x, _| LinearRgb::splat(0.5 * covers(x)));
    scene.normal = Image::from_fn(SIZE, |x, _| Vec3::Z * covers(x));
    scene.depth = Image::from_fn(SIZE, |x, _| 2.0 * covers(x));
    let of_edge = |scene: &Scene| {
        let image = scene.denoised();
        let column = |image: &Image<LinearRgb>| (0..SIZE.y).map(|y| f64::from(image.get(edge, y)[0])).sum::<f64>();
        column(&image) / column(&scene.truth)
    };
    let kept = of_edge(&scene);
    scene.coverage = scene.coverage.map(|share| share.ceil());
    let wrong = of_edge(&scene);
    assert!((kept - 1.0).abs() < 0.05 && wrong > 1.15, "{kept}, and {wrong} with the planted fault");
}

#[test]
fn pictures_of_any_size_and_brightness_have_finite_answers() {
    for (size, scale) in
        [(UVec2::ONE, 1.0), (UVec2::new(3, 2), 1e12), (UVec2::new(65, 17), 1e-12), (UVec2::new(1, 40), 0.0), (UVec2::new(20, 20), 1e36)]
    {
        let color = Image::from_fn(size, |x, y| LinearRgb::splat((x * 7 + y * 3) as f32 * scale));
        for variance in [0.0, scale * scale, f32::INFINITY] {
            let variance = color.map(|_| LinearRgb::splat(variance));
            let (normal, depth) = (color.map(|_| Vec3::ZERO), color.map(|_| 0.0));
            let black = color.map(|_| LinearRgb::BLACK);
            let coverage = &depth;
            let input =
                Input { color: &color, emission: &black, variance: &variance, coverage, albedo: &black, normal: &normal, depth: &depth };
            let image = denoise(&input).unwrap();
            assert!(image.size() == size && image.pixels().iter().all(|p| p.is_finite()), "{size} {scale}");
        }
    }
}

#[test]
fn images_that_do_not_belong_together_are_refused() {
    let (mut a, b) = (scene(4, 6), scene(4, 7));
    let small = Image::from_fn(UVec2::ONE, |_, _| 1.0);
    let message = denoise(&Input { depth: &small, ..b.input() }).unwrap_err().to_string();
    assert!(message.contains("`depth` has 1x1 px and the picture 96x64"), "{message}");
    a.color.pixels_mut()[5].0.y = f32::NAN;
    assert!(matches!(denoise(&a.input()), Err(DenoiseError::NotFinite { what: "color" })));
}
