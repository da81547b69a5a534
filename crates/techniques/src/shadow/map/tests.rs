use super::*;
use crate::{TraceBackend, shaders};

#[test]
fn the_uniform_is_laid_out_as_the_shader_reads_it() {
    let linked =
        shaders::link("shadow/map/look_up", include_str!("look_up.wesl"), shaders::Variant::without_models(TraceBackend::Compute, true))
            .unwrap();
    linked.check_layout::<GpuMap>("Map").unwrap();
    assert!(size_of::<GpuMap>() as u64 <= STRIDE);
}
