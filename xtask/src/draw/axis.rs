//! Axes of charts: a range of plotters, linear or logarithmic, and the texts of its ticks.

use plotters::coord::combinators::{IntoLogRange, LogCoord};
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use std::ops::Range;

/// Relative room beyond the ends of a logarithmic axis, so that the rounding of logarithms leaves no tick
/// out.
const ROOM: f64 = 1e-9;

/// One axis of a chart.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// What is shown, with its unit.
    pub(super) label: String,
    range: [f64; 2],
    is_logarithmic: bool,
    /// Ticks with their texts; without any, the ticks of plotters.
    ticks: Vec<(f64, String)>,
}

impl Axis {
    /// A linear axis with ticks at round values.
    pub(crate) fn linear(label: &str, range: [f64; 2]) -> Self {
        Self {
            label: label.to_owned(),
            range,
            is_logarithmic: false,
            ticks: Vec::new(),
        }
    }

    /// A linear axis with the given ticks.
    pub(crate) fn named(label: &str, range: [f64; 2], ticks: Vec<(f64, String)>) -> Self {
        Self {
            ticks,
            ..Self::linear(label, range)
        }
    }

    /// A logarithmic axis over the whole decades that hold all positive values.
    pub(crate) fn decades(label: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let (mut low, mut high) = (i32::MAX, i32::MIN);
        for v in values.into_iter().filter(|v| v.is_finite() && *v > 0.0) {
            low = low.min((v.log10() + 1e-9).floor() as i32);
            high = high.max((v.log10() - 1e-9).ceil() as i32);
        }
        if low > high {
            (low, high) = (0, 1);
        }
        let range = [
            10f64.powi(low) * (1.0 - ROOM),
            10f64.powi(high.max(low + 1)) * (1.0 + ROOM),
        ];
        Self {
            is_logarithmic: true,
            ..Self::linear(label, range)
        }
    }

    /// Whether a value is on the axis.
    pub(super) fn holds(&self, value: f64) -> bool {
        let [low, high] = self.range;
        let room = if self.is_logarithmic {
            0.0
        } else {
            ROOM * (high - low)
        };
        (low - room..=high + room).contains(&value)
    }

    fn logarithmic(&self) -> LogCoord<f64> {
        (self.range[0]..self.range[1]).log_scale().into()
    }

    fn straight(&self) -> RangedCoordf64 {
        (self.range[0]..self.range[1]).into()
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        if self.is_logarithmic {
            self.logarithmic().map(value, limit)
        } else {
            self.straight().map(value, limit)
        }
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if !self.ticks.is_empty() {
            self.ticks.iter().map(|t| t.0).collect()
        } else if self.is_logarithmic {
            self.logarithmic().key_points(hint)
        } else {
            self.straight().key_points(hint)
        }
    }

    fn range(&self) -> Range<f64> {
        self.range[0]..self.range[1]
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        if let Some((_, text)) = self.ticks.iter().find(|t| t.0 == *value) {
            return text.clone();
        }
        if self.is_logarithmic {
            let exponent = value.log10().round() as i32;
            return if (-2..=3).contains(&exponent) {
                10f64.powi(exponent).to_string()
            } else {
                format!("1e{exponent}").replace('-', "−")
            };
        }
        // Six decimals hide the rounding of the ticks, which are round.
        let text = format!("{value:.6}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        text.replace("-0", "−0").replace('-', "−")
    }
}

/// The name of a mesh: M³.
pub(crate) fn mesh_name(level: u32) -> String {
    format!("M{}", superscript(level))
}

/// A number in superscript digits.
fn superscript(number: u32) -> String {
    let digits = number.to_string().into_bytes().into_iter();
    let raised =
        digits.map(|d| ["⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"][usize::from(d - b'0')]);
    raised.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotters::coord::ranged1d::BoldPoints;

    #[test]
    fn ticks_are_round_and_inside() {
        let texts = |axis: &Axis| -> Vec<String> {
            let ticks = axis.key_points(BoldPoints(7));
            assert!(ticks.iter().all(|t| axis.holds(*t)));
            ticks.iter().map(|t| axis.format_ext(t)).collect()
        };
        let linear = Axis::linear("depth", [-0.05, 0.17]);
        assert_eq!(texts(&linear), ["−0.05", "0", "0.05", "0.1", "0.15"]);
        assert_eq!(Axis::decades("e", []).format_ext(&1e-7), "1e−7");
        let log = Axis::decades("e", [0.02, 3.0, 0.0, f64::NAN]);
        assert_eq!(texts(&log), ["0.01", "0.1", "1", "10"]);
        assert_eq!(log.map(&0.1, (0, 3000)), 1000);
        assert!(log.holds(10.0) && !log.holds(11.0) && !log.holds(0.0) && !log.holds(f64::NAN));
        assert_eq!(texts(&Axis::decades("e", [])), ["1", "10"]);
    }
}
