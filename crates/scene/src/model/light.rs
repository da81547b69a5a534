//! Analytic lights.

use kajo_units::{LinearRgb, Meters, Radians};

/// An analytic light. Its node places it: it stands at the node's origin and shines along the node's −z axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// For messages and per-light images.
    pub name: String,
    /// Geometry.
    pub shape: LightShape,
    /// What it emits, colour included; the unit depends on the shape, see [`LightShape`].
    pub emission: LinearRgb,
}

/// Geometry of a light, and what [`Light::emission`] means for it. Areas emit on the side their −z axis points to (a sphere outwards),
/// and are visible to cameras and reflections; scaling a node scales its areas. They have no surface: light passes them, and nothing
/// reflects from them. A lamp that does is a light before a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightShape {
    /// Point; emission is radiant intensity, W/sr.
    Point,
    /// Point with a cone around −z: full intensity inside `inner`, none outside `outer`, both half angles; emission is radiant
    /// intensity on the axis, W/sr. Falloff between them as KHR_lights_punctual gives it.
    Spot {
        /// Half angle where the falloff starts.
        inner: Radians,
        /// Half angle where the light ends, at most π/2.
        outer: Radians,
    },
    /// Light from infinity travelling along −z; emission is irradiance on a surface that faces it, W/m².
    Directional {
        /// Half angle of the disk it fills in the sky; 0 is a parallel light (the sun: 0.00465 rad).
        half_angle: Radians,
    },
    /// Rectangle in the node's xy plane, centred; emission is radiance, W/(m² sr).
    Rectangle {
        /// Extent along x.
        width: Meters,
        /// Extent along y.
        height: Meters,
    },
    /// Disk in the node's xy plane, centred; emission is radiance, W/(m² sr).
    Disk {
        /// Radius.
        radius: Meters,
    },
    /// Sphere around the node's origin; emission is radiance, W/(m² sr).
    Sphere {
        /// Radius.
        radius: Meters,
    },
}
