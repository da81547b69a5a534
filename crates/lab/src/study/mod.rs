//! Studies: questions about techniques that one comparison does not answer, each asked by varying one thing.
//!
//! A study is a folder: `doc.md` says what is asked and how it is measured, `mod.rs` measures on a [`Rig`] and returns [`Findings`]: tables, plots, pictures and
//! claims that hold or do not. Everything else (list, command line, page, files) iterates over [`ALL`].

mod findings;
mod fit;
mod instance_culling;
mod light_depth;
mod page;
mod plot;
mod rig;
mod shadow_aliasing;
mod shadow_bias;
mod shadow_cost;
mod shadow_leaks;
mod shadow_perception;
mod shadow_samples;
mod shadow_wedges;

pub use findings::{Claim, Findings, Picture, Table};
pub use plot::{Plot, Scale, Series, svg};
pub use rig::{Rig, Set};

use crate::report::DeviceEntry;
use crate::staging::{MANIFEST, PAGE, Staging};
use crate::{LabError, Progress, host};
use kajo_image::write_png;
use kajo_names::UnknownName;
use kajo_render_graph::Device;
use std::collections::BTreeMap;
use std::path::Path;

/// A study as data.
#[derive(Clone, Copy, Debug)]
pub struct Study {
    /// Name on the command line; the folder it stands in.
    pub id: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// What is asked, and how it is measured; Markdown.
    pub doc: &'static str,
    /// Measures.
    pub run: fn(&Bench) -> Result<Findings, LabError>,
}

/// In the order of every list.
pub const ALL: &[Study] = &[
    shadow_bias::STUDY,
    shadow_aliasing::STUDY,
    light_depth::STUDY,
    shadow_leaks::STUDY,
    shadow_samples::STUDY,
    shadow_wedges::STUDY,
    shadow_cost::STUDY,
    shadow_perception::STUDY,
    instance_culling::STUDY,
];

/// What a study is given.
pub struct Bench<'a> {
    /// The device.
    pub device: &'a Device,
    /// Takes fewer steps: for tests.
    pub quick: bool,
    progress: &'a dyn Progress,
}

impl<'a> Bench<'a> {
    /// A bench on a device.
    pub fn new(device: &'a Device, quick: bool, progress: &'a dyn Progress) -> Self {
        Self { device, quick, progress }
    }

    /// Says how far the study is, [0, 1].
    ///
    /// # Errors
    /// When the user wants it to end.
    pub fn at(&self, what: &str, fraction: f64) -> Result<(), LabError> {
        self.progress.at(what, fraction);
        if self.progress.interrupted() { Err(LabError::Interrupted) } else { Ok(()) }
    }
}

/// The study called `id`.
///
/// # Errors
/// An unknown name, with the nearest.
pub fn find(id: &str) -> Result<&'static Study, UnknownName> {
    ALL.iter().find(|study| study.id == id).ok_or_else(|| {
        let known: Vec<&str> = ALL.iter().map(|study| study.id).collect();
        UnknownName::new("study", id, &known)
    })
}

