//! Where what the camera sees of lamps and sky has an edge.
//!
//! The edge of a lamp holds far more contrast than anything that it lights, so a few pixels along it have most of the noise that the eye and
//! the mean squared error see: one in a hundred pixels of the Cornell box has a quarter of it. Smoothing an edge takes camera rays alone, which
//! are cheap beside a path. So at these pixels [`EDGE_RAYS`] rays a sample look for lamps in the place of one. Which pixels they are is found by
//! one ray through the centre of each before the first sample, and known to no sample, so the mean stays what it is.

use crate::Integrator;
use crate::camera::CameraView;
use crate::integrator::{Context, Sink, Split, TracedRay};
use crate::pixels::BATCH;
use crate::world::Rays;
use glam::{UVec2, Vec2};
use kajo_sampling::hash_u64;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Camera rays that look for lamps, a sample.
pub(crate) const EDGE_RAYS: u32 = 8;

/// Difference of luminance within three by three pixels, over the greatest, that is an edge.
const CONTRAST: f32 = 0.5;

/// The same over the mean of the image: edges within a photographed sky, and those of bodies before it, are no brighter than the rest of the picture.
const PROMINENCE: f32 = 2.0;

/// The pixels with edges.
pub(crate) struct Edges {
    width: usize,
    pixels: Vec<bool>,
}

impl Edges {
    /// Number of rays that [`Edges::find`] traces: none where the integrator sees no light.
    pub(crate) fn rays(cx: &Context) -> u64 {
        let looks = cx.lights.can_be_met && matches!(cx.settings.integrator, Integrator::Path | Integrator::Direct);
        if looks { u64::from(cx.settings.size.x) * u64::from(cx.settings.size.y) } else { 0 }
    }

    /// `None` where there are none. `row` is called after every row of pixels, from any thread, and may end the search.
    pub(crate) fn find(cx: &Context, view: &CameraView, row: impl Fn() -> ControlFlow<()> + Sync) -> ControlFlow<(), Option<Self>> {
        if Self::rays(cx) == 0 {
            return ControlFlow::Continue(None);
        }
        let width = cx.settings.size.x as usize;
        let mut seen = vec![0.0; width * cx.settings.size.y as usize];
        seen.par_chunks_exact_mut(width).enumerate().try_for_each(|(y, pixels)| {
            see(cx, view, y as u32, pixels);
            row()
        })?;
        ControlFlow::Continue(Self::between(width, &seen))
    }

    /// The pixels of an image with edges around them.
    fn between(width: usize, seen: &[f32]) -> Option<Self> {
        let height = seen.len() / width;
        let prominent = PROMINENCE * seen.iter().sum::<f32>() / seen.len() as f32;
        let is_edge = |pixel: usize| {
            let (x, y) = (pixel % width, pixel / width);
            let rows = y.saturating_sub(1)..(y + 2).min(height);
            let columns = x.saturating_sub(1)..(x + 2).min(width);
            let around = rows.flat_map(|y| &seen[y * width..][columns.clone()]);
            let (low, high) = around.fold((f32::INFINITY, 0.0f32), |(low, high), &value| (low.min(value), high.max(value)));
            high - low > prominent.max(CONTRAST * high)
        };
        let pixels: Vec<bool> = (0..seen.len()).into_par_iter().map(is_edge).collect();
        pixels.contains(&true).then_some(Self { width, pixels })
    }

    #[inline]
    pub(crate) fn at(&self, pixel: UVec2) -> bool {
        self.pixels[pixel.y as usize * self.width + pixel.x as usize]
    }
}

/// Luminance of lamps and sky at the centres of a row of pixels.
fn see(cx: &Context, view: &CameraView, y: u32, row: &mut [f32]) {
    let (mut rays, mut hits) = (Rays::default(), Vec::new());
    for (first, chunk) in row.chunks_mut(BATCH).enumerate() {
        rays.clear();
        for x in 0..chunk.len() {
            let pixel = UVec2::new((first * BATCH + x) as u32, y);
            let ray = view.ray(pixel.as_vec2() + 0.5, Vec2::splat(0.5)).traced();
            rays.push(ray, hash_u64(u64::from(pixel.y) << 32 | u64::from(pixel.x)));
        }
        cx.world.closest_of(&rays, &mut hits);
        for (number, (luminance, &hit)) in chunk.iter_mut().zip(&hits).enumerate() {
            let mut sum = Luminance(0.0);
            cx.emission(TracedRay { ray: rays.ray(number), hit }, &mut sum);
            *luminance = sum.0;
        }
    }
}

struct Luminance(f32);

