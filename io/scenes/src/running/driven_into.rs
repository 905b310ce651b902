//! Supports that are driven into obstacles.

use crate::building::engine_problem::is_without_room;
use crate::running::courses::courses;
use crate::running::under_way::UnderWay;
use crate::{Key, Problem, Scene};
use isosheet_dynamics::StepError;
use isosheet_mesh::wording::brief;

/// What is wrong with a step of `h` seconds that failed and at whose end a vertex of a support that moves is
/// to be inside an obstacle: it cannot give way. Nothing if none is.
pub(crate) fn driven_into(
    scene: &Scene,
    under_way: &UnderWay,
    error: &StepError,
    h: f64,
) -> Option<Problem> {
    if !is_without_room(error) {
        return None;
    }
    let facts = &under_way.facts;
    let end = under_way.simulation.state().t + h;
    // Contact keeps a gap, so that a vertex on the surface is inside as well.
    let half_thickness = 0.5 * scene.largest_thickness();
    let mut deepest: Option<(Key, usize, f64)> = None;
    for course in courses(scene, under_way, h) {
        for [from, to] in &course.points {
            for (k, obstacle) in facts.obstacles.iter().enumerate() {
                let depth = half_thickness - obstacle.signed_distance(end, &to.coords).value;
                let deeper = deepest
                    .as_ref()
                    .map_or(depth >= 0.0, |(.., least)| depth > *least);
                // The origin of an obstacle that moves is inside of it, and always was.
                let was_outside = obstacle.signed_distance(end - h, &from.coords).value > 0.0;
                if deeper && was_outside {
                    deepest = Some((course.key.clone(), k, depth));
                }
            }
        }
    }
    let (key, obstacle, depth) = deepest?;
    let message = format!(
        "{} is driven into `{}`: at {} s, the end of the step, one of its vertices is to be {} m inside, thickness taken off; {}",
        facts.origins.called(&key),
        facts.origins.obstacle_called(obstacle),
        brief(end),
        brief(depth),
        facts.origins.in_words(error)
    );
    let remedy = "end its motion before that, or let the obstacle give way: what is held cannot";
    Some(Problem::new(key, message, remedy))
}
