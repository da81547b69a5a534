use super::casters::GpuJob;
use super::extract::{GpuCounts, GpuExtraction};
use super::polygons::GpuCounting;
use super::receive::GpuReceiving;
use super::soften::GpuSoftening;
use crate::{TraceBackend, shaders};

#[test]
fn structs_are_laid_out_as_the_shaders_read_them() {
    let link = |name, source| {
        shaders::link_with_files(name, source, super::SHARED, shaders::Variant::without_models(TraceBackend::Compute, true)).unwrap()
    };
    let extract = link("shadow/volume/extract", include_str!("extract.wesl"));
    extract.check_layout::<GpuJob>("Job").unwrap();
    extract.check_layout::<GpuExtraction>("Extraction").unwrap();
    extract.check_layout::<GpuCounts>("Counts").unwrap();
    link("shadow/volume/count", include_str!("count.wesl")).check_layout::<GpuCounting>("Counting").unwrap();
    link("shadow/volume/soften", include_str!("soften.wesl")).check_layout::<GpuSoftening>("Softening").unwrap();
    link("shadow/volume/receive", include_str!("receive.wesl")).check_layout::<GpuReceiving>("Receiving").unwrap();
}
