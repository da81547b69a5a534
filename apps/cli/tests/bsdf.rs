//! `kajo bsdf` as a user types it.

mod common;

use common::{json, run, succeed};
use std::path::Path;

fn here() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn words(line: &str) -> Vec<&str> {
    line.split(' ').collect()
}

#[test]
fn eval_prints_value_cosine_and_density() {
    let brdf = json(here(), &words("bsdf eval --model phong --param kd=0.4 ks=0.4 --param n=50 --theta-i 30 --theta-r 40 --phi-r 180"));
    let number = |json: &serde_json::Value, key: &str| json[key][2].as_f64().unwrap();
    assert!((number(&brdf, "f") - 1.667_095_944).abs() < 1e-9, "{brdf}");
    assert!((number(&brdf, "f_cos") - number(&brdf, "f") * 30_f64.to_radians().cos()).abs() < 1e-12, "{brdf}");
    assert!(brdf["pdf"].as_f64().unwrap() > 0.0);
    let bsf = json(here(), &words("bsdf eval --model phong-bsf --param kd=0.4 ks=0.4 n=50 --theta-i 30 --theta-r 40 --phi-r 180"));
    assert!((number(&bsf, "f_cos") - 0.532_461_560_4).abs() < 1e-9, "a shading function contains the cosine: {bsf}");
    assert_eq!(number(&bsf, "bsf"), number(&bsf, "f_cos"));
}

#[test]
fn wrong_models_and_parameters_are_refused_with_what_is_right() {
    let eval = "bsdf eval --theta-i 30 --theta-r 40 --model";
    for (model, says) in [
        ("phnog", "no model is called \"phnog\" (did you mean \"phong\"?)"),
        ("phong --param kx=1", "no parameter is called \"kx\""),
        ("phong --param n=nan", "parameter `n` is `nan`; it must be from 0 to"),
        ("phong --param kd=-1", "it must be one number or r,g,b, each from 0 to 1"),
        ("phong --param kd=0.6 ks=0.6", "kd + ks is 1.2"),
        ("phong --param kd", "a parameter is written name=value"),
        ("phong --phi-i inf", "an angle is a finite number of degrees"),
    ] {
        let output = run(here(), &words(&format!("{eval} {model}")));
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{model}: {stderr}");
        assert!(stderr.starts_with("error: ") && stderr.contains(says), "{model}: no `{says}` in {stderr}");
    }
}

#[test]
fn albedo_check_and_sample_test_measure_every_model() {
    let albedo = json(here(), &words("bsdf albedo --model lambert --param kd=0.5 --theta-r 30 --samples 1000"));
    assert!((albedo["albedos"][0]["albedo"][0].as_f64().unwrap() - 0.5).abs() < 1e-7, "{albedo}");
    let models = json(here(), &["bsdf", "list"]).as_array().unwrap().len();
    assert_eq!(json(here(), &words("bsdf check --model phong --pairs 100"))[0]["reciprocity"]["holds"], true);
    let table = succeed(here(), &words("bsdf sample-test --model phong --samples 10000"));
    assert!(models >= 3 && table.lines().count() == 5, "{table}");
}

/// Row BR-40.
#[test]
fn misprints_and_claims_are_tables_and_json() {
    let errata = json(here(), &words("bsdf table --errata"));
    let row = errata.as_array().unwrap().iter().find(|row| row["equation"] == "3.11").unwrap();
    assert!(
        (row["value_printed"].as_f64().unwrap() - 0.197).abs() < 5e-4 && (row["value_implemented"].as_f64().unwrap() - 0.0387).abs() < 5e-5
    );
    assert_eq!(succeed(here(), &words("bsdf table --errata")).lines().count(), errata.as_array().unwrap().len() + 1);
    let claims = json(here(), &words("bsdf table --claims"));
    assert_eq!(claims[0]["holds"], true);
    assert_eq!(claims[1]["holds"], false, "Cook and Torrance's print gains energy");
    assert!(succeed(here(), &words("bsdf table --claims")).contains("largest albedo, F = 1, m = 0.2, 1/π"));
    assert_eq!(run(here(), &words("bsdf table --claims --errata")).status.code(), Some(2));
}

/// Row BR-38.
#[test]
fn plots_are_numbers_and_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let command = "bsdf plot --figure 2.2,2.5,3.4,3.5,3.6 --curves cook-torrance --param m=0.3 --theta-i 30,60 -o out";
    let files = json(folder.path(), &words(command));
    assert_eq!(files.as_array().unwrap().len(), 7 * 3, "{files}");
    for name in ["figure_2.2", "figure_2.5", "figure_3.4", "figure_3.5", "figure_3.6", "cook-torrance_lobe", "cook-torrance_polar"] {
        let read = |ending: &str| std::fs::read(folder.path().join(format!("out/{name}.{ending}"))).unwrap();
        assert!(read("png").starts_with(b"\x89PNG") && read("svg").starts_with(b"<svg") && read("csv").starts_with(b"curve,"), "{name}");
    }
    let output = run(folder.path(), &words("bsdf plot --figure 2.3 -o out"));
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(run(folder.path(), &words("bsdf plot -o out")).status.code(), Some(2), "a plot of nothing");
}

