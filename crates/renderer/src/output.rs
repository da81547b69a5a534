//! What a frame leaves behind.

use glam::{Vec2, Vec3};
use kajo_image::Image;
use kajo_render_graph::Timings;
use kajo_scene::Ignored;
use kajo_techniques::{DebugView, Role, Statistic};
use kajo_units::{LinearRgb, Srgb8};

/// A rendered frame, on the CPU.
#[derive(Clone, Debug)]
pub struct FrameOutput {
    /// The linear picture after anti-aliasing and before exposure, W/(m² sr).
    pub color: Image<LinearRgb>,
    /// The picture for a display: exposed, tone mapped, encoded.
    pub display: Image<Srgb8>,
    /// Light reflected straight from lights, W/(m² sr).
    pub direct: Image<LinearRgb>,
    /// Role direct visibility: one image for each light that is [watched](crate::Renderer::watch), in the order of the lights.
    pub visibility: Vec<Image<f32>>,
    /// What techniques of other roles estimated, where it was asked for; single numbers as grey.
    pub estimates: Vec<(Role, Image<LinearRgb>)>,
    /// The G-buffer, when it was asked for.
    pub gbuffer: Option<GBufferImages>,
    /// What each pass took.
    pub timings: Timings,
    /// Bytes of everything that is alive on the device.
    pub memory_bytes: u64,
    /// Bytes of what each technique keeps, by id: its textures and buffers, and the images of the slots that its passes make. Acceleration
    /// structures are the scene's.
    pub technique_bytes: Vec<(&'static str, u64)>,
    /// Rays traced for the frame.
    pub rays: u64,
    /// The same by technique, by id.
    pub technique_rays: Vec<(&'static str, u64)>,
    /// Draws of the passes that the camera looks through.
    pub draws: u32,
    /// Draws left out of them because the camera cannot see them.
    pub culled_draws: u32,
    /// Pixels lit, each counted once for each group of lights.
    pub shaded_pixels: u32,
    /// What techniques counted; that of the role direct visibility light by light.
    pub statistics: Vec<Statistic>,
    /// Pictures of their inner workings, when they were asked for.
    pub debug: Vec<DebugView>,
    /// What this renderer and the technique do not simulate in this scene.
    pub ignored: Vec<Ignored>,
}

impl FrameOutput {
    /// What the technique of a role estimated, where it was asked for.
    pub fn estimate(&self, role: Role) -> Option<&Image<LinearRgb>> {
        self.estimates.iter().find(|(of, _)| *of == role).map(|(_, image)| image)
    }
}

/// The G-buffer, unpacked. Where nothing is seen the depth is infinite and the other values mean nothing.
#[derive(Clone, Debug)]
pub struct GBufferImages {
    /// Distance along the viewing axis, m; infinite where nothing is seen.
    pub depth: Image<f32>,
    /// Position, world, m.
    pub position: Image<Vec3>,
    /// Shading normal, world, unit, on the viewer's side.
    pub shading_normal: Image<Vec3>,
    /// Geometric normal, world, unit, on the viewer's side.
    pub normal: Image<Vec3>,
    /// Base colour.
    pub albedo: Image<LinearRgb>,
    /// Metalness.
    pub metallic: Image<f32>,
    /// Reflectance of the base layer at normal incidence.
    pub f0: Image<LinearRgb>,
    /// Perceptual roughness.
    pub roughness: Image<f32>,
    /// Now minus one frame ago, px, x right and y down; −1e9 where the point was behind the camera.
    pub motion: Image<Vec2>,
    /// Index of the instance; `None` where nothing is seen.
    pub instance: Image<Option<u32>>,
    /// Index of the material; `None` where nothing is seen.
    pub material: Image<Option<u32>>,
}

impl GBufferImages {
    /// Where the point that pixel (x, y) shows was in the image one frame ago, px; `None` where nothing is seen, and where the point was
    /// outside the image or behind the camera: there is no history for it.
    pub fn reprojected(&self, x: u32, y: u32) -> Option<Vec2> {
        (*self.instance.get(x, y))?;
        let then = Vec2::new(x as f32, y as f32) + 0.5 - *self.motion.get(x, y);
        let inside = then.cmpge(Vec2::ZERO).all() && then.cmplt(self.motion.size().as_vec2()).all();
        inside.then_some(then)
    }
}
