//! Timing of the build and of rays, on any triangles and rays.

use crate::{
    blas::Blas,
    build::{BuildOptions, BuildQuality},
    error::BvhError,
    lanes::Backend,
    ray::{Filter, Ray},
    tlas::Tlas,
};
use glam::Vec3;
use rayon::prelude::*;
use std::time::Instant;

/// What to time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RayBenchOptions {
    /// Ask whether anything is hit instead of what is hit first.
    pub any_hit: bool,
    /// Trace each ray by itself instead of letting neighbours share a walk where they are alike.
    pub one_at_a_time: bool,
    /// What the build spends its time on.
    pub quality: BuildQuality,
    /// Threads of the build and of tracing; 0 for one a core.
    pub threads: usize,
    /// How often to build and to trace; at least once.
    pub repeat: usize,
}

impl Default for RayBenchOptions {
    fn default() -> Self {
        Self { any_hit: false, one_at_a_time: false, quality: BuildQuality::default(), threads: 0, repeat: 5 }
    }
}

/// What came out. Times are the best of the repeats (the least disturbed one); medians stand beside them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayBenchReport {
    /// Triangles given.
    pub triangles: usize,
    /// Rays given.
    pub rays: usize,
    /// Threads used.
    pub threads: usize,
    /// Instructions used.
    pub backend: Backend,
    /// Time of the build, ms.
    pub build_ms: f64,
    /// Median time of the build, ms.
    pub build_ms_median: f64,
    /// Expected work of a ray by the surface area heuristic, nodes and blocks of triangles at 1 each: [`Blas::sah_cost`].
    pub sah_cost: f64,
    /// Memory of the hierarchy, bytes a triangle.
    pub bytes_per_triangle: f64,
    /// Rays a microsecond.
    pub mrays_per_s: f64,
    /// Median of the same.
    pub mrays_per_s_median: f64,
    /// Rays that hit something.
    pub hits: usize,
    /// Sum of the hit distances, in lengths of the rays' directions; 0 for any-hit, which has none.
    pub t_sum: f64,
}

/// Rays that one task traces.
const CHUNK: usize = 2048;

/// Builds over `triangles` and traces `rays`, `repeat` times each.
///
/// # Errors
/// Those of [`Blas::build`].
///
/// # Panics
/// If the operating system gives no threads.
pub fn bench_rays(triangles: &[[Vec3; 3]], rays: &[Ray], options: &RayBenchOptions) -> Result<RayBenchReport, BvhError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build().expect("threads");
    pool.install(|| run(triangles, rays, options))
}

fn run(triangles: &[[Vec3; 3]], rays: &[Ray], options: &RayBenchOptions) -> Result<RayBenchReport, BvhError> {
    let repeat = options.repeat.max(1);
    let positions: &[Vec3] = triangles.as_flattened();
    let indices: Vec<[u32; 3]> = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mut build_seconds = Vec::new();
    let mut blas = None;
    for _ in 0..repeat {
        let start = Instant::now();
        blas = Some(Blas::build(positions, &indices, &BuildOptions::of(options.quality))?);
        build_seconds.push(start.elapsed().as_secs_f64());
    }
    let tlas = Tlas::single(blas.expect("at least one build"));

    let mut trace_seconds = Vec::new();
    let (mut hits, mut t_sum) = (0, 0.0);
    for _ in 0..repeat {
        let start = Instant::now();
        (hits, t_sum) = if options.any_hit { (any_hits(&tlas, rays, options), 0.0) } else { closest_hits(&tlas, rays, options) };
        trace_seconds.push(start.elapsed().as_secs_f64());
    }
    let (build, build_median) = best_and_median(build_seconds);
    let (trace, trace_median) = best_and_median(trace_seconds);
    let rate = |seconds: f64| if rays.is_empty() { 0.0 } else { rays.len() as f64 / seconds.max(1e-9) / 1e6 };
    Ok(RayBenchReport {
        triangles: triangles.len(),
        rays: rays.len(),
        threads: rayon::current_num_threads(),
        backend: tlas.backend(),
        build_ms: build * 1e3,
        build_ms_median: build_median * 1e3,
        sah_cost: tlas.blases()[0].sah_cost(1.0).into(),
        bytes_per_triangle: tlas.memory() as f64 / triangles.len().max(1) as f64,
        mrays_per_s: rate(trace),
        mrays_per_s_median: rate(trace_median),
        hits,
        t_sum,
    })
}

/// Hits, and the sum of their distances in the order of the rays: the same at any number of threads.
fn closest_hits(tlas: &Tlas, rays: &[Ray], options: &RayBenchOptions) -> (usize, f64) {
    let trace = |rays: &[Ray]| {
        let mut hits = [None; CHUNK];
        let hits = &mut hits[..rays.len()];
        if options.one_at_a_time {
            rays.iter().zip(&mut *hits).for_each(|(ray, hit)| *hit = tlas.closest_hit_opaque(ray, Filter::ALL));
        } else {
            tlas.closest_hits(rays, Filter::ALL, |_, _| true, hits);
        }
        hits.iter().flatten().fold((0, 0.0), |(hits, sum), hit| (hits + 1, sum + f64::from(hit.t)))
    };
    let parts: Vec<(usize, f64)> = rays.par_chunks(CHUNK).map(trace).collect();
    parts.into_iter().fold((0, 0.0), |(hits, sum), part| (hits + part.0, sum + part.1))
}

