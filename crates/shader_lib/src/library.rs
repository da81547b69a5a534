//! The sources of the library, embedded: each module is a file under `wesl/`, imported by its path,
//! e.g. `import shader_lib::bsdf::microfacet::ggx_d;`.

/// A module of the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Module {
    /// Path with slashes, e.g. `bsdf/microfacet`; imported as `shader_lib::bsdf::microfacet`.
    pub path: &'static str,
    /// WESL text.
    pub source: &'static str,
}

macro_rules! modules {
    ($($path:literal),* $(,)?) => {
        &[$(Module { path: $path, source: include_str!(concat!("../wesl/", $path, ".wesl")) }),*]
    };
}

/// Every module of the library.
pub const MODULES: &[Module] = modules![
    "bsdf/energy",
    "bsdf/film",
    "bsdf/fresnel",
    "bsdf/material",
    "bsdf/microfacet",
    "bsdf/sheen",
    "bsdf/tables",
    "bsdf/thin_film",
    "camera",
    "color",
    "emission",
    "light",
    "math",
    "models/geometry",
    "models/highlight",
    "models/microfacet",
    "models/schlick",
    "models/special",
    "models/tabulated",
    "packing",
    "random",
    "spherical_harmonics",
    "tone_map",
    "warp",
];

/// The module at `path` (with slashes): of the library, or the GPU's side of a reflectance model, `models/ward`.
pub fn module(path: &str) -> Option<Module> {
    MODULES.iter().copied().find(|module| module.path == path).or_else(|| crate::models::module(path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::Path;

    fn collect(folder: &Path, root: &Path, out: &mut BTreeSet<String>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(&path, root, out);
            } else {
                let relative = path.strip_prefix(root).unwrap().with_extension("");
                out.insert(relative.to_str().unwrap().replace('\\', "/"));
            }
        }
    }

    #[test]
    fn list_and_folder_agree() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("wesl");
        let mut files = BTreeSet::new();
        collect(&root, &root, &mut files);
        let listed: BTreeSet<String> = MODULES.iter().map(|module| module.path.to_owned()).collect();
        assert_eq!(files, listed);
    }
}
