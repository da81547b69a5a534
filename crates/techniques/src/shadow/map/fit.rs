//! The projections of a light's maps.

use crate::{FrameContext, FrameLight};
use glam::{Mat4, Vec3, Vec4};
use kajo_scene::LightShape;

/// Maps of one light.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Projection {
    /// One matrix, or six for a cube; camera-relative to clip space with reversed depth.
    pub clip_from_relative: Vec<Mat4>,
    /// Parallel rays.
    pub parallel: bool,
    /// Size of a texel across the rays: m, or m for each metre along the axis of the face.
    pub texel: f32,
}

/// Spot lights wider than this get a cube: one perspective image would waste most of its texels.
const WIDEST_SPOT: f32 = 75.0 * std::f32::consts::PI / 180.0;

/// Near plane of perspective maps in units of the size of the scene: nothing that matters is nearer to a light.
const NEAR: f32 = 1e-4;

/// Fits the maps of a light to the scene and to what the camera sees.
pub(super) fn fit(light: &FrameLight, frame: &FrameContext, resolution: u32, kernel: u32) -> Projection {
    let position = light.center() - frame.view.position;
    let near = (frame.bounds[1] - frame.bounds[0]).length().max(1e-3) * NEAR;
    // Texels that the filter may read beyond the border of a face.
    let margin = 1.0 + 2.0 * (kernel as f32 + 2.0) / resolution as f32;
    let shape = light.analytic().map(|placed| {
        let z = Vec3::from(placed.world_from_light.matrix3.z_axis).normalize_or(Vec3::Z);
        (placed.light.shape, z)
    });
    match shape {
        Some((LightShape::Directional { .. }, z)) => directional(z, frame, resolution, margin),
        Some((LightShape::Spot { outer, .. }, z)) if outer.0 < WIDEST_SPOT => {
            let half = outer.0.max(1e-3).tan() * margin;
            Projection {
                clip_from_relative: vec![perspective(position, -z, half, near)],
                parallel: false,
                texel: 2.0 * half / resolution as f32,
            }
        }
        _ => {
            let directions = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
            Projection {
                clip_from_relative: directions.map(|direction| perspective(position, direction, margin, near)).to_vec(),
                parallel: false,
                texel: 2.0 * margin / resolution as f32,
            }
        }
    }
}

/// Axes of an image whose viewer looks along `forward`: x, y and −forward.
fn axes(forward: Vec3) -> [Vec3; 3] {
    let (x, y) = (-forward).any_orthonormal_pair();
    [x, y, -forward]
}

/// Seen from `position` along `forward`; `half` is half the image at distance 1. Depth is near / distance.
fn perspective(position: Vec3, forward: Vec3, half: f32, near: f32) -> Mat4 {
    let [x, y, back] = axes(forward);
    let rotation = Mat4::from_cols(x.extend(0.0), y.extend(0.0), back.extend(0.0), Vec4::W).transpose();
    let projection = Mat4::from_cols(Vec4::X / half, Vec4::Y / half, Vec4::new(0.0, 0.0, 0.0, -1.0), Vec4::new(0.0, 0.0, near, 0.0));
    projection * rotation * Mat4::from_translation(-position)
}

/// Parallel rays along −`z`: as wide as what can be seen and casts shadows, as deep as everything. Depth falls from 1 to 0 away from the light.
fn directional(z: Vec3, frame: &FrameContext, resolution: u32, margin: f32) -> Projection {
    let [x, y, back] = axes(-z);
    let range = |points: &[Vec3], axis: Vec3| {
        points.iter().map(|p| p.dot(axis)).fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    let scene = corners(frame.bounds.map(|corner| corner - frame.view.position));
    let visible = visible_corners(frame, &scene);
    let across = |axis: Vec3| {
        let ([a, b], [c, d]) = (range(&scene, axis), range(&visible, axis));
        let (low, high) = (a.max(c), b.min(d));
        if low < high { [low, high] } else { [a, b] }
    };
    let ([x0, x1], [y0, y1], [z0, z1]) = (across(x), across(y), range(&scene, back));
    let half = |low: f32, high: f32| (0.5 * (high - low)).max(1e-4) * margin;
    let (half_x, half_y) = (half(x0, x1), half(y0, y1));
    // A scene flat across the light keeps some depth: coordinates are rounded in units of its width.
    let depth = (z1 - z0).max(0.01 * half_x.max(half_y)) * 1.001;
    let middle = x * (0.5 * (x0 + x1)) + y * (0.5 * (y0 + y1)) + back * (z0 - 0.0005 * depth);
    let rotation = Mat4::from_cols(x.extend(0.0), y.extend(0.0), back.extend(0.0), Vec4::W).transpose();
    let scale = Mat4::from_cols(Vec4::X / half_x, Vec4::Y / half_y, Vec4::Z / depth, Vec4::W);
    Projection {
        clip_from_relative: vec![scale * rotation * Mat4::from_translation(-middle)],
        parallel: true,
        texel: 2.0 * half_x.max(half_y) / resolution as f32,
    }
}

fn corners([low, high]: [Vec3; 2]) -> Vec<Vec3> {
    let pick = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
    (0..8).map(|corner| Vec3::new(pick(corner, 0), pick(corner, 1), pick(corner, 2))).collect()
}

/// Corners of the camera's frustum between the camera and the far side of the scene, camera-relative.
fn visible_corners(frame: &FrameContext, scene: &[Vec3]) -> Vec<Vec3> {
    let forward = frame.view.relative_from_view.transform_vector3(Vec3::NEG_Z);
    let far = scene.iter().map(|p| p.dot(forward)).fold(frame.view.near, f32::max);
    let relative_from_clip = frame.view.clip_from_relative().as_dmat4().inverse();
    let mut out = Vec::with_capacity(8);
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let p = relative_from_clip * glam::dvec4(x, y, 1.0, 1.0);
        let on_near = (p.truncate() / p.w).as_vec3();
        out.push(on_near);
        out.push(if frame.view.perspective { on_near * (far / frame.view.near) } else { on_near + forward * (far - on_near.dot(forward)) });
    }
    out
}
