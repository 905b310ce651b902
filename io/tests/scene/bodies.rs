//! Rigid bodies of scenes: their motion, what touches them, and what is refused.

use crate::parse;
use isosheet_io::scene::{LiveScene, SceneError, SceneFile, SceneFileError};
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::path::Path;

const G: f64 = 9.81;

/// A sheet that is held far away, for bodies alone.
const ASIDE: &str = "version = 1
[sheet]
mesh = { square = { side = 0.1, level = 0 } }
density = 0.1
placement = { position = [5, 5, 5] }
[[support]]
at = \"all\"
";

fn live(text: &str) -> LiveScene {
    let file = parse(text).unwrap_or_else(|e| panic!("{e}"));
    LiveScene::start(file).unwrap_or_else(|e| panic!("{e}"))
}

/// What is said of a scene that cannot start: the first key, and the text.
fn problem(text: &str) -> String {
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
fn play(live: &mut LiveScene, duration: f64) -> usize {
    let h = live.file().scene().method.step;
    let count = (duration / h).round() as usize;
    for _ in 0..count {
        let report = live.step(h).unwrap_or_else(|e| panic!("{e}"));
        assert!(report.gap.is_none_or(|gap| gap > 0.0));
    }
    count
}

fn centre(live: &LiveScene, body: usize) -> Vector3<f64> {
    live.bodies()[body]
        .centre(&live.simulation().state().x)
        .into()
}

fn velocity(live: &LiveScene, body: usize) -> Vector3<f64> {
    live.bodies()[body]
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

/// A corner piece of three cubes is thrown with a spin: its centre is on a parabola, its momenta are those of its
/// mass and inertia and remain, and so does its energy.
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

/// A ball and a cylinder roll without sliding: `g sin a / (1 + I / m r^2)`. Polyhedra roll over their corners.
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

/// A ball lies in a cloth that is held at two edges: the supports carry the weight of both.
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
    assert!((held / weight - 1.0).abs() < 5e-3, "{held} {weight}");
    let load = live.body_loads()[0].force[2];
    assert!((load / (0.03 * G) - 1.0).abs() < 5e-3, "{load}");
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
    assert!((velocity(&live, 0) - Vector3::x()).norm() < 1e-9);
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
            ["measure[0].sheet", "no sheet has the name `b`"],
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
    assert!((gauge.value(&live.positions()) + 0.1).abs() < 1e-12);
    play(&mut live, 0.06);
    let before = velocity(&live, 1).x;
    play(&mut live, 0.2);
    let slowed = (before - velocity(&live, 1).x) / 0.2;
    assert!((slowed / (0.1 * G) - 1.0).abs() < 0.02, "{slowed}");
    let place = gauge.value(&live.positions());
    assert!(
        (place - centre(&live, 1).x).abs() < 1e-12 && place > -0.05,
        "{place}"
    );
    let change = live.change(&["body[1].mass=0.2".parse().unwrap()]);
    let problem = change.unwrap_err().to_string();
    assert!(problem.contains("does not change"), "{problem}");
}

/// The period of a pendulum that swings with an amplitude, in that of small swings: by the arithmetic-geometric
/// mean.
fn slowed(amplitude: f64) -> f64 {
    let (mut a, mut g) = (1.0, (0.5 * amplitude).cos());
    for _ in 0..6 {
        (a, g) = (0.5 * (a + g), f64::sqrt(a * g));
    }
    1.0 / a
}

/// A rod on a hinge at its end swings with the period of the physical pendulum, `2 pi (I / m g s)^(1/2)` for small
/// amplitudes. At its lowest place the hinge carries weight and centrifugal force.
#[test]
fn a_rod_on_a_hinge_is_a_physical_pendulum() {
    let (length, side, mass) = (0.4, 0.02, 0.5);
    for degrees in [10.0_f64, 120.0] {
        let amplitude = degrees.to_radians();
        // It hangs in the plane y = 0 from the origin, displaced by its amplitude.
        let (sin, cos) = amplitude.sin_cos();
        let mut live = live(&format!(
            "{ASIDE}
            [[body]]
            shape = {{ box = {{ size = [{side}, {side}, {length}] }} }}
            mass = {mass}
            pose = {{ position = [{}, 0, {}], turn = {{ axis = [0, 1, 0], angle = {} }} }}
            guide = {{ hinge = {{ point = [0, 0, 0], axis = [0, 1, 0] }} }}
            [forces]
            gravity = [0, 0, -{G}]
            [method]
            step = 1e-3",
            0.5 * length * sin,
            -0.5 * length * cos,
            -degrees,
        ));
        let about = mass * ((length * length + side * side) / 12.0 + 0.25 * length * length);
        let lever = 0.5 * length;
        let period = TAU * (about / (mass * G * lever)).sqrt() * slowed(amplitude);
        // Half a period: from one side to the other.
        let h = live.file().scene().method.step;
        let (mut last, mut passes, mut largest) = (centre(&live, 0).x, Vec::new(), 0.0_f64);
        while passes.len() < 2 {
            live.step(h).unwrap();
            let x = centre(&live, 0).x;
            let t = live.simulation().state().t;
            if x * last < 0.0 {
                passes.push(t - h * x / (x - last));
            }
            last = x;
            largest = largest.max(live.guide_loads()[0].1.force[2]);
            let radius = centre(&live, 0).norm();
            assert!((radius - lever).abs() < 1e-9);
        }
        let found = 2.0 * (passes[1] - passes[0]);
        assert!(
            (found / period - 1.0).abs() < 2e-3,
            "{degrees}: {found} {period}"
        );
        // m g + m s w^2 with the energy of the fall.
        let rate2 = 2.0 * mass * G * lever * (1.0 - cos) / about;
        let expected = mass * (G + lever * rate2);
        assert!(
            (largest / expected - 1.0).abs() < 0.01,
            "{largest} {expected}"
        );
    }
}

/// A wheel on a hinge through its centre, that a torque turns: `I dw/dt = T`, over many turns; and a spring there
/// that counts turns and brings it back.
#[test]
fn a_torque_turns_a_wheel_about_its_centre() {
    let (radius, mass, torque) = (0.1, 1.0, 0.05);
    let wheel = |more: &str, body: &str| {
        live(&format!(
            "{ASIDE}
            [[body]]
            shape = {{ cylinder = {{ radius = {radius}, height = 0.02 }} }}
            sides = 64
            mass = {mass}
            pose = {{ position = [1, 2, 3] }}
            guide = {{ hinge = {{ point = [1, 2, 3], axis = [0, 0, 1]{more} }} }}
            {body}
            [method]
            step = 2e-3"
        ))
    };
    // A polygon of 64 sides: second moments over the area.
    let angle = TAU / 64.0;
    let inertia = 0.5 * mass * radius * radius * (2.0 + angle.cos()) / 3.0;
    let mut live = wheel(
        "",
        &format!("torque = [{{ axis = [0, 0, 1], size = {torque} }}]"),
    );
    play(&mut live, 2.0);
    let energy = live
        .simulation()
        .model()
        .kinetic_energy(&live.simulation().state().v);
    let rate = torque / inertia * 2.0;
    let expected = 0.5 * inertia * rate * rate;
    assert!(
        (energy / expected - 1.0).abs() < 1e-2,
        "{energy} {expected}"
    );
    assert!(centre(&live, 0).metric_distance(&Vector3::new(1.0, 2.0, 3.0)) < 1e-9);
    // A spring that is at rest two turns away, with a damper: it goes there.
    let mut live = wheel(
        ", stiffness = 0.02, rest = 720, damping = 0.02",
        "spin = { axis = [0, 0, 1], rate = 3000 }",
    );
    play(&mut live, 6.0);
    let potential = live.simulation().energy();
    assert!(potential < 1e-6, "{potential}");
    let speed = live
        .simulation()
        .state()
        .v
        .iter()
        .fold(0.0_f64, |m, v| m.max(v.abs()));
    assert!(speed < 1e-3, "{speed}");
}

/// A damped oscillator on a slider that leans: `m s'' = m g sin a - c s' - k s`, with the closed form, and the force
/// of the guide across it.
#[test]
fn a_body_on_a_slider_is_a_damped_oscillator() {
    let (mass, stiffness, damping, slope) = (0.2, 20.0, 0.4, 0.5_f64);
    let (sin, cos) = slope.sin_cos();
    let mut live = live(&format!(
        "{ASIDE}
        [[body]]
        shape = {{ box = {{ size = [0.1, 0.05, 0.03] }} }}
        mass = {mass}
        guide = {{ slider = {{ direction = [{cos}, 0, -{sin}], stiffness = {stiffness}, damping = {damping} }} }}
        [forces]
        gravity = [0, 0, -{G}]
        [method]
        step = 1e-3"
    ));
    let along = Vector3::new(cos, 0.0, -sin);
    let rest = mass * G * sin / stiffness;
    let (decay, omega0) = (0.5 * damping / mass, (stiffness / mass).sqrt());
    let omega = (omega0 * omega0 - decay * decay).sqrt();
    let closed = |t: f64| {
        let shape = (omega * t).cos() + decay / omega * (omega * t).sin();
        rest * (1.0 - (-decay * t).exp() * shape)
    };
    for k in 1..=6 {
        play(&mut live, 0.1);
        let place = centre(&live, 0);
        let expected = closed(0.1 * f64::from(k));
        assert!(
            (place.dot(&along) - expected).abs() < 2e-3 * rest,
            "{place} {expected}"
        );
        assert!((place - place.dot(&along) * along).norm() < 1e-9);
        let normal = mass * G * cos;
        let across = Vector3::new(sin, 0.0, cos);
        let force = Vector3::from(live.guide_loads()[0].1.force);
        assert!(
            (force.dot(&across) / normal - 1.0).abs() < 1e-3,
            "{force} {normal}"
        );
    }
    // Work, damping and the rest of the energy are in balance.
    play(&mut live, 8.0);
    assert!((centre(&live, 0).dot(&along) / rest - 1.0).abs() < 1e-3);
}

/// A top on a ball joint at its foot precesses at the rate `W` for which `I1 W^2 cos a - I3 w3 W + m g s = 0`, with the
/// inertia `I1` across its axis and `I3` along it, the rate `w3` about it and its lean `a`.
#[test]
fn a_top_on_a_ball_joint_precesses() {
    let (mass, radius, height, above) = (0.1, 0.05, 0.01, 0.04);
    let lean = 30.0_f64;
    let (sin, cos) = lean.to_radians().sin_cos();
    let angle = TAU / 64.0;
    let along = 0.5 * mass * radius * radius * (2.0 + angle.cos()) / 3.0;
    let across = 0.5 * along + mass * (height * height / 12.0 + above * above);
    let precession = 8.0_f64;
    let spin = (mass * G * above + across * precession * precession * cos) / (along * precession);
    let axis = Vector3::new(sin, 0.0, cos);
    let rate = (spin - precession * cos) * axis + precession * Vector3::z();
    let mut live = live(&format!(
        "{ASIDE}
        [[body]]
        shape = {{ cylinder = {{ radius = {radius}, height = {height} }} }}
        sides = 64
        mass = {mass}
        pose = {{ position = [{}, 0, {}], turn = {{ axis = [0, 1, 0], angle = {lean} }} }}
        spin = {{ axis = [{}, 0, {}], rate = {} }}
        guide = {{ ball = {{ point = [0, 0, 0] }} }}
        [forces]
        gravity = [0, 0, -{G}]
        [method]
        step = 5e-4",
        above * sin,
        above * cos,
        rate.x,
        rate.z,
        rate.norm().to_degrees()
    ));
    let duration = 0.2;
    play(&mut live, duration);
    let place = centre(&live, 0);
    assert!((place.norm() / above - 1.0).abs() < 1e-9);
    let turned = place.y.atan2(place.x) / (precession * duration);
    assert!((turned - 1.0).abs() < 2e-3, "{turned}");
    assert!((place.z / (above * cos) - 1.0).abs() < 2e-3, "{place}");
}

/// A strip that is pulled over a roller on a hinge turns it by friction: its rim has the speed of the strip.
#[test]
fn a_pulled_strip_drives_a_roller() {
    let (radius, speed) = (0.03, 0.1);
    let mut live = live(&format!(
        "version = 1
        [sheet]
        mesh = {{ rectangle = {{ width = 0.3, height = 0.04, columns = 30, rows = 4, diagonals = \"union_jack\" }} }}
        isometry = {{ elastic = {{ stiffness = 3e5 }} }}
        bending = {{ plate = {{ rigidity = 1e-4, poisson = 0.3 }} }}
        mass = 2e-3
        damping = 4
        placement = {{ position = [-0.15, -0.02, 0] }}
        [[support]]
        at = {{ half_space = {{ point = [0.1499, 0, 0], normal = [1, 0, 0] }} }}
        hold = {{ moving_pin = {{ x = {{ run_up = {{ rate = {speed}, begin = 0.3, end = 0.6 }} }} }} }}
        [[support]]
        at = {{ half_space = {{ point = [-0.1499, 0, 0], normal = [-1, 0, 0] }} }}
        hold = {{ moving_pin = {{ x = {{ run_up = {{ rate = {speed}, begin = 0.3, end = 0.6 }} }} }} }}
        [[body]]
        shape = {{ cylinder = {{ radius = {radius}, height = 0.06 }} }}
        sides = 48
        mass = 0.02
        pose = {{ position = [0, 0, 0.0304], turn = {{ axis = [1, 0, 0], angle = 90 }} }}
        guide = {{ hinge = {{ point = [0, 0, 0.0304], axis = [0, 1, 0] }} }}
        [forces]
        gravity = [0, 0, 9.81]
        [contact]
        friction = 0.8
        activation = 1e-3
        [method]
        step = 0.005"
    ));
    play(&mut live, 1.2);
    let before = live.simulation().state().t;
    let point = |live: &LiveScene| {
        // A point of the rim on the roller.
        let first = live.bodies()[0].surface().start;
        Vector3::from(live.positions().as_chunks::<3>().0[first])
    };
    let middle = Vector3::new(0.0, 0.0, 0.0304);
    let angle = |live: &LiveScene| {
        let r = point(live) - middle;
        r.z.atan2(r.x)
    };
    let (mut last, mut turned) = (angle(&live), 0.0);
    for _ in 0..40 {
        play(&mut live, 0.005);
        let now = angle(&live);
        turned += (now - last + PI).rem_euclid(TAU) - PI;
        last = now;
    }
    let rim = radius * turned.abs() / (live.simulation().state().t - before);
    assert!((rim / speed - 1.0).abs() < 0.05, "{rim} {speed}");
}

/// A cloth that is glued to a pole hangs from it, and the guide of the pole carries both.
#[test]
fn a_cloth_is_glued_to_a_pole() {
    let mut live = live(&format!(
        "version = 1
        [sheet]
        name = \"flag\"
        mesh = {{ square = {{ side = 0.2, level = 2 }} }}
        isometry = {{ elastic = {{ stiffness = 3e5 }} }}
        bending = {{ plate = {{ rigidity = 1e-4, poisson = 0.3 }} }}
        mass = 4e-3
        damping = 8
        placement = {{ position = [0.0105, 0, 0], turn = {{ axis = [1, 0, 0], angle = 90 }} }}
        [[body]]
        name = \"pole\"
        shape = {{ box = {{ size = [0.02, 0.02, 0.3] }} }}
        mass = 0.05
        pose = {{ position = [0, 0, 0.1] }}
        guide = {{ hinge = {{ point = [0, 0, 0], axis = [0, 0, 1] }} }}
        [[glue]]
        sheets = [\"flag\", \"pole\"]
        first = {{ line = {{ from = [0, 0, 0], to = [0, 0.2, 0] }} }}
        [forces]
        gravity = [0, 0, -{G}]"
    ));
    play(&mut live, 3.0);
    let carried = live.guide_loads()[0].1.force[2];
    let weight = G * (4e-3 + 0.05);
    assert!((carried / weight - 1.0).abs() < 5e-3, "{carried} {weight}");
}
