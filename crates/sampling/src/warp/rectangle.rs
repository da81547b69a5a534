//! A planar rectangle as a light.

use super::{DistantRectangle, SphericalRectangle};
use glam::{DVec3, Vec2, Vec3};

/// A planar rectangle, ready to be seen from any point.
#[derive(Clone, Copy, Debug)]
pub struct Rectangle {
    corner: Vec3,
    edge_x: Vec3,
    edge_y: Vec3,
    normal: Vec3,
    /// Unit, in double precision.
    axes: [DVec3; 3],
    lengths: [f64; 2],
}

/// A [`Rectangle`] as it is seen from a point.
#[derive(Clone, Copy, Debug)]
pub enum SeenRectangle {
    /// From near: uniform in solid angle.
    Near(SphericalRectangle),
    /// From afar: nearly so.
    Distant(DistantRectangle),
}

impl Rectangle {
    /// The rectangle `corner` + s `edge_x` + t `edge_y`, s, t in [0, 1], edges perpendicular.
    pub fn new(corner: Vec3, edge_x: Vec3, edge_y: Vec3) -> Self {
        let (x, y) = (edge_x.as_dvec3(), edge_y.as_dvec3());
        let (ax, ay) = (x.normalize_or_zero(), y.normalize_or_zero());
        let az = ax.cross(ay);
        Self { corner, edge_x, edge_y, normal: az.as_vec3(), axes: [ax, ay, az], lengths: [x.length(), y.length()] }
    }

    /// The rectangle as it is seen from `point`.
    #[inline]
    pub fn seen_from(&self, point: Vec3) -> SeenRectangle {
        let corner = self.corner - point;
        match DistantRectangle::new(corner, self.edge_x, self.edge_y, corner.dot(self.normal).abs()) {
            Some(distant) => SeenRectangle::Distant(distant),
            None => SeenRectangle::Near(SphericalRectangle::from_axes(point.as_dvec3(), self.corner.as_dvec3(), self.axes, self.lengths)),
        }
    }
}

impl SeenRectangle {
    /// A point of the rectangle, relative to the point that sees it, and the density per solid angle of its direction.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec3, f32) {
        match self {
            Self::Near(near) => {
                let point = near.sample_relative(u);
                (point, near.pdf(point))
            }
            Self::Distant(distant) => distant.sample(u),
        }
    }

    /// Density per solid angle with which [`SeenRectangle::sample`] finds `point`, relative to the point that sees it.
    #[inline]
    pub fn pdf(&self, point: Vec3) -> f32 {
        match self {
            Self::Near(near) => near.pdf(point),
            Self::Distant(distant) => distant.pdf(point),
        }
    }
}
