//! What a build is asked for.

use crate::error::BvhError;

/// What a build spends its time on. Every quality gives the same hits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BuildQuality {
    /// The least time: parts of a space-filling curve, \[Lauterbach09], of which the largest are moved to better places, \[Meister18]. For geometry
    /// that changes all the time.
    Fast,
    /// The best of many planes at every node: binned surface area heuristic, \[Wald07]; and the largest subtrees moved.
    #[default]
    Balanced,
    /// Also planes that cut triangles in two, \[Stich09], and many more subtrees moved. Long thin triangles and uneven scenes gain most; what is
    /// cut is stored once for every part. For a scene that is traced for long.
    High,
}

impl BuildQuality {
    /// All, from fast builds to fast rays.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Balanced, Self::High];

    /// As users write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Balanced => "balanced",
            Self::High => "high",
        }
    }
}

/// How to build. `BuildOptions::default()` suits a scene that is built once and traced for long.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BuildOptions {
    /// What the time is spent on.
    pub quality: BuildQuality,
    /// Later moves of vertices, shapes or instances may keep the tree: [`Blas::update`](crate::Blas::update), [`Tlas::update`](crate::Tlas::update).
    /// Triangles are then never cut.
    pub allow_update: bool,
    /// The arrays stay as the build left them, with room to spare, until [`Blas::compacted`](crate::Blas::compacted) copies them to their exact
    /// size. Without it the build ends with that copy.
    pub allow_compaction: bool,
    /// Fewer nodes and fuller leaves at the price of slower rays; triangles are never cut.
    pub low_memory: bool,
    /// Weights of the heuristic.
    pub sah: Sah,
}

impl BuildOptions {
    /// The options of a quality.
    pub fn of(quality: BuildQuality) -> Self {
        Self { quality, ..Self::default() }
    }

    /// Whether triangles may be cut.
    pub(crate) fn may_cut(&self) -> bool {
        self.quality == BuildQuality::High && !self.allow_update && !self.low_memory
    }

    /// The heuristic, as low memory changes it.
    pub(crate) fn effective_sah(&self) -> Sah {
        match self.low_memory {
            true => Sah {
                max_leaf_size: self.sah.max_leaf_size.max(LOW_MEMORY_LEAF),
                node_cost: self.sah.node_cost * LOW_MEMORY_NODE_COST,
                ..self.sah
            },
            false => self.sah,
        }
    }
}

/// Triangles that a leaf may hold when memory is short.
const LOW_MEMORY_LEAF: usize = 16;

/// By how much nodes are dearer when memory is short.
const LOW_MEMORY_NODE_COST: f32 = 4.0;

/// How to weigh a split. The defaults suit the traversal of this crate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sah {
    /// Candidate planes an axis, plus one; 2 to 32.
    pub bins: usize,
    /// Greatest number of triangles in a leaf; 1 to 32.
    pub max_leaf_size: usize,
    /// Cost of visiting a node, in units of the cost of a triangle block.
    pub node_cost: f32,
}

impl Default for Sah {
    fn default() -> Self {
        Self { bins: 16, max_leaf_size: 8, node_cost: 1.0 }
    }
}

/// The same wishes in the words of Vulkan and DirectX (`ALLOW_UPDATE`, `PREFER_FAST_TRACE`, …), for callers that have those.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BuildFlags {
    /// [`BuildOptions::allow_update`].
    pub allow_update: bool,
    /// [`BuildOptions::allow_compaction`].
    pub allow_compaction: bool,
    /// [`BuildQuality::High`].
    pub prefer_fast_trace: bool,
    /// [`BuildQuality::Fast`].
    pub prefer_fast_build: bool,
    /// [`BuildOptions::low_memory`].
    pub low_memory: bool,
}

impl TryFrom<BuildFlags> for BuildOptions {
    type Error = BvhError;

    /// # Errors
    /// Both preferences at once.
    fn try_from(flags: BuildFlags) -> Result<Self, BvhError> {
        let quality = match (flags.prefer_fast_trace, flags.prefer_fast_build) {
            (true, true) => return Err(BvhError::BothPreferences),
            (true, false) => BuildQuality::High,
            (false, true) => BuildQuality::Fast,
            (false, false) => BuildQuality::Balanced,
        };
        let BuildFlags { allow_update, allow_compaction, low_memory, .. } = flags;
        Ok(Self { quality, allow_update, allow_compaction, low_memory, ..Self::default() })
    }
}
