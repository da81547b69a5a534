//! Binned surface area heuristic, \[Wald07].

use super::tree::{Bounds, Cost, Item, Split, half_area};
use glam::Vec4;

/// Greatest number of bins an axis.
const MAX_BINS: usize = 32;

/// Box around what falls into a bin.
#[derive(Clone, Copy)]
struct Bin {
    min: Vec4,
    max: Vec4,
}

impl Bin {
    const EMPTY: Self = Self { min: Vec4::INFINITY, max: Vec4::NEG_INFINITY };

    #[inline(always)]
    fn add(&mut self, min: Vec4, max: Vec4) {
        self.min = self.min.min(min);
        self.max = self.max.max(max);
    }

    /// Area times tests; 0 without items.
    #[inline(always)]
    fn weighted(&self, count: u32, cost: &Cost) -> f32 {
        if count == 0 { 0.0 } else { half_area(self.min, self.max) * cost.blocks(count as usize) }
    }
}

/// A way to divide the items: bins below `bin` on `axis` go left.
pub struct Plane {
    axis: usize,
    bin: usize,
    /// Σ area · tests of both sides.
    pub cost: f32,
}

/// 1.5 · 2²³: added to a number below 2²², it rounds that to a whole one and leaves it in the low bits.
const ROUNDING: f32 = 12582912.0;

/// Up to this many items are divided by way of a second list, without branches that cannot be predicted.
const MOST_COPIED: usize = 1 << 16;

/// Items counted by the bin of their centre, on each axis. Kept and filled again for every node.
pub struct Bins {
    count: usize,
    origin: Vec4,
    scale: Vec4,
    boxes: [[Bin; 3]; MAX_BINS],
    counts: [[u32; 3]; MAX_BINS],
    /// Items that go right.
    right: Vec<Item>,
}

impl Bins {
    pub fn new() -> Self {
        Self {
            count: 0,
            origin: Vec4::ZERO,
            scale: Vec4::ZERO,
            boxes: [[Bin::EMPTY; 3]; MAX_BINS],
            counts: [[0; 3]; MAX_BINS],
            right: Vec::new(),
        }
    }

    /// Counts items. Few items get few bins, at most `limit`.
    pub fn fill(&mut self, items: &[Item], bounds: &Bounds, limit: usize) {
        self.count = (4 + items.len() / 16).min(limit.clamp(2, MAX_BINS));
        let extent = bounds.center_max - bounds.center_min;
        // An axis without extent gets scale 0: everything falls into bin 0 and no plane divides it.
        let scale = Vec4::select(extent.cmpgt(Vec4::ZERO), Vec4::splat(self.count as f32 * 0.999) / extent, Vec4::ZERO);
        self.scale = Vec4::select(scale.cmplt(Vec4::INFINITY), scale, Vec4::ZERO);
        self.origin = bounds.center_min;
        self.boxes[..self.count].fill([Bin::EMPTY; 3]);
        self.counts[..self.count].fill([0; 3]);
        for item in items {
            let index = self.index(item);
            let (min, max) = (item.min(), item.max());
            for (axis, &bin) in index.iter().enumerate() {
                self.boxes[bin][axis].add(min, max);
                self.counts[bin][axis] += 1;
            }
        }
    }

    /// Bin of an item on each axis, and [`ROUNDING`].
    #[inline(always)]
    fn place(&self, item: &Item) -> Vec4 {
        // At most 0.999 · count and its rounding, less a half: the nearest whole number is below count.
        ((item.center2() - self.origin) * self.scale - 0.5) + ROUNDING
    }

    /// Bin of an item on each axis.
    #[inline(always)]
    fn index(&self, item: &Item) -> [usize; 3] {
        self.place(item).to_array().first_chunk::<3>().expect("four lanes").map(|x| x.to_bits() as usize & (MAX_BINS - 1))
    }

