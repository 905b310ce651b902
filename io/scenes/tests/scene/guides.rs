//! Rigid bodies on joints, with springs, dampers, forces and torques, and glued to sheets.

use crate::bodies::{ASIDE, G, centre, live, play, problem};
use isosheet_scenes::LiveScene;
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};

/// The period of a pendulum that swings with an amplitude, in that of small swings: by the
/// arithmetic-geometric mean.
fn slowed(amplitude: f64) -> f64 {
    let (mut a, mut g) = (1.0, (0.5 * amplitude).cos());
    for _ in 0..6 {
        (a, g) = (0.5 * (a + g), f64::sqrt(a * g));
    }
    1.0 / a
}

/// A rod on a hinge at its end swings with the period of the physical pendulum, `2 pi (I / m g s)^(1/2)` for
/// small amplitudes. At its lowest place the hinge carries weight and centrifugal force.
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

/// A wheel on a hinge through its centre, that a torque turns: `I dw/dt = T`, over many turns; and a spring
/// there that counts turns and brings it back.
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
    let inertia = 0.5 * mass * radius * radius;
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

/// A damped oscillator on a slider that leans: `m s'' = m g sin a - c s' - k s`, with the closed form, and
/// the force of the guide across it.
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

/// A top on a ball joint at its foot precesses at the rate `W` for which
/// `I1 W^2 cos a - I3 w3 W + m g s = 0`, with the inertia `I1` across its axis and `I3` along it, the rate
/// `w3` about it and its lean `a`.
#[test]
fn a_top_on_a_ball_joint_precesses() {
    let (mass, radius, height, above) = (0.1, 0.05, 0.01, 0.04);
    let lean = 30.0_f64;
    let (sin, cos) = lean.to_radians().sin_cos();
    let along = 0.5 * mass * radius * radius;
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
        let first = live.facts().bodies[0].surface().start;
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

/// A force that follows a function of time accelerates a body, off its centre it turns it; and it can be
/// driven.
#[test]
fn a_force_pushes_a_body_where_it_acts() {
    let mut live = live(&format!(
        "{ASIDE}
        [[body]]
        shape = {{ box = {{ size = [0.1, 0.1, 0.1] }} }}
        mass = 2
        force = [
            {{ direction = [0, 3, 0], size = {{ ramp = {{ to = 4, end = 1 }} }} }},
            {{ direction = [0, 0, 1], size = 0.01, at = [0.05, 0, 0] }},
        ]
        [method]
        step = 2e-3"
    ));
    play(&mut live, 0.5);
    // The integral of 4 t / 2 until 0.5 s, and the torque of 5e-4 N m on m a^2 / 6.
    let v: Vector3<f64> = live.facts().bodies[0]
        .centre(&live.simulation().state().v)
        .into();
    assert!((v - Vector3::new(0.0, 0.25, 0.0025)).norm() < 2e-3, "{v}");
    let model = live.simulation().model();
    let state = live.simulation().state();
    let turning = Vector3::from(model.angular_momentum(&state.x, &state.v));
    let linear = Vector3::from(model.linear_momentum(&state.v));
    let own = turning - centre(&live, 0).cross(&linear);
    assert!((own.y / (-5e-4 * 0.5) - 1.0).abs() < 1e-3, "{own}");
    let key = "body[0].force[0].size".parse().unwrap();
    live.drive(&[(key, 0.0.into())], 0.502).unwrap();
    play(&mut live, 0.1);
    let before: Vector3<f64> = live.facts().bodies[0]
        .centre(&live.simulation().state().v)
        .into();
    play(&mut live, 0.1);
    let after: Vector3<f64> = live.facts().bodies[0]
        .centre(&live.simulation().state().v)
        .into();
    assert!((after.y - before.y).abs() < 1e-9);
}

#[test]
fn guides_and_seams_that_cannot_be_are_refused_with_the_cause() {
    let cube =
        "[[body]]\nname = \"cube\"\nshape = { box = { size = [0.1, 0.1, 0.1] } }\nmass = 1\n";
    for (more, says) in [
        (
            "guide = { hinge = { point = [1, 0, 0], axis = [0, 0, 0] } }",
            ["body[0].guide.hinge.axis", "direction"],
        ),
        (
            "guide = { hinge = { point = [1, 0, 0], axis = [0, 0, 1], damping = -1 } }",
            ["body[0].guide.hinge.damping", "less than 0"],
        ),
        (
            "velocity = [1, 0, 0]\nguide = { hinge = { point = [1, 0, 0], axis = [0, 0, 1] } }",
            ["body[0].velocity", "its hinge does not allow"],
        ),
        (
            "spin = { axis = [1, 0, 0], rate = 90 }\nguide = { hinge = { point = [1, 0, 0], axis = [0, 0, 1] } }",
            ["body[0].spin", "its hinge does not allow"],
        ),
        (
            "velocity = [1, 0.1, 0]\nguide = { slider = { direction = [1, 0, 0] } }",
            ["body[0].velocity", "its slider does not allow"],
        ),
        (
            "force = [{ direction = [0, 0, 0], size = 1 }]",
            ["body[0].force[0].direction", "direction"],
        ),
        (
            "[[glue]]\nsheets = [\"sheet\", \"cube\"]\nfirst = { vertices = [0] }\nsecond = { vertices = [1] }",
            ["glue[0].second", "is a body"],
        ),
        (
            "[[glue]]\nfirst = { vertices = [0] }",
            ["glue[0]", "no second side"],
        ),
        (
            "[[glue]]\nsheets = [\"sheet\", \"ball\"]\nfirst = { vertices = [0] }\nsecond = { vertices = [1] }",
            ["glue[0].sheets[0]", "no sheet has the name"],
        ),
    ] {
        let problem = problem(&format!("{ASIDE}{cube}{more}"));
        for part in says {
            assert!(problem.contains(part), "{more}: {problem}");
        }
    }
}
