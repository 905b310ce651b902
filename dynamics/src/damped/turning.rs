//! Rigid bodies that turn: what formulas in space miss of a rotation.
//!
//! A backward differentiation formula continues the velocities of the corners of a body along straight lines.
//! Where they go round, the rods have to turn them at the end of the step, and what is left of the formula
//! there brakes the body: with the rate of rotation `w` and equal steps `h`, BDF2 makes
//! `dw/dt = -w^5 h^3 / 2`. The motion of a body on which nothing acts is known, however. From a state it is
//! `X(t)`, with the velocities `V(t)`, and what the formula with the coefficients `b` and `k` makes of that
//! motion, after a step `h'`, is wrong by
//!
//! ```text
//! e_v = V(h) - (V(0) + b (V(0) - V(-h'))),
//! e_x = X(h) - (X(0) + b (X(0) - X(-h')) + k h (V(0) + b (V(0) - V(-h')))).
//! ```
//!
//! With both added to the prediction of the formula, a free body turns as it should, and what acts on it acts
//! as before. Both are of second order in `h`, as is the part of the force of the rods that they stand for.

use crate::damped::restitution::mass_matrix;
use crate::step::accepted::{OfPlaces, OfState};
use crate::{SheetModel, State};
use isosheet_model::PINNED;
use nalgebra::{Matrix3, Matrix4, UnitQuaternion, Vector3};

/// Angle of a part of the integration of a rotation, radians: its fifth power is the error of the energy.
const PART: f64 = 0.01;

/// Most parts: a step of more turns is no step of a rotation.
const MOST_PARTS: f64 = 1024.0;

/// Part of the size of a body, and of its speeds, over which derivatives are central differences: the root of
/// the third order of round-off leaves 1e-10.
const DIFFERENCE: f64 = 1e-5;

/// The bodies that no guide holds.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Turning {
    bodies: Vec<Turned>,
}

/// A body.
#[derive(Debug, Clone, PartialEq)]
struct Turned {
    /// The first of its four vertices.
    first: usize,
    mass: Matrix4<f64>,
}

/// The predictions of a step, `3V`: where the vertices would be without the force of the formula, and where
/// with inertia alone, metres.
pub(crate) struct Predictions<'a> {
    pub(crate) rest: &'a mut [f64],
    pub(crate) inertial: &'a mut [f64],
}

impl Turning {
    pub(crate) fn new(model: &SheetModel) -> Self {
        let [start, end] = model.sheets_end();
        let is_held = |first: usize| {
            let mut vertices = first..first + 4;
            let held = |v: usize| model.constraints().iter().any(|c| c.vertex().index() == v);
            vertices.any(|v| model.free_index()[v] == PINNED || held(v))
        };
        let free = (start..end).step_by(4).filter(|first| !is_held(*first));
        Self {
            bodies: free
                .map(|first| Turned {
                    first,
                    mass: mass_matrix(model, first),
                })
                .collect(),
        }
    }

    /// Corrects the predictions of a step of `h` seconds with the coefficients `b` and `k` by what they miss
    /// of rotations; the step before took `before` seconds. Returns the changes of `rest`, by coordinates.
    pub(crate) fn correct(
        &self,
        state: &State,
        [before, h]: [f64; 2],
        [b, k]: [f64; 2],
        predictions: &mut Predictions<'_>,
    ) -> Vec<(usize, f64)> {
        let mut changes = Vec::with_capacity(12 * self.bodies.len());
        for body in &self.bodies {
            let motion = FreeMotion::of(body, state);
            let (start, end) = (motion.at(0.0), motion.at(h));
            let last = match b == 0.0 {
                true => start,
                false => motion.at(-before),
            };
            for i in 0..4 {
                let [x, x0, x_] = [&end, &start, &last].map(|there| there.places[i]);
                let [v, v0, v_] = [&end, &start, &last].map(|there| there.velocities[i]);
                let predicted = v0 + b * (v0 - v_);
                let of_velocity = v - predicted;
                let of_place = x - (x0 + b * (x0 - x_) + k * h * predicted);
                let place = 3 * (body.first + i);
                for axis in 0..3 {
                    let change = of_place[axis] - k * h * of_velocity[axis];
                    predictions.inertial[place + axis] += of_place[axis];
                    predictions.rest[place + axis] += change;
                    changes.push((place + axis, change));
                }
            }
        }
        changes
    }

