//! From lines that may cross, overlap and end anywhere to the edges of a planar graph.

use super::faces::MOST_EDGES;
use crate::mesh_file::{EdgeAssignment, FileCrease};
use crate::mesh_file::{Point, distance, twice_area};
use isosheet_files::DataError;
use isosheet_mesh::Advice;
use isosheet_mesh::plane::{gaps, near_pairs};
use isosheet_mesh::wording::{brief, counted};
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

/// A drawing whose edges meet at their ends alone, and each of which is beside a face.
#[derive(Debug, Default)]
pub(crate) struct Planar {
    /// The points that were given, and behind them those where edges cross.
    pub(crate) points: Vec<Point>,
    /// Points that were given and became one with others.
    pub(crate) welded: usize,
    pub(crate) edges: Vec<FileCrease>,
    /// Corners of the faces, counter-clockwise.
    pub(crate) faces: Vec<Vec<i64>>,
    /// Edges that were divided because others cross them or end on them.
    pub(crate) divided: usize,
    /// Edges that were left out because they lead nowhere, and edges that lie on another one.
    pub(crate) loose: usize,
    pub(crate) double: usize,
    /// The edges that lead nowhere and are lines of the outline or of cuts inside of faces.
    pub(crate) loose_cuts: usize,
    /// Edges where lines that are meant to do different things lie on each other.
    pub(crate) contradicting: usize,
    /// Ends of the outline at gaps, see [`super::gaps`].
    open: Vec<Point>,
}

/// How coordinates are written in the file of a drawing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FileUnit {
    /// Units of the file for one of the drawing, along x and along y.
    pub(crate) along: [f64; 2],
    /// The name of the unit, with a blank before it, if it has one.
    pub(crate) name: &'static str,
}

impl FileUnit {
    /// Coordinates as in the file.
    pub(crate) const SAME: Self = Self {
        along: [1.0, 1.0],
        name: "",
    };
}

/// Points, of which those within a distance are one: the first of them.
pub(super) struct Points {
    near: f64,
    points: Vec<Point>,
    cells: HashMap<[i64; 2], Vec<u32>>,
}

impl Points {
    pub(super) fn within(near: f64) -> Self {
        Self {
            near: near.max(f64::MIN_POSITIVE),
            points: Vec::new(),
            cells: HashMap::new(),
        }
    }

    fn cell(&self, p: Point) -> [i64; 2] {
        [0, 1].map(|k| (p[k] / self.near).floor() as i64)
    }

    /// Adds a point whatever is near it.
    fn push(&mut self, p: Point) -> u32 {
        let number = self.points.len() as u32;
        self.cells.entry(self.cell(p)).or_default().push(number);
        self.points.push(p);
        number
    }

    /// The number of the nearest point within the distance, or of a new one.
    pub(super) fn add(&mut self, p: Point) -> u32 {
        let [x, y] = self.cell(p);
        let around = (-1..=1)
            .flat_map(|i| (-1..=1).map(move |j| [x.saturating_add(i), y.saturating_add(j)]));
        let known = around.filter_map(|cell| self.cells.get(&cell)).flatten();
        let away = |v: u32| {
            let q = self.points[v as usize];
            (p[0] - q[0]).hypot(p[1] - q[1])
        };
        let nearest = known
            .map(|&v| (away(v), v))
            .filter(|(d, _)| *d <= self.near);
        match nearest.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))) {
            Some((_, v)) => v,
            None => self.push(p),
        }
    }

    pub(super) fn into_points(self) -> Vec<Point> {
        self.points
    }
}

/// Divides edges where others cross them or end on them within a distance, unites edges that lie on each
/// other, leaves out edges that lead nowhere, and finds the faces.
///
/// # Errors
/// [`DataError`] for edges without length, for lines that meet more often than a drawing of so many lines has
/// it, and for a drawing with a part inside of a face of another part.
pub(crate) fn planar(
    given: Vec<Point>,
    edges: &[FileCrease],
    near: f64,
) -> Result<Planar, DataError> {
    if edges.len() > MOST_EDGES {
        let message = format!(
            "the drawing has {} lines, more than the {MOST_EDGES} of which faces are made",
            edges.len()
        );
        return Err(DataError::new(
            message,
            "export it as a FOLD file with its faces",
        ));
    }
    let without_length = |e: &FileCrease| {
        let [a, b] = e.ends.map(|v| given[v as usize]);
        a[0] == b[0] && a[1] == b[1]
    };
    if let Some(edge) = edges.iter().position(without_length) {
        let message = format!("edge {edge}, counted from 0, has no length");
        return Err(
            DataError::new(message, "remove it, or export the file with its faces").at(edge),
        );
    }
    let mut points = Points::within(near);
    for p in given {
        points.push(p);
    }
    let on = points_on_edges(&mut points, edges, near)?;
    let mut planar = Planar {
        divided: on.iter().filter(|points| !points.is_empty()).count(),
        points: points.into_points(),
        ..Planar::default()
    };
    planar.divide(edges, on);
    let loose = planar.drop_loose();
    if !planar.edges.is_empty() {
        planar.faces = super::faces(&planar.points, &planar.edges)?;
    }
    planar.drop_bridges();
    let Planar {
        points,
        edges,
        faces,
        ..
    } = &planar;
    (planar.loose_cuts, planar.open) = super::gaps::of(points, edges, faces, &loose, near);
    Ok(planar)
}

