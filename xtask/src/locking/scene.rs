//! Runs of sheets from rest, and where they end.

use super::model::Model;
use crate::interrupt::Interrupted;
use crate::runs::{Course, Ending, Plan, unseen};
use isosheet_dynamics::{Method, Reaction, SheetModel, Simulation, State};
use isosheet_mesh::{Sheet, VertexId};

/// Rate of damping of scenes that come to rest, 1/s.
pub(super) const DAMPING: f64 = 4.0;

/// A sheet is at rest when no vertex is faster, metres per second. Halving the bound does not change the
/// first four digits of energies.
pub(super) const REST: f64 = 1e-5;

/// Until rest, in steps of 0.05 s of implicit Euler: long ones, which damp all motion. At most so many
/// simulated seconds.
pub(super) fn until_rest(duration: f64) -> Plan {
    Plan::new(0.05, duration).until_rest(REST)
}

/// How long a sheet of rods may take, seconds of the processor: one that locks and is held at fewer than two
/// vertices is not refused.
const PATIENCE: f64 = 60.0;

/// The end of a run.
#[derive(Clone, Debug)]
pub(super) struct End {
    /// Positions, metres; the start where no step was taken.
    pub(super) x: Vec<f64>,
    /// Forces of the supports in the last step of a run that reached its end.
    pub(super) reactions: Vec<Reaction>,
}

impl End {
    /// Mean of a coordinate of some vertices, metres.
    pub(super) fn mean(&self, vertices: &[VertexId], k: usize, of: fn(f64) -> f64) -> f64 {
        let values = vertices.iter().map(|v| of(self.x[3 * v.index() + k]));
        values.sum::<f64>() / vertices.len() as f64
    }
}

/// Runs a sheet from its rest shape at rest. An error of the solver is an ending like others, and not an
/// error of this function.
///
/// # Errors
/// [`Interrupted`].
pub(super) fn run(
    of: Model,
    model: SheetModel,
    sheet: &Sheet,
    method: Method,
    plan: &Plan,
) -> Result<(Course, End), Interrupted> {
    let plan = match of {
        Model::Rods => &plan.within(PATIENCE),
        Model::Material | Model::Elastic => plan,
    };
    let mut course = Course::default();
    let mut end = End {
        x: sheet.positions().to_vec(),
        reactions: Vec::new(),
    };
    match Simulation::new(model, State::at_rest(end.x.clone()), method) {
        Err(error) => course.ending = Ending::of(&error, &error),
        Ok(mut simulation) => {
            course = plan.run(&mut simulation, &mut unseen)?;
            end.x.copy_from_slice(&simulation.state().x);
            if course.is_good() {
                end.reactions = simulation.reactions();
            }
        }
    }
    Ok((course, end))
}

#[cfg(test)]
mod tests {
    use super::super::model::PAPER;
    use super::*;
    use isosheet_mesh::generate;

    #[test]
    fn runs_end_complete_or_with_an_error() {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let falling = |start: &Sheet, plan: &Plan| {
            let model = Model::Rods.sheet(&sheet, PAPER).unwrap().with_gravity();
            run(Model::Rods, model, start, Method::default(), plan).unwrap()
        };
        let plan = Plan::new(0.01, 0.1);
        let (course, end) = falling(&sheet, &plan);
        assert_eq!((&course.ending, course.cost.steps), (&Ending::Complete, 10));
        // Damped methods of first and second order fall by g t^2 / 2 to within the order of a step.
        let all: Vec<VertexId> = sheet.topology().vertex_ids().collect();
        let height = end.mean(&all, 2, |z| z);
        assert!((height + 0.049).abs() < 0.006, "{height}");
        let broken = sheet.map_positions(|[x, y, z]| [1.1 * x, y, z]).unwrap();
        let ending = falling(&broken, &plan).0.ending;
        assert!(ending.name().starts_with("Start"), "{ending:?}");
        assert!(!ending.message().is_empty());
    }
}
