//! Techniques of the role direct visibility against the path tracer's `visibility.<light>`.

use super::scenes::*;
use crate::{FrameSettings, RoleSelection};
use glam::{Affine2, Affine3A, Quat, UVec2, Vec3};
use kajo_path_tracer::Aov;
use kajo_render_graph::Device;
use kajo_scene::{
    AlphaMode, ColorSpace, Filter, LightShape, Material, Scene, Texels, Texture, TextureImage, TextureRef, Wrap, builtin, shapes,
};
use kajo_units::{Meters, Radians};

/// Objects over a floor under one light.
fn blocks(shape: LightShape, position: Vec3) -> Scene {
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(8.0, 8.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
    place(&mut scene, shapes::cuboid(Vec3::new(0.3, 0.5, 0.3)), lambert(0.5), Affine3A::from_translation(Vec3::new(-0.7, 0.5, 0.1)));
    let turned = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.6), Vec3::new(0.6, 0.9, -0.2));
    place(&mut scene, shapes::cuboid(Vec3::new(0.5, 0.05, 0.3)), lambert(0.5), turned);
    place(&mut scene, shapes::sphere(0.35, 48), lambert(0.5), Affine3A::from_translation(Vec3::new(0.2, 0.35, 0.9)));
    light(&mut scene, shape, 1.0, position, -position);
    camera(&mut scene, PERSPECTIVE, Vec3::new(1.0, 3.2, 4.2), Vec3::new(0.0, 0.3, 0.0));
    scene
}

/// Row SH-08: hard shadows by maps of 2048² agree with the reference away from borders.
#[test]
fn shadow_maps_agree_with_rays_off_the_border() {
    let device = Device::new().unwrap();
    let size = UVec2::new(192, 144);
    let spot = LightShape::Spot { inner: Radians(0.5), outer: Radians(0.75) };
    let lights = [
        ("spot", spot, Vec3::new(1.5, 4.0, 1.0)),
        ("directional", LightShape::Directional { half_angle: Radians(0.0) }, Vec3::new(2.0, 3.0, 1.0)),
        ("point", LightShape::Point, Vec3::new(-0.4, 2.2, 0.8)),
    ];
    for (name, shape, position) in lights {
        let scene = blocks(shape, position);
        let map = frame(&device, &scene, size, "shadow/map", &[("resolution", "2048"), ("kernel", "0")]);
        let reference = reference(&scene, START, None, size, 1, vec![Aov::Visibility("*".into()), Aov::InstanceId]);
        let rays = |x, y| reference.image("visibility.light 0").unwrap().pixels.get(x, y).x;
        let instance = |x, y| reference.image("instance-id").unwrap().pixels.get(x, y).x;
        let images = map.gbuffer.unwrap();
        let pixels: Vec<UVec2> = off_border(&rays, size)
            .into_iter()
            .filter(|p| images.instance.get(p.x, p.y).map(|id| id as f32) == Some(instance(p.x, p.y)))
            .filter(|p| {
                let to_point = (*images.position.get(p.x, p.y) - position).normalize();
                !matches!(shape, LightShape::Spot { .. }) || to_point.dot(-position.normalize()) > 0.75f32.cos()
            })
            .collect();
        let wrong: Vec<String> = pixels
            .iter()
            .filter(|p| (map.visibility[0].get(p.x, p.y) - rays(p.x, p.y)).abs() > 0.5)
            .map(|p| format!("{p}: {} instead of {} at {}", map.visibility[0].get(p.x, p.y), rays(p.x, p.y), images.position.get(p.x, p.y)))
            .collect();
        let share = 1.0 - wrong.len() as f32 / pixels.len() as f32;
        let shadowed = pixels.iter().filter(|p| rays(p.x, p.y) < 0.5).count();
        assert!(pixels.len() > 10_000 && shadowed > 500, "{name}: {} pixels, {shadowed} in shadow", pixels.len());
        assert!(share >= 0.995, "{name}: {share}, {} pixels\n{}", wrong.len(), wrong[..wrong.len().min(12)].join("\n"));
    }
}

