//! What goes to stdout (results, JSON) and to stderr (messages).

use crate::failure::{Failure, Outcome};
use serde::Serialize;
use std::io::{self, Write};

/// Messages of the libraries go to stderr: warnings always, more with `KAJO_LOG`.
pub fn start_log(quiet: bool) {
    let default = if quiet { "error" } else { "warn,wgpu=error,naga=error" };
    let filter = tracing_subscriber::EnvFilter::try_from_env("KAJO_LOG").unwrap_or_else(|_| default.into());
    tracing_subscriber::fmt().with_env_filter(filter).with_writer(io::stderr).without_time().with_target(false).init();
}

/// Prints a value as JSON, one document.
///
/// # Errors
/// Those of [`text`].
pub fn json(value: &impl Serialize) -> Outcome {
    text(&(serde_json::to_string_pretty(value)? + "\n"))
}

/// Prints text; a reader that went away (`kajo … | head`) is no error.
///
/// # Errors
/// A standard output that takes nothing, such as a file on a full disk.
pub fn text(text: &str) -> Outcome {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::run(format!("cannot write to standard output: {error}"))),
        _ => Ok(()),
    }
}

/// A table with left-aligned columns.
pub fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).chain([head[column].chars().count()]).max().unwrap_or(0);
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let line = |cells: &[String]| {
        let padded: Vec<String> = cells.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
        format!("{}\n", padded.join("  ").trim_end())
    };
    let head: Vec<String> = head.iter().map(ToString::to_string).collect();
    std::iter::once(line(&head)).chain(rows.iter().map(|row| line(row))).collect()
}

/// `3.2 GB`, `410 kB`, `12 B`.
pub fn bytes(count: u64) -> String {
    let mut value = count as f64;
    let mut unit = "B";
    for next in ["kB", "MB", "GB", "TB"] {
        if value < 1000.0 {
            break;
        }
        value /= 1000.0;
        unit = next;
    }
    if unit == "B" { format!("{count} B") } else { format!("{value:.1} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_have_three_digits_or_so() {
        assert_eq!([bytes(12), bytes(410_000), bytes(3_200_000_000)], ["12 B", "410.0 kB", "3.2 GB"]);
    }

    #[test]
    fn columns_line_up() {
        let rows = vec![vec!["a".into(), "1".into()], vec!["long".into(), "2".into()]];
        assert_eq!(table(&["id", "n"], &rows), "id    n\na     1\nlong  2\n");
    }
}
