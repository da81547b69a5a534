//! `kajo bench rays`: how fast the hierarchy is built and traced, on given triangles and rays.

use crate::arguments::{BenchRays, Common, Quality};
use crate::failure::{Failure, Outcome};
use crate::output;
use glam::Vec3;
use kajo_bvh::bench::{RayBenchOptions, RayBenchReport, bench_rays, rays_from_bytes, triangles_from_bytes};
use kajo_bvh::{BuildQuality, Ray};
use kajo_image::read_file;
use serde_json::json;
use std::path::Path;

/// Times rays; the JSON also says what was traced, so that two programs can be seen to have answered the same question.
pub fn run(common: &Common, arguments: &BenchRays) -> Outcome {
    let triangles = read(&arguments.triangles, "triangles", 9, triangles_from_bytes)?;
    let rays = read(&arguments.rays, "rays", 8, rays_from_bytes)?;
    if let Some(index) = rays.iter().position(|ray| !is_ray(ray)) {
        let path = arguments.rays.display();
        return Err(Failure::run(format!("{path}: ray {index} has a number that is not finite, or no direction; mend or drop it")));
    }
    let options = RayBenchOptions {
        any_hit: arguments.any_hit,
        one_at_a_time: arguments.one_at_a_time,
        quality: match arguments.build_quality {
            Quality::Fast => BuildQuality::Fast,
            Quality::Balanced => BuildQuality::Balanced,
            Quality::High => BuildQuality::High,
        },
        threads: arguments.threads.map_or(0, usize::from),
        repeat: arguments.repeat as usize,
    };
    let report = bench_rays(&triangles, &rays, &options)?;
    if common.json { output::json(&as_json(&report, &options)) } else { output::text(&as_text(&report)) }
}

/// Only the end of a ray may be infinite.
fn is_ray(ray: &Ray) -> bool {
    ray.origin.is_finite() && ray.direction.is_finite() && ray.direction != Vec3::ZERO && ray.t_min.is_finite() && !ray.t_max.is_nan()
}

fn read<T>(path: &Path, what: &str, each: usize, parse: impl Fn(&[u8]) -> Option<Vec<T>>) -> Outcome<Vec<T>> {
    let bytes = read_file(path).map_err(|reason| Failure::run(format!("cannot read the {what} {}: {reason}", path.display())))?;
    if bytes.is_empty() {
        return Err(Failure::run(format!("{} is empty: there are no {what} to time", path.display())));
    }
    parse(&bytes).ok_or_else(|| {
        Failure::run(format!(
            "{} has {} bytes, which is no whole number of {what} of {each} little-endian f32 ({} bytes)",
            path.display(),
            bytes.len(),
            4 * each
        ))
    })
}

fn as_json(report: &RayBenchReport, options: &RayBenchOptions) -> serde_json::Value {
    json!({
        "triangles": report.triangles, "rays": report.rays, "any_hit": options.any_hit, "one_at_a_time": options.one_at_a_time,
        "threads": report.threads, "backend": format!("{:?}", report.backend).to_lowercase(), "repeat": options.repeat,
        "build_quality": options.quality.name(), "sah_cost": report.sah_cost, "build_ms": report.build_ms, "build_ms_median": report.build_ms_median, "bytes_per_triangle": report.bytes_per_triangle,
        "mrays_per_s": report.mrays_per_s, "mrays_per_s_median": report.mrays_per_s_median,
        "hits": report.hits, "t_sum": report.t_sum,
    })
}

fn as_text(report: &RayBenchReport) -> String {
    let line = |name: &str, value: String| format!("{name:<18}{value}\n");
    [
        line("triangles", report.triangles.to_string()),
        line("rays", report.rays.to_string()),
        line("threads", format!("{} ({:?})", report.threads, report.backend)),
        line("build, ms", format!("{:.2} (median {:.2})", report.build_ms, report.build_ms_median)),
        line("SAH cost", format!("{:.3}", report.sah_cost)),
        line("bytes a triangle", format!("{:.1}", report.bytes_per_triangle)),
        line("Mrays/s", format!("{:.3} (median {:.3})", report.mrays_per_s, report.mrays_per_s_median)),
        line("hits", report.hits.to_string()),
        line("sum of t", format!("{:.6}", report.t_sum)),
    ]
    .concat()
}