/// Of each edge the points between its ends that are on it: ends of other edges, and where others cross it.
fn points_on_edges(
    points: &mut Points,
    edges: &[FileCrease],
    near: f64,
) -> Result<Vec<Vec<u32>>, DataError> {
    let lines: Vec<[[f64; 2]; 3]> = edges
        .iter()
        .map(|edge| {
            let [a, b] = edge.ends.map(|v| points.points[v as usize]);
            [a, b, a].map(|p| [p[0], p[1]])
        })
        .collect();
    let mut on = vec![Vec::new(); edges.len()];
    near_pairs(&lines, near, |e, f| {
        meeting(points, [e, f], edges, near, &mut on);
    })
    .map_err(|e| DataError::new(e.to_string(), e.advice().unwrap_or_default()))?;
    Ok(on)
}

/// Notes where two edges meet between the ends of one of them.
fn meeting(
    points: &mut Points,
    [e, f]: [usize; 2],
    edges: &[FileCrease],
    near: f64,
    on: &mut [Vec<u32>],
) {
    let at = |points: &Points, v: u32| points.points[v as usize];
    let mut meets = false;
    for (edge, other) in [(e, f), (f, e)] {
        let ends = edges[edge].ends;
        for &v in edges[other].ends.iter().filter(|v| !ends.contains(v)) {
            if distance(at(points, v), ends.map(|v| at(points, v))) <= near {
                on[edge].push(v);
                meets = true;
            }
        }
    }
    if meets || edges[e].ends.iter().any(|v| edges[f].ends.contains(v)) {
        return;
    }
    let [[a, b], [c, d]] = [e, f].map(|e| edges[e].ends.map(|v| at(points, v)));
    let side = |p: Point, q: Point, r: Point| twice_area([p, q, r].iter());
    let [from, to] = [side(c, d, a), side(c, d, b)];
    if from * to < 0.0 && side(a, b, c) * side(a, b, d) < 0.0 {
        let part = from / (from - to);
        let crossing = points.add([0, 1, 2].map(|k| a[k] + part * (b[k] - a[k])));
        on[e].push(crossing);
        on[f].push(crossing);
    }
}

/// What is meant where lines lie on each other: an outline or a cut hides a crease, and a crease what stays
/// flat.
fn rank(assignment: EdgeAssignment) -> u8 {
    match assignment {
        EdgeAssignment::Boundary => 4,
        EdgeAssignment::Cut => 3,
        EdgeAssignment::Mountain | EdgeAssignment::Valley => 2,
        EdgeAssignment::Unassigned => 1,
        EdgeAssignment::Flat | EdgeAssignment::Join => 0,
    }
}

impl Planar {
    /// The drawing itself, if it is a sheet.
    ///
    /// # Errors
    /// [`DataError`] for a drawing whose outline is open, or that encloses no face.
    pub(crate) fn closed(self, unit: FileUnit) -> Result<Self, DataError> {
        let ends: Vec<[f64; 2]> = self.open.iter().map(|p| [p[0], p[1]]).collect();
        let gaps = gaps(&ends).into_iter().zip(&ends);
        if let Some((width, p)) = gaps.min_by(|a, b| a.0.total_cmp(&b.0)) {
            let [x, y] = [0, 1].map(|k| brief(unit.along[k] * p[k]));
            let name = unit.name;
            let next = match width.is_finite() {
                true => format!(
                    ", {}{name} from the next (T = {})",
                    brief(unit.along[0] * width),
                    brief(1.1 * width)
                ),
                false => String::new(),
            };
            let message = format!(
                "the outline is not closed: {} nowhere, one at ({x}, {y}){name}{next}",
                counted(
                    self.open.len(),
                    "end of its lines leads",
                    "ends of its lines lead"
                ),
            );
            let remedy =
                "close it there, or join the ends by `isosheet convert PATTERN OUT.fold --weld T`";
            return Err(DataError::new(message, remedy));
        }
        match self.edges.is_empty() {
            false => Ok(self),
            true => {
                let message =
                    "the lines of the drawing enclose no face: the outline of the sheet is missing";
                Err(DataError::new(message, "draw the outline as a closed line"))
            }
        }
    }