/// Masks cast the shadow of what they cover at their own cutoff, and unlit surfaces block light: maps and rays alike.
#[test]
fn masks_and_unlit_surfaces_cast_shadows_as_in_the_path_tracer() {
    let device = Device::new().unwrap();
    let size = UVec2::new(96, 96);
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(4.0, 4.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
    // Alpha 90, 110 and 255 in a row: a cutoff of 0.4 lies between the first two, the usual 0.5 above both.
    let texels = [90u8, 110, 255].map(|alpha| [255, 255, 255, alpha]).to_vec();
    scene.images.push(TextureImage { name: String::new(), width: 3, height: 1, texels: Texels::Rgba8(texels) }.into());
    scene.textures.push(Texture { image: 0, wrap: [Wrap::Clamp; 2], filter: Filter::Nearest, color_space: ColorSpace::Srgb });
    let base = TextureRef { texture: 0, uv_set: 0, transform: Affine2::IDENTITY };
    let mask = Material { base_color_texture: Some(base), alpha_mode: AlphaMode::Mask(0.4), ..lambert(0.5) };
    let flat = |x: f32| Affine3A::from_rotation_translation(Quat::from_rotation_x(-0.5 * std::f32::consts::PI), Vec3::new(x, 0.8, 0.0));
    place(&mut scene, shapes::rectangle(0.9, 0.9), mask, flat(-0.7));
    place(&mut scene, shapes::rectangle(0.6, 0.6), Material { unlit: true, ..lambert(0.5) }, flat(0.7));
    light(&mut scene, LightShape::Point, 1.0, Vec3::new(0.0, 2.5, 0.3), Vec3::NEG_Y);
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.0, 1.2, 3.4), Vec3::new(0.0, 0.2, 0.0));
    let reference = reference(&scene, START, None, size, 1, vec![Aov::Visibility("*".into()), Aov::InstanceId]);
    let rays = |x, y| reference.image("visibility.light 0").unwrap().pixels.get(x, y).x;
    let on_floor = |p: &UVec2| reference.image("instance-id").unwrap().pixels.get(p.x, p.y).x == 0.0;
    let pixels: Vec<UVec2> = off_border(&rays, size).into_iter().filter(on_floor).collect();
    let shadowed = pixels.iter().filter(|p| rays(p.x, p.y) < 0.5).count();
    assert!(pixels.len() > 2000 && shadowed > 100, "{} pixels of floor, {shadowed} in shadow", pixels.len());
    for (technique, params) in [("shadow/map", vec![("kernel", "0")]), ("shadow/map", Vec::new()), ("shadow/ray-traced", Vec::new())] {
        let out = frame(&device, &scene, size, technique, &params);
        let wrong: Vec<_> = pixels.iter().filter(|p| (out.visibility[0].get(p.x, p.y) - rays(p.x, p.y)).abs() > 0.5).collect();
        assert!(
            wrong.len() * 200 <= pixels.len(),
            "{technique} {params:?}: {} of {} pixels, {shadowed} in shadow",
            wrong.len(),
            pixels.len()
        );
    }
}

fn lit_plane(shape: LightShape, degrees: f32) -> Scene {
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(2.0, 2.0, 1.0), lambert(0.7), Affine3A::from_quat(Quat::from_rotation_y(0.3)));
    let (sin, cos) = degrees.to_radians().sin_cos();
    let to_light = Vec3::new(0.8 * sin, cos, 0.6 * sin);
    light(&mut scene, shape, 1.0, to_light * 20.0, -to_light);
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.0, 1.6, 2.4), Vec3::ZERO);
    scene
}

