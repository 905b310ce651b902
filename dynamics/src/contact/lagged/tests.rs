use super::*;
use crate::contact::{BodyMotion, ContactKind, StepMotion};
use nalgebra::Isometry3;
use proptest::prelude::*;

/// Keeps the blocks of a Hessian of four vertices.
struct Dense(nalgebra::SMatrix<f64, 12, 12>);

impl CouplingSink for Dense {
    fn add(&mut self, a: u32, b: u32, block: &Matrix3<f64>) {
        let (i, j) = (3 * a as usize, 3 * b as usize);
        for r in 0..3 {
            for c in 0..3 {
                self.0[(i + r, j + c)] += block[(r, c)];
                if a != b {
                    self.0[(j + c, i + r)] += block[(r, c)];
                }
            }
        }
    }
}

fn contact(weights: [f64; 4], normal: [f64; 3], force: f64, law: Coulomb) -> FrictionContact {
    FrictionContact {
        key: ContactKey {
            body: None,
            kind: ContactKind::VertexFace,
            pair: [0, 0],
        },
        ends: [0, 3],
        stencil: Stencil::new((0..4).zip(weights)),
        normal: Vector3::from(normal).normalize(),
        force,
        point: Vector3::zeros(),
        point_start: Vector3::zeros(),
        law: LawOfContact::Coulomb(law),
    }
}

fn friction(contacts: Vec<FrictionContact>) -> LaggedFriction {
    LaggedFriction {
        x0: vec![0.0; 12],
        contacts,
        ..LaggedFriction::none()
    }
}

fn positions() -> impl Strategy<Value = [f64; 12]> {
    proptest::array::uniform12(-1.0..1.0_f64)
}

proptest! {
    #![proptest_config(isosheet_random::cases(256))]

    #[test]
    fn energy_gradient_and_hessian_match_differences(
        x in positions(), normal in proptest::array::uniform3(0.2..1.0_f64), size in -6.0..3.0_f64,
        part in 0.01..3.0_f64, rest in 0.1..1.0_f64, sliding in 0.0..=1.0_f64, a in 0.1..0.4_f64, b in 0.1..0.4_f64,
    ) {
        let e = 10.0_f64.powf(size);
        let law = Coulomb::new(rest, rest * sliding, e).unwrap();
        let contact = contact([1.0, -a, -b, a + b - 1.0], normal, 7.0, law);
        let friction = friction(vec![contact]);
        let x = x.map(|x| part * e * x);
        let y = contact.slip(&friction.x0, &x, &[], 1.0).norm() / e;
        // The curvature has kinks at the seams and turns quickly next to rest.
        prop_assume!((y - 1.0).abs() > 1e-3 && (y - 3.0).abs() > 1e-3 && y > 0.05);
        let gradient = |x: &[f64]| {
            let mut out = [0.0; 12];
            friction.add_gradient(x, &[], 1.0, &mut out);
            out
        };
        let g = gradient(&x);
        let mut hessian = Dense(nalgebra::SMatrix::zeros());
        friction.add_hessian(&x, &[], &mut hessian);
        let (steepest, largest) = (7.0 * rest, 7.0 * 2.0 * rest / e);
        let h = 1e-5 * e;
        for i in 0..12 {
            let moved = |d: f64| {
                let mut y = x;
                y[i] += d;
                y
            };
            let (up, down) = (moved(h), moved(-h));
            let slope = (friction.energy(&up, &[]) - friction.energy(&down, &[])) / (2.0 * h);
            prop_assert!((slope - g[i]).abs() < 1e-6 * steepest);
            // A law that falls has its negative slope left out.
            if !(1.0..=3.0).contains(&y) {
                let (up, down) = (gradient(&up), gradient(&down));
                for j in 0..12 {
                    let curvature = (up[j] - down[j]) / (2.0 * h);
                    prop_assert!((curvature - hessian.0[(i, j)]).abs() < 1e-4 * largest);
                }
            }
        }
        let lowest = hessian.0.symmetric_eigenvalues().min();
        prop_assert!(lowest > -1e-12 * largest);
    }

    #[test]
    fn force_is_tangential_opposes_the_slip_and_sums_to_nothing(
        x in positions(), normal in proptest::array::uniform3(0.2..1.0_f64),
    ) {
        let contact = contact([1.0, -0.2, -0.5, -0.3], normal, 3.0, Coulomb::new(0.5, 0.4, 1e-3).unwrap());
        let friction = friction(vec![contact]);
        let mut g = [0.0; 12];
        friction.add_gradient(&x, &[], 1.0, &mut g);
        let forces: Vec<Vector3<f64>> = g.as_chunks::<3>().0.iter().map(|g| Vector3::from(*g)).collect();
        prop_assert!(forces.iter().sum::<Vector3<f64>>().norm() < 1e-12);
        for f in &forces {
            prop_assert!(f.dot(&contact.normal).abs() < 1e-12);
        }
        let power: f64 = g.iter().zip(&x).map(|(g, x)| g * x).sum();
        prop_assert!(power >= 0.0);
        // Sliding far beyond the passage: kinetic coefficient times normal force.
        let y = contact.slip(&friction.x0, &x, &[], 1.0).norm();
        if y > 3e-3 {
            prop_assert!((forces[0].norm() - 0.4 * 3.0).abs() < 1e-12);
            prop_assert!((friction.loss(&x, &[]) - 0.4 * 3.0 * y).abs() < 1e-12);
        }
    }
}

