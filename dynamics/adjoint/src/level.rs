//! The places at which the equations of a step were solved.

use isosheet_dynamics::sensitivity::{AcceptedStep, FrictionLag};
use isosheet_model::SheetModel;

/// A place of a step at which its equations were solved, and where friction was lagged then.
#[derive(Clone, Copy)]
pub(crate) struct Level<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) lag: FrictionLag<'a>,
    /// Whether friction was lagged until it had settled, so that it is that of the place itself.
    pub(crate) is_settled: bool,
}

/// The places at which the equations of a step were solved, the last one first.
///
/// An elastic sheet solves for a minimum with lagged friction, lags friction there, and begins anew: each of
/// these minima depends on the one before. A sheet of rods lags friction in the course of its iteration.
pub(crate) fn levels<'a>(model: &SheetModel, step: &'a AcceptedStep) -> Vec<Level<'a>> {
    let last = &step.end.x;
    if !model.rods().is_empty() && !step.lags.is_empty() {
        return vec![Level {
            x: last,
            lag: FrictionLag::Places(last),
            is_settled: true,
        }];
    }
    let places = step.lags.iter().chain([last]);
    let lags = step.lags.iter().map(|y| FrictionLag::Places(y));
    let lags = [FrictionLag::Start].into_iter().chain(lags);
    let levels = places.zip(lags).map(|(x, lag)| Level {
        x,
        lag,
        is_settled: false,
    });
    let mut levels: Vec<Level<'a>> = levels.collect();
    levels.reverse();
    levels
}
