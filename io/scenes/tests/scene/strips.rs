//! Strips between two curves as meshes of scenes.

use crate::{parse, simulation};
use isosheet_mesh::generate::strip_between;
use isosheet_scenes::SceneFile;
use std::fs;

/// An arc of a circle about the z axis.
fn arc(radius: f64, z: f64) -> Vec<[f64; 3]> {
    let angle = |k: u32| 0.1 * f64::from(k);
    let place = |a: f64| [radius * a.cos(), radius * a.sin(), z];
    (0..=12).map(angle).map(place).collect()
}

fn scene(first: &str, second: &str, rest: &str) -> String {
    format!(
        "version = 1\n[sheet]\nmaterial = \"card\"\n[sheet.mesh.strip_between]\nfirst = {first}\nsecond = {second}\n{rest}\n"
    )
}

/// The strip of a scene is that of the generator in its place in space, from lists of points and from files, and
/// its lengths at rest are those that it starts with.
#[test]
fn strips_are_those_of_the_generator() {
    let [first, second] = [arc(0.1, 0.0), arc(0.06, 0.08)];
    let expected = strip_between(&first, &second, 8, 2).unwrap().sheet;
    let folder = tempfile::tempdir().unwrap();
    let lines = |points: &[[f64; 3]]| -> String {
        let line = |[x, y, z]: &[f64; 3]| format!("{} {} {}\n", 1e3 * x, 1e3 * y, 1e3 * z);
        points.iter().map(line).collect()
    };
    fs::write(folder.path().join("first.txt"), lines(&first)).unwrap();
    let [points, others] = [&first, &second].map(|points| format!("{points:?}"));
    let file = "{ path = \"first.txt\", scale = 0.001 }";
    for first in [&points[..], file] {
        let text = scene(first, &others, "columns = 8\nrows = 2");
        let scene = SceneFile::parse(text, &folder.path().join("scene.toml"), &[]);
        let setup = scene.unwrap().build().unwrap_or_else(|e| panic!("{e}"));
        let pairs = setup.sheet.positions().iter().zip(expected.positions());
        pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-12));
        assert_eq!(setup.sheet.face_indices(), expected.face_indices());
        assert_eq!(setup.start.x, setup.sheet.positions());
    }
    // It springs towards the plane, as the material is flat at rest.
    let mut run = simulation(&scene(&points, &others, "columns = 8\nrows = 2"));
    for _ in 0..3 {
        run.step(1e-3).unwrap();
    }
    let moved = run.state().x.iter().zip(expected.positions());
    let most = moved.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(most > 1e-6 && most < 0.1, "{most}");
}

/// What is wrong is told at its key.
#[test]
fn bad_curves_are_named() {
    let [first, second] = [arc(0.1, 0.0), arc(0.06, 0.08)].map(|points| format!("{points:?}"));
    for (first, second, rest, expected) in [
        ("[[0, 0, 0]]", &second[..], "columns = 8", "first"),
        ("[[0, 0, 0], [0, 0, 0]]", &second, "columns = 8", "first"),
        (&first, "[[0, 0, 0], [nan, 0, 0]]", "columns = 8", "second"),
        (
            &first,
            "{ path = \"\" }",
            "columns = 8",
            "the path is empty",
        ),
        (
            &first,
            "{ path = \"none.csv\" }",
            "columns = 8",
            "second.path",
        ),
        (
            &first,
            "{ path = \"a.csv\", scale = 0 }",
            "columns = 8",
            "second.scale",
        ),
        (&first, &second, "columns = 0", "columns"),
        (&first, &second, "columns = 8\nrows = 0", "rows"),
        (&first, &first, "columns = 8", "strip_between"),
    ] {
        let text = scene(first, second, rest);
        let error = match parse(&text) {
            Ok(scene) => scene.build().map(|_| ()).unwrap_err().to_string(),
            Err(error) => error.to_string(),
        };
        assert!(error.contains(expected), "{text}\n{error}");
    }
    let words = scene("\"lower.csv\"", &second, "columns = 8");
    let error = parse(&words).unwrap_err().to_string();
    assert!(error.contains("first"), "{error}");
}
