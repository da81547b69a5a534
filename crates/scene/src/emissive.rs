//! Emissive instances as lights: which there are, what they are called, and how much each of their triangles emits.
//!
//! Every renderer takes this list, so that a light has the same index, name and measure in all of them: analytic lights come first, in the
//! snapshot's order, then emissive instances in theirs. Unlit surfaces show their colour but are no lights.

use crate::{Material, Mesh, Scene, Snapshot};
use glam::{Affine3A, Vec3};
use kajo_units::LinearRgb;
use rayon::prelude::*;
use std::collections::HashSet;
use std::f32::consts::PI;

/// An instance that lights the scene. Lists have one entry a triangle.
#[derive(Clone, Debug)]
pub struct EmissiveMesh {
    /// Index into [`Snapshot::instances`].
    pub instance: usize,
    /// Share in the light's emission, ∫ Y dA over the triangle; they sum to 1. The measure of `visibility.<light>`.
    pub shares: Vec<f32>,
    /// Probability with which a sampler of the light chooses the triangle; they sum to 1. The shares, and for textured emission to a
    /// tenth the area, since a triangle that is black where it was probed may still emit.
    pub choices: Vec<f32>,
    /// The emission where no texture changes it, W/(m² sr).
    pub constant: Option<LinearRgb>,
    /// Whether it emits on both sides.
    pub double_sided: bool,
    /// Area of one side in the world, m².
    pub area: f32,
    /// Radiance, mean over the area, W/(m² sr); estimated for textures.
    pub radiance: LinearRgb,
    /// Middle of the emission in the world, m.
    pub center: Vec3,
}

/// Share of choices by area where emission varies.
const BY_AREA: f64 = 0.1;

/// Points of a triangle at which emission that varies is probed.
const PROBES: [[f32; 2]; 7] = [[1. / 3., 1. / 3.], [0.1, 0.1], [0.8, 0.1], [0.1, 0.8], [0.45, 0.45], [0.1, 0.45], [0.45, 0.1]];

impl Snapshot {
    /// The instances whose material emits, in the order of [`Snapshot::instances`]; those without area are left out.
    pub fn emissive_meshes(&self, scene: &Scene) -> Vec<EmissiveMesh> {
        let emits = |index: usize| {
            let instance = &self.instances[index];
            let mesh = &self.meshes[instance.mesh];
            let material = scene.materials.get(mesh.material).filter(|material| material.is_emissive() && !material.unlit)?;
            EmissiveMesh::new(index, mesh, material, &instance.world_from_object, scene)
        };
        (0..self.instances.len()).filter_map(emits).collect()
    }

    /// A name for every light, each different: the file's or `light <index>` for analytic lights, then the node's, the mesh's or
    /// `mesh <instance>` for `emissive`. A name that is taken gets a number.
    pub fn light_names(&self, scene: &Scene, emissive: &[EmissiveMesh]) -> Vec<String> {
        let analytic = self.lights.iter().enumerate().map(|(index, placed)| or(&[&placed.light.name], || format!("light {index}")));
        let meshes = emissive.iter().map(|light| {
            let instance = &self.instances[light.instance];
            let names = [&scene.nodes[instance.node].name, &self.meshes[instance.mesh].name];
            or(&names, || format!("mesh {}", light.instance))
        });
        let mut taken = HashSet::new();
        let mut unique = |name: String| {
            let numbered = (2..).map(|number| format!("{name} {number}"));
            let free = std::iter::once(name.clone()).chain(numbered).find(|candidate| !taken.contains(candidate));
            free.inspect(|free| _ = taken.insert(free.clone())).unwrap_or(name)
        };
        analytic.chain(meshes).map(&mut unique).collect()
    }
}

/// The first name that is not empty.
fn or(names: &[&String], otherwise: impl Fn() -> String) -> String {
    names.iter().find(|name| !name.is_empty()).map_or_else(otherwise, |name| name.to_string())
}

