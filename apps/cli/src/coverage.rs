//! `docs/coverage.toml`: every requirement, its state, and the tests that decide it.

use serde::{Deserialize, Serialize};

/// The file, as it was when this program was built.
const FILE: &str = include_str!("../../../docs/coverage.toml");

/// All rows.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coverage {
    /// In the order of the file.
    pub row: Vec<Row>,
}

/// One requirement.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs, reason = "the head of docs/coverage.toml says what each field is")]
pub struct Row {
    pub id: String,
    pub title: String,
    pub accept: String,
    pub source: String,
    pub status: Status,
    pub r#where: String,
    pub tests: Vec<String>,
    pub note: String,
}

/// How far a row is.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs, reason = "the words say it")]
pub enum Status {
    Done,
    Partial,
    Todo,
}

impl Coverage {
    /// Reads the embedded file.
    ///
    /// # Panics
    /// When it is malformed; a test keeps it well-formed.
    pub fn embedded() -> Self {
        toml::from_str(FILE).expect("docs/coverage.toml is well-formed")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::path::Path;
    use std::{fs, io};

    /// Names of all `#[test]` functions in the Rust files under `folder`.
    fn test_names(folder: &Path, names: &mut HashSet<String>) -> io::Result<()> {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() {
                test_names(&path, names)?;
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = fs::read_to_string(&path)?;
                let mut is_test = false;
                for line in text.lines().map(str::trim) {
                    is_test |= line == "#[test]";
                    if let Some(name) = line.strip_prefix("fn ").and_then(|rest| rest.split(['(', '<']).next())
                        && std::mem::take(&mut is_test)
                    {
                        names.insert(name.to_string());
                    }
                }
            }
        }
        Ok(())
    }

    fn all_test_names() -> HashSet<String> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let mut names = HashSet::new();
        for folder in ["crates", "apps", "xtask"] {
            test_names(&root.join(folder), &mut names).expect("the sources are readable");
        }
        names
    }

    /// What is wrong with the rows, one sentence each.
    fn faults(rows: &[Row], tests: &HashSet<String>) -> Vec<String> {
        let mut faults = Vec::new();
        let mut ids = HashSet::new();
        for row in rows {
            if !ids.insert(&row.id) {
                faults.push(format!("{} stands twice", row.id));
            }
            if row.status == Status::Done && row.tests.is_empty() {
                faults.push(format!("{} is done and names no test", row.id));
            }
            if row.status != Status::Todo && row.r#where.is_empty() {
                faults.push(format!("{} is {:?} and does not say where", row.id, row.status));
            }
            if row.status == Status::Partial && row.note.is_empty() {
                faults.push(format!("{} is partial and does not say what is missing", row.id));
            }
            faults
                .extend(row.tests.iter().filter(|t| !tests.contains(*t)).map(|t| format!("{} names `{t}`, which does not exist", row.id)));
        }
        faults
    }

    #[test]
    fn every_row_of_the_checklists_is_there() {
        let ids: HashSet<String> = Coverage::embedded().row.into_iter().map(|row| row.id).collect();
        let numbered = [("BR-", 41), ("RE-", 56), ("RM-", 68), ("GI-", 51)]
            .into_iter()
            .flat_map(|(prefix, last)| (1..=last).map(move |n| format!("{prefix}{n}")));
        let padded = [("SH-", 23), ("L-", 14), ("R-", 14), ("T-", 9), ("M-", 14), ("D-", 17), ("A-", 7), ("V-", 11), ("G-", 7)]
            .into_iter()
            .flat_map(|(prefix, last)| (1..=last).map(move |n| format!("{prefix}{n:02}")));
        let missing: Vec<String> = numbered.chain(padded).filter(|id| !ids.contains(id)).collect();
        assert!(missing.is_empty(), "missing rows: {missing:?}");
        assert_eq!(ids.len(), 332);
    }

    #[test]
    fn done_rows_name_tests_that_exist() {
        let faults = faults(&Coverage::embedded().row, &all_test_names());
        assert!(faults.is_empty(), "{}", faults.join("\n"));
    }

    #[test]
    fn a_row_that_names_no_real_test_is_found() {
        let row = |status, tests: &[&str]| Row {
            id: "X-1".into(),
            title: String::new(),
            accept: String::new(),
            source: String::new(),
            status,
            r#where: "here".into(),
            tests: tests.iter().map(ToString::to_string).collect(),
            note: String::new(),
        };
        let real = HashSet::from(["real".to_string()]);
        assert_eq!(faults(&[row(Status::Done, &["real"])], &real), Vec::<String>::new());
        assert_eq!(faults(&[row(Status::Done, &["fancied"])], &real).len(), 1);
        assert_eq!(faults(&[row(Status::Done, &[])], &real).len(), 1);
        assert_eq!(faults(&[row(Status::Partial, &["real"])], &real).len(), 1);
    }
}
