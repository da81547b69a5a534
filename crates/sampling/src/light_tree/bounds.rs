//! What is known of emitters without looking at them one by one: where they are, where they shine, how strongly.

use glam::{Affine3A, DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Bounds of one emitter, or of many.    \[Estevez18] section 4
///
/// Every normal lies within θo of `axis`, every normal shines within θe of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmitterBounds {
    /// Least corner of a box around the emitters, m.
    pub min: Vec3,
    /// Greatest corner, m.
    pub max: Vec3,
    /// Axis of the cone of normals, unit length.
    pub axis: Vec3,
    /// cos θo; 1 for a plane, −1 for all directions.
    pub cos_normals: f32,
    /// cos θe; 0 for a surface, the cosine of the outer angle for a spot.
    pub cos_emission: f32,
    /// The negative of each normal counts as well.
    pub two_sided: bool,
    /// Greatest radiant intensity, as luminance, W/sr: L A of a plane, L π r² of a sphere; summed over the emitters.
    pub intensity: f32,
}

/// Squared cosine between axes, and squared ratio of lengths, up to which a transform counts as a similarity.
const SIMILAR: f32 = 1e-4;

/// Share of the squared diagonal in the extent of a box.
const ROW: f32 = 1e-3;

impl EmitterBounds {
    /// Bounds of nothing.
    pub const NONE: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
        axis: Vec3::Z,
        cos_normals: 1.0,
        cos_emission: 1.0,
        two_sided: false,
        intensity: 0.0,
    };

    /// A triangle of that radiance, W/(m² sr), which shines to where its corners run counter-clockwise.
    pub fn triangle(corners: [Vec3; 3], radiance: f32, two_sided: bool) -> Self {
        let [a, b, c] = corners;
        let cross = (b - a).cross(c - a);
        Self {
            min: a.min(b).min(c),
            max: a.max(b).max(c),
            axis: cross.normalize_or(Vec3::Z),
            cos_emission: 0.0,
            two_sided,
            intensity: 0.5 * cross.length() * radiance,
            ..Self::NONE
        }
    }

    /// A point that shines everywhere.
    pub fn point(position: Vec3, intensity: f32) -> Self {
        Self { min: position, max: position, cos_normals: -1.0, cos_emission: 0.0, intensity, ..Self::NONE }
    }

    /// True for bounds of nothing.
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x
    }

    /// Middle of the box, m.
    pub fn center(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    /// Bounds of both.
    pub fn union(&self, other: &Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return if self.is_empty() { *other } else { *self };
        }
        let two_sided = self.two_sided || other.two_sided;
        // The cone of normals that have a twin may point either way.
        let turn = if two_sided && other.two_sided && self.axis.dot(other.axis) < 0.0 { -1.0 } else { 1.0 };
        let (axis, cos_normals) = union_of_cones((self.axis, self.cos_normals), (turn * other.axis, other.cos_normals));
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            axis,
            cos_normals,
            cos_emission: self.cos_emission.min(other.cos_emission),
            two_sided,
            intensity: self.intensity + other.intensity,
        }
    }

    /// Whether everything that `other` bounds is bounded, up to rounding of angles (rad) and lengths (relative).
    pub fn encloses(&self, other: &Self) -> bool {
        const ANGLE: f64 = 1e-3;
        let slack = Vec3::splat(4.0 * f32::EPSILON) * self.min.abs().max(self.max.abs());
        let (mine, theirs) = (angle(self.cos_normals), angle(other.cos_normals));
        let mut apart = angle(self.axis.dot(other.axis));
        if self.two_sided {
            apart = apart.min(PI - apart);
        }
        (self.min - slack).cmple(other.min).all()
            && (self.max + slack).cmpge(other.max).all()
            && (mine >= PI - ANGLE || apart + theirs <= mine + ANGLE)
            && self.cos_emission <= other.cos_emission
            && (self.two_sided || !other.two_sided || mine >= PI - ANGLE)
            && self.intensity >= other.intensity * (1.0 - 1e-4)
    }

    /// The bounds after a similarity, which may mirror: front faces stay front faces (`docs/conventions.md`, winding).
    pub fn transformed(&self, world_from_object: &Affine3A) -> Self {
        let linear = world_from_object.matrix3;
        let (center, half) = (self.center(), 0.5 * (self.max - self.min));
        let center = world_from_object.transform_point3(center);
        let half: Vec3 = (linear.x_axis.abs() * half.x + linear.y_axis.abs() * half.y + linear.z_axis.abs() * half.z).into();
        let axis = world_from_object.transform_vector3(self.axis).normalize_or(Vec3::Z);
        let scale2 = linear.x_axis.length_squared();
        Self { min: center - half, max: center + half, axis, intensity: self.intensity * scale2, ..*self }
    }

    /// The measure that splits are judged by: intensity times the extent of positions times that of directions.
    ///
    /// ```text
    /// I M MΩ,    M = half the surface area,    MΩ = 2π (1 − cos θo) + π/2 (2 θw sin θo − cos(θo − 2 θw) − 2 θo sin θo + cos θo),    θw = min(θo + θe, π)
    /// ```
    ///
    /// \[Estevez18] eq. 1. Deviation: M has a thousandth of the squared diagonal, too, because rows of points have no area.
    pub(super) fn measure(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let Vec3 { x, y, z } = self.max - self.min;
        let extent = x * y + y * z + z * x + ROW * (x * x + y * y + z * z);
        let (o, e) = (angle(self.cos_normals), angle(self.cos_emission));
        let w = (o + e).min(PI);
        let (sin, cos) = o.sin_cos();
        let directions = 2.0 * PI * (1.0 - cos) + FRAC_PI_2 * (2.0 * w * sin - (o - 2.0 * w).cos() - 2.0 * o * sin + cos);
        self.intensity * extent * directions as f32
    }
}

