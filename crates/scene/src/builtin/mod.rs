//! Scenes as code: what `builtin:NAME` names. Each stands in its own file and is listed in [`all`].

mod chair_room;
mod cornell;
mod embers;
mod furnace;
mod glossy_floor;
mod many_lights;
mod mirror_room;
mod moving;
mod noise;
mod penumbra;
mod room;
mod scatter;
mod shadows;
mod spheres;
mod stacked;
mod stage;
mod terrain;
mod two_rooms;
mod umbra;

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

const ALL: &[BuiltinScene] = &[
    cornell::SCENE,
    furnace::SCENE,
    spheres::SCENE,
    shadows::SCENE,
    umbra::SCENE,
    penumbra::SCENE,
    stacked::SCENE,
    mirror_room::SCENE,
    glossy_floor::SCENE,
    chair_room::SCENE,
    many_lights::SCENE,
    embers::SCENE,
    two_rooms::SCENE,
    moving::SCENE,
    scatter::SCENE,
    terrain::SCENE,
];

/// The scene of a reference without its `builtin:`, such as `cornell` or `terrain:100000`.
///
/// # Errors
/// An unknown name (the nearest one is offered), a number where the scene takes none, or one out of range.
pub fn load(reference: &str) -> Result<Scene, SceneError> {
    let whole = format!("builtin:{reference}");
    let wrong = |problem: String| SceneError::UnknownBuiltin { reference: whole.clone(), problem };
    let (name, number) = reference.split_once(':').map_or((reference, None), |(name, number)| (name, Some(number)));
    let Some(builtin) = ALL.iter().find(|b| b.name == name) else {
        let names: Vec<_> = ALL.iter().map(|b| b.name).collect();
        return Err(wrong(match kajo_names::nearest(name, names.iter().copied()) {
            Some(nearest) => format!("no built-in scene has this name; did you mean `builtin:{nearest}`?"),
            None => format!("no built-in scene has this name; there are {}", names.join(", ")),
        }));
    };
    let count = match (builtin.count, number) {
        (None, None) => 0,
        (Some(count), None) => count.default,
        (None, Some(number)) => return Err(wrong(format!("`{name}` takes no number, got `{number}`; leave it out"))),
        (Some(count), Some(number)) => match number.parse::<u32>() {
            Ok(n) if (1..=count.max).contains(&n) => n,
            _ => return Err(wrong(format!("`{number}` is not a number of {} from 1 to {}", count.what, count.max))),
        },
    };
    let mut scene = (builtin.make)(count);
    scene.name = whole;
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
        assert!(message("zzzzzzzz").contains("there are cornell, furnace"), "{}", message("zzzzzzzz"));
        assert!(message("cornell:3").contains("takes no number"), "{}", message("cornell:3"));
    }

    #[test]
    fn every_scene_is_sound() {
        for builtin in all() {
            let count = builtin.count.map_or(0, |c| c.default.min(3000));
            let scene = (builtin.make)(count);
            let name = builtin.name;
            assert!(scene.exposure.is_some() && !scene.cameras.is_empty() && !scene.meshes.is_empty(), "{name}");
            for mesh in &scene.meshes {
                crate::shapes::tests::assert_sound(mesh);
                assert!(mesh.material < scene.materials.len(), "{name}");
            }
            for node in &scene.nodes {
                assert!(matrix_of(node.transform).is_finite(), "{name}: {}", node.name);
                assert!(node.meshes.iter().all(|&m| m < scene.meshes.len()), "{name}");
                assert!(node.light.is_none_or(|l| l < scene.lights.len()) && node.camera.is_none_or(|c| c < scene.cameras.len()), "{name}");
            }
            let lit = !scene.lights.is_empty() || scene.environment.is_some() || scene.materials.iter().any(crate::Material::is_emissive);
            assert!(lit, "{name}");
            assert!(scene.lights.iter().all(|l| l.emission.is_finite() && l.emission.0.min_element() >= 0.0), "{name}");
            for material in &scene.materials {
                let color = material.base_color.0;
                assert!(color.min_element() >= 0.0 && color.max_element() <= 1.0, "{name}: {}", material.name);
            }
            for (index, texture) in scene.textures.iter().enumerate() {
                let image = &scene.images[texture.image];
                let crate::Texels::Rgba8(texels) = &image.texels else { panic!("{name}: texture {index}") };
                assert_eq!(texels.len(), image.width as usize * image.height as usize, "{name}");
            }
        }
    }

    #[test]
    fn names_are_unique_and_described() {
        for (index, builtin) in all().iter().enumerate() {
            assert!(!builtin.description.is_empty() && builtin.description.len() < 120);
            assert!(all()[..index].iter().all(|other| other.name != builtin.name));
        }
    }

    #[test]
    fn numbers_are_taken_and_limited() {
        assert_eq!(load("many-lights:7").unwrap().lights.len(), 7);
        assert_eq!(load("terrain:1000").unwrap().name, "builtin:terrain:1000");
        for wrong in ["terrain:0", "terrain:x", "terrain:-3", "terrain:", "terrain:99999999999"] {
            let message = load(wrong).unwrap_err().to_string();
            assert!(message.contains("is not a number of triangles from 1 to 20000000"), "{message}");
        }
    }

    #[test]
    fn lamps_share_one_power() {
        let power = |n: u32| load(&format!("many-lights:{n}")).unwrap().lights.iter().map(|l| l.emission.luminance()).sum::<f32>();
        assert!((power(10) / power(1000) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn embers_are_counted_and_share_one_power() {
        let lights = |n: u32| {
            let scene = load(&format!("embers:{n}")).unwrap();
            crate::Snapshot::new(&scene, kajo_units::Seconds(0.0)).emissive_meshes(&scene)
        };
        for n in [1, 24, 26, 1000] {
            assert_eq!(lights(n).iter().map(|light| light.shares.len()).sum::<usize>(), n as usize);
        }
        let power = |n| lights(n).iter().map(crate::EmissiveMesh::power).sum::<f32>();
        assert!((power(10) / power(1000) - 1.0).abs() < 1e-2, "{} and {}", power(10), power(1000));
    }
}
