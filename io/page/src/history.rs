//! What a history shows over time.

use super::field::{Scale, TimeSeries};
use isosheet_formats::HistoryRow;

impl TimeSeries {
    /// The columns of a history over time: energies, largest strain, smallest gap (in runs that have one; 0,
    /// which plots leave out, while nothing is within reach), change of the total energy, length of the step,
    /// and the iterations, factorisations and rejected sub-steps of each step.
    pub fn of_history(rows: &[HistoryRow]) -> Vec<Self> {
        // The row of the start is no step.
        let steps: Vec<&HistoryRow> = rows.iter().filter(|row| row.h > 0.0).collect();
        let all: Vec<&HistoryRow> = rows.iter().collect();
        let one = |name: &str, unit: &str, scale, rows: &[&HistoryRow], of: HistoryColumn| Self {
            name: name.into(),
            unit: unit.into(),
            scale,
            times: rows.iter().map(|row| row.t).collect(),
            values: rows.iter().map(|row| of(row)).collect(),
        };
        let (linear, logarithmic) = (Scale::Linear, Scale::Logarithmic);
        let mut series = vec![
            one("kinetic energy", "J", linear, &all, |row| row.kinetic),
            one("potential energy", "J", linear, &all, |row| row.potential),
            one("total energy", "J", linear, &all, |row| row.total),
            one("largest strain", "", logarithmic, &all, |row| row.strain),
        ];
        if rows.iter().any(|row| row.gap.is_some()) {
            series.push(one("smallest gap", "m", logarithmic, &all, |row| {
                row.gap.unwrap_or_default()
            }));
        }
        if rows.iter().any(|row| row.plastic.is_some()) {
            series.push(one("dissipated by yielding", "J", linear, &all, |row| {
                row.plastic.unwrap_or_default()
            }));
        }
        series.extend([
            one("change of the total energy", "J", linear, &all, |row| {
                row.drift
            }),
            one("length of the step", "s", linear, &steps, |row| row.h),
            one("iterations", PER_STEP, linear, &steps, |row| {
                row.iterations as f64
            }),
            one("factorisations", PER_STEP, linear, &steps, |row| {
                row.factorisations as f64
            }),
            one("rejected", PER_STEP, linear, &steps, |row| {
                row.rejected as f64
            }),
        ]);
        series
    }
}

/// A number of a row.
type HistoryColumn = fn(&HistoryRow) -> f64;

/// The unit of counts, which share a plot.
const PER_STEP: &str = "per step";
