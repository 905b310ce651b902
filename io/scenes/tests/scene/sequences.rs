//! Vertices and obstacles that follow meshes in motion, from files.

use crate::bodies::{ASIDE, play, velocity};
use isosheet_dynamics::Simulation;
use isosheet_formats::{Series, SeriesOptions, Trajectory, write_series};
use isosheet_mesh::{Sheet, generate};
use isosheet_scenes::{LiveScene, SceneFile};
use std::path::Path;

/// The simulation of a scene in a folder.
fn simulation(folder: &Path, text: &str) -> Result<Simulation, String> {
    let scene = SceneFile::parse(text.into(), &folder.join("scene.toml"), &[]);
    let setup = scene.map_err(|e| e.to_string())?.build();
    let started = setup.and_then(|setup| setup.start());
    started.map_err(|e| e.to_string())
}

/// Writes a mesh in motion, with positions at some times.
fn write(path: &Path, mesh: &Sheet, frames: &[(f64, Vec<f64>)]) {
    let mut trajectory = Trajectory::new(mesh);
    for (t, x) in frames {
        trajectory.push(*t, x).unwrap();
    }
    trajectory.write(path).unwrap();
}

/// Positions moved by a displacement.
fn moved(x: &[f64], by: [f64; 3]) -> Vec<f64> {
    let points = x.as_chunks::<3>().0.iter();
    points
        .flat_map(|p| [0, 1, 2].map(|k| p[k] + by[k]))
        .collect()
}

/// Largest difference of positions.
fn off(a: &Simulation, b: &Simulation) -> f64 {
    let pairs = a.state().x.iter().zip(&b.state().x);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

const CLOTH: &str = "version = 1\n[sheet]\nmaterial = \"cotton\"\n\
     mesh = { rectangle = { width = 0.2, height = 0.1, columns = 8, rows = 4 } }\n\
     [forces]\ngravity = [0, 0, -9.81]\n";

/// Two corners that follow a mesh which goes up move as pins that are lifted by a profile: by number, by
/// the nearest vertex and by the same number.
#[test]
fn pins_follow_a_mesh_in_motion() {
    let dir = tempfile::tempdir().unwrap();
    let body = generate::grid(8, 4, 0.2, 0.1, generate::Diagonals::UnionJack).unwrap();
    let x = body.positions();
    let (start, end) = (moved(x, [0.0, 0.0, -0.01]), moved(x, [0.1, 0.0, 0.19]));
    write(
        &dir.path().join("body.npz"),
        &body,
        &[(-1.0, start), (4.0, end)],
    );
    let corners = "[[support]]\nat = { vertices = [0, 8] }\n";
    let ramp = |to: f64| {
        format!(
            "{{ ramp = {{ from = {}, to = {}, begin = -1, end = 4 }} }}",
            -0.2 * to,
            0.8 * to
        )
    };
    let lifted = format!(
        "hold = {{ moving_pin = {{ x = {}, z = {} }} }}",
        ramp(0.1),
        ramp(0.2)
    );
    let follow = |vertices: &str| {
        format!(
            "hold = {{ follow = {{ sequence = {{ path = \"body.npz\" }}, vertices = {vertices} }} }}"
        )
    };
    for hold in [
        follow("{ numbers = [0, 8] }"),
        follow("\"nearest\""),
        follow("\"same_number\""),
    ] {
        let start =
            |hold: &str| simulation(dir.path(), &format!("{CLOTH}{corners}{hold}")).unwrap();
        let [mut expected, mut found] = [start(&lifted), start(&hold)];
        for _ in 0..40 {
            expected.step(1.0 / 60.0).unwrap();
            found.step(1.0 / 60.0).unwrap();
        }
        let t = found.state().t;
        for x in [&expected.state().x, &found.state().x] {
            for v in [0, 8] {
                assert!((x[3 * v + 2] - 0.04 * t).abs() < 1e-12, "{hold}");
            }
        }
        // A step of an elastic sheet leaves up to the root of 1e-3 of the displacement by acceleration.
        let left = 1e-3_f64.sqrt() * 9.81 / 3600.0;
        let off = off(&expected, &found);
        assert!(off < left, "{hold}: {off}");
    }
}

#[test]
fn what_cannot_be_followed_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let body = generate::grid(1, 1, 0.2, 0.1, generate::Diagonals::UnionJack).unwrap();
    write(
        &dir.path().join("body.npz"),
        &body,
        &[0.0, 2.0].map(|t| (t, body.positions().to_vec())),
    );
    std::fs::write(dir.path().join("text.npz"), "t, x").unwrap();
    for (file, vertices, reason) in [
        (
            "body.npz",
            "\"same_number\"",
            "there is no vertex 8: the mesh in motion has 4",
        ),
        ("body.npz", "{ numbers = [0, 4] }", "there is no vertex 4"),
        (
            "body.npz",
            "{ numbers = [0] }",
            "1 vertices are named, and 2 are held",
        ),
        ("missing.npz", "\"nearest\"", "cannot read"),
        ("text.npz", "\"nearest\"", "text.npz: "),
    ] {
        let text = format!(
            "{CLOTH}[[support]]\nat = {{ vertices = [0, 8] }}\n\
             hold = {{ follow = {{ sequence = {{ path = \"{file}\" }}, vertices = {vertices} }} }}"
        );
        let message = simulation(dir.path(), &text).err().unwrap();
        assert!(message.contains(reason), "{file}, {vertices}: {message}");
    }
}

