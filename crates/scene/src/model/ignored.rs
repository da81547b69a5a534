//! The list of what was ignored or replaced.

use std::fmt;

/// One thing that an importer or a renderer did not do as the file says.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
pub struct Ignored {
    /// File, as the user named it.
    pub file: String,
    /// Place inside the file: `node "Lamp"`, `material 3 "Glass"`, or empty for the whole file.
    pub place: String,
    /// What was found: `KHR_lights_punctual.range`, `occlusionTexture`, …
    pub feature: String,
    /// What it means for the picture, one clause.
    pub consequence: String,
}

impl fmt::Display for Ignored {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.file)?;
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        write!(f, "{}: {}", self.feature, self.consequence)
    }
}
