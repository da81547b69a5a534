//! Which instances rays meet that start on surfaces: leaving some out of the upper structure makes it smaller, and what they would have added to a
//! reflection or a shadow is the error.
//!
//! A camera sees nothing of it: primary visibility has every instance. The ways are those of games (\[Varjus23] section 7.2): by distance from the camera, by a frustum that is
//! wider than the camera's (what stands beside the picture is still reflected in it), by size, and by the solid angle that an instance fills as seen from the
//! camera, which is size and distance together. Instances that emit light are always kept: they are lights.

use crate::{Instance, PlacedCamera, Projection, Scene, Snapshot};
use glam::Vec3;
use kajo_units::Meters;
use std::f32::consts::TAU;
use std::fmt;
use std::str::FromStr;

/// A way to leave instances out, each with its threshold. Instances count as spheres around their boxes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Culling {
    /// Keeps everything.
    #[default]
    Off,
    /// Keeps what comes as near to the camera as this.
    Distance(Meters),
    /// Keeps what comes as near as this to what the camera sees; behind it, as near to the camera's plane.
    Frustum(Meters),
    /// Keeps spheres of this radius and larger ones.
    Size(Meters),
    /// Keeps what fills this solid angle and more, sr, as seen from the camera.
    SolidAngle(f32),
}

/// A sphere around an instance.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sphere {
    center: Vec3,
    radius: f32,
}

impl Sphere {
    /// Around the corners of the mesh's box, placed; `None` for a mesh without vertices.
    fn of(instance: &Instance, [low, high]: [Vec3; 2]) -> Option<Self> {
        if low.cmpgt(high).any() {
            return None;
        }
        let to_world = &instance.world_from_object;
        let center = to_world.transform_point3(0.5 * (low + high));
        let half = 0.5 * (high - low);
        let corner = |signs: [f32; 3]| to_world.transform_vector3(half * Vec3::from(signs)).length();
        let corners = [[1.0, 1.0, 1.0], [1.0, 1.0, -1.0], [1.0, -1.0, 1.0], [-1.0, 1.0, 1.0]].map(corner);
        Some(Self { center, radius: corners.into_iter().fold(0.0, f32::max) })
    }

    /// Solid angle from a point: 2π (1 − √(1 − r²/d²)), 4π inside.
    fn solid_angle(&self, from: Vec3) -> f32 {
        let sine_2 = self.radius * self.radius / (self.center - from).length_squared();
        // The same as 1 − √(1 − s), without the loss of digits for small s.
        if sine_2 < 1.0 { TAU * sine_2 / (1.0 + (1.0 - sine_2).sqrt()) } else { 2.0 * TAU }
    }
}

/// Half spaces whose intersection a camera sees: a point on each border, and the unit normal inwards.
struct Frustum(Vec<(Vec3, Vec3)>);

impl Frustum {
    /// Of an image of width / height `aspect`.
    fn new(camera: &PlacedCamera, aspect: f32) -> Self {
        let to_world = camera.world_from_view;
        let eye = to_world.w_axis.truncate();
        let inward = |normal: Vec3| to_world.transform_vector3(normal).normalize_or_zero();
        let sides = match camera.camera.projection {
            Projection::Perspective { yfov, .. } => {
                let tangent = (0.5 * yfov.0).tan();
                let (x, y) = (tangent * aspect, tangent);
                let normals = [Vec3::new(1.0, 0.0, -x), Vec3::new(-1.0, 0.0, -x), Vec3::new(0.0, 1.0, -y), Vec3::new(0.0, -1.0, -y)];
                normals.map(|normal| (eye, inward(normal)))
            }
            Projection::Orthographic { xmag, ymag } => {
                let side = |axis: Vec3, half: f32| (eye - inward(axis) * half.abs(), inward(axis));
                [side(Vec3::X, xmag.0), side(Vec3::NEG_X, xmag.0), side(Vec3::Y, ymag.0), side(Vec3::NEG_Y, ymag.0)]
            }
        };
        Self(sides.into_iter().chain([(eye, inward(Vec3::NEG_Z))]).collect())
    }

