//! Cameras.

use glam::UVec2;
use kajo_units::{Meters, Radians};

/// Rows of an image whose size nobody chose.
const DEFAULT_ROWS: u32 = 720;

/// Shape of an image whose camera has none.
const DEFAULT_ASPECT: f32 = 16.0 / 9.0;

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

impl Camera {
    /// Size of an image where nobody chose one: 720 rows in the camera's shape, 16 : 9 where it has none, at most 10 : 1.
    pub fn default_image_size(&self) -> UVec2 {
        let aspect = match self.projection {
            Projection::Perspective { aspect, .. } => aspect.unwrap_or(DEFAULT_ASPECT),
            Projection::Orthographic { xmag, ymag } => (xmag.0 / ymag.0).abs(),
        };
        let aspect = if aspect.is_finite() { aspect.clamp(0.1, 10.0) } else { DEFAULT_ASPECT };
        UVec2::new((DEFAULT_ROWS as f32 * aspect).round() as u32, DEFAULT_ROWS)
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_camera_has_an_image_size() {
        let size = |projection| {
            let [lens_radius, focus_distance, near] = [0.0, 1.0, 0.1].map(Meters);
            Camera { name: String::new(), projection, lens_radius, focus_distance, near }.default_image_size()
        };
        let perspective = |aspect| size(Projection::Perspective { yfov: Radians(1.0), aspect });
        assert_eq!([perspective(None), perspective(Some(1.0)), perspective(Some(1e9))].map(|size| size.x), [1280, 720, 7200]);
        let orthographic = |xmag, ymag| size(Projection::Orthographic { xmag: Meters(xmag), ymag: Meters(ymag) });
        assert_eq!([orthographic(2.0, 1.0), orthographic(-1.0, 1.0), orthographic(1.0, 0.0)].map(|size| size.x), [1440, 720, 1280]);
    }
}
