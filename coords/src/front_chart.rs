//! The paper's chart: the coordinates that front propagation assigns.

use crate::assignment::{Assignment, AssignmentOptions, Rule, assign};
use crate::chart::{Chart, ChartError};
use crate::linearised::Linearised;
use crate::newton::newton;
use crate::placement::{jacobian_f, jacobian_g, jacobian_h};
use crate::placement_error::PlacementError;
use crate::realise::{Frame, FrontMap, RealiseOptions, check, check_length};
use crate::row_pattern::RowPattern;
use crate::select::pivot_columns;
use crate::system::RodSystem;
use crate::vec3::{Vec3, at};
use isosheet_linalg::{Pattern, SparseLu};
use isosheet_mesh::{Sheet, VertexId};
use nalgebra::DMatrix;

/// System coordinates by front propagation (Liu, Tang and Joneja 2007, Sec. 3.3).
///
/// On a mesh with closures (a vertex with four or more known neighbours somewhere) as many of the
/// assigned coordinates depend on the others; they are singled out at the reference state by a
/// column-pivoted elimination of the closure equations, and the chart consists of the rest.
///
/// Exact for placement, but its condition number grows exponentially with the number of fronts, see
/// [`crate::condition_table`].
#[derive(Clone, Debug)]
pub struct FrontChart {
    sheet: Sheet,
    options: AssignmentOptions,
    map: FrontMap,
    system: RodSystem,
    /// Assigned coordinates that are chart coordinates.
    kept: Vec<usize>,
    pattern: RowPattern,
    /// For each placing: chart indices of its coordinates.
    chart_index: Vec<Option<usize>>,
}

impl FrontChart {
    /// The chart of a sheet with the given options, with frames, pins and dependent coordinates from
    /// the state `reference`.
    ///
    /// # Errors
    /// [`ChartError::Assignment`], [`ChartError::System`], [`ChartError::Realise`];
    /// [`ChartError::RankDeficient`] and [`ChartError::Linalg`] when the closures do not determine
    /// as many coordinates at this state.
    pub fn new(
        sheet: &Sheet,
        options: &AssignmentOptions,
        reference: &[f64],
    ) -> Result<Self, ChartError> {
        let assignment = assign(sheet, reference, options)?;
        let system = RodSystem::new(sheet, &options.pins)?;
        system.check_freedom()?;
        let map = FrontMap::new(sheet, assignment, reference, RealiseOptions::default())?;
        let count = map.coordinate_count();
        let mut chart = Self {
            sheet: sheet.clone(),
            options: options.clone(),
            map,
            system,
            kept: (0..count).collect(),
            pattern: RowPattern::new(),
            chart_index: (0..count).map(Some).collect(),
        };
        chart.select(reference)?;
        Ok(chart)
    }

    /// The map from all assigned coordinates to positions.
    #[must_use]
    pub fn map(&self) -> &FrontMap {
        &self.map
    }

    /// The assignment.
    #[must_use]
    pub fn assignment(&self) -> &Assignment {
        self.map.assignment()
    }

    /// The assigned coordinates that the chart consists of, ascending.
    #[must_use]
    pub fn kept(&self) -> &[usize] {
        &self.kept
    }

    /// Choose the dependent coordinates and build the pattern.
    fn select(&mut self, x: &[f64]) -> Result<(), ChartError> {
        let closures = self.assignment().closures().len();
        let count = self.map.coordinate_count();
        self.kept = (0..count).collect();
        self.chart_index = (0..count).map(Some).collect();
        self.build_pattern();
        if closures == 0 {
            return Ok(());
        }
        let mut dependence = self.closure_jacobian(x)?;
        let dependent = pivot_columns(&mut dependence);
        if dependent.len() < closures {
            let missing = closures - dependent.len();
            return Err(ChartError::RankDeficient {
                equations: self.system.equations(),
                rank: self.system.equations() - missing,
            });
        }
        self.chart_index = vec![None; count];
        self.kept.retain(|k| !dependent.contains(k));
        for (i, k) in self.kept.iter().enumerate() {
            self.chart_index[*k] = Some(i);
        }
        self.build_pattern();
        Ok(())
    }

