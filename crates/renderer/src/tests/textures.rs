//! Textures from a list and from a buffer of texels: one picture.

use super::scenes::*;
use crate::{FrameOutput, FrameSettings, Renderer, RendererSettings, RoleSelection};
use glam::{Affine2, Affine3A, Quat, UVec2, Vec2, Vec3};
use kajo_image::Image;
use kajo_render_graph::Device;
use kajo_scene::{
    AlphaMode, ColorSpace, Filter, LightShape, Material, Scene, Snapshot, Texels, Texture, TextureImage, TextureRef, Wrap, shapes,
};
use kajo_units::LinearRgb;

fn render(device: &Device, scene: &Scene, size: UVec2, bindless: bool) -> FrameOutput {
    let settings = RendererSettings { bindless, ..RendererSettings::new(size) };
    let mut renderer = Renderer::new(device, scene, &Snapshot::new(scene, START), settings).unwrap();
    assert_eq!(renderer.texture_count() > 0, bindless && device.has_bindless_textures());
    renderer.render(&RoleSelection::new(), &FrameSettings { gbuffer: true, ..Default::default() }).unwrap()
}

/// A texture of the scene: noise of an odd size in one of three precisions.
fn texture(scene: &mut Scene, kind: usize, wrap: [Wrap; 2], filter: Filter, size: UVec2) -> TextureRef {
    let channel = |x: u32, y: u32, c: u32| ((x * 7 + y * 13 + c * 5 + x * y * 3) * 2_654_435_761u32.wrapping_mul(1 + c)) >> 24;
    let texel = |i: u32| -> [u32; 4] { std::array::from_fn(|c| channel(i % size.x, i / size.x, c as u32) & 255) };
    let all = || (0..size.element_product()).map(texel);
    let (texels, color_space) = match kind {
        0 => (Texels::Rgba8(all().map(|t| t.map(|c| c as u8)).collect()), ColorSpace::Srgb),
        1 => (Texels::Rgba8(all().map(|t| t.map(|c| c as u8)).collect()), ColorSpace::Linear),
        2 => (Texels::Rgba16(all().map(|t| t.map(|c| c as u16 * 257)).collect()), ColorSpace::Srgb),
        _ => (Texels::Rgba32F(all().map(|t| t.map(|c| c as f32 / 255.0)).collect()), ColorSpace::Linear),
    };
    scene.images.push(TextureImage { name: String::new(), width: size.x, height: size.y, texels }.into());
    scene.textures.push(Texture { image: scene.images.len() - 1, wrap, filter, color_space });
    TextureRef { texture: scene.textures.len() - 1, uv_set: 0, transform: Affine2::IDENTITY }
}

/// A board of 36 tiles seen from the front, one for each precision, filter and pair of wraps, with texture coordinates from −1 to 2; texels are
/// larger than pixels. A third of the tiles cut holes.
fn board() -> Scene {
    let mut scene = Scene::default();
    let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
    for tile in 0..36usize {
        let filter = if tile % 2 == 0 { Filter::Nearest } else { Filter::Linear };
        let wrap = [wraps[tile / 2 % 3], wraps[tile / 6 % 3]];
        let base = texture(&mut scene, (tile / 9 + tile) % 4, wrap, filter, UVec2::new(3, 5));
        let transform = Affine2::from_scale_angle_translation(Vec2::new(2.7, 3.1), 0.2, Vec2::new(-1.03, -0.97));
        let alpha_mode = if tile % 3 == 0 { AlphaMode::Mask(0.3) } else { AlphaMode::Opaque };
        let material = Material { base_color_texture: Some(TextureRef { transform, ..base }), alpha_mode, ..lambert(1.0) };
        let at = Vec3::new((tile % 6) as f32 - 2.5, (tile / 6) as f32 - 2.5, 0.0);
        place(&mut scene, shapes::rectangle(0.9, 0.9), material, Affine3A::from_translation(at));
    }
    light(&mut scene, LightShape::Point, 60.0, Vec3::new(1.0, 2.0, 4.0), Vec3::NEG_Z);
    camera(&mut scene, PERSPECTIVE, Vec3::Z * 8.6, Vec3::ZERO);
    scene
}

/// Share of pixels whose colours differ by more than `tolerance`, and the mean difference.
fn difference(a: &Image<LinearRgb>, b: &Image<LinearRgb>, tolerance: f32) -> (f32, f32) {
    let each: Vec<f32> = a.pixels().iter().zip(b.pixels()).map(|(a, b)| (a.0 - b.0).abs().max_element()).collect();
    let count = each.len() as f32;
    (each.iter().filter(|d| **d > tolerance).count() as f32 / count, each.iter().sum::<f32>() / count)
}

