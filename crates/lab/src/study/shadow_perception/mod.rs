//! The same objects with and without shadows: Fig. 1 of Arvo's survey.

use super::{Bench, Findings, Picture, Rig, Set, Study, Table};
use crate::LabError;
use glam::{Affine3A, UVec2, Vec3};
use kajo_renderer::FrameOutput;
use kajo_scene::{LightShape, Projection, shapes};
use kajo_units::Radians;

/// The study.
pub const STUDY: Study =
    Study { id: "shadow-perception", title: "What do shadows tell about distances?", doc: include_str!("doc.md"), run };

const EYE: Vec3 = Vec3::new(0.0, 2.4, 6.0);
/// Towards the sun, not normalised.
const TO_SUN: Vec3 = Vec3::new(-0.8, 1.0, 0.1);
/// Where the middle ball is at first, and its radius.
const BALL: Vec3 = Vec3::new(0.1, 0.4, 1.2);
const RADIUS: f32 = 0.3;
/// How much nearer to the eye it is in the other arrangement: it hangs higher then, and is smaller by as much.
const NEARER: f32 = 0.72;

/// The middle ball and its radius, on the line from the eye through [`BALL`].
fn ball(share: f32) -> (Vec3, f32) {
    (EYE + (BALL - EYE) * share, RADIUS * share)
}

fn set(share: f32) -> Set {
    let (middle, radius) = ball(share);
    let ball = |radius: f32, at: Vec3| (shapes::sphere(radius, 48), Affine3A::from_translation(at));
    let balls = [ball(0.3, Vec3::new(-1.3, 0.3, 0.0)), ball(radius, middle), ball(0.3, Vec3::new(1.4, 0.3, -0.4))];
    let floor = Set::default().place(shapes::floor(14.0, 14.0, 1.0), Affine3A::IDENTITY);
    balls
        .into_iter()
        .fold(floor, |set, (mesh, place)| set.place(mesh, place))
        .light(LightShape::Directional { half_angle: Radians(0.0) }, TO_SUN, Vec3::ZERO)
        .camera(Projection::Perspective { yfov: Radians(0.62), aspect: None }, EYE, Vec3::new(0.0, 0.3, 0.0))
}

fn run(bench: &Bench) -> Result<Findings, LabError> {
    let size = if bench.quick { UVec2::new(320, 200) } else { UVec2::new(800, 500) };
    let mut out = Findings::default();
    let mut table =
        Table::new("heights", "Height of the middle ball read from its shadow.", &["arrangement", "height, m", "read from the shadow, m"]);
    let mut right = true;
    let mut without = Vec::new();
    for (index, (name, share)) in [("far and low", 1.0), ("near and high", NEARER)].into_iter().enumerate() {
        bench.at(name, 0.5 * index as f64)?;
        let mut scene = set(share).scene;
        scene.exposure = Some(1.5);
        let mut rig = Rig::new(bench.device, scene, size)?;
        let plain = rig.frame("shadow/none")?;
        let shadowed = rig.frame("shadow/map:resolution=4096")?;
        let (middle, _) = ball(share);
        let read = height(&shadowed, middle);
        right &= (read / middle.y - 1.0).abs() < 0.03;
        table.row([name.into(), f64::from(middle.y).into(), f64::from(read).into()]);
        for (kind, frame) in [("without", &plain), ("with", &shadowed)] {
            let file = format!("{}-{kind}", name.replace(' ', "-"));
            let caption = format!("The middle ball {name}, {kind} shadows.");
            out.pictures.push(Picture { name: file, caption, image: frame.display.clone() });
        }
        without.push(plain);
    }
    let moved = different(&without[0], &without[1]);
    out.claim("Without shadows the arrangements look alike.", moved < 0.01, format!("{:.2} % of the pixels differ", 100.0 * moved));
    out.claim("With shadows the height of the ball can be read to three parts in a hundred.", right, "see the table");
    out.tables.push(table);
    Ok(out)
}

/// The height of a ball over the floor, from the middle of its shadow.
fn height(out: &FrameOutput, ball: Vec3) -> f32 {
    let gbuffer = out.gbuffer.as_ref().expect("asked for");
    let tangent = Vec3::new(TO_SUN.x, 0.0, TO_SUN.z).length() / TO_SUN.y;
    let away = -Vec3::new(TO_SUN.x, 0.0, TO_SUN.z).normalize();
    // Dark pixels of the floor in the row of the shadow: points on the line from below the ball away from the sun, half a radius to either side.
    let below = Vec3::new(ball.x, 0.0, ball.z);
    let along =
        gbuffer.position.pixels().iter().zip(gbuffer.instance.pixels()).zip(out.visibility[0].pixels()).filter_map(|((p, i), v)| {
            let offset = *p - below;
            let aside = offset - away * offset.dot(away);
            (*i == Some(0) && *v < 0.5 && Vec3::new(aside.x, 0.0, aside.z).length() < 0.02).then(|| offset.dot(away))
        });
    let [low, high] = along.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], t| [low.min(t), high.max(t)]);
    0.5 * (low + high) / tangent
}

/// Share of pixels whose displayed colours differ by more than what a slightly other angle of light does.
fn different(a: &FrameOutput, b: &FrameOutput) -> f32 {
    let far = |(a, b): (&kajo_units::Srgb8, &kajo_units::Srgb8)| (0..3).any(|c| a.0[c].abs_diff(b.0[c]) > 24);
    let pairs = a.display.pixels().iter().zip(b.display.pixels());
    pairs.filter(|pair| far(*pair)).count() as f32 / a.display.pixels().len() as f32
}
