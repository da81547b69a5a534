use super::*;
use crate::report::example::report;
use glam::UVec2;

fn pictures(report: &Report) -> Pictures {
    let size = UVec2::new(320, 180);
    let shadow = |shift: f32, soft: f32| {
        Image::from_fn(size, |x, y| {
            let d = ((x as f32 - 150.0 - shift) / 70.0).hypot((y as f32 - 90.0) / 40.0);
            let v = ((d - 1.0) / soft + 0.5).clamp(0.0, 1.0) * (0.4 + 0.6 * (y as f32 / 180.0));
            kajo_units::LinearRgb::splat(v).to_srgb8()
        })
    };
    let reference = shadow(0.0, 0.2);
    let run = |i: usize| {
        let image = shadow(i as f32 * 1.5, 0.02 + 0.05 * i as f32);
        let error = Image::from_fn(size, |x, y| (f32::from(image.get(x, y).0[0]) - f32::from(reference.get(x, y).0[0])).abs() / 255.0);
        let heat = kajo_image_metrics::heat_map(&error, 0.5, kajo_image_metrics::Palette::Magma);
        let crops = kajo_image_metrics::worst_crops(&error, 32, 3);
        RunPictures {
            composed: Some(image.clone()),
            crops: crops
                .iter()
                .map(|c| CropPictures { at: [c.x, c.y], images: [&image, &reference, &heat].map(|i| kajo_image_metrics::crop(i, c)) })
                .collect(),
            image,
            heat,
            heat_scale: "black 0, pale yellow 0.5".into(),
            failures: Some(image_of_failures(size)),
            films: vec![crate::temporal::Film {
                motion: "light",
                at: [30, 20],
                frames: vec![1, 2, 3],
                image: image_of_failures(UVec2::new(124, 124)),
            }],
        }
    };
    Pictures {
        references: report
            .references
            .iter()
            .map(|_| Some(ReferencePictures { image: reference.clone(), composed: Some(reference.clone()) }))
            .collect(),
        runs: report.runs.iter().enumerate().map(|(i, r)| r.is_ok().then(|| run(i % 8))).collect(),
    }
}

fn image_of_failures(size: UVec2) -> Image<kajo_units::Srgb8> {
    let classes = crate::failures::Class::ALL;
    Image::from_fn(size, |x, _| classes[(x as usize * classes.len()) / size.x as usize].color())
}

/// Opens and closes in order; void elements have no end. Returns the number of elements.
fn well_formed(html: &str) -> usize {
    const VOID: [&str; 4] = ["meta", "img", "input", "br"];
    let mut open: Vec<&str> = Vec::new();
    let mut count = 0;
    let mut rest = html;
    while let Some(start) = rest.find('<') {
        let tag = &rest[start + 1..start + rest[start..].find('>').unwrap()];
        rest = &rest[start + tag.len() + 2..];
        let name = tag.trim_start_matches('/').split([' ', '\n']).next().unwrap();
        if let Some(closed) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed), "near {}", &rest[..rest.len().min(80)]);
        } else if !tag.starts_with('!') && !VOID.contains(&name) {
            open.push(name);
            count += 1;
            if name == "script" || name == "style" {
                rest = &rest[rest.find(&format!("</{name}>")).unwrap()..];
            }
        }
    }
    assert!(open.is_empty(), "{open:?}");
    count
}

#[test]
fn page_is_one_well_formed_file_that_loads_nothing() {
    let report = report();
    let html = page(&report, &pictures(&report));
    assert!(well_formed(&html) > 500);
    for address in ["http://", "https://", "//cdn", "@import", "url("] {
        assert!(!html.contains(address), "{address}");
    }
    assert!(html.contains(POLICY), "the page forbids itself to load anything");
}

#[test]
fn everything_that_was_asked_for_is_on_the_page() {
    let report = report();
    let html = page(&report, &pictures(&report));
    let said = [
        "Use shadow/pcss for direct visibility",
        "not distinguishable",
        "skipped: needs experimental_ray_query",
        "KHR_materials_dispersion",
        "llvmpipe Mesa 25.0",
        "kajo compare builtin:shadows",
        "1024",
        "48.3 s",
        "resolution=512",
        "budget 2 ms",
        "software adapter",
        "Behaviour over time",
        "8 frames behind",
        "What moves: light. Frames 1, 2, 3 where they flicker most (column 30, row 20, 2×)",
        "What techniques count",
        "How shadows fail",
        "Umbra, penumbra and light",
    ];
    for text in said {
        assert!(html.contains(text), "{text}");
    }
    assert_eq!(html.matches("class=\"split\"").count(), 2, "a slider for each scene");
}

#[test]
fn names_from_files_cannot_become_markup() {
    let mut report = report();
    for run in &mut report.runs {
        run.scene = "<script>alert(1)</script>".into();
    }
    for entry in &mut report.references {
        entry.scene = "<script>alert(1)</script>".into();
    }
    assert!(!page(&report, &Pictures::default()).contains("<script>alert"));
}

#[test]
fn empty_and_interrupted_reports_have_a_page() {
    let mut empty = Report { kajo: "0".into(), complete: false, ..Report::default() };
    assert!(page(&empty, &Pictures::default()).contains("Interrupted."));
    empty.references.push(Default::default());
    well_formed(&page(&empty, &Pictures::default()));
}

/// Writes the page to `$KAJO_REPORT_EXAMPLE` to look at it.
#[test]
fn example_page_can_be_written() {
    let report = report();
    let html = page(&report, &pictures(&report));
    if let Some(path) = std::env::var_os("KAJO_REPORT_EXAMPLE") {
        std::fs::write(path, &html).unwrap();
    }
    assert!(html.len() > 100_000);
}
