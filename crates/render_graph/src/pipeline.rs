//! Pipelines from linked shaders: layouts come from reflection, resources are bound by name.

use crate::bind::{self, Bindings};
use crate::{Device, Error};
use kajo_shader_lib::{Binding, EntryPoint, Linked, Stage};

/// A linked shader, compiled for the device.
#[derive(Debug)]
pub struct Shader {
    linked: Linked,
    module: wgpu::ShaderModule,
}

impl Shader {
    /// Compiles what `link` made.
    ///
    /// # Errors
    /// When the linker or the device refuses it.
    pub fn new(device: &Device, linked: Result<Linked, kajo_shader_lib::ShaderError>) -> Result<Self, Error> {
        let linked = linked.map_err(|error| Error::Shader { name: "link".to_owned(), reason: error.to_string() })?;
        let source = wgpu::ShaderSource::Wgsl(linked.wgsl.as_str().into());
        let module = device.wgpu.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(&linked.name), source });
        device.check().map_err(|error| Error::Shader { name: linked.name.clone(), reason: error.to_string() })?;
        Ok(Self { linked, module })
    }

    fn entry(&self, name: &str) -> Result<&EntryPoint, Error> {
        self.linked.entry_point(name).map_err(|error| Error::Shader { name: self.linked.name.clone(), reason: error.to_string() })
    }

    /// Overrides in the form wgpu takes: by key.
    fn constants<'a>(&'a self, values: &[(&str, f64)]) -> Result<Vec<(&'a str, f64)>, Error> {
        values
            .iter()
            .map(|&(name, value)| {
                let found = self.linked.overrides.iter().find(|constant| constant.name == name);
                found.map(|constant| (constant.key.as_str(), value)).ok_or_else(|| Error::Shader {
                    name: self.linked.name.clone(),
                    reason: format!(
                        "no override `{name}`; it has: {:?}",
                        self.linked.overrides.iter().map(|o| &o.name).collect::<Vec<_>>()
                    ),
                })
            })
            .collect()
    }
}

/// What a pipeline is made with, beyond its shader.
#[derive(Clone, Copy, Debug, Default)]
pub struct PipelineOptions<'a> {
    /// Values of `override` constants.
    pub constants: &'a [(&'a str, f64)],
    /// Length of binding arrays whose length the shader leaves open.
    pub list_length: u32,
}

/// The layout of a pipeline, and the binding of resources to it.
#[derive(Debug)]
struct Interface {
    name: String,
    declared: Vec<Binding>,
    groups: Vec<wgpu::BindGroupLayout>,
    layout: wgpu::PipelineLayout,
}

impl Interface {
    fn new(device: &Device, shader: &Shader, entries: &[&EntryPoint], list_length: u32) -> Self {
        let declared: Vec<Binding> = shader
            .linked
            .bindings
            .iter()
            .filter(|binding| entries.iter().any(|entry| entry.bindings.contains(&binding.name)))
            .cloned()
            .collect();
        let stages = |binding: &Binding| {
            entries.iter().filter(|entry| entry.bindings.contains(&binding.name)).fold(wgpu::ShaderStages::NONE, |all, entry| {
                all | match entry.stage {
                    Stage::Vertex => wgpu::ShaderStages::VERTEX,
                    Stage::Fragment => wgpu::ShaderStages::FRAGMENT,
                    _ => wgpu::ShaderStages::COMPUTE,
                }
            })
        };
        let group_count = declared.iter().map(|binding| binding.group + 1).max().unwrap_or(0);
        let groups: Vec<wgpu::BindGroupLayout> = (0..group_count)
            .map(|group| {
                let entries: Vec<_> = declared
                    .iter()
                    .filter(|binding| binding.group == group)
                    .map(|binding| bind::layout_entry(binding, stages(binding), list_length))
                    .collect();
                device
                    .wgpu
                    .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(&shader.linked.name), entries: &entries })
            })
            .collect();
        let references: Vec<Option<&wgpu::BindGroupLayout>> = groups.iter().map(Some).collect();
        let layout = device.wgpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(&shader.linked.name),
            bind_group_layouts: &references,
            immediate_size: 0,
        });
        Self { name: shader.linked.name.clone(), declared, groups, layout }
    }

    fn bind(&self, device: &Device, shared: &Bindings, own: &Bindings) -> Result<Vec<wgpu::BindGroup>, Error> {
        let resources = bind::resolve(&self.name, &self.declared, shared, own)?;
        let of_group = |group: u32| {
            let entries: Vec<_> = self
                .declared
                .iter()
                .zip(&resources)
                .filter(|(binding, _)| binding.group == group)
                .map(|(binding, resource)| (binding.binding, *resource))
                .collect();
            bind::group(&device.wgpu, &self.groups[group as usize], &entries)
        };
        Ok((0..self.groups.len() as u32).map(of_group).collect())
    }
}

