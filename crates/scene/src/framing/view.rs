//! What a camera would see, at thumbnail size: how much is front, back or nothing, and how far away.

use crate::{Instance, Mesh, PlacedCamera, Projection};
use glam::{Mat4, Vec2, Vec3};
use std::sync::Arc;

/// Width and height of the thumbnail, px.
const SIZE: usize = 48;

/// A square perspective view.
pub(super) struct View {
    view_from_world: Mat4,
    near: f32,
    /// cot(yfov / 2)
    zoom: f32,
}

/// One pixel: nearest surface.
#[derive(Clone, Copy)]
struct Pixel {
    /// 1 / depth; 0 where nothing is.
    inverse_depth: f32,
    front: bool,
}

/// The thumbnail.
pub(super) struct Seen {
    pixels: Vec<Pixel>,
    near: f32,
}

impl View {
    pub fn new(camera: &PlacedCamera) -> Self {
        let zoom = match camera.camera.projection {
            Projection::Perspective { yfov, .. } => 1.0 / (yfov.0 * 0.5).tan(),
            Projection::Orthographic { .. } => 1.0,
        };
        Self { view_from_world: camera.world_from_view.inverse(), near: camera.camera.near.0, zoom }
    }

    /// Draws every triangle.
    pub fn look(&self, meshes: &[Arc<Mesh>], instances: &[Instance]) -> Seen {
        let mut pixels = vec![Pixel { inverse_depth: 0.0, front: false }; SIZE * SIZE];
        for instance in instances {
            let mesh = &meshes[instance.mesh];
            let world_from_object = Mat4::from(instance.world_from_object);
            let view_from_object = self.view_from_world * world_from_object;
            let mirrored = world_from_object.determinant() < 0.0;
            let positions: Vec<Vec3> = mesh.positions.iter().map(|&p| view_from_object.transform_point3(p)).collect();
            for triangle in &mesh.indices {
                let [a, b, c] = triangle.map(|i| positions[i as usize]);
                // The view looks from the origin: fronts wind counter-clockwise.
                let front = (a.dot((b - a).cross(c - a)) < 0.0) != mirrored;
                self.draw([a, b, c], front, &mut pixels);
            }
        }
        Seen { pixels, near: self.near }
    }

    /// Clips at the near plane, projects and fills.
    fn draw(&self, triangle: [Vec3; 3], front: bool, pixels: &mut [Pixel]) {
        let mut polygon = [Vec3::ZERO; 4];
        let mut corners = 0;
        for i in 0..3 {
            let (from, to) = (triangle[i], triangle[(i + 1) % 3]);
            let (inside, next_inside) = (-from.z > self.near, -to.z > self.near);
            if inside {
                polygon[corners] = from;
                corners += 1;
            }
            if inside != next_inside {
                polygon[corners] = from.lerp(to, (-self.near - from.z) / (to.z - from.z));
                corners += 1;
            }
        }
        // x and y in pixels, z the inverse depth: linear over the image.
        let projected = polygon.map(|p| {
            let inverse = -1.0 / p.z;
            let xy = (Vec2::new(p.x, -p.y) * (self.zoom * inverse) + 1.0) * (0.5 * SIZE as f32);
            xy.extend(inverse)
        });
        for i in 2..corners {
            fill([projected[0], projected[i - 1], projected[i]], front, pixels);
        }
    }
}

fn fill([a, b, c]: [Vec3; 3], front: bool, pixels: &mut [Pixel]) {
    let edge = |p: Vec3, q: Vec3, x: Vec2| (q - p).truncate().perp_dot(x - p.truncate());
    let area = edge(a, b, c.truncate());
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let limit = |v: f32| v.clamp(0.0, SIZE as f32) as usize;
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    for y in limit(low.y)..limit(high.y + 1.0) {
        for x in limit(low.x)..limit(high.x + 1.0) {
            let centre = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let weights = Vec3::new(edge(b, c, centre), edge(c, a, centre), edge(a, b, centre)) / area;
            if weights.min_element() < 0.0 {
                continue;
            }
            let inverse_depth = weights.dot(Vec3::new(a.z, b.z, c.z));
            let pixel = &mut pixels[y * SIZE + x];
            if inverse_depth > pixel.inverse_depth {
                *pixel = Pixel { inverse_depth, front };
            }
        }
    }
}

