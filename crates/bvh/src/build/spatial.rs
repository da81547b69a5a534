//! The build for fast rays: planes may also cut triangles in two, \[Stich09].
//!
//! A cut triangle is kept once on each side, with the box of the part that lies there, so long thin triangles no longer make boxes that overlap. The parts of a
//! triangle cover it exactly: corners of a part are rounded outwards. References that cuts add take room that is set aside in the list of items,
//! and is shared out to the two sides of each split in proportion to their items; so subtrees can be built side by side, and the result
//! does not depend on the number of threads.

use super::{
    bins::Bins,
    tree::{BALANCE_DEPTH, BinaryNode, BinaryTree, Bounds, Cost, Item, PARALLEL_ITEMS, Split, half_area, halve},
};
use crate::aabb::Aabb;
use glam::{DVec3, Vec3, Vec4, Vec4Swizzles};

/// Room for added references, in parts of the items.
const ROOM: f32 = 0.5;

/// A cut is tried where the sides of the best plane that cuts nothing overlap in more than this part of the surface of everything, \[Stich09] section 4.5.
const LEAST_OVERLAP: f32 = 1e-5;

/// Bins an axis for cuts.
const BINS: usize = 16;

/// Corners of an item that may be cut.
trait Triangle: Fn(u32) -> Option<[Vec3; 3]> + Sync {}
impl<T: Fn(u32) -> Option<[Vec3; 3]> + Sync> Triangle for T {}

/// Builds over items; `order` of the result has gaps that no leaf refers to.
pub fn build(mut items: Vec<Item>, cost: &Cost, triangle: &(impl Fn(u32) -> Option<[Vec3; 3]> + Sync)) -> BinaryTree {
    if items.is_empty() {
        return BinaryTree { nodes: Vec::new(), order: Vec::new() };
    }
    let count = items.len();
    items.resize(count + (count as f32 * ROOM) as usize, items[0]);
    let mut nodes = vec![BinaryNode::UNUSED; 2 * items.len() - 1];
    let bounds = Bounds::of(&items[..count]);
    let builder = Builder { cost, triangle, whole: bounds.half_area() };
    builder.build(
        Task { items: &mut items, count, nodes: &mut nodes, first_item: 0, first_node: 0, depth: 0 },
        bounds,
        &mut Scratch::new(),
    );
    BinaryTree { nodes, order: items.iter().map(Item::number).collect() }
}

/// A subtree to build: `count` items and room behind them.
struct Task<'a> {
    items: &'a mut [Item],
    count: usize,
    nodes: &'a mut [BinaryNode],
    first_item: usize,
    first_node: usize,
    depth: usize,
}

/// Lists that are kept from node to node.
struct Scratch {
    bins: Bins,
    right: Vec<Item>,
}

impl Scratch {
    fn new() -> Self {
        Self { bins: Bins::new(), right: Vec::new() }
    }
}

struct Builder<'a, T> {
    cost: &'a Cost,
    triangle: &'a T,
    /// Half the surface of everything.
    whole: f32,
}

/// What the items of a node are divided into: the first `left` of them, and `right` that stand in a list of their own or behind.
struct Divided {
    left: (usize, Bounds),
    right: (usize, Bounds),
    /// Whether the right items are in the scratch list.
    apart: bool,
}

