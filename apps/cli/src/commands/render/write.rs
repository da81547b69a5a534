//! Image files of a rendering.

use crate::arguments::{ExposureChoice, Render};
use crate::failure::{Failure, Outcome};
use kajo_image::{ExrFile, Image, Layer, auto_exposure, tone_map, write_hdr, write_png};
use kajo_units::LinearRgb;
use std::collections::BTreeMap;
use std::path::Path;

/// Formats that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8-bit display-referred.
    Png,
    /// Float, with layers.
    Exr,
    /// Radiance RGBE.
    Hdr,
}

impl Format {
    /// The format that a file's ending names.
    ///
    /// # Errors
    /// An unknown ending is wrong usage.
    pub fn of(path: &Path) -> Outcome<Self> {
        match path.extension().unwrap_or_default().to_ascii_lowercase().to_str() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            Some("hdr") => Ok(Self::Hdr),
            _ => Err(Failure::usage(format!("cannot tell the format of {}; its name must end in .png, .exr or .hdr", path.display()))),
        }
    }
}

/// Checks that `path` can be made in its folder, so that hours of rendering do not end in a refusal.
///
/// # Errors
/// A folder that does not exist or cannot be written to, and a path that is a folder.
pub fn check_folder(path: &Path) -> Outcome {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(Failure::run(format!("cannot write {}: there is no folder {}; make it first", path.display(), folder.display())));
    }
    if path.is_dir() {
        return Err(Failure::run(format!("cannot write {}: it is a folder", path.display())));
    }
    match tempfile::tempfile_in(folder) {
        Ok(_) => Ok(()),
        Err(reason) => Err(Failure::run(format!("cannot write {}: {reason}", path.display()))),
    }
}

/// A finished image and what goes into its file beside it.
pub struct Picture<'a> {
    /// Linear, scene-referred.
    pub image: &'a Image<LinearRgb>,
    /// Further layers; EXR only.
    pub layers: Vec<Layer>,
    /// What repeats the run.
    pub metadata: BTreeMap<String, String>,
    /// Exposure that the scene's author chose, stops.
    pub scene_exposure: Option<f32>,
}

impl Picture<'_> {
    /// Writes the file atomically.
    ///
    /// # Errors
    /// Those of the format's writer.
    pub fn write(mut self, arguments: &Render, path: &Path) -> Outcome {
        match Format::of(path)? {
            Format::Hdr => write_hdr(path, self.image)?,
            Format::Exr => {
                let mut file = ExrFile::new(self.image.size());
                file.layers.push(Layer::color("", self.image));
                file.layers.append(&mut self.layers);
                file.metadata = self.metadata;
                file.write(path)?;
            }
            Format::Png => {
                let stops = match arguments.exposure {
                    Some(ExposureChoice::Stops(stops)) => stops,
                    Some(ExposureChoice::Auto) => auto_exposure(self.image),
                    None => self.scene_exposure.unwrap_or_else(|| auto_exposure(self.image)),
                };
                self.metadata.insert("exposure".into(), format!("{stops}"));
                self.metadata.insert("tone_map".into(), arguments.tone_map.name().into());
                write_png(path, &tone_map(self.image, stops, arguments.tone_map), &self.metadata)?;
            }
        }
        Ok(())
    }
}

/// Version and command line: enough to make the file again.
pub fn provenance() -> BTreeMap<String, String> {
    BTreeMap::from([("software".into(), format!("kajo {}", env!("CARGO_PKG_VERSION"))), ("command".into(), command_line())])
}

/// The command as it was typed, quoted for a POSIX shell.
pub fn command_line() -> String {
    let quote = |word: String| {
        let plain = !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || "-_./:=,+@%".contains(c));
        if plain { word } else { format!("'{}'", word.replace('\'', r"'\''")) }
    };
    let words = std::env::args_os().skip(1).map(|word| quote(word.to_string_lossy().into_owned()));
    std::iter::once("kajo".to_string()).chain(words).collect::<Vec<_>>().join(" ")
}
