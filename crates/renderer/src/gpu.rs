//! Structs as shaders read them; tests compare each with its WGSL twin.

use bytemuck::{Pod, Zeroable};
use kajo_shader_lib::ShaderLayout;
use kajo_shader_lib::models::MOST_CONSTANTS;

/// Twin of `frame::Frame`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, ShaderLayout)]
pub(crate) struct GpuFrame {
    pub clip_from_relative: [[f32; 4]; 4],
    pub relative_from_clip: [[f32; 4]; 4],
    pub previous_clip_from_relative: [[f32; 4]; 4],
    pub camera_position: [f32; 3],
    pub index: u32,
    pub previous_camera_position: [f32; 3],
    pub light_count: u32,
    pub forward: [f32; 3],
    pub near: f32,
    pub jitter: [f32; 2],
    pub size: [u32; 2],
    pub environment_scale: [f32; 3],
    pub environment_rotation: f32,
    pub perspective: u32,
    pub environment_image: u32,
    pub depth_range: f32,
    pub environment_light: u32,
}

/// Twin of `scene::Instance`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, ShaderLayout)]
pub(crate) struct GpuInstance {
    /// Four columns, each padded to four numbers.
    pub relative_from_object: [[f32; 4]; 4],
    pub previous_relative_from_object: [[f32; 4]; 4],
    pub first_vertex: u32,
    pub previous_first_vertex: u32,
    pub first_index: u32,
    pub material: u32,
    pub flags: u32,
    pub light: u32,
    pub padding_b: u32,
    pub padding_c: u32,
}

impl GpuInstance {
    /// An instance that emits nothing.
    pub const NO_LIGHT: u32 = u32::MAX;
    /// The transform turns the winding round.
    pub const MIRRORED: u32 = 1;
    /// The mesh has tangents.
    pub const HAS_TANGENTS: u32 = 2;
}

/// Twin of `scene::Attributes`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, ShaderLayout)]
pub(crate) struct GpuAttributes {
    pub normal: [f32; 3],
    pub u0: f32,
    pub tangent: [f32; 4],
    pub v0: f32,
    pub u1: f32,
    pub v1: f32,
    pub padding: f32,
    pub color: [f32; 4],
}

/// Twin of `material::TextureRef`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, ShaderLayout)]
pub(crate) struct GpuTextureRef {
    pub texture: u32,
    pub sampler: u32,
    pub uv_set: u32,
    pub padding: u32,
    pub x_axis: [f32; 2],
    pub y_axis: [f32; 2],
    pub translation: [f32; 2],
    pub padding_b: [f32; 2],
}

/// Number of textures of a material.
pub(crate) const MATERIAL_TEXTURES: usize = 16;

/// Twin of `shader_lib::models::geometry::ModelConstants`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, ShaderLayout)]
pub(crate) struct GpuModelConstants {
    pub data: [[f32; 4]; MOST_CONSTANTS / 4],
}

/// Twin of `material::Material`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, ShaderLayout)]
pub(crate) struct GpuMaterial {
    pub base_color: [f32; 3],
    pub alpha: f32,
    pub emission: [f32; 3],
    pub cutoff: f32,
    pub specular_color: [f32; 3],
    pub specular: f32,
    pub sheen_color: [f32; 3],
    pub sheen_roughness: f32,
    pub metallic: f32,
    pub roughness: f32,
    pub normal_scale: f32,
    pub occlusion_strength: f32,
    pub ior: f32,
    pub clearcoat: f32,
    pub clearcoat_roughness: f32,
    pub clearcoat_normal_scale: f32,
    pub anisotropy: f32,
    pub anisotropy_rotation: f32,
    pub transmission: f32,
    pub thickness: f32,
    pub iridescence: f32,
    pub iridescence_ior: f32,
    pub iridescence_thickness_min: f32,
    pub iridescence_thickness_max: f32,
    pub alpha_mode: u32,
    pub flags: u32,
    pub model: u32,
    pub padding: u32,
    pub constants: GpuModelConstants,
    pub textures: [GpuTextureRef; MATERIAL_TEXTURES],
}

impl GpuMaterial {
    pub const UNLIT: u32 = 1;
    pub const DOUBLE_SIDED: u32 = 2;
}

/// Twin of `lights::LightTriangle`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable, ShaderLayout)]
pub(crate) struct GpuLightTriangle {
    pub end: u32,
    pub keep: f32,
}

/// Twin of `trace::BvhInfo`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, ShaderLayout)]
pub(crate) struct GpuBvhInfo {
    pub margin: f32,
    pub extra: f32,
    pub mesh_margin: f32,
    pub empty: u32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_techniques::{TraceBackend, shaders};

    /// A root that reads one element of each buffer.
    const ROOT: &str = "
        import package::frame::frame;
        import package::scene::{instances, attributes};
        import package::material::materials;
        import package::lights::{lights, light_triangles};
        @group(1) @binding(0) var<storage, read_write> out: array<f32>;
        @compute @workgroup_size(1) fn main() {
            out[0] = frame.near + f32(instances[0].material) + attributes[0].u0 + materials[0].ior + lights[0].size + light_triangles[0].keep;
        }";

    #[test]
    fn every_struct_is_laid_out_as_the_shaders_read_it() {
        let linked = shaders::link("test", ROOT, shaders::Variant::without_models(TraceBackend::Compute, true)).unwrap();
        linked.check_layout::<GpuFrame>("Frame").unwrap();
        linked.check_layout::<GpuInstance>("Instance").unwrap();
        linked.check_layout::<GpuAttributes>("Attributes").unwrap();
        linked.check_layout::<GpuMaterial>("Material").unwrap();
        linked.check_layout::<GpuTextureRef>("TextureRef").unwrap();
        linked.check_layout::<GpuLightTriangle>("LightTriangle").unwrap();
    }
}
