//! `kajo coverage`: the requirements as a table.

use crate::arguments::Common;
use crate::coverage::{Coverage, Row, Status};
use crate::failure::Outcome;
use crate::output;

/// Prints the rows in state `status`, or all, and how many are in each.
pub fn run(common: &Common, status: Option<&str>) -> Outcome {
    let rows = Coverage::embedded().row;
    let chosen: Vec<&Row> = rows.iter().filter(|row| status.is_none_or(|word| word == name(row.status))).collect();
    if common.json {
        return output::json(&chosen);
    }
    let cells: Vec<Vec<String>> =
        chosen.iter().map(|row| vec![row.id.clone(), name(row.status).into(), row.title.clone(), row.r#where.clone()]).collect();
    let count = |status| rows.iter().filter(|row| row.status == status).count();
    let counts = format!("\n{} done, {} partial, {} todo\n", count(Status::Done), count(Status::Partial), count(Status::Todo));
    output::text(&(output::table(&["row", "status", "feature", "where"], &cells) + &counts))
}

fn name(status: Status) -> &'static str {
    match status {
        Status::Done => "done",
        Status::Partial => "partial",
        Status::Todo => "todo",
    }
}
