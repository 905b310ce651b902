//! Faces of a flat crease pattern that has vertices and edges alone.

use crate::mesh_file::{EdgeAssignment, FileCrease};
use crate::mesh_file::{Point, twice_area};
use isosheet_files::DataError;
use std::collections::BTreeMap;

/// More lines are refused: a pattern of so many takes a second or two, and is more than anybody folds.
pub(super) const MOST_EDGES: usize = 50_000;

/// The faces, counter-clockwise, as corners from 0.
///
/// Each edge has two sides; at its end, a side is followed by that of the next edge clockwise. The
/// circuits of positive area are the faces, the one of negative area is the outside. A face is a hole of
/// the sheet if all of its edges are boundary and have another face on their other side.
pub(crate) fn faces(points: &[Point], edges: &[FileCrease]) -> Result<Vec<Vec<i64>>, DataError> {
    check_pieces(points, edges)?;
    let out = outgoing(points, edges);
    let mut face_of = vec![usize::MAX; 2 * edges.len()];
    let mut circuits: Vec<Vec<usize>> = Vec::new();
    for start in 0..face_of.len() {
        if face_of[start] != usize::MAX {
            continue;
        }
        let mut circuit = Vec::new();
        let mut side = start;
        while face_of[side] == usize::MAX {
            face_of[side] = circuits.len();
            circuit.push(side);
            side = next(&out, edges, side);
        }
        circuits.push(circuit);
    }
    let corner = |&side: &usize| tail(edges, side);
    let area = |circuit: &[usize]| twice_area(circuit.iter().map(|s| &points[corner(s)]));
    let is_face: Vec<bool> = circuits.iter().map(|c| area(c) > 0.0).collect();
    let is_hole = |circuit: &[usize]| {
        circuit.iter().all(|&side| {
            edges[side / 2].assignment == EdgeAssignment::Boundary && is_face[face_of[side ^ 1]]
        })
    };
    let kept = circuits
        .iter()
        .enumerate()
        .filter(|(k, c)| is_face[*k] && !is_hole(c));
    Ok(kept
        .map(|(_, c)| c.iter().map(|s| corner(s) as i64).collect())
        .collect())
}

/// Where a side begins. Side `2 e` runs along edge `e`, side `2 e + 1` against it.
fn tail(edges: &[FileCrease], side: usize) -> usize {
    edges[side / 2].ends[side % 2] as usize
}

/// The sides that begin at each vertex, counter-clockwise.
fn outgoing(points: &[Point], edges: &[FileCrease]) -> Vec<Vec<usize>> {
    let mut out = vec![Vec::new(); points.len()];
    for side in 0..2 * edges.len() {
        out[tail(edges, side)].push(side);
    }
    let angle = |side: usize| {
        let (a, b) = (points[tail(edges, side)], points[tail(edges, side ^ 1)]);
        (b[1] - a[1]).atan2(b[0] - a[0])
    };
    for sides in &mut out {
        sides.sort_by(|&s, &t| angle(s).total_cmp(&angle(t)));
    }
    out
}

/// The side that follows on the circuit to the left.
fn next(out: &[Vec<usize>], edges: &[FileCrease], side: usize) -> usize {
    let back = side ^ 1;
    let sides = &out[tail(edges, back)];
    let at = sides.iter().position(|&s| s == back).unwrap_or(0);
    sides[(at + sides.len() - 1) % sides.len()]
}

/// Refuses a part of the drawing inside of a face of another part: what is between them is no polygon.
fn check_pieces(points: &[Point], edges: &[FileCrease]) -> Result<(), DataError> {
    let mut piece: Vec<usize> = (0..points.len()).collect();
    for crease in edges {
        let [a, b] = crease.ends.map(|v| root(&mut piece, v as usize));
        piece[a] = b;
    }
    let mut boxes: BTreeMap<usize, [[f64; 2]; 2]> = BTreeMap::new();
    for v in edges.iter().flat_map(|e| e.ends) {
        let p = points[v as usize];
        let of_piece = boxes.entry(root(&mut piece, v as usize));
        let [low, high] = of_piece.or_insert([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]]);
        for k in 0..2 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    let inside = |[low, high]: &[[f64; 2]; 2], [l, h]: &[[f64; 2]; 2]| {
        (0..2).all(|k| l[k] < low[k] && high[k] < h[k])
    };
    let nested = |a: &&[[f64; 2]; 2]| boxes.values().any(|b| inside(a, b));
    if boxes.values().find(nested).is_some() {
        let message = "a part of the drawing lies inside of another one and is not connected to it";
        let remedy = "connect them by a line that stays flat at two places, or export the file with its faces";
        return Err(DataError::new(message, remedy));
    }
    Ok(())
}

/// The representative of a set, with the path to it halved.
pub(super) fn root(parent: &mut [usize], mut v: usize) -> usize {
    while parent[v] != v {
        parent[v] = parent[parent[v]];
        v = parent[v];
    }
    v
}

/// Smallest and largest number.
pub(super) fn bounds(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| {
        [low.min(c), high.max(c)]
    })
}
