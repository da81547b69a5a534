//! Local transforms and morph weights at one time: rest values, replaced where the animation drives them.

use super::placement::parent_from_local;
use crate::{Channel, Interpolation, Property, Scene, Transform};
use glam::{Affine3A, Quat, Vec3, Vec4};
use kajo_units::Seconds;

/// The state of every node.
pub(super) struct Pose {
    /// Local transforms.
    pub parent_from_node: Vec<Affine3A>,
    /// Weights of the morph targets of the node's meshes; empty where each mesh keeps its own.
    pub morph_weights: Vec<Vec<f32>>,
}

impl Pose {
    /// Samples the animation that plays.
    pub fn sample(scene: &Scene, time: Seconds) -> Self {
        let mut transforms: Vec<Transform> = scene.nodes.iter().map(|node| node.transform).collect();
        let mut morph_weights: Vec<Vec<f32>> = scene.nodes.iter().map(|node| node.morph_weights.clone()).collect();
        for channel in scene.animations.get(scene.animation).map_or(&[][..], |animation| &animation.channels) {
            let value = sample(channel, time.0);
            if channel.property == Property::MorphWeights {
                morph_weights[channel.node] = value;
            } else if let Transform::Trs { translation, rotation, scale } = &mut transforms[channel.node] {
                match channel.property {
                    Property::Translation => *translation = Vec3::from_slice(&value),
                    Property::Scale => *scale = Vec3::from_slice(&value),
                    Property::Rotation => *rotation = unit(&value),
                    Property::MorphWeights => unreachable!("handled above"),
                }
            }
        }
        Self { parent_from_node: transforms.iter().map(parent_from_local).collect(), morph_weights }
    }
}

/// The value of a channel at `time`; held before the first key and after the last.    glTF 2.0, section 3.11 and appendix C
fn sample(channel: &Channel, time: f32) -> Vec<f32> {
    let after = channel.times.partition_point(|&key| key <= time);
    let last = channel.times.len() - 1;
    let key = after.saturating_sub(1).min(last);
    if after == 0 || after > last || channel.interpolation == Interpolation::Step {
        return value(channel, key).to_vec();
    }
    let interval = channel.times[after] - channel.times[key];
    let t = (time - channel.times[key]) / interval;
    match (channel.interpolation, channel.property) {
        (Interpolation::CubicSpline, _) => cubic(channel, key, t, interval),
        (_, Property::Rotation) => unit(value(channel, key)).slerp(unit(value(channel, after)), t).to_array().to_vec(),
        _ => value(channel, key).iter().zip(value(channel, after)).map(|(a, b)| a + (b - a) * t).collect(),
    }
}

/// Cubic Hermite spline between keys k and k + 1, tangents scaled by the interval d:
///
/// ```text
/// p(t) = (2t³ − 3t² + 1) vₖ + d (t³ − 2t² + t) bₖ + (−2t³ + 3t²) vₖ₊₁ + d (t³ − t²) aₖ₊₁       glTF 2.0, appendix C.5
/// ```
///
/// with values v, out-tangents b and in-tangents a.
fn cubic(channel: &Channel, key: usize, t: f32, interval: f32) -> Vec<f32> {
    let (t2, t3) = (t * t, t * t * t);
    let from = 2.0 * t3 - 3.0 * t2 + 1.0;
    let out_tangent = &triple(channel, key)[2];
    let in_tangent = &triple(channel, key + 1)[0];
    (0..value(channel, key).len())
        .map(|i| {
            from * value(channel, key)[i]
                + interval * (t3 - 2.0 * t2 + t) * out_tangent[i]
                + (1.0 - from) * value(channel, key + 1)[i]
                + interval * (t3 - t2) * in_tangent[i]
        })
        .collect()
}

/// The value of a key, without its tangents.
fn value(channel: &Channel, key: usize) -> &[f32] {
    if channel.interpolation == Interpolation::CubicSpline {
        triple(channel, key)[1]
    } else {
        let width = channel.values.len() / channel.times.len();
        &channel.values[key * width..][..width]
    }
}

