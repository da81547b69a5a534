//! Where the surface point of each pixel was one frame ago.

use glam::{UVec2, Vec2};
use kajo_image::Image;
use kajo_renderer::{Error, FrameSettings, GBufferImages, Renderer, RoleSelection};
use kajo_scene::Snapshot;
use kajo_units::LinearRgb;
use std::sync::Arc;

/// For each pixel the place in the frame before, px; `None` where its surface was not seen then.
pub type Track = Image<Option<Vec2>>;

/// The G-buffer at pixel centres.
///
/// # Errors
/// When the device fails.
pub fn gbuffer(renderer: &mut Renderer, now: &Snapshot, before: &Snapshot) -> Result<GBufferImages, Error> {
    renderer.set_snapshot(now, before)?;
    let roles = RoleSelection::new().choose("shadow/none", &[])?;
    let frame = renderer.render(&roles, &FrameSettings { gbuffer: true, ..FrameSettings::default() })?;
    Ok(frame.gbuffer.expect("it was asked for"))
}

/// Distances between where a point should have been and what was seen there that still count as the same place, in units of what a pixel covers.
const PIXELS: f32 = 3.0;

/// Follows the motion vectors back. What is seen there must be the same instance and, of those that do not deform, the same place on it. Where nothing is seen, there
/// is nothing to follow.
pub fn track((now, images): (&Snapshot, &GBufferImages), (before, old): (&Snapshot, &GBufferImages)) -> Track {
    let size = images.motion.size();
    Image::from_fn(size, |x, y| {
        let then = images.reprojected(x, y)?;
        let id = (*images.instance.get(x, y))?;
        let (u, v) = (then.x as u32, then.y as u32);
        if *old.instance.get(u, v) != Some(id) {
            return None;
        }
        let [to, from] = [before, now].map(|snapshot| &snapshot.instances[id as usize]);
        let rigid = Arc::ptr_eq(&now.meshes[from.mesh], &before.meshes[to.mesh]) && from.world_from_object.matrix3.determinant() != 0.0;
        if rigid {
            let expected =
                to.world_from_object.transform_point3(from.world_from_object.inverse().transform_point3(*images.position.get(x, y)));
            let footprint = PIXELS * old.depth.get(u, v) / size.y as f32;
            // Seen at a grazing angle a pixel covers more of the surface.
            if expected.distance(*old.position.get(u, v)) > PIXELS * footprint {
                return None;
            }
        }
        Some(then)
    })
}

/// The image at a place between pixels, bilinear, in the part that begins at row `top` and has `size`.
pub fn at(image: &Image<LinearRgb>, place: Vec2, top: u32, size: UVec2) -> LinearRgb {
    let last = size.as_vec2() - 1.0;
    let p = (place - 0.5).clamp(Vec2::ZERO, last);
    let low = p.floor();
    let t = p - low;
    let high = (low + 1.0).min(last);
    let get = |x: f32, y: f32| *image.get(x as u32, y as u32 + top);
    let row = |y: f32| get(low.x, y) * (1.0 - t.x) + get(high.x, y) * t.x;
    row(low.y) * (1.0 - t.y) + row(high.y) * t.y
}
