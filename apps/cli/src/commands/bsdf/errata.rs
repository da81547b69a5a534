//! `kajo bsdf table --errata`: the misprints of the survey, each in numbers.

use crate::arguments::Common;
use crate::failure::Outcome;
use crate::output;
use kajo_bsdf_lab::{Erratum, errata};
use serde_json::{Value, json};

/// Prints the table.
pub fn run(common: &Common) -> Outcome {
    let errata = errata();
    if common.json {
        return output::json(&errata.iter().map(as_json).collect::<Vec<_>>());
    }
    let rows: Vec<Vec<String>> = errata
        .iter()
        .map(|row| {
            vec![
                row.equation.into(),
                row.subject.into(),
                row.printed.into(),
                row.implemented.into(),
                row.quantity.into(),
                number(row.values[0]),
                number(row.values[1]),
                row.consequence.into(),
            ]
        })
        .collect();
    let head = ["equation", "subject", "printed", "implemented", "quantity", "as printed", "as implemented", "consequence"];
    output::text(&output::table(&head, &rows))
}

fn as_json(row: &Erratum) -> Value {
    json!({
        "equation": row.equation,
        "subject": row.subject,
        "printed": row.printed,
        "implemented": row.implemented,
        "quantity": row.quantity,
        "value_printed": row.values[0],
        "value_implemented": row.values[1],
        "label_only": row.is_label(),
        "consequence": row.consequence,
    })
}

/// Six significant digits.
pub fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || (1e-3..1e6).contains(&magnitude) {
        let digits = if magnitude < 1.0 { 6 } else { 5 - magnitude.log10().floor() as usize };
        let text = format!("{value:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
    } else {
        format!("{value:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_have_six_digits_and_no_idle_zeros() {
        for (value, text) in
            [(0.0, "0"), (1.0, "1"), (0.196_787_1, "0.196787"), (3.999_999_9, "4"), (-12.345_678, "-12.3457"), (1976.0, "1976")]
        {
            assert_eq!(number(value), text);
        }
        assert_eq!([number(3.2e-14), number(1e7), number(244_219.3)], ["3.2e-14", "1.0e7", "244219"]);
    }
}
