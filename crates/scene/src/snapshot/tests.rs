use super::*;
use crate::{Animation, Channel, Interpolation, LightShape, MorphTarget, Node, Projection, Property, Skin, SkinWeights, Transform};
use glam::{Quat, Vec3, Vec4};
use kajo_units::{LinearRgb, Meters, Radians};

fn triangle() -> Mesh {
    Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        normals: vec![Vec3::Z; 3],
        tangents: vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 3],
        indices: vec![[0, 1, 2]],
        ..Mesh::default()
    }
}

fn node(transform: Transform, parent: Option<usize>) -> Node {
    Node { transform, parent, ..Node::default() }
}

fn moved(x: f32, y: f32, z: f32) -> Transform {
    Transform::Trs { translation: Vec3::new(x, y, z), rotation: Quat::IDENTITY, scale: Vec3::ONE }
}

fn close(a: Vec3, b: Vec3) -> bool {
    a.distance(b) < 1e-5
}

#[test]
fn parents_may_follow_their_children() {
    let turn = Transform::Trs { translation: Vec3::ZERO, rotation: Quat::from_rotation_z(90f32.to_radians()), scale: Vec3::splat(2.0) };
    let mut scene = Scene { nodes: vec![node(moved(1.0, 0.0, 0.0), Some(1)), node(turn, None)], ..Scene::default() };
    scene.meshes.push(Arc::new(triangle()));
    scene.nodes[0].meshes.push(0);
    let snapshot = Snapshot::new(&scene, Seconds(0.0));
    let corner = snapshot.instances[0].world_from_object.transform_point3(Vec3::X);
    assert!(close(corner, Vec3::new(0.0, 4.0, 0.0)), "{corner}");
    assert!(Arc::ptr_eq(&snapshot.meshes[0], &scene.meshes[0]), "a rigid mesh is shared");
}

#[test]
fn a_cycle_of_parents_ends() {
    let scene = Scene { nodes: vec![node(moved(1.0, 0.0, 0.0), Some(1)), node(moved(0.0, 1.0, 0.0), Some(0))], ..Scene::default() };
    assert!(Snapshot::new(&scene, Seconds(0.0)).instances.is_empty());
}

#[test]
fn cameras_lose_scale_and_mirror() {
    let scaled =
        Transform::Trs { translation: Vec3::new(1.0, 2.0, 3.0), rotation: Quat::from_rotation_y(0.3), scale: Vec3::new(-2.0, 5.0, 0.5) };
    let mut scene = Scene { nodes: vec![node(scaled, None)], ..Scene::default() };
    scene.nodes[0].camera = Some(0);
    scene.cameras.push(framing::default_camera([Vec3::ZERO, Vec3::ONE]).camera);
    let view = Snapshot::new(&scene, Seconds(0.0)).cameras[0].world_from_view;
    assert!((view.determinant() - 1.0).abs() < 1e-5);
    assert!(close(view.transform_point3(Vec3::ZERO), Vec3::new(1.0, 2.0, 3.0)));
    assert!(close(view.transform_vector3(Vec3::NEG_Z), Quat::from_rotation_y(0.3) * Vec3::NEG_Z));
    assert!(close(view.transform_vector3(Vec3::Y), Vec3::Y));
}

#[test]
fn a_scene_without_camera_gets_one_that_sees_it() {
    let mut scene = Scene { nodes: vec![node(moved(10.0, 0.0, 0.0), None)], ..Scene::default() };
    scene.meshes.push(Arc::new(triangle()));
    scene.nodes[0].meshes.push(0);
    let snapshot = Snapshot::new(&scene, Seconds(0.0));
    let Projection::Perspective { yfov, .. } = snapshot.cameras[0].camera.projection else { panic!("perspective") };
    let view_from_world = snapshot.cameras[0].world_from_view.inverse();
    for position in &snapshot.meshes[0].positions {
        let view = view_from_world.transform_point3(snapshot.instances[0].world_from_object.transform_point3(*position));
        assert!(view.z < 0.0 && view.truncate().length() < -view.z * (yfov.0 * 0.5).tan(), "{view}");
    }
}

#[test]
fn lights_stand_where_their_nodes_do() {
    let mut scene = Scene { nodes: vec![node(moved(1.0, 2.0, 3.0), None)], ..Scene::default() };
    scene.nodes[0].light = Some(0);
    scene.lights.push(Light { name: "l".into(), shape: LightShape::Point, emission: LinearRgb::WHITE });
    let light = &Snapshot::new(&scene, Seconds(0.0)).lights[0];
    assert!(close(light.world_from_light.translation.into(), Vec3::new(1.0, 2.0, 3.0)));
}

