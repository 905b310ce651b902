//! Random sheets under random loads: symmetries of the motion, bounds on strain and energy, steps that fail.
//!
//! The random numbers are the same in every run.

use crate::scenes::methods;
use isosheet_dynamics::{
    At, Method, Potential, PotentialShape, SheetModel, Simulation, State, StepReport,
};
use isosheet_mesh::generate::{Diagonals, delaunay_square, disk, fan, strip};
use isosheet_mesh::{MassMatrix, Sheet, VertexId};
use nalgebra::{Isometry3, Rotation3, Vector3};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Constant forces on the vertices, newtons.
#[derive(Debug)]
struct Loads(Vec<Vector3<f64>>);

impl Potential for Loads {
    fn energy(&self, at: At<'_>) -> f64 {
        let At { x, .. } = at;
        let points = x.as_chunks::<3>().0.iter();
        points
            .zip(&self.0)
            .map(|(p, f)| -f.dot(&Vector3::from(*p)))
            .sum()
    }

    fn add_gradient(&self, _at: At<'_>, gradient: &mut [f64]) {
        for (g, f) in gradient
            .iter_mut()
            .zip(self.0.iter().flat_map(|f| f.iter()))
        {
            *g -= f;
        }
    }

    fn shape(&self) -> PotentialShape {
        PotentialShape::Linear
    }
}

/// A sheet, its loads and its start at rest.
#[derive(Debug, Clone)]
struct Scene {
    x: Vec<Vector3<f64>>,
    faces: Vec<[u32; 3]>,
    masses: Vec<f64>,
    loads: Vec<Vector3<f64>>,
    gravity: Vector3<f64>,
    pin: Option<u32>,
    /// Step, seconds.
    h: f64,
}

impl Scene {
    fn model(&self) -> SheetModel {
        let x = self.x.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
        let sheet = Sheet::new(x, &self.faces).expect("a sheet");
        let mass = MassMatrix::from_vertex_masses(self.masses.clone()).expect("positive");
        let pins: Vec<VertexId> = self.pin.map(VertexId).into_iter().collect();
        SheetModel::with_mass(&sheet, mass)
            .expect("valid")
            .with_acceleration(self.gravity.into())
            .with_potential(Loads(self.loads.clone()))
            .with_pins(&pins)
            .expect("exists")
    }

    fn start(&self) -> State {
        State::at_rest(self.x.iter().flat_map(|p| [p.x, p.y, p.z]).collect())
    }

    /// `(w h)^2` for the fastest oscillation that rods allow while nothing moves: the lightest vertex across
    /// the shortest rod under a tension `F` of all weights and loads, `w^2 = F / (m l)`.
    fn squared_phase(&self) -> f64 {
        let loads = self.loads.iter().zip(&self.masses);
        let tension: f64 = loads.map(|(f, m)| (*m * self.gravity + f).norm()).sum();
        let sides = self
            .faces
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let lengths = sides.map(|ends| {
            let [a, b] = ends.map(|v| self.x[v as usize]);
            (a - b).norm()
        });
        let least = |of: &mut dyn Iterator<Item = f64>| of.fold(f64::INFINITY, f64::min);
        let inertia = least(&mut self.masses.iter().copied()) * least(&mut { lengths });
        tension * self.h * self.h / inertia
    }

    /// `(w h)^2` for the fastest oscillation of a vertex across its rods under their forces in the last step,
    /// `w^2 = sum |F| / (m l)`: levers pull with more than the loads.
    fn squared_phase_of(&self, run: &Simulation) -> f64 {
        let forces = run.rod_forces().expect("a method that solves for them");
        let rods = run.model().rods();
        let mut stiffness = vec![0.0; self.x.len()];
        for ((ends, length), force) in rods.edges().iter().zip(rods.lengths()).zip(forces) {
            for v in ends {
                stiffness[*v] += force.abs() / length;
            }
        }
        let vertices = stiffness.iter().zip(&self.masses);
        let squares = vertices.map(|(stiffness, mass)| self.h * self.h * stiffness / mass);
        squares.fold(0.0, f64::max)
    }

