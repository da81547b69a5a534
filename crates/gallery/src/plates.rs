//! What stands on the page: plates, in sections.

use crate::GalleryError;
use crate::check::Check;
use crate::stage::{Ball, Stage, Sun};
use crate::studio::{Names, Shown, Studio, stacked};
use crate::survey::SphereFigure;
use glam::UVec2;
use kajo_bsdf_lab::figures::survey_figure;
use kajo_image::Image;
use kajo_path_tracer::Settings;
use kajo_units::LinearRgb;

/// A figure with everything that belongs to it.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub struct Plate {
    /// The stem of its files and its place on the page.
    pub id: String,
    /// What it shows.
    pub title: String,
    /// What to look at.
    pub caption: String,
    /// Models and parameters where the caption does not say them.
    pub parameters: Vec<String>,
    /// The pictures.
    pub shown: Vec<Shown>,
    /// The numbers.
    pub checks: Vec<Check>,
}

impl Plate {
    /// Without pictures and numbers yet.
    pub fn new(id: &str, title: &str, caption: &str) -> Self {
        Self { id: id.into(), title: title.into(), caption: caption.into(), ..Self::default() }
    }
}

/// Height of a row of spheres in a picture, m.
const HEIGHT: f32 = 2.6;
/// Of the camera and the light of the pictures, degrees.
const RAISED: f32 = 14.0;
/// From the upper left.
const SUN: Sun = Sun { off_axis: 30.0, azimuth: 135.0 };
/// Paths in a picture: mirrors of mirrors of mirrors are dark.
const DEPTH: u32 = 4;

/// A figure of spheres: its picture from above, the same level as the standard scene has it, the lobe probe, the checks.
pub fn spheres(figure: &SphereFigure, studio: &mut Studio) -> Result<Plate, GalleryError> {
    let rows = (figure.rows)();
    let count = rows.len() as f64;
    let spp = studio.options.spp;
    let views = [(RAISED, "", spp, [0.0, 0.55]), (0.0, "_level", spp.div_ceil(4), [0.55, 0.7])];
    let id = format!("figure_{}", figure.number);
    let names = Names {
        rows: rows.iter().map(|(name, _)| name.clone()).collect(),
        columns: rows[0].1.iter().map(|ball| ball.label.clone()).collect(),
        tiles: None,
    };
    let mut shown = Vec::new();
    for (elevation, ending, spp, part) in views {
        let share = |k: usize| part[0] + (part[1] - part[0]) * k as f64 / count;
        let pictures = rows
            .iter()
            .enumerate()
            .map(|(k, (_, balls))| row(studio, balls, elevation, spp, [share(k), share(k + 1)]))
            .collect::<Result<Vec<_>, _>>()?;
        let alt = format!("Figure {}, spheres. {}. {}", figure.number, figure.title, figure.caption);
        let [image, calm] = [0, 1].map(|k| stacked(&pictures.iter().map(|pair| pair[k].clone()).collect::<Vec<_>>()));
        shown.push(studio.picture(&format!("{id}{ending}"), [&image, &calm], &names, &alt)?);
    }
    // The level picture is a file of the plate, and not shown beside the other.
    let level = shown.pop().map_or_else(Vec::new, |level| level.files);
    shown[0].files.extend(level.into_iter().filter(|file| !file.ends_with("svg")));
    studio.advance(0.7)?;
    let measured = (figure.measure)(&rows)?;
    for curves in &measured.curves {
        shown.push(studio.curves(curves)?);
    }
    Ok(Plate { shown, checks: measured.checks, ..Plate::new(&id, &format!("{} · {}", figure.number, figure.title), figure.caption) })
}

/// A figure of curves.
pub fn survey_curves(number: &str, studio: &mut Studio) -> Result<Plate, GalleryError> {
    let figure = survey_figure(number).expect("a number of the list");
    let shown = vec![studio.curves(&figure)?];
    Ok(Plate { shown, ..Plate::new(&figure.name, &format!("{number} · {}", figure.title), "Computed; every point is in the CSV file.") })
}

fn row(studio: &Studio, balls: &[Ball], elevation: f32, spp: u32, part: [f64; 2]) -> Result<[Image<LinearRgb>; 2], GalleryError> {
    let width = studio.options.width;
    // Few spheres are no larger than five.
    let across = (balls.len() as f32 * crate::stage::SPACING).max(12.5);
    let size = UVec2::new(width, (width as f32 * HEIGHT / across).round() as u32);
    let settings = Settings { size, max_depth: DEPTH, ..Settings::default() };
    let stage = Stage::row(balls).for_picture(balls.len(), SUN, elevation, HEIGHT);
    studio.render_calmly(&stage, &settings, spp, part)
}
