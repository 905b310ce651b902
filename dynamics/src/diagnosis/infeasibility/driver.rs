//! What a driver does.

use isosheet_model::Driver;

/// What a driver does between the state and the time for which positions are sought, at the minimum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drive {
    pub(super) by: Driver,
    /// The size of its force on the sheet, in units of stiffness times metres.
    pub(super) force: f64,
    /// The force times the displacement along it.
    pub(super) work: f64,
    /// How far it moves, metres.
    pub(super) displacement: f64,
}
