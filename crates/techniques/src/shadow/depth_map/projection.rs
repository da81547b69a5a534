//! The projections of a light's maps.

use super::MAX_FACES;
use crate::{FrameContext, FrameLight};
use glam::{Mat4, Vec3, Vec4};
use kajo_scene::LightShape;

/// Maps of one light.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::shadow) struct Projection {
    /// One matrix for each map; camera-relative to clip space with reversed depth.
    pub faces: Vec<Mat4>,
    /// Whether a point that the camera sees may be looked up in the map; others are not drawn.
    pub is_used: [bool; MAX_FACES],
    /// The maps are the faces +x, −x, +y, −y, +z, −z of a cube.
    pub cube: bool,
    /// Parallel rays.
    pub parallel: bool,
    /// Near plane of maps with perspective, m.
    pub near: f32,
    /// Where linear depth ends, along the axis of the map, m: from the light, or of parallel maps from where it begins.
    pub far: f32,
    /// Texels at the border of a map in which no point is looked up.
    pub margin: f32,
}

impl Projection {
    /// The same, with the maps found that nothing visible can lie in: those that neither the scene's box nor the camera's frustum reaches into.
    pub fn used_by(mut self, frame: &FrameContext) -> Self {
        let scene = corners(relative_bounds(frame));
        let seen = Frustum::of(frame).corners();
        for (is_used, clip_from_relative) in self.is_used.iter_mut().zip(&self.faces) {
            *is_used = reaches_into(&scene, clip_from_relative) && reaches_into(&seen, clip_from_relative);
        }
        self
    }
}

/// False where all points lie beyond one of the four sides of a map.
fn reaches_into(points: &[Vec3], clip_from_relative: &Mat4) -> bool {
    let clip: Vec<Vec4> = points.iter().map(|p| *clip_from_relative * p.extend(1.0)).collect();
    let beyond = |off: fn(&Vec4) -> f32| clip.iter().all(|c| off(c) > 0.0);
    !(beyond(|c| c.x - c.w) || beyond(|c| -c.x - c.w) || beyond(|c| c.y - c.w) || beyond(|c| -c.y - c.w))
}

/// What a projection is fitted to.
#[derive(Clone, Copy)]
pub(in crate::shadow) struct Fit<'a> {
    /// The light.
    pub light: &'a FrameLight,
    /// Camera and scene.
    pub frame: &'a FrameContext<'a>,
    /// Side of a map, px.
    pub resolution: u32,
    /// Texels from a point to the furthest that is read for it.
    pub reach: f32,
}

/// Spot lights wider than this get a cube: one perspective image would waste most of its texels.
const WIDEST_SPOT: f32 = 75.0 * std::f32::consts::PI / 180.0;

/// Near plane of perspective maps in units of the size of the scene: nothing that matters is nearer to a light.
const NEAR: f32 = 1e-4;

/// Keeps the sum of what a map holds finite.
pub(super) const MAX_FAR: f32 = 1e30;

/// One map for spots and directional lights, fitted to the scene and to what the camera sees, a cube for all others.
pub(in crate::shadow) fn fit(of: &Fit) -> Projection {
    match of.light.analytic().map(|placed| placed.light.shape) {
        Some(LightShape::Directional { .. }) => directional(of),
        Some(LightShape::Spot { outer, .. }) if outer.0 < WIDEST_SPOT => towards(of, &[axis(of.light)], outer.0.max(1e-3).tan()),
        _ => {
            let directions = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
            Projection { cube: true, ..towards(of, &directions, 1.0) }
        }
    }
}

/// The direction in which a light shines, −z for those that have none.
pub(in crate::shadow) fn axis(light: &FrameLight) -> Vec3 {
    let z = light.analytic().map_or(Vec3::Z, |placed| Vec3::from(placed.world_from_light.matrix3.z_axis));
    -z.normalize_or(Vec3::Z)
}

