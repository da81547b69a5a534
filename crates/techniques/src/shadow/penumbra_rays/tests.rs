use super::*;
use crate::{TraceBackend, shaders};

#[test]
fn the_uniforms_are_laid_out_as_the_shaders_read_them() {
    let variant = shaders::Variant::without_models(TraceBackend::Compute, true);
    shaders::link(TECHNIQUE.id, include_str!("penumbra_rays.wesl"), variant).unwrap().check_layout::<GpuParams>("Params").unwrap();
    shaders::link("sort", include_str!("sort.wesl"), variant).unwrap().check_layout::<GpuSort>("Params").unwrap();
}
