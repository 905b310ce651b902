//! Supports and bodies that ask for more than the lengths allow.

mod driver;
mod fit;
mod gaps;

use crate::contact::{ContactState, ContactTerm};
use crate::{SheetModel, State};
use fit::{Fit, ROD_STIFFNESS};
use gaps::Gaps;
use isosheet_model::Infeasibility;

/// Looks for positions with the rest lengths or strains within the limit, with the supports and bodies where
/// they are at time `t` and with gaps that are not negative, and says by how much they fail to exist.
///
/// The least squares
///
/// ```text
/// E = sum_e p_e c_e^2 / 2                               rods, with the length errors c_e
///   + sum_T A_T k max(0, |E_T| - m)^2 / 2               elastic sheets with the limit m of the strain
///   + sum_c q min(0, g_c)^2 / 2                         contacts with bodies, with the gaps g_c
/// ```
///
/// are minimised by Newton's method from the state; the gaps belong to the contacts at the state, linearised.
/// Where the minimum is not zero its forces are in equilibrium at all free vertices: by Farkas' lemma for the
/// linearised lengths and gaps no small motion meets them. Twice the energy is the sum of force times
/// violation, so that the part `2 E / W` of the motions is too much, where `W` is the work of the forces of
/// all that moves over its motion.
pub(crate) fn infeasibility(
    model: &SheetModel,
    contact: Option<(&mut ContactTerm, &ContactState)>,
    state: &State,
    t: f64,
) -> Option<Infeasibility> {
    let gaps = contact.map_or_else(Gaps::default, |(term, contacts)| {
        Gaps::of(term, contacts, state, t, ROD_STIFFNESS * model.mean_mass())
    });
    let fit = Fit::new(model, state, t, gaps)?.minimised()?;
    let (by, distance) = fit.demand()?;
    let (pressed, bodies) = fit.pressed(by);
    Some(Infeasibility {
        by,
        distance,
        t,
        strain_limit: fit.strain_limit(),
        pressed,
        against: bodies,
    })
}
