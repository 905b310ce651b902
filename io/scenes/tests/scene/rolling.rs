//! Round bodies touch by their true surface: they roll as they should, and nothing comes into them.

use crate::bodies::{ASIDE, G, centre, live, velocity};
use isosheet_scenes::LiveScene;
use nalgebra::Vector3;

/// The acceleration of a body on what is below it along x, where gravity points down a slope: over the second
/// half of a time, as bodies have settled by then.
fn acceleration(live: &mut LiveScene, step: f64, duration: f64) -> f64 {
    let count = (0.5 * duration / step).round() as usize;
    let mut speeds = [0.0; 2];
    for speed in &mut speeds {
        for _ in 0..count {
            let report = live.step(step).unwrap_or_else(|e| panic!("{e}"));
            assert!(report.gap.is_none_or(|gap| gap > 0.0));
        }
        *speed = velocity(live, 0).x;
    }
    (speeds[1] - speeds[0]) / (count as f64 * step)
}

/// Gravity down a slope along x.
fn gravity(tangent: f64) -> String {
    let slope = tangent.atan();
    let [x, z] = [G * slope.sin(), -G * slope.cos()];
    format!("[forces]\ngravity = [{x}, 0, {z}]\n")
}

/// A body that lies with its middle so high above the plane z = 0, on something.
fn on(tangent: f64, height: f64, body: &str, below: &str) -> LiveScene {
    live(&format!(
        "{ASIDE}[contact]\nactivation = 1e-4\nfriction = 0.8\n{}[[body]]\n{body}\ndensity = 500\n{below}",
        gravity(tangent),
    )
    .replace("HEIGHT", &format!("{}", height + 5e-5)))
}

const FLOOR: &str = "[[obstacle]]\nshape = \"half_space\"\nfriction = 0.8\n";

/// `g sin a / (1 + I / (m r^2))`, of a ball 5/7 g sin a, on any slope and in any steps.
#[test]
fn balls_roll_down_at_five_sevenths() {
    for tangent in [0.002, 0.05, 0.3] {
        for step in [1.0 / 60.0, 1.0 / 240.0] {
            let body =
                "shape = { sphere = { radius = 0.3 } }\npose = { position = [0, 0, HEIGHT] }";
            let mut live = on(tangent, 0.3, body, FLOOR);
            let found = acceleration(&mut live, step, 0.5);
            let wanted = 5.0 / 7.0 * G * tangent.atan().sin();
            assert!(
                (found / wanted - 1.0).abs() < 5e-3,
                "{tangent}, {step}: {found} {wanted}"
            );
        }
    }
}

/// However the ball is turned, and on whatever it rolls: a box that is an obstacle, and one that is a heavy
/// body itself.
#[test]
fn balls_roll_on_boxes() {
    let table = "[[obstacle]]\nshape = { box = { size = [4, 4, 1] } }\npose = { position = [0, 0, -0.5] }\nfriction = 0.8\n";
    let held = "[[body]]\nshape = { box = { size = [4, 4, 1] } }\ndensity = 500\npose = { position = [0.1, 0.3, -0.5] }\n\
                guide = { slider = { direction = [0, 1, 0] } }\n";
    let body = "shape = { sphere = { radius = 0.3 } }\n\
                pose = { position = [0, 0, HEIGHT], turn = { axis = [1, 2, 3], angle = 77 } }";
    for (name, below) in [("table", table), ("body", held)] {
        let mut live = on(0.1, 0.3, body, below);
        let found = acceleration(&mut live, 1.0 / 120.0, 0.5);
        let wanted = 5.0 / 7.0 * G * 0.1_f64.atan().sin();
        assert!(
            (found / wanted - 1.0).abs() < 5e-3,
            "{name}: {found} {wanted}"
        );
    }
}

/// A capsule across the slope: a cylinder of the length l has `m r^2 / 2`, two half balls `2/5 m r^2`.
#[test]
fn capsules_roll() {
    let (radius, length) = (0.2_f64, 0.5_f64);
    let cylinder = radius * radius * length;
    let balls = 4.0 / 3.0 * radius.powi(3);
    let part = (0.5 * cylinder + 0.4 * balls) / (cylinder + balls);
    for tangent in [0.05, 0.3] {
        for step in [1.0 / 60.0, 1.0 / 240.0] {
            let body = "shape = { capsule = { radius = 0.2, length = 0.5 } }\n\
                        pose = { position = [0, 0, HEIGHT], turn = { axis = [1, 0, 0], angle = 90 } }";
            let mut live = on(tangent, 0.2, body, FLOOR);
            let found = acceleration(&mut live, step, 0.4);
            let wanted = G * tangent.atan().sin() / (1.0 + part);
            assert!(
                (found / wanted - 1.0).abs() < 5e-3,
                "{tangent}, {step}: {found} {wanted}"
            );
        }
    }
}

