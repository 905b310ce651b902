//! How runs end.

use crate::{code, isosheet, run, stderr, summary, with_scene};
use isosheet_formats::{frame_path, read_sheet};
use isosheet_runs::EndReason;
use isosheet_scenes::StartingPoint;
use serde_json::Value;
use std::fs;
use std::process::Stdio;

#[test]
fn conditions_to_stop_end_a_run() {
    let dir = with_scene(StartingPoint::Feed);
    let dir = dir.path();
    let limit = [
        "simulate",
        "scene.toml",
        "--out",
        "slip",
        "--set",
        "stop.support_force=0.0015",
    ];
    let done = run(dir, &limit);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let slip = summary(&dir.join("slip")).ending;
    assert_eq!(slip.reason, EndReason::SupportForce);
    let size = slip.supports[0].iter().map(|f| f * f).sum::<f64>().sqrt();
    assert!(slip.t < 0.9 && size > 0.0015, "{slip:?}");
    let scene = "version = 1
        [sheet]
        mesh = { rectangle = { width = 0.1, height = 0.1, columns = 1, rows = 1 } }
        damping = 40
        [[support]]
        at = { vertices = [2, 3] }
        [forces]
        gravity = [0, 0, -9.81]
        [stop]
        time = 10
        rest = { speed = 1e-4, duration = 0.1 }
        [output]
        obj = true
        trajectory = false";
    fs::write(dir.join("rest.toml"), scene).unwrap();
    let done = run(dir, &["simulate", "rest.toml", "--json"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let rest = summary(&dir.join("rest-run"));
    assert_eq!(rest.ending.reason, EndReason::Rest);
    assert!(rest.ending.t < 10.0 && rest.ending.largest_speed <= 1e-4);
    // Half the weight of the faces is at the two vertices that are pinned, all of it is carried by them.
    let weight = 0.08 * 0.01 * 9.81;
    assert!(
        (rest.ending.supports[0][2] - weight).abs() < 1e-3 * weight,
        "{rest:?}"
    );
    assert!(!dir.join("rest-run/trajectory.npz").exists());
    let last = frame_path(&dir.join("rest-run/obj"), rest.frames as usize - 1);
    let hanging = read_sheet(&last).unwrap();
    assert!(
        (hanging.positions()[2] + 0.1).abs() < 1e-4,
        "it hangs straight down"
    );
}

/// A sheet that rests until its support begins to move is not at its end.
#[test]
fn rest_before_a_motion_does_not_end_a_run() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let scene = "version = 1
        [sheet]
        mesh = { rectangle = { width = 0.1, height = 0.1, columns = 1, rows = 1 } }
        damping = 40
        [[support]]
        at = 'all'
        hold = { moving_pin = { z = { smooth_step = { to = 0.1, begin = 1, end = 1.5 } } } }
        [stop]
        time = 10
        rest = { speed = 1e-3, duration = 0.2 }";
    fs::write(dir.join("scene.toml"), scene).unwrap();
    let done = run(dir, &["simulate", "scene.toml", "--out", "run"]);
    assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    let ending = summary(&dir.join("run")).ending;
    assert_eq!(ending.reason, EndReason::Rest);
    assert!((1.7..1.8).contains(&ending.t), "{}", ending.t);
}

/// Motions that turn back within a step are refused, and seen with the step that the message asks for.
#[test]
fn motions_within_a_step_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let scene = |motion: &str| {
        format!(
            "version = 1
            [sheet]
            mesh = {{ rectangle = {{ width = 0.1, height = 0.1, columns = 1, rows = 1 }} }}
            [[obstacle]]
            shape = {{ box = {{ size = [1, 1, 1] }} }}
            pose = {{ position = [0, 0, -2] }}
            motion = {motion}"
        )
    };
    for (motion, key, step) in [
        (
            "{ z = { sine = { amplitude = 0.005, frequency = 60 } } }",
            "obstacle[0].motion.z",
            "0.00417",
        ),
        (
            "{ x = { keyframes = { keys = [[0.102, 0], [0.108, 0.3], [0.114, 0]] } } }",
            "obstacle[0].motion.x",
            "0.00833",
        ),
        (
            "{ rotation = { centre = [0, 0, 0], axis = [1, 0, 0], angle = { ramp = { to = 21600, end = 1 } } } }",
            "obstacle[0].motion.rotation.angle",
            "0.00833",
        ),
        (
            "{ poses = { keys = [{ position = [0, 0, 0] }, { time = 0.008, position = [0, 1, 0] }, \
             { time = 0.016, position = [0, 0, 0] }] } }",
            "obstacle[0].motion.poses.keys",
            "0.00833",
        ),
    ] {
        fs::write(dir.join("scene.toml"), scene(motion)).unwrap();
        let refused = run(dir, &["check", "scene.toml"]);
        let said = stderr(&refused);
        assert_ne!(code(&refused), Some(0), "{said}");
        let help = format!("take a `method.step` of {step} s or less");
        assert!(said.contains(key) && said.contains(&help), "{said}");
        let set = format!("method.step={step}");
        let done = run(dir, &["check", "scene.toml", "--set", &set]);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
    }
}

