use super::*;
use crate::models::find;
use crate::models::testing::*;
use glam::{DMat3, DVec3};

/// `kd=0` and one lobe.
fn golden(row: [f64; 4], values: [f64; 5]) {
    let row = row.map(|x| x.to_string()).join(",");
    assert_golden("lafortune", &[("kd", "0"), ("lobe", &row)], Form::Corrected, values, 1e-9);
}

/// Row BR-27.
#[test]
fn lobes_equal_their_golden_values() {
    golden(phong_row(50.0), [3.849_429_975, 3.881_956_49e-6, 1.718_731_166e-29, 0.0, 8.276_057_041]);
    golden([-1.0, -1.0, 0.8, 20.0], [0.040_744_197_36, 4.026_676_802e-4, 1.544_377_731e-14, 0.0, 0.622_836_315_1]);
    golden([0.9, 0.9, 0.9, 20.0], [5.832_891_281e-11, 0.0, 1.628_560_81e-13, 0.121_576_654_6, 0.0]);
    golden([-1.0, -0.6, 0.9, 20.0], [0.182_500_924_9, 0.003_500_346_086, 1.628_560_81e-13, 0.0, 0.790_306_287_6]);
}

/// Row BR-27.
#[test]
fn the_phong_recipe_is_phongs_highlight() {
    let lafortune = model("lafortune", &[("kd", "0"), ("lobe", &phong_row(50.0).map(|x| x.to_string()).join(","))], Form::Corrected);
    let phong = model("phong", &[("kd", "0"), ("ks", "1"), ("n", "50")], Form::Corrected);
    let other = model("phong", &[("kd", "0"), ("ks", "1"), ("n", "50.001")], Form::Corrected);
    let mut rng = kajo_sampling::Rng::new(27);
    let mut planted: f64 = 0.0;
    for _ in 0..10_000 {
        let mut next = || DVec3::from(V3::from_angles(rng.next_f64().acos(), TAU * rng.next_f64()));
        let (wi, wo) = (next(), next());
        let value = lafortune.value(wi, wo).x;
        assert!((value - phong.value(wi, wo).x).abs() < 1e-10, "{wi} {wo}");
        planted = planted.max((value - other.value(wi, wo).x).abs());
    }
    assert!(planted > 1e-6);
}

/// Row BR-27.
#[test]
fn lobes_add_up_and_minnaert_is_one_of_them() {
    let (wi, wo) = directions(SETS[0].1);
    let value = |pairs: &[(&str, &str)]| model("lafortune", pairs, Form::Corrected).value(wi, wo).x;
    let first = value(&[("kd", "0"), ("lobe", "-1,-1,0.8,20")]);
    let second = value(&[("kd", "0"), ("lobe", "-1,-0.6,0.9,5")]);
    let both = [("kd", "0.3"), ("ks", "0.5"), ("lobe", "-1,-1,0.8,20"), ("lobe", "-1,-0.6,0.9,5")];
    assert!((value(&both) - 0.3 * FRAC_1_PI - 0.5 * (first + second)).abs() < 1e-12);
    let c = (0.5 * 2.7 / TAU).powf(1.0 / 0.7).to_string();
    let minnaert = model("minnaert", &[("kd", "0.5"), ("n", "0.7")], Form::Corrected).value(wi, wo).x;
    assert!((value(&[("kd", "0"), ("lobe", &format!("0,0,{c},0.7"))]) - minnaert).abs() < 1e-12);
    assert!((value(&[("kd", "0"), ("lobe", "1,2,3,0")]) - 1.0).abs() < 1e-15, "n = 0 is constant");
}

/// Row BR-27: (−1, −1, 0.8), n = 20 peaks beyond the mirror direction.
#[test]
fn off_specular_lobes_peak_where_they_should() {
    let lobe = CosineLobe::<f64>::of([-1.0, -1.0, 0.8, 20.0]);
    for (theta_i, expected) in [(30.0_f64, 35.82), (45.0, 51.34), (60.0, 65.21), (75.0, 77.90)] {
        let wi = V3::from_angles(theta_i.to_radians(), 0.0);
        let at = |k: i32| lobe.value(wi, V3::from_angles((f64::from(k) * 0.01).to_radians(), std::f64::consts::PI));
        let peak = f64::from((0..9000).max_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap()) * 0.01;
        assert!((peak - expected).abs() < 0.05 && peak > theta_i + 1.0, "{theta_i}°: {peak}°");
    }
}

