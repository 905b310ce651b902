//! Convergence orders of every method under every kind of load that changes in time.
//!
//! A triangle moves along its normal by `a(t) = A (mean + sin(omega t + phase))`, so that each load is known in closed
//! form: forces, accelerations and pressures are functions of time, the wind is that whose drag accelerates the
//! triangle so, and forces of positions and velocities pull it back to the exact motion.

use isosheet_coords::{CartesianChart, Chart, Choice, RodSystem};
use isosheet_dynamics::chart::{ChartMethod, ChartOptions, ChartStepControl};
use isosheet_dynamics::{
    AccelerationField, Air, At, Force, ImplicitOptions, LoadedFaces, Method, Potential, Profile, SheetModel, Simulation, State,
    VertexLoad, Wind,
};
use isosheet_mesh::{MassMatrix, Sheet, VertexId};
use isosheet_tests::{methods, orders};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Mass of a vertex, kilograms, and area of the triangle, square metres.
const MASS: f64 = 1e-3;
const AREA: f64 = 0.02;
/// The acceleration.
const SIZE: f64 = 4.0;
const MEAN: f64 = 1.6;
const FREQUENCY: f64 = 2.0;
const PHASE: f64 = 0.4;
/// Velocity at the start, metres per second.
const VELOCITY: f64 = 0.3;
/// End of the runs, seconds.
const END: f64 = 0.5;
/// Rates of forces of velocities and of the damping, 1/s, and of forces of positions, 1/s2.
const RATE: f64 = 3.0;
const SPRING: f64 = 20.0;

/// Position, velocity and acceleration along z.
fn exact(t: f64) -> [f64; 3] {
    let (w, phase) = (TAU * FREQUENCY, TAU * FREQUENCY * t + PHASE);
    let (sin, cos) = PHASE.sin_cos();
    [
        VELOCITY * t + SIZE * (0.5 * MEAN * t * t + (cos * t) / w - (phase.sin() - sin) / (w * w)),
        VELOCITY + SIZE * (MEAN * t - (phase.cos() - cos) / w),
        SIZE * (MEAN + phase.sin()),
    ]
}

/// `factor a(t)`.
fn course(factor: f64) -> Profile {
    Profile::Sine {
        mean: factor * SIZE * MEAN,
        amplitude: factor * SIZE,
        frequency: FREQUENCY,
        phase: PHASE,
    }
}

/// A force along z on each vertex, by its time, height and velocity.
struct Along<F>(F);

impl<F> std::fmt::Debug for Along<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Along")
    }
}

impl<F: Fn(f64, f64, f64) -> f64 + Send + Sync> Force for Along<F> {
    fn add_force(&self, t: f64, x: &[f64], v: &[f64], force: &mut [f64]) {
        for k in (2..x.len()).step_by(3) {
            force[k] += (self.0)(t, x[k], v[k]);
        }
    }
}

/// `V = -m a(t) z` of each vertex.
#[derive(Debug)]
struct Lift;

impl Potential for Lift {
    fn energy(&self, at: At<'_>) -> f64 {
        let heights: f64 = at.x.iter().skip(2).step_by(3).sum();
        -MASS * exact(at.t)[2] * heights
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        for g in gradient.iter_mut().skip(2).step_by(3) {
            *g -= MASS * exact(at.t)[2];
        }
    }

    fn is_driven(&self) -> bool {
        true
    }
}

fn triangle() -> Sheet {
    let x = vec![0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.1, 0.2, 0.0];
    Sheet::new(x, &[[0, 1, 2]]).expect("a triangle")
}

fn bare() -> SheetModel {
    let mass = MassMatrix::from_vertex_masses(vec![MASS; 3]).expect("positive");
    SheetModel::with_mass(&triangle(), mass).expect("a model")
}

/// Whether a load depends on time alone, or on positions and velocities too.
#[derive(Debug, Clone, Copy, PartialEq)]
enum DependsOn {
    Time,
    Motion,
    Damping,
}

type Loaded = fn() -> SheetModel;

