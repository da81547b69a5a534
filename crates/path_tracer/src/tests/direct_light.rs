//! Irradiance of every light against its closed form, and shadows on it.

use super::scenes::{Stage, at, downwards, floor, lambert, looking, mean, render_at, sized};
use crate::{Settings, Strategy};
use glam::Vec3;
use kajo_scene::{LightShape, Material, Mesh, Transform, shapes};
use kajo_units::{Meters, Radians};
use std::f64::consts::PI;

const HEIGHT: f64 = 2.0;

/// Irradiance on the white floor at a point, by the radiance a camera right above it sees: E = π L.
fn irradiance(stage: Stage, x: f32, strategy: Strategy) -> f64 {
    let target = Vec3::new(x, 0.0, 0.0);
    let scene = stage.mesh(floor(), lambert(1.0), at(Vec3::ZERO)).orthographic(target + 0.5 * Vec3::Y, target, 1e-3).0;
    PI * mean(&render_at(&scene, &Settings { max_depth: 1, strategy, ..sized(8, 8) }, 256))
}

fn lit(shape: LightShape, transform: Transform) -> Stage {
    Stage::default().light(shape, 1.0, transform)
}

fn above(x: f32) -> Transform {
    downwards(Vec3::new(x, HEIGHT as f32, 0.0))
}

const DISK: LightShape = LightShape::Disk { radius: Meters(1.0) };
const RECTANGLE: LightShape = LightShape::Rectangle { width: Meters(1.0), height: Meters(0.6) };
const SPHERE: LightShape = LightShape::Sphere { radius: Meters(0.5) };
const SPOT: LightShape = LightShape::Spot { inner: Radians(0.3), outer: Radians(0.6) };

/// Irradiance of a rectangle of radiance 1 on a parallel plane, above one of its corners: half widths summed by symmetry.
/// E = ½ [a/√(1+a²) atan(b/√(1+a²)) + b/√(1+b²) atan(a/√(1+b²))], a and b the sides over the distance.
fn corner(a: f64, b: f64) -> f64 {
    let (ra, rb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    0.5 * (a / ra * (b / ra).atan() + b / rb * (a / rb).atan())
}

/// Row SH-01, and L-09 for the disk: analytic irradiance within 0.5 %.
#[test]
fn irradiance_of_every_light_is_the_closed_form() {
    let h2 = HEIGHT * HEIGHT;
    let spot_edge = {
        let cos = HEIGHT / (h2 + 1.0f64).sqrt();
        let falloff = ((cos - 0.6f64.cos()) / (0.3f64.cos() - 0.6f64.cos())).powi(2);
        falloff * cos / (h2 + 1.0)
    };
    let sky = 0.3f32;
    let cases = [
        ("point above", LightShape::Point, above(0.0), 1.0 / h2),
        ("point aside", LightShape::Point, above(1.5), HEIGHT / (h2 + 2.25).powf(1.5)),
        ("spot inside", SPOT, above(0.0), 1.0 / h2),
        ("spot in the falloff", SPOT, above(1.0), spot_edge),
        ("parallel", LightShape::Directional { half_angle: Radians(0.0) }, above(0.0), 1.0),
        ("sun aslant", LightShape::Directional { half_angle: Radians(sky) }, looking(Vec3::ZERO, Vec3::new(1.0, -1.0, 0.0)), 0.5f64.sqrt()),
        ("rectangle", RECTANGLE, above(0.0), 4.0 * corner(0.25, 0.15)),
        ("rectangle aside", RECTANGLE, above(1.5), 2.0 * (corner(1.0, 0.15) - corner(0.5, 0.15))),
        ("disk", DISK, above(0.0), PI / (1.0 + h2)),
        ("sphere", SPHERE, above(0.0), PI * 0.25 / h2),
        ("sphere aside", SPHERE, above(1.5), PI * 0.25 * HEIGHT / (h2 + 2.25).powf(1.5)),
    ];
    for (name, shape, transform, exact) in cases {
        for strategy in [Strategy::Mis, Strategy::Lights] {
            let got = irradiance(lit(shape, transform), 0.0, strategy);
            assert!((got / exact - 1.0).abs() < 0.005, "{name}, {strategy:?}: {got} for {exact}");
        }
    }
    assert!((irradiance(Stage::default().environment(1.0), 0.0, Strategy::Mis) / PI - 1.0).abs() < 0.005);
}

/// Row L-09: both cosines are clamped.
#[test]
fn area_lights_are_dark_from_behind_and_below_the_horizon() {
    for shape in [DISK, RECTANGLE] {
        let up = looking(Vec3::new(0.0, 2.0, 0.0), Vec3::new(0.0, 3.0, 0.0));
        assert_eq!(irradiance(lit(shape, up), 0.0, Strategy::Mis), 0.0, "{shape:?} shines away");
        let below = downwards(Vec3::new(0.0, -2.0, 0.0));
        assert_eq!(irradiance(lit(shape, below), 0.0, Strategy::Mis), 0.0, "{shape:?} lies below");
    }
}

fn occluder(low: f32, high: f32) -> Mesh {
    let mut mesh = shapes::rectangle(high - low, 20.0).moved(glam::Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2), Vec3::ZERO);
    mesh.positions.iter_mut().for_each(|p| p.x += 0.5 * (low + high));
    mesh
}

