//! Umbra, penumbra, lit: what a point sees of a light, in the words of the field.
//!
//! ```text
//! umbra     V = 0         no point of the light is seen; also where the surface turns away from it
//! penumbra  0 < V < 1     a part of an area light is seen; point lights have none
//! lit       V = 1         all of it is seen, above the horizon of the surface
//! ```
//! \[Arvo03] section 2. A measured V is a mean over samples, so ends count within [`TOLERANCE`]. The classes are of points: an image
//! sampled at pixel centres has them, one averaged over pixels turns each border into penumbra.

use crate::MetricsError;
use crate::error::check_size;
use kajo_image::Image;
use kajo_units::Srgb8;
use serde::Serialize;

/// Visibility up to this is umbra, from one minus this on is lit.
pub const TOLERANCE: f32 = 1e-3;

/// What a point sees of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShadowClass {
    /// Nothing.
    Umbra,
    /// A part.
    Penumbra,
    /// All of it.
    Lit,
}

impl ShadowClass {
    /// From dark to light; their numbers in images are their places here.
    pub const ALL: [Self; 3] = [Self::Umbra, Self::Penumbra, Self::Lit];

    /// The class of a visibility in [0, 1].
    pub fn of(visibility: f32) -> Self {
        match visibility {
            v if v <= TOLERANCE => Self::Umbra,
            v if v >= 1.0 - TOLERANCE => Self::Lit,
            _ => Self::Penumbra,
        }
    }

    /// Its word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Umbra => "umbra",
            Self::Penumbra => "penumbra",
            Self::Lit => "lit",
        }
    }

    /// How pictures show it; pixels without a surface are black.
    pub const fn color(self) -> Srgb8 {
        match self {
            Self::Umbra => Srgb8([44, 52, 110]),
            Self::Penumbra => Srgb8([236, 133, 38]),
            Self::Lit => Srgb8([250, 242, 212]),
        }
    }

    /// The name of its colour, for legends.
    pub const fn color_name(self) -> &'static str {
        match self {
            Self::Umbra => "indigo",
            Self::Penumbra => "orange",
            Self::Lit => "ivory",
        }
    }
}

/// The class of each pixel; `None` where `mask` is false: there is no surface.
///
/// # Errors
/// Sizes that differ.
pub fn shadow_classes(visibility: &Image<f32>, mask: Option<&Image<bool>>) -> Result<Image<Option<ShadowClass>>, MetricsError> {
    if let Some(mask) = mask {
        check_size("mask", mask.size(), visibility.size())?;
    }
    let class = |x, y| mask.is_none_or(|mask| *mask.get(x, y)).then(|| ShadowClass::of(*visibility.get(x, y)));
    Ok(Image::from_fn(visibility.size(), class))
}

/// The picture of classes.
pub fn class_picture(classes: &Image<Option<ShadowClass>>) -> Image<Srgb8> {
    classes.map(|class| class.map_or(Srgb8([0; 3]), ShadowClass::color))
}

/// Shares of pixels by the class that the technique puts them into.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ClassShares {
    /// Into the umbra.
    pub umbra: f64,
    /// Into the penumbra.
    pub penumbra: f64,
    /// Into the light.
    pub lit: f64,
}

impl ClassShares {
    /// In the order of [`ShadowClass::ALL`].
    pub fn to_array(self) -> [f64; 3] {
        [self.umbra, self.penumbra, self.lit]
    }
}

/// Which class of the reference a technique takes for which: shares of all pixels that show a surface, one row a class of the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ClassConfusion {
    /// What is umbra in the reference.
    pub umbra: ClassShares,
    /// What is penumbra there.
    pub penumbra: ClassShares,
    /// What is lit there.
    pub lit: ClassShares,
}

