use super::*;
use crate::{TraceBackend, shaders};

#[test]
fn structs_are_laid_out_as_the_shaders_read_them() {
    for backend in [TraceBackend::RayQuery, TraceBackend::Compute] {
        let variant = shaders::Variant::without_models(backend, true);
        for (name, source) in [("gi/probes", include_str!("probes.wesl")), ("gi/probes/bake", include_str!("bake.wesl"))] {
            let linked = shaders::link_with_files(name, source, FILES, variant).unwrap();
            linked.check_layout::<GpuGrid>("Grid").unwrap();
            linked.check_layout::<GpuProbe>("Probe").unwrap();
        }
    }
}
