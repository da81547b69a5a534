//! Which casters matter, from boxes around them. Coordinates are camera-relative.

use crate::{FrameLight, View};
use glam::{Affine3A, Vec3, Vec4};
use kajo_scene::LightShape;

/// Share of a box's extent by which it is made larger: covers what rounds its corners.
const MARGIN: f32 = 1e-4;

/// A box along the axes of the world around a placed mesh: its eight corners.
pub(super) fn relative_box([low, high]: [Vec3; 2], world_from_object: &Affine3A, camera: Vec3) -> [Vec3; 2] {
    let pick = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
    let corner = |i: usize| world_from_object.transform_point3(Vec3::new(pick(i, 0), pick(i, 1), pick(i, 2))) - camera;
    let [a, b] = (0..8).map(corner).fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[a, b], p| [a.min(p), b.max(p)]);
    let margin = Vec3::splat(MARGIN * ((b - a).max_element() + a.abs().max(b.abs()).max_element()));
    [a - margin, b + margin]
}

/// A light as volumes see it: a point, or a direction towards it with w = 0.
pub(super) fn light_point(light: &FrameLight, camera: Vec3) -> Vec4 {
    match light.analytic() {
        Some(placed) if matches!(placed.light.shape, LightShape::Directional { .. }) => {
            Vec3::from(placed.world_from_light.matrix3.z_axis).normalize_or(Vec3::Z).extend(0.0)
        }
        _ => (light.center() - camera).extend(1.0),
    }
}

/// Whether the light is inside of the box.
pub(super) fn holds([low, high]: &[Vec3; 2], light: Vec4) -> bool {
    light.w != 0.0 && light.truncate().cmpge(*low).all() && light.truncate().cmple(*high).all()
}

/// Whether viewing rays may begin inside of the box: it comes as near to the camera as the near plane.
pub(super) fn is_near([low, high]: &[Vec3; 2], view: &View) -> bool {
    let forward = view.relative_from_view.transform_vector3(Vec3::NEG_Z);
    if !view.perspective {
        // Nothing before the near plane is seen, so a box that lies beyond it everywhere holds the start of no ray.
        return nearest_along(low, high, forward) <= view.near;
    }
    let corner = view.clip_from_relative().as_dmat4().inverse() * glam::DVec4::ONE;
    let reach = (corner.truncate() / corner.w).length() as f32;
    Vec3::ZERO.clamp(*low, *high).length() <= reach
}

fn nearest_along(low: &Vec3, high: &Vec3, axis: Vec3) -> f32 {
    (*low * axis).min(*high * axis).element_sum()
}

/// Whether no part of the box and of the shadow behind it is within the view.
pub(super) fn is_out_of_sight([low, high]: &[Vec3; 2], light: Vec4, view: &View) -> bool {
    let rows = view.clip_from_relative().transpose();
    let (x, y, w) = (rows.x_axis, rows.y_axis, rows.w_axis);
    // One pixel more on each side: jitter moves the view by less.
    let wide = w * (1.0 + 2.0 / view.size.min_element() as f32);
    let planes = [wide + x, wide - x, wide + y, wide - y, w];
    let corner = |i: usize| Vec3::select(glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0), *high, *low);
    let beyond = |plane: &Vec4| {
        (0..8).map(corner).all(|p| plane.dot(p.extend(1.0)) < 0.0 && plane.truncate().dot(p * light.w - light.truncate()) < 0.0)
    };
    planes.iter().any(beyond)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Mat4, UVec2};
    use kajo_scene::{Camera, PlacedCamera, Projection};
    use kajo_units::{Meters, Radians};

    /// At the origin, looking along −z, 90° wide.
    fn view(projection: Projection) -> View {
        let camera = Camera { name: String::new(), projection, lens_radius: Meters(0.0), focus_distance: Meters(1.0), near: Meters(0.1) };
        View::new(&PlacedCamera { camera, world_from_view: Mat4::IDENTITY }, UVec2::new(64, 64), 100.0)
    }

    const PERSPECTIVE: Projection = Projection::Perspective { yfov: Radians(std::f32::consts::FRAC_PI_2), aspect: None };
    const PARALLEL: Projection = Projection::Orthographic { xmag: Meters(2.0), ymag: Meters(2.0) };

    fn cube(at: Vec3) -> [Vec3; 2] {
        [at - 0.5, at + 0.5]
    }

    #[test]
    fn a_caster_beside_the_view_counts_only_where_its_shadow_reaches_in() {
        for projection in [PERSPECTIVE, PARALLEL] {
            let view = view(projection);
            let beside = cube(Vec3::new(20.0, 0.0, -5.0));
            assert!(is_out_of_sight(&beside, Vec4::new(0.0, 10.0, -5.0, 1.0), &view), "its shadow falls outwards");
            assert!(!is_out_of_sight(&beside, Vec4::new(40.0, 0.0, -5.0, 1.0), &view), "its shadow falls into the view");
            assert!(!is_out_of_sight(&beside, Vec4::new(1.0, 0.0, 0.0, 0.0), &view));
            assert!(is_out_of_sight(&beside, Vec4::new(-1.0, 0.0, 0.0, 0.0), &view));
            assert!(!is_out_of_sight(&cube(Vec3::new(0.0, 0.0, -5.0)), Vec4::new(0.0, 10.0, 0.0, 1.0), &view), "it is seen");
            assert!(!is_out_of_sight(&cube(Vec3::new(0.0, 0.0, 5.0)), Vec4::new(0.0, 0.0, 10.0, 1.0), &view), "behind, throwing forwards");
        }
    }

    #[test]
    fn rays_begin_inside_of_what_the_near_plane_reaches() {
        for projection in [PERSPECTIVE, PARALLEL] {
            let view = view(projection);
            assert!(is_near(&cube(Vec3::ZERO), &view) && is_near(&cube(Vec3::new(0.0, 0.0, -0.55)), &view));
            assert!(!is_near(&cube(Vec3::new(0.0, 0.0, -0.8)), &view));
        }
    }

    #[test]
    fn a_box_holds_points_and_no_directions() {
        assert!(holds(&cube(Vec3::ZERO), Vec4::new(0.1, 0.2, -0.3, 1.0)));
        assert!(!holds(&cube(Vec3::ZERO), Vec4::new(0.1, 0.2, -0.3, 0.0)) && !holds(&cube(Vec3::ZERO), Vec4::new(0.1, 0.7, 0.0, 1.0)));
    }
}
