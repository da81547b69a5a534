//! The device: which adapter, with which features, and what has gone wrong on it.
//!
//! Every optional feature that the adapter has is switched on; a technique asks [`Device::features`] through its needs. Errors that
//! the device reports later (validation, loss) are kept and returned by [`Device::check`], so that none ends in a panic.

use crate::Error;
use crate::memory::{Buffer, Memory, Texture};
use std::sync::{Arc, Mutex};
use wgpu::{Features, Limits};

/// Features that are used where they are there; nothing requires one of them.
const WANTED: [Features; 9] = [
    Features::EXPERIMENTAL_RAY_QUERY,
    Features::TIMESTAMP_QUERY,
    Features::TIMESTAMP_QUERY_INSIDE_ENCODERS,
    Features::TEXTURE_BINDING_ARRAY,
    Features::SAMPLED_TEXTURE_AND_STORAGE_BUFFER_ARRAY_NON_UNIFORM_INDEXING,
    Features::FLOAT32_FILTERABLE,
    Features::FLOAT32_BLENDABLE,
    Features::DEPTH_CLIP_CONTROL,
    Features::DEPTH32FLOAT_STENCIL8,
];

/// Which adapter to take.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum AdapterChoice {
    /// `KAJO_ADAPTER` when it is set (`hardware`, `software`, or part of a name), else hardware first.
    #[default]
    Auto,
    /// A graphics processor.
    Hardware,
    /// A software rasteriser.
    Software,
    /// An adapter whose name contains this, whatever the case.
    Name(String),
}

/// What the report says about the device.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceInfo {
    /// Name of the adapter.
    pub name: String,
    /// Name and version of the driver.
    pub driver: String,
    /// `discrete`, `integrated`, `virtual`, `software` or `other`.
    pub kind: &'static str,
    /// `vulkan`, `metal`, `dx12`, …
    pub backend: String,
    /// Hardware or driver ray queries.
    pub ray_query: bool,
    /// Timers on the device; otherwise passes are timed from outside.
    pub timestamps: bool,
    /// Largest side of an image, px.
    pub max_image_side: u32,
    /// Largest buffer a shader can see, bytes.
    pub max_buffer_bytes: u64,
    /// Textures a material shader can choose from; 0 where it cannot choose.
    pub max_bindless_textures: u32,
}

/// An open device and its queue. Cloning shares it.
#[derive(Clone, Debug)]
pub struct Device {
    /// The device.
    pub wgpu: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    info: DeviceInfo,
    memory: Memory,
    trouble: Arc<Mutex<Option<Error>>>,
}

impl Device {
    /// Opens the adapter that [`AdapterChoice::Auto`] takes.
    ///
    /// # Errors
    /// When no adapter answers, none matches `KAJO_ADAPTER`, or its driver gives no device.
    pub fn new() -> Result<Self, Error> {
        Self::open(&AdapterChoice::Auto)
    }

    /// Opens an adapter with every feature of it that Kajo can use.
    ///
    /// # Errors
    /// When no adapter answers, none matches, or its driver gives no device.
    pub fn open(choice: &AdapterChoice) -> Result<Self, Error> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        let adapter = choose(adapters, choice)?;
        let features = WANTED.iter().fold(Features::empty(), |all, &one| all | (adapter.features() & one));
        let request = wgpu::DeviceDescriptor {
            label: Some("kajo"),
            required_features: features,
            required_limits: adapter.limits(),
            // SAFETY: only ray queries are experimental here; shaders that use them go through the validation of naga.
            experimental_features: unsafe { wgpu::ExperimentalFeatures::enabled() },
            ..Default::default()
        };
        let (wgpu, queue) = pollster::block_on(adapter.request_device(&request))
            .map_err(|reason| Error::NoDevice { adapter: adapter.get_info().name, reason: reason.to_string() })?;

