use super::*;
use crate::{TraceBackend, shaders};

#[test]
fn the_uniform_is_laid_out_as_the_shader_reads_it() {
    let variant = shaders::Variant::without_models(TraceBackend::Compute, true);
    shaders::link(TECHNIQUE.id, include_str!("planar.wesl"), variant).unwrap().check_layout::<GpuMirror>("Mirror").unwrap();
}
