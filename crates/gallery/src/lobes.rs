//! Goniometric bodies: how far the surface reaches in a direction is what is sent there, f(ω_i, ω_r) cos θ_r.
//!
//! Each model's body is a mesh, scaled to its farthest point and path traced; the light of the lobe comes along the rod. Beside it, the cut through
//! the plane of incidence as curves.

use crate::GalleryError;
use crate::plates::Plate;
use crate::stage::{Ball, Stage, at, matte};
use crate::studio::{Names, Studio, tiled};
use glam::{DVec3, Quat, UVec2, Vec3};
use kajo_bsdf::models::V3;
use kajo_bsdf_lab::figures::polar_lobe;
use kajo_path_tracer::Settings;
use kajo_scene::{Material, Mesh, Transform, shapes};
use kajo_units::LinearRgb;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Inclination of the light, degrees.
const THETA_I: f64 = 45.0;
/// Quads along inclination and azimuth.
const GRID: [usize; 2] = [120, 240];
const COLUMNS: u32 = 4;

fn models() -> Vec<Ball> {
    [
        ("lambert", "kd=0.8", "Lambert"),
        ("oren-nayar", "kd=0.8 sigma=35", "Oren-Nayar"),
        ("phong", "kd=0.4 ks=0.4 n=12", "Phong"),
        ("blinn-phong", "kd=0.4 ks=0.4 n=40", "Blinn-Phong"),
        ("cook-torrance", "kd=0.2 ks=0.8 m=0.35 fresnel=none", "Cook-Torrance"),
        ("htsg", "", "He et al."),
        ("ward", "kd=0.3 ks=0.5 mx=0.15 my=0.5", "Ward, anisotropic"),
        ("schlick-double", "c=0.15 r=0.15 c2=0.6 r2=0.8", "Schlick, two layers"),
        ("ashikhmin-shirley", "rs=0.4 rd=0.5 nx=60 ny=8", "Ashikhmin-Shirley"),
        ("lafortune", "kd=0.3 ks=0.4 lobe=-1,-1,0.8,10 lobe=0.7,0.7,0.7,6", "Lafortune, with retro-reflection"),
        ("strauss", "c=0.7 s=0.75 e=0.3 t=0", "Strauss"),
        ("ggx", "alpha=0.3 f0=0.9", "GGX"),
    ]
    .map(|(model, params, label)| Ball::new(model, params, label))
    .into()
}

/// From the frame of the surface (z up) to the world (y up).
fn world(w: DVec3) -> Vec3 {
    DVec3::new(w.x, w.z, -w.y).as_vec3()
}

/// The body and its farthest reach, 1/sr.
fn body(ball: &Ball) -> (Mesh, f64) {
    let model = ball.prepare().reflectance;
    let wi: DVec3 = V3::from_angles(THETA_I.to_radians(), 0.0).into();
    let [rows, columns] = GRID;
    let reach: Vec<(DVec3, f64)> = (0..=rows)
        .flat_map(|row| (0..columns).map(move |column| (row, column)))
        .map(|(row, column)| {
            let [theta, phi] = [row as f64 / rows as f64 * FRAC_PI_2, column as f64 / columns as f64 * TAU];
            let wo: DVec3 = V3::from_angles(theta.min(FRAC_PI_2 - 1e-6), phi).into();
            // Both are the radiance for a unit of irradiance, but for the light's cosine.
            (wo, (model.f_cos(wi, wo).element_sum() / 3.0 * wo.z).max(0.0))
        })
        .collect();
    let farthest = reach.iter().map(|(_, r)| *r).fold(0.0, f64::max);
    let positions: Vec<Vec3> = reach.iter().map(|(w, r)| world(*w * (r / farthest))).collect();
    let vertex = |row: usize, column: usize| (row * columns + column % columns) as u32;
    let quads = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let indices: Vec<[u32; 3]> = quads
        .flat_map(|(row, column)| {
            let [a, b, c, d] = [vertex(row, column), vertex(row + 1, column), vertex(row + 1, column + 1), vertex(row, column + 1)];
            [[a, b, c], [a, c, d]]
        })
        .filter(|triangle| {
            let [a, b, c] = triangle.map(|i| positions[i as usize]);
            (b - a).cross(c - a).length() > 1e-12
        })
        .collect();
    let mut normals = vec![Vec3::ZERO; positions.len()];
    for triangle in &indices {
        let [a, b, c] = triangle.map(|i| positions[i as usize]);
        for &i in triangle {
            normals[i as usize] += (b - a).cross(c - a);
        }
    }
    // The pole is one point of many vertices.
    let pole = normals[..columns].iter().copied().sum::<Vec3>();
    normals[..columns].fill(pole);
    let normals =
        normals.into_iter().zip(&positions).map(|(normal, position)| normal.normalize_or(position.normalize_or(Vec3::Y))).collect();
    (Mesh { name: "lobe".into(), positions, normals, indices, ..Mesh::default() }, farthest / wi.z)
}

