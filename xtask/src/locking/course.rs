//! Runs of scenes, with a limit of wall time, and how they ended.

use super::limit::{GivenUp, Guard, unless_given_up};
use crate::interrupt::Interrupted;
use crate::report::Cost;
use anyhow::Result;
use isosheet_collide::Contacts;
use isosheet_dynamics::{
    Method, Reaction, RunEnd, SheetModel, Simulation, State, StepError, StepReport,
};
use isosheet_mesh::{Sheet, VertexId};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// How long a scene runs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// Length of a step, seconds.
    pub(super) step: f64,
    /// Longest time simulated, seconds.
    pub(super) duration: f64,
    /// The run ends early when the sheet is at rest: when the largest speed of a vertex (m/s) has been below
    /// this bound for [`QUIET`] steps. `None`: it does not end early.
    pub(super) rest_speed: Option<f64>,
    /// Longest wall time.
    pub(super) patience: Duration,
}

impl Plan {
    /// So many seconds in steps of so many, whatever the sheet does.
    pub(super) fn new(step: f64, duration: f64, patience: Duration) -> Self {
        Self {
            step,
            duration,
            rest_speed: None,
            patience,
        }
    }

    /// The same, but the run ends when the sheet is at rest, see [`Plan::rest_speed`].
    pub(super) fn until_rest(self, speed: f64) -> Self {
        Self {
            rest_speed: Some(speed),
            ..self
        }
    }

    /// The limit of wall time, seconds.
    pub(super) fn limit(&self) -> f64 {
        self.patience.as_secs_f64()
    }
}

/// Steps below the bound of speed after which a sheet is called at rest: one alone may be a turning point.
pub(super) const QUIET: usize = 5;

/// How a run ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) enum Ending {
    /// The whole time was simulated.
    #[default]
    Complete,
    /// The sheet came to rest.
    Rest,
    /// The limit of wall time was reached.
    WallTime,
    /// The solver returned an error: its kind and its message.
    Error { kind: String, message: String },
}

impl Ending {
    /// The ending in a word or two.
    pub(super) fn name(&self) -> &str {
        match self {
            Self::Complete => "complete",
            Self::Rest => "at rest",
            Self::WallTime => "wall time over",
            Self::Error { kind, .. } => kind,
        }
    }

    /// The message of an error, nothing otherwise.
    pub(super) fn message(&self) -> &str {
        match self {
            Self::Error { message, .. } => message,
            _ => "",
        }
    }

    /// Whether the run reached its end.
    pub(super) fn is_good(&self) -> bool {
        matches!(self, Self::Complete | Self::Rest)
    }
}

/// What a step guarantees where the model has equations of isometry and where there is contact: the worst of
/// steps or of runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Kept {
    /// Largest violation of the equations of isometry (see [`StepReport::constrained_strain`]).
    pub(super) violation: f64,
    /// Smallest gap, metres; nothing without contact.
    pub(super) gap: Option<f64>,
}

impl Kept {
    /// Takes other steps into account.
    pub(super) fn add(&mut self, other: Self) {
        self.violation = self.violation.max(other.violation);
        self.gap = [self.gap, other.gap].into_iter().flatten().reduce(f64::min);
    }
}

/// What happened in a run.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Course {
    pub(super) ending: Ending,
    /// Positions at the end, metres; the start where no step was taken. They are not kept in records.
    #[serde(skip)]
    pub(super) x: Vec<f64>,
    /// Forces of the supports in the last step of a run that reached its end; not kept in records either.
    #[serde(skip)]
    pub(super) reactions: Vec<Reaction>,
    /// Time at the end, seconds.
    pub(super) t: f64,
    /// What the completed steps cost; wall time of the whole run.
    pub(super) cost: Cost,
    /// Most factorisations in one step.
    pub(super) worst: usize,
    /// Kinetic energy after the last complete step, joules.
    pub(super) kinetic: f64,
    /// Largest speed of a vertex after the last complete step, metres per second.
    pub(super) speed: f64,
    /// Largest relative error of an edge length.
    pub(super) strain: f64,
    pub(super) kept: Kept,
}

impl Course {
    fn of(start: &[f64]) -> Self {
        Self {
            x: start.to_vec(),
            ..Self::default()
        }
    }

    fn add(&mut self, state: &State, report: &StepReport) {
        self.cost.add(report);
        self.worst = self.worst.max(report.factorisations);
        self.kinetic = report.kinetic;
        self.strain = self.strain.max(report.strain);
        self.kept.add(Kept {
            violation: report.constrained_strain,
            gap: report.gap,
        });
        let square = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>();
        let fastest = state.v.as_chunks::<3>().0.iter().map(square);
        self.speed = fastest.fold(0.0, f64::max).sqrt();
    }

    /// Whether the run reached its end.
    pub(super) fn is_good(&self) -> bool {
        self.ending.is_good()
    }

