//! Everyday scenes with rigid bodies, against what mechanics says of them.

use crate::bodies::{ASIDE, G, centre, live, play};
use isosheet_scenes::{LiveScene, StartingPoint};
use std::f64::consts::PI;
use std::fmt::Write;

/// Height of the highest vertex of a body.
fn top(live: &LiveScene, body: usize) -> f64 {
    let range = live.facts().bodies[body].surface();
    let x = live.positions();
    let heights = x.as_chunks::<3>().0[range].iter().map(|p| p[2]);
    heights.fold(f64::NEG_INFINITY, f64::max)
}

/// A cloth is pulled away from under a vase that stands on it: friction carries the vase along while the
/// cloth slides beneath, and brakes it on the table afterwards, over `m u g t^2` in all, where the end of the
/// cloth passes its foot at `t`: between the times at which it comes to the foot and leaves it.
#[test]
fn a_cloth_is_pulled_from_under_a_vase() {
    let (friction, radius, half, speed) = (0.2, 0.03, 0.25, 3.0);
    let mut live = live(&format!(
        "version = 1
        [sheet]
        mesh = {{ rectangle = {{ width = 0.5, height = 0.3, columns = 20, rows = 12 }} }}
        material = \"cotton\"
        placement = {{ position = [-0.25, -0.15, 5e-4] }}
        [[support]]
        at = {{ box = {{ min = [0.2499, -1, -1], max = [1, 1, 1] }} }}
        hold = {{ moving_pin = {{ x = {{ run_up = {{ rate = {speed}, begin = 0.1, end = 0.15 }} }} }} }}
        [[body]]
        shape = {{ cylinder = {{ radius = {radius}, height = 0.12 }} }}
        density = 700
        pose = {{ position = [0, 0, 0.0612] }}
        [contact]
        friction = {friction}
        [[obstacle]]
        shape = {{ box = {{ size = [0.8, 0.6, 0.05] }} }}
        pose = {{ position = [-0.1, 0, -0.025] }}
        friction = {friction}
        [forces]
        gravity = [0, 0, -{G}]
        [method]
        step = 0.004"
    ));
    let standing = top(&live, 0);
    play(&mut live, 0.6);
    let moved = centre(&live, 0).x;
    // The cloth slides from 0.1 s on, by 0.075 m up to its speed at 0.15 s.
    let sliding = |way: f64| 0.05 + (way - 0.075) / speed;
    let carried = |way: f64| friction * G * sliding(way).powi(2);
    let (least, most) = (carried(half - radius), carried(half + radius + moved));
    assert!(least < moved && moved < most, "{least} {moved} {most}");
    assert!((top(&live, 0) - standing).abs() < 2e-3, "it stands");
    let cloth = &live.positions()[..3 * 13 * 21];
    let left = cloth
        .iter()
        .step_by(3)
        .fold(f64::INFINITY, |m, x| m.min(*x));
    assert!(left > moved + radius, "the cloth is away: {left}");
}

/// Two cards that lean against each other, each by an angle from upright.
fn card_house(friction: f64, degrees: f64) -> String {
    let [thick, height] = [3e-3_f64, 0.09];
    let mut text = format!(
        "{ASIDE}
        [contact]
        friction = {friction}
        [forces]
        gravity = [0, 0, -{G}]
        [method]
        step = 0.004
        [[obstacle]]
        shape = {{ box = {{ size = [1, 1, 0.1] }} }}
        pose = {{ position = [0, 0, -0.05] }}
        friction = {friction}\n"
    );
    let (s, c) = degrees.to_radians().sin_cos();
    // The ridge is where the upper inner edges are, the foot where the lower outer ones are.
    let reach = 0.5 * (thick * c + height * s);
    let rise = 0.5 * (thick * s + height * c);
    for side in [-1.0, 1.0] {
        writeln!(
            text,
            "[[body]]
            shape = {{ box = {{ size = [{thick}, 0.06, {height}] }} }}
            density = 800
            pose = {{ position = [{}, 0, {}], turn = {{ axis = [0, 1, 0], angle = {} }} }}",
            side * (reach + 2e-4),
            rise + 2e-4,
            -side * degrees
        )
        .unwrap();
    }
    text
}

