//! Figures by number, and ranges of them, such as `1-9`.

use std::ops::RangeInclusive;

/// First and last figure that can be made. Fig. 10 of the paper is a table; the paper ends at [`PAPER`].
const BUILT: [u8; 2] = [1, 17];

/// The last figure of the paper. What follows are applications that it names without showing them.
pub(crate) const PAPER: u8 = 15;

/// Every figure that can be made.
pub(crate) fn all() -> RangeInclusive<u8> {
    BUILT[0]..=BUILT[1]
}

/// The number of a figure that can be made.
fn figure(text: &str) -> Result<u8, String> {
    // The parser of the standard library also takes a plus sign.
    let is_number = text.bytes().all(|b| b.is_ascii_digit());
    let number = text.parse::<u64>().ok().filter(|_| is_number);
    let number = number.ok_or_else(|| {
        format!("'{text}' is neither a figure nor a range; give figures such as 3 or 1-9,11")
    })?;
    let [first, last] = BUILT;
    let known = u8::try_from(number).ok().filter(|f| all().contains(f));
    known.ok_or_else(|| format!("there is no figure {number}; known figures are {first} to {last}"))
}

/// A figure or a range of figures.
///
/// # Errors
/// What cannot be understood, in words.
pub(crate) fn parse(text: &str) -> Result<RangeInclusive<u8>, String> {
    let (from, to) = match text.trim().split_once('-') {
        Some((from, to)) if !from.is_empty() && !to.is_empty() => (from, to),
        _ => (text, text),
    };
    let [from, to] = [figure(from.trim())?, figure(to.trim())?];
    if to < from {
        return Err(format!(
            "the range {from}-{to} runs backwards; write {to}-{from}"
        ));
    }
    Ok(from..=to)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_and_ranges() {
        for (text, range) in [
            ("3", 3..=3),
            (" 1-3", 1..=3),
            ("1-17", 1..=17),
            ("7-7", 7..=7),
        ] {
            assert_eq!(parse(text), Ok(range));
        }
    }

    #[test]
    fn what_makes_no_sense_is_named() {
        for (text, word) in [
            (" ", "'' is neither"),
            ("1-x", "'x' is neither"),
            ("-3", "'-3' is neither"),
            ("+3", "neither"),
            ("1-+3", "neither"),
            ("+1-3", "neither"),
            ("0", "no figure 0"),
            ("99", "no figure 99"),
            ("300", "no figure 300"),
            ("1-18", "no figure 18"),
            ("9-1", "write 1-9"),
            // A range is refused by its ends, not walked through.
            ("1-18446744073709551615", "no figure 18446744073709551615"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(word), "{text}: {error}");
        }
    }
}
