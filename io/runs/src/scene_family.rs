//! Scenes as functions of the values of some keys, for gradients.

use crate::steps::{step_count, step_length};
use isosheet_adjoint::{Family, Plan, SceneError as NoScene};
use isosheet_dynamics::contact::Contact;
use isosheet_dynamics::{ImplicitOptions, Method};
use isosheet_files::DataError;
use isosheet_mesh::Advice;
use isosheet_scenes::{Integration, Key, SceneFile, SceneFileError, Setup};
use std::path::{Path, PathBuf};

/// A scene as a function of the values of some of its keys: what `isosheet-adjoint` differentiates.
///
/// ```
/// use isosheet_adjoint::{AdjointOptions, Run, coordinate};
/// use isosheet_runs::SceneFamily;
/// use std::path::Path;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
/// let text = r#"
/// version = 1
/// [sheet]
/// mesh = { square = { side = 0.3, level = 1 } }
/// density = 0.08
/// damping = 2.0
/// [[support]]
/// at = { nearest = [[0.0, 0.3, 0.0]] }
/// [forces]
/// gravity = [0.0, 0.0, -9.81]
/// [stop]
/// time = 0.05
/// "#;
/// let keys = ["sheet.damping", "forces.gravity[2]"].map(str::to_owned).to_vec();
/// let family = SceneFamily::of_text(text, Path::new("hanging.toml"), Vec::new(), keys)?;
/// let plan = family.plan()?;
/// let last = plan.steps.len();
/// let run = Run::record(&family, &family.values()?, plan, AdjointOptions::default())?;
/// let gradient = run.gradient(&coordinate(4, 2, last))?;
/// // It falls further with more weight, and less far with more damping.
/// assert!(gradient.of_numbers[0] > 0.0 && gradient.of_numbers[1] > 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct SceneFamily {
    text: String,
    path: PathBuf,
    edits: Vec<String>,
    keys: Vec<String>,
}

/// Why a scene cannot be differentiated.
#[derive(Debug, thiserror::Error)]
pub enum SceneFamilyError {
    /// The scene is wrong.
    #[error(transparent)]
    Scene(#[from] SceneFileError),
    /// A key has no number in the scene, or the scene is one that has no gradient.
    #[error(transparent)]
    Other(#[from] DataError),
}

impl Advice for SceneFamilyError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Scene(error) => error.advice(),
            Self::Other(error) => error.advice(),
        }
    }
}

/// The tables of a scene that say how it is run and what is told of it.
const WITHOUT_DERIVATIVE: [&str; 4] = ["method", "stop", "output", "measure"];

fn no_number(key: &str) -> DataError {
    DataError::new(
        format!("`{key}` has no number in the scene"),
        "name a key that has one, such as `forces.gravity[2]`; give those that are left out their value first",
    )
}

impl SceneFamily {
    /// The scene of a file, with edits of the form `key=value`, as a function of some keys.
    ///
    /// # Errors
    /// [`SceneFamilyError`] if the scene is wrong, or a key has no number in it.
    pub fn read(
        path: &Path,
        edits: Vec<String>,
        keys: Vec<String>,
    ) -> Result<Self, SceneFamilyError> {
        let file = SceneFile::read(path, &edits)?;
        let text = file.text().text.clone();
        Self::of_text(&text, path, Vec::new(), keys)
    }

    /// As [`SceneFamily::read`], of a text; `path` is for messages and relative paths.
    ///
    /// # Errors
    /// As [`SceneFamily::read`].
    pub fn of_text(
        text: &str,
        path: &Path,
        edits: Vec<String>,
        keys: Vec<String>,
    ) -> Result<Self, SceneFamilyError> {
        let family = Self {
            text: text.to_owned(),
            path: path.to_owned(),
            edits,
            keys,
        };
        let file = family.file(&[])?;
        if file.scene().has_periods() {
            let message = "something in the scene holds for a time, or until something happens";
            let remedy = "differentiate the runs before and after it";
            return Err(DataError::new(message, remedy).into());
        }
        let stop = &file.scene().stop;
        let ends = [
            ("rest", stop.rest.is_some()),
            ("support_force", stop.support_force.is_some()),
        ];
        if let Some((name, _)) = ends.into_iter().find(|(_, is_given)| *is_given) {
            let message = format!("the scene ends by `stop.{name}`, and its end has no derivative");
            let remedy = "end the scene at a time alone, for example with `stop = { time = 1.0 }`";
            return Err(DataError::new(message, remedy).into());
        }
        family.values()?;
        Ok(family)
    }

