use super::*;
use crate::shapes;
use glam::{Quat, Vec2};
use std::collections::{BTreeMap, BTreeSet};

fn closed_meshes() -> Vec<(&'static str, Mesh)> {
    let mut two = shapes::cuboid(Vec3::splat(0.4));
    two.append(&shapes::sphere(0.3, 10).moved(Quat::from_rotation_x(0.7), Vec3::new(0.2, 0.3, 0.1)));
    vec![
        ("cuboid", shapes::cuboid(Vec3::new(0.5, 0.3, 0.2))),
        ("sphere", shapes::sphere(0.5, 14)),
        ("torus", shapes::torus(0.5, 0.2, [14, 9])),
        ("rounded cuboid", shapes::rounded_cuboid(Vec3::new(0.4, 0.3, 0.2), 0.05, 2)),
        ("two bodies through each other", two),
    ]
}

/// Twenty lights around the meshes and inside of them: points and directions.
fn lights() -> Vec<Vec4> {
    let golden = 2.399_963_2_f32;
    let at = |i: u32| {
        let (z, angle) = (1.0 - (i as f32 + 0.5) / 10.0, golden * i as f32);
        let across = (1.0 - z * z).sqrt();
        Vec3::new(across * angle.cos(), across * angle.sin(), z)
    };
    (0..20).map(|i| if i % 2 == 0 { (at(i) * (0.3 + 0.2 * i as f32)).extend(1.0) } else { at(i).extend(0.0) }).collect()
}

/// Positions of an undirected edge.
fn place(mesh: &Mesh, [a, b]: [u32; 2]) -> [[u32; 3]; 2] {
    let mut ends = [a, b].map(|vertex| key(mesh.positions[vertex as usize]));
    ends.sort_unstable();
    ends
}

/// The article's way, over all pairs of triangles: an edge is on the silhouette when the vector to the light has different signs with the normals
/// of the two triangles that share it.
fn by_brute_force(mesh: &Mesh, light: Vec4) -> BTreeSet<[[u32; 3]; 2]> {
    let corners = |t: usize| mesh.indices[t].map(|vertex| mesh.positions[vertex as usize]);
    let side = |t: usize| {
        let [a, b, c] = corners(t).map(|p| p.as_dvec3());
        (b - a).cross(c - a).dot(light.truncate().as_dvec3() - a * f64::from(light.w)) > 0.0
    };
    let edges = |t: usize| {
        let [a, b, c] = mesh.indices[t];
        [[a, b], [b, c], [c, a]].map(|edge| place(mesh, edge))
    };
    let mut found = BTreeSet::new();
    for i in 0..mesh.indices.len() {
        for j in 0..i {
            if side(i) != side(j) {
                found.extend(edges(i).into_iter().filter(|edge| edges(j).contains(edge)));
            }
        }
    }
    found
}

fn silhouette(mesh: &Mesh, light: Vec4) -> Vec<[u32; 2]> {
    Adjacency::new(mesh).silhouette(&faces(mesh, light))
}

/// Row SH-02.
#[test]
fn silhouettes_are_those_of_brute_force() {
    for (name, mesh) in closed_meshes() {
        for light in lights() {
            let fast: Vec<_> = silhouette(&mesh, light).into_iter().map(|edge| place(&mesh, edge)).collect();
            let set: BTreeSet<_> = fast.iter().copied().collect();
            assert_eq!(set.len(), fast.len(), "{name}: an edge twice");
            assert_eq!(set, by_brute_force(&mesh, light), "{name}, {light}");
        }
    }
}

#[test]
fn planted_fault_an_edge_with_equal_signs_is_noticed() {
    let (mesh, light) = (shapes::sphere(0.5, 14), Vec4::new(0.3, 2.0, 0.4, 1.0));
    let mut wrong = faces(&mesh, light);
    wrong[5] = !wrong[5];
    let set: BTreeSet<_> = Adjacency::new(&mesh).silhouette(&wrong).into_iter().map(|edge| place(&mesh, edge)).collect();
    assert_ne!(set, by_brute_force(&mesh, light));
}

