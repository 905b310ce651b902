//! Angles and moments of creases as measures.

use crate::{code, run, stderr, summary};
use isosheet_formats::{MeasureRow, SeriesOptions, read_measures};
use isosheet_mesh::{EdgeId, fold_angle};
use isosheet_runs::Recording;
use std::fs;

/// Stiffness of the crease, N, and its length, m.
const STIFFNESS: f64 = 0.04;
const LENGTH: f64 = 0.5;

/// Two triangles that meet along y in a valley of some degrees and are held there, while the crease between
/// them is driven to a mountain; a second sheet, which has no crease, is the first one.
fn scene(degrees: f64, of_crease: &str) -> String {
    let (s, c) = degrees.to_radians().sin_cos();
    format!(
        "version = 1
[[sheet]]
name = \"flat\"
mesh = {{ square = {{ side = 0.1, level = 0 }} }}
mass = 0.01
placement = {{ position = [2, 0, 0] }}
[[sheet]]
name = \"folded\"
mesh = {{ triangles = {{ vertices = [[0, 0, 0], [0, {LENGTH}, 0], [0.3, 0.2, 0], [{x}, 0.2, {z}]], \
         faces = [[0, 2, 1], [0, 1, 3]] }} }}
mass = 0.01
[[crease]]
name = \"lid\"
sheet = \"folded\"
at = {{ ends = [[0, 1]] }}
stiffness = {STIFFNESS}
angle = {{ ramp = {{ to = -90, end = 1 }} }}
{of_crease}
[[support]]
sheet = \"folded\"
at = \"all\"
hold = \"pin\"
[[support]]
sheet = \"flat\"
at = {{ vertices = [0] }}
hold = \"pin\"
[[measure]]
name = \"angle\"
crease = \"lid\"
quantity = \"fold_angle\"
[[measure]]
name = \"moment\"
crease = \"lid\"
quantity = \"moment\"
[[measure]]
name = \"per-metre\"
crease = \"lid\"
quantity = \"moment_per_length\"
[method]
step = 0.05
[stop]
time = 1
",
        x = -0.3 * c,
        z = 0.3 * s
    )
}

