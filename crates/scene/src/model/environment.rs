//! Light from infinity.

use crate::TextureImage;
use kajo_units::{LinearRgb, Radians};
use std::sync::Arc;

/// A latitude-longitude environment: the radiance that arrives from each direction.
///
/// Column 0 of the image is at longitude −π; direction d has u = ½ + atan2(d.x, −d.z)/2π (so the centre looks along −z, and u grows to
/// the right, +x) and v = acos(d.y)/π. `image: None` is a constant environment.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Radiance, W/(m² sr), linear; row 0 is up.
    pub image: Option<Arc<TextureImage>>,
    /// Multiplies the image.
    pub scale: LinearRgb,
    /// Rotation about +y, counter-clockwise seen from above.
    pub rotation: Radians,
}
