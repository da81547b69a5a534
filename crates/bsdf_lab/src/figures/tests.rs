use super::*;
use kajo_bsdf::models::{Form, find};
use std::collections::BTreeMap;

type Curves = BTreeMap<String, Vec<[f64; 2]>>;

/// What a reader of the file sees.
fn read(csv: &str) -> Curves {
    let mut curves = Curves::new();
    for line in csv.lines().skip(1) {
        let (name, rest) = line.strip_prefix('"').and_then(|line| line.split_once("\",")).unwrap();
        let (x, y) = rest.split_once(',').unwrap();
        curves.entry(name.into()).or_default().push([x.parse().unwrap(), y.parse().unwrap()]);
    }
    curves
}

fn file(number: &str) -> Curves {
    read(&survey_figure(number).unwrap().csv())
}

fn at(points: &[[f64; 2]], x: f64) -> f64 {
    points.iter().find(|point| point[0] == x).unwrap_or_else(|| panic!("no point at {x}"))[1]
}

/// Where a falling curve passes `level`, linear between points.
fn passes(points: &[[f64; 2]], level: f64) -> f64 {
    let k = points.iter().position(|point| point[1] < level).unwrap();
    let ([x0, y0], [x1, y1]) = (points[k - 1], points[k]);
    x0 + (x1 - x0) * (y0 - level) / (y0 - y1)
}

/// Row BR-38: half of the maximum at acos 2^(−1/n).
#[test]
fn figure_2_2_halves_where_section_5_says() {
    let curves = file("2.2");
    for (n, degrees) in [(3, 37.47), (5, 29.48), (10, 21.09), (50, 9.52), (200, 4.77)] {
        let found = passes(&curves[&format!("n = {n}")], 0.5);
        assert!((found - degrees).abs() < 6e-3, "n = {n}: {found}");
    }
    assert!((passes(&curves["n = 10"], 0.52) - 21.09).abs() > 6e-3, "planted fault");
}

/// Row BR-38: the values and gaps of section 3.5.
#[test]
fn figure_2_5_has_the_gaps_of_section_3_5() {
    let curves = file("2.5");
    for (n, gap) in [(5, 0.155), (10, 0.179), (50, 0.199), (100, 0.201)] {
        let (power, quotient) = (&curves[&format!("power, n = {n}")], &curves[&format!("Schlick, n = {n}")]);
        let found = power.iter().zip(quotient).fold(0.0, |most: f64, (a, b)| most.max((a[1] - b[1]).abs()));
        assert!((found - gap).abs() < 6e-4, "n = {n}: {found}");
        assert_eq!([at(power, 1.0), at(quotient, 1.0)], [1.0; 2]);
    }
    assert!((at(&curves["power, n = 50"], 0.9) - 0.005_15).abs() < 6e-6 && (at(&curves["Schlick, n = 50"], 0.9) - 0.152_5).abs() < 6e-5);
}

/// Row BR-38: the table of section 3.6.
#[test]
fn figure_3_4_is_the_table_of_section_3_6() {
    let curves = file("3.4");
    for (degrees, row) in [
        (30.0, [0.955_962_73, 1.0, 0.975_908_11, 0.878_374_05, 0.997_857_82, 0.931_046_77]),
        (60.0, [0.878_374_05, 0.997_857_82, 0.862_383_50, 0.667_429_29, 0.761_249_83, 0.676_255_64]),
        (80.0, [0.641_870_04, 0.725_543_84, 0.568_378_85, 0.311_986_14, 0.321_329_64, 0.305_048_27]),
        (89.0, [0.104_737_42, 0.105_095_07, 0.100_160_55, 0.035_965_57, 0.035_980_24, 0.035_775_73]),
    ] {
        let names = ["0.2", "0.6"].iter().flat_map(|m| ["Smith printed", "Smith", "Schlick"].map(|name| format!("{name}, m = {m}")));
        for (name, expected) in names.zip(row) {
            let found = at(&curves[&name], degrees);
            assert!((found - expected).abs() < 1e-7, "{name}, {degrees}°: {found}");
        }
    }
}