/// The kinds of loads.
fn loads() -> [(&'static str, DependsOn, Loaded); 7] {
    [
        ("force on vertices", DependsOn::Time, || {
            let all: Vec<VertexId> = (0..3).map(VertexId).collect();
            let load = VertexLoad::new(triangle().topology(), &all, [0.0, 0.0, 2.0], course(MASS));
            bare().with_force(load.expect("a load"))
        }),
        ("acceleration", DependsOn::Time, || {
            let field = AccelerationField::new(vec![MASS; 3], [0.0, 0.0, 1.0], course(1.0));
            bare().with_force(field.expect("a field"))
        }),
        ("pressure", DependsOn::Time, || {
            let sheet = triangle();
            let faces: Vec<_> = sheet.topology().face_ids().collect();
            let faces = LoadedFaces::new(sheet.topology(), &faces, &[]).expect("a face");
            bare().with_pressure(faces, course(3.0 * MASS / AREA)).expect("a pressure")
        }),
        ("potential", DependsOn::Time, || bare().with_potential(Lift)),
        ("wind", DependsOn::Motion, || {
            let air = Air {
                tangential: 0.0,
                ..Air::default()
            };
            let factor = 0.5 * air.density * AREA * air.normal;
            let wind = move |_: [f64; 3], t: f64| {
                let [_, v, a] = exact(t);
                [0.0, 0.0, v + (3.0 * MASS * a / factor).sqrt()]
            };
            let wind = Wind::Custom(Arc::new(wind));
            bare().with_air(Air { wind, ..air }).expect("air")
        }),
        ("force of positions and velocities", DependsOn::Motion, || {
            bare().with_force(Along(|t, z, v| {
                let [z0, v0, a] = exact(t);
                MASS * (a + RATE * (v0 - v) + SPRING * (z0 - z))
            }))
        }),
        ("damping", DependsOn::Damping, || {
            let force = Along(|t, _, _| {
                let [_, v, a] = exact(t);
                MASS * (a + RATE * v)
            });
            bare().with_force(force).with_damping(RATE).expect("a rate")
        }),
    ]
}

fn start() -> State {
    let sheet = triangle();
    State::moving(sheet.positions().to_vec(), [0.0, 0.0, VELOCITY].repeat(3))
}

/// Errors of position and velocity at the end of a run, relative to the exact ones.
fn errors(run: &mut Simulation, steps: usize) -> [f64; 2] {
    for _ in 0..steps {
        let report = run.step(END / steps as f64).expect("accepted");
        assert_eq!(report.rejected, 0, "no step is refused");
    }
    let [z, v, _] = exact(END);
    let state = run.state();
    [(state.x[2] - z).abs() / z, (state.v[2] - v).abs() / v]
}

/// Checks that positions and velocities converge with an order; `run` starts a simulation with steps of a length.
fn check(what: &str, order: f64, run: impl Fn(f64) -> Simulation) {
    let found: Vec<[f64; 2]> = [60, 120, 240]
        .map(|steps| errors(&mut run(END / steps as f64), steps))
        .to_vec();
    for (k, name) in ["position", "velocity"].into_iter().enumerate() {
        let errors: Vec<f64> = found.iter().map(|e| e[k]).collect();
        let is_round_off = errors.iter().all(|e| *e < 1e-11);
        let observed = orders(&errors);
        assert!(
            is_round_off || observed.iter().all(|o| *o > order - 0.1),
            "{what}, {name}: errors {errors:?}, orders {observed:?}, expected {order}"
        );
    }
}

#[test]
fn loads_of_time_keep_the_order_of_each_method() {
    for (load, depends, model) in loads() {
        for (name, method) in methods() {
            let order = match (name, depends) {
                ("implicit Euler", _) => 1.0,
                // Its steps are symmetric, and can be composed, where forces depend on no velocities.
                ("RATTLE composition", DependsOn::Time | DependsOn::Damping) => 4.0,
                _ => 2.0,
            };
            let tight = ImplicitOptions {
                tolerance: Some(1e-12),
                ..Default::default()
            };
            let method = match method {
                Method::ImplicitEuler(_) => Method::ImplicitEuler(tight),
                Method::Bdf2(_) => Method::Bdf2(tight),
                other => other,
            };
            check(&format!("{name} under {load}"), order, |_| {
                Simulation::new(model(), start(), method.clone()).expect("a simulation")
            });
        }
    }
}

/// In a chart the damping is that of the paper, which follows each step.
#[test]
fn loads_of_time_keep_the_order_in_a_chart() {
    for (load, depends, model) in loads() {
        let order = if depends == DependsOn::Damping { 1.0 } else { 4.0 };
        check(&format!("Runge-Kutta under {load}"), order, |h| {
            let sheet = triangle();
            let system = RodSystem::new(&sheet, &[]).expect("rods");
            let chart = CartesianChart::new(system, Choice::Auto, sheet.positions()).expect("a chart");
            let options = ChartOptions {
                method: ChartMethod::RungeKutta4,
                control: ChartStepControl::Fixed(h),
                ..Default::default()
            };
            let chart: Box<dyn Chart> = Box::new(chart);
            Simulation::in_chart(model(), start(), chart, options).expect("a simulation")
        });
    }
}

/// A release at a time that is no end of a step, a load that jumps within a thousandth of a second, and a pin that
/// starts with a jump of its velocity: with the breaks of their functions the order is two.
#[test]
fn breaks_keep_the_order_of_bdf2() {
    let begin = 0.1234;
    let jump = |to: f64| Profile::Ramp {
        from: 0.0,
        to,
        begin,
        end: begin + 1e-9,
    };
    // z = a (t - b)^2 / 2 after the jump of the load, and the same for the velocity that it leaves.
    let observed = |with_breaks: bool| -> Vec<f64> {
        let errors: Vec<f64> = [60_u32, 120, 240]
            .iter()
            .map(|steps| {
                let profile = jump(SIZE);
                let times = if with_breaks { profile.breaks() } else { Vec::new() };
                let field = AccelerationField::new(vec![MASS; 3], [0.0, 0.0, 1.0], profile);
                let model = bare().with_force(field.expect("a field")).with_breaks(times);
                let method = Method::Bdf2(Default::default());
                let start = State::at_rest(triangle().positions().to_vec());
                let mut run = Simulation::new(model, start, method).expect("a simulation");
                for _ in 0..*steps {
                    run.step(END / f64::from(*steps)).expect("accepted");
                }
                (run.state().v[2] - SIZE * (END - begin)).abs()
            })
            .collect();
        errors
    };
    let (without, with) = (observed(false), observed(true));
    assert!(with.iter().all(|e| *e < 1e-8), "{with:?}");
    assert!(without.iter().all(|e| *e > 1e-4), "{without:?}");
}
