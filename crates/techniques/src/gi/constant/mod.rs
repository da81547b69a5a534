//! A constant ambient term.

#[cfg(test)]
mod tests;

use super::READS;
use super::light_power::{around, light_powers};
use crate::still_life::StillLife;
use crate::{Effect, Error, FrameContext, MakeContext, Needs, Role, Technique};
use glam::Vec3;
use kajo_params::{ParamChoice, ParamValues, Params};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Access, Bindings, Buffer, ComputePipeline, Graph, PipelineOptions, slot};
use kajo_scene::{Material, Scene, Snapshot};
use kajo_units::Radiance;
use std::f32::consts::PI;

/// The technique.
pub const TECHNIQUE: Technique = Technique {
    id: "gi/constant",
    role: Role::DiffuseIndirect,
    title: "Constant ambient term",
    doc: include_str!("doc.md"),
    cites: &["Cohen88"],
    reads: READS,
    needs: Needs::NONE,
    params: Params::SPEC,
    make: |context, values| Ok(Box::new(Constant::new(context, values)?)),
};

/// Where the radiance is from.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// The mean that the power of the lights and the reflectances leave.
    Scene,
    /// A parameter.
    Given,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Scene takes what an even exchange between all surfaces would leave, given takes `radiance`.
    #[param(default = Of::Scene)]
    pub of: Of,
    /// Radiance from everywhere where it is given.
    #[param(default = 0.1, range = 0.0..=1000000.0, unit = "W/(m² sr)")]
    pub radiance: Radiance,
}

/// What the shader reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable, kajo_shader_lib::ShaderLayout)]
struct GpuParams {
    irradiance: Vec3,
    padding: u32,
}

struct Constant {
    params: Params,
    pipeline: ComputePipeline,
    uniform: Buffer,
    still: StillLife,
    irradiance: Vec3,
}

impl Constant {
    fn new(context: &MakeContext, values: &ParamValues) -> Result<Self, Error> {
        let shader = context.shader(TECHNIQUE.id, include_str!("constant.wesl"))?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        Ok(Self {
            params: Params::from_values(values),
            pipeline: ComputePipeline::new(context.device, &shader, "fill", options)?,
            uniform: context.device.buffer(TECHNIQUE.id, size_of::<GpuParams>() as u64, usage)?,
            still: StillLife::default(),
            irradiance: Vec3::ZERO,
        })
    }
}

impl Effect for Constant {
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error> {
        if self.still.changed(frame) {
            self.irradiance = match self.params.of {
                Of::Given => Vec3::splat(PI * self.params.radiance.0),
                Of::Scene => even_exchange(frame.scene, frame.snapshot, around(frame.bounds).1),
            };
        }
        let params = GpuParams { irradiance: self.irradiance, padding: 0 };
        self.uniform.write(&frame.device.queue, bytemuck::bytes_of(&params));
        Ok(())
    }

    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        graph.pass(Access::new("gi/constant/fill").reads(READS).writes(&[slot::DIFFUSE_INDIRECT]), move |pass| {
            let own = Bindings::new()
                .with("params", &self.uniform)
                .with("depth", pass.view(slot::DEPTH)?)
                .with("irradiance", pass.view(slot::DIFFUSE_INDIRECT)?);
            self.pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, frame.size().extend(1))
        });
    }
}

/// Irradiance by light that bounced, W/m², if every surface gave its light to all others alike: (Φ/A) ρ̄/(1 − ρ̄).    \[Cohen88]
///
/// Unlit surfaces reflect nothing. `radius` (m) bounds the scene: directional lights shine on a disc of it.
fn even_exchange(scene: &Scene, snapshot: &Snapshot, radius: f32) -> Vec3 {
    let power: Vec3 = light_powers(scene, snapshot, radius).iter().map(|power| power.0).sum();
    let default = Material::default();
    let (mut area, mut reflecting) = (0.0f32, Vec3::ZERO);
    for instance in &snapshot.instances {
        let mesh = &snapshot.meshes[instance.mesh];
        let material = scene.materials.get(mesh.material).unwrap_or(&default);
        let corner = |i: u32| instance.world_from_object.transform_point3(mesh.positions[i as usize]);
        let triangle = |[a, b, c]: [u32; 3]| {
            let a = corner(a);
            0.5 * (corner(b) - a).cross(corner(c) - a).length()
        };
        let here: f32 = mesh.indices.iter().map(|indices| triangle(*indices)).sum();
        area += here;
        if !material.unlit {
            reflecting += here * material.base_color.0 * (1.0 - material.transmission);
        }
    }
    if area <= 0.0 {
        return Vec3::ZERO;
    }
    // A closed white room never becomes even.
    let mean = (reflecting / area).clamp(Vec3::ZERO, Vec3::splat(MOST_REFLECTANCE));
    power / area * mean / (1.0 - mean)
}

/// Bounds the sum of the bounces in scenes that are all white.
const MOST_REFLECTANCE: f32 = 0.95;
