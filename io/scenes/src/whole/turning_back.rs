//! Functions of time that change faster than the steps of a run, at whose ends alone they are taken.

use crate::{
    Checks, Course, Function, InterpolationKey, Key, KeyPart, MotionKey, Moved, Poses, ProfileKey,
    Scene,
};
use isosheet_mesh::wording::brief;
use nalgebra::{Quaternion, UnitQuaternion};
use std::f64::consts::PI;

/// Part of its range that a function may turn back by within a step: that of a sine with three steps in a
/// period. With two it may look as if it did not move at all (Shannon 1949, *Communication in the presence of
/// noise*).
const TURNED_BACK: f64 = 0.25;

/// Angle by which something may turn in a step, degrees: with more than half a turn it may have turned the
/// other way.
const TURNED: f64 = 180.0;

/// Functions that are the components of one vector, or one function.
type Group = Vec<(Key, ProfileKey)>;

impl Scene {
    /// Functions of time do not turn back within a step, and nothing turns too far in one.
    pub(crate) fn check_steps_resolve(&self, checks: &mut Checks) {
        let h = self.method.step;
        if !(h.is_finite() && h > 0.0) {
            return;
        }
        let mut groups: Vec<Group> = Vec::new();
        for Function { key, profile, .. } in self.functions() {
            let function = (key, profile.clone());
            match groups.last_mut() {
                Some(group) if are_components(&group[0].0, &function.0) => group.push(function),
                _ => groups.push(vec![function]),
            }
        }
        let (mut scene, mut angles) = (self.clone(), Vec::new());
        for Moved { key, motion, .. } in scene.motions_mut() {
            groups.extend(motion.poses.as_ref().map(|poses| positions(&key, poses)));
            angles.extend(angle(&key, motion));
        }
        let until = self.stop.time;
        for group in &groups {
            if let Some((key, time, by)) = turned_back(group, h, until) {
                let message = format!(
                    "`{key}` turns back by {} within the step of {} s after t = {} s, but a step uses only the value at \
                     its end",
                    brief(by),
                    brief(h),
                    brief(time)
                );
                let fits = |h: f64| turned_back(group, h, until).is_none();
                checks.report(key.clone(), message, remedy(h, fits));
            }
        }
        for (key, angle) in &angles {
            let by = largest_change(angle, h);
            if by > TURNED {
                let message = format!(
                    "`{key}` changes by {} degrees in a step of {} s, more than half a turn",
                    brief(by),
                    brief(h)
                );
                let fits = |h: f64| largest_change(angle, h) <= TURNED;
                checks.report(key.clone(), message, remedy(h, fits));
            }
        }
    }
}

/// The remedy: the longest step that fits, found by halving, or a slower change.
fn remedy(h: f64, fits: impl Fn(f64) -> bool) -> String {
    let mut shorter = (1..=f64::MANTISSA_DIGITS as i32).map(|k| h * 0.5_f64.powi(k));
    match shorter.find(|h| fits(*h)) {
        Some(step) => format!(
            "take a `method.step` of {} s or less, or let it change more slowly",
            brief(step)
        ),
        None => "let it change more slowly".to_owned(),
    }
}

/// Whether two keys are components of one vector.
fn are_components(one: &Key, other: &Key) -> bool {
    let is_component = |key: &Key| match key.parts().last() {
        Some(KeyPart::Name(name)) => ["x", "y", "z"].contains(&name.as_str()),
        Some(KeyPart::Entry(_)) => true,
        None => false,
    };
    is_component(one) && is_component(other) && one.above() == other.above()
}

/// The positions of poses as functions.
fn positions(key: &Key, poses: &Poses) -> Group {
    let keys = key.name("poses.keys");
    let component = |k: usize| {
        let values = poses.keys.iter().map(|pose| [pose.time, pose.position[k]]);
        (keys.clone(), keyframes(values.collect()))
    };
    (0..3).map(component).collect()
}

/// The angle of a motion by time, degrees; of poses the sum of all turns, forth and back.
fn angle(key: &Key, motion: &MotionKey) -> Option<(Key, ProfileKey)> {
    let Some(poses) = &motion.poses else {
        let angle = motion.rotation.as_ref()?.angle.clone();
        return Some((key.name("rotation.angle"), angle));
    };
    let turns = poses.keys.iter().scan(None, |before, pose| {
        let [w, x, y, z] = pose.orientation;
        let here = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let (last, total) = before.unwrap_or((here, 0.0));
        let total = total + last.angle_to(&here).to_degrees();
        *before = Some((here, total));
        Some([pose.time, total])
    });
    Some((key.name("poses.keys"), keyframes(turns.collect())))
}

fn keyframes(keys: Vec<[f64; 2]>) -> ProfileKey {
    ProfileKey::Course(Course::Keyframes {
        interpolation: InterpolationKey::Linear,
        keys,
        kinks: None,
    })
}

/// Which function of a group turns back too far in a step of `h` seconds, in which step (the time at its
/// beginning), and how far.
fn turned_back(group: &[(Key, ProfileKey)], h: f64, until: f64) -> Option<(&Key, f64, f64)> {
    let width = |(_, f): &(Key, ProfileKey)| {
        let [low, high] = f.range(until);
        high - low
    };
    let range = group.iter().map(width).fold(0.0, f64::max);
    group.iter().find_map(|(key, function)| {
        let (time, by) = farthest_beyond(function, h, until)?;
        (by > TURNED_BACK * range).then_some((key, time, by))
    })
}

