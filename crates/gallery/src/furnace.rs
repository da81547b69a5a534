//! White spheres under a white sky: what keeps all light cannot be seen.

use crate::GalleryError;
use crate::check::{Check, largest};
use crate::plates::Plate;
use crate::stage::{Ball, Stage};
use crate::studio::{Names, Studio, tiled};
use glam::{UVec2, Vec3};
use kajo_bsdf_lab::figures::{Curve, Figure};
use kajo_path_tracer::{Filter, Settings};

const COLUMNS: u32 = 6;
/// What a tile shows, m.
const HEIGHT: f32 = 2.4;

fn models() -> Vec<Ball> {
    [
        ("lambert", "kd=1", "Lambert"),
        ("oren-nayar", "kd=1 sigma=30", "Oren-Nayar"),
        ("phong", "kd=0 ks=1 n=50", "Phong"),
        ("blinn-phong", "kd=0 ks=1 n=50", "Blinn-Phong"),
        ("cook-torrance", "kd=0 ks=1 m=0.2 fresnel=none", "Cook-Torrance"),
        ("schlick-cook-torrance", "kd=0 ks=1 m=0.2 f0=1", "Schlick-C.-T."),
        ("ward", "kd=0 ks=1 m=0.2", "Ward"),
        ("schlick-single", "c=1 r=0.1", "Schlick"),
        ("ashikhmin-shirley", "rs=1 rd=0 nx=100 ny=100", "Ashikhmin-Sh."),
        ("minnaert", "kd=1 n=0.7", "Minnaert"),
        ("ggx", "alpha=0.7 f0=1", "GGX"),
        ("ggx", "alpha=0.7 f0=1 multiple_scattering=true", "GGX, all facets"),
    ]
    .map(|(model, params, label)| Ball::new(model, params, label))
    .into()
}

/// A sphere alone: one bounce is all there is.
fn stage(ball: &Ball) -> Stage {
    let mut stage = Stage::row(std::slice::from_ref(ball));
    stage.0.nodes.retain(|node| node.meshes != [1]);
    stage.sky(1.0).orthographic(Vec3::new(0.0, 1.0, 5.0), Vec3::Y, Vec3::Y, HEIGHT)
}

/// The albedo over the angle to the normal: means over rings of pixels' centres, one a 5°, from 2.5° to 77.5°.
fn rings(ball: &Ball) -> Result<Vec<[f64; 2]>, GalleryError> {
    let settings = Settings { size: UVec2::splat(96), max_depth: 1, filter: Filter::Center, ..Settings::default() };
    let frame = stage(ball).render(&settings, 32)?;
    let image = frame.beauty();
    let mut rings = [[0.0_f64; 2]; 16];
    let scale = f64::from(HEIGHT) / f64::from(image.height());
    let middle = image.size().as_dvec2() / 2.0;
    for y in 0..image.height() {
        for x in 0..image.width() {
            let sin = (f64::from(x) + 0.5 - middle.x).hypot(f64::from(y) + 0.5 - middle.y) * scale;
            let ring = (sin.min(1.0).asin().to_degrees() / 5.0) as usize;
            if let Some([sum, count]) = rings.get_mut(ring) {
                *sum += f64::from(image.get(x, y).0.element_sum()) / 3.0;
                *count += 1.0;
            }
        }
    }
    let point = |(k, [sum, count]): (usize, &[f64; 2])| (*count > 0.0).then(|| [k as f64 * 5.0 + 2.5, sum / count]);
    Ok(rings.iter().enumerate().filter_map(point).collect())
}

/// The plate.
pub fn plate(studio: &mut Studio) -> Result<Plate, GalleryError> {
    let balls = models();
    let size = UVec2::splat(studio.options.width / COLUMNS);
    let mut tiles = Vec::new();
    let mut curves = Vec::new();
    for (k, ball) in balls.iter().enumerate() {
        let part = [k, k + 1].map(|k| k as f64 / balls.len() as f64);
        let settings = Settings { size, max_depth: 1, ..Settings::default() };
        let frame = studio.render(&stage(ball), &settings, studio.options.spp, part)?;
        curves.push(Curve { name: ball.label.clone(), points: rings(ball)? });
        tiles.push(frame.beauty().clone());
    }
    let checks = checks(&curves);
    let figure = Figure {
        name: "furnace_albedo".into(),
        title: "Reflectance of a white sky, from pixels".into(),
        axes: ["view from the normal, degrees".into(), "radiance".into()],
        curves,
        equal_scales: false,
    };
    let image = tiled(&tiles, COLUMNS);
    let names = Names { tiles: Some((COLUMNS, balls.iter().map(|ball| ball.label.clone()).collect())), ..Names::default() };
    let alt = "Twelve spheres before a background as bright as the sky. Lambert's and that of GGX with all facets cannot be seen; Phong's, Ward's and others darken towards \
               their outline; Schlick's is brighter than the sky there.";
    let shown = vec![studio.picture("furnace", [&image, &image], &names, alt)?, studio.curves(&figure)?];
    let parameters = balls.iter().map(|ball| format!("{}: {} {}", ball.label, ball.model, ball.params)).collect();
    Ok(Plate { shown, checks, parameters, ..Plate::new("furnace", "White spheres under a white sky", CAPTION) })
}

const CAPTION: &str = "Every model at its whitest, under radiance 1 from everywhere, before the same. A sphere that reflects all light vanishes; one that is darker has lost light, a brighter one \
    has made some.";

fn checks(curves: &[Curve]) -> Vec<Check> {
    let of = |name: &str| curves.iter().find(|curve| curve.name == name).map_or(&[][..], |curve| &curve.points);
    let worst = |name: &str| largest(of(name).iter().map(|point| (point[1] - 1.0).abs()));
    let last = |name: &str| of(name).last().map_or(f64::NAN, |point| point[1]);
    vec![
        Check::at_most("Lambert: farthest from 1", worst("Lambert"), 0.02),
        Check::at_most("GGX, all facets: farthest from 1", worst("GGX, all facets"), 0.03),
        Check::at_most("Phong at 77.5°", last("Phong"), 0.3),
        Check::at_least("Schlick at 77.5°: more than arrives", last("Schlick"), 1.05),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_spheres_vanish_and_others_do_not() {
        let curves: Vec<Curve> = models()
            .iter()
            .filter(|ball| ["Lambert", "GGX, all facets", "Phong", "Schlick"].contains(&ball.label.as_str()))
            .map(|ball| Curve { name: ball.label.clone(), points: rings(ball).unwrap() })
            .collect();
        assert!(checks(&curves).iter().all(|check| check.holds), "{:#?}", checks(&curves));
        let mut swapped = curves.clone();
        for curve in &mut swapped {
            curve.points.iter_mut().for_each(|point| point[1] = 1.05 - 0.5 * point[1]);
        }
        assert!(checks(&swapped).iter().all(|check| !check.holds), "planted fault");
    }
}
