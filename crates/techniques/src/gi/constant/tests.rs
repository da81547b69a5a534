use super::*;
use crate::{TraceBackend, shaders};
use kajo_scene::{Light, LightShape, Node, Transform, shapes};
use kajo_units::{LinearRgb, Seconds};
use std::sync::Arc;

#[test]
fn the_uniform_is_laid_out_as_the_shader_reads_it() {
    let variant = shaders::Variant::without_models(TraceBackend::Compute, true);
    shaders::link(TECHNIQUE.id, include_str!("constant.wesl"), variant).unwrap().check_layout::<GpuParams>("Params").unwrap();
}

/// A cube of 2 m lit by a point: E = 4π I/24 m² · ρ/(1 − ρ).
#[test]
fn a_closed_room_gets_what_even_exchange_leaves() {
    let room = |albedo: f32, unlit: bool| {
        let base_color = LinearRgb::splat(albedo);
        let scene = Scene {
            materials: vec![Material { base_color, unlit, ..Material::default() }],
            meshes: vec![Arc::new(shapes::cuboid(Vec3::ONE).inside_out())],
            lights: vec![Light { name: String::new(), shape: LightShape::Point, emission: LinearRgb::splat(6.0) }],
            nodes: vec![
                Node { meshes: vec![0], ..Node::default() },
                Node { light: Some(0), transform: Transform::Matrix(glam::Mat4::IDENTITY), ..Node::default() },
            ],
            ..Scene::default()
        };
        even_exchange(&scene, &Snapshot::new(&scene, Seconds(0.0)), 3.0f32.sqrt()).x
    };
    let lit = |albedo: f32| room(albedo, false);
    assert!((lit(0.5) - PI).abs() < 1e-4, "{}", lit(0.5));
    assert!((lit(0.8) - 4.0 * PI).abs() < 1e-3 && lit(0.0) == 0.0, "{}", lit(0.8));
    assert_eq!(room(0.5, true), 0.0, "walls that reflect nothing");
}