/// Balls and capsules stop each other, whichever way they meet, and stop at obstacles, with friction and
/// without: at the distance of their surfaces, which is that of points and segments.
#[test]
fn round_bodies_do_not_enter_each_other() {
    let ball = |x: f64, vx: f64| {
        format!(
            "[[body]]\nshape = {{ sphere = {{ radius = 0.03 }} }}\ndensity = 300\n\
             pose = {{ position = [{x}, 0.004, 0.003] }}\nvelocity = [{vx}, 0, 0]\n"
        )
    };
    let capsule = |kind: &str, x: f64, vx: f64, turn: f64| {
        let (rest, velocity) = match kind {
            "body" => ("density = 300\n", format!("velocity = [{vx}, 0, 0]\n")),
            _ => ("", String::new()),
        };
        format!(
            "[[{kind}]]\nshape = {{ capsule = {{ radius = 0.02, length = 0.1 }} }}\n{rest}\
             pose = {{ position = [{x}, 0, 0], turn = {{ axis = [1, 0, 0], angle = {turn} }} }}\n{velocity}"
        )
    };
    let sphere = "[[obstacle]]\nshape = { sphere = { radius = 0.015 } }\npose = { position = [0.1, 0.001, 0.01] }\n";
    let short = "[[obstacle]]\nshape = { capsule = { radius = 0.02, length = 0.02 } }\npose = { position = [0.1, 0, 0] }\n";
    let scenes = [
        ("balls", ball(0.0, 1.0) + &ball(0.1, -1.0)),
        (
            "ball and capsule",
            capsule("body", 0.1, -1.0, 90.0) + &ball(0.0, 1.0),
        ),
        (
            "parallel capsules",
            capsule("body", 0.0, 1.0, 0.0) + &capsule("body", 0.1, -1.0, 0.0),
        ),
        (
            "crossed capsules",
            capsule("body", 0.0, 1.0, 30.0) + &capsule("body", 0.1, -1.0, -40.0),
        ),
        (
            "capsule and a ball at rest",
            capsule("body", 0.0, 2.0, 0.0) + sphere,
        ),
        (
            "capsule and a short capsule",
            capsule("body", 0.0, 2.0, 0.0) + short,
        ),
        (
            "ball and capsule at rest",
            ball(0.0, 2.0) + &capsule("obstacle", 0.1, 0.0, 20.0),
        ),
    ];
    for (name, bodies) in scenes {
        let mut live = live(&format!(
            "{ASIDE}[contact]\nactivation = 5e-4\nfriction = 0.3\n{bodies}"
        ));
        let mut least = f64::INFINITY;
        for _ in 0..30 {
            let report = live
                .step(1.0 / 60.0)
                .unwrap_or_else(|e| panic!("{name}: {e}"));
            let gap = report.gap.unwrap();
            assert!(gap > 0.0, "{name}");
            least = least.min(gap);
        }
        // They touched, and the first did not go on as it went.
        assert!(least < 5e-4, "{name}: {least}");
        assert!(
            velocity(&live, 0).x.abs() < 0.95 * (2.0 - f64::from(bodies.contains("-1, 0, 0"))),
            "{name}"
        );
        let passed = centre(&live, 0).x;
        let limit = if name == "ball and capsule" {
            -1.0..0.2
        } else {
            -1.0..0.09
        };
        assert!(limit.contains(&passed), "{name}: {passed}");
    }
}

fn hammock() -> String {
    format!(
        "version = 1
        [sheet]
        mesh = {{ square = {{ side = 0.2, level = 2 }} }}
        isometry = {{ elastic = {{ stiffness = 3e5 }} }}
        bending = {{ plate = {{ rigidity = 5e-4, poisson = 0.3 }} }}
        mass = 3.2e-3
        thickness = 2e-4
        [[support]]
        at = \"boundary\"
        [[body]]
        name = \"ball\"
        shape = {{ sphere = {{ radius = 0.025 }} }}
        mass = 0.03
        pose = {{ position = [0.11, 0.09, 0.04] }}
        velocity = [0.3, 0, -1]
        spin = {{ axis = [1, 1, 0], rate = 300 }}
        [forces]
        gravity = [0, 0, -{G}]
        [contact]
        friction = 0.3"
    )
}

/// The least distance of the centre of the ball from the faces of the sheet.
fn clearance(live: &LiveScene) -> f64 {
    let x = &live.simulation().state().x;
    let place = |v: usize| Vector3::from_column_slice(&x[3 * v..3 * v + 3]);
    let centre = centre(live, 0);
    let topology = live.simulation().model().topology();
    let first = live.facts().bodies[0].vertices()[0].index();
    let sheet = topology
        .faces()
        .iter()
        .filter(|face| face[0].index() < first);
    let distances = sheet.map(|face| {
        let [a, b, c] = face.map(|v| place(v.index()));
        isosheet_geometry::distance::point_triangle(&[centre, a, b, c]).distance()
    });
    distances.fold(f64::INFINITY, f64::min)
}