/// A ball of triangles about the origin: an octahedron whose faces are cut into four, twice, with corners on
/// the sphere.
fn ball(radius: f64) -> Sheet {
    let corners = [
        [1, 0, 0],
        [-1, 0, 0],
        [0, 1, 0],
        [0, -1, 0],
        [0, 0, 1],
        [0, 0, -1],
    ];
    let x = corners
        .as_flattened()
        .iter()
        .map(|c| f64::from(*c))
        .collect();
    let faces = [
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    let octahedron = Sheet::new(x, &faces).unwrap();
    let finer = generate::split_1_4(&generate::split_1_4(&octahedron).unwrap()).unwrap();
    let on_sphere = |p: [f64; 3]| {
        let length = p.iter().map(|c| c * c).sum::<f64>().sqrt();
        p.map(|c| c * radius / length)
    };
    finer.map_positions(on_sphere).unwrap()
}

/// Positions times a factor, and then moved.
fn scaled(x: &[f64], factor: f64, by: [f64; 3]) -> Vec<f64> {
    let larger: Vec<f64> = x.iter().map(|c| factor * c).collect();
    moved(&larger, by)
}

/// A cloth that hangs on two corners, held above a ball, with a stiffness that does not depend on what else
/// moves.
const HELD: &str = "version = 1\n[sheet]\nmaterial = \"cotton\"\ndamping = 1\n\
     mesh = { rectangle = { width = 0.2, height = 0.2, columns = 10, rows = 10 } }\n\
     placement = { position = [-0.1, -0.1, 0] }\n\
     [forces]\ngravity = [0, 0, -9.81]\n[contact]\nactivation = 0.004\nstiffness = 1e-4\nrest_speed = 1e-3\n\
     [[support]]\nat = { vertices = [0, 10] }\n";

/// A ball that comes up bends a clamped strip of card as the same ball does that is moved by a profile, with
/// friction. The forces on it are the same too.
#[test]
fn a_mesh_in_motion_that_does_not_deform_is_a_body_that_moves() {
    let dir = tempfile::tempdir().unwrap();
    let ball = ball(0.02);
    let place = |t: f64| [0.15 + 0.01 * t, 0.02, -0.025 + 0.05 * t];
    let frames = [-1.0, 4.0].map(|t| (t, moved(ball.positions(), place(t))));
    write(&dir.path().join("ball.npz"), &ball, &frames);
    isosheet_formats::write_obj(
        &dir.path().join("ball.obj"),
        ball.topology(),
        ball.positions(),
    )
    .unwrap();
    let ramp = |rate: f64| {
        format!(
            "{{ ramp = {{ from = {}, to = {}, begin = -1, end = 4 }} }}",
            -rate,
            4.0 * rate
        )
    };
    let body = format!(
        "[[obstacle]]\nshape = {{ file = {{ path = \"ball.obj\" }} }}\nfriction = 0.3\n\
         pose = {{ position = [0.15, 0.02, -0.025] }}\nmotion = {{ x = {}, z = {} }}",
        ramp(0.01),
        ramp(0.05)
    );
    let mesh = "[[obstacle]]\nshape = { sequence = { path = \"ball.npz\" } }\nfriction = 0.3";
    let start = |obstacle: &str| {
        let text = format!(
            "version = 1\n[sheet]\nmaterial = \"card\"\ndamping = 4\n\
             mesh = {{ rectangle = {{ width = 0.2, height = 0.05, columns = 16, rows = 4 }} }}\n\
             [contact]\nactivation = 0.002\nstiffness = 1e-4\nrest_speed = 1e-2\n\
             [[support]]\nat = {{ box = {{ min = [-1, -1, -1], max = [1e-6, 1, 1] }} }}\nhold = \"clamp\"\n\
             {obstacle}"
        );
        LiveScene::start(SceneFile::parse(text, &dir.path().join("scene.toml"), &[]).unwrap())
            .unwrap()
    };
    let [mut expected, mut found] = [start(&body), start(mesh)];
    for _ in 0..45 {
        expected.step(1.0 / 60.0).unwrap();
        let report = found.step(1.0 / 60.0).unwrap();
        assert!(
            report.gap.unwrap() > 0.0 && report.strain < 0.01,
            "{report:?}"
        );
    }
    let sheet = 3 * 17 * 5;
    let [a, b] = [&expected, &found].map(|live| &live.simulation().state().x[..sheet]);
    let off = a
        .iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    let bent = a.iter().skip(2).step_by(3).fold(0.0, |m: f64, z| m.max(*z));
    assert!(bent > 0.02, "the strip is bent: {bent}");
    assert!(off < 1e-4 * bent, "{off} of {bent}");
    let [a, b] = [&expected, &found].map(|live| live.obstacle_loads()[0].force);
    assert!(a[2] < -1e-3, "the strip presses on the ball: {a:?}");
    for k in 0..3 {
        assert!((a[k] - b[k]).abs() < 1e-3 * a[2].abs(), "{a:?} {b:?}");
    }
    // What is known of the sheet is that of the sheet alone.
    let [a, b] = [&expected, &found].map(LiveScene::simulation);
    assert_eq!(a.model().mass().total(), b.model().mass().total());
    assert_eq!(a.model().mean_length(), b.model().mean_length());
    assert_eq!(expected.pins(), found.pins());
    assert_eq!(found.facts().parts[1].0, "obstacle_0");
}

/// A ball that breathes lifts a free cloth that lies on it, without penetration, and bears its weight on the
/// average.
#[test]
fn a_breathing_ball_lifts_a_cloth() {
    let dir = tempfile::tempdir().unwrap();
    let ball = ball(0.05);
    let frames = (0..=24).map(|k| {
        let t = f64::from(k) / 12.0;
        let size = 1.0 + 0.25 * (1.0 - (std::f64::consts::PI * t).cos());
        (t, scaled(ball.positions(), size, [0.0, 0.0, -0.055]))
    });
    write(
        &dir.path().join("ball.npz"),
        &ball,
        &frames.collect::<Vec<_>>(),
    );
    let text = HELD.split("[[support]]").next().unwrap().to_owned()
        + "[[obstacle]]\nshape = { sequence = { path = \"ball.npz\" } }\nfriction = 0.8";
    let mut simulation = simulation(dir.path(), &text).unwrap();
    let middle = |s: &Simulation| s.state().x[3 * 60 + 2];
    let mut highest: f64 = middle(&simulation);
    for _ in 0..60 {
        let report = simulation.step(1.0 / 60.0).unwrap();
        assert!(report.gap.unwrap() > 0.0);
        // The tip of the ball is a vertex below the middle of the cloth.
        let tip = 0.05 * (1.0 + 0.25 * (1.0 - (std::f64::consts::PI * report.t).cos())) - 0.055;
        assert!(
            middle(&simulation) > tip - 1e-3,
            "{} {tip}",
            middle(&simulation)
        );
        highest = highest.max(middle(&simulation));
    }
    assert!(highest > 0.02, "{highest}");
}

/// What one run has moved is the obstacle of another, which continues from a checkpoint with the same bits.
#[test]
fn the_motion_of_one_sheet_is_the_obstacle_of_another() {
    let dir = tempfile::tempdir().unwrap();
    let hammock = HELD.replace(
        "at = { vertices = [0, 10] }",
        "at = { vertices = [0, 10, 110, 120] }",
    );
    let scene = SceneFile::parse(hammock.clone(), &dir.path().join("a.toml"), &[]).unwrap();
    let setup = scene.build().unwrap();
    let mut trajectory = Trajectory::new(&setup.sheet);
    let mut first = setup.start().unwrap();
    for _ in 0..30 {
        let state = first.state();
        trajectory.push(state.t, &state.x).unwrap();
        first.step(1.0 / 60.0).unwrap();
    }
    trajectory.write(&dir.path().join("hammock.npz")).unwrap();
    // A smaller cloth falls into it. A floor below touches neither.
    let text = "version = 1\n[sheet]\nmaterial = \"cotton\"\n\
         mesh = { rectangle = { width = 0.1, height = 0.1, columns = 5, rows = 5 } }\n\
         placement = { position = [-0.05, -0.05, 0.01] }\n[forces]\ngravity = [0, 0, -9.81]\n\
         [[obstacle]]\nshape = \"half_space\"\npose = { position = [0, 0, -0.01] }\n\
         [[obstacle]]\nshape = { sequence = { path = \"hammock.npz\", delay = 0.1, outside = \"rest\" } }\nfriction = 0.5";
    let build = || {
        let scene = SceneFile::parse(text.into(), &dir.path().join("b.toml"), &[]);
        scene.unwrap().build().unwrap()
    };
    let mut whole = build().start().unwrap();
    for _ in 0..10 {
        whole.step(1.0 / 60.0).unwrap();
    }
    let mut continued = build().resume(whole.checkpoint()).unwrap();
    for _ in 0..10 {
        let report = whole.step(1.0 / 60.0).unwrap();
        assert!(report.gap.unwrap() > 0.0);
        assert_eq!(report, continued.step(1.0 / 60.0).unwrap());
    }
    assert_eq!(whole.state(), continued.state());
    // The vertices of the obstacle are where the first run had them a tenth of a second before.
    let (t, own) = (whole.state().t - 0.1, 3 * 36);
    let k = (t * 60.0).round() as usize;
    let found = &whole.state().x[own..];
    let off = found
        .iter()
        .zip(trajectory.frame(k).unwrap())
        .map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-12);
}

