//! The values that a scale of colours names, as texts.

use super::colour_scale::{ColourScale, Spacing};

/// The values that are named, and what is written.
pub(super) struct Ticks {
    /// Name and unit of the quantity; of a unit with a prefix or a power of ten by which labels are to be
    /// multiplied.
    pub(super) title: String,
    /// Values in ascending order, with their labels.
    pub(super) labels: Vec<(f64, String)>,
}

/// Prefixes of units by powers of ten.
const PREFIXES: [(i32, &str); 6] = [
    (-12, "p"),
    (-9, "n"),
    (-6, "µ"),
    (-3, "m"),
    (3, "k"),
    (6, "M"),
];

/// Units that take a prefix.
const PREFIXED: [&str; 4] = ["m", "N", "J", "Pa"];

/// Round values are these times a power of ten.
const ROUND: [f64; 3] = [1.0, 2.0, 5.0];

impl Ticks {
    /// At most so many round values within the range of a scale; where it has one value alone, this one.
    pub(super) fn of(scale: &ColourScale, most: usize) -> Self {
        let [low, high] = scale.range;
        let logarithmic = match scale.spacing {
            Spacing::Logarithmic if high > low => logarithmic(low, high, most),
            _ => Vec::new(),
        };
        // A range of less than a factor of some is as good as linear.
        if logarithmic.len() < 2 {
            return Self::linear(scale, most);
        }
        Self {
            title: title(&scale.name, &scale.unit),
            labels: logarithmic,
        }
    }

    fn linear(scale: &ColourScale, most: usize) -> Self {
        let [low, high] = scale.range;
        let exponent = exponent(low.abs().max(high.abs()));
        let factor = 10_f64.powi(exponent);
        let (values, digits) = if high > low {
            let step = step(low / factor, high / factor, most);
            let numbers = (low / factor / step - 1e-9).ceil() as i64
                ..=(high / factor / step + 1e-9).floor() as i64;
            let digits = (-step.log10().floor()).max(0.0) as usize;
            (numbers.map(|k| k as f64 * step).collect(), digits)
        } else {
            (vec![low / factor], 2)
        };
        let labels = values
            .into_iter()
            .map(|value: f64| (value * factor, plain(value, digits)));
        let prefix = PREFIXES.iter().find(|(power, _)| *power == exponent);
        let takes_one = PREFIXED.contains(&scale.unit.split('/').next().unwrap_or_default());
        let unit = match (exponent, prefix) {
            (0, _) => scale.unit.clone(),
            (_, Some((_, prefix))) if takes_one => format!("{prefix}{}", scale.unit),
            _ => format!("{} {}", power(exponent), scale.unit)
                .trim_end()
                .to_owned(),
        };
        Self {
            title: title(&scale.name, &unit),
            labels: labels.collect(),
        }
    }
}

fn title(name: &str, unit: &str) -> String {
    match (unit, name.strip_suffix(')')) {
        ("", _) => name.to_owned(),
        (_, Some(more)) => format!("{more}, {unit})"),
        _ => format!("{name} ({unit})"),
    }
}

/// The power of ten, a multiple of three, by which numbers up to a size are short; 0 for sizes that are short
/// themselves.
fn exponent(size: f64) -> i32 {
    if size == 0.0 || (0.1..1e4).contains(&size) {
        return 0;
    }
    3 * (size.log10() / 3.0).floor() as i32
}

/// The smallest round step with which no more than so many values are in a range.
fn step(low: f64, high: f64, most: usize) -> f64 {
    let least = (high - low) / most.max(1) as f64;
    let power = least.log10().floor() as i32;
    let steps = (power..power + 3).flat_map(|power| ROUND.map(|m| m * 10_f64.powi(power)));
    let count = |step: f64| (high / step + 1e-9).floor() - (low / step - 1e-9).ceil() + 1.0;
    let mut fitting = steps.filter(|step| count(*step) <= most as f64);
    fitting.next().unwrap_or(high - low)
}