    /// Hands the derivatives of a number by `rest` and by the inertial prediction on to the state, as far as
    /// they depend on it by [`Turning::correct`]: central differences of its twenty-four numbers for each
    /// body.
    pub(crate) fn pull_back(
        &self,
        state: &State,
        spans: [f64; 2],
        formula: [f64; 2],
        of: &OfPlaces,
        of_state: &mut OfState,
    ) {
        if self.bodies.is_empty() {
            return;
        }
        let n = state.x.len();
        let mut moved = state.clone();
        let [mut rest, mut inertial] = [vec![0.0; n], vec![0.0; n]];
        for body in &self.bodies {
            let own = 3 * body.first..3 * body.first + 12;
            let alone = Self {
                bodies: vec![body.clone()],
            };
            let mut value = |state: &State| -> f64 {
                rest[own.clone()].fill(0.0);
                inertial[own.clone()].fill(0.0);
                let mut predictions = Predictions {
                    rest: &mut rest,
                    inertial: &mut inertial,
                };
                alone.correct(state, spans, formula, &mut predictions);
                let parts = own.clone();
                parts
                    .map(|i| of.rest[i] * rest[i] + of.prediction[i] * inertial[i])
                    .sum()
            };
            let size = |values: &[f64]| {
                let first = &values[own.start..own.start + 3];
                let rows = values[own.clone()].as_chunks::<3>().0.iter();
                let parts = rows.flat_map(|row| row.iter().zip(first).map(|(a, b)| (a - b).abs()));
                parts.fold(0.0, f64::max)
            };
            let step_x = DIFFERENCE * size(&state.x);
            let step_v = DIFFERENCE * size(&state.v).max(size(&state.x) / spans[1]);
            for i in own.clone() {
                let mut slope = |values: fn(&mut State) -> &mut Vec<f64>, step: f64| {
                    let at = values(&mut moved)[i];
                    values(&mut moved)[i] = at + step;
                    let up = value(&moved);
                    values(&mut moved)[i] = at - step;
                    let down = value(&moved);
                    values(&mut moved)[i] = at;
                    (up - down) / (2.0 * step)
                };
                of_state.x[i] += slope(|state| &mut state.x, step_x);
                of_state.v[i] += slope(|state| &mut state.v, step_v);
            }
        }
    }
}

/// The rotation of a body on which nothing acts, about its centre.
struct FreeMotion {
    /// The corners from the centre, metres.
    arms: [Vector3<f64>; 4],
    /// Angular momentum, kg m2/s.
    momentum: Vector3<f64>,
    /// The inverse of the tensor of inertia at the start.
    inverse: Matrix3<f64>,
}

/// Corners about the centre at a time.
#[derive(Clone, Copy)]
struct Corners {
    places: [Vector3<f64>; 4],
    velocities: [Vector3<f64>; 4],
}

impl FreeMotion {
    fn of(body: &Turned, state: &State) -> Self {
        let (mass, first) = (&body.mass, body.first);
        let at = |values: &[f64], k: usize| {
            let i = 3 * (first + k);
            Vector3::new(values[i], values[i + 1], values[i + 2])
        };
        let weights = mass.row_sum() / mass.sum();
        let centred = |values: &[f64]| -> [Vector3<f64>; 4] {
            // Of differences, which lose no digits far from the origin.
            let from = at(values, 0);
            let own: [Vector3<f64>; 4] = std::array::from_fn(|k| at(values, k) - from);
            let centre: Vector3<f64> = (0..4).map(|k| weights[k] * own[k]).sum();
            own.map(|p| p - centre)
        };
        let (arms, velocities) = (centred(&state.x), centred(&state.v));
        let (mut momentum, mut inertia) = (Vector3::zeros(), Matrix3::zeros());
        for k in 0..4 {
            for l in 0..4 {
                let m = mass[(k, l)];
                momentum += m * arms[k].cross(&velocities[l]);
                let square = Matrix3::from_diagonal_element(arms[k].dot(&arms[l]));
                inertia += m * (square - arms[k] * arms[l].transpose());
            }
        }
        Self {
            arms,
            momentum,
            // (A body has a volume, and its inertia an inverse.)
            inverse: inertia.try_inverse().unwrap_or_default(),
        }
    }

    /// Angular velocity after a rotation from the start: the momentum remains.
    fn rate(&self, turned: &UnitQuaternion<f64>) -> Vector3<f64> {
        turned * (self.inverse * (turned.inverse() * self.momentum))
    }

