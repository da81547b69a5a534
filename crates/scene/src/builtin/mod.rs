//! Scenes as code: what `builtin:NAME` names. Each stands in its own file and is listed in [`all`].

mod cornell;
mod stage;

use crate::{Scene, SceneError};

/// A scene of this library.
#[derive(Clone, Copy, Debug)]
pub struct BuiltinScene {
    /// What stands after `builtin:`.
    pub name: &'static str,
    /// One line for lists.
    pub description: &'static str,
    /// The number that may follow the name, as in `terrain:100000`; `None` for a scene without one.
    pub count: Option<Count>,
    make: fn(u32) -> Scene,
}

/// The number that a scene takes.
#[derive(Clone, Copy, Debug)]
pub struct Count {
    /// What it counts.
    pub what: &'static str,
    /// Taken when none is given.
    pub default: u32,
    /// Largest accepted; the smallest is 1.
    pub max: u32,
}

/// All of them, in the order of every list.
pub fn all() -> &'static [BuiltinScene] {
    ALL
}

const ALL: &[BuiltinScene] = &[cornell::SCENE];

/// The scene of a reference without its `builtin:`, such as `cornell` or `terrain:100000`.
///
/// # Errors
/// An unknown name (the nearest one is offered), a number where the scene takes none, or one out of range.
pub fn load(reference: &str) -> Result<Scene, SceneError> {
    let file = format!("builtin:{reference}");
    let (name, number) = reference.split_once(':').map_or((reference, None), |(name, number)| (name, Some(number)));
    let Some(builtin) = ALL.iter().find(|b| b.name == name) else {
        let names: Vec<_> = ALL.iter().map(|b| b.name).collect();
        let advice = match crate::nearest::nearest(name, &names) {
            Some(nearest) => format!("did you mean `builtin:{nearest}`?"),
            None => format!("the built-in scenes are {}", names.join(", ")),
        };
        return Err(SceneError::invalid(&file, "name", format!("no built-in scene has this name; {advice}")));
    };
    let count = match (builtin.count, number) {
        (None, None) => 0,
        (Some(count), None) => count.default,
        (None, Some(number)) => {
            return Err(SceneError::invalid(&file, "number", format!("`{name}` takes no number, got `{number}`; leave it out")));
        }
        (Some(count), Some(number)) => match number.parse::<u32>() {
            Ok(n) if (1..=count.max).contains(&n) => n,
            _ => {
                let problem = format!("`{number}` is not a number of {} from 1 to {}", count.what, count.max);
                return Err(SceneError::invalid(&file, "number", problem));
            }
        },
    };
    let mut scene = (builtin.make)(count);
    scene.name = file;
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Transform;
    use glam::{Mat4, Vec3};

    pub(super) fn matrix_of(transform: Transform) -> Mat4 {
        match transform {
            Transform::Trs { translation, rotation, scale } => Mat4::from_scale_rotation_translation(scale, rotation, translation),
            Transform::Matrix(matrix) => matrix,
        }
    }

    /// Vertices in the world of the root node of this name.
    pub(super) fn world_positions(scene: &Scene, node: &str) -> Vec<Vec3> {
        let node = scene.nodes.iter().find(|n| n.name == node).expect("a node of this name");
        assert!(node.parent.is_none());
        let world_from_object = matrix_of(node.transform);
        node.meshes.iter().flat_map(|&m| scene.meshes[m].positions.iter().map(|&p| world_from_object.transform_point3(p))).collect()
    }

    #[test]
    fn unknown_names_and_wrong_numbers_are_explained() {
        let message = |reference| load(reference).unwrap_err().to_string();
        assert!(message("cornel").contains("did you mean `builtin:cornell`?"), "{}", message("cornel"));
        assert!(message("zzzzzzzz").contains("the built-in scenes are cornell"), "{}", message("zzzzzzzz"));
        assert!(message("cornell:3").contains("takes no number"), "{}", message("cornell:3"));
    }
}
