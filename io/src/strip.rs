//! The strip between two curves, as `isosheet mesh --strip-to` makes it.

use super::failure::{Code, Failure};
use isosheet_files::FileError;
use isosheet_formats::read_curve;
use isosheet_mesh::generate::{GenerateError, RuledStrip, strip_between};
use std::path::Path;

/// The strip between the curves of two files whose unit is so many metres long.
pub(super) fn strip(
    files: [&Path; 2],
    metres: f64,
    [columns, rows]: [usize; 2],
) -> Result<RuledStrip, Failure> {
    let points = files.map(|path| {
        let points = read_curve(path).map_err(|e: FileError| Failure::of(Code::Input, &e))?;
        Ok(points.into_iter().map(|p| p.map(|c| metres * c)).collect())
    });
    let [first, second]: [Result<Vec<[f64; 3]>, Failure>; 2] = points;
    strip_between(&first?, &second?, columns, rows).map_err(|error| {
        let code = match error {
            GenerateError::Count { .. } | GenerateError::TooManyFaces { .. } => Code::CommandLine,
            _ => Code::Input,
        };
        Failure::of(code, &error)
    })
}

/// Twists below are round-off of curves through points, radians: a degree.
const DEVELOPABLE: f64 = std::f64::consts::PI / 180.0;

/// What came of it, in words.
pub(super) fn verdict(strip: &RuledStrip) -> String {
    let degrees = format!("{:.2}", strip.twist.to_degrees());
    match strip.twist <= DEVELOPABLE {
        true => format!(
            "developable: along each ruling the sheet has one tangent plane, to {degrees} degrees"
        ),
        false => format!(
            "not developable: along a ruling the tangent plane turns by up to {degrees} degrees, and the sum of the \
             squares of these angles is the least that was found"
        ),
    }
}
