//! Obstacles that would jump where a scene changes.

use crate::building::setup::Facts;
use crate::words::key::Key;
use crate::{Problem, Scene};
use isosheet_mesh::wording::brief;

/// Part of its distance from the origin, or a metre, by which a place differs by round-off from where another
/// function of time led to. Angles of rotations are found from their cosines, to the root of that.
const ROUND_OFF: f64 = 1e-12;

/// What is wrong with a change of a scene at time `t` (seconds) that leaves the obstacles in number: each
/// keeps its shape, and goes on from where it is, since nothing on the way of a jump would be met. (A change
/// that adds or removes obstacles makes new ones, which have to be clear of the sheet.)
pub(crate) fn jumps(before: (&Scene, &Facts), after: (&Scene, &Facts), t: f64) -> Vec<Problem> {
    let ((before, old), (after, new_facts)) = (before, after);
    if before.obstacle.len() != after.obstacle.len() {
        return Vec::new();
    }
    let key = |k: usize| Key::root().name("obstacle").entry(k);
    let pairs = before.obstacle.iter().zip(&after.obstacle).enumerate();
    let reshaped = pairs.filter(|(_, (old, new))| old.shape != new.shape);
    let mut problems: Vec<Problem> = reshaped
        .map(|(k, _)| {
            let message = format!("`{}` would have another shape at once", key(k));
            let advice = "let it move as a sequence or a surface does, or begin a new simulation";
            Problem::new(key(k).name("shape"), message, advice)
        })
        .collect();
    let pairs = old.obstacles.iter().zip(&new_facts.obstacles).enumerate();
    problems.extend(pairs.filter_map(|(k, (old, new))| {
        let [from, to] = [old, new].map(|obstacle| obstacle.motion().pose(t));
        let way = (to.translation.vector - from.translation.vector).norm();
        let angle = from.rotation.angle_to(&to.rotation);
        let size = 1.0 + from.translation.vector.norm();
        if way <= ROUND_OFF * size && angle <= ROUND_OFF.sqrt() {
            return None;
        }
        let key = key(new_facts.origins.obstacle_number(k));
        let message = format!(
            "`{key}` would jump by {} m and {} degrees, past all that is on the way",
            brief(way),
            brief(angle.to_degrees())
        );
        let advice = "let it go there in time: `drive` its `motion`, or change that to one that goes on from here";
        Some(Problem::new(key, message, advice))
    }));
    problems
}
