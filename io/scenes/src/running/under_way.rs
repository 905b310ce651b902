//! A simulation of a scene in which things are taken up and released.

use crate::building::build::Kept;
use crate::building::setup::Facts;
use crate::whole::switches::{Reached, Switches, not_taken_up};
use crate::{Scene, SceneError, Setup, SupportForces};
use isosheet_dynamics::contact::Contact;
use isosheet_dynamics::{Hand, Simulation, StepError, StepProgress, StepReport};
use isosheet_formats::EventRow;
use std::cell::OnceCell;
use std::ops::ControlFlow;
use std::sync::Arc;

/// A simulation between two steps, with what is known of its scene as it is held now.
pub struct UnderWay {
    /// What is known of its scene.
    pub facts: Arc<Facts>,
    pub(crate) switches: Switches,
    /// The forces of the supports.
    pub supports: SupportForces,
    /// The simulation.
    pub simulation: Simulation,
    /// Forces of the supports in the last step (newtons), where something has been taken up or released
    /// since.
    before: Option<Vec<[f64; 3]>>,
}

impl UnderWay {
    /// The simulation that begins with what a scene was built to.
    pub fn begin(
        scene: &Scene,
        setup: Setup,
        begin: impl FnOnce(Setup) -> Result<Simulation, SceneError>,
    ) -> Result<Self, SceneError> {
        let (facts, switches) = (Arc::clone(&setup.facts), setup.switches.clone());
        Ok(Self::new(scene, facts, switches, begin(setup)?))
    }

    /// Whether something of the scene is still taken up or released at a time within the run.
    pub fn is_due(&self, scene: &Scene) -> bool {
        self.switches.are_due(scene)
    }

    pub(crate) fn new(
        scene: &Scene,
        facts: Arc<Facts>,
        switches: Switches,
        simulation: Simulation,
    ) -> Self {
        let count = scene.support.len();
        Self {
            supports: SupportForces::new(Arc::clone(&facts), &simulation, count),
            facts,
            switches,
            simulation,
            before: None,
        }
    }

    /// Takes a step, see [`Simulation::step_watched`]; the forces of the supports then belong to this step.
    pub fn step_watched(
        &mut self,
        h: f64,
        watch: &mut dyn FnMut(&StepProgress) -> ControlFlow<()>,
    ) -> Result<StepReport, StepError> {
        let stepped = self.simulation.step_watched(h, watch);
        self.before = None;
        stepped
    }

    /// Takes up and releases what the step that has ended asks for, and goes on with it; what has happened.
    /// `hand` is what somebody holds.
    ///
    /// # Errors
    /// [`SceneError`] if something cannot be taken up; then nothing has changed.
    pub fn switch(
        &mut self,
        scene: &Scene,
        kept: &mut Kept,
        hand: Option<&Hand>,
    ) -> Result<Vec<EventRow>, SceneError> {
        if !self.switches.wait() {
            return Ok(Vec::new());
        }
        let mut switches = self.switches.clone();
        let events = self.changes(scene, &mut switches);
        if events.is_empty() {
            return Ok(events);
        }
        let mut setup = scene.build_switched(kept, &switches)?;
        if let Some(hand) = hand {
            setup.model = setup.model.with_hand(hand.clone());
        }
        let Setup {
            facts,
            model,
            contacts,
            ..
        } = setup;
        let contact = contacts.map(|c| Box::new(c) as Box<dyn Contact>);
        let before = self.support_forces();
        self.simulation
            .hold_by(model, contact)
            .map_err(|e| not_taken_up(&events, &e, facts.origins.of_change(&e)))?;
        self.simulation.set_note(switches.note());
        let count = scene.support.len();
        self.supports = SupportForces::new(Arc::clone(&facts), &self.simulation, count);
        (self.facts, self.switches, self.before) = (facts, switches, Some(before));
        Ok(events)
    }

    /// Force of each support of the scene on the sheet in the last step, newtons; zero before the first one.
    pub fn support_forces(&self) -> Vec<[f64; 3]> {
        match &self.before {
            Some(forces) => forces.clone(),
            None => self.supports.of(&self.simulation),
        }
    }

    /// What the present state takes up and releases.
    fn changes(&self, scene: &Scene, switches: &mut Switches) -> Vec<EventRow> {
        let state = self.simulation.state();
        let seen = self.facts.shown(&state.x);
        let measure = |name: &str| {
            let mut gauges = self.facts.measures.iter();
            let gauge = gauges.find(|gauge| gauge.name == name)?;
            Some(gauge.value(state.t, &seen, self.simulation.memories()))
        };
        // They cost a factorisation, and are asked for where something depends on them.
        let forces = OnceCell::new();
        let support = |k: usize| {
            let forces = forces.get_or_init(|| self.supports.of(&self.simulation));
            let force = forces.get(k).copied().unwrap_or_default();
            force.iter().map(|c| c * c).sum::<f64>().sqrt()
        };
        let reached = Reached {
            t: state.t,
            x: &state.x,
            measure: &measure,
            support: &support,
            bonds: &self.facts.bonds,
        };
        switches.after_step(scene, &reached)
    }
}