impl EmissiveMesh {
    /// `None` for an instance without area.
    fn new(instance: usize, mesh: &Mesh, material: &Material, world_from_object: &Affine3A, scene: &Scene) -> Option<Self> {
        let constant = material.emission_texture.is_none().then_some(material.emission);
        let uniform = constant.filter(|_| !material.needs_alpha_test());
        // Area, emission, and the middle of each triangle.
        let measured: Vec<(f64, LinearRgb, Vec3)> = (0..mesh.indices.len() as u32)
            .into_par_iter()
            .map(|triangle| {
                let [a, b, c] = mesh.indices[triangle as usize].map(|i| world_from_object.transform_point3(mesh.positions[i as usize]));
                let emission = uniform.unwrap_or_else(|| probe(scene, mesh, material, triangle));
                (0.5 * f64::from((b - a).cross(c - a).length()), emission, (a + b + c) / 3.0)
            })
            .collect();
        let area: f64 = measured.iter().map(|(area, ..)| area).sum();
        if !(area > 0.0 && area.is_finite()) {
            return None;
        }
        let powers: Vec<f64> = measured.iter().map(|(area, emission, _)| area * f64::from(emission.luminance())).collect();
        let power: f64 = powers.iter().sum();
        let by_area = |i: usize| measured[i].0 / area;
        // A light that is black wherever it was probed is measured by its area.
        let share = |i: usize| if power > 0.0 { powers[i] / power } else { by_area(i) };
        let blind = if uniform.is_some() { 0.0 } else { BY_AREA };
        let all = 0..measured.len();
        let mean = |value: &dyn Fn(usize) -> f64| all.clone().map(value).sum::<f64>();
        let axis = |k: usize| mean(&|i| share(i) * f64::from(measured[i].2[k])) as f32;
        let channel = |k: usize| mean(&|i| by_area(i) * f64::from(measured[i].1.0[k])) as f32;
        Some(Self {
            instance,
            shares: all.clone().map(|i| share(i) as f32).collect(),
            choices: all.clone().map(|i| ((1.0 - blind) * share(i) + blind * by_area(i)) as f32).collect(),
            constant,
            double_sided: material.double_sided,
            area: area as f32,
            radiance: LinearRgb::new(channel(0), channel(1), channel(2)),
            center: Vec3::new(axis(0), axis(1), axis(2)),
        })
    }

    /// Emitted flux as luminance, W: π L A a side.
    pub fn power(&self) -> f32 {
        PI * self.area * self.radiance.luminance() * self.sides()
    }

    /// Radiant intensity, mean over all directions, W/sr: L A / 4 a side, where nothing hides any of it.
    pub fn intensity(&self) -> LinearRgb {
        self.radiance * (0.25 * self.area * self.sides())
    }

    /// Whether [`Self::choices`] differ from [`Self::shares`].
    pub fn chooses_by_area(&self) -> bool {
        self.choices != self.shares
    }

    fn sides(&self) -> f32 {
        if self.double_sided { 2.0 } else { 1.0 }
    }
}