/// Row SH-08: no plane shadows itself, up to 85°, with and without filtering.
#[test]
fn a_lit_plane_has_no_acne_up_to_85_degrees() {
    let device = Device::new().unwrap();
    let size = UVec2::new(96, 72);
    let acne = |shape, degrees, params: &[(&str, &str)]| {
        let out = frame(&device, &lit_plane(shape, degrees), size, "shadow/map", params);
        let images = out.gbuffer.unwrap();
        let on_plane = (0..images.instance.pixels().len()).filter(|&i| images.instance.pixels()[i].is_some());
        on_plane.filter(|&i| out.visibility[0].pixels()[i] < 1.0).count()
    };
    let spot = LightShape::Spot { inner: Radians(0.05), outer: Radians(0.2) };
    let sun = LightShape::Directional { half_angle: Radians(0.0) };
    for degrees in [0.0, 30.0, 60.0, 80.0, 85.0] {
        for (name, shape) in [("sun", sun), ("spot", spot), ("point", LightShape::Point)] {
            for kernel in ["0", "2"] {
                let count = acne(shape, degrees, &[("resolution", "1024"), ("kernel", kernel)]);
                assert_eq!(count, 0, "{name} at {degrees}°, kernel {kernel}");
            }
        }
    }
    let none = [("bias", "constant"), ("constant_bias", "0"), ("resolution", "1024"), ("kernel", "0")];
    assert!(acne(sun, 80.0, &none) > 50, "without bias the plane shadows itself, and the test sees it");
}

/// Row SH-17: the mean of many frames is the reference within its noise, for every kind of light, on both backends.
#[test]
fn ray_traced_visibility_is_unbiased() {
    let device = Device::new().unwrap();
    let size = UVec2::new(40, 30);
    let position = Vec3::new(1.5, 3.0, 1.0);
    let shapes = [
        LightShape::Point,
        LightShape::Spot { inner: Radians(0.5), outer: Radians(0.9) },
        LightShape::Directional { half_angle: Radians(0.06) },
        LightShape::Rectangle { width: Meters(1.0), height: Meters(0.6) },
        LightShape::Disk { radius: Meters(0.5) },
        LightShape::Sphere { radius: Meters(0.5) },
    ];
    let backends: Vec<_> = [kajo_techniques::TraceBackend::RayQuery, kajo_techniques::TraceBackend::Compute]
        .into_iter()
        .filter(|backend| *backend == kajo_techniques::TraceBackend::Compute || device.has_ray_query())
        .collect();
    let with_plates = |mut scene: Scene| {
        // One plate is found only by rays that go almost all the way to the light, one only by rays that go on behind it.
        for (seen_from, share) in [(Vec3::new(-1.5, 0.0, 1.5), 0.15), (Vec3::new(0.3, 0.0, 1.8), -0.3)] {
            let place_of_plate = position + share * (seen_from - position);
            place(&mut scene, shapes::cuboid(Vec3::new(0.1, 0.01, 0.1)), lambert(0.5), Affine3A::from_translation(place_of_plate));
        }
        scene
    };
    let emissive = |add: &dyn Fn(&mut Scene)| {
        let mut scene = super::emissive::table();
        add(&mut scene);
        scene
    };
    let analytic = shapes.into_iter().map(|shape| (format!("{shape:?}"), with_plates(blocks(shape, position))));
    let meshes = [
        ("half a plate".to_owned(), emissive(&super::emissive::half_plate)),
        ("ball".to_owned(), emissive(&|scene| super::emissive::ball(scene, 0.3, 32, false))),
        ("ball that shines inwards too".to_owned(), emissive(&|scene| super::emissive::ball(scene, 0.3, 32, true))),
    ];
    for (name, scene) in analytic.chain(meshes) {
        let (frames, spp) = (24u32, 256u32);
        let reference = reference(&scene, START, None, size, spp, vec![Aov::Visibility("*".into())]);
        let truth = &reference.images.iter().find(|image| image.name.starts_with("visibility.")).unwrap().pixels;
        for &backend in &backends {
            let mut renderer = renderer(&device, &scene, size, Some(backend));
            let roles = RoleSelection::new().choose("shadow/ray-traced", &[("samples", "2")]).unwrap();
            let mut sums = vec![[0.0f64; 2]; (size.x * size.y) as usize];
            for index in 0..frames {
                let out = renderer.render(&roles, &FrameSettings { index, ..Default::default() }).unwrap();
                for (sum, v) in sums.iter_mut().zip(out.visibility[0].pixels()) {
                    sum[0] += f64::from(*v);
                    sum[1] += f64::from(v * v);
                }
            }
            // Blocks of 5 × 5 pixels: z of the difference of means, with the variance of both sides bounded by V (1 − V).
            let n = f64::from(frames);
            let (mut beyond, mut blocks, mut total, mut total_variance) = (0, 0, 0.0, 0.0);
            for (bx, by) in (0..size.y / 5).flat_map(|y| (0..size.x / 5).map(move |x| (x * 5, y * 5))) {
                let (mut difference, mut variance) = (0.0, 1e-7);
                for (x, y) in (by..by + 5).flat_map(|y| (bx..bx + 5).map(move |x| (x, y))) {
                    let [sum, square] = sums[(y * size.x + x) as usize];
                    let v = f64::from(truth.get(x, y).x);
                    difference += sum / n - v;
                    variance += (square / n - (sum / n).powi(2)).max(0.0) / (n - 1.0) + v * (1.0 - v) / f64::from(spp);
                }
                blocks += 1;
                beyond += u32::from(difference.abs() > 3.0 * variance.sqrt() + 0.02 * 25.0);
                total += difference;
                total_variance += variance;
            }
            assert!(beyond <= blocks / 50, "{name} {}: {beyond} of {blocks} blocks beyond 3 σ", backend.id());
            let z = total / total_variance.sqrt().max(0.5);
            assert!(z.abs() <= 3.0, "{name} {}: z = {z}, difference {total}", backend.id());
        }
    }
}