#[test]
fn steps_that_fail_are_told_at_the_scene() {
    let dir = with_scene(StartingPoint::Fold);
    let dir = dir.path();
    let scene = "version = 1
[sheet]
mesh = { rectangle = { width = 0.2, height = 0.1, columns = 2, rows = 1 } }
[[support]]
at = { vertices = [0, 3] }
[[support]]
at = { vertices = [2, 5] }
hold = { moving_pin = { x = { ramp = { to = 0.1, end = 1 } } } }
";
    fs::write(dir.join("taut.toml"), scene).unwrap();
    let failed = run(dir, &["simulate", "taut.toml"]);
    assert_eq!(code(&failed), Some(1), "{}", stderr(&failed));
    assert!(
        stderr(&failed).contains("--> taut.toml:8:8"),
        "{}",
        stderr(&failed)
    );
    let json = run(dir, &["simulate", "taut.toml", "--json"]);
    let last = String::from_utf8_lossy(&json.stdout);
    let error: Value = serde_json::from_str(last.lines().last().unwrap()).unwrap();
    assert_eq!(
        (&error["event"], &error["code"]),
        (&"error".into(), &1.into())
    );
    assert_eq!(error["problems"][0]["key"], "support[1].hold");
    let stop = [
        "simulate",
        "taut.toml",
        "--set",
        "method.taut=stop",
        "--out",
        "stop",
    ];
    let stopped = run(dir, &stop);
    assert_eq!(code(&stopped), Some(0), "{}", stderr(&stopped));
    assert_eq!(summary(&dir.join("stop")).ending.reason, EndReason::Taut);
}

/// Two clamps at the ends of a strip that move towards and through each other.
#[test]
fn clamps_that_are_driven_into_each_other_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let scene = "version = 1
[sheet]
mesh = { rectangle = { width = 0.2, height = 0.05, columns = 8, rows = 2 } }
bending = { plate = { rigidity = 5e-4 } }
damping = 5
start = { perturbation = 0.01, seed = 1 }
[[support]]
at = { box = { min = [-0.01, -1, -1], max = [0.03, 1, 1] } }
hold = { moving_pin = { x = { ramp = { to = 0.2, end = 1 } } } }
[[support]]
at = { box = { min = [0.17, -1, -1], max = [0.21, 1, 1] } }
hold = { moving_pin = { x = { ramp = { to = -0.2, end = 1 } } } }
[contact]
self_contact = true
[method]
step = 0.005
";
    fs::write(dir.join("clamps.toml"), scene).unwrap();
    let failed = run(dir, &["simulate", "clamps.toml"]);
    let said = stderr(&failed);
    assert_eq!(code(&failed), Some(1), "{said}");
    for part in [
        "`support[0]` and `support[1]` are driven into each other",
        "--> clamps.toml:12:8",
        "room between them",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    // No number of the message has more than three digits, or four before the point.
    let message = said.lines().find(|line| line.starts_with("error")).unwrap();
    let is_digit = |c: char| c.is_ascii_digit();
    for number in message.split(|c: char| !is_digit(c) && c != '.') {
        let digits = number.trim_matches('0').replace('.', "");
        let is_long = digits.trim_start_matches('0').len() > 3;
        assert!(!(number.contains('.') && is_long), "{number}: {message}");
    }
}

