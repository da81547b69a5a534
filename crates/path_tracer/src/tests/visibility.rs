//! Shadows and ambient occlusion against geometry.

use super::scenes::{Stage, at, downwards, floor, glowing, lambert, looking, mean, render_at, sized};
use crate::{Aov, Filter, Frame, Integrator, Settings};
use glam::{Quat, UVec2, Vec3};
use kajo_scene::{LightShape, Material, Mesh, Scene, Transform, shapes};
use kajo_units::{Meters, Radians};
use std::f32::consts::{FRAC_PI_2, PI};

fn visibility(scene: &Scene, size: UVec2, spp: u32) -> Frame {
    let aovs = vec![Aov::Visibility("*".into()), Aov::Coverage];
    render_at(scene, &Settings { aovs, filter: Filter::Center, max_depth: 1, ..sized(size.x, size.y) }, spp)
}

const LIGHT: &str = "visibility.light 0";

/// A half plane with its edge over the z axis at `height`, over a floor that a parallel camera below the half plane sees as a strip along x.
fn edge(height: f32) -> Stage {
    let mut half_plane = shapes::rectangle(20.0, 20.0).moved(Quat::from_rotation_x(-FRAC_PI_2), Vec3::ZERO);
    half_plane.positions.iter_mut().for_each(|p| p.x -= 10.0);
    Stage::default().mesh(floor(), lambert(0.5), at(Vec3::ZERO)).mesh(half_plane, lambert(0.0), at(Vec3::Y * height)).orthographic(
        Vec3::new(0.0, 0.5 * height, 0.0),
        Vec3::ZERO,
        4.0 / 128.0,
    )
}

/// Row L-13: the penumbra of a strip light of width W at height H behind an edge at height h is W h / (H − h) wide; point and parallel
/// light have none.
#[test]
fn penumbra_is_as_wide_as_similar_triangles_say() {
    let (width, light_height) = (0.5f32, 3.0f32);
    let strip = LightShape::Rectangle { width: Meters(width), height: Meters(6.0) };
    let size = UVec2::new(128 * 4, 1);
    for height in [0.5f32, 1.0, 1.5] {
        let penumbra = |shape| {
            let scene = edge(height).light(shape, 1.0, downwards(Vec3::Y * light_height)).0;
            let frame = visibility(&scene, size, 256);
            let image = frame.image(LIGHT).unwrap();
            let partial = (0..size.x).filter(|&x| (0.002..0.998).contains(&image.pixels.get(x, 0).x)).count();
            assert!(image.pixels.get(0, 0).x != image.pixels.get(size.x - 1, 0).x, "one end is lit, the other is not");
            partial as f32
        };
        let pixel = 4.0 / 128.0;
        let expected = width * height / (light_height - height) / pixel;
        let got = penumbra(strip);
        assert!((got - expected).abs() <= 1.0, "edge at {height}: {got} px instead of {expected}");
        assert_eq!(penumbra(LightShape::Point), 0.0);
        assert_eq!(penumbra(LightShape::Directional { half_angle: Radians(0.0) }), 0.0);
    }
}

/// Row T-07: the shadow of a sphere on a plane, by a point light and by the sun, has its border where cone and cylinder meet the plane.
#[test]
fn shadow_of_a_sphere_has_its_analytic_border() {
    let (center, radius, light) = (Vec3::new(0.2, 1.0, -0.1), 0.4f32, Vec3::new(-0.5, 3.0, 0.4));
    let size = UVec2::new(96, 96);
    let stage = || {
        Stage::default()
            .mesh(floor(), lambert(0.5), at(Vec3::ZERO))
            .mesh(shapes::sphere(radius, 256), lambert(0.5), at(center))
            .orthographic(Vec3::new(0.0, 0.3, 0.0), Vec3::ZERO, 3.0)
    };
    let sun = Vec3::new(0.4, -1.0, 0.2).normalize();
    let parallel = LightShape::Directional { half_angle: Radians(0.0) };
    for (shape, transform) in [(LightShape::Point, at(light)), (parallel, looking(Vec3::ZERO, sun))] {
        let scene = stage().light(shape, 1.0, transform).0;
        let aovs = vec![Aov::Visibility("*".into()), Aov::Position];
        let frame = render_at(&scene, &Settings { aovs, filter: Filter::Center, max_depth: 1, ..sized(size.x, size.y) }, 1);
        let (mut wrong, mut shadowed) = (0, 0);
        for y in 0..size.y {
            for x in 0..size.x {
                let position = frame.image("position").unwrap().pixels.get(x, y);
                let towards = if shape == parallel { -sun } else { (light - position).normalize() };
                let along = (center - position).dot(towards);
                let distance = ((center - position) - along * towards).length();
                let blocked = distance < radius;
                shadowed += u32::from(blocked);
                // A pixel is 3 / 96 m; the border may be one pixel off.
                let on_border = (distance - radius).abs() < 3.0 / 96.0;
                let visible = frame.image(LIGHT).unwrap().pixels.get(x, y).x;
                wrong += u32::from(!on_border && visible != f32::from(u8::from(!blocked)));
            }
        }
        assert_eq!(wrong, 0, "{shape:?}");
        assert!(shadowed > 300, "{shape:?}: the shadow is in the picture");
    }
}