/// Row BR-38: the contours of section 3.7 and the crossings of section 5.
#[test]
fn figure_3_5_has_the_contours_of_section_3_7() {
    let curves = file("3.5");
    for (m, beckmann, schlick) in [
        (0.05, [2.39, 4.35, 6.14], [1.85, 4.22, 8.64]),
        (0.1, [4.81, 8.71, 12.23], [3.72, 8.52, 17.58]),
        (0.2, [9.84, 17.52, 24.03], [7.63, 17.63, 37.47]),
        (0.4, [21.66, 35.20, 44.27], [17.10, 40.37, 71.91]),
        (0.6, [37.24, 50.62, 58.07], [32.53, 64.23, 82.02]),
    ] {
        for (name, row) in [("Beckmann", beckmann), ("Schlick", schlick)] {
            let curve = &curves[&format!("{name}, m = {m}")];
            assert!((at(curve, 0.0) - 1.0).abs() < 1e-12);
            for (level, expected) in [0.5, 0.1, 0.01].into_iter().zip(row) {
                let found = passes(curve, level);
                assert!((found - expected).abs() < 0.02, "{name}, m = {m}, {level}: {found}");
            }
        }
    }
    for (m, crossing) in [(0.05, 4.53), (0.1, 8.98), (0.2, 17.40), (0.4, 31.47)] {
        let pairs = curves[&format!("Beckmann, m = {m}")].iter().zip(&curves[&format!("Schlick, m = {m}")]);
        let difference: Vec<[f64; 2]> = pairs.skip(1).map(|(a, b)| [a[0], a[1] - b[1]]).collect();
        let found = passes(&difference, 0.0);
        assert!((found - crossing).abs() < 0.02, "m = {m}: {found}");
    }
}

/// Row BR-38: the table of section 3.8.
#[test]
fn figure_3_6_is_the_table_of_section_3_8() {
    let curves = file("3.6");
    for (name, exact, schlick) in [
        (
            "plastic",
            [0.048_845, 0.087_521, 0.251_156, 0.385_989, 0.611_656, 0.903_906],
            [0.040_797, 0.068_765, 0.253_740, 0.409_126, 0.648_025, 0.918_994],
        ),
        (
            "diamond",
            [0.181_116, 0.211_261, 0.330_500, 0.433_315, 0.621_709, 0.899_746],
            [0.173_754, 0.197_845, 0.357_180, 0.491_028, 0.696_813, 0.930_223],
        ),
        (
            "silver",
            [0.967_234, 0.964_309, 0.961_497, 0.965_224, 0.977_407, 0.994_934],
            [0.968_615, 0.969_530, 0.975_582, 0.980_667, 0.988_483, 0.997_349],
        ),
        (
            "copper",
            [0.588_721, 0.597_268, 0.659_778, 0.721_746, 0.828_951, 0.960_141],
            [0.589_030, 0.601_013, 0.680_266, 0.746_841, 0.849_197, 0.965_293],
        ),
    ] {
        for (k, degrees) in [45.0, 60.0, 75.0, 80.0, 85.0, 89.0].into_iter().enumerate() {
            let found = [at(&curves[&format!("Fresnel, {name}")], degrees), at(&curves[&format!("Schlick, {name}")], degrees)];
            assert!((found[0] - exact[k]).abs() < 1e-6 && (found[1] - schlick[k]).abs() < 1e-6, "{name}, {degrees}°: {found:?}");
        }
    }
}

#[test]
fn lobes_are_the_models_values_and_polar_ones_their_arrows() {
    let model = find("phong").unwrap().from_pairs(&[("kd", "0"), ("ks", "1"), ("n", "50")], Form::Corrected).unwrap();
    let (flat, polar) = (lobe(&*model, "phong", &[30.0]), polar_lobe(&*model, "phong", &[30.0]));
    let peak = flat.curves[0].points.iter().copied().fold([0.0; 2], |most, point| if point[1] > most[1] { point } else { most });
    assert!(peak[0] == 30.0 && (peak[1] - 52.0 / std::f64::consts::TAU).abs() < 1e-9, "{peak:?}");
    for ([theta, f], [x, y]) in flat.curves[0].points.iter().zip(&polar.curves[0].points) {
        assert!((x.hypot(*y) - f).abs() < 1e-12 && (y * theta.to_radians().sin() - x * theta.to_radians().cos()).abs() < 1e-12);
    }
}

#[test]
fn every_listed_figure_exists_and_no_other() {
    assert!(SURVEY_FIGURES.iter().all(|number| survey_figure(number).is_some()) && survey_figure("2.3").is_none());
}