/// A ball that comes up in files of all kinds lifts the same cloth to the same bits, as an obstacle and with
/// corners that follow it.
#[test]
fn the_same_motion_in_any_file_is_the_same_run() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    let ball = ball(0.05);
    let mut trajectory = Trajectory::new(&ball);
    for frame in 0..=6 {
        let t = f64::from(frame) / 24.0;
        let size = 1.0 + 0.5 * t;
        let x = scaled(ball.positions(), size, [0.0, 0.0, -0.06 + 0.02 * t]);
        trajectory.push(t, &x).unwrap();
    }
    trajectory.write(&folder.join("ball.npz")).unwrap();
    trajectory
        .write(&folder.join("run/trajectory.npz"))
        .unwrap();
    let series = Series::new(&trajectory, &SeriesOptions::default()).unwrap();
    for name in ["list.pvd", "numbered.obj"] {
        write_series(&folder.join(name), &series).unwrap();
    }
    let start = |source: &str| {
        let cloth = HELD.split("[[support]]").next().unwrap();
        let text = format!(
            "{cloth}[stop]\ntime = 0.25\n[[obstacle]]\nshape = {{ sequence = {{ {source} }} }}\nfriction = 0.5\n\
             [[support]]\nat = {{ vertices = [0] }}\n\
             hold = {{ follow = {{ sequence = {{ {source} }} }} }}"
        );
        simulation(folder, &text)
    };
    let mut expected = start("path = \"ball.npz\"").unwrap();
    for _ in 0..10 {
        let report = expected.step(1.0 / 60.0).unwrap();
        assert!(report.gap.unwrap() > 0.0);
    }
    for source in [
        "path = \"run\"",
        "path = \"list.pvd\"",
        "path = \"list\"",
        "path = \"numbered\", rate = 24",
        "path = \"numbered/frame_*.obj\", rate = 24",
    ] {
        let mut found = start(source).unwrap();
        for _ in 0..10 {
            found.step(1.0 / 60.0).unwrap();
        }
        assert!(off(&expected, &found) < 1e-12, "{source}");
    }
    for (source, reason) in [
        ("path = \"numbered\"", "numbers and no times"),
        ("path = \"list\", rate = 24", "has times in seconds"),
        (
            "path = \"numbered\", rate = 48",
            "goes from 0 s to 0.125 s, and the run goes from 0 s to 0.25 s",
        ),
        ("path = \"ball.npz\", delay = 0.01", "goes from 0.01 s"),
        ("path = \".\"", "no mesh files whose names end with"),
    ] {
        let message = start(source).err().unwrap();
        assert!(message.contains(reason), "{source}: {message}");
    }
    assert!(start("path = \"numbered\", rate = 48, outside = \"rest\"").is_ok());
}

