//! Row M-06: light sampling, BSDF sampling and their balance-heuristic combination on a plane below spherical lights.

use crate::{Bsdf, MaterialParams};
use glam::Vec3;
use kajo_sampling::statistics::Moments;
use kajo_sampling::{Rng, balance_heuristic, warp::LightSphere};
use kajo_units::{LinearRgb, PerceptualRoughness};

/// Reflected radiance of a metal plane under a spherical light of radiance 1, one sample a strategy.
struct Case {
    bsdf: Bsdf,
    wo: Vec3,
    light: LightSphere,
}

impl Case {
    fn new(roughness: f32, radius: f32) -> Self {
        let params = MaterialParams { metallic: 1.0, roughness: PerceptualRoughness(roughness), ..MaterialParams::default() };
        let wo = Vec3::new(0.8, 0.0, 0.6);
        // In the mirror direction, 2 m away.
        Self { bsdf: Bsdf::new(&params), wo, light: LightSphere::new(Vec3::ZERO, Vec3::new(-1.6, 0.0, 1.2), radius) }
    }

    fn f(&self, wi: Vec3) -> f64 {
        if self.light.pdf(wi) > 0.0 { f64::from(self.bsdf.f_cos(self.wo, wi).total().0.x) } else { 0.0 }
    }

    /// Weighted contributions of one light sample and one BSDF sample; the weight is called with (own pdf, other pdf).
    fn samples(&self, rng: &mut Rng, weight: impl Fn(f32, f32) -> f32) -> [f64; 2] {
        let wi = self.light.sample(rng.next_2d());
        let (own, other) = (self.light.pdf(wi), self.bsdf.pdf(self.wo, wi));
        let by_light = if own > 0.0 { f64::from(weight(own, other)) * self.f(wi) / f64::from(own) } else { 0.0 };
        let by_bsdf = self
            .bsdf
            .sample(self.wo, rng.next_1d(), rng.next_2d())
            .map_or(0.0, |s| f64::from(weight(s.pdf, self.light.pdf(s.wi))) * self.f(s.wi) / f64::from(s.pdf));
        [by_light, by_bsdf]
    }

    /// Moments of light sampling, BSDF sampling and the balanced sum.
    fn moments(&self, seed: u64) -> [Moments; 3] {
        let mut rng = Rng::new(seed);
        let mut m = [Moments::default(); 3];
        for _ in 0..100_000 {
            let [by_light, by_bsdf] = self.samples(&mut rng, |_, _| 1.0);
            m[0].add(by_light);
            m[1].add(by_bsdf);
            let balanced = self.samples(&mut rng, balance_heuristic);
            m[2].add(balanced[0] + balanced[1]);
        }
        m
    }
}

/// Var(balance) ≤ Var(strategy s with its own n_s samples) + (1/min n − 1/Σn) μ².    \[Veach98] theorem 9.2
#[test]
fn balance_heuristic_stays_within_veachs_bound_and_beats_each_strategy_somewhere() {
    let mut beaten = [false; 2];
    for (i, (roughness, radius)) in [(0.12, 0.05), (0.12, 1.0), (0.7, 0.05), (0.7, 1.0)].into_iter().enumerate() {
        let [light, bsdf, balance] = Case::new(roughness, radius).moments(i as u64);
        for (s, strategy) in [light, bsdf].into_iter().enumerate() {
            let difference = (strategy.mean() - balance.mean()).abs();
            let error = strategy.standard_error().hypot(balance.standard_error());
            assert!(difference < 4.0 * error, "case {i}: same mean, {strategy:?} {balance:?}");
            let bound = strategy.variance() + 0.5 * balance.mean().powi(2);
            assert!(balance.variance() <= bound, "case {i}, strategy {s}: {} > {bound}", balance.variance());
            beaten[s] |= balance.variance() < 0.5 * strategy.variance();
        }
    }
    assert_eq!(beaten, [true; 2], "light sampling fails on narrow lobes, BSDF sampling on small lights");
}

#[test]
fn planted_fault_weights_that_do_not_sum_to_one_change_the_mean() {
    let case = Case::new(0.7, 1.0);
    let mut rng = Rng::new(9);
    let wrong: Moments = (0..100_000).map(|_| case.samples(&mut rng, |own, other| own / (own + 2.0 * other)).iter().sum()).collect();
    let right = case.moments(3)[2];
    assert!((wrong.mean() - right.mean()).abs() > 10.0 * right.standard_error());
    assert_eq!(case.bsdf.albedo(case.wo).diffuse, LinearRgb::BLACK);
}
