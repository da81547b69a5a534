//! What a study found.

use super::Plot;
use crate::report::short;
use kajo_image::Image;
use kajo_units::Srgb8;
use serde::Serialize;

/// Everything that a study found, in the order in which it is shown.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// What was to be shown, and whether it was.
    pub claims: Vec<Claim>,
    /// Numbers.
    pub tables: Vec<Table>,
    /// Curves.
    pub plots: Vec<Plot>,
    /// Images.
    pub pictures: Vec<Picture>,
}

impl Findings {
    /// Adds a claim.
    pub fn claim(&mut self, text: impl Into<String>, holds: bool, measured: impl Into<String>) {
        self.claims.push(Claim { text: text.into(), holds, measured: measured.into() });
    }
}

/// A sentence that the study confirms or refutes.
#[derive(Clone, Debug, Serialize)]
pub struct Claim {
    /// The sentence.
    pub text: String,
    /// Whether it was confirmed.
    pub holds: bool,
    /// The numbers that decide.
    pub measured: String,
}

/// Numbers in rows; the first column names the row.
#[derive(Clone, Debug, Serialize)]
pub struct Table {
    /// Of its file.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// Headings, with units.
    pub columns: Vec<String>,
    /// Cells.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Cell {
    /// A name.
    Text(String),
    /// A number.
    Number(f64),
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl Cell {
    /// Three digits, for people.
    pub fn shown(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(number) => short(*number),
        }
    }
}

impl Table {
    /// Without rows.
    pub fn new(name: &str, caption: &str, columns: &[&str]) -> Self {
        Self { name: name.into(), caption: caption.into(), columns: columns.iter().map(|c| (*c).into()).collect(), rows: Vec::new() }
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = Cell>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// Comma-separated, with every digit.
    pub fn to_csv(&self) -> String {
        let quoted = |text: &str| if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.into() };
        let cell = |cell: &Cell| match cell {
            Cell::Text(text) => quoted(text),
            Cell::Number(number) => number.to_string(),
        };
        let line = |cells: Vec<String>| cells.join(",") + "\n";
        let head = line(self.columns.iter().map(|c| quoted(c)).collect());
        head + &self.rows.iter().map(|row| line(row.iter().map(cell).collect())).collect::<String>()
    }
}

/// An image with a sentence.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Of its file.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// The image.
    pub image: Image<Srgb8>,
}

impl Picture {
    /// Visibility as grey: black 0, white 1.
    pub fn of_visibility(name: &str, caption: &str, visibility: &Image<f32>) -> Self {
        let grey = |v: &f32| Srgb8([(v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8; 3]);
        Self { name: name.into(), caption: caption.into(), image: visibility.map(grey) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_written_with_every_digit_and_quoted_names() {
        let mut table = Table::new("t", "", &["name", "x, m"]);
        table.row(["a \"b\"".into(), 0.123456789.into()]);
        assert_eq!(table.to_csv(), "name,\"x, m\"\n\"a \"\"b\"\"\",0.123456789\n");
        assert_eq!(table.rows[0][1].shown(), "0.123");
    }
}
