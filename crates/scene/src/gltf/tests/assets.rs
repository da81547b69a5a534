//! Real scenes: counts and what is ignored. They are not part of the repository; where they are absent, the tests say so and pass.

use crate::{ColorSpace, Scene, Snapshot, load_gltf};
use kajo_units::Seconds;

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
