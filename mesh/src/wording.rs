//! Numbers and lists in messages.

use crate::VertexId;
use std::fmt;

/// Shows a number with three significant digits, and with an exponent where it would be long without one:
/// `0.0167`, `1.02e-6`, `-12300`. For values that were computed, whose further digits say nothing.
pub fn brief(value: f64) -> impl fmt::Display {
    let rounded = format!("{value:.2e}").parse().ok();
    // The largest numbers would be rounded beyond the range of f64.
    given(rounded.filter(|r: &f64| r.is_finite()).unwrap_or(value))
}

/// Shows a number with all its digits, and with an exponent where it would be long without one: `0.25`,
/// `1e-300`. For values that somebody wrote, who wants to find them again.
pub fn given(value: f64) -> impl fmt::Display {
    Given(value)
}

struct Given(f64);

impl fmt::Display for Given {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        match value.abs() {
            0.0 => f.write_str("0"),
            // Five digits before the point and two zeros behind it are read at a glance.
            size if !size.is_finite() || (1e-3..1e5).contains(&size) => {
                write!(f, "{value}")
            }
            _ => write!(f, "{value:e}"),
        }
    }
}

/// Shows a place, metres: `(0.1, 0.0167, -1.02e-6) m`.
pub fn place(point: &[f64; 3]) -> impl fmt::Display {
    let [x, y, z] = point.map(brief);
    format!("({x}, {y}, {z}) m")
}

/// Shows a name in quotes, of a long one its beginning and how long it is.
pub fn quoted(name: &str) -> String {
    /// As much as a line of text takes.
    const SHOWN: usize = 80;
    match name.char_indices().nth(SHOWN) {
        None => format!("{name:?}"),
        Some((end, _)) => {
            let (shown, all) = (&name[..end], name.chars().count());
            format!("{shown:?}... ({all} characters)")
        }
    }
}

/// A number of things: `1 step`, `2 steps`.
pub fn counted(count: usize, one: &str, more: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { more })
}

/// The first of some vertices by name, and the number of the others.
pub fn listed(vertices: &[VertexId]) -> String {
    /// As many as a line of text takes.
    const NAMED: usize = 5;
    let named: Vec<String> = vertices.iter().take(NAMED).map(|v| v.to_string()).collect();
    match vertices.len().saturating_sub(NAMED) {
        0 => named.join(", "),
        more => format!(
            "{} and {}",
            named.join(", "),
            counted(more, "other", "others")
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_shown_by_their_beginning() {
        assert_eq!(quoted("Flügel"), "\"Flügel\"");
        assert_eq!(quoted("a\u{2028}b"), "\"a\\u{2028}b\"");
        let expected = format!("\"{}\"... (100000 characters)", "ü".repeat(80));
        assert_eq!(quoted(&"ü".repeat(100_000)), expected);
        assert_eq!(quoted(&"ü".repeat(80)), format!("{:?}", "ü".repeat(80)));
    }

    #[test]
    fn numbers_are_short_and_keep_three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (-1.0, "-1"),
            (1.0 / 60.0, "0.0167"),
            (12_345.678, "12300"),
            (99_960.0, "1e5"),
            (-0.001_017_252, "-0.00102"),
            (0.000_001_017_252_604_166_7, "1.02e-6"),
            (4.94e-310, "4.94e-310"),
            (1e300, "1e300"),
            (f64::MAX, "1.7976931348623157e308"),
            (1.7949e308, "1.79e308"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(brief(value).to_string(), text);
        }
        assert_eq!(given(0.016_666_6).to_string(), "0.0166666");
        assert_eq!(given(-1e-300).to_string(), "-1e-300");
    }

    #[test]
    fn one_thing_is_no_plural() {
        assert_eq!(counted(1, "step", "steps"), "1 step");
        assert_eq!(counted(0, "step", "steps"), "0 steps");
    }
}
