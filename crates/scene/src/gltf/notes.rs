//! Collects what the importer ignores: each kind of thing once, with the names of all places where it occurs.

use crate::Ignored;
use std::collections::{HashMap, HashSet};

/// How many places are named before the rest is counted.
const NAMED_PLACES: usize = 8;

/// The list in the making.
pub struct Notes {
    file: String,
    notes: Vec<Note>,
    /// Where the note of a feature and a consequence stands in the list.
    index: HashMap<(String, String), usize>,
}

/// One kind of thing.
struct Note {
    feature: String,
    consequence: String,
    /// The first places where it occurs.
    named: Vec<String>,
    /// All of them.
    places: HashSet<String>,
}

impl Notes {
    /// An empty list for a file.
    pub fn new(file: &str) -> Self {
        Self { file: file.into(), notes: Vec::new(), index: HashMap::new() }
    }

    /// Adds a place (empty: the file) where `feature` occurs.
    pub fn add(&mut self, place: impl Into<String>, feature: impl Into<String>, consequence: impl Into<String>) {
        let (place, feature, consequence) = (place.into(), feature.into(), consequence.into());
        let next = self.notes.len();
        let index = *self.index.entry((feature.clone(), consequence.clone())).or_insert(next);
        if index == next {
            self.notes.push(Note { feature, consequence, named: Vec::new(), places: HashSet::new() });
        }
        let note = &mut self.notes[index];
        if note.places.insert(place.clone()) && note.named.len() < NAMED_PLACES {
            note.named.push(place);
        }
    }

    /// Adds the extensions of an object that Kajo does not know.
    pub fn unknown_extensions<'a>(&mut self, place: &str, names: impl IntoIterator<Item = &'a String>) {
        for name in names {
            self.add(place, name, super::extensions::consequence(name));
        }
    }

    /// True where an entry names this feature.
    pub fn mentions(&self, feature: &str) -> bool {
        self.notes.iter().any(|note| note.feature == feature)
    }

    /// The list, in the order in which kinds first occurred.
    pub fn finish(self) -> Vec<Ignored> {
        let file = self.file;
        let entry = |note: Note| Ignored { file: file.clone(), place: note.place(), feature: note.feature, consequence: note.consequence };
        self.notes.into_iter().map(entry).collect()
    }
}

impl Note {
    fn place(&self) -> String {
        let named = self.named.join(", ");
        match self.places.len() - self.named.len() {
            0 => named,
            more => format!("{named} and {more} more"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_notes_are_one_entry_with_all_places() {
        let mut notes = Notes::new("a.gltf");
        notes.add("node 0", "range", "ignored");
        notes.add("node 1", "range", "ignored");
        notes.add("node 1", "range", "ignored");
        notes.add("", "variants", "the default is shown");
        let list = notes.finish();
        assert_eq!(list.len(), 2);
        assert_eq!(list[0].to_string(), "a.gltf: node 0, node 1: range: ignored");
        assert_eq!(list[1].to_string(), "a.gltf: variants: the default is shown");
    }

    #[test]
    fn long_lists_of_places_are_counted() {
        let mut notes = Notes::new("a.gltf");
        for index in 0..100 {
            notes.add(format!("node {index}"), "range", "ignored");
        }
        assert!(notes.finish()[0].place.ends_with("node 7 and 92 more"));
    }
}