impl<T: Triangle> Builder<'_, T> {
    fn build(&self, task: Task, bounds: Bounds, scratch: &mut Scratch) {
        let Task { items, count, nodes, first_item, first_node, depth } = task;
        let room = items.len() - count;
        let (node, nodes) = nodes.split_first_mut().expect("a place for every node");
        let Some(divided) = self.divide(items, count, &bounds, depth, scratch) else {
            *node = BinaryNode::of_leaf(&bounds, first_item, count);
            return;
        };
        let Divided { left: (left_count, left_bounds), right: (right_count, right_bounds), apart } = divided;
        let spare = room + count - left_count - right_count;
        let left_size = left_count + spare * left_count / (left_count + right_count);
        match apart {
            true => items[left_size..left_size + right_count].copy_from_slice(&scratch.right),
            false => items.copy_within(left_count..left_count + right_count, left_size),
        }
        let (left_first, right_first) = (first_node + 1, first_node + 2 * left_size);
        *node = BinaryNode::of_children(&bounds, left_first, right_first);
        let (left, right) = items.split_at_mut(left_size);
        let (left_nodes, right_nodes) = nodes.split_at_mut(2 * left_size - 1);
        let left = Task { items: left, count: left_count, nodes: left_nodes, first_item, first_node: left_first, depth: depth + 1 };
        let first_item = first_item + left_size;
        let right = Task { items: right, count: right_count, nodes: right_nodes, first_item, first_node: right_first, depth: depth + 1 };
        if count >= PARALLEL_ITEMS {
            rayon::join(|| self.build(left, left_bounds, scratch), || self.build(right, right_bounds, &mut Scratch::new()));
        } else {
            self.build(left, left_bounds, scratch);
            self.build(right, right_bounds, scratch);
        }
    }

    /// Divides the items as is cheapest; `None` makes a leaf.
    fn divide(&self, items: &mut [Item], count: usize, bounds: &Bounds, depth: usize, scratch: &mut Scratch) -> Option<Divided> {
        let apart = |Split { middle, left, right }: Split| Divided { left: (middle, left), right: (count - middle, right), apart: false };
        if count == 1 {
            return None;
        }
        let must_split = count > self.cost.sah.max_leaf_size;
        if depth >= BALANCE_DEPTH {
            return must_split.then(|| apart(halve(&mut items[..count], bounds)));
        }
        let area = bounds.half_area();
        let leaf_cost = match must_split {
            true => f32::INFINITY,
            false => area * (self.cost.blocks(count) - self.cost.sah.node_cost),
        };
        scratch.bins.fill(&items[..count], bounds, self.cost.sah.bins);
        let plane = scratch.bins.best_plane(self.cost);
        let object_cost = plane.as_ref().map_or(f32::INFINITY, |plane| plane.cost);
        let overlap = plane.as_ref().map_or(f32::INFINITY, |plane| scratch.bins.overlap(plane));
        if items.len() > count && overlap > LEAST_OVERLAP * self.whole {
            let cut = CutBins::fill(&items[..count], bounds, self.triangle).best(self.cost);
            if let Some(cut) = cut.filter(|cut| cut.cost < object_cost && cut.cost < leaf_cost)
                && let Some(divided) = self.cut(items, count, cut, &mut scratch.right)
            {
                return Some(divided);
            }
        }
        match plane {
            Some(plane) if plane.cost < leaf_cost => Some(apart(scratch.bins.partition(&mut items[..count], &plane))),
            _ => must_split.then(|| apart(halve(&mut items[..count], bounds))),
        }
    }

    /// Divides at a cut. The left items are moved to the front, the right ones to `right`. `None` if one side would be empty; the items then still cover
    /// what they did.
    fn cut(&self, items: &mut [Item], count: usize, cut: Cut, right: &mut Vec<Item>) -> Option<Divided> {
        right.clear();
        let mut room = items.len() - count;
        let mut sides = cut.sides;
        let (mut left_bounds, mut right_bounds) = (Bounds::EMPTY, Bounds::EMPTY);
        let mut end = 0;
        for index in 0..count {
            let item = items[index];
            let (to_left, to_right) = if item.max()[cut.axis] <= cut.position {
                (Some(item), None)
            } else if item.min()[cut.axis] >= cut.position {
                (None, Some(item))
            } else {
                self.place(&item, &cut, &mut sides, &mut room)
            };
            if let Some(item) = to_left {
                left_bounds.add(&item);
                items[end] = item;
                end += 1;
            }
            if let Some(item) = to_right {
                right_bounds.add(&item);
                right.push(item);
            }
        }
        (end > 0 && !right.is_empty()).then_some(Divided { left: (end, left_bounds), right: (right.len(), right_bounds), apart: true })
    }

    /// What of an item that reaches over the cut goes to each side: its parts, or the whole to one side where that is cheaper, \[Stich09] section 4.4,
    /// or where there is no room for both.
    fn place(&self, item: &Item, cut: &Cut, sides: &mut [CutSide; 2], room: &mut usize) -> (Option<Item>, Option<Item>) {
        let triangle = (self.triangle)(item.number());
        let parts = triangle.map(|triangle| parts(item, triangle, cut.axis, cut.position));
        // The box may reach over the cut where the triangle does not.
        if let Some((Some(part), None) | (None, Some(part))) = parts {
            let side = usize::from(matches!(parts, Some((None, _))));
            sides[1 - side].count = sides[1 - side].count.saturating_sub(1);
            return if side == 0 { (Some(part), None) } else { (None, Some(part)) };
        }
        let [left, right] = *sides;
        let whole = [left.with(item), right.with(item)];
        let without = |side: CutSide| CutSide { count: side.count.saturating_sub(1), ..side };
        let only_left = whole[0].cost(self.cost) + without(right).cost(self.cost);
        let only_right = without(left).cost(self.cost) + whole[1].cost(self.cost);
        let both = left.cost(self.cost) + right.cost(self.cost);
        match parts {
            Some(parts) if *room > 0 && both <= only_left.min(only_right) => {
                *room -= 1;
                parts
            }
            _ if only_left <= only_right => {
                *sides = [whole[0], without(right)];
                (Some(*item), None)
            }
            _ => {
                *sides = [without(left), whole[1]];
                (None, Some(*item))
            }
        }
    }
}

