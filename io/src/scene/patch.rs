//! Parts of a sheet that are of another material.

use super::key::Key;
use super::material::Material;
use super::placed::Form;
use super::problem::{Checks, Problem};
use super::selection::Selection;
use super::sheet::{Bending, Isometry, Sheet};
use super::unit::Unit;
use isosheet_dynamics::Patched;
use isosheet_mesh::{FaceId, VertexId};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A part of a sheet that is of another material: a label, a reinforcement, a stiff board in a soft cover. Mass, stiffness in
/// the plane and in bending, and the yield are those of its material; the distance of contact is that of the sheet.
/// Where patches overlap, the last one counts.
///
/// ```toml
/// [sheet]
/// material = "office paper"
///
/// [[sheet.patch]]
/// at = { box = { min = [0.05, 0, -1], max = [0.1, 0.05, 1] } }
/// material = "card"
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Patch {
    /// Its faces: those all corners of which are selected.
    pub at: Selection,
    /// What it is made of.
    pub material: Material,
    /// The direction of its material, in the frame of the mesh. If left out, that of the sheet.
    #[serde(default)]
    pub direction: Option<[f64; 3]>,
    /// Mass of a square metre, kg/m2. If left out, that of its material.
    #[serde(default)]
    pub density: Option<f64>,
}

impl Patch {
    /// The largest strain that its material may have, if that is known.
    pub(super) fn strain_limit(&self, sheet: &Sheet) -> Option<f64> {
        self.as_sheet(sheet).made_of().map(|m| m.strain_limit)
    }

    /// A sheet that is as the patch all over.
    fn as_sheet(&self, sheet: &Sheet) -> Sheet {
        Sheet {
            material: Some(self.material.clone()),
            direction: self.direction.or(sheet.direction),
            density: self.density,
            isometry: match sheet.isometry() {
                Isometry::Rods => Some(Isometry::Rods),
                Isometry::Elastic { .. } => None,
            },
            bending: None,
            patch: Vec::new(),
            ..sheet.clone()
        }
    }

    fn check(&self, sheet: &Sheet, key: &Key, checks: &mut Checks) {
        let before = checks.problems.len();
        self.at.check(&key.name("at"), checks);
        self.material.check(&key.name("material"), checks);
        let density = self.density;
        checks.positive(key.name("density"), density, Unit::KilogramPerSquareMetre);
        if let Some(direction) = &self.direction {
            checks.direction(key.name("direction"), direction);
        }
        if checks.problems.len() > before {
            return;
        }
        let own = self.as_sheet(sheet);
        let has_directions = own.made_of().is_some_and(|m| m.directions.is_some());
        if self.direction.is_some() && !has_directions {
            checks.report(
                key.name("direction"),
                "the material of the patch does not depend on a direction",
                "leave it out, or give a material that has two directions (docs/materials.md says which)",
            );
        }
        if own.direction.is_none() && self.material.needs_direction() {
            checks.report(
                key.name("material"),
                "the material is stiffer along a direction, and the patch has none",
                "give it a `direction`, for instance [1, 0, 0]",
            );
        }
        if sheet.yields.is_some() && own.yields().is_none() {
            checks.report(
                key.name("material"),
                "the sheet yields, and nothing says when the material of the patch does",
                "give `moment` in `sheet.yield`, or a material of which docs/materials.md says when it yields",
            );
        }
    }
}

/// Checks the patches of a sheet.
pub(super) fn check(sheet: &Sheet, key: &Key, checks: &mut Checks) {
    for (key, patch) in key.name("patch").entries(&sheet.patch) {
        patch.check(sheet, &key, checks);
    }
    let key = key.name("patch");
    let is_known = sheet.material.is_none() || sheet.made_of().is_some();
    let has_plate = !matches!(sheet.bending(), Bending::None | Bending::Hinges { .. });
    if !sheet.patch.is_empty() && is_known && !has_plate {
        checks.report(
            key.clone(),
            "the sheet has patches, and no plate resists bending outside of them",
            "give `sheet.bending` as a `plate`, or `sheet.material`",
        );
    }
    if !sheet.patch.is_empty() && sheet.mass.is_some() {
        checks.report(
            key,
            "the sheet has a mass as a whole, and patches of masses of their own",
            "give `density` in place of `mass`",
        );
    }
}

/// A sheet, and what its patches are as sheets.
pub(super) fn patched(sheet: &Sheet, form: &Form, key: &Key) -> Result<Patched<Sheet>, Problem> {
    let mut all = Patched::everywhere(sheet.clone());
    for (key, patch) in key.name("patch").entries(&sheet.patch) {
        let topology = form.placed.topology();
        let at = key.name("at");
        let vertices = patch.at.resolve(&at, topology, form.start())?;
        let is_inside = |v: &VertexId| vertices.binary_search(v).is_ok();
        let faces = topology.face_ids().zip(topology.faces());
        let faces: Vec<FaceId> = faces
            .filter(|(_, corners)| corners.iter().all(is_inside))
            .map(|(face, _)| face)
            .collect();
        if faces.is_empty() {
            return Err(Problem::new(
                at,
                "no face of the sheet has all its corners here",
                "choose a larger region, or a finer mesh",
            ));
        }
        all = all.with_patch(faces, patch.as_sheet(sheet));
    }
    Ok(all)
}