    fn simulation(&self, method: &Method) -> Simulation {
        Simulation::new(self.model(), self.start(), method.clone()).expect("valid")
    }

    /// Positions after some steps.
    fn run(&self, method: &Method, steps: usize) -> Vec<Vector3<f64>> {
        let mut run = self.simulation(method);
        for k in 0..steps {
            run.step(self.h)
                .unwrap_or_else(|e| panic!("{method:?}, step {k}: {e}"));
        }
        let points = run.state().x.as_chunks::<3>().0.iter();
        points.map(|p| Vector3::from(*p)).collect()
    }

    /// This scene in another frame.
    fn moved(&self, frame: &Isometry3<f64>) -> Self {
        let turn = |f: &Vector3<f64>| frame.rotation * f;
        Self {
            x: self
                .x
                .iter()
                .map(|p| (frame * nalgebra::Point3::from(*p)).coords)
                .collect(),
            loads: self.loads.iter().map(turn).collect(),
            gravity: turn(&self.gravity),
            ..self.clone()
        }
    }

    /// This scene with vertex `order[i]` in place of vertex `i`, with the faces in another order, and with
    /// each face beginning at another corner.
    fn renumbered(&self, order: &[usize], shift: usize) -> Self {
        let mut place = vec![0; order.len()];
        order
            .iter()
            .enumerate()
            .for_each(|(i, &v)| place[v] = i as u32);
        let mut faces: Vec<[u32; 3]> = self.faces.clone();
        for (k, f) in faces.iter_mut().enumerate() {
            *f = f.map(|v| place[v as usize]);
            f.rotate_left((k + shift) % 3);
        }
        faces.rotate_left(shift % self.faces.len());
        faces.reverse();
        Self {
            x: order.iter().map(|&v| self.x[v]).collect(),
            masses: order.iter().map(|&v| self.masses[v]).collect(),
            loads: order.iter().map(|&v| self.loads[v]).collect(),
            pin: self.pin.map(|v| place[v as usize]),
            faces,
            ..self.clone()
        }
    }

    /// This scene with scaled lengths and masses; times are scaled by the square root of the lengths
    /// (Froude's ratio) and forces as the masses.
    fn scaled(&self, length: f64, mass: f64) -> Self {
        Self {
            x: self.x.iter().map(|p| p * length).collect(),
            masses: self.masses.iter().map(|m| m * mass).collect(),
            loads: self.loads.iter().map(|f| f * mass).collect(),
            h: self.h * length.sqrt(),
            ..self.clone()
        }
    }
}

/// Largest distance of corresponding vertices, metres.
fn apart(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max)
}

/// Flat sheets of about a metre.
fn flat_sheets() -> impl Strategy<Value = Sheet> {
    prop_oneof![
        (2_usize..6, 0.1..0.5_f64).prop_map(|(n, w)| strip(n, 1.0, w, Diagonals::Rising)),
        (3_usize..9, 1.0..5.0_f64).prop_map(|(n, opening)| fan(n, 0.5, opening)),
        (1_usize..3).prop_map(|rings| disk(rings, 0.5)),
        (0.3..0.5_f64, any::<u64>())
            .prop_map(|(spacing, seed)| delaunay_square(1.0, spacing, seed)),
    ]
    .prop_map(|sheet| sheet.expect("valid"))
}

fn vectors(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-size..size).prop_map(Vector3::from)
}

/// Creased sheets under loads of up to their weight.
fn scenes() -> impl Strategy<Value = Scene> {
    flat_sheets().prop_flat_map(|flat| {
        let n = flat.topology().vertex_count();
        (
            Just(flat),
            prop::collection::vec(-0.06..0.06_f64, n),
            prop::collection::vec(0.002..0.01_f64, n),
            prop::collection::vec(vectors(0.03), n),
            vectors(10.0),
            prop::option::of(0..n as u32),
        )
            .prop_map(|(flat, heights, masses, loads, gravity, pin)| {
                let points = flat.positions().as_chunks::<3>().0.iter();
                let lift = |(p, z): (&[f64; 3], &f64)| Vector3::new(p[0], p[1], p[2] + z);
                Scene {
                    x: points.zip(&heights).map(lift).collect(),
                    faces: flat.face_indices(),
                    masses,
                    loads,
                    gravity,
                    pin,
                    h: 4e-3,
                }
            })
    })
}

