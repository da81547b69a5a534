//! Techniques that find the hard shadow of a point: what others run for many points of a light.

use super::{map, volume_zfail};
use crate::{Error, Technique};
use kajo_params::{ParamType, ParamValues, ScalarType, Value};

/// A technique, and the parameters with which it answers only yes or no.
pub struct HardAlgorithm {
    technique: &'static Technique,
    exact: &'static [(&'static str, &'static str)],
}

/// In the order of every list.
const ALL: &[HardAlgorithm] = &[
    HardAlgorithm { technique: &map::TECHNIQUE, exact: &[("kernel", "0")] },
    HardAlgorithm { technique: &volume_zfail::TECHNIQUE, exact: &[] },
];

const NAMES: &[&str] = &{
    let mut names = [""; ALL.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = ALL[i].technique.id;
        i += 1;
    }
    names
};

/// A parameter that chooses one of them by id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hard(usize);

impl Hard {
    /// The technique.
    pub fn technique(self) -> &'static Technique {
        ALL[self.0].technique
    }

    /// Its parameters: those with which it answers yes or no, and of `wanted` the ones that it has.
    ///
    /// # Errors
    /// A value that the technique does not take.
    pub fn params(self, wanted: &[(&str, &str)]) -> Result<ParamValues, Error> {
        let known = |name: &str| self.technique().params.iter().any(|spec| spec.name == name);
        let pairs: Vec<(&str, &str)> =
            ALL[self.0].exact.iter().copied().chain(wanted.iter().copied().filter(|(name, _)| known(name))).collect();
        self.technique().parse_params(&pairs)
    }
}

impl ParamType for Hard {
    const TYPE: ScalarType = ScalarType::Choice(NAMES);

    fn from_value(value: Value) -> Self {
        Self(value.choice())
    }

    fn to_value(self) -> Value {
        Value::Choice { index: self.0, name: NAMES[self.0] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_hard_algorithm_takes_its_exact_parameters() {
        for index in 0..ALL.len() {
            Hard(index).params(&[("resolution", "64"), ("no such parameter", "1")]).unwrap();
        }
        assert!(Hard(0).params(&[("resolution", "1")]).is_err());
    }
}