    fn comes_within(&self, sphere: &Sphere, distance: f32) -> bool {
        self.0.iter().all(|(point, normal)| normal.dot(sphere.center - *point) >= -(sphere.radius + distance))
    }
}

impl Culling {
    /// Whether each instance of the snapshot is kept for the camera, whose image has width / height `aspect`.
    pub fn kept(self, scene: &Scene, snapshot: &Snapshot, camera: &PlacedCamera, aspect: f32) -> Vec<bool> {
        if self == Self::Off {
            return vec![true; snapshot.instances.len()];
        }
        let boxes: Vec<[Vec3; 2]> = snapshot.meshes.iter().map(|mesh| mesh.bounds()).collect();
        let eye = camera.world_from_view.w_axis.truncate();
        let frustum = Frustum::new(camera, aspect);
        let keeps = |instance: &Instance| {
            let emits = scene.materials.get(snapshot.meshes[instance.mesh].material).is_some_and(|material| material.is_emissive());
            let Some(sphere) = Sphere::of(instance, boxes[instance.mesh]) else { return true };
            emits
                || match self {
                    Self::Off => true,
                    Self::Distance(limit) => sphere.center.distance(eye) - sphere.radius <= limit.0,
                    Self::Frustum(limit) => frustum.comes_within(&sphere, limit.0),
                    Self::Size(limit) => sphere.radius >= limit.0,
                    Self::SolidAngle(limit) => sphere.solid_angle(eye) >= limit,
                }
        };
        snapshot.instances.iter().map(keeps).collect()
    }
}

impl fmt::Display for Culling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Off => f.write_str("off"),
            Self::Distance(limit) => write!(f, "distance:{}", limit.0),
            Self::Frustum(limit) => write!(f, "frustum:{}", limit.0),
            Self::Size(limit) => write!(f, "size:{}", limit.0),
            Self::SolidAngle(limit) => write!(f, "solid-angle:{limit}"),
        }
    }
}

/// What is no way to cull.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{got}` is no way to leave instances out; write off, distance:METRES, frustum:METRES, size:METRES or solid-angle:STERADIANS, with a number that is not negative"
)]
pub struct UnknownCulling {
    /// The word.
    pub got: String,
}

impl FromStr for Culling {
    type Err = UnknownCulling;

