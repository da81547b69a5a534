//! The picture that a technique keeps from frame to frame.

use crate::FrameContext;
use kajo_render_graph::wgpu::{self, TextureUsages};
use kajo_render_graph::{Texture, slot};
use std::sync::Arc;

/// Two images that take turns: the picture that the frame before left, and the one that this frame leaves, which is lent to
/// [`slot::RESOLVED`]. The fourth channel is the technique's own.
#[derive(Default)]
pub(super) struct History {
    images: Option<[Arc<Texture>; 2]>,
    /// Number of the last frame, and whether it had one before it.
    last: Option<(u32, bool)>,
    /// The image that this frame fills.
    turn: usize,
}

impl History {
    /// Makes room for a frame, once each time it is prepared; true where [`Self::before`] holds the frame before it. A frame that is rendered
    /// again finds what it found the first time.
    pub fn begin(&mut self, frame: &FrameContext) -> bool {
        let size = frame.size();
        let fits = |image: &Arc<Texture>| image.wgpu.width() == size.x && image.wgpu.height() == size.y;
        if !self.images.as_ref().is_some_and(|images| images.iter().all(fits)) {
            self.images = Some([(); 2].map(|()| Arc::new(image(frame))));
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
    pub fn before(&self) -> &Arc<Texture> {
        self.image(1 - self.turn)
    }

    /// What this frame leaves.
    pub fn after(&self) -> &Arc<Texture> {
        self.image(self.turn)
    }

    fn image(&self, turn: usize) -> &Arc<Texture> {
        &self.images.as_ref().expect("prepared before it is recorded")[turn]
    }
}

fn image(frame: &FrameContext) -> Texture {
    let size = frame.size();
    frame.device.texture(&wgpu::TextureDescriptor {
        label: Some("history"),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: slot::RESOLVED.format,
        usage: TextureUsages::STORAGE_BINDING | TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}
