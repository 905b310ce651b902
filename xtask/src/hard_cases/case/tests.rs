//! Cases of a falling sheet.

use super::*;
use crate::report::Verdict;

const SCENE: &str = "version = 1
    [sheet]
    mesh = { square = { side = 0.2, level = 0 } }
    [forces]
    gravity = [0, 0, -9.8]
    [stop]
    time = 0.1";

/// The case with a scene of a falling sheet. Its folder stays as long as the first value lives.
fn read(case: &str) -> Result<(tempfile::TempDir, Case)> {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("scene.toml"), SCENE)?;
    let path = folder.path().join("case.toml");
    let head = "title = 't'\nexpected = 'e'\nscene = 'scene.toml'";
    fs::write(&path, format!("{head}\n{case}"))?;
    let case = Case::read(&path)?;
    Ok((folder, case))
}

fn checks(case: &str) -> Vec<Finding> {
    let (_folder, case) = read(case).expect("right");
    case.run(Effort::Quick).expect("runs").0
}

/// A sheet that falls freely has the speed `g t` at the end, and the worst of several runs counts.
#[test]
fn the_worst_run_is_judged() {
    let found = checks(
        "[[variants]]
            'stop.time' = [0.1, 0.2]
        [[check]]
        quantity = 'ending.largest_speed'
        at_most = 1.97
        at_least = 0.97
        [[check]]
        only = { 'stop.time' = 0.2 }
        quantity = 'ending.largest_speed'
        at_least = 1.95
        [[check]]
        quantity = 'stopped'
        at_most = 0",
    );
    let values: Vec<f64> = found.iter().map(|c| c.value.expect("a number")).collect();
    for (value, want) in values.iter().zip([1.96, 0.98, 1.96, 0.0]) {
        assert!((value - want).abs() < 1e-9, "{values:?}");
    }
    assert!(
        found.iter().all(|c| c.verdict() == Verdict::Passed),
        "{found:?}"
    );
}

/// The runs are the runs of all entries of variants, and edits of the effort come last. What is for greater
/// effort is not checked in quick reports.
#[test]
fn entries_of_variants_have_their_own_runs() {
    let (_folder, file) = read(
        "quick = ['method.step=0.01']
        [[variants]]
        'stop.time' = [0.1, 0.2]
        [[variants]]
        'sheet.mass' = [1.0]
        [[variants]]
        effort = 'standard'
        'stop.time' = [5.0]
        [[check]]
        only = { 'stop.time' = 5.0 }
        quantity = 'steps'
        at_least = 300
        [[check]]
        quantity = 'steps'
        at_most = 20",
    )
    .expect("right");
    let runs = |effort| -> Vec<String> {
        let runs = file.runs(effort).expect("right");
        runs.iter().map(|edits| edits.join(" ")).collect()
    };
    let standard = [
        "stop.time=0.1",
        "stop.time=0.2",
        "sheet.mass=1.0",
        "stop.time=5.0",
    ];
    assert_eq!(runs(Effort::Standard), standard);
    let quick: Vec<String> = standard[..3]
        .iter()
        .map(|run| format!("{run} method.step=0.01"))
        .collect();
    assert_eq!(runs(Effort::Quick), quick);
    let found = file.run(Effort::Quick).expect("runs").0;
    let values: Vec<_> = found.iter().map(|c| c.value).collect();
    assert_eq!(values, [Some(20.0)]);
}

/// A limitation has to be there.
#[test]
fn a_limitation_is_judged_on_both_sides() {
    for (range, verdict) in [
        ("[0.9, 1.1]", Verdict::Limitation),
        ("[1.5, 2.0]", Verdict::Improved),
        ("[0.6, 0.9]", Verdict::Failed),
    ] {
        let found = checks(&format!(
            "[[check]]
            quantity = 'ending.largest_speed'
            at_most = 0.5
            limitation = {{ why = 'it falls', between = {range} }}"
        ));
        assert_eq!(found[0].verdict(), verdict);
    }
}

/// A run that stops fails all bounds but the bounds of what its accepted steps say.
#[test]
fn runs_that_stop_are_no_good() {
    let found = checks(
        "quick = ['method.integrator=bdf2', 'sheet.mesh.square.level=1', 'stop.time=1',
            'support=[{ at = { nearest = [[0, 0, 0], [0.2, 0.2, 0]] } }]']
        [[check]]
        quantity = 'ending.largest_speed'
        at_most = 1
        [[check]]
        quantity = 'largest_strain'
        at_most = 1e-12
        [[check]]
        quantity = 'stopped'
        at_most = 0",
    );
    let verdicts: Vec<Verdict> = found.iter().map(Finding::verdict).collect();
    assert_eq!(
        verdicts,
        [Verdict::Failed, Verdict::Passed, Verdict::Failed],
        "{found:?}"
    );
}

#[test]
fn wrong_files_are_refused() {
    let said = |case: &str| format!("{:#}", read(case).map(drop).expect_err("wrong"));
    let text = said("[[check]]\nquantity = 'stopped'");
    assert!(
        text.contains("all runs: number that stop early` has no bound"),
        "{text}"
    );
    let text = said("[[check]]\nquantity = 'stopped'\nat_most = 0\nonly = { 'a.b' = 1 }");
    assert!(
        text.contains("`a.b` of `only` is none of the variants"),
        "{text}"
    );
    let text = said("[[check]]\nquantity = 'stopped'\nat_mos = 0");
    assert!(text.contains("unknown field `at_mos`"), "{text}");
    let (_folder, file) =
        read("[[check]]\nquantity = 'measures.tip.last'\nat_most = 0").expect("right");
    let error = file
        .run(Effort::Quick)
        .map(drop)
        .expect_err("no such measure");
    assert!(
        error
            .to_string()
            .contains("no number of `all runs: measures.tip.last"),
        "{error}"
    );
    assert!(said("check = []").contains("there is no check"));
    let check = "[[check]]\nquantity = 'steps'\nat_most = 0\n";
    let text = said(&format!("{check}[[variants]]\n'stop.time' = 0.1"));
    assert!(text.contains("invalid type"), "{text}");
    let case = format!("{check}only = {{ 'stop.time' = 0.2 }}\n[[variants]]\n'stop.time' = [0.1]");
    let (_folder, file) = read(&case).expect("right");
    let error = file.run(Effort::Quick).map(drop).expect_err("wrong");
    let problem = "no run is one of `stop.time = 0.2: steps`";
    assert!(error.to_string().contains(problem), "{error}");
}

#[test]
fn the_files_of_the_folder_are_cases() {
    for case in &all().expect("right files") {
        assert_eq!(named(&case.name), Ok(case.name.clone()));
        let contents = &case.contents;
        assert!(
            !contents.title.is_empty() && contents.expected.ends_with('.'),
            "{case:?}"
        );
        case.require_runs().expect("runs of all checks");
    }
    let error = named("flat").expect_err("no case");
    assert!(error.contains("'flat-start'"), "{error}");
}
