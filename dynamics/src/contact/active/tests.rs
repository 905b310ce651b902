use super::*;
use crate::contact::StepSpan;

const RADIUS: f64 = 0.25;

fn contacts(list: Vec<ActiveContact>) -> ActiveContacts {
    ActiveContacts {
        list,
        bodies: Vec::new(),
        span: StepSpan { t0: 0.0, h: 1.0 },
        progress: 1.0,
        is_finite: true,
    }
}

fn vertex(normal: Vector3<f64>, gap: f64) -> ActiveContact {
    ActiveContact {
        key: ContactKey {
            body: Some(0),
            kind: ContactKind::Vertex,
            pair: [0, 0],
        },
        vertices: [0; 4],
        weights: [1.0, 0.0, 0.0, 0.0],
        normal,
        gap,
        closest: Vector3::zeros(),
        parallel: None,
        rolling: None,
        round: [None; 2],
    }
}

/// A vertex inside a sphere about the origin: the gap is `R - |p|`.
fn in_a_bowl(p: Vector3<f64>) -> ActiveContacts {
    contacts(vec![vertex(-p.normalize(), RADIUS - p.norm())])
}

/// A vertex outside: the gap is `|p| - R`.
fn on_a_ball(p: Vector3<f64>) -> ActiveContacts {
    contacts(vec![vertex(p.normalize(), p.norm() - RADIUS)])
}

#[test]
fn gaps_that_close_faster_than_to_first_order_are_answered() {
    let barrier = BarrierPotential::new(1e-3, 2e-4).unwrap();
    let p = Vector3::new(0.0, 0.0, -(RADIUS - 4e-4));
    let dx = Vector3::new(0.02, -0.01, 1e-4);
    let mut force = [0.0; 3];
    let ahead = in_a_bowl(p + dx);
    let there_are =
        in_a_bowl(p).add_gap_correction(&ahead, &barrier, dx.as_slice(), 2.0, &mut force);
    assert!(there_are);
    // To second order the gap closes by |t|^2 / (2 |p|) with the displacement t along the sphere.
    let second = dx.xy().norm_squared() / (2.0 * p.norm());
    let [_, _, stiffness] = barrier.derivatives(4e-4);
    let expected = 2.0 * stiffness * second;
    assert_eq!(force[..2], [0.0; 2]);
    assert!(
        (force[2] / expected - 1.0).abs() < 1e-2,
        "{force:?}, {expected}"
    );
    // Exactly: the change of |p| beyond its first order.
    let exact = (p + dx).norm() - p.norm() + dx.z;
    assert!((force[2] / (2.0 * stiffness * exact) - 1.0).abs() < 1e-9);
}

#[test]
fn gaps_that_open_faster_are_not() {
    let barrier = BarrierPotential::new(1e-3, 2e-4).unwrap();
    let p = Vector3::new(0.0, 0.0, RADIUS + 4e-4);
    let dx = Vector3::new(0.004, -0.002, -1e-4);
    let mut force = [0.0; 3];
    let ahead = on_a_ball(p + dx);
    assert!(!on_a_ball(p).add_gap_correction(&ahead, &barrier, dx.as_slice(), 1.0, &mut force));
    assert_eq!(force, [0.0; 3]);
}

#[test]
fn distances_beyond_a_passage_count_as_negative() {
    // A vertex at the height 4e-4 that moves straight through a surface at zero: the distance ahead has no
    // sign, but the normal has turned, and the gap is linear.
    let barrier = BarrierPotential::new(1e-3, 2e-4).unwrap();
    let here = contacts(vec![vertex(Vector3::z(), 4e-4)]);
    let ahead = contacts(vec![vertex(-Vector3::z(), 6e-4)]);
    let mut force = [0.0; 3];
    here.add_gap_correction(&ahead, &barrier, &[0.0, 0.0, -1e-3], 1.0, &mut force);
    assert!(force[2].abs() < 1e-9 * barrier.force(4e-4), "{force:?}");
}
