//! Where assets, lights and cameras stand.

use super::source::Table;
use crate::{SceneError, Transform};
use glam::{EulerRot, Mat3, Quat, Vec3};

/// Any finite number.
pub const ANY: std::ops::RangeInclusive<f32> = f32::MIN..=f32::MAX;
/// A finite number above zero.
pub const ABOVE_ZERO: std::ops::RangeInclusive<f32> = f32::MIN_POSITIVE..=f32::MAX;
/// A finite number of zero or more.
pub const FROM_ZERO: std::ops::RangeInclusive<f32> = 0.0..=f32::MAX;

/// A turn about x, then y, then z, about fixed axes, in degrees: R_z · R_y · R_x.
pub fn rotation(table: &Table, rotate_deg: Option<[f32; 3]>) -> Result<Quat, SceneError> {
    let [x, y, z] = table.numbers("rotate_deg", rotate_deg.unwrap_or_default(), ANY)?.map(f32::to_radians);
    Ok(Quat::from_euler(EulerRot::ZYX, z, y, x))
}

/// The rotation of something whose −z points along `direction` and whose +y points up as far as that allows.
pub fn facing(table: &Table, key: &str, direction: Vec3) -> Result<Quat, SceneError> {
    let Some(back) = (-direction).try_normalize() else {
        return Err(table.error(format!("`{key}` gives no direction; move it away from `position`")));
    };
    let up = if back.y.abs() > 0.9999 { Vec3::NEG_Z } else { Vec3::Y };
    let right = up.cross(back).normalize();
    Ok(Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back)))
}

/// The place of a light or a camera from its keys.
pub struct Place {
    pub position: Option<[f32; 3]>,
    pub target: Option<[f32; 3]>,
    pub direction: Option<[f32; 3]>,
    pub rotate_deg: Option<[f32; 3]>,
}

impl Place {
    /// The transform, and whether a direction was given.
    pub fn transform(&self, table: &Table) -> Result<(Transform, bool), SceneError> {
        let ways = [("target", self.target), ("direction", self.direction), ("rotate_deg", self.rotate_deg)];
        let way = table.one_of(&ways)?;
        let translation = Vec3::from_array(table.numbers("position", self.position.unwrap_or_default(), ANY)?);
        let rotation = match way {
            None => Quat::IDENTITY,
            Some((key @ "target", target)) => facing(table, key, Vec3::from_array(table.numbers(key, target, ANY)?) - translation)?,
            Some((key @ "direction", direction)) => facing(table, key, Vec3::from_array(table.numbers(key, direction, ANY)?))?,
            Some((_, rotate)) => rotation(table, Some(rotate))?,
        };
        Ok((Transform::Trs { translation, rotation, scale: Vec3::ONE }, way.is_some()))
    }
}
