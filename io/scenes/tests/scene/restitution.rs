//! Rigid bodies that hit one another: they part no faster than they met.

use crate::bodies::{ASIDE, centre, live, velocity};
use isosheet_scenes::LiveScene;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const H: f64 = 1.0 / 60.0;

/// A ball at `boost`, 3 cm from a box that comes with `speed` more.
fn apart(mass: f64, speed: f64, boost: f64, guide: &str) -> LiveScene {
    live(&format!(
        "{ASIDE}[[body]]\nshape = {{ sphere = {{ radius = 0.02 }} }}\nsides = 24\nmass = {mass}\n\
         velocity = [{boost}, 0, 0]\n{guide}\n\
         [[body]]\nshape = {{ box = {{ size = [0.1, 0.1, 0.1] }} }}\nmass = 1\n\
         pose = {{ position = [-0.1, 0, 0] }}\nvelocity = [{}, 0, 0]\n",
        speed + boost
    ))
}

/// They hit one another in steps of 1/60 s, until they have parted.
fn hit(mass: f64, speed: f64, boost: f64, guide: &str) -> (LiveScene, f64) {
    let mut live = apart(mass, speed, boost, guide);
    let steps = (0.06 / speed * 60.0).ceil() as usize + 20;
    for _ in 0..steps {
        live.step(H).unwrap();
    }
    let [ball, other] = [0, 1].map(|body| velocity(&live, body).x);
    (live, (ball - other) / speed)
}

/// Whatever the masses, the speeds and the frame of reference; the momentum of both together stays.
#[test]
fn bodies_part_no_faster_than_they_met() {
    for mass in [1e-3, 1e-2, 0.1, 1.0, 10.0, 1e3] {
        for (speed, boost) in [(0.03, 0.0), (0.3, 0.0), (0.3, 5.0), (3.0, -1.0)] {
            let (live, restitution) = hit(mass, speed, boost, "");
            let case = format!("mass {mass}, speed {speed}, boost {boost}");
            assert!((0.0..=1.0).contains(&restitution), "{case}: {restitution}");
            let [ball, other] = [0, 1].map(|body| velocity(&live, body).x - boost);
            let momentum = mass * ball + other;
            assert!((momentum / speed - 1.0).abs() < 1e-5, "{case}: {momentum}");
        }
    }
}

/// A body on a slider, along which it is hit, and what an arm on a hinge hits, part no faster than they met.
#[test]
fn guided_bodies_part_no_faster_than_they_met() {
    let slider = "guide = { slider = { direction = [1, 0, 0] } }";
    for mass in [1e-2, 1.0] {
        for speed in [0.1, 0.3, 1.0] {
            let (_, restitution) = hit(mass, speed, 0.0, slider);
            assert!(
                (0.0..=1.0).contains(&restitution),
                "{mass} {speed}: {restitution}"
            );
        }
    }
    for speed in [0.1, 0.3, 1.0] {
        // A wall pushes an arm in its middle; the middle runs away no faster than twice the speed of the
        // wall.
        let scene = format!(
            "{ASIDE}[[body]]\nshape = {{ box = {{ size = [0.02, 0.2, 0.02] }} }}\nmass = 0.02\n\
             guide = {{ hinge = {{ point = [0, 0.1, 0], axis = [0, 0, 1] }} }}\n\
             [[obstacle]]\nshape = {{ sphere = {{ radius = 0.02 }} }}\npose = {{ position = [-0.05, 0, 0] }}\n\
             motion = {{ x = {{ ramp = {{ to = {speed}, end = 1 }} }} }}\n"
        );
        let mut live = live(&scene);
        let (mut fastest, mut before) = (0.0_f64, centre(&live, 0));
        for _ in 0..(0.04 / speed * 60.0) as usize + 4 {
            live.step(1.0 / 60.0).unwrap();
            let now = centre(&live, 0);
            fastest = fastest.max((now - before).norm() * 60.0);
            before = now;
        }
        assert!(
            fastest > 0.9 * speed && fastest <= 2.0 * speed,
            "{speed}: {fastest}"
        );
    }
}

/// The speed at which the ball and the box part after these steps, and more of the last one, over that at
/// which they met.
fn parted(mut live: LiveScene, speed: f64, steps: impl IntoIterator<Item = f64>) -> f64 {
    let mut gone = false;
    let mut last = H;
    for h in steps {
        live.step(h).unwrap();
        last = h;
    }
    for _ in 0..60 {
        live.step(last).unwrap();
        let apart = centre(&live, 0).x - centre(&live, 1).x;
        gone |= apart > 0.1;
        if gone {
            break;
        }
    }
    (velocity(&live, 0).x - velocity(&live, 1).x) / speed
}

