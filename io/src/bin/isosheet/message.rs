//! Text for people.

pub(crate) use isosheet_io::mesh::wording::counted;
use std::io::Write;

/// Writes a line to standard error. Nothing happens where nobody reads it any more, as behind `2>&1 | head`:
/// the work goes on.
pub(crate) fn print_message(text: std::fmt::Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{text}");
}
