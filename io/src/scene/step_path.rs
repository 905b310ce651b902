//! How far a step of a scene takes its sheet.

use super::Scene;
use super::key::Key;
use super::problem::Problem;
use super::resolution::{reach, shortest};
use isosheet_dynamics::SheetModel;
use isosheet_mesh::wording::{brief, given};
use nalgebra::Vector3;

/// Refuses steps in which inertia alone takes the sheet so far that its edges are lost in round-off.
pub(super) fn check_step(scene: &Scene, model: &SheetModel, v: &[f64]) -> Result<(), Problem> {
    let speeds = v.as_chunks::<3>().0.iter();
    let speed = speeds.map(|v| Vector3::from(*v).norm()).fold(0.0, f64::max);
    let forces = &scene.forces;
    let largest = |range: [f64; 2]| range[0].abs().max(range[1].abs());
    let gravity = forces.gravity.map_or(0.0, |g| Vector3::from(g).norm());
    let fields = forces.acceleration.iter();
    let fields: f64 = fields.map(|f| largest(f.size.range(scene.stop.time))).sum();
    let h = scene.method.step;
    let path = h * speed + h * h * (gravity + fields);
    let shortest = shortest(model.edges().lengths());
    if path <= reach(shortest) {
        return Ok(());
    }
    let message = format!(
        "in a step of {} s inertia alone takes the sheet {} m away, where its edges of {} m are lost in round-off",
        given(h),
        brief(path),
        brief(shortest)
    );
    let key = Key::root().name("method.step");
    Err(Problem::new(key, message, "choose a shorter step"))
}
