//! Random numbers, warps, frames, normal packing and camera helpers.

use crate::compare::{Tolerance, conform};
use glam::{UVec2, Vec2, Vec3};
use kajo_sampling::{Frame, Rng, ShRadiance, hammersley_2d, sh_basis, sh_cosine_basis, warp};
use kajo_shader_lib::{camera, packing, random};

/// Points of the unit square: a grid with the borders, and random ones.
pub fn unit_square() -> Vec<[f32; 2]> {
    let mut rng = Rng::new(7);
    let last = 1.0 - f32::EPSILON;
    let grid = (0..=32).flat_map(|i| (0..=32).map(move |j| [(i as f32 / 32.0).min(last), (j as f32 / 32.0).min(last)]));
    grid.chain((0..4000).map(|_| rng.next_2d().to_array())).collect()
}

/// Unit vectors: the axes, near the equator and the poles, and random ones.
pub fn directions() -> Vec<[f32; 3]> {
    let mut rng = Rng::new(8);
    let axes = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
    let near = axes.map(|axis| (axis + Vec3::new(1e-3, -2e-3, 3e-3)).normalize());
    axes.into_iter().chain(near).chain((0..4000).map(|_| warp::uniform_sphere(rng.next_2d()))).map(|d| d.to_array()).collect()
}

#[test]
fn random_numbers_have_equal_bits() {
    let mut rng = Rng::new(3);
    let rows: Vec<[f32; 4]> = (0..4000)
        .map(|_| {
            // Whole numbers below 2²⁴, which an f32 holds.
            [rng.below(1 << 24), rng.below(1 << 24), rng.below(1 << 24), rng.below(256)].map(|i| i as f32)
        })
        .collect();
    let shader = "import shader_lib::random::{random_1d, random_2d, hammersley_2d};
        fn eval(x: array<f32, 4>) -> array<f32, 5> {
            let pixel = vec2u(u32(x[0]), u32(x[1]));
            let p = random_2d(pixel, u32(x[2]), u32(x[3]));
            let h = hammersley_2d(u32(x[3]), 256u);
            return array(random_1d(pixel, u32(x[2]), u32(x[3])), p.x, p.y, h.x, h.y);
        }";
    let twin = |x: [f32; 4]| {
        let [px, py, frame, dimension] = x.map(|i| i as u32);
        let (pixel, h) = (UVec2::new(px, py), hammersley_2d(dimension, 256));
        let p = random::random_2d(pixel, frame, dimension);
        [random::random_1d(pixel, frame, dimension), p.x, p.y, h.x, h.y]
    };
    conform("random", shader, &rows, twin, Tolerance::EXACT);
}

#[test]
fn warps_match() {
    let shader =
        "import shader_lib::warp::{concentric_disk, uniform_sphere, uniform_hemisphere, cosine_hemisphere, cosine_hemisphere_pdf, cone, triangle_barycentrics};
        fn eval(x: array<f32, 2>) -> array<f32, 18> {
            let u = vec2f(x[0], x[1]);
            let a = concentric_disk(u);
            let b = uniform_sphere(u);
            let c = uniform_hemisphere(u);
            let d = cosine_hemisphere(u);
            let e = cone(1e-4, u);
            let f = triangle_barycentrics(u);
            return array(a.x, a.y, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z, cosine_hemisphere_pdf(d), e.x, e.y, e.z, f.x, f.y, f.z);
        }";
    let twin = |x: [f32; 2]| {
        let u = Vec2::from_array(x);
        let (a, b, c, d) = (warp::concentric_disk(u), warp::uniform_sphere(u), warp::uniform_hemisphere(u), warp::cosine_hemisphere(u));
        let f = warp::triangle_barycentrics(u);
        let (e, pdf) = (warp::Cone::from_one_minus_cos(1e-4).sample(u), warp::cosine_hemisphere_pdf(d));
        [a.x, a.y, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z, pdf, e.x, e.y, e.z, f.x, f.y, f.z]
    };
    // Near the rim z is the root of a small difference: an ulp of the disc becomes 3e-4 of z.
    conform("warp", shader, &unit_square(), twin, Tolerance { relative: 1e-4, absolute: 4e-4 });
}

#[test]
fn frames_match() {
    let shader = "import shader_lib::math::{frame_from_z, frame_from_z_tangent, to_local, to_world};
        fn eval(d: array<f32, 3>) -> array<f32, 12> {
            let z = vec3f(d[0], d[1], d[2]);
            let a = to_world(frame_from_z(z), vec3f(0.3, -0.5, 0.8));
            let b = to_local(frame_from_z(z), vec3f(0.3, -0.5, 0.8));
            let frame = frame_from_z_tangent(z, vec3f(1.0, 0.0, 0.0));
            return array(a.x, a.y, a.z, b.x, b.y, b.z, frame.x.x, frame.x.y, frame.x.z, frame.y.x, frame.y.y, frame.y.z);
        }";
    let twin = |d: [f32; 3]| {
        let (z, v) = (Vec3::from_array(d), Vec3::new(0.3, -0.5, 0.8));
        let (a, b) = (Frame::from_z(z).to_world(v), Frame::from_z(z).to_local(v));
        let f = Frame::from_z_tangent(z, Vec3::X);
        [a.x, a.y, a.z, b.x, b.y, b.z, f.x.x, f.x.y, f.x.z, f.y.x, f.y.y, f.y.z]
    };
    // Near the singular direction −z the frame divides by a difference of order 1e-5.
    conform("frame", shader, &directions(), twin, Tolerance { relative: 1e-3, absolute: 1e-3 });
}

