//! The command line that repeats what is seen.

use crate::model::Model;
use crate::selection::{Choice, Selection};
use crate::show::curve;
use crate::stage::Shot;
use glam::Vec3;
use kajo_scene::Projection;
use kajo_techniques::Role;

/// `kajo render …`: the picture of A. `None` without a scene.
pub(crate) fn render(model: &Model) -> Option<String> {
    let mut words = vec!["kajo".to_owned(), "render".to_owned()];
    words.extend(scene_and_view(model)?);
    words.extend(["--renderer", "realtime", "-o", "kajo.png"].map(str::to_owned));
    for (role, choice) in technique_flags(&model.selection) {
        words.extend(["--technique".to_owned(), format!("{role}={}", choice.words())]);
    }
    let tone = curve(model.selection.chosen.get(&Role::ToneMap));
    words.extend(["--tone-map".to_owned(), tone.name().to_owned(), format!("--exposure={}", model.exposure)]);
    if model.frame != 0 {
        words.extend(["--seed".to_owned(), model.frame.to_string()]);
    }
    Some(joined(&words))
}

/// `kajo compare …`: the judged role, both sides. `None` without a scene.
pub(crate) fn compare(model: &Model) -> Option<String> {
    let mut words = vec!["kajo".to_owned(), "compare".to_owned()];
    words.extend(scene_and_view(model)?);
    let selection = &model.selection;
    words.extend(["-o", "kajo-report", "--role", selection.judged.id(), "--technique"].map(str::to_owned));
    words.push(selection.champion().words());
    if model.layout.needs_rival() {
        words.extend(["--technique".to_owned(), selection.rival.words()]);
    }
    words.extend(["--reference-spp".to_owned(), model.spp.to_string()]);
    Some(joined(&words))
}

/// What no command line says.
pub(crate) fn left_out(model: &Model) -> Option<&'static str> {
    (!model.dark.is_empty()).then_some("Lights that are switched off here are on in the command's picture.")
}

/// The tone map has a flag of its own.
fn technique_flags(selection: &Selection) -> impl Iterator<Item = (&Role, &Choice)> {
    selection.chosen.iter().filter(|(role, _)| **role != Role::ToneMap)
}

fn scene_and_view(model: &Model) -> Option<Vec<String>> {
    let shot = model.shot()?;
    let source = &shot.moment.stage.source;
    let mut words = vec![source.reference.clone(), "--size".to_owned(), format!("{}x{}", shot.size.x, shot.size.y)];
    if let Some(environment) = &source.environment {
        words.extend(["--env".to_owned(), environment.display().to_string()]);
    }
    if model.time != 0.0 {
        words.push(format!("--frame={}", model.time));
    }
    words.extend(camera(model, &shot));
    Some(words)
}

fn camera(model: &Model, shot: &Shot) -> Vec<String> {
    let Some(rig) = &model.rig else { return Vec::new() };
    let cameras = &shot.moment.snapshot.cameras;
    let at = cameras.iter().position(|c| c.world_from_view == shot.camera.world_from_view && c.camera == shot.camera.camera);
    if let Some(index) = at {
        return if index == 0 { Vec::new() } else { vec!["--camera".to_owned(), index.to_string()] };
    }
    let [eye, target] = rig.eye_and_target().map(|v: Vec3| format!("{},{},{}", v.x, v.y, v.z));
    let mut words = Vec::new();
    if let Some(index) = cameras.iter().position(|c| c.camera.name == shot.camera.camera.name).filter(|&index| index > 0) {
        words.extend(["--camera".to_owned(), index.to_string()]);
    }
    words.extend([format!("--look-from={eye}"), format!("--look-at={target}")]);
    if let Projection::Perspective { yfov, .. } = shot.camera.camera.projection {
        words.push(format!("--fov={}", yfov.0.to_degrees()));
    }
    words
}

/// For a POSIX shell.
fn joined(words: &[String]) -> String {
    words.iter().map(|word| kajo_lab::quoted(word)).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::{Layout, PRESETS};
    use crate::stage::{Source, Stage};
    use glam::{UVec2, Vec2};

    fn model() -> Model {
        let mut model = Model { screen: UVec2::new(64, 48), ..Model::default() };
        model.enter(Stage::load(&Source { reference: "builtin:shadows".into(), environment: None }).unwrap());
        model
    }

    #[test]
    fn a_camera_of_the_scene_needs_no_words() {
        let command = render(&model()).unwrap();
        let start = "kajo render builtin:shadows --size 64x48 --renderer realtime -o kajo.png --technique direct-visibility=";
        assert!(command.starts_with(start) && !command.contains("look"), "{command}");
    }

    #[test]
    fn a_moved_camera_is_said_by_place_target_and_angle() {
        let mut model = model();
        model.rig.as_mut().unwrap().orbit(Vec2::new(20.0, -5.0));
        let command = compare(&model).unwrap();
        let [eye, _] = model.rig.as_ref().unwrap().eye_and_target();
        assert!(
            command.contains(&format!("--look-from={},{},{} --look-at=", eye.x, eye.y, eye.z)) && command.contains("--fov="),
            "{command}"
        );
    }

    #[test]
    fn the_rival_is_compared_where_it_is_shown() {
        let mut model = model();
        let count = |command: String| command.matches("--technique").count();
        assert_eq!(count(compare(&model).unwrap()), 1);
        model.layout = Layout::new(PRESETS[3]);
        assert_eq!(count(compare(&model).unwrap()), 2);
        model.dark.insert(0);
        assert!(left_out(&model).is_some());
    }

    #[test]
    fn names_with_spaces_are_quoted() {
        assert_eq!(joined(&["kajo".into(), "my scene's.glb".into()]), r"kajo 'my scene'\''s.glb'");
    }
}
