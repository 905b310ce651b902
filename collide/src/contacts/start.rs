//! Whether a simulation can start.

use super::evaluate::Placed;
use isosheet_dynamics::contact::{ActiveContact, ContactError, ContactPair};
use isosheet_geometry::vectors::gather;
use isosheet_geometry::{BroadPhase, ContactMesh, pierces};
use nalgebra::Vector3;

/// Refuses a contact whose gap is closed or not a number, naming the closest.
pub(super) fn check_gaps(contacts: &[ActiveContact], t: f64) -> Result<(), ContactError> {
    let mut worst: Option<&ActiveContact> = None;
    for contact in contacts {
        let closed = contact.gap <= 0.0 || contact.gap.is_nan();
        if closed && worst.is_none_or(|w| contact.gap < w.gap) {
            worst = Some(contact);
        }
    }
    match worst {
        Some(contact) => Err(ContactError::Touching {
            pair: name(contact),
            gap: contact.gap,
            t,
        }),
        None => Ok(()),
    }
}

/// The vertices of largest weight on both sides.
fn name(contact: &ActiveContact) -> ContactPair {
    let heaviest = |sign: f64| {
        let mut best = 0;
        for i in 1..4 {
            if sign * contact.weights[i] > sign * contact.weights[best] {
                best = i;
            }
        }
        contact.vertices[best]
    };
    match contact.key.body {
        Some(body) => ContactPair::Body {
            vertex: heaviest(1.0),
            body: body as usize,
        },
        None => ContactPair::Sheet {
            first: heaviest(1.0),
            second: heaviest(-1.0),
        },
    }
}

/// Refuses edges of the sheet that pass through its faces, with the pair.
pub(super) fn check_itself(boxes: &mut BroadPhase, x: &[f64]) -> Result<(), ContactPair> {
    let Some([edge, face]) = boxes.self_crossing(x, 0.0) else {
        return Ok(());
    };
    let mesh = boxes.mesh();
    Err(ContactPair::Sheet {
        first: mesh.edges()[edge as usize][0],
        second: mesh.faces()[face as usize][0],
    })
}

/// Refuses a sheet that is inside a solid or passes through its surface, with the pair and its gap. Inside a
/// convex body a gap is negative; this finds edges and faces that run through with their corners outside.
/// `meets_bodies` says of a vertex whether what has it is looked at.
pub(super) fn check_body(
    number: usize,
    Placed { body, place }: Placed<'_>,
    segments: usize,
    boxes: &BroadPhase,
    x: &[f64],
    meets_bodies: impl Fn(u32) -> bool,
) -> Result<(), (ContactPair, f64)> {
    let shape = body.obstacle().shape();
    let touching = |vertex, gap| {
        let body = number;
        (ContactPair::Body { vertex, body }, gap)
    };
    if shape.is_solid() && !shape.is_convex() {
        let vertices = (0..).zip(x.as_chunks::<3>().0);
        for (v, p) in vertices.filter(|(v, _)| meets_bodies(*v)) {
            let local = place.to_local(&Vector3::from(*p));
            let gap = shape.signed_distance(&local).value;
            if gap <= 0.0 {
                return Err(touching(v, gap));
            }
        }
    }
    let Ok(Some(geometry)) = shape.contact_geometry(segments) else {
        return Ok(());
    };
    let mut places = geometry.positions;
    for p in places.as_chunks_mut::<3>().0 {
        *p = place.to_space(&Vector3::from(*p)).into();
    }
    let other = BroadPhase::new(geometry.mesh, &places);
    let mut pairs = Vec::new();
    let (sheet, solid): (&ContactMesh, &ContactMesh) = (boxes.mesh(), other.mesh());
    boxes.edge_faces_with(&other, &mut pairs);
    for &[e, f] in &pairs {
        let (edge, face) = (sheet.edges()[e as usize], solid.faces()[f as usize]);
        if meets_bodies(edge[0]) && pierces(gather(x, edge), gather(&places, face)) {
            return Err(touching(edge[0], 0.0));
        }
    }
    other.edge_faces_with(boxes, &mut pairs);
    for &[e, f] in &pairs {
        let (edge, face) = (solid.edges()[e as usize], sheet.faces()[f as usize]);
        if meets_bodies(face[0]) && pierces(gather(&places, edge), gather(x, face)) {
            return Err(touching(face[0], 0.0));
        }
    }
    Ok(())
}
