//! A parallel map whose texels shrink towards the viewer.

use crate::shadow::depth_map::{Fit, Frustum, MAX_FACES, Projection, axis, corners, depth_of, fit, range, relative_bounds, rotation};
use glam::{Mat4, Vec3, Vec4};
use kajo_scene::LightShape;

/// The map of a directional light; other lights have the plain ones, and so has a light along the viewing axis, where the view's perspective does not
/// show on the map.
pub(super) fn fit_warped(of: &Fit, strength: f32) -> Projection {
    let back = -axis(of.light);
    let frustum = Frustum::of(of.frame);
    let forward = (frustum.on_axis(frustum.far) - frustum.on_axis(frustum.near)).normalize_or(Vec3::NEG_Z);
    let sine = forward.reject_from_normalized(back).length();
    let directional = of.light.analytic().is_some_and(|placed| matches!(placed.light.shape, LightShape::Directional { .. }));
    if !directional || sine < SMALLEST_SINE || strength == 0.0 || !of.frame.view.perspective {
        return fit(of);
    }
    let up = forward.reject_from_normalized(back).normalize();
    let light_axes = [up.cross(back), up, back];
    let body = body(of, &frustum);
    let scene = corners(relative_bounds(of.frame));
    // What is seen is within the scene; the frustum alone would reach far beyond.
    let within = |axis: Vec3| {
        let ([a, b], [c, d]) = (range(&body, axis), range(&scene, axis));
        [a.max(c), b.min(d)]
    };
    let [y0, y1] = within(up);
    if y1 - y0 <= 0.0 {
        return fit(of);
    }
    let view = seen_range(&body, forward, frustum.near);
    // The error is even where the viewer's own perspective is made up for.    [Wimmer04] eq. 3
    let nearest = view[0].max(view[1] * NEAREST);
    let start = (nearest + (nearest * view[1]).sqrt()) / sine / strength;
    let [y_near, y_far] = [start, start + (y1 - y0)];
    let depth = depth_of(range(&scene, back), [0.5 * (y1 - y0); 2]);
    let matrix = matrix(&body, light_axes, within(light_axes[0]), [y0 - start, y_near, y_far], depth, of);
    Projection {
        faces: vec![matrix],
        is_used: [true; MAX_FACES],
        cube: false,
        parallel: true,
        near: 0.0,
        far: depth[1] - depth[0],
        margin: 0.0,
    }
}

/// Sine of the angle between light and view under which a warp gains nothing.
const SMALLEST_SINE: f32 = 0.05;

/// The nearest distance that the warp is made for, as a share of the farthest: for what is nearer, hardly any of which is seen, the rest of the map would
/// become coarse.
const NEAREST: f32 = 1.0 / 64.0;

/// Corners of what the camera sees.
fn body(of: &Fit, frustum: &Frustum) -> Vec<Vec3> {
    let scene = relative_bounds(of.frame);
    let forward = frustum.on_axis(1.0).normalize_or(Vec3::NEG_Z);
    let nearest = range(&corners(scene), forward)[0].max(frustum.near);
    frustum.at(nearest).into_iter().chain(frustum.at(frustum.far)).collect()
}

fn seen_range(body: &[Vec3], forward: Vec3, near: f32) -> [f32; 2] {
    let [low, high] = range(body, forward);
    [low.max(near), high.max(2.0 * near)]
}

/// x and y are divided by the distance along y from a centre behind the viewer; so is depth, which falls from the light on as before.
///
/// ```text
/// x' = (x − x_m) / (k y),   y' = (y (f + n) − 2 f n) / (y (f − n)),   z' = n (z − z_0) / (y (z_1 − z_0))
/// ```
fn matrix(body: &[Vec3], [x, y, back]: [Vec3; 3], [x0, x1]: [f32; 2], [origin, near, far]: [f32; 3], depth: [f32; 2], of: &Fit) -> Mat4 {
    let wider = 1.0 + 2.0 * (of.reach + 1.0) / of.resolution as f32;
    let eye_x = 0.5 * (x0 + x1);
    // Widest slope of what is seen around the line through the middle.
    let slope = |p: &Vec3| ((p.dot(x).clamp(x0, x1) - eye_x) / (p.dot(y) - origin).max(near)).abs();
    let widest = body.iter().map(slope).fold(1e-6, f32::max) * wider;
    // The border of the filter stretches y, too.
    let border = (far - near) * 0.5 * (wider - 1.0) + 1e-6 * far;
    let (near, far) = ((near - border).max(0.5 * near), far + border);
    let span = far - near;
    let warp = Mat4::from_cols(
        Vec4::new(1.0 / widest, 0.0, 0.0, 0.0),
        Vec4::new(0.0, (far + near) / span, 0.0, 1.0),
        Vec4::new(0.0, 0.0, near / (depth[1] - depth[0]), 0.0),
        Vec4::new(0.0, -2.0 * far * near / span, 0.0, 0.0),
    );
    let corner = x * eye_x + y * origin + back * depth[0];
    warp * rotation([x, y, back]) * Mat4::from_translation(-corner)
}
