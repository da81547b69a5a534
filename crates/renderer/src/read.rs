//! Images of the pool, read back and unpacked.

use crate::output::GBufferImages;
use glam::{UVec2, Vec2, Vec3, Vec4};
use kajo_image::Image;
use kajo_render_graph::{Device, Error, Pool, Slot, readback, slot, wgpu};
use kajo_techniques::{Role, View};
use kajo_units::{LinearRgb, Srgb8};

/// The texels of a slot that a pass has made.
fn texels<T: bytemuck::AnyBitPattern>(device: &Device, pool: &Pool, slot: Slot, layer: u32) -> Result<Vec<T>, Error> {
    let texture = pool.get(slot).ok_or_else(|| Error::NoProducer { pass: "readback".to_owned(), slot: slot.name, written: Vec::new() })?;
    readback::read_texture(device, &texture.wgpu, layer)
}

fn image<T: bytemuck::AnyBitPattern, U>(
    device: &Device,
    pool: &Pool,
    slot: Slot,
    layer: u32,
    unpack: impl FnMut(T) -> U,
) -> Result<Image<U>, Error> {
    Ok(Image::from_pixels(pool.size(), texels(device, pool, slot, layer)?.into_iter().map(unpack).collect()))
}

/// A slot of four floats.
pub(crate) fn radiance(device: &Device, pool: &Pool, slot: Slot) -> Result<Image<LinearRgb>, Error> {
    image(device, pool, slot, 0, |[r, g, b, _]: [f32; 4]| LinearRgb::new(r, g, b))
}

/// One layer of a slot of one float.
pub(crate) fn scalar(device: &Device, pool: &Pool, slot: Slot, layer: u32) -> Result<Image<f32>, Error> {
    image(device, pool, slot, layer, |value: f32| value)
}

/// What the technique of a role with one image wrote.
pub(crate) fn estimate(device: &Device, pool: &Pool, role: Role) -> Result<Image<LinearRgb>, Error> {
    let slot = role.output().expect("a role that is read has a slot");
    match slot.format {
        wgpu::TextureFormat::R32Float => Ok(scalar(device, pool, slot, 0)?.map(|&value| LinearRgb::splat(value))),
        _ => radiance(device, pool, slot),
    }
}

/// The picture for a display.
pub(crate) fn display(device: &Device, pool: &Pool) -> Result<Image<Srgb8>, Error> {
    image(device, pool, slot::DISPLAY, 0, |[r, g, b, _]: [u8; 4]| Srgb8([r, g, b]))
}

/// Everything that the G-buffer pass wrote.
pub(crate) fn gbuffer(device: &Device, pool: &Pool, view: &View) -> Result<GBufferImages, Error> {
    let depths: Vec<f32> = texels(device, pool, slot::DEPTH, 0)?;
    let size = pool.size();
    let relative_from_clip = view.jittered_clip_from_relative().as_dmat4().inverse();
    let forward = view.relative_from_view.transform_vector3(Vec3::NEG_Z);
    let relative = |index: usize| -> Vec3 {
        let pixel = UVec2::new(index as u32 % size.x, index as u32 / size.x).as_dvec2() + 0.5;
        let ndc = pixel / size.as_dvec2() * 2.0 - 1.0;
        let p = relative_from_clip * glam::dvec4(ndc.x, -ndc.y, f64::from(depths[index]), 1.0);
        (p.truncate() / p.w).as_vec3()
    };
    let of = |f: &dyn Fn(usize) -> f32| Image::from_pixels(size, (0..depths.len()).map(f).collect());
    let normal = |which: usize| {
        let decode = move |words: [u32; 2]| unpack_normal(words[which]);
        image(device, pool, slot::NORMAL, 0, decode)
    };
    let halves = |texel: [u16; 4]| Vec4::from_array(texel.map(|bits| half::f16::from_bits(bits).to_f32()));
    let id = |which: usize| {
        let decode = move |words: [u32; 2]| (words[which] & 0x7fff_ffff).checked_sub(1);
        image(device, pool, slot::IDS, 0, decode)
    };
    Ok(GBufferImages {
        depth: of(&|i| if depths[i] > 0.0 { relative(i).dot(forward) } else { f32::INFINITY }),
        position: Image::from_pixels(
            size,
            (0..depths.len()).map(|i| if depths[i] > 0.0 { relative(i) + view.position } else { Vec3::ZERO }).collect(),
        ),
        shading_normal: normal(0)?,
        normal: normal(1)?,
        albedo: image(device, pool, slot::ALBEDO, 0, |t| LinearRgb(halves(t).truncate()))?,
        metallic: image(device, pool, slot::ALBEDO, 0, |t| halves(t).w)?,
        f0: image(device, pool, slot::F0_ROUGHNESS, 0, |t| LinearRgb(halves(t).truncate()))?,
        roughness: image(device, pool, slot::F0_ROUGHNESS, 0, |t| halves(t).w)?,
        motion: image(device, pool, slot::MOTION, 0, |[x, y]: [f32; 2]| Vec2::new(x, y))?,
        instance: id(0)?,
        material: id(1)?,
    })
}

/// Twin of `packing::unpack_normal`.
fn unpack_normal(bits: u32) -> Vec3 {
    let snorm = |half: u32| (f32::from(half as u16 as i16) / 32767.0).max(-1.0);
    let p = Vec2::new(snorm(bits & 0xffff), snorm(bits >> 16));
    let z = 1.0 - p.x.abs() - p.y.abs();
    let sign = |v: f32| if v >= 0.0 { 1.0 } else { -1.0 };
    let xy = if z >= 0.0 { p } else { Vec2::new((1.0 - p.y.abs()) * sign(p.x), (1.0 - p.x.abs()) * sign(p.y)) };
    xy.extend(z).normalize()
}
