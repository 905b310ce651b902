//! The forces of all supports add up to the change of momentum, step by step.

use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::constraint::{Line, Plane, Side, Sphere};
use isosheet_dynamics::{Method, SheetModel, Simulation, State, VertexConstraint};
use isosheet_mesh::{MassKind, VertexId, generate};
use isosheet_tests::damped_to;
use nalgebra::{Isometry3, Vector3};

const SIDE: f64 = 0.2;
const MASS: f64 = 3.5e-3;
const G: f64 = 9.8;
/// Where the floor lies, metres.
const FLOOR: f64 = -0.04;

/// The supports of a sheet that starts flat and at rest.
#[derive(Debug, Clone, Copy, Default)]
struct Supports {
    /// A corner pinned.
    pin: bool,
    /// A corner on a slanting line.
    curve: bool,
    /// A corner on a sphere.
    surface: bool,
    /// The middle over a slanting plane, one-sided.
    ledge: bool,
    /// A floor with a coefficient of friction.
    floor: Option<f64>,
}

impl Supports {
    fn simulation(self, method: Method, mass: MassKind) -> Simulation {
        let sheet = generate::isotropic_square(1, SIDE).expect("valid");
        let n = 5_u32;
        let mut model = SheetModel::new(&sheet, MASS, mass)
            .expect("valid")
            .with_gravity();
        if self.pin {
            model = model.with_pins(&[VertexId(0)]).expect("exists");
        }
        let mut constraints = Vec::new();
        if self.curve {
            let v = VertexId(n - 1);
            let line = Line::new(sheet.position(v), [-1.0, 0.2, -0.5]).expect("valid");
            constraints.push(VertexConstraint::on_curve(v, line));
        }
        if self.surface {
            let v = VertexId(n * (n - 1));
            let [x, y, z] = sheet.position(v);
            let arm = Vector3::new(0.06, 0.05, -0.02);
            let centre = [x - arm.x, y - arm.y, z - arm.z];
            let sphere = Sphere::new(centre, arm.norm()).expect("valid");
            constraints.push(VertexConstraint::on_surface(v, sphere, Side::On));
        }
        if self.ledge {
            let v = VertexId(n * n / 2);
            let ledge = Plane::new([0.0, 0.0, -0.01], [0.2, 0.1, 1.0]).expect("valid");
            constraints.push(VertexConstraint::on_surface(v, ledge, Side::Outside));
        }
        for c in constraints {
            model = model.with_constraint(c).expect("exists");
        }
        let contacts = self.floor.map(|mu| {
            let floor = Obstacle::fixed(Shape::HalfSpace, Isometry3::translation(0.0, 0.0, FLOOR))
                .expect("valid");
            Contacts::new(&model, ContactOptions::for_sheet(&model))
                .and_then(|c| c.with_body(floor, Coefficients::equal(mu)))
                .expect("valid")
        });
        let start = State::at_rest(sheet.positions().to_vec());
        let simulation = Simulation::new(model, start, method).expect("valid");
        match contacts {
            None => simulation,
            Some(c) => simulation.with_contact(c).expect("nothing touches"),
        }
    }
}

fn momentum(simulation: &Simulation) -> Vector3<f64> {
    let (model, v) = (simulation.model(), &simulation.state().v);
    let mut momenta = vec![0.0; v.len()];
    model.mass().apply(model.topology(), v, &mut momenta);
    let momenta = momenta.as_chunks::<3>().0.iter();
    momenta.map(|p| Vector3::from(*p)).sum()
}

/// Discrete rate of change of momentum in the last step, by the method's own formula, from
/// the momenta at the end of the step, at its start and one step before.
fn rate(
    method: &Method,
    [new, old]: [Vector3<f64>; 2],
    older: Option<Vector3<f64>>,
) -> Vector3<f64> {
    match (method, older) {
        (Method::Bdf2(_), Some(older)) => (1.5 * new - 2.0 * old + 0.5 * older) / STEP,
        _ => (new - old) / STEP,
    }
}

/// Largest failure of `rate = sum of reactions - sum of loads on bodies + weight` in 60 steps from exactly
/// flat, relative to the sum of the magnitudes of all forces.
#[derive(Debug, Default)]
struct Imbalance {
    of_forces: f64,
    steps: usize,
}

/// Length of a step, seconds.
const STEP: f64 = 1.0 / 120.0;

/// What the tolerance of the lengths leaves of a balance, relative to the weight: rods of the length `l` hold
/// their ends to within `l sqrt(2 s)` across them, with `s = 1e-12` the relative tolerance, and a motion by
/// that within a step asks for the acceleration `l sqrt(2 s) / h^2`.
fn left_by_lengths() -> f64 {
    let longest = SIDE / 4.0 * 2.0_f64.sqrt();
    longest * 2e-12_f64.sqrt() / (STEP * STEP * G)
}

