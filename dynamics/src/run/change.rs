//! Changes of what acts on a sheet, between two steps.

use crate::damped::start::{check_motions, check_state};
use crate::report::checkpoint_error::CheckpointError;
use crate::report::simulation_error::SimulationError;
use crate::run::simulation::Simulation;

impl Simulation {
    /// Completes a change of the model or the contact between two steps. This simulation has been resumed
    /// from the checkpoint of `before` with others: other loads, rest angles of creases, motions of pins and
    /// bodies. The sheet, its masses and the vertices that are held are the same, as a checkpoint asks for.
    ///
    /// What the change does at once is work, `E - E_before` with the energies of both at the present state,
    /// so that [`StepReport::energy_drift`](crate::StepReport::energy_drift) goes on without a jump. A change
    /// of nothing leaves every bit as it is.
    ///
    /// ```
    /// use isosheet_dynamics::{Method, ModelError, PointProfile, Profile, SheetModel, Simulation, State};
    /// use isosheet_mesh::{MassKind, VertexId, generate};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let sheet = generate::isotropic_square(1, 0.21)?;
    /// let model = |z: Profile| -> Result<SheetModel, ModelError> {
    ///     let offset = sheet.position(VertexId(20));
    ///     let hold = PointProfile { offset, z, ..PointProfile::default() };
    ///     let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)?.with_gravity();
    ///     model.with_moving_pin(VertexId(20), hold)
    /// };
    /// let start = State::at_rest(sheet.positions().to_vec());
    /// let mut simulation = Simulation::new(model(0.0.into())?, start, Method::default())?;
    /// simulation.step(0.01)?;
    ///
    /// // From now on the pin rises by 0.1 m/s.
    /// let rise = Profile::Ramp { from: 0.0, to: 0.1, begin: 0.01, end: 1.01 };
    /// let next = Simulation::resume(model(rise)?, None, simulation.checkpoint())?;
    /// simulation = next.changed_from(&simulation)?;
    /// simulation.step(0.01)?;
    /// assert!((simulation.state().x[62] - 1e-3).abs() < 1e-15);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`SimulationError::Start`] if the new motion of a support does not begin where its vertex is, or the
    /// state exceeds a new limit of the strain; [`SimulationError::Checkpoint`] if `before` is at another
    /// state.
    pub fn changed_from(mut self, before: &Self) -> Result<Self, SimulationError> {
        if self.state() != before.state() {
            let what = "time, positions or velocities";
            return Err(CheckpointError::OtherSheet { what }.into());
        }
        check_motions(self.model(), self.state())?;
        check_state(self.model(), self.state())?;
        self.count_work(self.energy() - before.energy());
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        Method, PointProfile, Profile, SheetModel, Simulation, SimulationError, State, StepError,
        VertexLoad,
    };
    use isosheet_mesh::{MassKind, Sheet, VertexId, generate};

    const STEP: f64 = 1.0 / 60.0;

    fn sheet() -> Sheet {
        generate::isotropic_square(1, 0.2).expect("a mesh")
    }

    /// A square with gravity whose corner is held and moves along z.
    fn hanging(gravity: f64, z: Profile) -> SheetModel {
        let sheet = sheet();
        let hold = PointProfile {
            offset: sheet.position(VertexId(20)),
            z,
            ..PointProfile::default()
        };
        let model = SheetModel::new(&sheet, 1e-3, MassKind::Lumped).expect("a model");
        let model = model.with_acceleration([0.0, 0.0, -gravity]);
        model.with_moving_pin(VertexId(20), hold).expect("a pin")
    }

    /// After three steps.
    fn moved(model: SheetModel) -> Simulation {
        let start = State::at_rest(sheet().positions().to_vec());
        let mut simulation = Simulation::new(model, start, Method::default()).expect("valid");
        for _ in 0..3 {
            simulation.step(STEP).expect("accepted");
        }
        simulation
    }

    fn changed(simulation: &Simulation, model: SheetModel) -> Result<Simulation, SimulationError> {
        Simulation::resume(model, None, simulation.checkpoint())?.changed_from(simulation)
    }

    #[test]
    fn a_change_of_nothing_leaves_every_bit() {
        let mut left = moved(hanging(9.81, 0.0.into()));
        let mut changed = changed(&left, hanging(9.81, 0.0.into())).expect("the same model");
        assert_eq!(changed.checkpoint(), left.checkpoint());
        for _ in 0..3 {
            assert_eq!(changed.step(STEP), left.step(STEP));
        }
        assert_eq!(changed.state(), left.state());
    }

    /// The potential energy jumps, and the energy balance does not.
    #[test]
    fn what_a_change_does_at_once_is_work() {
        let before = moved(hanging(9.81, 0.0.into()));
        let mut after = changed(&before, hanging(-3.0, 0.0.into())).expect("another gravity");
        let jump = after.energy() - before.energy();
        let step = |mut simulation: Simulation| simulation.step(STEP).expect("accepted");
        let kept = step(moved(hanging(9.81, 0.0.into())));
        let report = after.step(STEP).expect("accepted");
        assert!(jump.abs() > 1e-5, "{jump}");
        assert!(
            (report.work - kept.work - jump).abs() < 1e-3 * jump.abs(),
            "work {} after {}, jump {jump}",
            report.work,
            kept.work
        );
        assert!(report.energy_drift.abs() < 0.5 * jump.abs(), "{report:?}");
    }

    /// A free sheet in free fall on which a load acts from some time on: `dv = F / m dt`, exactly for
    /// implicit Euler.
    #[test]
    fn a_load_acts_from_the_change_on() {
        let sheet = sheet();
        let all: Vec<VertexId> = sheet.topology().vertex_ids().collect();
        let model = |size: f64| {
            let load = VertexLoad::new(sheet.topology(), &all, [1.0, 0.0, 0.0], size.into());
            let model = SheetModel::new(&sheet, 1e-3, MassKind::Consistent).expect("a model");
            model.with_force(load.expect("a load"))
        };
        let start = State::at_rest(sheet.positions().to_vec());
        let method = Method::ImplicitEuler(Default::default());
        let mut simulation = Simulation::new(model(0.0), start, method).expect("valid");
        simulation.step(0.1).expect("accepted");
        let mut simulation = changed(&simulation, model(2e-5)).expect("a load");
        simulation.step(0.1).expect("accepted");
        let momentum = simulation.model().linear_momentum(&simulation.state().v);
        let want = all.len() as f64 * 2e-5 * 0.1;
        assert!((momentum[0] - want).abs() < 1e-12, "{momentum:?}, {want}");
    }

    #[test]
    fn supports_do_not_jump_and_stay_the_same() {
        let before = moved(hanging(9.81, 0.0.into()));
        let error = changed(&before, hanging(9.81, 1e-3.into())).map(drop);
        assert!(
            matches!(error, Err(SimulationError::Start(StepError::OffSupport { distance, .. }))
                if (distance - 1e-3).abs() < 1e-12),
            "{error:?}"
        );
        let free = SheetModel::new(&sheet(), 1e-3, MassKind::Lumped).expect("a model");
        let error = changed(&before, free).map(drop);
        assert!(
            matches!(error, Err(SimulationError::Checkpoint(_))),
            "{error:?}"
        );
        let mut later = moved(hanging(9.81, 0.0.into()));
        later.step(STEP).expect("accepted");
        let error = later.changed_from(&before).map(drop);
        assert!(
            matches!(error, Err(SimulationError::Checkpoint(_))),
            "{error:?}"
        );
    }
}
