//! A report with every kind of entry, for tests of the page and the files.

use super::*;

use kajo_image_metrics::{ClassShares, MseDifference, View};

fn comparison(rmse: f64, floor: f64) -> Comparison {
    Comparison {
        rmse,
        mse: rmse * rmse,
        rel_mse: rmse * 0.5,
        psnr: (rmse > 0.0).then(|| -20.0 * rmse.log10()),
        psnr_linear: (rmse > 0.0).then(|| -20.0 * rmse.log10()),
        ssim: Some(1.0 - rmse),
        flip: rmse * 0.8,
        flip_hdr: None,
        mean_ratio: Some(1.0 - 0.3 * rmse),
        identical: rmse == 0.0,
        rmse_floor: Some(floor),
        distinguishable: Some(rmse > 1.2 * floor),
        view: View::FRACTION,
    }
}

fn run(scene: &str, technique: &str, changed: &[(&str, serde_json::Value)], rmse: f64, ms: f64) -> Run {
    let mut params = serde_json::Map::from_iter([("resolution".to_owned(), 2048.into()), ("bias".to_owned(), "auto".into())]);
    params.extend(changed.iter().map(|(k, v)| ((*k).to_owned(), v.clone())));
    Run {
        scene: scene.into(),
        role: "direct-visibility".into(),
        technique: technique.into(),
        title: format!("Technique {technique}"),
        params,
        changed_params: changed.iter().map(|(k, _)| (*k).to_owned()).collect(),
        status: OK.into(),
        error: Some(RunError {
            image: comparison(rmse, 0.0031),
            bias: Some(rmse * 0.9),
            noise: Some(rmse * 0.1),
            bias_floor: Some(0.0015),
            label: Some(if rmse > 0.01 { "biased" } else { "unbiased" }),
            mean_relative_error: Some(-0.3 * rmse),
            mean_relative_error_95: Some(0.001),
            mse_standard_error: 1e-7,
            off_border_mismatch: Some(rmse * 0.05),
            off_border_mismatches: Some((rmse * 9000.0) as u64),
            border_error: Some(rmse * 3.0),
            border_px: Some(rmse * 20.0),
            shadow_classes: Some(ClassConfusion {
                umbra: ClassShares { umbra: 0.2, penumbra: 0.0, lit: 0.1 * rmse },
                penumbra: ClassShares { umbra: 0.04, penumbra: 0.02, lit: 0.04 },
                lit: ClassShares { umbra: 0.0, penumbra: 0.1 * rmse, lit: 0.7 - 0.2 * rmse },
            }),
            lights: vec![LightError { light: "Key".into(), rmse, off_border_mismatch: rmse * 0.05, border_px: Some(rmse * 20.0) }],
            composed: Some(ComposedError {
                against: "direct".into(),
                image: comparison(rmse * 0.5, 0.002),
                approximation_rmse: Some(rmse * 0.4),
                not_simulated_rmse: Some(0.01),
            }),
        }),
        temporal: Temporal {
            flicker: Some(rmse * 0.01),
            lag: Some(if changed.is_empty() { 0.0 } else { 8.0 }),
            ghost: Some(rmse * 0.1),
            still_flicker: Some(rmse * 0.02),
            sequences: ["camera", "light", "object"]
                .map(|motion| SequenceError { motion: motion.into(), flicker: Some(rmse * 0.01), ghost: Some(rmse * 0.1), rmse })
                .to_vec(),
            response: (1..if changed.is_empty() { 2 } else { 10 }).map(|frame| 1.0 - 0.7f64.powi(frame)).collect(),
        },
        cost: Some(Cost {
            gpu_ms: Some(ms),
            gpu_ms_p95: Some(ms * 1.2),
            gpu_ms_per_light: Some(ms / 3.0),
            cpu_ms: ms * 1.6,
            memory_bytes: 16 << 20,
            rays: 0,
            statistics: BTreeMap::from([("polygons".to_owned(), vec![420])]),
        }),
        failures: BTreeMap::from([("acne".to_owned(), 0.01 * rmse), ("leak".to_owned(), 0.02 * rmse), ("missed-penumbra".to_owned(), 0.0)]),
        images: BTreeMap::new(),
    }
}

