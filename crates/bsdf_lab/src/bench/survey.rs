//! The survey's own measurements, Table 5.2 of \[Falski04], and a yardstick for operations that no clock has a part in.

use kajo_bsdf::models::Operations;

/// What the survey says of a model's cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Survey {
    /// ns a call on an Athlon XP 2200+ of 1.8 GHz: 10⁹ calls with fixed inputs.
    Measured(f64),
    /// The survey has the model and did not time it.
    NotMeasured,
}

/// Our ids in the order of the table. Its Lambert computes a cosine and so is the shading function.
const TABLE: &[(&str, Survey)] = &[
    ("lambert-bsf", Survey::Measured(LAMBERT)),
    ("schlick-phong-bsf", Survey::Measured(735.0)),
    ("blinn-phong-bsf", Survey::Measured(841.0)),
    ("phong-bsf", Survey::Measured(921.0)),
    ("schlick-cook-torrance", Survey::Measured(1102.0)),
    ("strauss", Survey::Measured(1150.0)),
    ("cook-torrance", Survey::Measured(1277.0)),
    ("ward", Survey::Measured(1426.0)),
    ("schlick-single", Survey::Measured(1634.0)),
    ("ashikhmin-shirley", Survey::Measured(1649.0)),
    ("lafortune", Survey::NotMeasured),
    ("htsg", Survey::NotMeasured),
];

/// ns a call of Lambert's model there.
const LAMBERT: f64 = 305.0;

impl Survey {
    /// Relative to Lambert's model.
    pub fn ratio(self) -> Option<f64> {
        match self {
            Self::Measured(ns) => Some(ns / LAMBERT),
            Self::NotMeasured => None,
        }
    }
}

/// What the survey says of the model called `id`.
pub fn surveyed(id: &str) -> Option<Survey> {
    TABLE.iter().find(|(model, _)| *model == id).map(|(_, survey)| *survey)
}

/// A count of operations as one number: additions, in the round figures that processors of the last decade have for what one operation keeps busy.
pub fn weight(operations: &Operations) -> u32 {
    let o = operations;
    o.add + o.mul + o.compare + 5 * o.div + 5 * o.sqrt + 15 * o.exp + 20 * o.trig + 40 * o.pow
}
