//! Work counters that cost nothing when they are off.

/// Receives one call a unit of work; the no-op [`NoCounters`] compiles away.
pub trait Count {
    /// A node was visited: eight boxes were tested.
    fn node(&mut self);
    /// A block of triangles was tested; `count` tells how many it holds.
    fn triangles(&mut self, count: impl FnOnce() -> u32);
    /// A ray entered an instance.
    fn instance(&mut self);
}

/// Counts nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoCounters;

impl Count for NoCounters {
    #[inline(always)]
    fn node(&mut self) {}
    #[inline(always)]
    fn triangles(&mut self, _: impl FnOnce() -> u32) {}
    #[inline(always)]
    fn instance(&mut self) {}
}

/// Sums of work over the rays it was given to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Nodes visited, both levels.
    pub nodes: u64,
    /// Boxes tested; eight a node.
    pub boxes: u64,
    /// Triangles tested, padding not counted.
    pub triangles: u64,
    /// Instances entered.
    pub instances: u64,
}

impl Count for Counters {
    fn node(&mut self) {
        self.nodes += 1;
        self.boxes += 8;
    }
    fn triangles(&mut self, count: impl FnOnce() -> u32) {
        self.triangles += u64::from(count());
    }
    fn instance(&mut self) {
        self.instances += 1;
    }
}