#[test]
fn a_cube_has_six_edges_on_its_silhouette() {
    let cube = shapes::cuboid(Vec3::splat(0.5));
    for light in [Vec4::new(3.0, 4.0, 5.0, 1.0), Vec4::new(-1.0, 2.0, 0.7, 0.0)] {
        assert_eq!(silhouette(&cube, light).len(), 6);
    }
    assert_eq!(silhouette(&cube, Vec4::new(0.1, 4.0, 0.2, 1.0)).len(), 4, "one face alone");
    assert_eq!(silhouette(&cube, Vec4::new(0.1, 0.2, 0.1, 1.0)).len(), 0, "from inside no face");
}

/// As many silhouette edges end in a corner as begin there: they are closed loops, also where the signs are arbitrary.
#[test]
fn silhouettes_are_closed_loops() {
    for (name, mesh) in closed_meshes() {
        let adjacency = Adjacency::new(&mesh);
        let arbitrary: Vec<bool> = (0..mesh.indices.len()).map(|i| (i * 2_654_435_761) >> 7 & 1 == 0).collect();
        for faces in lights().into_iter().map(|light| faces(&mesh, light)).chain([arbitrary]) {
            let mut balance = BTreeMap::<u32, i32>::new();
            for [from, to] in adjacency.silhouette(&faces) {
                *balance.entry(from).or_default() += 1;
                *balance.entry(to).or_default() -= 1;
            }
            assert!(balance.values().all(|&sum| sum == 0), "{name}: {balance:?}");
        }
    }
}

#[test]
fn closed_meshes_are_told_from_others() {
    for (name, mesh) in closed_meshes() {
        let topology = Adjacency::new(&mesh).topology;
        assert!(topology.is_closed() && topology.is_manifold(), "{name}: {topology:?}");
    }
    let mut open = shapes::cuboid(Vec3::ONE);
    open.indices.pop();
    let hole = Adjacency::new(&open).topology;
    assert!(!hole.is_closed());
    assert_eq!((hole.open, hole.flipped, hole.crowded), (3, 0, 0));
    let mut turned = shapes::cuboid(Vec3::ONE);
    turned.indices[0].swap(0, 1);
    let flipped = Adjacency::new(&turned).topology;
    assert!(!flipped.is_closed());
    assert_eq!((flipped.open, flipped.flipped), (0, 3));
    assert_eq!(Adjacency::new(&shapes::rectangle(1.0, 1.0)).topology.open, 4);
    assert!(Adjacency::new(&Mesh::default()).topology.is_closed(), "nothing has no boundary");
}

/// Two cubes that share an edge: four triangles there, and still no boundary. A sheet with a second one on its back is a body of no thickness.
#[test]
fn bodies_that_touch_in_an_edge_and_doubled_sheets_are_closed() {
    let mut touching = shapes::cuboid(Vec3::splat(0.5));
    touching.append(&shapes::cuboid(Vec3::splat(0.5)).moved(Quat::IDENTITY, Vec3::new(1.0, 1.0, 0.0)));
    let topology = Adjacency::new(&touching).topology;
    assert!(topology.is_closed() && !topology.is_manifold() && topology.crowded == 1, "{topology:?}");
    let mut doubled = shapes::rectangle(1.0, 1.0);
    doubled.append(&shapes::rectangle(1.0, 1.0).inside_out());
    assert!(Adjacency::new(&doubled).topology.is_closed());
}

/// Poles of a sphere with texture seams: triangles with two corners in one place leave no gap.
#[test]
fn degenerate_triangles_leave_no_gap() {
    let mut mesh = shapes::cuboid(Vec3::ONE);
    let [a, b, _] = mesh.indices[0];
    let copy = mesh.positions.len() as u32;
    mesh.positions.push(mesh.positions[a as usize]);
    mesh.normals.push(Vec3::Y);
    mesh.uvs = [vec![Vec2::ZERO; mesh.positions.len()], Vec::new()];
    mesh.indices.push([a, b, copy]);
    let topology = Adjacency::new(&mesh).topology;
    assert!(topology.is_closed() && topology.degenerate == 1, "{topology:?}");
}

#[test]
fn welding_holds_while_corners_move_together() {
    let cube = shapes::cuboid(Vec3::ONE);
    let adjacency = Adjacency::new(&cube);
    let mut stretched = cube.clone();
    stretched.positions.iter_mut().for_each(|p| *p *= Vec3::new(2.0, 0.3, 1.1));
    assert!(adjacency.fits(&stretched));
    stretched.positions[0].x += 1.0;
    assert!(!adjacency.fits(&stretched), "one of three corners in a place moved away");
}