/// SH-01, shadows: behind a blocker every light is invisible, beside it visible; without a hit visibility is 1 and coverage 0.
#[test]
fn visibility_is_geometric_and_one_without_a_hit() {
    let shapes_of_light = [
        LightShape::Point,
        LightShape::Spot { inner: Radians(0.1), outer: Radians(0.2) },
        LightShape::Directional { half_angle: Radians(0.0) },
        LightShape::Directional { half_angle: Radians(0.05) },
        LightShape::Rectangle { width: Meters(0.2), height: Meters(0.2) },
        LightShape::Disk { radius: Meters(0.1) },
        LightShape::Sphere { radius: Meters(0.1) },
    ];
    for shape in shapes_of_light {
        let mut ground = shapes::rectangle(2.0, 2.0).moved(Quat::from_rotation_x(-FRAC_PI_2), Vec3::ZERO);
        ground.positions.iter_mut().for_each(|p| p.x += 0.5);
        let mut roof = shapes::rectangle(1.0, 6.0).moved(Quat::from_rotation_x(-FRAC_PI_2), Vec3::ZERO);
        roof.positions.iter_mut().for_each(|p| p.x -= 0.5);
        let scene = Stage::default()
            .mesh(ground, lambert(0.5), at(Vec3::ZERO))
            .mesh(roof, lambert(0.5), at(Vec3::Y * 2.0))
            .light(shape, 1.0, downwards(Vec3::new(0.0, 40.0, 0.0)))
            .orthographic(Vec3::Y, Vec3::ZERO, 2.0)
            .0;
        let frame = visibility(&scene, UVec2::new(32, 16), 16);
        let at = |name: &str, x| frame.image(name).unwrap().pixels.get(x, 8).x;
        // 8 px a metre: x = −1.9 m sees nothing, −0.3 m lies under the roof, +0.3 m does not.
        assert_eq!((at(LIGHT, 1), at("coverage", 1)), (1.0, 0.0), "{shape:?}: without a hit");
        assert_eq!((at(LIGHT, 13), at("coverage", 13)), (0.0, 1.0), "{shape:?}: under the roof");
        assert_eq!((at(LIGHT, 18), at("coverage", 18)), (1.0, 1.0), "{shape:?}: in the open");
    }
}

const MESH: &str = "visibility.rectangle";

/// Turned so that a rectangle, which faces +z, faces down.
fn facing_down(translation: Vec3) -> Transform {
    Transform::Trs { translation, rotation: Quat::from_rotation_x(FRAC_PI_2), scale: Vec3::ONE }
}

/// The penumbra of a glowing rectangle is that of the analytic light in its place.
#[test]
fn visibility_of_a_glowing_rectangle_is_that_of_the_analytic_one() {
    let (size, place) = (UVec2::new(128, 1), Vec3::Y * 3.0);
    let light = LightShape::Rectangle { width: Meters(0.5), height: Meters(0.7) };
    let mesh = edge(1.0).mesh(shapes::rectangle(0.5, 0.7), glowing(1.0, 0.0), facing_down(place)).0;
    let analytic = edge(1.0).light(light, 1.0, downwards(place)).0;
    let (a, b) = (visibility(&mesh, size, 1024), visibility(&analytic, size, 1024));
    let at = |frame: &Frame, name: &str, x| frame.image(name).unwrap().pixels.get(x, 0).x;
    let worst = (0..size.x).map(|x| (at(&a, MESH, x) - at(&b, LIGHT, x)).abs()).fold(0.0, f32::max);
    assert!(worst < 5.0 * 0.5 / 1024f32.sqrt(), "{worst}");
    let shifted = (1..size.x).map(|x| (at(&a, MESH, x) - at(&b, LIGHT, x - 1)).abs()).fold(0.0, f32::max);
    assert!(shifted > 1.3 * worst && shifted > 0.05, "one pixel off is noticed: {shifted} against {worst}");
}

