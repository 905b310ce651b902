//! Sheets that are thrown, and weights on them.

use crate::{parse, simulation};
use isosheet_dynamics::Simulation;
use isosheet_dynamics::nalgebra::{Rotation3, Vector3};

const SQUARE: &str =
    "version = 1\n[sheet]\nmesh = { square = { side = 0.2, level = 1 } }\nmass = 0.02\n";

fn run(simulation: &mut Simulation, steps: usize, h: f64) {
    for _ in 0..steps {
        simulation.step(h).unwrap();
    }
}

/// The centre of mass, metres.
fn centre(simulation: &Simulation) -> Vector3<f64> {
    let masses = &simulation.model().mass().vertex;
    let points = simulation.state().x.as_chunks::<3>().0.iter();
    let moment = points.zip(masses).map(|(p, m)| *m * Vector3::from(*p));
    moment.sum::<Vector3<f64>>() / simulation.model().mass().total()
}

/// Its centre of mass flies along a parabola, `x0 + v t + g t^2 / 2`, and a flat sheet that spins about its
/// normal stays flat and turns by `rate t`.
#[test]
fn a_thrown_sheet_flies_along_a_parabola_and_turns() {
    let text = format!(
        "{SQUARE}start = {{ velocity = [1.0, 0.5, 2.0], spin = {{ axis = [0, 0, 2], rate = 90 }} }}\n\
         [forces]\ngravity = [0, 0, -9.81]\n"
    );
    let mut thrown = simulation(&text);
    let (start, x) = (centre(&thrown), thrown.state().x.clone());
    let (steps, h) = (200, 1e-3);
    run(&mut thrown, steps, h);
    let t = steps as f64 * h;
    let v = Vector3::new(1.0, 0.5, 2.0);
    // The first of the two-step method's steps is one of implicit Euler, which falls by g h^2 / 2 too far; a
    // third of the difference of two positions is carried into the next one, 1 / (1 - 1/3) of it in all.
    let error = 1.5 * 0.5 * 9.81 * h * h;
    let flown = start + v * t - Vector3::z() * (0.5 * 9.81 * t * t);
    assert!((centre(&thrown) - flown).norm() < 1.01 * error);
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), (90.0 * t).to_radians());
    for (a, b) in x
        .as_chunks::<3>()
        .0
        .iter()
        .zip(thrown.state().x.as_chunks::<3>().0)
    {
        let expected = flown + turn * (Vector3::from(*a) - start);
        // The angle errs by the second power of w h, 2e-6.
        assert!(
            (Vector3::from(*b) - expected).norm() < 1.2 * error,
            "{b:?} {expected:?}"
        );
    }
}

/// A spin about a point that is pinned leaves it where it is, and a pinned vertex of a thrown sheet does not
/// move.
#[test]
fn pins_hold_what_is_thrown() {
    let pinned = "[[support]]\nat = { vertices = [0] }\n";
    let text = format!(
        "{SQUARE}start = {{ spin = {{ axis = [0, 0, 1], rate = 90, centre = [0, 0, 0] }} }}\n{pinned}"
    );
    let mut swung = simulation(&text);
    let far = |s: &Simulation| Vector3::from_column_slice(&s.state().v[3 * 24..3 * 24 + 3]);
    // w x r of the corner (0.2, 0.2, 0).
    let expected = 90_f64.to_radians() * Vector3::new(-0.2, 0.2, 0.0);
    assert!((far(&swung) - expected).norm() < 1e-15);
    run(&mut swung, 10, 1e-3);
    assert_eq!(swung.state().x[..3], [0.0; 3]);
    let thrown = simulation(&format!(
        "{SQUARE}start = {{ velocity = [1, 2, 3] }}\n{pinned}"
    ));
    assert_eq!(thrown.state().v[..6], [0.0, 0.0, 0.0, 1.0, 2.0, 3.0]);
    let still = parse(&format!("{SQUARE}start = {{ seed = 1 }}\n")).unwrap();
    let modelled = still.build().unwrap().modelled.clone();
    assert!(!modelled.iter().any(|m| m.contains("velocities")));
}

/// Supports bear the sheet and its weights.
#[test]
fn supports_bear_the_weights() {
    let text = format!(
        "{SQUARE}damping = 5.0\n[[weight]]\nat = {{ vertices = [2, 22] }}\nmass = 0.03\n\
         [[weight]]\nat = {{ nearest = [[0.1, 0.1, 0]] }}\nmass = 0.05\n\
         [[support]]\nat = {{ vertices = [0, 20] }}\n[forces]\ngravity = [0, 0, -10]\n"
    );
    let mut hanging = simulation(&text);
    let masses = &hanging.model().mass().vertex;
    assert!((masses.iter().sum::<f64>() - 0.1).abs() < 1e-15);
    let bare = simulation(SQUARE).model().mass().vertex.clone();
    assert!((masses[2] - bare[2] - 0.015).abs() < 1e-15 && masses[1] == bare[1]);
    run(&mut hanging, 400, 0.02);
    let held: f64 = hanging.reactions().iter().map(|r| r.force.z).sum();
    assert!((held - 1.0).abs() < 1e-3, "{held} N");
    let modelled = parse(&text).unwrap().build().unwrap().modelled.clone();
    assert!(modelled.iter().any(|m| m == "2 weights"), "{modelled:?}");
}

#[test]
fn wrong_starts_and_weights_are_told() {
    let said = |text: &str| parse(text).map(|_| ()).unwrap_err().to_string();
    let text = said(&format!(
        "{SQUARE}start = {{ spin = {{ axis = [0, 0, 0], rate = 1 }} }}\n"
    ));
    assert!(text.contains("spin"), "{text}");
    let text = said(&format!("{SQUARE}[[weight]]\nat = \"all\"\nmass = 0\n"));
    assert!(text.contains("weight"), "{text}");
    let text = said(&format!(
        "{SQUARE}[[weight]]\nat = \"all\"\nmass = 1\nsheet = \"b\"\n"
    ));
    assert!(text.contains('b'), "{text}");
}
