//! A wall on a floor, drawn by hand: each planted fault is called by its name and by no other.

use super::*;
use crate::judge::{Kind, Part};
use glam::{UVec2, Vec2, Vec3};

const SIZE: UVec2 = UVec2::new(120, 100);
/// Row of the crease between wall (above) and floor (below).
const FOOT: u32 = 30;
/// First row of the floor that is lit again.
const END: u32 = 70;

/// A wall that turns away from the light, and the floor before it, 1 cm a pixel. The light shines over the wall.
fn gbuffer() -> GBufferImages {
    let is_wall = |y: u32| y < FOOT;
    let image = |f: &dyn Fn(u32, u32) -> Vec3| Image::from_fn(SIZE, f);
    let normal = image(&|_, y| if is_wall(y) { Vec3::Z } else { Vec3::Y });
    let grey = Image::from_fn(SIZE, |_, _| LinearRgb::WHITE);
    GBufferImages {
        depth: grey.map(|_| 1.0),
        position: image(&|x, y| {
            let (x, down) = (x as f32 * 0.01, (y as f32 - FOOT as f32 + 0.5) * 0.01);
            if is_wall(y) { Vec3::new(x, -down, 0.0) } else { Vec3::new(x, 0.0, down) }
        }),
        shading_normal: normal.clone(),
        normal,
        metallic: grey.map(|_| 0.0),
        f0: grey.clone(),
        roughness: grey.map(|_| 1.0),
        motion: grey.map(|_| Vec2::ZERO),
        instance: Image::from_fn(SIZE, |_, y| Some(u32::from(is_wall(y)))),
        material: grey.map(|_| Some(0)),
        albedo: grey,
    }
}

/// Shadow of the wall on the floor, up to `END` and beyond it by `soft` px of penumbra.
fn truth(soft: f32) -> Image<f32> {
    Image::from_fn(SIZE, |_, y| if y < END { 0.0 } else { ((y - END) as f32 + 0.5).min(soft) / soft })
}

/// The wall stands between it and the floor.
fn sun() -> LightPlace {
    LightPlace::Towards(Vec3::new(0.0, 1.0, -1.0).normalize())
}

/// Shares of all classes, and those that are not zero.
fn faults(image: &Image<f32>, soft: f32) -> (Failures, Vec<Class>) {
    faults_of(image, soft, sun())
}

fn faults_of(image: &Image<f32>, soft: f32, light: LightPlace) -> (Failures, Vec<Class>) {
    let grey = |image: &Image<f32>| image.map(|v| LinearRgb::splat(*v));
    let part = Part { name: "visibility.sun".into(), image: grey(&truth(soft)), variance: None, settled: None };
    let judge = Judge { parts: vec![part], mask: None, kind: Kind::Visibility, composed: None };
    let failures = Failures::new(&judge, &[grey(image)], &gbuffer(), &[light]).unwrap();
    let found = failures.shares.iter().filter(|(_, share)| **share > 0.0).map(|(class, _)| *class).collect();
    (failures, found)
}

fn changed(soft: f32, change: impl Fn(u32, u32, f32) -> f32) -> Image<f32> {
    let truth = truth(soft);
    Image::from_fn(SIZE, |x, y| change(x, y, *truth.get(x, y)))
}

#[test]
fn the_truth_and_a_border_one_pixel_off_have_no_faults() {
    for soft in [1.0, 20.0] {
        assert_eq!(faults(&truth(soft), soft).1, []);
    }
    let off = changed(1.0, |_, y, _| if y < END + 1 { 0.0 } else { 1.0 });
    assert_eq!(faults(&off, 1.0).1, []);
}

#[test]
fn stripes_on_the_lit_floor_are_acne() {
    let stripes = changed(1.0, |_, y, v| if y > END + 4 && y % 4 == 0 { 0.0 } else { v });
    let (failures, found) = faults(&stripes, 1.0);
    assert_eq!(found, [Class::Acne]);
    let rows = (END + 5..SIZE.y).filter(|y| y % 4 == 0).count() as f64;
    assert!((failures.shares[&Class::Acne] - rows / f64::from(SIZE.y)).abs() < 1e-9);
    assert_eq!(*failures.image.get(5, END + 11), None);
}

#[test]
fn light_at_the_foot_of_the_wall_is_detachment() {
    let gap = changed(1.0, |_, y, v| if (FOOT..FOOT + 12).contains(&y) { 1.0 } else { v });
    let (failures, found) = faults(&gap, 1.0);
    assert_eq!((found, *failures.image.get(60, FOOT + 3)), (vec![Class::Detachment], Some(Class::Detachment)));
    // Border that draws back on its whole length.
    let short = changed(1.0, |_, y, v| if (END - 4..END).contains(&y) { 1.0 } else { v });
    assert_eq!(faults(&short, 1.0).1, [Class::Detachment]);
}