/// The step of `h` seconds in which a function goes farthest beyond its values at both ends, and how far.
fn farthest_beyond(function: &ProfileKey, h: f64, until: f64) -> Option<(f64, f64)> {
    match function {
        ProfileKey::Course(Course::Sine {
            amplitude,
            frequency,
            ..
        }) => {
            // With a peak in the middle of the step.
            let phase = PI * (frequency.abs() * h).min(1.0);
            Some((0.0, amplitude.abs() * (1.0 - phase.cos())))
        }
        ProfileKey::Course(Course::Keyframes { keys, .. }) => {
            let beyond = |[time, value]: &[f64; 2]| {
                let start = (time / h).floor() * h;
                let ends = [start, start + h].map(|t| function.value(t));
                let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
                (start, (value - high).max(low - value))
            };
            let used = keys.iter().filter(|[time, _]| (0.0..until).contains(time));
            used.map(beyond).max_by(|a, b| a.1.total_cmp(&b.1))
        }
        _ => None,
    }
}

/// The largest change of a function in `h` seconds; of a sine in any part of them, as it may be back.
fn largest_change(function: &ProfileKey, h: f64) -> f64 {
    let ProfileKey::Course(course) = function else {
        return 0.0;
    };
    match course {
        Course::Ramp(c) => (c.to - c.from).abs() * (h / (c.end - c.begin)).min(1.0),
        Course::SmoothStep(c) => {
            // About its middle, where it is the fastest.
            let middle = 0.5 * (c.begin + c.end);
            (function.value(middle + 0.5 * h) - function.value(middle - 0.5 * h)).abs()
        }
        Course::RunUp { rate, .. } => rate.abs() * h,
        Course::Sine {
            amplitude,
            frequency,
            ..
        } => 2.0 * amplitude.abs() * (PI * (frequency.abs() * h).min(0.5)).sin(),
        Course::Keyframes { keys, .. } => {
            let times = keys.iter().flat_map(|[t, _]| [*t, t - h]);
            let changes = times.map(|t| (function.value(t + h) - function.value(t)).abs());
            changes.fold(0.0, f64::max)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(frequency: f64) -> ProfileKey {
        ProfileKey::Course(Course::Sine {
            mean: 1.0,
            amplitude: 2.0,
            frequency,
            phase: 30.0,
        })
    }

    fn one(function: ProfileKey) -> Group {
        vec![(Key::root(), function)]
    }

    /// A sine turns back by no more than a sampled one does, and needs three steps in a period.
    #[test]
    fn sines_have_three_steps_in_a_period() {
        let h = 0.01;
        assert!(turned_back(&one(sine(33.0)), h, 1.0).is_none());
        assert!(turned_back(&one(sine(34.0)), h, 1.0).is_some());
        assert!(turned_back(&one(sine(100.0)), h, 1.0).is_some());
        // Found by sampling: the farthest beyond both ends of any interval of 0.01 s.
        let function = sine(20.0);
        let sampled = (0..5000).map(|k| {
            let start = f64::from(k) * 1e-5;
            let inside = (0..=100).map(|i| function.value(start + f64::from(i) * 1e-4));
            let ends = [start, start + h].map(|t| function.value(t));
            inside.fold(f64::MIN, f64::max) - ends[0].max(ends[1])
        });
        let sampled = sampled.fold(0.0, f64::max);
        let (_, found) = farthest_beyond(&function, h, 1.0).unwrap();
        // The samples miss the most even position of the step by up to 5e-6 s, in which the ends change by
        // 5e-4.
        assert!((sampled - found).abs() < 1e-3, "{sampled} and {found}");
    }

    /// A pulse between the ends of a step is found; noise of another component is not.
    #[test]
    fn pulses_within_a_step_are_found() {
        let pulse = |width: f64| {
            let [a, b, c] = [0.102, 0.102 + 0.5 * width, 0.102 + width];
            keyframes(vec![[0.0, 0.0], [a, 0.0], [b, 0.3], [c, 0.0]])
        };
        assert!(turned_back(&one(pulse(0.006)), 0.01, 1.0).is_some());
        assert!(turned_back(&one(pulse(0.06)), 0.01, 1.0).is_none());
        let noise = keyframes(
            (0..100)
                .map(|k| [f64::from(k) * 1e-3, f64::from(k % 2)])
                .collect(),
        );
        assert!(turned_back(&one(noise.clone()), 0.01, 1.0).is_some());
        let mut group = one(noise);
        group.push((Key::root(), keyframes(vec![[0.0, 0.0], [1.0, 9.0]])));
        assert!(turned_back(&group, 0.01, 1.0).is_none());
    }

    /// The largest change in a step is that of all intervals of its length.
    #[test]
    fn largest_changes_are_those_of_sampled_functions() {
        let change = crate::Change {
            from: 10.0,
            to: 50.0,
            begin: 0.1,
            end: 0.4,
        };
        let functions = [
            ProfileKey::Course(Course::Ramp(change.clone())),
            ProfileKey::Course(Course::SmoothStep(change)),
            sine(3.0),
            keyframes(vec![[0.0, 0.0], [0.1, 5.0], [0.15, -3.0], [0.4, 2.0]]),
        ];
        for function in functions {
            // Up to half a period of the sine.
            for h in [0.01, 0.1, 1.0 / 6.0] {
                let steps = (-10_000..10_000).map(|k| f64::from(k) * 1e-4);
                let changes = steps.map(|t| (function.value(t + h) - function.value(t)).abs());
                let sampled = changes.fold(0.0, f64::max);
                let found = largest_change(&function, h);
                assert!(
                    (sampled - found).abs() < 2e-2,
                    "{function:?}, {h}: {sampled} and {found}"
                );
            }
        }
    }
}
