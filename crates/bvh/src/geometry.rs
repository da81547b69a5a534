//! What a lower level is built over: triangles, and shapes that are known by a box and a function.

use crate::{
    aabb::Aabb,
    build::Item,
    error::BvhError,
    limits::Limits,
    ray::Ray,
    triangle::{Crossing, MAX_COORDINATE},
};
use glam::Vec3;
use rayon::prelude::*;
use std::{fmt::Debug, sync::Arc};

/// Shapes that the caller intersects: spheres, curves, distance fields.
///
/// Their primitive numbers follow those of the triangles in the same mesh: shape `s` is primitive `triangles + s`.
pub trait Procedural: Debug + Send + Sync {
    /// How many there are.
    fn count(&self) -> usize;

    /// A box around a shape, in the space of the mesh. Crossings outside it may be missed.
    fn bounds(&self, shape: usize) -> Aabb;

    /// The first crossing of a ray with a shape in `ray.t_min ≤ t ≤ ray.t_max`. `u` and `v` are the caller's own and come back in the hit.
    ///
    /// The ray is in the space of the mesh, its direction of any length. The answer must depend on the arguments alone, and not be NaN.
    fn intersect(&self, shape: usize, ray: &Ray) -> Option<Crossing>;
}

/// Triangles and shapes of one mesh.
#[derive(Clone, Debug)]
pub struct Geometry<'a> {
    positions: &'a [Vec3],
    indices: &'a [[u32; 3]],
    shapes: Option<Arc<dyn Procedural>>,
}

impl<'a> Geometry<'a> {
    /// Indexed triangles.
    pub fn triangles(positions: &'a [Vec3], indices: &'a [[u32; 3]]) -> Self {
        Self { positions, indices, shapes: None }
    }

    /// Shapes only.
    pub fn shapes(shapes: Arc<dyn Procedural>) -> Self {
        Self::triangles(&[], &[]).with_shapes(shapes)
    }

    /// The same triangles, and shapes beside them.
    pub fn with_shapes(self, shapes: Arc<dyn Procedural>) -> Self {
        Self { shapes: Some(shapes), ..self }
    }

    pub(crate) fn triangle_count(&self) -> usize {
        self.indices.len()
    }

    pub(crate) fn shape_count(&self) -> usize {
        self.shapes.as_ref().map_or(0, |shapes| shapes.count())
    }

    /// The shapes, if there are any.
    pub(crate) fn used_shapes(&self) -> Option<&Arc<dyn Procedural>> {
        self.shapes.as_ref().filter(|shapes| shapes.count() > 0)
    }

    /// Corners of a triangle; its indices have been checked.
    #[inline(always)]
    pub(crate) fn triangle(&self, number: usize) -> [Vec3; 3] {
        self.indices[number].map(|v| self.positions[v as usize])
    }

    /// Checks everything and puts a box around each triangle and shape.
    pub(crate) fn items(&self) -> Result<Vec<Item>, BvhError> {
        Limits::HERE.check_primitives(self.triangle_count().saturating_add(self.shape_count()))?;
        let mut items = self
            .indices
            .par_iter()
            .enumerate()
            .with_min_len(1024)
            .map(|(number, vertices)| {
                check(self.positions, number, vertices)?;
                Ok(Item::new(&Aabb::of_points(self.triangle(number)), number as u32))
            })
            .collect::<Result<Vec<_>, BvhError>>()?;
        if let Some(shapes) = self.used_shapes() {
            for shape in 0..shapes.count() {
                items.push(Item::new(&checked_bounds(&**shapes, shape)?, (self.triangle_count() + shape) as u32));
            }
        }
        Ok(items)
    }
}

/// Whether a triangle's vertices exist and are usable.
fn check(positions: &[Vec3], triangle: usize, vertices: &[u32; 3]) -> Result<(), BvhError> {
    for &vertex in vertices {
        let Some(position) = positions.get(vertex as usize) else {
            return Err(BvhError::Index { triangle, vertex, vertices: positions.len() });
        };
        // A comparison with NaN is false.
        if !position.abs().cmple(Vec3::splat(MAX_COORDINATE)).all() {
            return Err(BvhError::Position { vertex: vertex as usize, position: position.to_array() });
        }
    }
    Ok(())
}

/// The box of a shape, if it is one.
fn checked_bounds(shapes: &dyn Procedural, shape: usize) -> Result<Aabb, BvhError> {
    let bounds = shapes.bounds(shape);
    // The greatest of numbers with NaN among them may be one of the others, so each is asked.
    let usable = |p: Vec3| p.abs().cmple(Vec3::splat(MAX_COORDINATE)).all();
    match !bounds.is_empty() && usable(bounds.min) && usable(bounds.max) {
        true => Ok(bounds),
        false => Err(BvhError::Shape { shape, min: bounds.min.to_array(), max: bounds.max.to_array() }),
    }
}
