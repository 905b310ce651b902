//! What of a scene can be changed while it is played: its functions of time.

use isosheet_page::LiveSlider;
use isosheet_scenes::{Change, Course, Function, Key, ProfileKey, Scene};

/// By how much the wind can be stronger than the scene has it.
const STRONGER: f64 = 2.0;

/// The unit of the wind.
const WIND: &str = "m/s";

/// A function of time of a scene that a slider takes over.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Slider {
    pub(super) key: Key,
    pub(super) shown: LiveSlider,
    /// The function as it is now.
    profile: ProfileKey,
}

impl Slider {
    /// The sliders of a scene. What is zero at all times is not named, and has none.
    pub(super) fn all(scene: &Scene) -> Vec<Self> {
        let slider = |function: Function<'_>| {
            let Function { key, profile, unit } = function;
            let name = with_names(called(&key)?, scene);
            let reach = if unit == WIND { STRONGER } else { 1.0 };
            let [least, most] = profile.range(scene.stop.time).map(|end| reach * end);
            let [low, high] = [least.min(0.0), most.max(0.0)];
            let shown = LiveSlider {
                name,
                unit: as_shown(unit),
                low,
                high,
            };
            (high > low).then(|| Self {
                key,
                shown,
                profile: profile.clone(),
            })
        };
        let mut all: Vec<Self> = scene.functions().into_iter().filter_map(slider).collect();
        // The wind comes first.
        all.sort_by_key(|slider| slider.shown.unit != WIND);
        all
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
    /// [`LiveScene::drive`](isosheet_scenes::LiveScene::drive) has made it.
    pub(super) fn driven(&mut self, to: f64, begin: f64, end: f64) {
        let from = self.value(begin);
        self.profile = ProfileKey::Course(Course::Ramp(Change {
            from,
            to,
            begin,
            end,
        }));
    }
}

/// What the slider of the function of time at a key is called; nothing where there is none.
fn called(key: &Key) -> Option<String> {
    let text = key.to_string();
    let owner = text.find(']').map_or("", |end| &text[..=end]);
    let (above, last) = text.rsplit_once('.')?;
    Some(match last {
        "closing" | "rest" => return None,
        "angle" => format!("angle of {owner}"),
        "x" | "y" | "z" => format!("{owner} along {last}"),
        "size" | "profile" => above.to_owned(),
        "course" => "part of the folding".to_owned(),
        "added" => format!("gas added to {owner}"),
        "wind[0]" => "wind along x".to_owned(),
        "wind[1]" => "wind along y".to_owned(),
        "wind[2]" => "wind along z".to_owned(),
        _ => text,
    })
}

/// A unit as a page shows it.
fn as_shown(unit: &str) -> String {
    unit.replace("degrees", "°")
        .replace('2', "²")
        .replace('3', "³")
}

/// What a slider is called, where a crease has a name by that.
fn with_names(called: String, scene: &Scene) -> String {
    let creases = scene.crease.iter().enumerate();
    let named = creases.filter_map(|(k, crease)| Some((format!("crease[{k}]"), crease.called()?)));
    named.fold(called, |called, (key, name)| {
        called.replace(&key, &format!("\"{name}\""))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_scenes::{SceneFile, StartingPoint};
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
        // The seams close, and air is blown in.
        let added = ("gas added to forces.gas[0]".to_owned(), 0.0, 5e-4);
        assert_eq!(sliders(StartingPoint::Pillow.text()), [added]);
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

    #[test]
    fn curls_and_swelling_have_sliders() {
        let text = r#"
            version = 1
            [sheet]
            mesh = { square = { side = 0.2, level = 1 } }
            material = "office paper"
            curl = { along = [1, 0, 0], radius = 0.1 }
            swell = { ramp = { to = -0.002, end = 1 } }
        "#;
        let named = |name: &str, low, high| (name.to_owned(), low, high);
        let expected = [
            named("sheet.curl", 0.0, 1.0),
            named("sheet.swell", -0.002, 0.0),
        ];
        assert_eq!(sliders(text), expected);
    }
}
