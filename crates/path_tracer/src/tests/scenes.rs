//! Small scenes for tests.

use crate::{Film, Frame, Settings, Stop, Tracer, render, uncontrolled};
use glam::{Quat, UVec2, Vec3};
use kajo_scene::{Camera, Environment, Light, LightShape, Material, Mesh, Node, Projection, Scene, Snapshot, Transform, shapes};
use kajo_units::{LinearRgb, Meters, Radians, Seconds};
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

/// A scene under construction.
#[derive(Clone, Default)]
pub(crate) struct Stage(pub Scene);

impl Stage {
    pub(crate) fn mesh(mut self, mesh: Mesh, material: Material, transform: Transform) -> Self {
        self.0.materials.push(material);
        self.0.meshes.push(Arc::new(Mesh { material: self.0.materials.len() - 1, ..mesh }));
        self.0.nodes.push(Node { meshes: vec![self.0.meshes.len() - 1], transform, ..Node::default() });
        self
    }

    pub(crate) fn light(mut self, shape: LightShape, emission: f32, transform: Transform) -> Self {
        let emission = LinearRgb::splat(emission);
        self.0.lights.push(Light { name: String::new(), shape, emission });
        self.0.nodes.push(Node { light: Some(self.0.lights.len() - 1), transform, ..Node::default() });
        self
    }

    pub(crate) fn environment(mut self, radiance: f32) -> Self {
        self.0.environment = Some(Environment::uniform(LinearRgb::splat(radiance)));
        self
    }

    /// A parallel camera at `eye` that sees `height` metres around `target`.
    pub(crate) fn orthographic(self, eye: Vec3, target: Vec3, height: f32) -> Self {
        let half = Meters(0.5 * height);
        self.camera(eye, target, Projection::Orthographic { xmag: half, ymag: half })
    }

    pub(crate) fn perspective(self, eye: Vec3, target: Vec3, degrees: f32) -> Self {
        self.camera(eye, target, Projection::Perspective { yfov: Radians::from_degrees(degrees), aspect: None })
    }

    fn camera(mut self, eye: Vec3, target: Vec3, projection: Projection) -> Self {
        let camera =
            Camera { name: "camera".into(), projection, lens_radius: Meters(0.0), focus_distance: Meters(1.0), near: Meters(1e-3) };
        self.0.cameras.push(camera);
        self.0.nodes.push(Node { camera: Some(self.0.cameras.len() - 1), transform: looking(eye, target), ..Node::default() });
        self
    }
}

/// At `eye`, −z towards `target`.
pub(crate) fn looking(eye: Vec3, target: Vec3) -> Transform {
    let rotation = Quat::from_rotation_arc(Vec3::NEG_Z, (target - eye).normalize());
    Transform::Trs { translation: eye, rotation, scale: Vec3::ONE }
}

/// At a place, unturned: rectangles face +z, lights shine along −z.
pub(crate) fn at(translation: Vec3) -> Transform {
    Transform::Trs { translation, rotation: Quat::IDENTITY, scale: Vec3::ONE }
}

/// At a place, turned so that −z of the node points down: lights shine down.
pub(crate) fn downwards(translation: Vec3) -> Transform {
    Transform::Trs { translation, rotation: Quat::from_rotation_x(-FRAC_PI_2), scale: Vec3::ONE }
}

pub(crate) fn lambert(albedo: f32) -> Material {
    Material { base_color: LinearRgb::splat(albedo), metallic: 0.0, specular: 0.0, ..Material::default() }
}

pub(crate) fn glowing(radiance: f32, albedo: f32) -> Material {
    Material { emission: LinearRgb::splat(radiance), ..lambert(albedo) }
}

/// A perfect mirror.
pub(crate) fn mirror() -> Material {
    Material { metallic: 1.0, roughness: 0.0, ..Material::default() }
}

/// A horizontal white floor at y = 0.
pub(crate) fn floor() -> Mesh {
    shapes::floor(100.0, 100.0, 1.0)
}

pub(crate) fn cornell() -> Scene {
    kajo_scene::load("builtin:cornell", &Default::default()).expect("a built-in scene")
}

pub(crate) fn tracer(scene: &Scene) -> Tracer {
    Tracer::new(scene, Snapshot::new(scene, Seconds(0.0))).expect("a sound scene")
}

pub(crate) fn film_at(scene: &Scene, settings: &Settings, spp: u32) -> Film {
    render(&tracer(scene), settings, Stop::at_spp(spp), None, &uncontrolled).expect("a rendering")
}

pub(crate) fn render_at(scene: &Scene, settings: &Settings, spp: u32) -> Frame {
    let frame = film_at(scene, settings, spp).develop();
    assert_eq!(frame.invalid_samples, 0);
    frame
}

/// Mean of all pixels and channels of an image of `beauty`, in double precision.
pub(crate) fn mean(frame: &Frame) -> f64 {
    let pixels = frame.beauty().pixels();
    pixels.iter().map(|p| f64::from(p.0.element_sum()) / 3.0).sum::<f64>() / pixels.len() as f64
}

/// Settings of a picture of this size.
pub(crate) fn sized(width: u32, height: u32) -> Settings {
    Settings { size: UVec2::new(width, height), ..Settings::default() }
}
