use super::*;
use crate::gltf::NoResources;
use crate::{AlphaMode, ColorSpace, SurfaceUv, Texels};
use kajo_units::LinearRgb;

fn parse(text: &str) -> Scene {
    parse_obj("test.obj", text.as_bytes(), &NoResources, ImportLimits::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(text: &str) -> String {
    parse_obj("test.obj", text.as_bytes(), &NoResources, ImportLimits::default()).expect_err("refused").to_string()
}

/// A square with texture coordinates and the given material library.
fn with_library(library: &str) -> Scene {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("m.mtl"), library).unwrap();
    for (name, texel) in [("dark.png", [51u8, 51, 51, 255]), ("half.png", [128, 128, 128, 255]), ("red.png", [255, 0, 0, 64])] {
        let image = image::RgbaImage::from_pixel(2, 2, image::Rgba(texel));
        image.save(directory.path().join(name)).unwrap();
    }
    let text = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\n";
    parse_obj("test.obj", text.as_bytes(), &Folder(directory.path().to_owned()), ImportLimits::default()).unwrap()
}

fn features(scene: &Scene) -> Vec<&str> {
    scene.ignored.iter().map(|i| i.feature.as_str()).collect()
}

#[test]
fn bunny_has_its_69451_triangles() {
    let Some(assets) = crate::test_assets::directory() else { return };
    let scene = load_obj(&assets.join("bunny/stanford-bunny.obj")).unwrap();
    assert_eq!(scene.meshes.iter().map(|m| m.indices.len()).sum::<usize>(), 69_451);
    let mesh = &scene.meshes[0];
    assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4) && mesh.normals.len() == mesh.positions.len());
}

#[test]
fn polygons_become_fans_and_v_is_turned_over() {
    let scene = parse("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0.5 2 0\nv 0 1 0\nvt 0 0.25\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/1 5/1/1\n");
    let mesh = &scene.meshes[0];
    assert_eq!((mesh.indices.len(), mesh.positions.len(), mesh.normals[0]), (3, 5, Vec3::Z));
    assert_eq!(mesh.uvs[0][0], Vec2::new(0.0, 0.75));
    assert!(!mesh.faceted);
}

#[test]
fn faces_without_normals_are_flat_and_unshared() {
    let scene = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\n");
    let mesh = &scene.meshes[0];
    assert!(mesh.faceted && mesh.positions.len() == 6);
    assert_eq!((mesh.normals[0], mesh.normals[3]), (Vec3::NEG_Z, Vec3::NEG_Y));
}

#[test]
fn groups_and_materials_are_meshes_with_nodes() {
    let scene = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\no first\nf 1 2 3\ng second\nf -3 -2 -1\n");
    let names: Vec<_> = scene.nodes.iter().map(|n| n.name.as_str()).collect();
    assert_eq!(names, ["first", "second"]);
    assert_eq!((scene.materials.len(), scene.materials[0].name.as_str()), (1, "default"));
}

#[test]
fn vertex_colours_are_decoded() {
    let scene = parse("v 0 0 0 1 0.5 0\nv 1 0 0 1 0.5 0\nv 0 1 0 1 0.5 0\nf 1 2 3\n");
    let color = scene.meshes[0].colors[0];
    assert!((color - Vec4::new(1.0, 0.214_04, 0.0, 1.0)).abs().max_element() < 1e-4, "{color}");
}

#[test]
fn broken_files_name_their_line() {
    assert!(refused("v 0 0 0\nv 1 x 0\n").contains("line 2"), "{}", refused("v 0 0 0\nv 1 x 0\n"));
    assert!(refused("v 0 0 0\nf 1 2 9\n").contains("out of bounds"));
    assert!(refused("v 0 0 0\nf 1 2 99999999999999\n").contains("line 2"));
    assert!(refused("v 0 0 0\nf 1 -9223372036854775807 1\n").contains("is no index"));
    // Found by fuzzing: the parser's own arithmetic wraps round.
    assert!(refused("v 0 0 0\nvt 0 0\nvt 1 1\nf 1/1 1/-4 1/2\n").contains("index -4 counts back from 2 given so far"));
    assert!(refused("v 0 0 0\nf 1 -2 1\n").contains("line 2"));
    assert!(refused("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").contains("every number must be finite"));
    assert!(refused("v 0 0 1e999\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").contains("every number must be finite"));
    assert!(refused("").contains("there are no faces"));
    assert!(refused("f 0 0 0\n").contains("out of bounds"));
    let missing = load_obj(Path::new("/no/such.obj")).unwrap_err().to_string();
    assert!(missing.starts_with("cannot read `/no/such.obj`"), "{missing}");
}

#[test]
fn what_is_not_drawn_is_noted() {
    let scene = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\ns 1\nl 1 2\np 1\nwhatever 3\nmtllib gone.mtl\nf 1 2 3\n");
    assert_eq!(features(&scene), ["l (1x)", "p (1x)", "whatever (1x)", "s", "mtllib gone.mtl"]);
    let mixed = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 3\n");
    assert!(mixed.ignored[0].consequence.contains("some faces have normals and some have none"));
}

#[test]
fn classic_materials_become_dielectrics() {
    let scene = with_library("newmtl a\nKa 1 1 1\nKd 0.2 0.4 0.6\nKs 0.5 0.5 0.5\nNs 98\nNi 1.8\nillum 2\nTf 1 1 1\n");
    let material = &scene.materials[0];
    assert_eq!(material.base_color, LinearRgb::new(0.2, 0.4, 0.6));
    assert_eq!((material.metallic, material.specular_color, material.ior), (0.0, LinearRgb::WHITE, 1.5));
    // n = 98: α² = 0.02, r = √√0.02.
    assert!((material.roughness - 0.02f32.powf(0.25)).abs() < 1e-6);
    assert_eq!(features(&scene), ["Ka", "Ni", "Tf"]);
    assert_eq!(with_library("newmtl a\nKd 1 1 1\n").materials[0].specular, 0.0, "without Ks nothing reflects");
}

