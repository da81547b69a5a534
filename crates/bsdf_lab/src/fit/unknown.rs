//! A number of a model's parameters, mapped to [0, 1].

use super::FitError;
use kajo_bsdf::models::ModelEntry;
use kajo_names::UnknownName;
use kajo_params::{ParamKind, ParamSpec, ParamValues, Rows, Value};
use kajo_sampling::Rng;

/// Coefficients of lobes are searched up to here, or to twice the starting value.
const COEFFICIENT: f64 = 10.0;
/// Exponents of lobes, likewise.
const EXPONENT: f64 = 1e4;

/// Where the number stands.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    Number,
    /// All channels of a colour.
    Grey,
    Channel(usize),
    /// Columns of a row that are equal.
    Row(usize, &'static [usize]),
}

/// One number that a fit changes.
#[derive(Clone, Debug)]
pub struct Unknown {
    /// `m`, `kd.r`, `lobe[1].cz`.
    pub name: String,
    param: usize,
    place: Place,
    min: f64,
    max: f64,
    /// b of v = min + (max − min) (bᵘ − 1)/(b − 1), which puts the middle value at u = ½; 1 for a straight line.
    base: f64,
}

impl Unknown {
    fn new(name: String, param: usize, place: Place, [min, middle, max]: [f64; 3]) -> Self {
        // (√b − 1)/(b − 1) = 1/(√b + 1) is the middle's share of the range.
        let share = ((middle - min) / (max - min)).clamp(1e-6, 0.5);
        Self { name, param, place, min, max, base: (1.0 / share - 1.0).powi(2) }
    }

    /// The value at u in [0, 1].
    pub fn value(&self, u: f64) -> f64 {
        let share = if self.base > 1.0 + 1e-9 { (self.base.powf(u) - 1.0) / (self.base - 1.0) } else { u };
        (self.min + (self.max - self.min) * share).clamp(self.min, self.max)
    }

    /// Inverse of [`Unknown::value`].
    pub fn position(&self, value: f64) -> f64 {
        let share = (value - self.min) / (self.max - self.min);
        let u = if self.base > 1.0 + 1e-9 { (1.0 + share * (self.base - 1.0)).ln() / self.base.ln() } else { share };
        u.clamp(0.0, 1.0)
    }

    /// Its value among those of a model.
    pub fn read(&self, values: &[Value]) -> f64 {
        match (values[self.param], self.place) {
            (Value::Float(value), _) => value,
            (Value::Color(color), Place::Channel(channel)) => color[channel],
            (Value::Color(color), _) => color.iter().sum::<f64>() / 3.0,
            (Value::Rows(rows), Place::Row(row, columns)) => {
                columns.iter().map(|&c| rows.as_slice()[row][c]).sum::<f64>() / columns.len() as f64
            }
            (other, _) => other.as_f64(),
        }
    }

    /// Changes it among the values of a model.
    pub fn write(&self, values: &mut [Value], value: f64) {
        let slot = &mut values[self.param];
        match (*slot, self.place) {
            (Value::Color(_), Place::Grey) => *slot = Value::Color([value; 3]),
            (Value::Color(mut color), Place::Channel(channel)) => {
                color[channel] = value;
                *slot = Value::Color(color);
            }
            (Value::Rows(rows), Place::Row(row, columns)) => {
                let mut rows = rows.as_slice().to_vec();
                for &column in columns {
                    rows[row][column] = value;
                }
                *slot = Value::Rows(rows.into_iter().collect::<Rows>());
            }
            _ => *slot = Value::Float(value),
        }
    }

    /// A random start: anywhere in the range; lobes about the mirror direction, sometimes back towards the light.
    pub fn start(&self, rng: &mut Rng, back: &[bool]) -> f64 {
        let random = rng.next_f64();
        match self.place {
            Place::Row(_, [3]) => self.position(2.0 * 200.0_f64.powf(random)),
            Place::Row(_, [2]) => self.position(0.75 + 0.4 * random),
            Place::Row(row, _) => {
                let size = 0.85 + 0.35 * random;
                self.position(if back[row] { size } else { -size })
            }
            _ => 0.02 + 0.96 * random,
        }
    }
}

/// The unknowns of a model: those of the parameters named, or of every number. `grey` keeps colours grey, `isotropic` keeps C_x = C_y in lobes.
pub fn unknowns(entry: &ModelEntry, start: &ParamValues, free: &[String], grey: bool, isotropic: bool) -> Result<Vec<Unknown>, FitError> {
    let names = resolve(entry, free)?;
    let wanted = |spec: &ParamSpec| names.is_empty() || names.contains(&spec.name);
    let mut out = Vec::new();
    for (param, (spec, value)) in start.iter().enumerate().filter(|(_, (spec, _))| wanted(spec)) {
        let mut push = |suffix: &str, place, range| out.push(Unknown::new(format!("{}{suffix}", spec.name), param, place, range));
        match (spec.kind, spec.default, value) {
            (ParamKind::Float { min, max }, Value::Float(middle), _) => push("", Place::Number, [min, middle, max]),
            (ParamKind::Color { min, max }, Value::Color([middle, ..]), _) if grey => push("", Place::Grey, [min, middle, max]),
            (ParamKind::Color { min, max }, Value::Color([middle, ..]), _) => {
                for (channel, suffix) in [".r", ".g", ".b"].into_iter().enumerate() {
                    push(suffix, Place::Channel(channel), [min, middle, max]);
                }
            }
            (ParamKind::Rows { .. }, _, Value::Rows(rows)) => {
                let columns: &[(&str, &[usize])] = if isotropic {
                    &[("cxy", &[0, 1]), ("cz", &[2]), ("n", &[3])]
                } else {
                    &[("cx", &[0]), ("cy", &[1]), ("cz", &[2]), ("n", &[3])]
                };
                for (index, row) in rows.as_slice().iter().enumerate() {
                    for &(suffix, columns) in columns {
                        let value = 2.0 * row[columns[0]].abs();
                        let range = if columns == [3] {
                            [0.0, 20.0, value.max(EXPONENT)]
                        } else {
                            [-value.max(COEFFICIENT), 0.0, value.max(COEFFICIENT)]
                        };
                        push(&format!("[{index}].{suffix}"), Place::Row(index, columns), range);
                    }
                }
            }
            _ if !names.is_empty() => {
                return Err(FitError::NotFree { name: spec.name.into(), reason: format!("it is {}, no real number", spec.expected()) });
            }
            _ => {}
        }
    }
    if out.is_empty() {
        return Err(FitError::NotFree {
            name: if free.is_empty() { entry.id.into() } else { free.join(",") },
            reason: "there is no number to change; give lobes or other names".into(),
        });
    }
    Ok(out)
}

/// Names of parameters, aliases resolved.
fn resolve(entry: &ModelEntry, free: &[String]) -> Result<Vec<&'static str>, FitError> {
    let mut out = Vec::new();
    for name in free {
        let alias = entry.aliases.iter().find(|(alias, _)| alias == name).map(|(_, targets)| *targets);
        match (alias, entry.params.iter().find(|spec| spec.name == name)) {
            (Some(targets), _) => out.extend(targets),
            (None, Some(spec)) => out.push(spec.name),
            (None, None) => {
                let known: Vec<&str> = entry.params.iter().map(|spec| spec.name).collect();
                let unknown = UnknownName::new("parameter", name, &known);
                return Err(FitError::NotFree { name: name.clone(), reason: unknown.to_string() });
            }
        }
    }
    Ok(out)
}