/// True for turns, mirrors, even scales and shifts: what keeps angles, so that bounds of an object hold wherever it is put.
pub fn is_similarity(transform: &Affine3A) -> bool {
    let [x, y, z] = [transform.matrix3.x_axis, transform.matrix3.y_axis, transform.matrix3.z_axis].map(Vec3::from);
    let scale2 = x.length_squared();
    let off = [x.dot(y), y.dot(z), z.dot(x), y.length_squared() - scale2, z.length_squared() - scale2];
    scale2 > 0.0 && off.iter().all(|off| off.abs() <= SIMILAR * scale2)
}

fn angle(cos: f32) -> f64 {
    f64::from(cos.clamp(-1.0, 1.0)).acos()
}

/// The least cone around two cones of directions: axis and cosine of its half angle.
fn union_of_cones((a, cos_a): (Vec3, f32), (b, cos_b): (Vec3, f32)) -> (Vec3, f32) {
    if cos_b < cos_a {
        return union_of_cones((b, cos_b), (a, cos_a));
    }
    let between = a.dot(b);
    // A direction inside of a cone: the usual case while a tree is built, without an angle.
    if cos_a <= -1.0 || (cos_b >= 1.0 && between >= cos_a) {
        return (a, cos_a);
    }
    let (angle_a, angle_b, between) = (angle(cos_a), angle(cos_b), angle(between));
    if (between + angle_b).min(PI) <= angle_a {
        return (a, cos_a);
    }
    let half = 0.5 * (angle_a + between + angle_b);
    let (from, to): (DVec3, DVec3) = (a.into(), b.into());
    let side = (to - from.dot(to) * from).try_normalize();
    match side {
        Some(side) if half < PI => {
            let (sin, cos) = (half - angle_a).sin_cos();
            ((cos * from + sin * side).as_vec3().normalize(), half.cos() as f32)
        }
        // The same axis twice, or cones that leave nothing out; opposite axes have no plane between them.
        _ if between < 1e-3 => (a, half.cos() as f32),
        _ => (a, -1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;
    use crate::warp::uniform_sphere;
    use proptest::prelude::*;

    fn cone(rng: &mut Rng, widest: f32) -> (Vec3, f32) {
        (uniform_sphere(rng.next_2d()), (rng.next_1d() * widest).cos())
    }

    #[test]
    fn cones_around_cones_hold_every_direction_of_both_and_are_tight() {
        let mut rng = Rng::new(1);
        for i in 0..2000 {
            let widest = if i % 2 == 0 { 0.5 } else { 3.1 };
            let (a, b) = (cone(&mut rng, widest), cone(&mut rng, widest));
            let (axis, cos) = union_of_cones(a, b);
            assert!((axis.length() - 1.0).abs() < 1e-5);
            for (other, cos_other) in [a, b] {
                let needed = angle(axis.dot(other)) + angle(cos_other);
                assert!(cos <= -1.0 || needed <= angle(cos) + 1e-3, "{needed} in {}", angle(cos));
            }
            let least = angle(a.1).max(angle(b.1)).max(0.5 * (angle(a.0.dot(b.0)) + angle(a.1) + angle(b.1)));
            assert!(cos <= -1.0 || angle(cos) <= least + 1e-3, "{} and {least}", angle(cos));
        }
        assert_eq!(union_of_cones((Vec3::Z, 1.0), (-Vec3::Z, 1.0)).1, -1.0);
    }

    /// MΩ is the integral of the cosine falloff outside of the normals: 2π (1 − cos θo) + 2π ∫ cos(θ − θo) sin θ dθ from θo to θw.
    #[test]
    fn the_measure_of_directions_is_its_integral() {
        for (o, e) in [(0.0f64, FRAC_PI_2), (0.4, FRAC_PI_2), (1.0, 0.3), (2.0, FRAC_PI_2), (PI, FRAC_PI_2)] {
            let w = (o + e).min(PI);
            let steps = 20_000;
            let h = (w - o) / f64::from(steps);
            let integral: f64 = (0..steps).map(|i| (o + (f64::from(i) + 0.5) * h, h)).map(|(t, h)| (t - o).cos() * t.sin() * h).sum();
            let exact = 2.0 * PI * (1.0 - o.cos()) + 2.0 * PI * integral;
            let bounds = EmitterBounds {
                min: Vec3::ZERO,
                max: Vec3::new(1.0, 1.0, 0.0),
                cos_normals: o.cos() as f32,
                cos_emission: e.cos() as f32,
                intensity: 1.0 / (1.0 + 2.0 * ROW),
                ..EmitterBounds::NONE
            };
            assert!((f64::from(bounds.measure()) / exact - 1.0).abs() < 1e-3, "{o}, {e}: {} and {exact}", bounds.measure());
        }
    }

    #[test]
    fn twins_of_normals_turn_to_each_other() {
        let up = EmitterBounds::triangle([Vec3::ZERO, Vec3::X, Vec3::Y], 1.0, true);
        let down = EmitterBounds::triangle([Vec3::ZERO, Vec3::Y, Vec3::X], 1.0, true);
        assert_eq!(up.union(&down).cos_normals, 1.0);
        let single = EmitterBounds { two_sided: false, ..down };
        assert_eq!(up.union(&single).cos_normals, -1.0);
    }

    proptest! {
        #[test]
        fn bounds_of_both_enclose_each_and_a_planted_fault_is_seen(seed: u64) {
            let mut rng = Rng::new(seed);
            let mut one = || {
                let corners = [(); 3].map(|()| uniform_sphere(rng.next_2d()) * 3.0 * rng.next_1d());
                let surface = EmitterBounds::triangle(corners, rng.next_1d(), rng.next_1d() < 0.3);
                // As spots have it.
                EmitterBounds { cos_emission: [0.0, 0.5, 0.9][rng.next_u32() as usize % 3], ..surface }
            };
            let (a, b, c) = (one(), one(), one());
            let all = a.union(&b).union(&c);
            prop_assert!([a, b, c].iter().all(|e| all.encloses(e)));
            prop_assert!((all.intensity - a.intensity - b.intensity - c.intensity).abs() < 1e-4);
            let higher = EmitterBounds { max: c.max + Vec3::Y * 7.0, ..c };
            let wider = EmitterBounds { cos_emission: all.cos_emission - 0.1, ..c };
            prop_assert!(!all.encloses(&higher) && !all.encloses(&wider));
        }

        #[test]
        fn transformed_bounds_enclose_transformed_triangles(seed: u64, mirror: bool) {
            let mut rng = Rng::new(seed);
            let corners = [(); 3].map(|()| uniform_sphere(rng.next_2d()));
            let turn = glam::Quat::from_rotation_arc(Vec3::Z, uniform_sphere(rng.next_2d()));
            let scale = Vec3::splat(0.2 + 3.0 * rng.next_1d()) * if mirror { Vec3::new(-1.0, 1.0, 1.0) } else { Vec3::ONE };
            let to_world = Affine3A::from_scale_rotation_translation(scale, turn, Vec3::new(1.0, -2.0, 0.5));
            prop_assert!(is_similarity(&to_world));
            prop_assert!(!is_similarity(&(to_world * Affine3A::from_scale(Vec3::new(1.0, 1.2, 1.0)))));
            let object = EmitterBounds::triangle(corners, 2.0, false).transformed(&to_world);
            let [a, b, c] = corners.map(|p| to_world.transform_point3(p));
            // Mirrored triangles run the other way round.
            let world = EmitterBounds::triangle(if mirror { [a, c, b] } else { [a, b, c] }, 2.0, false);
            prop_assert!(object.axis.dot(world.axis) > 0.999);
            prop_assert!((object.intensity / world.intensity - 1.0).abs() < 1e-3);
            let axis = EmitterBounds { axis: object.axis, intensity: object.intensity, ..world };
            let slack = EmitterBounds { min: object.min - 1e-5, max: object.max + 1e-5, ..object };
            prop_assert!(slack.encloses(&axis));
        }
    }
}
