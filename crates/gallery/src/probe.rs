//! Reads models off rendered pixels: along a sphere's great circle, at one pair of directions, under a white sky.
//!
//! A sphere under a parallel camera and a parallel light shows one pair of directions under every normal. A row of pixels through its centre
//! and towards the light, sampled at pixel centres, is the model along the plane of incidence, to the facets of the sphere.

use crate::GalleryError;
use crate::stage::{Ball, IRRADIANCE, Stage, Sun, toward};
use glam::{DVec3, UVec2, Vec3};
use kajo_bsdf::models::V3;
use kajo_path_tracer::{Filter, Integrator, Settings};

/// Pixels of a row across the sphere.
const PIXELS: u32 = 1601;
/// Closer to the outline, facets show.
const LEAST_COSINE: f64 = 0.05;

/// What one pixel shows, in the local frame of the surface: z normal, x east, y north.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Angle from the half vector to the normal, degrees; positive towards the light.
    pub tilt: f64,
    /// To the light.
    pub wi: DVec3,
    /// To the viewer.
    pub wo: DVec3,
    /// Radiance/(irradiance cos θ_i), 1/sr.
    pub f: DVec3,
    /// Radiance as the pixel has it.
    pub radiance: DVec3,
}

impl Sample {
    /// δ, from the half vector to the normal, rad.
    pub fn delta(&self) -> f64 {
        self.half().z.clamp(-1.0, 1.0).acos()
    }

    /// Half vector.
    pub fn half(&self) -> DVec3 {
        (self.wi + self.wo).normalize()
    }

    /// cos θ_i, cos θ_r.
    pub fn cosines(&self) -> [f64; 2] {
        [self.wi.z, self.wo.z]
    }
}

/// The lobe probe: a row of pixels across the sphere in the plane of camera and light, for a light 30° off the axis at `azimuth`.
/// Only pixels that see the surface well above its horizon and are lit.
pub fn strip(ball: &Ball, azimuth: f32) -> Result<Vec<Sample>, GalleryError> {
    let sun = Sun { off_axis: 30.0, azimuth };
    let center = Vec3::Y;
    let right = Vec3::new(azimuth.to_radians().cos(), azimuth.to_radians().sin(), 0.0);
    let up = Vec3::Z.cross(right);
    let height = 2.0 / PIXELS as f32;
    let stage = Stage::row(std::slice::from_ref(ball)).sun(sun).orthographic(center + Vec3::Z * 5.0, center, up, height);
    let image = stage.direct(UVec2::new(PIXELS, 1))?;
    let (light, right) = (toward(sun).as_dvec3(), right.as_dvec3());
    let half = (light + DVec3::Z).normalize();
    let sample = |i: u32| {
        let x = (f64::from(i) + 0.5) / f64::from(PIXELS) * 2.0 - 1.0;
        let normal = right * x + DVec3::Z * (1.0 - x * x).sqrt();
        let radiance = image.get(i, 0).0.as_dvec3();
        read(normal, light, DVec3::Z, radiance, (x.asin() - half.dot(right).asin()).to_degrees())
    };
    Ok((0..PIXELS).map(sample).filter(|sample| sample.cosines().into_iter().all(|cos| cos > LEAST_COSINE)).collect())
}

/// The same for every pixel of the disc that the sphere fills, for a light to the right; tilts are δ.
pub fn disc(ball: &Ball) -> Result<Vec<Sample>, GalleryError> {
    const SIDE: u32 = 301;
    let sun = Sun { off_axis: 30.0, azimuth: 0.0 };
    let stage = Stage::row(std::slice::from_ref(ball)).sun(sun).orthographic(Vec3::new(0.0, 1.0, 5.0), Vec3::Y, Vec3::Y, 2.0);
    let image = stage.direct(UVec2::splat(SIDE))?;
    let light = toward(sun).as_dvec3();
    let along = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE) * 2.0 - 1.0;
    let sample = |(i, j): (u32, u32)| {
        let [x, y] = [along(i), -along(j)];
        let normal = DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt());
        let sample = read(normal, light, DVec3::Z, image.get(i, j).0.as_dvec3(), 0.0);
        Sample { tilt: sample.delta().to_degrees(), ..sample }
    };
    let pixels = (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j)));
    let inside = pixels.filter(|&(i, j)| along(i).hypot(along(j)) < 0.999).map(sample);
    Ok(inside.filter(|sample| sample.cosines().into_iter().all(|cos| cos > LEAST_COSINE)).collect())
}

/// Directions in the frame of a point of the sphere, whose tangent points east.
fn read(normal: DVec3, light: DVec3, viewer: DVec3, radiance: DVec3, tilt: f64) -> Sample {
    let east = DVec3::Y.cross(normal).normalize_or(DVec3::X);
    let local = |w: DVec3| DVec3::new(w.dot(east), w.dot(normal.cross(east)), w.dot(normal));
    let wi = local(light);
    Sample { tilt, wi, wo: local(viewer), f: radiance / (f64::from(IRRADIANCE) * wi.z), radiance }
}