#[test]
fn light_inside_the_shadow_is_a_leak_also_when_it_is_faint_and_when_no_shadow_is_there() {
    for amount in [0.2, 1.0] {
        let hole = changed(1.0, |x, y, v| if (50..60).contains(&x) && (45..52).contains(&y) { amount } else { v });
        assert_eq!(faults(&hole, 1.0).1, [Class::Leak], "{amount}");
    }
    let none = changed(1.0, |_, y, _| if y < FOOT { 0.0 } else { 1.0 });
    assert_eq!(faults(&none, 1.0).1, [Class::Leak]);
}

#[test]
fn stairs_along_the_border_are_aliasing() {
    let stairs = changed(1.0, |x, y, _| if y < END - 3 + 6 * ((x / 8) % 2) { 0.0 } else { 1.0 });
    assert_eq!(faults(&stairs, 1.0).1, [Class::Aliasing]);
}

#[test]
fn a_hard_border_beside_a_large_light_misses_the_penumbra_and_noise_does_not() {
    let hard = changed(20.0, |_, _, v| v.round());
    let (failures, found) = faults(&hard, 20.0);
    assert_eq!(found, [Class::MissedPenumbra]);
    assert!(failures.shares[&Class::MissedPenumbra] > 0.08, "{:?}", failures.shares);
    // One shadow ray a pixel: right in the mean.
    let noisy = changed(20.0, |x, y, v| if (x * 7 + y * 13) % 20 < (v * 20.0) as u32 { 1.0 } else { 0.0 });
    let (failures, _) = faults(&noisy, 20.0);
    assert!(failures.shares[&Class::MissedPenumbra] < 0.02, "{:?}", failures.shares);
}

/// Visibility knows no cone, so a map of a spot, which ends at the cone, may say anything beyond it.
#[test]
fn where_a_spot_does_not_shine_nothing_fails() {
    let at = Vec3::new(0.6, 2.0, -2.0);
    let spot = |cosine: f32| LightPlace::Cone { at, axis: (Vec3::new(0.6, 0.0, 0.2) - at).normalize(), cosine };
    let point = Vec3::new(0.6, 0.0, 0.4);
    assert!(spot(0.99).shines_on(point) && !spot(0.9999).shines_on(point));
    let scene = kajo_scene::load("builtin:shadows", &kajo_scene::LoadOptions::default()).unwrap();
    let snapshot = kajo_scene::Snapshot::new(&scene, kajo_units::Seconds(0.0));
    let found = places(&scene, &snapshot, &[0, 1, 2]);
    let LightPlace::Cone { axis, cosine, .. } = found[1] else { panic!("the spot is a cone: {found:?}") };
    assert!(axis.y < 0.0 && (cosine - 26f32.to_radians().cos()).abs() < 1e-6 && found[1].shines_on(Vec3::new(-1.4, 0.0, 0.2)));
}

/// The same hole in the shadow of a spot that reaches a part of the floor is a larger share of what it reaches.
#[test]
fn shares_are_of_what_the_light_can_reach() {
    let hole = changed(1.0, |x, y, v| if (50..60).contains(&x) && (45..52).contains(&y) { 1.0 } else { v });
    let (far, middle) = (Vec3::new(0.55, 100.0, -100.0), Vec3::new(0.55, 0.0, 0.185));
    let axis = (middle - far).normalize();
    let spot = LightPlace::Cone { at: far, axis, cosine: (0.2f32 / (middle - far).length()).atan().cos() };
    let buffer = gbuffer();
    let reached = buffer.position.pixels().iter().filter(|point| spot.shines_on(**point)).count();
    assert!(reached > 100 && reached < 3000, "{reached}");
    let (of_sun, of_spot) = (faults(&hole, 1.0).0, faults_of(&hole, 1.0, spot).0);
    assert_eq!(of_sun.shares[&Class::Leak], 70.0 / f64::from(SIZE.element_product()));
    assert_eq!(of_spot.shares[&Class::Leak], 70.0 / reached as f64);
}

#[test]
fn a_pixel_shows_the_gravest_fault_and_every_class_is_counted() {
    assert!(Class::ALL.is_sorted());
    let (failures, _) = faults(&changed(1.0, |_, y, _| if y < FOOT { 0.0 } else { 1.0 }), 1.0);
    assert_eq!(failures.by_id().keys().collect::<Vec<_>>(), ["acne", "aliasing", "detachment", "leak", "missed-penumbra"]);
}
