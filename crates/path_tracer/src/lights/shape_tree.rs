//! A small bounding volume hierarchy over analytic area lights, for the lights that a ray passes.

use glam::Vec3;
use kajo_bvh::Aabb;

/// A binary tree over boxes, split at the median.
#[derive(Clone, Debug, Default)]
pub(crate) struct ShapeTree {
    /// Preorder: the left child follows its parent.
    nodes: Vec<Node>,
}

#[derive(Clone, Debug)]
struct Node {
    bounds: Aabb,
    /// First node after this subtree.
    skip: u32,
    /// Set in leaves.
    item: Option<u32>,
}

impl ShapeTree {
    pub(crate) fn new(items: &[(u32, Aabb)]) -> Self {
        let mut tree = Self::default();
        if !items.is_empty() {
            tree.build(&mut items.to_vec());
        }
        tree
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    fn build(&mut self, items: &mut [(u32, Aabb)]) {
        let bounds = items.iter().fold(Aabb::EMPTY, |sum, item| sum.union(item.1));
        let index = self.nodes.len();
        self.nodes.push(Node { bounds, skip: 0, item: (items.len() == 1).then_some(items[0].0) });
        if items.len() > 1 {
            let axis = (bounds.max - bounds.min).max_position();
            let middle = items.len() / 2;
            let center = |b: &Aabb| b.min[axis] + b.max[axis];
            items.select_nth_unstable_by(middle, |a, b| center(&a.1).total_cmp(&center(&b.1)).then(a.0.cmp(&b.0)));
            let (left, right) = items.split_at_mut(middle);
            self.build(left);
            self.build(right);
        }
        self.nodes[index].skip = self.nodes.len() as u32;
    }

    /// Calls `visit` with every item whose box the segment touches, in an order that depends on the tree only.
    #[inline]
    pub(crate) fn visit(&self, origin: Vec3, direction: Vec3, t_max: f32, mut visit: impl FnMut(u32)) {
        let inverse = direction.recip();
        let mut index = 0;
        while let Some(node) = self.nodes.get(index) {
            let inside = touches(&node.bounds, origin, inverse, t_max);
            if let (true, Some(item)) = (inside, node.item) {
                visit(item);
            }
            index = if inside { index + 1 } else { node.skip as usize };
        }
    }
}

/// Slab test, generous by a few roundings; NaN from 0 · ∞ counts as inside.
#[inline]
fn touches(bounds: &Aabb, origin: Vec3, inverse: Vec3, t_max: f32) -> bool {
    const SLACK: f32 = 1.0 + 4.0 * f32::EPSILON;
    let (a, b) = ((bounds.min - origin) * inverse, (bounds.max - origin) * inverse);
    let (mut near, mut far) = (0.0f32, t_max);
    for axis in 0..3 {
        near = near.max(a[axis].min(b[axis]) / SLACK);
        far = far.min(a[axis].max(b[axis]) * SLACK);
    }
    near <= far
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_sampling::{Rng, warp::uniform_sphere};

    #[test]
    fn visits_what_a_loop_over_all_boxes_visits() {
        let mut rng = Rng::new(5);
        for count in [1u32, 2, 3, 17, 200] {
            let boxes: Vec<_> = (0..count)
                .map(|i| {
                    let center = Vec3::new(rng.next_1d(), rng.next_1d(), rng.next_1d());
                    let half = Vec3::new(rng.next_1d(), 0.0, rng.next_1d()) * 0.1;
                    (i, Aabb { min: center - half, max: center + half })
                })
                .collect();
            let tree = ShapeTree::new(&boxes);
            for _ in 0..200 {
                let (origin, direction) = (Vec3::splat(0.5) + uniform_sphere(rng.next_2d()), uniform_sphere(rng.next_2d()));
                let mut got = Vec::new();
                tree.visit(origin, direction, 1.5, |i| got.push(i));
                got.sort_unstable();
                let inside = |b: &Aabb| touches(b, origin, direction.recip(), 1.5);
                let all: Vec<_> = boxes.iter().filter(|(_, b)| inside(b)).map(|&(i, _)| i).collect();
                assert_eq!(got, all);
            }
        }
        assert!(ShapeTree::new(&[]).is_empty());
    }
}
