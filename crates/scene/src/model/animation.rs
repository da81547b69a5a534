//! Key-framed animation of nodes.    glTF 2.0, section 3.11 and appendix C

/// A named set of channels that play together.
#[derive(Clone, Debug, Default)]
pub struct Animation {
    /// For messages.
    pub name: String,
    /// What it moves.
    pub channels: Vec<Channel>,
}

/// Key frames of one property of one node.
#[derive(Clone, Debug)]
pub struct Channel {
    /// Index into [`Scene::nodes`](crate::Scene::nodes).
    pub node: usize,
    /// What it drives.
    pub property: Property,
    /// Between key frames.
    pub interpolation: Interpolation,
    /// Key times, s, strictly increasing; values before the first and after the last are held.
    pub times: Vec<f32>,
    /// Components of each key, flat: 3, 4 (xyzw) or the number of morph targets; three times as many (in-tangent, value, out-tangent)
    /// for cubic splines.
    pub values: Vec<f32>,
}

/// The animated property of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Property {
    /// Translation, 3 components.
    Translation,
    /// Rotation, a quaternion xyzw.
    Rotation,
    /// Scale, 3 components.
    Scale,
    /// Weights of the morph targets.
    MorphWeights,
}

/// Interpolation between keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Hold the earlier key.
    Step,
    /// Linear; spherical for rotations.
    Linear,
    /// Cubic Hermite with tangents.
    CubicSpline,
}
