//! Lists of figures, such as `1-9,11`.

use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;

/// First and last figure that can be made. Fig. 10 of the paper is a table; the paper ends at [`PAPER`].
const BUILT: [u8; 2] = [1, 17];

/// The last figure of the paper. What follows are applications that it names without showing them.
pub(crate) const PAPER: u8 = 15;

/// A set of figures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Selection(BTreeSet<u8>);

/// Why a list of figures cannot be understood.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum SelectionError {
    #[error("the list is empty; give figures such as 3 or 1-9,11")]
    Empty,
    #[error("'{0}' is neither a figure nor a range; give figures such as 3 or 1-9,11")]
    NotANumber(String),
    #[error("there is no figure {0}; known figures are 1 to 17")]
    Unknown(u64),
    #[error("the range {0}-{1} runs backwards; write {1}-{0}")]
    Backwards(u64, u64),
}

impl Selection {
    /// Every figure that can be made.
    pub(crate) fn all() -> Self {
        Self((BUILT[0]..=BUILT[1]).collect())
    }

    /// The figures in ascending order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = u8> + '_ {
        self.0.iter().copied()
    }
}

fn number(text: &str) -> Result<u64, SelectionError> {
    let wrong = || SelectionError::NotANumber(text.to_owned());
    // The parser of the standard library also takes a plus sign.
    if !text.bytes().all(|b| b.is_ascii_digit()) {
        return Err(wrong());
    }
    text.parse().map_err(|_| wrong())
}

fn known(figure: u64) -> Result<u8, SelectionError> {
    match u8::try_from(figure) {
        Ok(f) if (BUILT[0]..=BUILT[1]).contains(&f) => Ok(f),
        _ => Err(SelectionError::Unknown(figure)),
    }
}

impl FromStr for Selection {
    type Err = SelectionError;

    fn from_str(list: &str) -> Result<Self, SelectionError> {
        if list.trim().is_empty() {
            return Err(SelectionError::Empty);
        }
        let mut set = BTreeSet::new();
        for part in list.split(',').map(str::trim) {
            match part.split_once('-') {
                Some((from, to)) if !from.is_empty() && !to.is_empty() => {
                    let (from, to) = (number(from.trim())?, number(to.trim())?);
                    if to < from {
                        return Err(SelectionError::Backwards(from, to));
                    }
                    set.insert(known(from)?);
                    for figure in from..=u64::from(known(to)?) {
                        set.insert(known(figure)?);
                    }
                }
                _ => {
                    set.insert(known(number(part)?)?);
                }
            }
        }
        Ok(Self(set))
    }
}

impl fmt::Display for Selection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        let mut rest = self.iter().peekable();
        while let Some(first) = rest.next() {
            let mut last = first;
            while rest.peek() == Some(&(last + 1)) {
                last += 1;
                rest.next();
            }
            match last - first {
                0 => write!(f, "{separator}{first}")?,
                1 => write!(f, "{separator}{first},{last}")?,
                _ => write!(f, "{separator}{first}-{last}")?,
            }
            separator = ",";
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(list: &str) -> Result<Vec<u8>, SelectionError> {
        list.parse::<Selection>().map(|s| s.iter().collect())
    }

    #[test]
    fn ranges_and_lists() {
        assert_eq!(parse("3"), Ok(vec![3]));
        assert_eq!(parse("11, 1-3,2"), Ok(vec![1, 2, 3, 11]));
        assert_eq!(parse("1-17"), Ok((1..=17).collect()));
        assert_eq!(parse("7-7"), Ok(vec![7]));
    }

    #[test]
    fn what_makes_no_sense_is_named() {
        assert_eq!(parse(" "), Err(SelectionError::Empty));
        assert_eq!(
            parse("1,,2"),
            Err(SelectionError::NotANumber(String::new()))
        );
        assert_eq!(parse("1-x"), Err(SelectionError::NotANumber("x".into())));
        assert_eq!(parse("-3"), Err(SelectionError::NotANumber("-3".into())));
        for list in ["+3", "1-+3", "+1-3"] {
            assert!(matches!(parse(list), Err(SelectionError::NotANumber(_))));
        }
        assert_eq!(parse("0"), Err(SelectionError::Unknown(0)));
        assert_eq!(parse("99"), Err(SelectionError::Unknown(99)));
        assert_eq!(parse("300"), Err(SelectionError::Unknown(300)));
        assert_eq!(parse("1-18"), Err(SelectionError::Unknown(18)));
        assert_eq!(parse("9-1"), Err(SelectionError::Backwards(9, 1)));
        // A range is refused by its ends, not walked through.
        assert_eq!(
            parse("1-18446744073709551615"),
            Err(SelectionError::Unknown(u64::MAX))
        );
    }

    #[test]
    fn written_as_read() {
        for list in ["1-17", "1,2,4-6,9", "11"] {
            assert_eq!(
                list.parse::<Selection>().map(|s| s.to_string()).as_deref(),
                Ok(list)
            );
        }
    }
}