/// Every precision, filter and wrap, holes included; the sampler of the device may round the place between texels to 1/256.
#[test]
fn a_buffer_of_texels_looks_like_a_list_of_textures() {
    let device = Device::new().unwrap();
    let size = UVec2::new(192, 192);
    let [list, buffer] = [true, false].map(|bindless| render(&device, &board(), size, bindless));
    let (list, buffer) = (list.gbuffer.unwrap(), buffer.gbuffer.unwrap());
    let holes = list.instance.pixels().iter().zip(buffer.instance.pixels()).filter(|(a, b)| a != b).count();
    let covered = list.instance.pixels().iter().filter(|id| id.is_some()).count();
    assert!(covered > 15_000 && holes <= covered / 200, "{holes} of {covered} pixels");
    let (share, mean) = difference(&list.albedo, &buffer.albedo, 0.02);
    assert!(share < 0.01 && mean < 0.003, "{share} of the pixels differ, by {mean} in the mean");
    let mut shifted = buffer.albedo.clone();
    shifted.pixels_mut().rotate_right(1);
    assert!(difference(&list.albedo, &shifted, 0.02).0 > 0.1, "one pixel off is noticed");
}

/// Levels: a floor that runs to the horizon fades to the mean of its texture, and on the way nowhere differs in the mean of a row.
#[test]
fn a_buffer_of_texels_has_the_levels_of_a_texture() {
    let device = Device::new().unwrap();
    let size = UVec2::new(96, 64);
    for kind in [0, 3] {
        let mut scene = Scene::default();
        let base = texture(&mut scene, kind, [Wrap::Repeat; 2], Filter::Linear, UVec2::new(64, 32));
        let material = Material { base_color_texture: Some(base), ..lambert(1.0) };
        place(&mut scene, shapes::floor(400.0, 400.0, 400.0), material, Affine3A::from_quat(Quat::from_rotation_y(0.3)));
        camera(&mut scene, PERSPECTIVE, Vec3::Y, Vec3::new(0.0, 0.0, -2.0));
        let [list, buffer] = [true, false].map(|bindless| render(&device, &scene, size, bindless).gbuffer.unwrap());
        let row = |image: &Image<LinearRgb>, y: u32| -> Vec3 { (0..size.x).map(|x| image.get(x, y).0).sum::<Vec3>() / size.x as f32 };
        let spread = |image: &Image<LinearRgb>, y: u32| {
            let mean = row(image, y);
            ((0..size.x).map(|x| (image.get(x, y).0 - mean).length_squared()).sum::<f32>() / size.x as f32).sqrt()
        };
        let rows: Vec<u32> = (0..size.y).filter(|&y| (0..size.x).all(|x| list.instance.get(x, y).is_some())).collect();
        assert!(rows.len() > 40, "{} rows of floor", rows.len());
        for &y in &rows {
            let [a, b] = [&list.albedo, &buffer.albedo].map(|image| (row(image, y), spread(image, y)));
            assert!((a.0 - b.0).abs().max_element() < 0.03, "kind {kind}, row {y}: mean {} and {}", a.0, b.0);
            // Drivers round the level, so contrast is compared coarsely.
            assert!((a.1 - b.1).abs() < 0.08, "kind {kind}, row {y}: contrast {} and {}", a.1, b.1);
        }
        let [near, far] = [rows.last().unwrap(), &rows[2]].map(|&y| spread(&buffer.albedo, y));
        assert!(far < 0.3 * near, "kind {kind}: contrast {near} near, {far} far");
    }
}

/// A scene without a texture, and a real one with many.
#[test]
fn scenes_look_the_same_from_a_buffer_of_texels() {
    let device = Device::new().unwrap();
    let size = UVec2::new(80, 80);
    let plain = kajo_scene::builtin::load("cornell").unwrap();
    for scene in [Some(plain), asset("FlightHelmet/FlightHelmet.gltf")].into_iter().flatten() {
        let [list, buffer] = [true, false].map(|bindless| render(&device, &scene, size, bindless));
        let (share, mean) =
            difference(&list.color, &buffer.color, 0.05 * list.color.pixels().iter().map(|c| c.luminance()).fold(0.0, f32::max));
        assert!(share < 0.02 && mean.is_finite(), "{}: {share} of the pixels differ, by {mean} in the mean", scene.name);
        assert!(list.color.pixels().iter().any(|c| c.luminance() > 0.0), "{} is lit", scene.name);
    }
}
