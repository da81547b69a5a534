//! The meshes that throw volumes: their edges on the device, and for each light which of them throw what.

use super::{Count, cull};
use crate::{Coverage, Error, FrameContext, FrameLight};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use kajo_render_graph::Buffer;
use kajo_render_graph::wgpu::BufferUsages;
use kajo_scene::adjacency::{Adjacency, Edge};
use kajo_scene::{Ignored, Mesh};
use kajo_shader_lib::ShaderLayout;
use std::sync::Arc;

/// Twin of `Job` in extract.wesl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable, ShaderLayout)]
pub(super) struct GpuJob {
    pub first_triangle: u32,
    pub first_edge: u32,
    pub edges: u32,
    pub instance: u32,
    pub whole: u32,
    pub closed: u32,
    pub inside_out: u32,
    pub padding: u32,
}

/// What one light has extracted.
#[derive(Clone, Debug, Default)]
pub(super) struct Jobs {
    pub list: Vec<GpuJob>,
    pub triangles: u32,
    pub edges: u32,
    /// Most side polygons there can be.
    pub most_sides: u64,
}

/// A mesh of the snapshot.
#[derive(Clone, Debug)]
struct CasterMesh {
    mesh: Arc<Mesh>,
    adjacency: Arc<Adjacency>,
    /// Where its edges begin.
    first_edge: u32,
    /// Box in object space, m.
    bounds: [Vec3; 2],
    /// Its triangles face inwards, if it is closed.
    inside_out: bool,
}

/// The casters of a scene.
#[derive(Debug, Default)]
pub(super) struct Casters {
    meshes: Vec<CasterMesh>,
    edges: Option<Buffer>,
    notes: Vec<Ignored>,
}

/// One open edge in so many leaves a mesh nearly closed.
const NEARLY: usize = 20;

/// No triangle at a side of an edge, as in extract.wesl.
const NO_SIDE: u32 = u32::MAX;

impl Casters {
    /// Finds the edges of meshes that changed, and uploads them.
    pub fn update(&mut self, frame: &FrameContext) -> Result<(), Error> {
        let meshes = &frame.snapshot.meshes;
        let same = |(known, mesh): (&CasterMesh, &Arc<Mesh>)| Arc::ptr_eq(&known.mesh, mesh);
        if self.edges.is_some() && self.meshes.len() == meshes.len() && self.meshes.iter().zip(meshes).all(same) {
            return Ok(());
        }
        let mut first_edge = 0;
        let mut moved = self.edges.is_none() || self.meshes.len() != meshes.len();
        let mut list = Vec::with_capacity(meshes.len());
        for (index, mesh) in meshes.iter().enumerate() {
            let known = self.meshes.get(index).filter(|known| known.mesh.indices == mesh.indices && known.adjacency.fits(mesh));
            let adjacency = known.map_or_else(|| Arc::new(Adjacency::new(mesh)), |known| known.adjacency.clone());
            moved |= known.is_none();
            let count = adjacency.edges.len() as u32;
            let empty = [Vec3::INFINITY, Vec3::NEG_INFINITY];
            let bounds = mesh.positions.iter().fold(empty, |[low, high], p| [low.min(*p), high.max(*p)]);
            list.push(CasterMesh { mesh: mesh.clone(), adjacency, first_edge, bounds, inside_out: volume(mesh) < 0.0 });
            first_edge += count;
        }
        self.meshes = list;
        if moved {
            let packed: Vec<[u32; 4]> = self.meshes.iter().flat_map(|caster| caster.adjacency.edges.iter().map(pack)).collect();
            self.edges = Some(frame.device.buffer_with("shadow/volume edges", &packed, BufferUsages::STORAGE)?);
        }
        self.notes = self.find_notes(frame);
        Ok(())
    }

    /// The edges of all meshes.
    pub fn edges(&self) -> &Buffer {
        self.edges.as_ref().expect("prepared")
    }

