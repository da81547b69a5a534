//! The standard scene of the survey's figures, as code.
//!
//! Unit spheres stand 2.5 m apart on a plane with a checker of 1 m squares, black and white, 0.5 in the mean. One parallel light comes from
//! 30° off the camera's axis, and 0.2 from everywhere. Along that axis the ground would be seen edge-on; for the pictures camera and
//! light are raised together, so that each sphere looks the same and stands on something. Measurements use the level camera and the light alone.

use crate::GalleryError;
use glam::{Affine2, Mat3, Quat, UVec2, Vec2, Vec3};
use kajo_bsdf::models::{Form, find};
use kajo_image::Image;
use kajo_path_tracer::{Filter, Frame, Integrator, Settings, Stop, Tracer, render, uncontrolled};
use kajo_scene::{
    Camera, ColorSpace, Environment, Filter as TextureFilter, Light, LightShape, Material, Mesh, Node, Projection, ReflectanceModel, Scene,
    Snapshot, Texels, Texture, TextureImage, TextureRef, Transform, Wrap, shapes,
};
use kajo_units::{LinearRgb, Meters, Radians, Seconds};
use std::sync::Arc;

/// Distance between the spheres' centres, m.
pub const SPACING: f32 = 2.5;
/// Radiance from everywhere.
const SKY: f32 = 0.2;
/// Irradiance of the light on a surface that faces it: a white one has radiance 1 then.
pub const IRRADIANCE: f32 = std::f32::consts::PI;
/// Reflectances of the checker.
const CHECKER: [f32; 2] = [0.08, 0.92];
/// Edges along a sphere's equator: what its facets add to a direction is below 1e-4 rad where it is measured.
const SEGMENTS: u32 = 256;

/// A sphere's model with parameters.
#[derive(Clone, Debug)]
pub struct Ball {
    /// What stands below it.
    pub label: String,
    /// Id of the model.
    pub model: &'static str,
    /// `name=value` words.
    pub params: String,
    /// As printed, or corrected.
    pub form: Form,
}

impl Ball {
    /// A model with its parameters, as `kd=0.4 n=3`; `label` stands below it.
    pub fn new(model: &'static str, params: impl Into<String>, label: impl Into<String>) -> Self {
        Self { label: label.into(), model, params: params.into(), form: Form::Corrected }
    }

    /// As printed in its source.
    pub fn printed(self) -> Self {
        Self { form: Form::Printed, ..self }
    }

    /// The same with other or more parameters: the last of a name counts.
    pub fn with(&self, params: &str) -> Self {
        let name = |word: &str| word.split('=').next().map(str::to_owned);
        let kept = self.params.split_whitespace().filter(|word| !params.split_whitespace().any(|new| name(new) == name(word)));
        Self { params: kept.chain([params]).collect::<Vec<_>>().join(" "), ..self.clone() }
    }

    /// The model, ready.
    ///
    /// # Panics
    /// For parameters that the model refuses: they are written in this crate.
    pub fn prepare(&self) -> ReflectanceModel {
        let pairs: Vec<(&str, &str)> = self.params.split_whitespace().filter_map(|word| word.split_once('=')).collect();
        let entry = find(self.model).unwrap_or_else(|| panic!("{} is no model", self.model));
        ReflectanceModel::new(entry, &pairs, self.form).unwrap_or_else(|error| panic!("{} {}: {error}", self.model, self.params))
    }

    fn material(&self) -> Material {
        self.prepare().replace_reflection(Material { name: format!("{} {}", self.model, self.params), ..Material::default() })
    }
}

/// Where a parallel light comes from: degrees off the camera's axis, and azimuth about it from the right, counter-clockwise as seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Off the axis.
    pub off_axis: f32,
    /// About the axis.
    pub azimuth: f32,
}

/// A scene under construction.
#[derive(Clone, Debug, Default)]
pub struct Stage(pub Scene);

impl Stage {
    /// A row of spheres, the first at x = 0, on the checker.
    pub fn row(balls: &[Ball]) -> Self {
        let sphere = shapes::sphere(1.0, SEGMENTS);
        let row = balls.iter().enumerate().fold(Self::default(), |stage, (k, ball)| {
            stage.mesh(sphere.clone(), ball.material(), at(Vec3::new(k as f32 * SPACING, 1.0, 0.0)))
        });
        row.checker()
    }

    /// The ground.
    fn checker(mut self) -> Self {
        let [black, white] = CHECKER.map(|c| [c, c, c, 1.0]);
        let texels = Texels::Rgba32F(vec![black, white, white, black]);
        self.0.images.push(Arc::new(TextureImage { name: "checker".into(), width: 2, height: 2, texels }));
        let image = self.0.images.len() - 1;
        self.0.textures.push(Texture { image, wrap: [Wrap::Repeat; 2], filter: TextureFilter::Nearest, color_space: ColorSpace::Linear });
        let texture = TextureRef { texture: self.0.textures.len() - 1, uv_set: 0, transform: Affine2::IDENTITY };
        let material = Material { base_color_texture: Some(texture), ..matte(LinearRgb::WHITE) };
        self.mesh(shapes::floor(800.0, 800.0, 400.0), material, at(Vec3::ZERO))
    }

