//! Scene files that name no other file.
#![no_main]

use kajo_scene::Snapshot;
use kajo_scene::kajo_toml::parse_kajo_toml;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(scene) = parse_kajo_toml("fuzz.kajo.toml", text) {
        let snapshot = Snapshot::new(&scene, kajo_units::Seconds(0.0));
        assert!(snapshot.cameras.iter().all(|camera| camera.world_from_view.is_finite()));
        assert!(scene.lights.iter().all(|light| !light.emission.0.is_nan()));
    }
});
