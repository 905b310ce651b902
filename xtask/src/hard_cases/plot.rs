//! Plots of measured numbers.

use crate::draw::{Axis, Drawing, Series};
use crate::report::Chart;

/// As [`Series::styled`], without symbols.
pub(super) fn curve(k: usize, name: &str, points: Vec<[f64; 2]>) -> Series {
    Series {
        marker: None,
        ..Series::styled(k, name, points)
    }
}

const SIZE: [f64; 2] = [230.0, 150.0];

fn values(series: &[Series], k: usize) -> impl Iterator<Item = f64> + '_ {
    series
        .iter()
        .flat_map(move |s| s.points.iter().map(move |p| p[k]))
}

/// Both axes logarithmic; values that are not positive are left out.
pub(super) fn log_log(x: &str, y: &str, series: Vec<Series>) -> Drawing {
    let x = Axis::holding(x, values(&series, 0));
    let y = Axis::holding(y, values(&series, 1));
    Chart::new(x, y, SIZE, series).draw()
}

/// The vertical axis logarithmic; values that are not positive are left out.
pub(super) fn semi_log(x: &str, y: &str, series: Vec<Series>) -> Drawing {
    let high = values(&series, 0).fold(f64::MIN_POSITIVE, f64::max);
    let x = Axis::round(x, [0.0, high], 5);
    let y = Axis::holding(y, values(&series, 1));
    Chart::new(x, y, SIZE, series).draw()
}
