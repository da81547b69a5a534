//! Sphere and hemisphere around +z.

use super::{concentric_disk, concentric_disk_inverse, to_unit};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};

/// cos θ = z and azimuth as a direction.
#[inline]
pub(super) fn from_z_phi(z: f32, phi: f32) -> Vec3 {
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = phi.sin_cos();
    Vec3::new(r * cos, r * sin, z)
}

/// Azimuth from x as a fraction of a turn.
pub(super) fn turn(d: Vec3) -> f32 {
    to_unit((d.y.atan2(d.x) / TAU).rem_euclid(1.0))
}

/// Uniform on the sphere: cos θ = 1 − 2 u, φ = 2π v.
#[inline]
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    from_z_phi(1.0 - 2.0 * u.x, TAU * u.y)
}

/// The inverse of [`uniform_sphere`].
pub fn uniform_sphere_inverse(d: Vec3) -> Vec2 {
    Vec2::new(to_unit(0.5 * (1.0 - d.z)), turn(d))
}

/// 1/4π.
#[inline]
pub fn uniform_sphere_pdf(_direction: Vec3) -> f32 {
    FRAC_1_PI / 4.0
}

/// Uniform on the hemisphere: cos θ = 1 − u, φ = 2π v.
#[inline]
pub fn uniform_hemisphere(u: Vec2) -> Vec3 {
    from_z_phi(1.0 - u.x, TAU * u.y)
}

/// The inverse of [`uniform_hemisphere`].
pub fn uniform_hemisphere_inverse(d: Vec3) -> Vec2 {
    Vec2::new(to_unit(1.0 - d.z), turn(d))
}

/// 1/2π above the horizon, 0 below.
#[inline]
pub fn uniform_hemisphere_pdf(d: Vec3) -> f32 {
    if d.z >= 0.0 { FRAC_1_PI / 2.0 } else { 0.0 }
}

/// Cosine-weighted on the hemisphere: a uniform disc lifted to the sphere.    \[Malley88]
///
/// The rim of the disc (one point in 2²³) is lifted by 1e-5, so that the density is never zero and no sample is lost.
#[inline(always)]
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let p = concentric_disk(u);
    p.extend((1.0 - p.length_squared()).max(1e-10).sqrt())
}

/// The inverse of [`cosine_hemisphere`].
pub fn cosine_hemisphere_inverse(d: Vec3) -> Vec2 {
    concentric_disk_inverse(d.truncate())
}

/// cos θ / π above the horizon, 0 below.
#[inline]
pub fn cosine_hemisphere_pdf(d: Vec3) -> f32 {
    d.z.max(0.0) * FRAC_1_PI
}
