//! Faces of a flat crease pattern that has vertices and edges alone.

use crate::format::DataError;
use crate::format::mesh_file::plane::{NEAR, Point, meet, twice_area};
use crate::format::mesh_file::{EdgeAssignment, FileCrease};

/// More edges are refused: pairs of edges are compared, which takes a second or two for so many edges that
/// all overlap in one direction.
const MOST_EDGES: usize = 50_000;

/// The faces, counter-clockwise, as corners from 0.
///
/// Each edge has two sides; at its end, a side is followed by that of the next edge clockwise. The
/// circuits of positive area are the faces, the one of negative area is the outside. A face is a hole of
/// the sheet if all of its edges are boundary and have another face on their other side.
pub(super) fn faces(points: &[Point], edges: &[FileCrease]) -> Result<Vec<Vec<i64>>, DataError> {
    check(points, edges)?;
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

/// Checks that the edges are a connected drawing without crossings and loose ends.
fn check(points: &[Point], edges: &[FileCrease]) -> Result<(), DataError> {
    if edges.len() > MOST_EDGES {
        let what = format!(
            "its {} edges are more than the {MOST_EDGES} of which faces are made",
            edges.len()
        );
        return Err(no_drawing(&what, "export it with its faces"));
    }
    let mut degree = vec![0_usize; points.len()];
    let mut piece: Vec<usize> = (0..points.len()).collect();
    for (edge, crease) in edges.iter().enumerate() {
        let [a, b] = crease.ends.map(|v| v as usize);
        if points[a] == points[b] {
            let what = format!("its edge {edge} has no length");
            let remedy = "remove it, or export the file with its faces";
            return Err(no_drawing(&what, remedy).at(edge));
        }
        degree[a] += 1;
        degree[b] += 1;
        let (a, b) = (root(&mut piece, a), root(&mut piece, b));
        piece[a] = b;
    }
    check_crossings(points, edges)?;
    if let Some(vertex) = degree.iter().position(|&d| d == 1) {
        let what = format!("vertex {vertex} is an end of one edge only");
        let remedy = "connect it to the other edges, or export the file with its faces";
        return Err(no_drawing(&what, remedy).at(vertex));
    }
    let pieces = (0..points.len())
        .filter(|&v| degree[v] > 0 && piece[v] == v)
        .count();
    if pieces == 1 {
        Ok(())
    } else {
        let what = format!("its edges make {pieces} separate pieces");
        let remedy = "split the file, or export it with its faces";
        Err(no_drawing(&what, remedy))
    }
}

/// Why edges are no drawing of faces.
fn no_drawing(what: &str, remedy: &'static str) -> DataError {
    let message = format!("the file has no `faces_vertices`, and {what}");
    DataError::new(message, remedy)
}

/// The representative of a set, with the path to it halved.
fn root(parent: &mut [usize], mut v: usize) -> usize {
    while parent[v] != v {
        parent[v] = parent[parent[v]];
        v = parent[v];
    }
    v
}

/// Compares all pairs of edges that overlap along x.
fn check_crossings(points: &[Point], edges: &[FileCrease]) -> Result<(), DataError> {
    let ends = |e: usize| edges[e].ends.map(|v| points[v as usize]);
    let extent = |k: usize| {
        let [low, high] = bounds(
            edges
                .iter()
                .flat_map(|e| e.ends)
                .map(|v| points[v as usize][k]),
        );
        high - low
    };
    let near = NEAR * extent(0).max(extent(1));
    let mut order: Vec<(usize, [f64; 2], [f64; 2])> = (0..edges.len())
        .map(|e| {
            let range = |k: usize| bounds(ends(e).iter().map(|p| p[k]));
            (e, range(0), range(1))
        })
        .collect();
    order.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    for (k, &(e, x, y)) in order.iter().enumerate() {
        for &(f, _, v) in order[k + 1..].iter().take_while(|o| o.1[0] <= x[1] + near) {
            let apart = v[0] > y[1] + near || y[0] > v[1] + near;
            if !apart && meet(edges[e].ends, edges[f].ends, points, near) {
                let (first, second) = (e.min(f), e.max(f));
                let what = format!(
                    "its edges {first} and {second} meet where they have no vertex in common"
                );
                let remedy = "add the vertex, or export the file with its faces";
                return Err(no_drawing(&what, remedy).at(first));
            }
        }
    }
    Ok(())
}

/// Smallest and largest number.
fn bounds(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| {
        [low.min(c), high.max(c)]
    })
}
