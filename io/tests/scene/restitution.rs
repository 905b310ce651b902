//! Rigid bodies that hit one another: they part no faster than they met.

use crate::bodies::{ASIDE, centre, live, velocity};
use isosheet_io::scene::LiveScene;

/// A ball at `boost` is hit by a box that comes with `speed` more, in steps of 1/60 s, until they have
/// parted.
fn hit(mass: f64, speed: f64, boost: f64, guide: &str) -> (LiveScene, f64) {
    let scene = format!(
        "{ASIDE}[[body]]\nshape = {{ sphere = {{ radius = 0.02 }} }}\nsides = 24\nmass = {mass}\n\
         velocity = [{boost}, 0, 0]\n{guide}\n\
         [[body]]\nshape = {{ box = {{ size = [0.1, 0.1, 0.1] }} }}\nmass = 1\n\
         pose = {{ position = [-0.1, 0, 0] }}\nvelocity = [{}, 0, 0]\n",
        speed + boost
    );
    let mut live = live(&scene);
    // They are 3 cm apart.
    let steps = (0.06 / speed * 60.0).ceil() as usize + 20;
    for _ in 0..steps {
        live.step(1.0 / 60.0).unwrap();
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

/// The same holds for a body on a slider, along which it is hit, and for what an arm on a hinge hits.
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
        // A wall pushes an arm in its middle; the middle runs away no faster than twice the speed of the wall.
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
