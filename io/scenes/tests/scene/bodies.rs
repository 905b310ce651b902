//! Rigid bodies of scenes: their motion, what touches them, and what is refused.

use crate::parse;
use isosheet_dynamics::Memories;
use isosheet_scenes::{LiveScene, SceneError, SceneFile, SceneFileError};
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::fmt::Write;
use std::path::Path;

pub(crate) const G: f64 = 9.81;

/// A sheet that is held far away, for bodies alone.
pub(crate) const ASIDE: &str = "version = 1
[sheet]
mesh = { square = { side = 0.1, level = 0 } }
density = 0.1
placement = { position = [5, 5, 5] }
[[support]]
at = \"all\"
";

pub(crate) fn live(text: &str) -> LiveScene {
    let file = parse(text).unwrap_or_else(|e| panic!("{e}"));
    LiveScene::start(file).unwrap_or_else(|e| panic!("{e}"))
}

/// What is said of a scene that cannot start: the first key, and the text.
pub(crate) fn problem(text: &str) -> String {
    let said = |error: SceneError| format!("{}: {error}", error.problems()[0].key);
    match parse(text) {
        Err(SceneFileError::Scene(error)) => said(error),
        Err(error) => error.to_string(),
        Ok(file) => match LiveScene::start(file) {
            Err(error) => said(error),
            Ok(_) => panic!("it starts: {text}"),
        },
    }
}

/// Takes steps for a duration, and returns the number of them.
pub(crate) fn play(live: &mut LiveScene, duration: f64) -> usize {
    let h = live.file().scene().method.step;
    let count = (duration / h).round() as usize;
    for _ in 0..count {
        let report = live.step(h).unwrap_or_else(|e| panic!("{e}"));
        assert!(report.gap.is_none_or(|gap| gap > 0.0));
    }
    count
}

pub(crate) fn centre(live: &LiveScene, body: usize) -> Vector3<f64> {
    live.facts().bodies[body]
        .centre(&live.simulation().state().x)
        .into()
}

pub(crate) fn velocity(live: &LiveScene, body: usize) -> Vector3<f64> {
    live.facts().bodies[body]
        .centre(&live.simulation().state().v)
        .into()
}

/// Linear momentum and angular momentum about the origin of the model.
fn momenta(live: &LiveScene) -> [Vector3<f64>; 2] {
    let (model, state) = (live.simulation().model(), live.simulation().state());
    [
        model.linear_momentum(&state.v).into(),
        model.angular_momentum(&state.x, &state.v).into(),
    ]
}

