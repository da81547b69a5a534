//! One sample of one pixel: where the channels of each image are, and the sink that splits light among them.

use crate::film::FilmLayout;
use crate::integrator::{Sink, Split};
use crate::lights::Lights;
use crate::{Aov, PathTracerError};
use kajo_units::LinearRgb;

/// Offset of each image in the channels of a sample; `beauty` is at 0.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slots {
    pub emission: Option<usize>,
    pub direct: Option<usize>,
    pub direct_diffuse: Option<usize>,
    pub direct_specular: Option<usize>,
    /// By light.
    pub direct_light: Vec<Option<usize>>,
    pub indirect_diffuse: Option<usize>,
    pub indirect_specular: Option<usize>,
    /// By number of bounces.
    pub bounce: Vec<Option<usize>>,
    /// Offset and light.
    pub visibility: Vec<(usize, u32)>,
    pub ambient_visibility: Option<usize>,
    pub bent_normal: Option<usize>,
    pub diffuse_indirect: Option<usize>,
    pub specular_indirect: Option<usize>,
    pub albedo: Option<usize>,
    pub normal: Option<usize>,
    pub shading_normal: Option<usize>,
    pub depth: Option<usize>,
    pub position: Option<usize>,
    pub coverage: Option<usize>,
    pub instance_id: Option<usize>,
    pub material_id: Option<usize>,
    pub motion: Option<usize>,
    /// Lights below this index are analytic.
    pub analytic: u32,
    /// True when light is split into more images than `beauty`.
    pub splits_light: bool,
    /// True when something about the first hit is asked for.
    pub first_hit: bool,
}

impl Slots {
    /// # Errors
    /// [`PathTracerError::Aov`] for a light that the scene does not have, or that has no visibility.
    pub(crate) fn new(layout: &FilmLayout, lights: &Lights) -> Result<Self, PathTracerError> {
        let mut slots = Self { analytic: lights.analytic as u32, coverage: layout.coverage, ..Self::default() };
        slots.direct_light = vec![None; lights.names.len()];
        for image in &layout.images {
            let Some(aov) = &image.aov else { continue };
            let at = Some(image.offset);
            let mut is_light = true;
            match aov {
                Aov::Emission => slots.emission = at,
                Aov::Direct => slots.direct = at,
                Aov::DirectDiffuse => slots.direct_diffuse = at,
                Aov::DirectSpecular => slots.direct_specular = at,
                Aov::DirectLight(name) => slots.direct_light[lights.index_of(name, false)?] = at,
                Aov::IndirectDiffuse => slots.indirect_diffuse = at,
                Aov::IndirectSpecular => slots.indirect_specular = at,
                Aov::SpecularIndirect => slots.specular_indirect = at,
                Aov::Bounce(n) => {
                    let n = *n as usize;
                    slots.bounce.resize(slots.bounce.len().max(n + 1), None);
                    slots.bounce[n] = at;
                }
                _ => is_light = false,
            }
            slots.splits_light |= is_light;
            slots.first_hit |= !is_light && *aov != Aov::Samples;
            match aov {
                Aov::Visibility(name) => slots.visibility.push((image.offset, lights.index_of(name, true)? as u32)),
                Aov::AmbientVisibility => slots.ambient_visibility = at,
                Aov::BentNormal => slots.bent_normal = at,
                Aov::DiffuseIndirect => slots.diffuse_indirect = at,
                Aov::Albedo => slots.albedo = at,
                Aov::Normal => slots.normal = at,
                Aov::ShadingNormal => slots.shading_normal = at,
                Aov::Depth => slots.depth = at,
                Aov::Position => slots.position = at,
                Aov::InstanceId => slots.instance_id = at,
                Aov::MaterialId => slots.material_id = at,
                Aov::Motion => slots.motion = at,
                _ => {}
            }
        }
        Ok(slots)
    }
}

/// Splits light among the channels of one sample.
pub(crate) struct Record<'a> {
    pub slots: &'a Slots,
    pub channels: &'a mut [f32],
    /// Light of fewer bounces comes otherwise.
    pub least_bounces: u32,
}

impl Record<'_> {
    #[inline]
    pub(crate) fn add(&mut self, offset: usize, value: LinearRgb) {
        for (channel, value) in self.channels[offset..offset + 3].iter_mut().zip(value.0.to_array()) {
            *channel += value;
        }
    }

    #[inline]
    fn add_to(&mut self, offset: Option<usize>, value: LinearRgb) {
        if let Some(offset) = offset {
            self.add(offset, value);
        }
    }
}

impl Sink for Record<'_> {
    #[inline]
    fn wants(&self, bounces: u32) -> bool {
        bounces >= self.least_bounces
    }

    #[inline]
    fn light(&mut self, bounces: u32, light: u32, share: Split) {
        if !self.wants(bounces) {
            return;
        }
        let total = share.total();
        self.add(0, total);
        let slots = self.slots;
        if !slots.splits_light {
            return;
        }
        self.add_to(slots.bounce.get(bounces as usize).copied().flatten(), total);
        match bounces {
            0 => self.add_to(slots.emission, total),
            1 => {
                self.add_to(slots.direct, total);
                self.add_to(slots.direct_diffuse, share.diffuse);
                self.add_to(slots.direct_specular, share.specular);
                self.add_to(slots.direct_light[light as usize], total);
                if light >= slots.analytic {
                    self.add_to(slots.specular_indirect, share.specular);
                }
            }
            _ => {
                self.add_to(slots.indirect_diffuse, share.diffuse);
                self.add_to(slots.indirect_specular, share.specular);
                self.add_to(slots.specular_indirect, share.specular);
            }
        }
    }
}
