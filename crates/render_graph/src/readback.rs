//! Reading textures and buffers back to the CPU.

use crate::{Device, Error};
use glam::UVec2;

/// Reads one layer of a texture: `height × width` texels of type `T`, row-major, top row first.
///
/// # Errors
/// When the device is lost.
///
/// # Panics
/// When `T` is not as large as a texel.
pub fn read_texture<T: bytemuck::AnyBitPattern>(device: &Device, texture: &wgpu::Texture, layer: u32) -> Result<Vec<T>, Error> {
    let size = UVec2::new(texture.width(), texture.height());
    let aspect = if texture.format().has_depth_aspect() { wgpu::TextureAspect::DepthOnly } else { wgpu::TextureAspect::All };
    let texel = texture.format().block_copy_size(Some(aspect)).expect("an uncompressed format");
    assert_eq!(texel as usize, size_of::<T>(), "texels of {:?}", texture.format());
    let row = (size.x * texel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.wgpu.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: u64::from(row) * u64::from(size.y),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("readback") });
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo { texture, mip_level: 0, origin: wgpu::Origin3d { x: 0, y: 0, z: layer }, aspect },
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None },
        },
        wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
    );
    device.queue.submit([encoder.finish()]);
    let bytes: Vec<u8> = read_mapped(device, &buffer)?;
    let tight = (size.x * texel) as usize;
    let texels = |line: &[u8]| line[..tight].chunks_exact(texel as usize).map(bytemuck::pod_read_unaligned).collect::<Vec<T>>();
    Ok(bytes.chunks_exact(row as usize).flat_map(texels).collect())
}

/// Reads a whole buffer that has the usage `COPY_SRC`.
///
/// # Errors
/// When the device is lost.
pub fn read_buffer<T: bytemuck::AnyBitPattern>(device: &Device, buffer: &wgpu::Buffer) -> Result<Vec<T>, Error> {
    let copy = device.wgpu.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: buffer.size(),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("readback") });
    encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
    device.queue.submit([encoder.finish()]);
    read_mapped(device, &copy)
}

/// Reads a whole buffer that has the usage `MAP_READ`, after everything submitted.
pub(crate) fn read_mapped<T: bytemuck::AnyBitPattern>(device: &Device, buffer: &wgpu::Buffer) -> Result<Vec<T>, Error> {
    buffer.slice(..).map_async(wgpu::MapMode::Read, |_| {});
    device.wait()?;
    let range = buffer.slice(..).get_mapped_range().map_err(|error| Error::DeviceLost { reason: error.to_string() })?;
    let values = range.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect();
    drop(range);
    buffer.unmap();
    Ok(values)
}