impl ClassConfusion {
    /// Counts over pairs of images: visibility by the technique, and its reference. Lights count alike.
    ///
    /// # Errors
    /// Sizes that differ.
    pub fn new<'a>(
        pairs: impl IntoIterator<Item = (&'a Image<f32>, &'a Image<f32>)>,
        mask: Option<&Image<bool>>,
    ) -> Result<Self, MetricsError> {
        let (mut counts, mut total) = ([[0u64; 3]; 3], 0u64);
        for (image, reference) in pairs {
            check_size("image", image.size(), reference.size())?;
            let (image, reference) = (shadow_classes(image, mask)?, shadow_classes(reference, mask)?);
            for (v, r) in image.pixels().iter().zip(reference.pixels()).filter_map(|(v, r)| (*v).zip(*r)) {
                counts[r as usize][v as usize] += 1;
                total += 1;
            }
        }
        let share = |count: u64| count as f64 / total.max(1) as f64;
        let row = |[umbra, penumbra, lit]: [u64; 3]| ClassShares { umbra: share(umbra), penumbra: share(penumbra), lit: share(lit) };
        let [umbra, penumbra, lit] = counts.map(row);
        Ok(Self { umbra, penumbra, lit })
    }

    /// Rows in the order of [`ShadowClass::ALL`].
    pub fn rows(self) -> [ClassShares; 3] {
        [self.umbra, self.penumbra, self.lit]
    }

    /// Share of pixels that are in the class of the reference.
    pub fn agreement(self) -> f64 {
        self.umbra.umbra + self.penumbra.penumbra + self.lit.lit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    /// 10 columns each of umbra, penumbra and light.
    fn soft() -> Image<f32> {
        Image::from_fn(UVec2::new(30, 10), |x, _| ((x as f32 - 9.5) / 10.0).clamp(0.0, 1.0))
    }

    #[test]
    fn classes_are_told_by_what_is_seen_of_the_light() {
        let of = ShadowClass::of;
        assert_eq!([of(0.0), of(1e-2), of(0.99), of(1.0)].map(ShadowClass::name), ["umbra", "penumbra", "penumbra", "lit"]);
        let mask = Image::from_fn(UVec2::new(30, 10), |_, y| y > 0);
        let picture = class_picture(&shadow_classes(&soft(), Some(&mask)).unwrap());
        assert_eq!((*picture.get(4, 0), *picture.get(4, 1)), (Srgb8([0; 3]), ShadowClass::Umbra.color()));
        assert_eq!(*picture.get(15, 1), ShadowClass::Penumbra.color());
    }

    #[test]
    fn equal_images_agree_and_a_hard_shadow_takes_the_penumbra_for_its_ends() {
        let same = ClassConfusion::new([(&soft(), &soft())], None).unwrap();
        assert_eq!((same.agreement(), same.umbra.umbra), (1.0, 1.0 / 3.0));
        let hard = soft().map(|v| v.round());
        let taken = ClassConfusion::new([(&hard, &soft()), (&soft(), &soft())], None).unwrap();
        assert_eq!((taken.penumbra.umbra, taken.penumbra.lit, taken.penumbra.penumbra), (1.0 / 12.0, 1.0 / 12.0, 1.0 / 6.0));
        assert!((taken.agreement() - 5.0 / 6.0).abs() < 1e-12 && taken.lit.umbra == 0.0);
    }

    /// Rows and columns are not to be mixed up, and pixels without a surface say nothing.
    #[test]
    fn a_planted_light_is_counted_in_the_row_of_the_reference() {
        let (lit, dark) = (Image::from_pixels(UVec2::new(2, 1), vec![1.0; 2]), Image::from_pixels(UVec2::new(2, 1), vec![0.0; 2]));
        let mask = Image::from_pixels(UVec2::new(2, 1), vec![true, false]);
        let leak = ClassConfusion::new([(&lit, &dark)], Some(&mask)).unwrap();
        assert_eq!((leak.umbra.lit, leak.lit.umbra, leak.agreement()), (1.0, 0.0, 0.0));
        assert!(ClassConfusion::new([(&lit, &soft())], None).is_err());
    }
}
