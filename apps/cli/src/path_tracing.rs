//! From the words of the command line to the path tracer's settings: shared by `render` and `bench render`.

use crate::arguments::{SamplerChoice, Tracing};
use crate::failure::Outcome;
use glam::UVec2;
use kajo_path_tracer::{CameraChoice, PathTracerError, RussianRoulette, Settings, Tracer};
use kajo_sampling::SamplerKind;
use kajo_scene::{Scene, Snapshot};

/// Samples per pixel when no stop is given.
pub const DEFAULT_SPP: u32 = 64;

/// The tracer of a scene at a time.
///
/// # Errors
/// Those of [`Tracer::new`] and [`Tracer::with_environment_sampler`].
pub fn tracer(scene: &Scene, snapshot: Snapshot, tracing: &Tracing) -> Result<Tracer, PathTracerError> {
    let tracer = Tracer::new(scene, snapshot)?.with_environment_sampler(tracing.env_sampler.unwrap_or_default())?;
    Ok(tracer.with_light_sampler(tracing.light_sampler.unwrap_or_default()))
}

/// Settings of a picture that is to have `spp` samples per pixel.
pub fn settings(tracing: &Tracing, size: UVec2, camera: usize, spp: u32) -> Settings {
    Settings {
        size,
        camera: CameraChoice::Index(camera),
        max_depth: max_depth(tracing),
        strategy: tracing.strategy.unwrap_or_default(),
        russian_roulette: if tracing.no_rr { RussianRoulette::Off } else { RussianRoulette::default() },
        sampler: match tracing.sampler.unwrap_or(SamplerChoice::Sobol) {
            SamplerChoice::Sobol => SamplerKind::Sobol,
            SamplerChoice::Independent => SamplerKind::Independent,
            SamplerChoice::BlueNoise => SamplerKind::BlueNoise { log2_samples: spp.next_power_of_two().ilog2() },
        },
        filter: tracing.filter.unwrap_or_default(),
        seed: tracing.seed,
        ..Settings::default()
    }
}

/// Longest path, in surface bounces.
pub fn max_depth(tracing: &Tracing) -> u32 {
    tracing.max_depth.unwrap_or(Settings::default().max_depth)
}

/// Works with so many threads, all by default.
///
/// # Errors
/// A system that starts no threads.
pub fn in_pool<T: Send>(threads: Option<u16>, work: impl FnOnce() -> T + Send) -> Outcome<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, usize::from)).build()?;
    Ok(pool.install(work))
}
