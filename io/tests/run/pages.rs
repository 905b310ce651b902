//! The pages of runs.

use crate::headless::self_test;
use crate::skip::data_folder;
use crate::{code, killed, run, stderr, stdout, summary, with_scene};
use isosheet_formats::write_obj;
use isosheet_mesh::generate;
use isosheet_page::{BodyShape, Replay};
use isosheet_runs::{Recording, Tick, simulate_recorded};
use isosheet_scenes::{SceneFile, StartingPoint};
use serde_json::Value;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

/// The data of a page.
fn data(page: &Path) -> Value {
    let page = fs::read_to_string(page).unwrap();
    let (_, rest) = page.split_once("id=\"replay\">").unwrap();
    let (json, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(json).unwrap()
}

fn replay(folder: &Path) -> Replay {
    Recording::read(folder).unwrap().replay().unwrap()
}

/// The value of a row of the summary.
fn row<'a>(data: &'a Value, name: &str) -> Option<&'a str> {
    let rows = data["summary"].as_array().unwrap().iter();
    let mut named = rows.filter(|row| row[0] == name);
    named.next().and_then(|row| row[1].as_str())
}

#[test]
fn a_run_ends_with_its_page_which_can_be_made_again() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let done = run(dir, &["simulate", "scene.toml", "--json"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let last = String::from_utf8_lossy(&done.stdout);
    let event: Value = serde_json::from_str(last.lines().last().unwrap()).unwrap();
    assert_eq!(event["page"], "scene-run/index.html");
    let page = dir.join("scene-run/index.html");
    let made = fs::read(&page).unwrap();
    fs::remove_file(&page).unwrap();
    let again = run(dir, &["page", "scene-run"]);
    assert_eq!(code(&again), Some(0), "{}", stderr(&again));
    assert!(stdout(&again).contains("scene-run/index.html"));
    assert!(fs::read(&page).unwrap() == made, "another page");

    let data = data(&page);
    assert_eq!(data["title"], "scene");
    assert_eq!(
        row(&data, "modelled"),
        Some("velocity damping, 2 creases, rigid rods")
    );
    assert_eq!(
        row(&data, "ended"),
        Some("at 1.5000 s: the whole time has passed")
    );
    let rejected = summary(&dir.join("scene-run")).rejected;
    let steps = format!("90, {rejected} rejected");
    assert_eq!(row(&data, "steps"), Some(steps.as_str()));
    assert!(data["scene"].as_str().unwrap().contains("[sheet]"));
    let series = data["series"].as_array().unwrap().iter();
    let names: Vec<_> = series.map(|s| s["name"].as_str().unwrap()).collect();
    for name in [
        "kinetic energy",
        "largest strain",
        "factorisations",
        "rejected",
    ] {
        assert!(names.contains(&name), "{name} is not in {names:?}");
    }
    assert!(!names.contains(&"smallest gap"), "a run without contact");

    let none = run(dir, &["page", "."]);
    assert_eq!(code(&none), Some(3), "{}", stderr(&none));
    let small = run(dir, &["page", "scene-run", "--budget", "1000"]);
    assert_eq!(code(&small), Some(3), "{}", stderr(&small));
    assert!(
        stderr(&small).contains("raise the budget"),
        "{}",
        stderr(&small)
    );
    assert!(
        fs::read(&page).unwrap() == made,
        "a failure changed the page"
    );
}

#[test]
fn a_scene_can_do_without_a_page() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let without = ["simulate", "scene.toml", "--set", "output.page=false"];
    let done = run(dir, &without);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    assert!(!dir.join("scene-run/index.html").exists());
    assert!(!stdout(&done).contains("page:"), "{}", stdout(&done));
    fs::write(dir.join("mine.txt"), "dear").unwrap();
    for (file, part) in [
        ("mine.txt", "is a file that is no page"),
        ("scene-run/history.csv", "is a file of the run in"),
    ] {
        let refused = run(dir, &["page", "scene-run", "--out", file]);
        assert_eq!(code(&refused), Some(2), "{}", stderr(&refused));
        assert!(stderr(&refused).contains(part), "{}", stderr(&refused));
    }
    let made = run(dir, &["page", "scene-run", "--out", "mine.html"]);
    assert_eq!(code(&made), Some(0), "{}", stderr(&made));
    assert_eq!(data(&dir.join("mine.html"))["frames"], 46);
}

