//! Ordering passes by what they read and write, and refusing graphs that have no order.
//!
//! Each slot has one writer. Passes that *update* it run after the writer in the order they were added, and before every pass that only
//! reads it.

use crate::{Error, Slot};

/// What a pass does with slots.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Access {
    /// Name, like `shadow/map/cast`: also the name of its timer and debug group.
    pub name: String,
    /// Slots it reads.
    pub reads: Vec<Slot>,
    /// Slots it makes.
    pub writes: Vec<Slot>,
    /// Slots it reads and changes.
    pub updates: Vec<Slot>,
}

impl Access {
    /// A pass that touches nothing yet.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// Adds slots that are read.
    pub fn reads(mut self, slots: &[Slot]) -> Self {
        self.reads.extend(slots);
        self
    }

    /// Adds slots that are made.
    pub fn writes(mut self, slots: &[Slot]) -> Self {
        self.writes.extend(slots);
        self
    }

    /// Adds slots that are changed.
    pub fn updates(mut self, slots: &[Slot]) -> Self {
        self.updates.extend(slots);
        self
    }

    /// Names of every slot it touches.
    pub fn touched(&self) -> Vec<&'static str> {
        self.reads.iter().chain(&self.writes).chain(&self.updates).map(|slot| slot.name).collect()
    }
}

/// The order in which to run `passes`, as indices; `imported` slots are there before. Passes without a reason to move keep their order.
///
/// # Errors
/// [`Error::NoProducer`], [`Error::DoubleWrite`] or [`Error::Cycle`].
pub fn order(passes: &[Access], imported: &[Slot]) -> Result<Vec<usize>, Error> {
    let writer = |slot: &Slot| passes.iter().position(|pass| pass.writes.contains(slot));
    for (i, pass) in passes.iter().enumerate() {
        for slot in &pass.writes {
            let first = if imported.contains(slot) { Some("the caller".to_owned()) } else { None };
            let earlier = passes[..i].iter().find(|other| other.writes.contains(slot)).map(|other| other.name.clone());
            if let Some(first) = first.or(earlier) {
                return Err(Error::DoubleWrite { slot: slot.name, first, second: pass.name.clone() });
            }
        }
        for slot in pass.reads.iter().chain(&pass.updates) {
            if writer(slot).is_none() && !imported.contains(slot) {
                let written = passes.iter().flat_map(|pass| &pass.writes).chain(imported).map(|slot| slot.name).collect();
                return Err(Error::NoProducer { pass: pass.name.clone(), slot: slot.name, written });
            }
        }
    }

    // before[i]: the passes that pass i waits for.
    let before: Vec<Vec<usize>> = (0..passes.len())
        .map(|i| {
            let pass = &passes[i];
            let mut wait = Vec::new();
            for slot in pass.reads.iter().chain(&pass.updates) {
                wait.extend(writer(slot));
                let updates = |j: &usize| passes[*j].updates.contains(slot);
                if pass.updates.contains(slot) {
                    wait.extend((0..i).filter(updates));
                } else {
                    wait.extend((0..passes.len()).filter(updates));
                }
            }
            wait.retain(|&j| j != i);
            wait
        })
        .collect();

    let mut done = vec![false; passes.len()];
    let mut sorted = Vec::with_capacity(passes.len());
    while sorted.len() < passes.len() {
        let Some(next) = (0..passes.len()).find(|&i| !done[i] && before[i].iter().all(|&j| done[j])) else {
            let waiting = (0..passes.len()).filter(|&i| !done[i]).map(|i| passes[i].name.clone()).collect();
            return Err(Error::Cycle { passes: waiting });
        };
        done[next] = true;
        sorted.push(next);
    }
    Ok(sorted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slot::{ALBEDO, COLOR, DEPTH, DIRECT, NORMAL};

    fn names(passes: &[Access], imported: &[Slot]) -> Vec<String> {
        order(passes, imported).unwrap().into_iter().map(|i| passes[i].name.clone()).collect()
    }

    #[test]
    fn readers_run_after_their_writer_wherever_they_were_added() {
        let passes = [
            Access::new("composite").reads(&[DIRECT]).writes(&[COLOR]),
            Access::new("light").reads(&[DEPTH, NORMAL]).writes(&[DIRECT]),
            Access::new("gbuffer").writes(&[DEPTH, NORMAL]),
        ];
        assert_eq!(names(&passes, &[]), ["gbuffer", "light", "composite"]);
    }

    #[test]
    fn updates_keep_their_order_and_come_before_readers() {
        let passes = [
            Access::new("read").reads(&[DIRECT]),
            Access::new("first").updates(&[DIRECT]),
            Access::new("second").updates(&[DIRECT]),
            Access::new("make").writes(&[DIRECT]),
        ];
        assert_eq!(names(&passes, &[]), ["make", "first", "second", "read"]);
    }

    #[test]
    fn imported_slots_need_no_writer() {
        assert_eq!(names(&[Access::new("light").reads(&[DEPTH]).updates(&[DIRECT])], &[DEPTH, DIRECT]), ["light"]);
    }

    #[test]
    fn a_missing_producer_is_named_with_what_is_written() {
        let passes = [Access::new("light").reads(&[NORMAL]), Access::new("gbuffer").writes(&[DEPTH, ALBEDO])];
        let text = order(&passes, &[]).unwrap_err().to_string();
        assert_eq!(text, "pass light reads \"normal\", which no pass writes; written are: [depth, albedo]");
    }

    #[test]
    fn two_writers_are_refused() {
        let passes = [Access::new("a").writes(&[DEPTH]), Access::new("b").writes(&[DEPTH])];
        assert!(matches!(order(&passes, &[]), Err(Error::DoubleWrite { slot: "depth", .. })));
        assert!(matches!(order(&passes[..1], &[DEPTH]), Err(Error::DoubleWrite { slot: "depth", .. })));
    }

    #[test]
    fn a_cycle_is_refused_with_its_passes() {
        let passes = [
            Access::new("a").reads(&[NORMAL]).writes(&[DEPTH]),
            Access::new("b").reads(&[DEPTH]).writes(&[NORMAL]),
            Access::new("c").writes(&[ALBEDO]),
        ];
        assert_eq!(order(&passes, &[]).unwrap_err().to_string(), "these passes wait for each other: a, b");
    }
}