/// Rows BR-37 and BR-39: one command makes every picture, its numbers and the page.
#[test]
fn the_gallery_is_one_command_and_one_page() {
    let folder = tempfile::tempdir().unwrap();
    let gallery = json(folder.path(), &words("bsdf plot --gallery --width 120 --spp 2 -o out"));
    let plates: Vec<&serde_json::Value> =
        gallery["sections"].as_array().unwrap().iter().flat_map(|section| section["plates"].as_array().unwrap()).collect();
    let figures = [
        "2.1", "2.2", "2.3", "2.4", "2.5", "3.3", "3.4", "3.5", "3.6", "3.7", "3.8", "3.9", "4.1", "4.2", "4.3", "4.4", "4.5", "4.6", "4.7",
    ];
    let ids = figures.map(|number| format!("figure_{number}"));
    for id in ids.iter().map(String::as_str).chain(["floor"]) {
        assert!(plates.iter().any(|plate| plate["id"] == id), "{id}");
    }
    let page = std::fs::read_to_string(folder.path().join("out/index.html")).unwrap();
    for plate in plates {
        assert!(page.contains(&format!("id=\"{}\"", plate["id"].as_str().unwrap())), "{}", plate["id"]);
        for shown in plate["shown"].as_array().unwrap() {
            let image = shown["image"].as_str().unwrap();
            assert!(page.contains(&format!("src=\"{image}\"")) && !shown["alt"].as_str().unwrap().is_empty(), "{image}");
        }
    }
    for file in gallery["files"].as_array().unwrap() {
        assert!(folder.path().join("out").join(file.as_str().unwrap()).metadata().unwrap().len() > 0, "{file}");
    }
    let png = std::fs::read(folder.path().join("out/figure_2.3.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG"));
    assert_eq!(run(folder.path(), &words("bsdf plot --gallery --figure 2.2 -o out")).status.code(), Some(2));
    assert_eq!(run(folder.path(), &words("bsdf plot --figure 2.2 --spp 4 -o out")).status.code(), Some(2));
    let output = run(folder.path(), &words("bsdf plot --gallery -o out/index.html"));
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn fit_finds_parameters_writes_a_material_and_says_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(
        folder.path(),
        &words("bsdf fit --model blinn-phong --to phong --to-param kd=0.3 ks=0.2 n=20 --starts 4 --metric log -o material.kajo.toml"),
    );
    let value = |name: &str| found["params"][name].as_array().map_or_else(|| found["params"][name].as_f64(), |c| c[0].as_f64()).unwrap();
    assert!((value("kd") - 0.3).abs() < 0.03 && value("n") > 40.0 && found["relative_rms"].as_f64().unwrap() < 0.3, "{found}");
    assert_eq!(found["by_theta_i"].as_array().unwrap().len(), 6);
    // What was written is a scene's material.
    let material = std::fs::read_to_string(folder.path().join("material.kajo.toml")).unwrap();
    let asset = here().join("../../assets/still-life.gltf");
    let scene = format!("[[asset]]\nfile = {:?}\n\n{}", asset, material.replace("fitted-blinn-phong", "brass"));
    std::fs::write(folder.path().join("scene.kajo.toml"), scene).unwrap();
    succeed(folder.path(), &words("info scene.kajo.toml"));
    // A table of the command's own values.
    let mut table = "theta_i,phi_i,theta_r,phi_r,f\n".to_owned();
    for theta in ["0", "30", "60"] {
        table += &format!("{theta},0,20,0,{}\n", 0.5 / std::f64::consts::PI);
    }
    std::fs::write(folder.path().join("grey.csv"), &table).unwrap();
    let grey = json(folder.path(), &words("bsdf fit --model lambert --table grey.csv"));
    assert!((grey["free"][0]["value"].as_f64().unwrap() - 0.5).abs() < 1e-9, "{grey}");
    std::fs::write(folder.path().join("wrong.csv"), table + "95,0,20,0,1\n").unwrap();
    for (line, code, says) in [
        ("bsdf fit --model lambert --table wrong.csv", 1, "line 5 of the table: an inclination is 95°"),
        ("bsdf fit --model lambert --table absent.csv", 1, "cannot use absent.csv"),
        ("bsdf fit --model lambert --to phong --free kx", 2, "no parameter is called \"kx\""),
        ("bsdf fit --model lambert --to phong --lobes 2", 2, "has no lobes"),
        ("bsdf fit --model lambert", 2, "--to"),
        ("bsdf fit --model lambert --to phong --noise 2", 2, "a relative error is a number from 0 to 1"),
    ] {
        let output = run(folder.path(), &words(line));
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{line}: {stderr}");
        assert!(stderr.contains(says), "{line}: no `{says}` in {stderr}");
    }
}