    fn build_pattern(&mut self) {
        let mut pattern = RowPattern::new();
        let order = self.map.assignment().order();
        for placing in order {
            let v = placing.vertex;
            let push = |pattern: &mut RowPattern, k: usize, vertices: &[VertexId]| {
                if self.chart_index[k].is_some() {
                    pattern.push(
                        vertices
                            .iter()
                            .filter_map(|w| self.system.unknown(*w))
                            .flat_map(|u| (0..3).map(move |i| (u + i) as u32)),
                    );
                }
            };
            match placing.rule {
                Rule::Start { q } => {
                    let u = self.system.unknown(v).unwrap_or(0) as u32;
                    for i in 0..3 {
                        if self.chart_index[q + i].is_some() {
                            pattern.push([u + i as u32]);
                        }
                    }
                }
                Rule::H { known, q, .. } => {
                    push(&mut pattern, q, &[known, v]);
                    push(&mut pattern, q + 1, &[known, v]);
                }
                Rule::G {
                    known: [a, b], q, ..
                }
                | Rule::Turn {
                    known: [a, b, _],
                    q,
                    ..
                } => {
                    push(&mut pattern, q, &[a, b, v]);
                }
                Rule::Pinned | Rule::F { .. } => {}
            }
        }
        self.pattern = pattern;
    }