/// Two scenes; one of them with a skipped technique.
pub fn report() -> Report {
    let mut runs = Vec::new();
    let mut references = Vec::new();
    let mut decisions = Vec::new();
    for (scene, scale) in [("builtin:shadows", 1.0), ("assets/CornellBox.glb", 0.7)] {
        let first = runs.len();
        runs.extend([
            run(scene, "shadow/none", &[], 0.31 * scale, 0.004),
            run(scene, "shadow/map", &[], 0.042 * scale, 0.61),
            run(scene, "shadow/map", &[("resolution", 512.into())], 0.083 * scale, 0.22),
            run(scene, "shadow/pcss", &[], 0.027 * scale, 1.94),
            run(scene, "shadow/volume-zfail", &[], 0.051 * scale, 3.2),
            run(scene, "shadow/ray-traced", &[("samples", 4.into())], 0.012 * scale, 4.4),
            run(scene, "shadow/ray-traced", &[("samples", 64.into())], 0.0033, 41.0),
        ]);
        let candidates: Vec<Candidate> = (first..runs.len())
            .map(|i| {
                let error = &runs[i].error.as_ref().unwrap().image;
                let distinguishable = error.distinguishable.unwrap();
                Candidate { run: i, label: runs[i].label(), mse: error.mse, ms: runs[i].cost.as_ref().unwrap().ms(), distinguishable }
            })
            .collect();
        let difference = |a: usize, b: usize| MseDifference { value: candidates[a].mse - candidates[b].mse, standard_error: 2e-6 };
        decisions.push(decide(scene, "direct-visibility", &candidates, Some(2.0), difference));
        let mut skipped = run(scene, "shadow/ray-query", &[], 0.0, 0.0);
        (skipped.status, skipped.error, skipped.cost) = ("skipped: needs experimental_ray_query".into(), None, None);
        runs.push(skipped);
        references.push(ReferenceEntry {
            scene: scene.into(),
            role: "direct-visibility".into(),
            role_title: "Direct visibility".into(),
            estimates: "(1/A) ∫ V(x, y) dA over each light".into(),
            ambient_distance: None,
            unit: "1, in [0, 1] per light".into(),
            judged_by: vec!["visibility.Key".into()],
            size: [1280, 720],
            spp: 1024,
            relative_standard_error: Some(0.0042),
            rmse_floor: 0.0031,
            seconds: 48.3,
            rays: 1_900_000_000,
            images: BTreeMap::new(),
        });
    }
    Report {
        kajo: "0.1.0".into(),
        command: "kajo compare builtin:shadows assets/CornellBox.glb -o report --role direct-visibility --all --budget-ms 2".into(),
        created: "2026-01-31T12:00:00Z".into(),
        complete: true,
        device: Some(DeviceEntry {
            name: "llvmpipe (LLVM 19.1, 256 bits)".into(),
            driver: "llvmpipe Mesa 25.0".into(),
            kind: "software".into(),
            backend: "vulkan".into(),
            ray_query: true,
            timestamps: true,
        }),
        host: Host { cpu: "Example CPU".into(), threads: 2, os: "linux x86_64".into() },
        settings: Settings {
            frames: 10,
            warm_up_frames: 3,
            repeat: 4,
            budget_ms: Some(2.0),
            seed: 0,
            reference_spp: Some(1024),
            reference_noise: None,
            time: 0.0,
            temporal: 8,
        },
        references,
        runs,
        decisions,
        ignored: vec![kajo_scene::Ignored {
            file: "assets/CornellBox.glb".into(),
            place: "material 3 \"Glass\"".into(),
            feature: "KHR_materials_dispersion".into(),
            consequence: "refraction has no colour fringes".into(),
        }],
        warnings: vec![format!("Times are those of a software adapter: {} ms here says nothing about a GPU.", short(1.94))],
        files: vec!["index.html".into(), "report.json".into(), "table.csv".into()],
    }
}
