//! The scenes: a sheet that hangs by a corner, and a tablecloth.

use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, Sheet};
use isosheet_tests::{bumped, corner};
use nalgebra::Isometry3;
use serde::Deserialize;

/// Height of the bump, metres: nearly flat, so that the length constraints are nearly dependent.
const BUMP: f64 = 1e-3;

/// Step, seconds.
pub(crate) const STEP: f64 = 1.0 / 60.0;

/// Height of the sheet's rim above the table, metres.
const CLEARANCE: f64 = 1e-3;

/// Half of the table's side, half of its thickness, metres.
const TABLE: [f64; 3] = [0.25, 0.25, 0.1];

/// Mass of the sheet, kilograms.
const MASS: f64 = 0.1;

/// Which pairs repel each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Pairs {
    /// Sheet and table.
    Table,
    /// Sheet and table, and the sheet with itself.
    TableAndItself,
}

/// A scene that other programs have been measured on, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Bumped {
    /// A nearly flat sheet held at a corner, one second.
    Hanging,
    /// A nearly flat, free sheet above a table, 1.5 seconds.
    Tablecloth(Pairs),
}

impl Bumped {
    /// Simulated time, seconds.
    pub(crate) fn duration(self) -> f64 {
        match self {
            Self::Hanging => 1.0,
            Self::Tablecloth(_) => 1.5,
        }
    }

    /// The sheet `M^level` at the start of the scene.
    pub(crate) fn start(self, level: u32, method: Method) -> Result<Simulation> {
        match self {
            Self::Hanging => hanging(level, BUMP, method),
            Self::Tablecloth(pairs) => tablecloth(&bumped(level, BUMP), pairs, method),
        }
    }
}

/// The sheet `M^level` with a bump of the given height (metres), held at its corner.
fn hanging(level: u32, bump: f64, method: Method) -> Result<Simulation> {
    let sheet = bumped(level, bump);
    let model = SheetModel::new(&sheet, MASS, MassKind::Lumped)?
        .with_gravity()
        .with_pins(&[corner(level)])?;
    let start = State::at_rest(sheet.positions().to_vec());
    Ok(Simulation::new(model, start, method)?)
}

/// The sheet above the table.
fn tablecloth(sheet: &Sheet, pairs: Pairs, method: Method) -> Result<Simulation> {
    let model = SheetModel::new(sheet, MASS, MassKind::Lumped)?.with_gravity();
    let options = ContactOptions::for_sheet(&model);
    let contacts = on_table(&model, options, (TABLE, -CLEARANCE), pairs)?;
    let start = State::at_rest(sheet.positions().to_vec());
    Ok(Simulation::new(model, start, method)?.with_contact(contacts)?)
}

/// Frictionless contact of a sheet with a box under the middle of the square `[0, 1]^2`: half of its
/// sides, and the height of its top, metres.
fn on_table(
    model: &SheetModel,
    options: ContactOptions,
    (half, top): ([f64; 3], f64),
    pairs: Pairs,
) -> Result<Contacts> {
    let pose = Isometry3::translation(0.5, 0.5, top - half[2]);
    let table = Obstacle::fixed(Shape::Cuboid { half }, pose)?;
    let contacts = Contacts::new(model, options)?.with_body(table, Coefficients::FRICTIONLESS)?;
    Ok(match pairs {
        Pairs::Table => contacts,
        Pairs::TableAndItself => contacts.with_self_contact(Coefficients::FRICTIONLESS)?,
    })
}
