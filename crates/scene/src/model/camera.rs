//! Cameras.

use kajo_units::{Meters, Radians};

/// A camera. Its node places it: it looks along the node's −z axis with +y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The name `--camera` takes.
    pub name: String,
    /// Projection.
    pub projection: Projection,
    /// Radius of the thin lens; 0 is a pinhole.
    pub lens_radius: Meters,
    /// Distance of the plane in focus, along the optical axis.
    pub focus_distance: Meters,
    /// Distance of the near plane; the renderers use a far plane at infinity (reversed z).
    pub near: Meters,
}

/// How directions map to the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Perspective.
    Perspective {
        /// Vertical field of view, full angle.
        yfov: Radians,
        /// Width / height the camera was made for; `None` takes the image's. An image of another shape keeps `yfov`.
        aspect: Option<f32>,
    },
    /// Parallel projection.
    Orthographic {
        /// Half the width, m.
        xmag: Meters,
        /// Half the height, m.
        ymag: Meters,
    },
}
