//! Changes of what holds a sheet, between two steps.

use crate::SheetModel;
use crate::contact::Contact;
use crate::damped::start::{check_motions, check_state};
use crate::report::simulation_error::SimulationError;
use crate::run::checkpoint::SheetFingerprint;
use crate::run::simulation::{MOTION_SPAN, Moved, Simulation};

impl Simulation {
    /// Goes on from the present state with another model and contact of the same sheet: its supports, its
    /// glue and what touches may be others. For BDF2 and implicit Euler.
    ///
    /// Vertices that are pinned from now on stay where they are, and take the velocity of their pin at once;
    /// until the next step there are no forces of supports. What the change does to the energy at once is
    /// work, `E - E_before`: released glue gives up what it has stored, and a pin that catches a vertex takes
    /// its kinetic energy.
    ///
    /// ```
    /// use isosheet_dynamics::{Method, ModelError, SheetModel, Simulation, State};
    /// use isosheet_mesh::{MassKind, VertexId, generate};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let sheet = generate::isotropic_square(1, 0.21)?;
    /// let free = || SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped).map(SheetModel::with_gravity);
    /// let held = free()?.with_pins(&[VertexId(20)])?;
    /// let start = State::at_rest(sheet.positions().to_vec());
    /// let mut simulation = Simulation::new(held, start, Method::default())?;
    /// simulation.step(0.01)?;
    /// let z = simulation.state().x[62];
    ///
    /// // From now on the sheet falls.
    /// simulation.hold_by(free()?, None)?;
    /// simulation.step(0.01)?;
    /// assert!(simulation.state().x[62] < z);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`SimulationError`]; then nothing has changed. [`SimulationError::Start`] if a support is not where
    /// its vertex is, [`SimulationError::Contact`] if something touches that did not meet before,
    /// [`SimulationError::Checkpoint`] if the model is that of another sheet.
    pub fn hold_by(
        &mut self,
        model: SheetModel,
        contact: Option<Box<dyn Contact>>,
    ) -> Result<(), SimulationError> {
        let sheet = SheetFingerprint::of(&model);
        self.sheet.check_sheet(&sheet)?;
        let Moved::ByMethod(engine) = &self.engine else {
            return Err(SimulationError::Held);
        };
        if !engine.is_minimising() {
            return Err(SimulationError::Held);
        }
        check_motions(&model, self.state())?;
        check_state(&model, self.state())?;
        let next = engine.held_by(model, contact, MOTION_SPAN)?;
        let before = self.energy();
        self.engine = Moved::ByMethod(Box::new(next));
        self.sheet = sheet;
        self.count_work(self.energy() - before);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        Checkpoint, CheckpointError, Glue, Method, SheetModel, Simulation, SimulationError, State,
    };
    use isosheet_mesh::{MassKind, Sheet, VertexId, generate};

    const STEP: f64 = 1e-3;

    fn sheet() -> Sheet {
        generate::isotropic_square(1, 0.2).expect("a mesh")
    }

    fn model(pins: &[u32]) -> SheetModel {
        let pins: Vec<VertexId> = pins.iter().copied().map(VertexId).collect();
        let model = SheetModel::new(&sheet(), 1e-3, MassKind::Lumped).expect("a model");
        model.with_gravity().with_pins(&pins).expect("pins")
    }

    fn simulation(model: SheetModel) -> Simulation {
        let start = State::at_rest(sheet().positions().to_vec());
        Simulation::new(model, start, Method::default()).expect("valid")
    }

    fn centre(simulation: &Simulation) -> f64 {
        let x = simulation.state().x.as_chunks::<3>().0;
        let masses = &simulation.model().mass().vertex;
        let moment: f64 = x.iter().zip(masses).map(|(p, m)| p[2] * m).sum();
        moment / masses.iter().sum::<f64>()
    }

    /// A flat sheet that is pinned everywhere lies still; once the pins let go it falls as one that starts
    /// there, and its energy balance has no more error.
    #[test]
    fn a_released_sheet_falls_as_one_that_starts_there() {
        let mut released = simulation(model(&(0..25).collect::<Vec<_>>()));
        for _ in 0..5 {
            released.step(STEP).expect("accepted");
        }
        released.hold_by(model(&[]), None).expect("released");
        assert!(released.reactions().is_empty());
        let mut free = simulation(model(&[]));
        for _ in 0..20 {
            let report = released.step(STEP).expect("accepted");
            let as_free = free.step(STEP).expect("accepted");
            let error = report.energy_drift - as_free.energy_drift;
            assert!(error.abs() < 1e-9 * report.kinetic, "{report:?}");
        }
        assert!((centre(&released) - centre(&free)).abs() < 1e-14);
        assert!(released.reactions().is_empty());
    }