    /// The cheapest plane with items on both sides; the first of equals.
    #[allow(clippy::needless_range_loop, reason = "several lists run in step")]
    pub fn best_plane(&self, cost: &Cost) -> Option<Plane> {
        let mut right_cost = [[f32::INFINITY; 3]; MAX_BINS];
        let (mut boxes, mut counts) = ([Bin::EMPTY; 3], [0; 3]);
        for bin in (1..self.count).rev() {
            for axis in 0..3 {
                let here = &self.boxes[bin][axis];
                boxes[axis].add(here.min, here.max);
                counts[axis] += self.counts[bin][axis];
                if counts[axis] > 0 {
                    right_cost[bin][axis] = boxes[axis].weighted(counts[axis], cost);
                }
            }
        }
        let mut best = Plane { axis: 0, bin: 0, cost: f32::INFINITY };
        (boxes, counts) = ([Bin::EMPTY; 3], [0; 3]);
        for bin in 1..self.count {
            for axis in 0..3 {
                let here = &self.boxes[bin - 1][axis];
                boxes[axis].add(here.min, here.max);
                counts[axis] += self.counts[bin - 1][axis];
                let total = boxes[axis].weighted(counts[axis], cost) + right_cost[bin][axis];
                if counts[axis] > 0 && total < best.cost {
                    best = Plane { axis, bin, cost: total };
                }
            }
        }
        (best.bin > 0).then_some(best)
    }

    /// Boxes around what lies on both sides of a plane.
    fn sides(&self, plane: &Plane) -> [Bin; 2] {
        [0..plane.bin, plane.bin..self.count].map(|bins| {
            self.boxes[bins].iter().fold(Bin::EMPTY, |mut all, bin| {
                all.add(bin[plane.axis].min, bin[plane.axis].max);
                all
            })
        })
    }

    /// Half the surface of what the boxes of both sides of a plane have in common.
    pub fn overlap(&self, plane: &Plane) -> f32 {
        let [left, right] = self.sides(plane);
        let extent = (left.max.min(right.max) - left.min.max(right.min)).max(Vec4::ZERO);
        half_area(Vec4::ZERO, extent)
    }

    /// Moves the items left of the plane to the front. The order depends on the items alone.
    pub fn partition(&mut self, items: &mut [Item], plane: &Plane) -> Split {
        let limit = Vec4::splat(ROUNDING + plane.bin as f32);
        let goes_left = |bins: &Self, item: &Item| bins.place(item).cmplt(limit).bitmask() >> plane.axis & 1 == 1;
        let mut centers = [Bin::EMPTY; 2];
        let mut middle = 0;
        if items.len() <= MOST_COPIED {
            let mut list = std::mem::take(&mut self.right);
            list.resize(list.len().max(items.len()), items[0]);
            let right = &mut list[..items.len()];
            for index in 0..items.len() {
                let item = items[index];
                let left = goes_left(self, &item);
                items[middle] = item;
                right[index - middle] = item;
                middle += usize::from(left);
                let center = item.center2();
                let only = |side: bool, none: Vec4| if side { center } else { none };
                centers[0].add(only(left, Vec4::INFINITY), only(left, Vec4::NEG_INFINITY));
                centers[1].add(only(!left, Vec4::INFINITY), only(!left, Vec4::NEG_INFINITY));
            }
            let count = items.len() - middle;
            items[middle..].copy_from_slice(&right[..count]);
            self.right = list;
        } else {
            let mut end = items.len();
            while middle < end {
                let item = items[middle];
                let (left, center) = (goes_left(self, &item), item.center2());
                centers[usize::from(!left)].add(center, center);
                if left {
                    middle += 1;
                } else {
                    end -= 1;
                    items.swap(middle, end);
                }
            }
        }
        let [left, right] = self.sides(plane);
        let bounds = |all: Bin, centers: Bin| Bounds { min: all.min, max: all.max, center_min: centers.min, center_max: centers.max };
        Split { middle, left: bounds(left, centers[0]), right: bounds(right, centers[1]) }
    }
}
