//! Where cascades begin and end, and the maps that cover them.

use super::Params;
use crate::shadow::depth_map::{Fit, Frustum, MAX_FACES, Projection, axes, axis, corners, depth_of, fit, parallel, range, relative_bounds};
use glam::Vec3;
use kajo_scene::LightShape;

/// The maps of a directional light, nearest first; other lights have the plain ones.
pub(super) fn fit_cascades(of: &Fit, params: &Params) -> Projection {
    match of.light.analytic().map(|placed| placed.light.shape) {
        Some(LightShape::Directional { .. }) => {}
        _ => return fit(of),
    }
    let frustum = Frustum::of(of.frame);
    let light_axes = axes(axis(of.light));
    let ends = ends(&frustum, params);
    let starts = std::iter::once(frustum.near).chain(ends.iter().copied());
    let margin = of.reach + 1.0;
    let slice = |(start, end): (f32, &f32)| {
        if params.stable {
            return steady(of, &frustum, [start, *end], margin);
        }
        let points: Vec<Vec3> = frustum.at(start).into_iter().chain(frustum.at(*end)).collect();
        tight(&points, light_axes, of, margin)
    };
    let slices: Vec<([f32; 2], [f32; 2])> = starts.zip(&ends).map(slice).collect();
    let widest = slices.iter().flat_map(|(_, half)| *half).fold(0.0, f32::max);
    let depth = depth_of(range(&corners(relative_bounds(of.frame)), light_axes[2]), [widest; 2]);
    Projection {
        faces: slices.iter().map(|(middle, half)| parallel(light_axes, *middle, *half, depth)).collect(),
        is_used: [true; MAX_FACES],
        cube: false,
        parallel: true,
        near: 0.0,
        far: depth[1] - depth[0],
        margin,
    }
}

/// Where the factor of logarithmic splits begins, as a share of the far end: nearer, perspective would spend maps on what is hardly seen.
const NEAREST: f32 = 1.0 / 512.0;

/// Ends of the cascades, m: a mean of equal lengths and equal factors.    \[Zhang06\] eq. 3
///
/// ```text
/// C_i = λ n (f/n)^(i/m) + (1 − λ) (n + (f − n) i/m)
/// ```
fn ends(frustum: &Frustum, params: &Params) -> Vec<f32> {
    let mut far = if params.distance.0 > 0.0 { params.distance.0.min(frustum.far) } else { frustum.far };
    if params.stable && params.distance.0 == 0.0 {
        // A far end that follows the camera would resize every map with each step.
        far = 2f32.powf((2.0 * far.log2()).ceil() * 0.5);
    }
    let near = frustum.near.max(far * NEAREST).min(0.5 * far);
    let end = |i: u32| {
        let t = i as f32 / params.cascades as f32;
        params.lambda * near * (far / near).powf(t) + (1.0 - params.lambda) * (near + (far - near) * t)
    };
    (1..=params.cascades).map(end).collect()
}

/// The smallest box in the axes of the map around a slice.
fn tight(points: &[Vec3], [x, y, _]: [Vec3; 3], of: &Fit, margin: f32) -> ([f32; 2], [f32; 2]) {
    let wider = of.resolution as f32 / (of.resolution as f32 - 2.0 * margin).max(1.0);
    let ([x0, x1], [y0, y1]) = (range(points, x), range(points, y));
    ([0.5 * (x0 + x1), 0.5 * (y0 + y1)], [0.5 * (x1 - x0) * wider, 0.5 * (y1 - y0) * wider])
}

/// A square around the sphere around a slice: its size does not change as the camera turns, and its middle moves by whole texels of a grid that
/// stands still in the world.    \[Valient08\]
fn steady(of: &Fit, frustum: &Frustum, [start, end]: [f32; 2], margin: f32) -> ([f32; 2], [f32; 2]) {
    let (distance, radius) = frustum.sphere([start, end]);
    let radius = round_up(radius);
    let half = radius * of.resolution as f32 / (of.resolution as f32 - 2.0 * (margin + 1.0)).max(1.0);
    let texel = f64::from(2.0 * half / of.resolution as f32);
    let middle = frustum.on_axis(distance);
    let eye = of.frame.view.position.as_dvec3();
    let [x, y, _] = axes(axis(of.light));
    let on_grid = |axis: Vec3| {
        let (axis, relative) = (axis.as_dvec3(), middle.as_dvec3());
        let world = (relative + eye).dot(axis);
        ((world / texel).round() * texel - eye.dot(axis)) as f32
    };
    ([on_grid(x), on_grid(y)], [half; 2])
}

/// Up to eight digits after the leading one: what rotations round must not resize a map.
fn round_up(radius: f32) -> f32 {
    let step = 2f32.powf(radius.log2().floor() - 8.0);
    (radius / step).ceil() * step
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_units::Meters;

    fn params() -> Params {
        Params { resolution: 1024, cascades: 4, lambda: 1.0, distance: Meters(0.0), kernel: 0, stable: false }
    }

    #[test]
    fn lambda_goes_from_equal_lengths_to_equal_factors() {
        let frustum = Frustum::looking_along_minus_z(0.5, 1.0, 256.0);
        let logarithmic = ends(&frustum, &params());
        let uniform = ends(&frustum, &Params { lambda: 0.0, ..params() });
        for (got, expected) in logarithmic.iter().chain(&uniform).zip([4.0, 16.0, 64.0, 256.0, 64.75, 128.5, 192.25, 256.0]) {
            assert!((got - expected).abs() < 1e-3 * expected, "{logarithmic:?} {uniform:?}");
        }
        let nearer = ends(&frustum, &Params { distance: Meters(16.0), ..params() });
        assert!((nearer[3] - 16.0).abs() < 1e-3 && nearer[0] < 4.0);
    }

    #[test]
    fn the_far_end_changes_in_steps() {
        let far = |far| *ends(&Frustum::looking_along_minus_z(0.5, 1.0, far), &Params { stable: true, ..params() }).last().unwrap();
        assert_eq!(far(200.0), far(250.0));
        assert!((far(200.0) - 256.0).abs() < 0.01 && far(257.0) > 300.0);
    }

    #[test]
    fn sizes_are_rounded_up_by_little() {
        for radius in [0.37f32, 1.0, 5.3, 812.0] {
            let rounded = round_up(radius);
            assert!(rounded >= radius && rounded < radius * 1.005, "{radius} {rounded}");
            assert_eq!(round_up(rounded * 0.9999), rounded, "rounding errors of a rotation do not matter");
        }
    }
}
