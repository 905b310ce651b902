//! Cells of tables that spreadsheets open.

use std::borrow::Cow;

/// A cell that no spreadsheet takes for a formula: a text that begins like one gets an apostrophe before it,
/// which spreadsheets do not show. Numbers stay as they are.
pub fn cell(text: &str) -> Cow<'_, str> {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']);
    match is_formula && text.parse::<f64>().is_err() {
        true => Cow::Owned(format!("'{text}")),
        false => Cow::Borrowed(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_become_texts_and_numbers_stay() {
        for text in ["=1+1", "+cmd", "-2+3", "@SUM(A1)", "\t=1", "\r=1"] {
            assert_eq!(cell(text), format!("'{text}"));
        }
        for text in ["-1.5e-3", "+2", "plain", "a=b", ""] {
            assert_eq!(cell(text), text);
        }
    }
}