/// Thin cards that lean at an angle `a` from upright stand if friction is above `tan(a) / 2`, and slide apart
/// below.
#[test]
fn a_house_of_cards_stands_by_friction() {
    let degrees = 20.0_f64;
    let needed = 0.5 * degrees.to_radians().tan();
    for (part, stands) in [(0.6, false), (1.4, true)] {
        let mut live = live(&card_house(part * needed, degrees));
        let before = top(&live, 0);
        play(&mut live, 1.0);
        let sunk = before - top(&live, 0);
        assert_eq!(sunk < 2e-3, stands, "{part}: sinks by {sunk}");
    }
}

/// Dominoes fall one after the other, and faster from one to the next up to the speed of a long row, which is
/// a small multiple of the root of `g` times their height.
#[test]
fn dominoes_fall_in_a_row() {
    let (count, [thick, wide, high], pitch) = (8, [0.0075, 0.024, 0.048], 0.0275);
    let mut text = format!(
        "{ASIDE}
        [contact]
        friction = 0.2
        [forces]
        gravity = [0, 0, -{G}]
        [method]
        step = 0.002
        [[obstacle]]
        shape = {{ box = {{ size = [1, 1, 0.1] }} }}
        pose = {{ position = [0, 0, -0.05] }}
        friction = 0.5\n"
    );
    for k in 0..count {
        writeln!(
            text,
            "[[body]]
            shape = {{ box = {{ size = [{thick}, {wide}, {high}] }} }}
            density = 1100
            pose = {{ position = [{}, 0, {}] }}",
            f64::from(k) * pitch,
            0.5 * high + 1e-4
        )
        .unwrap();
        if k == 0 {
            let pushed = "spin = { axis = [0, 1, 0], rate = 250, centre = [0.00375, 0, 0] }\n";
            text.push_str(pushed);
        }
    }
    let mut live = live(&text);
    let mut fallen = vec![None; count as usize];
    while fallen.contains(&None) {
        play(&mut live, 0.002);
        let t = live.simulation().state().t;
        assert!(t < 1.0, "{fallen:?}");
        for (k, at) in fallen.iter_mut().enumerate() {
            // Turned by 30 degrees.
            if at.is_none() && centre(&live, k).z < 0.5 * high * 0.75_f64.sqrt() {
                *at = Some(t);
            }
        }
    }
    let times: Vec<f64> = fallen.into_iter().flatten().collect();
    let steps: Vec<f64> = times.windows(2).map(|t| t[1] - t[0]).collect();
    assert!(steps.iter().all(|s| *s > 0.0), "{times:?}");
    let speed = pitch / steps[count as usize - 2];
    let scale = (G * high).sqrt();
    assert!(
        speed > pitch / steps[0] && speed < 4.0 * scale,
        "{steps:?} {speed} {scale}"
    );
}

/// The plane to start from glides straight on. A wing of its aspect ratio has the lift of Helmbold, a bent-up
/// flap of a quarter of the chord takes 0.61 of its angle off (Glauert), and the drag of lift is between that
/// of a force across the wing, without the suction of its sharp leading edge, and that of an elliptic wing
/// with all of it.
#[test]
fn a_plane_glides_as_far_as_its_lift_allows() {
    let (chord, span, friction, bend, duration) = (0.12, 0.3, 0.02, 4.0_f64.to_radians(), 2.0);
    let mut live = live(StartingPoint::Plane.text());
    let weight = G * live.masses().iter().sum::<f64>();
    let place = |live: &LiveScene| {
        let x = live.positions();
        let points = x.as_chunks::<3>().0;
        [0, 1, 2].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / points.len() as f64)
    };
    play(&mut live, 2.0);
    let begin = place(&live);
    play(&mut live, duration);
    let end = place(&live);
    let [ahead, aside, down] = [0, 1, 2].map(|k| begin[k] - end[k]);
    let speed = ahead.hypot(down) / duration;
    let aspect = span / chord;
    let lift = 2.0 * weight / (1.2 * speed * speed * chord * span);
    let slope = 2.0 * PI * aspect / (2.0 + (4.0 + aspect * aspect).sqrt());
    let angle = lift / slope + 0.61 * bend;
    let without_suction = lift / (friction + lift * angle.tan());
    let with_suction = lift / (friction + lift * lift / (PI * aspect));
    let ratio = ahead / down;
    assert!(
        ratio > 0.75 * without_suction && ratio < with_suction,
        "{ratio}: {without_suction} {with_suction}"
    );
    assert!(aside.abs() < 1e-3, "{aside}");
}
