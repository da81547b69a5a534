//! Where a shadow's border runs between the samples of a reference.
//!
//! Images at pixel centres do not show what is narrower than a pixel: light between two folds of a mesh, the outline of a thing behind which another shadow
//! lies. A technique whose sample lies a thousandth of a pixel elsewhere may see it, and is right. Whether a pixel is away from every border is therefore asked of
//! samples all over its neighbourhood.

use crate::judge::Judge;
use crate::{LabError, Progress};
use kajo_image::Image;
use kajo_image_metrics::TOLERANCE;
use kajo_path_tracer::{Aov, Filter, Integrator, Settings, Stop, Tracer, render};
use kajo_units::LinearRgb;
use std::ops::ControlFlow;

/// Samples of each pixel: with its neighbours 144 for the area within which a border counts as near.
pub(crate) const SPP: u32 = 16;

/// Fills [`Part::settled`](crate::judge::Part::settled) of a judge of the role direct visibility; false when interrupted.
///
/// # Errors
/// Settings that the tracer refuses.
pub(crate) fn settle(judge: &mut Judge, tracer: &Tracer, base: &Settings, progress: &dyn Progress) -> Result<bool, LabError> {
    let aovs: Vec<Aov> = judge.parts.iter().map(|part| part.name.parse()).collect::<Result<_, _>>()?;
    let settings = Settings { integrator: Integrator::Direct, filter: Filter::Box, aovs, ..base.clone() };
    let control = |_: &kajo_path_tracer::Progress| if progress.interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let frame = render(tracer, &settings, Stop::at_spp(SPP), None, &control)?.develop();
    if progress.interrupted() {
        return Ok(false);
    }
    for part in &mut judge.parts {
        let area = frame.image(&part.name).expect("an image that was asked for").pixels.to_color();
        part.settled = Some(settled(&part.image, &area));
    }
    Ok(true)
}

/// False where the image is the same at a pixel's centre and at those of its neighbours, and yet not over their areas: a border runs between the centres.
fn settled(centers: &Image<LinearRgb>, area: &Image<LinearRgb>) -> Image<bool> {
    let (width, height) = (centers.width(), centers.height());
    Image::from_fn(centers.size(), |x, y| {
        let own = centers.get(x, y)[0];
        let all_own = |image: &Image<LinearRgb>| {
            let columns = x.saturating_sub(1)..=(x + 1).min(width - 1);
            let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
            rows.flat_map(|v| columns.clone().map(move |u| (u, v))).all(|(u, v)| (image.get(u, v)[0] - own).abs() < TOLERANCE)
        };
        !all_own(centers) || all_own(area)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::references;
    use crate::{ReferenceStop, progress::Unwatched};
    use glam::{UVec2, Vec3};
    use kajo_scene::{Snapshot, builtin};
    use kajo_units::Seconds;

    fn grey(size: UVec2, of: impl Fn(u32, u32) -> f32) -> Image<LinearRgb> {
        Image::from_fn(size, |x, y| LinearRgb::splat(of(x, y)))
    }

    #[test]
    fn a_sliver_between_centres_unsettles_its_neighbours_only() {
        let size = UVec2::new(9, 5);
        let edge = |x: u32| if x < 6 { 1.0 } else { 0.0 };
        let area = grey(size, |x, y| if (x, y) == (2, 2) { 0.9 } else { edge(x) });
        let settled = settled(&grey(size, |x, _| edge(x)), &area);
        for (x, y) in (0..5u32).flat_map(|y| (0..9u32).map(move |x| (x, y))) {
            let near = x.abs_diff(2) <= 1 && y.abs_diff(2) <= 1;
            assert_eq!(*settled.get(x, y), !near, "({x}, {y}): pixels of the border that centres show stay as they are");
        }
    }

    /// A shadow in the wrong place is no sliver: almost every pixel away from the border still counts.
    #[test]
    fn most_of_a_scene_is_settled() {
        let scene = builtin::load("shadows").unwrap();
        let tracer = Tracer::new(&scene, Snapshot::new(&scene, Seconds(0.0))).unwrap();
        let base = Settings { size: UVec2::new(160, 90), ..Settings::default() };
        let mut found = references(&tracer, &["direct-visibility"], &base, ReferenceStop::Spp(4), &Unwatched, &|f| f).unwrap().unwrap();
        let judge = found.judges.get_mut("direct-visibility").unwrap();
        assert!(judge.parts.iter().all(|part| part.settled.is_none()));
        assert!(settle(judge, &tracer, &base, &Unwatched).unwrap());
        for part in &judge.parts {
            let image = part.settled.as_ref().unwrap();
            let share = image.pixels().iter().filter(|on| **on).count() as f32 / image.pixels().len() as f32;
            assert!(share > 0.85, "{}: {share}", part.name);
            let shadow = part.image.pixels().iter().zip(image.pixels()).filter(|(v, on)| **on && v.0 == Vec3::ZERO).count();
            assert!(shadow > 100, "{}: {shadow} pixels of settled shadow", part.name);
        }
    }
}