    /// Mean factorisations in the steps that were completed; nothing where none was.
    pub(super) fn factorisations(&self) -> Option<f64> {
        self.cost.factorisations_per_step()
    }

    /// Heights of the lowest and the highest vertex at the end, metres.
    pub(super) fn heights(&self) -> [f64; 2] {
        let heights = self.x.as_chunks::<3>().0.iter().map(|p| p[2]);
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| {
            [low.min(z), high.max(z)]
        })
    }

    /// Mean of a coordinate of some vertices at the end, metres.
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

    /// Runs the scene. An error of the solver is an ending like others, and not an error of this function.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub(super) fn run(self, plan: &Plan) -> Result<Course, Interrupted> {
        let mut course = Course::of(&self.start);
        let clock = Instant::now();
        let model = self.model.with_potential(Guard::new(plan.patience));
        let (start, method, contacts) = (State::at_rest(self.start), self.method, self.contacts);
        let simulation = unless_given_up(|| {
            let simulation = Simulation::new(model, start, method)?;
            match contacts {
                None => Ok(simulation),
                Some(contacts) => simulation.with_contact(contacts),
            }
        });
        let mut simulation = match simulation {
            Ok(Ok(simulation)) => simulation,
            Ok(Err(error)) => {
                course.ending = refused(&error, &error);
                return Ok(course);
            }
            Err(GivenUp::TimeOver) => {
                course.ending = Ending::WallTime;
                return Ok(course);
            }
            Err(GivenUp::Interrupted) => return Err(Interrupted),
        };
        let mut quiet = 0;
        let mut watch = |simulation: &Simulation, report: &StepReport| {
            course.add(simulation.state(), report);
            let slow = plan.rest_speed.is_some_and(|bound| course.speed < bound);
            quiet = if slow { quiet + 1 } else { 0 };
            if quiet < QUIET {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        };
        let end = unless_given_up(|| simulation.run(plan.duration, plan.step, &mut [&mut watch]));
        course.ending = match end {
            Ok(Ok(RunEnd::Complete | RunEnd::Taut)) => Ending::Complete,
            Ok(Ok(RunEnd::Stopped)) => Ending::Rest,
            Ok(Err(error)) => refused(&error, cause(&error)),
            Err(GivenUp::TimeOver) => Ending::WallTime,
            Err(GivenUp::Interrupted) => return Err(Interrupted),
        };
        if course.ending.is_good() {
            course.reactions = simulation.reactions();
        }
        course.x.copy_from_slice(&simulation.state().x);
        course.t = simulation.state().t;
        course.cost.wall = clock.elapsed().as_secs_f64();
        Ok(course)
    }
}

/// The error behind an error of the step control.
fn cause(error: &StepError) -> &StepError {
    match error {
        StepError::StepTooSmall { cause, .. } => cause,
        _ => error,
    }
}

/// The ending by an error, with the names of the error and of its cause as they are in the code.
fn refused(error: &impl std::error::Error, cause: &impl std::fmt::Debug) -> Ending {
    let variant = |debug: String| {
        let end = debug.find(|c: char| !c.is_alphanumeric());
        debug[..end.unwrap_or(debug.len())].to_owned()
    };
    let (kind, cause) = (variant(format!("{error:?}")), variant(format!("{cause:?}")));
    Ending::Error {
        kind: if cause == kind {
            kind
        } else {
            format!("{kind} ({cause})")
        },
        message: error.to_string(),
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

    const PLAN: Plan = Plan {
        step: 0.01,
        duration: 0.1,
        rest_speed: None,
        patience: Duration::from_secs(60),
    };

    #[test]
    fn runs_end_complete_at_rest_out_of_time_or_with_an_error() {
        let course = falling().run(&PLAN).unwrap();
        assert_eq!(
            (course.ending.clone(), course.cost.steps),
            (Ending::Complete, 10)
        );
        // Damped methods of first and second order fall by g t^2 / 2 to within the order of a step.
        let [lowest, _] = course.heights();
        assert!((lowest + 0.049).abs() < 0.006, "{lowest}");
        let fast = Plan {
            rest_speed: Some(100.0),
            ..PLAN
        };
        let course = falling().run(&fast).unwrap();
        assert_eq!(
            (course.ending.clone(), course.cost.steps),
            (Ending::Rest, QUIET)
        );
        let hurried = Plan {
            patience: Duration::ZERO,
            ..PLAN
        };
        let course = falling().run(&hurried).unwrap();
        assert_eq!(
            (course.ending.name(), course.cost.steps),
            ("wall time over", 0)
        );
        let mut broken = falling();
        broken.start[0] += 0.1;
        let course = broken.run(&PLAN).unwrap();
        assert!(
            course.ending.name().starts_with("Start"),
            "{:?}",
            course.ending
        );
        assert!(!course.ending.is_good() && !course.ending.message().is_empty());
    }
}
