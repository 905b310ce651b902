//! Plots of measured numbers, and the orders fitted to them.

use crate::draw::{Axis, Drawing, Legend, Plot, Series, row};
use crate::scale::exponent;

/// A named sequence of points with a line, the style by its place; without points that have no logarithm.
pub(super) fn series(k: usize, name: &str, points: Vec<[f64; 2]>) -> Series {
    Series::styled(k, name, points.into_iter().filter(is_positive).collect())
}

fn is_positive(point: &[f64; 2]) -> bool {
    point.iter().all(|v| v.is_finite() && *v > 0.0)
}

/// Fitted power of the errors above `floor`, the level of round-off and of the solver's tolerances, below
/// which an error says nothing; nothing from fewer than two.
pub(super) fn order(points: &[[f64; 2]], floor: f64) -> Option<f64> {
    let all = points.iter().copied();
    let above: Vec<[f64; 2]> = all.filter(|p| is_positive(p) && p[1] > floor).collect();
    if above.len() < 2 {
        return None;
    }
    exponent(&above)
}

/// Whole decades that hold all values.
fn decades(label: &str, values: impl Iterator<Item = f64>) -> Axis {
    let (mut low, mut high) = (i32::MAX, i32::MIN);
    for v in values {
        low = low.min((v.log10() + 1e-9).floor() as i32);
        high = high.max((v.log10() - 1e-9).ceil() as i32);
    }
    if low > high {
        return Axis::decades(label, 0, 1, 1);
    }
    Axis::decades(label, low, high.max(low + 1), 1)
}

/// Plots side by side with the same logarithmic axes, each with its label of the vertical axis; the series are
/// named beside the last one.
pub(super) fn panels(x: &str, panels: Vec<(String, Vec<Series>)>) -> Drawing {
    let all: Vec<[f64; 2]> = panels
        .iter()
        .flat_map(|(_, series)| series.iter().flat_map(|s| s.points.iter().copied()))
        .collect();
    let last = panels.len().saturating_sub(1);
    let drawings: Vec<Drawing> = panels
        .into_iter()
        .enumerate()
        .map(|(k, (label, series))| {
            Plot {
                x: decades(x, all.iter().map(|p| p[0])),
                y: decades(&label, all.iter().map(|p| p[1])),
                size: [150.0, 150.0],
                legend: if k == last {
                    Legend::Right
                } else {
                    Legend::None
                },
                series,
            }
            .draw()
        })
        .collect();
    row(&drawings, 24.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_need_two_values_above_the_floor() {
        let points = [[0.1, 0.02], [0.2, 0.08], [0.4, 0.0], [0.8, f64::NAN]];
        assert!((order(&points, 0.0).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(order(&points, 0.05), None);
        assert_eq!(order(&points[1..], 0.0), None);
    }
}
