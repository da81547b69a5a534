//! From what the user types to a scene that can be rendered.

use crate::{
    Camera, Ignored, Node, Scene, SceneError, Transform, builtin, framing, kajo_toml, lighting, load_environment, load_gltf, load_obj,
};
use kajo_names::choose;
use std::path::{Path, PathBuf};

/// How to load a scene.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// An environment file that replaces the scene's own.
    pub environment: Option<PathBuf>,
    /// The animation that plays, by name or number; `None` leaves the scene's own choice.
    pub animation: Option<String>,
}

/// Loads the scene that `reference` names: a path ending in `.gltf`, `.glb`, `.obj` or `.toml`, or `builtin:NAME[:N]`.
///
/// A scene without a camera gets one that frames it ([`framing`]); one without any light gets one ([`lighting`]), and
/// [`Scene::ignored`] says so.
///
/// # Errors
/// See [`SceneError`]; nothing of a failed scene is returned.
pub fn load(reference: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    let mut scene = import_reference(reference)?;
    if let Some(path) = &options.environment {
        let (environment, ignored) = load_environment(path)?;
        scene.environment = Some(environment);
        scene.ignored.extend(ignored);
    }
    if let Some(word) = &options.animation {
        let names: Vec<&str> = scene.animations.iter().map(|animation| animation.name.as_str()).collect();
        scene.animation =
            choose("animation", word, &names).map_err(|unknown| SceneError::UnknownName { scene: reference.into(), unknown })?;
    }
    let shows = |node: &Node| !node.meshes.is_empty() || node.light.is_some();
    if scene.environment.is_none() && !scene.nodes.iter().any(shows) {
        return Err(SceneError::invalid(reference, "file", "there is nothing to see in it: no geometry, no light and no environment"));
    }
    complete(&mut scene);
    Ok(scene)
}

/// Adds the camera and the light that a scene lacks.
pub(crate) fn complete(scene: &mut Scene) {
    add_camera(scene);
    add_light(scene);
}

/// The scene that a reference of the user names, as its file has it.
fn import_reference(reference: &str) -> Result<Scene, SceneError> {
    if let Some(name) = reference.strip_prefix("builtin:") {
        return builtin::load(name);
    }
    let path = Path::new(reference);
    if path.extension().is_none() && !path.exists() && builtin::all().iter().any(|b| b.name == reference) {
        return Err(SceneError::UnknownBuiltin { reference: reference.into(), problem: format!("did you mean `builtin:{reference}`?") });
    }
    import(path, 0)
}

/// The scene of a file, `depth` scene files deep.
pub(crate) fn import(path: &Path, depth: usize) -> Result<Scene, SceneError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match extension.as_str() {
        "gltf" | "glb" => load_gltf(path),
        "obj" => load_obj(path),
        "toml" => kajo_toml::load_nested(path, depth),
        _ => Err(SceneError::Unsupported {
            file: path.display().to_string(),
            feature: "this kind of file".into(),
            advice: "give a .gltf, .glb, .obj or .kajo.toml file, or builtin:NAME".into(),
        }),
    }
}

/// Frames a scene that has no placed camera.
fn add_camera(scene: &mut Scene) {
    if scene.nodes.iter().any(|node| node.camera.is_some()) {
        return;
    }
    let placed = framing::camera_for(scene);
    let (scale, rotation, translation) = placed.world_from_view.to_scale_rotation_translation();
    debug_assert!(scale.abs_diff_eq(glam::Vec3::ONE, 1e-3), "a view is rigid: {scale}");
    let name = unused_name(scene, &placed.camera.name);
    let transform = Transform::Trs { translation, rotation, scale: glam::Vec3::ONE };
    scene.nodes.push(Node { name: name.clone(), transform, camera: Some(scene.cameras.len()), ..Node::default() });
    scene.cameras.push(Camera { name, ..placed.camera });
}

/// `wanted`, unless an unplaced camera of the file has that name.
fn unused_name(scene: &Scene, wanted: &str) -> String {
    let mut name = wanted.to_owned();
    while scene.cameras.iter().any(|camera| camera.name == name) {
        name.push('\'');
    }
    name
}

