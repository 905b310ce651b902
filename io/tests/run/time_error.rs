//! What the lengths of steps leave as an error, in the summary of a run.

use crate::{code, run, stderr, summary};
use std::fs;

/// A triangle that falls freely: a step of `h` seconds of implicit Euler errs by `g h^2 / 2`.
const SCENE: &str = "version = 1
[sheet]
mesh = { triangles = { vertices = [[0, 0, 0], [0.3, 0, 0], [0, 0.4, 0]], faces = [[0, 1, 2]] } }
mass = 0.1
[forces]
gravity = [0, 0, -10]
[method]
integrator = 'implicit_euler'
step = 0.01
[stop]
time = 0.1
";

#[test]
fn the_error_of_a_fall_is_that_of_the_closed_form_and_an_accuracy_that_is_not_met_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("fall.toml"), SCENE).unwrap();
    for (name, sets, size, is_told) in [
        ("fixed", &[][..], 5e-4, false),
        ("met", &["method.accuracy=1e-4"], 5e-4 / 16.0, false),
        (
            "unmet",
            &["method.accuracy=1e-4", "method.min_fraction=0.5"],
            5e-4 / 4.0,
            true,
        ),
    ] {
        let mut arguments = vec!["simulate", "fall.toml", "--out", name];
        arguments.extend(sets.iter().flat_map(|set| ["--set", set]));
        let done = run(dir, &arguments);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        let error = summary(&dir.join(name)).time_error.unwrap();
        assert!((error.size / size - 1.0).abs() < 1e-9, "{name}: {error:?}");
        let text = stderr(&done);
        assert_eq!(
            text.contains("1e-4 m a step, is not met"),
            is_told,
            "{text}"
        );
    }
    let done = run(dir, &["check", "fall.toml", "--set", "method.accuracy=-1"]);
    assert_eq!(code(&done), Some(3), "{}", stderr(&done));
    assert!(
        stderr(&done).contains("method.accuracy"),
        "{}",
        stderr(&done)
    );
    let sets = [
        "--set",
        "method.integrator=rattle",
        "--set",
        "method.accuracy=1e-3",
    ];
    let done = run(dir, &[&["check", "fall.toml"][..], &sets].concat());
    assert!(
        stderr(&done).contains("does not estimate the errors"),
        "{}",
        stderr(&done)
    );
}