/// f at a pair of directions, in degrees (θ_i, φ_i, θ_r, φ_r): the pixel at the sphere's front, with camera and light turned about it.
pub fn pixel(ball: &Ball, [theta_i, phi_i, theta_r, phi_r]: [f64; 4]) -> Result<DVec3, GalleryError> {
    let direction = |theta: f64, phi: f64| -> DVec3 { V3::from_angles(theta.to_radians(), phi.to_radians()).into() };
    let (wi, wo) = (direction(theta_i, phi_i), direction(theta_r, phi_r));
    let point = Vec3::Y + Vec3::Z;
    let stage = Stage::row(std::slice::from_ref(ball));
    let image = stage.light(wi.as_vec3()).orthographic(point + wo.as_vec3() * 5.0, point, Vec3::Y, 1e-5).direct(UVec2::ONE)?;
    Ok(image.get(0, 0).0.as_dvec3() / (f64::from(IRRADIANCE) * wi.z))
}

/// What the sphere's middle reflects of a white sky, with its standard error: the albedo at normal incidence.
pub fn furnace(ball: &Ball) -> Result<(f64, f64), GalleryError> {
    const SIDE: u32 = 32;
    const SPP: u32 = 32;
    let mut stage = Stage::row(std::slice::from_ref(ball));
    // Without ground: the last mesh is the checker.
    stage.0.nodes.retain(|node| node.meshes != [1]);
    let stage = stage.sky(1.0).orthographic(Vec3::new(0.0, 1.0, 5.0), Vec3::Y, Vec3::Y, 1e-3);
    let settings =
        Settings { size: UVec2::splat(SIDE), integrator: Integrator::Path, max_depth: 1, filter: Filter::Center, ..Settings::default() };
    let frame = stage.render(&settings, SPP)?;
    let values: Vec<f64> = frame.beauty().pixels().iter().map(|pixel| f64::from(pixel.0.element_sum()) / 3.0).collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    Ok((mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt()))
}

/// Where `value` falls to half of what it is at `tilt` 0, to both sides, degrees; linear between pixels. `None` where it does not within the row.
pub fn half_widths(samples: &[Sample], value: impl Fn(&Sample) -> f64) -> [Option<f64>; 2] {
    let points: Vec<(f64, f64)> = samples.iter().map(|sample| (sample.tilt, value(sample))).collect();
    let at_zero = points.windows(2).find(|pair| pair[0].0 <= 0.0 && pair[1].0 > 0.0).map_or(f64::NAN, |pair| {
        let t = -pair[0].0 / (pair[1].0 - pair[0].0);
        pair[0].1 + t * (pair[1].1 - pair[0].1)
    });
    let crossing = |points: &mut dyn Iterator<Item = &(f64, f64)>| {
        let mut previous = (0.0, at_zero);
        for &(tilt, value) in points {
            if value <= at_zero / 2.0 {
                let t = (previous.1 - at_zero / 2.0) / (previous.1 - value);
                return Some((previous.0 + t * (tilt - previous.0)).abs());
            }
            previous = (tilt, value);
        }
        None
    };
    [crossing(&mut points.iter().rev().filter(|point| point.0 <= 0.0)), crossing(&mut points.iter().filter(|point| point.0 >= 0.0))]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pixels are the model, at the directions that the samples say: an anisotropic model in both planes.
    #[test]
    fn pixels_are_the_model_at_their_directions() {
        let ball = Ball::new("ward", "kd=0.2 ks=0.3 mx=0.3 my=0.15", "");
        let model = ball.prepare().reflectance;
        for azimuth in [0.0, 90.0] {
            let samples = strip(&ball, azimuth).unwrap();
            assert!(samples.len() > 1000);
            for sample in &samples {
                let expected = model.value(sample.wi, sample.wo).x;
                assert!((sample.f.x / expected - 1.0).abs() < 4e-3, "{azimuth} {sample:?} {expected}");
            }
        }
        let turned = |w: DVec3| DVec3::new(-w.y, w.x, w.z);
        let wrong =
            strip(&ball, 0.0).unwrap().iter().map(|s| (s.f.x / model.value(turned(s.wi), turned(s.wo)).x - 1.0).abs()).fold(0.0, f64::max);
        assert!(wrong > 0.1, "planted fault");
        for set in [[30.0, 0.0, 40.0, 180.0], [60.0, 20.0, 45.0, 150.0], [10.0, 0.0, 75.0, 90.0]] {
            let direction = |theta: f64, phi: f64| -> DVec3 { V3::from_angles(theta.to_radians(), phi.to_radians()).into() };
            let expected = model.value(direction(set[0], set[1]), direction(set[2], set[3])).x;
            let found = pixel(&ball, set).unwrap().x;
            assert!((found / expected - 1.0).abs() < 1e-3, "{set:?}: {found} {expected}");
        }
    }

    #[test]
    fn half_widths_are_those_of_the_curve() {
        let sample = |tilt: f64| Sample { tilt, wi: DVec3::Z, wo: DVec3::Z, f: DVec3::ZERO, radiance: DVec3::ZERO };
        let samples: Vec<Sample> = (-300..300).map(|k| sample(f64::from(k) * 0.1 + 0.03)).collect();
        let [left, right] = half_widths(&samples, |s| (-(s.tilt / 8.0_f64).powi(2)).exp());
        let exact = 8.0 * 2.0_f64.ln().sqrt();
        assert!((left.unwrap() - exact).abs() < 1e-3 && (right.unwrap() - exact).abs() < 1e-3, "{left:?} {right:?} {exact}");
        assert_eq!(half_widths(&samples, |_| 1.0), [None, None]);
    }
}
