use super::*;
use crate::{TraceBackend, shaders};

#[test]
fn the_uniform_is_laid_out_as_the_shader_reads_it() {
    let linked =
        shaders::link(TECHNIQUE.id, include_str!("none.wesl"), shaders::Variant::without_models(TraceBackend::Compute, true)).unwrap();
    linked.check_layout::<GpuParams>("Params").unwrap();
}
