//! Which picture is shown, and where its pixels come from.

use crate::errors::Errors;
use crate::frames::Frames;
use crate::reference::Reference;
use crate::selection::Choice;
use egui::ColorImage;
use glam::Vec3;
use kajo_image::{Image, ToneMap, tone_map};
use kajo_image_metrics::{Palette, ShadowClass, View, class_picture, heat_map, shadow_classes};
use kajo_lab::failures::Class;
use kajo_lab::take;
use kajo_renderer::{FrameOutput, GBufferImages};
use kajo_techniques::Role;
use kajo_units::{LinearRgb, Srgb8};

/// What of a frame is shown.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) enum Show {
    /// The tone-mapped picture.
    #[default]
    Picture,
    /// The light that is reflected straight from lights.
    Direct,
    /// The output of the judged role, the mean over all lights.
    Role,
    /// Visibility of one light, by index.
    Light(usize),
    /// Umbra, penumbra and lit of one light, by index.
    Classes(usize),
    /// How the shadows of the judged lights fail.
    Failures,
    /// A channel of the G-buffer, by its place in [`CHANNELS`].
    Channel(usize),
    /// A picture of the technique's inner workings.
    Debug {
        /// Its name.
        name: String,
        /// Index of the light it is of.
        light: u32,
    },
}

impl Show {
    /// True when the path tracer has a picture to hold against it.
    pub fn has_reference(&self) -> bool {
        !matches!(self, Self::Channel(_) | Self::Debug { .. } | Self::Failures)
    }

    /// True when the frame has to have its G-buffer.
    pub fn needs_gbuffer(&self) -> bool {
        matches!(self, Self::Channel(_) | Self::Classes(_) | Self::Failures)
    }

    /// What its colours mean, where they stand for something.
    pub fn legend(&self) -> Vec<(Srgb8, &'static str, &'static str)> {
        match self {
            Self::Classes(_) => ShadowClass::ALL.map(|class| (class.color(), class.name(), "")).to_vec(),
            Self::Failures => Class::ALL.map(|class| (class.color(), class.id(), class.meaning())).to_vec(),
            _ => Vec::new(),
        }
    }
}

/// How light becomes a picture for the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Develop {
    /// Stops.
    pub exposure: f32,
    /// The curve.
    pub curve: ToneMap,
    /// The role that is judged.
    pub role: Role,
}