        let trouble = Arc::new(Mutex::new(None));
        let keep_first = |slot: &Arc<Mutex<Option<Error>>>| {
            let slot = slot.clone();
            move |error: Error| {
                // The first one is passed on; those that follow from it are for whoever looks into it.
                tracing::debug!("{error}");
                slot.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).get_or_insert(error);
            }
        };
        // A loss explains whatever was refused before it.
        let lost = trouble.clone();
        wgpu.set_device_lost_callback(move |_, reason| {
            *lost.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = Some(Error::DeviceLost { reason });
        });
        let refused = keep_first(&trouble);
        wgpu.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            refused(match error {
                wgpu::Error::OutOfMemory { .. } => Error::OutOfMemory,
                other => Error::Refused { reason: other.to_string() },
            });
        }));

        let info = describe(&adapter, features, &wgpu.limits());
        tracing::debug!(?info, "opened device");
        Ok(Self { wgpu, queue, info, memory: Memory::default(), trouble })
    }

    /// Every adapter that answers, the one that [`AdapterChoice::Auto`] takes without `KAJO_ADAPTER` first. Opens none.
    pub fn list() -> Vec<DeviceInfo> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        adapters.sort_by_key(|adapter| rank(adapter.get_info().device_type));
        adapters.iter().map(|adapter| describe(adapter, adapter.features(), &adapter.limits())).collect()
    }

    /// Adapter, driver and limits, for the report.
    pub fn info(&self) -> &DeviceInfo {
        &self.info
    }

    /// Features that are switched on.
    pub fn features(&self) -> Features {
        self.wgpu.features()
    }

    /// True when ray queries can be used.
    pub fn has_ray_query(&self) -> bool {
        self.info.ray_query
    }

    /// True when a shader can choose a texture by number.
    pub fn has_bindless_textures(&self) -> bool {
        self.info.max_bindless_textures > 0
    }

    /// Bytes of the textures and buffers that are alive.
    pub fn memory_bytes(&self) -> u64 {
        self.memory.bytes()
    }

    /// The same device with a count of its own: what is made with it is counted there, and here too.
    pub fn counting_apart(&self) -> Self {
        Self { memory: self.memory.part(), ..self.clone() }
    }

    /// Makes a texture that is counted in [`Self::memory_bytes`].
    pub fn texture(&self, desc: &wgpu::TextureDescriptor<'_>) -> Texture {
        Texture::new(&self.wgpu, &self.memory, desc)
    }

    /// Makes a buffer that is counted in [`Self::memory_bytes`]; `size` is rounded up to 16 bytes, and never 0.
    ///
    /// # Errors
    /// When it is larger than the adapter allows.
    pub fn buffer(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> Result<Buffer, Error> {
        let limits = self.wgpu.limits();
        let limit = if usage.contains(wgpu::BufferUsages::STORAGE) {
            limits.max_buffer_size.min(limits.max_storage_buffer_binding_size)
        } else {
            limits.max_buffer_size
        };
        if size > limit {
            return Err(Error::TooLarge { what: label.to_owned(), got: size, limit });
        }
        Ok(Buffer::new(&self.wgpu, &self.memory, label, size, usage))
    }

    /// Makes a buffer from `data`.
    ///
    /// # Errors
    /// When it is larger than the adapter allows.
    pub fn buffer_with<T: bytemuck::NoUninit>(&self, label: &str, data: &[T], usage: wgpu::BufferUsages) -> Result<Buffer, Error> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let buffer = self.buffer(label, bytes.len() as u64, usage | wgpu::BufferUsages::COPY_DST)?;
        buffer.write(&self.queue, bytes);
        Ok(buffer)
    }

    /// Makes a uniform buffer from a struct, laid out as the shader sees it.
    ///
    /// # Errors
    /// When it is larger than the adapter allows.
    pub fn uniform<T: encase::ShaderType + encase::internal::WriteInto>(&self, label: &str, value: &T) -> Result<Buffer, Error> {
        let bytes = uniform_bytes(value);
        let buffer = self.buffer(label, bytes.len() as u64, wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST)?;
        buffer.write(&self.queue, &bytes);
        Ok(buffer)
    }

    /// Checks that an image of this size can be rendered.
    ///
    /// # Errors
    /// [`Error::Size`] when a side is 0 or larger than the adapter's limit.
    pub fn check_size(&self, size: glam::UVec2) -> Result<(), Error> {
        let limit = self.info.max_image_side;
        if size.min_element() == 0 || size.max_element() > limit {
            return Err(Error::Size { width: size.x, height: size.y, limit });
        }
        Ok(())
    }

    /// Waits until everything submitted is done.
    ///
    /// # Errors
    /// The first trouble that the device reported since the last check.
    pub fn wait(&self) -> Result<(), Error> {
        let polled = self.wgpu.poll(wgpu::PollType::wait_indefinitely());
        self.check()?;
        polled.map(|_| ()).map_err(|reason| Error::DeviceLost { reason: reason.to_string() })
    }

    /// Returns the first trouble that the device reported since the last check.
    ///
    /// # Errors
    /// [`Error::DeviceLost`] or [`Error::Refused`].
    pub fn check(&self) -> Result<(), Error> {
        match self.trouble.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).take() {
            Some(error) => Err(error),
            None => Ok(()),
        }
    }
}