/// Row L-10: an occluder over half of the light halves the irradiance, a full one leaves exactly nothing, for every light.
#[test]
fn occluders_take_their_share() {
    let sun = LightShape::Directional { half_angle: Radians(0.3) };
    let at_half = at(Vec3::new(0.0, 1.0, 0.0));
    for shape in [DISK, RECTANGLE, SPHERE, sun] {
        let open = irradiance(lit(shape, above(0.0)), 0.0, Strategy::Mis);
        for material in [lambert(0.0), Material { double_sided: true, ..lambert(0.0) }] {
            let half = irradiance(lit(shape, above(0.0)).mesh(occluder(-10.0, 0.0), material.clone(), at_half), 0.0, Strategy::Mis);
            assert!((half / open - 0.5).abs() < 0.005, "{shape:?}: {half} of {open}");
            let none = irradiance(lit(shape, above(0.0)).mesh(occluder(-10.0, 10.0), material, at_half), 0.0, Strategy::Mis);
            assert_eq!(none, 0.0, "{shape:?}");
        }
    }
    for shape in [LightShape::Point, SPOT, LightShape::Directional { half_angle: Radians(0.0) }] {
        assert_eq!(irradiance(lit(shape, above(0.0)).mesh(occluder(-10.0, 10.0), lambert(0.0), at_half), 0.0, Strategy::Mis), 0.0);
    }
}

/// Row L-12: inverse squares, parallel light everywhere equal, and an area that tends to a point.
#[test]
fn falloff_is_that_of_the_kind_of_light() {
    let point = |height: f32| irradiance(lit(LightShape::Point, downwards(Vec3::Y * height)), 0.0, Strategy::Mis);
    assert!((point(1.0) / point(2.0) - 4.0).abs() < 1e-3);
    let parallel = |x| irradiance(lit(LightShape::Directional { half_angle: Radians(0.0) }, above(0.0)), x, Strategy::Mis);
    assert_eq!(parallel(0.0), parallel(30.0));
    for shape in [LightShape::Disk { radius: Meters(0.1) }, LightShape::Sphere { radius: Meters(0.1) }] {
        let area = irradiance(lit(shape, downwards(Vec3::Y * 1.0)), 0.0, Strategy::Mis);
        assert!((area / (PI * 0.01) - 1.0).abs() < 0.01, "{shape:?}: {area}");
    }
}

/// A glowing mesh lights like the analytic light of the same shape, on its front only.
#[test]
fn emissive_meshes_light_like_analytic_lights() {
    let down = Transform::Trs {
        translation: Vec3::new(0.7, HEIGHT as f32, 0.0),
        rotation: glam::Quat::from_rotation_x(std::f32::consts::FRAC_PI_2),
        scale: Vec3::ONE,
    };
    let glow = super::scenes::glowing(1.0, 0.0);
    let exact = irradiance(lit(RECTANGLE, above(0.7)), 0.0, Strategy::Mis);
    let mesh =
        |material, transform| irradiance(Stage::default().mesh(shapes::rectangle(1.0, 0.6), material, transform), 0.0, Strategy::Mis);
    assert!((mesh(glow.clone(), down) / exact - 1.0).abs() < 0.005);
    let up = downwards(Vec3::new(0.7, HEIGHT as f32, 0.0));
    assert_eq!(mesh(glow.clone(), up), 0.0);
    let both = mesh(Material { double_sided: true, ..glow }, up);
    assert!((both / exact - 1.0).abs() < 0.005);
}