/// Lights a scene that nothing lights.
fn add_light(scene: &mut Scene) {
    let placed_light = scene.nodes.iter().any(|node| node.light.is_some_and(|light| !scene.lights[light].emission.is_black()));
    let shown = scene.nodes.iter().flat_map(|node| &node.meshes).map(|&mesh| scene.meshes[mesh].material);
    let emissive = shown.into_iter().any(|material| scene.materials[material].is_emissive());
    if placed_light || emissive || scene.environment.is_some() {
        return;
    }
    let consequence = lighting::light(scene).into();
    scene.ignored.push(Ignored { file: scene.name.clone(), place: String::new(), feature: "no light".into(), consequence });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Material, Mesh, shapes};
    use kajo_units::LinearRgb;
    use std::sync::Arc;

    fn bare() -> Scene {
        Scene {
            name: "bare".into(),
            nodes: vec![Node { meshes: vec![0], ..Node::default() }],
            meshes: vec![Arc::new(shapes::sphere(1.0, 8))],
            materials: vec![Material::default()],
            ..Scene::default()
        }
    }

    #[test]
    fn a_scene_without_light_gets_some_and_a_note() {
        let mut scene = bare();
        add_light(&mut scene);
        assert!(scene.environment.is_some() && scene.lights.len() == 1);
        assert_eq!(scene.ignored.len(), 1);
        assert!(scene.ignored[0].to_string().starts_with("bare: no light: a key light"), "{}", scene.ignored[0]);
    }

    #[test]
    fn lamps_glowing_meshes_and_environments_are_light_and_their_absence_is_not() {
        let mut glowing = bare();
        glowing.materials[0].emission = LinearRgb::WHITE;
        add_light(&mut glowing);
        assert!(glowing.environment.is_none());

        // A glowing material that nothing shows does not light anything.
        let mut hidden = bare();
        hidden.materials.push(Material { emission: LinearRgb::WHITE, ..Material::default() });
        hidden.meshes.push(Arc::new(Mesh { material: 1, ..shapes::sphere(1.0, 8) }));
        add_light(&mut hidden);
        assert!(hidden.environment.is_some());

        let mut lamp = builtin::load("cornell").unwrap();
        add_light(&mut lamp);
        assert!(lamp.environment.is_none() && lamp.ignored.is_empty());
    }

    #[test]
    fn a_scene_without_camera_gets_one_that_its_nodes_place() {
        let mut scene = bare();
        add_camera(&mut scene);
        let snapshot = crate::Snapshot::new(&scene, kajo_units::Seconds(0.0));
        assert_eq!(snapshot.cameras.len(), 1);
        let direct = framing::camera_for(&bare());
        assert!(snapshot.cameras[0].world_from_view.abs_diff_eq(direct.world_from_view, 1e-4));
        let before = scene.cameras.len();
        add_camera(&mut scene);
        assert_eq!(scene.cameras.len(), before, "a second call finds the camera");
    }

    #[test]
    fn foreign_files_and_forgotten_prefixes_are_explained() {
        let message = |reference| load(reference, &LoadOptions::default()).unwrap_err().to_string();
        assert!(message("scene.blend").contains("give a .gltf, .glb, .obj or .kajo.toml file"), "{}", message("scene.blend"));
        assert!(message("cornell").contains("did you mean `builtin:cornell`?"), "{}", message("cornell"));
    }

    #[test]
    fn a_scene_with_nothing_in_it_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let load = |name: &str, text: &str| {
            std::fs::write(folder.path().join(name), text).unwrap();
            load(folder.path().join(name).to_str().unwrap(), &LoadOptions::default())
        };
        for (name, text) in [("a.kajo.toml", ""), ("a.gltf", r#"{"asset":{"version":"2.0"}}"#)] {
            let message = load(name, text).unwrap_err().to_string();
            assert!(message.contains(name) && message.contains("there is nothing to see in it"), "{message}");
        }
        assert!(load("sky.kajo.toml", "[environment]\nradiance = 1").is_ok(), "a sky is something");
    }

    #[test]
    fn an_animation_is_chosen_by_name_or_number_and_a_missing_one_is_told() {
        let load = |word: &str| load("builtin:moving", &LoadOptions { animation: Some(word.into()), ..LoadOptions::default() });
        assert_eq!([load("loop").unwrap().animation, load("0").unwrap().animation], [0, 0]);
        let message = load("lop").unwrap_err().to_string();
        assert!(message.starts_with("builtin:moving: no animation is called \"lop\" (did you mean \"loop\"?)"), "{message}");
    }

    #[test]
    fn the_environment_of_the_options_replaces_the_scenes() {
        let Some(assets) = crate::test_assets::directory() else { return };
        let options = LoadOptions { environment: Some(assets.join("env/spiaggia_di_mondello_1k.hdr")), ..LoadOptions::default() };
        let scene = load("builtin:spheres", &options).unwrap();
        assert_eq!(scene.environment.unwrap().image.unwrap().width, 1024);
    }
}
