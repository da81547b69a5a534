//! Pixel filters by importance sampling: a sample is moved by an offset drawn from the filter and weighs 1.
//!
//! A pixel then gathers only its own samples, so that pixels are independent, can be replayed alone and have a variance of their
//! own.    \[Ernst06]
//! Filters with negative lobes (Mitchell, Lanczos) have no density to draw from and are left out for that reason.

use crate::PathTracerError;
use glam::Vec2;
use std::f32::consts::PI;
use std::str::FromStr;

/// Reconstruction filter of a pixel; all are separable, positive and have integral 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// The pixel square.
    Box,
    /// Triangle of radius 1 px.
    Tent,
    /// Gaussian, standard deviation 0.5 px, cut at 1.5 px.
    Gaussian,
    /// Blackman-Harris window of radius 1.5 px.    \[Harris78] table 1, 4 terms, 92 dB
    #[default]
    BlackmanHarris,
    /// A Dirac at the pixel centre: what a rasteriser without anti-aliasing sees. For judging real-time techniques.
    Center,
}

impl Filter {
    /// Every filter with its name.
    pub const ALL: [(&'static str, Self); 5] = [
        ("box", Self::Box),
        ("tent", Self::Tent),
        ("gaussian", Self::Gaussian),
        ("blackman-harris", Self::BlackmanHarris),
        ("center", Self::Center),
    ];

    /// The density along one axis, 1/px, not normalised for the two tabulated filters; `x` is the offset, px.
    fn shape(self, x: f32) -> f32 {
        match self {
            Self::Gaussian => (-0.5 * (x / 0.5) * (x / 0.5)).exp(),
            Self::BlackmanHarris => {
                let t = 2.0 * PI * (x / 3.0 + 0.5);
                0.35875 - 0.48829 * t.cos() + 0.14128 * (2.0 * t).cos() - 0.01168 * (3.0 * t).cos()
            }
            Self::Box => f32::from(u8::from(x.abs() <= 0.5)),
            Self::Tent => (1.0 - x.abs()).max(0.0),
            Self::Center => 0.0,
        }
    }
}

impl FromStr for Filter {
    type Err = PathTracerError;

    fn from_str(s: &str) -> Result<Self, PathTracerError> {
        Self::ALL.iter().find(|(name, _)| *name == s).map(|&(_, filter)| filter).ok_or_else(|| PathTracerError::Choice {
            what: "filter",
            got: s.into(),
            known: Self::ALL.map(|(name, _)| name).join(", "),
        })
    }
}

/// Draws offsets from a [`Filter`].
pub(crate) struct FilterSampler {
    filter: Filter,
    /// Offsets, px, at cumulative probabilities 0, 1/N … 1, for the filters without a closed inverse; linear between them.
    inverse_cdf: Vec<f32>,
}

impl FilterSampler {
    /// Cells of the tabulated inverse: the largest error of the filter's shape is then below 1e-3 of its peak.
    const CELLS: usize = 512;
    /// Where the tabulated filters end, px.
    const RADIUS: f32 = 1.5;

    pub(crate) fn new(filter: Filter) -> Self {
        let inverse_cdf = match filter {
            Filter::Gaussian | Filter::BlackmanHarris => Self::invert(filter),
            Filter::Box | Filter::Tent | Filter::Center => Vec::new(),
        };
        Self { filter, inverse_cdf }
    }

    fn invert(filter: Filter) -> Vec<f32> {
        let steps = 64 * Self::CELLS;
        let place = |i: usize| Self::RADIUS * (2.0 * i as f32 / steps as f32 - 1.0);
        let mut cdf = vec![0.0f64; steps + 1];
        for i in 0..steps {
            cdf[i + 1] = cdf[i] + f64::from(filter.shape(0.5 * (place(i) + place(i + 1))));
        }
        let total = cdf[steps];
        let mut i = 0;
        (0..=Self::CELLS)
            .map(|cell| {
                let target = total * cell as f64 / Self::CELLS as f64;
                while i < steps - 1 && cdf[i + 1] < target {
                    i += 1;
                }
                let t = ((target - cdf[i]) / (cdf[i + 1] - cdf[i])).clamp(0.0, 1.0);
                place(i) + (place(i + 1) - place(i)) * t as f32
            })
            .collect()
    }

    /// An offset from the pixel's centre, px; `u` in [0, 1)².
    pub(crate) fn offset(&self, u: Vec2) -> Vec2 {
        match self.filter {
            Filter::Center => Vec2::ZERO,
            Filter::Box => u - 0.5,
            Filter::Tent => Vec2::new(tent(u.x), tent(u.y)),
            Filter::Gaussian | Filter::BlackmanHarris => Vec2::new(self.lookup(u.x), self.lookup(u.y)),
        }
    }

    fn lookup(&self, u: f32) -> f32 {
        let at = u * Self::CELLS as f32;
        let cell = (at as usize).min(Self::CELLS - 1);
        self.inverse_cdf[cell] + (self.inverse_cdf[cell + 1] - self.inverse_cdf[cell]) * (at - cell as f32)
    }
}

/// Inverse of the cumulative triangle on [−1, 1].
fn tent(u: f32) -> f32 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_follow_the_shape_of_the_filter() {
        for (name, filter) in Filter::ALL {
            if filter == Filter::Center {
                assert_eq!(FilterSampler::new(filter).offset(Vec2::new(0.9, 0.1)), Vec2::ZERO);
                continue;
            }
            let sampler = FilterSampler::new(filter);
            let (n, bins) = (200_000, 30);
            let mut histogram = vec![0.0f32; bins];
            for i in 0..n {
                let x = sampler.offset(Vec2::new((i as f32 + 0.5) / n as f32, 0.5)).x;
                histogram[(((x + 1.5) / 3.0 * bins as f32) as usize).min(bins - 1)] += 1.0 / n as f32;
            }
            let shape: Vec<f32> = (0..bins)
                .map(|b| (0..64).map(|i| filter.shape(3.0 * (b as f32 + (i as f32 + 0.5) / 64.0) / bins as f32 - 1.5)).sum())
                .collect();
            let total: f32 = shape.iter().sum();
            for (got, expected) in histogram.iter().zip(&shape) {
                assert!((got - expected / total).abs() < 2e-3, "{name}: {got} instead of {}", expected / total);
            }
            assert!(sampler.offset(Vec2::splat(0.5)).length() < 1e-3, "{name} is centred");
        }
    }

    #[test]
    fn names_parse_and_unknown_ones_list_the_known() {
        assert_eq!("tent".parse::<Filter>().unwrap(), Filter::Tent);
        assert!("mitchell".parse::<Filter>().unwrap_err().to_string().contains("blackman-harris"));
    }
}