#[test]
fn packed_normals_match() {
    let shader = "import shader_lib::packing::{octahedral_encode, octahedral_decode, pack_normal, unpack_normal};
        fn eval(d: array<f32, 3>) -> array<f32, 8> {
            let n = vec3f(d[0], d[1], d[2]);
            let p = octahedral_encode(n);
            let a = octahedral_decode(p);
            let b = unpack_normal(pack_normal(n));
            return array(p.x, p.y, a.x, a.y, a.z, b.x, b.y, b.z);
        }";
    let twin = |d: [f32; 3]| {
        let n = Vec3::from_array(d);
        let p = packing::octahedral_encode(n);
        let (a, b) = (packing::octahedral_decode(p), packing::unpack_normal(packing::pack_normal(n)));
        [p.x, p.y, a.x, a.y, a.z, b.x, b.y, b.z]
    };
    // A coordinate half way between two steps may round either way: one step of 1/32767, stretched by √3.
    conform("packing", shader, &directions(), twin, Tolerance { relative: 1e-4, absolute: 6e-5 });
}

#[test]
fn camera_helpers_match() {
    let shader = "import shader_lib::camera::{depth_from_distance, distance_from_depth, pixel_from_ndc, ndc_from_pixel, view_ray};
        fn eval(x: array<f32, 2>) -> array<f32, 7> {
            let size = vec2f(640.0, 360.0);
            let pixel = vec2f(x[0], x[1]) * size;
            let back = pixel_from_ndc(ndc_from_pixel(pixel, size), size);
            let ray = view_ray(pixel, size, vec2f(0.9, 0.5));
            return array(depth_from_distance(x[0] + 0.1, 0.1), distance_from_depth(x[0], 0.1), back.x, back.y, ray.x, ray.y, ray.z);
        }";
    let twin = |x: [f32; 2]| {
        let size = Vec2::new(640.0, 360.0);
        let pixel = Vec2::from_array(x) * size;
        let back = camera::pixel_from_ndc(camera::ndc_from_pixel(pixel, size), size);
        let ray = camera::view_ray(pixel, size, Vec2::new(0.9, 0.5));
        [camera::depth_from_distance(x[0] + 0.1, 0.1), camera::distance_from_depth(x[0], 0.1), back.x, back.y, ray.x, ray.y, ray.z]
    };
    conform("camera", shader, &unit_square(), twin, Tolerance { relative: 1e-4, absolute: 1e-4 });
}

#[test]
fn spherical_harmonics_match() {
    let shader = "import shader_lib::spherical_harmonics::{sh_basis, sh_cosine_basis};
        fn eval(x: array<f32, 3>) -> array<f32, 18> {
            let a = sh_basis(vec3f(x[0], x[1], x[2]));
            let b = sh_cosine_basis(vec3f(x[0], x[1], x[2]));
            return array(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7], b[8]);
        }";
    let twin = |x: [f32; 3]| -> [f32; 18] {
        let (a, b) = (sh_basis(Vec3::from_array(x)), sh_cosine_basis(Vec3::from_array(x)));
        std::array::from_fn(|i| if i < 9 { a[i] } else { b[i - 9] })
    };
    conform("spherical harmonics", shader, &directions(), twin, Tolerance::USUAL);
}

/// Any nine coefficients: the seventh sine of their number, which no other order or band has alike.
#[test]
fn irradiance_by_spherical_harmonics_matches() {
    let shader = "import shader_lib::spherical_harmonics::sh_irradiance;
        fn eval(x: array<f32, 3>) -> array<f32, 3> {
            var radiance: array<vec3f, 9>;
            for (var i = 0u; i < 9u; i++) {
                radiance[i] = sin(7.0 * f32(i) + vec3f(0.0, 1.0, 2.0));
            }
            let sum = sh_irradiance(radiance, vec3f(x[0], x[1], x[2]));
            return array(sum.x, sum.y, sum.z);
        }";
    let radiance = ShRadiance(std::array::from_fn(|i| (7.0 * i as f32 + Vec3::new(0.0, 1.0, 2.0)).map(f32::sin)));
    let twin = |x: [f32; 3]| radiance.irradiance(Vec3::from_array(x)).to_array();
    conform("irradiance by spherical harmonics", shader, &directions(), twin, Tolerance { relative: 1e-4, absolute: 1e-4 });
}
