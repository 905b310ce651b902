//! Plots of measured numbers.

use crate::draw::{Axis, Drawing, Legend, Plot, Series};

/// As [`Series::styled`], without symbols.
pub(super) fn curve(k: usize, name: &str, points: Vec<[f64; 2]>) -> Series {
    Series {
        marker: None,
        ..Series::styled(k, name, points)
    }
}

/// Whole decades that hold all positive values, at least one.
fn decades(label: &str, values: impl Iterator<Item = f64>) -> Axis {
    let (mut low, mut high) = (i32::MAX, i32::MIN);
    for v in values.filter(|v| *v > 0.0 && v.is_finite()) {
        low = low.min((v.log10() + 1e-9).floor() as i32);
        high = high.max((v.log10() - 1e-9).ceil() as i32);
    }
    let (low, high) = if low > high {
        (0, 1)
    } else {
        (low, high.max(low + 1))
    };
    let every = ((high - low + 6) / 7).max(1);
    Axis::decades(
        label,
        low,
        low + every * ((high - low + every - 1) / every),
        every as usize,
    )
}

fn positive(series: &mut [Series]) {
    for s in series {
        s.points.retain(|p| p[1] > 0.0 && p[1].is_finite());
    }
}

fn draw(x: Axis, y: Axis, series: Vec<Series>) -> Drawing {
    Plot {
        x,
        y,
        size: [230.0, 150.0],
        series,
        legend: Legend::Right,
    }
    .draw()
}

/// Both axes logarithmic; values that are not positive are left out.
pub(super) fn log_log(x: &str, y: &str, mut series: Vec<Series>) -> Drawing {
    positive(&mut series);
    let all = || series.iter().flat_map(|s| &s.points);
    let axes = [
        decades(x, all().map(|p| p[0])),
        decades(y, all().map(|p| p[1])),
    ];
    let [x, y] = axes;
    draw(x, y, series)
}

/// The vertical axis logarithmic; values that are not positive are left out.
pub(super) fn semi_log(x: &str, y: &str, mut series: Vec<Series>) -> Drawing {
    positive(&mut series);
    let all = || series.iter().flat_map(|s| &s.points);
    let high = all().map(|p| p[0]).fold(0.0, f64::max);
    let x = Axis::round(x, [0.0, high.max(f64::MIN_POSITIVE)], 5);
    let y = decades(y, all().map(|p| p[1]));
    draw(x, y, series)
}
