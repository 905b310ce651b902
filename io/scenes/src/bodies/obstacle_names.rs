//! Names of obstacles.

use crate::bodies::body;
use crate::words::key::Key;
use crate::words::problem::Checks;
use crate::{BodyKey, ObstacleKey, SheetKey};

/// The number of the obstacle of a name.
pub(crate) fn number_of(obstacles: &[ObstacleKey], name: &str) -> Option<usize> {
    obstacles
        .iter()
        .position(|obstacle| obstacle.name.as_deref() == Some(name))
}

/// Checks that nothing else has the name of an obstacle.
pub(crate) fn check_names(
    all: &[ObstacleKey],
    sheets: &[SheetKey],
    bodies: &[BodyKey],
    checks: &mut Checks,
) {
    for (k, (key, obstacle)) in Key::root().name("obstacle").entries(all).enumerate() {
        let Some(name) = &obstacle.name else {
            continue;
        };
        let is_other = number_of(all, name) != Some(k)
            || body::number_of(bodies, name).is_some()
            || sheets.iter().any(|sheet| sheet.name.as_ref() == Some(name));
        if is_other {
            let message = format!("another obstacle, body or sheet has the name `{name}`, too");
            let remedy = "give each obstacle a `name` of its own, or none";
            checks.report(key.name("name"), message, remedy);
        }
        if name.is_empty() {
            checks.report(key.name("name"), "the name is empty", "leave it out");
        }
    }
}
