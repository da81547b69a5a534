//! The radiometric quantities as integrals of radiance, over directions by [`Hemisphere`] and over surfaces made of flat patches.
//!
//! ```text
//! Φ = ∫_A ∫_Ω L(x→Θ) cos θ dω dA      W          (1.6)
//! E = ∫_Ω L(x←Θ) cos θ dω             W/m²       (1.7)
//! B = ∫_Ω L(x→Θ) cos θ dω             W/m²       (1.8)
//! I = ∫_A L(x→Θ) cos θ dA             W/sr       (1.9)
//! ```

use super::{Hemisphere, lobe::to_frame};
use glam::DVec3;

/// A small flat piece of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Where it is, m.
    pub position: DVec3,
    /// Its unit normal.
    pub normal: DVec3,
    /// Its area, m².
    pub area: f64,
}

/// Irradiance E, W/m²: what arrives at a surface with normal +z under `radiance` from each direction above it.
pub fn irradiance(nodes: &Hemisphere, radiance: impl Fn(DVec3) -> f64) -> f64 {
    nodes.integrate(|w| radiance(w) * w.z)
}

/// Radiosity B (radiant exitance), W/m²: what leaves a surface with normal +z whose radiance towards each direction is `radiance`.
pub fn radiosity(nodes: &Hemisphere, radiance: impl Fn(DVec3) -> f64) -> f64 {
    irradiance(nodes, radiance)
}

/// Radiant power Φ, W, that a surface sends out; `radiance(x, Θ)` with the direction in the frame of the surface as a whole.
pub fn radiant_power(nodes: &Hemisphere, surface: &[Patch], radiance: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    let leaving = |patch: &Patch| {
        let world = |local: DVec3| DVec3::from(to_frame(patch.normal.into(), local.into()));
        patch.area * radiosity(nodes, |local| radiance(patch.position, world(local)))
    };
    surface.iter().map(leaving).sum()
}

/// Radiant intensity I, W/sr, of a surface towards the unit vector `direction`; patches that face away send nothing.
pub fn radiant_intensity(surface: &[Patch], direction: DVec3, radiance: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    surface.iter().map(|patch| radiance(patch.position, direction) * patch.normal.dot(direction).max(0.0) * patch.area).sum()
}

#[cfg(test)]
mod tests {
    use super::super::quadrature::gauss_legendre;
    use super::*;
    use std::f64::consts::{PI, TAU};

    /// A sphere of radius 2 m whose patches are small enough for 1e-9 in every integral here.
    fn sphere() -> Vec<Patch> {
        let (radius, azimuths) = (2.0, 64);
        let mut patches = Vec::new();
        for (x, weight) in gauss_legendre(64) {
            let z = 2.0 * x - 1.0;
            for j in 0..azimuths {
                let (sin, cos) = ((f64::from(j) + 0.5) * TAU / f64::from(azimuths)).sin_cos();
                let normal = DVec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z);
                patches.push(Patch { position: normal * radius, normal, area: 2.0 * weight * TAU / f64::from(azimuths) * radius * radius });
            }
        }
        patches
    }

    /// Row BR-2.
    #[test]
    fn constant_radiance_gives_pi_times_it() {
        let nodes = Hemisphere::new(32, 16);
        assert!((irradiance(&nodes, |_| 7.0) - 7.0 * PI).abs() < 1e-10);
        assert!((radiosity(&nodes, |_| 7.0) - 7.0 * PI).abs() < 1e-10);
        // Light from one half of the sky only.
        assert!((irradiance(&nodes, |w| if w.x > 0.0 { 7.0 } else { 0.0 }) - 3.5 * PI).abs() < 1e-10);
        // L cos θ: the integral is 2π/3, and a forgotten cosine (π) is noticed.
        let cosine = irradiance(&nodes, |w| w.z);
        assert!((cosine - TAU / 3.0).abs() < 1e-10 && (cosine - PI).abs() > 1.0);
    }

    /// Row BR-2: a diffuse sphere is Φ = πL · 4πr², and looks like a disc of πr² from everywhere.
    #[test]
    fn a_glowing_sphere_has_its_power_and_its_intensity() {
        let (sphere, nodes) = (sphere(), Hemisphere::new(16, 16));
        let power = radiant_power(&nodes, &sphere, |_, _| 3.0);
        assert!((power / (3.0 * PI * 4.0 * PI * 4.0) - 1.0).abs() < 1e-9, "{power} W");
        for direction in [DVec3::Z, -DVec3::Z] {
            let intensity = radiant_intensity(&sphere, direction, |_, _| 3.0);
            assert!((intensity / (3.0 * PI * 4.0) - 1.0).abs() < 1e-3, "{intensity} W/sr");
        }
        // Power is also the integral of the intensity over all directions.
        let all = |f: &dyn Fn(DVec3) -> f64| nodes.integrate(|w| f(w) + f(-w));
        let total = all(&|w| radiant_intensity(&sphere, w, |_, _| 3.0));
        assert!((total / power - 1.0).abs() < 1e-3, "{total} W");
        // The direction reaches the radiance in the world's frame: only what goes up counts.
        let upward = radiant_power(&nodes, &sphere, |_, w| if w.z > 0.0 { 3.0 } else { 0.0 });
        assert!((upward / power - 0.5).abs() < 1e-2, "{upward} W");
    }
}
