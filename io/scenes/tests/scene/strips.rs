//! Strips between two curves as meshes of scenes.

use crate::{parse, simulation};
use isosheet_mesh::generate::strip_between;
use isosheet_scenes::{SceneFile, SceneFileError};
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

/// The strip of a scene is the strip of the generator in its place in space, from lists of points and from
/// files. Its lengths at rest are its lengths at the start.
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

/// What is wrong is told at its key, with what to do.
#[test]
fn bad_curves_are_named() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("folder.csv")).unwrap();
    for (name, text) in [
        ("empty.csv", ""),
        ("words.csv", "0 0 0\n1 two 3\n"),
        ("good.csv", "0 0 0\n1 0 0\n"),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let [first, second] = [arc(0.1, 0.0), arc(0.06, 0.08)].map(|points| format!("{points:?}"));
    let file = |path: &str| format!("{{ path = {path:?} }}");
    let columns = "columns = 8";
    let mut cases = vec![
        ("[[0, 0, 0]]".to_owned(), second.clone(), columns, "first"),
        (
            "[[0, 0, 0], [0, 0, 0]]".to_owned(),
            second.clone(),
            columns,
            "first",
        ),
        (
            first.clone(),
            "[[0, 0, 0], [nan, 0, 0]]".to_owned(),
            columns,
            "second[1][0]",
        ),
        (
            first.clone(),
            "{ path = \"good.csv\", scale = 0 }".to_owned(),
            columns,
            "second.scale",
        ),
        (first.clone(), second.clone(), "columns = 0", "columns"),
        (
            first.clone(),
            second.clone(),
            "columns = 8\nrows = 0",
            "rows",
        ),
        (first.clone(), first.clone(), columns, ""),
    ];
    for name in ["", "none.csv", "folder.csv", "empty.csv", "words.csv"] {
        cases.push((first.clone(), file(name), columns, "second.path"));
        cases.push((file(name), second.clone(), columns, "first.path"));
    }
    for (first, second, rest, key) in cases {
        let text = scene(&first, &second, rest);
        let read = SceneFile::parse(text.clone(), &folder.path().join("test.toml"), &[]);
        let error = match read.map(|file| file.build()) {
            Err(SceneFileError::Scene(error)) | Ok(Err(error)) => error,
            other => panic!("{text}: {other:?}"),
        };
        let placed = error.placed();
        let whole = format!("sheet.mesh.strip_between.{key}");
        assert_eq!(placed[0].key, whole.trim_end_matches('.'), "{error}");
        assert!(error.to_string().contains("= help: "), "{error}");
    }
    let words = parse(&scene("\"lower.csv\"", &second, columns));
    let error = words.unwrap_err().to_string();
    assert!(
        error.contains("first = \"lower.csv\"") && error.contains("`path`"),
        "{error}"
    );
}
