//! How the window is divided: one picture, or several in vertical strips with sliders between them.
//!
//! Every strip shows the same part of the view at the same place, so that moving a slider wipes from one picture to the next.

use egui::{Rect, pos2};

/// What a strip shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Pane {
    /// The technique.
    A,
    /// The technique that stands against it.
    B,
    /// The path-traced reference.
    Reference,
    /// Where A is wrong.
    HeatA,
    /// Where B is wrong.
    HeatB,
}

/// A choice of strips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Preset {
    /// For people, and for scripts.
    pub name: &'static str,
    /// From left to right.
    pub panes: &'static [Pane],
}

/// Every choice.
pub(crate) const PRESETS: [Preset; 7] = [
    Preset { name: "A", panes: &[Pane::A] },
    Preset { name: "A | reference", panes: &[Pane::A, Pane::Reference] },
    Preset { name: "A | B", panes: &[Pane::A, Pane::B] },
    Preset { name: "A | B | reference", panes: &[Pane::A, Pane::B, Pane::Reference] },
    Preset { name: "A | error of A", panes: &[Pane::A, Pane::HeatA] },
    Preset { name: "errors of A | B", panes: &[Pane::HeatA, Pane::HeatB] },
    Preset { name: "reference", panes: &[Pane::Reference] },
];

/// Narrowest strip, as a share of the width.
const NARROWEST: f32 = 0.02;

/// The strips and the sliders between them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout {
    preset: Preset,
    /// Shares of the width, ascending.
    dividers: Vec<f32>,
}

impl Default for Layout {
    fn default() -> Self {
        Self::new(PRESETS[0])
    }
}

impl Layout {
    /// Strips of equal width.
    pub fn new(preset: Preset) -> Self {
        let count = preset.panes.len();
        Self { preset, dividers: (1..count).map(|i| i as f32 / count as f32).collect() }
    }

    /// What was chosen.
    pub fn preset(&self) -> Preset {
        self.preset
    }

    /// True when a strip shows it.
    pub fn shows(&self, pane: Pane) -> bool {
        self.preset.panes.contains(&pane)
    }

    /// True when a strip needs frames of B.
    pub fn needs_rival(&self) -> bool {
        self.shows(Pane::B) || self.shows(Pane::HeatB)
    }

    /// Where each slider is, share of the width.
    pub fn dividers(&self) -> &[f32] {
        &self.dividers
    }

    /// Moves a slider; it stays between its neighbours.
    pub fn drag(&mut self, index: usize, to: f32) {
        let low = if index == 0 { 0.0 } else { self.dividers[index - 1] } + NARROWEST;
        let high = self.dividers.get(index + 1).copied().unwrap_or(1.0) - NARROWEST;
        if low <= high && to.is_finite() {
            self.dividers[index] = to.clamp(low, high);
        }
    }

    /// The strips of `whole`.
    pub fn strips(&self, whole: Rect) -> Vec<(Pane, Rect)> {
        let at = |share: f32| whole.left() + share * whole.width();
        let edges: Vec<f32> = [0.0].into_iter().chain(self.dividers.iter().copied()).chain([1.0]).map(at).collect();
        let strip = |(pane, x): (&Pane, &[f32])| (*pane, Rect::from_min_max(pos2(x[0], whole.top()), pos2(x[1], whole.bottom())));
        self.preset.panes.iter().zip(edges.windows(2)).map(strip).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: Rect = Rect { min: pos2(10.0, 20.0), max: pos2(110.0, 80.0) };

    #[test]
    fn strips_tile_the_window_in_every_layout() {
        for preset in PRESETS {
            let strips = Layout::new(preset).strips(WHOLE);
            assert_eq!(strips.len(), preset.panes.len());
            assert_eq!((strips[0].1.left(), strips.last().unwrap().1.right()), (WHOLE.left(), WHOLE.right()));
            assert!(strips.windows(2).all(|pair| pair[0].1.right() == pair[1].1.left()));
        }
    }

    #[test]
    fn sliders_never_cross() {
        let mut layout = Layout::new(PRESETS[3]);
        for (index, to) in [(0, 5.0), (1, -3.0), (0, f32::NAN), (1, 0.9), (0, -1.0)] {
            layout.drag(index, to);
            let [a, b] = layout.dividers() else { panic!("two sliders") };
            assert!(*a >= NARROWEST && a < b && *b <= 1.0 - NARROWEST, "{a} {b}");
        }
    }
}
