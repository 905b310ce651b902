//! Forces and torques of all supports of elastic sheets, with weight, loads and inertia, add up to zero step by step.

use isosheet_dynamics::constraint::{Line, Plane, Side, Sphere};
use isosheet_dynamics::{
    ElasticSheet, ImplicitOptions, Method, PlateBending, PlateStiffness, PointProfile, Profile, RigidDisplacement,
    SheetModel, Simulation, State, VertexConstraint, VertexLoad,
};
use isosheet_mesh::generate::{Diagonals, grid};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use nalgebra::Vector3;

const COLUMNS: usize = 12;
const LENGTH: f64 = 0.12;
const WIDTH: f64 = 0.02;
/// Mass, kilograms, and gravity, metres per second squared.
const MASS: f64 = 3e-4;
const G: f64 = 9.8;
/// Length of a step, seconds, and number of steps.
const STEP: f64 = 1.0 / 240.0;
const STEPS: usize = 60;

/// What holds one end; the other end is clamped by the pins of two lines of vertices, unless the strip is free.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Held {
    Clamped,
    MovingPins,
    OnPlane,
    OnMovingPlane,
    OnTiltedMovingPlane,
    OnSphere,
    OnLine,
    OverPlane,
    OverRisingPlane,
}

const ALL: [Held; 9] = [
    Held::Clamped,
    Held::MovingPins,
    Held::OnPlane,
    Held::OnMovingPlane,
    Held::OnTiltedMovingPlane,
    Held::OnSphere,
    Held::OnLine,
    Held::OverPlane,
    Held::OverRisingPlane,
];

fn strip() -> Sheet {
    grid(COLUMNS, 2, LENGTH, WIDTH, Diagonals::UnionJack).expect("a strip")
}

fn column(k: usize) -> impl Iterator<Item = VertexId> {
    (0..3).map(move |row| VertexId::from_index(k + row * (COLUMNS + 1)))
}

/// From 0 to `to` within the run.
fn rise(to: f64) -> Profile {
    Profile::SmoothStep {
        from: 0.0,
        to,
        begin: 0.0,
        end: STEP * STEPS as f64,
    }
}

/// How stiff the strip is in its plane, newtons per metre.
fn model(held: Held, stiffness: f64) -> SheetModel {
    let sheet = strip();
    let clamp: Vec<VertexId> = column(0).chain(column(1)).collect();
    let tip = || column(COLUMNS);
    let law = PlateStiffness {
        rigidity: 2e-4,
        poisson: 0.3,
    };
    let plate = PlateBending::clamped(&sheet, law, &clamp).expect("a plate");
    let elastic = ElasticSheet::new(&sheet, stiffness, 0.3).expect("a sheet").beside(&sheet, &plate);
    let load = VertexLoad::new(sheet.topology(), &[VertexId(COLUMNS as u32 / 2)], [0.3, 0.2, 1.0], rise(1e-3));
    let mut model = SheetModel::new(&sheet, MASS, MassKind::Lumped)
        .expect("a model")
        .with_acceleration([0.0, 0.0, -G])
        .with_force(load.expect("a load"))
        .with_pins(&clamp)
        .expect("pins")
        .with_potential(plate)
        .with_elastic_sheet(elastic)
        .expect("a sheet");
    if held == Held::MovingPins {
        for v in tip() {
            let motion = PointProfile {
                offset: sheet.position(v),
                x: rise(-0.01),
                z: rise(0.02),
                ..PointProfile::default()
            };
            model = model.with_moving_pin(v, motion).expect("a pin");
        }
        return model;
    }
    for v in tip() {
        let [x, y, z] = sheet.position(v);
        let plane = |normal: [f64; 3]| Plane::new([x, y, z], normal).expect("a plane");
        let up = [0.0, 0.0, 1.0];
        let moving = |constraint: VertexConstraint, to: f64| {
            constraint.moving(RigidDisplacement {
                z: rise(to),
                ..RigidDisplacement::default()
            })
        };
        let constraint = match held {
            Held::Clamped | Held::MovingPins => continue,
            Held::OnPlane => VertexConstraint::on_surface(v, plane(up), Side::On),
            Held::OnMovingPlane => moving(VertexConstraint::on_surface(v, plane(up), Side::On), 0.03),
            Held::OnTiltedMovingPlane => {
                moving(VertexConstraint::on_surface(v, plane([0.5, 0.1, 1.0]), Side::On), 0.03)
            }
            Held::OnSphere => {
                let centre = [x - 0.03, y, z - 0.04];
                let sphere = Sphere::new(centre, 0.05).expect("a sphere");
                VertexConstraint::on_surface(v, sphere, Side::On)
            }
            Held::OnLine => {
                let line = Line::new([x, y, z], [1.0, 0.0, 0.3]).expect("a line");
                VertexConstraint::on_curve(v, line)
            }
            Held::OverPlane => VertexConstraint::on_surface(v, plane(up), Side::Outside),
            Held::OverRisingPlane => moving(VertexConstraint::on_surface(v, plane(up), Side::Outside), 0.03),
        };
        model = model.with_constraint(constraint).expect("a vertex");
    }
    model
}

