//! A model's lobe in the plane of incidence.

use super::{Curve, Figure};
use crate::checks::{brdf, from_degrees};
use kajo_bsdf::models::Reflectance;

/// f over the viewer's inclination by half degrees, negative on the light's side, positive on the mirror's; a curve for each inclination of the light.
/// Of a shading function S/cos θ_i. The mean of the channels.
pub fn lobe(model: &dyn Reflectance, id: &str, theta_i: &[f64]) -> Figure {
    let curve = |&theta_i: &f64| {
        let wi = from_degrees(theta_i, 0.0);
        let points = (-179..=179).map(|k| f64::from(k) * 0.5).map(|theta_r| {
            let f = brdf(model, wi, from_degrees(theta_r, 180.0));
            [theta_r, f.element_sum() / 3.0]
        });
        Curve { name: format!("light at {theta_i} degrees"), points: points.collect() }
    };
    Figure {
        name: format!("{id}_lobe"),
        title: format!("{id}: f in the plane of incidence"),
        axes: ["inclination of the viewer, degrees".into(), "f, 1/sr".into()],
        curves: theta_i.iter().map(curve).collect(),
        equal_scales: false,
    }
}

/// [`lobe`] as arrows from the origin: f sin θ_r, f cos θ_r.
pub fn polar_lobe(model: &dyn Reflectance, id: &str, theta_i: &[f64]) -> Figure {
    let mut figure = lobe(model, id, theta_i);
    for [x, y] in figure.curves.iter_mut().flat_map(|curve| &mut curve.points) {
        let (sin, cos) = x.to_radians().sin_cos();
        (*x, *y) = (*y * sin, *y * cos);
    }
    figure.name = format!("{id}_polar");
    figure.axes = ["f along the surface, 1/sr".into(), "f along the normal, 1/sr".into()];
    figure.equal_scales = true;
    figure
}
