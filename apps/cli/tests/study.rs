//! `kajo study` as a user types it.

mod common;

use common::{json, run, succeed};
use std::fs;

#[test]
fn studies_are_listed_and_one_leaves_a_page_tables_and_plots() {
    let folder = tempfile::tempdir().unwrap();
    let list = json(folder.path(), &["study"]);
    assert!(list.as_array().unwrap().iter().any(|study| study["id"] == "shadow-bias"), "{list}");
    succeed(folder.path(), &["study", "light-depth", "-o", "report", "--quick"]);
    let report: serde_json::Value = serde_json::from_str(&fs::read_to_string(folder.path().join("report/report.json")).unwrap()).unwrap();
    assert!(report["claims"].as_array().unwrap().iter().all(|claim| claim["holds"] == true), "{}", report["claims"]);
    for file in report["files"].as_array().unwrap() {
        assert!(folder.path().join("report").join(file.as_str().unwrap()).is_file(), "{file}");
    }
    assert!(fs::read_to_string(folder.path().join("report/index.html")).unwrap().contains("<svg"));
    assert!(fs::read_to_string(folder.path().join("report/depth.csv")).unwrap().lines().count() > 10);
}

#[test]
fn an_unknown_study_and_a_missing_folder_are_wrong_usage() {
    let folder = tempfile::tempdir().unwrap();
    for words in [&["study", "shadow-bais", "-o", "report"][..], &["study", "shadow-bias"]] {
        let output = run(folder.path(), words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
    }
    let said = run(folder.path(), &["study", "shadow-bais", "-o", "report"]);
    assert!(String::from_utf8_lossy(&said.stderr).contains("did you mean \"shadow-bias\"?"), "{said:?}");
    assert!(!folder.path().join("report").exists());
}
