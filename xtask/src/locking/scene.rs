//! Scenes with a limit of wall time that holds within a step as well.

use super::limit::{GivenUp, Guard, unless_given_up};
use crate::interrupt::Interrupted;
use crate::report::extremes;
use crate::runs::{Course, Ending, Plan, unseen};
use anyhow::Result;
use isosheet_collide::Contacts;
use isosheet_dynamics::{Method, Reaction, SheetModel, Simulation, SimulationError, State};
use isosheet_mesh::{Sheet, VertexId};
use std::time::{Duration, Instant};

/// The end of a run.
#[derive(Clone, Debug)]
pub(super) struct End {
    /// Positions, metres; the start where no step was taken.
    pub(super) x: Vec<f64>,
    /// Forces of the supports in the last step of a run that reached its end.
    pub(super) reactions: Vec<Reaction>,
}

impl End {
    /// Heights of the lowest and the highest vertex, metres.
    pub(super) fn heights(&self) -> [f64; 2] {
        let heights = self.x.as_chunks::<3>().0.iter().map(|p| p[2]);
        extremes(heights).unwrap_or([f64::NAN; 2])
    }

    /// Mean of a coordinate of some vertices, metres.
    pub(super) fn mean(&self, vertices: &[VertexId], k: usize, of: fn(f64) -> f64) -> f64 {
        let values = vertices.iter().map(|v| of(self.x[3 * v.index() + k]));
        values.sum::<f64>() / vertices.len() as f64
    }
}

/// A scene: what moves, where it starts and by which method.
#[derive(Debug)]
pub(super) struct Scene {
    pub(super) model: SheetModel,
    /// Positions at the start (3V, metres); the sheet starts at rest.
    pub(super) start: Vec<f64>,
    pub(super) method: Method,
    pub(super) contacts: Option<Contacts>,
}

impl Scene {
    /// A flat sheet by the default method.
    pub(super) fn flat(model: SheetModel, sheet: &Sheet) -> Self {
        Self {
            model,
            start: sheet.positions().to_vec(),
            method: Method::default(),
            contacts: None,
        }
    }

    /// The same by another method.
    pub(super) fn by(self, method: Method) -> Self {
        Self { method, ..self }
    }

    /// The same from other positions.
    pub(super) fn from(self, start: Vec<f64>) -> Self {
        Self { start, ..self }
    }

    /// The same with contact.
    pub(super) fn touching(self, contacts: Contacts) -> Self {
        let contacts = Some(contacts);
        Self { contacts, ..self }
    }

    fn simulation(self) -> Result<Simulation, SimulationError> {
        let start = State::at_rest(self.start);
        let simulation = Simulation::new(self.model, start, self.method)?;
        match self.contacts {
            None => Ok(simulation),
            Some(contacts) => simulation.with_contact(contacts),
        }
    }

    /// Runs the scene; the wall time is that of the whole run. An error of the solver is an ending like
    /// others, and not an error of this function.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub(super) fn run(mut self, plan: &Plan) -> Result<(Course, End), Interrupted> {
        let (mut course, clock) = (Course::default(), Instant::now());
        let mut end = End {
            x: self.start.clone(),
            reactions: Vec::new(),
        };
        self.model =
            (self.model).with_potential(Guard::new(Duration::from_secs_f64(plan.patience)));
        let mut simulation = None;
        let given_up = unless_given_up(|| {
            match self.simulation() {
                Ok(made) => plan.go_on(simulation.insert(made), &mut course, &mut unseen)?,
                Err(error) => course.ending = Ending::of(&error, &error),
            }
            Ok(())
        });
        match given_up {
            Ok(interrupted) => interrupted?,
            Err(GivenUp::TimeOver) => course.ending = Ending::WallTime(plan.patience),
            Err(GivenUp::Interrupted) => return Err(Interrupted),
        }
        if let Some(simulation) = simulation {
            end.x.copy_from_slice(&simulation.state().x);
            course.time = simulation.state().t;
            if course.is_good() {
                end.reactions = simulation.reactions();
            }
        }
        course.cost.wall = clock.elapsed().as_secs_f64();
        Ok((course, end))
    }
}

#[cfg(test)]
mod tests {
    use super::super::isometry::{Isometry, Material};
    use super::*;
    use isosheet_mesh::generate;

    fn falling() -> Scene {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let model = Isometry::Rods.model(&sheet, Material::limp(0.1)).unwrap();
        Scene::flat(model.with_gravity(), &sheet)
    }

    #[test]
    fn runs_end_complete_out_of_time_or_with_an_error() {
        let plan = Plan::new(0.01, 0.1).within(60.0);
        let (course, end) = falling().run(&plan).unwrap();
        assert_eq!((&course.ending, course.cost.steps), (&Ending::Complete, 10));
        // Damped methods of first and second order fall by g t^2 / 2 to within the order of a step.
        let [lowest, _] = end.heights();
        assert!((lowest + 0.049).abs() < 0.006, "{lowest}");
        let (course, _) = falling().run(&plan.within(0.0)).unwrap();
        assert_eq!(
            (course.ending.name(), course.cost.steps),
            ("wall time over", 0)
        );
        let mut broken = falling();
        broken.start[0] += 0.1;
        let ending = broken.run(&plan).unwrap().0.ending;
        assert!(ending.name().starts_with("Start"), "{ending:?}");
        assert!(!ending.message().is_empty());
    }
}
