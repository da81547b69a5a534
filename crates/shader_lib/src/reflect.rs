//! What a linked shader declares, read from naga's module.

use crate::diagnose::Names;
use crate::{FieldLayout, StructLayout};
use naga::proc::Layouter;
use naga::valid::ModuleInfo;
use naga::{AddressSpace, ArraySize, GlobalVariable, Handle, ImageClass, TypeInner};
use std::collections::BTreeSet;

/// A resource of the shader.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Binding {
    /// `@group`.
    pub group: u32,
    /// `@binding`.
    pub binding: u32,
    /// Name of the variable in the file that declares it; Rust binds by it.
    pub name: String,
    /// What may be bound.
    pub kind: BindingKind,
    /// Elements of a binding array; `None` for a single resource.
    pub count: Option<u32>,
}

/// The kind of a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BindingKind {
    /// `var<uniform>`.
    Uniform {
        /// Bytes.
        size: u32,
    },
    /// `var<storage>`.
    Storage {
        /// True for `read`, false for `read_write`.
        read_only: bool,
        /// Bytes; with a runtime-sized array, the bytes of one element included.
        size: u32,
    },
    /// A texture that is sampled or loaded from.
    Texture {
        /// 1D, 2D, 3D or cube.
        dimension: naga::ImageDimension,
        /// An array of layers.
        arrayed: bool,
        /// Several samples a texel.
        multisampled: bool,
        /// `Depth`, or the scalar kind of the texels.
        texels: Texels,
        /// True when an entry point reads it through a sampler (so that its format must be filterable if the sampler filters).
        sampled: bool,
    },
    /// `texture_storage_*`.
    StorageTexture {
        /// 1D, 2D or 3D.
        dimension: naga::ImageDimension,
        /// An array of layers.
        arrayed: bool,
        /// Texel format.
        format: naga::StorageFormat,
        /// Load, store or both.
        access: naga::StorageAccess,
    },
    /// `sampler` or `sampler_comparison`.
    Sampler {
        /// True for `sampler_comparison`.
        comparison: bool,
    },
    /// `acceleration_structure`.
    AccelerationStructure,
}

/// What a texture returns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Texels {
    /// `texture_*<f32>`.
    Float,
    /// `texture_*<i32>`.
    Sint,
    /// `texture_*<u32>`.
    Uint,
    /// `texture_depth_*`.
    Depth,
}

/// Shader stage of an entry point.
pub type Stage = naga::ShaderStage;

/// An entry point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EntryPoint {
    /// Function name.
    pub name: String,
    /// Vertex, fragment or compute.
    pub stage: Stage,
    /// Invocations of a work group; zeros outside compute.
    pub workgroup_size: [u32; 3],
    /// Names of the bindings it uses, itself or through a function it calls.
    pub bindings: Vec<String>,
}

/// An `override` constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Override {
    /// Name in the file that declares it.
    pub name: String,
    /// The key under which a pipeline sets it.
    pub key: String,
    /// Scalar type.
    pub scalar: naga::Scalar,
    /// Default, where it is a literal; booleans are 0 and 1.
    pub default: Option<f64>,
}

pub(crate) fn bindings(module: &naga::Module, info: &ModuleInfo, names: &Names) -> Vec<Binding> {
    let layouter = layouter(module);
    let used: BTreeSet<_> = (0..module.entry_points.len())
        .flat_map(|entry| module.global_variables.iter().filter(move |(handle, _)| !info.get_entry_point(entry)[*handle].is_empty()))
        .map(|(handle, _)| handle.index())
        .collect();
    let sampled: BTreeSet<_> =
        (0..module.entry_points.len()).flat_map(|entry| &info.get_entry_point(entry).sampling_set).map(|key| key.image.index()).collect();
    let mut bindings: Vec<Binding> = module
        .global_variables
        .iter()
        .filter(|(handle, _)| module.entry_points.is_empty() || used.contains(&handle.index()))
        .filter_map(|(handle, variable)| binding(module, &layouter, names, variable, sampled.contains(&handle.index())))
        .collect();
    bindings.sort_by_key(|binding| (binding.group, binding.binding));
    bindings
}

fn binding(module: &naga::Module, layouter: &Layouter, names: &Names, variable: &GlobalVariable, sampled: bool) -> Option<Binding> {
    let place = variable.binding?;
    let (ty, count) = match module.types[variable.ty].inner {
        TypeInner::BindingArray { base, size } => (base, Some(array_length(size))),
        _ => (variable.ty, None),
    };
    let size = layouter[ty].size;
    let kind = match (variable.space, &module.types[ty].inner) {
        (AddressSpace::Uniform, _) => BindingKind::Uniform { size },
        (AddressSpace::Storage { access }, _) => BindingKind::Storage { read_only: !access.contains(naga::StorageAccess::STORE), size },
        (_, &TypeInner::Image { dim, arrayed, class }) => image(dim, arrayed, class, sampled)?,
        (_, &TypeInner::Sampler { comparison }) => BindingKind::Sampler { comparison },
        (_, TypeInner::AccelerationStructure { .. }) => BindingKind::AccelerationStructure,
        _ => return None,
    };
    Some(Binding { group: place.group, binding: place.binding, name: variable_name(names, variable), kind, count })
}