    /// The corners at a time, seconds from the start: the rotation by the method of Runge and Kutta, of
    /// fourth order.
    fn at(&self, t: f64) -> Corners {
        let angle = self.rate(&UnitQuaternion::identity()).norm() * t.abs();
        let parts = (angle / PART).ceil().clamp(1.0, MOST_PARTS);
        let h = t / parts;
        let mut turned = UnitQuaternion::identity();
        for _ in 0..parts as usize {
            // Rotation vectors from the start of the part, to the order of the method.
            let slope = |u: Vector3<f64>| {
                let w = self.rate(&(UnitQuaternion::from_scaled_axis(u) * turned));
                // The inverse of the derivative of the exponential.
                w - 0.5 * u.cross(&w) + u.cross(&u.cross(&w)) / 12.0
            };
            let k1 = slope(Vector3::zeros());
            let k2 = slope(0.5 * h * k1);
            let k3 = slope(0.5 * h * k2);
            let k4 = slope(h * k3);
            let u = h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            turned = UnitQuaternion::from_scaled_axis(u) * turned;
        }
        let rate = self.rate(&turned);
        let places = self.arms.map(|arm| turned * arm);
        Corners {
            places,
            velocities: places.map(|p| rate.cross(&p)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RigidBody;

    /// A body with three different moments that tumbles about its middle axis.
    fn tumbling() -> (Turned, State, [f64; 3]) {
        let moments = [0.011, 0.03, 0.05];
        let body = RigidBody::new(
            2.0,
            [3.0, -1.0, 0.5],
            Matrix3::from_diagonal(&Vector3::from(moments)).into(),
        )
        .unwrap();
        let sheet = body.tetrahedron();
        let mass = body.mass_matrix();
        let mut matrix =
            Matrix4::from_diagonal(&nalgebra::Vector4::from_column_slice(&mass.vertex));
        if let Some(edges) = &mass.edge {
            for ([a, b], m) in sheet.topology().edges().iter().zip(edges) {
                matrix[(a.index(), b.index())] = *m;
                matrix[(b.index(), a.index())] = *m;
            }
        }
        let spin = Vector3::new(0.3, 11.0, -0.2);
        let drift = Vector3::new(1.0, 2.0, 3.0);
        let centre = Vector3::new(3.0, -1.0, 0.5);
        let x = sheet.positions().to_vec();
        let v = x.as_chunks::<3>().0.iter().flat_map(|p| {
            let v: [f64; 3] = (drift + spin.cross(&(Vector3::from(*p) - centre))).into();
            v
        });
        let v = v.collect();
        (
            Turned {
                first: 0,
                mass: matrix,
            },
            State::moving(x, v),
            moments,
        )
    }

    /// Energy and momentum remain, and the rate is that of Euler's equations, by differences.
    #[test]
    fn a_free_body_obeys_eulers_equations() {
        let (body, state, moments) = tumbling();
        let motion = FreeMotion::of(&body, &state);
        // Moments about axes are sums of the other two.
        let sum: f64 = moments.iter().sum();
        let expected =
            Vector3::new(0.3, 11.0, -0.2).component_mul(&Vector3::from(moments).map(|s| sum - s));
        assert!((motion.momentum - expected).norm() < 1e-12);
        let kinetic = |there: &Corners| {
            let mut energy = 0.0;
            for k in 0..4 {
                for l in 0..4 {
                    energy +=
                        0.5 * body.mass[(k, l)] * there.velocities[k].dot(&there.velocities[l]);
                }
            }
            energy
        };
        let start = kinetic(&motion.at(0.0));
        for t in [0.01, -0.01, 0.07, -0.07, 0.5] {
            let there = motion.at(t);
            let energy = kinetic(&there);
            assert!(
                (energy / start - 1.0).abs() < 1e-10,
                "{t}: {energy} {start}"
            );
            let (mut momentum, h) = (Vector3::zeros(), 1e-5);
            for k in 0..4 {
                for l in 0..4 {
                    momentum += body.mass[(k, l)] * there.places[k].cross(&there.velocities[l]);
                }
                let speed = (motion.at(t + h).places[k] - motion.at(t - h).places[k]) / (2.0 * h);
                assert!(
                    (speed - there.velocities[k]).norm() < 1e-6 * speed.norm(),
                    "{t}"
                );
            }
            assert!(
                (momentum - motion.momentum).norm() < 1e-12 * momentum.norm(),
                "{t}"
            );
        }
        // There and back.
        let there = motion.at(0.3);
        let state = State::moving(
            there.places.iter().flatten().copied().collect(),
            there.velocities.iter().flatten().copied().collect(),
        );
        let back = FreeMotion::of(&body, &state).at(-0.3);
        for k in 0..4 {
            assert!((back.places[k] - motion.arms[k]).norm() < 1e-8);
        }
    }

    /// With the corrections the formula is exact for a free body.
    #[test]
    fn predictions_of_a_free_body_are_where_it_goes() {
        let (body, state, _) = tumbling();
        let motion = FreeMotion::of(&body, &state);
        let turning = Turning { bodies: vec![body] };
        let (before, h) = (0.013, 0.02);
        let w: f64 = h / before;
        let [b, k] = [w * w, 1.0 + w].map(|c| c / (1.0 + 2.0 * w));
        let [start, end, last] = [0.0, h, -before].map(|t| motion.at(t));
        let mut rest = vec![0.0; 12];
        let mut inertial = vec![0.0; 12];
        for i in 0..4 {
            for axis in 0..3 {
                let [x0, x_] = [start.places[i][axis], last.places[i][axis]];
                let [v0, v_] = [start.velocities[i][axis], last.velocities[i][axis]];
                rest[3 * i + axis] = x0 + b * (x0 - x_);
                inertial[3 * i + axis] = rest[3 * i + axis] + k * h * (v0 + b * (v0 - v_));
            }
        }
        let mut predictions = Predictions {
            rest: &mut rest,
            inertial: &mut inertial,
        };
        let changes = turning.correct(&state, [before, h], [b, k], &mut predictions);
        assert_eq!(changes.len(), 12);
        for i in 0..4 {
            for axis in 0..3 {
                let n = 3 * i + axis;
                assert!((inertial[n] - end.places[i][axis]).abs() < 1e-13);
                let speed = (inertial[n] - rest[n]) / (k * h);
                assert!((speed - end.velocities[i][axis]).abs() < 1e-11);
            }
        }
    }
}
