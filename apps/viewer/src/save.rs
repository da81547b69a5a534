//! Pictures to files.

use crate::layout::Pane;
use crate::model::Model;
use crate::textures;
use glam::UVec2;
use kajo_image::{ExrFile, Image, Layer, write_png};
use kajo_units::Srgb8;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Writes the picture of A: `.png` as it is shown, `.exr` with the numbers of everything that was read back.
///
/// # Errors
/// No picture, an ending that is neither, a file that cannot be written.
pub(crate) fn picture(model: &Model, path: &Path) -> Result<(), String> {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let written = match ending.to_str() {
        Some("png") => {
            let shown = textures::picture(model, Pane::A).ok_or("there is no picture to write")?;
            let pixels = shown.pixels.iter().map(|color| Srgb8([color.r(), color.g(), color.b()])).collect();
            write_png(path, &Image::from_pixels(UVec2::new(shown.size[0] as u32, shown.size[1] as u32), pixels), &provenance(model))
        }
        Some("exr") => exr(model)?.write(path),
        _ => return Err(format!("cannot tell the format of {}; its name must end in .png or .exr", path.display())),
    };
    written.map_err(|error| error.to_string())
}

fn exr(model: &Model) -> Result<ExrFile, String> {
    let frames = model.frames.as_ref().ok_or("there is no picture to write")?;
    let frame = frames.sides.first().ok_or("there is no picture to write")?.as_ref().map_err(Clone::clone)?;
    let mut file = ExrFile::new(frame.color.size());
    file.layers.push(Layer::color("", &frame.color));
    file.layers.push(Layer::color("direct", &frame.direct));
    for (light, image) in frames.watched.iter().zip(&frame.visibility) {
        let name = frames.lights.get(*light).map_or("", String::as_str);
        file.layers.push(Layer::scalar(format!("visibility.{name}"), image));
    }
    if let Some(reference) = model.current_reference().filter(|reference| reference.picture.size() == frame.color.size()) {
        file.layers.push(Layer::color("reference", &reference.picture));
    }
    file.metadata = provenance(model);
    Ok(file)
}

/// A name in the current folder that no file has.
pub(crate) fn free_name(ending: &str) -> PathBuf {
    (1u32..).map(|number| PathBuf::from(format!("kajo-{number:04}.{ending}"))).find(|path| !path.exists()).expect("numbers do not end")
}

/// Version and the command that repeats it.
pub(crate) fn provenance(model: &Model) -> BTreeMap<String, String> {
    let mut out = BTreeMap::from([("software".to_owned(), format!("kajo {}", env!("CARGO_PKG_VERSION")))]);
    out.extend(crate::command::render(model).map(|command| ("command".to_owned(), command)));
    out
}
