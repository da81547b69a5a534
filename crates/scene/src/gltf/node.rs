//! The node hierarchy, and what stands at its nodes: cameras and lights.    glTF 2.0, sections 3.5 and 3.10; KHR_lights_punctual

use super::accessor::Selection;
use super::json::{self, Document, floats};
use super::notes::Notes;
use super::resources::{Resources, label};
use crate::{Camera, Light, LightShape, Projection, SceneError, Transform};
use glam::{Mat4, Quat, Vec3, Vec4};
use kajo_units::{Candela, LinearRgb, LuminousEfficacy, Lux, Meters, Radians};
use std::f32::consts::{FRAC_PI_2, PI};

/// Parents of all nodes, checked: no node has two, none is its own ancestor.
pub fn parents(resources: &Resources<'_>) -> Result<Vec<Option<usize>>, SceneError> {
    let nodes = &resources.document.nodes;
    let mut parents = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        let place = label("node", index, &node.name);
        for &child in &node.children {
            resources.get(nodes, "node", child, &place)?;
            if let Some(other) = parents[child].replace(index) {
                return Err(resources.invalid(label("node", child, &nodes[child].name), format!("it has two parents, {other} and {index}")));
            }
        }
    }
    // Walking up from every node, each node is passed once: a walk ends where an earlier one has been.
    let mut walk_of = vec![usize::MAX; nodes.len()];
    for (start, json) in nodes.iter().enumerate() {
        let mut node = Some(start);
        while let Some(index) = node.filter(|&index| walk_of[index] == usize::MAX) {
            walk_of[index] = start;
            node = parents[index];
        }
        if node.is_some_and(|index| walk_of[index] == start) {
            return Err(resources.invalid(label("node", start, &json.name), "it is its own ancestor"));
        }
    }
    Ok(parents)
}

/// For each node, whether the scene that is shown contains it and nothing hides it.
pub fn visible(resources: &Resources<'_>, parents: &[Option<usize>], notes: &mut Notes) -> Result<Vec<bool>, SceneError> {
    let document = resources.document;
    let roots = scene_roots(resources, parents, notes)?;
    let mut visible = vec![false; document.nodes.len()];
    let mut pending = roots;
    while let Some(node) = pending.pop() {
        let json = &document.nodes[node];
        if json.extensions.visibility.as_ref().is_none_or(|visibility| visibility.visible) && !std::mem::replace(&mut visible[node], true) {
            pending.extend(&json.children);
        }
    }
    Ok(visible)
}

/// The root nodes of the default scene, else of the first; all roots of a file without scenes.
fn scene_roots(resources: &Resources<'_>, parents: &[Option<usize>], notes: &mut Notes) -> Result<Vec<usize>, SceneError> {
    let Document { scenes, nodes, scene, .. } = resources.document;
    if scenes.is_empty() && scene.is_none() {
        return Ok((0..nodes.len()).filter(|&node| parents[node].is_none()).collect());
    }
    let shown = scene.unwrap_or(0);
    let roots = &resources.get(scenes, "scene", shown, "file")?.nodes;
    for (index, other) in scenes.iter().enumerate().filter(|&(index, _)| index != shown) {
        notes.add(label("scene", index, &other.name), "another scene", "only the default scene is shown");
    }
    let place = label("scene", shown, &scenes[shown].name);
    notes.unknown_extensions(&place, scenes[shown].extensions.keys());
    for &root in roots {
        resources.get(nodes, "node", root, &place)?;
        if let Some(parent) = parents[root] {
            return Err(resources.invalid(place, format!("it lists node {root} as a root, but that is a child of node {parent}")));
        }
    }
    Ok(roots.clone())
}

/// The transform of a node.
pub fn transform(resources: &Resources<'_>, index: usize) -> Result<Transform, SceneError> {
    let json = &resources.document.nodes[index];
    let invalid = |problem: &str| resources.invalid(label("node", index, &json.name), problem);
    if let Some(matrix) = json.matrix {
        let matrix = Mat4::from_cols_array(&floats(matrix));
        if matrix.row(3) != Vec4::W {
            return Err(invalid("the last row of its matrix is not 0, 0, 0, 1"));
        }
        return Ok(Transform::Matrix(matrix));
    }
    let rotation = json.rotation.map_or(Vec4::W, |rotation| Vec4::from(floats(rotation)));
    let rotation = rotation.try_normalize().ok_or_else(|| invalid("its rotation is not a unit quaternion"))?;
    Ok(Transform::Trs {
        translation: json.translation.map_or(Vec3::ZERO, |translation| floats(translation).into()),
        rotation: Quat::from_vec4(rotation),
        scale: json.scale.map_or(Vec3::ONE, |scale| floats(scale).into()),
    })
}

