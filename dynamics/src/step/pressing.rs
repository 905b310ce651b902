//! What presses the sheet where no step is found.

use crate::contact::{ContactState, ContactTerm, StepSpan};
use isosheet_mesh::VertexId;
use isosheet_mesh::wording::{brief, listed};
use std::fmt;

/// A body that moves against the resistance of the sheet.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Pressing {
    /// Its number.
    pub body: usize,
    /// The sum of its normal forces on the sheet at the last accepted state, newtons.
    pub force: f64,
    /// The vertices that it touches, those with the largest forces first.
    pub vertices: Vec<VertexId>,
    /// The other bodies that the sheet touches.
    pub against: Vec<usize>,
}

impl fmt::Display for Pressing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let force = brief(self.force);
        write!(f, "body {} presses the sheet with {force} N", self.body)?;
        for (k, other) in self.against.iter().enumerate() {
            let link = if k == 0 { "against body" } else { "and body" };
            write!(f, " {link} {other}")?;
        }
        write!(f, " at {}", listed(&self.vertices))
    }
}

/// Of the bodies that move on within a span of time from the state of the contacts, the one that the sheet
/// resists most: by the work of its present normal forces. Nothing if none moves into the sheet.
pub(crate) fn pressing(
    term: &mut ContactTerm,
    contacts: &ContactState,
    span: StepSpan,
) -> Option<Pressing> {
    let barrier = contacts.barrier;
    let motions = term.motions(span).list();
    let mut work = vec![0.0; motions.len()];
    let touching: Vec<_> = contacts
        .active
        .list()
        .iter()
        .filter_map(|contact| {
            let body = contact.key.body? as usize;
            Some((contact, body, contact.force(&barrier)))
        })
        .collect();
    for (contact, body, force) in &touching {
        let shift = motions[*body].surface.displacement(&contact.closest);
        work[*body] += force * shift.dot(&contact.normal).max(0.0);
    }
    let body = (0..work.len()).max_by(|a, b| work[*a].total_cmp(&work[*b]))?;
    if work[body] <= 0.0 {
        return None;
    }
    let mut own: Vec<_> = touching.iter().filter(|(_, b, _)| *b == body).collect();
    own.sort_by(|a, b| b.2.total_cmp(&a.2));
    let mut vertices = Vec::new();
    for (contact, ..) in &own {
        let vertex = contact.heaviest_vertex();
        if !vertices.contains(&vertex) {
            vertices.push(vertex);
        }
    }
    let mut against: Vec<usize> = touching.iter().map(|(_, b, _)| *b).collect();
    against.sort_unstable();
    against.dedup();
    against.retain(|b| *b != body);
    Some(Pressing {
        body,
        force: own.iter().map(|(.., force)| force).sum(),
        vertices,
        against,
    })
}