    /// A mesh with its material at a place.
    pub fn mesh(mut self, mesh: Mesh, material: Material, transform: Transform) -> Self {
        self.0.materials.push(material);
        self.0.meshes.push(Arc::new(Mesh { material: self.0.materials.len() - 1, ..mesh }));
        self.0.nodes.push(Node { meshes: vec![self.0.meshes.len() - 1], transform, ..Node::default() });
        self
    }

    /// The parallel light; `from` points to it.
    pub fn light(mut self, from: Vec3) -> Self {
        let shape = LightShape::Directional { half_angle: Radians(0.0) };
        self.0.lights.push(Light { name: "light".into(), shape, emission: LinearRgb::splat(IRRADIANCE) });
        self.0.nodes.push(Node { light: Some(self.0.lights.len() - 1), transform: looking(from, Vec3::ZERO, Vec3::Y), ..Node::default() });
        self
    }

    /// The light of [`Sun`] for a level camera that looks along −z.
    pub fn sun(self, sun: Sun) -> Self {
        self.light(toward(sun))
    }

    /// Radiance from everywhere.
    pub fn sky(mut self, radiance: f32) -> Self {
        self.0.environment = Some(Environment::uniform(LinearRgb::splat(radiance)));
        self
    }

    /// A parallel camera that sees `height` metres about `target` from `eye`.
    pub fn orthographic(self, eye: Vec3, target: Vec3, up: Vec3, height: f32) -> Self {
        let half = Meters(0.5 * height);
        self.camera(eye, target, up, Projection::Orthographic { xmag: half, ymag: half })
    }

    /// A perspective camera with a vertical field of view in degrees.
    pub fn perspective(self, eye: Vec3, target: Vec3, degrees: f32) -> Self {
        self.camera(eye, target, Vec3::Y, Projection::Perspective { yfov: Radians::from_degrees(degrees), aspect: None })
    }

    fn camera(mut self, eye: Vec3, target: Vec3, up: Vec3, projection: Projection) -> Self {
        self.0.cameras =
            vec![Camera { name: "camera".into(), projection, lens_radius: Meters(0.0), focus_distance: Meters(1.0), near: Meters(1e-4) }];
        self.0.nodes.retain(|node| node.camera.is_none());
        self.0.nodes.push(Node { camera: Some(0), transform: looking(eye, target, up), ..Node::default() });
        self
    }

    /// Camera, light and sky of the pictures of a row of `count` spheres: raised by `elevation` degrees; the picture is `height` metres high.
    pub fn for_picture(self, count: usize, sun: Sun, elevation: f32, height: f32) -> Self {
        let raise = Quat::from_rotation_x(-elevation.to_radians());
        let middle = Vec3::new((count as f32 - 1.0) * SPACING / 2.0, 1.0, 0.0);
        let axis = raise * Vec3::Z;
        let target = middle - raise * Vec3::Y * 0.08;
        self.light(raise * toward(sun)).sky(SKY).orthographic(target + axis * 40.0, target, Vec3::Y, height)
    }

    /// One sample at each pixel's centre of the light alone: no randomness.
    pub fn direct(&self, size: UVec2) -> Result<Image<LinearRgb>, GalleryError> {
        let settings = Settings { size, integrator: Integrator::Direct, filter: Filter::Center, ..Settings::default() };
        Ok(self.render(&settings, 1)?.beauty().clone())
    }

    /// A rendering to the end.
    pub fn render(&self, settings: &Settings, spp: u32) -> Result<Frame, GalleryError> {
        Ok(render(&self.tracer()?, settings, Stop::at_spp(spp), None, &uncontrolled)?.develop())
    }

    /// The path tracer over the scene.
    pub fn tracer(&self) -> Result<Tracer, GalleryError> {
        Ok(Tracer::new(&self.0, Snapshot::new(&self.0, Seconds(0.0)))?)
    }
}

/// A surface that only scatters.
pub fn matte(color: LinearRgb) -> Material {
    Material { base_color: color, metallic: 0.0, specular: 0.0, ..Material::default() }
}

/// A translation.
pub fn at(translation: Vec3) -> Transform {
    Transform::Trs { translation, rotation: Quat::IDENTITY, scale: Vec3::ONE }
}

/// At `eye`, −z towards `target`, +y as near to `up` as can be.
pub fn looking(eye: Vec3, target: Vec3, up: Vec3) -> Transform {
    let back = (eye - target).normalize_or(Vec3::Z);
    let up = if back.cross(up).length() < 1e-6 { Vec3::NEG_Z } else { up };
    let right = up.cross(back).normalize();
    Transform::Trs { translation: eye, rotation: Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back)), scale: Vec3::ONE }
}

/// The unit vector to a light, for a camera that looks along −z.
pub fn toward(sun: Sun) -> Vec3 {
    let (sin, cos) = sun.off_axis.to_radians().sin_cos();
    let around = Vec2::from_angle(sun.azimuth.to_radians()) * sin;
    Vec3::new(around.x, around.y, cos)
}
