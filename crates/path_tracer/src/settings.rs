//! What to render, and how long.

use crate::{Aov, Filter, PathTracerError};
use glam::UVec2;
use kajo_sampling::SamplerKind;
use std::str::FromStr;
use std::time::Duration;

/// Everything that decides which picture is rendered; two renderings with equal settings are equal bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Width and height, px.
    pub size: UVec2,
    /// The camera, by name or by index.
    pub camera: CameraChoice,
    /// What the image `beauty` is.
    pub integrator: Integrator,
    /// Largest number of surface bounces of a path: 0 shows emitters only, 1 adds direct light, 2 one indirect bounce, and so on.
    pub max_depth: u32,
    /// How direct light is found.
    pub strategy: Strategy,
    /// When paths end by chance.
    pub russian_roulette: RussianRoulette,
    /// The random numbers.
    pub sampler: SamplerKind,
    /// Pixel filter.
    pub filter: Filter,
    /// Chooses among equally good sets of random numbers.
    pub seed: u64,
    /// Images besides `beauty`.
    pub aovs: Vec<Aov>,
    /// Longest ray of ambient occlusion, m (integrator `ao` and image `ambient-visibility`); infinite asks for the open sky.
    pub ambient_distance: f32,
    /// Move the start of rays off coarse smooth-shaded meshes, so that the facets cast no shadow on themselves.    \[Hanika21]
    pub smooth_terminator: bool,
    /// After 16 samples per pixel, more go where noise is, by what the neighbours of each pixel have seen: the mean of every pixel stays
    /// unbiased. Noise goals are reached with fewer samples, but the error of one pixel no longer says much about that of another, so references
    /// that others are judged by are sampled evenly. The image [`Aov::Samples`] shows where they went.    \[Kirk91], \[Neyman34]
    pub adaptive: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            size: UVec2::new(1280, 720),
            camera: CameraChoice::default(),
            integrator: Integrator::default(),
            max_depth: 32,
            strategy: Strategy::default(),
            russian_roulette: RussianRoulette::default(),
            sampler: SamplerKind::default(),
            filter: Filter::default(),
            seed: 0,
            aovs: Vec::new(),
            ambient_distance: f32::INFINITY,
            smooth_terminator: true,
            adaptive: false,
        }
    }
}

impl Settings {
    /// Largest width or height, px.
    pub const MAX_SIDE: u32 = 1 << 16;

    /// Checks the ranges of all numbers.
    ///
    /// # Errors
    /// [`PathTracerError::Size`] and [`PathTracerError::Range`].
    pub fn validate(&self) -> Result<(), PathTracerError> {
        let UVec2 { x: width, y: height } = self.size;
        if width == 0 || height == 0 || width > Self::MAX_SIDE || height > Self::MAX_SIDE {
            return Err(PathTracerError::Size { width, height, max: Self::MAX_SIDE });
        }
        if self.ambient_distance.is_nan() || self.ambient_distance <= 0.0 {
            return Err(PathTracerError::Range { what: "ambient distance", got: self.ambient_distance.into(), range: "(0, inf]" });
        }
        if self.adaptive && matches!(self.sampler, SamplerKind::BlueNoise { .. }) {
            return Err(PathTracerError::AdaptiveBlueNoise);
        }
        if let RussianRoulette::Constant(q) = self.russian_roulette
            && !(q > 0.0 && q <= 1.0)
        {
            return Err(PathTracerError::Range { what: "survival probability", got: q.into(), range: "(0, 1]" });
        }
        Ok(())
    }
}

/// Which camera of the scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CameraChoice {
    /// Index into the snapshot's cameras.
    Index(usize),
    /// Name of a camera; the first one that has it.
    Name(String),
}

impl Default for CameraChoice {
    fn default() -> Self {
        Self::Index(0)
    }
}

impl From<&str> for CameraChoice {
    /// A whole number is an index, everything else a name.
    fn from(s: &str) -> Self {
        s.parse().map_or_else(|_| Self::Name(s.into()), Self::Index)
    }
}