    /// Visit the gradient rows of all assigned coordinates in order: coordinate, and per vertex its
    /// part. With a velocity, their rates.
    fn visit(
        &self,
        x: &[f64],
        velocity: Option<&[f64]>,
        mut emit: impl FnMut(usize, &[(VertexId, Vec3<f64>)]),
    ) -> Result<(), ChartError> {
        for (placing, frame) in self.map.assignment().order().iter().zip(self.map.frames()) {
            let v = placing.vertex;
            let fail = |q: usize, source: PlacementError| ChartError::Row {
                coordinate: q,
                vertex: v,
                source,
            };
            match (placing.rule, frame) {
                (Rule::Start { q }, _) => {
                    for i in 0..3 {
                        let mut e = [0.0; 3];
                        e[i] = if velocity.is_some() { 0.0 } else { 1.0 };
                        emit(q + i, &[(v, e)]);
                    }
                }
                (Rule::H { known, q, .. }, Frame::Spherical(f)) => {
                    let (a, b) = (at(x, known), at(x, v));
                    let rows = match velocity {
                        None => f.gradient(&a, &b),
                        Some(u) => f.gradient_rate([&a, &b], [&at(u, known), &at(u, v)]),
                    }
                    .map_err(|e| fail(q, e))?;
                    for (i, r) in rows.iter().enumerate() {
                        emit(q + i, &[(known, r.map(|c| -c)), (v, *r)]);
                    }
                }
                (
                    Rule::G {
                        known: [a, b], q, ..
                    }
                    | Rule::Turn {
                        known: [a, b, _],
                        q,
                        ..
                    },
                    Frame::Edge(f),
                ) => {
                    let p = [at(x, a), at(x, b), at(x, v)];
                    let points = [&p[0], &p[1], &p[2]];
                    let rows = match velocity {
                        None => f.gradient(points),
                        Some(u) => f.gradient_rate(points, [&at(u, a), &at(u, b), &at(u, v)]),
                    }
                    .map_err(|e| fail(q, e))?;
                    emit(q, &[(a, rows[0]), (b, rows[1]), (v, rows[2])]);
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn fill(
        &self,
        x: &[f64],
        velocity: Option<&[f64]>,
        values: &mut [f64],
    ) -> Result<(), ChartError> {
        check("x", x, 3 * self.system.vertex_count())?;
        check_length("values", values.len(), self.pattern.len())?;
        let mut next = 0;
        self.visit(x, velocity, |k, parts| {
            if self.chart_index[k].is_none() {
                return;
            }
            let single = self.pattern.range(self.chart_index[k].unwrap_or(0)).len() == 1;
            if single {
                // A start vertex: the one entry of a unit row.
                values[next] = parts[0].1.iter().sum();
                next += 1;
                return;
            }
            for (w, r) in parts {
                if self.system.unknown(*w).is_some() {
                    values[next..next + 3].copy_from_slice(r);
                    next += 3;
                }
            }
        })
    }

    /// Derivative of the closure lengths with respect to all assigned coordinates, at x.
    fn closure_jacobian(&self, x: &[f64]) -> Result<DMatrix<f64>, ChartError> {
        let closures = self.assignment().closures();
        let rods = self.system.rods();
        let mut closure = vec![false; self.sheet.topology().edge_count()];
        for c in closures {
            closure[c.edge.index()] = true;
        }
        let unknowns = self.system.unknowns();
        let count = self.map.coordinate_count();
        // The square matrix of the placements: rods that are not closures, then all coordinates.
        let mut row_of = vec![None; rods.len()];
        let mut next = 0u32;
        for (e, rod) in rods.iter().enumerate() {
            if !closure[rod.edge.index()] {
                row_of[e] = Some(next);
                next += 1;
            }
        }
        let mut entries = Vec::new();
        let mut values = Vec::new();
        let mut closure_rows = vec![Vec::new(); rods.len()];
        for ((e, u), value) in self
            .system
            .jacobian_entries()
            .zip(self.system.jacobian_values(x))
        {
            match row_of[e as usize] {
                Some(r) => {
                    entries.push((r, u));
                    values.push(value);
                }
                None => closure_rows[e as usize].push((u, value)),
            }
        }
        let mut rows = vec![0.0; self.pattern.len()];
        self.fill(x, None, &mut rows)?;
        for ((k, u), value) in self.pattern.entries().zip(rows) {
            entries.push((next + k, u));
            values.push(value);
        }
        let (pattern, slots) = Pattern::from_entries(unknowns, unknowns, &entries);
        let mut lu = SparseLu::new(pattern)?;
        for (slot, value) in slots.iter().zip(values) {
            lu.values_mut()[*slot as usize] += value;
        }
        lu.factorize()?;
        let mut jacobian = DMatrix::zeros(closures.len(), count);
        let used = closure_rows.iter().filter(|r| !r.is_empty());
        for (i, row) in used.enumerate() {
            let mut y = vec![0.0; unknowns];
            for (u, value) in row {
                y[*u as usize] = *value;
            }
            lu.solve_transpose_refined(&mut y)?;
            for k in 0..count {
                jacobian[(i, k)] = y[next as usize + k];
            }
        }
        Ok(jacobian)
    }

    /// J by the chain rule through the placements (the differentiated form of Eq. 15): unknowns x n.
    ///
    /// Unlike a factorisation of A this keeps relative accuracy when J is huge.
    ///
    /// # Errors
    /// [`ChartError::Row`] where a placement has no derivative. Charts with closures are refused with
    /// [`ChartError::RankDeficient`]: their coordinates differ from the coordinates of the placements.
    fn chain_jacobian(&self, x: &[f64]) -> Result<DMatrix<f64>, ChartError> {
        check("x", x, 3 * self.system.vertex_count())?;
        if !self.assignment().closures().is_empty() {
            return Err(ChartError::RankDeficient {
                equations: self.system.equations(),
                rank: self.system.equations() - self.assignment().closures().len(),
            });
        }
        let n = self.dimension();
        let mut jacobian = DMatrix::zeros(self.system.unknowns(), n);
        for (placing, frame) in self.map.assignment().order().iter().zip(self.map.frames()) {
            let v = placing.vertex;
            let Some(u) = self.system.unknown(v) else {
                continue;
            };
            let p = at(x, v);
            let fail = |source| ChartError::Row {
                coordinate: n,
                vertex: v,
                source,
            };
            let mut parts: Vec<(VertexId, [[f64; 3]; 3])> = Vec::with_capacity(3);
            match (placing.rule, frame) {
                (Rule::Start { q }, _) => {
                    for i in 0..3 {
                        jacobian[(u + i, q + i)] = 1.0;
                    }
                }
                (Rule::H { known, q, .. }, Frame::Spherical(f)) => {
                    let d = jacobian_h(&at(x, known), f, &p).map_err(fail)?;
                    for i in 0..3 {
                        jacobian[(u + i, q)] = d.q[0][i];
                        jacobian[(u + i, q + 1)] = d.q[1][i];
                    }
                    parts.push((known, d.known));
                }
                (Rule::G { known, q, .. }, Frame::Edge(f)) => {
                    let k = known.map(|w| at(x, w));
                    let d = jacobian_g([&k[0], &k[1]], f, &p).map_err(fail)?;
                    for i in 0..3 {
                        jacobian[(u + i, q)] = d.q[i];
                    }
                    parts.extend(known.into_iter().zip(d.known));
                }
                (Rule::F { known, .. }, _) => {
                    let k = known.map(|w| at(x, w));
                    let d = jacobian_f([&k[0], &k[1], &k[2]], &p).map_err(fail)?;
                    parts.extend(known.into_iter().zip(d));
                }
                _ => {}
            }
            for (w, block) in parts {
                let Some(s) = self.system.unknown(w) else {
                    continue;
                };
                for k in 0..n {
                    let column = [jacobian[(s, k)], jacobian[(s + 1, k)], jacobian[(s + 2, k)]];
                    for i in 0..3 {
                        jacobian[(u + i, k)] += block[i][0] * column[0]
                            + block[i][1] * column[1]
                            + block[i][2] * column[2];
                    }
                }
            }
        }
        Ok(jacobian)
    }
}

impl Chart for FrontChart {
    fn system(&self) -> &RodSystem {
        &self.system
    }

    fn dimension(&self) -> usize {
        self.kept.len()
    }

    fn pattern(&self) -> &RowPattern {
        &self.pattern
    }

    fn rows(&self, x: &[f64], values: &mut [f64]) -> Result<(), ChartError> {
        self.fill(x, None, values)
    }

    fn rows_rate(&self, x: &[f64], v: &[f64], values: &mut [f64]) -> Result<(), ChartError> {
        check("v", v, 3 * self.system.vertex_count())?;
        self.fill(x, Some(v), values)
    }

    fn coordinates(&self, x: &[f64], q: &mut [f64]) -> Result<(), ChartError> {
        check_length("q", q.len(), self.dimension())?;
        if self.kept.len() == self.map.coordinate_count() {
            return Ok(self.map.coordinates(x, q)?);
        }
        let mut all = vec![0.0; self.map.coordinate_count()];
        self.map.coordinates(x, &mut all)?;
        for (value, k) in q.iter_mut().zip(&self.kept) {
            *value = all[*k];
        }
        Ok(())
    }

    fn difference(&self, q1: &[f64], q0: &[f64], out: &mut [f64]) {
        for k in 0..out.len() {
            let d = q1[k] - q0[k];
            // A row of one entry is a Cartesian coordinate of a start vertex, all others are angles.
            out[k] = if self.pattern.range(k).len() == 1 {
                d
            } else {
                d.sin().atan2(d.cos())
            };
        }
    }

    fn realise(
        &self,
        linear: &mut Linearised,
        q: &[f64],
        near: &[f64],
        x: &mut [f64],
    ) -> Result<(), ChartError> {
        check("q", q, self.dimension())?;
        if self.kept.len() == self.map.coordinate_count() {
            self.map.realise(q, near, x)?;
            return Ok(());
        }
        check("near", near, x.len())?;
        x.copy_from_slice(near);
        newton(self, linear, q, x)?;
        Ok(())
    }

    fn jacobian(
        &self,
        system: &RodSystem,
        linear: &mut Linearised,
        x: &[f64],
    ) -> Result<DMatrix<f64>, ChartError> {
        self.linearise(system, linear, x)?;
        if self.assignment().closures().is_empty() {
            self.chain_jacobian(x)
        } else {
            Ok(linear.jacobian()?)
        }
    }

    fn margin(&self, x: &[f64]) -> Result<f64, ChartError> {
        Ok(self.map.frame_margin(x)?)
    }

    fn rebased(&self, x: &[f64]) -> Result<Box<dyn Chart>, ChartError> {
        // Which neighbours are on a line depends on the state, so the assignment is made anew as well.
        let assignment = assign(&self.sheet, x, &self.options)?;
        let mut chart = self.clone();
        chart.map = FrontMap::new(&self.sheet, assignment, x, RealiseOptions::default())?;
        chart.select(x)?;
        Ok(Box::new(chart))
    }
}