fn any_hits(tlas: &Tlas, rays: &[Ray], options: &RayBenchOptions) -> usize {
    let trace = |rays: &[Ray]| {
        let mut hits = [false; CHUNK];
        let hits = &mut hits[..rays.len()];
        if options.one_at_a_time {
            rays.iter().zip(&mut *hits).for_each(|(ray, hit)| *hit = tlas.any_hit_opaque(ray, Filter::ALL));
        } else {
            tlas.any_hits(rays, Filter::ALL, |_, _| true, hits);
        }
        hits.iter().filter(|&&hit| hit).count()
    };
    rays.par_chunks(CHUNK).map(trace).sum()
}

fn best_and_median(mut seconds: Vec<f64>) -> (f64, f64) {
    seconds.sort_by(f64::total_cmp);
    (seconds[0], seconds[seconds.len() / 2])
}

/// Triangles from little-endian single-precision numbers, nine each. `None` if bytes are left over.
pub fn triangles_from_bytes(bytes: &[u8]) -> Option<Vec<[Vec3; 3]>> {
    let numbers = numbers(bytes)?;
    let (triangles, rest) = numbers.as_chunks::<9>();
    rest.is_empty().then(|| {
        let vertex = |n: &[f32; 9], i: usize| Vec3::new(n[3 * i], n[3 * i + 1], n[3 * i + 2]);
        triangles.iter().map(|n| [vertex(n, 0), vertex(n, 1), vertex(n, 2)]).collect()
    })
}

/// Rays from little-endian single-precision numbers, eight each: origin, direction, t_min, t_max. `None` if bytes are left over.
pub fn rays_from_bytes(bytes: &[u8]) -> Option<Vec<Ray>> {
    let numbers = numbers(bytes)?;
    let (rays, rest) = numbers.as_chunks::<8>();
    rest.is_empty().then(|| {
        let ray =
            |n: &[f32; 8]| Ray { origin: Vec3::new(n[0], n[1], n[2]), direction: Vec3::new(n[3], n[4], n[5]), t_min: n[6], t_max: n[7] };
        rays.iter().map(ray).collect()
    })
}

fn numbers(bytes: &[u8]) -> Option<Vec<f32>> {
    let (numbers, rest) = bytes.as_chunks::<4>();
    rest.is_empty().then(|| numbers.iter().map(|&n| f32::from_le_bytes(n)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_wrong_length_are_refused() {
        let ones = |count: usize| 1.0f32.to_le_bytes().repeat(count);
        assert_eq!(triangles_from_bytes(&ones(18)), Some(vec![[Vec3::ONE; 3]; 2]));
        assert_eq!(rays_from_bytes(&ones(8)), Some(vec![Ray { origin: Vec3::ONE, t_min: 1.0, direction: Vec3::ONE, t_max: 1.0 }]));
        assert_eq!(triangles_from_bytes(&[]), Some(vec![]));
        assert!(triangles_from_bytes(&ones(17)).is_none() && rays_from_bytes(&ones(9)).is_none() && rays_from_bytes(&[0; 33]).is_none());
    }

    #[test]
    fn the_report_depends_neither_on_threads_nor_on_packets() {
        let triangles: Vec<[Vec3; 3]> =
            (0..500).map(|i| [Vec3::new(0.0, 0.0, i as f32), Vec3::new(9.0, 0.0, i as f32), Vec3::new(0.0, 9.0, i as f32)]).collect();
        let rays: Vec<Ray> = (0..10_000)
            .map(|i| Ray::new(Vec3::new((i % 97) as f32 * 0.1, (i % 89) as f32 * 0.1, (i % 501) as f32 - 0.5), Vec3::new(0.01, 0.02, 1.0)))
            .collect();
        let report = |threads, any_hit, one_at_a_time| {
            bench_rays(&triangles, &rays, &RayBenchOptions { any_hit, one_at_a_time, threads, repeat: 2, ..RayBenchOptions::default() })
                .unwrap()
        };
        let (one, three, any) = (report(1, false, false), report(3, false, true), report(2, true, false));
        assert_eq!((one.threads, three.threads, any.threads), (1, 3, 2));
        assert_eq!((one.hits, one.t_sum), (three.hits, three.t_sum));
        assert_eq!((any.hits, any.t_sum), (one.hits, 0.0));
        for quality in BuildQuality::ALL {
            let report = bench_rays(&triangles, &rays, &RayBenchOptions { quality, repeat: 1, ..RayBenchOptions::default() }).unwrap();
            assert_eq!((report.hits, report.t_sum), (one.hits, one.t_sum), "{quality:?}");
        }
        assert!(one.hits > 2_000 && one.hits < 10_000 && one.build_ms <= one.build_ms_median && one.mrays_per_s >= one.mrays_per_s_median);
    }
}