/// The parts of an item below and above a plane, as far as its box contains them; exact, but for rounding outwards. `None` for no part.
fn parts(item: &Item, corners: [Vec3; 3], axis: usize, position: f32) -> (Option<Item>, Option<Item>) {
    let mut sides = [Aabb::EMPTY; 2];
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if a[axis] <= position {
            sides[0] = sides[0].union(Aabb { min: a, max: a });
        }
        if a[axis] >= position {
            sides[1] = sides[1].union(Aabb { min: a, max: a });
        }
        if (a[axis] < position && b[axis] > position) || (a[axis] > position && b[axis] < position) {
            let (from, to) = (a.as_dvec3(), b.as_dvec3());
            let crossing = from.lerp(to, (f64::from(position) - from[axis]) / (to[axis] - from[axis]));
            let crossing = around(crossing);
            sides = sides.map(|side| side.union(crossing));
        }
    }
    sides[0].max[axis] = sides[0].max[axis].min(position);
    sides[1].min[axis] = sides[1].min[axis].max(position);
    let [left, right] = sides.map(|side| {
        let part = Aabb { min: side.min.max(item.min().xyz()), max: side.max.min(item.max().xyz()) };
        (!part.is_empty()).then(|| Item::new(&part, item.number()))
    });
    (left, right)
}

/// A box of single-precision numbers around a point that was computed in double precision.
fn around(point: DVec3) -> Aabb {
    let near = point.as_vec3();
    Aabb { min: near.map(f32::next_down), max: near.map(f32::next_up) }
}

/// One side of a cut.
#[derive(Clone, Copy)]
struct CutSide {
    min: Vec4,
    max: Vec4,
    count: usize,
}

impl CutSide {
    const EMPTY: Self = Self { min: Vec4::INFINITY, max: Vec4::NEG_INFINITY, count: 0 };

    fn with(self, item: &Item) -> Self {
        Self { min: self.min.min(item.min()), max: self.max.max(item.max()), ..self }
    }

    fn union(self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max), count: self.count + other.count }
    }

    /// Area times tests; 0 without items.
    fn cost(&self, cost: &Cost) -> f32 {
        if self.count == 0 { 0.0 } else { half_area(self.min, self.max) * cost.blocks(self.count) }
    }
}

/// A plane that cuts what reaches over it.
struct Cut {
    axis: usize,
    position: f32,
    /// What lies below and above, all that reaches over being cut.
    sides: [CutSide; 2],
    /// Σ area · tests of both sides.
    cost: f32,
}

/// Parts of items by the slab they lie in; `count` tells how many start there, `ends` how many end.
struct CutBins {
    bins: [[CutSide; BINS]; 3],
    ends: [[usize; BINS]; 3],
    origin: Vec3,
    width: Vec3,
}

impl CutBins {
    fn fill<T: Triangle>(items: &[Item], bounds: &Bounds, triangle: &T) -> Self {
        let (origin, extent) = (bounds.min.xyz(), (bounds.max - bounds.min).xyz());
        let mut bins = Self { bins: [[CutSide::EMPTY; BINS]; 3], ends: [[0; BINS]; 3], origin, width: extent / BINS as f32 };
        for item in items {
            for axis in 0..3 {
                // Without extent there is nothing to cut.
                if bins.width[axis] > f32::MIN_POSITIVE {
                    bins.add(item, axis, triangle);
                }
            }
        }
        bins
    }

