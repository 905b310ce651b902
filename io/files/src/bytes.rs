//! Numbers of bytes in words.

use isosheet_mesh::wording::brief;

/// A number of bytes with three digits, as in `1.25 GB`.
pub fn bytes_in_words(bytes: f64) -> String {
    let units = [("PB", 1e15), ("TB", 1e12), ("GB", 1e9), ("MB", 1e6)];
    let fitting = units.into_iter().find(|(_, size)| bytes >= *size);
    let (unit, size) = fitting.unwrap_or(("kB", 1e3));
    format!("{} {unit}", brief(bytes / size))
}
