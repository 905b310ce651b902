//! What runs of sheets that yield leave.

use crate::{code, run, stderr};
use isosheet_io::read_history;
use std::fs;

/// A strip that is held at one end and falls.
const SCENE: &str = "version = 1
[sheet]
mesh = { rectangle = { width = 0.2, height = 0.02, columns = 8, rows = 1 } }
material = \"office paper\"
damping = 5
[[support]]
at = { box = { min = [-0.01, -0.01, -1], max = [0.03, 0.03, 1] } }
[forces]
gravity = [0, 0, -9.81]
[stop]
time = 0.3
";

/// The history says what has been dissipated where something can yield, and there alone; it ends with what the summary
/// says.
#[test]
fn a_history_says_what_yielding_has_dissipated() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("strip.toml"), SCENE).unwrap();
    let simulated = |out: &str, edits: &[&str]| {
        let mut arguments = vec!["simulate", "strip.toml", "--out", out];
        arguments.extend(edits.iter().flat_map(|edit| ["--set", edit]));
        let done = run(dir.path(), &arguments);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        let out = dir.path().join(out);
        let summary = fs::read_to_string(out.join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        (read_history(&out.join("history.csv")).unwrap(), summary)
    };
    let (elastic, _) = simulated("elastic", &[]);
    assert!(elastic.iter().all(|row| row.plastic.is_none()));
    let (rows, summary) = simulated("yields", &["sheet.yield={moment=1e-3,layers=3}"]);
    let plastic: Vec<f64> = rows.iter().map(|row| row.plastic.unwrap()).collect();
    assert_eq!(plastic[0], 0.0);
    assert!(
        plastic.is_sorted() && plastic[plastic.len() - 1] > 0.0,
        "{plastic:?}"
    );
    let end = summary["ending"]["plastic"].as_f64();
    assert_eq!(end, plastic.last().copied());
}
