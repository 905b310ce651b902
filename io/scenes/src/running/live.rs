//! A simulation together with its scene, which can be changed between steps.

mod hand;

pub use hand::HoldError;

use crate::Files;
use crate::building::build::Kept;
use crate::running::jump::jumps;
use crate::running::under_way::UnderWay;
use crate::sheets::several::sheet_key;
use crate::text::changed::edited;
use crate::time::profile::{Change, Course};
use crate::words::edit::{Edit, EditError, no_function, no_motion};
use crate::words::key::Key;
use crate::{
    BodyKey, CarriedBody, Facts, FramePose, MethodKey, MotionKey, Problem, ProfileKey, Scene,
    SceneError, SceneFile, SceneFileError, Setup, Wrench,
};
use isosheet_dynamics::{Checkpoint, Hand, Simulation, StepError, StepProgress, StepReport};
use isosheet_files::DataError;
use isosheet_formats::EventRow;
use isosheet_mesh::{Advice, VertexId};
use std::borrow::Cow;
use std::ops::ControlFlow;
use std::sync::Arc;
use thiserror::Error;

/// A simulation together with the scene that it is made of. Between two steps the scene can be changed.
///
/// ```
/// use isosheet_scenes::{LiveScene, SceneFile};
/// use std::path::Path;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let text = r#"
///     version = 1
///     [sheet]
///     mesh = { square = { side = 0.2, level = 1 } }
///     density = 0.08
///     [[support]]
///     at = { vertices = [20] }
///     hold = { moving_pin = {} }
///     [forces]
///     gravity = [0, 0, -9.81]
/// "#;
/// let mut live = LiveScene::start(SceneFile::parse(text.into(), Path::new("cloth.toml"), &[])?)?;
/// live.step(0.01)?;
/// // The corner rises by 1 mm until t = 0.02 s, and weight has gone.
/// live.change(&["forces.gravity=[0, 0, 0]".parse()?])?;
/// live.drive(&[("support[0].hold.moving_pin.z".parse()?, 0.001.into())], 0.02)?;
/// live.step(0.01)?;
/// assert!((live.simulation().state().x[62] - 0.001).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
pub struct LiveScene {
    file: SceneFile,
    kept: Kept,
    under_way: UnderWay,
    /// What was taken up and released at the end of the last step.
    events: Vec<EventRow>,
    /// What somebody holds.
    hand: Option<Hand>,
}

/// Part of a step by which a time may differ from a whole number of steps, to allow for round-off: of a
/// thousand steps it is 1e-13.
const ROUND_OFF: f64 = 1e-9;

/// A step that failed: the error of the engine, and the place of the scene that is to blame.
#[derive(Debug, Error)]
#[error("{scene}")]
pub struct FailedStep {
    /// What failed; nothing where the step was taken, and what had to be taken up after it could not be.
    pub step: Option<StepError>,
    /// What failed, in words of the scene.
    pub scene: SceneError,
}

impl FailedStep {
    /// The place of the scene and what is wrong, on one line; nothing where somebody interrupted the step.
    pub fn in_short(&self) -> Option<String> {
        let is_ended = matches!(self.step, Some(StepError::Interrupted { .. }));
        let first = self.scene.problems().first().filter(|_| !is_ended);
        first.map(|problem| problem.to_string())
    }
}

impl Advice for FailedStep {
    /// Always `None`: the text has the remedy.
    fn advice(&self) -> Option<&'static str> {
        self.scene.advice()
    }
}

/// What something is driven to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// A function of time to a value, in its unit.
    Value(f64),
    /// A rigid motion to a pose of its frame.
    Pose(FramePose),
}

impl From<f64> for Target {
    fn from(value: f64) -> Self {
        Self::Value(value)
    }
}

impl From<FramePose> for Target {
    fn from(pose: FramePose) -> Self {
        Self::Pose(pose)
    }
}

