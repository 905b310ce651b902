//! Sheets of several materials.

use crate::meshes::selection::InPlace;
use crate::sheets::patch::Patch;
use crate::sheets::sheet::{Bending, SheetKey};
use crate::words::key::Key;
use crate::words::problem::{Checks, Problem};
use crate::words::unit::Unit;
use isosheet_dynamics::Patched;

/// Checks the patches of a sheet.
pub(crate) fn check(sheet: &SheetKey, key: &Key, checks: &mut Checks) {
    for (key, patch) in key.name("patch").entries(&sheet.patch) {
        check_patch(patch, sheet, &key, checks);
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

fn check_patch(patch: &Patch, sheet: &SheetKey, key: &Key, checks: &mut Checks) {
    let before = checks.problems.len();
    patch.material.check(&key.name("material"), checks);
    let density = patch.density;
    checks.positive(key.name("density"), density, Unit::KilogramPerSquareMetre);
    if let Some(direction) = &patch.direction {
        checks.direction(key.name("direction"), direction);
    }
    if checks.problems.len() > before {
        return;
    }
    let own = sheet.of_patch(patch);
    let has_directions = own.made_of().is_some_and(|m| m.directions.is_some());
    if patch.direction.is_some() && !has_directions {
        checks.report(
                key.name("direction"),
                "the material of the patch does not depend on a direction",
                "leave it out, or give a material that has two directions (docs/materials.md says which)",
            );
    }
    if own.direction.is_none() && patch.material.needs_direction() {
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

/// A sheet in its place, and what its patches are as sheets.
pub(crate) fn patched(
    sheet: &SheetKey,
    place: &InPlace<'_>,
    key: &Key,
) -> Result<Patched<SheetKey>, Problem> {
    let mut all = Patched::everywhere(sheet.clone());
    for (key, patch) in key.name("patch").entries(&sheet.patch) {
        let at = key.name("at");
        let faces = patch.at.faces(&at, place)?;
        all = all.with_patch(faces, sheet.of_patch(patch));
    }
    Ok(all)
}