/// In-tangent, value and out-tangent of a cubic-spline key.
fn triple(channel: &Channel, key: usize) -> [&[f32]; 3] {
    let width = channel.values.len() / channel.times.len() / 3;
    [0, 1, 2].map(|part| &channel.values[(3 * key + part) * width..][..width])
}

/// The unit quaternion nearest to four numbers; the identity where they are all 0.
fn unit(xyzw: &[f32]) -> Quat {
    Quat::from_vec4(Vec4::from_slice(xyzw).normalize_or(Vec4::W))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(property: Property, interpolation: Interpolation, times: &[f32], values: &[f32]) -> Channel {
        Channel { node: 0, property, interpolation, times: times.to_vec(), values: values.to_vec() }
    }

    #[test]
    fn keys_are_met_exactly_and_held_outside() {
        let linear = channel(Property::Translation, Interpolation::Linear, &[1.0, 2.0], &[0.0, 0.0, 0.0, 4.0, 8.0, -2.0]);
        assert_eq!(sample(&linear, -3.0), [0.0, 0.0, 0.0]);
        assert_eq!(sample(&linear, 1.0), [0.0, 0.0, 0.0]);
        assert_eq!(sample(&linear, 1.25), [1.0, 2.0, -0.5]);
        assert_eq!(sample(&linear, 2.0), [4.0, 8.0, -2.0]);
        assert_eq!(sample(&linear, 99.0), [4.0, 8.0, -2.0]);
        assert_eq!(sample(&linear, f32::NAN), [0.0, 0.0, 0.0]);
    }

    #[test]
    fn step_holds_the_earlier_key() {
        let step = channel(Property::Translation, Interpolation::Step, &[0.0, 1.0], &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
        assert_eq!(sample(&step, 0.999), [1.0; 3]);
        assert_eq!(sample(&step, 1.0), [2.0; 3]);
    }

    /// A quarter of the way from 0 to 120° is 30°, at constant angular speed; linear blending would give 25.7°.
    #[test]
    fn rotations_are_spherical_and_take_the_short_way() {
        let end = Quat::from_rotation_y(120f32.to_radians());
        for sign in [1.0, -1.0] {
            let end = end * sign;
            let rotation =
                channel(Property::Rotation, Interpolation::Linear, &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, end.x, end.y, end.z, end.w]);
            let quarter = unit(&sample(&rotation, 0.25));
            assert!(quarter.angle_between(Quat::from_rotation_y(30f32.to_radians())) < 1e-3, "{quarter:?}");
            assert!((quarter.length() - 1.0).abs() < 1e-6);
        }
    }

    /// A Hermite spline reproduces any cubic from its values and slopes: here f(t) = t³ − 2t² + 3 on keys 1 and 3.
    #[test]
    fn cubic_spline_reproduces_a_cubic() {
        let f = |t: f32| t * t * t - 2.0 * t * t + 3.0;
        let slope = |t: f32| 3.0 * t * t - 4.0 * t;
        let key = |t: f32| [[slope(t); 3], [f(t); 3], [slope(t); 3]].concat();
        let spline = channel(Property::Translation, Interpolation::CubicSpline, &[1.0, 3.0], &[key(1.0), key(3.0)].concat());
        for t in [1.0, 1.3, 2.0, 2.9, 3.0] {
            assert!((sample(&spline, t)[1] - f(t)).abs() < 1e-4, "at {t}: {} instead of {}", sample(&spline, t)[1], f(t));
        }
    }

    #[test]
    fn morph_weights_have_the_width_of_the_targets() {
        let weights = channel(Property::MorphWeights, Interpolation::Linear, &[0.0, 1.0], &[0.0, 1.0, 0.5, 1.0, 0.0, 0.5]);
        assert_eq!(sample(&weights, 0.5), [0.5, 0.5, 0.5]);
    }
}