impl Seen {
    /// Share of the covered pixels that show the back of a surface; 0 where nothing is seen.
    pub fn backs(&self) -> f32 {
        let covered = self.pixels.iter().filter(|p| p.inverse_depth > 0.0);
        let (all, backs) = covered.fold((0u32, 0u32), |(all, backs), p| (all + 1, backs + u32::from(!p.front)));
        if all == 0 { 0.0 } else { backs as f32 / all as f32 }
    }

    /// How much room is before the camera: the mean of ln(depth / near) over the pixels that show fronts. Backs count against it; a view with nothing
    /// in it has 0.
    pub fn spaciousness(&self) -> f32 {
        let value = |p: &Pixel| match (p.inverse_depth > 0.0, p.front) {
            (false, _) => 0.0,
            (true, true) => -(p.inverse_depth * self.near).ln(),
            (true, false) => -5.0,
        };
        self.pixels.iter().map(value).sum::<f32>() / self.pixels.len() as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Camera, shapes};
    use glam::{Affine3A, Quat};
    use kajo_units::{Meters, Radians};

    /// From the origin along −z with 90°.
    fn view() -> View {
        let projection = Projection::Perspective { yfov: Radians::from_degrees(90.0), aspect: None };
        let camera = Camera { name: String::new(), projection, lens_radius: Meters(0.0), focus_distance: Meters(1.0), near: Meters(0.1) };
        View::new(&PlacedCamera { camera, world_from_view: Mat4::IDENTITY })
    }

    fn look(mesh: Mesh, world_from_object: Affine3A) -> Seen {
        view().look(&[Arc::new(mesh)], &[Instance { node: 0, mesh: 0, world_from_object }])
    }

    fn covered(seen: &Seen) -> f32 {
        seen.pixels.iter().filter(|p| p.inverse_depth > 0.0).count() as f32 / (SIZE * SIZE) as f32
    }

    #[test]
    fn a_quad_covers_its_share_and_has_its_depth() {
        let seen = look(shapes::rectangle(2.0, 2.0), Affine3A::from_translation(Vec3::NEG_Z * 2.0));
        assert!((covered(&seen) - 0.25).abs() < 0.01, "{}", covered(&seen));
        assert_eq!(seen.backs(), 0.0);
        let centre = seen.pixels[SIZE * SIZE / 2 + SIZE / 2];
        assert!((centre.inverse_depth - 0.5).abs() < 1e-5);
    }

    #[test]
    fn backs_are_told_from_fronts_also_when_mirrored() {
        let behind = Affine3A::from_translation(Vec3::NEG_Z * 2.0);
        let turned = behind * Affine3A::from_quat(Quat::from_rotation_y(std::f32::consts::PI));
        assert_eq!(look(shapes::rectangle(2.0, 2.0), turned).backs(), 1.0);
        // A mirrored instance keeps its fronts.
        let mirrored = behind * Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
        assert_eq!(look(shapes::rectangle(2.0, 2.0), mirrored).backs(), 0.0);
    }

    #[test]
    fn a_floor_through_the_near_plane_is_clipped() {
        let seen = look(shapes::floor(1000.0, 1000.0, 1.0), Affine3A::from_translation(Vec3::NEG_Y));
        assert!((covered(&seen) - 0.5).abs() < 0.03, "{}", covered(&seen));
        assert_eq!(seen.backs(), 0.0);
    }

    #[test]
    fn the_inside_of_a_room_is_spacious_and_its_outside_all_back() {
        let room = || shapes::cuboid(Vec3::splat(3.0)).inside_out();
        let inside = look(room(), Affine3A::IDENTITY);
        assert_eq!((covered(&inside), inside.backs()), (1.0, 0.0));
        let outside = look(room(), Affine3A::from_translation(Vec3::NEG_Z * 9.0));
        assert_eq!(outside.backs(), 1.0);
        assert!(inside.spaciousness() > 2.0 && outside.spaciousness() < 0.0);
    }
}