/// A picture of a G-buffer.
pub(crate) type Channel = (&'static str, fn(&GBufferImages) -> Image<LinearRgb>);

/// The channels of the G-buffer, with names for people.
pub(crate) const CHANNELS: [Channel; 10] = [
    ("base colour", |g| g.albedo.clone()),
    ("shading normal", |g| directions(&g.shading_normal)),
    ("geometric normal", |g| directions(&g.normal)),
    ("depth (near is light)", |g| near_is_light(&g.depth)),
    ("roughness", |g| g.roughness.map(|&v| LinearRgb::splat(v))),
    ("metalness", |g| g.metallic.map(|&v| LinearRgb::splat(v))),
    ("reflectance at normal incidence", |g| g.f0.clone()),
    ("motion (grey is still)", |g| g.motion.map(|m| LinearRgb(Vec3::new(m.x, m.y, 0.0) / 32.0 + 0.2))),
    ("instances", |g| g.instance.map(|id| id.map_or(LinearRgb::BLACK, colour_of))),
    ("materials", |g| g.material.map(|id| id.map_or(LinearRgb::BLACK, colour_of))),
];

fn directions(normals: &Image<Vec3>) -> Image<LinearRgb> {
    normals.map(|n| LinearRgb(0.5 * *n + 0.5))
}

/// Nearest over distance: 1 at the nearest surface, 0 where nothing is.
fn near_is_light(depth: &Image<f32>) -> Image<LinearRgb> {
    let nearest = depth.pixels().iter().copied().fold(f32::INFINITY, f32::min);
    depth.map(|&d| LinearRgb::splat(if d.is_finite() && d > 0.0 { nearest / d } else { 0.0 }))
}

/// Neighbouring numbers differ in hue: steps of the golden ratio around the circle.
fn colour_of(id: u32) -> LinearRgb {
    let hue = (id as f32 * 0.618_034).fract() * std::f32::consts::TAU;
    LinearRgb(Vec3::new(hue.cos(), (hue - 2.1).cos(), (hue + 2.1).cos()) * 0.4 + 0.5)
}

/// The curve that a technique of the role tone-map stands for, by the last word of its id.
pub(crate) fn curve(choice: Option<&Choice>) -> ToneMap {
    let name = choice.and_then(|choice| choice.technique.id.rsplit('/').next());
    ToneMap::ALL.into_iter().find(|curve| Some(curve.name()) == name).unwrap_or_default()
}

/// A side's picture; `None` where the frame does not have it (yet).
pub(crate) fn of_side(show: &Show, frames: &Frames, side: usize, reference: Option<&Reference>, develop: Develop) -> Option<ColorImage> {
    let frame = frames.sides.get(side)?.as_ref().ok()?;
    Some(match show {
        Show::Picture => colors(&frame.display),
        Show::Direct => colors(&tone_map(&frame.direct, develop.exposure, develop.curve)),
        Show::Role => colors(&role_picture(frame, reference, develop.role)),
        Show::Light(light) => {
            let part = frames.watched.iter().position(|watched| watched == light)?;
            fraction(&frame.visibility.get(part)?.map(|&v| LinearRgb::splat(v)))
        }
        Show::Classes(light) => {
            let part = frames.watched.iter().position(|watched| watched == light)?;
            let seen = frame.gbuffer.as_ref()?.depth.map(|depth| depth.is_finite());
            colors(&class_picture(&shadow_classes(frame.visibility.get(part)?, Some(&seen)).ok()?))
        }
        Show::Failures => return None,
        Show::Channel(index) => colors(&View::default().to_srgb8(&CHANNELS.get(*index)?.1(frame.gbuffer.as_ref()?))),
        Show::Debug { name, light } => {
            let view = frame.debug.iter().find(|view| view.name == name && view.light == *light)?;
            fraction(&view.pixels.to_color())
        }
    })
}

/// The reference's picture; `None` where it has none.
pub(crate) fn of_reference(show: &Show, reference: &Reference, develop: Develop) -> Option<ColorImage> {
    let judge = &reference.judge;
    Some(match show {
        Show::Picture => colors(&tone_map(&reference.picture, develop.exposure, develop.curve)),
        Show::Direct => {
            let composed = judge.composed.as_ref()?;
            let light = composed.simulated.as_ref().unwrap_or(&composed.part.image);
            colors(&tone_map(light, develop.exposure, develop.curve))
        }
        Show::Role => colors(&judge.view().to_srgb8(&judge.picture(&judge.images()))),
        Show::Light(light) => {
            let part = reference.lights.iter().position(|judged| judged == light)?;
            fraction(&judge.parts.get(part)?.image)
        }
        Show::Classes(light) => {
            let part = reference.lights.iter().position(|judged| judged == light)?;
            let visibility = judge.parts.get(part)?.image.map(|p| p[0]);
            colors(&class_picture(&shadow_classes(&visibility, judge.mask.as_ref()).ok()?))
        }
        Show::Failures | Show::Channel(_) | Show::Debug { .. } => return None,
    })
}

/// The error of each pixel as colour; `full` is the error of the lightest.
pub(crate) fn of_errors(errors: &Errors, full: f32) -> ColorImage {
    colors(&heat_map(&errors.heat, full, Palette::Magma))
}

/// How a side's shadows fail; `None` until it was measured.
pub(crate) fn of_failures(errors: &Errors) -> Option<ColorImage> {
    errors.failures.as_ref().map(|(picture, _)| colors(picture))
}

/// The mean over the role's images, as the reference shows it where there is one.
fn role_picture(frame: &FrameOutput, reference: Option<&Reference>, role: Role) -> Image<Srgb8> {
    let take = take(role, frame);
    if let Some(judge) = reference.map(|reference| &reference.judge)
        && judge.parts.len() == take.parts.len()
        && judge.size() == frame.direct.size()
    {
        return judge.view().to_srgb8(&judge.picture(&take.parts));
    }
    let scale = 1.0 / take.parts.len().max(1) as f32;
    let mean = |x, y| take.parts.iter().map(|part| *part.get(x, y)).sum::<LinearRgb>() * scale;
    View::FRACTION.to_srgb8(&Image::from_fn(frame.direct.size(), mean))
}

fn fraction(image: &Image<LinearRgb>) -> ColorImage {
    colors(&View::FRACTION.to_srgb8(image))
}

/// For the window.
pub(crate) fn colors(image: &Image<Srgb8>) -> ColorImage {
    let bytes: Vec<u8> = image.pixels().iter().flat_map(|pixel| pixel.0).collect();
    ColorImage::from_rgb([image.width() as usize, image.height() as usize], &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn every_curve_of_the_registry_is_one_of_the_library() {
        for technique in kajo_techniques::of_role(Role::ToneMap) {
            let choice = Choice::new(technique);
            assert!(technique.id.ends_with(curve(Some(&choice)).name()), "{}", technique.id);
        }
    }

    #[test]
    fn depth_is_lightest_where_it_is_nearest_and_black_at_infinity() {
        let depth = Image::from_pixels(UVec2::new(3, 1), vec![4.0, 2.0, f32::INFINITY]);
        let grey: Vec<f32> = near_is_light(&depth).pixels().iter().map(|p| p[0]).collect();
        assert_eq!(grey, [0.5, 1.0, 0.0]);
    }

    #[test]
    fn neighbouring_ids_have_different_colours() {
        for id in 0..200 {
            let (a, b) = (colour_of(id).0, colour_of(id + 1).0);
            assert!(a.distance(b) > 0.3 && a.min_element() >= 0.0 && a.max_element() <= 1.0, "{id}: {a} {b}");
        }
    }

    #[test]
    fn colours_keep_their_places() {
        let image = Image::from_fn(UVec2::new(2, 3), |x, y| Srgb8([x as u8, y as u8, 9]));
        let shown = colors(&image);
        assert_eq!(shown.size, [2, 3]);
        assert_eq!(shown[(1, 2)], egui::Color32::from_rgb(1, 2, 9));
    }
}