    /// The keys.
    pub fn keys(&self) -> &[String] {
        &self.keys
    }

    /// The values of the keys in the scene.
    ///
    /// # Errors
    /// [`SceneFamilyError::Other`] if a key has no number.
    pub fn values(&self) -> Result<Vec<f64>, SceneFamilyError> {
        let file = self.file(&[])?;
        let number = |text: &String| {
            let key: Key = text.parse().map_err(|_| no_number(text))?;
            let is_of_run = |table: &&&str| table.parse().is_ok_and(|table| key.is_within(&table));
            if let Some(table) = WITHOUT_DERIVATIVE.iter().find(is_of_run) {
                let message = format!("`{key}` has no derivative");
                let remedy = match *table {
                    "method" | "stop" => "steps and end are the same for all values of other keys",
                    _ => "name a key of the sheet, of what holds it, or of what acts on it",
                };
                return Err(DataError::new(message, remedy).into());
            }
            Ok(file.number(&key).ok_or_else(|| no_number(text))?)
        };
        self.keys.iter().map(number).collect()
    }

    /// The sizes of the values for [`AdjointOptions::sizes`](isosheet_adjoint::AdjointOptions::sizes): of
    /// positions of obstacles and bodies the distance at which contact acts, and zeros of all others, which
    /// are as large as they are.
    ///
    /// # Errors
    /// [`SceneFamilyError`] if the scene cannot be built.
    pub fn sizes(&self) -> Result<Vec<f64>, SceneFamilyError> {
        let setup = self.file(&[])?.build().map_err(SceneFileError::from)?;
        let distance = setup.contacts.map(|contacts| contacts.options().activation);
        let is_place = |key: &String| {
            let holds = ["obstacle[", "body["]
                .iter()
                .any(|own| key.starts_with(own));
            holds && key.contains(".position[")
        };
        let size = |key: &String| distance.filter(|_| is_place(key)).unwrap_or(0.0);
        Ok(self.keys.iter().map(size).collect())
    }

    /// The method and the steps of the scene, up to its time. The tolerance of the steps is 1e-10
    /// ([`ImplicitOptions::tolerance`]), as the gradient is that of equations which are solved.
    ///
    /// # Errors
    /// [`SceneFamilyError`] if the scene cannot be built, or moves in a chart.
    pub fn plan(&self) -> Result<Plan, SceneFamilyError> {
        let file = self.file(&[])?;
        let setup = file.build().map_err(SceneFileError::from)?;
        let Integration::Free { method, control } = setup.integration else {
            let message = "the scene moves in a chart, which has no gradient";
            return Err(DataError::new(message, "use BDF2 or implicit Euler").into());
        };
        let scene = file.scene();
        let numbers = 1..=step_count(scene);
        Ok(Plan {
            method: solved(method),
            control,
            steps: numbers.map(|number| step_length(scene, number)).collect(),
        })
    }

    /// The scene with values of the first keys.
    fn file(&self, numbers: &[f64]) -> Result<SceneFile, SceneFileError> {
        let values = self.keys.iter().zip(numbers);
        let own = values.map(|(key, value)| format!("{key}={value:?}"));
        let edits: Vec<String> = self.edits.iter().cloned().chain(own).collect();
        SceneFile::parse(self.text.clone(), &self.path, &edits)
    }
}