/// A mesh at one time is one that rests, which the scene has to say as of any other motion that ends early.
#[test]
fn one_sample_covers_no_run() {
    let dir = tempfile::tempdir().unwrap();
    let ball = ball(0.05);
    let mut trajectory = Trajectory::new(&ball);
    trajectory.push(0.0, ball.positions()).unwrap();
    let series = Series::new(&trajectory, &SeriesOptions::default()).unwrap();
    for name in ["numbered.obj", "list.pvd"] {
        write_series(&dir.path().join(name), &series).unwrap();
    }
    let start = |source: &str| {
        let text = format!(
            "{CLOTH}placement = {{ position = [0, 0, 1] }}\n[stop]\ntime = 1\n\
             [[obstacle]]\nshape = {{ sequence = {{ {source} }} }}"
        );
        let text = text.replace("[forces]\ngravity = [0, 0, -9.81]\n", "");
        simulation(dir.path(), &text)
    };
    for source in ["path = \"numbered\", rate = 24", "path = \"list.pvd\""] {
        let message = start(source).err().unwrap();
        let expected = "the mesh in motion has one time, 0 s, and the run goes from 0 s to 1 s";
        assert!(message.contains(expected), "{source}: {message}");
        assert!(message.contains("outside = \"rest\""), "{message}");
        let rests = start(&format!("{source}, outside = \"rest\""));
        assert!(rests.is_ok(), "{:?}", rests.err());
    }
}

