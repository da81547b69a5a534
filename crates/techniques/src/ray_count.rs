//! Counting the rays of a technique: what `package::ray_count` adds to.

use crate::{Error, FrameContext, MakeContext, Statistic};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Buffer, Device, readback};

/// Most layers of an image: lights of a group.
const LAYERS: usize = 256;

/// The counts on the device: a 64-bit one of all frames, and one for each layer in this frame.
pub(crate) struct RayCount(Buffer);

impl RayCount {
    /// The name by which shaders know it.
    pub const BINDING: &'static str = "ray_counts";

    /// # Errors
    /// When the device refuses.
    pub fn new(context: &MakeContext, label: &str) -> Result<Self, Error> {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        Ok(Self(context.device.buffer_with(label, &[0u32; 2 + LAYERS], usage)?))
    }

    /// Begins the counts of a frame anew.
    pub fn prepare(&self, frame: &FrameContext) {
        frame.device.queue.write_buffer(&self.0.wgpu, 8, bytemuck::bytes_of(&[0u32; LAYERS]));
    }

    /// What to bind.
    pub fn buffer(&self) -> &Buffer {
        &self.0
    }

    fn words(&self, device: &Device) -> Result<Vec<u32>, Error> {
        Ok(readback::read_buffer(device, &self.0.wgpu)?)
    }

    /// Rays of all frames.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn rays(&self, device: &Device) -> Result<u64, Error> {
        let words = self.words(device)?;
        Ok(u64::from(words[0]) | u64::from(words[1]) << 32)
    }

    /// Rays of this frame, light by light.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn statistics(&self, frame: &FrameContext) -> Result<Vec<Statistic>, Error> {
        let words = self.words(frame.device)?;
        let of = |layer: usize| Statistic { name: "rays", light: frame.first_light + layer as u32, value: words[2 + layer].into() };
        Ok((0..frame.lights.len()).map(of).collect())
    }
}
