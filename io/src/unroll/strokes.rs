//! The lines of a drawing of an unrolled sheet.

use super::folds::Fold;
use isosheet_drawings::{LineClass, Stroke};
use isosheet_formats::EdgeAssignment;
use isosheet_mesh::{EdgeId, Sheet, VertexId};
use std::collections::BTreeMap;

pub(super) type Point = [f64; 2];

pub(super) fn place(flat: &Sheet, v: VertexId) -> Point {
    let [x, y, _] = flat.position(v);
    [x, y]
}

/// The outlines of all pieces, closed.
pub(super) fn outlines(flat: &Sheet) -> Vec<Stroke> {
    let loops = flat.topology().boundary_loops().into_iter();
    let outline = |own: Vec<VertexId>| {
        let points = own.iter().chain(own.first()).map(|v| place(flat, *v));
        Stroke {
            points: points.collect(),
            class: LineClass::Cut,
            angle: None,
        }
    };
    loops.map(outline).collect()
}

/// The creases. Creases that fold alike and go straight on are one line.
pub(super) fn creases(flat: &Sheet, folds: &[Fold]) -> Vec<Stroke> {
    // Angles have nine digits after the layout: they are alike if these are.
    let key = |fold: &Fold| ((fold.size() * 1e9).round() as u64, class(fold) as u8);
    let mut alike: BTreeMap<_, Vec<&Fold>> = BTreeMap::new();
    for fold in folds.iter().filter(|fold| fold.is_crease) {
        alike.entry(key(fold)).or_default().push(fold);
    }
    let stroke = |own: Vec<&Fold>| {
        let edges: Vec<EdgeId> = own.iter().map(|fold| fold.edge).collect();
        let (class, angle) = (class(own[0]), own[0].angle.map(f64::abs));
        straight(flat, &edges).into_iter().map(move |ends| Stroke {
            points: ends.map(|v| place(flat, v)).to_vec(),
            class,
            angle,
        })
    };
    alike.into_values().flat_map(stroke).collect()
}

fn class(fold: &Fold) -> LineClass {
    match fold.assignment {
        EdgeAssignment::Mountain => LineClass::Mountain,
        EdgeAssignment::Valley => LineClass::Valley,
        EdgeAssignment::Flat => LineClass::Flat,
        _ => LineClass::Crease,
    }
}

/// The ends of the longest straight lines that some edges make.
pub(super) fn straight(flat: &Sheet, edges: &[EdgeId]) -> Vec<[VertexId; 2]> {
    /// The sine of the angle by which a straight line turns: round-off of layouts.
    const TURN: f64 = 1e-9;
    let t = flat.topology();
    let mut at: BTreeMap<VertexId, Vec<EdgeId>> = BTreeMap::new();
    for &e in edges {
        t.edges()[e.index()]
            .iter()
            .for_each(|v| at.entry(*v).or_default().push(e));
    }
    let direction = |from: VertexId, to: VertexId| {
        let [p, q] = [from, to].map(|v| place(flat, v));
        let d = [q[0] - p[0], q[1] - p[1]];
        let length = d[0].hypot(d[1]);
        d.map(|c| c / length)
    };
    // The edge with which a line goes on at a vertex.
    let next = |e: EdgeId, v: VertexId| {
        let along = direction(t.other_end(e, v), v);
        let mut others = at[&v].iter().copied().filter(|o| *o != e);
        others.find(|o| {
            let onwards = direction(v, t.other_end(*o, v));
            let turn = along[0] * onwards[1] - along[1] * onwards[0];
            turn.abs() < TURN && along[0] * onwards[0] + along[1] * onwards[1] > 0.0
        })
    };
    let mut is_drawn = vec![false; t.edge_count()];
    let mut lines = Vec::new();
    for &first in edges {
        if is_drawn[first.index()] {
            continue;
        }
        is_drawn[first.index()] = true;
        let ends = t.edges()[first.index()].map(|end| {
            let (mut e, mut v) = (first, end);
            while let Some(onwards) = next(e, v).filter(|o| !is_drawn[o.index()]) {
                is_drawn[onwards.index()] = true;
                (e, v) = (onwards, t.other_end(onwards, v));
            }
            v
        });
        lines.push(ends);
    }
    lines
}
