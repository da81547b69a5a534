//! `kajo bsdf plot`: curves as numbers and as pictures.

use super::{entry, gallery, prepare};
use crate::arguments::Common;
use crate::arguments::bsdf::Plot;
use crate::failure::Outcome;
use crate::output;
use anyhow::Context;
use kajo_bsdf_lab::figures::{Figure, lobe, polar_lobe, survey_figure};
use kajo_bsdf_lab::plot;
use std::path::{Path, PathBuf};

/// Writes a CSV, an SVG and a PNG file for each figure and lists them.
pub fn run(common: &Common, arguments: &Plot) -> Outcome {
    if arguments.gallery {
        return gallery::run(common, arguments);
    }
    let mut figures: Vec<Figure> = arguments.figure.iter().filter_map(|number| survey_figure(number)).collect();
    if let Some(id) = &arguments.curves {
        let chosen = prepare(entry(id)?, &arguments.params, arguments.form)?;
        figures.extend([lobe, polar_lobe].map(|curves| curves(&*chosen.model, chosen.entry.id, &arguments.theta_i)));
    }
    let folder = &arguments.output;
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder `{}`", folder.display()))?;
    let mut files = Vec::new();
    for figure in &figures {
        files.push(write(folder, &figure.name, "csv", figure.csv().as_bytes())?);
        files.push(write(folder, &figure.name, "svg", plot::svg(figure).as_bytes())?);
        files.push(write(folder, &figure.name, "png", &plot::png(figure))?);
    }
    if common.json {
        return output::json(&files);
    }
    output::text(&files.iter().map(|file| format!("{}\n", file.display())).collect::<String>())
}

fn write(folder: &Path, name: &str, ending: &str, bytes: &[u8]) -> Outcome<PathBuf> {
    let path = folder.join(format!("{name}.{ending}"));
    std::fs::write(&path, bytes).with_context(|| format!("cannot write `{}`", path.display()))?;
    Ok(path)
}
