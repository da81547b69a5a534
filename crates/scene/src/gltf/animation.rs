//! Skins and animations.    glTF 2.0, sections 3.7.3 and 3.11

use super::accessor::Selection;
use super::json;
use super::notes::Notes;
use super::resources::{Resources, label};
use crate::{Animation, Channel, Interpolation, Property, SceneError, Skin};
use glam::Mat4;

/// The skin of index `index`.
pub fn read_skin(resources: &Resources<'_>, index: usize) -> Result<Skin, SceneError> {
    let json = &resources.document.skins[index];
    let place = label("skin", index, &json.name);
    for &joint in &json.joints {
        resources.get(&resources.document.nodes, "node", joint, &place)?;
    }
    if json.joints.len() > usize::from(u16::MAX) {
        return Err(resources.invalid(place, format!("{} joints exceed the limit of 65535", json.joints.len())));
    }
    let inverse_bind = match json.inverse_bind_matrices {
        None => vec![Mat4::IDENTITY; json.joints.len()],
        Some(accessor) => {
            let purpose = format!("inverseBindMatrices of {place}");
            let matrices = resources.floats::<16>(accessor, &purpose, Selection::All)?;
            if matrices.len() < json.joints.len() {
                let problem = format!("it has {} inverse bind matrices for {} joints", matrices.len(), json.joints.len());
                return Err(resources.invalid(place, problem));
            }
            matrices[..json.joints.len()].iter().map(Mat4::from_cols_array).collect()
        }
    };
    Ok(Skin { joints: json.joints.clone(), inverse_bind })
}

/// What an animation must know of the nodes of the scene.
pub struct AnimatedNode {
    /// A node whose transform is a matrix cannot be animated.
    pub has_matrix: bool,
    /// Morph targets of its mesh.
    pub morph_targets: usize,
}

/// The animation of index `index`.
pub fn read_animation(resources: &Resources<'_>, notes: &mut Notes, index: usize, nodes: &[AnimatedNode]) -> Result<Animation, SceneError> {
    let json = &resources.document.animations[index];
    let place = label("animation", index, &json.name);
    let mut channels = Vec::with_capacity(json.channels.len());
    for (number, channel) in json.channels.iter().enumerate() {
        channels.extend(read_channel(resources, notes, json, channel, &format!("{place}, channel {number}"), nodes)?);
    }
    let name = if json.name.is_empty() { format!("animation {index}") } else { json.name.clone() };
    Ok(Animation { name, channels })
}

fn read_channel(
    resources: &Resources<'_>,
    notes: &mut Notes,
    animation: &json::Animation,
    channel: &json::Channel,
    place: &str,
    nodes: &[AnimatedNode],
) -> Result<Option<Channel>, SceneError> {
    let mut ignore = |feature: &str, consequence: &str| {
        notes.add(place, feature, consequence);
        Ok(None)
    };
    let property = match channel.target.path.as_str() {
        "translation" => Property::Translation,
        "rotation" => Property::Rotation,
        "scale" => Property::Scale,
        "weights" => Property::MorphWeights,
        "pointer" => return ignore("KHR_animation_pointer", super::extensions::consequence("KHR_animation_pointer")),
        other => return Err(resources.invalid(place, format!("its path {:?} is not known", super::uri::short(other)))),
    };
    let Some(node) = channel.target.node else { return ignore("a target without a node", "this channel moves nothing") };
    let target = resources.get(nodes, "node", node, place)?;
    let width = match property {
        Property::MorphWeights if target.morph_targets == 0 => {
            return ignore("weights of a node without morph targets", "this channel moves nothing");
        }
        _ if property != Property::MorphWeights && target.has_matrix => {
            return ignore("a channel of a node with a matrix", "only nodes with translation, rotation and scale can move");
        }
        Property::MorphWeights => target.morph_targets,
        Property::Rotation => 4,
        Property::Translation | Property::Scale => 3,
    };

    let sampler = resources.get(&animation.samplers, "sampler", channel.sampler, place)?;
    let interpolation = match sampler.interpolation.as_deref() {
        None | Some("LINEAR") => Interpolation::Linear,
        Some("STEP") => Interpolation::Step,
        Some("CUBICSPLINE") => Interpolation::CubicSpline,
        Some(other) => return Err(resources.invalid(place, format!("its interpolation {:?} is not known", super::uri::short(other)))),
    };
    let times: Vec<f32> =
        resources.floats::<1>(sampler.input, &format!("times of {place}"), Selection::All)?.into_iter().flatten().collect();
    if times.is_empty() || !times.is_sorted_by(|a, b| a < b) {
        return Err(resources.invalid(place, "its key times are not strictly increasing"));
    }
    let purpose = format!("values of {place}");
    let values: Vec<f32> = match property {
        Property::Translation | Property::Scale => flat(resources.floats::<3>(sampler.output, &purpose, Selection::All)?),
        Property::Rotation => flat(resources.floats::<4>(sampler.output, &purpose, Selection::All)?),
        Property::MorphWeights => flat(resources.floats::<1>(sampler.output, &purpose, Selection::All)?),
    };
    let per_key = if interpolation == Interpolation::CubicSpline { 3 * width } else { width };
    if times.len().checked_mul(per_key) != Some(values.len()) {
        let problem = format!("its {} key times need {per_key} numbers each, but there are {}", times.len(), values.len());
        return Err(resources.invalid(place, problem));
    }
    Ok(Some(Channel { node, property, interpolation, times, values }))
}

fn flat<const N: usize>(values: Vec<[f32; N]>) -> Vec<f32> {
    values.into_flattened()
}