    /// Adds the parts of an item to the bins of an axis; in single precision, since this only estimates costs.
    fn add<T: Triangle>(&mut self, item: &Item, axis: usize, triangle: &T) {
        let (first, last) = (self.bin(axis, item.min()[axis]), self.bin(axis, item.max()[axis]));
        self.bins[axis][first].count += 1;
        self.ends[axis][last] += 1;
        let Some(corners) = (if first < last { triangle(item.number()) } else { None }) else {
            self.bins[axis][last] = self.bins[axis][last].with(item);
            return;
        };
        let corners = corners.map(|p| p.extend(0.0));
        let mut parts = [(Vec4::INFINITY, Vec4::NEG_INFINITY); BINS];
        let mut add = |bin: usize, point: Vec4| {
            let (min, max) = &mut parts[bin];
            (*min, *max) = (min.min(point), max.max(point));
        };
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            let [from, to] = [a, b].map(|p| self.bin(axis, p[axis]).clamp(first, last));
            add(from, a);
            let slope = (b - a) / (b[axis] - a[axis]);
            for bin in from.min(to)..from.max(to) {
                let crossing = a + slope * (self.plane(axis, bin + 1) - a[axis]);
                add(bin, crossing);
                add(bin + 1, crossing);
            }
        }
        for (bin, &(min, max)) in self.bins[axis].iter_mut().zip(&parts).take(last + 1).skip(first) {
            let (min, max) = (min.max(item.min()), max.min(item.max()));
            if min.xyz().cmple(max.xyz()).all() {
                (bin.min, bin.max) = (bin.min.min(min), bin.max.max(max));
            }
        }
    }

    fn bin(&self, axis: usize, place: f32) -> usize {
        (((place - self.origin[axis]) / self.width[axis]) as usize).min(BINS - 1)
    }

    /// Where a bin begins.
    fn plane(&self, axis: usize, bin: usize) -> f32 {
        self.origin[axis] + self.width[axis] * bin as f32
    }

    /// The cheapest cut with something on both sides; the first of equals.
    fn best(&self, cost: &Cost) -> Option<Cut> {
        let mut best: Option<Cut> = None;
        for axis in 0..3 {
            let mut right = [CutSide::EMPTY; BINS + 1];
            for bin in (1..BINS).rev() {
                right[bin] = right[bin + 1].union(&CutSide { count: self.ends[axis][bin], ..self.bins[axis][bin] });
            }
            let mut left = CutSide::EMPTY;
            for (bin, right) in right.iter().enumerate().take(BINS).skip(1) {
                left = left.union(&self.bins[axis][bin - 1]);
                let total = left.cost(cost) + right.cost(cost);
                if left.count > 0 && right.count > 0 && best.as_ref().is_none_or(|best| total < best.cost) {
                    best = Some(Cut { axis, position: self.plane(axis, bin), sides: [left, *right], cost: total });
                }
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::Sah;

    /// Thin triangles in all directions, the same every time.
    fn needles() -> Vec<[Vec3; 3]> {
        let mut state = 1u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u64 << 24) as f32
        };
        let mut point = |size: f32| Vec3::new(unit(), unit(), unit()) * size;
        (0..60)
            .map(|_| {
                let (a, b) = (point(1.0), point(1.0));
                [a, b, b + point(0.05)]
            })
            .collect()
    }

    fn items(triangles: &[[Vec3; 3]]) -> Vec<Item> {
        (0..).zip(triangles).map(|(number, &triangle)| Item::new(&Aabb::of_points(triangle), number)).collect()
    }

    /// Points of the edges of both parts, more exact than a box of single-precision numbers.
    #[test]
    fn boxes_of_parts_hold_every_point_of_them() {
        for triangle in needles() {
            let item = items(&[triangle])[0];
            for axis in 0..3 {
                let position = (item.min()[axis] + item.max()[axis]) * 0.5;
                let (Some(left), Some(right)) = parts(&item, triangle, axis, position) else {
                    panic!("{triangle:?} reaches over {position}")
                };
                let cut = f64::from(position);
                for (a, b) in (0..3).map(|i| (triangle[i].as_dvec3(), triangle[(i + 1) % 3].as_dvec3())) {
                    let crossing = (cut - a[axis]) / (b[axis] - a[axis]);
                    for t in [0.0, 0.3, crossing, 0.6, 1.0].into_iter().filter(|t| (0.0..=1.0).contains(t)) {
                        let point = a.lerp(b, t);
                        let holds = |part: &Item| {
                            let (min, max) = (part.min().xyz().as_dvec3() - 1e-12, part.max().xyz().as_dvec3() + 1e-12);
                            min.cmple(point).all() && point.cmple(max).all()
                        };
                        let (below, above) = (t == crossing || point[axis] < cut, t == crossing || point[axis] > cut);
                        assert!(
                            (!below || holds(&left)) && (!above || holds(&right)),
                            "{point} of {triangle:?} cut at {position} on {axis}"
                        );
                    }
                }
            }
        }
    }

    /// What bins estimate of both sides of a cut is what cutting there gives.
    #[test]
    fn estimates_of_both_sides_are_what_a_cut_leaves_there() {
        let triangles = needles();
        let (items, cost) = (items(&triangles), Cost { sah: Sah::default(), block: 4 });
        for count in [5, 20, 60] {
            let items = &items[..count];
            let cut = CutBins::fill(items, &Bounds::of(items), &|number| Some(triangles[number as usize])).best(&cost).expect("a cut");
            let mut sides = [CutSide::EMPTY; 2];
            for item in items {
                let (left, right) = parts(item, triangles[item.number() as usize], cut.axis, cut.position);
                for (side, part) in sides.iter_mut().zip([left, right]).filter_map(|(side, part)| part.map(|part| (side, part))) {
                    *side = CutSide { count: side.count + 1, ..side.with(&part) };
                }
            }
            for (estimate, side) in cut.sides.iter().zip(&sides) {
                let apart = (estimate.min - side.min).abs().max((estimate.max - side.max).abs()).xyz().max_element();
                assert!(apart < 1e-5 && estimate.count == side.count, "{count}: {apart} m, {} and {}", estimate.count, side.count);
            }
        }
    }
}
