//! Supports and obstacles that move too fast for a step.

use crate::building::engine_problem::is_without_room;
use crate::meshes::selection::bounds;
use crate::running::courses::courses;
use crate::running::driven_into::driven_into;
use crate::running::under_way::UnderWay;
use crate::words::key::Key;
use crate::{Problem, Scene};
use isosheet_dynamics::StepError;
use isosheet_mesh::wording::brief;
use nalgebra::Vector3;

/// What moved.
struct Fastest {
    key: Key,
    /// The largest way of a point in the step, metres.
    way: f64,
}

impl UnderWay {
    /// What is wrong with a step of `h` seconds that failed.
    pub fn problem(&self, scene: &Scene, error: &StepError, h: f64) -> Problem {
        let of_engine = || self.facts.origins.of_failed_step(error, &self.simulation);
        let of_motions = too_fast(scene, self, error, h);
        let of_motions = of_motions.or_else(|| driven_into(scene, self, error, h));
        of_motions.unwrap_or_else(of_engine)
    }
}

/// What is wrong with a step of `h` seconds that failed while a support or an obstacle moves farther in it
/// than the sheets are large: where the sheets end, they have little to do with where they began. Nothing if
/// none does.
fn too_fast(scene: &Scene, under_way: &UnderWay, error: &StepError, h: f64) -> Option<Problem> {
    if !is_without_room(error) {
        return None;
    }
    let Fastest { key, way } = fastest(scene, under_way, h)?;
    let [low, high] = bounds(under_way.facts.sheet.positions().as_chunks::<3>().0);
    let size = (Vector3::from(high) - Vector3::from(low)).norm();
    if way <= size {
        return None;
    }
    let name = under_way.facts.origins.called(&key);
    let message = format!(
        "{name} moves by {} m in a step of {} s, at {} m/s, and the sheet is {} m across; {}",
        brief(way),
        brief(h),
        brief(way / h),
        brief(size),
        under_way.facts.origins.in_words(error)
    );
    let remedy = format!(
        "move it more slowly, below {} m/s, over several steps, or take a `method.step` below {} s",
        brief(size / h),
        brief(h * size / way)
    );
    Some(Problem::new(key, message, remedy))
}

/// What moves farthest in a step from the present state.
fn fastest(scene: &Scene, under_way: &UnderWay, h: f64) -> Option<Fastest> {
    let ways = courses(scene, under_way, h).into_iter().map(|course| {
        let ways = course.points.iter().map(|[from, to]| (to - from).norm());
        let way = ways.fold(0.0, f64::max);
        Fastest {
            key: course.key,
            way,
        }
    });
    ways.max_by(|a, b| a.way.total_cmp(&b.way))
}