#[test]
fn the_chosen_animation_moves_its_nodes() {
    let lift = |height: f32| Animation {
        name: String::new(),
        channels: vec![Channel {
            node: 0,
            property: Property::Translation,
            interpolation: Interpolation::Linear,
            times: vec![0.0, 2.0],
            values: vec![0.0, 0.0, 0.0, 0.0, height, 0.0],
        }],
    };
    let mut scene = Scene { nodes: vec![node(moved(0.0, 9.0, 0.0), None)], animations: vec![lift(2.0), lift(4.0)], ..Scene::default() };
    scene.meshes.push(Arc::new(triangle()));
    scene.nodes[0].meshes.push(0);
    for (animation, height) in [(0, 1.0), (1, 2.0), (2, 9.0)] {
        scene.animation = animation;
        let placed = Snapshot::new(&scene, Seconds(1.0)).instances[0].world_from_object;
        assert!(close(placed.translation.into(), Vec3::new(0.0, height, 0.0)), "animation {animation}: {placed:?}");
    }
}

/// Joint 0 stays, joint 1 turns by 90° about z at (1, 0, 0): a vertex at (2, 0, 0) that follows joint 1 goes to (1, 1, 0), one that follows
/// both equally to the mean of (2, 0, 0) and (1, 1, 0). The node of the mesh does not count.
fn bending_arm() -> Scene {
    let mut mesh = triangle();
    mesh.positions = vec![Vec3::new(2.0, 0.0, 0.0); 3];
    mesh.normals = vec![Vec3::Y; 3];
    let half = |a, b| SkinWeights { joints: [0, 1, 0, 0, 0, 0, 0, 0], weights: [a, b, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0] };
    mesh.skin_weights = vec![half(1.0, 0.0), half(0.0, 1.0), half(0.5, 0.5)];
    let bend = Transform::Trs { translation: Vec3::X, rotation: Quat::from_rotation_z(90f32.to_radians()), scale: Vec3::ONE };
    let mut scene =
        Scene { nodes: vec![node(moved(7.0, 7.0, 7.0), None), node(moved(0.0, 0.0, 0.0), None), node(bend, Some(1))], ..Scene::default() };
    scene.nodes[0].meshes.push(0);
    scene.nodes[0].skin = Some(0);
    scene.meshes.push(Arc::new(mesh));
    scene.skins.push(Skin { joints: vec![1, 2], inverse_bind: vec![Mat4::IDENTITY, Mat4::from_translation(Vec3::NEG_X)] });
    scene
}

#[test]
fn joints_blend_linearly_and_replace_the_node() {
    let snapshot = Snapshot::new(&bending_arm(), Seconds(0.0));
    assert_eq!(snapshot.instances[0].world_from_object, Affine3A::IDENTITY);
    let mesh = &snapshot.meshes[0];
    for (got, want) in mesh.positions.iter().zip([Vec3::new(2.0, 0.0, 0.0), Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.5, 0.5, 0.0)]) {
        assert!(close(*got, want), "{got} instead of {want}");
    }
    for (got, want) in mesh.normals.iter().zip([Vec3::Y, Vec3::NEG_X, Vec3::new(-1.0, 1.0, 0.0).normalize()]) {
        assert!(close(*got, want), "{got} instead of {want}");
    }
}

/// Under S = diag(2, 1, 1) the plane with normal (1, 1, 0) gets the normal S⁻ᵀ(1, 1, 0) = (½, 1, 0); a mirror turns the winding with it.
#[test]
fn skinned_normals_use_the_inverse_transpose_and_mirrors_keep_front_faces() {
    let mut scene = bending_arm();
    let mesh = Arc::make_mut(&mut scene.meshes[0]);
    mesh.positions = vec![Vec3::ZERO, Vec3::new(-1.0, 1.0, 0.0), Vec3::Z];
    mesh.normals = vec![(mesh.positions[1]).cross(mesh.positions[2]).normalize(); 3];
    mesh.tangents = vec![Vec4::new(0.0, 0.0, 1.0, 1.0); 3];
    for weights in &mut mesh.skin_weights {
        weights.weights = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    }
    for mirror in [1.0, -1.0] {
        scene.nodes[1].transform =
            Transform::Trs { translation: Vec3::ZERO, rotation: Quat::IDENTITY, scale: Vec3::new(2.0 * mirror, 1.0, 1.0) };
        let snapshot = Snapshot::new(&scene, Seconds(0.0));
        let mesh = &snapshot.meshes[0];
        let want = Vec3::new(0.5 * mirror, 1.0, 0.0).normalize();
        assert!(close(mesh.normals[0], want), "{} instead of {want}", mesh.normals[0]);
        let [a, b, c] = mesh.indices[0].map(|i| mesh.positions[i as usize]);
        assert!((b - a).cross(c - a).dot(mesh.normals[0]) > 0.0, "the geometric normal follows");
        assert_eq!(mesh.tangents[0].w, mirror);
    }
}