/// Powers of ten in a range, or where there is one at most also their round multiples.
fn logarithmic(low: f64, high: f64, most: usize) -> Vec<(f64, String)> {
    let powers = || (low.log10() - 1e-9).ceil() as i32..=(high.log10() + 1e-9).floor() as i32;
    let count = powers().count();
    if count >= 2 {
        let every = count.div_ceil(most.max(1));
        return powers()
            .step_by(every)
            .map(|k| (10_f64.powi(k), power(k)))
            .collect();
    }
    let around = low.log10().floor() as i32..=high.log10().floor() as i32;
    let round = around.flat_map(|k| ROUND.map(|m| (m * 10_f64.powi(k), m, k)));
    let round = round.filter(|(value, ..)| (low..=high).contains(value));
    let label = |m: f64, k: i32| match (m, k) {
        (_, -2..=2) => plain(m * 10_f64.powi(k), (-k).max(0) as usize),
        (1.0, _) => power(k),
        _ => format!("{m}·{}", power(k)),
    };
    let round: Vec<_> = round.map(|(value, m, k)| (value, label(m, k))).collect();
    let every = round.len().div_ceil(most.max(1)).max(1);
    round.into_iter().step_by(every).collect()
}

/// A number with so many digits behind the point.
fn plain(value: f64, digits: usize) -> String {
    // The sum has no negative zero.
    format!("{:.digits$}", value + 0.0).replace('-', "−")
}

/// A power of ten as it is written.
fn power(exponent: i32) -> String {
    let raised = |c: char| match c.to_digit(10) {
        Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
        None => '⁻',
    };
    match exponent {
        0 => "1".into(),
        1 => "10".into(),
        _ => format!(
            "10{}",
            exponent.to_string().chars().map(raised).collect::<String>()
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::super::colour_scale::ColourMap;
    use super::*;

    fn ticks(range: [f64; 2], unit: &str, spacing: Spacing) -> (String, Vec<String>) {
        let scale = ColourScale {
            name: "gap".into(),
            unit: unit.into(),
            range,
            is_open: [false; 2],
            spacing,
            map: ColourMap::Sequential,
        };
        let Ticks { title, labels } = Ticks::of(&scale, 5);
        let [low, high] = range;
        for (value, label) in &labels {
            let room = 1e-9 * high.abs().max(low.abs());
            assert!(
                (low - room..=high + room).contains(value),
                "{label}: {value}"
            );
        }
        (title, labels.into_iter().map(|(_, label)| label).collect())
    }

    #[test]
    fn labels_are_round_and_short() {
        use Spacing::{Linear, Logarithmic};
        for (range, unit, spacing, title, labels) in [
            ([0.0, 0.00123], "m", Linear, "gap (mm)", "0.0 0.5 1.0"),
            ([0.0, 0.00093], "m", Linear, "gap (µm)", "0 200 400 600 800"),
            ([-0.2, 0.2], "m", Linear, "gap (m)", "−0.2 −0.1 0.0 0.1 0.2"),
            ([-60.0, 60.0], "°", Linear, "gap (°)", "−50 0 50"),
            ([0.0, 2e-7], "", Linear, "gap (10⁻⁹)", "0 50 100 150 200"),
            ([3e4, 9e4], "1/m", Linear, "gap (10³ 1/m)", "40 60 80"),
            ([0.0, 4e4], "N/m", Linear, "gap (kN/m)", "0 10 20 30 40"),
            ([0.7, 0.7], "m", Linear, "gap (m)", "0.70"),
            ([0.0, 0.0], "m", Logarithmic, "gap (m)", "0.00"),
            (
                [2e-12, 3e-3],
                "",
                Logarithmic,
                "gap",
                "10⁻¹¹ 10⁻⁹ 10⁻⁷ 10⁻⁵ 10⁻³",
            ),
            ([0.5, 30.0], "", Logarithmic, "gap", "1 10"),
            (
                [3e-6, 3e-5],
                "m",
                Logarithmic,
                "gap (m)",
                "5·10⁻⁶ 10⁻⁵ 2·10⁻⁵",
            ),
            ([0.03, 0.09], "m", Logarithmic, "gap (mm)", "40 60 80"),
        ] {
            let labels: Vec<String> = labels.split(' ').map(str::to_owned).collect();
            assert_eq!(ticks(range, unit, spacing), (title.into(), labels));
        }
    }
}