/// Steps that become longer give no more of an impulse than equal ones.
#[test]
fn bodies_part_no_faster_than_they_met_in_steps_that_grow() {
    let divided = [1.0 / 8.0; 8].into_iter().chain([0.25; 4]).chain([0.5]);
    let rows: [(&str, Vec<f64>); 4] = [
        ("equal", vec![1.0; 8]),
        ("halves", vec![0.5, 0.5, 1.0, 1.0]),
        ("thirds", vec![2.0 / 3.0, 2.0 / 3.0, 1.0, 1.0]),
        ("doubled", divided.collect()),
    ];
    for (name, row) in rows {
        for mass in [1e-3, 0.1, 1.0, 10.0] {
            let steps = row.iter().map(|part| part * H).chain([H; 20]);
            let restitution = parted(apart(mass, 3.0, 0.0, ""), 3.0, steps);
            assert!(
                (0.0..=1.0).contains(&restitution),
                "{name}, mass {mass}: {restitution}"
            );
        }
    }
}

/// In any divisions of steps, for any masses.
#[test]
fn bodies_part_no_faster_than_they_met_in_random_steps() {
    let mut rng = ChaCha8Rng::seed_from_u64(isosheet_random::seed());
    for case in 0..400 * isosheet_random::times() {
        let mass = 10.0_f64.powf(rng.random_range(-3.0..1.0));
        let mut step = H * 0.5_f64.powi(rng.random_range(0..4));
        let steps: Vec<f64> = (0..60)
            .map(|_| {
                // Any length up to twice the one before, at most 1/60 s.
                step = (step * rng.random_range(0.4..2.0)).clamp(H / 32.0, H);
                step
            })
            .collect();
        let restitution = parted(apart(mass, 3.0, 0.0, ""), 3.0, steps.clone());
        assert!(
            (0.0..=1.0).contains(&restitution),
            "case {case}, mass {mass}: {restitution} in the steps {steps:?}"
        );
    }
}

/// Bodies of any shape that meet aside of their centres, turning, with friction, in any divisions of steps:
/// they have no more energy afterwards.
#[test]
fn bodies_that_meet_aside_gain_no_energy_in_random_steps() {
    let mut rng = ChaCha8Rng::seed_from_u64(isosheet_random::seed());
    let mut touched = 0;
    let cases = 60 * isosheet_random::times();
    for case in 0..cases {
        let mut vector = |size: f64| [0; 3].map(|_| rng.random_range(-size..size));
        let (axis, rates) = ([vector(1.0), vector(1.0)], vector(720.0));
        let [_, y, z] = vector(0.04);
        let mass = 10.0_f64.powf(rng.random_range(-3.0..1.0));
        let shape = [
            "box = { size = [0.03, 0.05, 0.08] }",
            "sphere = { radius = 0.03 }",
            "capsule = { radius = 0.02, length = 0.06 }",
        ][case as usize % 3];
        let mut live = live(&format!(
            "{ASIDE}[contact]\nfriction = 0.3\n\
             [[body]]\nshape = {{ {shape} }}\nmass = {mass}\npose = {{ position = [0, {y}, {z}] }}\n\
             spin = {{ axis = {:?}, rate = {} }}\n\
             [[body]]\nshape = {{ box = {{ size = [0.1, 0.1, 0.1] }} }}\nmass = 1\n\
             pose = {{ position = [-0.2, 0, 0] }}\nvelocity = [3, 0, 0]\n\
             spin = {{ axis = {:?}, rate = {} }}\n",
            axis[0], rates[0], axis[1], rates[1]
        ));
        let start = live.simulation().energy();
        let mut step = H;
        for _ in 0..16 {
            step = (step * rng.random_range(0.4..2.0)).clamp(H / 32.0, H);
            live.step(step).unwrap();
        }
        for _ in 0..4 {
            live.step(H).unwrap();
        }
        touched += u32::from(velocity(&live, 0).norm() > 1e-3);
        let gained = live.simulation().energy() / start - 1.0;
        assert!(
            gained < 1e-6,
            "case {case}, {shape}, mass {mass}: {gained:e}"
        );
    }
    assert!(2 * touched > cases, "{touched} of {cases} met");
}