/// The measures of a run.
fn rows(text: &str) -> Vec<MeasureRow> {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("lid.toml"), text).unwrap();
    let done = run(dir, &["simulate", "lid.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    read_measures(&dir.join("run/measures.csv")).unwrap()
}

/// The moment at a difference of the angles, degrees, up to the one at which the crease yields.
fn check(of_crease: &str, moment: impl Fn(f64) -> f64) {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("lid.toml"), scene(30.0, of_crease)).unwrap();
    let done = run(dir, &["simulate", "lid.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let rows = read_measures(&dir.join("run/measures.csv")).unwrap();
    assert_eq!(rows.len(), 21 * 3);
    for row in &rows {
        let exact = match row.name.as_str() {
            "angle" => 30.0,
            "moment" => LENGTH * moment(30.0 + 90.0 * row.t),
            _ => moment(30.0 + 90.0 * row.t),
        };
        assert!((row.value - exact).abs() < 1e-12, "{row:?}: {exact}");
    }
    let recording = Recording::read(&dir.join("run")).unwrap();
    let series = recording.replay().unwrap().series;
    for (name, unit) in [("angle", "degrees"), ("moment", "N m"), ("per-metre", "N")] {
        let shown = series.iter().find(|s| s.name == name).unwrap();
        assert_eq!(shown.unit, unit);
    }
    let last = summary(&dir.join("run")).measures["moment"].last;
    assert!((last - LENGTH * moment(120.0)).abs() < 1e-12);
}

#[test]
fn the_moment_of_a_crease_is_its_stiffness_by_its_length_and_its_angle_from_rest() {
    check("", |degrees| STIFFNESS * degrees.to_radians());
}

/// What a crease carries at most is what it yields at.
#[test]
fn the_moment_of_a_crease_that_yields_is_bounded() {
    let most = 0.05;
    check(&format!("yield = {{ moment = {most} }}"), |degrees| {
        (STIFFNESS * degrees.to_radians()).min(most)
    });
}

/// A fold that is held at a valley of 170 degrees is, for a crease that is driven to a mountain beyond -10
/// degrees, one of -190.
#[test]
fn the_angle_of_a_crease_goes_on_beyond_half_a_turn() {
    let text = scene(170.0, "").replace("to = -90, end = 1", "to = -340, end = 1");
    for row in rows(&text) {
        let (angle, rest) = (
            if 340.0 * row.t > 10.0 { -190.0 } else { 170.0 },
            -340.0 * row.t,
        );
        let exact = match row.name.as_str() {
            "angle" => angle,
            "moment" => LENGTH * STIFFNESS * f64::to_radians(angle - rest),
            _ => STIFFNESS * f64::to_radians(angle - rest),
        };
        assert!((row.value - exact).abs() < 1e-9, "{row:?}: {exact}");
    }
}

#[test]
fn a_measure_is_of_vertices_or_of_a_crease() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    for (from, to, told) in [
        (
            "crease = \"lid\"\nquantity = \"moment\"",
            "crease = \"lit\"\nquantity = \"moment\"",
            "no crease has the name `lit`",
        ),
        (
            "quantity = \"moment\"",
            "quantity = \"x\"",
            "this quantity is one of vertices",
        ),
        (
            "crease = \"lid\"\nquantity = \"moment\"",
            "at = \"all\"\nquantity = \"moment\"",
            "this quantity is one of a crease",
        ),
        (
            "quantity = \"moment\"",
            "sheet = \"flat\"\nquantity = \"moment\"",
            "a crease is of one sheet",
        ),
        (
            "[[support]]\nsheet = \"flat\"",
            "[[crease]]\nname = \"lid\"\nsheet = \"flat\"\nat = { ends = [[0, 4]] }\nstiffness = 1\n[[support]]\nsheet = \"flat\"",
            "another crease has the name `lid`",
        ),
    ] {
        let text = scene(30.0, "");
        assert!(text.contains(from), "{from}");
        fs::write(dir.join("lid.toml"), text.replacen(from, to, 1)).unwrap();
        let done = run(dir, &["check", "lid.toml"]);
        let said = stderr(&done);
        assert!(
            code(&done) != Some(0) && said.contains(told),
            "{told}: {said}"
        );
    }
}

/// Creases that `[folding]` folds are measured by the groups of its order, in the scene that `isosheet fold`
/// writes.
#[test]
fn creases_of_patterns_are_measured_in_scenes_of_fold() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let strip = "1 0 0 3 0\n1 3 0 3 1\n1 3 1 0 1\n1 0 1 0 0\n3 1 0 1 1\n2 2 0 2 1\n";
    fs::write(dir.join("strip.cp"), strip).unwrap();
    let folded = run(
        dir,
        &[
            "fold",
            "strip.cp",
            "out",
            "--part",
            "0.25",
            "--scene",
            "strip.toml",
        ],
    );
    assert_eq!(code(&folded), Some(0), "{}", stderr(&folded));
    let text = fs::read_to_string(dir.join("strip.toml")).unwrap();
    let measure = |name: &str, of: &str, quantity: &str| {
        format!("[[measure]]\nname = \"{name}\"\nfold = {of}\nquantity = \"{quantity}\"\n")
    };
    let measured = [
        measure("valley", "\"valleys\"", "fold_angle"),
        measure("mountain", "\"mountains\"", "fold_angle"),
        measure("moment", "\"valleys\"", "moment"),
        measure("per-metre", "\"valleys\"", "moment_per_length"),
    ];
    fs::write(
        dir.join("measured.toml"),
        format!("{text}\n{}", measured.concat()),
    )
    .unwrap();
    let done = run(dir, &["simulate", "measured.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let rows = read_measures(&dir.join("run/measures.csv")).unwrap();
    let of = |name: &str| -> Vec<f64> {
        let own = rows.iter().filter(|row| row.name == name);
        own.map(|row| row.value).collect()
    };
    let last = |name: &str| *of(name).last().unwrap();
    // A quarter of 180 degrees to either side, at rest.
    let angles = ["valley", "mountain"].map(last);
    assert!((angles[0] - 45.0).abs() < 0.1, "{angles:?}");
    assert!((angles[1] + 45.0).abs() < 0.1, "{angles:?}");
    // The springs lead by a moment on the way, over the 0.2 m / 3 of the crease.
    let most = of("moment").iter().map(|m| m.abs()).fold(0.0, f64::max);
    assert!(most > 0.0 && last("moment").abs() < 0.1 * most, "{most}");
    for (whole, per_metre) in of("moment").iter().zip(of("per-metre")) {
        let expected = whole / (0.2 / 3.0);
        assert!(
            (per_metre - expected).abs() <= 1e-9 * expected.abs(),
            "{per_metre} {expected}"
        );
    }
    let refused = |measure: String, expected: &str| {
        fs::write(dir.join("wrong.toml"), format!("{text}\n{measure}")).unwrap();
        let checked = run(dir, &["simulate", "wrong.toml", "--out", "no"]);
        assert_eq!(code(&checked), Some(3), "{}", stderr(&checked));
        assert!(stderr(&checked).contains(expected), "{}", stderr(&checked));
    };
    refused(
        measure("a", "{ edges = [0] }", "fold_angle"),
        "no crease that is driven is one of these",
    );
    refused(
        measure("a", "{ drawn = [\"red\"] }", "fold_angle"),
        "does not say which lines",
    );
    refused(
        measure("a", "\"valleys\"", "x"),
        "this quantity is one of vertices",
    );
}

/// Office paper with a crease of 0.05 N across, which a moment of 2e-4 N m bends. Its strip of 0.05 m turns
/// the crease by `M / (k L)` on every mesh, though the faces beside it bend by more on coarse ones; the
/// crease carries the moment of its law to round-off. Meshes, exports and the page say the same.
#[test]
fn the_angle_of_a_crease_is_its_kink_on_every_mesh() {
    let exact = 2e-4_f64 / (0.05 * 0.05);
    let mut bends = Vec::new();
    for columns in [10, 20, 40] {
        let text = format!(
            "version = 1
[sheet]
mesh = {{ rectangle = {{ width = 0.2, height = 0.05, columns = {columns}, rows = 4, diagonals = \"rising\" }} }}
material = \"office paper\"
damping = 10
[[crease]]
name = \"lid\"
at = {{ line = {{ from = [0.1, 0, 0], to = [0.1, 0.05, 0] }} }}
stiffness = 0.05
[[support]]
at = {{ half_space = {{ point = [1e-6, 0, 0], normal = [-1, 0, 0] }} }}
hold = \"clamp\"
[[forces.moment]]
at = {{ half_space = {{ point = [0.1999, 0, 0], normal = [1, 0, 0] }} }}
axis = [0, -1, 0]
size = {{ smooth_step = {{ to = 2e-4, end = 1.0 }} }}
{}{}[stop]
time = 3
",
            measure("angle", "fold_angle"),
            measure("moment", "moment")
        );
        let dir = tempfile::tempdir().unwrap();
        let dir = dir.path();
        fs::write(dir.join("lid.toml"), text).unwrap();
        let done = run(dir, &["simulate", "lid.toml", "--out", "run"]);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        let summary = summary(&dir.join("run"));
        let [angle, moment] = ["angle", "moment"].map(|name| summary.measures[name].last);
        let kink = angle.to_radians();
        assert!((kink / exact - 1.0).abs() < 0.01, "{columns}: {angle}");
        assert!(
            (moment / (0.05 * 0.05 * kink) - 1.0).abs() < 1e-12,
            "{moment}"
        );
        let recording = Recording::read(&dir.join("run")).unwrap();
        let (t, last) = (recording.sheet.topology(), recording.trajectory.len() - 1);
        let bend = recording.trajectory.crease_bends(last).unwrap();
        let creases: Vec<EdgeId> = t.edge_ids().filter(|e| bend[e.index()] != 0.0).collect();
        assert_eq!(creases.len(), 4);
        let series = recording.series(&SeriesOptions::default()).unwrap();
        let folds = series.fold_angles(last);
        let x = recording.trajectory.frame(last).unwrap();
        let mean = |values: &[f64]| creases.iter().map(|e| values[e.index()]).sum::<f64>() / 4.0;
        assert!((mean(&folds) - kink).abs() < 1e-13, "{}", mean(&folds));
        for e in t.edge_ids().filter(|e| !t.is_boundary_edge(*e)) {
            let whole = fold_angle(t, x, e).unwrap();
            assert!((folds[e.index()] + bend[e.index()] - whole).abs() < 1e-14);
        }
        let done = run(dir, &["convert", "run", "run.fold"]);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        let fold: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(dir.join("run.fold")).unwrap()).unwrap();
        let frames = fold["file_frames"].as_array().unwrap();
        let angles = frames.last().unwrap()["edges_foldAngle"]
            .as_array()
            .unwrap();
        let degrees: Vec<f64> = angles.iter().map(|a| a.as_f64().unwrap_or(0.0)).collect();
        assert!((mean(&degrees) - angle).abs() < 1e-11);
        let replay = recording.replay().unwrap();
        let of_page = &replay.fields[replay.bends.unwrap()].values[last];
        let shown: Vec<f64> = of_page.iter().map(|bend| bend.to_radians()).collect();
        assert!((mean(&shown) - mean(bend)).abs() < 1e-14);
        bends.push(mean(bend));
    }
    // The moment bends two halves of faces, whose size is halved: `M h / (D L)`.
    for (bend, columns) in bends.iter().zip([10.0, 20.0, 40.0]) {
        let expected = 2e-4 * (0.2 / columns) / (5e-4 * 0.05);
        assert!((bend / expected - 1.0).abs() < 0.01, "{columns}: {bend}");
    }
}

/// A measure of the crease of that scene.
fn measure(name: &str, quantity: &str) -> String {
    format!("[[measure]]\nname = \"{name}\"\ncrease = \"lid\"\nquantity = \"{quantity}\"\n")
}

/// Panels that do not bend have no bend beside creases, and frames of their runs have none.
#[test]
fn the_angle_between_flat_panels_is_the_kink() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("lid.toml"), scene(30.0, "")).unwrap();
    let done = run(dir, &["simulate", "lid.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let recording = Recording::read(&dir.join("run")).unwrap();
    assert_eq!(recording.trajectory.crease_bends(0), None);
    assert_eq!(recording.replay().unwrap().bends, None);
}
