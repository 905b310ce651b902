//! The number of the steps of a run and their lengths.

use isosheet_scenes::Scene;

/// Part of a step by which the time of a run may differ from a whole number of steps, to allow for round-off.
pub(super) const ROUND_OFF: f64 = 1e-9;

/// Number of steps of a run.
pub(crate) fn step_count(scene: &Scene) -> u64 {
    let steps = (scene.stop.time / scene.method.step - ROUND_OFF).ceil();
    steps.max(1.0) as u64
}

/// Length of the last step that the time asks for, seconds.
fn last_length(scene: &Scene) -> f64 {
    scene.stop.time - (step_count(scene) - 1) as f64 * scene.method.step
}

/// Whether the last step of a run is shorter than the others.
pub(super) fn has_short_step(scene: &Scene) -> bool {
    let h = scene.method.step;
    (last_length(scene) - h).abs() > ROUND_OFF * h
}

/// Length of a step, from 1 to the number of steps: the last one is as short as the time asks for.
pub(super) fn step_length(scene: &Scene, number: u64) -> f64 {
    match number == step_count(scene) && has_short_step(scene) {
        true => last_length(scene),
        false => scene.method.step,
    }
}
