//! How a caller watches a comparison.

/// Watches a comparison. Called from any thread.
pub trait Progress: Sync {
    /// Where it is: what is being done, and the share of the whole that is done, [0, 1].
    fn at(&self, what: &str, fraction: f64);

    /// True ends the comparison soon; what is finished is kept.
    fn interrupted(&self) -> bool {
        false
    }
}

/// Watches nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Progress for Unwatched {
    fn at(&self, _what: &str, _fraction: f64) {}
}