/// Files whose format says which axis points upwards are turned once: a scene that says it again is refused.
#[test]
fn axes_that_files_say_themselves_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let scene = |shape: &str| {
        let text = format!(
            "version = 1\n[sheet]\nmesh = {{ square = {{ side = 0.1, level = 1 }} }}\n\
             placement = {{ position = [0, 0, -9] }}\n[[obstacle]]\nshape = {{ {shape} }}"
        );
        SceneFile::parse(text, &dir.path().join("scene.toml"), &[])
    };
    for shape in [
        "sequence = { path = \"walk_*.GLB\", rate = 24, up = \"y\" }",
        "file = { path = \"table.gltf\", up = \"y\" }",
    ] {
        let refused = scene(shape).and_then(|scene| Ok(scene.build()?));
        let message = refused.err().unwrap().to_string();
        assert!(message.contains("itself says which axis"), "{message}");
        assert!(message.contains("leave `up` out"), "{message}");
    }
}

/// A box that hits a ball pushes it away whether it is a mesh in motion or a rigid obstacle, at speeds at
/// which the two meet within a step.
#[test]
fn a_mesh_in_motion_hits_a_body_as_a_rigid_obstacle_does() {
    let dir = tempfile::tempdir().unwrap();
    let faces = [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ];
    let corner = |k: usize, axis: usize| {
        if k >> (2 - axis) & 1 == 1 {
            0.05
        } else {
            -0.05
        }
    };
    let x: Vec<f64> = (0..24).map(|i| corner(i / 3, i % 3)).collect();
    let mesh = Sheet::new(x, &faces).unwrap();
    let start = |obstacle: &str| {
        let text = format!(
            "{ASIDE}[[body]]\nname = \"ball\"\nshape = {{ sphere = {{ radius = 0.02 }} }}\nsides = 24\nmass = 0.02\n\
             [[obstacle]]\n{obstacle}\n[stop]\ntime = 0.5\n"
        );
        let scene = SceneFile::parse(text, &dir.path().join("scene.toml"), &[]).unwrap();
        LiveScene::start(scene).unwrap()
    };
    for speed in [0.1, 0.2, 0.5, 1.0, 2.0] {
        let frames = [0.0, 1.0].map(|t| (t, moved(mesh.positions(), [-0.1 + speed * t, 0.0, 0.0])));
        write(&dir.path().join("box.npz"), &mesh, &frames);
        let by_mesh = start("shape = { sequence = { path = \"box.npz\" } }");
        let by_motion = start(&format!(
            "shape = {{ box = {{ size = [0.1, 0.1, 0.1] }} }}\npose = {{ position = [-0.1, 0, 0] }}\n\
             motion = {{ x = {{ ramp = {{ to = {speed}, end = 1 }} }} }}"
        ));
        // Between a ball that goes with the box and one that is thrown off without loss.
        for mut live in [by_mesh, by_motion] {
            play(&mut live, 0.5);
            let found = velocity(&live, 0).x;
            assert!(
                found > 0.99 * speed && found <= 2.0 * speed,
                "{speed}: {found}"
            );
        }
    }
}

