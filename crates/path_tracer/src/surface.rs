//! A hit turned into what shading needs: position, normals, frame, material.
//!
//! # Normals
//! Every surface is shaded on the side that is seen, single-sided ones too (a rasteriser would cull their backs; a path tracer
//! that did so would leak light). The shading normal is the interpolated one, perturbed by the normal map, and bent towards the
//! viewer until the mirror direction lies above the geometric surface \[Keller17]. What the BSDF sends above the shading normal's
//! horizon but below the geometric surface is folded back: mirrored at the geometric surface, f'(ωi) = f(ωi) + f(mirror ωi). So a
//! white surface stays white, nothing leaks through the surface, and no energy is gained; both estimators see the same f'.
//! Transmissive surfaces are not folded, for they have a far side: there, directions on which the two normals disagree carry no light.

use crate::integrator::dispersion::Channel;
use crate::lights::Lights;
use crate::world::{Placed, World, interpolate};
use glam::{Vec2, Vec3};
use kajo_bsdf::{AnyBsdf, AnyBsdfView, Bsdf, BsdfSample, LobeValues};
use kajo_bvh::{Hit, PrimitiveRef, SurfacePoint, offset_origin};
use kajo_sampling::Frame;
use kajo_sampling::light_tree::Receiver;
use kajo_scene::SurfaceMaterial;
use kajo_units::{LinearRgb, Radians};
use std::borrow::Cow;

/// A point on a surface, as seen from `wo`.
pub(crate) struct Surface<'a> {
    pub point: SurfacePoint,
    pub primitive: PrimitiveRef,
    pub material: &'a SurfaceMaterial,
    /// The BSDF, where the material has prepared it.
    prepared: Option<&'a AnyBsdf>,
    /// Index of the material.
    pub material_index: u32,
    /// The front face is seen: the one whose winding is counter-clockwise.
    pub front: bool,
    /// Geometric normal on the viewer's side, unit length.
    pub geometric_normal: Vec3,
    /// Shading frame; z lies on the viewer's side, but on the front of a surface that bounds a volume: its BSDF knows its inside.
    pub frame: Frame,
    /// 1 where `frame.z` lies on the viewer's side, else −1.
    frame_side: f32,
    /// Light may pass to the far side.
    transmissive: bool,
    /// Where rays to the viewer's side start, and from where lights are looked at.
    pub origin_in_front: Vec3,
}

/// Least cosine between the bent mirror direction and the geometric surface: keeps it clear of rounding.
const MIRROR_ABOVE: f32 = 1e-3;

impl<'a> Surface<'a> {
    /// `wo` points to where the ray came from, unit length. A material that differs from point to point is left in `room`. `None` for a
    /// triangle without area.
    #[inline(always)]
    pub(crate) fn new(world: &'a World, hit: &Hit, wo: Vec3, lift: bool, room: &'a mut Option<SurfaceMaterial>) -> Option<Self> {
        let placed = &world.instances[hit.instance as usize];
        let info = &world.materials[placed.material as usize];
        let point = placed.point(hit.primitive, hit.u, hit.v);
        if point.geometric_normal == Vec3::ZERO {
            return None;
        }
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let constant = info.constant.as_ref().filter(|_| placed.mesh.colors.is_empty());
        *room = match constant {
            Some(_) if !info.needs_tangent => None,
            Some(material) => Some(*material),
            None => Some(placed.material_at(world, hit)),
        };
        let front = point.geometric_normal.dot(wo) >= 0.0;
        let side = if front { 1.0 } else { -1.0 };

        let vertex_normal = placed.normal_at(hit.primitive, weights, point.geometric_normal);
        let mut normal = vertex_normal;
        let mut tangent = Vec3::ZERO;
        if let (true, Some(material)) = (info.needs_tangent, &mut *room) {
            let (vertex_frame, sign) = placed.tangent_frame(hit.primitive, weights, vertex_normal);
            let to_world = |v: Vec3| vertex_frame.to_world(Vec3::new(v.x, sign * v.y, v.z));
            normal = to_world(material.normal).normalize_or(vertex_normal);
            let (sin, cos) = material.params.anisotropy_rotation.0.sin_cos();
            tangent = to_world(Vec3::new(cos, sin, 0.0));
            material.params.anisotropy_rotation = Radians(0.0);
            material.params.clearcoat_normal = to_world(material.params.clearcoat_normal);
        }
        let geometric_normal = side * point.geometric_normal;
        let normal = bent(side * normal, geometric_normal, wo);
        let params = &room.as_ref().or(constant)?.params;
        let material_transmits = params.transmission > 0.0;
        let bounds_volume = material_transmits && !params.thin;
        let frame_side = if bounds_volume { side } else { 1.0 };
        let z = frame_side * normal;
        let frame = if info.needs_tangent { Frame::from_z_tangent(z, tangent) } else { Frame::from_z(z) };
        if let (true, Some(material)) = (info.needs_tangent, &mut *room) {
            let coat = frame_side * bent(side * material.params.clearcoat_normal, geometric_normal, wo);
            material.params.clearcoat_normal = frame.to_local(coat).normalize_or(Vec3::Z);
        }
        let material: &SurfaceMaterial = room.as_ref().or(constant)?;
        let prepared = info.bsdf.as_ref().filter(|bsdf| matches!(bsdf, AnyBsdf::Model(_)) || room.is_none());
        let origin_in_front = world.ray_start(hit, &point, geometric_normal, wo, lift && !material_transmits);
        Some(Self {
            point,
            primitive: hit.primitive_ref(),
            material,
            prepared,
            material_index: placed.material,
            front,
            geometric_normal,
            frame,
            frame_side,
            transmissive: material_transmits,
            origin_in_front,
        })
    }

