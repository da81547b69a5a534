//! The graph of one execution: passes with their slots, and the pool of images behind the slots.

use crate::order::{Access, order};
use crate::timer::{Timer, Timings};
use crate::{Device, Error, Layers, Slot, Texture};
use glam::UVec2;
use std::collections::HashMap;
use std::sync::Arc;

/// The images behind slots, kept from frame to frame. All have the size of the frame.
#[derive(Debug, Default)]
pub struct Pool {
    size: UVec2,
    lights: u32,
    textures: HashMap<&'static str, Arc<Texture>>,
    /// Slots whose images are not its own.
    lent: Vec<&'static str>,
}

impl Pool {
    /// A pool for frames of `size`, with `lights` layers where a slot has one for each light. No image is made yet.
    pub fn new(size: UVec2, lights: u32) -> Self {
        Self { size, lights: lights.max(1), ..Self::default() }
    }

    /// Size of every image, px.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Layers of the slots that have one for each light.
    pub fn lights(&self) -> u32 {
        self.lights
    }

    /// The image of a slot, if a pass has made it.
    pub fn get(&self, slot: Slot) -> Option<&Texture> {
        self.textures.get(slot.name).map(Arc::as_ref)
    }

    /// Takes over the images that `other`, a pool for frames of the same size, has for these slots: both hold the same ones.
    pub fn share(&mut self, other: &Self, slots: &[Slot]) {
        debug_assert_eq!(self.size, other.size);
        for slot in slots {
            if let Some(texture) = other.textures.get(slot.name) {
                self.textures.insert(slot.name, texture.clone());
            }
        }
    }

    /// Puts `lent` images behind their slots. Of `written` slots, those that held one before and are lent none now get an image of their own again.
    fn borrow<'s>(&mut self, lent: Vec<(Slot, Arc<Texture>)>, written: impl Iterator<Item = &'s Slot>) {
        for slot in written {
            if let Some(at) = self.lent.iter().position(|name| *name == slot.name) {
                self.lent.swap_remove(at);
                self.textures.remove(slot.name);
            }
        }
        for (slot, texture) in lent {
            self.textures.insert(slot.name, texture);
            self.lent.push(slot.name);
        }
    }

    /// Makes the image of a slot, if it is not there.
    pub fn make(&mut self, device: &Device, slot: Slot) {
        let layers = match slot.layers {
            Layers::One => 1,
            Layers::PerLight => self.lights,
        };
        let size = self.size;
        self.textures.entry(slot.name).or_insert_with(|| {
            let depth = slot.format.is_depth_stencil_format();
            let storage = matches!(
                slot.format,
                wgpu::TextureFormat::R32Float
                    | wgpu::TextureFormat::Rgba16Float
                    | wgpu::TextureFormat::Rgba32Float
                    | wgpu::TextureFormat::Rgba8Unorm
            );
            let mut usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
            if !depth {
                usage |= wgpu::TextureUsages::COPY_DST;
            }
            if storage && !depth {
                usage |= wgpu::TextureUsages::STORAGE_BINDING;
            }
            Arc::new(device.texture(&wgpu::TextureDescriptor {
                label: Some(slot.name),
                size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: layers },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: slot.format,
                usage,
                view_formats: &[],
            }))
        });
    }
}

type Run<'a> = Box<dyn FnOnce(&mut PassContext) -> Result<(), Error> + 'a>;

/// Passes to be ordered and run once.
#[derive(Default)]
pub struct Graph<'a> {
    accesses: Vec<Access>,
    runs: Vec<Run<'a>>,
    imported: Vec<Slot>,
    lent: Vec<(Slot, Arc<Texture>)>,
}

impl<'a> Graph<'a> {
    /// No passes.
    pub fn new() -> Self {
        Self::default()
    }

    /// Says that the image of `slot` was made by an earlier execution.
    pub fn import(&mut self, slots: &[Slot]) {
        self.imported.extend(slots);
    }

