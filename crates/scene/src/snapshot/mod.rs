//! A scene evaluated at one time: world transforms, deformed meshes, placed lights and cameras.
//!
//! [`Snapshot::new`] samples the animation that plays ([`pose`]), multiplies the node hierarchy out ([`placement`]) and deforms the
//! meshes that have morph targets or a skin ([`deform`]). Renderers see snapshots only and never a node.

mod deform;
mod placement;
mod pose;

use crate::{Camera, Light, Mesh, Scene, framing};
use glam::{Affine3A, Mat4};
use kajo_names::{UnknownName, choose};
use kajo_units::Seconds;
use pose::Pose;
use rayon::prelude::*;
use std::sync::Arc;

/// What the renderers see: the scene with every animation, skin and morph evaluated at `time`.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// The time it was evaluated at.
    pub time: Seconds,
    /// Meshes in object space; those that deform are new, the others shared with the scene. The first ones are in the scene's order.
    pub meshes: Vec<Arc<Mesh>>,
    /// Placed meshes, in node order: equal scenes give equal lists, so an index names the same thing at every time.
    pub instances: Vec<Instance>,
    /// Placed lights, in node order.
    pub lights: Vec<PlacedLight>,
    /// Placed cameras, in node order; never empty (a camera that frames the scene is made where a file has none).
    pub cameras: Vec<PlacedCamera>,
}

/// A mesh in the world.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Index into [`Scene::nodes`](crate::Scene::nodes).
    pub node: usize,
    /// Index into [`Snapshot::meshes`].
    pub mesh: usize,
    /// Object to world; may mirror, and may flatten (a scale of 0, as animations use to hide things). Always finite.
    pub world_from_object: Affine3A,
}

/// A light in the world.
#[derive(Clone, Debug)]
pub struct PlacedLight {
    /// The light.
    pub light: Light,
    /// Light space (shines along −z) to world.
    pub world_from_light: Affine3A,
}

/// A camera in the world.
#[derive(Clone, Debug)]
pub struct PlacedCamera {
    /// The camera.
    pub camera: Camera,
    /// View space (looks along −z) to world; rigid.
    pub world_from_view: Mat4,
}

impl Snapshot {
    /// True when the same light falls on every surface of two snapshots of one scene: neither bodies nor lights move between them.
    pub fn same_bodies_and_lights(&self, other: &Self) -> bool {
        let same_mesh = |(a, b): (&Arc<Mesh>, &Arc<Mesh>)| Arc::ptr_eq(a, b);
        let same_place = |(a, b): (&Instance, &Instance)| a.mesh == b.mesh && a.world_from_object == b.world_from_object;
        let same_light = |(a, b): (&PlacedLight, &PlacedLight)| a.light == b.light && a.world_from_light == b.world_from_light;
        (self.meshes.len(), self.instances.len(), self.lights.len()) == (other.meshes.len(), other.instances.len(), other.lights.len())
            && self.meshes.iter().zip(&other.meshes).all(same_mesh)
            && self.instances.iter().zip(&other.instances).all(same_place)
            && self.lights.iter().zip(&other.lights).all(same_light)
    }

    /// Evaluates `scene` at `time`.
    ///
    /// The animation [`Scene::animation`] plays, all its channels together; before its first key and after its last the values are held.
    /// A skinned mesh comes out in world space, so its instance has the identity transform. One mesh that several nodes deform
    /// is several meshes here: the first takes the place the mesh has in the scene, the others stand after the scene's meshes.
    pub fn new(scene: &Scene, time: Seconds) -> Self {
        let pose = Pose::sample(scene, time);
        let world_from_node = placement::world_from_nodes(scene, &pose.parent_from_node);

        let mut meshes = scene.meshes.clone();
        let mut instances = Vec::new();
        let mut taken = rigid_meshes(scene);
        let mut deformed = Vec::new();
        for (node_index, node) in scene.nodes.iter().enumerate() {
            for &mesh in &node.meshes {
                let mut instance = Instance { node: node_index, mesh, world_from_object: world_from_node[node_index] };
                if deform::deforms(&scene.meshes[mesh], node) {
                    if std::mem::replace(&mut taken[mesh], true) {
                        instance.mesh = meshes.len();
                        meshes.push(scene.meshes[mesh].clone());
                    }
                    if deform::is_skinned(&scene.meshes[mesh], node) {
                        instance.world_from_object = Affine3A::IDENTITY;
                    }
                    deformed.push((node_index, mesh, instance.mesh));
                }
                instances.push(instance);
            }
        }
        let results: Vec<_> = deformed
            .par_iter()
            .map(|&(node, mesh, slot)| (slot, deform::deform(scene, node, mesh, &pose.morph_weights[node], &world_from_node)))
            .collect();
        for (slot, mesh) in results {
            meshes[slot] = Arc::new(mesh);
        }

        let lights = placed(scene, |node| node.light)
            .map(|(node, light)| PlacedLight { light: scene.lights[light].clone(), world_from_light: world_from_node[node] })
            .collect();
        let mut cameras: Vec<_> = placed(scene, |node| node.camera)
            .map(|(node, camera)| PlacedCamera {
                camera: scene.cameras[camera].clone(),
                world_from_view: placement::rigid(&world_from_node[node]),
            })
            .collect();
        if cameras.is_empty() {
            cameras.push(framing::default_camera(framing::bounds(&meshes, &instances)));
        }
        Self { time, meshes, instances, lights, cameras }
    }

    /// The index of the camera that `word` names or numbers.
    ///
    /// # Errors
    /// [`UnknownName`] with the cameras there are.
    pub fn find_camera(&self, word: &str) -> Result<usize, UnknownName> {
        choose("camera", word, &self.cameras.iter().map(|placed| placed.camera.name.as_str()).collect::<Vec<_>>())
    }
}

/// For each mesh, whether a node shows it as it is in the scene.
fn rigid_meshes(scene: &Scene) -> Vec<bool> {
    let mut rigid = vec![false; scene.meshes.len()];
    for node in &scene.nodes {
        for &mesh in node.meshes.iter().filter(|&&mesh| !deform::deforms(&scene.meshes[mesh], node)) {
            rigid[mesh] = true;
        }
    }
    rigid
}

/// Pairs of a node and what it places.
fn placed(scene: &Scene, what: impl Fn(&crate::Node) -> Option<usize>) -> impl Iterator<Item = (usize, usize)> {
    scene.nodes.iter().enumerate().filter_map(move |(index, node)| what(node).map(|thing| (index, thing)))
}

#[cfg(test)]
mod tests;
