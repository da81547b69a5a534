use super::*;
use crate::{AlphaMode, LightShape, Projection, Snapshot};
use kajo_units::Seconds;
use std::f32::consts::PI;

const DOCUMENT: &str = include_str!("../../../../docs/scene-format.md");

fn examples() -> Vec<&'static str> {
    DOCUMENT.split("```toml\n").skip(1).map(|rest| rest.split_once("```").expect("a closed block").0).collect()
}

fn parse(text: &str) -> Scene {
    parse_kajo_toml("test.kajo.toml", text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn refused(text: &str) -> String {
    match parse_kajo_toml("test.kajo.toml", text) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("accepted:\n{text}"),
    }
}

/// Composes a text beside the built-in scenes.
fn with_builtins(text: &str) -> Result<Scene, SceneError> {
    compose("test.kajo.toml", text, Some(Path::new("/nonexistent")), 0)
}

fn world_from_node(scene: &Scene, name: &str) -> glam::Mat4 {
    let Transform::Trs { translation, rotation, scale } = scene.nodes.iter().find(|n| n.name == name).unwrap().transform else { panic!() };
    glam::Mat4::from_scale_rotation_translation(scale, rotation, translation)
}

#[test]
fn every_example_of_the_document_parses() {
    let examples = examples();
    assert_eq!(examples.len(), 3);
    for example in examples {
        if let Err(error) = toml::from_str::<File>(example) {
            panic!("{error}");
        }
    }
}

#[test]
fn the_examples_of_the_document_load_with_the_test_scenes() {
    let Some(assets) = crate::test_assets::directory() else { return };
    let scene = compose("example.kajo.toml", examples()[0], Some(&assets), 0).unwrap();
    assert_eq!((scene.lights.len(), scene.cameras[0].name.as_str(), scene.exposure), (2, "front", Some(0.5)));
    assert_eq!(scene.animations.len(), 1);
    let leather = scene.materials.iter().find(|m| m.name == "LeatherPartsMat").unwrap();
    assert_eq!((leather.clearcoat, leather.clearcoat_roughness), (0.6, 0.1));
    let snapshot = Snapshot::new(&scene, Seconds(0.5));
    assert_eq!(snapshot.cameras[0].camera.name, "front");

    let scene = compose("example.kajo.toml", examples()[2], Some(&assets), 0).unwrap();
    let lambert = scene.materials.iter().find(|m| m.name == "lambert").unwrap();
    let texture = scene.textures[lambert.base_color_texture.unwrap().texture];
    assert_eq!((texture.wrap, texture.color_space), ([Wrap::Mirror; 2], ColorSpace::Srgb));
    assert!(scene.images[texture.image].width > 1);
}

/// Every key of the reader stands in the document, and every key of its tables is known to the reader.
#[test]
fn document_and_reader_know_the_same_keys() {
    let reader = include_str!("format.rs");
    let keys: Vec<&str> = reader
        .lines()
        .filter_map(|line| line.trim().strip_prefix("pub "))
        .filter_map(|line| line.split_once(": ").map(|(key, _)| key))
        .filter(|key| !["kind", "asset", "environment", "light", "camera", "material"].contains(key))
        .collect();
    assert!(keys.len() > 90, "{}", keys.len());
    for key in keys {
        let forms = [format!("`{key}`"), format!("{key} = "), format!("`{key}` =")];
        assert!(forms.iter().any(|form| DOCUMENT.contains(form)), "docs/scene-format.md does not explain `{key}`");
    }
}

#[test]
fn unknown_keys_name_their_line_and_the_nearest_key() {
    let message = refused("exposure = 1.0\n\n[[light]]\ntype = \"point\"\nlumen = 5\n");
    assert!(message.starts_with("`test.kajo.toml`, line 5, column 1: unknown field `lumen`"), "{message}");
    assert!(message.ends_with("did you mean `lumens`?"), "{message}");
    let message = refused("[[light]]\ntype = \"rectangel\"\n");
    assert!(message.contains("line 2") && message.ends_with("did you mean `rectangle`?"), "{message}");
    let message = refused("[[material]]\nname = \"a\"\nrougness = 1.0\n");
    assert!(message.contains("line 3") && message.ends_with("did you mean `roughness`?"), "{message}");
    let message = refused("[assets]\n");
    assert!(message.contains("line 1") && message.ends_with("did you mean `asset`?"), "{message}");
}

#[test]
fn broken_toml_and_wrong_types_name_their_place() {
    let message = refused("exposure = \n");
    assert!(message.contains("line 1, column"), "{message}");
    let message = refused("[[light]]\ntype = \"point\"\nlumens = \"many\"\n");
    assert!(message.contains("line 3, column 10"), "{message}");
    let message = refused("[environment]\nradiance = [1.0, 2.0]\n");
    assert!(message.contains("line 2") && message.contains("a colour: one number or [r, g, b]"), "{message}");
    assert!(refused("exposure = nan").contains("`exposure` is NaN"));
}

#[test]
fn values_out_of_range_say_the_range() {
    let camera = |keys: &str| refused(&format!("[[camera]]\nposition = [0, 0, 1]\ntarget = [0, 0, 0]\n{keys}\n"));
    assert!(camera("yfov_deg = 0").contains("give a number from 0.01 to 175"), "{}", camera("yfov_deg = 0"));
    assert!(camera("near = 0").contains("give a finite number above 0"), "{}", camera("near = 0"));
    assert!(camera("focus_on = [0, 0, 2]").contains("behind the camera"));
    assert!(camera("f_number = 2\nlens_radius = 0.1").contains("`lens_radius` and `f_number` exclude each other"));
    assert!(camera("rotate_deg = [0, 0, 0]").contains("`target` and `rotate_deg` exclude each other"));
    assert!(refused("[[camera]]\nname = \"a\"\n").contains("camera \"a\": its place is missing"));
    assert!(
        refused("[[light]]\ntype = \"disk\"\nradius = -1\nnits = 1\ntarget = [0,1,0]")
            .contains("`radius` is -1; give a finite number above 0")
    );
}

#[test]
fn lights_have_the_emission_of_their_unit() {
    let light = |keys: &str| parse(&format!("[[light]]\n{keys}\n")).lights.remove(0);
    let red = |keys: &str| light(keys).emission[0];
    let close = |got: f32, expected: f32| assert!((got / expected - 1.0).abs() < 1e-5, "{got} for {expected}");
    close(red("type = \"point\"\nlumens = 100"), 100.0 / (4.0 * PI));
    close(red("type = \"point\"\nwatts = 100"), 100.0 / (4.0 * PI));
    close(red("type = \"point\"\ncandela = 7"), 7.0);
    close(red("type = \"spot\"\nouter_deg = 90\ndirection = [0,-1,0]\nlumens = 10"), 10.0 / (2.0 * PI / 3.0));
    close(red("type = \"directional\"\nlux = 5\ndirection = [0,-1,0]"), 5.0);
    close(red("type = \"rectangle\"\nwidth = 2\nheight = 3\nlumens = 12\ntarget = [0,0,-1]"), 12.0 / (6.0 * PI));
    close(red("type = \"disk\"\nradius = 0.5\nradiance = 4\ntarget = [0,0,-1]"), 4.0);
    close(red("type = \"sphere\"\nradius = 0.1\nlumens = 800"), 800.0 / (4.0 * PI * PI * 0.01));
    let tinted = light("type = \"point\"\ncandela = 2\ncolor = [1.0, 0.5, 0.25]");
    assert_eq!(tinted.emission.0.to_array(), [2.0, 1.0, 0.5]);
}

#[test]
fn lights_refuse_what_does_not_fit_their_type() {
    let light = |keys: &str| refused(&format!("[[light]]\n{keys}\n"));
    assert!(light("type = \"point\"").contains("its strength is missing; give one of `lumens`, `candela`, `watts`, `intensity`"));
    assert!(light("type = \"point\"\nlux = 1").contains("`lux` is no strength of a point light"));
    assert!(light("type = \"point\"\nlumens = 1\nwatts = 1").contains("`lumens` and `watts` exclude each other"));
    assert!(light("type = \"point\"\ncandela = 1\nradius = 2").contains("`radius` does not belong"));
    assert!(light("type = \"rectangle\"\nwidth = 1\nnits = 1\ntarget = [0,1,0]").contains("`height` is missing"));
    assert!(light("type = \"spot\"\ncandela = 1").contains("shines somewhere"));
    assert!(light("type = \"spot\"\ncandela = 1\ndirection = [0,0,0]").contains("gives no direction"));
    assert!(
        light("type = \"spot\"\ncandela = 1\ndirection = [0,0,1]\ninner_deg = 50")
            .contains("`inner_deg` is 50; give a number from 0 to 45")
    );
}

#[test]
fn targets_directions_and_turns_point_minus_z() {
    let scene = parse(
        "[[light]]\nname = \"a\"\ntype = \"spot\"\ncandela = 1\nposition = [1, 2, 3]\ntarget = [1, 0, 3]\n\
         [[light]]\nname = \"b\"\ntype = \"directional\"\nlux = 1\ndirection = [0, 0, 2]\n\
         [[light]]\nname = \"c\"\ntype = \"directional\"\nlux = 1\nrotate_deg = [0, 90, 0]\n",
    );
    let towards = |name| world_from_node(&scene, name).transform_vector3(Vec3::NEG_Z);
    assert!(towards("a").distance(Vec3::NEG_Y) < 1e-6);
    assert!(towards("b").distance(Vec3::Z) < 1e-6);
    assert!(towards("c").distance(Vec3::NEG_X) < 1e-6);
    assert_eq!(world_from_node(&scene, "a").w_axis.truncate(), Vec3::new(1.0, 2.0, 3.0));
}

#[test]
fn turns_go_about_x_then_y_then_z() {
    let scene = parse("[[camera]]\nname = \"c\"\nposition = [0, 0, 0]\nrotate_deg = [90, 90, 0]\n");
    // +y turns about x to +z, then about y to +x.
    assert!(world_from_node(&scene, "c").transform_vector3(Vec3::Y).distance(Vec3::X) < 1e-6);
}

#[test]
fn cameras_have_their_lens_and_focus() {
    let scene = parse(
        "[[camera]]\nname = \"photo\"\nposition = [0, 0, 4]\ntarget = [0, 0, 0]\nyfov_deg = 90\nf_number = 2\nfocus_on = [1, 0, 1]\n\
         [[camera]]\nposition = [0, 0, 4]\ntarget = [0, 0, 0]\n\
         [[camera]]\nposition = [0, 0, 4]\ntarget = [0, 0, 0]\northographic_height = 2\naspect = 1.5\n",
    );
    let photo = &scene.cameras[0];
    // Focal length 12 mm of a sensor of 24 mm at 90°: radius 12 / (2 · 2) mm.
    assert!((photo.lens_radius.0 - 0.003).abs() < 1e-8 && (photo.focus_distance.0 - 3.0).abs() < 1e-6);
    assert_eq!((scene.cameras[1].name.as_str(), scene.cameras[1].lens_radius.0, scene.cameras[1].focus_distance.0), ("camera 1", 0.0, 4.0));
    assert_eq!(scene.cameras[2].projection, Projection::Orthographic { xmag: kajo_units::Meters(1.5), ymag: kajo_units::Meters(1.0) });
}

#[test]
fn assets_are_placed_and_their_parts_renumbered() {
    let scene = with_builtins(
        "[[asset]]\nfile = \"builtin:cornell\"\n[[asset]]\nfile = \"builtin:moving\"\ntranslate = [5, 0, 0]\nscale = 2\ntime_offset = 1\n",
    )
    .unwrap();
    let cornell = crate::builtin::load("cornell").unwrap();
    let moving = crate::builtin::load("moving").unwrap();
    assert_eq!(scene.meshes.len(), cornell.meshes.len() + moving.meshes.len());
    assert_eq!(scene.nodes.len(), cornell.nodes.len() + moving.nodes.len() + 2);
    let name_of = |scene: &Scene, mesh: usize| scene.materials[scene.meshes[mesh].material].name.clone();
    for (index, _) in moving.meshes.iter().enumerate() {
        assert_eq!(name_of(&scene, cornell.meshes.len() + index), name_of(&moving, index));
    }
    for (channel, original) in scene.animations[0].channels.iter().zip(&moving.animations[0].channels) {
        assert_eq!(scene.nodes[channel.node].name, moving.nodes[original.node].name);
        assert_eq!(channel.times[0], original.times[0] - 1.0);
    }
    let floor = scene.materials.iter().find(|m| m.base_color_texture.is_some()).unwrap().base_color_texture.unwrap();
    assert_eq!(scene.images[scene.textures[floor.texture].image].name, "tiles");

    // The composed scene at time t shows the asset at t + 1, twice as large and 5 m to the right.
    let composed = Snapshot::new(&scene, Seconds(0.5));
    let alone = Snapshot::new(&moving, Seconds(1.5));
    for (a, b) in composed.instances[cornell.meshes.len()..].iter().zip(&alone.instances) {
        let p = Vec3::new(0.3, -0.2, 0.1);
        let expected = b.world_from_object.transform_point3(p) * 2.0 + Vec3::X * 5.0;
        assert!(a.world_from_object.transform_point3(p).distance(expected) < 1e-4);
    }
}

#[test]
fn the_files_own_cameras_and_light_come_first() {
    let scene = with_builtins(
        "[environment]\nradiance = 2\nscale = [1, 0.5, 0]\n[[camera]]\nname = \"mine\"\nposition = [0, 0, 2]\ntarget = [0, 0, 0]\n\
         [[asset]]\nfile = \"builtin:spheres\"\n",
    )
    .unwrap();
    assert_eq!(Snapshot::new(&scene, Seconds(0.0)).cameras[0].camera.name, "mine");
    assert_eq!(scene.environment.unwrap().scale.0.to_array(), [2.0, 1.0, 0.0]);
    assert_eq!(scene.exposure, Some(0.0), "the asset's exposure counts where the file has none");
}

#[test]
fn a_light_on_a_node_follows_it() {
    let scene = with_builtins(
        "[[light]]\nname = \"on ball\"\ntype = \"point\"\ncandela = 1\nposition = [0, 1, 0]\nnode = \"ball\"\n[[asset]]\nfile = \"builtin:moving\"\n",
    )
    .unwrap();
    for time in [0.0, 0.4, 1.0] {
        let snapshot = Snapshot::new(&scene, Seconds(time));
        let ball = scene.nodes.iter().position(|n| n.name == "ball").unwrap();
        let centre = snapshot.instances.iter().find(|i| i.node == ball).unwrap().world_from_object.translation;
        let light = snapshot.lights.iter().find(|l| l.light.name == "on ball").unwrap().world_from_light.translation;
        assert!((light - centre - glam::Vec3A::Y).length() < 1e-5);
    }
}

#[test]
fn materials_are_changed_by_name_and_asset() {
    let two = "[[asset]]\nname = \"a\"\nfile = \"builtin:cornell\"\n[[asset]]\nname = \"b\"\nfile = \"builtin:cornell\"\n";
    let change = |limit: &str| {
        let keys = "name = \"white\"\nroughness = 0.25\nemission = 3\nalpha_mode = \"mask\"\nanisotropy_rotation_deg = 180\nior = 0\n";
        with_builtins(&format!("{two}[[material]]\n{limit}{keys}")).unwrap()
    };
    let whites = |scene: &Scene| scene.materials.iter().filter(|m| m.name == "white").map(|m| m.roughness).collect::<Vec<_>>();
    assert_eq!(whites(&change("")), [0.25, 0.25]);
    let one = change("asset = \"b\"\n");
    assert_eq!(whites(&one), [1.0, 0.25]);
    let changed = one.materials.iter().find(|m| m.roughness == 0.25).unwrap();
    assert_eq!((changed.emission, changed.alpha_mode, changed.ior), (LinearRgb::splat(3.0), AlphaMode::Mask(0.5), 0.0));
    assert!((changed.anisotropy_rotation.0 - PI).abs() < 1e-6);
    assert_eq!(changed.base_color.0.to_array(), [0.885809, 0.698859, 0.666422], "other fields stay");
}

#[test]
fn names_that_do_not_exist_are_answered_with_the_nearest() {
    let cornell = "[[asset]]\nname = \"box\"\nfile = \"builtin:cornell\"\n";
    let message = |rest: &str| with_builtins(&format!("{cornell}{rest}")).unwrap_err().to_string();
    assert!(message("[[material]]\nname = \"whit\"\n").contains("no material is called \"whit\" (did you mean \"white\"?)"));
    assert!(message("[[material]]\nname = \"red\"\nasset = \"bax\"\n").contains("no asset is called \"bax\" (did you mean \"box\"?)"));
    assert!(message("[[light]]\ntype = \"point\"\nlux = 1\n").contains("line 4"));
    let node = message("[[light]]\ntype = \"point\"\ncandela = 1\nnode = \"larg box\"\n");
    assert!(node.contains("did you mean \"large box\"?"), "{node}");
    let moving = with_builtins("[[asset]]\nfile = \"builtin:moving\"\nanimation = \"lop\"\n").unwrap_err().to_string();
    assert!(moving.contains("line 1") && moving.contains("did you mean \"loop\"?"), "{moving}");
    let number = with_builtins("[[asset]]\nfile = \"builtin:moving\"\nanimation = 3\n").unwrap_err().to_string();
    assert!(number.contains("`animation` is 3, but the asset has 1"), "{number}");
    let twice = with_builtins(&format!("{cornell}{cornell}")).unwrap_err().to_string();
    assert!(twice.contains("another asset has this name"), "{twice}");
    let none = with_builtins("[[asset]]\nfile = \"builtin:moving\"\nanimation = false\n").unwrap();
    assert!(none.animations.is_empty());
}

#[test]
fn a_material_may_be_any_model_of_the_library() {
    let with = |model: &str| with_builtins(&format!("[[asset]]\nfile = \"builtin:cornell\"\n[[material]]\nname = \"red\"\n{model}\n"));
    let scene = with("model = \"phong\"\nparams = { kd = [0.1, 0.2, 0.3], ks = 0.5, n = 20 }").unwrap();
    let model = scene.materials.iter().find(|m| m.name == "red").unwrap().model.clone().unwrap();
    assert_eq!(format!("{model:?}"), "phong kd=0.1,0.2,0.3,ks=0.5,n=20 Corrected");
    assert!(scene.materials.iter().filter(|m| m.name != "red").all(|m| m.model.is_none()));
    for (text, says) in [
        ("model = \"fong\"", "did you mean \"phong\"?"),
        ("model = \"phong\"\nparams = { n = -1 }", "parameter `n` is -1; it must be from 0 to"),
        ("model = \"phong\"\nparams = { m = 1 }", "no parameter is called \"m\""),
        ("model = \"phong\"\nparams = { n = 2024-01-01 }", "give a number"),
        ("params = { n = 1 }", "belong to a `model`"),
    ] {
        let message = with(text).unwrap_err().to_string();
        assert!(message.contains(says) && message.contains("material \"red\""), "{text}: {message}");
    }
}

#[test]
fn missing_files_and_circles_are_one_sentence() {
    let missing = with_builtins("[[asset]]\nfile = \"no.glb\"\n").unwrap_err().to_string();
    assert!(missing.contains("no.glb"), "{missing}");
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("ring.kajo.toml");
    std::fs::write(&path, "[[asset]]\nfile = \"ring.kajo.toml\"\n").unwrap();
    let circle = load_kajo_toml(&path).unwrap_err().to_string();
    assert!(circle.contains("does one name itself?"), "{circle}");
    std::fs::write(&path, [0xff, 0xfe]).unwrap();
    assert!(load_kajo_toml(&path).unwrap_err().to_string().contains("not UTF-8"));
}

#[test]
fn an_empty_file_is_an_empty_scene() {
    let scene = parse("");
    assert!(scene.nodes.is_empty() && scene.environment.is_none());
    assert!(matches!(parse("[[light]]\ntype=\"sphere\"\nradius=1\nnits=1").lights[0].shape, LightShape::Sphere { .. }));
}