    /// A falling sheet is caught: its kinetic energy goes into the pins.
    #[test]
    fn caught_vertices_give_up_their_kinetic_energy() {
        let all: Vec<u32> = (0..25).collect();
        let mut caught = simulation(model(&[]));
        for _ in 0..20 {
            caught.step(STEP).expect("accepted");
        }
        let state = caught.state();
        let (kinetic, z) = (caught.model().kinetic_energy(&state.v), state.x[2]);
        assert!(kinetic > 1e-6);
        caught.hold_by(model(&all), None).expect("caught");
        let report = caught.step(STEP).expect("accepted");
        assert_eq!((report.kinetic, caught.state().x[2]), (0.0, z));
        assert!((report.work + kinetic).abs() < 1e-15, "{report:?}");
        let weight = caught.reactions().iter().map(|r| r.force.z).sum::<f64>();
        assert!((weight - 9.8e-3).abs() < 1e-12, "{weight}");
    }

    /// Springs between two pinned squares, drawn out by `d`, give up `k d^2 / 2` each when they let go.
    #[test]
    fn released_glue_gives_up_what_it_has_stored() {
        let (stiffness, d) = (10.0, 0.1);
        let lower = sheet().map_positions(|[x, y, z]| [x, y, z - d]);
        let two = Sheet::union(&[&sheet(), &lower.expect("moved")]).expect("two squares");
        let pins: Vec<VertexId> = (0..50).map(VertexId).collect();
        let held = || {
            let model = SheetModel::new(&two, 2e-3, MassKind::Lumped).expect("a model");
            model.with_pins(&pins).expect("pins")
        };
        let pairs: Vec<[VertexId; 2]> = (0..25).map(|v| [VertexId(v), VertexId(v + 25)]).collect();
        let glue = Glue::new(two.topology(), &pairs, stiffness, 1.0, two.positions());
        let start = State::at_rest(two.positions().to_vec());
        let glued = held().with_potential(glue.expect("glue"));
        let mut simulation = Simulation::new(glued, start, Method::default()).expect("valid");
        simulation.step(STEP).expect("accepted");
        simulation.hold_by(held(), None).expect("released");
        let report = simulation.step(STEP).expect("accepted");
        let stored = 25.0 * 0.5 * stiffness * d * d;
        assert!((report.work + stored).abs() < 1e-12 * stored, "{report:?}");
        assert_eq!((report.potential, report.energy_drift), (0.0, 0.0));
    }

    #[test]
    fn a_simulation_goes_on_with_the_same_bits_from_a_checkpoint_after_a_release() {
        let mut left = simulation(model(&[0, 20]));
        left.set_note(vec![1, 2]);
        left.step(STEP).expect("accepted");
        left.hold_by(model(&[20]), None).expect("released");
        for _ in 0..2 {
            let bytes = left.checkpoint().to_bytes().expect("encoded");
            let checkpoint = Checkpoint::from_bytes(&bytes).expect("decoded");
            assert_eq!(checkpoint.note(), [1, 2]);
            let mut resumed = Simulation::resume(model(&[20]), None, checkpoint).expect("same");
            for _ in 0..3 {
                assert_eq!(resumed.step(STEP), left.step(STEP));
            }
            assert_eq!(resumed.checkpoint(), left.checkpoint());
        }
    }

    #[test]
    fn other_sheets_and_methods_without_minima_are_refused() {
        let mut simulation = simulation(model(&[0]));
        let other = SheetModel::new(&sheet(), 2e-3, MassKind::Lumped).expect("a model");
        let before = simulation.checkpoint();
        let refused = simulation.hold_by(other, None);
        assert!(
            matches!(refused, Err(SimulationError::Checkpoint(CheckpointError::OtherSheet { what })) if what == "masses")
        );
        assert_eq!(simulation.checkpoint(), before);
        let start = State::at_rest(sheet().positions().to_vec());
        let method = Method::EnergyMomentum(Default::default());
        let mut conserving = Simulation::new(model(&[0]), start, method).expect("valid");
        assert_eq!(
            conserving.hold_by(model(&[]), None),
            Err(SimulationError::Held)
        );
    }
}
