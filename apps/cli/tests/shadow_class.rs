//! Umbra, penumbra and lit of `builtin:umbra`, by the commands that a user types, against the closed form (row SH-23).

mod common;

use common::{run, succeed};
use kajo_image::{ExrFile, Image};
use kajo_image_metrics::ShadowClass;
use std::path::Path;

/// The lamp: height, and half its extent along x and z, m.
const LAMP: (f64, [f64; 2]) = (2.5, [0.35, 0.25]);
/// The board: heights of its lower and upper face, and half its extent, m.
const BOARD: ([f64; 2], [f64; 2]) = ([0.79, 0.81], [0.5, 0.35]);

/// Share of the lamp that the point sees, in closed form.
///
/// A point of the floor looks through the board: its two level faces, thrown onto the lamp's plane from the point, are rectangles, and the larger shadow of
/// the board, the hull of both, is clipped with the lamp. A point of the (convex) board sees what is above its own plane.
fn visible_share([x, y, z]: [f64; 3]) -> f64 {
    let (height, half) = LAMP;
    let lamp = vec![[-half[0], -half[1]], [half[0], -half[1]], [half[0], half[1]], [-half[0], half[1]]];
    let (faces, extent) = BOARD;
    if y > 0.5 * faces[0] {
        let on_top = y > faces[1] - 1e-4;
        // A side sees the part of the lamp that lies in front of it.
        let cut = |lamp: Vec<[f64; 2]>| match (x.abs() > extent[0] - 1e-4, z.abs() > extent[1] - 1e-4) {
            (true, _) => clip(&lamp, [x.signum(), 0.0], extent[0]),
            (_, true) => clip(&lamp, [0.0, z.signum()], extent[1]),
            _ => vec![],
        };
        return if on_top { 1.0 } else { area(&cut(lamp.clone())) / area(&lamp) };
    }
    let corner = |face: f64, [sx, sz]: [f64; 2]| {
        let t = (height - y) / (face - y);
        [x + t * (sx * extent[0] - x), z + t * (sz * extent[1] - z)]
    };
    let thrown: Vec<[f64; 2]> =
        faces.iter().flat_map(|&face| [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|sign| corner(face, sign))).collect();
    let hull = hull(thrown);
    let mut covered = lamp.clone();
    for (i, a) in hull.iter().enumerate() {
        let b = hull[(i + 1) % hull.len()];
        // Inside is to the left of each edge.
        let normal = [-(b[1] - a[1]), b[0] - a[0]];
        covered = clip(&covered, normal, normal[0] * a[0] + normal[1] * a[1]);
    }
    1.0 - area(&covered) / area(&lamp)
}

/// The part of a convex polygon where n·p ≥ d.
fn clip(polygon: &[[f64; 2]], n: [f64; 2], d: f64) -> Vec<[f64; 2]> {
    let side = |p: &[f64; 2]| n[0] * p[0] + n[1] * p[1] - d;
    let mut out = Vec::new();
    for (i, a) in polygon.iter().enumerate() {
        let b = &polygon[(i + 1) % polygon.len()];
        let (sa, sb) = (side(a), side(b));
        if sa >= 0.0 {
            out.push(*a);
        }
        if (sa >= 0.0) != (sb >= 0.0) {
            let t = sa / (sa - sb);
            out.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
        }
    }
    out
}

fn area(polygon: &[[f64; 2]]) -> f64 {
    let cross = |i: usize| {
        let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        a[0] * b[1] - a[1] * b[0]
    };
    0.5 * (0..polygon.len()).map(cross).sum::<f64>().abs()
}

/// Convex hull, counter-clockwise (monotone chain).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let turn = |o: [f64; 2], a: [f64; 2], b: [f64; 2]| (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut out: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while out.len() > 1 && turn(out[out.len() - 2], out[out.len() - 1], p) <= 0.0 {
                out.pop();
            }
            out.push(p);
        }
        out.pop();
        out
    };
    let lower = chain(&mut points.iter().copied());
    let upper = chain(&mut points.iter().rev().copied());
    [lower, upper].concat()
}

/// Share of the pixels that show a surface whose class is the one of the closed form; the scene is moved along x by `shift` in the closed form.
fn agreement(file: &Path, shift: f64) -> f64 {
    let file = ExrFile::read(file).unwrap();
    let classes = file.layer("shadow-class.lamp").unwrap();
    let classes = classes.channels.first().unwrap().1.clone();
    let position = file.layer("position").unwrap();
    let axis = |name: &str| position.channel(name).unwrap();
    let (x, y, z) = (axis("X"), axis("Y"), axis("Z"));
    let (mut seen, mut same) = (0, 0);
    for (i, &class) in classes.iter().enumerate().filter(|(_, class)| **class >= 0.0) {
        let share = visible_share([f64::from(x[i]) - shift, f64::from(y[i]), f64::from(z[i])]);
        seen += 1;
        same += usize::from(ShadowClass::ALL[class as usize] == ShadowClass::of(share as f32));
    }
    assert!(seen > 10_000, "{seen} pixels show a surface");
    f64::from(same as u32) / f64::from(seen)
}

const WORDS: [&str; 8] = ["render", "builtin:umbra", "--size", "240x135", "--aov", "position,shadow-class.lamp", "-o", "classes.exr"];

