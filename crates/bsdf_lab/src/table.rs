//! The survey's table of models, 5.1 of \[Falski04], with measurements beside what it claims.

use crate::checks::{Furnace, Reciprocity, brdf, from_degrees, furnace, reciprocity};
use glam::DVec3;
use kajo_bsdf::models::{Claims, Form, ModelEntry, Reflectance, all};

/// Bright, glossy and, where that exists, anisotropic parameters: those that show what a model does.
const PROBES: &[(&str, &[(&str, &str)])] = &[
    ("lambert", &[("kd", "1")]),
    ("phong", &[("kd", "0"), ("ks", "1"), ("n", "50")]),
    ("phong-bsf", &[("kd", "0.6"), ("ks", "0.4"), ("n", "5")]),
    ("cook-torrance", &[("kd", "0"), ("ks", "1"), ("m", "0.2")]),
    ("schlick-cook-torrance", &[("kd", "0"), ("ks", "1"), ("m", "0.2"), ("f0", "1")]),
    ("htsg", &[]),
    ("strauss", &[("c", "1"), ("s", "0.9"), ("e", "0.5")]),
    ("ward", &[("kd", "0"), ("ks", "1"), ("mx", "0.2"), ("my", "0.3")]),
    ("schlick-single", &[("c", "1"), ("r", "0.1"), ("p", "0.6")]),
    ("schlick-double", &[("p", "0.6")]),
    ("ashikhmin-shirley", &[("rs", "1"), ("rd", "0"), ("nx", "10"), ("ny", "100")]),
    ("lafortune", &[("kd", "0"), ("lobe", "-1,-0.6,0.9,20")]),
];

/// The parameters at which a model is measured for the table.
pub fn probe(id: &str) -> &'static [(&'static str, &'static str)] {
    PROBES.iter().find(|(model, _)| *model == id).map_or(&[], |(_, pairs)| pairs)
}

/// A model's line of the table.
#[derive(Clone, Debug)]
pub struct TableRow {
    /// The model.
    pub entry: &'static ModelEntry,
    /// What the survey says.
    pub claims: Claims,
    /// f(a, b) against f(b, a).
    pub reciprocity: Reciprocity,
    /// Albedos.
    pub furnace: Furnace,
    /// The largest relative change when light and viewer turn about the normal together.
    pub turning: f64,
    /// The peak of the lobe past the mirror direction for light at 60°, degrees; `None` for a model without a peak.
    pub peak_shift: Option<f64>,
}

impl TableRow {
    /// Reciprocal and energy conserving, as measured.
    pub fn plausible(&self) -> bool {
        self.reciprocity.holds() && self.furnace.holds()
    }

    /// As measured.
    pub fn anisotropic(&self) -> bool {
        self.turning > 1e-6
    }

    /// The peak leaves the mirror direction, as measured.
    pub fn off_specular(&self) -> bool {
        self.peak_shift.is_some_and(|shift| shift.abs() > 0.5)
    }
}

/// Measures every model of which the survey claims something, at [`probe`].
pub fn survey_table(form: Form) -> Vec<TableRow> {
    all()
        .filter_map(|entry| Some((entry, entry.claims?)))
        .map(|(entry, claims)| {
            let model = entry.from_pairs(probe(entry.id), form).expect("probes are in range");
            TableRow {
                entry,
                claims,
                reciprocity: reciprocity(&*model, 20_000, 0),
                furnace: furnace(&*model),
                turning: turning(&*model),
                peak_shift: peak_shift(&*model),
            }
        })
        .collect()
}

pub(crate) fn turning(model: &dyn Reflectance) -> f64 {
    let value = |turn: f64| brdf(model, from_degrees(40.0, turn), from_degrees(55.0, 150.0 + turn)).x;
    let still = value(0.0);
    (1..12).map(|i| (value(f64::from(i) * 15.0) - still).abs() / still.abs().max(1e-12)).fold(0.0, f64::max)
}

/// Where f is largest in the plane of incidence, by tenths of a degree.
pub(crate) fn peak_shift(model: &dyn Reflectance) -> Option<f64> {
    let wi: DVec3 = from_degrees(60.0, 0.0);
    let values: Vec<(f64, f64)> =
        (0..890).map(|i| f64::from(i) * 0.1).map(|theta| (theta, brdf(model, wi, from_degrees(theta, 180.0)).x)).collect();
    let (least, most) = values.iter().fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), (_, f)| (least.min(*f), most.max(*f)));
    let (peak, _) = values.into_iter().find(|(_, f)| *f == most)?;
    (most > least * (1.0 + 1e-9)).then_some(peak - 60.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row BR-7: the column "Check" of the specification.
    #[test]
    fn measurements_say_what_is_known_of_the_claims() {
        let table = survey_table(Form::Corrected);
        let row = |id: &str| table.iter().find(|row| row.entry.id == id).unwrap_or_else(|| panic!("{id} has no claims"));
        // (model, reciprocal, conserving, anisotropic, peak shifts)
        for (id, reciprocal, conserving, anisotropic, shifts) in [
            ("lambert", true, true, false, false),
            ("phong", true, true, false, false),
            ("phong-bsf", false, true, false, false),
            ("cook-torrance", true, true, false, true),
            ("schlick-cook-torrance", true, true, false, true),
            ("htsg", true, true, false, true),
            ("strauss", false, true, false, false),
            ("ward", true, true, true, true),
            ("schlick-single", true, false, true, true),
            ("ashikhmin-shirley", true, true, true, true),
            ("lafortune", true, true, true, true),
        ] {
            let r = row(id);
            assert_eq!(r.reciprocity.holds(), reciprocal, "{id}: {:?}", r.reciprocity);
            assert_eq!(r.furnace.holds(), conserving, "{id}: {:?}", r.furnace.worst());
            assert_eq!(r.anisotropic(), anisotropic, "{id}: {}", r.turning);
            assert_eq!(r.off_specular(), shifts, "{id}: {:?}", r.peak_shift);
        }
        let printed = survey_table(Form::Printed);
        for id in ["cook-torrance", "schlick-cook-torrance"] {
            let r = printed.iter().find(|row| row.entry.id == id).unwrap();
            assert!(!r.furnace.holds(), "{id} as printed gains energy: {:?}", r.furnace.worst());
        }
    }
}