/// Maps with perspective from the middle of the light; `half` is half the side of each at distance 1, without the margin.
fn towards(of: &Fit, directions: &[Vec3], half: f32) -> Projection {
    let position = of.light.center() - of.frame.view.position;
    let near = (of.frame.bounds[1] - of.frame.bounds[0]).length().max(1e-3) * NEAR;
    let margin = of.reach + 1.0;
    let half = half * (1.0 + 2.0 * margin / of.resolution as f32);
    let furthest = corners(relative_bounds(of.frame)).iter().map(|corner| corner.distance(position)).fold(0.0, f32::max);
    let faces = directions.iter().map(|&direction| perspective(position, direction, half, near)).collect();
    Projection {
        faces,
        is_used: [true; MAX_FACES],
        cube: false,
        parallel: false,
        near,
        far: (furthest * 1.001).max(2.0 * near),
        margin: 0.0,
    }
}

/// Axes of an image whose viewer looks along `forward`: x, y and −forward.
pub(in crate::shadow) fn axes(forward: Vec3) -> [Vec3; 3] {
    let (x, y) = (-forward).any_orthonormal_pair();
    [x, y, -forward]
}

/// The rotation into the axes of an image.
pub(in crate::shadow) fn rotation([x, y, back]: [Vec3; 3]) -> Mat4 {
    Mat4::from_cols(x.extend(0.0), y.extend(0.0), back.extend(0.0), Vec4::W).transpose()
}

/// Seen from `position` along `forward`; `half` is half the image at distance 1. Depth is near / distance.
fn perspective(position: Vec3, forward: Vec3, half: f32, near: f32) -> Mat4 {
    let projection = Mat4::from_cols(Vec4::X / half, Vec4::Y / half, Vec4::new(0.0, 0.0, 0.0, -1.0), Vec4::new(0.0, 0.0, near, 0.0));
    projection * rotation(axes(forward)) * Mat4::from_translation(-position)
}

/// Parallel rays: a box in the axes of the image. Depth falls from 1 to 0 away from the light.
pub(in crate::shadow) fn parallel([x, y, back]: [Vec3; 3], middle: [f32; 2], half: [f32; 2], depth: [f32; 2]) -> Mat4 {
    let span = depth[1] - depth[0];
    let corner = x * middle[0] + y * middle[1] + back * depth[0];
    let scale = Mat4::from_cols(Vec4::X / half[0], Vec4::Y / half[1], Vec4::Z / span, Vec4::W);
    scale * rotation([x, y, back]) * Mat4::from_translation(-corner)
}

/// As wide as what can be seen and casts shadows, as deep as everything.
fn directional(of: &Fit) -> Projection {
    let [x, y, back] = axes(axis(of.light));
    let scene = corners(relative_bounds(of.frame));
    let visible = Frustum::of(of.frame).corners().to_vec();
    let across = |axis: Vec3| {
        let ([a, b], [c, d]) = (range(&scene, axis), range(&visible, axis));
        let (low, high) = (a.max(c), b.min(d));
        if low < high { [low, high] } else { [a, b] }
    };
    let margin = of.reach + 1.0;
    let wider = 1.0 + 2.0 * margin / of.resolution as f32;
    let ([x0, x1], [y0, y1]) = (across(x), across(y));
    let half = [x1 - x0, y1 - y0].map(|side| (0.5 * side).max(1e-4) * wider);
    let depth = depth_of(range(&scene, back), half);
    Projection {
        faces: vec![parallel([x, y, back], [0.5 * (x0 + x1), 0.5 * (y0 + y1)], half, depth)],
        is_used: [true; MAX_FACES],
        cube: false,
        parallel: true,
        near: 0.0,
        far: depth[1] - depth[0],
        margin: 0.0,
    }
}

