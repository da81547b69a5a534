//! The rays that leave what is seen, and what they cost.

use crate::LabError;
use cpu_time::ThreadTime;
use glam::Vec3;
use kajo_bvh::{Blas, BuildOptions, BvhInstance, Counters, Filter, Ray, Tlas};
use kajo_path_tracer::{Aov, Frame, Pixels};
use kajo_scene::{Mesh, Snapshot};
use std::f32::consts::TAU;
use std::sync::Arc;

/// Rays about the normal of each pixel's surface.
const SPREAD: u8 = 3;
/// From the rays of each pixel to those of the next, rad.
const GOLDEN_ANGLE: f32 = 2.399_963;
/// Rounds of the timed rays.
const ROUNDS: usize = 5;

/// Rays of one kind.
pub struct Kind {
    pub name: &'static str,
    pub rays: Vec<Ray>,
}

/// What a ray does on average.
#[derive(Clone, Copy)]
pub struct Work {
    /// Nodes visited, of the upper structure and of the meshes.
    pub nodes: f64,
    /// Instances entered.
    pub instances: f64,
    /// Triangles tested.
    pub triangles: f64,
    /// Rays per second, millions.
    pub speed: f64,
}

impl Work {
    /// Tests: a node is one of eight boxes at once; instances and triangles are one each.
    pub fn total(self) -> f64 {
        self.nodes + self.instances + self.triangles
    }

    /// Of `rays` through the structure of the instances that are `kept`.
    ///
    /// # Errors
    /// Meshes that have no structure.
    pub fn of(rays: &[Ray], snapshot: &Snapshot, kept: &[bool]) -> Result<Self, LabError> {
        let failed = |e: kajo_bvh::BvhError| LabError::NotMeasured { reason: e.to_string() };
        let blas = |mesh: &Arc<Mesh>| Ok(Arc::new(Blas::build(&mesh.positions, &mesh.indices, &BuildOptions::default())?));
        let blases = snapshot.meshes.iter().map(blas).collect::<Result<Vec<_>, _>>().map_err(failed)?;
        let instances = snapshot.instances.iter().zip(kept).filter(|(_, kept)| **kept);
        let placed = instances.map(|(instance, _)| BvhInstance::new(instance.mesh, instance.world_from_object)).collect();
        let tlas = Tlas::build(blases, placed).map_err(failed)?;
        let mut counters = Counters::default();
        for ray in rays {
            tlas.closest_hit_counted(ray, Filter::ALL, |_| true, &mut counters);
        }
        let round = || {
            let begin = ThreadTime::now();
            let hits = rays.iter().filter(|ray| tlas.closest_hit_opaque(ray, Filter::ALL).is_some()).count();
            std::hint::black_box(hits);
            begin.elapsed().as_secs_f64()
        };
        let best = (0..ROUNDS).map(|_| round()).fold(f64::INFINITY, f64::min);
        let each = |count: u64| count as f64 / rays.len() as f64;
        Ok(Self {
            nodes: each(counters.nodes),
            instances: each(counters.instances),
            triangles: each(counters.triangles),
            speed: rays.len() as f64 / best / 1e6,
        })
    }
}

/// Rays that leave what is seen: one in the mirror direction, and [`SPREAD`] about the normal by the cosine.
pub fn secondary_rays(frame: &Frame, eye: Vec3) -> [Kind; 2] {
    let image = |aov: Aov| &frame.image(&aov.to_string()).expect("an image that was asked for").pixels;
    let (position, normal, coverage) = (image(Aov::Position), image(Aov::ShadingNormal), image(Aov::Coverage));
    let seen = |&(x, y): &(u32, u32)| match coverage {
        Pixels::Scalar(image) => *image.get(x, y) > 0.5,
        Pixels::Color(_) | Pixels::Vector(_) => false,
    };
    let (mut mirrored, mut spread) = (Vec::new(), Vec::new());
    for (x, y) in (0..frame.size.y).flat_map(|y| (0..frame.size.x).map(move |x| (x, y))).filter(seen) {
        let (p, n) = (position.get(x, y), normal.get(x, y).normalize_or_zero());
        let origin = p + n * 1e-3 * p.distance(eye).max(1.0);
        let (tangent, bitangent) = n.any_orthonormal_pair();
        let turn = (x + frame.size.x * y) as f32 * GOLDEN_ANGLE;
        mirrored.push(Ray::new(origin, (p - eye).normalize_or_zero().reflect(n)));
        spread.extend((0..SPREAD).map(|k| {
            let (share, angle) = ((f32::from(k) + 0.5) / f32::from(SPREAD), turn + f32::from(k) * TAU / f32::from(SPREAD));
            let direction = (tangent * angle.cos() + bitangent * angle.sin()) * share.sqrt() + n * (1.0 - share).sqrt();
            Ray::new(origin, direction)
        }));
    }
    [Kind { name: "mirror", rays: mirrored }, Kind { name: "about the normal", rays: spread }]
}