/// The transforms of EXT_mesh_gpu_instancing, each relative to the node. `node_bytes` is the memory that each of them will take.
pub fn instances(
    resources: &Resources<'_>,
    node: usize,
    instancing: &json::Instancing,
    node_bytes: u64,
    notes: &mut Notes,
) -> Result<Vec<Transform>, SceneError> {
    let place = label("node", node, &resources.document.nodes[node].name);
    let mut count = None;
    for (name, &accessor) in &instancing.attributes {
        let this = resources.count(accessor, &place)?;
        if *count.get_or_insert(this) != this {
            return Err(resources.invalid(place, "the attributes of EXT_mesh_gpu_instancing differ in their count"));
        }
        if !matches!(name.as_str(), "TRANSLATION" | "ROTATION" | "SCALE") {
            notes.add(&place, format!("EXT_mesh_gpu_instancing.{name}"), "instances differ in their transforms only");
        }
    }
    let count = count.unwrap_or(0);
    resources.budget.claim(resources.file, &place, count, node_bytes)?;
    fn attribute<const N: usize>(
        resources: &Resources<'_>,
        instancing: &json::Instancing,
        name: &str,
        place: &str,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let Some(&accessor) = instancing.attributes.get(name) else { return Ok(Vec::new()) };
        resources.floats::<N>(accessor, &format!("{name} of the instances of {place}"), Selection::All)
    }
    let translations = attribute::<3>(resources, instancing, "TRANSLATION", &place)?;
    let rotations = attribute::<4>(resources, instancing, "ROTATION", &place)?;
    let scales = attribute::<3>(resources, instancing, "SCALE", &place)?;
    Ok((0..count as usize)
        .map(|i| Transform::Trs {
            translation: translations.get(i).map_or(Vec3::ZERO, |&v| v.into()),
            rotation: rotations.get(i).map_or(Quat::IDENTITY, |&v| Quat::from_vec4(Vec4::from(v).normalize_or(Vec4::W))),
            scale: scales.get(i).map_or(Vec3::ONE, |&v| v.into()),
        })
        .collect())
}

/// The camera of index `index` as node `node` has it.
pub fn camera(resources: &Resources<'_>, notes: &mut Notes, index: usize, node: &str) -> Result<Camera, SceneError> {
    let json = resources.get(&resources.document.cameras, "camera", index, node)?;
    let place = label("camera", index, &json.name);
    notes.unknown_extensions(&place, json.extensions.keys());
    let (projection, near, far) = match (&json.perspective, &json.orthographic) {
        (Some(perspective), _) => {
            let yfov = perspective.yfov.0;
            let aspect = perspective.aspect_ratio.map(|aspect| aspect.0);
            if !(yfov > 0.0 && yfov < PI) || aspect.is_some_and(|aspect| aspect <= 0.0) || perspective.znear.0 <= 0.0 {
                return Err(resources.invalid(place, "yfov must be between 0 and π, aspectRatio and znear greater than 0"));
            }
            (Projection::Perspective { yfov: Radians(yfov), aspect }, perspective.znear.0, perspective.zfar)
        }
        (None, Some(orthographic)) => {
            let (xmag, ymag) = (orthographic.xmag.0.abs(), orthographic.ymag.0.abs());
            if xmag == 0.0 || ymag == 0.0 || orthographic.znear.0 < 0.0 {
                return Err(resources.invalid(place, "xmag and ymag must not be 0, znear not negative"));
            }
            (Projection::Orthographic { xmag: Meters(xmag), ymag: Meters(ymag) }, orthographic.znear.0, Some(orthographic.zfar))
        }
        (None, None) => return Err(resources.invalid(place, "it is neither perspective nor orthographic")),
    };
    if far.is_some() {
        notes.add(&place, "zfar", "the far plane is at infinity");
    }
    let name = first_name(&json.name, node, || format!("camera {index}"));
    Ok(Camera { name, projection, lens_radius: Meters(0.0), focus_distance: Meters(1.0), near: Meters(near) })
}

/// The punctual light of index `index` as node `node` has it.    KHR_lights_punctual
pub fn light(resources: &Resources<'_>, notes: &mut Notes, index: usize, node: &str) -> Result<Light, SceneError> {
    let lights = resources.document.extensions.lights.as_ref().map_or(&[][..], |extension| &extension.lights);
    let json = resources.get(lights, "light", index, node)?;
    let place = label("light", index, &json.name);
    notes.unknown_extensions(&place, json.extensions.keys());
    if json.range.is_some() {
        notes.add(&place, "KHR_lights_punctual.range", "the light reaches to infinity, as light does");
    }
    let color = LinearRgb(Vec3::from(floats(json.color)).max(Vec3::ZERO));
    let value = json.intensity.0.max(0.0);
    if color.0 != Vec3::from(floats(json.color)) || value != json.intensity.0 {
        notes.add(&place, "negative light", "0 is used");
    }
    let intensity = Candela(value).to_radiant_intensity(LuminousEfficacy::IMPORT).0;
    let (shape, scale) = match json.kind.as_str() {
        "point" => (LightShape::Point, intensity),
        "directional" => (LightShape::Directional { half_angle: Radians(0.0) }, Lux(value).to_irradiance(LuminousEfficacy::IMPORT).0),
        "spot" => {
            let angle = |value: Option<json::Num>, default: f32| value.map_or(default, |value| value.0);
            let spot = json.spot.as_ref();
            let inner = angle(spot.and_then(|spot| spot.inner_cone_angle), 0.0);
            let outer = angle(spot.and_then(|spot| spot.outer_cone_angle), PI / 4.0);
            if !(0.0 <= inner && inner < outer && outer <= FRAC_PI_2 + 1e-6) {
                return Err(resources.invalid(place, format!("its cone angles {inner} and {outer} do not satisfy 0 ≤ inner < outer ≤ π/2")));
            }
            (LightShape::Spot { inner: Radians(inner), outer: Radians(outer.min(FRAC_PI_2)) }, intensity)
        }
        other => {
            return Err(resources.invalid(place, format!("its type {:?} is none of directional, point and spot", super::uri::short(other))));
        }
    };
    let emission = color * scale;
    if !emission.is_finite() {
        return Err(resources.invalid(place, "color × intensity exceeds the range of 32-bit floats"));
    }
    let name = first_name(&json.name, node, || format!("light {index}"));
    Ok(Light { name, shape, emission })
}

fn first_name(own: &str, node: &str, number: impl FnOnce() -> String) -> String {
    [own, node].into_iter().find(|name| !name.is_empty()).map_or_else(number, str::to_owned)
}
