//! A part of a sheet that is of another material.

use crate::meshes::selection::Selection;
use crate::sheets::material::MaterialKey;
use crate::words::part::Part;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A part of a sheet with another material: a label, a reinforcement, a stiff board in a soft cover. It has
/// the mass, the stiffness in the plane and in bending, and the yield of its material, and the thickness of
/// the sheet in contact. Where patches overlap, the last one counts.
///
/// ```toml
/// [sheet]
/// material = "office paper"
///
/// [[sheet.patch]]
/// at = { box = { min = [0.05, 0, -1], max = [0.1, 0.05, 1] } }
/// material = "card"
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Patch {
    /// Its faces: faces by number or of a group, or otherwise faces whose corners are all selected.
    pub at: Selection,
    /// What it is made of.
    pub material: MaterialKey,
    /// The direction of its material, in the frame of the mesh. By default the direction of the sheet.
    #[serde(default)]
    pub direction: Option<[f64; 3]>,
    /// Mass of a square metre, kg/m2. By default the mass of its material.
    #[serde(default)]
    pub density: Option<f64>,
}