    /// Emitted radiance towards the viewer and the light it belongs to; `None` where nothing is emitted: dark materials, and the backs of
    /// single-sided ones.
    #[inline]
    pub(crate) fn emission(&self, world: &World, lights: &Lights) -> Option<(u32, LinearRgb)> {
        let material = &world.scene.materials[self.material_index as usize];
        let emits = !self.material.emission.is_black() && (self.front || material.double_sided || material.unlit);
        emits.then(|| Some((lights.of_instance(self.primitive.instance)?, self.material.emission))).flatten()
    }

    /// The BSDF at the point for light of one channel, or of all.
    #[inline]
    pub(crate) fn bsdf(&self, channel: Channel) -> Cow<'a, AnyBsdf> {
        let layered = |params| Cow::Owned(AnyBsdf::Layered(Bsdf::new(params)));
        match (self.prepared, channel) {
            (_, Some(channel)) if self.disperses() => layered(&self.material.params.for_channel(channel)),
            (Some(bsdf), _) => Cow::Borrowed(bsdf),
            (None, _) => layered(&self.material.params),
        }
    }

    /// True when the channels refract differently.
    #[inline]
    pub(crate) fn disperses(&self) -> bool {
        self.transmissive && self.material.params.dispersion > 0.0 && {
            let iors = self.material.params.channel_iors();
            iors.x != iors.z
        }
    }

    /// True for a surface that shows its base colour and scatters nothing: every ray that meets it sees it, no shadow ray looks for it.
    #[inline]
    pub(crate) fn unlit(&self, world: &World) -> bool {
        world.scene.materials[self.material_index as usize].unlit
    }

    /// The start of rays to the viewer's side from the triangle itself, as a technique that knows no better position starts them.
    #[inline]
    pub(crate) fn origin_flat(&self) -> Vec3 {
        offset_origin(self.point.position, self.geometric_normal, self.point.error)
    }

    /// Where light is looked for: above the surface, or all around where light passes it.
    #[inline]
    pub(crate) fn receiver(&self) -> Receiver {
        Receiver { point: self.origin_in_front, normal: (!self.transmissive).then_some(self.geometric_normal) }
    }

    /// Where a ray towards `direction` starts.
    #[inline]
    pub(crate) fn origin_towards(&self, world: &World, direction: Vec3) -> Vec3 {
        if direction.dot(self.geometric_normal) > 0.0 {
            self.origin_in_front
        } else {
            world.ray_start_beyond(self.primitive, &self.point, self.geometric_normal, self.origin_in_front)
        }
    }

    /// f · |cos θ| and density of the BSDF towards the world direction `wi`, folded as the module says.
    #[inline(always)]
    pub(crate) fn eval(&self, bsdf: &AnyBsdfView, wi: Vec3) -> (LobeValues, f32) {
        let local = self.frame.to_local(wi);
        let height = wi.dot(self.geometric_normal) * self.frame_side;
        if self.transmissive {
            return if height * local.z > 0.0 { bsdf.eval(local) } else { (LobeValues::ZERO, 0.0) };
        }
        if height <= 0.0 {
            return (LobeValues::ZERO, 0.0);
        }
        let (mut value, mut pdf) = if local.z > 0.0 { bsdf.eval(local) } else { (LobeValues::ZERO, 0.0) };
        let folded = self.frame.to_local(self.mirrored(wi));
        if folded.z > 0.0 {
            let (more, more_pdf) = bsdf.eval(folded);
            value += more;
            pdf += more_pdf;
        }
        (value, pdf)
    }

    /// The world direction of a sample, folded; `None` where a transmissive surface carries no light.
    #[inline(always)]
    pub(crate) fn direction_of(&self, sample: &BsdfSample) -> Option<Vec3> {
        let wi = self.frame.to_world(sample.wi);
        let height = wi.dot(self.geometric_normal) * self.frame_side;
        if self.transmissive {
            return (height * sample.wi.z > 0.0).then_some(wi);
        }
        if height > 0.0 { Some(wi) } else { Some(self.mirrored(wi)).filter(|wi| wi.dot(self.geometric_normal) > 0.0) }
    }

    /// Density of [`Surface::direction_of`] at `wi`, which `sample` gave.
    #[inline(always)]
    pub(crate) fn pdf_of(&self, bsdf: &AnyBsdfView, sample: &BsdfSample, wi: Vec3) -> f32 {
        let folds = !self.transmissive && self.frame.z.dot(self.mirrored(wi)) > 0.0;
        if folds { self.eval(bsdf, wi).1 } else { sample.pdf }
    }

    /// Mirror image at the geometric surface.
    #[inline(always)]
    fn mirrored(&self, wi: Vec3) -> Vec3 {
        wi - 2.0 * wi.dot(self.geometric_normal) * self.geometric_normal
    }

    /// Shading normal on the viewer's side, unit length.
    #[inline]
    pub(crate) fn normal(&self) -> Vec3 {
        self.frame_side * self.frame.z
    }
}