/// By the path tracer: at least 99.5 % of pixels, and not when the board is thought 5 cm aside.
#[test]
fn the_reference_finds_the_closed_form() {
    let folder = tempfile::tempdir().unwrap();
    succeed(folder.path(), &[&WORDS[..], &["--spp", "256", "--integrator", "direct"]].concat());
    let file = folder.path().join("classes.exr");
    let (found, planted) = (agreement(&file, 0.0), agreement(&file, 0.05));
    assert!(found >= 0.995 && planted < 0.99, "{found}; 5 cm aside {planted}");
}

/// Shadow rays of the real-time renderer find it too, and a technique without penumbrae does not.
#[test]
fn ray_traced_shadows_find_the_closed_form_and_hard_ones_do_not() {
    let folder = tempfile::tempdir().unwrap();
    let of = |technique: &str| {
        succeed(
            folder.path(),
            &[&WORDS[..], &["--renderer", "realtime", "--technique", &format!("direct-visibility={technique}")]].concat(),
        );
        agreement(&folder.path().join("classes.exr"), 0.0)
    };
    let (rays, hard) = (of("shadow/ray-traced:samples=64"), of("shadow/map"));
    assert!(rays >= 0.995 && hard < 0.95, "rays {rays}, hard {hard}");
}

/// A PNG of one light is the picture of its classes, in the three colours and black; anything else in a PNG is refused.
#[test]
fn a_png_shows_three_colours() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["render", "builtin:umbra", "--size", "96x54", "--spp", "64", "--integrator", "direct", "-o", "c.png", "--aov"];
    let said = succeed(folder.path(), &[&words[..], &["shadow-class.lamp"]].concat());
    assert!(said.contains("umbra indigo, penumbra orange, lit ivory"), "{said}");
    let picture: Image<[u8; 3]> = {
        let read = kajo_image::read_image(&folder.path().join("c.png")).unwrap();
        read.map(|p| p.to_srgb8().0)
    };
    for class in ShadowClass::ALL {
        let count = picture.pixels().iter().filter(|p| **p == class.color().0).count();
        assert!(count > 50, "{}: {count} pixels", class.name());
    }
    let known = |p: &[u8; 3]| *p == [0; 3] || ShadowClass::ALL.iter().any(|class| *p == class.color().0);
    assert!(picture.pixels().iter().all(known));
    for wrong in ["shadow-class.*", "shadow-class.lamp,depth", "depth"] {
        assert_eq!(run(folder.path(), &[&words[..], &[wrong]].concat()).status.code(), Some(2), "{wrong}");
    }
}

/// Classes leave the other layers of the real-time renderer as they are, and are those of one frame at pixel centres however many frames the
/// picture is the mean of, and under a technique that samples elsewhere; where that takes a frame of its own, a note says so.
#[test]
fn classes_do_not_change_the_other_layers_of_the_real_time_renderer() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["render", "builtin:umbra", "--size", "64x36", "--renderer", "realtime", "--technique", "direct-visibility=shadow/map"];
    let of = |aov: &str, more: &[&str]| {
        let output = run(folder.path(), &[&words[..], &["-o", "x.exr", "--aov", aov], more].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        (ExrFile::read(&folder.path().join("x.exr")).unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let numbers =
        |file: &ExrFile, name: &str| file.layer(name).unwrap().channels.iter().map(|(_, values)| values.clone()).collect::<Vec<_>>();
    let both = "direct,visibility.lamp,shadow-class.lamp";
    let (centred, said) = of(both, &[]);
    assert!(!said.contains("shadow classes"), "{said}");
    for more in [["--spp", "4"], ["--technique", "anti-alias=aa/taa"]] {
        let ((with, said), (without, silent)) = (of(both, &more), of("direct,visibility.lamp", &more));
        for name in ["", "direct", "visibility.lamp"] {
            assert_eq!(numbers(&with, name), numbers(&without, name), "{more:?}: {name}");
        }
        assert_eq!(numbers(&with, "shadow-class.lamp"), numbers(&centred, "shadow-class.lamp"), "{more:?}");
        assert!(said.contains("note: shadow classes are of a frame of their own") && !silent.contains("shadow classes"), "{said}");
    }
    assert_ne!(
        numbers(&of(both, &["--spp", "4"]).0, "visibility.lamp"),
        numbers(&centred, "visibility.lamp"),
        "frames are sampled elsewhere"
    );
}

/// The path tracer samples all images at pixel centres for classes: a note says so, and every file which filter it was.
#[test]
fn the_path_tracer_tells_that_classes_change_the_filter() {
    let folder = tempfile::tempdir().unwrap();
    let of = |more: &[&str]| {
        let words = ["render", "builtin:umbra", "--size", "16x9", "--spp", "1", "-o", "x.exr"];
        let output = run(folder.path(), &[&words[..], more].concat());
        let file = ExrFile::read(&folder.path().join("x.exr")).unwrap();
        (String::from_utf8(output.stderr).unwrap().contains("sampled at pixel centres"), file.metadata["filter"].clone())
    };
    assert_eq!(of(&["--aov", "direct,shadow-class.lamp"]), (true, "center".to_owned()));
    assert_eq!(of(&["--aov", "direct,shadow-class.lamp", "--filter", "box"]), (false, "box".to_owned()));
    assert_eq!(of(&["--aov", "direct"]), (false, "blackman-harris".to_owned()));
}
