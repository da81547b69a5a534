//! What the G-buffer knows about a light: which surfaces face it, and where shadows meet what casts them.

use glam::Vec3;
use kajo_image::Image;
use kajo_image_metrics::MetricsError;
use kajo_renderer::GBufferImages;
use kajo_scene::{LightShape, Scene, Snapshot};

/// Where light comes from, as far as facing it needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightPlace {
    /// A point: the light's middle, world, m.
    At(Vec3),
    /// A point from which light leaves in a cone only: a spot, and the front of a flat lamp.
    Cone {
        /// The light's middle, world, m.
        at: Vec3,
        /// Where it shines, unit, world.
        axis: Vec3,
        /// Cosine of half the angle of the cone.
        cosine: f32,
    },
    /// A direction towards the light, unit, world.
    Towards(Vec3),
}

impl LightPlace {
    /// Unit direction from a point to the light.
    pub fn direction(self, from: Vec3) -> Vec3 {
        match self {
            Self::At(place) | Self::Cone { at: place, .. } => (place - from).normalize_or_zero(),
            Self::Towards(direction) => direction,
        }
    }

    /// True where light arrives if nothing is in its way: elsewhere a shadow is of no consequence, and visibility, which knows no cone, says nothing.
    pub fn shines_on(self, point: Vec3) -> bool {
        match self {
            Self::At(_) | Self::Towards(_) => true,
            Self::Cone { axis, cosine, .. } => -self.direction(point).dot(axis) > cosine,
        }
    }
}

/// Where the lights are, by the indices that both renderers share: analytic ones, then emissive instances.
pub fn places(scene: &Scene, snapshot: &Snapshot, lights: &[usize]) -> Vec<LightPlace> {
    let analytic = snapshot.lights.iter().map(|placed| {
        let back = Vec3::from(placed.world_from_light.matrix3.z_axis).normalize_or_zero();
        let at = placed.world_from_light.translation.into();
        match placed.light.shape {
            LightShape::Directional { .. } => LightPlace::Towards(back),
            LightShape::Spot { outer, .. } => LightPlace::Cone { at, axis: -back, cosine: outer.0.cos() },
            LightShape::Rectangle { .. } | LightShape::Disk { .. } => LightPlace::Cone { at, axis: -back, cosine: 0.0 },
            LightShape::Point | LightShape::Sphere { .. } => LightPlace::At(at),
        }
    });
    let emissive = snapshot.emissive_meshes(scene).into_iter().map(|mesh| LightPlace::At(mesh.center));
    let all: Vec<LightPlace> = analytic.chain(emissive).collect();
    lights.iter().map(|&light| all[light]).collect()
}

/// The surfaces of a view.
pub struct Surfaces<'a> {
    gbuffer: &'a GBufferImages,
    /// Pixels that show a surface, for the reference and the G-buffer.
    pub seen: Image<bool>,
    /// Distance to the next pixels of the same surface, the larger of both axes, m.
    spacing: Image<f32>,
}

/// Pixels across which a crease is looked for.
const CREASE: i32 = 2;
/// Cosine between normals below which two pixels of one instance are of different surfaces.
const SAME_SURFACE: f32 = 0.9;
/// How far, in pixels' spacings, a point may be off the plane of another surface that it touches.
const TOUCHING: f32 = 3.0;

impl<'a> Surfaces<'a> {
    /// # Errors
    /// Sizes that differ.
    pub fn new(gbuffer: &'a GBufferImages, mask: Option<&Image<bool>>) -> Result<Self, MetricsError> {
        let size = gbuffer.depth.size();
        if let Some(mask) = mask.filter(|mask| mask.size() != size) {
            return Err(MetricsError::SizeMismatch { what: "mask", got: mask.size(), reference: size });
        }
        let seen = Image::from_fn(size, |x, y| gbuffer.depth.get(x, y).is_finite() && mask.is_none_or(|mask| *mask.get(x, y)));
        let mut surfaces = Self { gbuffer, spacing: seen.map(|_| 0.0), seen };
        surfaces.spacing = Image::from_fn(size, |x, y| surfaces.spacing_at(x, y));
        Ok(surfaces)
    }

    fn spacing_at(&self, x: u32, y: u32) -> f32 {
        let along = |dx: i32, dy: i32| {
            let step = |sign: i32| {
                let (u, v) = self.neighbour(x, y, sign * dx, sign * dy)?;
                self.same(x, y, u, v).then(|| self.position(x, y).distance(self.position(u, v)))
            };
            [step(-1), step(1)].into_iter().flatten().reduce(f32::min).unwrap_or(0.0)
        };
        along(1, 0).max(along(0, 1))
    }

    fn position(&self, x: u32, y: u32) -> Vec3 {
        *self.gbuffer.position.get(x, y)
    }

    fn normal(&self, x: u32, y: u32) -> Vec3 {
        *self.gbuffer.normal.get(x, y)
    }

    /// A neighbour in the picture that shows a surface.
    fn neighbour(&self, x: u32, y: u32, dx: i32, dy: i32) -> Option<(u32, u32)> {
        let (u, v) = (x.checked_add_signed(dx)?, y.checked_add_signed(dy)?);
        (u < self.seen.width() && v < self.seen.height() && *self.seen.get(u, v)).then_some((u, v))
    }

    fn same(&self, x: u32, y: u32, u: u32, v: u32) -> bool {
        self.gbuffer.instance.get(x, y) == self.gbuffer.instance.get(u, v) && self.normal(x, y).dot(self.normal(u, v)) > SAME_SURFACE
    }

    /// Pixels whose surface the light shines on if nothing is in its way.
    pub fn reached(&self, light: LightPlace) -> Image<bool> {
        Image::from_fn(self.seen.size(), |x, y| *self.seen.get(x, y) && light.shines_on(self.position(x, y)))
    }

    /// True where a surface is seen that faces the light.
    pub fn faces(&self, light: LightPlace, x: u32, y: u32) -> bool {
        *self.seen.get(x, y) && self.normal(x, y).dot(light.direction(self.position(x, y))) > 0.0
    }

    /// True where, within [`CREASE`] px, the surface meets the unlit side of another one.
    pub fn is_contact(&self, light: LightPlace, x: u32, y: u32) -> bool {
        let window = -CREASE..=CREASE;
        let mut around = window.clone().flat_map(|dy| window.clone().map(move |dx| (dx, dy)));
        around.any(|(dx, dy)| {
            self.neighbour(x, y, dx, dy).is_some_and(|(u, v)| {
                !self.same(x, y, u, v) && !self.faces(light, u, v) && self.in_plane(x, y, u, v) && self.in_plane(u, v, x, y)
            })
        })
    }

    /// True when (u, v) lies in the plane of (x, y), as far as its own pixels tell.
    fn in_plane(&self, x: u32, y: u32, u: u32, v: u32) -> bool {
        let away = self.normal(x, y).dot(self.position(u, v) - self.position(x, y)).abs();
        away <= TOUCHING * self.spacing.get(u, v).max(*self.spacing.get(x, y))
    }
}
