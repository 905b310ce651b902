//! What a program changed between the steps of a run that it recorded.

use super::RunError;
use super::intervention::{Intervention, note};
use isosheet_scenes::{
    Course, InterpolationKey, Key, KeyPart, MotionKey, Moved, ProfileKey, Scene, SceneFile,
};
use toml::Value;

/// What was changed in the course of a run.
#[derive(Clone, Debug, Default)]
pub(super) struct Control {
    /// Functions of time that were replaced, in the order of time.
    courses: Vec<NewCourse>,
    /// Rigid motions that were replaced, as a whole, in the order of time.
    motions: Vec<NewMotion>,
}

/// A rigid motion that replaced another one.
#[derive(Clone, Debug)]
struct NewMotion {
    begin: f64,
    key: Key,
    motion: MotionKey,
}

/// A function of time that replaced another one.
#[derive(Clone, Debug)]
struct NewCourse {
    begin: f64,
    key: Key,
    profile: ProfileKey,
}

/// The gases of a scene by their names, of which each is measured.
fn gases(scene: &Scene) -> impl Iterator<Item = Option<&String>> {
    scene.forces.gas.iter().map(|gas| gas.name.as_ref())
}

impl Control {
    /// Takes in that a scene is another one from a time on, and notes what has changed.
    ///
    /// # Errors
    /// [`RunError::NotRecordable`] for changes after which the files of the run would have other columns;
    /// then nothing is noted.
    pub(super) fn change(
        &mut self,
        before: &Scene,
        after: &Scene,
        t: f64,
        done: &mut Vec<Intervention>,
    ) -> Result<(), RunError> {
        let changed = [
            ("support", before.support.len() == after.support.len()),
            ("obstacle", before.obstacle.len() == after.obstacle.len()),
            ("body", before.body.len() == after.body.len()),
            ("measure", before.measure == after.measure),
            ("forces.gas", gases(before).eq(gases(after))),
        ];
        if let Some((key, _)) = changed.into_iter().find(|(_, same)| !same) {
            return Err(RunError::NotRecordable { key: key.into() });
        }
        let (mut patched, mut after) = (before.clone(), after.clone());
        let moved = patched.motions_mut().into_iter().zip(after.motions_mut());
        for (known, Moved { key, motion, .. }) in moved.filter(|(a, b)| a.key == b.key) {
            if known.motion == motion {
                continue;
            }
            self.motions.push(NewMotion {
                begin: t,
                key: key.clone(),
                motion: motion.clone(),
            });
            if known.motion.poses != motion.poses {
                note(done, &key.to_string(), t, true);
                *known.motion = motion.clone();
            }
        }
        for (key, profile) in after.functions_mut() {
            let mut functions = patched.functions_mut();
            let known = functions.iter_mut().find(|(known, _)| *known == key);
            let Some((_, known)) = known.filter(|(_, known)| **known != *profile) else {
                continue;
            };
            **known = profile.clone();
            note(done, &key.to_string(), t, true);
            self.courses.push(NewCourse {
                begin: t,
                key,
                profile: profile.clone(),
            });
        }
        if patched == after {
            return Ok(());
        }
        let mut keys = Vec::new();
        if let (Ok(before), Ok(after)) = (Value::try_from(&patched), Value::try_from(&after)) {
            differing(&before, &after, Key::root(), &mut keys);
        }
        for key in keys {
            note(done, &key.to_string(), t, false);
        }
        Ok(())
    }

    /// Whether no function of time was replaced.
    pub(super) fn is_empty(&self) -> bool {
        self.courses.is_empty() && self.motions.is_empty()
    }