    /// What throws volumes for a light.
    /// `soft`: the count is a sum of coverages, in which layers of a body must not count twice.
    pub fn jobs(&self, frame: &FrameContext, light: &FrameLight, (count, culling, soft): (Count, bool, bool)) -> Jobs {
        let mut out = Jobs::default();
        let light_at = cull::light_point(light, frame.view.position);
        for (draw, instance) in frame.draws.iter().zip(&frame.snapshot.instances) {
            let caster = &self.meshes[instance.mesh];
            let flat = instance.world_from_object.matrix3.determinant() == 0.0;
            // A lamp stands around its own centre, and must not block what it shines at. What is blended blocks a share, which no count can say.
            if flat || light.is(draw.instance) || draw.coverage == Coverage::Blend || caster.adjacency.edges.is_empty() {
                continue;
            }
            let bounds = cull::relative_box(caster.bounds, &instance.world_from_object, frame.view.position);
            if culling && cull::is_out_of_sight(&bounds, light_at, &frame.view) {
                continue;
            }
            let masked = draw.coverage == Coverage::Mask;
            let topology = &caster.adjacency.topology;
            let closed = topology.is_closed();
            let nearly = topology.unbalanced * NEARLY < topology.edges;
            // Around a closed mesh that holds neither the light nor the camera, what faces the light and what does not throw the same shadow.
            let inside = [cull::holds(&bounds, light_at), cull::is_near(&bounds, &frame.view)];
            let whole = if soft { !nearly || inside[0] != inside[1] } else { masked || !closed || inside[0] || inside[1] };
            let edges = &caster.adjacency.edges;
            out.list.push(GpuJob {
                first_triangle: out.triangles,
                first_edge: out.edges,
                edges: caster.first_edge,
                instance: draw.instance,
                whole: u32::from(whole),
                // Between the camera and what it sees lie no caps but those that can be seen through.
                closed: u32::from(count == Count::Behind || masked),
                inside_out: u32::from(caster.inside_out),
                ..GpuJob::default()
            });
            out.triangles += caster.mesh.indices.len() as u32;
            out.edges += edges.len() as u32;
            let most = if whole { edges.iter().map(|edge| edge.sides.iter().flatten().count() as u64).sum() } else { edges.len() as u64 };
            out.most_sides += most;
        }
        out
    }

    /// What a user should know about the meshes.
    pub fn notes(&self, id: &str) -> Vec<Ignored> {
        self.notes.iter().map(|note| Ignored { consequence: format!("{id}: {}", note.consequence), ..note.clone() }).collect()
    }

    fn find_notes(&self, frame: &FrameContext) -> Vec<Ignored> {
        let file = &frame.scene.name;
        let mut out = Vec::new();
        let open: Vec<&CasterMesh> = self.meshes.iter().filter(|caster| !caster.adjacency.topology.is_closed()).collect();
        if let Some(worst) = open.iter().max_by_key(|caster| caster.adjacency.topology.unbalanced) {
            out.push(Ignored {
                file: file.clone(),
                place: format!("{} of {} meshes", open.len(), self.meshes.len()),
                feature: format!(
                    "not closed (\"{}\": {} of {} edges are open or disagree)",
                    worst.mesh.name, worst.adjacency.topology.unbalanced, worst.adjacency.topology.edges
                ),
                consequence: "each triangle throws a volume of its own: the same shadow, more polygons".into(),
            });
        }
        for (coverage, feature, consequence) in [
            (Coverage::Mask, "alpha mask", "masked surfaces throw the shadow of whole triangles; a volume knows no texture"),
            (Coverage::Blend, "alpha blend", "blended surfaces throw no shadow; a count knows no share"),
        ] {
            let number = frame.draws.iter().filter(|draw| draw.coverage == coverage).count();
            if number > 0 {
                let place = format!("{number} of {} placed meshes", frame.draws.len());
                out.push(Ignored { file: file.clone(), place, feature: feature.into(), consequence: consequence.into() });
            }
        }
        out
    }
}

/// Signed volume of a closed mesh, m³; negative where its triangles face inwards.
fn volume(mesh: &Mesh) -> f64 {
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
    let cone = |[a, b, c]: [glam::DVec3; 3]| a.dot(b.cross(c)) / 6.0;
    mesh.indices.iter().map(|triangle| cone(corners(triangle))).sum()
}

/// An edge as the shader reads it.
fn pack(edge: &Edge) -> [u32; 4] {
    let [a, b] = edge.sides.map(|side| side.map_or(NO_SIDE, |side| 2 * side.triangle + u32::from(!side.forward)));
    [edge.vertices[0], edge.vertices[1], a, b]
}
