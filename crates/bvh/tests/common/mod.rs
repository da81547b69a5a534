//! Meshes, rays and comparisons shared by the tests.
#![allow(dead_code, reason = "each test binary uses a part")]

use glam::Vec3;
use kajo_bvh::{Backend, Blas, BuildOptions, Hit, Ray};

/// A small counter-based generator (SplitMix64): tests need repeatable numbers, not good ones.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// In [-1, 1)³.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    /// On the unit sphere.
    pub fn sphere(&mut self) -> Vec3 {
        let (z, phi) = (2.0 * self.unit() - 1.0, std::f32::consts::TAU * self.unit());
        let r = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(r * phi.cos(), r * phi.sin(), z)
    }
}

/// Those that this processor runs.
pub fn backends() -> impl Iterator<Item = Backend> {
    [Backend::Portable, Backend::Avx2, Backend::Avx512].into_iter().filter(|b| b.is_supported())
}

/// Vertices and triangles.
#[derive(Clone, Default)]
pub struct TestMesh {
    pub positions: Vec<Vec3>,
    pub indices: Vec<[u32; 3]>,
}

impl TestMesh {
    pub fn blas(&self) -> Blas {
        Blas::build(&self.positions, &self.indices, &BuildOptions::default()).expect("a valid mesh")
    }

    pub fn triangle(&self, number: usize) -> [Vec3; 3] {
        self.indices[number].map(|v| self.positions[v as usize])
    }

    pub fn map(&self, f: impl Fn(Vec3) -> Vec3) -> Self {
        Self { positions: self.positions.iter().map(|&p| f(p)).collect(), indices: self.indices.clone() }
    }
}

/// Unconnected triangles in [-1, 1]³, of the given size.
pub fn soup(count: usize, size: f32, seed: u64) -> TestMesh {
    let mut random = Random::new(seed);
    let mut mesh = TestMesh::default();
    for i in 0..count as u32 {
        let center = random.cube();
        mesh.positions.extend((0..3).map(|_| center + random.cube() * size));
        mesh.indices.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
}

/// A closed sphere of `8 · 4^levels` triangles: an octahedron, subdivided. Vertices are shared.
pub fn sphere(levels: u32) -> TestMesh {
    let mut positions = vec![Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let mut indices: Vec<[u32; 3]> = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32, positions: &mut Vec<Vec3>| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        let mut finer = Vec::with_capacity(4 * indices.len());
        for [a, b, c] in indices {
            let (ab, bc, ca) = (middle(a, b, &mut positions), middle(b, c, &mut positions), middle(c, a, &mut positions));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        indices = finer;
    }
    TestMesh { positions, indices }
}

/// A closed torus of `2 · around · along` triangles, radii 1 and 0.4.
pub fn torus(around: u32, along: u32) -> TestMesh {
    let mut mesh = TestMesh::default();
    for i in 0..along {
        for j in 0..around {
            let (phi, theta) = (i as f32 / along as f32 * std::f32::consts::TAU, j as f32 / around as f32 * std::f32::consts::TAU);
            let r = 1.0 + 0.4 * theta.cos();
            mesh.positions.push(Vec3::new(r * phi.cos(), 0.4 * theta.sin(), r * phi.sin()));
            let at = |i: u32, j: u32| i % along * around + j % around;
            mesh.indices.extend([[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]);
        }
    }
    mesh
}

/// Rays from outside into the cube, some of them along axes.
pub fn rays(count: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|i| {
            let origin = random.cube() * if i % 2 == 0 { 3.0 } else { 1.0 };
            let mut direction = random.cube() - origin * random.unit();
            if i % 8 == 0 {
                direction[i / 8 % 3] = 0.0;
            }
            Ray::new(origin, direction)
        })
        .collect()
}

/// Whether two answers are the same, bit for bit; says how they differ.
pub fn same(expected: Option<Hit>, got: Option<Hit>) -> Result<(), String> {
    let bits = |h: &Hit| (h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.primitive, h.instance);
    if expected.as_ref().map(bits) == got.as_ref().map(bits) { Ok(()) } else { Err(format!("expected {expected:?}, got {got:?}")) }
}