    /// The scene that a run began with, with the functions of time as they went at these times, and with this
    /// time to stop.
    pub(super) fn scene(&self, begun: &SceneFile, times: &[f64], stop: f64) -> Option<SceneFile> {
        let mut scene = begun.scene().clone();
        let mut keys = Vec::new();
        for (key, function) in scene.functions_mut() {
            let courses = self.courses.iter().filter(|course| course.key == key);
            let courses: Vec<&NewCourse> = courses.collect();
            if courses.is_empty() {
                continue;
            }
            // What replaces another function at a time acts in the steps after it.
            let value = |t: f64| {
                let last = courses.iter().rev().find(|course| course.begin < t);
                last.map_or(&*function, |course| &course.profile).value(t)
            };
            let all = std::iter::once(0.0).chain(times.iter().copied().filter(|t| *t > 0.0));
            let pieces = courses
                .iter()
                .map(|course| (course.begin, course.profile.breaks()));
            *function = ProfileKey::Course(Course::Keyframes {
                interpolation: InterpolationKey::Linear,
                keys: without_rests(all.map(|t| [t, value(t)]).collect(), |a, b| a[1] == b[1]),
                kinks: Some(kinks(function.breaks(), pieces)),
            });
            keys.push(key);
        }
        for Moved { key, motion, .. } in scene.motions_mut() {
            let new = self.motions.iter().filter(|new| new.key == key);
            let new: Vec<&NewMotion> = new.collect();
            let Some(poses) = new.iter().find_map(|new| new.motion.poses.as_ref()) else {
                continue;
            };
            let frame = poses.frame();
            let at = |t: f64| {
                let last = new.iter().rev().find(|new| new.begin < t);
                last.map_or(&*motion, |new| &new.motion)
            };
            let all = std::iter::once(0.0).chain(times.iter().copied().filter(|t| *t > 0.0));
            let keys_of = all.map(|t| at(t).pose_of(frame, t)).collect();
            let keys_of = without_rests(keys_of, |a, b| a.is_as(b));
            let pieces = new.iter().map(|new| (new.begin, new.motion.breaks()));
            let kinks = kinks(motion.breaks(), pieces);
            *motion = MotionKey::through(frame, keys_of);
            if let Some(poses) = &mut motion.poses {
                poses.kinks = Some(kinks);
            }
            keys.push(key);
        }
        if scene.stop.time != stop {
            scene.stop.time = stop;
            keys.push(Key::root().name("stop.time"));
        }
        begun.changed(scene, keys).ok()
    }
}

/// When what went in turn as several functions changed abruptly: the first one from the beginning, and each
/// that replaced another one from its time on.
fn kinks(first: Vec<f64>, further: impl Iterator<Item = (f64, Vec<f64>)>) -> Vec<f64> {
    let mut all = first;
    for (begin, breaks) in further {
        all.retain(|t| *t < begin);
        all.extend(breaks.into_iter().filter(|t| *t >= begin));
    }
    all
}

/// Keyframes without those between two of the same value.
fn without_rests<T: Copy>(keys: Vec<T>, same: fn(&T, &T) -> bool) -> Vec<T> {
    let is_needed = |k: usize| {
        let neighbours = (k.checked_sub(1).and_then(|k| keys.get(k)), keys.get(k + 1));
        !matches!(neighbours, (Some(a), Some(b)) if same(a, &keys[k]) && same(b, &keys[k]))
    };
    let needed = (0..keys.len()).filter(|k| is_needed(*k));
    needed.map(|k| keys[k]).collect()
}

/// The keys at which two values differ; lists of numbers count as a whole.
fn differing(before: &Value, after: &Value, key: Key, found: &mut Vec<Key>) {
    match (before, after) {
        (Value::Table(before), Value::Table(after)) => {
            let further = after.keys().filter(|name| !before.contains_key(*name));
            for name in before.keys().chain(further) {
                let key = key.part(&KeyPart::Name(name.clone()));
                match (before.get(name), after.get(name)) {
                    (Some(before), Some(after)) => differing(before, after, key, found),
                    _ => found.push(key),
                }
            }
        }
        (Value::Array(before), Value::Array(after))
            if before.len() == after.len() && before.iter().all(Value::is_table) =>
        {
            for (k, (before, after)) in before.iter().zip(after).enumerate() {
                differing(before, after, key.entry(k), found);
            }
        }
        _ if before != after => found.push(key),
        _ => {}
    }
}