/// Mean emission of a triangle, each point weighed with the share of the surface that is there.
fn probe(scene: &Scene, mesh: &Mesh, material: &Material, triangle: u32) -> LinearRgb {
    let at = |[u, v]: [f32; 2]| {
        let uv = mesh.uv_at(triangle, u, v);
        material.emission_at(scene, &uv) * material.coverage_at(scene, &uv)
    };
    PROBES.into_iter().map(at).sum::<LinearRgb>() * (1.0 / PROBES.len() as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColorSpace, Filter, Node, Texels, Texture, TextureImage, TextureRef, Transform, shapes};
    use glam::Vec2;
    use kajo_units::Seconds;
    use std::sync::Arc;

    fn glowing(radiance: LinearRgb) -> Material {
        Material { emission: radiance, ..Material::default() }
    }

    /// One node a mesh, each with its own material.
    fn scene(parts: Vec<(Mesh, Material, Transform)>) -> Scene {
        let mut scene = Scene::default();
        for (mesh, material, transform) in parts {
            scene.materials.push(material);
            scene.meshes.push(Arc::new(Mesh { material: scene.materials.len() - 1, ..mesh }));
            scene.nodes.push(Node { meshes: vec![scene.meshes.len() - 1], transform, ..Node::default() });
        }
        scene
    }

    fn found(scene: &Scene) -> (Snapshot, Vec<EmissiveMesh>) {
        let snapshot = Snapshot::new(scene, Seconds(0.0));
        let lights = snapshot.emissive_meshes(scene);
        (snapshot, lights)
    }

    fn placed(translation: Vec3, scale: Vec3) -> Transform {
        Transform::Trs { translation, rotation: glam::Quat::IDENTITY, scale }
    }

    #[test]
    fn area_power_and_centre_are_those_of_the_placed_mesh() {
        let red = LinearRgb::new(3.0, 1.0, 0.0);
        let up = placed(Vec3::new(1.0, 5.0, 2.0), Vec3::new(2.0, 3.0, 1.0));
        let both = Material { double_sided: true, ..glowing(red) };
        let (_, lights) = found(&scene(vec![(shapes::rectangle(1.0, 0.5), glowing(red), up), (shapes::rectangle(1.0, 0.5), both, up)]));
        let [one, two] = &lights[..] else { panic!("{} lights", lights.len()) };
        assert!((one.area - 3.0).abs() < 1e-5 && one.center.abs_diff_eq(Vec3::new(1.0, 5.0, 2.0), 1e-5), "{one:?}");
        assert!((one.power() - PI * 3.0 * red.luminance()).abs() < 1e-4 && (two.power() - 2.0 * one.power()).abs() < 1e-4);
        assert!((one.intensity().0 - red.0 * 0.75).abs().max_element() < 1e-5);
        assert_eq!((&one.shares, &one.choices, one.constant), (&vec![0.5, 0.5], &vec![0.5, 0.5], Some(red)));
    }

    #[test]
    fn flat_unlit_and_dark_instances_are_no_lights() {
        let white = LinearRgb::WHITE;
        let unlit = Material { unlit: true, ..glowing(white) };
        let at = |scale| placed(Vec3::ZERO, scale);
        let quad = || shapes::rectangle(1.0, 1.0);
        let parts = vec![
            (quad(), glowing(white), at(Vec3::ZERO)),
            (quad(), unlit, at(Vec3::ONE)),
            (quad(), Material::default(), at(Vec3::ONE)),
            (quad(), glowing(white), at(Vec3::ONE)),
        ];
        let (_, lights) = found(&scene(parts));
        assert_eq!(lights.iter().map(|light| light.instance).collect::<Vec<_>>(), [3]);
    }

    #[test]
    fn names_are_the_nodes_and_never_the_same_twice() {
        let quad = || (shapes::rectangle(1.0, 1.0), glowing(LinearRgb::WHITE), placed(Vec3::ZERO, Vec3::ONE));
        let mut scene = scene(vec![quad(), quad(), quad(), quad()]);
        scene.nodes[0].name = "lamp".into();
        scene.nodes[1].name = "lamp".into();
        Arc::make_mut(&mut scene.meshes[2]).name = "bulb".into();
        Arc::make_mut(&mut scene.meshes[3]).name.clear();
        let (snapshot, lights) = found(&scene);
        assert_eq!(snapshot.light_names(&scene, &lights), ["lamp", "lamp 2", "bulb", "mesh 3"]);
    }

    /// A strip of two quads: the left one black, the right one white in the texture.
    #[test]
    fn textured_triangles_have_the_share_of_their_texels() {
        let mut strip = Mesh::default();
        for x in [0.0f32, 1.0] {
            let first = strip.positions.len() as u32;
            for (u, v) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                strip.positions.push(Vec3::new(x + u, v, 0.0));
                strip.uvs[0].push(Vec2::new(0.25 + 0.5 * x, 0.5));
            }
            strip.indices.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        let texture = TextureRef { texture: 0, uv_set: 0, transform: glam::Affine2::IDENTITY };
        let material = Material { emission_texture: Some(texture), ..glowing(LinearRgb::splat(2.0)) };
        let mut scene = scene(vec![(strip, material, placed(Vec3::ZERO, Vec3::ONE))]);
        let texels = Texels::Rgba8(vec![[0, 0, 0, 255], [255, 255, 255, 255]]);
        scene.images.push(Arc::new(TextureImage { name: String::new(), width: 2, height: 1, texels }));
        scene.textures.push(Texture { image: 0, wrap: Default::default(), filter: Filter::Nearest, color_space: ColorSpace::Linear });
        let (_, lights) = found(&scene);
        let light = &lights[0];
        assert_eq!(light.shares, [0.0, 0.0, 0.5, 0.5]);
        assert!(light.chooses_by_area() && (light.choices.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        assert!(light.choices.iter().all(|&choice| choice > 0.0), "black where probed, and still found: {:?}", light.choices);
        assert!(light.center.abs_diff_eq(Vec3::new(1.5, 0.5, 0.0), 1e-5) && (light.radiance.0 - 1.0).abs().max_element() < 1e-5);
    }
}
