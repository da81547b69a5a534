//! How much light of a cluster can arrive at a point: the weights by which a tree is descended.

use super::WIDTH;
use super::bounds::EmitterBounds;
use glam::{Affine3A, Vec3, Vec4};

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

/// Share of r² that distances to a cluster are longer by.
const WIDTH_OF_CLUSTER: f32 = 0.25;

/// Share of the greatest cosine at the receiver; the rest is that of the cluster's middle.
const BOUND: f32 = 0.25;

/// Numbers of this many children are handled by one instruction.
const QUAD: usize = 4;

/// One number for each child.
type Row = [Vec4; WIDTH / QUAD];

/// Bounds of up to eight children, coordinate by coordinate. Places without a child have no intensity.
#[derive(Clone, Debug, Default)]
pub(super) struct Lanes {
    center: [Row; 3],
    half: [Row; 3],
    axis: [Row; 3],
    cos_normals: Row,
    sin_normals: Row,
    cos_emission: Row,
    /// 1 where normals have twins, else 0.
    two_sided: Row,
    intensity: Row,
}

impl Lanes {
    pub(super) fn set(&mut self, lane: usize, bounds: &EmitterBounds) {
        let put = |row: &mut Row, value: f32| row[lane / QUAD][lane % QUAD] = value;
        let center = bounds.center();
        // A box that holds the one of the bounds in spite of the rounding of its middle.
        let half = (bounds.max - center).max(center - bounds.min) + f32::EPSILON * center.abs();
        for k in 0..3 {
            put(&mut self.center[k], center[k]);
            put(&mut self.half[k], half[k]);
            put(&mut self.axis[k], bounds.axis[k]);
        }
        put(&mut self.cos_normals, bounds.cos_normals);
        put(&mut self.sin_normals, (1.0 - bounds.cos_normals * bounds.cos_normals).max(0.0).sqrt());
        put(&mut self.cos_emission, bounds.cos_emission);
        put(&mut self.two_sided, f32::from(u8::from(bounds.two_sided)));
        put(&mut self.intensity, if bounds.intensity > 0.0 && bounds.intensity.is_finite() { bounds.intensity } else { 0.0 });
    }

    pub(super) fn intensities(&self) -> [f32; WIDTH] {
        gathered(self.intensity)
    }

    /// Estimated irradiance of each child, W/m².
    #[inline]
    pub(super) fn importance(&self, receiver: &Receiver) -> [f32; WIDTH] {
        gathered(match receiver.normal {
            Some(normal) => [0, 1].map(|quad| self.estimate::<true>(quad, receiver.point, normal)),
            None => [0, 1].map(|quad| self.estimate::<false>(quad, receiver.point, Vec3::ZERO)),
        })
    }

    /// ```text
    /// I cos θ' (¼ cos θi' + ¾ max(0, cos θi)) / (d² + ¼ r²),    θ' = max(0, θ − θo − θu),    θi' = max(0, θi − θu);    0 where θ' > θe
    /// ```
    ///
    /// d is the distance of the middle, r the radius of the box and θu = asin(r/d) the angle it fills, θ the angle at the cluster and θi that at
    /// the receiver. Deviations from \[Estevez18] eq. 3, which has I cos θ' cos θi' / d²: the bound cos θi' alone is far above the mean of a wide cluster, and so
    /// is 1/d² inside of it (docs/decisions/0004-light-bvh.md has the measurements). And bounds are tighter: a box wholly below the horizon of the receiver,
    /// or a plane that wholly turns its back, has no importance.
    #[inline(always)]
    fn estimate<const NORMAL: bool>(&self, quad: usize, point: Vec3, normal: Vec3) -> Vec4 {
        let one = Vec4::ONE;
        let quads = |rows: &[Row; 3]| rows.map(|row| row[quad]);
        let dot = |a: [Vec4; 3], b: [Vec4; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (center, half, axis) = (quads(&self.center), quads(&self.half), quads(&self.axis));
        let d = [point.x - center[0], point.y - center[1], point.z - center[2]];
        let (d2, r2) = (dot(d, d), dot(half, half));
        let nearest2 = d2.max(Vec4::splat(NEAREST2));
        let reach2 = nearest2.max(r2);
        let inverse = one / roots(nearest2);
        let inside = d2.cmple(r2);
        let sin_u2 = r2 / reach2;
        let (sin_u, cos_u) = (roots(sin_u2), roots(one - sin_u2));
        // cos max(0, θ − θu)
        let seen_wider = |cos: Vec4, sin: Vec4| Vec4::select(inside | cos.cmpge(cos_u), one, cos * cos_u + sin * sin_u);

        let along = dot(d, axis);
        let cos = (along * inverse).clamp(-one, one);
        let twins = self.two_sided[quad].cmpgt(Vec4::ZERO);
        let cos = Vec4::select(twins, cos.abs(), cos);
        let sin = roots(one - cos * cos);
        let (cos_o, sin_o, cos_e) = (self.cos_normals[quad], self.sin_normals[quad], self.cos_emission[quad]);
        let in_normals = cos.cmpge(cos_o);
        let from_normals = Vec4::select(in_normals, one, cos * cos_o + sin * sin_o);
        let sin_from_normals = Vec4::select(in_normals, Vec4::ZERO, sin * cos_o - cos * sin_o);
        let cos_light = seen_wider(from_normals, sin_from_normals);
        // Height of the receiver over the lowest plane of a flat cluster.
        let height = along + dot(axis.map(Vec4::abs), half);
        let behind = height.cmplt(Vec4::ZERO) & cos_o.cmpge(one) & cos_e.cmpge(Vec4::ZERO) & !twins;
        let mut lit = cos_light.cmpge(cos_e - SLACK) & !behind;
        let mut value = self.intensity[quad] * cos_light.max(Vec4::splat(SLACK)) / (nearest2 + WIDTH_OF_CLUSTER * r2);

        if NORMAL {
            let normals = normal.to_array().map(Vec4::splat);
            let up = -dot(d, normals);
            let cos = (up * inverse).clamp(-one, one);
            let bound = seen_wider(cos, roots(one - cos * cos));
            lit &= (up + dot(normals.map(Vec4::abs), half)).cmpge(Vec4::ZERO);
            value *= (BOUND * bound + (1.0 - BOUND) * cos.max(Vec4::ZERO)).max(Vec4::splat(SLACK));
        }
        Vec4::select(lit, value, Vec4::ZERO)
    }
}

#[inline(always)]
fn roots(x: Vec4) -> Vec4 {
    Vec4::from_array(x.to_array().map(f32::sqrt))
}

#[inline(always)]
fn gathered(row: Row) -> [f32; WIDTH] {
    let [a, b] = row.map(|quad| quad.to_array());
    [a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]]
}
