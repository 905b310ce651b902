//! What a simulation tells, in plain arrays.

use super::simulation::Simulation;
use crate::Support;

impl Simulation {
    /// The forces of [`Simulation::reactions`] as arrays: of each support on the sheet, newtons.
    ///
    /// With damped methods a call costs one factorisation.
    pub fn support_forces(&self) -> Vec<(Support, [f64; 3])> {
        let reactions = self.reactions().into_iter();
        reactions.map(|r| (r.support, r.force.into())).collect()
    }

    /// The forces of [`Simulation::body_loads`] as arrays: of the sheet on each obstacle, newtons, in the
    /// order in which the obstacles were added. Empty without contact and in charts.
    pub fn obstacle_forces(&self) -> Vec<[f64; 3]> {
        let loads = self.body_loads().into_iter();
        loads.map(|load| load.force.into()).collect()
    }
}
