//! Until when something prescribed changes.

use isosheet_scenes::{Course, Function, Moved, ProfileKey, Scene};

/// Until when the functions of time and the poses of a scene change, seconds, or zero. Sines, which have no
/// end, do not count.
pub(super) fn last_change(scene: &Scene) -> f64 {
    let mut scene = scene.clone();
    let folded = scene.folding.iter().map(|folding| folding.time);
    let mut last = folded.fold(0.0, f64::max);
    for Function { profile, .. } in scene.functions() {
        last = last.max(end(profile));
    }
    for Moved { motion, .. } in scene.motions_mut() {
        let poses = motion.poses.iter().flat_map(|poses| &poses.keys);
        last = poses.map(|key| key.time).fold(last, f64::max);
    }
    last
}

/// When a function has come to its end, seconds; zero for one that has none.
fn end(function: &ProfileKey) -> f64 {
    let ProfileKey::Course(course) = function else {
        return 0.0;
    };
    match course {
        Course::Ramp(change) | Course::SmoothStep(change) => change.end,
        Course::RunUp { end, .. } => *end,
        Course::Sine { .. } => 0.0,
        Course::Keyframes { keys, .. } => keys.last().map_or(0.0, |key| key[0]),
    }
}
