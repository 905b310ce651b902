//! What of a scene can be changed while it is played: its functions of time.

use crate::scene::{Change, Course, Hold, Key, Motion, Profile, Scene};
use crate::view::LiveSlider;

/// By how much the wind can be stronger than the scene has it.
const STRONGER: f64 = 2.0;

/// A function of time of a scene that a slider takes over.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Slider {
    pub(super) key: Key,
    pub(super) shown: LiveSlider,
    /// The function as it is now.
    profile: Profile,
}

impl Slider {
    /// Those of a scene. What is zero at all times is not named, and has none.
    pub(super) fn all(scene: &Scene) -> Vec<Self> {
        let until = scene.stop.time;
        let mut found = Vec::new();
        let mut add = |name: String, unit: &str, key: Key, profile: &Profile, reach: f64| {
            let [least, most] = profile.range(until).map(|end| reach * end);
            let [low, high] = [least.min(0.0), most.max(0.0)];
            if high > low {
                found.push(Self {
                    key,
                    shown: LiveSlider {
                        name,
                        unit: unit.into(),
                        low,
                        high,
                    },
                    profile: profile.clone(),
                });
            }
        };
        let root = Key::root();
        if let Some(air) = &scene.air {
            for (k, (axis, component)) in ["x", "y", "z"].iter().zip(&air.wind).enumerate() {
                let key = root.name("air.wind").entry(k);
                add(
                    format!("wind along {axis}"),
                    "m/s",
                    key,
                    component,
                    STRONGER,
                );
            }
        }
        for (k, crease) in scene.crease.iter().enumerate() {
            let key = root.name("crease").entry(k);
            let name = format!("angle of {key}");
            add(name, "°", key.name("angle"), &crease.angle, 1.0);
        }
        let mut moving = |what: &Key, key: &Key, motion: &Motion| {
            let Motion { x, y, z, rotation } = motion;
            for (axis, profile) in [("x", x), ("y", y), ("z", z)] {
                let name = format!("{what} along {axis}");
                add(name, "m", key.name(axis), profile, 1.0);
            }
            if let Some(rotation) = rotation {
                let key = key.name("rotation.angle");
                add(format!("angle of {what}"), "°", key, &rotation.angle, 1.0);
            }
        };
        for (k, support) in scene.support.iter().enumerate() {
            let what = root.name("support").entry(k);
            let (place, motion) = match &support.hold {
                Hold::Pin => continue,
                Hold::MovingPin(motion) => ("hold.moving_pin", motion),
                Hold::Curve { motion, .. } => ("hold.curve.motion", motion),
                Hold::Surface { motion, .. } => ("hold.surface.motion", motion),
            };
            moving(&what, &what.name(place), motion);
        }
        for (k, obstacle) in scene.obstacle.iter().enumerate() {
            let what = root.name("obstacle").entry(k);
            moving(&what, &what.name("motion"), &obstacle.motion);
        }
        for (k, load) in scene.forces.load.iter().enumerate() {
            let key = root.name("forces.load").entry(k);
            add(key.to_string(), "N", key.name("size"), &load.size, 1.0);
        }
        for (k, field) in scene.forces.acceleration.iter().enumerate() {
            let key = root.name("forces.acceleration").entry(k);
            add(key.to_string(), "m/s²", key.name("size"), &field.size, 1.0);
        }
        found
    }

    /// The value at time `t`, seconds.
    pub(super) fn value(&self, t: f64) -> f64 {
        self.profile.value(t)
    }

    /// A value that the slider can stand at.
    pub(super) fn allowed(&self, value: f64) -> f64 {
        value.clamp(self.shown.low, self.shown.high)
    }

    /// Notes that the scene goes from its present value to another one between two times, as
    /// [`LiveScene::drive`](crate::scene::LiveScene::drive) has made it.
    pub(super) fn driven(&mut self, to: f64, begin: f64, end: f64) {
        let from = self.value(begin);
        self.profile = Profile::Course(Course::Ramp(Change {
            from,
            to,
            begin,
            end,
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{SceneFile, StartingPoint};
    use std::path::Path;

    fn sliders(text: &str) -> Vec<(String, f64, f64)> {
        let file = SceneFile::parse(text.into(), Path::new("scene.toml"), &[]).unwrap();
        let named = Slider::all(file.scene()).into_iter();
        named
            .map(|slider| (slider.shown.name, slider.shown.low, slider.shown.high))
            .collect()
    }

    #[test]
    fn what_a_scene_does_not_name_has_no_slider() {
        assert_eq!(sliders(StartingPoint::Hanging.text()), []);
        // The air is still, and the crease folds.
        let crease = ("angle of crease[0]".to_owned(), 0.0, 60.0);
        assert_eq!(sliders(StartingPoint::Leaf.text()), [crease]);
    }

    #[test]
    fn sliders_reach_as_far_as_the_scene_does() {
        let text = r#"
            version = 1
            [sheet]
            mesh = { square = { side = 0.2, level = 1 } }
            density = 0.08
            [[support]]
            at = { vertices = [20] }
            hold = { moving_pin = { z = { ramp = { to = 0.1, end = 1 } } } }
            [[obstacle]]
            shape = { sphere = { radius = 0.05 } }
            pose = { position = [0, 0, -1] }
            [obstacle.motion.rotation]
            centre = [0, 0, 0]
            axis = [0, 0, 1]
            angle = { run_up = { rate = -90, end = 1 } }
            [air]
            wind = [{ sine = { mean = 1, amplitude = 3, frequency = 1 } }, 0, -2]
            [stop]
            time = 2
        "#;
        let named = |name: &str, low, high| (name.to_owned(), low, high);
        assert_eq!(
            sliders(text),
            [
                named("wind along x", -4.0, 8.0),
                named("wind along z", -4.0, 0.0),
                named("support[0] along z", 0.0, 0.1),
                named("angle of obstacle[0]", -135.0, 0.0),
            ]
        );
    }
}
