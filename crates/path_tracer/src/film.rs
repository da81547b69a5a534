//! The film: what every pixel has gathered so far, for every image.
//!
//! A pixel adds its own samples, in their order, in double precision; nothing is shared between pixels. So the result does not
//! depend on the number of threads, on the size of passes, or on where a rendering was interrupted and resumed.

use crate::adaptive::{Pilot, Plan, count};
use crate::blocks::BlockSums;
use crate::{Aov, PathTracerError, aov::Combine};
use glam::UVec2;

/// What a film gathers for one image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ImageSpec {
    /// `None` is `beauty`.
    pub aov: Option<Aov>,
    /// Name of the image and of its layer in files.
    pub name: String,
    /// First of its channels in a pixel's sums.
    pub offset: usize,
    /// Number of channels.
    pub channels: usize,
    /// First of its channels among those whose variance is tracked.
    pub tracked: Option<usize>,
    /// How samples become a value.
    pub combine: Combine,
}

/// The images of a film and their places in a pixel's sums.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct FilmLayout {
    pub images: Vec<ImageSpec>,
    /// Channels of a pixel, all images together.
    pub channels: usize,
    /// Channels whose variance is tracked.
    pub tracked: usize,
    /// Where the count of samples that hit a surface is kept, if anything needs it.
    pub coverage: Option<usize>,
    /// That place when it is no image of its own.
    hidden_coverage: Option<usize>,
}

impl FilmLayout {
    /// `beauty` and `aovs`, each once.
    pub(crate) fn new(aovs: &[Aov]) -> Self {
        let mut layout = Self::default();
        layout.push(None, "beauty".into(), 3, Combine::TrackedMean);
        for aov in aovs {
            if layout.images.iter().all(|image| image.aov.as_ref() != Some(aov)) {
                layout.push(Some(aov.clone()), aov.to_string(), aov.channels(), aov.combine());
            }
        }
        layout.coverage = layout.images.iter().find(|image| image.aov == Some(Aov::Coverage)).map(|image| image.offset);
        if layout.coverage.is_none() && layout.images.iter().any(|image| image.combine == Combine::Covered) {
            layout.coverage = Some(layout.channels);
            layout.hidden_coverage = layout.coverage;
            layout.channels += 1;
        }
        layout
    }

    /// Asks for the memory of an image before work goes into it: the system refuses in a moment what it cannot have at all.
    ///
    /// # Errors
    /// [`PathTracerError::Memory`].
    pub(crate) fn check_memory(&self, size: UVec2, adaptive: bool) -> Result<(), PathTracerError> {
        let plan = if adaptive { size_of::<(u32, f32, Pilot)>() as u64 } else { 0 };
        let bytes = self.bytes(size).saturating_add((u64::from(size.x) * u64::from(size.y)).saturating_mul(plan));
        let fits = usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
        if fits { Ok(()) } else { Err(PathTracerError::Memory { width: size.x, height: size.y, bytes }) }
    }

    /// Memory of a film of `size` and of the images that it is developed into, bytes.
    fn bytes(&self, size: UVec2) -> u64 {
        let developed = size_of::<f32>() * (self.channels + self.tracked);
        let pixel = size_of::<f64>() * self.channels + size_of::<BlockSums>() * self.tracked + developed;
        (u64::from(size.x) * u64::from(size.y)).saturating_mul(pixel as u64)
    }

    fn push(&mut self, aov: Option<Aov>, name: String, channels: usize, combine: Combine) {
        let tracked = (combine == Combine::TrackedMean).then_some(self.tracked);
        self.images.push(ImageSpec { aov, name, offset: self.channels, channels, tracked, combine });
        self.channels += channels;
        self.tracked += if tracked.is_some() { channels } else { 0 };
    }
}