fn frames() -> impl Strategy<Value = Isometry3<f64>> {
    (vectors(1.0), vectors(3.0)).prop_map(|(shift, turn)| {
        let turn = Rotation3::new(turn);
        Isometry3::from_parts(shift.into(), turn.into())
    })
}

/// Runs a property on the same random values every time.
fn check<S: Strategy>(cases: Config, strategy: &S, property: impl Fn(S::Value)) {
    let config = Config {
        max_shrink_iters: 30,
        ..cases
    };
    let result = TestRunner::new(config).run(strategy, |value| {
        property(value);
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("{e}"));
}

/// Steps of the symmetry tests.
const STEPS: usize = 15;

/// Random scenes of a test.
const CASES: u32 = 40;

/// Largest distance, relative to the size of the sheet, after [`STEPS`] between motions that differ by
/// round-off alone: each step may use the tolerance of the lengths anew, and what it used goes on as a
/// velocity in all that follow.
const ROUND_OFF: f64 = (STEPS * (STEPS + 1) / 2) as f64 * 1e-12;

#[test]
fn motion_commutes_with_rigid_motions() {
    check(
        isosheet_random::cases(CASES),
        &(scenes(), frames()),
        |(scene, frame)| {
            for (name, method) in methods() {
                let there = scene.moved(&frame).run(&method, STEPS);
                let here = scene.run(&method, STEPS);
                let carried: Vec<_> = here
                    .iter()
                    .map(|p| (frame * nalgebra::Point3::from(*p)).coords)
                    .collect();
                let error = apart(&there, &carried);
                assert!(error < ROUND_OFF, "{name}: {error:e} m");
                assert!(apart(&here, &scene.x) > 1e-3, "{name}: nothing moved");
            }
        },
    );
}

#[test]
fn motion_does_not_depend_on_numbering() {
    let numbered = scenes().prop_flat_map(|scene| {
        let order: Vec<usize> = (0..scene.x.len()).collect();
        (Just(scene), Just(order).prop_shuffle(), 0_usize..7)
    });
    check(
        isosheet_random::cases(CASES),
        &numbered,
        |(scene, order, shift)| {
            for (name, method) in methods() {
                let there = scene.renumbered(&order, shift).run(&method, STEPS);
                let here = scene.run(&method, STEPS);
                let carried: Vec<_> = order.iter().map(|&v| here[v]).collect();
                let error = apart(&there, &carried);
                assert!(error < ROUND_OFF, "{name}: {error:e} m");
            }
        },
    );
}

#[test]
fn motion_scales_by_froude() {
    let scales = (-3.0..3.0_f64, -3.0..3.0_f64).prop_map(|(l, m)| (10_f64.powf(l), 10_f64.powf(m)));
    check(
        isosheet_random::cases(CASES),
        &(scenes(), scales),
        |(scene, (length, mass))| {
            for (name, method) in methods() {
                let there = scene.scaled(length, mass).run(&method, STEPS);
                let here = scene.run(&method, STEPS);
                let back: Vec<_> = there.iter().map(|p| p / length).collect();
                let error = apart(&back, &here);
                assert!(
                    error < ROUND_OFF,
                    "{name}: {error:e} m, length {length}, mass {mass}"
                );
            }
        },
    );
}

/// What a run promises in every report. `squared` is the square of the fastest oscillation's phase in a step
/// ([`Scene::squared_phase`], [`Scene::squared_phase_of`]).
fn check_report(name: &str, report: &StepReport, start: f64, largest: f64, squared: f64) {
    let numbers = [
        report.kinetic,
        report.potential,
        report.energy_drift,
        report.strain,
        report.residual,
    ];
    assert!(numbers.iter().all(|n| n.is_finite()), "{name}: {report:?}");
    assert!(report.strain < 1e-12, "{name}: {report:?}");
    assert_eq!(report.work, 0.0, "{name}: {report:?}");
    let drift = report.hamiltonian() - start;
    let noise = 1e-9 * (largest + report.potential.abs() + start.abs());
    let [low, high] = match name {
        // The first step from rest of a damped method loses as much energy as it turns into motion; the
        // account of the energy lets all steps together gain a fiftieth.
        "implicit Euler" | "BDF2" => [-1.01, 0.02],
        "energy-momentum" => [0.0, 0.0],
        // Methods of the second order, and of higher ones, err by no more than the square of the phase.
        _ => [-squared, squared],
    };
    assert!(
        (low * largest - noise..=high * largest + noise).contains(&drift),
        "{name}: {drift:e} J of {largest} J, {report:?}"
    );
}

/// Steps of the runs of random sheets.
const FALL: usize = 40;

#[test]
fn strain_and_energy_of_random_sheets() {
    check(isosheet_random::cases(CASES), &scenes(), |scene| {
        let mut lost = HashMap::new();
        for (name, method) in methods() {
            let mut run = scene.simulation(&method);
            let (start, mut largest) = (run.energy(), 0.0_f64);
            let mut squared = scene.squared_phase();
            for k in 0..FALL {
                let report = run
                    .step(scene.h)
                    .unwrap_or_else(|e| panic!("{name}, step {k}: {e}"));
                largest = largest.max(report.kinetic);
                squared = squared.max(scene.squared_phase_of(&run));
                check_report(name, &report, start, largest, squared);
                lost.insert(name, -report.energy_drift / largest);
            }
        }
        // From rest a method of the second order loses less than one of the first.
        assert!(lost["BDF2"] < lost["implicit Euler"], "{lost:?}");
    });
}

/// A potential that is not a number: its energy while the first switch is on, its gradient while the second
/// switch is on.
#[derive(Debug, Clone)]
struct Broken {
    switches: Arc<[AtomicBool; 2]>,
    after: f64,
}

impl Broken {
    fn value(&self, t: f64, switch: usize) -> f64 {
        if t > self.after && self.switches[switch].load(Ordering::Relaxed) {
            f64::NAN
        } else {
            0.0
        }
    }

    fn set(&self, on: [bool; 2]) {
        for (switch, on) in self.switches.iter().zip(on) {
            switch.store(on, Ordering::Relaxed);
        }
    }
}

impl Potential for Broken {
    fn energy(&self, at: At<'_>) -> f64 {
        let At { t, .. } = at;
        self.value(t, 0)
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let At { t, .. } = at;
        gradient[4] += self.value(t, 1);
    }
}

#[test]
fn failed_steps_leave_no_trace() {
    check(isosheet_random::cases(8), &scenes(), |scene| {
        for (name, method) in methods() {
            let broken = Broken {
                switches: Arc::default(),
                after: 5.5 * scene.h,
            };
            let mut runs = [(); 2].map(|()| {
                let model = scene.model().with_potential(broken.clone());
                Simulation::new(model, scene.start(), method.clone()).expect("valid")
            });
            for k in 0..12 {
                let [undisturbed, disturbed] = &mut runs;
                let report = undisturbed
                    .step(scene.h)
                    .unwrap_or_else(|e| panic!("{name}, step {k}: {e}"));
                for h in [0.0, -scene.h, f64::NAN, f64::INFINITY] {
                    assert!(disturbed.step(h).is_err(), "{name}: {h} s");
                }
                if k >= 6 {
                    assert!(disturbed.step(1e-30).is_err(), "{name}: time stands still");
                    broken.set([true, k % 2 == 1]);
                    let before = disturbed.checkpoint();
                    assert!(disturbed.step(scene.h).is_err(), "{name}, step {k}");
                    assert!(
                        disturbed.checkpoint() == before,
                        "{name}, step {k}: a trace"
                    );
                    broken.set([false, false]);
                }
                let same = disturbed.step(scene.h).expect("as before");
                assert_eq!(
                    format!("{same:?}"),
                    format!("{report:?}"),
                    "{name}, step {k}"
                );
                assert!(disturbed.state() == undisturbed.state(), "{name}, step {k}");
            }
        }
    });
}
