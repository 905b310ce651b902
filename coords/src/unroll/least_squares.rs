//! The layout with the least squares of strain.

use super::vec2::{Point, dot, sub, twice_area};
use isosheet_linalg::{LinalgError, Pattern, SparseLlt};
use isosheet_mesh::{EdgeId, Sheet, VertexId};

/// Steps at most: quadratic convergence takes five from the layout of what is developable, and layouts with
/// strain gain at least a digit in some steps.
const STEPS: usize = 200;

/// Below this relative change of positions, a step of Newton's method leaves round-off alone.
const SMALL: f64 = 1e-9;

/// Three steps that gain less than this part of the sum of squares are the last ones: strains that are left
/// are known to more digits than a limit for them has.
const IDLE: f64 = 1e-6;

/// The lengths of a sheet in the plane, as a problem of least squares.
///
/// The sum of `w r^2` over the edges is minimised, with the strain `r = (|p - q|^2 / l^2 - 1) / 2` and
/// weights `w`, the areas that belong to the edges. Gauss and Newton's normal equations are regular besides
/// the motions of the plane, as triangles in the plane are rigid: of a developable sheet all lengths are met,
/// and convergence is quadratic.
pub(super) struct LeastSquares<'a> {
    sheet: &'a Sheet,
    weights: Vec<f64>,
    matrix: SparseLlt,
    /// The places of the entries of each edge in the matrix.
    slots: Vec<u32>,
    /// The places of the diagonal in the matrix.
    diagonal: Vec<u32>,
}

impl<'a> LeastSquares<'a> {
    pub(super) fn new(sheet: &'a Sheet) -> Result<Self, LinalgError> {
        let t = sheet.topology();
        let mut weights = vec![0.0; t.edge_count()];
        for f in t.face_ids() {
            let part = sheet.face_areas()[f.index()] / (3.0 * sheet.area());
            t.face_edges(f)
                .iter()
                .for_each(|e| weights[e.index()] += part);
        }
        let unknowns = 2 * t.vertex_count();
        let mut entries = Vec::new();
        for ends in t.edges() {
            let of_edge = ends.map(|v| 2 * v.0).map(|k| [k, k + 1]).concat();
            for (k, i) in of_edge.iter().enumerate() {
                for j in &of_edge[..=k] {
                    entries.push((*i.max(j), *i.min(j)));
                }
            }
        }
        entries.extend((0..unknowns as u32).map(|k| (k, k)));
        let (pattern, mut slots) = Pattern::from_entries(unknowns, unknowns, &entries);
        let diagonal = slots.split_off(slots.len() - unknowns);
        Ok(Self {
            sheet,
            weights,
            matrix: SparseLlt::with_blocks(pattern, 2)?,
            slots,
            diagonal,
        })
    }

    /// Moves points to the least squares. Where no triangle is turned over, none is in the end.
    ///
    /// # Errors
    /// [`LinalgError`] for equations that cannot be solved.
    pub(super) fn fit(&mut self, points: &mut [Point]) -> Result<(), LinalgError> {
        let size = points.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
        let keeps_sides = turned_over(self.sheet, points).is_none();
        let mut old = self.value(points);
        let (mut damping, mut small, mut idle) = (0.0, 0, 0);
        for _ in 0..STEPS {
            let step = match self.step(points, damping) {
                Ok(step) => step,
                // Levenberg and Marquardt's damping, relative to the diagonal.
                Err(error) if damping >= 1.0 => return Err(error),
                Err(_) => {
                    damping = (10.0 * damping).max(f64::EPSILON);
                    continue;
                }
            };
            let change = step.iter().fold(0.0_f64, |m, c| m.max(c.abs())) / size;
            let moved = |part: f64| -> Vec<Point> {
                let pairs = points.iter().zip(step.as_chunks::<2>().0);
                pairs
                    .map(|(p, d)| [p[0] + part * d[0], p[1] + part * d[1]])
                    .collect()
            };
            let mut part = 1.0;
            let next = loop {
                let trial = moved(part);
                let value = self.value(&trial);
                let is_better = value < old || change < SMALL;
                if is_better && !(keeps_sides && turned_over(self.sheet, &trial).is_some()) {
                    break Some((trial, value));
                }
                part *= 0.5;
                if part < 1e-6 {
                    break None;
                }
            };
            let Some((trial, value)) = next else {
                if damping >= 1.0 {
                    return Ok(());
                }
                damping = (10.0 * damping).max(1e-6);
                continue;
            };
            damping = if damping > f64::EPSILON {
                0.1 * damping
            } else {
                0.0
            };
            points.copy_from_slice(&trial);
            let gain = old - value;
            old = value;
            small += usize::from(change < SMALL);
            idle = if gain <= IDLE * old { idle + 1 } else { 0 };
            // Quadratic convergence is at round-off after another step.
            if small > 2 || idle > 2 || change < f64::EPSILON {
                return Ok(());
            }
        }
        Ok(())
    }

