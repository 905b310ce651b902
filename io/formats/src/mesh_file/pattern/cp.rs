//! Crease patterns of ORIPA and Oriedita as text (`.cp`): a line `kind x1 y1 x2 y2` for each line of the
//! drawing.

use super::Segment;
use crate::mesh_file::EdgeAssignment;
use isosheet_files::DataError;

/// What a line of one of the kinds of these programs is meant to do: 1 the outline, 2 a mountain, 3 a valley,
/// 4 and 0 auxiliary lines, which stay flat.
pub(super) fn assignment(kind: &str) -> Option<EdgeAssignment> {
    Some(match kind {
        "1" => EdgeAssignment::Boundary,
        "2" => EdgeAssignment::Mountain,
        "3" => EdgeAssignment::Valley,
        "0" | "4" => EdgeAssignment::Flat,
        _ => return None,
    })
}

/// The lines of the drawing, in which y points downwards, with the numbers of their lines in the text for
/// errors.
pub(crate) fn parse(bytes: &[u8]) -> Result<Vec<Segment>, (usize, DataError)> {
    let text = String::from_utf8_lossy(bytes);
    let mut segments = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let words: Vec<&str> = line.split_whitespace().collect();
        if words.is_empty() || words[0].starts_with('#') {
            continue;
        }
        let segment = segment(&words).ok_or_else(|| {
            let found: String = line.trim().chars().take(40).collect();
            let message = format!("{found:?} is no line of a crease pattern");
            let remedy = "write `kind x1 y1 x2 y2` with a kind of 1 (outline), 2 (mountain), 3 (valley) or 4 (auxiliary)";
            (number, DataError::new(message, remedy).at(number))
        })?;
        segments.push(segment);
    }
    Ok(segments)
}

fn segment(words: &[&str]) -> Option<Segment> {
    let [kind, coordinates @ ..] = words else {
        return None;
    };
    let numbers: Vec<f64> = coordinates
        .iter()
        .map(|word| word.parse().ok().filter(|c: &f64| c.is_finite()))
        .collect::<Option<_>>()?;
    let [x1, y1, x2, y2] = numbers[..] else {
        return None;
    };
    Some(Segment {
        ends: [[x1, -y1], [x2, -y2]],
        assignment: assignment(kind)?,
        angle: None,
        drawn: None,
    })
}
