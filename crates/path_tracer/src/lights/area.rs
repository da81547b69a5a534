//! Analytic area lights: rectangle, disk, sphere.
//!
//! They emit on one side (the sphere outwards) and are nothing but emission: rays pass through them and gather it on the way, so
//! they neither block nor scatter light. Solid lamps are modelled with emissive meshes.

use super::LightSample;
use glam::{Affine3A, Vec2, Vec3};
use kajo_bvh::Aabb;
use kajo_sampling::light_tree::EmitterBounds;
use kajo_sampling::warp::{LightSphere, Rectangle, concentric_disk};
use kajo_units::LinearRgb;
use std::f32::consts::PI;

/// An area light in the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AreaLight {
    shape: Shape,
    /// Radiance, W/(m² sr).
    radiance: LinearRgb,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    /// A rectangle, or under a skewed transform a parallelogram: `corner` + s `x` + t `y`.
    Rectangle { corner: Vec3, x: Vec3, y: Vec3, normal: Vec3, area: f32, right_angled: Option<Rectangle> },
    /// A disk, or under an uneven transform an ellipse: `center` + r cos φ `x` + r sin φ `y`.
    Disk { center: Vec3, x: Vec3, y: Vec3, normal: Vec3, area: f32 },
    /// A sphere; uneven scale is averaged.
    Sphere { center: Vec3, radius: f32 },
}

/// Cosine between edges up to which a parallelogram counts as a rectangle: transforms round.
const RIGHT_ANGLE: f32 = 1e-4;

impl AreaLight {
    pub(crate) fn rectangle(world_from_light: &Affine3A, width: f32, height: f32, radiance: LinearRgb) -> Self {
        let (x, y, normal) = plane(world_from_light, width, height);
        let corner = Vec3::from(world_from_light.translation) - 0.5 * (x + y);
        let right_angled = (x.dot(y).abs() <= RIGHT_ANGLE * x.length() * y.length()).then(|| Rectangle::new(corner, x, y));
        Self { shape: Shape::Rectangle { corner, x, y, normal, area: x.cross(y).length(), right_angled }, radiance }
    }

    pub(crate) fn disk(world_from_light: &Affine3A, radius: f32, radiance: LinearRgb) -> Self {
        let (x, y, normal) = plane(world_from_light, radius, radius);
        let center = world_from_light.translation.into();
        Self { shape: Shape::Disk { center, x, y, normal, area: PI * x.cross(y).length() }, radiance }
    }

    pub(crate) fn sphere(world_from_light: &Affine3A, radius: f32, radiance: LinearRgb) -> Self {
        let scale = world_from_light.matrix3.determinant().abs().cbrt();
        Self { shape: Shape::Sphere { center: world_from_light.translation.into(), radius: radius * scale }, radiance }
    }

    /// Emitted flux, W.
    pub(crate) fn power(&self) -> f32 {
        let area = match self.shape {
            Shape::Rectangle { area, .. } | Shape::Disk { area, .. } => area,
            Shape::Sphere { radius, .. } => 4.0 * PI * radius * radius,
        };
        PI * area * self.radiance.luminance()
    }

    /// What a light tree knows of it.
    pub(crate) fn emitter_bounds(&self) -> EmitterBounds {
        let Aabb { min, max } = self.bounds();
        let luminance = self.radiance.luminance();
        let base = EmitterBounds { min, max, cos_emission: 0.0, ..EmitterBounds::NONE };
        match self.shape {
            Shape::Rectangle { normal, area, .. } | Shape::Disk { normal, area, .. } => {
                EmitterBounds { axis: normal, intensity: luminance * area, ..base }
            }
            Shape::Sphere { radius, .. } => EmitterBounds { cos_normals: -1.0, intensity: luminance * PI * radius * radius, ..base },
        }
    }

    pub(crate) fn bounds(&self) -> Aabb {
        let (center, half) = match self.shape {
            Shape::Rectangle { corner, x, y, .. } => (corner + 0.5 * (x + y), 0.5 * (x.abs() + y.abs())),
            Shape::Disk { center, x, y, .. } => (center, (x * x + y * y).map(f32::sqrt)),
            Shape::Sphere { center, radius } => (center, Vec3::splat(radius)),
        };
        Aabb { min: center - half, max: center + half }
    }

    /// A direction towards the light: uniform in solid angle for spheres and near rectangles, nearly so for distant ones, uniform in area for
    /// disks.
    pub(crate) fn sample(&self, from: Vec3, u: Vec2) -> Option<LightSample> {
        let (wi, distance, pdf) = match self.shape {
            Shape::Sphere { center, radius } => {
                if from.distance_squared(center) <= radius * radius {
                    return None;
                }
                let cone = LightSphere::new(from, center, radius);
                let wi = cone.sample(u);
                // At the rim rounding may miss the sphere; its nearest point is the rim itself.
                let distance = hit_sphere(from, wi, center, radius).unwrap_or((center - from).dot(wi));
                (wi, distance, 1.0 / cone.solid_angle())
            }
            Shape::Rectangle { corner, x, y, normal, area, right_angled } => {
                if (from - corner).dot(normal) <= 0.0 {
                    return None;
                }
                if let Some(rectangle) = right_angled {
                    let (to_light, pdf) = rectangle.seen_from(from).sample(u);
                    let distance = to_light.length();
                    (to_light / distance, distance, pdf)
                } else {
                    towards_area(from, corner + u.x * x + u.y * y, normal, area)
                }
            }
            Shape::Disk { center, x, y, normal, area } => {
                if (from - center).dot(normal) <= 0.0 {
                    return None;
                }
                let p = concentric_disk(u);
                towards_area(from, center + p.x * x + p.y * y, normal, area)
            }
        };
        (pdf > 0.0 && pdf.is_finite()).then_some(LightSample { wi, distance, radiance: self.radiance, pdf })
    }