    /// The sum of the squares.
    fn value(&self, points: &[Point]) -> f64 {
        let t = self.sheet.topology();
        let of_edge = |e: EdgeId| self.weights[e.index()] * self.strain(points, e).1.powi(2);
        t.edge_ids().map(of_edge).sum()
    }

    /// The vector along an edge, and the strain `(|d|^2 / l^2 - 1) / 2`.
    fn strain(&self, points: &[Point], e: EdgeId) -> (Point, f64) {
        let [a, b] = self.sheet.topology().edges()[e.index()].map(|v| points[v.index()]);
        let (d, length) = (sub(a, b), self.sheet.lengths()[e.index()]);
        let now = dot(d, d).sqrt();
        (d, 0.5 * (now - length) / length * (now + length) / length)
    }

    /// The step of Gauss and Newton, with a part of the diagonal added.
    fn step(&mut self, points: &[Point], damping: f64) -> Result<Vec<f64>, LinalgError> {
        let t = self.sheet.topology();
        let mut right = vec![0.0; 2 * points.len()];
        let mut values = vec![0.0; self.matrix.values().len()];
        for e in t.edge_ids() {
            let (d, strain) = self.strain(points, e);
            let (weight, length) = (self.weights[e.index()], self.sheet.lengths()[e.index()]);
            let slope = d.map(|c| c / (length * length));
            let slope = [slope[0], slope[1], -slope[0], -slope[1]];
            let [a, b] = t.edges()[e.index()].map(|v| 2 * v.index());
            for (k, s) in [a, a + 1, b, b + 1].into_iter().zip(slope) {
                right[k] -= weight * strain * s;
            }
            let own = &self.slots[10 * e.index()..10 * e.index() + 10];
            let mut own = own.iter();
            for i in 0..4 {
                for j in 0..=i {
                    if let Some(slot) = own.next() {
                        values[*slot as usize] += weight * slope[i] * slope[j];
                    }
                }
            }
        }
        for slot in &self.diagonal {
            values[*slot as usize] *= 1.0 + damping;
        }
        // Motions of the plane are free: one end of an edge is held, and the other one across the edge. The
        // solution has no part of them, so that nothing pulls there.
        let [a, b] = t.edges()[0];
        let d = sub(points[a.index()], points[b.index()]);
        let across = if d[0].abs() > d[1].abs() { 1 } else { 0 };
        for k in [2 * a.index(), 2 * a.index() + 1, 2 * b.index() + across] {
            let largest = 2 * (k / 2);
            let size = values[self.diagonal[largest] as usize];
            let size = size.max(values[self.diagonal[largest + 1] as usize]);
            values[self.diagonal[k] as usize] += size;
        }
        self.matrix.values_mut().copy_from_slice(&values);
        self.matrix.factorize()?;
        self.matrix.solve(&mut right);
        match right.iter().position(|c| !c.is_finite()) {
            Some(_) => Err(LinalgError::Singular {
                order: right.len(),
                backward_error: f64::INFINITY,
            }),
            None => Ok(right),
        }
    }
}

/// The first face of a layout that is turned over or has no area, as [`Sheet::MIN_RELATIVE_ALTITUDE`] says.
/// (A thin triangle loses its altitude by a strain of the square of it.)
pub(super) fn turned_over(sheet: &Sheet, points: &[Point]) -> Option<usize> {
    let faces = sheet.topology().faces();
    let has_area = |f: &[VertexId; 3]| {
        let corners = f.map(|v| points[v.index()]);
        let side = |k: usize| sub(corners[(k + 1) % 3], corners[k]);
        let squared = (0..3).map(|k| dot(side(k), side(k)));
        let longest = squared.fold(0.0, f64::max);
        // What is not a number has none.
        twice_area(corners) > Sheet::MIN_RELATIVE_ALTITUDE * longest
    };
    faces.iter().position(|f| !has_area(f))
}

/// The edge with the largest strain of a layout, and its strain `length / rest length - 1`.
pub(super) fn largest_strain(sheet: &Sheet, points: &[Point]) -> (EdgeId, f64) {
    let t = sheet.topology();
    let strain = |e: EdgeId| {
        let [a, b] = t.edges()[e.index()].map(|v| points[v.index()]);
        let length = sheet.lengths()[e.index()];
        (super::vec2::distance(a, b) - length) / length
    };
    let all = t.edge_ids().map(|e| (e, strain(e)));
    all.fold((EdgeId(0), 0.0), |most: (EdgeId, f64), own| {
        if own.1.abs() > most.1.abs() {
            own
        } else {
            most
        }
    })
}
