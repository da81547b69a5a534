//! Binding by name: what a pass hands to a shader, checked against what the shader declares.

use crate::{Buffer, Error, Texture};
use kajo_shader_lib::naga::{ImageDimension, StorageAccess, StorageFormat};
use kajo_shader_lib::{Binding, BindingKind, Texels};
use std::collections::BTreeMap;
use std::num::NonZeroU32;

/// Something that can be bound.
#[derive(Clone, Debug)]
pub enum Resource<'a> {
    /// A view of a texture, to sample, load from or store to.
    View(wgpu::TextureView),
    /// Textures that the shader chooses from.
    Views(&'a [wgpu::TextureView]),
    /// A sampler.
    Sampler(&'a wgpu::Sampler),
    /// Samplers that the shader chooses from.
    Samplers(&'a [wgpu::Sampler]),
    /// A whole buffer, uniform or storage.
    Buffer(&'a wgpu::Buffer),
    /// Part of a buffer: the buffer, the first byte and the number of bytes.
    Range(&'a wgpu::Buffer, u64, u64),
    /// A top-level acceleration structure.
    Tlas(&'a wgpu::Tlas),
}

impl Resource<'_> {
    fn kind(&self) -> &'static str {
        match self {
            Self::View(_) => "texture view",
            Self::Views(_) => "list of texture views",
            Self::Sampler(_) => "sampler",
            Self::Samplers(_) => "list of samplers",
            Self::Buffer(_) | Self::Range(..) => "buffer",
            Self::Tlas(_) => "acceleration structure",
        }
    }

    fn fits(&self, binding: &Binding) -> bool {
        let list = binding.count.is_some();
        match (self, &binding.kind) {
            (Self::View(_), BindingKind::Texture { .. } | BindingKind::StorageTexture { .. }) => !list,
            (Self::Views(_), BindingKind::Texture { .. }) => list,
            (Self::Sampler(_), BindingKind::Sampler { .. }) => !list,
            (Self::Samplers(_), BindingKind::Sampler { .. }) => list,
            (Self::Buffer(_) | Self::Range(..), BindingKind::Uniform { .. } | BindingKind::Storage { .. }) => !list,
            (Self::Tlas(_), BindingKind::AccelerationStructure) => !list,
            _ => false,
        }
    }
}

impl From<&wgpu::TextureView> for Resource<'_> {
    fn from(view: &wgpu::TextureView) -> Self {
        Self::View(view.clone())
    }
}

impl From<wgpu::TextureView> for Resource<'_> {
    fn from(view: wgpu::TextureView) -> Self {
        Self::View(view)
    }
}

impl From<&Texture> for Resource<'_> {
    fn from(texture: &Texture) -> Self {
        Self::View(texture.view.clone())
    }
}

impl<'a> From<&'a Buffer> for Resource<'a> {
    fn from(buffer: &'a Buffer) -> Self {
        Self::Buffer(&buffer.wgpu)
    }
}

impl<'a> From<&'a wgpu::Sampler> for Resource<'a> {
    fn from(sampler: &'a wgpu::Sampler) -> Self {
        Self::Sampler(sampler)
    }
}

impl<'a> From<&'a wgpu::Tlas> for Resource<'a> {
    fn from(tlas: &'a wgpu::Tlas) -> Self {
        Self::Tlas(tlas)
    }
}

/// Resources by name.
#[derive(Clone, Debug, Default)]
pub struct Bindings<'a>(BTreeMap<&'static str, Resource<'a>>);

impl<'a> Bindings<'a> {
    /// Nothing bound.
    pub fn new() -> Self {
        Self::default()
    }

    /// Binds `name`, in place of what had that name.
    pub fn with(mut self, name: &'static str, resource: impl Into<Resource<'a>>) -> Self {
        self.0.insert(name, resource.into());
        self
    }

    /// Leaves out what is bound as `name`.
    pub fn without(mut self, name: &str) -> Self {
        self.0.remove(name);
        self
    }

    /// Binds everything that `other` has.
    pub fn with_all(mut self, other: &Bindings<'a>) -> Self {
        self.0.extend(other.0.iter().map(|(name, resource)| (*name, resource.clone())));
        self
    }

    /// Bound names, sorted.
    pub fn names(&self) -> Vec<String> {
        self.0.keys().map(|name| (*name).to_owned()).collect()
    }
}

/// Finds the resource of each declared binding: in `own` (whose names must all be declared) or in `shared` (which may hold more).
pub(crate) fn resolve<'r, 'a>(
    pass: &str,
    declared: &[Binding],
    shared: &'r Bindings<'a>,
    own: &'r Bindings<'a>,
) -> Result<Vec<&'r Resource<'a>>, Error> {
    let complaint = || Error::Binding {
        pass: pass.to_owned(),
        declared: declared.iter().map(|binding| binding.name.clone()).collect(),
        bound: own.names().into_iter().chain(shared.names()).collect(),
    };
    if own.0.keys().any(|name| declared.iter().all(|binding| binding.name != *name)) {
        return Err(complaint());
    }
    declared
        .iter()
        .map(|binding| {
            let resource = own.0.get(binding.name.as_str()).or_else(|| shared.0.get(binding.name.as_str())).ok_or_else(complaint)?;
            if resource.fits(binding) {
                Ok(resource)
            } else {
                let declared = format!("{:?}", binding.kind);
                Err(Error::BindingKind { pass: pass.to_owned(), name: binding.name.clone(), declared, bound: resource.kind() })
            }
        })
        .collect()
}

