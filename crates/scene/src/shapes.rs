//! Triangle meshes of simple bodies, in their own object space, with normals, tangents and texture coordinates.
//!
//! Closed bodies are watertight: where two patches or the two ends of a seam meet, their positions are equal to the last bit. Every
//! patch runs s to the right and t up when seen from its front, has texture coordinates (s, 1 − t), and tangents along s; so the
//! bitangent points up in the image, as glTF wants it.

use crate::Mesh;
use glam::{Quat, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A vertex of a patch: position, unit normal, direction of growing s (need not be unit).
type PatchVertex = (Vec3, Vec3, Vec3);

/// A grid of `columns × rows` quads over (s, t) in [0, 1]², two triangles each; triangles without area (poles) are left out.
fn patch(mesh: &mut Mesh, [columns, rows]: [u32; 2], vertex: impl Fn(f32, f32) -> PatchVertex) {
    let base = mesh.positions.len() as u32;
    for row in 0..=rows {
        for column in 0..=columns {
            let (s, t) = (column as f32 / columns as f32, row as f32 / rows as f32);
            let (position, normal, along_s) = vertex(s, t);
            mesh.positions.push(position);
            mesh.normals.push(normal);
            let tangent = (along_s - normal * normal.dot(along_s)).normalize_or(normal.any_orthonormal_vector());
            mesh.tangents.push(tangent.extend(1.0));
            mesh.uvs[0].push(Vec2::new(s, 1.0 - t));
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = base + row * (columns + 1) + column;
            let (b, c, d) = (a + 1, a + columns + 2, a + columns + 1);
            for triangle in [[a, b, c], [a, c, d]] {
                let [p, q, r] = triangle.map(|i| mesh.positions[i as usize]);
                if p != q && q != r && r != p {
                    mesh.indices.push(triangle);
                }
            }
        }
    }
}

/// The point (cos, sin) of a full turn, equal at its two ends.
fn turn(s: f32) -> Vec2 {
    let (sin, cos) = (s.fract() * TAU).sin_cos();
    Vec2::new(cos, sin)
}

/// (cos, sin) of the latitude from −π/2 at t = 0 to π/2 at t = 1; exact at the poles.
fn latitude(t: f32) -> Vec2 {
    match t {
        0.0 => -Vec2::Y,
        1.0 => Vec2::Y,
        _ => Vec2::from_angle((t - 0.5) * PI),
    }
}

/// A rectangle in the xy plane, centred, front towards +z.
pub fn rectangle(width: f32, height: f32) -> Mesh {
    let mut mesh = Mesh { name: "rectangle".into(), ..Mesh::default() };
    patch(&mut mesh, [1, 1], |s, t| (Vec3::new((s - 0.5) * width, (t - 0.5) * height, 0.0), Vec3::Z, Vec3::X));
    mesh
}

/// A rectangle in the xz plane, centred, front towards +y; `repeat` times its texture along each axis.
pub fn floor(width: f32, depth: f32, repeat: f32) -> Mesh {
    let mut mesh = Mesh { name: "floor".into(), ..Mesh::default() };
    patch(&mut mesh, [1, 1], |s, t| (Vec3::new((s - 0.5) * width, 0.0, (0.5 - t) * depth), Vec3::Y, Vec3::X));
    mesh.uvs[0].iter_mut().for_each(|uv| *uv *= repeat);
    mesh
}

/// A box of the given half extents, centred, each face with the whole texture. Closed.
pub fn cuboid(half: Vec3) -> Mesh {
    let mut mesh = Mesh { name: "box".into(), ..Mesh::default() };
    for [right, up] in CUBE_FACES {
        let normal = right.cross(up);
        patch(&mut mesh, [1, 1], |s, t| ((normal + right * (2.0 * s - 1.0) + up * (2.0 * t - 1.0)) * half, normal, right));
    }
    mesh
}

/// A box of the given half extents whose edges and corners are rounded with `radius`, in `segments` steps a quarter. Closed.
///
/// `radius` is limited to the smallest half extent.
pub fn rounded_cuboid(half: Vec3, radius: f32, segments: u32) -> Mesh {
    let radius = radius.min(half.min_element());
    let core = half - radius;
    // Along an axis: offsets in units of (core, radius); the arc of a face ends where the neighbour's begins, at 45 degrees.
    let stop = |k: u32| if k == segments { 1.0 } else { (k as f32 / segments as f32 * PI / 4.0).tan() };
    let steps = 2 * segments + 1;
    let offset = |k: u32| if k <= segments { (-1.0, -stop(segments - k)) } else { (1.0, stop(k - segments - 1)) };
    let mut mesh = Mesh { name: "rounded box".into(), ..Mesh::default() };
    for [right, up] in CUBE_FACES {
        let normal = right.cross(up);
        patch(&mut mesh, [steps; 2], |s, t| {
            let ((core_s, arc_s), (core_t, arc_t)) = (offset((s * steps as f32).round() as u32), offset((t * steps as f32).round() as u32));
            let direction = (normal + right * arc_s + up * arc_t).normalize();
            ((normal + right * core_s + up * core_t) * core + direction * radius, direction, right)
        });
    }
    mesh
}

/// The right and up directions of the six faces of a box, front outwards.
const CUBE_FACES: [[Vec3; 2]; 6] =
    [[Vec3::NEG_Z, Vec3::Y], [Vec3::Z, Vec3::Y], [Vec3::X, Vec3::NEG_Z], [Vec3::X, Vec3::Z], [Vec3::X, Vec3::Y], [Vec3::NEG_X, Vec3::Y]];

/// A sphere around the origin, `segments` along the equator and half as many along a meridian. Closed.
pub fn sphere(radius: f32, segments: u32) -> Mesh {
    let mut mesh = Mesh { name: "sphere".into(), ..Mesh::default() };
    patch(&mut mesh, [segments.max(3), (segments / 2).max(2)], |s, t| {
        let (around, up) = (turn(s), latitude(t));
        let normal = Vec3::new(around.y * up.x, up.y, around.x * up.x);
        (normal * radius, normal, Vec3::new(around.x, 0.0, -around.y))
    });
    mesh
}

/// A torus around the y axis: `major` to the centre of the tube, `minor` its radius. Closed.
pub fn torus(major: f32, minor: f32, [around, tube]: [u32; 2]) -> Mesh {
    let mut mesh = Mesh { name: "torus".into(), ..Mesh::default() };
    patch(&mut mesh, [around, tube], |s, t| {
        let (a, b) = (turn(s), turn(t));
        let outward = Vec3::new(a.y, 0.0, a.x);
        let normal = outward * b.x + Vec3::Y * b.y;
        (outward * major + normal * minor, normal, Vec3::new(a.x, 0.0, -a.y))
    });
    mesh
}

/// A closed cylinder around the y axis, standing on y = 0.
pub fn cylinder(radius: f32, height: f32, segments: u32) -> Mesh {
    lathe("cylinder", &[Vec2::ZERO, Vec2::new(radius, 0.0), Vec2::new(radius, height), Vec2::new(0.0, height)], segments)
}

/// A surface of revolution around the y axis from a profile of (radius, height) points, sharp at every point.
///
/// The profile runs so that the body lies to its left: up along an outer wall. One that starts and ends on the axis makes a closed body.
pub fn lathe(name: &str, profile: &[Vec2], segments: u32) -> Mesh {
    revolve(name, profile, segments, 1.0)
}

/// As [`lathe`], smooth wherever the profile turns by less than 60°.
pub fn smooth_lathe(name: &str, profile: &[Vec2], segments: u32) -> Mesh {
    revolve(name, profile, segments, 0.5)
}

/// `crease`: cosine of the turn from which an edge is sharp.
fn revolve(name: &str, profile: &[Vec2], segments: u32, crease: f32) -> Mesh {
    let along: Vec<Vec2> = profile.windows(2).map(|pair| (pair[1] - pair[0]).normalize_or(Vec2::Y)).collect();
    // The direction of the wall at an end of a segment that another one continues.
    let blended = |own: Vec2, next: Option<&Vec2>| match next {
        Some(&next) if own.dot(next) > crease => (own + next).normalize(),
        _ => own,
    };
    let mut mesh = Mesh { name: name.into(), ..Mesh::default() };
    for (index, pair) in profile.windows(2).enumerate() {
        let own = along[index];
        let start = blended(own, index.checked_sub(1).and_then(|i| along.get(i)));
        let end = blended(own, along.get(index + 1));
        patch(&mut mesh, [segments.max(3), 1], |s, t| {
            let around = turn(s);
            let outward = Vec3::new(around.y, 0.0, around.x);
            let (point, wall) = if t == 0.0 { (pair[0], start) } else { (pair[1], end) };
            (outward * point.x + Vec3::Y * point.y, outward * wall.y - Vec3::Y * wall.x, Vec3::new(around.x, 0.0, -around.y))
        });
    }
    mesh
}

/// A disk in the xz plane around the origin, front towards +y.
pub fn disk(radius: f32, segments: u32) -> Mesh {
    lathe("disk", &[Vec2::new(radius, 0.0), Vec2::ZERO], segments)
}

/// A height field over the xz plane, centred: `height(x, z)` in metres, `cells` squares of two triangles, smooth normals by central
/// differences over one cell.
pub fn height_field([width, depth]: [f32; 2], cells: [u32; 2], height: impl Fn(f32, f32) -> f32) -> Mesh {
    let mut mesh = Mesh { name: "height field".into(), ..Mesh::default() };
    let step = Vec2::new(width / cells[0] as f32, depth / cells[1] as f32);
    patch(&mut mesh, cells, |s, t| {
        let (x, z) = ((s - 0.5) * width, (0.5 - t) * depth);
        let slope_x = (height(x + step.x, z) - height(x - step.x, z)) / (2.0 * step.x);
        let slope_z = (height(x, z + step.y) - height(x, z - step.y)) / (2.0 * step.y);
        (Vec3::new(x, height(x, z), z), Vec3::new(-slope_x, 1.0, -slope_z).normalize(), Vec3::new(1.0, slope_x, 0.0))
    });
    mesh
}

impl Mesh {
    /// The mesh moved and turned.
    pub fn moved(mut self, rotation: Quat, translation: Vec3) -> Self {
        self.positions.iter_mut().for_each(|p| *p = rotation * *p + translation);
        self.normals.iter_mut().for_each(|n| *n = rotation * *n);
        self.tangents.iter_mut().for_each(|t| *t = (rotation * t.truncate()).extend(t.w));
        self
    }

    /// The same surface seen from inside: fronts and normals are turned over.
    pub fn inside_out(mut self) -> Self {
        self.indices.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        self.normals.iter_mut().for_each(|n| *n = -*n);
        self.tangents.iter_mut().for_each(|t| t.w = -t.w);
        self
    }

    /// Adds the vertices and triangles of `other`, which has the same lists filled. Its material is forgotten.
    ///
    /// # Panics
    /// When one mesh has tangents, a set of texture coordinates or colours that the other lacks, or either is skinned or morphed.
    pub fn append(&mut self, other: &Mesh) {
        let lists = |m: &Mesh| [m.tangents.is_empty(), m.uvs[0].is_empty(), m.uvs[1].is_empty(), m.colors.is_empty()];
        assert!(
            self.positions.is_empty() || lists(self) == lists(other),
            "`{}` and `{}` have different vertex lists",
            self.name,
            other.name
        );
        let deforms = |m: &Mesh| !m.skin_weights.is_empty() || !m.morph_targets.is_empty();
        assert!(!deforms(self) && !deforms(other), "`{}` or `{}` deforms", self.name, other.name);
        let base = self.positions.len() as u32;
        self.positions.extend_from_slice(&other.positions);
        self.normals.extend_from_slice(&other.normals);
        self.tangents.extend_from_slice(&other.tangents);
        for set in 0..2 {
            self.uvs[set].extend_from_slice(&other.uvs[set]);
        }
        self.colors.extend_from_slice(&other.colors);
        self.indices.extend(other.indices.iter().map(|t| t.map(|i| i + base)));
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::collections::HashMap;

    /// Directed edges, by position, that no triangle runs the other way: none in a closed mesh with consistent winding.
    pub(crate) fn open_edges(mesh: &Mesh) -> usize {
        let key = |i: u32| (mesh.positions[i as usize] + 0.0).to_array().map(f32::to_bits);
        let mut edges: HashMap<_, i64> = HashMap::new();
        for &[a, b, c] in &mesh.indices {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (from, to) = (key(from), key(to));
                *edges.entry(if from < to { (from, to) } else { (to, from) }).or_default() += if from < to { 1 } else { -1 };
            }
        }
        edges.values().filter(|&&balance| balance != 0).count()
    }

    /// Volume that the mesh encloses, positive when fronts face outwards; by the divergence theorem.
    fn volume(mesh: &Mesh) -> f32 {
        let corner = |i: u32| mesh.positions[i as usize];
        mesh.indices.iter().map(|t| t.map(corner)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    /// Unit normals that agree with the winding, orthonormal tangents along growing u, indices in range, lists of one length.
    pub(crate) fn assert_sound(mesh: &Mesh) {
        let n = mesh.positions.len();
        assert!(n > 0 && !mesh.indices.is_empty(), "{}: empty", mesh.name);
        assert_eq!((mesh.normals.len(), mesh.tangents.len(), mesh.uvs[0].len()), (n, n, n), "{}", mesh.name);
        for i in 0..n {
            let (normal, tangent) = (mesh.normals[i], mesh.tangents[i].truncate());
            assert!(mesh.positions[i].is_finite() && mesh.uvs[0][i].is_finite(), "{}", mesh.name);
            assert!((normal.length() - 1.0).abs() < 1e-5, "{}: normal {normal}", mesh.name);
            assert!((tangent.length() - 1.0).abs() < 1e-5 && normal.dot(tangent).abs() < 1e-5, "{}: tangent {tangent}", mesh.name);
            assert!(mesh.tangents[i].w.abs() == 1.0);
        }
        for triangle in &mesh.indices {
            assert!(triangle.iter().all(|&i| (i as usize) < n), "{}: {triangle:?}", mesh.name);
            let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
            let geometric = (b - a).cross(c - a);
            assert!(geometric.length() > 0.0, "{}: a triangle without area", mesh.name);
            let shading: Vec3 = triangle.iter().map(|&i| mesh.normals[i as usize]).sum();
            assert!(geometric.dot(shading) > 0.0, "{}: normals oppose the winding of {triangle:?}", mesh.name);
            // The texture's u grows along the tangent: dP/du by the chain rule over the triangle.
            let [p, q, r] = triangle.map(|i| mesh.uvs[0][i as usize]);
            let area = (q - p).perp_dot(r - p);
            let along_u = ((b - a) * (r.y - p.y) - (c - a) * (q.y - p.y)) / area;
            let tangent: Vec3 = triangle.iter().map(|&i| mesh.tangents[i as usize].truncate()).sum();
            assert!(along_u.dot(tangent) > 0.0, "{}: tangents oppose u", mesh.name);
            let handedness = -area.signum();
            assert!(triangle.iter().all(|&i| mesh.tangents[i as usize].w == handedness), "{}: bitangent not up in the image", mesh.name);
        }
    }

    fn solids() -> Vec<(Mesh, f32)> {
        let bottle = [Vec2::ZERO, Vec2::new(0.5, 0.0), Vec2::new(0.5, 1.0), Vec2::new(0.2, 1.3), Vec2::new(0.0, 1.3)];
        let bottle_volume = PI * 0.25 + PI * 0.3 / 3.0 * (0.25 + 0.1 + 0.04);
        vec![
            (cuboid(Vec3::new(0.5, 1.0, 2.0)), 8.0),
            (rounded_cuboid(Vec3::ONE, 1.0, 16), 4.0 / 3.0 * PI),
            (rounded_cuboid(Vec3::new(1.0, 2.0, 3.0), 1e-3, 2), 48.0),
            (sphere(0.7, 128), 4.0 / 3.0 * PI * 0.343),
            (torus(1.0, 0.25, [128, 64]), 2.0 * PI * PI * 0.0625),
            (cylinder(0.5, 2.0, 128), PI * 0.5),
            (lathe("bottle", &bottle, 128), bottle_volume),
            (smooth_lathe("smooth bottle", &bottle, 128), bottle_volume),
        ]
    }

    #[test]
    fn solids_are_closed_sound_and_enclose_their_volume() {
        for (mesh, expected) in solids() {
            assert_sound(&mesh);
            assert_eq!(open_edges(&mesh), 0, "{}", mesh.name);
            assert!((volume(&mesh) / expected - 1.0).abs() < 0.01, "{}: {} for {expected}", mesh.name, volume(&mesh));
        }
    }

    #[test]
    fn sheets_are_sound_and_face_their_way() {
        for (mesh, normal) in [
            (rectangle(2.0, 1.0), Vec3::Z),
            (floor(3.0, 2.0, 4.0), Vec3::Y),
            (disk(1.0, 32), Vec3::Y),
            (height_field([2.0, 3.0], [5, 7], |_, _| 0.5), Vec3::Y),
        ] {
            assert_sound(&mesh);
            assert!(mesh.normals.iter().all(|n| n.distance(normal) < 1e-6), "{}", mesh.name);
            assert!(open_edges(&mesh) > 0, "{}: the check of closedness sees a border", mesh.name);
        }
        assert_sound(&height_field([2.0; 2], [32; 2], |x, z| 0.3 * (3.0 * x).sin() * (2.0 * z).cos()));
    }

    #[test]
    fn a_missing_triangle_opens_a_solid() {
        let mut mesh = sphere(1.0, 16);
        mesh.indices.pop();
        assert_eq!(open_edges(&mesh), 3);
    }

    #[test]
    fn inside_out_turns_fronts_and_normals() {
        let room = cuboid(Vec3::ONE).inside_out();
        assert_sound(&room);
        assert!((volume(&room) + 8.0).abs() < 1e-5);
    }

    #[test]
    fn moved_and_appended_meshes_stay_sound() {
        let mut mesh = cuboid(Vec3::splat(0.5)).moved(Quat::from_rotation_x(0.7), Vec3::new(3.0, 0.0, 0.0));
        mesh.append(&torus(1.0, 0.2, [24, 12]));
        assert_sound(&mesh);
        assert_eq!(open_edges(&mesh), 0);
        assert_eq!(mesh.indices.len(), 12 + 2 * 24 * 12);
    }
}