#[test]
fn meshes_in_motion_that_cannot_be_obstacles_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let ball = ball(0.05);
    let below = moved(ball.positions(), [0.0, 0.0, -0.1]);
    let mut turned = below.clone();
    // Inside out.
    turned
        .iter_mut()
        .skip(2)
        .step_by(3)
        .for_each(|z| *z = -0.2 - *z);
    let mut flat = below.clone();
    let corners = ball.topology().faces()[7].map(|v| v.index());
    for k in 0..3 {
        flat[3 * corners[1] + k] = flat[3 * corners[0] + k];
    }
    let through = moved(ball.positions(), [0.0, 0.0, -0.02]);
    for (name, frames) in [
        ("turned", vec![(0.0, below.clone()), (1.0, turned)]),
        (
            "flat",
            vec![(0.0, below.clone()), (1.0, below.clone()), (2.0, flat)],
        ),
        ("below", [0.0, 2.0].map(|t| (t, below.clone())).to_vec()),
        ("through", [0.0, 2.0].map(|t| (t, through.clone())).to_vec()),
    ] {
        write(&dir.path().join(format!("{name}.npz")), &ball, &frames);
    }
    let obstacle = |name: &str, more: &str| {
        format!("{HELD}[[obstacle]]\nshape = {{ sequence = {{ path = \"{name}.npz\" }} }}\n{more}")
    };
    for (text, reason) in [
        (obstacle("turned", ""), "turns over from frame 0 to frame 1"),
        (obstacle("flat", ""), "has no area in frame 2"),
        (obstacle("through", ""), "the obstacle touches the sheet"),
        (
            obstacle("below", "motion = { z = { ramp = { to = 1, end = 1 } } }"),
            "moves besides",
        ),
        (obstacle("missing", ""), "missing.npz"),
        (
            obstacle("below", "").replace("[[obstacle]]", "[[body]]\ndensity = 1"),
            "no body that responds",
        ),
    ] {
        let message = simulation(dir.path(), &text).err().unwrap();
        assert!(message.contains(reason), "{message}");
    }
    assert!(simulation(dir.path(), &obstacle("below", "")).is_ok());
}

