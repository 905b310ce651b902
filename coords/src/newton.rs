//! Newton's method for positions with given coordinates and edge lengths.

use crate::chart::{Chart, ChartError};
use crate::linearised::Linearised;
use crate::realise::check;
use isosheet_linalg::norm_inf;

/// Relative change of the unknowns below which Newton's method for positions stops. Convergence is
/// quadratic, so that the last step taken leaves rounding only.
const NEWTON_TOLERANCE: f64 = 1e-13;

/// Most Newton steps for positions; from a step of ordinary size four or five are needed.
const NEWTON_STEPS: usize = 30;

/// Newton's method for positions: solve `[c(x); q(x) - q] = 0` from the state in `x`.
///
/// The step is halved while the residual does not decrease. Leaves A factorised near the result.
///
/// # Errors
/// [`ChartError::NotConverged`], or an error of the factorisation on the way; `x` is the last
/// iterate then.
pub(crate) fn newton(
    chart: &dyn Chart,
    linear: &mut Linearised,
    q: &[f64],
    x: &mut [f64],
) -> Result<usize, ChartError> {
    let system = chart.system();
    check("q", q, chart.dimension())?;
    check("x", x, 3 * system.vertex_count())?;
    let size = norm_inf(x).max(f64::MIN_POSITIVE);
    let mut residual = vec![0.0; linear.unknowns()];
    let mut now = vec![0.0; q.len()];
    let mut trial = x.to_vec();
    let mut evaluate = |x: &[f64], residual: &mut [f64]| -> Result<f64, ChartError> {
        let (c, s) = residual.split_at_mut(system.equations());
        system.residual(x, c);
        chart.coordinates(x, &mut now)?;
        chart.difference(&now, q, s);
        Ok(residual.iter().map(|r| r * r).sum::<f64>().sqrt())
    };
    let mut old = evaluate(x, &mut residual)?;
    let mut change = f64::INFINITY;
    for iteration in 0..NEWTON_STEPS {
        chart.linearise(system, linear, x)?;
        let mut step = residual.clone();
        linear.solve(&mut step)?;
        change = norm_inf(&step) / size;
        let mut fraction = 1.0;
        loop {
            trial.copy_from_slice(x);
            system.add_scaled(-fraction, &step, &mut trial);
            match evaluate(&trial, &mut residual) {
                // At rounding level the residual need not decrease any more.
                Ok(new) if new < old || change < 1e-9 => {
                    old = new;
                    break;
                }
                _ if fraction > 1e-3 => fraction *= 0.5,
                _ => {
                    return Err(ChartError::NotConverged {
                        iterations: iteration,
                        residual: change,
                        tolerance: NEWTON_TOLERANCE,
                    });
                }
            }
        }
        x.copy_from_slice(&trial);
        if change < 1e-9 && fraction == 1.0 {
            // Quadratic: the step just taken leaves about its square, if the Jacobian is regular;
            // one more pass only when that is still above the tolerance.
            if change * change < NEWTON_TOLERANCE {
                return Ok(iteration + 1);
            }
        }
    }
    Err(ChartError::NotConverged {
        iterations: NEWTON_STEPS,
        residual: change,
        tolerance: NEWTON_TOLERANCE,
    })
}
