//! Images that a technique keeps from frame to frame.

use crate::FrameContext;
use kajo_render_graph::Texture;
use kajo_render_graph::wgpu;

/// Two sets of images that take turns: what the frame before left, and what this one leaves.
pub(super) struct History {
    formats: &'static [wgpu::TextureFormat],
    sets: [Vec<Texture>; 2],
    /// Number of the last frame, and whether it had one before it.
    last: Option<(u32, bool)>,
    /// The set that this frame fills.
    turn: usize,
}

impl History {
    /// An image of each format; none is made yet.
    pub fn new(formats: &'static [wgpu::TextureFormat]) -> Self {
        Self { formats, sets: [vec![], vec![]], last: None, turn: 0 }
    }

    /// Makes room for a frame, once each time it is prepared; true where [`Self::before`] holds the frame before it. A frame that is rendered
    /// again finds what it found the first time.
    pub fn begin(&mut self, frame: &FrameContext) -> bool {
        let size = frame.size();
        let fits = |set: &Vec<Texture>| {
            set.len() == self.formats.len() && set.iter().all(|texture| texture.wgpu.width() == size.x && texture.wgpu.height() == size.y)
        };
        if !self.sets.iter().all(fits) {
            self.sets = [(); 2].map(|()| self.formats.iter().map(|format| image(frame, *format)).collect());
            self.last = None;
        }
        let follows = match self.last {
            Some((last, follows)) if last == frame.index => follows,
            last => {
                self.turn = 1 - self.turn;
                last.is_some_and(|(last, _)| last.wrapping_add(1) == frame.index)
            }
        };
        self.last = Some((frame.index, follows));
        follows
    }

    /// What the frame before left; anything where there was none.
    pub fn before(&self) -> &[Texture] {
        &self.sets[1 - self.turn]
    }

    /// What this frame leaves.
    pub fn after(&self) -> &[Texture] {
        &self.sets[self.turn]
    }
}

fn image(frame: &FrameContext, format: wgpu::TextureFormat) -> Texture {
    let size = frame.size();
    use wgpu::TextureUsages as Usage;
    frame.device.texture(&wgpu::TextureDescriptor {
        label: Some("history"),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: Usage::STORAGE_BINDING | Usage::RENDER_ATTACHMENT | Usage::TEXTURE_BINDING | Usage::COPY_SRC,
        view_formats: &[],
    })
}
