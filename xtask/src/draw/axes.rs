//! Linear and logarithmic axes.

/// One axis of a plot.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// What is shown, with its unit.
    pub(crate) label: String,
    /// Values at the ends.
    pub(crate) range: [f64; 2],
    /// Positions and texts of the ticks.
    pub(crate) ticks: Vec<(f64, String)>,
    scale: Scale,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scale {
    Linear,
    Logarithmic,
}

impl Axis {
    /// A linear axis with the given ticks.
    pub(crate) fn linear(label: &str, range: [f64; 2], ticks: Vec<(f64, String)>) -> Self {
        Self {
            label: label.to_owned(),
            range,
            ticks,
            scale: Scale::Linear,
        }
    }

    /// A linear axis from `range` with about `count` ticks at round values.
    pub(crate) fn round(label: &str, range: [f64; 2], count: usize) -> Self {
        let raw = (range[1] - range[0]) / count.max(1) as f64;
        let power = 10f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|m| m * power)
            .into_iter()
            .find(|s| *s >= raw)
            .unwrap_or(raw);
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let first = (range[0] / step - 1e-9).ceil() as i64;
        let last = (range[1] / step + 1e-9).floor() as i64;
        let ticks = (first..=last)
            .map(|k| {
                let v = k as f64 * step;
                (v, format!("{v:.decimals$}").replace('-', "−"))
            })
            .collect();
        Self::linear(label, range, ticks)
    }

    /// A logarithmic axis over whole decades, with a tick every `every` decades.
    pub(crate) fn decades(label: &str, first: i32, last: i32, every: usize) -> Self {
        let ticks = (first..=last)
            .step_by(every.max(1))
            .map(|k| (10f64.powi(k), format!("10^{{{k}}}").replace('-', "−")))
            .collect();
        Self {
            label: label.to_owned(),
            range: [10f64.powi(first), 10f64.powi(last)],
            ticks,
            scale: Scale::Logarithmic,
        }
    }

    /// A logarithmic axis over the whole decades that hold all positive values, with at most seven ticks.
    pub(crate) fn holding(label: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let (mut low, mut high) = (i32::MAX, i32::MIN);
        for v in values.into_iter().filter(|v| v.is_finite() && *v > 0.0) {
            low = low.min((v.log10() + 1e-9).floor() as i32);
            high = high.max((v.log10() - 1e-9).ceil() as i32);
        }
        if low > high {
            (low, high) = (0, 1);
        }
        let high = high.max(low + 1);
        let every = (high - low).unsigned_abs().div_ceil(6) as usize;
        Self::decades(label, low, high, every)
    }

    /// A logarithmic axis with a tick at every one of some values, and room beside the first and the last.
    pub(crate) fn at(label: &str, ticks: Vec<(f64, String)>) -> Self {
        let low = ticks.iter().map(|t| t.0).fold(f64::INFINITY, f64::min);
        let high = ticks.iter().map(|t| t.0).fold(0.0, f64::max);
        Self {
            label: label.to_owned(),
            range: [low / 1.5, high * 1.5],
            ticks,
            scale: Scale::Logarithmic,
        }
    }

    /// Where on the axis a value is: 0 and 1 are the ends.
    pub(crate) fn part(&self, value: f64) -> f64 {
        let f = |v: f64| match self.scale {
            Scale::Linear => v,
            Scale::Logarithmic => v.log10(),
        };
        (f(value) - f(self.range[0])) / (f(self.range[1]) - f(self.range[0]))
    }

    /// Whether a value is on the axis.
    pub(crate) fn holds(&self, value: f64) -> bool {
        (-1e-9..=1.0 + 1e-9).contains(&self.part(value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let axis = Axis::round("depth", [0.0, 0.17], 4);
        let texts: Vec<&str> = axis.ticks.iter().map(|(_, t)| t.as_str()).collect();
        assert_eq!(texts, ["0.00", "0.05", "0.10", "0.15"]);
        let log = Axis::decades("cond", 0, 6, 3);
        assert_eq!(log.ticks.len(), 3);
        assert!((log.part(1e3) - 0.5).abs() < 1e-15);
        let log = Axis::holding("e", [0.02, 3.0, 0.0, f64::NAN]);
        assert!((log.part(0.1) - 1.0 / 3.0).abs() < 1e-12 && log.holds(10.0) && !log.holds(11.0));
        assert!(!log.holds(0.0) && !log.holds(f64::NAN));
        assert_eq!(Axis::holding("e", []).range, [1.0, 10.0]);
        let at = Axis::at("h", vec![(1.0, "1".into()), (4.0, "4".into())]);
        assert!((at.part(2.0) - 0.5).abs() < 1e-12);
    }
}
