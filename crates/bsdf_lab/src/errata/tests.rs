use super::*;

fn row(rows: &[Erratum], equation: &str, subject: &str) -> [f64; 2] {
    let found = rows.iter().find(|row| row.equation == equation && row.subject.contains(subject));
    found.unwrap_or_else(|| panic!("no row for {equation} {subject}")).values
}

/// Row BR-40: both numbers are there and differ, but for the misprint of names.
#[test]
fn every_misprint_has_two_numbers_that_differ() {
    let rows = errata();
    for row in &rows {
        let [printed, implemented] = row.values;
        assert!(printed.is_finite() && implemented.is_finite(), "{row:?}");
        let differ = (printed - implemented).abs() > 1e-3 * printed.abs().max(implemented.abs());
        assert_eq!(differ, row.equation != "3.1", "{row:?}");
        assert_eq!(row.is_label(), row.equation == "3.1", "{row:?}");
    }
}

/// Row BR-40: appendix A, in its order.
#[test]
fn every_equation_of_the_list_has_its_row() {
    let mut equations: Vec<&str> = errata().iter().map(|row| row.equation).collect();
    equations.dedup();
    let listed = [
        "1.11",
        "2.8",
        "2.10",
        "2.11",
        "2.12",
        "3.1",
        "3.3",
        "3.11",
        "3.17",
        "3.24",
        "3.25",
        "3.26",
        "3.27",
        "4.2",
        "4.8",
        "4.12",
        "4.13",
        "4.15",
        "4.16",
        "4.19, 4.20, 4.22",
        "4.25",
        "4.31",
        "text",
    ];
    // The prefactor (3.17) precedes HTSG in the survey, too.
    assert_eq!(equations, listed);
}

/// Row BR-40: the numbers of appendix A and of the sections it refers to.
#[test]
fn consequences_hold_numerically() {
    let rows = errata();
    for (equation, subject, printed, implemented, tolerance) in [
        ("1.11", "", 0.996_194_698_092 * 0.819_152_044_289, 0.996_194_698_092, 1e-11),
        ("2.10", "", 3.922, 1.0, 5e-4),
        ("2.11", "", 0.1225, 1.0, 1e-12),
        ("2.12", "", 1.0 / 0.334_00, 0.334_00, 5e-5),
        ("3.1", "", 0.512_993_281_1, 0.512_993_281_1, 1e-10),
        ("3.11", "", 0.197, 0.0387, 5e-4),
        ("3.17", "", 4.0, 1.0, 1e-3),
        ("3.25", "Λ", 0.6945, 0.8824, 1e-3),
        ("3.25", "shadowing", 0.849_714_173_8, 0.844_731_266_4, 1e-9),
        ("3.27", "effective", 0.985_931_9, 0.276_060_936, 1e-6),
        ("3.27", "g", 18.6127174 / (0.276_060_936 * 0.276_060_936), 18.6127174, 1e-5),
        ("4.2", "", 0.656_25, 0.397_830_419_9, 1e-9),
        ("4.13", "", f64::NAN, 1.363_364_848 - 0.4 / std::f64::consts::PI, 1e-8),
        ("4.15", "", f64::NAN, 0.583_753_251_3 - 0.4 / std::f64::consts::PI, 1e-8),
        ("4.31", "", 0.0, 0.161_214_135_6, 1e-9),
    ] {
        let values = row(&rows, equation, subject);
        for (found, expected) in values.into_iter().zip([printed, implemented]) {
            assert!(expected.is_nan() || (found - expected).abs() < tolerance, "({equation}) {subject}: {values:?}, not {expected}");
        }
    }
    let [printed, corrected] = row(&rows, "3.3", "");
    assert!((corrected - printed - 0.144).abs() < 5e-4, "{printed} {corrected}");
    let [printed, corrected] = row(&rows, "4.8", "");
    assert!((printed / corrected - 2.75).abs() < 0.05 && (corrected - 0.099_213_862_58).abs() < 1e-9, "{printed} {corrected}");
    let [printed, corrected] = row(&rows, "4.12", "");
    assert!(printed < 0.0 && corrected > 0.0, "{printed} {corrected}");
    let [printed, corrected] = row(&rows, "4.16", "");
    assert!(printed > 0.25 && corrected < 1e-12, "{printed} {corrected}");
    let [printed, corrected] = row(&rows, "4.19, 4.20, 4.22", "");
    assert!(printed > 1.0 && corrected < 1.0, "{printed} {corrected}");
    let [printed, corrected] = row(&rows, "4.25", "");
    let diffuse = 28.0 * 0.4 * 0.6 / (23.0 * std::f64::consts::PI) * (1.0 - 0.75_f64.powi(5)) * (1.0 - (1.0 - 0.125_f64.sqrt()).powi(5));
    assert!((corrected + diffuse - 0.062_927_717_12).abs() < 1e-9 && printed > 1.5 * corrected, "{printed} {corrected}");
    let [printed, corrected] = row(&rows, "3.27", "z0");
    assert!((corrected - 1.0).abs() < 1e-9 && printed > 10.0, "{printed} {corrected}");
}
