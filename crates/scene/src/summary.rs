//! What a scene contains, in numbers.

use crate::{Ignored, LightShape, Projection, Scene, Snapshot, Texels, framing};
use kajo_units::Seconds;
use serde::Serialize;

/// Contents and sizes of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// What the user named.
    pub name: String,
    /// Nodes of the hierarchy.
    pub nodes: usize,
    /// Meshes, one material each.
    pub meshes: usize,
    /// Meshes placed in the world.
    pub instances: usize,
    /// Triangles in memory.
    pub triangles: usize,
    /// Triangles in the world: those of every instance.
    pub placed_triangles: usize,
    /// Vertices in memory.
    pub vertices: usize,
    /// Smallest and largest corner in the world at time 0, m.
    pub bounds: [[f32; 3]; 2],
    /// Names of the materials.
    pub materials: Vec<String>,
    /// Images of the textures.
    pub images: Vec<ImageSummary>,
    /// Lights.
    pub lights: Vec<LightSummary>,
    /// Materials that emit.
    pub emissive_materials: usize,
    /// The environment, if any.
    pub environment: Option<EnvironmentSummary>,
    /// Cameras.
    pub cameras: Vec<CameraSummary>,
    /// Animations.
    pub animations: Vec<AnimationSummary>,
    /// Skins.
    pub skins: usize,
    /// Memory of vertices, indices and morph targets, bytes.
    pub geometry_bytes: usize,
    /// Memory of images, the environment's with them, bytes.
    pub image_bytes: usize,
    /// Exposure in stops, where the scene has one.
    pub exposure: Option<f32>,
    /// What was ignored or replaced.
    pub ignored: Vec<Ignored>,
}

/// An image in memory.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ImageSummary {
    /// For messages.
    pub name: String,
    /// Width, px.
    pub width: u32,
    /// Height, px.
    pub height: u32,
    /// `rgba8`, `rgba16` or `rgba32f`.
    pub format: &'static str,
    /// Memory.
    pub bytes: usize,
}

/// A light.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightSummary {
    /// Its name.
    pub name: String,
    /// `point`, `spot`, `directional`, `rectangle`, `disk` or `sphere`.
    pub shape: &'static str,
    /// Linear RGB; the unit follows.
    pub emission: [f32; 3],
    /// Unit of the emission.
    pub unit: &'static str,
}

/// An environment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EnvironmentSummary {
    /// Its image; `None` for a uniform one.
    pub image: Option<ImageSummary>,
    /// Factor, or the radiance of a uniform one, W/(m² sr).
    pub scale: [f32; 3],
}

/// A camera.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraSummary {
    /// The name `--camera` takes.
    pub name: String,
    /// `perspective` or `orthographic`.
    pub projection: &'static str,
    /// Vertical field of view, degrees, of a perspective camera.
    pub yfov_deg: Option<f32>,
    /// Radius of the lens, m; 0 is a pinhole.
    pub lens_radius: f32,
}

/// An animation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AnimationSummary {
    /// Its name.
    pub name: String,
    /// Properties it moves.
    pub channels: usize,
    /// Time of its last key, s.
    pub duration: f32,
    /// Whether it is the one that plays.
    pub plays: bool,
}

impl Scene {
    /// Counts what is there. Evaluates the scene at time 0 for what is placed in the world.
    pub fn summary(&self) -> Summary {
        let snapshot = Snapshot::new(self, Seconds(0.0));
        let [low, high] = framing::bounds(&snapshot.meshes, &snapshot.instances);
        let images: Vec<_> = self.images.iter().map(|image| image_summary(image)).collect();
        let environment = self
            .environment
            .as_ref()
            .map(|e| EnvironmentSummary { image: e.image.as_deref().map(image_summary), scale: e.scale.0.to_array() });
        let environment_bytes = environment.as_ref().and_then(|e| e.image.as_ref()).map_or(0, |i| i.bytes);
        Summary {
            name: self.name.clone(),
            nodes: self.nodes.len(),
            meshes: self.meshes.len(),
            instances: snapshot.instances.len(),
            triangles: self.meshes.iter().map(|m| m.indices.len()).sum(),
            placed_triangles: snapshot.instances.iter().map(|i| snapshot.meshes[i.mesh].indices.len()).sum(),
            vertices: self.meshes.iter().map(|m| m.positions.len()).sum(),
            bounds: [low.to_array(), high.to_array()],
            materials: self.materials.iter().map(|m| m.name.clone()).collect(),
            image_bytes: images.iter().map(|i| i.bytes).sum::<usize>() + environment_bytes,
            images,
            lights: self.lights.iter().map(light_summary).collect(),
            emissive_materials: self.materials.iter().filter(|m| m.is_emissive()).count(),
            environment,
            cameras: self.cameras.iter().map(camera_summary).collect(),
            animations: (0..self.animations.len()).map(|index| self.animation_summary(index)).collect(),
            skins: self.skins.len(),
            geometry_bytes: self.meshes.iter().map(|m| m.bytes()).sum(),
            exposure: self.exposure,
            ignored: self.ignored.clone(),
        }
    }