    fn from_str(word: &str) -> Result<Self, UnknownCulling> {
        let unknown = || UnknownCulling { got: word.to_owned() };
        if word == "off" {
            return Ok(Self::Off);
        }
        let (mode, number) = word.split_once(':').ok_or_else(unknown)?;
        let limit: f32 = number.parse().ok().filter(|limit: &f32| limit.is_finite() && *limit >= 0.0).ok_or_else(unknown)?;
        match mode {
            "distance" => Ok(Self::Distance(Meters(limit))),
            "frustum" => Ok(Self::Frustum(Meters(limit))),
            "size" => Ok(Self::Size(Meters(limit))),
            "solid-angle" => Ok(Self::SolidAngle(limit)),
            _ => Err(unknown()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mesh;
    use crate::{Camera, Material, Node, Transform, shapes};
    use kajo_units::{LinearRgb, Radians, Seconds};
    use std::sync::Arc;

    /// Cubes of half a metre of half side at these places; the last one glows. The camera stands at the origin and looks along −z, 90° wide and high.
    fn kept(culling: &str, places: &[Vec3]) -> Vec<bool> {
        let glow = Material { emission: LinearRgb::WHITE, ..Material::default() };
        let mesh = |material: usize| Arc::new(Mesh { material, ..shapes::cuboid(Vec3::splat(0.5)) });
        let node = |(i, place): (usize, &Vec3)| Node {
            transform: Transform::Matrix(glam::Mat4::from_translation(*place)),
            meshes: vec![usize::from(i + 1 == places.len())],
            ..Node::default()
        };
        let scene = Scene {
            materials: vec![Material::default(), glow],
            meshes: vec![mesh(0), mesh(1)],
            nodes: places.iter().enumerate().map(node).collect(),
            cameras: vec![Camera {
                name: String::new(),
                projection: Projection::Perspective { yfov: Radians::from_degrees(90.0), aspect: None },
                lens_radius: Meters(0.0),
                focus_distance: Meters(1.0),
                near: Meters(0.01),
            }],
            ..Scene::default()
        };
        let snapshot = Snapshot::new(&scene, Seconds(0.0));
        let camera = PlacedCamera { camera: scene.cameras[0].clone(), world_from_view: glam::Mat4::IDENTITY };
        culling.parse::<Culling>().unwrap().kept(&scene, &snapshot, &camera, 1.0)
    }

    /// Half the diagonal of a cube.
    const RADIUS: f32 = 0.866_025_4;

    #[test]
    fn each_way_keeps_what_it_says_and_lights_always() {
        let far_light = Vec3::new(0.0, 0.0, 900.0);
        let near_and_far = [Vec3::new(0.0, 0.0, -10.0), Vec3::new(0.0, 0.0, -20.0), far_light];
        assert_eq!(kept("off", &near_and_far), [true; 3]);
        assert_eq!(kept(&format!("distance:{}", 10.0 - RADIUS - 0.01), &near_and_far), [false, false, true]);
        assert_eq!(kept(&format!("distance:{}", 10.0 - RADIUS + 0.01), &near_and_far), [true, false, true]);
        assert_eq!(kept("size:0.86", &near_and_far), [true; 3]);
        assert_eq!(kept("size:0.87", &near_and_far), [false, false, true]);
        // 2π (1 − cos asin(r / d)) is near π r² / d².
        let angle = |d: f32| std::f32::consts::PI * RADIUS * RADIUS / (d * d);
        assert_eq!(kept(&format!("solid-angle:{}", angle(15.0)), &near_and_far), [true, false, true]);
        assert_eq!(kept(&format!("solid-angle:{}", 1.1 * angle(10.0)), &near_and_far), [false, false, true]);
    }

    #[test]
    fn the_frustum_is_as_wide_as_the_camera_sees_and_by_so_much_more() {
        // The right side is x = −z: this one lies 2 m / √2 beyond it, less its radius.
        let beside = Vec3::new(12.0, 0.0, -10.0);
        let behind = Vec3::new(0.0, 0.0, 3.0);
        let all = [Vec3::new(0.0, 0.0, -10.0), beside, behind, Vec3::ZERO];
        let gap = 2.0 / 2f32.sqrt() - RADIUS;
        assert_eq!(kept(&format!("frustum:{}", gap - 0.01), &all), [true, false, false, true]);
        assert_eq!(kept(&format!("frustum:{}", gap + 0.01), &all), [true, true, false, true]);
        assert_eq!(kept("frustum:3", &all), [true; 4]);
    }

    #[test]
    fn inside_is_the_whole_sphere_and_small_angles_keep_their_digits() {
        let sphere = Sphere { center: Vec3::X, radius: 2.0 };
        assert_eq!(sphere.solid_angle(Vec3::ZERO), 2.0 * TAU);
        let far = Sphere { center: Vec3::X * 1e4, radius: 1.0 }.solid_angle(Vec3::ZERO);
        assert!((far / (std::f32::consts::PI * 1e-8) - 1.0).abs() < 1e-5, "{far}");
    }

    #[test]
    fn words_are_read_back_and_others_refused() {
        for culling in [
            Culling::Off,
            Culling::Distance(Meters(5.0)),
            Culling::Frustum(Meters(0.5)),
            Culling::Size(Meters(0.25)),
            Culling::SolidAngle(1e-5),
        ] {
            assert_eq!(culling.to_string().parse(), Ok(culling));
        }
        for wrong in ["", "distance", "distance:x", "size:-1", "solid-angle:inf", "angle:1"] {
            assert!(wrong.parse::<Culling>().unwrap_err().to_string().contains("solid-angle:STERADIANS"), "{wrong}");
        }
    }
}
