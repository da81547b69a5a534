//! `--aov shadow-class.LIGHT`: which pixels are umbra, penumbra and lit, derived from the visibility of the light by either renderer.
//!
//! An EXR has a layer with a number a pixel; a PNG is the picture of the classes itself.

use super::write::Format;
use crate::arguments::Render;
use crate::failure::{Failure, Outcome};
use crate::output;
use kajo_image::{Image, Layer, write_png};
use kajo_image_metrics::{ShadowClass, class_picture, shadow_classes};
use std::collections::BTreeMap;
use std::path::Path;

/// Before the name of the light.
const PREFIX: &str = "shadow-class.";

/// The light that a word of `--aov` asks the classes of; `*` is every light.
pub fn light_of(word: &str) -> Option<&str> {
    word.trim().strip_prefix(PREFIX).filter(|light| !light.is_empty())
}

/// True when classes of any light are asked.
pub fn is_asked(words: &[String]) -> bool {
    words.iter().any(|word| light_of(word).is_some())
}

/// The classes of one light.
pub struct Classes {
    light: String,
    image: Image<Option<ShadowClass>>,
}

impl Classes {
    /// From the light's visibility where a surface is seen.
    ///
    /// # Errors
    /// Sizes that differ.
    pub fn new(light: &str, visibility: &Image<f32>, seen: &Image<bool>) -> Outcome<Self> {
        Ok(Self { light: light.to_owned(), image: shadow_classes(visibility, Some(seen))? })
    }

    /// Name of the light.
    pub fn light(&self) -> &str {
        &self.light
    }

    /// 0 umbra, 1 penumbra, 2 lit, −1 where no surface is seen.
    pub fn layer(&self) -> Layer {
        Layer::scalar(format!("{PREFIX}{}", self.light), &self.image.map(|class| class.map_or(-1.0, |class| class as u8 as f32)))
    }
}

/// True when the picture is to be one of classes.
pub fn is_picture(arguments: &Render) -> bool {
    is_asked(&arguments.aov) && Format::of(&arguments.output).is_ok_and(|format| format == Format::Png)
}

/// A PNG holds one picture: that of one light's classes and nothing else.
///
/// # Errors
/// Anything else is wrong usage.
pub fn check_png(arguments: &Render) -> Outcome {
    match arguments.aov.as_slice() {
        [one] if light_of(one).is_some_and(|light| light != "*") => Ok(()),
        _ => Err(Failure::usage(
            "--aov writes layers of one file, which only .exr has; change the name of the output, or ask for one shadow-class.LIGHT, which a .png shows in colours",
        )),
    }
}

/// Writes the picture of the classes and says what its colours mean.
///
/// # Errors
/// Those of the writer.
pub fn write(classes: &Classes, mut metadata: BTreeMap<String, String>, path: &Path, silent: bool) -> Outcome {
    let legend = ShadowClass::ALL.map(|class| format!("{} {}", class.name(), class.color_name())).join(", ");
    let shares = ShadowClass::ALL.map(|class| {
        let (seen, of_it) = classes.image.pixels().iter().flatten().fold((0u64, 0u64), |(n, k), c| (n + 1, k + u64::from(*c == class)));
        format!("{} {:.1} %", class.name(), 100.0 * of_it as f64 / seen.max(1) as f64)
    });
    metadata.insert("legend".into(), legend.clone());
    write_png(path, &class_picture(&classes.image), &metadata)?;
    if silent {
        return Ok(());
    }
    output::text(&format!("{}: classes of {} in colours ({legend}, nothing black): {}\n", path.display(), classes.light, shares.join(", ")))
}
