//! Where the probes of a scene stand.

use glam::{UVec3, Vec3};

/// Distance of the outermost probes from the bounds, in steps.
const INSET: f32 = 0.25;

/// Least extent of the grid along an axis, as a share of the longest: a floor alone has probes over and under it.
const LEAST_EXTENT: f32 = 0.05;

/// Probes along each axis (2 or more), the place of the first one and the step between them, m: `longest` probes along the longest axis of the bounds, and
/// steps about as long along the others.
pub(super) fn grid_over([low, high]: [Vec3; 2], longest: u32) -> (UVec3, Vec3, Vec3) {
    let extent = (high - low).max(Vec3::splat((high - low).max_element() * LEAST_EXTENT)).max(Vec3::splat(f32::MIN_POSITIVE));
    let step = extent.max_element() / steps(longest);
    let count = extent.to_array().map(|along| ((along / step - 2.0 * INSET).round() as u32 + 1).clamp(2, longest));
    let step = extent / Vec3::from_array(count.map(steps));
    (UVec3::from_array(count), 0.5 * (low + high) - 0.5 * extent + INSET * step, step)
}

/// Steps that fill an extent in which `count` probes stand.
fn steps(count: u32) -> f32 {
    (count - 1) as f32 + 2.0 * INSET
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probes_fill_the_bounds_evenly() {
        let bounds = [Vec3::new(-3.0, 0.0, -1.6), Vec3::new(3.0, 2.6, 1.6)];
        let (count, first, step) = grid_over(bounds, 16);
        assert_eq!(count, UVec3::new(16, 7, 9));
        let last = first + step * (count - 1).as_vec3();
        assert!((first - INSET * step).abs_diff_eq(bounds[0], 1e-5) && (last + INSET * step).abs_diff_eq(bounds[1], 1e-5));
        assert!(step.max_element() / step.min_element() < 1.2, "{step}");
    }

    #[test]
    fn flat_and_single_points_have_a_grid() {
        let (count, first, step) = grid_over([Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 0.0, 1.0)], 8);
        assert!(count.y == 2 && first.y < 0.0 && first.y + step.y > 0.0);
        let (count, first, step) = grid_over([Vec3::ONE; 2], 4);
        assert!(count.min_element() >= 2 && first.is_finite() && step.min_element() > 0.0);
    }
}