    /// Makes the parts of the edges between the points on them. The sheet folds freely where edges with
    /// different meanings lie on each other.
    fn divide(&mut self, edges: &[FileCrease], on: Vec<Vec<u32>>) {
        struct Known {
            at: usize,
            line: usize,
            rank: u8,
            contradicts: bool,
        }
        let mut known: HashMap<[u32; 2], Known> = HashMap::new();
        for (line, (edge, mut inner)) in edges.iter().zip(on).enumerate() {
            let [a, b] = edge.ends.map(|v| self.points[v as usize]);
            let along = |v: u32| {
                let p = self.points[v as usize];
                (p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1])
            };
            inner.sort_by(|&v, &w| along(v).total_cmp(&along(w)));
            let chain = [vec![edge.ends[0]], inner, vec![edge.ends[1]]].concat();
            let rank = rank(edge.assignment);
            for ends in chain
                .windows(2)
                .map(|w| [w[0], w[1]])
                .filter(|[a, b]| a != b)
            {
                let part = FileCrease { ends, ..*edge };
                let new = |at| Known {
                    at,
                    line,
                    rank,
                    contradicts: false,
                };
                let [a, b] = ends;
                let known = match known.entry([a.min(b), a.max(b)]) {
                    Entry::Vacant(place) => {
                        place.insert(new(self.edges.len()));
                        self.edges.push(part);
                        continue;
                    }
                    Entry::Occupied(place) => place.into_mut(),
                };
                if known.line == line {
                    continue;
                }
                self.double += 1;
                let first = &mut self.edges[known.at];
                let is_same =
                    |c: &FileCrease| (c.assignment, c.angle) == (part.assignment, part.angle);
                if rank > known.rank {
                    *first = part;
                    *known = new(known.at);
                } else if rank == known.rank && !is_same(first) {
                    first.assignment = EdgeAssignment::Unassigned;
                    first.angle = None;
                    known.contradicts = true;
                }
            }
        }
        self.contradicting = known.values().filter(|known| known.contradicts).count();
    }

    /// Leaves out the edges that are sides of no face: they lead from one part of the sheet to another.
    fn drop_bridges(&mut self) {
        let mut sides = HashSet::new();
        for face in &self.faces {
            let next = face.iter().cycle().skip(1);
            sides.extend(face.iter().zip(next).map(|(a, b)| [*a.min(b), *a.max(b)]));
        }
        let before = self.edges.len();
        self.edges.retain(|edge| {
            let [a, b] = edge.ends.map(i64::from);
            sides.contains(&[a.min(b), a.max(b)])
        });
        self.loose += before - self.edges.len();
    }

    /// Leaves out the edges that end where no other one does, again and again, and returns them.
    fn drop_loose(&mut self) -> Vec<FileCrease> {
        let mut at: Vec<Vec<usize>> = vec![Vec::new(); self.points.len()];
        for (e, edge) in self.edges.iter().enumerate() {
            edge.ends.iter().for_each(|&v| at[v as usize].push(e));
        }
        let mut degree: Vec<usize> = at.iter().map(Vec::len).collect();
        let mut is_loose = vec![false; self.edges.len()];
        let mut ends: Vec<usize> = (0..degree.len()).filter(|&v| degree[v] == 1).collect();
        while let Some(v) = ends.pop() {
            let Some(&e) = at[v].iter().find(|&&e| !is_loose[e]) else {
                continue;
            };
            is_loose[e] = true;
            for w in self.edges[e].ends.map(|w| w as usize) {
                degree[w] -= 1;
                if degree[w] == 1 {
                    ends.push(w);
                }
            }
        }
        let edges = std::mem::take(&mut self.edges).into_iter().zip(is_loose);
        let (loose, kept): (Vec<_>, Vec<_>) = edges.partition(|(_, is_loose)| *is_loose);
        self.edges = kept.into_iter().map(|(edge, _)| edge).collect();
        self.loose = loose.len();
        loose.into_iter().map(|(edge, _)| edge).collect()
    }
}