#[test]
fn transparency_is_coverage_or_glass() {
    let veil = with_library("newmtl a\nKd 1 1 1\nd 0.25\n").materials.remove(0);
    assert_eq!((veil.alpha, veil.alpha_mode, veil.transmission), (0.25, AlphaMode::Blend, 0.0));
    let veil = with_library("newmtl a\nKd 1 1 1\nTr 0.75\n").materials.remove(0);
    assert_eq!((veil.alpha, veil.alpha_mode), (0.25, AlphaMode::Blend));
    let glass = with_library("newmtl a\nKd 1 1 1\nd 0.25\nillum 7\nNi 1.3\n").materials.remove(0);
    assert_eq!((glass.alpha_mode, glass.transmission, glass.ior), (AlphaMode::Opaque, 0.75, 1.3));
    assert!(glass.thickness > 0.0);
}

#[test]
fn physical_extensions_are_read() {
    let library = "newmtl a\nKd 0.5 0.5 0.5\nPr 0.3\nPm 1\nPc 0.5\nPcr 0.2\nPs 0.4\naniso 0.6\nanisor 0.25\nKe 1 2 3\nmap_Pr half.png\nnorm -bm 0.5 half.png\n";
    let scene = with_library(library);
    let m = &scene.materials[0];
    assert_eq!((m.roughness, m.metallic, m.clearcoat, m.clearcoat_roughness), (0.3, 1.0, 0.5, 0.2));
    assert_eq!((m.anisotropy, m.emission, m.normal_scale), (0.6, LinearRgb::new(1.0, 2.0, 3.0), 0.5));
    assert!((m.anisotropy_rotation.0 - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
    let at = m.at(&scene, &SurfaceUv::default());
    assert!((at.params.roughness.0 - 0.3 * 128.0 / 255.0).abs() < 1e-3 && at.params.metallic == 1.0);
    assert!(!scene.meshes[0].tangents.is_empty(), "a normal map needs tangents");
    assert!(scene.ignored.is_empty(), "{:?}", scene.ignored);
}

#[test]
fn colour_and_coverage_images_are_joined() {
    let scene = with_library("newmtl a\nKd 1 1 1\nmap_Kd dark.png\nmap_d half.png\n");
    let at = scene.materials[0].at(&scene, &SurfaceUv::default());
    assert!((at.params.base_color[0] - 0.033_1).abs() < 1e-3 && (at.coverage - 0.502).abs() < 2e-3, "{at:?}");
    // One file for both: its alpha is the coverage.
    let scene = with_library("newmtl a\nKd 1 1 1\nmap_Kd red.png\nmap_d red.png\n");
    let at = scene.materials[0].at(&scene, &SurfaceUv::default());
    assert!((at.params.base_color[0] - 1.0).abs() < 1e-6 && (at.coverage - 64.0 / 255.0).abs() < 1e-3);
    let texture = scene.textures[scene.materials[0].base_color_texture.unwrap().texture];
    assert_eq!(texture.color_space, ColorSpace::Srgb);
    assert!(matches!(scene.images[texture.image].texels, Texels::Rgba8(_)));
}

#[test]
fn missing_textures_and_bad_numbers_are_noted() {
    let scene = with_library("newmtl a\nKd 0.5 0.5 0.5\nmap_Kd gone.png\nPr 7\nPm much\nbump dark.png\nmap_Ns dark.png\n");
    let notes: Vec<_> = scene.ignored.iter().map(|i| i.to_string()).collect();
    assert!(notes.iter().any(|n| n.contains("texture `gone.png`: cannot be read")), "{notes:?}");
    assert!(notes.iter().any(|n| n.contains("Pr: 7 is outside 0 to 1; clamped")), "{notes:?}");
    assert!(notes.iter().any(|n| n.contains("Pm: `much` is no number")), "{notes:?}");
    assert!(notes.iter().any(|n| n.contains("bump")) && notes.iter().any(|n| n.contains("map_Ns")), "{notes:?}");
    assert_eq!(scene.materials[0].roughness, 1.0);
}

#[test]
fn a_broken_library_is_noted_with_its_line() {
    let scene = with_library("newmtl a\nNs x\n");
    assert!(scene.ignored[0].to_string().contains("mtllib m.mtl: line 2"), "{}", scene.ignored[0]);
    assert!(scene.ignored[1].to_string().contains("usemtl a: no library has this material"), "{}", scene.ignored[1]);
    assert_eq!(scene.materials[0].name, "default");
}

#[test]
fn colours_of_one_number_are_grey_and_of_two_are_noted() {
    let scene = with_library("newmtl a\nKd 0.25\nKs 1 1\nKe spectral x.rfl\n");
    assert_eq!(scene.materials[0].base_color, LinearRgb::splat(0.25));
    let notes: Vec<_> = scene.ignored.iter().map(|i| i.to_string()).collect();
    assert!(notes[0].contains("line 3: Ks is no colour") && notes[1].contains("line 4: Ke is no colour"), "{notes:?}");
}

#[test]
fn texture_options_are_parsed() {
    let statement = texture::Statement::parse("-s 2 3 1 -o 0.5 -clamp on -mm 0 1 -bm 0.25 my wood.png");
    assert_eq!(
        (statement.name.as_str(), statement.multiplier, statement.ignored.as_slice()),
        ("my wood.png", 0.25, ["-mm".to_owned()].as_slice())
    );
    let negative = texture::Statement::parse("-o -0.5 -0.25 a.png");
    assert_eq!(negative.name, "a.png");
}