/// Accumulated samples of a rendering; it can be developed into a [`Frame`](crate::Frame), saved, loaded and rendered on.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    pub(crate) size: UVec2,
    pub(crate) layout: FilmLayout,
    /// Hash of scene and settings: films of different pictures must not be mixed.
    pub(crate) fingerprint: Fingerprint,
    /// Level of each row: the samples of each of its pixels, or what [`Plan::count`] makes of it. Rows differ only after an interruption.
    pub(crate) levels: Vec<u32>,
    /// Where samples go, if not everywhere alike.
    pub(crate) plan: Option<Plan>,
    /// Sums of samples, `height × width × channels`.
    pub(crate) sums: Vec<f64>,
    /// Block sums, `height × width × tracked`.
    pub(crate) blocks: Vec<BlockSums>,
    /// Rays traced.
    pub(crate) rays: u64,
    /// Wall-clock time spent on it, s.
    pub(crate) seconds: f64,
    /// Samples that were NaN or infinite and count as black.
    pub(crate) invalid: u64,
}

/// Hashes of what a film shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Fingerprint {
    pub scene: u64,
    pub settings: u64,
}

impl Film {
    pub(crate) fn new(size: UVec2, layout: FilmLayout, fingerprint: Fingerprint, adaptive: bool) -> Self {
        let pixels = size.x as usize * size.y as usize;
        Self {
            size,
            levels: vec![0; size.y as usize],
            plan: adaptive.then(|| Plan::even(pixels)),
            sums: vec![0.0; pixels * layout.channels],
            blocks: vec![BlockSums::default(); pixels * layout.tracked],
            layout,
            fingerprint,
            rays: 0,
            seconds: 0.0,
            invalid: 0,
        }
    }

    /// Width and height, px.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Samples that every pixel has at least; with adaptive sampling their mean.
    pub fn spp(&self) -> u32 {
        self.levels.iter().copied().min().unwrap_or(0)
    }

    /// Samples of all pixels together.
    pub fn samples(&self) -> u64 {
        match &self.plan {
            None => self.levels.iter().map(|&n| u64::from(n)).sum::<u64>() * u64::from(self.size.x),
            Some(_) => (0..self.size.x as usize * self.size.y as usize).map(|pixel| u64::from(self.count(pixel))).sum(),
        }
    }

    /// Samples of a pixel.
    pub(crate) fn count(&self, pixel: usize) -> u32 {
        let level = self.levels[pixel / self.size.x as usize];
        self.plan.as_ref().map_or(level, |plan| plan.count(pixel, level))
    }

    /// Decides anew where samples go, if it is time to.
    pub(crate) fn revise(&mut self) {
        if let Some(plan) = &mut self.plan
            && self.levels.iter().all(|&level| level == plan.revision())
        {
            plan.revise(self.size);
        }
    }

    /// Rays traced so far.
    pub fn rays(&self) -> u64 {
        self.rays
    }

    /// Time spent rendering so far, s.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// The rows, from the top, for filling them independently of each other.
    pub(crate) fn rows(&mut self) -> Vec<Row<'_>> {
        let width = self.size.x as usize;
        let sums = self.sums.chunks_exact_mut(width * self.layout.channels);
        let blocks = self.blocks.chunks_exact_mut(width * self.layout.tracked);
        let layout = &self.layout;
        let levels = self.levels.iter_mut();
        let mut rows: Vec<_> = sums
            .zip(blocks)
            .zip(levels)
            .enumerate()
            .map(|(y, ((sums, blocks), level))| Row { y: y as u32, layout, sums, blocks, level, plan: None })
            .collect();
        if let Some(Plan { level, milestone, base, density, pilots }) = &mut self.plan {
            let parts = base.chunks_exact(width).zip(density.chunks_exact(width)).zip(pilots.chunks_exact_mut(width));
            for (row, ((base, density), pilots)) in rows.iter_mut().zip(parts) {
                row.plan = Some(RowPlan { first: row.y as usize * width, level: *level, milestone: *milestone, base, density, pilots });
            }
        }
        rows
    }
}

