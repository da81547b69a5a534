use super::*;
use crate::{TraceBackend, shaders};

#[test]
fn the_uniforms_are_laid_out_as_the_shaders_read_them() {
    let variant = shaders::Variant::without_models(TraceBackend::Compute, true);
    let look_up = "import package::depth_map::map; @compute @workgroup_size(1) fn main() { _ = map.light; }";
    shaders::link("test", look_up, variant).unwrap().check_layout::<GpuMap>("Map").unwrap();
    shaders::link("cast", include_str!("cast.wesl"), variant).unwrap().check_layout::<caster::GpuFace>("Face").unwrap();
    assert!(size_of::<GpuMap>() as u64 <= STRIDE && caster::FACE_BYTES <= FACE_STRIDE);
}
