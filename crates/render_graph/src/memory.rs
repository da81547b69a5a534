//! Textures and buffers that are counted while they live.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes of what is alive; clones share the counter.
#[derive(Clone, Debug, Default)]
pub struct Memory(Arc<Counter>);

#[derive(Debug, Default)]
struct Counter {
    bytes: AtomicU64,
    whole: Option<Memory>,
}

impl Memory {
    /// A counter of a part: what it counts is counted here too.
    pub fn part(&self) -> Self {
        Self(Arc::new(Counter { bytes: AtomicU64::new(0), whole: Some(self.clone()) }))
    }

    /// Bytes that are alive.
    pub fn bytes(&self) -> u64 {
        self.0.bytes.load(Ordering::Relaxed)
    }

    fn chain(&self) -> impl Iterator<Item = &AtomicU64> {
        std::iter::successors(Some(self), |memory| memory.0.whole.as_ref()).map(|memory| &memory.0.bytes)
    }

    fn take(&self, bytes: u64) -> Share {
        for counter in self.chain() {
            counter.fetch_add(bytes, Ordering::Relaxed);
        }
        Share { memory: self.clone(), bytes }
    }
}

/// Gives its bytes back when it is dropped.
#[derive(Debug)]
struct Share {
    memory: Memory,
    bytes: u64,
}

impl Drop for Share {
    fn drop(&mut self) {
        for counter in self.memory.chain() {
            counter.fetch_sub(self.bytes, Ordering::Relaxed);
        }
    }
}

/// A texture with a view of all of it.
#[derive(Debug)]
pub struct Texture {
    /// The texture.
    pub wgpu: wgpu::Texture,
    /// Every layer and level; an array view when it was made with more than one layer.
    pub view: wgpu::TextureView,
    share: Share,
}

impl Texture {
    pub(crate) fn new(device: &wgpu::Device, memory: &Memory, desc: &wgpu::TextureDescriptor<'_>) -> Self {
        let wgpu = device.create_texture(desc);
        let view = wgpu.create_view(&wgpu::TextureViewDescriptor::default());
        Self { wgpu, view, share: memory.take(texture_bytes(desc)) }
    }

    /// Bytes of all its levels and layers.
    pub fn bytes(&self) -> u64 {
        self.share.bytes
    }

    /// A two-dimensional view of one layer.
    pub fn layer(&self, layer: u32) -> wgpu::TextureView {
        self.wgpu.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: layer,
            array_layer_count: Some(1),
            ..Default::default()
        })
    }

    /// An array view of every layer, also where there is only one.
    pub fn array(&self) -> wgpu::TextureView {
        self.wgpu.create_view(&wgpu::TextureViewDescriptor { dimension: Some(wgpu::TextureViewDimension::D2Array), ..Default::default() })
    }
}

/// A buffer.
#[derive(Debug)]
pub struct Buffer {
    /// The buffer.
    pub wgpu: wgpu::Buffer,
    _share: Share,
}

impl Buffer {
    pub(crate) fn new(device: &wgpu::Device, memory: &Memory, label: &str, size: u64, usage: wgpu::BufferUsages) -> Self {
        let size = size.max(1).next_multiple_of(16);
        let wgpu = device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false });
        Self { wgpu, _share: memory.take(size) }
    }

    /// Replaces the first bytes; what does not fill four bytes is padded with zeros.
    pub fn write(&self, queue: &wgpu::Queue, bytes: &[u8]) {
        let whole = bytes.len() / 4 * 4;
        if whole > 0 {
            queue.write_buffer(&self.wgpu, 0, &bytes[..whole]);
        }
        if whole < bytes.len() {
            let mut rest = [0; 4];
            rest[..bytes.len() - whole].copy_from_slice(&bytes[whole..]);
            queue.write_buffer(&self.wgpu, whole as u64, &rest);
        }
    }

    /// Bytes.
    pub fn bytes(&self) -> u64 {
        self.wgpu.size()
    }
}

/// Bytes of all levels and layers, without the padding that drivers add.
fn texture_bytes(desc: &wgpu::TextureDescriptor<'_>) -> u64 {
    let texel = u64::from(desc.format.block_copy_size(None).unwrap_or(4));
    (0..desc.mip_level_count)
        .map(|level| {
            let side = |full: u32| u64::from((full >> level).max(1));
            side(desc.size.width) * side(desc.size.height) * u64::from(desc.size.depth_or_array_layers) * texel
        })
        .sum()
}
