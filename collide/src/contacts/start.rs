//! Whether a simulation can start.

use super::body::{Body, point};
use super::touch::Touch;
use crate::narrow_phase::{gather, pierces};
use crate::{BroadPhase, ContactMesh, Shape};
use isosheet_dynamics::contact::{ContactError, ContactPair};
use nalgebra::Vector3;

/// Refuses a contact whose gap is closed or not a number, naming the closest.
pub(super) fn check_gaps(touches: &[Touch], t: f64) -> Result<(), ContactError> {
    let mut worst: Option<&Touch> = None;
    for touch in touches {
        let closed = touch.gap <= 0.0 || touch.gap.is_nan();
        if closed && worst.is_none_or(|w| touch.gap < w.gap) {
            worst = Some(touch);
        }
    }
    match worst {
        Some(touch) => Err(ContactError::Touching {
            pair: name(touch),
            gap: touch.gap,
            t,
        }),
        None => Ok(()),
    }
}

/// The vertices of largest weight on both sides.
fn name(touch: &Touch) -> ContactPair {
    let heaviest = |sign: f64| {
        let mut best = 0;
        for i in 1..4 {
            if sign * touch.weights[i] > sign * touch.weights[best] {
                best = i;
            }
        }
        touch.vertices[best]
    };
    match touch.key.body {
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

fn crossing(pair: ContactPair, t: f64) -> ContactError {
    ContactError::Touching { pair, gap: 0.0, t }
}

/// Refuses edges of the sheet that pass through its faces.
pub(super) fn check_itself(boxes: &mut BroadPhase, x: &[f64], t: f64) -> Result<(), ContactError> {
    let mut pairs = Vec::new();
    boxes.self_edge_faces(&mut pairs);
    let mesh = boxes.mesh();
    for [e, f] in pairs {
        let (edge, face) = (mesh.edges()[e as usize], mesh.faces()[f as usize]);
        if pierces(gather(x, edge), gather(x, face)) {
            let pair = ContactPair::Sheet {
                first: edge[0],
                second: face[0],
            };
            return Err(crossing(pair, t));
        }
    }
    Ok(())
}

/// Refuses a sheet that is inside a solid or passes through its surface at progress 1. Inside a convex
/// body a gap is negative; this finds edges and faces that run through with their corners outside.
pub(super) fn check_body(
    body: &Body,
    number: usize,
    boxes: &BroadPhase,
    x: &[f64],
    segments: usize,
    t: f64,
) -> Result<(), ContactError> {
    let shape = body.obstacle().shape();
    let named = |vertex| ContactPair::Body {
        vertex,
        body: number,
    };
    if let Shape::Surface(surface) = shape
        && surface.is_closed()
    {
        for v in 0..(x.len() / 3) as u32 {
            let gap = surface.signed_distance(&body.local(&point(x, v))).value;
            if gap <= 0.0 {
                let pair = named(v);
                return Err(ContactError::Touching { pair, gap, t });
            }
        }
    }
    let Ok(Some(geometry)) = shape.contact_geometry(segments) else {
        return Ok(());
    };
    let mut places = geometry.positions;
    for p in places.as_chunks_mut::<3>().0 {
        *p = body.in_space(&Vector3::from(*p)).into();
    }
    let other = BroadPhase::new(geometry.mesh, &places);
    let mut pairs = Vec::new();
    let (sheet, solid): (&ContactMesh, &ContactMesh) = (boxes.mesh(), other.mesh());
    boxes.edge_faces_with(&other, &mut pairs);
    for &[e, f] in &pairs {
        let (edge, face) = (sheet.edges()[e as usize], solid.faces()[f as usize]);
        if pierces(gather(x, edge), gather(&places, face)) {
            return Err(crossing(named(edge[0]), t));
        }
    }
    other.edge_faces_with(boxes, &mut pairs);
    for &[e, f] in &pairs {
        let (edge, face) = (solid.edges()[e as usize], sheet.faces()[f as usize]);
        if pierces(gather(&places, edge), gather(x, face)) {
            return Err(crossing(named(face[0]), t));
        }
    }
    Ok(())
}