/// Inertia `M a` of each vertex by the formula of the method, from velocities at the end of a step, at its start and a
/// step before.
fn inertia(method: &Method, masses: &[f64], [new, old, older]: [&[f64]; 3]) -> Vec<Vector3<f64>> {
    let at = |v: &[f64], i: usize| Vector3::from_column_slice(&v[3 * i..3 * i + 3]);
    let of = |i: usize| match method {
        Method::Bdf2(_) => 1.5 * at(new, i) - 2.0 * at(old, i) + 0.5 * at(older, i),
        _ => at(new, i) - at(old, i),
    };
    masses.iter().enumerate().map(|(i, m)| of(i) * (*m / STEP)).collect()
}

/// Largest sums of forces and of torques in a run over the largest sums of their magnitudes; with what the simulation
/// says of them itself.
fn left(held: Held, method: &Method, stiffness: f64) -> [f64; 4] {
    let model = model(held, stiffness);
    let start = State::at_rest(strip().positions().to_vec());
    let mut run = Simulation::new(model, start, method.clone()).expect("a simulation");
    let mut before = [run.state().v.clone(), run.state().v.clone()];
    let (mut largest, mut sizes) = ([0.0_f64; 4], [0.0_f64; 4]);
    for step in 0..STEPS {
        let report = run.step(STEP).expect("a step");
        assert_eq!((report.rejected, report.substeps), (0, 1), "{held:?}");
        let State { t, x, v } = run.state();
        let masses = run.model().mass().vertex.clone();
        let rate = inertia(method, &masses, [v, &before[0], &before[1]]);
        before = [v.clone(), std::mem::take(&mut before[0])];
        // The first step of BDF2 has a formula of its own, and the second one a history of it.
        if step < 1 {
            continue;
        }
        let place = |i: usize| Vector3::from_column_slice(&x[3 * i..3 * i + 3]);
        let mut loads = vec![0.0; x.len()];
        run.model().applied_force(*t, x, v, &mut loads);
        let mut sum = [Vector3::zeros(); 2];
        let mut size = [0.0; 2];
        let mut add = |i: usize, force: Vector3<f64>| {
            let torque = place(i).cross(&force);
            sum[0] += force;
            sum[1] += torque;
            size[0] += force.norm();
            size[1] += torque.norm();
        };
        for reaction in run.reactions() {
            add(reaction.support.vertex().index(), reaction.force);
        }
        for (i, (m, a)) in masses.iter().zip(&rate).enumerate() {
            add(i, Vector3::new(0.0, 0.0, -m * G) - a);
            add(i, Vector3::from_column_slice(&loads[3 * i..3 * i + 3]));
        }
        let own = run.imbalance().expect("supports");
        for (k, (value, of)) in [
            (sum[0].norm(), size[0]),
            (sum[1].norm(), size[1]),
            (own.force.norm(), own.forces),
            (own.torque.norm(), own.torques),
        ]
        .into_iter()
        .enumerate()
        {
            largest[k] = largest[k].max(value);
            sizes[k] = sizes[k].max(of);
        }
    }
    std::array::from_fn(|k| largest[k] / sizes[k])
}

fn damped(tolerance: f64) -> [Method; 2] {
    let options = ImplicitOptions {
        tolerance: Some(tolerance),
        ..ImplicitOptions::default()
    };
    [Method::Bdf2(options.clone()), Method::ImplicitEuler(options)]
}

/// The tolerance is one of an energy, which is quadratic in the forces that are left; what a strip of this stiffness
/// leaves of the torque of the plate is of the order of its strain.
#[test]
fn all_supports_balance() {
    for tolerance in [1e-12, 1e-3_f64] {
        for method in damped(tolerance) {
            for held in ALL {
                for stiffness in [1e3, 1e5] {
                    let found = left(held, &method, stiffness);
                    let bound = tolerance.sqrt();
                    assert!(found.iter().all(|f| *f < bound), "{held:?} {stiffness:e} {method:?}: {found:?} {bound:e}");
                }
            }
        }
    }
}