fn stage(mesh: Mesh) -> Stage {
    let lacquer =
        Material { base_color: LinearRgb::new(0.85, 0.33, 0.1), roughness: 0.45, metallic: 0.0, double_sided: true, ..Material::default() };
    let light = Quat::from_rotation_z(-(THETA_I as f32).to_radians());
    let rod = Transform::Trs { translation: Vec3::ZERO, rotation: light, scale: Vec3::ONE };
    let stage = Stage::default()
        .mesh(mesh, lacquer, at(Vec3::ZERO))
        .mesh(shapes::cylinder(0.022, 1.25, 24), matte(LinearRgb::new(0.1, 0.25, 0.55)), rod)
        .mesh(shapes::cylinder(1.15, 0.01, 128), matte(LinearRgb::splat(0.72)), at(Vec3::new(0.0, -0.0105, 0.0)))
        .mesh(shapes::floor(40.0, 40.0, 1.0), matte(LinearRgb::splat(0.82)), at(Vec3::new(0.0, -0.0115, 0.0)))
        .light(Vec3::new(0.5, 1.0, 0.75))
        .sky(0.35);
    let target = Vec3::new(0.0, 0.36, 0.0);
    stage.perspective(target + Vec3::new(-0.55, 0.42, 1.0).normalize() * 5.2, target, 26.0)
}

/// The plate.
pub fn plate(studio: &mut Studio) -> Result<Plate, GalleryError> {
    let balls = models();
    let side = studio.options.width / COLUMNS;
    let size = UVec2::new(side, side * 3 / 4);
    let mut tiles = Vec::new();
    let mut parameters = Vec::new();
    let mut curves = Vec::new();
    for (k, ball) in balls.iter().enumerate() {
        let (mesh, farthest) = body(ball);
        let part = [k, k + 1].map(|k| k as f64 / balls.len() as f64);
        let settings = Settings { size, max_depth: 3, ..Settings::default() };
        tiles.push(studio.render(&stage(mesh), &settings, studio.options.spp, part)?.beauty().clone());
        parameters.push(format!("{}: {} {}; farthest {farthest:.3}/sr", ball.label, ball.model, ball.params));
        let mut figure = polar_lobe(&*ball.prepare().reflectance, ball.model, &[0.0, 30.0, 60.0]);
        figure.name = format!("polar_{}", ball.model);
        figure.title = format!("{}: f in the plane of incidence", ball.label);
        curves.push(studio.curves(&figure)?);
    }
    let image = tiled(&tiles, COLUMNS);
    let rows: Vec<String> =
        balls.chunks(COLUMNS as usize).map(|row| row.iter().map(|ball| ball.label.as_str()).collect::<Vec<_>>().join(", ")).collect();
    let alt = format!("Twelve bodies on a disc, light from 45° along a rod. By rows: {}", rows.join("; "));
    let mut shown = vec![studio.picture(
        "lobes",
        [&image, &image],
        &Names { tiles: Some((COLUMNS, balls.iter().map(|ball| ball.label.clone()).collect())), ..Names::default() },
        &alt,
    )?];
    shown.extend(curves);
    Ok(Plate { shown, parameters, ..Plate::new("lobes", "Goniometric bodies, light from 45°", CAPTION) })
}

const CAPTION: &str = "The surface reaches as far in a direction as light is sent there: f cos θr, scaled to its farthest point. Light comes along the blue rod. Below, f itself in the \
    plane of incidence for light from 0°, 30° and 60°, as arrows from the origin.";

#[cfg(test)]
mod tests {
    use super::*;

    /// Of Lambert's model the body is the sphere of diameter 1 on the surface; of a mirror-like lobe it points to the mirror direction.
    #[test]
    fn bodies_reach_as_far_as_light_is_sent() {
        let (mesh, farthest) = body(&Ball::new("lambert", "kd=0.8", ""));
        assert!((farthest - 0.8 * std::f64::consts::FRAC_1_PI).abs() < 1e-6, "{farthest}");
        assert!(mesh.positions.iter().all(|p| ((*p - Vec3::Y * 0.5).length() - 0.5).abs() < 1e-5));
        assert!(
            mesh.normals
                .iter()
                .zip(&mesh.positions)
                .filter(|(_, p)| p.length() > 0.1)
                .all(|(n, p)| n.dot((*p - Vec3::Y * 0.5).normalize()) > 0.99)
        );
        let (mesh, _) = body(&Ball::new("phong", "kd=0 ks=1 n=2000", ""));
        let tip = mesh.positions.iter().copied().max_by(|a, b| a.length().total_cmp(&b.length())).unwrap();
        let mirror = Vec3::new(-1.0, 1.0, 0.0).normalize();
        assert!(tip.normalize().dot(mirror) > 0.9999 && (tip.length() - 1.0).abs() < 1e-6, "{tip}");
    }
}