/// A sheet at rest on a belt that moves by `d` slides by `-d`: the belt works, all of it is lost.
#[test]
fn a_belt_under_a_sheet_at_rest_loses_its_work() {
    let law = Coulomb::new(0.5, 0.5, 1e-4).unwrap();
    let motion = StepMotion::new(Isometry3::identity(), Isometry3::translation(0.1, 0.0, 0.0));
    let motion = BodyMotion {
        material: motion,
        surface: motion,
    };
    let mut on_belt = contact([1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 2.0, law);
    on_belt.key.body = Some(0);
    let friction = friction(vec![on_belt]);
    let x = [0.0; 12];
    let bodies = [BodyPlace::at(&motion, 1.0)];
    let work = friction.body_work(&x, &bodies);
    assert!((work - 0.5 * 2.0 * 0.1).abs() < 1e-15, "{work}");
    assert!((friction.loss(&x, &bodies) - work).abs() < 1e-15);
    // Half-way the sheet has slid half as far.
    let half = [BodyPlace::at(&motion, 0.5)];
    assert!((friction.loss(&x, &half) - 0.5 * work).abs() < 1e-15);
    let mut force = [0.0; 12];
    friction.add_gradient(&x, &bodies, -1.0, &mut force);
    assert!((force[0] - 1.0).abs() < 1e-15, "taken along: {force:?}");
}

/// A law in metres per second at velocities at the end of a step is Coulomb's law in metres a step.
#[test]
fn other_laws_have_speeds_in_metres_per_second() {
    let (tau, rest_speed) = (1e-2, 1e-2);
    let coulomb = Coulomb::new(0.5, 0.3, rest_speed * tau).unwrap();
    let by_distance = friction(vec![contact(
        [1.0, -0.2, -0.5, -0.3],
        [0.3, 0.2, 1.0],
        3.0,
        coulomb,
    )]);
    let mut by_speed = by_distance.clone();
    by_speed.contacts[0].law = LawOfContact::Other {
        number: 0,
        tau,
        part: 1.0,
    };
    by_speed.others = vec![Arc::new(Coulomb::new(0.5, 0.3, rest_speed).unwrap())];
    // From other positions than those at the start.
    let start: [f64; 12] = std::array::from_fn(|i| 1e-3 * (i as f64).sin());
    by_speed.rest = start.to_vec();
    for part in [0.5, 1.7, 5.0] {
        let dx: [f64; 12] = std::array::from_fn(|i| part * 1e-4 * (2.0 * i as f64).cos());
        let x: [f64; 12] = std::array::from_fn(|i| start[i] + dx[i]);
        let found = [(&by_distance, &dx), (&by_speed, &x)].map(|(friction, x)| {
            let (mut gradient, mut hessian) = ([0.0; 12], Dense(nalgebra::SMatrix::zeros()));
            friction.add_gradient(x, &[], 1.0, &mut gradient);
            friction.add_hessian(x, &[], &mut hessian);
            (friction.energy(x, &[]), gradient, hessian.0)
        });
        let [(e0, g0, h0), (e1, g1, h1)] = found;
        assert!((e0 - e1).abs() < 1e-12 * e0.abs(), "{e0} {e1}");
        assert!(g0.iter().zip(&g1).all(|(a, b)| (a - b).abs() < 1e-10));
        assert!((h0 - h1).norm() < 1e-10 * h0.norm());
        let speed = by_speed.sliding(&by_speed.contacts[0], &x, &[]).speed();
        let distance = by_distance
            .sliding(&by_distance.contacts[0], &dx, &[])
            .speed();
        assert!((speed * tau - distance).abs() < 1e-12 * distance);
    }
}

#[test]
fn changes_are_relative_to_the_largest_force() {
    let law = Coulomb::new(0.5, 0.5, 1e-4).unwrap();
    let at = |number: u32, force: f64| {
        let mut c = contact([1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0], force, law);
        c.key.pair[0] = number;
        c
    };
    let before = friction(vec![at(0, 1.0), at(2, 4.0)]);
    assert_eq!(before.change_since(&before), 0.0);
    let none = LaggedFriction::none();
    assert_eq!(none.change_since(&none), 0.0);
    assert_eq!(before.change_since(&none), 1.0);
    // One has come, one has gone, one has changed.
    let after = friction(vec![at(1, 2.0), at(2, 5.0)]);
    assert_eq!(after.change_since(&before), 2.0 / 5.0);
}