/// What the image `beauty` shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Integrator {
    /// Full transport: next-event estimation and BSDF sampling, combined by the power heuristic.
    #[default]
    Path,
    /// The same with at most one bounce.
    Direct,
    /// Full transport by BSDF sampling alone, written independently of `Path`: the check of the judge. It cannot see point, spot
    /// and parallel lights.
    BsdfOnly,
    /// Ambient visibility (1/π) ∫ V cos θ dω by cosine-distributed rays.    \[Zhukov98]
    Ao,
    /// Mean of V over uniformly distributed directions of the hemisphere, 1/2π ∫ V dω.
    AoUniform,
    /// Base colour at the first hit.
    Albedo,
    /// Shading normal at the first hit, each component n mapped to (n + 1)/2.
    Normal,
}

impl Integrator {
    /// Every integrator with its name.
    pub const ALL: [(&'static str, Self); 7] = [
        ("path", Self::Path),
        ("direct", Self::Direct),
        ("bsdf-only", Self::BsdfOnly),
        ("ao", Self::Ao),
        ("ao-uniform", Self::AoUniform),
        ("albedo", Self::Albedo),
        ("normal", Self::Normal),
    ];
}

impl FromStr for Integrator {
    type Err = PathTracerError;

    fn from_str(s: &str) -> Result<Self, PathTracerError> {
        Self::ALL.iter().find(|(name, _)| *name == s).map(|&(_, integrator)| integrator).ok_or_else(|| PathTracerError::Choice {
            what: "integrator",
            got: s.into(),
            known: Self::ALL.map(|(name, _)| name).join(", "),
        })
    }
}

/// How the integrators `path` and `direct` find direct light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Strategy {
    /// Light sampling and BSDF sampling, combined by the power heuristic; a path divides in two at a first surface that is no mirror.
    #[default]
    Mis,
    /// Light sampling alone, the textbook's: one direction and one shadow ray a surface. Emitters are seen directly and by perfect mirrors and glass. Fewer
    /// rays, much noise on shiny surfaces.
    Lights,
}

impl Strategy {
    /// Every strategy with its name.
    pub const ALL: [(&'static str, Self); 2] = [("mis", Self::Mis), ("lights", Self::Lights)];
}

/// How light sampling draws directions towards an environment with an image; a choice of the [`Tracer`](crate::Tracer), which holds the table.
///
/// All three are unbiased and converge to the same picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum EnvironmentSampler {
    /// Inversion of the cumulative distribution of the pixels: O(log pixels), and neighbouring random numbers stay neighbours, which keeps
    /// Sobol points well stratified over the image.
    #[default]
    Cdf,
    /// Alias tables, rows first: O(1).
    Alias,
    /// Blocks of a kd-tree, one for 170 pixels, chosen by a formula: O(1) and little memory.    \[Ergun15]
    Kd,
}

impl EnvironmentSampler {
    /// Every sampler with its name.
    pub const ALL: [(&'static str, Self); 3] = [("cdf", Self::Cdf), ("alias", Self::Alias), ("kd", Self::Kd)];
}

/// How light sampling chooses among the lights; a choice of the [`Tracer`](crate::Tracer), which holds the tables.
///
/// All are unbiased and converge to the same picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LightSampler {
    /// A tree over all lights and emissive triangles, by how much light can arrive at the surface.    \[Estevez18]
    /// Where an image of light is among them, or a light at infinity among others, two candidates are drawn at the first surface, of which one is kept by
    /// how much unshadowed light it reflects to the viewer.    \[Talbot05]
    #[default]
    Bvh,
    /// By power, wherever the surface is; a tenth of the choices ignores power, too.
    Power,
    /// Every light and emissive triangle alike.
    Uniform,
    /// Candidates by the tree, of which one is kept by how much unshadowed light it reflects to the viewer: knows gloss and colours, at the cost of a look
    /// at each.    \[Talbot05]
    Ris {
        /// Number of candidates; 0 counts as 1.
        candidates: u32,
    },
}

impl LightSampler {
    /// Every sampler with its name.
    pub const ALL: [(&'static str, Self); 4] =
        [("bvh", Self::Bvh), ("power", Self::Power), ("uniform", Self::Uniform), ("ris", Self::Ris { candidates: 4 })];

    /// True where lights are chosen by the tree.
    pub(crate) fn uses_tree(self) -> bool {
        matches!(self, Self::Bvh | Self::Ris { .. })
    }
}

/// Ending of paths by chance: a path goes on with probability q, and what it finds is divided by q.    \[Arvo90]
///
/// Unbiased for every q in (0, 1]; it trades noise for time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum RussianRoulette {
    /// Paths end at the depth limit only.
    Off,
    /// From the second bounce on, or the third where the second is a mirror or clear glass, q is twice the largest channel of the path's
    /// throughput, at most 1; from the eighth on at most 0.95.
    #[default]
    Throughput,
    /// q at every bounce.
    Constant(f32),
}

impl RussianRoulette {
    /// First bounce at which [`RussianRoulette::Throughput`] may end a path: direct light needs the first.
    const START: u32 = 2;
    /// The same for a bounce that has one direction: straight through a body of glass, light has no noise but what roulette would add.
    const START_STRAIGHT: u32 = 3;
    /// Survival over throughput. More paths live, at less than the noise of ending them early costs: docs/performance.md, Roulette.
    const FACTOR: f32 = 2.0;
    /// Bright paths in a closed white room still end, but only when they are long.
    const LONG: u32 = 8;
    const MAX_SURVIVAL: f32 = 0.95;