/// One row of a film.
pub(crate) struct Row<'a> {
    pub y: u32,
    layout: &'a FilmLayout,
    sums: &'a mut [f64],
    blocks: &'a mut [BlockSums],
    /// See [`Film::levels`].
    pub level: &'a mut u32,
    plan: Option<RowPlan<'a>>,
}

/// One row of a [`Plan`].
struct RowPlan<'a> {
    /// Number of the first pixel.
    first: usize,
    level: u32,
    milestone: u32,
    base: &'a [u32],
    density: &'a [f32],
    pilots: &'a mut [Pilot],
}

impl Row<'_> {
    /// Samples of pixel `x` at `level`.
    pub(crate) fn count(&self, x: u32, level: u32) -> u32 {
        let x = x as usize;
        self.plan.as_ref().map_or(level, |plan| count(plan.first + x, plan.base[x], plan.density[x], level.saturating_sub(plan.level)))
    }

    /// Adds sample number `sample` to pixel `x`; `record` has one value a channel. False when a value was not finite: the sample
    /// then counts as black, because one NaN would otherwise take the pixel.
    pub(crate) fn add(&mut self, x: u32, sample: u32, record: &[f32]) -> bool {
        let x = x as usize;
        let valid = record.iter().all(|value| value.is_finite());
        let sums = &mut self.sums[x * self.layout.channels..][..self.layout.channels];
        let blocks = &mut self.blocks[x * self.layout.tracked..][..self.layout.tracked];
        for image in &self.layout.images {
            let values = &record[image.offset..image.offset + image.channels];
            if image.combine == Combine::First && sample > 0 {
                continue;
            }
            for (c, &value) in values.iter().enumerate() {
                let value = if valid { value } else { 0.0 };
                sums[image.offset + c] += f64::from(value);
                if let Some(tracked) = image.tracked {
                    blocks[tracked + c].add(sample, value);
                }
            }
        }
        if let Some(coverage) = self.layout.hidden_coverage
            && valid
        {
            sums[coverage] += f64::from(record[coverage]);
        }
        if let Some(plan) = &mut self.plan
            && sample + 1 == plan.milestone
        {
            plan.pilots[x] = Pilot::new(sums, blocks, plan.milestone);
        }
        valid
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layout_gives_every_image_its_own_channels() {
        let layout = FilmLayout::new(&[Aov::Depth, Aov::Visibility("a".into()), Aov::Depth, Aov::Motion]);
        let names: Vec<_> = layout.images.iter().map(|i| (i.name.as_str(), i.offset, i.channels, i.tracked)).collect();
        assert_eq!(names, [("beauty", 0, 3, Some(0)), ("depth", 3, 1, None), ("visibility.a", 4, 1, Some(3)), ("motion", 5, 2, None)]);
        assert_eq!((layout.channels, layout.tracked, layout.coverage), (8, 4, Some(7)));
    }

    #[test]
    fn images_that_memory_cannot_hold_are_refused_before_the_first_sample() {
        let layout = FilmLayout::new(&[]);
        assert!(layout.check_memory(UVec2::new(1280, 720), true).is_ok());
        let error = layout.check_memory(UVec2::MAX, true).unwrap_err().to_string();
        assert!(error.starts_with("image of 4294967295x4294967295 px: ") && error.contains("choose a smaller size"), "{error}");
        // Sums of 3 f64 and blocks; 3 f32 of colour and 3 of variance.
        assert_eq!(layout.bytes(UVec2::ONE), (24 + 3 * size_of::<BlockSums>() + 24) as u64);
    }

    #[test]
    fn an_invalid_sample_is_black_and_reported() {
        let mut film = Film::new(UVec2::ONE, FilmLayout::new(&[]), Fingerprint::default(), false);
        let mut rows = film.rows();
        assert!(rows[0].add(0, 0, &[1.0, 2.0, 3.0]));
        assert!(!rows[0].add(0, 1, &[1.0, f32::NAN, 3.0]));
        assert_eq!(film.sums, [1.0, 2.0, 3.0]);
    }
}