impl LiveScene {
    /// The scene at its start.
    ///
    /// # Errors
    /// [`SceneError`], shown at its place in the text.
    pub fn start(file: SceneFile) -> Result<Self, SceneError> {
        let mut kept = Kept::in_folder(file.folder());
        let setup = file.build_with(&mut kept)?;
        Self::begin(file, kept, setup, Setup::start)
    }

    /// The scene at a checkpoint of its simulation, bit for bit. A scene that was changed is resumed with the
    /// changed one ([`LiveScene::file`]).
    ///
    /// # Errors
    /// [`SceneError`] if the checkpoint belongs to another scene.
    pub fn resume(file: SceneFile, checkpoint: Checkpoint) -> Result<Self, SceneError> {
        let mut kept = Kept::in_folder(file.folder());
        let setup = file.build_at_with(&mut kept, &checkpoint)?;
        Self::begin(file, kept, setup, |setup| setup.resume(checkpoint))
    }

    fn begin(
        file: SceneFile,
        kept: Kept,
        setup: Setup,
        begin: impl FnOnce(Setup) -> Result<Simulation, SceneError>,
    ) -> Result<Self, SceneError> {
        Ok(Self {
            under_way: UnderWay::begin(file.scene(), setup, begin)?,
            events: Vec::new(),
            file,
            kept,
            hand: None,
        })
    }

    /// The scene with all changes.
    pub fn file(&self) -> &SceneFile {
        &self.file
    }

    /// What is known of the scene: the sheet, its parts, bodies and obstacles.
    pub fn facts(&self) -> &Facts {
        &self.under_way.facts
    }

    /// The simulation with what is known of its scene.
    pub fn under_way(&self) -> &UnderWay {
        &self.under_way
    }

    /// The files that the scene names, as they were read.
    pub fn files(&mut self) -> &mut Files {
        &mut self.kept.files
    }

    /// The simulation.
    pub fn simulation(&self) -> &Simulation {
        &self.under_way.simulation
    }

