//! Counting what a search does: complexity is asserted in steps, which no other load on the machine can change.

/// Takes note of one read of a table. `()` counts nothing and costs nothing.
pub trait Steps {
    /// One read.
    fn step(&mut self);
}

impl Steps for () {
    #[inline(always)]
    fn step(&mut self) {}
}

impl Steps for u64 {
    #[inline]
    fn step(&mut self) {
        *self += 1;
    }
}