impl Sink for Luminance {
    fn light(&mut self, _bounces: u32, _light: u32, share: Split) {
        self.0 += share.total().luminance();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::scenes::{Stage, at, glowing, looking, mean, render_at, sized};
    use crate::{Frame, Settings};
    use glam::{Quat, Vec3};
    use kajo_sampling::SamplerKind;
    use kajo_scene::{LightShape, Material, Scene, Transform, shapes};
    use kajo_units::Meters;

    #[test]
    fn edges_are_where_neighbours_differ_and_nowhere_else() {
        let mut seen = vec![0.0; 7 * 5];
        seen[2 * 7 + 3] = 4.0;
        let edges = Edges::between(7, &seen).expect("an edge");
        for (x, y) in (0..5).flat_map(|y| (0..7).map(move |x| (x, y))) {
            assert_eq!(edges.at(UVec2::new(x, y)), (2..5).contains(&x) && (1..4).contains(&y), "{x} {y}");
        }
        let slope: Vec<f32> = (0..35).map(|pixel| 10.0 + (pixel % 7) as f32).collect();
        assert!(Edges::between(7, &slope).is_none() && Edges::between(7, &[0.0; 35]).is_none());
        // A bright half is no lamp, a bright pixel among others is one.
        let half: Vec<f32> = (0..35).map(|pixel| if pixel % 7 < 4 { 1.0 } else { 0.2 }).collect();
        assert!(Edges::between(7, &half).is_none());
        let sun: Vec<f32> = half.iter().enumerate().map(|(pixel, &sky)| if pixel == 16 { 100.0 } else { sky }).collect();
        assert!(Edges::between(7, &sun).is_some_and(|edges| edges.at(UVec2::new(2, 2)) && !edges.at(UVec2::new(5, 2))));
    }

    /// Emission alone, by several seeds: for each its mean, and the mean squared error of a picture.
    fn emission(scene: &Scene, integrator: Integrator, sampler: SamplerKind) -> (Vec<f64>, f64) {
        let settings = |seed| Settings { integrator, sampler, seed, max_depth: 0, ..sized(32, 32) };
        let frames: Vec<Frame> = (0..16).map(|seed| render_at(scene, &settings(seed), 16)).collect();
        let count = frames.len() as f64;
        let mut error = 0.0;
        for (x, y) in (0..32).flat_map(|y| (0..32).map(move |x| (x, y))) {
            let values = frames.iter().map(|frame| f64::from(frame.beauty().get(x, y).luminance()));
            let center = values.clone().sum::<f64>() / count;
            error += values.map(|value| (value - center).powi(2)).sum::<f64>() / (count - 1.0) / (32.0 * 32.0);
        }
        (frames.iter().map(mean).collect(), error)
    }

    /// Lamps of every kind before a dim sky, against rays that look once a sample.
    #[test]
    fn edges_of_lamps_have_less_noise_and_the_same_mean() {
        let lamp = shapes::rectangle(0.5, 0.5);
        let turned = Transform::Trs { translation: Vec3::X * 0.6, rotation: Quat::from_rotation_z(0.3), scale: Vec3::ONE };
        let scene = Stage::default()
            .light(
                LightShape::Rectangle { width: Meters(0.5), height: Meters(0.5) },
                5.0,
                looking(-0.6 * Vec3::X, Vec3::new(-0.5, 0.1, 1.0)),
            )
            .light(LightShape::Sphere { radius: Meters(0.25) }, 5.0, at(Vec3::ZERO))
            .mesh(lamp, Material { double_sided: true, ..glowing(5.0, 0.0) }, turned)
            .environment(0.1)
            .perspective(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, 60.0)
            .0;
        for sampler in [SamplerKind::Sobol, SamplerKind::Independent] {
            let (means, error) = emission(&scene, Integrator::Path, sampler);
            let (once, error_once) = emission(&scene, Integrator::BsdfOnly, sampler);
            // Independent samples: one eighth. Sobol points: 8 to the power of 3/2.
            let least = if sampler == SamplerKind::Sobol { 12.0 } else { 6.0 };
            assert!(error_once > least * error, "{sampler:?}: {error_once} over {error}");
            let moments = |values: &[f64]| {
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                let scatter = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
                (mean, scatter / (values.len() * (values.len() - 1)) as f64)
            };
            let ((a, variance_a), (b, variance_b)) = (moments(&means), moments(&once));
            let z = (a - b).abs() / (variance_a + variance_b).sqrt();
            assert!(a > 0.3 && z < 4.0, "{sampler:?}: {a} and {b}, {z} standard errors");
            assert!((1.05 * a - b).abs() > 4.0 * (variance_a + variance_b).sqrt(), "planted fault: five per cent more is seen");
        }
    }
}
