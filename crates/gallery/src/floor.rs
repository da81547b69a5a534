//! A floor of each model, looked at more and more steeply: how plain is the mirror image in it?
//!
//! The sky has white and black bands parallel to the plane of view, each 8° wide. A mirror of it has contrast 1 at every angle; a matte floor sees
//! the whole sky from everywhere and has contrast 0. What lies between is the share of the mirror image,
//!
//! ```text
//! C = (L_white − L_black)/(L_white + L_black)
//! ```
//!
//! with radiances at places of the floor that mirror the middle of a band. The light that the floor gets is the same at every angle, and so is the
//! width of the bands: only the model changes the contrast. In the survey \[Falski04] this series is told (section 5.3.1) and its pictures are lost.

use crate::GalleryError;
use crate::check::{Check, largest, smallest};
use crate::plates::Plate;
use crate::stage::{Ball, Stage, at};
use crate::studio::{Names, Studio, tiled};
use glam::{UVec2, Vec3};
use kajo_bsdf_lab::figures::{Curve, Figure};
use kajo_image::Image;
use kajo_path_tracer::{Frame, Settings};
use kajo_scene::{Environment, Material, Texels, TextureImage, shapes};
use kajo_units::{LinearRgb, Radians};
use std::sync::Arc;

/// Inclinations of the view from the floor's normal, degrees.
pub const ANGLES: [f32; 6] = [15.0, 30.0, 45.0, 60.0, 70.0, 80.0];
/// Width of a band, degrees.
const BAND: f64 = 8.0;
/// Vertical field of view, degrees.
const FIELD: f32 = 26.0;

/// What is known of a model's contrast over the angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trend {
    /// It falls at each step.
    Falls,
    /// It does not fall.
    Holds,
}

/// The floors.
pub fn floors() -> Vec<(Ball, Trend)> {
    use Trend::{Falls, Holds};
    let floor = |model, params: &str, label: &str, trend| (Ball::new(model, params, label), trend);
    vec![
        floor("phong", "kd=0.4 ks=0.4 n=2000", "Phong", Falls),
        floor("blinn-phong", "kd=0.4 ks=0.4 n=8000", "Blinn-Phong", Falls),
        floor("ward", "kd=0.4 ks=0.4 m=0.015", "Ward", Falls),
        floor("cook-torrance", "kd=0.4 ks=0.4 m=0.015 eta=1.5", "Cook-Torrance", Holds),
        floor("schlick-cook-torrance", "kd=0.4 ks=0.4 m=0.015 f0=0.04", "Schlick-Cook-Torrance", Holds),
        floor("schlick-single", "c=0.5 r=0.0005", "Schlick, one layer", Holds),
        floor("schlick-double", "c=0.04 r=0.0005 c2=0.5 r2=0.8", "Schlick, two layers", Holds),
        floor("ashikhmin-shirley", "rs=0.05 rd=0.5 nx=8000 ny=8000", "Ashikhmin-Shirley", Holds),
        floor("htsg", "sigma0=0.05 tau=3 lambda=0.5 eta=1.5 kappa=0 kd=0.4", "He et al.", Holds),
        floor("principled", "base_color=0.5 roughness=0.12", "Principled", Holds),
    ]
}