#[test]
fn morph_targets_add_by_weight() {
    let mut mesh = triangle();
    mesh.colors = vec![Vec4::splat(0.5); 3];
    mesh.uvs[0] = vec![glam::Vec2::ZERO; 3];
    let up = MorphTarget {
        positions: vec![Vec3::Z; 3],
        normals: vec![Vec3::new(1.0, 0.0, -1.0); 3],
        colors: vec![Vec4::splat(2.0); 3],
        uvs: [vec![glam::Vec2::ONE; 3], Vec::new()],
        ..MorphTarget::default()
    };
    let side = MorphTarget { positions: vec![Vec3::X; 3], ..MorphTarget::default() };
    mesh.morph_targets = vec![up, side];
    mesh.morph_weights = vec![0.0, 1.0];
    let mut scene = Scene { nodes: vec![Node::default(), Node::default()], ..Scene::default() };
    scene.meshes.push(Arc::new(mesh));
    for node in &mut scene.nodes {
        node.meshes.push(0);
    }
    scene.nodes[1].morph_weights = vec![0.5, 0.0];
    let snapshot = Snapshot::new(&scene, Seconds(0.0));
    let [by_mesh, by_node] = [0, 1].map(|i| &snapshot.meshes[snapshot.instances[i].mesh]);
    assert!(close(by_mesh.positions[0], Vec3::X), "{}", by_mesh.positions[0]);
    assert!(close(by_node.positions[0], Vec3::Z * 0.5), "{}", by_node.positions[0]);
    assert!(close(by_node.normals[0], Vec3::new(1.0, 0.0, 1.0).normalize()), "{}", by_node.normals[0]);
    assert_eq!(by_node.uvs[0][0], glam::Vec2::splat(0.5));
    assert_eq!(by_node.colors[0], Vec4::ONE, "colours stay in [0, 1]");
    assert_eq!(snapshot.instances[0].mesh, 0, "the first stands where the scene has it");
}

#[test]
fn faceted_normals_follow_the_deformation() {
    let mut mesh = triangle();
    mesh.make_faceted_normals();
    mesh.morph_targets = vec![MorphTarget { positions: vec![Vec3::ZERO, Vec3::ZERO, Vec3::new(0.0, -1.0, 1.0)], ..MorphTarget::default() }];
    mesh.morph_weights = vec![1.0];
    let mut scene = Scene { nodes: vec![Node { meshes: vec![0], ..Node::default() }], ..Scene::default() };
    scene.meshes.push(Arc::new(mesh));
    let snapshot = Snapshot::new(&scene, Seconds(0.0));
    assert!(close(snapshot.meshes[0].normals[0], Vec3::NEG_Y), "{}", snapshot.meshes[0].normals[0]);
}

#[test]
fn overflowing_transforms_flatten_instead_of_spreading() {
    let huge = Transform::Trs { translation: Vec3::ONE, rotation: Quat::IDENTITY, scale: Vec3::splat(1e30) };
    let mut scene = Scene { nodes: vec![node(huge, None), node(huge, Some(0))], ..Scene::default() };
    scene.meshes.push(Arc::new(triangle()));
    scene.nodes[1].meshes.push(0);
    assert_eq!(Snapshot::new(&scene, Seconds(0.0)).instances[0].world_from_object, Affine3A::ZERO);
}

#[test]
fn framing_accepts_an_empty_scene() {
    let snapshot = Snapshot::new(&Scene::default(), Seconds(0.0));
    assert_eq!(snapshot.cameras.len(), 1);
    assert!(snapshot.cameras[0].world_from_view.is_finite());
    assert!(snapshot.cameras[0].camera.near > Meters(0.0));
    assert!(snapshot.cameras[0].camera.projection != Projection::Perspective { yfov: Radians(0.0), aspect: None });
}