/// Bends a unit normal towards `wo` until the mirror direction of `wo` lies above the geometric surface.    \[Keller17] appendix
#[inline(always)]
fn bent(normal: Vec3, geometric: Vec3, wo: Vec3) -> Vec3 {
    let mirror = 2.0 * normal.dot(wo) * normal - wo;
    let above = mirror.dot(geometric);
    if above >= MIRROR_ABOVE && normal.dot(wo) > 0.0 {
        return normal;
    }
    let raised = (mirror + (MIRROR_ABOVE - above).max(0.0) * geometric).normalize_or(geometric);
    let bent = (wo + raised).normalize_or(geometric);
    if bent.dot(geometric) > 0.0 { bent } else { geometric }
}

impl Placed {
    /// The material where textures and vertex colours make it differ from point to point.
    fn material_at(&self, world: &World, hit: &Hit) -> SurfaceMaterial {
        world.scene.materials[self.material as usize].at(&world.scene, &self.uv_at(hit.primitive, hit.u, hit.v))
    }

    /// Unit vertex normal in the world, on the side of the geometric normal.
    fn normal_at(&self, primitive: u32, weights: [f32; 3], geometric: Vec3) -> Vec3 {
        if self.flat {
            return geometric;
        }
        let object: Vec3 = interpolate(&self.mesh.normals, self.mesh.indices[primitive as usize], weights);
        let normal = (self.normal_from_object * object).normalize_or(geometric);
        if normal.dot(geometric) < 0.0 { -normal } else { normal }
    }

    /// A frame around the vertex normal with x along the tangent, and the sign of the bitangent in it.
    fn tangent_frame(&self, primitive: u32, weights: [f32; 3], normal: Vec3) -> (Frame, f32) {
        let indices = self.mesh.indices[primitive as usize];
        if !self.mesh.tangents.is_empty() {
            let tangent = interpolate(&self.mesh.tangents, indices, weights);
            let world = self.world_from_object.transform_vector3(tangent.truncate());
            return (Frame::from_z_tangent(normal, world), self.handedness.copysign(self.handedness * tangent.w));
        }
        // Without tangents: the direction in which u grows on the triangle.
        let uvs = &self.mesh.uvs[0];
        if uvs.is_empty() {
            return (Frame::from_z(normal), 1.0);
        }
        let [p, q, r] = self.world_triangle(primitive);
        let [a, b, c]: [Vec2; 3] = indices.map(|i| uvs[i as usize]);
        let (e1, e2, d1, d2) = (q - p, r - p, b - a, c - a);
        let determinant = d1.perp_dot(d2);
        let tangent = (e1 * d2.y - e2 * d1.y) * determinant.signum();
        // v grows down in glTF textures while the bitangent of a normal map points up.
        let down = (e2 * d1.x - e1 * d2.x) * determinant.signum();
        let frame = Frame::from_z_tangent(normal, tangent);
        (frame, if frame.y.dot(-down) < 0.0 { -1.0 } else { 1.0 })
    }
}