/// The bytes of a struct in the layout of a WGSL uniform.
pub fn uniform_bytes<T: encase::ShaderType + encase::internal::WriteInto>(value: &T) -> Vec<u8> {
    let mut buffer = encase::UniformBuffer::new(Vec::new());
    buffer.write(value).expect("a Vec grows as it is written");
    buffer.into_inner()
}

/// Takes the best adapter that matches: discrete, integrated, virtual, other, software.
fn choose(adapters: Vec<wgpu::Adapter>, choice: &AdapterChoice) -> Result<wgpu::Adapter, Error> {
    if adapters.is_empty() {
        return Err(Error::NoAdapter);
    }
    let from_environment = match std::env::var("KAJO_ADAPTER") {
        Ok(name) if *choice == AdapterChoice::Auto && !name.is_empty() => Some(parse(&name)),
        _ => None,
    };
    let choice = from_environment.as_ref().unwrap_or(choice);
    let infos: Vec<_> = adapters.iter().map(wgpu::Adapter::get_info).collect();
    let best = (0..adapters.len()).filter(|&i| matches(&infos[i], choice)).min_by_key(|&i| rank(infos[i].device_type));
    match best {
        Some(i) => Ok(adapters.into_iter().nth(i).expect("an index into the list")),
        None => Err(Error::NoSuchAdapter { wanted: name(choice), found: infos.into_iter().map(|info| info.name).collect() }),
    }
}

fn parse(text: &str) -> AdapterChoice {
    match text.to_lowercase().as_str() {
        "hardware" => AdapterChoice::Hardware,
        "software" => AdapterChoice::Software,
        _ => AdapterChoice::Name(text.to_owned()),
    }
}

fn name(choice: &AdapterChoice) -> String {
    match choice {
        AdapterChoice::Auto => "any".to_owned(),
        AdapterChoice::Hardware => "hardware".to_owned(),
        AdapterChoice::Software => "software".to_owned(),
        AdapterChoice::Name(name) => name.clone(),
    }
}

fn matches(info: &wgpu::AdapterInfo, choice: &AdapterChoice) -> bool {
    match choice {
        AdapterChoice::Auto => true,
        AdapterChoice::Hardware => info.device_type != wgpu::DeviceType::Cpu,
        AdapterChoice::Software => info.device_type == wgpu::DeviceType::Cpu,
        AdapterChoice::Name(name) => info.name.to_lowercase().contains(&name.to_lowercase()),
    }
}

fn rank(kind: wgpu::DeviceType) -> u32 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

