//! Text for people.

use std::io::Write;

/// A number of things: `1 frame`, `2 frames`.
pub(crate) fn counted(count: usize, one: &str, more: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { more })
}

/// Writes a line to standard error. Nothing happens where nobody reads it any more, as behind `2>&1 | head`:
/// the work goes on.
pub(crate) fn print_message(text: std::fmt::Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{text}");
}
