//! Where things lie: boxes around them, which of them the camera may see, and in what order.
//!
//! A draw is left out of the passes that the camera looks through when all corners of its box lie beyond one plane of the frustum. It stays in the lists
//! that shadows are cast from and in the scene that rays are traced through: what is out of view still darkens and reflects.

use glam::{DVec3, UVec2, Vec3};
use kajo_scene::{Instance, PlacedCamera, Snapshot};
use kajo_techniques::{Coverage, Draw, View};

/// Boxes around meshes, in object space, and around all that is placed.
pub(crate) struct Boxes {
    meshes: Vec<[Vec3; 2]>,
    /// World, m; a unit box where nothing is placed.
    pub world: [Vec3; 2],
}

/// Share of a coordinate by which the rasteriser's single precision may differ: boxes so near to a plane count as seen.
const SLACK: f64 = 1e-4;

impl Boxes {
    pub fn new(snapshot: &Snapshot) -> Self {
        let meshes: Vec<[Vec3; 2]> = snapshot.meshes.iter().map(|mesh| mesh.bounds()).collect();
        let mut world = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        for instance in &snapshot.instances {
            for corner in corners(&meshes[instance.mesh]).into_iter().filter(|corner| corner.is_finite()) {
                let point = instance.world_from_object.transform_point3(corner);
                world = [world[0].min(point), world[1].max(point)];
            }
        }
        let placed = world[0].is_finite() && world[1].is_finite();
        Self { meshes, world: if placed { world } else { [Vec3::splat(-0.5), Vec3::splat(0.5)] } }
    }

    /// A camera that sees to the farthest of them.
    pub fn view(&self, camera: &PlacedCamera, size: UVec2) -> View {
        let eye = camera.world_from_view.w_axis.truncate();
        let [low, high] = self.world;
        let far = (low - eye).abs().max((high - eye).abs()).length() * 1.001;
        View::new(camera, size, far)
    }

    /// For each instance, whether any of it may be in the view.
    pub fn seen(&self, snapshot: &Snapshot, view: &View) -> Vec<bool> {
        let clip_from_relative = view.jittered_clip_from_relative().as_dmat4();
        let camera = view.position.as_dvec3();
        let instance = |instance: &Instance| {
            let world_from_object = instance.world_from_object;
            let (matrix, origin) = (world_from_object.matrix3.as_dmat3(), world_from_object.translation.as_dvec3() - camera);
            // Bits of the planes that every corner lies beyond.
            let beyond = |corner: Vec3| {
                let p: DVec3 = matrix * corner.as_dvec3() + origin;
                let c = clip_from_relative * p.extend(1.0);
                let past = |distance: f64, size: f64| distance < -SLACK * (size.abs() + c.w.abs());
                let sides = [c.w + c.x, c.w - c.x, c.w + c.y, c.w - c.y].map(|distance| past(distance, c.x.abs().max(c.y.abs())));
                let ends = [c.w - c.z, c.z].map(|distance| past(distance, c.z));
                sides.into_iter().chain(ends).enumerate().fold(0u32, |bits, (i, past)| bits | u32::from(past) << i)
            };
            corners(&self.meshes[instance.mesh]).into_iter().map(beyond).fold(u32::MAX, |all, bits| all & bits) == 0
        };
        snapshot.instances.iter().map(instance).collect()
    }

    /// Blended draws that are seen, farthest first, by the distance of the middle of their boxes.
    pub fn far_to_near(&self, snapshot: &Snapshot, draws: &[Draw], seen: &[bool], view: &View) -> Vec<usize> {
        let distance = |index: usize| {
            let instance = &snapshot.instances[index];
            let [low, high] = self.meshes[instance.mesh];
            instance.world_from_object.transform_point3(0.5 * (low + high)).distance_squared(view.position)
        };
        let blended = draws.iter().enumerate().filter(|(index, draw)| draw.coverage == Coverage::Blend && seen[*index]);
        let mut order: Vec<(usize, f32)> = blended.map(|(index, _)| (index, distance(index))).collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1));
        order.into_iter().map(|(index, _)| index).collect()
    }
}

fn corners(of: &[Vec3; 2]) -> [Vec3; 8] {
    std::array::from_fn(|corner| Vec3::from_array(std::array::from_fn(|axis| of[corner >> axis & 1][axis])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Mat4, UVec2};
    use kajo_scene::{Camera, PlacedCamera, Projection, builtin};
    use kajo_units::{Meters, Radians, Seconds};

    /// Points of the view are in boxes that are seen, whatever plane is near; boxes beyond each plane are not.
    #[test]
    fn boxes_beyond_a_plane_are_not_seen() {
        let snapshot = Snapshot::new(&builtin::load("shadows").unwrap(), Seconds(0.0));
        let boxes = |low: Vec3, high: Vec3| Boxes { meshes: vec![[low, high]; snapshot.meshes.len()], world: [low, high] };
        let one =
            Snapshot { instances: vec![Instance { node: 0, mesh: 0, world_from_object: glam::Affine3A::IDENTITY }], ..snapshot.clone() };
        let half = Meters(1.0);
        let (fov, parallel) =
            (Projection::Perspective { yfov: Radians(1.0), aspect: None }, Projection::Orthographic { xmag: half, ymag: half });
        for projection in [fov, parallel] {
            let camera =
                Camera { name: String::new(), projection, lens_radius: Meters(0.0), focus_distance: Meters(1.0), near: Meters(0.1) };
            let view = View::new(&PlacedCamera { camera, world_from_view: Mat4::IDENTITY }, UVec2::splat(64), 50.0);
            let seen = |middle: Vec3| boxes(middle - 0.1, middle + 0.1).seen(&one, &view)[0];
            let edge = if view.perspective { 4.0 * 0.5f32.tan() } else { 1.0 };
            assert!(seen(Vec3::new(0.0, 0.0, -4.0)) && seen(Vec3::new(edge, 0.0, -4.0)) && seen(Vec3::new(0.0, -edge, -4.0)));
            for out in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y] {
                assert!(!seen(out * (edge + 0.3) - 4.0 * Vec3::Z), "{projection:?} {out}");
            }
            assert!(!seen(Vec3::Z), "behind");
            assert_eq!(seen(Vec3::NEG_Z * 60.0), view.perspective, "beyond the far plane of parallel projection");
            assert!(boxes(Vec3::splat(-100.0), Vec3::splat(100.0)).seen(&one, &view)[0], "around the camera");
            assert!(boxes(Vec3::INFINITY, Vec3::NEG_INFINITY).seen(&one, &view)[0], "what has no box is not left out");
        }
    }
}
