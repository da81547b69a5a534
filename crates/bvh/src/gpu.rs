//! The two levels as plain arrays for a compute shader.
//!
//! Binary nodes of 32 bytes, all meshes in one array, so that a shader needs four buffers and no pointers:
//!
//! ```text
//! tlas_nodes[0] ─ inner ─ … ─ leaf ─► instances[first .. first + count]
//!                                        │ object_from_world, mask, flags, instance
//!                                        └ root ─► blas_nodes[root] ─ inner ─ … ─ leaf ─► triangles[first .. first + count]
//! ```
//!
//! To trace: start at `tlas_nodes[0]` unless [`FlatBvh::is_empty`]; a node with `count == 0` has its children at `left_or_first` and
//! `left_or_first + 1`; push the farther one. In an instance transform origin and direction (do not normalise: `t` then keeps its meaning)
//! and start at `blas_nodes[root]`. A stack of [`FlatBvh::tlas_stack`] and one of [`FlatBvh::blas_stack`] entries suffice.
//! Boxes are entered with the margin of [`slab`](crate::slab): `e = margin · (D + |o|) + extra`, D from the box of the root; for meshes
//! `margin` is [`MARGIN`] and `extra` 0. [`FlatBvh::closest_hit`] is this walk in Rust; it decides triangles in double precision, where a
//! shader that has none may differ on rays that meet an edge or a triangle edge-on.

use crate::{
    aabb::Aabb,
    build::{BinaryTree, Cost, Item, Sah},
    ray::{Filter, Hit, Ray},
    slab::{MARGIN, SlabRay},
    tlas::{Tlas, world_bounds},
    traverse::Nearest,
    triangle::ShearedRay,
};
use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Vec3};
use rayon::prelude::*;

/// A binary node. 32 bytes, two `vec4` loads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FlatNode {
    /// Least corner, m.
    pub min: [f32; 3],
    /// Inner: the first of two children. Leaf: the first triangle or instance.
    pub left_or_first: u32,
    /// Greatest corner, m.
    pub max: [f32; 3],
    /// Triangles or instances of a leaf; 0 for an inner node.
    pub count: u32,
}

impl FlatNode {
    fn bounds(&self) -> Aabb {
        Aabb { min: Vec3::from_array(self.min), max: Vec3::from_array(self.max) }
    }
}

/// A triangle. 48 bytes, three `vec4` loads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FlatTriangle {
    /// Vertex 0, m.
    pub v0: [f32; 3],
    /// Index in its mesh.
    pub primitive: u32,
    /// Vertex 1, m.
    pub v1: [f32; 3],
    /// Zero.
    pub padding_1: u32,
    /// Vertex 2, m.
    pub v2: [f32; 3],
    /// Zero.
    pub padding_2: u32,
}

/// A placed mesh. 64 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FlatInstance {
    /// The first three rows of the matrix: `p_object[i] = dot(object_from_world[i], vec4(p_world, 1))`.
    pub object_from_world: [[f32; 4]; 3],
    /// Top node of its mesh in `blas_nodes`.
    pub root: u32,
    /// Index of the instance as given to [`Tlas::build`].
    pub instance: u32,
    /// Seen by rays whose mask shares a bit.
    pub mask: u32,
    /// Bit 0, [`FlatInstance::OPAQUE`]: hits need no confirmation.
    pub flags: u32,
}

impl FlatInstance {
    /// Bit of `flags`.
    pub const OPAQUE: u32 = 1;
}