/// The frames of an archive as numbers are the same mesh in motion, bit for bit.
#[test]
fn frames_as_numbers_move_as_those_of_a_file() {
    let dir = tempfile::tempdir().unwrap();
    let body = generate::grid(2, 2, 0.3, 0.2, generate::Diagonals::UnionJack).unwrap();
    let frames = [0.0, 0.6].map(|t| (t, moved(body.positions(), [-0.05, -0.05, 0.1 * t - 0.02])));
    write(&dir.path().join("body.npz"), &body, &frames);
    let list = |x: &[f64]| format!("{:?}", x.as_chunks::<3>().0);
    let numbers = format!(
        "frames = {{ times = [0, 0.6], positions = [{}, {}], faces = {:?} }}",
        list(&frames[0].1),
        list(&frames[1].1),
        body.face_indices()
    );
    let scene = |source: &str| {
        let obstacle = format!("[[obstacle]]\nshape = {{ sequence = {{ {source} }} }}\n");
        format!("{CLOTH}{obstacle}[stop]\ntime = 0.5\n")
    };
    let start = |source: &str| simulation(dir.path(), &scene(source)).unwrap();
    let [mut file, mut here] = [start("path = \"body.npz\""), start(&numbers)];
    for _ in 0..10 {
        assert_eq!(file.step(1.0 / 60.0), here.step(1.0 / 60.0));
    }
    assert_eq!(file.state(), here.state());
    // It lies on the mesh, and has not fallen by 0.14 m.
    let heights = here.state().x[..3 * 45].iter().skip(2).step_by(3);
    let lowest = heights.fold(f64::INFINITY, |low, z| low.min(*z));
    assert!(lowest > -0.03, "{lowest} m");
    let ragged = "frames = { times = [0, 1], positions = [[[0, 0, 9]], []], faces = [] }";
    let index =
        "frames = { times = [0, 1], positions = [[[0, 0, 9]], [[0, 0, 8]]], faces = [[0, 0, 1]] }";
    let short = "frames = { times = [0, 0.2], positions = [[[0, 0, 9]], [[0, 0, 8]]], faces = [[0, 0, 0]] }";
    for (source, says) in [
        (
            format!("path = \"body.npz\", {numbers}"),
            "has a `path` and `frames`",
        ),
        (String::new(), "neither a `path` nor `frames`"),
        (
            ragged.to_owned(),
            "the frame has 0 vertices, and the first one 1",
        ),
        (
            numbers.replace("[0, 0.6]", "[0]"),
            "positions of 2 frames at 1 times",
        ),
        (
            numbers.replace("[0, 0.6]", "[0.6, 0]"),
            "has the time 0 s after 0.6 s",
        ),
        (
            numbers.replace("[0, 0.6]", "[0, nan]"),
            "frames.times[1]` is NaN",
        ),
        (index.to_owned(), "refers to vertex 1 of 1"),
        (short.to_owned(), "goes from 0 s to 0.2 s"),
        (format!("{numbers}, rate = 24"), "leave `rate` out"),
    ] {
        let error = simulation(dir.path(), &scene(&source))
            .map(drop)
            .unwrap_err();
        assert!(error.contains(says), "{source}: {error}");
    }
}
