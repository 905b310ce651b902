//! Supports and bodies that ask for more than the lengths allow.

mod driver;
mod fit;
mod gaps;

use crate::contact::{ContactState, ContactTerm};
use crate::{SheetModel, State};
pub use driver::Driver;
use fit::{Fit, ROD_STIFFNESS};
use gaps::Gaps;
use isosheet_mesh::VertexId;
use isosheet_mesh::wording::{brief, given, listed};
use std::fmt;

/// A demand that cannot be met.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct Infeasibility {
    /// Of what moves, that which does most of the work.
    pub by: Driver,
    /// How far it would have to stay back for the lengths and gaps to be kept, to first order; metres.
    pub distance: f64,
    /// When it asks for this, seconds.
    pub t: f64,
    /// The limit of the strain, which an elastic sheet keeps in place of lengths.
    pub strain_limit: Option<f64>,
    /// The vertices that bodies press, those pressed most first.
    #[serde(serialize_with = "as_numbers")]
    pub pressed: Vec<VertexId>,
    /// The other bodies that press the sheet.
    pub against: Vec<usize>,
}

fn as_numbers<S: serde::Serializer>(vertices: &[VertexId], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(vertices.iter().map(|v| v.0))
}

impl fmt::Display for Infeasibility {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} asks", self.by)?;
        if !self.pressed.is_empty() {
            write!(f, " at {}", listed(&self.pressed))?;
        }
        write!(f, " for {} m more than ", brief(self.distance))?;
        match self.strain_limit {
            Some(limit) => write!(f, "the strain limit of {}", given(limit))?,
            None => f.write_str("the rods")?,
        }
        if let Some((last, first)) = self.against.split_last() {
            let plural = if first.is_empty() { "body" } else { "bodies" };
            let numbers = first
                .iter()
                .map(|body| format!("{body}, "))
                .collect::<String>();
            write!(f, " and {plural} {numbers}{last}")?;
        }
        let allows = match self.strain_limit {
            Some(_) if self.against.is_empty() => "allows",
            _ => "allow",
        };
        write!(f, " {allows} at t = {} s", brief(self.t))
    }
}

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
/// are minimised by Newton's method from the state; the gaps are those of the contacts at the state,
/// linearised. Where the minimum is not zero its forces are in equilibrium at all free vertices: by Farkas'
/// lemma for the linearised lengths and gaps no small motion meets them. Twice the energy is the sum of force
/// times violation, so that the part `2 E / W` of the motions is too much, where `W` is the work of the forces
/// of all that moves over its motion.
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
        strain_limit: model.elastic_sheet().map(|sheet| sheet.limit()),
        pressed,
        against: bodies,
    })
}