    /// Positions of the vertices of [`Facts::sheet`], metres (`3V`).
    pub fn positions(&self) -> Cow<'_, [f64]> {
        self.under_way
            .facts
            .shown(&self.under_way.simulation.state().x)
    }

    /// The bend of the faces beside each crease of [`Facts::sheet`], radians, 0 at other edges
    /// ([`Simulation::bends_at_creases`]); empty where no crease is in a sheet that bends.
    pub fn crease_bends(&self) -> Vec<f64> {
        let bends = self.under_way.simulation.bends_at_creases();
        self.under_way.facts.of_edges(bends.unwrap_or_default())
    }

    /// Their velocities, m/s.
    pub fn velocities(&self) -> Cow<'_, [f64]> {
        self.under_way
            .facts
            .shown(&self.under_way.simulation.state().v)
    }

    /// Their masses, kilograms: zero for bodies, whose mass is not on their surface.
    pub fn masses(&self) -> Vec<f64> {
        let masses = self.under_way.simulation.model().mass().vertex.clone();
        self.under_way.facts.of_vertices(masses, 1)
    }

    /// Forces of supports on the sheets in the last step at the vertices that they hold (`3V`), newtons.
    pub fn reactions(&self) -> Vec<f64> {
        let mut forces = vec![0.0; self.under_way.simulation.state().x.len()];
        for reaction in self.under_way.simulation.reactions() {
            let vertex = reaction.support.vertex().index();
            for k in 0..3 {
                forces[3 * vertex + k] += reaction.force[k];
            }
        }
        self.under_way.facts.of_vertices(forces, 3)
    }

    /// Forces of the rods in the last step, newtons, see [`Simulation::rod_forces`]: zero of the edges of
    /// bodies.
    pub fn rod_forces(&self) -> Option<Vec<f64>> {
        self.under_way
            .simulation
            .rod_forces()
            .map(|forces| self.under_way.facts.of_edges(forces))
    }

    /// The pinned vertices of sheets, at rest or in motion.
    pub fn pins(&self) -> Vec<VertexId> {
        let UnderWay {
            facts, simulation, ..
        } = &self.under_way;
        let bodies = facts.bodies.iter();
        let carriers: Vec<VertexId> = bodies.flat_map(|body| body.vertices).collect();
        let mut pins = simulation.model().pins();
        pins.retain(|v| !carriers.contains(v) && !facts.origins.is_driven(*v));
        pins
    }

    /// What touches bodies, does to each of them at the end of the last step.
    pub fn body_loads(&self) -> Vec<Wrench> {
        CarriedBody::contact_loads(&self.under_way.facts.bodies, &self.under_way.simulation)
    }

    /// What its guide does to each body that has one, in the last step, by the number of the body.
    pub fn guide_loads(&self) -> Vec<(usize, Wrench)> {
        let bodies = self.under_way.facts.bodies.iter().enumerate();
        let loads =
            bodies.filter_map(|(k, body)| Some((k, body.guide_load(&self.under_way.simulation)?)));
        loads.collect()
    }

    /// What the sheet does to the obstacles at the end of the last step, in the order of the scene.
    pub fn obstacle_loads(&self) -> Vec<Wrench> {
        self.under_way
            .facts
            .obstacle_loads(&self.under_way.simulation)
    }

    /// Force of each support of the scene on the sheet in the last step, newtons; zero before the first one.
    pub fn support_forces(&self) -> Vec<[f64; 3]> {
        self.under_way.support_forces()
    }

    /// The length of the next step of a run until time `until` (seconds): that of the scene, the rest of the
    /// time where that is less, and nothing at the end. A rest that is round-off is no step.
    pub fn next_step(&self, until: f64) -> Option<f64> {
        let h = self.file.scene().method.step;
        let rest = until - self.under_way.simulation.state().t;
        let parts = rest / h;
        let length = if parts < 1.0 - ROUND_OFF { rest } else { h };
        (parts > ROUND_OFF).then_some(length)
    }

    /// Advances by `h` seconds, see [`Simulation::step`].
    ///
    /// # Errors
    /// [`FailedStep`]; the state is that of the last accepted sub-step, or that of the end of the step where
    /// something cannot be taken up.
    pub fn step(&mut self, h: f64) -> Result<StepReport, FailedStep> {
        self.step_watched(h, &mut |_| ControlFlow::Continue(()))
    }

    /// As [`LiveScene::step`], with a watch as in [`Simulation::step_watched`].
    ///
    /// # Errors
    /// As [`LiveScene::step`]; with [`StepError::Interrupted`] if the watch ended the step.
    pub fn step_watched(
        &mut self,
        h: f64,
        watch: &mut dyn FnMut(&StepProgress) -> ControlFlow<()>,
    ) -> Result<StepReport, FailedStep> {
        self.step_observed(h, watch, &mut |_, _| ())
    }

    /// Advances as [`LiveScene::step_watched`] does, and shows the state at the end of the step, before
    /// anything is taken up or released there.
    pub fn step_observed(
        &mut self,
        h: f64,
        watch: &mut dyn FnMut(&StepProgress) -> ControlFlow<()>,
        observe: &mut dyn FnMut(&UnderWay, &StepReport),
    ) -> Result<StepReport, FailedStep> {
        self.events.clear();
        let stepped = self.under_way.step_watched(h, watch);
        let report = stepped.map_err(|step| {
            let problem = self.under_way.problem(self.file.scene(), &step, h);
            let scene = SceneError::from(problem).in_text(self.file.text());
            let step = Some(step);
            FailedStep { step, scene }
        })?;
        observe(&self.under_way, &report);
        let (scene, hand) = (self.file.scene(), self.hand.as_ref());
        let events = self.under_way.switch(scene, &mut self.kept, hand);
        self.events = events.map_err(|error| FailedStep {
            step: None,
            scene: error.in_text(self.file.text()),
        })?;
        Ok(report)
    }

    /// What was taken up and released at the end of the last step.
    pub fn events(&self) -> &[EventRow] {
        &self.events
    }

    /// Changes the scene between two steps by edits, in force from now on. What acts on the sheet may change:
    /// forces, stiffnesses and angles of creases, damping, air, bodies, friction, the motions of supports;
    /// what it is may not. Where supports and obstacles are is no matter of a change, they do not jump: see
    /// [`LiveScene::drive`]; obstacles that are added have to be clear of the sheet. What a change does at
    /// once counts as work ([`Simulation::changed_from`]). Meshes, plates and bodies that it does not touch
    /// are not made again.
    ///
    /// # Errors
    /// [`SceneFileError`]; then nothing has changed.
    pub fn change(&mut self, edits: &[Edit]) -> Result<(), SceneFileError> {
        let file = match edited(self.file.scene(), edits) {
            Some(scene) => {
                let keys = edits.iter().map(|edit| edit.key.clone());
                self.file.changed(scene, keys)?
            }
            None => {
                let (text, edits) = (self.file.text(), edits.iter().map(Edit::to_string));
                SceneFile::parse(text.text.clone(), &text.path, &edits.collect::<Vec<_>>())?
            }
        };
        Ok(self.go_on_with(file)?)
    }

    /// Lets functions of time in the scene go from their present values to others until time `until`
    /// (seconds), along a ramp, and keep these: displacements and angles of supports and bodies, angles of
    /// creases, profiles of curls and swellings, sizes of loads. Values are in the units of the scene. A
    /// rigid motion, `obstacle[0].motion` or `support[0].hold.moving_pin`, goes to a pose of its frame, see
    /// [`Poses`](crate::Poses): that of an obstacle is its own, and that of a support the one of space at the
    /// start, where the motion has no `poses` that say another. Where it goes is led on from the second time
    /// on without building anything anew.
    ///
    /// # Errors
    /// As [`LiveScene::change`]; [`EditError`] at a key that is no function of time, or no motion.
    pub fn drive(&mut self, targets: &[(Key, Target)], until: f64) -> Result<(), SceneFileError> {
        let begin = self.under_way.simulation.state().t;
        let mut scene = self.file.scene().clone();
        for (key, target) in targets {
            let refused = |problem: fn(&Key) -> DataError| EditError {
                edit: key.to_string(),
                problem: problem(key),
            };
            match target {
                Target::Value(to) => {
                    let mut functions = scene.functions_mut().into_iter();
                    let found = functions.find(|(place, _)| place == key);
                    let (_, function) = found.ok_or_else(|| refused(no_function))?;
                    *function = ProfileKey::Course(Course::Ramp(Change {
                        from: function.value(begin),
                        to: *to,
                        begin,
                        end: until,
                    }));
                }
                Target::Pose(to) => {
                    let found = scene.motions_mut().into_iter().find(|m| m.key == *key);
                    let moved = found.ok_or_else(|| refused(no_motion))?;
                    *moved.motion = moved.motion.led(*to, moved.frame, [begin, until]);
                }
            }
        }
        let moved = moved_by(&mut scene, targets);
        let keys = targets.iter().map(|(key, _)| key.clone());
        let file = self.file.changed(scene, keys)?;
        let led = &self.under_way.facts.led;
        if targets
            .iter()
            .all(|(key, _)| led.iter().any(|led| led.has(key)))
        {
            for (key, motion) in &moved {
                for led in led.iter().filter(|led| led.has(key)) {
                    led.lead(motion);
                }
            }
            let breaks = file.scene().breaks();
            self.under_way.simulation.set_breaks(breaks);
            self.file = file;
            return Ok(());
        }
        for (key, _) in moved {
            if !self.kept.led.contains(&key) {
                self.kept.led.push(key);
            }
        }
        Ok(self.go_on_with(file)?)
    }

    /// Goes on with a changed scene.
    fn go_on_with(&mut self, file: SceneFile) -> Result<(), SceneError> {
        SceneError::of(lasting(self.file.scene(), file.scene()))
            .and_then(|()| match self.under_way.switches.fit(file.scene()) {
                true => Ok(()),
                false => Err(other_periods().into()),
            })
            .and_then(|()| self.rebuild(file.scene(), self.hand.clone()))
            .map_err(|e| e.in_text(file.text()))?;
        self.file = file;
        Ok(())
    }

    /// Goes on with the simulation of a scene and with a hand from the present state.
    fn rebuild(&mut self, scene: &Scene, hand: Option<Hand>) -> Result<(), SceneError> {
        let mut setup = scene.build_switched(&mut self.kept, &self.under_way.switches)?;
        let facts = Arc::clone(&setup.facts);
        let before = (self.file.scene(), &*self.under_way.facts);
        SceneError::of(jumps(
            before,
            (scene, &facts),
            self.under_way.simulation.state().t,
        ))?;
        if let Some(hand) = &hand {
            setup.model = setup.model.with_hand(hand.clone());
        }
        let resumed = setup.resume_changed(self.under_way.simulation.checkpoint())?;
        let changed = resumed.changed_from(&self.under_way.simulation);
        let changed = changed.map_err(|e| SceneError::from(facts.origins.of_change(&e)))?;
        let switches = self.under_way.switches.clone();
        self.under_way = UnderWay::new(scene, facts, switches, changed);
        self.hand = hand;
        Ok(())
    }
}

