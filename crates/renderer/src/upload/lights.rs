//! Lights as shaders read them: analytic ones, then emissive meshes with the triangles that samplers choose from.

use crate::Error;
use crate::gpu::{GpuInstance, GpuLightTriangle};
use glam::Vec3;
use kajo_bvh::{Blas, BuildOptions, Filter, PrimitiveRef, Ray, Tlas};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Bindings, Buffer, Device};
use kajo_sampling::warp::{triangle_barycentrics, uniform_sphere};
use kajo_sampling::{AliasTable, Rng};
use kajo_scene::{EmissiveMesh, Mesh, Scene, Snapshot};
use kajo_shader_lib::light::{GpuLight, MESH};
use kajo_techniques::FrameLight;
use std::sync::Arc;

/// The lights of a snapshot on the device.
#[derive(Debug)]
pub(crate) struct Lights {
    /// In the order of the buffer: analytic ones, then emissive instances, each in the snapshot's order.
    pub list: Vec<FrameLight>,
    /// Of each, as the path tracer names them.
    pub names: Vec<String>,
    meshes: Vec<MeshEntry>,
    lights: Buffer,
    triangles: Buffer,
}

/// An emissive mesh, its position still the world's, and what `unhidden` was computed for.
#[derive(Clone, Debug)]
struct MeshEntry {
    light: GpuLight,
    mesh: Arc<Mesh>,
    linear: glam::Mat3A,
}

impl Lights {
    /// Uploads the triangles; what `old` knows of a mesh that did not change is taken over.
    pub fn new(device: &Device, scene: &Scene, snapshot: &Snapshot, old: Option<&Self>) -> Result<Self, Error> {
        let emissive = snapshot.emissive_meshes(scene);
        let mut triangles = Vec::new();
        let mut meshes = Vec::with_capacity(emissive.len());
        for light in &emissive {
            let instance = &snapshot.instances[light.instance];
            let (mesh, linear) = (&snapshot.meshes[instance.mesh], instance.world_from_object.matrix3);
            let known = old.and_then(|old| old.meshes.iter().find(|known| Arc::ptr_eq(&known.mesh, mesh) && known.linear == linear));
            let unhidden = match known {
                Some(known) => known.light.unhidden,
                None => unhidden(light, mesh, snapshot)?,
            };
            let first_triangle = triangles.len() as u32;
            triangles.extend(intervals(light));
            let light = GpuLight {
                position: light.center,
                kind: MESH,
                emission: light.intensity().0,
                unhidden,
                first_triangle,
                triangle_count: triangles.len() as u32 - first_triangle,
                instance: light.instance as u32,
                double_sided: u32::from(light.double_sided),
                ..GpuLight::default()
            };
            meshes.push(MeshEntry { light, mesh: mesh.clone(), linear });
        }
        let analytic = snapshot.lights.iter().cloned().map(FrameLight::Analytic);
        let shining = emissive.iter().map(|light| FrameLight::Mesh { instance: light.instance as u32, center: light.center });
        let list: Vec<FrameLight> = analytic.chain(shining).collect();
        let storage = BufferUsages::STORAGE;
        Ok(Self {
            names: snapshot.light_names(scene, &emissive),
            lights: device.buffer("lights", (list.len().max(1) * size_of::<GpuLight>()) as u64, storage | BufferUsages::COPY_DST)?,
            triangles: device.buffer_with("light triangles", &triangles, storage)?,
            list,
            meshes,
        })
    }

    /// Uploads what depends on the camera's position.
    pub fn place(&self, device: &Device, camera: Vec3) {
        let analytic = self.list.iter().filter_map(FrameLight::analytic).map(|placed| GpuLight::new(placed, camera));
        let meshes = self.meshes.iter().map(|entry| GpuLight { position: entry.light.position - camera, ..entry.light });
        let lights: Vec<GpuLight> = analytic.chain(meshes).collect();
        self.lights.write(&device.queue, bytemuck::cast_slice(&lights));
    }

    /// Where an instance stands in the list, or [`GpuInstance::NO_LIGHT`].
    pub fn place_of(&self, instance: usize) -> u32 {
        let found = self.meshes.binary_search_by_key(&(instance as u32), |entry| entry.light.instance);
        found.map_or(GpuInstance::NO_LIGHT, |at| (self.list.len() - self.meshes.len() + at) as u32)
    }

    pub fn bind<'a>(&'a self, bindings: Bindings<'a>) -> Bindings<'a> {
        bindings.with("lights", &self.lights).with("light_triangles", &self.triangles)
    }
}

/// The choices among the triangles as ends of intervals of [0, 2³²), and how often a choice stands by the share in the emission.
fn intervals(light: &EmissiveMesh) -> Vec<GpuLightTriangle> {
    let ratio = |i: usize| if light.choices[i] > 0.0 { light.shares[i] / light.choices[i] } else { 0.0 };
    let most = (0..light.choices.len()).map(ratio).fold(0.0, f32::max);
    let total: f64 = light.choices.iter().map(|&choice| f64::from(choice)).sum();
    let last = light.choices.iter().rposition(|&choice| choice > 0.0).unwrap_or(0);
    let mut sum = 0.0;
    let end = |(i, &choice): (usize, &f32)| {
        sum += f64::from(choice);
        let end = if i >= last { u32::MAX } else { (sum / total * 4_294_967_296.0) as u32 };
        GpuLightTriangle { end, keep: ratio(i) / most }
    };
    light.choices.iter().enumerate().map(end).collect()
}