/// A held vertex cannot give way: the support, the obstacle and the depth are named, not the solver.
#[test]
fn a_pin_that_is_driven_into_a_floor_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let scene = "version = 1
[sheet]
mesh = { rectangle = { width = 0.2, height = 0.05, columns = 8, rows = 2 } }
material = \"cotton\"
[[support]]
at = { box = { min = [-1, -1, -1], max = [0.001, 1, 1] } }
hold = { moving_pin = { z = { ramp = { to = -0.1, end = 0.5 } } } }
[[obstacle]]
shape = \"half_space\"
pose = { position = [0, 0, -0.03] }
[stop]
time = 0.6
";
    fs::write(dir.join("floor.toml"), scene).unwrap();
    let refused = |edits: &[&str]| {
        let failed = run(dir, &[&["simulate", "floor.toml"], edits].concat());
        let said = stderr(&failed);
        assert_eq!(code(&failed), Some(1), "{said}");
        said
    };
    // Down onto the floor is too far: contact keeps a gap.
    let onto = [
        "--set",
        "support.0.hold.moving_pin.z.ramp.to=-0.03",
        "--out",
        "onto",
    ];
    let said = refused(&onto);
    assert!(said.contains("is driven into `obstacle[0]`"), "{said}");
    let said = refused(&[]);
    // At 0.2 m/s the floor is reached at 0.15 s; the step ends 1/60 s after that.
    for part in [
        "`support[0].hold.moving_pin` is driven into `obstacle[0]`: at 0.167 s",
        "0.00333 m inside",
        "--> floor.toml:7:23",
        "end its motion before that",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

/// A sheet of rods that is clamped across its mesh: `check` and `simulate` say so before the run, which is
/// refused with the remedy, after a bounded effort.
#[test]
fn a_sheet_that_locks_is_foretold_and_refused() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let scene = |support: &str| {
        format!(
            "version = 1
[sheet]
mesh = {{ square = {{ side = 1.0, level = 2 }} }}
mass = 0.1
bending = {{ hinges = {{ rigidity = 1e-2 }} }}
[[support]]
at = {{ half_space = {{ {support} }} }}
[forces]
gravity = [0.0, 0.0, -9.8]
[stop]
time = 0.1
"
        )
    };
    fs::write(
        dir.join("across.toml"),
        scene("point = [0.3, 0, 0], normal = [-1, -0.3, 0]"),
    )
    .unwrap();
    fs::write(
        dir.join("along.toml"),
        scene("point = [0.3, 0, 0], normal = [-1, 0, 0]"),
    )
    .unwrap();
    let told = "no line of edges of the mesh runs along the clamp by `support[0]`";
    for (name, locks) in [("across.toml", true), ("along.toml", false)] {
        let checked = run(dir, &["check", name]);
        assert_eq!(code(&checked), Some(0), "{}", stderr(&checked));
        assert_eq!(
            stderr(&checked).contains(told),
            locks,
            "{}",
            stderr(&checked)
        );
        let ended = run(dir, &["simulate", name]);
        let said = stderr(&ended);
        assert_eq!(code(&ended), Some(i32::from(locks)), "{said}");
        assert_eq!(said.contains(told), locks, "{said}");
        assert_eq!(said.contains("the sheet locks at t = "), locks, "{said}");
        assert_eq!(said.contains("which makes it elastic"), locks, "{said}");
    }
}

