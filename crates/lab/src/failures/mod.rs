//! Where and how a shadow technique fails, in the words of the field: acne, detachment, leak, aliasing, missed penumbra.
//!
//! Each class is a geometric statement about three images of one view: the technique's visibility V of a light, the reference R, and the G-buffer. No
//! knowledge of the technique enters, so all are measured alike. Terms: a pixel is *cast* shadow where R is umbra though the surface faces the light; the *border* runs where R changes between umbra, penumbra
//! and lit; a fault *hugs the border* when it begins there and reaches no farther than [`reach`] px; a *contact* is a crease where cast shadow meets the unlit
//! side of another surface, the foot of what casts it.
//!
//! | class | where R says | V says | and |
//! | --- | --- | --- | --- |
//! | acne | lit | shadow | does not hug the border: the surface shadows itself |
//! | detachment | cast | lit | begins at a contact, or hugs the border with no fault of the other sign near: the shadow has come off its caster |
//! | leak | cast | light | neither: nothing but a hole in the shadow explains it; also where a whole shadow is missing |
//! | aliasing | lit or cast | the opposite | hugs the border; light in the shadow with faults of the other sign near, shadow on what is lit always |
//! | missed penumbra | penumbra, with all neighbours | one class, over 5 × 5 px | the two differ by more than a tenth |
//!
//! Faults one pixel deep at the border are none: any rasterisation has them. Nor is what happens outside the cone of a spot and behind a flat lamp; shares are
//! of the pixels that remain.
//!
//! The words are the literature's: acne, or erroneous self-shadowing, and detachment, or Peter Panning, the two ends of a depth bias \[Reeves87\],
//! \[MicrosoftShadows\]; leaks are the light bleeding of filtered maps \[Donnelly06\], \[Lauritzen08\] section 4, and of any shadow that has a hole;
//! aliasing is of perspective and projection \[Stamminger02\], \[Wimmer04\]; umbra and penumbra \[Arvo03\] section 2, \[Hasenfratz03\]. They describe what
//! is seen, and how it comes about; the tests on images in the table are ours.

mod regions;
mod shadows;
mod surfaces;

pub use surfaces::{LightPlace, places};

use crate::judge::Judge;
use kajo_image::Image;
use kajo_image_metrics::{MetricsError, View};
use kajo_renderer::GBufferImages;
use kajo_units::{LinearRgb, Srgb8};
use std::collections::BTreeMap;
use surfaces::Surfaces;

/// A way to fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Class {
    /// Light where there must be none.
    Leak,
    /// The shadow does not begin where its caster stands.
    Detachment,
    /// Shadow on a lit surface, by itself.
    Acne,
    /// Stairs along the border.
    Aliasing,
    /// A hard border where the light is large.
    MissedPenumbra,
}

impl Class {
    /// The one that hides more of what is wrong first: a pixel that fails for several lights shows it.
    pub const ALL: [Self; 5] = [Self::Leak, Self::Detachment, Self::Acne, Self::Aliasing, Self::MissedPenumbra];

    /// Its key in `report.json`.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Leak => "leak",
            Self::Detachment => "detachment",
            Self::Acne => "acne",
            Self::Aliasing => "aliasing",
            Self::MissedPenumbra => "missed-penumbra",
        }
    }

    /// What it means, for legends.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Leak => "light inside a shadow, away from its border and its caster",
            Self::Detachment => "light between a shadow and the foot of what casts it",
            Self::Acne => "shadow on a lit surface, away from any border",
            Self::Aliasing => "the border strays to both sides",
            Self::MissedPenumbra => "a hard border where a part of the light is seen",
        }
    }

    /// How masks show it.
    pub const fn color(self) -> Srgb8 {
        match self {
            Self::Leak => Srgb8([255, 214, 64]),
            Self::Detachment => Srgb8([64, 200, 255]),
            Self::Acne => Srgb8([255, 64, 64]),
            Self::Aliasing => Srgb8([192, 96, 255]),
            Self::MissedPenumbra => Srgb8([80, 220, 120]),
        }
    }
}

/// The faults of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Failures {
    /// The class of each pixel, over all lights.
    pub image: Image<Option<Class>>,
    /// Share of each class in the pixels that show a surface which the light can reach, lights counted one by one.
    pub shares: BTreeMap<Class, f64>,
}

/// How far a fault may reach from the border and still be one of the border, px: 3 % of the picture's height.
pub fn reach(height: u32) -> f32 {
    (0.03 * height as f32).max(6.0)
}

impl Failures {
    /// The faults of `parts`, the visibility of each judged light: in reports the mean over all takes, in the viewer one frame. `lights`: where they are, in the order of the judge's parts.
    ///
    /// # Errors
    /// Sizes that differ.
    pub fn new(judge: &Judge, parts: &[Image<LinearRgb>], gbuffer: &GBufferImages, lights: &[LightPlace]) -> Result<Self, MetricsError> {
        assert_eq!(lights.len(), judge.parts.len(), "a place for each judged light");
        let scalar = |image: &Image<LinearRgb>| image.map(|p| p[0]);
        let surfaces = Surfaces::new(gbuffer, judge.mask.as_ref())?;
        let mut image: Image<Option<Class>> = Image::from_fn(judge.size(), |_, _| None);
        let mut counts: BTreeMap<Class, u64> = Class::ALL.map(|class| (class, 0)).into();
        let mut reachable = 0;
        for ((part, reference), light) in parts.iter().zip(&judge.parts).zip(lights) {
            let reached = surfaces.reached(*light);
            reachable += reached.pixels().iter().filter(|reached| **reached).count();
            let found = shadows::classify(&scalar(part), &scalar(&reference.image), &surfaces, (*light, &reached))?;
            for (shown, class) in image.pixels_mut().iter_mut().zip(found.pixels()) {
                let Some(class) = class else { continue };
                *counts.get_mut(class).expect("every class is counted") += 1;
                *shown = Some(shown.map_or(*class, |before| before.min(*class)));
            }
        }
        let shares = counts.into_iter().map(|(class, count)| (class, count as f64 / reachable.max(1) as f64)).collect();
        Ok(Self { image, shares })
    }

    /// The mask over a dark picture of the reference.
    pub fn picture(&self, judge: &Judge) -> Image<Srgb8> {
        const DIM: f32 = 0.12;
        let reference = judge.picture(&judge.images()).map(|p| *p * DIM);
        let under = View::FRACTION.to_srgb8(&reference);
        Image::from_fn(under.size(), |x, y| self.image.get(x, y).map_or(*under.get(x, y), Class::color))
    }

    /// Shares by the names of the classes, as `report.json` has them.
    pub fn by_id(&self) -> BTreeMap<String, f64> {
        self.shares.iter().map(|(class, share)| (class.id().to_owned(), *share)).collect()
    }
}

#[cfg(test)]
mod tests;
