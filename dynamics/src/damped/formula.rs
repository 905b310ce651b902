//! The formula of a damped step: where inertia alone leads, and how that depends on the states before.

use crate::damped::turning::{Predictions, Turning};
use crate::step::accepted::{OfPlaces, OfState};
use crate::{SheetModel, State};

/// How a step makes positions and velocities of those before: with the state `_` before its start `0`,
///
/// ```text
/// x1 = y + k h v1,   y = x0 + b (x0 - x_),   x^ = y + k h (v0 + b (v0 - v_)).
/// ```
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepFormula<'a> {
    pub(crate) start: &'a State,
    /// The state before it, of a formula that looks back.
    pub(crate) before: Option<&'a State>,
    /// `h`, seconds.
    pub(crate) span: f64,
    /// `b`.
    pub(crate) back: f64,
    /// `k`.
    pub(crate) k: f64,
}

impl StepFormula<'_> {
    /// Sets `y`, `x^` and the positions that the velocities at the start lead to (`3V`, metres). Returns what
    /// the rotation of rigid bodies adds to `y`, by coordinates.
    pub(crate) fn place(
        &self,
        model: &SheetModel,
        turning: &Turning,
        [rest, prediction, ahead]: &mut [Vec<f64>; 3],
    ) -> Vec<(usize, f64)> {
        // 1 + b: differences keep pinned vertices where they are to the last bit.
        let (state, h, b, k) = (self.start, self.span, self.back, self.k);
        let before = self.before.unwrap_or(state);
        // Of v_ the damping leaves by now what it does in the step before, and of both what it does in this
        // one.
        prediction.copy_from_slice(&before.v);
        model.damp(prediction, state.t - before.t);
        for i in 0..state.x.len() {
            let v = state.v[i];
            prediction[i] = v + b * (v - prediction[i]);
        }
        model.damp(prediction, h);
        for i in 0..state.x.len() {
            let x = state.x[i];
            rest[i] = x + b * (x - before.x[i]);
            prediction[i] = rest[i] + k * h * prediction[i];
            ahead[i] = x + h * state.v[i];
        }
        model.place_pins(state.t + h, ahead);
        let mut predictions = Predictions {
            rest,
            inertial: prediction,
        };
        let spans = [state.t - before.t, h];
        turning.correct(state, spans, [b, k], &mut predictions)
    }

    /// Hands derivatives by the places on to the states that these are made of: to the start, and to the
    /// state before. (The velocities at the end are `(x1 - y) / (k h)`, and are handed on as those by `x1`
    /// and `y`.)
    pub(crate) fn pull_back(
        &self,
        model: &SheetModel,
        turning: &Turning,
        of: &OfPlaces,
        of_start: &mut OfState,
        of_before: &mut OfState,
    ) {
        let (state, h, b, k) = (self.start, self.span, self.back, self.k);
        let mut speeds: Vec<f64> = of.prediction.iter().map(|p| k * h * p).collect();
        // The damping multiplies velocities, and so it does derivatives.
        model.damp(&mut speeds, h);
        for i in 0..speeds.len() {
            let rest = of.rest[i] + of.prediction[i];
            of_start.x[i] += (1.0 + b) * rest;
            of_start.v[i] += (1.0 + b) * speeds[i];
        }
        if let Some(before) = self.before {
            for i in 0..speeds.len() {
                of_before.x[i] -= b * (of.rest[i] + of.prediction[i]);
            }
            let mut earlier: Vec<f64> = speeds.iter().map(|s| -b * s).collect();
            model.damp(&mut earlier, state.t - before.t);
            for (own, earlier) in of_before.v.iter_mut().zip(&earlier) {
                *own += earlier;
            }
        }
        let mut ahead = of.ahead.clone();
        for v in model.moving_pins() {
            ahead[3 * v..3 * v + 3].fill(0.0);
        }
        for i in 0..ahead.len() {
            of_start.x[i] += ahead[i];
            of_start.v[i] += h * ahead[i];
        }
        let last = self.before.unwrap_or(state);
        let spans = [state.t - last.t, h];
        turning.pull_back(state, spans, [b, k], of, of_start);
    }
}
