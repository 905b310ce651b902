//! Lists of figures, such as `1-9,11`.

use std::collections::BTreeSet;

/// First and last figure that can be made. Fig. 10 of the paper is a table; the paper ends at [`PAPER`].
const BUILT: [u8; 2] = [1, 17];

/// The last figure of the paper. What follows are applications that it names without showing them.
pub(crate) const PAPER: u8 = 15;

/// Every figure that can be made.
pub(crate) fn all() -> impl Iterator<Item = u8> {
    BUILT[0]..=BUILT[1]
}

/// The figures of a list, in ascending order.
///
/// # Errors
/// What cannot be understood, in words.
pub(crate) fn parse(list: &str) -> Result<BTreeSet<u8>, String> {
    const HELP: &str = "give figures such as 3 or 1-9,11";
    if list.trim().is_empty() {
        return Err(format!("the list is empty; {HELP}"));
    }
    let figure = |text: &str| {
        // The parser of the standard library also takes a plus sign.
        let is_number = text.bytes().all(|b| b.is_ascii_digit());
        let number = text.parse::<u64>().ok().filter(|_| is_number);
        let number =
            number.ok_or_else(|| format!("'{text}' is neither a figure nor a range; {HELP}"))?;
        let [first, last] = BUILT;
        u8::try_from(number)
            .ok()
            .filter(|f| (first..=last).contains(f))
            .ok_or_else(|| {
                format!("there is no figure {number}; known figures are {first} to {last}")
            })
    };
    let mut set = BTreeSet::new();
    for part in list.split(',').map(str::trim) {
        match part.split_once('-') {
            Some((from, to)) if !from.is_empty() && !to.is_empty() => {
                let (from, to) = (figure(from.trim())?, figure(to.trim())?);
                if to < from {
                    return Err(format!(
                        "the range {from}-{to} runs backwards; write {to}-{from}"
                    ));
                }
                set.extend(from..=to);
            }
            _ => {
                set.insert(figure(part)?);
            }
        }
    }
    Ok(set)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_lists() {
        let parse = |list| parse(list).map(|set| set.into_iter().collect::<Vec<u8>>());
        assert_eq!(parse("3"), Ok(vec![3]));
        assert_eq!(parse("11, 1-3,2"), Ok(vec![1, 2, 3, 11]));
        assert_eq!(parse("1-17"), Ok((1..=17).collect()));
        assert_eq!(parse("7-7"), Ok(vec![7]));
    }

    #[test]
    fn what_makes_no_sense_is_named() {
        for (list, word) in [
            (" ", "empty"),
            ("1,,2", "'' is neither"),
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
            let error = parse(list).unwrap_err();
            assert!(error.contains(word), "{list}: {error}");
        }
    }
}