/// Row GI-42: from a table in MERL's format, and from a formula, to a material of a scene.
#[test]
fn factor_writes_a_model_and_says_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let params = [("kd", "0.3,0.2,0.1"), ("ks", "0.4"), ("m", "0.25")];
    let ward = kajo_bsdf::models::find("ward").unwrap().from_pairs(&params, kajo_bsdf::models::Form::Corrected).unwrap();
    kajo_bsdf::models::merl::Table::of_model(&*ward).write(folder.path().join("ward.binary").to_str().unwrap()).unwrap();
    let number = |json: &serde_json::Value| json["f_cos"][1].as_f64().unwrap();
    let angles = "--theta-i 35 --theta-r 50 --phi-r 170";
    let expected = number(&json(here(), &words(&format!("bsdf eval --model ward --param kd=0.3,0.2,0.1 ks=0.4 m=0.25 {angles}"))));
    for (method, source) in [
        ("nmf --terms 3 --inner 2", "merl --param file=ward.binary"),
        ("tucker --terms 2 --passes 3", "merl --param file=ward.binary"),
        ("tucker", "ward --param kd=0.3,0.2,0.1 ks=0.4 m=0.25"),
    ] {
        let report = json(folder.path(), &words(&format!("bsdf factor --model {source} --method {method} -o out.factors")));
        let steps = report["steps"].as_array().unwrap();
        let errors: Vec<f64> = steps.iter().map(|step| step["cos_rms"].as_f64().unwrap()).collect();
        assert!(errors.len() > 2 && errors.windows(2).all(|pair| pair[1] < pair[0]), "{method}: {report}");
        assert!(report["ratio"].as_f64().unwrap() > 50.0 && report["isotropic"] == true, "{report}");
        let size = std::fs::metadata(folder.path().join("out.factors")).unwrap().len();
        assert!(size.abs_diff(report["factor_bytes"].as_u64().unwrap()) < 200, "{size} {report}");
        let id = words(method)[0];
        let value = number(&json(folder.path(), &words(&format!("bsdf eval --model {id} --param file=out.factors {angles}"))));
        assert!((value - expected).abs() < 0.05 * expected, "{method}: {value} instead of {expected}");
        let scene = format!(
            "[[asset]]\nfile = {:?}\n\n[[material]]\nname = \"brass\"\nmodel = \"{id}\"\n\n[material.params]\nfile = \"out.factors\"\n",
            here().join("../../assets/still-life.gltf")
        );
        std::fs::write(folder.path().join("scene.kajo.toml"), scene).unwrap();
        succeed(folder.path(), &words("info scene.kajo.toml"));
    }
    let table = succeed(folder.path(), &words("bsdf factor --model phong --method tucker --terms 1 --passes 3 -o phong.factors"));
    assert!(table.contains("rms of f cos θi") && table.contains("times less; written to phong.factors"), "{table}");
    for (line, code, says) in [
        ("bsdf factor --model ambient --method nmf -o x", 1, "cannot factor model `ambient`: the model is black"),
        ("bsdf factor --model phong --method nmf --passes 2 -o x", 2, "method nmf has no --passes"),
        ("bsdf factor --model phong --method tucker --sweeps 2 -o x", 2, "method tucker has no --sweeps"),
        ("bsdf factor --model phong --method tucker --terms 17 -o x", 2, "at most 16"),
        ("bsdf factor --model ward --param mx=0.1 my=0.3 --method tucker --terms 16 --passes 17 -o x", 2, "17 passes of rank 16"),
        ("bsdf factor --model phong --method nmf --terms 0 -o x", 2, "0 is not in 1..=64"),
        ("bsdf factor --model phong --method nmf --terms 1 --sweeps 1 -o absent/x", 1, "absent does not exist"),
        ("bsdf eval --model nmf --param file=out.factors --theta-i 1 --theta-r 1", 1, "begins with \"kajo-tucker 1\""),
        ("bsdf eval --model tucker --theta-i 1 --theta-r 1", 2, "`file` is not given"),
    ] {
        let output = run(folder.path(), &words(line));
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{line}: {stderr}");
        assert!(stderr.contains(says), "{line}: no `{says}` in {stderr}");
    }
}
