//! Estimators of light transport along one camera ray.

pub(crate) mod ambient;
pub(crate) mod bsdf_only;
pub(crate) mod dispersion;
pub(crate) mod first_hit;
pub(crate) mod path;

use crate::Settings;
use crate::lights::{Lights, SeenLight};
use crate::world::World;
use glam::Vec3;
use kajo_bvh::{Hit, Ray};
use kajo_sampling::hash_u64;
use kajo_sampling::light_tree::Receiver;
use kajo_units::LinearRgb;

/// What every estimator reads.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    pub world: &'a World,
    pub lights: &'a Lights,
    pub settings: &'a Settings,
    /// Surface bounces a path may have.
    pub max_depth: u32,
}

impl Context<'_> {
    /// Calls `see` with each lamp that a ray passes, and with what is behind everything where it leaves the scene: the distance and the light.
    #[inline(always)]
    fn pass(&self, traced: &TracedRay, receiver: Option<&Receiver>, mut see: impl FnMut(f32, SeenLight)) {
        let (ray, t_max) = (&traced.ray, traced.hit.map_or(f32::INFINITY, |hit| hit.t));
        self.lights.along(receiver, ray.origin, ray.direction, t_max, |t, seen| {
            if t > ray.t_min {
                see(t, seen);
            }
        });
        if traced.hit.is_none() {
            self.lights.beyond(self.world, receiver, ray.direction, |seen| see(f32::INFINITY, seen));
        }
    }
}

impl Context<'_> {
    /// The same for light of at most one bounce.
    pub(crate) fn direct_only(self) -> Self {
        Self { max_depth: self.max_depth.min(1), ..self }
    }
}

/// A ray with the nearest surface on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TracedRay {
    pub ray: Ray,
    pub hit: Option<Hit>,
}

/// Numbers for the rays of one sample: each decides by chance what blended surfaces let pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chance {
    key: u64,
    /// Rays traced so far.
    pub rays: u64,
}

impl Chance {
    pub(crate) fn new(key: u64) -> Self {
        Self { key, rays: 0 }
    }

    /// The number of the next ray.
    #[inline]
    pub(crate) fn next(&mut self) -> u64 {
        self.rays += 1;
        hash_u64(self.key.wrapping_add(self.rays))
    }
}

/// Light, or a path's throughput, split by the lobe of the first bounce.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Split {
    pub diffuse: LinearRgb,
    pub specular: LinearRgb,
}

impl Split {
    /// Before the first bounce everything is kept in one half.
    pub(crate) const CAMERA: Self = Self { diffuse: LinearRgb::WHITE, specular: LinearRgb::BLACK };

    #[inline]
    pub(crate) fn total(self) -> LinearRgb {
        self.diffuse + self.specular
    }

    #[inline]
    pub(crate) fn scaled(self, by: LinearRgb) -> Self {
        Self { diffuse: self.diffuse * by, specular: self.specular * by }
    }
}

/// Where an estimator leaves what it finds.
pub(crate) trait Sink {
    /// Whether light that bounced `bounces` times is kept; what is not need not be looked for.
    fn wants(&self, _bounces: u32) -> bool {
        true
    }

    /// Light of `light` that bounced `bounces` times.
    fn light(&mut self, bounces: u32, light: u32, share: Split);
}

/// exp(−σ t): what a volume lets through; towards infinity everything, for no volume reaches there.    Beer-Lambert law
#[inline]
pub(crate) fn transmittance(absorption: LinearRgb, distance: f32) -> LinearRgb {
    if absorption.is_black() || distance == f32::INFINITY {
        return LinearRgb::WHITE;
    }
    LinearRgb((-absorption.0 * distance).map(f32::exp))
}

/// A ray of unit direction without end.
#[inline]
pub(crate) fn open_ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray::new(origin, direction)
}