/// Rays that estimate [`unhidden`]: its standard error is at most 0.8 %.
const RAYS: u32 = 4096;

/// Of the emission that faces a distant point, the share that the mesh does not hide itself, mean over all directions: 1 for plates and convex
/// lamps, ½ for a ball that shines on both sides. A technique that leaves the lamp out of its occluders multiplies by it. A mesh that shows
/// nothing to the outside shines on what it encloses: 1.
fn unhidden(light: &EmissiveMesh, mesh: &Mesh, snapshot: &Snapshot) -> Result<f32, Error> {
    let world_from_object = snapshot.instances[light.instance].world_from_object;
    let positions: Vec<Vec3> = mesh.positions.iter().map(|p| world_from_object.transform_point3(*p)).collect();
    let mirrored = world_from_object.matrix3.determinant() < 0.0;
    let corners = |triangle: u32| mesh.indices[triangle as usize].map(|i| positions[i as usize]);
    if lies_in_a_plane(&positions) {
        return Ok(1.0);
    }
    let Some(table) = AliasTable::new(&light.shares) else { return Ok(1.0) };
    let tlas = Tlas::single(Blas::build(&positions, &mesh.indices, &BuildOptions::default())?);
    let mut random = Rng::new(0);
    let (mut facing, mut open) = (0u32, 0u32);
    for _ in 0..RAYS {
        let triangle = table.sample(random.next_1d()).0 as u32;
        let [a, b, c] = corners(triangle);
        let w = triangle_barycentrics(random.next_2d());
        let direction = uniform_sphere(random.next_2d());
        let height = (b - a).cross(c - a).dot(direction) * if mirrored { -1.0 } else { 1.0 };
        if height <= 0.0 && !light.double_sided {
            continue;
        }
        facing += 1;
        let itself = PrimitiveRef { instance: 0, primitive: triangle };
        let ray = Ray::new(a * w.x + b * w.y + c * w.z, direction);
        open += u32::from(!tlas.any_hit_opaque(&ray, Filter { exclude: Some(itself), ..Filter::ALL }));
    }
    Ok(if open > 0 { open as f32 / facing as f32 } else { 1.0 })
}

/// Whether all points lie in one plane, up to a ten-thousandth of their extent.
fn lies_in_a_plane(points: &[Vec3]) -> bool {
    let Some(&first) = points.first() else { return true };
    let farthest =
        |measure: &dyn Fn(Vec3) -> f32| points.iter().copied().max_by(|p, q| measure(*p).total_cmp(&measure(*q))).unwrap_or(first);
    let along = farthest(&|p| p.distance_squared(first)) - first;
    let normal = along.cross(farthest(&|p| along.cross(p - first).length_squared()) - first).normalize_or_zero();
    points.iter().all(|p| (*p - first).dot(normal).abs() <= 1e-4 * along.length())
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_scene::{Material, Node, shapes};
    use kajo_units::{LinearRgb, Seconds};

    fn emissive(mesh: Mesh, double_sided: bool) -> (EmissiveMesh, Snapshot) {
        let scene = Scene {
            materials: vec![Material { emission: LinearRgb::WHITE, double_sided, ..Material::default() }],
            meshes: vec![Arc::new(mesh)],
            nodes: vec![Node { meshes: vec![0], ..Node::default() }],
            ..Scene::default()
        };
        let snapshot = Snapshot::new(&scene, Seconds(0.0));
        (snapshot.emissive_meshes(&scene).remove(0), snapshot)
    }

    #[test]
    fn a_lamp_hides_of_itself_what_geometry_says() {
        let share = |mesh: Mesh, double_sided| {
            let (light, snapshot) = emissive(mesh.clone(), double_sided);
            unhidden(&light, &mesh, &snapshot).unwrap()
        };
        for double_sided in [false, true] {
            assert_eq!(share(shapes::rectangle(1.0, 2.0), double_sided), 1.0);
        }
        assert_eq!(share(shapes::sphere(0.5, 32), false), 1.0, "what faces is not hidden on a convex lamp");
        let both = share(shapes::sphere(0.5, 32), true);
        assert!((both - 0.5).abs() < 0.03, "a ball hides the far half of its inside: {both}");
        assert_eq!(share(shapes::cuboid(Vec3::ONE).inside_out(), false), 1.0, "a box that shines inwards is seen from inside");
    }

    /// Intervals tile [0, 2³²) with the lengths of the choices; triangles without emission have none.
    #[test]
    fn intervals_are_as_long_as_the_choices() {
        let (mut light, _) = emissive(shapes::sphere(1.0, 24), false);
        light.shares[5] = 0.0;
        let total: f32 = light.shares.iter().sum();
        light.choices = light.shares.clone();
        let all = intervals(&light);
        let mut begin = 0u32;
        for (entry, choice) in all.iter().zip(&light.choices) {
            let length = f64::from(entry.end - begin) / 4_294_967_296.0;
            assert!((length - f64::from(choice / total)).abs() < 1e-7, "{length} for {choice}");
            begin = entry.end;
        }
        assert_eq!((begin, all[5].keep, all[6].keep), (u32::MAX, 0.0, 1.0));
    }
}
