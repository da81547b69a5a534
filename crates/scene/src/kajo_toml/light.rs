//! `[[light]]`: shapes, and strengths in the units that people measure.

use super::format::{LightKind, LightTable};
use super::placement::{ABOVE_ZERO, FROM_ZERO, Place};
use super::source::Table;
use crate::{Light, LightShape, SceneError, Transform};
use kajo_units::{Candela, LinearRgb, Lumens, LuminousEfficacy, Lux, Meters, Nits, Radians};
use std::f32::consts::PI;

/// The light and its place.
pub fn read(table: &Table, light: &LightTable, index: usize) -> Result<(Light, Transform), SceneError> {
    let shape = shape(table, light)?;
    let place = Place { position: light.position, target: light.target, direction: light.direction, rotate_deg: light.rotate_deg };
    let (transform, directed) = place.transform(table)?;
    let needs_direction = !matches!(light.kind, LightKind::Point | LightKind::Sphere);
    if needs_direction && !directed && light.node.is_none() {
        return Err(table.error(format!("a {} light shines somewhere: give `target`, `direction` or `rotate_deg`", shape.name())));
    }
    let color = table.numbers("color", light.color.map_or([1.0; 3], |c| c.0), FROM_ZERO)?;
    let strength = strength(table, light, &shape)?;
    let name = light.name.clone().unwrap_or_else(|| format!("light {index}"));
    Ok((Light { name, shape, emission: LinearRgb(color.into()) * strength }, transform))
}

fn shape(table: &Table, light: &LightTable) -> Result<LightShape, SceneError> {
    let allowed: &[&str] = match light.kind {
        LightKind::Point => &[],
        LightKind::Spot => &["inner_deg", "outer_deg"],
        LightKind::Directional => &["half_angle_deg"],
        LightKind::Rectangle => &["width", "height"],
        LightKind::Disk | LightKind::Sphere => &["radius"],
    };
    let sizes = [
        ("width", light.width),
        ("height", light.height),
        ("radius", light.radius),
        ("inner_deg", light.inner_deg),
        ("outer_deg", light.outer_deg),
        ("half_angle_deg", light.half_angle_deg),
    ];
    if let Some((key, _)) = sizes.iter().find(|(key, value)| value.is_some() && !allowed.contains(key)) {
        return Err(table.error(format!("`{key}` does not belong to a light of this type; remove it")));
    }
    let length = |key, value: Option<f32>| match value {
        Some(value) => table.number(key, value, ABOVE_ZERO).map(Meters),
        None => Err(table.error(format!("`{key}` is missing; give it in metres"))),
    };
    Ok(match light.kind {
        LightKind::Point => LightShape::Point,
        LightKind::Spot => {
            let outer = table.number("outer_deg", light.outer_deg.unwrap_or(45.0), f32::MIN_POSITIVE..=90.0)?;
            let inner = table.number("inner_deg", light.inner_deg.unwrap_or(0.0), 0.0..=outer)?;
            LightShape::Spot { inner: Radians::from_degrees(inner), outer: Radians::from_degrees(outer) }
        }
        LightKind::Directional => {
            let half_angle = table.number("half_angle_deg", light.half_angle_deg.unwrap_or(0.0), 0.0..=90.0)?;
            LightShape::Directional { half_angle: Radians::from_degrees(half_angle) }
        }
        LightKind::Rectangle => LightShape::Rectangle { width: length("width", light.width)?, height: length("height", light.height)? },
        LightKind::Disk => LightShape::Disk { radius: length("radius", light.radius)? },
        LightKind::Sphere => LightShape::Sphere { radius: length("radius", light.radius)? },
    })
}

/// The factor of the colour, in the unit of the shape's emission. Photometric values come in with [`LuminousEfficacy::IMPORT`].
fn strength(table: &Table, light: &LightTable, shape: &LightShape) -> Result<f32, SceneError> {
    let keys = [
        ("lumens", light.lumens),
        ("candela", light.candela),
        ("lux", light.lux),
        ("nits", light.nits),
        ("watts", light.watts),
        ("intensity", light.intensity),
        ("irradiance", light.irradiance),
        ("radiance", light.radiance),
    ];
    let allowed: &[&str] = match shape {
        LightShape::Point | LightShape::Spot { .. } => &["lumens", "candela", "watts", "intensity"],
        LightShape::Directional { .. } => &["lux", "irradiance"],
        LightShape::Rectangle { .. } | LightShape::Disk { .. } | LightShape::Sphere { .. } => &["lumens", "nits", "watts", "radiance"],
    };
    let list = || allowed.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", ");
    let Some((key, value)) = table.one_of(&keys)? else {
        return Err(table.error(format!("its strength is missing; give one of {}", list())));
    };
    if !allowed.contains(&key) {
        return Err(table.error(format!("`{key}` is no strength of a {} light; give one of {}", shape.name(), list())));
    }
    let value = table.number(key, value, FROM_ZERO)?;
    let efficacy = LuminousEfficacy::IMPORT;
    Ok(match key {
        "lumens" => flux(Lumens(value), shape).0,
        // With one watt for a lumen, a radiant flux is spread over a shape as a luminous one is.
        "watts" => flux(Lumens(value * efficacy.0), shape).0,
        "candela" => Candela(value).to_radiant_intensity(efficacy).0,
        "lux" => Lux(value).to_irradiance(efficacy).0,
        "nits" => Nits(value).to_radiance(efficacy).0,
        _ => value,
    })
}

/// Emission of a shape with the given flux, in the unit of the shape.
struct Emission(f32);

fn flux(flux: Lumens, shape: &LightShape) -> Emission {
    let efficacy = LuminousEfficacy::IMPORT;
    let area = match *shape {
        LightShape::Point => return Emission(flux.to_candela_isotropic().to_radiant_intensity(efficacy).0),
        LightShape::Spot { inner, outer } => return Emission(flux.to_candela_spot(inner, outer).to_radiant_intensity(efficacy).0),
        LightShape::Directional { .. } => unreachable!("a directional light has no flux; refused before"),
        LightShape::Rectangle { width, height } => width.0 * height.0,
        LightShape::Disk { radius } => PI * radius.0 * radius.0,
        LightShape::Sphere { radius } => 4.0 * PI * radius.0 * radius.0,
    };
    Emission(flux.to_nits_lambertian(area).to_radiance(efficacy).0)
}