/// Both levels, ready to upload. No array is empty: where there is nothing, one zeroed entry stands.
#[derive(Clone, Debug)]
pub struct FlatBvh {
    /// Upper level; starts at 0.
    pub tlas_nodes: Vec<FlatNode>,
    /// Lower levels of all meshes.
    pub blas_nodes: Vec<FlatNode>,
    /// Triangles of all meshes, in the order of the leaves.
    pub triangles: Vec<FlatTriangle>,
    /// Instances, in the order of the leaves.
    pub instances: Vec<FlatInstance>,
    /// Top node of every mesh in `blas_nodes`; `None` for an empty mesh.
    pub roots: Vec<Option<u32>>,
    /// Margin of the upper level's boxes, in units of D + |o|.
    pub margin: f32,
    /// Added to the margin of the upper level's boxes, m.
    pub extra: f32,
    /// Shapes of the meshes: they are functions of the caller's, which a shader does not have, so they are not in the arrays.
    pub shapes_left_out: usize,
    /// Stack entries that a walk through the upper level can need.
    pub tlas_stack: u32,
    /// Stack entries that a walk through a mesh can need.
    pub blas_stack: u32,
}

/// Triangles of a leaf, at most.
const LEAF_TRIANGLES: usize = 4;

impl FlatBvh {
    /// Builds binary trees over the meshes and instances of `tlas`. Instances that cannot be hit are left out, and all shapes:
    /// see [`shapes_left_out`](Self::shapes_left_out).
    pub fn new(tlas: &Tlas) -> Self {
        let sah = Sah { max_leaf_size: LEAF_TRIANGLES, ..Sah::default() };
        let meshes: Vec<(Vec<FlatTriangle>, Vec<FlatNode>)> = tlas
            .blases()
            .par_iter()
            .map(|blas| {
                let mut triangles = vec![FlatTriangle::default(); blas.triangle_count()];
                let mut items = vec![Item::new(&Aabb::EMPTY, 0); blas.triangle_count()];
                for (primitive, corners) in blas.triangles() {
                    let [v0, v1, v2] = corners.map(|p| p.to_array());
                    triangles[primitive as usize] = FlatTriangle { v0, primitive, v1, v2, ..FlatTriangle::default() };
                    items[primitive as usize] = Item::new(&Aabb::of_points(corners), primitive);
                }
                let tree = BinaryTree::build(items, &Cost { sah, block: 1 });
                (tree.order.iter().map(|&i| triangles[i as usize]).collect(), flatten(&tree))
            })
            .collect();

        let mut flat = Self {
            tlas_nodes: Vec::new(),
            blas_nodes: Vec::new(),
            triangles: Vec::new(),
            instances: Vec::new(),
            roots: Vec::new(),
            margin: tlas.margin().0,
            extra: tlas.margin().1,
            shapes_left_out: tlas.blases().iter().map(|blas| blas.shape_count()).sum(),
            tlas_stack: 1,
            blas_stack: 1,
        };
        for (triangles, nodes) in meshes {
            flat.blas_stack = flat.blas_stack.max(stack_of(&nodes));
            flat.roots.push((!nodes.is_empty()).then_some(flat.blas_nodes.len() as u32));
            let (first_node, first_triangle) = (flat.blas_nodes.len() as u32, flat.triangles.len() as u32);
            flat.blas_nodes.extend(nodes.iter().map(|node| {
                let shift = if node.count == 0 { first_node } else { first_triangle };
                FlatNode { left_or_first: node.left_or_first + shift, ..*node }
            }));
            flat.triangles.extend(triangles);
        }
        flat.place(tlas);
        pad(&mut flat.tlas_nodes);
        pad(&mut flat.blas_nodes);
        pad(&mut flat.triangles);
        pad(&mut flat.instances);
        flat
    }

    /// Fills the upper level.
    fn place(&mut self, tlas: &Tlas) {
        let placed = tlas.placed();
        let with_triangles = placed.iter().enumerate().filter(|(_, p)| self.roots[p.blas as usize].is_some());
        let items = with_triangles.map(|(slot, p)| {
            let bounds = world_bounds(&tlas.blases()[p.blas as usize], &p.world_from_object);
            Item::new(&bounds, slot as u32)
        });
        let sah = Sah { max_leaf_size: 1, ..Sah::default() };
        let tree = BinaryTree::build(items.collect(), &Cost { sah, block: 1 });
        self.tlas_nodes = flatten(&tree);
        self.tlas_stack = stack_of(&self.tlas_nodes);
        self.instances.extend(tree.order.iter().map(|&slot| {
            let p = &placed[slot as usize];
            FlatInstance {
                object_from_world: rows(&p.object_from_world),
                root: self.roots[p.blas as usize].expect("only meshes with triangles are kept"),
                instance: p.instance,
                mask: p.mask,
                flags: if p.opaque { FlatInstance::OPAQUE } else { 0 },
            }
        }));
    }

