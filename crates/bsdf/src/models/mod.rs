//! The reflectance models of the literature, each in its folder with equation, parameters, sampling, GPU side and tests.
//!
//! A model states its equation once over [`Real`]; [`all`] lists every model as data. Values for both directions above the surface are f in 1/sr, or, for
//! the older shading functions, S; see [`Kind`]. Where the print of a source has a defect, [`Form`] chooses between print and correction.

mod counting;
mod geometry;
mod lanes;
mod lobe;
mod model;
#[cfg(test)]
mod optics_tests;
mod quadrature;
pub mod radiometry;
mod real;
#[cfg(test)]
mod registry_tests;
pub mod shading;
#[cfg(test)]
pub(crate) mod testing;
mod vector;

pub mod ambient;
pub mod ashikhmin_shirley;
pub mod blinn_phong;
pub mod blocks;
pub mod cook_torrance;
pub mod factored;
pub mod ggx;
pub mod htsg;
pub mod lafortune;
pub mod lambert;
pub mod merl;
pub mod minnaert;
pub mod nmf;
pub mod oren_nayar;
pub mod phong;
pub mod principled;
pub mod rgl;
pub mod schlick;
pub mod schlick_cook_torrance;
pub mod strauss;
pub mod tabulated;
pub mod torrance_sparrow;
pub mod tucker;
pub mod ward;

pub use counting::{Counted, CountedMask, Operations};
pub use geometry::Geometry;
pub use lanes::Instructions;
pub use lobe::{Lobe, MOST_LOBES, Mixture};
pub use model::{Claims, Evaluate, Form, Kind, Made, Model, ModelEntry, ModelError, Parameters, Reflectance, Task, diffuse_and, make};
pub use quadrature::{Hemisphere, gauss_legendre};
pub use real::{Real, Scalar};
pub use vector::{Rgb, V3};

/// Every model, in the order of every list.
const ALL: &[&ModelEntry] = &[
    &ambient::MODEL,
    &lambert::BRDF,
    &lambert::BSF,
    &oren_nayar::MODEL,
    &minnaert::MODEL,
    &phong::BRDF,
    &phong::BSF,
    &blinn_phong::BRDF,
    &blinn_phong::BSF,
    &phong::SCHLICK_BSF,
    &torrance_sparrow::MODEL,
    &cook_torrance::MODEL,
    &schlick_cook_torrance::MODEL,
    &htsg::MODEL,
    &strauss::MODEL,
    &ward::MODEL,
    &schlick::SINGLE,
    &schlick::DOUBLE,
    &ashikhmin_shirley::MODEL,
    &lafortune::MODEL,
    &ggx::MODEL,
    &principled::MODEL,
    &merl::MODEL,
    &rgl::MODEL,
    &nmf::MODEL,
    &tucker::MODEL,
];

/// Every model.
pub fn all() -> impl Iterator<Item = &'static ModelEntry> {
    ALL.iter().copied()
}

/// The model called `id`.
pub fn find(id: &str) -> Option<&'static ModelEntry> {
    all().find(|model| model.id == id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::Path;

    #[test]
    fn folders_and_list_agree() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/models");
        let mut folders = BTreeSet::new();
        for entry in std::fs::read_dir(root).unwrap().map(Result::unwrap).filter(|e| e.path().join("doc.md").exists()) {
            folders.insert(std::fs::read_to_string(entry.path().join("doc.md")).unwrap());
        }
        let listed: BTreeSet<String> = all().map(|model| model.doc.to_owned()).collect();
        assert!(folders == listed, "a folder with doc.md and a line in ALL belong together");
        let ids: BTreeSet<_> = all().map(|model| model.id).collect();
        assert_eq!(ids.len(), all().count(), "an id names one model");
    }

    #[test]
    fn citations_have_entries() {
        let bibliography = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/references.bib")).unwrap();
        let missing = |key: &str| !bibliography.contains(&format!("{{{key},"));
        for model in all() {
            for key in model.cites {
                assert!(!missing(key), "{}: no entry {key} in docs/references.bib", model.id);
            }
        }
        assert!(missing("Nobody99"), "planted fault");
    }
}
