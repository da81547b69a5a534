use super::*;
use crate::{TraceBackend, shaders};

#[test]
fn the_uniform_is_laid_out_as_the_shader_reads_it() {
    for backend in [TraceBackend::RayQuery, TraceBackend::Compute] {
        let variant = shaders::Variant::without_models(backend, true);
        shaders::link(TECHNIQUE.id, include_str!("ray_traced.wesl"), variant).unwrap().check_layout::<GpuParams>("Params").unwrap();
    }
}