#[test]
fn a_run_that_was_killed_has_a_page_up_to_there() {
    let dir = with_scene(StartingPoint::Drape);
    let dir = dir.path();
    let scene = ["simulate", "scene.toml", "--set", "stop.time=30"];
    killed(dir, &scene, "scene-run", 20);
    let made = run(dir, &["page", "scene-run"]);
    assert_eq!(code(&made), Some(0), "{}", stderr(&made));
    let data = data(&dir.join("scene-run/index.html"));
    assert!(
        row(&data, "state")
            .unwrap()
            .starts_with("not complete: up to 0.")
    );
    assert_eq!(row(&data, "wall time"), None);
    // A frame after every second step of 1/60 s.
    let frames = data["frames"].as_u64().unwrap();
    assert!((10..900).contains(&frames), "{frames}");
}

/// A scene with every body, every curve and every surface: the left half of a sheet lies still, the right
/// half is held by one vertex each.
const EVERYTHING: &str = r#"version = 1
[sheet]
mesh = { rectangle = { width = 2.0, height = 1.0, columns = 4, rows = 2 } }
[[support]]
at = { vertices = [0, 5] }
[[support]]
at = { vertices = [2] }
hold = { curve = { shape = { line = { point = [1, 0, 0], direction = [0, 1, 0] } } } }
[[support]]
at = { vertices = [4] }
hold = { curve = { shape = { circle = { centre = [2, 0, -0.5], normal = [0, 1, 0], radius = 0.5 } } } }
[[support]]
at = { vertices = [7] }
hold = { curve = { shape = { polyline = { points = [[1, 0, 0], [1, 1, 0], [1, 1, 1]], corner_radius = 0.1 } } } }
[[support]]
at = { vertices = [9] }
hold = { curve = { shape = { spline = { points = [[2, 0.5, 0], [2, 1, -0.5], [2.5, 1, -1]] } } } }
[[support]]
at = { vertices = [12] }
hold = { curve = { shape = { closed_spline = { points = [[1, 1, 0], [1.5, 1.5, 0], [1, 2, 0], [0.5, 1.5, 0]] } } } }
[[support]]
at = { vertices = [14] }
hold = { surface = { shape = { plane = { point = [2, 1, 0], normal = [0, 1, 0] } }, side = "outside" } }
[[support]]
at = { vertices = [13] }
hold = { surface = { shape = { sphere = { centre = [1.5, 1, -0.4], radius = 0.4 } } } }
[[support]]
at = { vertices = [11] }
hold = { surface = { shape = { cylinder = { point = [0.5, 0, -0.2], axis = [0, 1, 0], radius = 0.2 } } } }
[[obstacle]]
shape = "half_space"
pose = { position = [0, 0, -1.5] }
[[obstacle]]
shape = { box = { size = [0.4, 0.3, 0.2] } }
pose = { position = [0.2, -0.4, -1] }
[[obstacle]]
shape = { sphere = { radius = 0.2 } }
pose = { position = [0.5, 0.3, 0.6] }
motion = { z = { ramp = { to = 0.1, end = 0.1 } } }
[[obstacle]]
shape = { cylinder = { radius = 0.1, height = 0.4 } }
pose = { position = [1.4, -0.4, -1] }
[[obstacle]]
shape = { capsule = { radius = 0.1, length = 0.3 } }
pose = { position = [2.0, -0.4, -1] }
[[obstacle]]
shape = { file = { path = "tool.obj" } }
pose = { position = [2.2, 0.0, 0.7] }
[stop]
time = 0.1
"#;

