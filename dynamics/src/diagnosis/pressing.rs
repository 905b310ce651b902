//! What presses the sheet where no step is found.

use crate::contact::{ContactState, ContactTerm, StepSpan};
use isosheet_model::Pressing;

/// Of the bodies that move on within a span of time from the state of the contacts, the one that the sheet
/// resists most: by the work of its present normal forces. Nothing if none moves into the sheet.
pub(crate) fn pressing(
    term: &mut ContactTerm,
    contacts: &ContactState,
    span: StepSpan,
) -> Option<Pressing> {
    let barrier = contacts.barrier;
    let points = term.shared_points();
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
        let vertex = contact.heaviest_vertex(points.as_deref());
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
