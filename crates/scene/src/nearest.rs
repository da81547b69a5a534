//! The known name that a mistyped one most likely meant.

/// The closest of `known` to `name`, if it is close enough to be worth offering.
pub(crate) fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let score = |k: &str| strsim::jaro_winkler(&name.to_lowercase(), &k.to_lowercase());
    known.iter().copied().map(|k| (score(k), k)).filter(|(s, _)| *s >= 0.75).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, k)| k)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn slips_are_recognised_and_strangers_are_not() {
        let known = ["cornell", "furnace", "many-lights"];
        assert_eq!(nearest("cornel", &known), Some("cornell"));
        assert_eq!(nearest("many_lights", &known), Some("many-lights"));
        assert_eq!(nearest("Furnaces", &known), Some("furnace"));
        assert_eq!(nearest("xyzzy", &known), None);
        assert_eq!(nearest("", &known), None);
    }
}