fn imbalance(supports: Supports, method: &Method, mass: MassKind) -> Imbalance {
    let weight = Vector3::new(0.0, 0.0, -MASS * G);
    let mut simulation = supports.simulation(method.clone(), mass);
    let mut old = momentum(&simulation);
    let mut older = None;
    let mut was_divided = false;
    let mut worst = Imbalance::default();
    for _ in 0..60 {
        let report = simulation.step(STEP).expect("accepted");
        let new = momentum(&simulation);
        // The reactions belong to the last sub-step, and a damped step that is repeated has dropped its
        // history.
        if report.rejected > 0 {
            older = None;
        }
        // The formula of BDF2 above is that of equal steps.
        let is_regular = report.substeps == 1 && !was_divided;
        was_divided = report.substeps > 1;
        if is_regular {
            let reactions = simulation.reactions().into_iter().map(|r| r.force);
            let loads = simulation.body_loads().into_iter().map(|l| -l.force);
            let forces: Vec<_> = reactions.chain(loads).chain([weight]).collect();
            let sum: Vector3<f64> = forces.iter().sum();
            let size: f64 = forces.iter().map(|f| f.norm()).sum();
            let left = (rate(method, [new, old], older) - sum).norm();
            worst.of_forces = worst.of_forces.max(left / size);
            worst.steps += 1;
        }
        (older, old) = (Some(old), new);
    }
    worst
}

const MASSES: [MassKind; 2] = [MassKind::Lumped, MassKind::Consistent];

fn two_sided() -> [Supports; 4] {
    let none = Supports::default();
    let [pin, curve, surface] = [
        Supports { pin: true, ..none },
        Supports {
            curve: true,
            ..none
        },
        Supports {
            surface: true,
            ..none
        },
    ];
    let together = Supports {
        pin: true,
        curve: true,
        surface: true,
        ..none
    };
    [pin, curve, surface, together]
}

fn one_sided() -> [Supports; 2] {
    let ledge = Supports {
        ledge: true,
        ..Supports::default()
    };
    [
        ledge,
        Supports {
            pin: true,
            curve: true,
            surface: true,
            ..ledge
        },
    ]
}

#[test]
fn supports_of_the_implicit_methods_balance_the_change_of_momentum() {
    // The tolerance is one of an energy, which is quadratic in the forces that are left.
    for tolerance in [1e-12, 1e-4_f64] {
        let exact = tolerance.sqrt() + left_by_lengths();
        for method in damped_to(tolerance) {
            for supports in two_sided().into_iter().chain(one_sided()) {
                // A sheet that falls on its ledge buckles: with the semidefinite part of the Hessian the
                // iteration converges linearly, and what a last iteration leaves adds up with what later ones
                // would leave.
                let bound = if supports.ledge {
                    exact / (1.0 - 0.9)
                } else {
                    exact
                };
                for mass in MASSES {
                    let found = imbalance(supports, &method, mass);
                    assert!(found.of_forces < bound, "{supports:?} {method:?} {found:?}");
                    assert!(found.steps > 50);
                }
            }
        }
    }
}

#[test]
fn supports_of_the_conservative_methods_balance_the_change_of_momentum() {
    // Steps of rods that are dependent are divided: some are not compared.
    let energy_momentum = Method::EnergyMomentum(Default::default());
    let rattle = Method::Rattle(Default::default());
    let [pin, curve, surface, _] = two_sided();
    for (method, supports, mass) in [
        (&energy_momentum, pin, MassKind::Consistent),
        (&energy_momentum, curve, MassKind::Consistent),
        (&rattle, pin, MassKind::Lumped),
        (&rattle, pin, MassKind::Consistent),
        (&rattle, curve, MassKind::Lumped),
        (&rattle, surface, MassKind::Lumped),
    ] {
        let found = imbalance(supports, method, mass);
        // Their tolerance of 1e-12 is relative to the largest acceleration of a vertex.
        assert!(found.of_forces < 1e-11, "{found:?}");
        assert!(found.steps > 10);
    }
}

#[test]
fn contact_balances_the_change_of_momentum_but_for_its_curvature() {
    // The projection that ends a step changes the contact forces. The change of first order is balanced by
    // the projection itself; the rest is of second order and is not balanced.
    let none = Supports::default();
    let all = Supports {
        pin: true,
        curve: true,
        surface: true,
        ledge: true,
        floor: Some(0.4),
    };
    for (supports, bound) in [
        (
            Supports {
                floor: Some(0.0),
                ..none
            },
            0.01,
        ),
        (
            Supports {
                floor: Some(0.4),
                ..none
            },
            0.01,
        ),
        (all, 0.05),
    ] {
        for method in damped_to(1e-12) {
            for mass in MASSES {
                let found = imbalance(supports, &method, mass);
                assert!(found.of_forces < bound, "{found:?}");
                assert!(found.steps > 50);
            }
        }
    }
}
