//! A technique as data, and what it does once it is made.

use crate::{DebugView, Error, FrameContext, MakeContext, Needs, Role, Statistic};
use glam::Vec2;
use kajo_params::{ParamSpec, ParamValues};
use kajo_render_graph::{Device, Graph, Pool, Slot, Timings};
use kajo_scene::Ignored;

/// Makes a technique for one scene, with checked parameters.
pub type Make = fn(&MakeContext, &ParamValues) -> Result<Box<dyn Effect>, Error>;

/// A technique: what it is, and how it is made.
#[derive(Clone, Copy, Debug)]
pub struct Technique {
    /// `group/name`, the folder it stands in.
    pub id: &'static str,
    /// The role it fills.
    pub role: Role,
    /// Name for people.
    pub title: &'static str,
    /// Integral, equation, citation, limits; Markdown.
    pub doc: &'static str,
    /// Keys in `docs/references.bib`.
    pub cites: &'static [&'static str],
    /// Slots it reads.
    pub reads: &'static [Slot],
    /// What the device must have.
    pub needs: Needs,
    /// Its parameters.
    pub params: &'static [ParamSpec],
    /// Makes it for one scene.
    pub make: Make,
}

impl Technique {
    /// Makes it with checked parameters.
    ///
    /// # Errors
    /// [`Error::Needs`] when the device lacks something, or what making its shaders reports.
    pub fn build(&self, context: &MakeContext, params: &ParamValues) -> Result<Box<dyn Effect>, Error> {
        match self.missing(context.device) {
            Some(needs) => Err(Error::Needs { technique: self.id, needs }),
            None => (self.make)(context, params),
        }
    }

    /// Reads its parameters; what is not given keeps its default.
    ///
    /// # Errors
    /// [`Error::Param`] for unknown names and values out of range.
    pub fn parse_params(&self, pairs: &[(&str, &str)]) -> Result<ParamValues, Error> {
        ParamValues::from_pairs(self.params, pairs).map_err(|source| Error::Param { technique: self.id, source })
    }

    /// What `device` lacks for it, in words.
    pub fn missing(&self, device: &Device) -> Option<String> {
        self.needs.missing(device)
    }
}

/// A technique at work on one scene.
pub trait Effect {
    /// Makes or resizes what it keeps, and uploads what changes with the frame; before [`Self::record`] of each group of lights.
    ///
    /// # Errors
    /// When the device refuses.
    fn prepare(&mut self, frame: &FrameContext) -> Result<(), Error>;

    /// Does what takes executions of its own before the passes of [`Self::record`]: for techniques that run others. `pool` holds the G-buffer.
    ///
    /// # Errors
    /// When the device refuses or is lost.
    fn run(&mut self, _frame: &FrameContext, _pool: &Pool) -> Result<Timings, Error> {
        Ok(Timings::default())
    }

    /// Adds its passes to the graph.
    fn record<'a>(&'a self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>);

    /// Where in its pixels frame `index` is to be sampled, from their centres, px, x right and y down: techniques of the role anti-alias choose.
    fn jitter(&self, _index: u32) -> Vec2 {
        Vec2::ZERO
    }

    /// Frames after which its output has forgotten how it began; 0 for techniques that keep nothing from frame to frame. What is kept belongs
    /// to the frame before: where numbers of frames do not follow each other it begins anew.
    fn history(&self) -> u32 {
        0
    }

    /// Role specular indirect: the greatest perceptual roughness at which its output shows emissive meshes. Surfaces up to it get no highlights of
    /// them as direct light, which would count them twice.
    fn mirrors_up_to(&self) -> Option<f32> {
        None
    }

    /// Rays traced since it was made, where it traces any. Waits for the device.
    ///
    /// # Errors
    /// When the device is lost.
    fn rays(&self, _device: &Device) -> Result<u64, Error> {
        Ok(0)
    }

    /// What it counted for the lights of the group, after its passes ran. Waits for the device.
    ///
    /// # Errors
    /// When the device is lost.
    fn statistics(&self, _frame: &FrameContext) -> Result<Vec<Statistic>, Error> {
        Ok(Vec::new())
    }

    /// Pictures of its inner workings for the lights of the group, after its passes ran. Asked for only where [`FrameContext::debug`] was set when
    /// they were recorded.
    ///
    /// # Errors
    /// When the device is lost.
    fn debug_views(&self, _frame: &FrameContext) -> Result<Vec<DebugView>, Error> {
        Ok(Vec::new())
    }

    /// What of the scene it took otherwise than it is, for the user to know; after [`Self::prepare`].
    fn notes(&self) -> Vec<Ignored> {
        Vec::new()
    }
}
