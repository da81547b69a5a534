use super::sources::choices;
use super::*;
use crate::gi::sky::SkyRay;
use crate::{TraceBackend, shaders};

#[test]
fn structs_are_laid_out_as_the_shader_reads_them() {
    for backend in [TraceBackend::RayQuery, TraceBackend::Compute] {
        let linked = shaders::link(TECHNIQUE.id, include_str!("vpl.wesl"), shaders::Variant::without_models(backend, true)).unwrap();
        linked.check_layout::<GpuParams>("Params").unwrap();
        linked.check_layout::<SkyRay>("SkyRay").unwrap();
    }
}

#[test]
fn paths_are_dealt_out_by_power() {
    let dealt = choices(&[1.0, 0.0, 3.0, 0.0]);
    assert_eq!(dealt.iter().map(|c| c[1]).collect::<Vec<_>>(), [0.25, 0.0, 0.75, 0.0]);
    // A light without power is never chosen: the first end above x is that of a light with some.
    let chosen = |x: f32| dealt.iter().position(|c| c[0] > x).unwrap();
    assert_eq!([0.0, 0.2, 0.25, 0.999_999_9].map(chosen), [0, 0, 2, 2]);
    assert!(choices(&[0.0, 0.0]).is_empty() && choices(&[]).is_empty());
}
