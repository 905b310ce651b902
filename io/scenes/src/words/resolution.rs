//! Whether double precision resolves the shapes and the motion of a scene.

use crate::words::key::Key;
use crate::words::problem::Problem;
use isosheet_dynamics::SheetModel;
use isosheet_mesh::Sheet;
use isosheet_mesh::wording::brief;
use nalgebra::Vector3;

/// Least height of a face, as a part of its longest edge. Below the root of the round-off, 1.5e-8, the cosine
/// of the angle between two edges is one, and angles and areas of the face have no digit left.
const LEAST_HEIGHT: f64 = 1e-7;

/// Largest part of the shortest edge that the round-off of coordinates may be.
const ROUND_OFF: f64 = 1e-4;

/// Largest coordinate (metres) beside which double precision resolves an edge of a length.
pub(crate) fn reach(shortest: f64) -> f64 {
    ROUND_OFF * shortest / f64::EPSILON
}

/// The length of the shortest edge, metres.
pub(crate) fn shortest(lengths: &[f64]) -> f64 {
    lengths.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Refuses a sheet in its place whose faces are so narrow, or so far away, that their shape is lost in
/// round-off.
pub(crate) fn check_shape(sheet: &Sheet, key: &Key) -> Result<(), Problem> {
    for (f, corners) in sheet.topology().faces().iter().enumerate() {
        let [a, b, c] = corners.map(|v| Vector3::from(sheet.position(v)));
        let longest = [b - a, c - b, a - c].map(|e| e.norm());
        let longest = longest.into_iter().fold(0.0, f64::max);
        let height = ((b - a) / longest).cross(&((c - a) / longest)).norm();
        if height < LEAST_HEIGHT {
            let message = format!(
                "face {f} is {} m long and {} m high, too narrow for its angles to be computed",
                brief(longest),
                brief(height * longest)
            );
            let remedy = "give lengths that differ less, or more cells along the longer one: the height of a face has \
                          to be at least 1e-7 of its longest edge";
            return Err(Problem::new(key.clone(), message, remedy));
        }
    }
    let farthest = sheet
        .positions()
        .iter()
        .fold(0.0, |m: f64, c| m.max(c.abs()));
    let shortest = shortest(sheet.lengths());
    if farthest > reach(shortest) {
        let message = format!(
            "the sheet comes to {} m from the origin, beside which its edges of {} m are lost in round-off",
            brief(farthest),
            brief(shortest)
        );
        let remedy = "put it nearer to the origin, or make it of fewer faces";
        return Err(Problem::new(key.clone(), message, remedy));
    }
    Ok(())
}

/// Refuses positions (length 3V) that are so far away that the edges of the sheet are lost in round-off.
pub fn check_positions(model: &SheetModel, x: &[f64]) -> Result<(), Problem> {
    let farthest = x.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    let shortest = shortest(model.edges().lengths());
    if farthest <= reach(shortest) {
        return Ok(());
    }
    let message = format!(
        "the sheet is {} m away from the origin, where its edges of {} m are lost in round-off",
        brief(farthest),
        brief(shortest)
    );
    let remedy = "end the run before, or choose shorter steps";
    Err(Problem::new(Key::root().name("stop.time"), message, remedy))
}