fn describe(adapter: &wgpu::Adapter, features: Features, limits: &Limits) -> DeviceInfo {
    let info = adapter.get_info();
    let bindless = Features::TEXTURE_BINDING_ARRAY | Features::SAMPLED_TEXTURE_AND_STORAGE_BUFFER_ARRAY_NON_UNIFORM_INDEXING;
    DeviceInfo {
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        kind: match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete",
            wgpu::DeviceType::IntegratedGpu => "integrated",
            wgpu::DeviceType::VirtualGpu => "virtual",
            wgpu::DeviceType::Cpu => "software",
            wgpu::DeviceType::Other => "other",
        },
        backend: info.backend.to_string(),
        name: info.name,
        ray_query: features.contains(Features::EXPERIMENTAL_RAY_QUERY),
        timestamps: features.contains(Features::TIMESTAMP_QUERY | Features::TIMESTAMP_QUERY_INSIDE_ENCODERS),
        max_image_side: limits.max_texture_dimension_2d,
        max_buffer_bytes: limits.max_storage_buffer_binding_size.min(limits.max_buffer_size),
        max_bindless_textures: if features.contains(bindless) { limits.max_binding_array_elements_per_shader_stage } else { 0 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_adapter_answers_and_says_what_it_is() {
        let device = Device::new().unwrap();
        assert!(!device.info().name.is_empty() && device.info().max_image_side >= 2048, "{:?}", device.info());
    }

    #[test]
    fn an_unknown_adapter_is_refused_with_the_list() {
        let error = Device::open(&AdapterChoice::Name("no such adapter".into())).unwrap_err();
        assert!(error.to_string().contains("no such adapter\"; there are: "), "{error}");
    }

    #[test]
    fn no_adapter_says_what_to_run() {
        let error = choose(Vec::new(), &AdapterChoice::Auto).unwrap_err();
        assert!(error.to_string().contains("cargo xtask setup"), "{error}");
    }

    #[test]
    fn sizes_outside_the_limit_are_refused() {
        let device = Device::new().unwrap();
        let limit = device.info().max_image_side;
        for bad in [glam::uvec2(0, 4), glam::uvec2(4, 0), glam::uvec2(limit + 1, 4)] {
            assert!(matches!(device.check_size(bad), Err(Error::Size { .. })), "{bad}");
        }
        for good in [glam::uvec2(1, 1), glam::uvec2(limit, 1), glam::uvec2(33, 17)] {
            assert!(device.check_size(good).is_ok(), "{good}");
        }
    }

    #[test]
    fn a_refused_command_is_an_error_and_not_a_panic() {
        let device = Device::new().unwrap();
        let _ = device.wgpu.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::MAX / 2,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        assert!(device.wait().is_err());
        assert!(device.wait().is_ok(), "an error is reported once");
    }

    #[test]
    fn a_destroyed_device_is_an_error_and_not_a_panic() {
        let device = Device::new().unwrap();
        device.wgpu.destroy();
        assert!(matches!(device.wait(), Err(Error::DeviceLost { .. })));
    }

    #[test]
    fn memory_counts_what_is_alive() {
        let device = Device::new().unwrap();
        let before = device.memory_bytes();
        let buffer = device.buffer("test", 1024, wgpu::BufferUsages::STORAGE).unwrap();
        assert_eq!(device.memory_bytes() - before, 1024);
        drop(buffer);
        assert_eq!(device.memory_bytes(), before);
    }

    #[test]
    fn a_part_is_counted_apart_and_in_the_whole() {
        let device = Device::new().unwrap();
        let (one, other) = (device.counting_apart(), device.counting_apart());
        let bytes = || [&device, &one, &other].map(Device::memory_bytes);
        let size = wgpu::Extent3d { width: 8, height: 4, depth_or_array_layers: 3 };
        let texture = one.texture(&wgpu::TextureDescriptor {
            label: None,
            size,
            mip_level_count: 2,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        // Three layers of 8 × 4 and 4 × 2 texels of four bytes.
        assert_eq!(bytes(), [480, 480, 0]);
        let buffer = other.buffer("test", 100, wgpu::BufferUsages::STORAGE).unwrap();
        assert_eq!(bytes(), [592, 480, 112]);
        drop(texture);
        assert_eq!(bytes(), [112, 0, 112]);
        drop(buffer);
        assert_eq!(bytes(), [0; 3]);
    }
}
