//! Binned surface area heuristic, [Wald07].

use super::tree::{Bounds, Cost, Item, half_area};
use glam::{UVec4, Vec4};

/// Greatest number of bins an axis.
const MAX_BINS: usize = 32;

/// What falls into a bin.
#[derive(Clone, Copy)]
struct Bin {
    min: Vec4,
    max: Vec4,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { min: Vec4::INFINITY, max: Vec4::NEG_INFINITY, count: 0 };

    #[inline(always)]
    fn add(&mut self, item: &Item) {
        self.min = self.min.min(item.min());
        self.max = self.max.max(item.max());
        self.count += 1;
    }

    fn merge(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
        self.count += other.count;
    }

    fn weighted(&self, cost: &Cost) -> f32 {
        if self.count == 0 { 0.0 } else { half_area(self.min, self.max) * cost.blocks(self.count as usize) }
    }
}

/// A way to divide the items: bins below `bin` on `axis` go left.
pub struct Plane {
    axis: usize,
    bin: u32,
    /// Σ area · tests of both sides.
    pub cost: f32,
}

/// Items counted by the bin of their centre, on each axis.
pub struct Bins {
    count: usize,
    origin: Vec4,
    scale: Vec4,
    bins: [[Bin; MAX_BINS]; 3],
}

impl Bins {
    pub fn of(items: &[Item], bounds: &Bounds, bins: usize) -> Self {
        let count = bins.clamp(2, MAX_BINS);
        let extent = bounds.center_max - bounds.center_min;
        // An axis without extent gets scale 0: everything falls into bin 0 and no plane divides it.
        let scale = Vec4::select(extent.cmpgt(Vec4::ZERO), Vec4::splat(count as f32 * 0.999) / extent, Vec4::ZERO);
        let scale = Vec4::select(scale.cmplt(Vec4::INFINITY), scale, Vec4::ZERO);
        let mut out = Self { count, origin: bounds.center_min, scale, bins: [[Bin::EMPTY; MAX_BINS]; 3] };
        for item in items {
            let index = out.index(item);
            for axis in 0..3 {
                out.bins[axis][index[axis] as usize].add(item);
            }
        }
        out
    }

    /// Bin of an item on each axis.
    #[inline(always)]
    fn index(&self, item: &Item) -> UVec4 {
        ((item.center2() - self.origin) * self.scale).as_uvec4().min(UVec4::splat(self.count as u32 - 1))
    }

    /// The cheapest plane with items on both sides; the first of equals.
    pub fn best_plane(&self, cost: &Cost) -> Option<Plane> {
        let mut best: Option<Plane> = None;
        for (axis, bins) in self.bins.iter().enumerate() {
            let mut right_cost = [0.0; MAX_BINS];
            let mut right = Bin::EMPTY;
            for i in (1..self.count).rev() {
                right.merge(&bins[i]);
                right_cost[i] = if right.count == 0 { f32::INFINITY } else { right.weighted(cost) };
            }
            let mut left = Bin::EMPTY;
            for i in 1..self.count {
                left.merge(&bins[i - 1]);
                if left.count == 0 {
                    continue;
                }
                let total = left.weighted(cost) + right_cost[i];
                if total.is_finite() && best.as_ref().is_none_or(|b| total < b.cost) {
                    best = Some(Plane { axis, bin: i as u32, cost: total });
                }
            }
        }
        best
    }

    /// Moves the items left of the plane to the front and returns their number. The order depends on the items alone.
    pub fn partition(&self, items: &mut [Item], plane: &Plane) -> usize {
        let mut left = 0;
        let mut right = items.len();
        while left < right {
            if self.index(&items[left])[plane.axis] < plane.bin {
                left += 1;
            } else {
                right -= 1;
                items.swap(left, right);
            }
        }
        left
    }
}