/// Only what faces a point counts: a closed lamp is seen wholly, its far side is no shadow; from behind a lamp that shines on one side
/// there is nothing to block; a lamp that shines on both is seen from there too. Half of it behind a wall is half.
#[test]
fn visibility_of_an_emissive_mesh_is_over_the_part_that_faces_the_point() {
    let ball = || shapes::sphere(0.3, 128);
    let both = Material { double_sided: true, ..glowing(1.0, 0.0) };
    let up = || looking(Vec3::Y * 2.0, Vec3::ZERO);
    let seen = |mesh: Mesh, material: Material, transform, wall: bool| {
        let stage = Stage::default().mesh(floor(), lambert(0.5), at(Vec3::ZERO)).mesh(mesh, material, transform);
        let mut roof = shapes::rectangle(20.0, 20.0).moved(Quat::from_rotation_x(-FRAC_PI_2), Vec3::ZERO);
        roof.positions.iter_mut().for_each(|p| p.x -= 10.0);
        let stage = if wall { stage.mesh(roof, lambert(0.5), at(Vec3::Y)) } else { stage };
        let frame = visibility(&stage.orthographic(Vec3::Y * 0.5, Vec3::ZERO, 1e-3).0, UVec2::new(4, 4), 256);
        let name = frame.images.iter().map(|image| image.name.clone()).find(|name| name.starts_with("visibility.")).unwrap();
        let image = &frame.image(&name).unwrap().pixels;
        (0..16).map(|i| image.get(i % 4, i / 4).x).sum::<f32>() / 16.0
    };
    let rectangle = || shapes::rectangle(1.0, 0.6);
    assert_eq!(seen(ball(), glowing(1.0, 0.0), at(Vec3::Y * 2.0), false), 1.0);
    let half = seen(ball(), glowing(1.0, 0.0), at(Vec3::Y * 2.0), true);
    assert!((half - 0.5).abs() < 0.02, "{half}");
    for wall in [false, true] {
        assert_eq!(seen(rectangle(), glowing(1.0, 0.0), up(), wall), 1.0, "from behind there is no shadow");
    }
    let half = seen(rectangle(), both.clone(), up(), true);
    assert!((half - 0.5).abs() < 0.02, "{half}");
    // A ball that shines inwards too hides all but the cap that the point sees, (1 − r/d) / 2 of it.
    let closed = seen(ball(), both, at(Vec3::Y * 2.0), false);
    assert!((closed - 0.5 * (1.0 - 0.3 / 2.0)).abs() < 0.02, "{closed}");
}

/// Weighed with what each part emits: black triangles behind the wall do not count.
#[test]
fn dark_parts_of_an_emissive_mesh_do_not_count() {
    use kajo_scene::{ColorSpace, Filter as Texels, Texture, TextureImage, TextureRef};
    let mut left = shapes::rectangle(1.0, 0.6);
    left.positions.iter_mut().for_each(|p| p.x -= 0.5);
    let first = left.positions.len() as u32;
    left.uvs[0] = vec![glam::Vec2::new(0.25, 0.5); left.positions.len()];
    let right = left.positions.iter().map(|p| *p + Vec3::X).collect::<Vec<_>>();
    left.positions.extend(right);
    left.normals.extend(left.normals.clone());
    left.uvs[0].extend(vec![glam::Vec2::new(0.75, 0.5); first as usize]);
    left.indices.extend(left.indices.iter().map(|t| t.map(|i| i + first)).collect::<Vec<_>>());
    let seen = |dark: usize| {
        let texture = TextureRef { texture: 0, uv_set: 0, transform: glam::Affine2::IDENTITY };
        let material = Material { emission_texture: Some(texture), ..glowing(1.0, 0.0) };
        let mut roof = shapes::rectangle(20.0, 20.0).moved(Quat::from_rotation_x(-FRAC_PI_2), Vec3::ZERO);
        roof.positions.iter_mut().for_each(|p| p.x -= 10.0);
        let mut scene = Stage::default()
            .mesh(floor(), lambert(0.5), at(Vec3::ZERO))
            .mesh(left.clone(), material, facing_down(Vec3::Y * 2.0))
            .mesh(roof, lambert(0.5), at(Vec3::Y))
            .orthographic(Vec3::Y * 0.5, Vec3::ZERO, 1e-3)
            .0;
        let mut texels = vec![[255u8; 4]; 2];
        texels[dark] = [0, 0, 0, 255];
        let texels = kajo_scene::Texels::Rgba8(texels);
        scene.images.push(std::sync::Arc::new(TextureImage { name: String::new(), width: 2, height: 1, texels }));
        scene.textures.push(Texture { image: 0, wrap: Default::default(), filter: Texels::Nearest, color_space: ColorSpace::Linear });
        visibility(&scene, UVec2::new(2, 2), 64).image(MESH).unwrap().pixels.get(1, 1).x
    };
    // The wall hides x < 0, where the texture is dark or not.
    assert_eq!((seen(0), seen(1)), (1.0, 0.0));
}

