//! `kajo bench environment`: what sampling an environment by blocks costs and keeps, beside the inversion of all pixels and alias tables.

use crate::arguments::{BenchEnvironment, Common};
use crate::failure::{Failure, Outcome};
use crate::output;
use glam::Vec2;
use kajo_image::{Image, ToneMap, auto_exposure, tone_map, write_image};
use kajo_image_metrics::{psnr, rmse};
use kajo_sampling::environment::{AlphaPlane, BlockTree, Criterion, DensityImage, EnvironmentError, GridHash, KdSampler, PackedTree};
use kajo_sampling::{Alias2d, Piecewise2d, Rng};
use kajo_scene::{ColorSpace, load_environment};
use kajo_units::{LinearRgb, Srgb8};
use serde_json::{Value, json};
use std::hint::black_box;
use std::time::Instant;

/// Points of each timed round, and rounds; the least counts.
const POINTS: usize = 1 << 16;
const ROUNDS: usize = 16;

/// Builds every sampler of one map, times them on the same random numbers, and rebuilds the map from the blocks.
pub fn run(common: &Common, arguments: &BenchEnvironment) -> Outcome {
    let (environment, _) = load_environment(&arguments.env)?;
    let (Some(map), Some(grid)) = (&environment.image, environment.importance()) else {
        return Err(Failure::run("the environment has no image"));
    };
    let (size, weights) = (grid.size(), grid.pixels());
    let refused = |error: EnvironmentError| Failure::run(format!("{}: {error}", arguments.env.display()));

    let count = arguments.blocks.map_or_else(|| KdSampler::default_count(size), |blocks| blocks as usize);
    let (tree_ms, tree) = timed(|| {
        let density = DensityImage::from_weights(size, weights)?;
        BlockTree::new(&density, count, Criterion::default())
    });
    let tree = tree.map_err(refused)?;
    let (fit_ms, kd) = timed(|| KdSampler::from_tree(&tree));
    let (width, height) = (size.x as usize, size.y as usize);
    let (cdf_ms, cdf) = timed(|| Piecewise2d::new(weights, width, height));
    let (alias_ms, alias) = timed(|| Alias2d::new(weights, width, height));
    let (Some(cdf), Some(alias)) = (cdf, alias) else { return Err(Failure::run("the environment has no pixels")) };
    let (plane, hash, packed) = (AlphaPlane::new(&kd), GridHash::new(&kd), PackedTree::new(&tree).ok());

    let mut rng = Rng::new(1);
    let numbers: Vec<(f32, Vec2)> = (0..POINTS).map(|_| (rng.next_1d(), rng.next_2d())).collect();
    let nanoseconds = |f: &dyn Fn(f32, Vec2) -> f32| {
        let round = || timed(|| numbers.iter().map(|&(xi, u)| f(xi, u)).sum::<f32>());
        (0..ROUNDS).map(|_| round()).map(|(ms, sum)| (ms, black_box(sum)).0).fold(f64::INFINITY, f64::min) * 1e6 / POINTS as f64
    };
    let mut steps = [0u64; 4];
    for &(xi, u) in &numbers {
        kd.sample_counted(xi.into(), u, &mut steps[0]);
        cdf.sample_counted(u, &mut steps[1]);
        hash.density_counted(u, &mut steps[2]);
        if let Some(packed) = &packed {
            packed.density_counted(u, &mut steps[3]);
        }
    }
    let reads = steps.map(|steps| steps as f64 / POINTS as f64);

    let shares: Vec<f64> = tree.ranked_leaves().iter().map(|&leaf| tree.nodes()[leaf as usize].share).collect();
    let pixels: Vec<[f32; 3]> = (0..size.y)
        .flat_map(|y| (0..size.x).map(move |x| (x, y)))
        .map(|(x, y)| map.texel(x, y, ColorSpace::Linear).truncate().into())
        .collect();
    let image = |pixels: &[[f32; 3]]| Image::from_pixels(size, pixels.iter().map(|p| LinearRgb((*p).into())).collect());
    let (original, rebuilt) = (image(&pixels), image(&tree.reconstruct(&pixels)));
    if let Some(path) = &arguments.output {
        let written = write_image(path, &rebuilt, &Default::default())?;
        if written.clamped > 0 && !common.quiet {
            eprintln!("note: {} pixels were clamped to 1; .exr and .hdr keep them", written.clamped);
        }
    }
    let report = json!({
        "width": size.x, "height": size.y, "blocks": tree.leaf_count(),
        "pixels_per_block": f64::from(size.element_product()) / tree.leaf_count() as f64,
        "fit": { "u": kd.law().u(), "total_variation": kd.law().total_variation(&shares) },
        "build_ms": { "kd": tree_ms + fit_ms, "cdf": cdf_ms, "alias": alias_ms },
        "sample_ns": {
            "kd": nanoseconds(&|xi, u| kd.sample(xi.into(), u).1),
            "kd_packed_tree": packed.as_ref().map(|packed| nanoseconds(&|xi, u| packed.sample(xi.into(), u).1)),
            "cdf": nanoseconds(&|_, u| cdf.sample(u).1),
            "alias": nanoseconds(&|_, u| alias.sample(u).1),
        },
        "sample_reads": { "kd": reads[0], "cdf": reads[1] },
        "density_ns": {
            "alpha_channel": nanoseconds(&|_, u| plane.density(u)),
            "grid_hash": nanoseconds(&|_, u| hash.density(u)),
            "packed_tree": packed.as_ref().map(|packed| nanoseconds(&|_, u| packed.density(u))),
            "cdf": nanoseconds(&|_, u| cdf.pdf(u)),
        },
        "density_reads": { "alpha_channel": 1, "grid_hash": reads[2], "packed_tree": packed.as_ref().map(|_| reads[3]) },
        "bytes": {
            "kd": kd.bytes(), "alpha_channel": plane.bytes(), "grid_hash": hash.bytes(), "packed_tree": packed.as_ref().map(PackedTree::bytes),
            "cdf": cdf.bytes(), "cdf_cumulative": cdf.cumulative_bytes(), "alias": alias.bytes(),
        },
        "memory_ratio": cdf.cumulative_bytes() as f64 / kd.bytes() as f64,
        "reconstruction": {
            "psnr_db": psnr(&display(&rebuilt, &original), &display(&original, &original), 1.0)?,
            "rmse": rmse(&rebuilt, &original)?,
        },
    });
    if common.json { output::json(&report) } else { output::text(&as_text("", &report)) }
}

/// Milliseconds of a piece of work, and its result.
fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = black_box(work());
    (start.elapsed().as_secs_f64() * 1e3, result)
}

/// Display values in [0, 1] at the exposure of `of`: clamped, with the transfer curve of sRGB. What the peak signal-to-noise ratio is taken of.
fn display(image: &Image<LinearRgb>, of: &Image<LinearRgb>) -> Image<LinearRgb> {
    let encoded = |pixel: &Srgb8| LinearRgb(glam::Vec3::from_array(pixel.0.map(f32::from)) / 255.0);
    tone_map(image, auto_exposure(of), ToneMap::Linear).map(encoded)
}

/// One line a number, `group.name value`.
fn as_text(prefix: &str, value: &Value) -> String {
    match value {
        Value::Object(fields) => fields
            .iter()
            .map(|(key, value)| as_text(&if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") }, value))
            .collect(),
        Value::Number(number) if !number.is_u64() => format!("{prefix:<28}{:.4}\n", number.as_f64().unwrap_or(f64::NAN)),
        other => format!("{prefix:<28}{other}\n"),
    }
}