    fn animation_summary(&self, index: usize) -> AnimationSummary {
        let animation = &self.animations[index];
        AnimationSummary {
            name: animation.name.clone(),
            channels: animation.channels.len(),
            duration: animation.channels.iter().filter_map(|c| c.times.last()).copied().fold(0.0, f32::max),
            plays: index == self.animation,
        }
    }
}

impl crate::Mesh {
    /// Memory of the vertex lists, indices and morph targets, bytes.
    pub fn bytes(&self) -> usize {
        let vertices = size_of_val(self.positions.as_slice())
            + size_of_val(self.normals.as_slice())
            + size_of_val(self.tangents.as_slice())
            + self.uvs.iter().map(|set| size_of_val(set.as_slice())).sum::<usize>()
            + size_of_val(self.colors.as_slice())
            + size_of_val(self.skin_weights.as_slice());
        let targets = self.morph_targets.iter().map(|target| {
            size_of_val(target.positions.as_slice())
                + size_of_val(target.normals.as_slice())
                + size_of_val(target.tangents.as_slice())
                + target.uvs.iter().map(|set| size_of_val(set.as_slice())).sum::<usize>()
                + size_of_val(target.colors.as_slice())
        });
        vertices + size_of_val(self.indices.as_slice()) + targets.sum::<usize>()
    }
}

impl LightShape {
    /// `point`, `spot`, `directional`, `rectangle`, `disk` or `sphere`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Spot { .. } => "spot",
            Self::Directional { .. } => "directional",
            Self::Rectangle { .. } => "rectangle",
            Self::Disk { .. } => "disk",
            Self::Sphere { .. } => "sphere",
        }
    }

    /// Unit of [`Light::emission`](crate::Light::emission).
    pub fn unit(&self) -> &'static str {
        match self {
            Self::Point | Self::Spot { .. } => "W/sr",
            Self::Directional { .. } => "W/m²",
            Self::Rectangle { .. } | Self::Disk { .. } | Self::Sphere { .. } => "W/(m² sr)",
        }
    }
}

fn image_summary(image: &crate::TextureImage) -> ImageSummary {
    let format = match &image.texels {
        Texels::Rgba8(_) => "rgba8",
        Texels::Rgba16(_) => "rgba16",
        Texels::Rgba32F(_) => "rgba32f",
        Texels::Rgb32F(_) => "rgb32f",
    };
    ImageSummary { name: image.name.clone(), width: image.width, height: image.height, format, bytes: image.bytes() }
}

fn light_summary(light: &crate::Light) -> LightSummary {
    LightSummary { name: light.name.clone(), shape: light.shape.name(), emission: light.emission.0.to_array(), unit: light.shape.unit() }
}

fn camera_summary(camera: &crate::Camera) -> CameraSummary {
    let (projection, yfov_deg) = match camera.projection {
        Projection::Perspective { yfov, .. } => ("perspective", Some(yfov.0.to_degrees())),
        Projection::Orthographic { .. } => ("orthographic", None),
    };
    CameraSummary { name: camera.name.clone(), projection, yfov_deg, lens_radius: camera.lens_radius.0 }
}

#[cfg(test)]
mod tests {
    use crate::builtin;

    #[test]
    fn cornell_box_in_numbers() {
        let summary = builtin::load("cornell").unwrap().summary();
        assert_eq!((summary.meshes, summary.instances, summary.triangles, summary.vertices), (9, 9, 38, 76));
        assert_eq!((summary.lights.len(), summary.emissive_materials, summary.cameras.len()), (1, 0, 1));
        assert_eq!((summary.lights[0].shape, summary.lights[0].unit), ("rectangle", "W/(m² sr)"));
        assert!((summary.cameras[0].yfov_deg.unwrap() - 39.3077).abs() < 1e-3);
        // 12 bytes of position, 12 of normal, 16 of tangent, 8 of uv; 12 a triangle.
        assert_eq!(summary.geometry_bytes, 76 * 48 + 38 * 12);
        let expected = [[-1.0, -1.01, -1.0], [1.0, 1.0, 1.0]];
        let near = |(a, b): (&[f32; 3], &[f32; 3])| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(summary.bounds.iter().zip(&expected).all(near), "{:?}", summary.bounds);
    }

    #[test]
    fn animations_images_and_instances_are_counted() {
        let moving = builtin::load("moving").unwrap().summary();
        assert_eq!(moving.animations.len(), 1);
        assert!(moving.animations[0].plays && (moving.animations[0].duration - 4.0).abs() < 1e-6);
        assert_eq!((moving.images[0].format, moving.images[0].bytes, moving.image_bytes), ("rgba8", 16, 16));
        let court = builtin::load("many-lights:3").unwrap().summary();
        assert!(court.instances > court.meshes && court.placed_triangles > court.triangles);
    }

    #[test]
    fn summary_is_json() {
        let json = serde_json::to_value(builtin::load("spheres").unwrap().summary()).unwrap();
        assert_eq!(json["materials"].as_array().unwrap().len(), 20);
        assert_eq!(json["environment"]["image"], serde_json::Value::Null);
    }
}
