use super::*;
use crate::{TraceBackend, shaders};

#[test]
fn the_uniforms_are_laid_out_as_the_shaders_read_them() {
    let variant = shaders::Variant::without_models(TraceBackend::Compute, true);
    let look_up = "import package::depth_map::map; @compute @workgroup_size(1) fn main() { _ = map.light; }";
    shaders::link("test", look_up, variant).unwrap().check_layout::<GpuMap>("Map").unwrap();
    shaders::link("cast", include_str!("cast.wesl"), variant).unwrap().check_layout::<caster::GpuFace>("Face").unwrap();
    shaders::link("look_up", include_str!("filtered.wesl"), variant).unwrap().check_layout::<filtered::GpuParams>("Params").unwrap();
    assert!(size_of::<GpuMap>() as u64 <= STRIDE && caster::FACE_BYTES <= FACE_STRIDE);
}

#[test]
fn the_sphere_around_a_part_of_the_view_holds_its_corners() {
    for (tangent, start, end) in [(0.3, 1.0, 4.0), (1.5, 1.0, 2.0), (0.05, 3.0, 100.0)] {
        let frustum = Frustum::looking_along_minus_z(tangent, 1.0, 200.0);
        let (middle, radius) = frustum.sphere([start, end]);
        let off = frustum.at(start).into_iter().chain(frustum.at(end)).map(|p| p.distance(frustum.on_axis(middle)));
        let furthest = off.fold(0.0, f32::max);
        assert!((furthest - radius).abs() < 1e-4 * radius, "{tangent}: {furthest} {radius}");
        assert!(radius <= 0.5001 * (end - start) + 1.5 * tangent * end, "{tangent}: {radius}");
    }
}
