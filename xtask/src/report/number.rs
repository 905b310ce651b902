//! Numbers as people read them.

/// A number with three significant digits, without zeros at the end.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 {
        // The sum of no numbers is -0.
        return "0".into();
    }
    if value.fract() == 0.0 && value.abs() < 1e5 {
        return format!("{value:.0}");
    }
    if !(1e-3..1e5).contains(&value.abs()) {
        return format!("{value:.1e}");
    }
    let digits = (2 - value.abs().log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// The smallest and the largest of some values; nothing of none.
pub(crate) fn extremes(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let pairs = values.map(|v| [v; 2]);
    pairs.reduce(|[low, high], [a, b]| [low.min(a), high.max(b)])
}

/// The median of some values; nothing of none.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    (n > 0).then(|| 0.5 * (values[(n - 1) / 2] + values[n / 2]))
}

/// Exponent `p` of the least-squares fit `y ~ x^p`; `None` from fewer than two different `x`.
pub(crate) fn exponent(points: &[[f64; 2]]) -> Option<f64> {
    let n = points.len() as f64;
    let mean = |k: usize| points.iter().map(|p| p[k].ln()).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let (mut above, mut below) = (0.0, 0.0);
    for p in points {
        above += (p[0].ln() - x) * (p[1].ln() - y);
        below += (p[0].ln() - x).powi(2);
    }
    let slope = above / below;
    (below > 0.0 && slope.is_finite()).then_some(slope)
}

/// A message with its long numbers rounded to three digits.
pub(crate) fn rounded(text: &str) -> String {
    let word = |w: &str| {
        let number = w
            .trim_start_matches('(')
            .trim_end_matches([',', ':', ';', ')']);
        match number.parse::<f64>() {
            Ok(value) if number.len() > 7 => {
                let short = if (1e-3..1e6).contains(&value.abs()) {
                    let digits = (2 - value.abs().log10().floor() as i32).max(0) as usize;
                    format!("{value:.digits$}")
                } else {
                    format!("{value:.2e}")
                };
                w.replace(number, &short)
            }
            _ => w.to_owned(),
        }
    };
    text.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (15.0, "15"),
            (0.13294, "0.133"),
            (22.512, "22.5"),
            (1234.5, "1234"),
            (123_456.0, "1.2e5"),
            (4.2e-7, "4.2e-7"),
            (-0.5, "-0.5"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn extremes_of_values() {
        assert_eq!(extremes([2.0, -1.0, 5.0].into_iter()), Some([-1.0, 5.0]));
        assert_eq!(extremes(std::iter::empty()), None);
    }

    #[test]
    fn medians_of_values() {
        assert_eq!(median(vec![5.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0]), Some(2.5));
        assert_eq!(median(Vec::new()), None);
    }

    #[test]
    fn exponents_of_powers() {
        let points = [1.0, 3.0, 10.0, 40.0].map(|x: f64| [x, 7.0 * x.powf(1.5)]);
        assert!((exponent(&points).expect("four sizes") - 1.5).abs() < 1e-12);
        assert_eq!(exponent(&points[..1]), None);
        assert_eq!(exponent(&[[1.0, 2.0], [1.0, 3.0]]), None);
    }

    #[test]
    fn long_numbers_in_messages_are_rounded() {
        assert_eq!(
            rounded(
                "at t = 0.010229167034529732 s no step above 1e-6 s (it is 3.636331564792661e-6 J): 25/32, 1234.56789"
            ),
            "at t = 0.0102 s no step above 1e-6 s (it is 3.64e-6 J): 25/32, 1235"
        );
    }
}