    /// Probability that a path that has bounced `bounces` times, the last time in the one direction there was if `straight`, goes on.
    #[inline]
    pub(crate) fn survival(self, bounces: u32, straight: bool, throughput_max: f32) -> f32 {
        match self {
            Self::Off => 1.0,
            Self::Throughput if bounces < if straight { Self::START_STRAIGHT } else { Self::START } => 1.0,
            Self::Throughput => {
                let most = if bounces < Self::LONG { 1.0 } else { Self::MAX_SURVIVAL };
                (Self::FACTOR * throughput_max).min(most)
            }
            Self::Constant(q) => q,
        }
    }
}

/// When to stop; the first condition that holds ends the rendering.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stop {
    /// Samples per pixel, those of a resumed film included.
    pub spp: Option<u32>,
    /// Wall-clock time of this run. It is looked at between passes, whose length is chosen to fit; the first pass is always made.
    /// The search for highlights counts.
    pub time: Option<Duration>,
    /// Relative standard error of the image, see [`Frame::relative_standard_error`](crate::Frame::relative_standard_error).
    pub noise: Option<f32>,
}

impl Stop {
    /// After `spp` samples per pixel.
    pub fn at_spp(spp: u32) -> Self {
        Self { spp: Some(spp), ..Self::default() }
    }

    /// After `time`.
    pub fn at_time(time: Duration) -> Self {
        Self { time: Some(time), ..Self::default() }
    }

    /// When the relative standard error is at most `error`.
    pub fn at_noise(error: f32) -> Self {
        Self { noise: Some(error), ..Self::default() }
    }

    pub(crate) fn validate(&self) -> Result<(), PathTracerError> {
        if let Some(noise) = self.noise
            && !(noise > 0.0 && noise.is_finite())
        {
            return Err(PathTracerError::Range { what: "noise level", got: noise.into(), range: "(0, inf)" });
        }
        if self.spp == Some(0) {
            return Err(PathTracerError::Range { what: "samples per pixel", got: 0.0, range: "1 ..= 4294967295" });
        }
        if *self == Self::default() { Err(PathTracerError::EndlessStop) } else { Ok(()) }
    }
}