    /// Puts an image in the place of the pool's own, until another graph writes `slot`: the pass that writes it now leaves what its technique keeps, without a copy. It has the
    /// format of the slot and the size of the frame.
    pub fn lend(&mut self, slot: Slot, texture: Arc<Texture>) {
        debug_assert_eq!(texture.wgpu.format(), slot.format);
        self.lent.push((slot, texture));
    }

    /// Adds a pass: what it touches, and what it does.
    pub fn pass(&mut self, access: Access, run: impl FnOnce(&mut PassContext) -> Result<(), Error> + 'a) {
        self.accesses.push(access);
        self.runs.push(Box::new(run));
    }

    /// Adds a pass that makes the image of `slot` and fills its first layer with `value`.
    pub fn clear(&mut self, name: &str, slot: Slot, value: wgpu::Color) {
        self.pass(Access::new(name).writes(&[slot]), move |pass| {
            let view = pass.view(slot)?;
            let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(value), store: wgpu::StoreOp::Store };
            pass.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(&pass.access.name),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment { view: &view, depth_slice: None, resolve_target: None, ops })],
                ..Default::default()
            });
            Ok(())
        });
    }

    /// Slots that the passes whose names start with `prefix` make.
    pub fn written_by(&self, prefix: &str) -> Vec<Slot> {
        self.accesses.iter().filter(|access| access.name.starts_with(prefix)).flat_map(|access| &access.writes).copied().collect()
    }

    /// Orders and runs the passes, waits for the device, and says how long each took.
    ///
    /// # Errors
    /// When there is no order, a pass fails, or the device is lost.
    pub fn execute(self, device: &Device, pool: &mut Pool) -> Result<Timings, Error> {
        let order = order(&self.accesses, &self.imported)?;
        pool.borrow(self.lent, self.accesses.iter().flat_map(|access| &access.writes));
        for slot in self.accesses.iter().flat_map(|access| &access.writes) {
            pool.make(device, *slot);
        }
        let mut runs: Vec<Option<Run>> = self.runs.into_iter().map(Some).collect();
        let mut timer = Timer::new(device, order.len());
        let mut encoder = device.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("graph") });
        for index in order {
            let access = &self.accesses[index];
            let run = runs[index].take().expect("each pass runs once");
            let _span = tracing::trace_span!("pass", name = access.name).entered();
            encoder.push_debug_group(&access.name);
            timer.begin(&mut encoder, &access.name);
            run(&mut PassContext { device, access, pool, encoder: &mut encoder })?;
            timer.end(device, &mut encoder)?;
            encoder.pop_debug_group();
        }
        timer.resolve(&mut encoder);
        device.queue.submit([encoder.finish()]);
        device.check()?;
        timer.read(device)
    }
}

/// What a running pass sees.
pub struct PassContext<'c> {
    /// The device.
    pub device: &'c Device,
    /// Commands go here.
    pub encoder: &'c mut wgpu::CommandEncoder,
    access: &'c Access,
    pool: &'c Pool,
}

impl PassContext<'_> {
    /// Size of the frame, px.
    pub fn size(&self) -> UVec2 {
        self.pool.size
    }

    /// The image of a slot that the pass declared.
    ///
    /// # Errors
    /// When it did not declare it, or nothing has made it.
    pub fn texture(&self, slot: Slot) -> Result<&Texture, Error> {
        let declared = self.access.touched();
        let undeclared = || Error::Undeclared { pass: self.access.name.clone(), slot: slot.name, declared: declared.clone() };
        if !declared.contains(&slot.name) {
            return Err(undeclared());
        }
        self.pool.get(slot).ok_or_else(|| Error::NoProducer {
            pass: self.access.name.clone(),
            slot: slot.name,
            written: self.pool.textures.keys().copied().collect(),
        })
    }

    /// The view of a slot that the pass declared: of all its layers where it has one for each light.
    ///
    /// # Errors
    /// As [`Self::texture`].
    pub fn view(&self, slot: Slot) -> Result<wgpu::TextureView, Error> {
        let texture = self.texture(slot)?;
        Ok(match slot.layers {
            Layers::One => texture.view.clone(),
            Layers::PerLight => texture.array(),
        })
    }
}