/// The range of depth of a map, a little more than the casters fill: a scene flat across the light keeps some, since coordinates are rounded in
/// units of its width.
pub(in crate::shadow) fn depth_of([low, high]: [f32; 2], half: [f32; 2]) -> [f32; 2] {
    let span = (high - low).max(0.01 * half[0].max(half[1])) * 1.001;
    let start = low - 0.0005 * span;
    [start, start + span]
}

/// Least and greatest coordinate along an axis.
pub(in crate::shadow) fn range(points: &[Vec3], axis: Vec3) -> [f32; 2] {
    points.iter().map(|p| p.dot(axis)).fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

/// The box around the scene, camera-relative.
pub(in crate::shadow) fn relative_bounds(frame: &FrameContext) -> [Vec3; 2] {
    frame.bounds.map(|corner| corner - frame.view.position)
}

pub(in crate::shadow) fn corners([low, high]: [Vec3; 2]) -> Vec<Vec3> {
    let pick = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
    (0..8).map(|corner| Vec3::new(pick(corner, 0), pick(corner, 1), pick(corner, 2))).collect()
}

/// What the camera sees between its near plane and the far side of the scene, camera-relative.
#[derive(Clone, Copy, Debug)]
pub(in crate::shadow) struct Frustum {
    /// Corners on the near plane.
    on_near: [Vec3; 4],
    forward: Vec3,
    perspective: bool,
    /// Distance of the near plane, m.
    pub near: f32,
    /// Distance of the farthest part of the scene along the viewing axis, m.
    pub far: f32,
}

impl Frustum {
    pub fn of(frame: &FrameContext) -> Self {
        let forward = frame.view.relative_from_view.transform_vector3(Vec3::NEG_Z);
        let far = range(&corners(relative_bounds(frame)), forward)[1].max(frame.view.near);
        let relative_from_clip = frame.view.clip_from_relative().as_dmat4().inverse();
        let on_near = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|(x, y)| {
            let p = relative_from_clip * glam::dvec4(x, y, 1.0, 1.0);
            (p.truncate() / p.w).as_vec3()
        });
        Self { on_near, forward, perspective: frame.view.perspective, near: frame.view.near, far }
    }

    /// The four corners at a distance along the viewing axis.
    pub fn at(&self, distance: f32) -> [Vec3; 4] {
        let (near, forward) = (self.near, self.forward);
        self.on_near.map(|p| if self.perspective { p * (distance / near) } else { p + forward * (distance - p.dot(forward)) })
    }

    /// Middle of the view at a distance along the viewing axis.
    pub fn on_axis(&self, distance: f32) -> Vec3 {
        self.at(distance).iter().sum::<Vec3>() * 0.25
    }

    /// The smallest sphere around a part of the view whose middle lies on the axis: the distance of its middle, and its radius.
    pub fn sphere(&self, [start, end]: [f32; 2]) -> (f32, f32) {
        let aside = |distance: f32| self.at(distance)[0].distance_squared(self.on_axis(distance));
        let (near, far) = (aside(start), aside(end));
        // As far from the corners in front as from those behind, or in the middle of the far side.
        let middle = (0.5 * (start + end + (far - near) / (end - start).max(f32::MIN_POSITIVE))).clamp(start, end);
        let radius = (near + (middle - start).powi(2)).max(far + (end - middle).powi(2));
        (middle, radius.sqrt())
    }

    /// All eight.
    pub fn corners(&self) -> [Vec3; 8] {
        let (near, far) = (self.at(self.near), self.at(self.far));
        std::array::from_fn(|i| if i < 4 { near[i] } else { far[i - 4] })
    }
}

#[cfg(test)]
impl Frustum {
    /// A square one with this tangent of half its angle.
    pub fn looking_along_minus_z(tangent: f32, near: f32, far: f32) -> Self {
        let on_near =
            [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|(x, y)| Vec3::new(x * tangent * near, y * tangent * near, -near));
        Self { on_near, forward: Vec3::NEG_Z, perspective: true, near, far }
    }
}