/// Bands of the sky by the angle from the plane x = 0: white about it, then black, and so on.
fn bands() -> Environment {
    const SIZE: UVec2 = UVec2::new(1024, 512);
    let mut environment = Environment::uniform(LinearRgb::WHITE);
    let texel = |x: u32, y: u32| {
        let direction = environment.direction(glam::Vec2::new((x as f32 + 0.5) / SIZE.x as f32, (y as f32 + 0.5) / SIZE.y as f32));
        let angle = f64::from(direction.x.clamp(-1.0, 1.0).asin()).to_degrees();
        [if (angle / BAND + 0.5).floor() as i64 % 2 == 0 { 1.0 } else { 0.0 }; 3]
    };
    let texels = Texels::Rgb32F((0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect());
    environment.rotation = Radians(0.0);
    environment.image = Some(Arc::new(TextureImage { name: "bands".into(), width: SIZE.x, height: SIZE.y, texels }));
    environment
}

fn stage(ball: &Ball, degrees: f32) -> Stage {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let material = ball.prepare().replace_reflection(Material::default());
    let mut stage = Stage::default().mesh(shapes::floor(4000.0, 4000.0, 1.0), material, at(Vec3::ZERO)).perspective(
        Vec3::new(0.0, cos, sin) * 3.0,
        Vec3::ZERO,
        FIELD,
    );
    stage.0.environment = Some(bands());
    stage
}

fn settings(size: UVec2) -> Settings {
    Settings { size, max_depth: 1, ..Settings::default() }
}

/// Contrast of a picture's middle with its standard error: pixels within ±3° of the angle that mirror the inner half of a band.
pub fn contrast(frame: &Frame) -> (f64, f64) {
    let (image, variance) = (frame.beauty(), frame.beauty_variance());
    let size = image.size().as_dvec2();
    let scale = (f64::from(FIELD).to_radians() / 2.0).tan() * 2.0 / size.y;
    // Sum, variance of the sum, count.
    let mut sums = [[0.0_f64; 3]; 2];
    for y in 0..image.height() {
        for x in 0..image.width() {
            let (u, v) = ((f64::from(x) + 0.5 - size.x / 2.0) * scale, (f64::from(y) + 0.5 - size.y / 2.0) * scale);
            if v.atan().to_degrees().abs() > 3.0 {
                continue;
            }
            let angle = (u / (1.0 + u * u + v * v).sqrt()).asin().to_degrees() / BAND;
            if (angle - angle.round()).abs() < 0.25 {
                let sum = &mut sums[(angle.round() as i64).rem_euclid(2) as usize];
                sum[0] += f64::from(image.get(x, y).0.x);
                sum[1] += f64::from(variance.get(x, y).0.x);
                sum[2] += 1.0;
            }
        }
    }
    let [white, black] = sums.map(|[sum, variance, count]| (sum / count, variance / (count * count)));
    let total = white.0 + black.0;
    let value = (white.0 - black.0) / total;
    // ∂C/∂W = 2B/(W+B)², ∂C/∂B = −2W/(W+B)².
    let error = 2.0 / (total * total) * (black.0 * black.0 * white.1 + white.0 * white.0 * black.1).sqrt();
    (value, error)
}

/// Contrast over the angle, and its standard errors.
type Series = Vec<(f64, f64)>;

/// What must hold of a series: no step against the trend beyond noise, and a change over the whole range.
fn judge(name: &str, trend: Trend, series: &Series) -> Vec<Check> {
    let steps = || series.windows(2).map(|pair| (pair[1].0 - pair[0].0, pair[0].1.hypot(pair[1].1)));
    let (first, last) = (series[0], series[series.len() - 1]);
    let (change, error) = (last.0 - first.0, first.1.hypot(last.1));
    let what =
        format!("{name}: contrast at {}° less that at {}°, 3 standard errors nearer to no change", ANGLES[ANGLES.len() - 1], ANGLES[0]);
    match trend {
        Trend::Falls => {
            let largest = largest(steps().map(|(step, error)| step - 3.0 * error));
            let step = Check::at_most(format!("{name}: contrast falls; its largest step less 3 standard errors"), largest, 0.0);
            vec![step, Check::at_most(what, change + 3.0 * error, -0.2)]
        }
        Trend::Holds => {
            let smallest = smallest(steps().map(|(step, error)| step + 3.0 * error));
            let step = Check::at_least(format!("{name}: contrast does not fall; its smallest step and 3 standard errors"), smallest, 0.0);
            vec![step, Check::at_least(what, change - 3.0 * error, 0.15)]
        }
    }
}

/// The plate: pictures of all floors at all angles, the curves, the checks.
pub fn plate(studio: &mut Studio) -> Result<Plate, GalleryError> {
    let floors = floors();
    let tile = UVec2::new(studio.options.width / ANGLES.len() as u32, studio.options.width / ANGLES.len() as u32 * 3 / 4);
    let steps = (floors.len() * ANGLES.len()) as f64;
    let mut tiles = Vec::new();
    let mut curves = Vec::new();
    let mut checks = Vec::new();
    for (row, (ball, trend)) in floors.iter().enumerate() {
        let mut series = Series::new();
        for (column, angle) in ANGLES.into_iter().enumerate() {
            let done = (row * ANGLES.len() + column) as f64;
            let frame = studio.render(&stage(ball, angle), &settings(tile), studio.options.spp, [done / steps, (done + 1.0) / steps])?;
            series.push(contrast(&frame));
            tiles.push(frame.beauty().clone());
        }
        checks.extend(judge(&ball.label, *trend, &series));
        let points = ANGLES.iter().zip(&series).map(|(angle, point)| [f64::from(*angle), point.0]).collect();
        curves.push(Curve { name: ball.label.clone(), points });
    }
    let figure = Figure {
        name: "floor_contrast".into(),
        title: "Contrast of the mirror image in a floor".into(),
        axes: ["view from the normal, degrees".into(), "(white - black)/(white + black)".into()],
        curves,
        equal_scales: false,
    };
    let names = Names {
        rows: floors.iter().map(|(ball, _)| ball.label.clone()).collect(),
        columns: ANGLES.map(|angle| format!("{angle}°")).into(),
        tiles: None,
    };
    let image: Image<LinearRgb> = tiled(&tiles, ANGLES.len() as u32);
    let alt = "Floors of ten models under a banded sky at six angles: the bands' mirror image fades towards grazing angles for Phong, Blinn-Phong and Ward, and grows for the others";
    let shown = vec![studio.picture("floor", [&image, &image], &names, alt)?, studio.curves(&figure)?];
    let parameters = floors.iter().map(|(ball, _)| format!("{}: {}", ball.label, ball.params)).collect();
    Ok(Plate { shown, checks, parameters, ..Plate::new("floor", "The mirror image in a floor, over the viewing angle", CAPTION) })
}

const CAPTION: &str = "White and black bands of the sky, mirrored by floors that are seen from 15° to 80° off their normal. Where nothing but the cosine counts the image fades \
    into the diffuse light; with Fresnel's term, or where the diffuse part loses what the mirror takes, it grows. The contrast is measured on the pixels.";

#[cfg(test)]
mod tests {
    use super::*;

    fn series(ball: &Ball) -> Series {
        let settings = settings(UVec2::new(36, 27));
        ANGLES.map(|angle| contrast(&stage(ball, angle).render(&settings, 48).unwrap())).into()
    }

    /// Row BR-39.
    #[test]
    fn mirror_images_fade_for_phong_and_hold_for_models_with_a_fresnel_term() {
        for (ball, trend) in floors() {
            let series = series(&ball);
            assert!(judge(&ball.label, trend, &series).iter().all(|check| check.holds), "{}: {series:?}", ball.label);
            // Over the whole range the change is far beyond noise.
            let (first, last) = (series[0], series[ANGLES.len() - 1]);
            let change = (last.0 - first.0) / first.1.hypot(last.1);
            match trend {
                Trend::Falls => {
                    assert!(change < -20.0 && series.windows(2).all(|pair| pair[1].0 < pair[0].0), "{}: {series:?}", ball.label)
                }
                Trend::Holds => assert!(change > 20.0, "{}: {change} {series:?}", ball.label),
            }
        }
    }

    #[test]
    fn matte_floors_have_no_contrast_and_the_trends_are_not_interchangeable() {
        let matte = series(&Ball::new("lambert", "kd=0.5", ""));
        assert!(matte.iter().all(|(contrast, error)| contrast.abs() < 4.0 * error + 1e-3), "{matte:?}");
        let phong = series(&floors()[0].0);
        assert!(judge("", Trend::Holds, &phong).iter().all(|check| !check.holds), "planted fault: {phong:?}");
    }
}