    /// Whether there is nothing to hit: the top node is then neither a leaf nor has children.
    pub fn is_empty(&self) -> bool {
        self.tlas_nodes[0].count == 0 && self.tlas_nodes[0].left_or_first == 0
    }

    /// Bytes of the four arrays.
    pub fn memory(&self) -> usize {
        use std::mem::size_of_val;
        size_of_val(&self.tlas_nodes[..])
            + size_of_val(&self.blas_nodes[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.instances[..])
    }

    /// The walk that a shader does, over exactly these arrays. Returns what [`Tlas::closest_hit`] returns.
    pub fn closest_hit(&self, ray: &Ray, filter: Filter, mut accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        let mut nearest = Nearest::before(ray.t_max);
        if self.is_empty() || !ray.is_usable() {
            return None;
        }
        let slab = SlabRay::new(ray, &self.tlas_nodes[0].bounds(), self.margin, self.extra);
        walk(&self.tlas_nodes, 0, &slab, ray.t_max, |first, count| {
            for placed in self.instances[first..first + count].iter().filter(|p| p.mask & filter.mask != 0) {
                self.enter(placed, ray, filter, &mut accept, &mut nearest);
            }
            nearest.hit.t
        });
        nearest.into_option()
    }

    fn enter(&self, placed: &FlatInstance, ray: &Ray, filter: Filter, accept: &mut impl FnMut(&Hit) -> bool, nearest: &mut Nearest) {
        let object_from_world = affine(&placed.object_from_world);
        let local = Ray {
            origin: object_from_world.transform_point3(ray.origin),
            direction: object_from_world.transform_vector3(ray.direction),
            ..*ray
        };
        if !local.is_usable() {
            return;
        }
        let sheared = ShearedRay::new(&local);
        let slab = SlabRay::new(&local, &self.blas_nodes[placed.root as usize].bounds(), MARGIN, 0.0);
        let opaque = placed.flags & FlatInstance::OPAQUE != 0;
        walk(&self.blas_nodes, placed.root, &slab, nearest.hit.t, |first, count| {
            for triangle in &self.triangles[first..first + count] {
                let Some(crossing) = sheared.cross([triangle.v0, triangle.v1, triangle.v2]) else { continue };
                let hit = Hit { t: crossing.t, u: crossing.u, v: crossing.v, primitive: triangle.primitive, instance: placed.instance };
                if hit.t > ray.t_min
                    && nearest.is_beaten_by(&hit)
                    && filter.exclude != Some(hit.primitive_ref())
                    && (opaque || accept(&hit))
                {
                    *nearest = Nearest { hit, found: true };
                }
            }
            nearest.hit.t
        });
    }
}

/// Front to back through a binary tree. `leaf` tests its items and returns the distance beyond which boxes may be skipped.
fn walk(nodes: &[FlatNode], root: u32, slab: &SlabRay, mut limit: f32, mut leaf: impl FnMut(usize, usize) -> f32) {
    let mut stack = vec![(root, enter_box(slab, &nodes[root as usize], limit))];
    while let Some((index, entered)) = stack.pop() {
        if !entered.is_some_and(|t| t <= limit) {
            continue;
        }
        let node = &nodes[index as usize];
        if node.count > 0 {
            limit = leaf(node.left_or_first as usize, node.count as usize);
            continue;
        }
        let children = [node.left_or_first, node.left_or_first + 1];
        let [left, right] = children.map(|child| (child, enter_box(slab, &nodes[child as usize], limit)));
        let swap = match (left.1, right.1) {
            (Some(l), Some(r)) => l < r,
            _ => false,
        };
        stack.extend(if swap { [right, left] } else { [left, right] });
    }
}

/// Where the ray enters the box of a node, if it does before `limit`.
fn enter_box(slab: &SlabRay, node: &FlatNode, limit: f32) -> Option<f32> {
    let (mut near, mut far) = (slab.t_min, limit);
    for axis in 0..3 {
        let planes = [node.min[axis], node.max[axis]];
        let side = usize::from(slab.reciprocal[axis] < 0.0);
        near = near.max(planes[side] * slab.reciprocal[axis] + slab.near[axis]);
        far = far.min(planes[side ^ 1] * slab.reciprocal[axis] + slab.far[axis]);
    }
    (near <= far).then_some(near)
}

/// Nodes in breadth-first pairs, without gaps.
fn flatten(tree: &BinaryTree) -> Vec<FlatNode> {
    if tree.nodes.is_empty() {
        return Vec::new();
    }
    let flat = |index: usize| {
        let node = &tree.nodes[index];
        let bounds = node.bounds();
        let (left_or_first, count) = node.leaf().map_or((0, 0), |range| (range.start as u32, range.len() as u32));
        FlatNode { min: bounds.min.to_array(), left_or_first, max: bounds.max.to_array(), count }
    };
    let mut out = vec![flat(0)];
    let mut sources = vec![0];
    let mut next = 0;
    while next < out.len() {
        if out[next].count == 0 {
            out[next].left_or_first = out.len() as u32;
            for child in tree.nodes[sources[next]].children() {
                out.push(flat(child));
                sources.push(child);
            }
        }
        next += 1;
    }
    out
}

/// Stack entries that a walk can need when it pops one entry and pushes two: one a level, and one more.
fn stack_of(nodes: &[FlatNode]) -> u32 {
    let mut depth = vec![1u32; nodes.len()];
    for index in 0..nodes.len() {
        if nodes[index].count == 0 {
            let left = nodes[index].left_or_first as usize;
            depth[left] = depth[index] + 1;
            depth[left + 1] = depth[index] + 1;
        }
    }
    depth.into_iter().max().unwrap_or(1)
}

fn rows(map: &Affine3A) -> [[f32; 4]; 3] {
    let m = map.matrix3;
    [0, 1, 2].map(|row| [m.x_axis[row], m.y_axis[row], m.z_axis[row], map.translation[row]])
}

fn affine(rows: &[[f32; 4]; 3]) -> Affine3A {
    let column = |c: usize| Vec3::new(rows[0][c], rows[1][c], rows[2][c]);
    Affine3A::from_cols(column(0).into(), column(1).into(), column(2).into(), column(3).into())
}

fn pad<T: Default>(list: &mut Vec<T>) {
    if list.is_empty() {
        list.push(T::default());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Blas, BuildOptions};

    /// Entries that a walk needs which descends to the deeper child first, the other one waiting, and enters every box.
    fn most_waiting(nodes: &[FlatNode], index: usize) -> u32 {
        if nodes[index].count > 0 {
            return 1;
        }
        let left = nodes[index].left_or_first as usize;
        let (a, b) = (most_waiting(nodes, left), most_waiting(nodes, left + 1));
        1 + a.max(b)
    }

    #[test]
    fn stacks_hold_the_longest_walk() {
        for growth in [1.0f32, 1.1, 2.0] {
            for count in [1u32, 2, 5, 6, 100] {
                let corner = |i: u32, k: u32| Vec3::new(1.0, (k % 2) as f32, (k / 2) as f32) * growth.powi(i as i32 - 50);
                let positions: Vec<Vec3> = (0..count).flat_map(|i| (0..3).map(move |k| corner(i, k))).collect();
                let indices: Vec<[u32; 3]> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
                let flat = FlatBvh::new(&Tlas::single(Blas::build(&positions, &indices, &BuildOptions::default()).unwrap()));
                assert_eq!(flat.blas_stack, most_waiting(&flat.blas_nodes, 0), "{count} triangles, each {growth} times the last");
                assert_eq!(flat.tlas_stack, 1);
            }
        }
    }
}