/// The name in the file that declares it, also when that file is imported.
fn variable_name(names: &Names, variable: &GlobalVariable) -> String {
    variable.name.as_deref().map_or("", |name| names.original(name).1).to_owned()
}

fn image(dimension: naga::ImageDimension, arrayed: bool, class: ImageClass, sampled: bool) -> Option<BindingKind> {
    let (texels, multisampled) = match class {
        ImageClass::Storage { format, access } => return Some(BindingKind::StorageTexture { dimension, arrayed, format, access }),
        ImageClass::Depth { multi } => (Texels::Depth, multi),
        ImageClass::Sampled { kind: naga::ScalarKind::Sint, multi } => (Texels::Sint, multi),
        ImageClass::Sampled { kind: naga::ScalarKind::Uint, multi } => (Texels::Uint, multi),
        ImageClass::Sampled { multi, .. } => (Texels::Float, multi),
        ImageClass::External => return None,
    };
    Some(BindingKind::Texture { dimension, arrayed, multisampled, texels, sampled })
}

fn array_length(size: ArraySize) -> u32 {
    match size {
        ArraySize::Constant(count) => count.get(),
        ArraySize::Pending(_) | ArraySize::Dynamic => 0,
    }
}

pub(crate) fn entry_points(module: &naga::Module, info: &ModuleInfo, names: &Names, bindings: &[Binding]) -> Vec<EntryPoint> {
    let uses = |entry: usize, name: &str| {
        module
            .global_variables
            .iter()
            .any(|(handle, variable)| variable_name(names, variable) == name && !info.get_entry_point(entry)[handle].is_empty())
    };
    let entry_point = |(index, entry): (usize, &naga::EntryPoint)| EntryPoint {
        name: entry.name.clone(),
        stage: entry.stage,
        workgroup_size: entry.workgroup_size,
        bindings: bindings.iter().filter(|binding| uses(index, &binding.name)).map(|binding| binding.name.clone()).collect(),
    };
    module.entry_points.iter().enumerate().map(entry_point).collect()
}

/// Structs reachable from a uniform or storage buffer.
pub(crate) fn structs(module: &naga::Module, names: &Names) -> Vec<StructLayout> {
    let mut reached = BTreeSet::new();
    for (_, variable) in module.global_variables.iter() {
        if matches!(variable.space, AddressSpace::Uniform | AddressSpace::Storage { .. }) {
            reach(module, variable.ty, &mut reached);
        }
    }
    let layouter = layouter(module);
    let layout = |(handle, ty): (Handle<naga::Type>, &naga::Type)| {
        let TypeInner::Struct { members, span } = &ty.inner else { return None };
        let (path, name) = names.original(ty.name.as_deref()?);
        let fields = members
            .iter()
            .map(|member| FieldLayout {
                name: member.name.clone().unwrap_or_default(),
                offset: member.offset,
                size: layouter[member.ty].size,
            })
            .collect();
        let module = path.map(ToString::to_string);
        reached.contains(&handle.index()).then(|| StructLayout { name: name.to_owned(), module, size: *span, fields })
    };
    module.types.iter().filter_map(layout).collect()
}

fn reach(module: &naga::Module, ty: Handle<naga::Type>, reached: &mut BTreeSet<usize>) {
    reached.insert(ty.index());
    match &module.types[ty].inner {
        TypeInner::Struct { members, .. } => members.iter().for_each(|member| reach(module, member.ty, reached)),
        TypeInner::Array { base, .. } | TypeInner::BindingArray { base, .. } => reach(module, *base, reached),
        _ => {}
    }
}

pub(crate) fn overrides(module: &naga::Module, names: &Names) -> Vec<Override> {
    let constant = |(_, constant): (Handle<naga::Override>, &naga::Override)| {
        let linked = constant.name.clone()?;
        let TypeInner::Scalar(scalar) = module.types[constant.ty].inner else { return None };
        let default = constant.init.and_then(|init| match module.global_expressions[init] {
            naga::Expression::Literal(literal) => literal_value(literal),
            _ => None,
        });
        let key = constant.id.map_or_else(|| linked.clone(), |id| id.to_string());
        Some(Override { name: names.original(&linked).1.to_owned(), key, scalar, default })
    };
    module.overrides.iter().filter_map(constant).collect()
}

fn literal_value(literal: naga::Literal) -> Option<f64> {
    Some(match literal {
        naga::Literal::F32(value) => f64::from(value),
        naga::Literal::U32(value) => f64::from(value),
        naga::Literal::I32(value) => f64::from(value),
        naga::Literal::Bool(value) => f64::from(u8::from(value)),
        _ => return None,
    })
}

fn layouter(module: &naga::Module) -> Layouter {
    let mut layouter = Layouter::default();
    layouter.update(module.to_ctx()).expect("a validated module has a layout for every type");
    layouter
}
