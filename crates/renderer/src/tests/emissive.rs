//! Emissive meshes as lights: direct light and shadow maps against the path tracer.

use super::scenes::*;
use crate::{FrameSettings, Renderer, RendererSettings, RoleSelection};
use glam::{Affine3A, Quat, UVec2, Vec2, Vec3};
use kajo_image::Image;
use kajo_path_tracer::{Aov, Frame};
use kajo_render_graph::Device;
use kajo_scene::{ColorSpace, Filter, Material, Scene, Snapshot, Texels, Texture, TextureImage, TextureRef, shapes};
use kajo_units::LinearRgb;
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

const SIZE: UVec2 = UVec2::new(64, 48);
const LAMP: Vec3 = Vec3::new(0.3, 2.2, 0.4);

/// Blocks on a floor, without a light.
pub fn table() -> Scene {
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(8.0, 8.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
    place(&mut scene, shapes::cuboid(Vec3::new(0.3, 0.5, 0.3)), lambert(0.5), Affine3A::from_translation(Vec3::new(-0.7, 0.5, 0.1)));
    place(&mut scene, shapes::sphere(0.35, 48), lambert(0.5), Affine3A::from_translation(Vec3::new(0.9, 0.35, 0.9)));
    camera(&mut scene, PERSPECTIVE, Vec3::new(1.0, 3.2, 4.2), Vec3::new(0.0, 0.3, 0.0));
    scene
}

pub fn glowing(radiance: LinearRgb) -> Material {
    Material { emission: radiance, ..lambert(0.0) }
}

/// Adds a plate that shines down, its left half black.
pub fn half_plate(scene: &mut Scene) {
    scene.images.push(Arc::new(TextureImage {
        name: String::new(),
        width: 2,
        height: 1,
        texels: Texels::Rgba8(vec![[0, 0, 0, 255], [255, 255, 255, 255]]),
    }));
    scene.textures.push(Texture { image: 0, wrap: Default::default(), filter: Filter::Nearest, color_space: ColorSpace::Linear });
    let texture = TextureRef { texture: 0, uv_set: 0, transform: glam::Affine2::IDENTITY };
    let mut plate = shapes::rectangle(0.6, 0.8);
    // Two quads, so that each triangle is of one colour: visibility is weighed triangle by triangle.
    let right: Vec<Vec3> = plate.positions.iter().map(|p| *p + Vec3::X * 0.6).collect();
    let count = plate.positions.len();
    plate.positions.extend(right);
    plate.normals.extend(plate.normals.clone());
    plate.uvs[0] = [vec![Vec2::new(0.25, 0.5); count], vec![Vec2::new(0.75, 0.5); count]].concat();
    plate.indices.extend(plate.indices.iter().map(|t| t.map(|i| i + count as u32)).collect::<Vec<_>>());
    let material = Material { emission_texture: Some(texture), ..glowing(LinearRgb::new(6.0, 4.0, 2.0)) };
    place(scene, plate, material, Affine3A::from_rotation_translation(Quat::from_rotation_x(FRAC_PI_2), LAMP));
}

/// A closed lamp under a transform that mirrors and stretches it.
pub fn ball(scene: &mut Scene, radius: f32, segments: u32, double_sided: bool) {
    let stretched = Affine3A::from_scale_rotation_translation(Vec3::new(-1.0, 1.5, 0.8), Quat::from_rotation_z(0.4), LAMP);
    let material = Material { double_sided, ..glowing(LinearRgb::splat(5.0)) };
    place(scene, shapes::sphere(radius, segments), material, stretched);
}

fn lamps() -> [(&'static str, Scene); 4] {
    let with = |add: &dyn Fn(&mut Scene)| {
        let mut scene = table();
        add(&mut scene);
        scene
    };
    let down = Affine3A::from_rotation_translation(Quat::from_rotation_x(FRAC_PI_2), LAMP);
    [
        ("plate", with(&|scene| place(scene, shapes::rectangle(0.8, 0.5), glowing(LinearRgb::splat(6.0)), down))),
        ("half a plate", with(&half_plate)),
        ("ball", with(&|scene| ball(scene, 0.25, 96, false))),
        (
            "two lamps",
            with(&|scene| {
                ball(scene, 0.1, 24, false);
                let both = Material { double_sided: true, ..glowing(LinearRgb::new(2.0, 3.0, 4.0)) };
                let upright = Affine3A::from_translation(Vec3::new(-1.6, 0.8, -1.0));
                place(scene, shapes::rectangle(0.7, 0.9), both, upright);
            }),
        ),
    ]
}

/// Side of the blocks that noise is averaged over, px.
const BLOCK: u32 = 4;

/// Mean ratio less 1, and mean |difference| of blocks over the mean, of direct light and its reference.
fn disagreement(direct: &Image<LinearRgb>, reference: &dyn Fn(u32, u32) -> Vec3) -> [f32; 2] {
    let (mut ours, mut theirs, mut difference) = (0.0, 0.0, 0.0);
    for (bx, by) in (0..SIZE.y / BLOCK).flat_map(|y| (0..SIZE.x / BLOCK).map(move |x| (x * BLOCK, y * BLOCK))) {
        let block =
            |value: &dyn Fn(u32, u32) -> Vec3| (0..BLOCK * BLOCK).map(|i| value(bx + i % BLOCK, by + i / BLOCK).element_sum()).sum::<f32>();
        let (a, b) = (block(&|x, y| direct.get(x, y).0), block(reference));
        ours += a;
        theirs += b;
        difference += (a - b).abs();
    }
    [(ours / theirs - 1.0).abs(), difference / theirs]
}

/// Bars of [`disagreement`], those of the analytic area lights in single pixels.
const BARS: [f32; 2] = [0.02, 0.08];

fn agrees(disagreement: [f32; 2]) -> bool {
    disagreement[0] < BARS[0] && disagreement[1] < BARS[1]
}

fn direct_of(frame: &Frame, lights: &[String]) -> impl Fn(u32, u32) -> Vec3 {
    let images: Vec<_> = lights.iter().map(|light| frame.image(&format!("direct.{light}")).unwrap().pixels.clone()).collect();
    move |x, y| images.iter().map(|image| image.get(x, y)).sum()
}

/// Plates, textured plates, closed lamps under uneven mirrored transforms, lamps that shine on both sides: each lights as in the path
/// tracer, and has its name.
#[test]
fn emissive_meshes_light_as_in_the_path_tracer() {
    let device = Device::new().unwrap();
    for (name, scene) in lamps() {
        let settings = RendererSettings { light_samples: 64, ..RendererSettings::new(SIZE) };
        let mut renderer = Renderer::new(&device, &scene, &Snapshot::new(&scene, START), settings).unwrap();
        let roles = RoleSelection::new().choose("shadow/ray-traced", &[("samples", "64")]).unwrap();
        let direct = renderer.render(&roles, &FrameSettings::default()).unwrap().direct;
        let lights = renderer.light_names().to_vec();
        let tracer = kajo_path_tracer::Tracer::new(&scene, Snapshot::new(&scene, START)).unwrap();
        assert_eq!(lights, tracer.visibility_light_names().collect::<Vec<_>>(), "{name}");
        let reference = reference(&scene, START, None, SIZE, 64, vec![Aov::DirectLight("*".into())]);
        let truth = direct_of(&reference, &lights);
        let error = disagreement(&direct, &truth);
        assert!(agrees(error), "{name}: {error:?}");
        let brighter = direct.map(|p| *p * 1.05);
        assert!(!agrees(disagreement(&brighter, &truth)), "{name}: 5 % too bright is noticed");
        let unshadowed = frame(&device, &scene, SIZE, "shadow/none", &[]).direct;
        assert!(!agrees(disagreement(&unshadowed, &truth)), "{name}: missing shadows are noticed");
    }
}

/// A small lamp's map is that of a point in its middle, though the lamp stands around it; two-sided closed lamps show half of themselves.
#[test]
fn shadow_maps_leave_the_lamp_out_of_its_own_occluders() {
    let device = Device::new().unwrap();
    let mut scene = table();
    ball(&mut scene, 0.03, 24, false);
    let map = frame(&device, &scene, SIZE, "shadow/map", &[("resolution", "1024"), ("kernel", "0")]);
    let reference = reference(&scene, START, None, SIZE, 64, vec![Aov::Visibility("*".into())]);
    let rays = |x, y| reference.image("visibility.sphere").unwrap().pixels.get(x, y).x;
    let pixels: Vec<UVec2> = off_border(&rays, SIZE).into_iter().filter(|p| !(0.2..0.8).contains(&rays(p.x, p.y))).collect();
    let wrong = |image: &Image<f32>| pixels.iter().filter(|p| (image.get(p.x, p.y) - rays(p.x, p.y)).abs() > 0.5).count();
    let shadowed = pixels.iter().filter(|p| rays(p.x, p.y) < 0.5).count();
    assert!(pixels.len() > 1500 && shadowed > 50, "{} pixels, {shadowed} in shadow", pixels.len());
    assert!(wrong(&map.visibility[0]) <= pixels.len() / 100, "{} of {}", wrong(&map.visibility[0]), pixels.len());
    let dark = map.visibility[0].map(|_| 0.0);
    assert!(wrong(&dark) > pixels.len() / 2, "a lamp that blocked itself would be noticed");

    let mut both = table();
    ball(&mut both, 0.03, 24, true);
    let map = frame(&device, &both, SIZE, "shadow/map", &[("resolution", "1024"), ("kernel", "0")]);
    // The floor: neither the lamp itself nor the sky.
    let on_floor = |p: &&UVec2| rays(p.x, p.y) > 0.5 && *map.gbuffer.as_ref().unwrap().instance.get(p.x, p.y) == Some(0);
    let lit: Vec<f32> = pixels.iter().filter(on_floor).map(|p| *map.visibility[0].get(p.x, p.y)).collect();
    let share = lit.iter().sum::<f32>() / lit.len() as f32;
    assert!((share - 0.5).abs() < 0.05, "{share}");
}

/// Only what is asked for is read back, in the order of the lights.
#[test]
fn watched_lights_are_read_back_alone() {
    let device = Device::new().unwrap();
    let [.., (_, scene)] = lamps();
    let mut renderer = renderer(&device, &scene, SIZE, None);
    let mut images = |watch: Option<&[usize]>| {
        watch.iter().for_each(|lights| renderer.watch(lights));
        renderer.render(&RoleSelection::new(), &FrameSettings::default()).unwrap().visibility
    };
    let all = images(None);
    assert_eq!(all.len(), 2);
    assert!(images(Some(&[1])) == all[1..] && images(Some(&[1, 0])) == all && images(Some(&[])).is_empty());
}

/// A lamp that moves is uploaded anew: the light moves with it.
#[test]
fn a_lamp_that_moves_takes_its_light_along() {
    let device = Device::new().unwrap();
    let scene_at = |x: f32| {
        let mut scene = table();
        let down = Affine3A::from_rotation_translation(Quat::from_rotation_x(FRAC_PI_2), LAMP + Vec3::X * x);
        place(&mut scene, shapes::rectangle(0.8, 0.5), glowing(LinearRgb::splat(6.0)), down);
        scene
    };
    let (from, to) = (scene_at(0.0), scene_at(-1.5));
    let roles = RoleSelection::new();
    let mut moved = renderer(&device, &from, SIZE, None);
    let before = moved.render(&roles, &FrameSettings::default()).unwrap().direct;
    let (now, then) = (Snapshot::new(&to, START), Snapshot::new(&from, START));
    moved.set_snapshot(&now, &then).unwrap();
    let after = moved.render(&roles, &FrameSettings::default()).unwrap().direct;
    let fresh = renderer(&device, &to, SIZE, None).render(&roles, &FrameSettings::default()).unwrap().direct;
    assert!(after == fresh && after != before);
}
