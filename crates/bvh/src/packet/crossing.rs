//! One triangle against all rays of a packet: the numbers of [`ShearedRay::cross`], bit for bit.

use super::{Packet, SIZE, fold};
use crate::triangle::ShearedRay;

/// Where the rays cross a triangle.
pub(super) struct Crossings {
    /// All ones for a ray that crosses.
    pub crossed: [u32; SIZE],
    pub t: [f32; SIZE],
    /// Edge functions of vertices 1 and 2 and the sum of all three: the weights before they are divided.
    pub v: [f64; SIZE],
    pub w: [f64; SIZE],
    pub sum: [f64; SIZE],
}

/// A triangle's vertices with their axes in the order of the sheared space.
type Triangle = [[f32; 3]; 3];

impl Packet {
    /// Crossings of rays at `t_min < t ≤ t_max`; `None` if there are none.
    #[inline(always)]
    pub(super) fn cross(&self, triangle: &Triangle, t_max: &[f32; SIZE]) -> Option<Crossings> {
        let candidates = self.candidates(triangle);
        if fold(&candidates, |a, b| a | b) == 0 {
            return None;
        }
        self.measure(triangle, &candidates, t_max)
    }

    /// A vertex as ray `i` sees it, [`ShearedRay::shear`].
    #[inline(always)]
    fn shear(&self, [x, y, z]: [f32; 3], i: usize) -> [f32; 3] {
        let rays = &self.sheared;
        let dz = z - rays.origin[2][i];
        [(x - rays.origin[0][i]) - rays.shear[0][i] * dz, (y - rays.origin[1][i]) - rays.shear[1][i] * dz, dz]
    }

    /// Rays whose edge functions in single precision do not have two signs. Rounding is monotone, so none that crosses is missing.
    #[inline(always)]
    fn candidates(&self, &[a, b, c]: &Triangle) -> [u32; SIZE] {
        let mut candidates = [0; SIZE];
        for (i, candidate) in candidates.iter_mut().enumerate() {
            let (a, b, c) = (self.shear(a, i), self.shear(b, i), self.shear(c, i));
            let edge = |p: [f32; 3], q: [f32; 3]| p[0] * q[1] - p[1] * q[0];
            let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
            let least = if u < v { u } else { v };
            let least = if w < least { w } else { least };
            let greatest = if u > v { u } else { v };
            let greatest = if w > greatest { w } else { greatest };
            *candidate = if (least >= 0.0) | (greatest <= 0.0) { u32::MAX } else { 0 };
        }
        candidates
    }

    /// Decides and measures in double precision.
    #[inline(always)]
    fn measure(&self, &[a, b, c]: &Triangle, candidates: &[u32; SIZE], t_max: &[f32; SIZE]) -> Option<Crossings> {
        let mut found = Crossings { crossed: [0; SIZE], t: [0.0; SIZE], v: [0.0; SIZE], w: [0.0; SIZE], sum: [0.0; SIZE] };
        let mut on_edge = [0; SIZE];
        for i in 0..SIZE {
            let (a, b, c) = (self.shear(a, i), self.shear(b, i), self.shear(c, i));
            let edge = |p: [f32; 3], q: [f32; 3]| f64::from(p[0]) * f64::from(q[1]) - f64::from(p[1]) * f64::from(q[0]);
            let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
            let inside = ((u >= 0.0) & (v >= 0.0) & (w >= 0.0)) | ((u <= 0.0) & (v <= 0.0) & (w <= 0.0));
            let sum = u + v + w;
            let distance = u * f64::from(a[2]) + v * f64::from(b[2]) + w * f64::from(c[2]);
            // 0/0 without area: NaN, which is in no interval.
            let t = (distance / (sum * f64::from(self.sheared.dz[i]))) as f32;
            let crossed = inside & (t > self.t_min[i]) & (t <= t_max[i]);
            found.crossed[i] = if crossed { candidates[i] } else { 0 };
            on_edge[i] = if (u == 0.0) | (v == 0.0) | (w == 0.0) { found.crossed[i] } else { 0 };
            (found.t[i], found.v[i], found.w[i], found.sum[i]) = (t, v, w, sum);
        }
        if fold(&on_edge, |a, b| a | b) != 0 {
            self.decide_edges([a, b, c], &on_edge, &mut found.crossed);
        }
        (fold(&found.crossed, |a, b| a | b) != 0).then_some(found)
    }

    /// Takes away crossings on an edge or a vertex that belongs to a neighbour.
    #[cold]
    fn decide_edges(&self, triangle: Triangle, on_edge: &[u32; SIZE], crossed: &mut [u32; SIZE]) {
        for i in (0..SIZE).filter(|&i| on_edge[i] != 0) {
            let rays = &self.sheared;
            // The triangle's axes are in order already.
            let ray = ShearedRay {
                axes: [0, 1, 2],
                origin: rays.origin.map(|axis| axis[i]),
                shear: rays.shear.map(|axis| axis[i]),
                dz: rays.dz[i],
            };
            if ray.cross(triangle).is_none() {
                crossed[i] = 0;
            }
        }
    }
}