/// A compute pipeline.
#[derive(Debug)]
pub struct ComputePipeline {
    pipeline: wgpu::ComputePipeline,
    interface: Interface,
    workgroup: [u32; 3],
}

impl ComputePipeline {
    /// Makes the pipeline of one entry point.
    ///
    /// # Errors
    /// When the shader has no such entry point or override, or the device refuses it.
    pub fn new(device: &Device, shader: &Shader, entry: &str, options: PipelineOptions) -> Result<Self, Error> {
        let point = shader.entry(entry)?;
        let interface = Interface::new(device, shader, &[point], options.list_length);
        let constants = shader.constants(options.constants)?;
        let pipeline = device.wgpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(&interface.name),
            layout: Some(&interface.layout),
            module: &shader.module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() },
            cache: None,
        });
        device.check()?;
        Ok(Self { pipeline, workgroup: point.workgroup_size, interface })
    }

    /// Runs at least `invocations`, in whole work groups. Names in `own` must all be declared; `shared` may hold more.
    ///
    /// # Errors
    /// When a declared name is not bound, or a name of `own` is not declared.
    pub fn dispatch(
        &self,
        device: &Device,
        encoder: &mut wgpu::CommandEncoder,
        shared: &Bindings,
        own: &Bindings,
        invocations: glam::UVec3,
    ) -> Result<(), Error> {
        let groups = self.interface.bind(device, shared, own)?;
        let mut pass =
            encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(&self.interface.name), timestamp_writes: None });
        pass.set_pipeline(&self.pipeline);
        for (index, group) in groups.iter().enumerate() {
            pass.set_bind_group(index as u32, group, &[]);
        }
        let [x, y, z] = self.workgroup;
        pass.dispatch_workgroups(invocations.x.div_ceil(x), invocations.y.div_ceil(y), invocations.z.div_ceil(z));
        Ok(())
    }
}

/// State of a render pipeline beyond its shader.
#[derive(Clone, Debug)]
pub struct RenderState<'a> {
    /// Vertex entry point.
    pub vertex: &'a str,
    /// Fragment entry point; none for depth only.
    pub fragment: Option<&'a str>,
    /// Colour targets.
    pub targets: &'a [wgpu::ColorTargetState],
    /// Depth and stencil.
    pub depth: Option<wgpu::DepthStencilState>,
    /// Triangles and culling.
    pub primitive: wgpu::PrimitiveState,
}

/// A render pipeline.
#[derive(Debug)]
pub struct RenderPipeline {
    pipeline: wgpu::RenderPipeline,
    interface: Interface,
}

impl RenderPipeline {
    /// Makes the pipeline.
    ///
    /// # Errors
    /// When the shader has no such entry point or override, or the device refuses it.
    pub fn new(device: &Device, shader: &Shader, state: &RenderState, options: PipelineOptions) -> Result<Self, Error> {
        let mut points = vec![shader.entry(state.vertex)?];
        if let Some(fragment) = state.fragment {
            points.push(shader.entry(fragment)?);
        }
        let interface = Interface::new(device, shader, &points, options.list_length);
        let constants = shader.constants(options.constants)?;
        let compilation = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        let targets: Vec<_> = state.targets.iter().cloned().map(Some).collect();
        let pipeline = device.wgpu.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(&interface.name),
            layout: Some(&interface.layout),
            vertex: wgpu::VertexState {
                module: &shader.module,
                entry_point: Some(state.vertex),
                compilation_options: compilation.clone(),
                buffers: &[],
            },
            primitive: state.primitive,
            depth_stencil: state.depth.clone(),
            multisample: wgpu::MultisampleState::default(),
            fragment: state.fragment.map(|entry| wgpu::FragmentState {
                module: &shader.module,
                entry_point: Some(entry),
                compilation_options: compilation.clone(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        });
        device.check()?;
        Ok(Self { pipeline, interface })
    }

    /// Sets the pipeline and its resources, ready to draw. Names in `own` must all be declared; `shared` may hold more.
    ///
    /// # Errors
    /// When a declared name is not bound, or a name of `own` is not declared.
    pub fn set(&self, device: &Device, pass: &mut wgpu::RenderPass, shared: &Bindings, own: &Bindings) -> Result<(), Error> {
        let groups = self.interface.bind(device, shared, own)?;
        pass.set_pipeline(&self.pipeline);
        for (index, group) in groups.iter().enumerate() {
            pass.set_bind_group(index as u32, group, &[]);
        }
        Ok(())
    }
}
