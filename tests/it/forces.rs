//! Potentials and non-conservative forces of the user, and the mass matrices.

use crate::scenes::{bumped, gap, methods, pinned};
use isosheet_dynamics::{
    At, Force, HessianSink, Method, Potential, SheetModel, Simulation, SimulationError, State,
    StepError,
};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use isosheet_tests::Pendulum;
use nalgebra::{Matrix3, Vector3};

/// A potential `k/4 (|x - c|^2 - r^2)^2` on every vertex: nonlinear, not convex.
#[derive(Debug, Clone, Copy)]
struct Shell {
    stiffness: f64,
    with_hessian: Hessian,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Hessian {
    Given,
    Missing,
}

const CENTRE: [f64; 3] = [0.5, 0.5, -0.6];
const RADIUS: f64 = 0.9;

impl Shell {
    fn offsets(x: &[f64]) -> impl Iterator<Item = Vector3<f64>> + '_ {
        x.chunks(3)
            .map(|p| Vector3::from_column_slice(p) - Vector3::from(CENTRE))
    }
}

impl Potential for Shell {
    fn energy(&self, at: At<'_>) -> f64 {
        let At { x, .. } = at;
        Self::offsets(x)
            .map(|d| 0.25 * self.stiffness * (d.norm_squared() - RADIUS * RADIUS).powi(2))
            .sum()
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let At { x, .. } = at;
        for (d, g) in Self::offsets(x).zip(gradient.chunks_mut(3)) {
            let factor = self.stiffness * (d.norm_squared() - RADIUS * RADIUS);
            for k in 0..3 {
                g[k] += factor * d[k];
            }
        }
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let At { x, .. } = at;
        if self.with_hessian == Hessian::Missing {
            return;
        }
        for (i, d) in Self::offsets(x).enumerate() {
            let factor = d.norm_squared() - RADIUS * RADIUS;
            let block = self.stiffness * (Matrix3::identity() * factor + 2.0 * d * d.transpose());
            hessian.add_vertex(VertexId(i as u32), &block);
        }
    }
}

fn shelled(with_hessian: Hessian) -> Simulation {
    let model = pinned(1, 0.05).with_potential(Shell {
        stiffness: 0.5,
        with_hessian,
    });
    let start = State::at_rest(bumped(1, 0.05).positions().to_vec());
    Simulation::new(model, start, Method::EnergyMomentum(Default::default())).expect("valid")
}

#[test]
fn a_nonlinear_potential_keeps_energy_with_and_without_hessian() {
    let mut ends = Vec::new();
    let mut iterations = Vec::new();
    for hessian in [Hessian::Given, Hessian::Missing] {
        let mut run = shelled(hessian);
        let mut total = 0;
        for _ in 0..100 {
            let report = run.step(2.5e-3).expect("accepted");
            assert_eq!(report.rejected, 0);
            assert!(
                report.energy_drift.abs() < 1e-10,
                "{:e} J",
                report.energy_drift
            );
            total += report.iterations;
        }
        iterations.push(total);
        ends.push(run.state().x.clone());
    }
    assert!(
        gap(&ends[0], &ends[1]) < 1e-8,
        "the Hessian changes speed, not motion"
    );
    assert!(iterations[0] <= iterations[1], "{iterations:?}");
}

/// Gravity as a non-conservative force, and drag.
#[derive(Debug)]
struct Wind {
    weight: f64,
    drag: f64,
}

impl Force for Wind {
    fn add_force(&self, _t: f64, _x: &[f64], v: &[f64], force: &mut [f64]) {
        for (i, f) in force.iter_mut().enumerate() {
            *f -= self.drag * v[i] + if i % 3 == 2 { self.weight } else { 0.0 };
        }
    }
}

#[test]
fn work_of_applied_forces_closes_the_energy_balance() {
    let sheet = bumped(1, 0.05);
    for (name, method) in methods() {
        let drag = if name.starts_with("RATTLE") {
            0.0
        } else {
            2e-3
        };
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)
            .expect("valid")
            .with_force(Wind { weight: 0.02, drag })
            .with_pins(&[VertexId(20)])
            .expect("exists");
        let start = State::at_rest(sheet.positions().to_vec());
        let mut run = Simulation::new(model, start, method).expect("valid");
        let mut last = None;
        for _ in 0..80 {
            last = Some(run.step(2.5e-3).expect("accepted"));
        }
        let report = last.expect("steps were taken");
        assert!(report.work > 5e-3, "{name}: work {} J", report.work);
        let bound = match name {
            "energy-momentum" => 1e-12,
            "RATTLE" | "RATTLE composition" => 0.02 * report.work,
            _ => 0.2 * report.work,
        };
        assert!(
            report.energy_drift.abs() < bound,
            "{name}: {:e} J of {} J",
            report.energy_drift,
            report.work
        );
    }
}