/// The straight edge of a banner that hangs by two corners cannot move: the engine holds its vertices, and
/// their forces belong to the corners. At rest the forces balance weight and torque: half of it at each
/// corner.
#[test]
fn forces_of_corners_balance_the_weight_of_a_banner() {
    let folder = tempfile::tempdir().unwrap();
    let text = "version = 1
        [sheet]
        mesh = { square = { side = 0.2, level = 2 } }
        damping = 20
        [[support]]
        at = { nearest = [[0.0, 0.2, 0.0]] }
        [[support]]
        at = { nearest = [[0.2, 0.2, 0.0]] }
        [forces]
        gravity = [0, 0, -9.81]
        [stop]
        time = 8
        [output]
        page = false";
    fs::write(folder.path().join("banner.toml"), text).unwrap();
    let output = run(folder.path(), &["simulate", "banner.toml", "--out", "run"]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let ending = summary(&folder.path().join("run")).ending;
    let weight = 0.08 * 0.2 * 0.2 * 9.81;
    assert!(ending.kinetic < 1e-9, "at rest: {ending:?}");
    let [left, right] = ending.supports[..] else {
        panic!("two supports: {ending:?}");
    };
    for (force, part) in [(left[2], 0.5), (right[2], 0.5), (left[2] + right[2], 1.0)] {
        assert!(
            (force / weight - part).abs() < 0.01,
            "{:?} of {weight} N",
            ending.supports
        );
    }
}

/// As behind `2>&1 | head`: nobody reads standard error any more.
#[test]
fn a_run_goes_on_when_nobody_reads_its_messages() {
    let dir = with_scene(StartingPoint::Drape);
    let arguments = [
        "simulate",
        "scene.toml",
        "--out",
        "run",
        "--set",
        "stop.time=0.1",
    ];
    let mut command = isosheet(dir.path());
    let mut child = command
        .args(arguments)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert!(dir.path().join("run/summary.json").exists());
}

/// A strip of paper on a mesh far too coarse for its bends, and on one that is fine enough: the first run
/// warns of its bends.
#[test]
fn a_mesh_too_coarse_for_the_bends_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let scene = "version = 1
        [sheet]
        mesh = { rectangle = { width = 0.3, height = 0.06, columns = 5, rows = 1 } }
        material = \"office paper\"
        damping = 5
        [[support]]
        at = { box = { min = [-1, -1, -1], max = [0.061, 1, 1] } }
        [forces]
        gravity = [0, 0, -9.81]
        [stop]
        time = 1";
    fs::write(dir.join("strip.toml"), scene).unwrap();
    for bending in ["plate", "hinges"] {
        let edit = format!("sheet.bending={{ {bending} = {{ rigidity = 5e-4 }} }}");
        let arguments = [
            "simulate",
            "strip.toml",
            "--out",
            "coarse",
            "--force",
            "--set",
            &edit,
        ];
        let coarse = run(dir, &arguments);
        assert_eq!(code(&coarse), Some(0), "{}", stderr(&coarse));
        let text = stderr(&coarse);
        assert!(text.contains("too coarse for the bends"), "{text}");
        assert!(text.contains("half the edge length"), "{text}");
        let elastic = summary(&dir.join("coarse")).elastic.unwrap();
        assert!(elastic.stiffness == 3e5 && elastic.strain < elastic.limit);
        let bend = elastic.sharpest.unwrap();
        assert!(bend.angle > 0.49 && bend.at[0] > 0.06, "{bend:?}");
        assert!(elastic.at_end.unwrap().angle > 0.0, "{elastic:?}");
    }
    let page = fs::read_to_string(dir.join("coarse/index.html")).unwrap();
    assert!(page.contains("share of stretching"));
    let fine = [
        "simulate",
        "strip.toml",
        "--out",
        "fine",
        "--set",
        "sheet.mesh={rectangle={width=0.3,height=0.06,columns=30,rows=6}}",
    ];
    let fine = run(dir, &fine);
    assert_eq!(code(&fine), Some(0), "{}", stderr(&fine));
    assert!(!stderr(&fine).contains("warning"), "{}", stderr(&fine));
}