/// More samples, less noise; and the technique says how many rays it traced.
#[test]
fn noise_falls_and_rays_are_counted() {
    let device = Device::new().unwrap();
    let size = UVec2::new(64, 36);
    let scene = builtin::load("penumbra").unwrap();
    let truth = frame(&device, &scene, size, "shadow/ray-traced", &[("samples", "1024")]);
    let error = |samples: &str| {
        let out = frame(&device, &scene, size, "shadow/ray-traced", &[("samples", samples)]);
        let pairs = out.visibility[0].pixels().iter().zip(truth.visibility[0].pixels());
        (pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f32>().sqrt(), out.rays)
    };
    let ((one, one_rays), (sixteen, sixteen_rays)) = (error("1"), error("16"));
    assert!(sixteen < 0.4 * one, "{one} -> {sixteen}");
    assert!(one_rays > 1000 && sixteen_rays > 14 * one_rays && sixteen_rays < 18 * one_rays, "{one_rays}, {sixteen_rays}");
}

/// What a technique keeps: its own textures and buffers and the image it fills, in every frame the same, and apart from other techniques.
#[test]
fn the_memory_of_a_technique_is_what_it_keeps() {
    let device = Device::new().unwrap();
    let size = UVec2::new(32, 18);
    let spot = LightShape::Spot { inner: Radians(0.5), outer: Radians(0.75) };
    let visibility = u64::from(size.x * size.y) * 4;
    // Uniforms and counters.
    let small = 16 << 10;
    for (shape, faces) in [(spot, 1), (LightShape::Point, 6)] {
        let scene = blocks(shape, Vec3::new(1.5, 4.0, 1.0));
        let mut renderer = renderer(&device, &scene, size, None);
        for (technique, resolution) in
            [("shadow/none", 0), ("shadow/map", 256), ("shadow/ray-traced", 0), ("shadow/map", 512), ("shadow/none", 0)]
        {
            let side = resolution.to_string();
            let params = if resolution > 0 { vec![("resolution", side.as_str())] } else { Vec::new() };
            let roles = RoleSelection::new().choose(technique, &params).unwrap();
            for index in 0..2 {
                let out = renderer.render(&roles, &FrameSettings { index, ..Default::default() }).unwrap();
                let (id, bytes) = out.technique_bytes[0];
                let images = visibility + faces * resolution * resolution * 4;
                assert_eq!(id, technique);
                assert!(bytes >= images && bytes < images + small, "{id} {resolution} px, frame {index}: {bytes} B, {images} B of images");
                let tone = out.technique_bytes.iter().find(|(id, _)| *id == "tone/agx").expect("every role's technique is listed").1;
                assert!((visibility..visibility + small).contains(&tone), "an 8-bit picture: {:?}", out.technique_bytes);
            }
        }
    }
}

