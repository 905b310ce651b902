//! A triangle that loads of all kinds move along its normal, by `a(t) = A (mean + sin(omega t + phase))`.
//!
//! Forces, accelerations and pressures are functions of time, the wind is that whose drag accelerates the
//! triangle so, and forces of positions and velocities pull it back to the exact motion.

use isosheet_dynamics::{
    AccelerationField, Air, At, Force, LoadedFaces, Potential, Profile, SheetModel, State,
    VertexLoad, Wind,
};
use isosheet_mesh::{MassMatrix, Sheet, VertexId};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Mass of a vertex, kilograms.
pub const MASS: f64 = 1e-3;
/// Area of the triangle, square metres.
const AREA: f64 = 0.02;
/// Amplitude of the acceleration, metres per second squared.
pub const SIZE: f64 = 4.0;
/// Its mean, in amplitudes.
const MEAN: f64 = 1.6;
/// Hertz.
const FREQUENCY: f64 = 2.0;
/// Radians.
const PHASE: f64 = 0.4;
/// Velocity at the start, metres per second.
const VELOCITY: f64 = 0.3;
/// End of the runs, seconds.
pub const END: f64 = 0.5;
/// Rates of forces of velocities and of the damping, 1/s, and of forces of positions, 1/s2.
const RATE: f64 = 3.0;
const SPRING: f64 = 20.0;

/// Position, velocity and acceleration along z at a time, seconds: metres, and per second and per second
/// squared.
pub fn exact(t: f64) -> [f64; 3] {
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

/// The triangle, flat at the origin.
pub fn triangle() -> Sheet {
    let x = vec![0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.1, 0.2, 0.0];
    Sheet::new(x, &[[0, 1, 2]]).expect("a triangle")
}

/// The triangle without loads.
pub fn bare() -> SheetModel {
    let mass = MassMatrix::from_vertex_masses(vec![MASS; 3]).expect("positive");
    SheetModel::with_mass(&triangle(), mass).expect("a model")
}

/// What a load depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DependsOn {
    /// Time alone.
    Time,
    /// Positions and velocities too.
    Motion,
    /// Velocities, by the damping of the sheet.
    Damping,
}

/// A kind of load: its name, what it depends on, and the triangle under it.
pub type Load = (&'static str, DependsOn, fn() -> SheetModel);

/// The kinds of loads, forces that depend on time alone first.
pub fn loads() -> [Load; 7] {
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
            bare()
                .with_pressure(faces, course(3.0 * MASS / AREA))
                .expect("a pressure")
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
        (
            "force of positions and velocities",
            DependsOn::Motion,
            || {
                bare().with_force(Along(|t, z, v| {
                    let [z0, v0, a] = exact(t);
                    MASS * (a + RATE * (v0 - v) + SPRING * (z0 - z))
                }))
            },
        ),
        ("damping", DependsOn::Damping, || {
            let force = Along(|t, _, _| {
                let [_, v, a] = exact(t);
                MASS * (a + RATE * v)
            });
            bare().with_force(force).with_damping(RATE).expect("a rate")
        }),
    ]
}

/// The triangle at the start, moving up.
pub fn start() -> State {
    let sheet = triangle();
    State::moving(sheet.positions().to_vec(), [0.0, 0.0, VELOCITY].repeat(3))
}