/// The tolerance of steps whose equations are differentiated ([`ImplicitOptions::tolerance`]): they leave a
/// part 1e-5 of the forces, the square root. What a step of a scene leaves is a hundredth.
const TOLERANCE: f64 = 1e-10;

/// When friction and loads that follow the sheet count as settled in such steps, and after how many updates
/// at most.
const SETTLED: f64 = 1e-8;
const UPDATES: usize = 40;

/// A method whose steps are solved to [`TOLERANCE`], with friction and loads that have settled.
fn solved(method: Method) -> Method {
    let solved = |options: ImplicitOptions| ImplicitOptions {
        tolerance: Some(TOLERANCE),
        friction_tolerance: SETTLED,
        max_friction_updates: UPDATES,
        ..options
    };
    match method {
        Method::Bdf2(options) => Method::Bdf2(solved(options)),
        Method::ImplicitEuler(options) => Method::ImplicitEuler(solved(options)),
        Method::Equilibrium(options) => Method::Equilibrium(solved(options)),
        other => other,
    }
}

impl Family for SceneFamily {
    fn scene(&self, numbers: &[f64]) -> Result<isosheet_adjoint::Scene, NoScene> {
        let Setup {
            model,
            start,
            contacts,
            ..
        } = self.file(numbers)?.build()?;
        Ok(isosheet_adjoint::Scene {
            model,
            start,
            contact: contacts.map(|contacts| Box::new(contacts) as Box<dyn Contact>),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_adjoint::{AdjointError, AdjointOptions, Branches, Run, StepEvent, coordinate};

    const TEXT: &str = "\
version = 1
[sheet]
mesh = { square = { side = 0.2, level = 1 } }
material = 'office paper'
[[support]]
at = { nearest = [[0.0, 0.0, 0.0], [0.2, 0.0, 0.0]] }
[forces]
gravity = [0.0, 0.3, -9.81]
[method]
step = 0.01
[stop]
time = 0.055
";

    fn family(keys: &[&str]) -> Result<SceneFamily, SceneFamilyError> {
        let keys = keys.iter().map(|key| (*key).to_owned()).collect();
        SceneFamily::of_text(TEXT, Path::new("paper.toml"), Vec::new(), keys)
    }

    #[test]
    fn gradients_by_keys_are_those_of_differences() {
        let family = family(&["forces.gravity[1]", "forces.gravity[2]"]).expect("keys");
        let values = family.values().expect("numbers");
        assert_eq!(values, [0.3, -9.81]);
        let plan = family.plan().expect("steps");
        assert_eq!(plan.steps.len(), 6);
        assert!((plan.steps[5] - 5e-3).abs() < 1e-12);
        let loss = coordinate(24, 2, 6);
        let value = |values: &[f64]| {
            let options = AdjointOptions::default();
            let run = Run::record(&family, values, plan.clone(), options).expect("a run");
            (
                run.value(&loss).expect("a value"),
                run.gradient(&loss).expect("a gradient"),
            )
        };
        let (_, gradient) = value(&values);
        for k in 0..2 {
            let h = 1e-3 * values[k];
            let at = |change: f64| {
                let mut moved = values.clone();
                moved[k] += change;
                value(&moved).0
            };
            let slope = (at(h) - at(-h)) / (2.0 * h);
            let found = gradient.of_numbers[k];
            // (What steps leave of the forces, a part 1e-5, is in the differences.)
            assert!((found / slope - 1.0).abs() < 1e-4, "{k}: {found} {slope}");
        }
    }

    /// A block beside a sheet falls on the floor. Where its velocities are corrected is a branch.
    #[test]
    fn impacts_of_bodies_are_refused_or_named() {
        let text = "\
version = 1
[sheet]
mesh = { square = { side = 0.1, level = 0 } }
material = 'office paper'
[[support]]
at = { nearest = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0]] }
[[body]]
shape = { box = { size = [0.05, 0.04, 0.03] } }
mass = 0.1
pose = { position = [0.3, 0.0, 0.0] }
[[obstacle]]
shape = 'half_space'
pose = { position = [0.0, 0.0, -0.04] }
[forces]
gravity = [0.0, 0.0, -9.81]
[contact]
[method]
step = 0.01
[stop]
time = 0.2
";
        let keys = vec!["forces.gravity[2]".to_owned()];
        let family = SceneFamily::of_text(text, Path::new("block.toml"), Vec::new(), keys);
        let family = family.expect("a key");
        let plan = family.plan().expect("steps");
        let values = family.values().expect("a number");
        let gradient = |branches| {
            let options = AdjointOptions {
                branches,
                ..AdjointOptions::default()
            };
            let run = Run::record(&family, &values, plan.clone(), options).expect("a run");
            run.gradient(&coordinate(5, 2, 20))
        };
        let error = gradient(Branches::Refuse).expect_err("an impact");
        let event = StepEvent::Restitution;
        assert!(
            matches!(error, AdjointError::Event { event: found, .. } if found == event),
            "{error}"
        );
        let passed_by = gradient(Branches::PassBy).expect("a gradient").passed_by;
        assert!(!passed_by.is_empty());
        for passed in passed_by {
            assert!(passed.what.contains("bodies met"), "{passed:?}");
        }
    }

    #[test]
    fn what_says_how_a_scene_is_run_is_refused() {
        for key in ["method.step", "stop.time"] {
            let error = family(&[key]).expect_err("no derivative");
            assert!(error.to_string().contains("no derivative"), "{error}");
            assert!(error.advice().is_some());
        }
        for end in [
            "stop.support_force=0.01",
            "stop.rest={speed=1e-3,duration=0.1}",
        ] {
            let edits = vec![end.to_owned()];
            let keys = vec!["forces.gravity[2]".to_owned()];
            let path = Path::new("paper.toml");
            let error = SceneFamily::of_text(TEXT, path, edits, keys).expect_err("an end");
            assert!(error.to_string().contains("stop."), "{error}");
        }
    }

    /// A ball at the origin: the size of its place is not one metre.
    #[test]
    fn places_of_obstacles_have_the_size_of_the_contact() {
        let edits = [
            "obstacle=[{shape={sphere={radius=0.05}},pose={position=[0,0,-0.0506]}}]",
            "contact={}",
            "support=[]",
        ];
        let keys = ["obstacle[0].pose.position[0]", "forces.gravity[2]"].map(str::to_owned);
        let edits = edits.map(str::to_owned).to_vec();
        let path = Path::new("paper.toml");
        let family = SceneFamily::of_text(TEXT, path, edits, keys.to_vec()).expect("keys");
        let [place, gravity] = family.sizes().expect("sizes")[..] else {
            panic!("two sizes");
        };
        assert!(place > 0.0 && place < 0.01 && gravity == 0.0, "{place}");
        let (plan, values) = (family.plan().expect("steps"), family.values().expect("two"));
        let options = AdjointOptions {
            sizes: family.sizes().expect("sizes"),
            ..AdjointOptions::default()
        };
        let loss = coordinate(24, 2, 6);
        let value = |change: f64| {
            let numbers = [values[0] + change, values[1]];
            let run = Run::record(&family, &numbers, plan.clone(), options.clone());
            run.expect("a run").value(&loss).expect("a height")
        };
        let run = Run::record(&family, &values, plan.clone(), options.clone());
        let found = run.expect("a run").gradient(&loss).expect("a gradient");
        let slope = (value(1e-7) - value(-1e-7)) / 2e-7;
        let error = found.of_numbers[0] / slope - 1.0;
        assert!(error.abs() < 1e-3, "{} {slope}", found.of_numbers[0]);
    }

    #[test]
    fn keys_without_a_number_are_refused() {
        for key in ["sheet.material", "sheet.nothing", "obstacle[0].friction"] {
            let error = family(&[key]).expect_err("no number");
            assert!(error.to_string().contains(key), "{error}");
            assert!(error.advice().is_some());
        }
    }
}
