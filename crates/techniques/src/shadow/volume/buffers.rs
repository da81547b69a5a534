//! Buffers that grow with the scene, and uniforms of which each light of a group has its own.

use crate::Error;
use bytemuck::Pod;
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Buffer, Device, Resource};

/// Distance between what belongs to two lights in a buffer: a multiple of every device's offset alignment.
pub(super) const STRIDE: u64 = 256;

/// What has been made by the time passes run.
pub(super) fn made(buffer: &Option<Buffer>) -> &Buffer {
    buffer.as_ref().expect("prepared")
}

/// Appends `bytes`, and zeros up to the next multiple of [`STRIDE`].
pub(super) fn append(buffer: &mut Vec<u8>, bytes: &[u8]) {
    buffer.extend(bytes);
    buffer.resize(buffer.len().next_multiple_of(STRIDE as usize), 0);
}

/// Makes a buffer of at least `bytes`, where the one that is there is smaller.
pub(super) fn grow(device: &Device, buffer: &mut Option<Buffer>, label: &str, bytes: u64, usage: BufferUsages) -> Result<(), Error> {
    if buffer.as_ref().is_none_or(|buffer| buffer.bytes() < bytes) {
        *buffer = None;
        *buffer = Some(device.buffer(label, bytes, usage)?);
    }
    Ok(())
}

/// Writes `bytes` into a buffer that is large enough.
pub(super) fn upload(device: &Device, buffer: &mut Option<Buffer>, label: &str, bytes: &[u8], usage: BufferUsages) -> Result<(), Error> {
    grow(device, buffer, label, bytes.len() as u64, usage | BufferUsages::COPY_DST)?;
    made(buffer).write(&device.queue, bytes);
    Ok(())
}

/// Uniforms of all lights of a group, [`STRIDE`] apart.
pub(super) fn upload_uniforms<T: Pod>(device: &Device, buffer: &mut Option<Buffer>, label: &str, values: &[T]) -> Result<(), Error> {
    let mut bytes = Vec::new();
    values.iter().for_each(|value| append(&mut bytes, bytemuck::bytes_of(value)));
    upload(device, buffer, label, &bytes, BufferUsages::UNIFORM)
}

/// The uniform of one light.
pub(super) fn uniform<T>(buffer: &Option<Buffer>, layer: usize) -> Resource<'_> {
    Resource::Range(&made(buffer).wgpu, layer as u64 * STRIDE, size_of::<T>() as u64)
}
