//! Values of arguments: what a word may be, and the sentence that says so.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use glam::{UVec2, Vec3};
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;
use std::time::Duration;

/// The words of a library's own list.
pub(super) fn named<T: Copy + Send + Sync + 'static>(
    list: &'static [(&'static str, T)],
) -> impl clap::builder::TypedValueParser<Value = T> {
    let value = |word: String| list.iter().find(|(name, _)| *name == word).expect("one of the possible values").1;
    PossibleValuesParser::new(list.iter().map(|(name, _)| *name)).map(value)
}

/// `auto` or stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ExposureChoice {
    /// From the image.
    Auto,
    /// Image value = radiance × 2^stops.
    Stops(f32),
}

impl FromStr for ExposureChoice {
    type Err = String;
    fn from_str(word: &str) -> Result<Self, String> {
        if word == "auto" {
            return Ok(Self::Auto);
        }
        let stops = finite(word)?;
        if stops.abs() > 100.0 { Err("expected -100 to 100 stops, or `auto`".into()) } else { Ok(Self::Stops(stops as f32)) }
    }
}

/// Largest image side, px.
const MAX_SIDE: u32 = 16_384;

/// An image size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub UVec2);

impl FromStr for Size {
    type Err = String;
    fn from_str(word: &str) -> Result<Self, String> {
        let sides = word.split_once(['x', 'X', '×']).and_then(|(w, h)| Some((w.trim().parse().ok()?, h.trim().parse().ok()?)));
        let (width, height): (u32, u32) = sides.ok_or("expected WIDTHxHEIGHT in px, e.g. 1280x720")?;
        if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE {
            return Err(format!("each side must be 1 to {MAX_SIDE} px"));
        }
        Ok(Self(UVec2::new(width, height)))
    }
}

/// Frame numbers, both ends inclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRange {
    /// First frame.
    pub first: u32,
    /// Last frame.
    pub last: u32,
}

impl FromStr for FrameRange {
    type Err = String;
    fn from_str(word: &str) -> Result<Self, String> {
        let ends = word.split_once("..").and_then(|(a, b)| Some((a.trim().parse().ok()?, b.trim().parse().ok()?)));
        let (first, last) = ends.ok_or("expected FIRST..LAST, e.g. 0..48")?;
        if first > last { Err("the first frame comes after the last".into()) } else { Ok(Self { first, last }) }
    }
}

/// A whole number in a range.
pub(super) fn whole<T>(range: RangeInclusive<T>) -> impl Fn(&str) -> Result<T, String> + Clone
where
    T: FromStr + PartialOrd + Display + Clone,
{
    move |word| {
        let number = word.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| format!("expected a whole number from {} to {}", range.start(), range.end()))
    }
}

/// A number that single precision, in which images are computed, can hold.
pub(super) fn finite(word: &str) -> Result<f64, String> {
    let value: f64 = word.parse().map_err(|_| "expected a number".to_string())?;
    if (value as f32).is_finite() { Ok(value) } else { Err("expected a finite number".into()) }
}

pub(super) fn positive(word: &str) -> Result<f64, String> {
    let value = finite(word)?;
    if value as f32 >= f32::MIN_POSITIVE { Ok(value) } else { Err("expected a number above 0".into()) }
}

/// Three numbers with commas between them.
pub(super) fn point(word: &str) -> Result<Vec3, String> {
    let numbers = word.split(',').map(|number| finite(number.trim())).collect::<Result<Vec<f64>, _>>();
    let point = numbers.ok().and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
    point.map(|point| Vec3::from(point.map(|number| number as f32))).ok_or_else(|| "expected X,Y,Z in m, e.g. 0,1.6,4".into())
}

pub(super) fn angle_of_view(word: &str) -> Result<f64, String> {
    let degrees = finite(word)?;
    if (0.01..=179.0).contains(&degrees) { Ok(degrees) } else { Err("expected 0.01 to 179 degrees".into()) }
}

/// A time that no clock overflows at.
pub(super) fn seconds(word: &str) -> Result<Duration, String> {
    const THIRTY_YEARS: f64 = 1e9;
    let value = positive(word)?;
    if value <= THIRTY_YEARS { Ok(Duration::from_secs_f64(value)) } else { Err("expected at most 1e9 seconds".into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_without_pixels_or_too_large_are_refused() {
        assert_eq!("640x360".parse(), Ok(Size(UVec2::new(640, 360))));
        for wrong in ["0x0", "100000x100000", "640", "x", "-1x5", "1.5x2"] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn frame_ranges_are_ordered() {
        assert_eq!("3..5".parse(), Ok(FrameRange { first: 3, last: 5 }));
        assert!("5..3".parse::<FrameRange>().is_err());
    }

    #[test]
    fn numbers_that_single_precision_cannot_hold_are_refused() {
        for wrong in ["nan", "inf", "1e39", "-1e39", "x", ""] {
            assert!(finite(wrong).is_err() && positive(wrong).is_err() && seconds(wrong).is_err(), "{wrong}");
        }
        for wrong in ["0", "-1", "1e-50"] {
            assert!(positive(wrong).is_err() && seconds(wrong).is_err(), "{wrong}");
        }
        assert!(seconds("1e10").is_err());
        assert_eq!((finite("-2.5"), positive("1e-9"), seconds("0.5")), (Ok(-2.5), Ok(1e-9), Ok(Duration::from_millis(500))));
        assert_eq!(whole(1..=9u16)("12").unwrap_err(), "expected a whole number from 1 to 9");
        assert_eq!((whole(1..=9u16)("9"), whole(1..=9u16)("-1").is_ok(), whole(0..=9u16)("1.5").is_ok()), (Ok(9), false, false));
    }

    #[test]
    fn points_have_three_finite_numbers() {
        assert_eq!(point("-1, 2.5,3e0"), Ok(Vec3::new(-1.0, 2.5, 3.0)));
        for wrong in ["", "1,2", "1,2,3,4", "a,b,c", "1,2,inf"] {
            assert!(point(wrong).is_err(), "{wrong}");
        }
        assert!(angle_of_view("0").is_err() && angle_of_view("180").is_err() && angle_of_view("40").is_ok());
    }

    #[test]
    fn nan_is_no_exposure() {
        assert!("nan".parse::<ExposureChoice>().is_err());
        assert_eq!("-2.5".parse(), Ok(ExposureChoice::Stops(-2.5)));
    }
}
