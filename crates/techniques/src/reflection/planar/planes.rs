//! The flat mirrors of a scene: its largest smooth surfaces that lie in one plane.

use glam::{IVec4, Vec3};
use kajo_scene::{AlphaMode, Material, Scene, Snapshot};
use std::collections::HashMap;

/// A plane n · x = height, world, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    /// Unit.
    pub normal: Vec3,
    /// m.
    pub height: f32,
    /// Of the smooth surfaces that lie in it, m².
    pub area: f32,
}

/// What [`find`] found.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Mirrors {
    /// Largest first.
    pub planes: Vec<Plane>,
    /// Area of the smooth surfaces in no plane of the list, m².
    pub left_out: f32,
}

/// Planes whose normals differ by less are one.
const TOLERANCE: f32 = 1e-3;

/// Planes whose heights differ by less are one, in units of the size of the scene: no farther apart than what the shader takes for a plane.
const HEIGHT_TOLERANCE: f32 = 1e-5;

/// Area below which a plane counts as a facet of something curved, in units of the square of the scene's size.
const FACET: f32 = 1e-3;

/// The `most` largest planes of surfaces up to `max_roughness`; `size` is the diagonal of the box around the scene, m.
pub(super) fn find(scene: &Scene, snapshot: &Snapshot, size: f32, max_roughness: f32, most: usize) -> Mirrors {
    let mut cells: HashMap<IVec4, Plane> = HashMap::new();
    let unit = HEIGHT_TOLERANCE * size.max(1e-6);
    for instance in &snapshot.instances {
        let mesh = &snapshot.meshes[instance.mesh];
        if !scene.materials.get(mesh.material).is_some_and(|material| is_mirror(material, max_roughness)) {
            continue;
        }
        let at = |i: u32| instance.world_from_object.transform_point3(mesh.positions[i as usize]);
        for &[a, b, c] in &mesh.indices {
            let (a, b, c) = (at(a), at(b), at(c));
            let cross = (b - a).cross(c - a);
            let (Some(normal), area) = (cross.try_normalize(), 0.5 * cross.length()) else { continue };
            // Either side of a plane is a mirror.
            let first = normal.to_array().into_iter().find(|v| v.abs() > 0.1).unwrap_or(1.0);
            let normal = normal * first.signum();
            let height = normal.dot(a);
            let key = (normal / TOLERANCE).round().as_ivec3().extend((height / unit).round() as i32);
            cells.entry(key).or_insert(Plane { normal, height, area: 0.0 }).area += area;
        }
    }
    let mut all: Vec<Plane> = cells.into_values().collect();
    let order = |a: &Plane, b: &Plane| {
        let tie = |p: &Plane| [p.height, p.normal.x, p.normal.y, p.normal.z];
        b.area.total_cmp(&a.area).then_with(|| tie(a).partial_cmp(&tie(b)).unwrap_or(std::cmp::Ordering::Equal))
    };
    all.sort_by(order);
    // Rounding may have put one plane into neighbouring cells.
    let mut planes: Vec<Plane> = Vec::new();
    let mut small = 0.0;
    for plane in all {
        let same = |p: &&mut Plane| p.normal.distance(plane.normal) < 2.0 * TOLERANCE && (p.height - plane.height).abs() < 2.0 * unit;
        match planes.iter_mut().find(same) {
            Some(found) => found.area += plane.area,
            None if plane.area >= FACET * size * size => planes.push(plane),
            None => small += plane.area,
        }
    }
    planes.sort_by(order);
    let left_out = small + planes.iter().skip(most).map(|plane| plane.area).sum::<f32>();
    planes.truncate(most);
    Mirrors { planes, left_out }
}

/// Whether a material is smooth wherever it is flat.
fn is_mirror(material: &Material, max_roughness: f32) -> bool {
    let reflects = material.metallic > 0.0 || material.specular > 0.0;
    let flat = material.normal_texture.is_none() && material.model.is_none() && !material.unlit;
    reflects && flat && material.alpha_mode != AlphaMode::Blend && material.roughness <= max_roughness
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_scene::builtin;
    use kajo_units::Seconds;

    fn mirrors(name: &str, max_roughness: f32, most: usize) -> Mirrors {
        let scene = builtin::load(name).unwrap();
        find(&scene, &Snapshot::new(&scene, Seconds(0.0)), 8.0, max_roughness, most)
    }

    #[test]
    fn the_mirrors_of_the_mirror_room_are_found() {
        let found = mirrors("mirror-room", 0.1, 4);
        assert_eq!(found.planes.len(), 2, "{found:?}");
        let [left, back] = [found.planes[0], found.planes[1]];
        assert!((left.area - 3.0 * 1.9).abs() < 1e-3 && (left.normal.x.abs() - 1.0).abs() < 1e-5, "{left:?}");
        assert!((back.area - 1.4 * 1.7).abs() < 1e-3 && (back.height * back.normal.z + 2.97).abs() < 1e-3, "{back:?}");
        assert_eq!(found.left_out, 0.0);
    }

    #[test]
    fn what_is_beyond_the_number_is_told() {
        let found = mirrors("mirror-room", 0.1, 1);
        assert!(found.planes.len() == 1 && (found.left_out - 1.4 * 1.7).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn curved_surfaces_are_no_planes() {
        // The red sphere and the red column are as smooth as that: of them only the ends of the column are flat.
        let found = mirrors("mirror-room", 0.3, 8);
        assert_eq!(found.planes.len(), 4, "{found:?}");
        assert!(found.planes[2..].iter().all(|end| end.normal.y.abs() > 0.999), "{found:?}");
        let curved = std::f32::consts::PI * (4.0 * 0.4 * 0.4 + 2.0 * 0.22 * 1.8);
        assert!((found.left_out / curved - 1.0).abs() < 0.02, "{found:?}");
    }
}
