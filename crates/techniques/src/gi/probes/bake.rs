//! The passes that place the probes, send their rays out once, and let light bounce between what these met.

use super::FILES;
use crate::ray_count::RayCount;
use crate::{Error, FrameContext, MakeContext};
use glam::UVec3;
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Bindings, Buffer, ComputePipeline, Device, PassContext, PipelineOptions};

/// Bytes of a probe, of the distances it knows, of its coefficients, and of what one of its rays met.
const PROBE_BYTES: u64 = 16;
const MOMENTS_BYTES: u64 = 8 * 8 * 8;
const COEFFICIENTS_BYTES: u64 = 9 * 16;
const SURFEL_BYTES: u64 = 32;

pub(super) struct Bake {
    place: ComputePipeline,
    look: ComputePipeline,
    measure: ComputePipeline,
    gather_bounce: ComputePipeline,
    made: Option<Made>,
}

/// What is kept of each probe.
struct Made {
    count: u32,
    probes: Buffer,
    moments: Buffer,
    surfels: Buffer,
    /// Light of an even and of an odd number of bounces.
    light: [Buffer; 2],
}

impl Bake {
    pub fn new(context: &MakeContext) -> Result<Self, Error> {
        let shader = context.shader_with("gi/probes/bake", include_str!("bake.wesl"), FILES)?;
        let options = PipelineOptions { list_length: context.textures, ..Default::default() };
        let pipeline = |entry| ComputePipeline::new(context.device, &shader, entry, options);
        Ok(Self {
            place: pipeline("place")?,
            look: pipeline("look")?,
            measure: pipeline("measure")?,
            gather_bounce: pipeline("gather_bounce")?,
            made: None,
        })
    }

    /// Makes room for `count` probes of `rays` rays.
    ///
    /// # Errors
    /// When the device has not enough.
    pub fn prepare(&mut self, device: &Device, count: u32, rays: u32) -> Result<(), Error> {
        if self.made.as_ref().is_some_and(|made| made.count == count) {
            return Ok(());
        }
        let buffer = |label, bytes: u64| {
            device.buffer(label, u64::from(count) * bytes, BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST)
        };
        self.made = Some(Made {
            count,
            probes: buffer("gi/probes probes", PROBE_BYTES)?,
            moments: buffer("gi/probes distances", MOMENTS_BYTES)?,
            surfels: buffer("gi/probes surfels", SURFEL_BYTES * u64::from(rays))?,
            light: [buffer("gi/probes light", COEFFICIENTS_BYTES)?, buffer("gi/probes light", COEFFICIENTS_BYTES)?],
        });
        Ok(())
    }

    fn made(&self) -> Result<&Made, kajo_render_graph::Error> {
        self.made.as_ref().ok_or_else(|| kajo_render_graph::Error::Refused { reason: "probes are read before they are made".to_owned() })
    }

    /// The probes.
    ///
    /// # Errors
    /// Before [`Self::prepare`].
    pub fn probes(&self) -> Result<&Buffer, kajo_render_graph::Error> {
        Ok(&self.made()?.probes)
    }

    /// The distances that they know.
    ///
    /// # Errors
    /// Before [`Self::prepare`].
    pub fn moments(&self) -> Result<&Buffer, kajo_render_graph::Error> {
        Ok(&self.made()?.moments)
    }

    /// Coefficients of light of up to `bounces` bounces.
    ///
    /// # Errors
    /// Before [`Self::prepare`].
    pub fn light(&self, bounces: u32) -> Result<&Buffer, kajo_render_graph::Error> {
        Ok(&self.made()?.light[(bounces % 2) as usize])
    }

    /// Places the probes and lets light bounce `bounces` times.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn record(
        &self,
        pass: &mut PassContext,
        frame: &FrameContext,
        inputs: Inputs,
        bounces: u32,
    ) -> Result<(), kajo_render_graph::Error> {
        let made = self.made()?;
        let groups = UVec3::new(made.count * 64, 1, 1);
        let grid = || Bindings::new().with("grid", inputs.grid);
        let looking = || grid().with("probes", &made.probes).with(RayCount::BINDING, inputs.rays.buffer());
        let mut dispatch =
            |pipeline: &ComputePipeline, own: Bindings| pipeline.dispatch(pass.device, pass.encoder, &frame.shared, &own, groups);
        dispatch(&self.place, looking())?;
        dispatch(&self.look, looking().with("surfels", &made.surfels))?;
        dispatch(&self.measure, grid().with("surfels", &made.surfels).with("moments", &made.moments))?;
        pass.encoder.clear_buffer(&made.light[0].wgpu, 0, None);
        for bounce in 0..bounces as usize {
            let [before, after] = [&made.light[bounce % 2], &made.light[(bounce + 1) % 2]];
            let own = grid().with("surfels", &made.surfels).with("before", before).with("after", after);
            self.gather_bounce.dispatch(pass.device, pass.encoder, &frame.shared, &own, groups)?;
        }
        Ok(())
    }
}

/// What the bake reads and counts beside its own buffers.
#[derive(Clone, Copy)]
pub(super) struct Inputs<'a> {
    pub grid: &'a Buffer,
    pub rays: &'a RayCount,
}