/// The L of three unit squares, of some height, as a file in centimetres.
fn corner_piece(height: f64, reversed: bool) -> String {
    let outline = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]];
    let mut text = String::new();
    for z in [0.0, height] {
        for [x, y] in outline {
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
    }
    let caps = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
    let mut faces: Vec<[usize; 3]> = Vec::new();
    for [a, b, c] in caps {
        faces.extend([[a, c, b], [6 + a, 6 + b, 6 + c]]);
    }
    for k in 0..6 {
        let next = (k + 1) % 6;
        faces.extend([[k, next, 6 + next], [k, 6 + next, 6 + k]]);
    }
    for [a, b, c] in faces {
        let [b, c] = if reversed { [c, b] } else { [b, c] };
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    text
}

fn in_folder(folder: &Path, text: &str) -> Result<LiveScene, String> {
    let path = folder.join("scene.toml");
    let file = SceneFile::parse(text.into(), &path, &[]).map_err(|e| e.to_string())?;
    LiveScene::start(file).map_err(|e| e.to_string())
}

/// A corner piece of three cubes is thrown with a spin: its centre is on a parabola, its momenta follow from
/// its mass and inertia and remain, and so does its energy.
#[test]
fn a_corner_piece_falls_and_tumbles() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("piece.obj"), corner_piece(1.0, false)).unwrap();
    let scene = format!(
        "{ASIDE}
        [[body]]
        name = \"piece\"
        shape = {{ file = {{ path = \"piece.obj\", scale = 0.02 }} }}
        density = 1000
        pose = {{ position = [0.1, 0.2, 0.3], turn = {{ axis = [1, 2, 3], angle = 50 }} }}
        velocity = [1, 0.5, 3]
        spin = {{ axis = [1, 0.2, -0.3], rate = 500 }}
        [forces]
        gravity = [0, 0, -{G}]
        [method]
        step = 1e-3"
    );
    let mut live = in_folder(folder.path(), &scene).unwrap();
    // Three cubes of 20 mm.
    let (side, cube) = (0.02, 1000.0 * 0.02_f64.powi(3));
    let mass = 3.0 * cube;
    let cubes =
        [[0.5, 0.5, 0.5], [1.5, 0.5, 0.5], [0.5, 1.5, 0.5]].map(|p| side * Vector3::from(p));
    let middle: Vector3<f64> = cubes.iter().sum::<Vector3<f64>>() / 3.0;
    let own = cube * side * side / 6.0 * Matrix3::identity();
    let about_middle = cubes.iter().map(|p| {
        let r = p - middle;
        own + cube * (r.norm_squared() * Matrix3::identity() - r * r.transpose())
    });
    let turn = Rotation3::from_scaled_axis(
        50.0_f64.to_radians() * Vector3::new(1.0, 2.0, 3.0).normalize(),
    );
    let inertia = turn * about_middle.sum::<Matrix3<f64>>() * turn.transpose();
    let at = Vector3::new(0.1, 0.2, 0.3) + turn * middle;
    assert!((centre(&live, 0) - at).norm() < 1e-12);
    let thrown = Vector3::new(1.0, 0.5, 3.0);
    let rate = 500.0_f64.to_radians() * Vector3::new(1.0, 0.2, -0.3).normalize();
    let spin = |live: &LiveScene| {
        let [linear, angular] = momenta(live);
        angular - centre(live, 0).cross(&linear)
    };
    assert!((momenta(&live)[0] - mass * thrown).norm() < 1e-12);
    let expected = inertia * rate;
    assert!((spin(&live) - expected).norm() < 1e-12 * expected.norm().max(1.0));
    let energy = 0.5 * mass * thrown.norm_squared() + 0.5 * rate.dot(&expected);
    let start = live
        .simulation()
        .model()
        .kinetic_energy(&live.simulation().state().v);
    assert!((start / energy - 1.0).abs() < 1e-12, "{start} {energy}");
    let total = live.simulation().energy();
    let duration = 0.5;
    play(&mut live, duration);
    let path = at + duration * thrown - Vector3::new(0.0, 0.0, 0.5 * G * duration * duration);
    let error = (centre(&live, 0) - path).norm();
    assert!(error < 1e-4, "{error}");
    let error = (spin(&live) - expected).norm() / expected.norm();
    assert!(error < 1e-4, "angular momentum: {error}");
    let error = (live.simulation().energy() - total).abs() / energy;
    assert!(error < 1e-4, "energy: {error}");
    assert!(live.body_loads()[0].force == [0.0; 3]);
}

/// A scene of bodies on an inclined plane through the origin, down along x.
fn on_plane(slope: f64, friction: f64, body: &str) -> LiveScene {
    let degrees = slope.to_degrees();
    live(&format!(
        "{ASIDE}
        [[obstacle]]
        shape = \"half_space\"
        pose = {{ turn = {{ axis = [0, 1, 0], angle = {degrees} }} }}
        friction = {friction}
        {body}
        [forces]
        gravity = [0, 0, -{G}]
        [contact]
        activation = 1e-3
        friction = {friction}
        [method]
        step = 0.004"
    ))
}

/// The pose of what lies on the plane with its middle so high above it.
fn lying(slope: f64, height: f64) -> String {
    let above = height + 5e-4;
    let [x, z] = [above * slope.sin(), above * slope.cos()];
    let degrees = slope.to_degrees();
    format!(
        "pose = {{ position = [{x}, 0, {z}], turn = {{ axis = [0, 1, 0], angle = {degrees} }} }}"
    )
}

/// The acceleration of a body down the plane, and the mean of the force on it.
fn run_down(live: &mut LiveScene, slope: f64) -> (f64, Vector3<f64>) {
    play(live, 0.1);
    let along = Vector3::new(slope.cos(), 0.0, -slope.sin());
    let before = velocity(live, 0).dot(&along);
    let (mut load, count) = (Vector3::zeros(), 100);
    for _ in 0..count {
        play(live, 0.004);
        load += Vector3::from(live.body_loads()[0].force) / f64::from(count);
    }
    let gained = velocity(live, 0).dot(&along) - before;
    (gained / (0.004 * f64::from(count)), load)
}

#[test]
fn a_box_slides_down_an_inclined_plane() {
    let (slope, friction, mass) = (0.5_f64, 0.2, 0.5);
    let body = format!(
        "[[body]]
        shape = {{ box = {{ size = [0.1, 0.08, 0.05] }} }}
        mass = {mass}
        {}",
        lying(slope, 0.025)
    );
    let mut live = on_plane(slope, friction, &body);
    let (found, load) = run_down(&mut live, slope);
    let expected = G * (slope.sin() - friction * slope.cos());
    assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
    let along = Vector3::new(slope.cos(), 0.0, -slope.sin());
    let carried = mass * (Vector3::new(0.0, 0.0, G) + expected * along);
    assert!(
        (load - carried).norm() < 5e-3 * carried.norm(),
        "{load} {carried}"
    );
}

/// A box that is pushed along a table, by a part of its weight that grows and stays between the two
/// coefficients, rests; by one above both it slides, with the kinetic one.
#[test]
fn the_static_coefficient_holds_what_the_kinetic_one_lets_slide() {
    let speed = |push: f64| {
        let (lies, size) = (lying(0.0, 0.025), push * G);
        let mut live = live(&format!(
            "{ASIDE}
            [[obstacle]]
            shape = \"half_space\"
            friction = {{ static = 0.5, kinetic = 0.2 }}
            [[body]]
            shape = {{ box = {{ size = [0.1, 0.08, 0.05] }} }}
            mass = 0.5
            {lies}
            [forces]
            gravity = [0, 0, -{G}]
            [[forces.acceleration]]
            direction = [1, 0, 0]
            size = {{ ramp = {{ to = {size}, begin = 0.3, end = 0.5 }} }}
            [contact]
            activation = 1e-3
            rest_speed = 0.02
            [method]
            step = 0.004"
        ));
        play(&mut live, 0.5);
        let before = velocity(&live, 0).x;
        play(&mut live, 0.2);
        (before, velocity(&live, 0).x)
    };
    let (before, after) = speed(0.35);
    assert!(
        before.abs() < 0.02 && after.abs() < 0.02,
        "{before} {after}"
    );
    let (before, after) = speed(0.7);
    let gained = 0.2 * G * (0.7 - 0.2);
    assert!(
        ((after - before) / gained - 1.0).abs() < 0.02,
        "{before} {after}"
    );
}

/// A ball and a cylinder roll without sliding: `g sin a / (1 + I / m r^2)`. A cylinder is a prism, which
/// rolls over its edges.
#[test]
fn a_ball_and_a_cylinder_roll_down_an_inclined_plane() {
    let (slope, radius, mass) = (0.3_f64, 0.05, 0.2);
    let ball = "shape = { sphere = { radius = 0.05 } }";
    let roller = "shape = { cylinder = { radius = 0.05, height = 0.1 } }";
    // The cylinder lies across the plane.
    let across = format!(
        "pose = {{ position = [{}, 0, {}], turn = {{ axis = [1, 0, 0], angle = 90 }} }}",
        (radius + 5e-4) * slope.sin(),
        (radius + 5e-4) * slope.cos()
    );
    for (shape, pose, part) in [
        (ball, lying(slope, radius), 5.0 / 7.0),
        (roller, across, 2.0 / 3.0),
    ] {
        let body = format!("[[body]]\n{shape}\nsides = 64\nmass = {mass}\n{pose}");
        let mut live = on_plane(slope, 0.6, &body);
        let (found, load) = run_down(&mut live, slope);
        let expected = part * G * slope.sin();
        assert!(
            (found / expected - 1.0).abs() < 0.03,
            "{shape}: {found} {expected}"
        );
        let along = Vector3::new(slope.cos(), 0.0, -slope.sin());
        let friction = -load.dot(&along);
        let expected = (1.0 - part) * mass * G * slope.sin();
        assert!(
            (friction / expected - 1.0).abs() < 0.1,
            "{shape}: {friction} {expected}"
        );
    }
}

/// A stack of boxes stays where it is, and each interface carries what is above it.
#[test]
fn boxes_stand_on_each_other() {
    let count = 4;
    let (side, gap, mass) = (0.1, 7e-4, 0.3);
    let mut bodies = String::new();
    for k in 0..count {
        let z = (f64::from(k) + 0.5) * side + f64::from(k + 1) * gap;
        write!(
            bodies,
            "[[body]]
            shape = {{ box = {{ size = [{side}, {side}, {side}] }} }}
            mass = {mass}
            pose = {{ position = [{}, 0, {z}] }}\n",
            0.004 * f64::from(k % 2)
        )
        .unwrap();
    }
    let mut live = on_plane(0.0, 0.5, &bodies);
    let before: Vec<_> = (0..count as usize).map(|k| centre(&live, k)).collect();
    play(&mut live, 0.8);
    for (k, before) in before.iter().enumerate() {
        let moved = (centre(&live, k) - before).norm();
        assert!(moved < 2e-3, "box {k} moved by {moved}");
        let load = live.body_loads()[k];
        let weight = mass * G;
        assert!(
            (load.force[2] / weight - 1.0).abs() < 0.02,
            "box {k}: {load:?}"
        );
    }
    let floor = live.simulation().body_loads()[0].force;
    let weight = f64::from(count) * mass * G;
    assert!((floor.z / -weight - 1.0).abs() < 0.01, "{floor}");
}

/// A ball lies in a cloth that is held at two edges: the supports carry the weight of both. Of forces at rest
/// the tolerance of scenes with bodies, 1e-4, leaves its root.
#[test]
fn a_ball_lies_in_a_hammock() {
    let mut live = live(&format!(
        "version = 1
        [sheet]
        mesh = {{ square = {{ side = 0.2, level = 2 }} }}
        isometry = {{ elastic = {{ stiffness = 3e5 }} }}
        bending = {{ plate = {{ rigidity = 5e-4, poisson = 0.3 }} }}
        mass = 3.2e-3
        damping = 8
        [[support]]
        at = {{ half_space = {{ point = [1e-6, 0, 0], normal = [-1, 0, 0] }} }}
        [[support]]
        at = {{ half_space = {{ point = [0.199999, 0, 0], normal = [1, 0, 0] }} }}
        [[body]]
        name = \"ball\"
        shape = {{ sphere = {{ radius = 0.025 }} }}
        sides = 16
        mass = 0.03
        pose = {{ position = [0.1, 0.1, 0.026] }}
        [forces]
        gravity = [0, 0, -{G}]
        [contact]
        friction = 0.3"
    ));
    play(&mut live, 3.0);
    let held: f64 = live.support_forces().iter().map(|f| f[2]).sum();
    let weight = G * (0.03 + 3.2e-3);
    assert!((held / weight - 1.0).abs() < 1e-2, "{held} {weight}");
    let load = live.body_loads()[0].force[2];
    assert!((load / (0.03 * G) - 1.0).abs() < 1e-2, "{load}");
}

/// Bodies that are thin are carried by thicker tetrahedra: a disc that spins keeps its axis.
#[test]
fn a_thin_disc_spins_about_its_axis() {
    let mut live = live(&format!(
        "{ASIDE}
        [[body]]
        shape = {{ cylinder = {{ radius = 0.1, height = 1e-4 }} }}
        density = 1000
        spin = {{ axis = [0.02, 0, 1], rate = 720 }}
        [method]
        step = 1e-3"
    ));
    let [_, before] = momenta(&live);
    let energy = live.simulation().energy();
    play(&mut live, 0.5);
    let [_, after] = momenta(&live);
    assert!(
        (after - before).norm() < 1e-3 * before.norm(),
        "{before} {after}"
    );
    let now = live.simulation().energy();
    assert!((now / energy - 1.0).abs() < 1e-3, "{energy} {now}");
}

/// Damping and air act on sheets, not on bodies.
#[test]
fn neither_damping_nor_air_slows_a_body() {
    let mut live = live(
        "version = 1
        [sheet]
        mesh = { square = { side = 0.1, level = 1 } }
        density = 0.1
        damping = 20
        start = { velocity = [1, 0, 0] }
        [[body]]
        shape = { box = { size = [0.1, 0.1, 0.1] } }
        density = 1
        pose = { position = [0, 0, 1] }
        velocity = [1, 0, 0]
        [air]",
    );
    play(&mut live, 0.2);
    let changed = (velocity(&live, 0) - Vector3::x()).norm();
    assert!(changed < 1e-9, "{changed:e}");
    assert!(live.simulation().state().v[0] < 0.1);
}

#[test]
fn bodies_that_cannot_be_are_refused_with_the_cause() {
    let with = |body: &str| format!("{ASIDE}\n[[body]]\n{body}");
    let cube = "shape = { box = { size = [0.1, 0.1, 0.1] } }";
    for (body, says) in [
        (cube.to_owned(), ["the body has no mass", "`density`"]),
        (
            format!("{cube}\nmass = 0"),
            ["body[0].mass", "not a positive number"],
        ),
        (
            format!("{cube}\nmass = 1\ndensity = 1"),
            ["body[0].mass", "density and a mass"],
        ),
        (
            "shape = \"half_space\"\nmass = 1".into(),
            ["body[0].shape", "encloses no volume"],
        ),
        (
            format!("{cube}\nmass = 1\nsides = 3"),
            ["body[0].sides", "out of range"],
        ),
        (
            format!("{cube}\nmass = 1\npose = {{ position = [5.05, 5.05, 5] }}"),
            ["body[0]", "at the start"],
        ),
        (
            format!(
                "{cube}\nmass = 1\n[[body]]\n{cube}\nmass = 1\npose = {{ position = [0.05, 0.05, 0.05] }}"
            ),
            ["body[0].pose", "body[1]"],
        ),
        (
            format!(
                "{cube}\nmass = 1\n[[body]]\nshape = {{ sphere = {{ radius = 0.02 }} }}\nmass = 1"
            ),
            ["body[0].pose", "inside of this body"],
        ),
        (
            format!("{cube}\nmass = 1\n[[obstacle]]\nshape = {{ sphere = {{ radius = 0.02 }} }}"),
            ["body[0].pose", "inside of this body"],
        ),
        (
            format!("{cube}\nmass = 1\n[[obstacle]]\nshape = \"half_space\""),
            ["obstacle[0]", "`body[0]`"],
        ),
        (
            format!("{cube}\nmass = 1\nname = \"a\"\n[[body]]\n{cube}\nmass = 1\nname = \"a\""),
            ["body[1].name", "the name `a`"],
        ),
        (
            format!("{cube}\nmass = 1\n[method]\nintegrator = \"chart\""),
            ["method.integrator", "no place for bodies"],
        ),
        (
            format!(
                "{cube}\nmass = 1\n[[measure]]\nname = \"m\"\nsheet = \"b\"\nat = \"all\"\nquantity = \"x\""
            ),
            ["measure[0].sheet", "no sheet or body has the name `b`"],
        ),
    ] {
        let problem = problem(&with(&body));
        for part in says {
            assert!(problem.contains(part), "{body}: {problem}");
        }
    }
    // Files: open, inside out.
    let folder = tempfile::tempdir().unwrap();
    let whole = corner_piece(1.0, false);
    let cut: Vec<&str> = whole.lines().collect();
    let file = "shape = { file = { path = \"piece.obj\" } }\nmass = 1";
    for (text, says) in [
        (cut[..cut.len() - 1].join("\n"), "the surface is open"),
        (corner_piece(1.0, true), "inwards"),
        // The inner corner of the L is pulled out through the outer one.
        (
            whole.replace("v 1 1 1\n", "v -1 -1 1\n"),
            "passes through its face",
        ),
    ] {
        std::fs::write(folder.path().join("piece.obj"), text).unwrap();
        let problem = in_folder(folder.path(), &with(file)).err().unwrap();
        assert!(
            problem.contains(says) && problem.contains("piece.obj"),
            "{problem}"
        );
    }
}

/// A measure of a body, friction of a pair, and what does not change during a simulation.
#[test]
fn bodies_have_measures_and_friction_by_their_names() {
    let text = format!(
        "{ASIDE}
        [[body]]
        name = \"slab\"
        shape = {{ box = {{ size = [0.4, 0.4, 0.05] }} }}
        mass = 1
        pose = {{ position = [0, 0, 0.0257] }}
        [[body]]
        name = \"puck\"
        shape = {{ box = {{ size = [0.05, 0.05, 0.05] }} }}
        mass = 0.1
        pose = {{ position = [-0.1, 0, 0.0764] }}
        velocity = [0.5, 0, 0]
        [[obstacle]]
        shape = \"half_space\"
        friction = 0.5
        [forces]
        gravity = [0, 0, -{G}]
        [contact]
        activation = 1e-3
        [[contact.pair]]
        sheets = [\"slab\", \"puck\"]
        friction = 0.1
        [[measure]]
        name = \"puck\"
        sheet = \"puck\"
        at = \"all\"
        quantity = \"x\"
        [method]
        step = 0.004"
    );
    let mut live = live(&text);
    let setup = parse(&text).unwrap().build().unwrap();
    let gauge = &setup.measures[0];
    let show = |x: &[f64]| gauge.value(0.0, x, &Memories::default());
    assert!((show(&live.positions()) + 0.1).abs() < 1e-12);
    play(&mut live, 0.06);
    let before = velocity(&live, 1).x;
    play(&mut live, 0.2);
    let slowed = (before - velocity(&live, 1).x) / 0.2;
    assert!((slowed / (0.1 * G) - 1.0).abs() < 0.02, "{slowed}");
    let place = show(&live.positions());
    assert!(
        (place - centre(&live, 1).x).abs() < 1e-12 && place > -0.05,
        "{place}"
    );
    let change = live.change(&["body[1].mass=0.2".parse().unwrap()]);
    let problem = change.unwrap_err().to_string();
    assert!(problem.contains("does not change"), "{problem}");
}