#[test]
fn the_same_force_as_potential_or_as_force_gives_the_same_motion() {
    let sheet = bumped(1, 0.05);
    let weight = 0.1 * 9.8 / 25.0;
    let mass = isosheet_mesh::MassMatrix::from_vertex_masses(vec![0.1 / 25.0; 25]).expect("valid");
    let base = || SheetModel::with_mass(&sheet, mass.clone()).expect("valid");
    for (name, method) in methods() {
        let run = |model: SheetModel| {
            let model = model.with_pins(&[VertexId(20)]).expect("exists");
            let start = State::at_rest(sheet.positions().to_vec());
            let mut run = Simulation::new(model, start, method.clone()).expect("valid");
            for _ in 0..20 {
                run.step(5e-3).expect("accepted");
            }
            run.state().x.clone()
        };
        let potential = run(base().with_gravity());
        let force = run(base().with_force(Wind { weight, drag: 0.0 }));
        let error = gap(&potential, &force);
        assert!(error < 1e-8, "{name}: {error:e} m");
    }
}

#[test]
fn consistent_mass_swings_like_a_uniform_plate() {
    // A uniform triangle about its base: inertia m h^2 / 6, weight at h / 3, so it swings like a
    // mathematical pendulum of length h / 2; lumped at the corners, like one of length h.
    let plate = Pendulum {
        length: 0.35,
        amplitude: 1.2,
        gravity: 9.8,
    };
    let (s, c) = plate.amplitude.sin_cos();
    let h = 2.0 * plate.length;
    let sheet = Sheet::new(
        vec![0.0, -0.3, 0.0, 0.0, 0.5, 0.0, h * s, 0.1, -h * c],
        &[[0, 1, 2]],
    )
    .expect("a triangle");
    let end = 0.3 * plate.period();
    let exact = plate.exact(end);
    for (name, method, bound) in [
        (
            "RATTLE composition",
            Method::RattleComposition(Default::default()),
            1e-8,
        ),
        (
            "energy-momentum",
            Method::EnergyMomentum(Default::default()),
            1e-4,
        ),
        (
            "implicit Euler",
            Method::ImplicitEuler(Default::default()),
            2e-2,
        ),
        ("BDF2", Method::Bdf2(Default::default()), 1e-3),
    ] {
        let model = SheetModel::new(&sheet, 0.3, MassKind::Consistent)
            .expect("valid")
            .with_gravity()
            .with_pins(&[VertexId(0), VertexId(1)])
            .expect("exist");
        let start = State::at_rest(sheet.positions().to_vec());
        let mut run = Simulation::new(model, start, method).expect("valid");
        for _ in 0..100 {
            run.step(end / 100.0).expect("accepted");
        }
        let (x, want) = (run.state().x[6], 2.0 * exact[6]);
        assert!((x - want).abs() < bound, "{name}: {x} instead of {want}");
    }
}

/// A potential gone wrong.
#[derive(Debug)]
struct Broken;

impl Potential for Broken {
    fn energy(&self, _at: At<'_>) -> f64 {
        f64::NAN
    }

    fn add_gradient(&self, _at: At<'_>, gradient: &mut [f64]) {
        gradient[4] = f64::NAN;
    }
}

#[test]
fn a_broken_potential_is_named() {
    let start = State::at_rest(bumped(1, 0.05).positions().to_vec());
    for (name, method) in methods() {
        let model = pinned(1, 0.05).with_potential(Broken);
        match Simulation::new(model, start.clone(), method).err() {
            Some(SimulationError::Start(StepError::Potential { bad, .. })) => {
                assert_eq!((bad.index, bad.name.as_str()), (1, "Broken"));
            }
            other => panic!("{name}: {other:?}"),
        }
    }
}
