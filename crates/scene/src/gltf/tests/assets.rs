//! Real scenes: counts and what is ignored. They are not part of the repository; where they are absent, the tests say so and pass.

use crate::{ColorSpace, Scene, Snapshot, Texels, load_gltf};
use glam::Vec3;
use kajo_units::{LinearRgb, Seconds};

/// Loads a real scene, or says that it is absent.
fn asset(name: &str) -> Option<Scene> {
    let path = crate::test_assets::directory()?.join(name);
    Some(load_gltf(&path).unwrap_or_else(|error| panic!("{error}")))
}

fn triangles(scene: &Scene) -> usize {
    let snapshot = Snapshot::new(scene, Seconds(0.0));
    snapshot.instances.iter().map(|instance| snapshot.meshes[instance.mesh].indices.len()).sum()
}

fn ignored(scene: &Scene) -> Vec<String> {
    scene.ignored.iter().map(|entry| format!("{}: {}", entry.place, entry.feature)).collect()
}

#[test]
fn flight_helmet_loads_completely() {
    let Some(scene) = asset("FlightHelmet/FlightHelmet.gltf") else { return };
    assert_eq!(triangles(&scene), 94722);
    assert_eq!((scene.materials.len(), scene.images.len()), (6, 15));
    assert_eq!(ignored(&scene), [""; 0]);
}

#[test]
fn barn_lamp_loads_completely() {
    let Some(scene) = asset("AnisotropyBarnLamp/AnisotropyBarnLamp.gltf") else { return };
    assert_eq!(triangles(&scene), 10203);
    assert_eq!(ignored(&scene), [""; 0]);
    assert_eq!(scene.textures.iter().filter(|t| t.color_space == ColorSpace::Srgb).count(), 1);
}

#[test]
fn fox_loads_completely() {
    let Some(scene) = asset("Fox/Fox.glb") else { return };
    assert_eq!(triangles(&scene), 576);
    assert_eq!(scene.animations.iter().map(|animation| animation.name.as_str()).collect::<Vec<_>>(), ["Survey", "Walk", "Run"]);
    assert_eq!(ignored(&scene), [""; 0]);
}

#[test]
fn cornell_box_loads_completely() {
    let Some(scene) = asset("CornellBox/CornellBox.glb") else { return };
    assert_eq!(triangles(&scene), 36);
    assert_eq!(ignored(&scene), [""; 0]);
}

#[test]
fn hotel_room_loads_completely() {
    let Some(scene) = asset("hotel-room/scene.glb") else { return };
    // Its primitives have 297 087 indices of triangles and 41 330 of lines; all of them over 3 would be 112 805.
    assert_eq!(triangles(&scene), 99_029);
    assert_eq!(ignored(&scene), ["mesh 0, primitive 9: lines"]);
}

/// Tangent-space normals are unit vectors of the upper half space: of the map's texels the mean length is 1 within 8-bit rounding.
#[test]
fn barn_lamp_normal_map_holds_normals() {
    let Some(scene) = asset("AnisotropyBarnLamp/AnisotropyBarnLamp.gltf") else { return };
    let normal = &scene.textures[scene.materials[0].normal_texture.unwrap().texture];
    assert_eq!(normal.color_space, ColorSpace::Linear);
    let image = &scene.images[normal.image];
    assert_eq!((image.width, image.height), (1024, 1024));
    let Texels::Rgba8(texels) = &image.texels else { panic!("8 bits") };
    let normals = texels.iter().map(|texel| Vec3::from([0, 1, 2].map(|c| f32::from(texel[c]) / 127.5 - 1.0)));
    let (mut lower, mut length, mut mean) = (0, 0.0f64, Vec3::ZERO);
    for normal in normals {
        lower += usize::from(normal.z <= 0.0);
        length += f64::from(normal.length());
        mean += normal / texels.len() as f32;
    }
    let length = length / texels.len() as f64;
    assert_eq!(lower, 0, "texels that point into the surface");
    assert!((length - 1.0).abs() < 0.01, "mean length {length}");
    assert!(mean.z > 0.9 && mean.truncate().length() < 0.05, "mean {mean}");
}

/// Every animation of the fox moves it, and it stays in one piece: no vertex leaves a generous box, no edge grows tenfold.
#[test]
fn fox_walks_and_stays_whole() {
    let Some(mut scene) = asset("Fox/Fox.glb") else { return };
    let rest = scene.meshes[0].clone();
    for animation in 0..3 {
        scene.animation = animation;
        let mut moved = 0.0f32;
        for time in [0.0, 0.3, 0.6, 5.0] {
            let snapshot = Snapshot::new(&scene, Seconds(time));
            let mesh = &snapshot.meshes[snapshot.instances[0].mesh];
            for triangle in &mesh.indices {
                let [a, b, _] = triangle.map(|vertex| vertex as usize);
                let (now, then) = (mesh.positions[a].distance(mesh.positions[b]), rest.positions[a].distance(rest.positions[b]));
                assert!(now < 10.0 * then + 1.0, "an edge of {then} grew to {now}");
            }
            assert!(mesh.positions.iter().all(|p| p.abs().max_element() < 300.0));
            assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4));
            moved = mesh.positions.iter().zip(&rest.positions).map(|(now, then)| now.distance(*then)).fold(moved, f32::max);
        }
        assert!(moved > 1.0, "animation {animation} moved by {moved}");
    }
}

/// The lamp and its room have what their materials say.
#[test]
fn barn_lamp_materials_have_their_layers() {
    let Some(scene) = asset("AnisotropyBarnLamp/AnisotropyBarnLamp.gltf") else { return };
    let [metal, filament, glass] = &scene.materials[..] else { panic!("three materials") };
    assert_eq!((metal.anisotropy, metal.clearcoat, metal.clearcoat_roughness), (1.0, 0.25, 0.15));
    assert!(metal.anisotropy_texture.is_some() && metal.clearcoat_normal_texture.is_some());
    assert_eq!(filament.emission, LinearRgb::new(25.0, 12.5, 6.25));
    assert_eq!((glass.transmission, glass.thickness), (1.0, 0.01));
    assert!(scene.meshes.iter().any(|mesh| mesh.tangents.len() == mesh.positions.len()));
}
