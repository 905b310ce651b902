//! What is said of wrong scenes, and edits.

use crate::parse;
use isosheet_io::scene::{Key, PlacedProblem, SceneFile, SceneFileError};
use std::path::Path;

/// A scene of twelve lines that is right but for what an edit does to it.
const RIGHT: &str = "version = 1
[sheet]
mesh = { square = { side = 0.2, level = 1 } }
density = 0.1
[[support]]
at = { vertices = [0] }
[[obstacle]]
shape = { sphere = { radius = 0.1 } }
pose = { position = [0, 0, -1] }
[stop]
time = 0.1
";

fn problems(text: &str) -> Vec<PlacedProblem> {
    let error = match parse(text) {
        Err(SceneFileError::Scene(error)) => error,
        Err(other) => panic!("{other}"),
        Ok(scene) => match scene.build().and_then(|s| s.start()) {
            Err(error) => error,
            Ok(_) => panic!("accepted:\n{text}"),
        },
    };
    // File, marker and text are in the message.
    let shown = error.to_string();
    assert!(
        shown.contains("--> test.toml:") && shown.contains('^'),
        "{shown}"
    );
    error.placed()
}

/// What is replaced by what; line and column, parts of message and remedy.
type Wrong<'a> = (&'a str, &'a str, [usize; 2], &'a str, &'a str);

const WRONG: [Wrong<'_>; 20] = [
    (
        "density = 0.1",
        "densty = 0.1",
        [4, 1],
        "unknown key `densty`",
        "did you mean `density`?",
    ),
    (
        "radius = 0.1",
        "radus = 0.1",
        [8, 22],
        "unknown key `radus`",
        "did you mean `radius`?",
    ),
    (
        "sphere =",
        "sphre =",
        [8, 11],
        "unknown choice `sphre`",
        "did you mean `sphere`?",
    ),
    (
        "density = 0.1",
        "density = \"x\"",
        [4, 11],
        "expected a number",
        "without quotes",
    ),
    (
        "level = 1",
        "level = -1",
        [3, 41],
        "found the number `-1`",
        "of at least 0",
    ),
    (
        "density = 0.1",
        "density = -1",
        [4, 11],
        "-1 kg/m2",
        "above 0",
    ),
    (
        "density = 0.1",
        "density = nan",
        [4, 11],
        "NaN kg/m2",
        "above 0",
    ),
    (
        "radius = 0.1",
        "radius = 0",
        [8, 31],
        "radius` is 0 m",
        "above 0",
    ),
    ("level = 1", "level = 40", [3, 41], "level is 40", ""),
    (
        "vertices = [0]",
        "vertices = [0, 25]",
        [6, 23],
        "no vertex 25",
        "0 to 24",
    ),
    (
        "vertices = [0]",
        "vertices = []",
        [6, 6],
        "no vertex",
        "compare the region",
    ),
    (
        "version = 1",
        "version = 2",
        [1, 11],
        "version 2",
        "version = 1",
    ),
    ("version = 1", "", [1, 1], "`version` is missing", "add it"),
    (
        "time = 0.1",
        "time = 0.1\n[stop]",
        [12, 2],
        "duplicate key",
        "toml.io",
    ),
    ("time = 0.1", "time = inf", [11, 8], "inf s", "above 0"),
    (
        "square = { side = 0.2, level = 1 }",
        "file = { path = \"no.obj\" }",
        [3, 26],
        "no.obj",
        "relative",
    ),
    (
        "[0, 0, -1]",
        "[0, 0, 0]",
        [7, 1],
        "touches the sheet at vertex",
        "move the obstacle",
    ),
    (
        "[0, 0, -1]",
        "[0, 0]",
        [9, 21],
        "expected a list of length 3, found a list of length 2",
        "in brackets",
    ),
    (
        "vertices = [0] }",
        "vertices = [0] }\nhold = { moving_pin = { x = { ramp = { to = 1, end = -1 } } } }",
        [7, 54],
        "ends at -1 s",
        "",
    ),
    (
        "vertices = [0] }",
        "vertices = [0] }\nhold = { moving_pin = { x = 0.5 } }",
        [7, 8],
        "0.5",
        "zero at the start",
    ),
];