/// Lights beyond one group are worked on in groups: the same picture.
#[test]
fn groups_of_lights_give_the_same_picture() {
    let device = Device::new().unwrap();
    let size = UVec2::new(32, 18);
    let scene = builtin::load("many-lights:20").unwrap();
    let snapshot = kajo_scene::Snapshot::new(&scene, START);
    let roles = RoleSelection::new();
    let render = |light_memory| {
        let settings = crate::RendererSettings { light_memory, ..crate::RendererSettings::new(size) };
        crate::Renderer::new(&device, &scene, &snapshot, settings).unwrap().render(&roles, &FrameSettings::default()).unwrap()
    };
    let (whole, parts) = (render(1 << 30), render(u64::from(size.x * size.y) * 4 * 3));
    assert_eq!(whole.visibility.len(), snapshot.lights.len());
    assert!(snapshot.lights.len() > 3 && whole.visibility == parts.visibility);
    let worst =
        whole.color.pixels().iter().zip(parts.color.pixels()).map(|(a, b)| (a.0 - b.0).abs().max_element() / (1.0 + a.max_component()));
    assert!(worst.fold(0.0, f32::max) < 1e-4);
    assert!(whole.direct.pixels().iter().any(|c| c.luminance() > 0.0));
}

/// Row SH-17: the filter lowers the error of few rays in penumbrae, by evening out noise and not by missing the shadow; its own error is told by a
/// comparison as that of every technique.
#[test]
fn the_denoised_variant_has_less_error_than_its_rays() {
    let device = Device::new().unwrap();
    let scene = builtin::load("penumbra").unwrap();
    let size = UVec2::new(160, 90);
    let visibility = |params: &[(&str, &str)]| frame(&device, &scene, size, "shadow/ray-traced", params).visibility.swap_remove(0);
    let truth = visibility(&[("samples", "1024")]);
    let rmse = |image: &kajo_image::Image<f32>| {
        let squares: f32 = image.pixels().iter().zip(truth.pixels()).map(|(a, b)| (a - b).powi(2)).sum();
        (squares / image.pixels().len() as f32).sqrt()
    };
    let raw = rmse(&visibility(&[("samples", "4")]));
    for (passes, share) in [("1", 0.8), ("3", 0.7)] {
        let filtered = rmse(&visibility(&[("samples", "4"), ("denoise", passes)]));
        assert!(filtered < share * raw, "{passes} passes: {filtered}, rays alone {raw}");
    }
    let mean = |image: &kajo_image::Image<f32>| image.pixels().iter().sum::<f32>() / image.pixels().len() as f32;
    let filtered = visibility(&[("samples", "4"), ("denoise", "3")]);
    assert!((mean(&filtered) - mean(&truth)).abs() < 0.004, "no light is lost: {} of {}", mean(&filtered), mean(&truth));
    // Lights without an extent have nothing to filter.
    let hard = builtin::load("shadows").unwrap();
    let [plain, same] = [&[][..], &[("denoise", "2")][..]].map(|params| frame(&device, &hard, size, "shadow/ray-traced", params));
    let kinds = &kajo_scene::Snapshot::new(&hard, START).lights;
    for (i, light) in kinds.iter().enumerate() {
        let extent = matches!(light.light.shape, LightShape::Rectangle { .. } | LightShape::Disk { .. } | LightShape::Sphere { .. });
        let soft_sun = matches!(light.light.shape, LightShape::Directional { half_angle } if half_angle.0 > 0.0);
        if !extent && !soft_sun {
            assert_eq!(plain.visibility[i].pixels(), same.visibility[i].pixels(), "light {i}");
        }
    }
}
