//! Every picture of the reflectance models, with its numbers, on one page.
//!
//! The models' laboratory (`kajo_bsdf_lab`) knows no scene and no renderer; pictures need both, and so the gallery is a crate of its own above the path
//! tracer. It renders through the tracer's public interface what a user's scene would render, measures on the pixels what each figure claims,
//! and writes pictures (PNG, EXR, SVG), curves (CSV, SVG, PNG) and a page into a folder that it is given.

pub mod check;
mod diagrams;
mod error;
mod floor;
mod furnace;
mod lobes;
mod page;
mod plates;
mod probe;
mod series;
mod stage;
mod studio;
mod survey;

pub use error::GalleryError;
pub use plates::Plate;
pub use studio::{Folder, Options, Shown, Watch};

use kajo_bsdf_lab::figures::SURVEY_FIGURES;
use studio::Studio;

/// The whole gallery, as data: `report.json`.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Gallery {
    /// Version of Kajo.
    pub kajo: String,
    /// Repeats it.
    pub command: String,
    /// Plates, in the order of the page.
    pub sections: Vec<Section>,
    /// Every file, relative to the folder.
    pub files: Vec<String>,
}

/// Plates of one kind.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// What they have in common.
    pub lead: String,
    /// The plates.
    pub plates: Vec<Plate>,
}

impl Gallery {
    /// All measurements.
    pub fn checks(&self) -> impl Iterator<Item = &check::Check> {
        self.sections.iter().flat_map(|section| &section.plates).flat_map(|plate| &plate.checks)
    }
}

/// Heading, lead, and for each plate its share of the time, its name and what makes it.
type Content = (&'static str, &'static str, Vec<(f64, String, Make)>);
type Make = Box<dyn Fn(&mut Studio) -> Result<Plate, GalleryError>>;

/// Sections with their lead, and what makes each plate with its share of the time.
fn contents() -> Vec<Content> {
    let spheres = survey::FIGURES.iter().map(|figure| {
        let make: Make = Box::new(|studio| plates::spheres(figure, studio));
        ((figure.rows)().len() as f64 + 0.5, format!("figure {}", figure.number), make)
    });
    let curves = SURVEY_FIGURES.iter().map(|number| {
        let make: Make = Box::new(|studio| plates::survey_curves(number, studio));
        (0.02, format!("figure {number}"), make)
    });
    vec![
        ("Spheres of the survey", SPHERES, spheres.collect()),
        (
            "Drawings and curves of the survey",
            "What stands behind the spheres.",
            [
                (0.2, "figure 3.3".to_owned(), Box::new(diagrams::facets) as Make),
                (0.6, "figure 4.4".to_owned(), Box::new(diagrams::layers)),
            ]
            .into_iter()
            .chain(curves)
            .collect(),
        ),
        ("Viewing angle", "What a floor mirrors, seen more and more steeply.", vec![(3.0, "floor".into(), Box::new(floor::plate))]),
        (
            "Shapes and energy",
            "Where models send light, and how much.",
            vec![
                (1.5, "lobes".into(), Box::new(lobes::plate)),
                (1.0, "furnace".into(), Box::new(furnace::plate)),
                (0.05, "off-specular peaks".into(), Box::new(series::off_specular)),
                (1.0, "albedo maps".into(), Box::new(series::albedo_maps)),
            ],
        ),
    ]
}

const SPHERES: &str = "Unit spheres 2.5 m apart on a checker of 1 m squares; a parallel light 30° off the camera's axis; 0.2 from everywhere; path traced. \
    The curves are pixels: the radiance along each sphere's great circle under the light alone.";

/// Makes everything in `folder`: pictures, curves, `index.html` and `report.json`.
///
/// # Errors
/// A file that cannot be written, a size that cannot be rendered, an interruption.
pub fn gallery(options: &Options, folder: &mut dyn Folder, watch: &dyn Watch) -> Result<Gallery, GalleryError> {
    let contents = contents();
    let whole: f64 = contents.iter().flat_map(|(_, _, plates)| plates).map(|(share, ..)| share).sum();
    let mut studio = Studio::new(options, folder, watch);
    let mut done = 0.0;
    let mut sections = Vec::new();
    for (title, lead, makes) in contents {
        let mut plates = Vec::new();
        for (share, what, make) in makes {
            studio.turn_to(&what, [done / whole, (done + share) / whole])?;
            plates.push(make(&mut studio)?);
            done += share;
        }
        sections.push(Section { title: title.into(), lead: lead.into(), plates });
    }
    let mut gallery =
        Gallery { kajo: env!("CARGO_PKG_VERSION").into(), command: options.command.clone(), sections, files: studio.files().into() };
    gallery.files.extend(["index.html", "report.json"].map(str::to_owned));
    studio.write("index.html", page::page(&gallery).as_bytes())?;
    let json = serde_json::to_string_pretty(&gallery).expect("names and numbers");
    studio.write("report.json", json.as_bytes())?;
    Ok(gallery)
}