/// Row L-14: the open plane, and a wall at distance d with a longest ray r, a = d / r.
#[test]
fn ambient_occlusion_of_a_wall_is_the_closed_form() {
    let distance = 0.5f32;
    let scene = |wall: bool| {
        let stage = Stage::default().mesh(floor(), lambert(0.5), at(Vec3::ZERO)).orthographic(Vec3::Y * 0.1, Vec3::ZERO, 1e-3);
        let wall_mesh = shapes::rectangle(100.0, 100.0).moved(Quat::from_rotation_y(-FRAC_PI_2), Vec3::ZERO);
        if wall { stage.mesh(wall_mesh, lambert(0.5), at(Vec3::X * distance)).0 } else { stage.0 }
    };
    let measured = |wall, integrator, reach| {
        mean(&render_at(&scene(wall), &Settings { integrator, ambient_distance: reach, ..sized(4, 4) }, 8192)) as f32
    };
    assert_eq!(measured(false, Integrator::Ao, f32::INFINITY), 1.0);
    assert_eq!(measured(false, Integrator::AoUniform, 1.0), 1.0);
    for (a, uniform, cosine) in [(0.5f32, 0.750, 0.8045), (0.25, 0.625, 0.6575)] {
        let exact = (1.0 - 0.5 * (1.0 - a), 1.0 - (a.acos() - a * (1.0 - a * a).sqrt()) / PI);
        assert!((exact.0 - uniform).abs() < 1e-4 && (exact.1 - cosine).abs() < 1e-4, "the formula gives the table's numbers");
        for (integrator, expected) in [(Integrator::AoUniform, uniform), (Integrator::Ao, cosine)] {
            let got = measured(true, integrator, distance / a);
            assert!((got - expected).abs() < 0.005, "{integrator:?}, a = {a}: {got}");
        }
    }
}

/// `ambient-visibility` is the same integral, and the bent normal leans away from the wall.
#[test]
fn bent_normals_lean_towards_the_open_side() {
    let wall: Mesh = shapes::rectangle(100.0, 100.0).moved(Quat::from_rotation_y(-FRAC_PI_2), Vec3::ZERO);
    let scene = Stage::default()
        .mesh(floor(), lambert(0.5), at(Vec3::ZERO))
        .mesh(wall, lambert(0.5), at(Vec3::X * 0.5))
        .orthographic(Vec3::Y * 0.1, Vec3::ZERO, 1e-3)
        .0;
    let aovs = vec![Aov::AmbientVisibility, Aov::BentNormal];
    let frame = render_at(&scene, &Settings { aovs, ambient_distance: 1.0, ..sized(2, 2) }, 4096);
    let open = frame.image("ambient-visibility").unwrap();
    assert!((open.pixels.get(0, 0).x - 0.8045).abs() < 0.01);
    let variance = open.variance.as_ref().unwrap().get(0, 0).x;
    assert!(variance > 0.0 && variance < 0.8045 * 0.1955 / 4096.0 * 2.0, "{variance}");
    let bent = frame.image("bent-normal").unwrap().pixels.get(0, 0);
    assert!(bent.x < -0.05 && bent.y > 0.4 && bent.z.abs() < 0.02, "{bent}");
}