fn random_matrix(rng: &mut kajo_sampling::Rng) -> DMat3 {
    DMat3::from_cols_array(&std::array::from_fn(|_| 2.0 * rng.next_f64() - 1.0))
}

/// Row BR-27.
#[test]
fn a_lobe_is_reciprocal_exactly_if_its_matrix_is_symmetric() {
    let mut rng = kajo_sampling::Rng::new(270);
    for _ in 0..100 {
        let m = random_matrix(&mut rng);
        let skewed = MatrixLobe { m, n: 3.0 };
        let symmetric = MatrixLobe { m: (m + m.transpose()) * 0.5, n: 3.0 };
        assert!(symmetric.is_reciprocal() && !skewed.is_reciprocal());
        assert!(asymmetry(|a, b| symmetric.value(a, b), 200) < 1e-9);
        assert!(asymmetry(|a, b| skewed.value(a, b), 200) > 1e-2);
        assert_eq!(skewed.eigen(), None);
    }
}

/// Row BR-27.
#[test]
fn the_eigenframe_reproduces_the_matrix_and_makes_the_lobe_diagonal() {
    let mut rng = kajo_sampling::Rng::new(271);
    let mut matrices: Vec<_> = (0..1000).map(|_| random_matrix(&mut rng)).map(|m| m + m.transpose()).collect();
    matrices.extend([DMat3::ZERO, DMat3::IDENTITY, MatrixLobe::mirror(1.0).m, DMat3::from_diagonal(DVec3::new(3.0, -1.0, 2.0))]);
    for m in matrices {
        let lobe = MatrixLobe { m, n: 4.0 };
        let eigen = lobe.eigen().unwrap();
        let worst = |a: DMat3, b: DMat3| (a - b).to_cols_array().into_iter().fold(0.0, |worst, x| f64::max(worst, x.abs()));
        assert!(worst(eigen.matrix(), m) < 1e-12, "{m}");
        assert!(worst(eigen.q * eigen.q.transpose(), DMat3::IDENTITY) < 1e-12, "{m}");
        assert!(worst(Eigen { d: eigen.d + DVec3::X * 1e-9, ..eigen }.matrix(), m) > 1e-12, "planted fault");
        let (wi, wo) = directions(SETS[1].1);
        let turned = eigen.lobe(4.0).value((eigen.q * wi).into(), (eigen.q * wo).into());
        assert!((turned - lobe.value(wi, wo)).abs() < 1e-11, "{m}");
    }
    let (wi, wo) = directions(SETS[0].1);
    let cos_alpha = 2.0 * wi.z * wo.z - wi.dot(wo);
    assert!((MatrixLobe::mirror(50.0).value(wi, wo) - cos_alpha.powi(50)).abs() < 1e-12);
}

/// Row BR-5.
#[test]
fn sums_of_lobes_are_reciprocal_and_sampled_without_bias() {
    let pairs = [("kd", "0.1"), ("lobe", "-1.1211,-1.1211,0.8032,14.66"), ("lobe", "0.9,0.7,0.9,3"), ("lobe", "-1,-1,0.94,200")];
    let lafortune = model("lafortune", &pairs, Form::Corrected);
    assert!(asymmetry(|a, b| lafortune.value(a, b).x, 20_000) < 1e-9);
    assert_sampled_albedo("lafortune", &pairs, 100_000);
}

#[test]
fn lobes_that_cannot_be_are_refused() {
    let refused = |row: &str| find("lafortune").unwrap().from_pairs(&[("lobe", row)], Form::Corrected).err().unwrap().to_string();
    assert!(refused("1,1,1,-2").contains("negative"));
    assert!(refused("2,1,1,1000").contains("nearer to 1"));
}

/// Row BR-41.
#[test]
fn lafortune_is_robust() {
    let sharp = phong_row(10_000.0).map(|x| x.to_string()).join(",");
    assert_robust(
        "lafortune",
        &[
            &[],
            &[("kd", "0"), ("lobe", &sharp)],
            &[("kd", "0"), ("lobe", "0,0,0,3"), ("lobe", "1,1,1,0")],
            &[("kd", "0.1"), ("lobe", "0.9,0.7,0.9,3"), ("lobe", "-1,-1,0.94,200")],
        ],
    );
}

/// A lobe with exponent 0 reflects everywhere, beside a narrow one that does not: all of it is sampled.
#[test]
fn a_lobe_of_exponent_zero_is_sampled_beside_a_narrow_one() {
    assert_sampled_albedo("lafortune", &[("kd", "0"), ("ks", "0.2"), ("lobe", "0,0,1,0"), ("lobe", "-1,-1,1,200")], 40_000);
}