/// A strip that is curved at rest, of edges longer and shorter than it takes: the warning names the length.
#[test]
fn a_mesh_too_coarse_for_its_curve_at_rest_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let (radius, turn) = (0.1, 0.5);
    for (rows, is_told) in [(8_u32, true), (32, false)] {
        let mut mesh = String::new();
        for k in 0..=rows {
            let (s, c) = (turn * f64::from(k) / f64::from(rows)).sin_cos();
            for j in 0..=2 {
                let y = radius * turn * f64::from(j) / f64::from(rows);
                mesh += &format!("v {} {y} {}\n", radius * s, radius * c);
            }
        }
        for a in (0..rows).flat_map(|k| [3 * k + 1, 3 * k + 2]) {
            mesh += &format!("f {a} {} {}\nf {a} {} {}\n", a + 3, a + 4, a + 4, a + 1);
        }
        fs::write(dir.join("arc.obj"), mesh).unwrap();
        // 12 D (1 - nu^2) / (E h) is the square of the thickness.
        let thickness = 4e-4_f64;
        let scene = format!(
            "version = 1
            [sheet]
            mesh = {{ file = {{ path = \"arc.obj\" }} }}
            isometry = {{ elastic = {{ stiffness = 3e5, poisson = 0 }} }}
            bending = {{ plate = {{ rigidity = {}, poisson = 0 }} }}
            mass = 1e-3
            rest = \"mesh\"
            [stop]
            time = 0.01",
            3e5 * thickness * thickness / 12.0
        );
        fs::write(dir.join("arc.toml"), scene).unwrap();
        let out = format!("out-{rows}");
        let done = run(dir, &["simulate", "arc.toml", "--out", &out]);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        let text = stderr(&done);
        assert_eq!(text.contains("curved at rest"), is_told, "{text}");
        let bend = summary(&dir.join(&out)).elastic.unwrap().at_rest.unwrap();
        // Squares with one diagonal; chords are shorter than their arcs by less than 1 %.
        let edge = radius * turn / f64::from(rows) * (4.0_f64 / 3.0).sqrt();
        let expected = [edge, radius, thickness];
        for (found, expected) in [bend.size, bend.radius, bend.thickness]
            .iter()
            .zip(expected)
        {
            assert!((found / expected - 1.0).abs() < 0.01, "{bend:?}");
        }
    }
}

/// Air that comes to a plate at 20 degrees separates from a real one, and a run says when; at 10 degrees it
/// does not.
#[test]
fn flow_that_would_separate_is_told_with_its_angle() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    for (degrees, is_told) in [(10.0_f64, false), (20.0, true)] {
        let scene = format!(
            "version = 1
            [sheet]
            mesh = {{ rectangle = {{ width = 0.1, height = 0.1, columns = 2, rows = 2 }} }}
            [[support]]
            at = \"boundary\"
            [air]
            wind = [6, 0, {}]
            [air.attached]
            trailing = {{ half_space = {{ point = [0.0999, 0, 0], normal = [1, 0, 0] }} }}
            [stop]
            time = 0.05",
            6.0 * degrees.to_radians().tan()
        );
        fs::write(dir.join("plate.toml"), scene).unwrap();
        let out = format!("out-{degrees}");
        let done = run(dir, &["simulate", "plate.toml", "--out", &out]);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        let said = stderr(&done);
        assert_eq!(said.contains("real flow separates"), is_told, "{said}");
        let incidence = summary(&dir.join(&out)).incidence.unwrap();
        // Vertices inside yield a little.
        assert!(
            (incidence.angle - degrees).abs() < 0.1 * degrees,
            "{incidence:?}"
        );
    }
}

/// The angle of the flag of the page on scenes, which has one sheet and no body, is that of its wind. Where
/// no air comes there is none.
#[test]
fn the_angle_of_the_air_is_that_of_the_wind() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    for (wind, expected) in [
        ("[6, 0.2, 0]", Some(0.2_f64.atan2(6.0))),
        ("[0, 0, 0]", None),
    ] {
        let scene = format!(
            "version = 1
            [sheet]
            mesh = {{ rectangle = {{ width = 0.3, height = 0.1, columns = 10, rows = 2 }} }}
            material = \"polycarbonate film\"
            placement = {{ turn = {{ axis = [1, 0, 0], angle = 90 }} }}
            [[support]]
            at = \"all\"
            [air]
            wind = {wind}
            [air.attached]
            trailing = {{ half_space = {{ point = [0.3, 0, 0], normal = [1, 0, 0] }} }}
            [method]
            step = 0.005
            [stop]
            time = 0.02"
        );
        fs::write(dir.join("flag.toml"), scene).unwrap();
        let done = run(dir, &["simulate", "flag.toml", "--force"]);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        assert!(!stderr(&done).contains("separates"), "{}", stderr(&done));
        let angle = summary(&dir.join("flag-run")).incidence.map(|i| i.angle);
        let off = angle.zip(expected).map(|(a, b)| (a - b.to_degrees()).abs());
        assert_eq!(angle.is_some(), expected.is_some(), "{angle:?}");
        assert!(off.is_none_or(|off| off < 1e-9), "{angle:?}");
    }
}
