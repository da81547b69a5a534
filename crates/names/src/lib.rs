//! Names that users type: which of the known ones a word means, and which one a mistyped word most likely meant.

/// Similarity below which an offer would only confuse: 1 is equal, 0 nothing in common.
const NEAR: f64 = 0.75;

/// How many names a message lists before it breaks off.
const LISTED: usize = 24;

/// The closest of `known` to `word`, if it is close enough to be worth offering. Case does not count.
///
/// Closeness is the Jaro–Winkler similarity, which favours words that begin alike.    \[Winkler90]
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    let scored = known.into_iter().map(|name| (strsim::jaro_winkler(&word, &name.to_lowercase()), name));
    scored.filter(|(score, _)| *score >= NEAR).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}

/// The index of the thing called `word`; a number is an index where nothing is called so.
///
/// # Errors
/// [`UnknownName`] with the things there are, numbered.
pub fn choose(kind: &'static str, word: &str, names: &[&str]) -> Result<usize, UnknownName> {
    let index = || word.parse().ok().filter(|&index| index < names.len());
    let numbered = || names.iter().enumerate().map(|(index, name)| format!("{index} {name:?}"));
    names.iter().position(|name| *name == word).or_else(index).ok_or_else(|| UnknownName::with_list(kind, word, names, numbered()))
}

/// A name that nothing has, with the nearest one and those there are.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no {kind} is called \"{word}\"{}{}", self.offer(), self.list())]
pub struct UnknownName {
    /// What was looked for: `camera`, `asset`, …
    pub kind: &'static str,
    /// The word given.
    pub word: String,
    /// The name it most likely meant.
    pub nearest: Option<String>,
    /// The first of the names there are, as they are shown.
    listed: Vec<String>,
    /// How many names are not listed.
    more: usize,
}

impl UnknownName {
    /// That none of `names` is `word`.
    pub fn new(kind: &'static str, word: &str, names: &[&str]) -> Self {
        Self::with_list(kind, word, names, names.iter().map(|name| format!("{name:?}")))
    }

    fn with_list(kind: &'static str, word: &str, names: &[&str], shown: impl Iterator<Item = String>) -> Self {
        let nearest = nearest(word, names.iter().copied()).map(str::to_owned);
        Self { kind, word: word.into(), nearest, listed: shown.take(LISTED).collect(), more: names.len().saturating_sub(LISTED) }
    }

    fn offer(&self) -> String {
        self.nearest.as_ref().map_or_else(String::new, |name| format!(" (did you mean {name:?}?)"))
    }

    fn list(&self) -> String {
        let names = self.listed.join(", ");
        match self.more {
            _ if self.listed.is_empty() => "; there are none".to_owned(),
            0 => format!("; there are: {names}"),
            more => format!("; there are: {names} and {more} more"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_recognised_and_strangers_are_not() {
        let nearest = |word| nearest(word, ["cornell", "furnace", "many-lights"]);
        assert_eq!(nearest("cornel"), Some("cornell"));
        assert_eq!(nearest("many_lights"), Some("many-lights"));
        assert_eq!(nearest("Furnaces"), Some("furnace"));
        assert_eq!(nearest("xyzzy"), None);
        assert_eq!(nearest(""), None);
    }

    #[test]
    fn names_come_before_numbers() {
        let choose = |word| choose("camera", word, &["main", "0"]).ok();
        assert_eq!([choose("0"), choose("main"), choose("1"), choose("2"), choose("-1")], [Some(1), Some(0), Some(1), None, None]);
    }

    #[test]
    fn an_unknown_name_is_answered_with_what_there_is() {
        let message = |word, names: &[&str]| choose("camera", word, names).unwrap_err().to_string();
        assert_eq!(
            message("maim", &["main", "side"]),
            "no camera is called \"maim\" (did you mean \"main\"?); there are: 0 \"main\", 1 \"side\""
        );
        assert_eq!(message("7", &["", "side"]), "no camera is called \"7\"; there are: 0 \"\", 1 \"side\"");
        assert_eq!(message("main", &[]), "no camera is called \"main\"; there are none");
        let many: Vec<String> = (0..30).map(|n| format!("material{n}")).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        let long = UnknownName::new("material", "xyz", &many).to_string();
        assert!(long.ends_with("\"material23\" and 6 more") && !long.contains("material24"), "{long}");
    }
}
