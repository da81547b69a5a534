//! The techniques at work in a renderer.

use crate::Error;
use crate::settings::{Choice, RoleSelection};
use kajo_render_graph::{Device, Graph, Pool, Slot, Texture, Timings};
use kajo_techniques::{DebugView, Effect, FrameContext, MakeContext, Role, Statistic};

/// A technique at work, with a device that counts its memory.
pub(crate) struct Made {
    pub choice: Choice,
    pub device: Device,
    pub effect: Box<dyn Effect>,
    /// What was chosen for all roles in its last frame.
    pub beside: Option<RoleSelection>,
    /// Slots that its passes made in its last frame.
    written: Vec<Slot>,
    /// Rays traced until its last frame ended.
    rays_before: u64,
}

/// The techniques of a frame.
pub(crate) struct Effects {
    pub shadow: Made,
    pub ambient: Made,
    pub diffuse: Made,
    pub specular: Made,
    pub anti_alias: Made,
    pub tone: Made,
}

/// What techniques said of themselves in a frame.
#[derive(Default)]
pub(crate) struct Insight {
    pub statistics: Vec<Statistic>,
    pub debug: Vec<DebugView>,
}

impl Made {
    pub fn new(choice: Choice, device: Device, context: &MakeContext) -> Result<Self, Error> {
        let effect = choice.technique.build(context, &choice.params)?;
        Ok(Self { choice, device, effect, beside: None, written: Vec::new(), rays_before: 0 })
    }

    /// Adds its passes to the graph, and remembers what they make.
    pub fn record<'a>(&'a mut self, frame: &'a FrameContext<'a>, graph: &mut Graph<'a>) {
        self.effect.record(frame, graph);
        self.written = graph.written_by(self.choice.technique.id);
    }

    /// Prepares, and runs what takes executions of its own.
    pub fn prepare(&mut self, frame: &FrameContext, pool: &Pool) -> Result<Timings, Error> {
        self.effect.prepare(frame)?;
        Ok(self.effect.run(frame, pool)?)
    }

    /// Adds what it tells after its passes ran.
    pub fn tell(&self, frame: &FrameContext, insight: &mut Insight) -> Result<(), Error> {
        insight.statistics.extend(self.effect.statistics(frame)?);
        if frame.debug {
            insight.debug.extend(self.effect.debug_views(frame)?);
        }
        Ok(())
    }
}

impl Effects {
    /// Those that `take` gives for each role.
    pub fn take(mut take: impl FnMut(Role) -> Result<Made, Error>) -> Result<Self, Error> {
        Ok(Self {
            shadow: take(Role::DirectVisibility)?,
            ambient: take(Role::AmbientVisibility)?,
            diffuse: take(Role::DiffuseIndirect)?,
            specular: take(Role::SpecularIndirect)?,
            anti_alias: take(Role::AntiAlias)?,
            tone: take(Role::ToneMap)?,
        })
    }

    fn all(&self) -> [&Made; 6] {
        [&self.shadow, &self.ambient, &self.diffuse, &self.specular, &self.anti_alias, &self.tone]
    }

    /// All of them, to be kept.
    pub fn into_all(self) -> [Made; 6] {
        [self.shadow, self.ambient, self.diffuse, self.specular, self.anti_alias, self.tone]
    }

    /// Rays of the frame, by technique.
    pub fn rays(&mut self, device: &Device) -> Result<Vec<(&'static str, u64)>, Error> {
        let all = [&mut self.shadow, &mut self.ambient, &mut self.diffuse, &mut self.specular, &mut self.anti_alias, &mut self.tone];
        let of = |made: &mut Made| {
            let rays = made.effect.rays(device)?;
            Ok((made.choice.technique.id, rays - std::mem::replace(&mut made.rays_before, rays)))
        };
        all.into_iter().map(of).collect()
    }

    /// By technique, the bytes of what it keeps and of the slots that its passes make.
    pub fn bytes(&self, pool: &Pool) -> Vec<(&'static str, u64)> {
        let slots = |made: &Made| -> u64 { made.written.iter().filter_map(|slot| pool.get(*slot)).map(Texture::bytes).sum() };
        self.all().iter().map(|made| (made.choice.technique.id, made.device.memory_bytes() + slots(made))).collect()
    }

    /// What they took otherwise than the scene is.
    pub fn notes(&self) -> impl Iterator<Item = kajo_scene::Ignored> {
        self.all().into_iter().flat_map(|made| made.effect.notes())
    }
}
