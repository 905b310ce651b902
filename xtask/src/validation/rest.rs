//! States of rest under loads, by long damped steps.

use crate::interrupt::Interrupted;
use crate::runs::{Course, Ending, Plan, unseen};
use isosheet_collide::Contacts;
use isosheet_dynamics::{SheetModel, Simulation, SimulationError, State};
use isosheet_mesh::Sheet;
use isosheet_tests::implicit_euler;

/// A sheet that is brought to rest under one load after another.
pub(super) struct Rest {
    /// Positions, metres.
    pub(super) x: Vec<f64>,
    /// What it took so far.
    pub(super) course: Course,
    /// Length of a step, seconds.
    pub(super) step: f64,
    /// Displacement in a step below which the sheet is at rest, metres.
    still: f64,
}

/// Steps after which a sheet that is still moving is given up.
const STEPS: f64 = 400.0;

/// A sheet is at rest when nothing moves by more than this part of its size in a step.
const STILL: f64 = 1e-6;

/// The part of the velocity that a step leaves: steps are steps of a descent, without momentum.
const LEFT: f64 = 1e-4;

impl Rest {
    /// From the rest shape of the sheet. `size` (metres) is how far it moves, about; `step` (seconds) the
    /// length of a step, about the time of its slowest motion: `length^2 (density / rigidity)^(1/2)` of a
    /// strip.
    pub(super) fn new(sheet: &Sheet, size: f64, step: f64) -> Self {
        Self {
            x: sheet.positions().to_vec(),
            course: Course::default(),
            step,
            still: STILL * size,
        }
    }

    /// Under what acts in a model. A run that does not end is an entry of the course.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub(super) fn under(&mut self, model: SheetModel) -> Result<(), Interrupted> {
        self.then(model, |_| {})
    }

    /// As [`Rest::under`], and looks at the state of rest.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub(super) fn then(
        &mut self,
        model: SheetModel,
        look: impl FnOnce(&Simulation),
    ) -> Result<(), Interrupted> {
        self.simulated(model, Ok, look)
    }

    /// As [`Rest::then`], among bodies.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub(super) fn among(
        &mut self,
        model: SheetModel,
        contacts: Contacts,
        look: impl FnOnce(&Simulation),
    ) -> Result<(), Interrupted> {
        self.simulated(model, |simulation| simulation.with_contact(contacts), look)
    }

    fn simulated(
        &mut self,
        model: SheetModel,
        with: impl FnOnce(Simulation) -> Result<Simulation, SimulationError>,
        look: impl FnOnce(&Simulation),
    ) -> Result<(), Interrupted> {
        if !self.course.is_good() {
            return Ok(());
        }
        let rate = -LEFT.ln() / self.step;
        let model = match model.with_damping(rate) {
            Ok(model) => model,
            Err(error) => {
                self.course.ending = Ending::of(&error, &error);
                return Ok(());
            }
        };
        let start = State::at_rest(self.x.clone());
        match Simulation::new(model, start, implicit_euler()).and_then(with) {
            Err(error) => self.course.ending = Ending::of(&error, &error),
            Ok(mut simulation) => {
                let plan = Plan::new(self.step, STEPS * self.step);
                let plan = plan.until_rest(self.still / self.step);
                let course = plan.run(&mut simulation, &mut unseen)?;
                self.x.copy_from_slice(&simulation.state().x);
                self.course.add_run(course);
                if self.course.is_good() {
                    look(&simulation);
                }
            }
        }
        Ok(())
    }
}
