//! How much light of a cluster can arrive at a point: the weights by which a tree is descended.

use super::WIDTH;
use super::bounds::EmitterBounds;
use glam::{Affine3A, Vec3};

/// Where light is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// The point, m.
    pub point: Vec3,
    /// Unit normal of the surface, if nothing below it can arrive. `None` where light passes the surface.
    pub normal: Option<Vec3>,
}

impl Receiver {
    /// The receiver as an object sees it that a similarity has put into the world.
    #[inline]
    pub fn transformed(&self, object_from_world: &Affine3A) -> Self {
        Self {
            point: object_from_world.transform_point3(self.point),
            normal: self.normal.map(|normal| object_from_world.transform_vector3(normal).normalize_or(normal)),
        }
    }
}

/// Cosine by which bounds may be missed: cosines near 1 know their angles to 3.5e-4 rad only.
const SLACK: f32 = 1e-3;

/// Squared distance, m², below which a point light counts as this far: its intensity over less would leave the range of f32.
const NEAREST2: f32 = 1e-20;

/// Bounds of up to eight children, coordinate by coordinate, so that one instruction handles four or eight of them.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Lanes {
    center: [[f32; WIDTH]; 3],
    half: [[f32; WIDTH]; 3],
    axis: [[f32; WIDTH]; 3],
    cos_normals: [f32; WIDTH],
    sin_normals: [f32; WIDTH],
    cos_emission: [f32; WIDTH],
    /// 1 where normals have twins, else 0.
    two_sided: [f32; WIDTH],
    intensity: [f32; WIDTH],
}

impl Lanes {
    pub(super) const EMPTY: Self = Self {
        center: [[0.0; WIDTH]; 3],
        half: [[0.0; WIDTH]; 3],
        axis: [[0.0; WIDTH]; 3],
        cos_normals: [1.0; WIDTH],
        sin_normals: [0.0; WIDTH],
        cos_emission: [1.0; WIDTH],
        two_sided: [0.0; WIDTH],
        intensity: [0.0; WIDTH],
    };

    pub(super) fn set(&mut self, lane: usize, bounds: &EmitterBounds) {
        let center = bounds.center();
        // A box that holds the one of the bounds in spite of the rounding of its middle.
        let half = (bounds.max - center).max(center - bounds.min) + f32::EPSILON * center.abs();
        for k in 0..3 {
            self.center[k][lane] = center[k];
            self.half[k][lane] = half[k];
            self.axis[k][lane] = bounds.axis[k];
        }
        self.cos_normals[lane] = bounds.cos_normals;
        self.sin_normals[lane] = (1.0 - bounds.cos_normals * bounds.cos_normals).max(0.0).sqrt();
        self.cos_emission[lane] = bounds.cos_emission;
        self.two_sided[lane] = f32::from(u8::from(bounds.two_sided));
        self.intensity[lane] = if bounds.intensity > 0.0 && bounds.intensity.is_finite() { bounds.intensity } else { 0.0 };
    }

    pub(super) fn intensities(&self) -> &[f32; WIDTH] {
        &self.intensity
    }

    /// Estimated irradiance of each child, W/m².
    #[inline]
    pub(super) fn importance(&self, receiver: &Receiver) -> [f32; WIDTH] {
        match receiver.normal {
            Some(normal) => self.estimate::<true>(receiver.point, normal),
            None => self.estimate::<false>(receiver.point, Vec3::ZERO),
        }
    }

    /// ```text
    /// I cos θ' cos θi' / max(d², r²),    θ' = max(0, θ − θo − θu),    θi' = max(0, θi − θu);    0 where θ' > θe          [Estevez18] eq. 3
    /// ```
    ///
    /// d is the distance of the middle, r the radius of the box and θu = asin(r/d) the angle it fills, θ the angle at the cluster and θi that at
    /// the receiver. Tighter than the paper: a box wholly below the horizon of the receiver, or a plane that wholly turns its back, has none.
    #[inline(always)]
    fn estimate<const NORMAL: bool>(&self, point: Vec3, normal: Vec3) -> [f32; WIDTH] {
        let mut out = [0.0; WIDTH];
        for (i, out) in out.iter_mut().enumerate() {
            let (dx, dy, dz) = (point.x - self.center[0][i], point.y - self.center[1][i], point.z - self.center[2][i]);
            let (hx, hy, hz) = (self.half[0][i], self.half[1][i], self.half[2][i]);
            let (ax, ay, az) = (self.axis[0][i], self.axis[1][i], self.axis[2][i]);
            let (d2, r2) = (dx * dx + dy * dy + dz * dz, hx * hx + hy * hy + hz * hz);
            let reach2 = d2.max(r2).max(NEAREST2);
            let inverse = 1.0 / d2.max(NEAREST2).sqrt();
            let sin_u2 = r2 / reach2;
            let (sin_u, cos_u) = (sin_u2.sqrt(), (1.0 - sin_u2).sqrt());

            let along = dx * ax + dy * ay + dz * az;
            let cos = (along * inverse).clamp(-1.0, 1.0);
            let cos = if self.two_sided[i] > 0.0 { cos.abs() } else { cos };
            let sin = (1.0 - cos * cos).sqrt();
            let (cos_o, sin_o) = (self.cos_normals[i], self.sin_normals[i]);
            let in_normals = cos >= cos_o;
            let cos_1 = if in_normals { 1.0 } else { cos * cos_o + sin * sin_o };
            let sin_1 = if in_normals { 0.0 } else { sin * cos_o - cos * sin_o };
            let cos_2 = if cos_1 >= cos_u || d2 <= r2 { 1.0 } else { cos_1 * cos_u + sin_1 * sin_u };
            // Height of the receiver over the lowest plane of a flat cluster.
            let height = along + ax.abs() * hx + ay.abs() * hy + az.abs() * hz;
            let flat_and_behind = (cos_o >= 1.0) & (self.two_sided[i] == 0.0) & (self.cos_emission[i] >= 0.0) & (height < 0.0);
            let shines = (cos_2 >= self.cos_emission[i] - SLACK) & !flat_and_behind;

            let (mut cos_i, mut above) = (1.0, true);
            if NORMAL {
                let up = -(dx * normal.x + dy * normal.y + dz * normal.z);
                let cos = (up * inverse).clamp(-1.0, 1.0);
                let sin = (1.0 - cos * cos).sqrt();
                cos_i = if cos >= cos_u || d2 <= r2 { 1.0 } else { cos * cos_u + sin * sin_u };
                above = up + normal.x.abs() * hx + normal.y.abs() * hy + normal.z.abs() * hz >= 0.0;
            }
            let value = self.intensity[i] * cos_2.max(SLACK) * cos_i.max(SLACK) / reach2;
            *out = if shines & above { value } else { 0.0 };
        }
        out
    }
}