#[test]
fn wrong_scenes_are_told_where_and_what_to_do() {
    parse(RIGHT)
        .unwrap()
        .build()
        .unwrap()
        .start()
        .map(|_| ())
        .unwrap();
    let mut misses = Vec::new();
    for (right, wrong, place, message, remedy) in WRONG {
        assert!(RIGHT.contains(right), "{right}");
        let found = problems(&RIGHT.replacen(right, wrong, 1));
        let about = &found[0];
        let help = about.remedy.as_deref().unwrap_or_default();
        let as_expected = found.len() == 1
            && [about.line, about.column] == place.map(Some)
            && about.message.contains(message)
            && help.contains(remedy);
        if !as_expected {
            misses.push(format!("{wrong}: {found:?}"));
        }
    }
    assert!(misses.is_empty(), "{}", misses.join("\n"));
}

#[test]
fn all_range_errors_are_reported_at_once() {
    let wrong = RIGHT
        .replace("density = 0.1", "density = 0")
        .replace("radius = 0.1", "radius = -3")
        .replace("time = 0.1", "time = 0");
    let keys: Vec<String> = problems(&wrong).into_iter().map(|p| p.key).collect();
    let expected = [
        "sheet.density",
        "obstacle[0].shape.sphere.radius",
        "stop.time",
    ];
    assert_eq!(keys, expected);
}

#[test]
fn methods_that_do_not_fit_and_double_supports_are_refused() {
    let rattle = format!("{RIGHT}[method]\nintegrator = \"rattle\"\n");
    let found = problems(&rattle);
    assert!(found[0].message.contains("contact"), "{found:?}");
    assert_eq!(found[0].line, Some(13));
    let twice = RIGHT.replace(
        "[[obstacle]]",
        "[[support]]\nat = \"all\"\nhold = { moving_pin = {} }\n[[obstacle]]",
    );
    let found = problems(&twice);
    assert_eq!(
        (found[0].line, found[0].key.as_str()),
        (Some(8), "support[1].at")
    );
    assert!(found[0].message.contains("`support[0]`"), "{found:?}");
}

#[test]
fn edits_reach_every_place_and_keep_the_rest() {
    let edits = [
        "stop.time = 0.5",
        "obstacle[0].shape.sphere.radius=0.25",
        "support.0.at.vertices[0]=3",
        "method.integrator=implicit_euler",
        "forces.gravity=[0, 0, -1]",
    ];
    let edits = edits.map(str::to_owned);
    let path = Path::new("test.toml");
    let edited = SceneFile::parse(RIGHT.into(), path, &edits).unwrap();
    let by_hand = RIGHT
        .replace("time = 0.1", "time = 0.5")
        .replace("radius = 0.1", "radius = 0.25")
        .replace("[0] }", "[3] }")
        + "[method]\nintegrator = \"implicit_euler\"\n[forces]\ngravity = [0, 0, -1]\n";
    assert_eq!(edited.scene(), parse(&by_hand).unwrap().scene());
    for wrong in [
        "stop",
        "=3",
        "stop..time=3",
        "obstacle[1].friction=1",
        "stop.time.x=1",
    ] {
        let refused = SceneFile::parse(RIGHT.into(), path, &[wrong.to_owned()]);
        let Err(SceneFileError::Edit(error)) = refused else {
            panic!("{wrong}: {refused:?}");
        };
        assert!(error.to_string().contains(wrong), "{error}");
    }
    assert_eq!(
        Key::root().name("a.b").entry(2).name("c").to_string(),
        "a.b[2].c"
    );
}

#[test]
fn whole_numbers_beyond_those_of_toml_are_refused() {
    let mesh = "rectangle = { width = 1, height = 1, columns = 18446744073709551615, rows = 1 }";
    let seed = "polygon = { outline = [[0, 0], [1, 0], [0, 1]], spacing = 0.5, seed = 9223372036854775808 }";
    for (mesh, part) in [
        (mesh, "give at most 9223372036854775807"),
        (seed, "whole numbers go up to"),
    ] {
        let error = parse(&format!("version = 1\n[sheet]\nmesh = {{ {mesh} }}\n")).unwrap_err();
        assert!(error.to_string().contains(part), "{error}");
    }
}