/// The bind group of one group.
pub(crate) fn group(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, entries: &[(u32, &Resource)]) -> wgpu::BindGroup {
    // Lists of references have to outlive the entries that borrow them.
    let views: Vec<Vec<&wgpu::TextureView>> = entries
        .iter()
        .map(|(_, resource)| match resource {
            Resource::Views(views) => views.iter().collect(),
            _ => Vec::new(),
        })
        .collect();
    let samplers: Vec<Vec<&wgpu::Sampler>> = entries
        .iter()
        .map(|(_, resource)| match resource {
            Resource::Samplers(samplers) => samplers.iter().collect(),
            _ => Vec::new(),
        })
        .collect();
    let entries: Vec<wgpu::BindGroupEntry> = entries
        .iter()
        .enumerate()
        .map(|(i, (binding, resource))| wgpu::BindGroupEntry {
            binding: *binding,
            resource: match resource {
                Resource::View(view) => wgpu::BindingResource::TextureView(view),
                Resource::Views(_) => wgpu::BindingResource::TextureViewArray(&views[i]),
                Resource::Sampler(sampler) => wgpu::BindingResource::Sampler(sampler),
                Resource::Samplers(_) => wgpu::BindingResource::SamplerArray(&samplers[i]),
                Resource::Buffer(buffer) => buffer.as_entire_binding(),
                Resource::Range(buffer, offset, size) => {
                    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: *offset, size: std::num::NonZeroU64::new(*size) })
                }
                Resource::Tlas(tlas) => tlas.as_binding(),
            },
        })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

/// The layout entry of a binding; `list_length` is the length of binding arrays that the shader leaves open.
pub(crate) fn layout_entry(binding: &Binding, stages: wgpu::ShaderStages, list_length: u32) -> wgpu::BindGroupLayoutEntry {
    let ty = match binding.kind {
        BindingKind::Uniform { .. } => {
            wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, has_dynamic_offset: false, min_binding_size: None }
        }
        BindingKind::Storage { read_only, .. } => wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        BindingKind::Texture { dimension, arrayed, multisampled, texels, sampled } => wgpu::BindingType::Texture {
            sample_type: match texels {
                Texels::Float => wgpu::TextureSampleType::Float { filterable: sampled },
                Texels::Sint => wgpu::TextureSampleType::Sint,
                Texels::Uint => wgpu::TextureSampleType::Uint,
                Texels::Depth => wgpu::TextureSampleType::Depth,
            },
            view_dimension: view_dimension(dimension, arrayed),
            multisampled,
        },
        BindingKind::StorageTexture { dimension, arrayed, format, access } => wgpu::BindingType::StorageTexture {
            access: storage_access(access),
            format: storage_format(format),
            view_dimension: view_dimension(dimension, arrayed),
        },
        BindingKind::Sampler { comparison: true } => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison),
        BindingKind::Sampler { comparison: false } => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        BindingKind::AccelerationStructure => wgpu::BindingType::AccelerationStructure { vertex_return: false },
    };
    let count = binding.count.and_then(|count| NonZeroU32::new(if count == 0 { list_length } else { count }));
    wgpu::BindGroupLayoutEntry { binding: binding.binding, visibility: stages, ty, count }
}

fn view_dimension(dimension: ImageDimension, arrayed: bool) -> wgpu::TextureViewDimension {
    match (dimension, arrayed) {
        (ImageDimension::D1, _) => wgpu::TextureViewDimension::D1,
        (ImageDimension::D2, false) => wgpu::TextureViewDimension::D2,
        (ImageDimension::D2, true) => wgpu::TextureViewDimension::D2Array,
        (ImageDimension::D3, _) => wgpu::TextureViewDimension::D3,
        (ImageDimension::Cube, false) => wgpu::TextureViewDimension::Cube,
        (ImageDimension::Cube, true) => wgpu::TextureViewDimension::CubeArray,
    }
}

fn storage_access(access: StorageAccess) -> wgpu::StorageTextureAccess {
    match (access.contains(StorageAccess::LOAD), access.contains(StorageAccess::STORE)) {
        (true, true) => wgpu::StorageTextureAccess::ReadWrite,
        (true, false) => wgpu::StorageTextureAccess::ReadOnly,
        _ => wgpu::StorageTextureAccess::WriteOnly,
    }
}

fn storage_format(format: StorageFormat) -> wgpu::TextureFormat {
    use wgpu::TextureFormat as To;
    match format {
        StorageFormat::R32Float => To::R32Float,
        StorageFormat::Rg32Float => To::Rg32Float,
        StorageFormat::Rgba32Float => To::Rgba32Float,
        StorageFormat::Rgba16Float => To::Rgba16Float,
        StorageFormat::R16Float => To::R16Float,
        StorageFormat::Rg16Float => To::Rg16Float,
        StorageFormat::R32Uint => To::R32Uint,
        StorageFormat::Rg32Uint => To::Rg32Uint,
        StorageFormat::Rgba32Uint => To::Rgba32Uint,
        StorageFormat::Rgba16Uint => To::Rgba16Uint,
        StorageFormat::Rgba8Unorm => To::Rgba8Unorm,
        StorageFormat::R8Unorm => To::R8Unorm,
        StorageFormat::R32Sint => To::R32Sint,
        other => unreachable!("no slot has the storage format {other:?}"),
    }
}
