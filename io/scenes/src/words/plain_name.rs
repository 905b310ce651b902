//! Names that stand in tables.

use crate::words::key::Key;
use crate::words::problem::Checks;

/// Refuses a name that tables cannot have.
pub(crate) fn check_name(name: &str, key: Key, of: &str, checks: &mut Checks) {
    let is_usual = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    // Spreadsheets take a name that begins with a minus for a formula.
    let is_text = name.starts_with(|c| is_usual(c) && c != '-');
    if !is_text || !name.chars().all(is_usual) {
        checks.report(
            key,
            format!("`{name}` cannot be the name of {of}"),
            "use letters, digits, `_` and `-`, which is not the first",
        );
    }
}
