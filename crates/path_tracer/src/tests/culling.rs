//! Instances left out for rays that start on surfaces.

use super::scenes::{Stage, at, floor, lambert, mirror};
use crate::{Aov, Filter, Pixels, Settings, Stop, Tracer, render, uncontrolled};
use glam::{UVec2, Vec3};
use kajo_scene::{Culling, Snapshot, shapes};
use kajo_units::{Meters, Seconds};

/// A ball over a mirror and a smaller one beside it, under a bright sky.
fn image(culling: Culling, aov: Aov) -> Vec<f32> {
    let scene = Stage::default()
        .mesh(floor(), mirror(), at(Vec3::ZERO))
        .mesh(shapes::sphere(0.5, 24), lambert(0.5), at(Vec3::new(-0.6, 0.6, 0.0)))
        .mesh(shapes::sphere(0.15, 24), lambert(0.5), at(Vec3::new(0.8, 0.3, 0.0)))
        .environment(1.0)
        .perspective(Vec3::new(0.0, 1.2, 4.0), Vec3::new(0.0, 0.2, 0.0), 40.0)
        .0;
    let settings =
        Settings { size: UVec2::new(64, 48), filter: Filter::Center, aovs: vec![aov.clone()], max_depth: 3, ..Settings::default() };
    let tracer = Tracer::new(&scene, Snapshot::new(&scene, Seconds(0.0))).unwrap().with_culling(culling, &settings).unwrap();
    let frame = render(&tracer, &settings, Stop::at_spp(4), None, &uncontrolled).unwrap().develop();
    match &frame.image(&aov.to_string()).unwrap().pixels {
        Pixels::Scalar(image) => image.pixels().to_vec(),
        other => other.to_color().pixels().iter().map(|p| p.luminance()).collect(),
    }
}

#[test]
fn the_camera_sees_what_reflections_do_not() {
    let small = Culling::Size(Meters(0.4));
    assert_eq!(image(small, Aov::InstanceId), image(Culling::Off, Aov::InstanceId), "the camera sees everything");
    let (all, culled) = (image(Culling::Off, Aov::SpecularIndirect), image(small, Aov::SpecularIndirect));
    let changed = all.iter().zip(&culled).filter(|(a, b)| (*a - *b).abs() > 0.1).count();
    assert!((20..400).contains(&changed), "{changed} pixels of the reflection have lost the small ball");
    let everything = image(Culling::Size(Meters(0.0)), Aov::SpecularIndirect);
    assert_eq!(all, everything, "nothing left out is nothing changed");
}

#[test]
fn a_film_is_not_continued_with_other_instances() {
    let scene = kajo_scene::load("builtin:scatter:50", &kajo_scene::LoadOptions::default()).unwrap();
    let hash = |culling| {
        let tracer = Tracer::new(&scene, Snapshot::new(&scene, Seconds(0.0))).unwrap();
        tracer.with_culling(culling, &Settings::default()).unwrap().hash()
    };
    let (off, some) = (hash(Culling::Off), hash(Culling::SolidAngle(1e-3)));
    assert!(off != some && some != hash(Culling::SolidAngle(1e-2)) && off == hash(Culling::Off));
}