/// Runs a study and writes its page, tables, plots and pictures to a folder.
///
/// # Errors
/// No adapter, a folder that cannot be written to, an interruption, or whatever stops the measurement.
pub fn run_study(study: &Study, output: &Path, quick: bool, progress: &dyn Progress) -> Result<Findings, LabError> {
    let mut staging = Staging::new(output)?;
    let device = Device::new()?;
    let findings = (study.run)(&Bench::new(&device, quick, progress))?;
    for table in &findings.tables {
        staging.write(&format!("{}.csv", table.name), table.to_csv().as_bytes())?;
    }
    for plot in &findings.plots {
        staging.write(&format!("{}.svg", plot.name), svg(plot).as_bytes())?;
    }
    for picture in &findings.pictures {
        write_png(&staging.place(&format!("{}.png", picture.name))?, &picture.image, &BTreeMap::new())?;
    }
    let info = device.info();
    let entry = DeviceEntry {
        name: info.name.clone(),
        driver: info.driver.clone(),
        kind: info.kind.into(),
        backend: info.backend.clone(),
        ray_query: info.ray_query,
        timestamps: info.timestamps,
    };
    staging.write(PAGE, page::page(study, &findings, &entry).as_bytes())?;
    let mut files = staging.files();
    files.push(MANIFEST.into());
    let report = serde_json::json!({
        "kajo": env!("CARGO_PKG_VERSION"),
        "study": study.id,
        "title": study.title,
        "command": format!("kajo study {} -o {}", study.id, output.display()),
        "created": host::now(),
        "device": entry,
        "claims": findings.claims,
        "tables": findings.tables,
        "plots": findings.plots,
        "pictures": findings.pictures.iter().map(|p| (&p.name, &p.caption)).collect::<BTreeMap<_, _>>(),
        "files": files,
    });
    let text = serde_json::to_string_pretty(&report).expect("a report is plain data");
    staging.write(MANIFEST, text.as_bytes())?;
    staging.publish()?;
    Ok(findings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Unwatched;
    use std::collections::BTreeSet;

    #[test]
    fn folders_and_list_agree() {
        let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/study");
        let folders = std::fs::read_dir(here).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir());
        let folders: BTreeSet<String> = folders.map(|path| path.file_name().unwrap().to_str().unwrap().replace('_', "-")).collect();
        assert_eq!(folders, ALL.iter().map(|study| study.id.to_owned()).collect());
        assert!(find("shadow-bais").unwrap_err().to_string().contains("shadow-bias"));
    }

    /// Every claim of every study holds; with the steps of a quick run.
    fn holds(id: &str) -> Findings {
        let folder = tempfile::tempdir().unwrap();
        let findings = run_study(find(id).unwrap(), folder.path(), true, &Unwatched).unwrap();
        let page = std::fs::read_to_string(folder.path().join(PAGE)).unwrap();
        assert!(page.contains("<svg") != findings.plots.is_empty() && !page.contains("src=\"http"));
        for table in &findings.tables {
            assert!(folder.path().join(format!("{}.csv", table.name)).exists());
            assert!(table.rows.iter().all(|row| row.len() == table.columns.len()), "{}", table.name);
        }
        for claim in &findings.claims {
            assert!(claim.holds, "{id}: {} ({})", claim.text, claim.measured);
        }
        assert!(!findings.claims.is_empty());
        findings
    }

    /// Row SH-09.
    #[test]
    fn the_automatic_bias_has_no_acne_and_the_smallest_detachment() {
        holds("shadow-bias");
    }

    /// Row SH-10.
    #[test]
    fn border_errors_halve_with_each_doubling_of_the_resolution() {
        holds("shadow-aliasing");
    }

    /// Row SH-11.
    #[test]
    fn errors_of_depth_follow_its_layout() {
        holds("light-depth");
    }

    /// Row SH-13.
    #[test]
    fn leaks_are_reported_for_each_method() {
        holds("shadow-leaks");
    }

    /// Row SH-16.
    #[test]
    fn the_report_shows_that_wedges_err_more_under_larger_lights() {
        let findings = holds("shadow-wedges");
        assert_eq!(findings.pictures.len(), 4, "wedges and rays for each occluder");
    }

    /// Row SH-20.
    #[test]
    fn volumes_cost_more_with_triangles_and_the_size_of_polygons_and_maps_with_texels() {
        let findings = holds("shadow-cost");
        assert!(findings.tables.len() == 2 && findings.plots.len() == 3);
    }

    /// Row SH-19.
    #[test]
    fn shadows_tell_the_height_of_objects() {
        let findings = holds("shadow-perception");
        assert!(findings.pictures.len() >= 4, "a pair of pictures for each arrangement");
    }

    /// Row RM-27.
    #[test]
    fn many_instances_can_be_left_out_of_reflections() {
        let findings = holds("instance-culling");
        let ways: BTreeSet<String> = findings.tables[0].rows.iter().map(|row| row[0].shown()).collect();
        assert_eq!(ways.len(), 4, "{ways:?}");
    }

    /// Row SH-15.
    #[test]
    fn more_samples_give_more_levels_and_less_error() {
        holds("shadow-samples");
    }
}