/// The first row of a square of rods and the next vertex of its side are pinned: three more vertices cannot
/// move.
const CLAMPED: &str = r#"version = 1
[sheet]
mesh = { square = { level = 1, side = 1.0 } }
[[support]]
at = { vertices = [0, 1, 2, 3, 4, 5] }
[stop]
time = 0.02
"#;

#[test]
fn vertices_that_rods_keep_in_place_are_on_the_page() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("clamped.toml"), CLAMPED).unwrap();
    let done = run(dir, &["simulate", "clamped.toml"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let shown = replay(&dir.join("clamped-run"));
    assert_eq!(shown.immobile.len(), 3, "{:?}", shown.immobile);
    for v in &shown.immobile {
        let at = |x: &[f64]| x[3 * *v as usize..][..3].to_vec();
        assert!(
            shown
                .positions
                .iter()
                .all(|x| at(x) == at(&shown.positions[0]))
        );
    }
}

#[test]
fn bodies_curves_and_surfaces_are_on_the_page() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let tool = generate::isotropic_square(1, 0.4).unwrap();
    write_obj(&dir.join("tool.obj"), tool.topology(), tool.positions()).unwrap();
    fs::write(dir.join("all.toml"), EVERYTHING).unwrap();
    let done = run(dir, &["simulate", "all.toml"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let shown = replay(&dir.join("all-run"));
    assert_eq!(shown.pins, [0, 5]);
    let names: Vec<_> = shown.bodies.iter().map(|b| b.name.clone()).collect();
    let obstacles = (0..6).map(|k| format!("obstacle[{k}]"));
    let supports = (1..9).map(|k| format!("support[{k}]"));
    assert_eq!(names, obstacles.chain(supports).collect::<Vec<_>>());
    let BodyShape::Cuboid { half } = shown.bodies[1].shape else {
        panic!("{:?}", shown.bodies[1])
    };
    assert_eq!(half, [0.2, 0.15, 0.1]);
    // The ball moves and nothing else does; distances from the bodies are those from the nearest.
    let moving = shown.bodies.iter().filter(|b| b.poses.len() > 1);
    assert_eq!(moving.count(), 1);
    let distances = shown.fields.iter().find(|f| f.name.starts_with("distance"));
    let distances = &distances.unwrap().values;
    for ((t, pose), of_frame) in shown
        .times
        .iter()
        .zip(&shown.bodies[2].poses)
        .zip(distances)
    {
        let ball = [0.5, 0.3, 0.6 + t.min(0.1)];
        assert!((pose.translation[2] - ball[2]).abs() < 1e-15);
        // Vertex 6 is at rest at (0.5, 0.5, 0), near the ball and far from the other bodies.
        let k = shown.times.iter().position(|s| s == t).unwrap();
        let x = &shown.positions[k][18..21];
        let square: f64 = x.iter().zip(ball).map(|(a, b)| (a - b) * (a - b)).sum();
        let expected = square.sqrt() - 0.2;
        assert!(
            (of_frame[6] - expected).abs() < 1e-14,
            "{} at {t}",
            of_frame[6]
        );
    }
    let page = fs::read_to_string(dir.join("all-run/index.html")).unwrap();
    let Some(result) = self_test(&page, "1200,800") else {
        return;
    };
    for body in result["bodies"].as_array().unwrap() {
        assert_eq!(body["shows"], true, "{body}");
    }
    assert_eq!(result["exceptions"], serde_json::json!([]));
}

/// The scene of the book with other people's meshes: a sheet that falls on a ball.
#[test]
fn meshes_of_other_people_become_a_page_in_one_command() {
    let Some(data) = data_folder() else {
        return;
    };
    let page = include_str!("../../../docs/own-mesh.md");
    let (_, scene) = page.split_once("```toml\nversion").unwrap();
    let (scene, _) = scene.split_once("```").unwrap();
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let meshes = [
        ("planar/square_delaunay_102v.obj", "cloth.obj"),
        ("tools/sphere_1k.obj", "table.obj"),
    ];
    for (from, to) in meshes {
        fs::copy(data.join(from), dir.join(to)).unwrap();
    }
    fs::write(dir.join("cloth.toml"), format!("version{scene}")).unwrap();
    let edits = [
        "sheet.mesh.file.scale=1.0",
        "sheet.placement.position=[0.0, -0.5, 0.51]",
    ];
    let done = run(
        dir,
        &[
            "simulate",
            "cloth.toml",
            "--set",
            edits[0],
            "--set",
            edits[1],
        ],
    );
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    assert!(stdout(&done).contains("page: cloth-run/index.html"));
    let kinds = kinds_of_bodies(&dir.join("cloth-run/index.html"));
    assert_eq!(kinds, ["mesh"]);
    let sheet = replay(&dir.join("cloth-run"));
    // It has fallen on the ball: nothing is inside, and the hem hangs below the top of the ball by a third of
    // the radius at least.
    let last = sheet.positions.last().unwrap();
    let lowest = last
        .iter()
        .skip(2)
        .step_by(3)
        .copied()
        .fold(f64::INFINITY, f64::min);
    assert!(lowest < 0.5 - 0.5 / 3.0, "{lowest}");
    let inside = last
        .as_chunks::<3>()
        .0
        .iter()
        .filter(|p| p.iter().map(|c| c * c).sum::<f64>().sqrt() < 0.49);
    assert_eq!(inside.count(), 0);
}

/// The kinds of the bodies on a page.
fn kinds_of_bodies(page: &Path) -> Vec<String> {
    let data = data(page);
    let bodies = data["bodies"].as_array().unwrap().iter();
    bodies
        .map(|b| b["shape"]["kind"].as_str().unwrap().to_owned())
        .collect()
}

/// The page and what a run returns are made of the rows in memory: here the files of the tables are gone at
/// its end.
#[test]
fn tables_are_not_read_back() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("run");
    let text = StartingPoint::Hanging.text().to_owned();
    let edits = ["stop.time=0.1".to_owned()];
    let file = SceneFile::parse(text, &dir.path().join("scene.toml"), &edits).unwrap();
    let mut take_away = |_: &Tick| {
        for name in ["history.csv", "loads.csv"] {
            let _ = fs::remove_file(folder.join(name));
        }
        ControlFlow::Continue(())
    };
    let recorded = simulate_recorded(&file, &folder, &mut take_away).unwrap();
    let recorded = recorded.expect("the run was not interrupted");
    let steps = recorded.summary.as_ref().unwrap().steps as usize;
    assert_eq!(recorded.history.len(), steps + 1);
    assert_eq!(recorded.loads.len(), steps);
    assert_eq!(
        recorded.trajectory.len() as u64,
        recorded.summary.unwrap().frames
    );
    assert!(folder.join("index.html").is_file());
    assert!(!folder.join("history.csv").exists());
}

/// A run that is continued in another process returns the rows of both.
#[test]
fn a_continued_run_returns_all_rows() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("run");
    let text = StartingPoint::Hanging.text().to_owned();
    let edits = ["stop.time=0.1".to_owned()];
    let file = SceneFile::parse(text, &dir.path().join("scene.toml"), &edits).unwrap();
    let mut stop = |tick: &Tick| match tick.steps {
        3 => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    };
    assert!(
        simulate_recorded(&file, &folder, &mut stop)
            .unwrap()
            .is_none()
    );
    let mut go_on = |_: &Tick| ControlFlow::Continue(());
    let recorded = simulate_recorded(&file, &folder, &mut go_on)
        .unwrap()
        .unwrap();
    let read = Recording::read(&folder).unwrap();
    assert_eq!(recorded.history, read.history);
    assert_eq!(recorded.loads, read.loads);
    assert_eq!(recorded.summary, read.summary);
    assert_eq!(recorded.trajectory, read.trajectory);
}
