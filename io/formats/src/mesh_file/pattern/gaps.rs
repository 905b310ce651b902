//! Whether a line of the outline that leads nowhere leaves a gap in it, or is only drawn too far.

use super::faces::root;
use crate::mesh_file::{EdgeAssignment, FileCrease, Point, distance};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// Of the edges that lead nowhere: how many belong to the outline or to cuts and are inside of a face, and
/// the ends of the others at gaps in the outline.
///
/// A crease has the sheet on both of its sides. Where a crease is at the border of what the lines enclose, a
/// face is missing beside it, and the ends of lines outside are ends of a gap; elsewhere they are drawn too
/// far, and enclose nothing. Lines that are connected to no face at all are an outline with a gap, if they
/// are not straight.
pub(super) fn of(
    points: &[Point],
    edges: &[FileCrease],
    faces: &[Vec<i64>],
    loose: &[FileCrease],
    near: f64,
) -> (usize, Vec<Point>) {
    let point = |v: u32| points[v as usize];
    let border = border(faces);
    let is_inside = |p: Point| is_within(p, &border, points);
    let outline = loose.iter().filter(|e| is_outline(e));
    let is_in_face = |e: &&FileCrease| {
        let [a, b] = e.ends.map(point);
        is_inside([0, 1, 2].map(|k| 0.5 * (a[k] + b[k])))
    };
    let inside = outline.clone().filter(is_in_face).count();
    let mut lines_at: BTreeMap<u32, usize> = BTreeMap::new();
    for v in outline.flat_map(|e| e.ends) {
        *lines_at.entry(v).or_default() += 1;
    }
    let kept = edges.iter().filter(|e| is_outline(e));
    for v in kept.flat_map(|e| e.ends) {
        lines_at.entry(v).and_modify(|count| *count += 1);
    }
    let mut tree: Vec<usize> = (0..points.len()).collect();
    for edge in loose {
        let [a, b] = edge.ends.map(|v| root(&mut tree, v as usize));
        tree[a] = b;
    }
    let mut trees: HashMap<usize, Vec<Point>> = HashMap::new();
    for v in loose.iter().flat_map(|e| e.ends) {
        let of = root(&mut tree, v as usize);
        trees.entry(of).or_default().push(point(v));
    }
    let ends = edges.iter().flat_map(|e| e.ends);
    let connected: HashSet<usize> = ends.map(|v| root(&mut tree, v as usize)).collect();
    let misses_faces = has_crease_at_border(edges, &border);
    let mut is_gap = |v: u32| {
        let of = root(&mut tree, v as usize);
        match connected.contains(&of) {
            true => misses_faces,
            false => !is_straight(&trees[&of], near),
        }
    };
    let ends = lines_at.iter().filter(|(_, count)| **count == 1);
    let open: BTreeSet<u32> = ends.map(|(v, _)| *v).filter(|v| is_gap(*v)).collect();
    let open = open.into_iter().map(point);
    (inside, open.filter(|p| !is_inside(*p)).collect())
}

fn is_outline(edge: &FileCrease) -> bool {
    matches!(
        edge.assignment,
        EdgeAssignment::Boundary | EdgeAssignment::Cut
    )
}

/// The sides that one face alone has.
fn border(faces: &[Vec<i64>]) -> Vec<[i64; 2]> {
    let mut sides: HashMap<[i64; 2], usize> = HashMap::new();
    for face in faces {
        let next = face.iter().cycle().skip(1);
        for (a, b) in face.iter().zip(next) {
            *sides.entry([*a.min(b), *a.max(b)]).or_default() += 1;
        }
    }
    let single = sides.into_iter().filter(|(_, count)| *count == 1);
    single.map(|(ends, _)| ends).collect()
}

/// Whether a crease has a face on one of its sides alone.
fn has_crease_at_border(edges: &[FileCrease], border: &[[i64; 2]]) -> bool {
    let creases = edges.iter().filter(|e| !is_outline(e));
    let creases: HashSet<[i64; 2]> = creases
        .map(|e| e.ends.map(i64::from))
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    border.iter().any(|ends| creases.contains(ends))
}

/// Whether points are on a line within a distance.
fn is_straight(points: &[Point], near: f64) -> bool {
    let away = |p: Point, q: Point| (p[0] - q[0]).hypot(p[1] - q[1]);
    let furthest = |from: Point| {
        let others = points.iter().copied();
        others.max_by(|p, q| away(from, *p).total_cmp(&away(from, *q)))
    };
    let Some(end) = points.first().and_then(|first| furthest(*first)) else {
        return true;
    };
    let other = furthest(end).unwrap_or(end);
    points.iter().all(|p| distance(*p, [end, other]) <= near)
}

/// Whether a point is in one of some faces, whose border has these sides: whether a ray from it to the right
/// crosses an odd number of them.
fn is_within(p: Point, border: &[[i64; 2]], points: &[Point]) -> bool {
    let sides = border.iter().map(|ends| ends.map(|v| points[v as usize]));
    let crossed = sides.filter(|[a, b]| {
        let at = (p[1] - a[1]) / (b[1] - a[1]);
        (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + at * (b[0] - a[0])
    });
    crossed.count() % 2 == 1
}