/// A ball that is thrown into a hammock keeps its surface outside of the cloth and its thickness at each
/// step, the balance of the energy holds, and a run that is resumed goes on bit for bit.
#[test]
fn a_ball_thrown_into_a_hammock_stays_on_it() {
    let mut live = live(&hammock());
    let mut least = f64::INFINITY;
    let start = live.simulation().energy();
    for step in 0..90 {
        let report = live.step(1.0 / 120.0).unwrap();
        assert!(report.gap.unwrap() > 0.0);
        let clear = clearance(&live) - 0.025 - 2e-4;
        assert!(clear > 0.0, "step {step}: {clear}");
        least = least.min(clear);
        let most = start.abs().max(0.03 * G * 0.04);
        assert!(
            live.simulation().energy() - start < 1e-3 * most,
            "step {step}"
        );
        if step == 30 {
            let checkpoint = live.simulation().checkpoint();
            let file = live.file().clone();
            let mut resumed = LiveScene::resume(file, checkpoint).unwrap();
            let mut other =
                LiveScene::resume(live.file().clone(), live.simulation().checkpoint()).unwrap();
            for _ in 0..10 {
                resumed.step(1.0 / 120.0).unwrap();
                other.step(1.0 / 120.0).unwrap();
            }
            assert_eq!(resumed.simulation().state(), other.simulation().state());
        }
    }
    let limit = live.simulation().contacts().is_some();
    assert!(limit && least < 1e-3, "{least}");
}

/// A ball in a hammock makes equal steps in the run itself and after its resumption.
#[test]
fn a_resumed_ball_rolls_on_bit_for_bit() {
    let mut run = live(&hammock());
    for _ in 0..20 {
        run.step(1.0 / 120.0).unwrap();
    }
    // Longer and shorter ones, by which what contact made of velocities counts.
    let checkpoint = run.simulation().checkpoint();
    let mut resumed = LiveScene::resume(run.file().clone(), checkpoint).unwrap();
    for h in [1.0 / 120.0, 1.0 / 60.0, 1.0 / 100.0, 1.0 / 120.0] {
        run.step(h).unwrap();
        resumed.step(h).unwrap();
        assert_eq!(run.simulation().state(), resumed.simulation().state());
    }
}

/// A ball and a free sheet that collide keep their momentum.
#[test]
fn a_ball_and_a_sheet_keep_their_momentum() {
    let text = hammock()
        .replace("[[support]]\n        at = \"boundary\"\n", "")
        .replace(&format!("[forces]\n        gravity = [0, 0, -{G}]\n"), "");
    let mut live = live(&text);
    let momentum = |live: &LiveScene| {
        let simulation = live.simulation();
        Vector3::from(simulation.model().linear_momentum(&simulation.state().v))
    };
    let before = momentum(&live);
    for _ in 0..30 {
        live.step(1.0 / 120.0).unwrap();
    }
    assert!((velocity(&live, 0) - Vector3::new(0.3, 0.0, -1.0)).norm() > 0.02);
    let lost = (momentum(&live) - before).norm() / before.norm();
    // The root of the tolerance of a step with bodies, of the change of momentum.
    assert!(lost < 1e-2, "{lost}");
}

/// Cylinders are prisms with 256 sides.
#[test]
fn cylinders_roll_down_at_two_thirds() {
    for (radius, activation) in [(0.03, 1e-4), (0.2, 1e-4), (0.2, 1e-3)] {
        for tangent in [0.05_f64, 0.3] {
            for step in [1.0 / 60.0, 1.0 / 240.0] {
                let scene = format!(
                    "{ASIDE}[contact]\nactivation = {activation}\nfriction = 0.8\n{}[[body]]\n\
                     shape = {{ cylinder = {{ radius = {radius}, height = 0.5 }} }}\n\
                     pose = {{ position = [0, 0, {}], turn = {{ axis = [1, 0, 0], angle = 90 }} }}\n\
                     density = 500\n{FLOOR}",
                    gravity(tangent),
                    radius + 0.5 * activation,
                );
                let mut live = live(&scene);
                // It turns by a few degrees in a step.
                let duration = if radius < 0.1 { 0.1 } else { 0.4 };
                let found = acceleration(&mut live, step, duration);
                let wanted = 2.0 / 3.0 * G * tangent.atan().sin();
                let case = format!("{radius}, {activation}, {tangent}, {step}");
                assert!(
                    (found / wanted - 1.0).abs() < 5e-3,
                    "{case}: {found} {wanted}"
                );
            }
        }
    }
}

/// What is left of the energy of a body that turns, after a second.
#[test]
fn bodies_that_turn_keep_their_energy() {
    for (name, shape) in [
        ("ball", "sphere = { radius = 0.03 }"),
        ("box", "box = { size = [0.03, 0.07, 0.1] }"),
    ] {
        for turns in [1.0, 5.0] {
            for step in [1.0 / 60.0, 1.0 / 240.0] {
                let mut live = live(&format!(
                    "{ASIDE}[[body]]\nshape = {{ {shape} }}\nmass = 1\nspin = {{ axis = [0.1, 1, 0.2], rate = {} }}\n",
                    360.0 * turns
                ));
                let start = live.simulation().energy();
                for _ in 0..(1.0_f64 / step).round() as usize {
                    live.step(step).unwrap();
                }
                let left = live.simulation().energy() / start;
                assert!(
                    (0.98..1.0 + 1e-9).contains(&left),
                    "{name}, {turns}, {step}: {left}"
                );
            }
        }
    }
}