/// The rigid motions of a scene to which some keys belong, or parts of them.
fn moved_by(scene: &mut Scene, targets: &[(Key, Target)]) -> Vec<(Key, MotionKey)> {
    let all = scene.motions_mut().into_iter();
    let driven = all.filter(|moved| targets.iter().any(|(key, _)| key.is_within(&moved.key)));
    driven
        .map(|moved| (moved.key, moved.motion.clone()))
        .collect()
}

fn other_periods() -> Problem {
    let message = "what is taken up and released does not change during a simulation";
    Problem::new(Key::root(), message, "begin a new simulation")
}

/// What a change must not change: where the sheet starts and how the motion is computed.
fn lasting(before: &Scene, after: &Scene) -> Vec<Problem> {
    let method = |scene: &Scene| MethodKey {
        step: before.method.step,
        ..scene.method.clone()
    };
    let bodies =
        |scene: &Scene| -> Vec<BodyKey> { scene.body.iter().map(BodyKey::lasting).collect() };
    let (old, new) = (&before.sheet, &after.sheet);
    if old.len() != new.len() {
        let message = "the number of sheets does not change during a simulation";
        let key = Key::root().name("sheet");
        return vec![Problem::new(key, message, "begin a new simulation")];
    }
    let mut checks = vec![
        (Key::root().name("method"), method(before) == method(after)),
        (Key::root().name("body"), bodies(before) == bodies(after)),
    ];
    for (k, (old, new)) in old.iter().zip(new).enumerate() {
        let key = sheet_key(before.sheet.len(), k);
        checks.push((key.name("mesh"), old.mesh == new.mesh));
        checks.push((key.name("refine"), old.refine == new.refine));
        checks.push((key.name("placement"), old.placement == new.placement));
        checks.push((key.name("start"), old.start == new.start));
        let shape =
            |sheet: &crate::SheetKey| sheet.curl.as_ref().and_then(|curl| curl.shape.clone());
        checks.push((key.name("curl.shape"), shape(old) == shape(new)));
    }
    let changed = checks.into_iter().filter(|(_, same)| !same);
    let problem = |(key, _): (Key, bool)| {
        let message = format!("`{key}` does not change during a simulation");
        Problem::new(key, message, "begin a new simulation")
    };
    changed.map(problem).collect()
}
