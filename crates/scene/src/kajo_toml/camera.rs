//! `[[camera]]`

use super::format::CameraTable;
use super::placement::{ABOVE_ZERO, ANY, FROM_ZERO, Place};
use super::source::Table;
use crate::{Camera, Projection, SceneError, Transform};
use glam::Vec3;
use kajo_units::{Meters, Radians};

/// Height of the sensor of a full-frame camera, mm: what an f-number refers to where none is given.
const SENSOR_HEIGHT_MM: f32 = 24.0;

/// The camera and its place.
pub fn read(table: &Table, camera: &CameraTable, index: usize) -> Result<(Camera, Transform), SceneError> {
    let place = Place { position: camera.position, target: camera.target, direction: None, rotate_deg: camera.rotate_deg };
    let (transform, _) = place.transform(table)?;
    if camera.position.is_none() && camera.node.is_none() {
        return Err(table.error("its place is missing: give `position` with `target` or `rotate_deg`, or the `node` it stands on"));
    }
    let projection = match table.one_of(&[("yfov_deg", camera.yfov_deg), ("orthographic_height", camera.orthographic_height)])? {
        Some(("orthographic_height", height)) => {
            let ymag = table.number("orthographic_height", height, ABOVE_ZERO)? / 2.0;
            let aspect = table.number("aspect", camera.aspect.unwrap_or(1.0), ABOVE_ZERO)?;
            Projection::Orthographic { xmag: Meters(ymag * aspect), ymag: Meters(ymag) }
        }
        given => {
            let yfov = table.number("yfov_deg", given.map_or(40.0, |(_, degrees)| degrees), 0.01..=175.0)?;
            let aspect = camera.aspect.map(|aspect| table.number("aspect", aspect, ABOVE_ZERO)).transpose()?;
            Projection::Perspective { yfov: Radians::from_degrees(yfov), aspect }
        }
    };
    let name = camera.name.clone().unwrap_or_else(|| format!("camera {index}"));
    let near = Meters(table.number("near", camera.near.unwrap_or(0.01), ABOVE_ZERO)?);
    let focus_distance = Meters(focus(table, camera, transform)?);
    let lens_radius = Meters(lens(table, camera, &projection)?);
    Ok((Camera { name, projection, lens_radius, focus_distance, near }, transform))
}

/// Distance of the plane in focus along the optical axis, m: as given, else that of `target`, else 1.
fn focus(table: &Table, camera: &CameraTable, transform: Transform) -> Result<f32, SceneError> {
    let (Transform::Trs { translation, rotation, .. }, Some(point)) = (transform, camera.focus_on.or(camera.target)) else {
        return table.number("focus_distance", camera.focus_distance.unwrap_or(1.0), ABOVE_ZERO);
    };
    if let Some(distance) = camera.focus_distance {
        if camera.focus_on.is_some() {
            return Err(table.error("`focus_on` and `focus_distance` exclude each other; keep one"));
        }
        return table.number("focus_distance", distance, ABOVE_ZERO);
    }
    let point = Vec3::from_array(table.numbers("focus_on", point, ANY)?);
    let distance = (point - translation).dot(rotation * Vec3::NEG_Z);
    if distance > 0.0 && distance.is_finite() { Ok(distance) } else { Err(table.error("`focus_on` lies behind the camera")) }
}

/// Radius of the lens, m. An f-number N is focal length / diameter, and the focal length is that of a sensor of the given height.
fn lens(table: &Table, camera: &CameraTable, projection: &Projection) -> Result<f32, SceneError> {
    let given = table.one_of(&[("lens_radius", camera.lens_radius), ("f_number", camera.f_number)])?;
    if camera.sensor_height_mm.is_some() && camera.f_number.is_none() {
        return Err(table.error("`sensor_height_mm` says what `f_number` means, which is missing"));
    }
    match (given, projection) {
        (None, _) => Ok(0.0),
        (Some(("f_number", n)), Projection::Perspective { yfov, .. }) => {
            let n = table.number("f_number", n, ABOVE_ZERO)?;
            let sensor = table.number("sensor_height_mm", camera.sensor_height_mm.unwrap_or(SENSOR_HEIGHT_MM), ABOVE_ZERO)? * 1e-3;
            let focal_length = 0.5 * sensor / (0.5 * yfov.0).tan();
            Ok(0.5 * focal_length / n)
        }
        (Some(("f_number", _)), _) => Err(table.error("`f_number` belongs to a perspective camera; give `lens_radius`")),
        (Some((key, radius)), _) => table.number(key, radius, FROM_ZERO),
    }
}