    /// Density per solid angle of [`AreaLight::sample`] at a point of the light in `direction` from `from`, `distance` away.
    pub(crate) fn pdf(&self, from: Vec3, direction: Vec3, distance: f32) -> f32 {
        match self.shape {
            Shape::Sphere { center, radius } => 1.0 / LightSphere::new(from, center, radius).solid_angle(),
            Shape::Rectangle { right_angled: Some(rectangle), .. } => rectangle.seen_from(from).pdf(distance * direction),
            Shape::Rectangle { normal, area, .. } | Shape::Disk { normal, area, .. } => {
                pdf_from_area(distance, -normal.dot(direction), area)
            }
        }
    }

    /// A point of the light, uniform over its area, or over the solid angle of a sphere: the measure of `visibility.<light>`.
    pub(crate) fn point_of_visibility(&self, from: Vec3, u: Vec2) -> Option<Vec3> {
        match self.shape {
            Shape::Rectangle { corner, x, y, .. } => Some(corner + u.x * x + u.y * y),
            Shape::Disk { center, x, y, .. } => {
                let p = concentric_disk(u);
                Some(center + p.x * x + p.y * y)
            }
            Shape::Sphere { .. } => self.sample(from, u).map(|s| from + s.wi * s.distance),
        }
    }

    /// Where a ray sees the emitting side: distance and radiance.
    pub(crate) fn seen_along(&self, origin: Vec3, direction: Vec3) -> Option<(f32, LinearRgb)> {
        let t = match self.shape {
            Shape::Sphere { center, radius } => {
                (origin.distance_squared(center) > radius * radius).then(|| hit_sphere(origin, direction, center, radius)).flatten()?
            }
            Shape::Rectangle { corner, x, y, normal, .. } => {
                let (t, s) = hit_plane(origin, direction, corner, x, y, normal)?;
                (s.cmpge(Vec2::ZERO).all() && s.cmple(Vec2::ONE).all()).then_some(t)?
            }
            Shape::Disk { center, x, y, normal, .. } => {
                let (t, s) = hit_plane(origin, direction, center, x, y, normal)?;
                (s.length_squared() <= 1.0).then_some(t)?
            }
        };
        Some((t, self.radiance))
    }
}

/// Direction, distance and density per solid angle of a point drawn uniformly from an area.
pub(super) fn towards_area(from: Vec3, point: Vec3, normal: Vec3, area: f32) -> (Vec3, f32, f32) {
    let distance = point.distance(from);
    let wi = (point - from) / distance;
    (wi, distance, pdf_from_area(distance, -normal.dot(wi), area))
}

/// r² / (A cos θ); 0 from behind.
pub(super) fn pdf_from_area(distance: f32, cos: f32, area: f32) -> f32 {
    if cos > 0.0 { distance * distance / (cos * area) } else { 0.0 }
}

/// Axes of a light's plane, scaled, and its emitting normal: the side of −z.
fn plane(world_from_light: &Affine3A, x: f32, y: f32) -> (Vec3, Vec3, Vec3) {
    let axes = world_from_light.matrix3;
    let (x, y): (Vec3, Vec3) = ((axes.x_axis * x).into(), (axes.y_axis * y).into());
    let normal = x.cross(y).normalize_or_zero();
    (x, y, if normal.dot(axes.z_axis.into()) > 0.0 { -normal } else { normal })
}

/// Distance to, and coordinates (s, t) of, the point `origin_of_plane` + s x + t y, approached against the normal.
fn hit_plane(origin: Vec3, direction: Vec3, origin_of_plane: Vec3, x: Vec3, y: Vec3, normal: Vec3) -> Option<(f32, Vec2)> {
    let cos = direction.dot(normal);
    let t = (origin_of_plane - origin).dot(normal) / cos;
    if cos >= 0.0 || t.is_nan() || t <= 0.0 {
        return None;
    }
    let p = origin + t * direction - origin_of_plane;
    let cross = x.cross(y);
    Some((t, Vec2::new(p.cross(y).dot(cross), x.cross(p).dot(cross)) / cross.length_squared()))
}

/// Distance to the nearer point of a sphere, from outside.    \[Haines19]: precise for small, distant spheres
fn hit_sphere(origin: Vec3, direction: Vec3, center: Vec3, radius: f32) -> Option<f32> {
    let to_center = center - origin;
    let along = to_center.dot(direction);
    let off_axis = to_center - along * direction;
    let discriminant = radius * radius - off_axis.length_squared();
    if along <= 0.0 || discriminant < 0.0 {
        return None;
    }
    let far = along + discriminant.sqrt();
    Some((to_center.length_squared() - radius * radius) / far)
}
