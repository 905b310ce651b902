//! The primal matrix of an implicit step: masses, rods as stiff springs, potentials.

mod cost;
mod far;
mod iterative;
mod low_rank;
mod whole;

use crate::linear::free::{gather, scatter};
use crate::linear::layout::{FULL, LOWER, Layout};
use crate::report::effort::SolverEffort;
use crate::{HessianSink, SheetModel};
use cost::{Direct, expected_iterations};
use far::{FarCouplings, NotNamed, stiff_pairs};
use isosheet_linalg::{LinalgError, Pattern, SparseLlt};
use isosheet_materials::hessian::{BlockSink, CouplingSink};
use isosheet_materials::vectors::add;
use isosheet_mesh::{EdgeId, VertexId};
use isosheet_model::PINNED;
use iterative::{ConjugateGradients, Goal, IterationEnd};
use low_rank::LowRank;
use nalgebra::{Matrix3, Vector3};
use whole::WholeMatrix;

/// Pairs without contact that keep their room, per pair and rod in use: room costs fill, analysing
/// costs about ten factorisations.
const EXTRA_LIMIT: usize = 2;
/// Error of what conjugate gradients solve for, relative to what the factorised matrix alone leaves, in the
/// norm of the matrix: each Newton iteration leaves so much of the error of the one before (Dembo, Eisenstat
/// and Steihaug, SIAM J. Numer. Anal. 19, 1982). Hanging sheets of 289 and 1089 vertices take as many
/// factorisations with 0.3, 0.1, 0.01 and 0.001 as with the whole matrix.
const GRADIENT_ACCURACY: f64 = 0.1;

/// The symmetric matrix
///
/// ```text
/// K = M + sum_e [ p_e I + r_e d_e d_e^T ] (blocks + at aa, bb and - at ab, ba) + s d2V/dx2
/// ```
///
/// over the free vertices (`d_e = x_a - x_b`), and its Cholesky factorisation. With `r_e` the
/// penalty and `p_e` the force density of rod `e` it is the Hessian of an augmented
/// Lagrangian: positive definite whatever the rank of the rigidity matrix, a third the size of
/// the saddle-point matrix and as sparse as the mesh.
///
/// Potentials may couple vertices without a common edge. Bending couples some thirty to each vertex, and a
/// factorisation with these couplings takes ten times as long as one without. So the matrix without them,
/// with their substitutes ([`FarCouplings`]), is factorised where that is the cheaper way, and conjugate
/// gradients on the whole matrix do the rest. Terms of rank one that couple all vertices are no part of what
/// is factorised, and enter solutions exactly ([`LowRank`]).
pub(crate) struct PrimalMatrix {
    /// All but the far couplings.
    near: SparseLlt,
    far: FarCouplings,
    low_rank: LowRank,
    whole: Option<WholeMatrix>,
    /// What the matrix without far couplings and the whole one cost, both without contact.
    costs: Option<[Direct; 2]>,
    /// Norm of the masses of the free vertices, kilograms.
    masses: f64,
    /// Whether conjugate gradients have been too slow since [`PrimalMatrix::begin`].
    is_slow: bool,
    iteration: ConjugateGradients,
    /// Slots of the lower triangle of each vertex block, row by row.
    vertex_slots: Vec<Option<[u32; 6]>>,
    /// Slots of the lower triangle of each free vertex block, row by row, by the free number of the vertex.
    free_slots: Vec<[u32; 6]>,
    /// Slots of each edge block and whether its rows belong to end `b` (else to `a`).
    edge_slots: Vec<Option<([u32; 9], bool)>>,
    rhs: Vec<f64>,
    /// Pairs of free vertices (in free numbers, larger first) that contact couples beyond the mesh's edges,
    /// sorted.
    extra: Vec<[u32; 2]>,
    /// Pairs that potentials couple stiffly, in the same form.
    stiff: Vec<[u32; 2]>,
    /// Positions at the last assembly (`3V`, metres) and the penalties of the equations.
    x: Vec<f64>,
    axial: Vec<f64>,
    factorised: Factorised,
    /// Whether a block had no place since the matrix was last set to zero.
    has_misplaced: bool,
}

/// What is factorised of the matrix assembled last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Factorised {
    Nothing,
    /// All of it, which has no far couplings.
    Near,
    /// All but the far couplings, with their substitutes.
    Substituted,
    /// All of it.
    Whole,
}

/// Of a matrix `H + G^T r G` the positions at which the equations were linearised (`3V`, metres) and the
/// penalties `r`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Linearisation<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) penalties: &'a [f64],
}

impl PrimalMatrix {
    /// Of a model with its potentials.
    pub(crate) fn new(model: &SheetModel) -> Result<Self, LinalgError> {
        let far = FarCouplings::of(model);
        let mut matrix = Self::with_couplings(model, far, Vec::new())?;
        if !matrix.far.pairs().is_empty() {
            let whole = WholeMatrix::new(matrix.near.pattern(), matrix.far.pairs())?;
            matrix.costs = Some([Direct::of(&matrix.near), whole.cost()]);
            matrix.whole = Some(whole);
        }
        Ok(matrix)
    }

    /// Of a model without potentials that couple vertices without a common edge.
    pub(crate) fn of_rods(model: &SheetModel) -> Result<Self, LinalgError> {
        Self::with_couplings(model, FarCouplings::none(model), Vec::new())
    }

    /// Room for the blocks of the `extra` pairs of free vertices too.
    fn with_couplings(
        model: &SheetModel,
        far: FarCouplings,
        extra: Vec<[u32; 2]>,
    ) -> Result<Self, LinalgError> {
        let free = model.free_index();
        let mut layout = Layout::default();
        let mut vertex_slots: Vec<_> = free
            .iter()
            .map(|&i| (i != PINNED).then(|| layout.block([i, i], LOWER)))
            .collect();
        let mut edge_slots: Vec<_> = model
            .edges()
            .edges()
            .iter()
            .map(|&[a, b]| {
                let (i, j) = (free[a], free[b]);
                let both_free = i != PINNED && j != PINNED;
                both_free.then(|| (layout.block([i.max(j), i.min(j)], FULL), j > i))
            })
            .collect();
        let stiff = stiff_pairs(model);
        for &pair in extra.iter().chain(&stiff) {
            layout.block(pair, FULL);
        }
        let n = 3 * model.free_count();
        let (pattern, slots) = layout.finish(n);
        vertex_slots
            .iter_mut()
            .flatten()
            .for_each(|b| slots.resolve(b));
        edge_slots
            .iter_mut()
            .flatten()
            .for_each(|(b, _)| slots.resolve(b));
        Ok(Self {
            near: SparseLlt::with_blocks(pattern, 3)?,
            far,
            low_rank: LowRank::default(),
            whole: None,
            costs: None,
            masses: (0..model.free_index().len())
                .filter(|&v| free[v] != PINNED)
                .map(|v| model.mass().vertex[v])
                .sum(),
            is_slow: false,
            iteration: ConjugateGradients::new(n),
            free_slots: vertex_slots.iter().flatten().copied().collect(),
            vertex_slots,
            edge_slots,
            rhs: vec![0.0; n],
            extra,
            stiff,
            x: vec![0.0; model.coordinate_count()],
            axial: vec![0.0; model.rods().len()],
            factorised: Factorised::Nothing,
            has_misplaced: false,
        })
    }

    /// Changes the pairs that contact couples.
    fn set_extra(&mut self, model: &SheetModel, extra: Vec<[u32; 2]>) -> Result<(), LinalgError> {
        let mut changed = Self::with_couplings(model, FarCouplings::none(model), extra)?;
        std::mem::swap(&mut changed.far, &mut self.far);
        changed.costs = self.costs;
        changed.is_slow = self.is_slow;
        *self = changed;
        Ok(())
    }

    /// Makes room for exactly the given pairs of free vertices beyond the edges of the mesh.
    pub(crate) fn reserve(
        &mut self,
        model: &SheetModel,
        pairs: &[[u32; 2]],
    ) -> Result<(), LinalgError> {
        if self.extra != pairs {
            self.set_extra(model, pairs.to_vec())?;
        }
        Ok(())
    }

    /// The pairs of free vertices (in free numbers, larger first, sorted) beyond the edges of the mesh that
    /// there is room for on account of contact.
    pub(crate) fn extra_pairs(&self) -> &[[u32; 2]] {
        &self.extra
    }

    /// Makes room for further pairs of vertices, which become pairs of free ones. The matrix is analysed anew
    /// only when a pair appears that it has no room for; pairs that have parted keep their room until they
    /// outnumber the ones in use.
    pub(crate) fn make_room(
        &mut self,
        model: &SheetModel,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<(), LinalgError> {
        let free = model.free_index();
        pairs.retain_mut(|[a, b]| {
            let (i, j) = (free[*a as usize], free[*b as usize]);
            (*a, *b) = (i.max(j), i.min(j));
            i != PINNED && j != PINNED && i != j
        });
        let pattern = self.near.pattern();
        if pairs
            .iter()
            .any(|&[i, j]| block_start(pattern, i, j).is_none())
        {
            let mut extra = pairs.clone();
            // What was in contact before is likely to be again.
            if self.extra.len() <= EXTRA_LIMIT * (pairs.len() + model.edges().len()) {
                extra.extend_from_slice(&self.extra);
            }
            extra.sort_unstable();
            extra.dedup();
            self.set_extra(model, extra)?;
        }
        Ok(())
    }

    /// Sets the matrix to masses and rods alone: `axial[e] = r_e`, `transverse[e] = p_e`.
    pub(crate) fn assemble(
        &mut self,
        model: &SheetModel,
        x: &[f64],
        axial: &[f64],
        transverse: &[f64],
    ) {
        self.clear();
        self.add_masses(model);
        self.add_rods(model, x, axial, transverse);
    }

    /// Sets the matrix to zero.
    pub(crate) fn clear(&mut self) {
        self.factorised = Factorised::Nothing;
        self.has_misplaced = false;
        self.far.clear();
        self.low_rank.clear();
        self.near.values_mut().fill(0.0);
    }

    fn add_masses(&mut self, model: &SheetModel) {
        let values = self.near.values_mut();
        for (slots, mass) in self.vertex_slots.iter().zip(&model.mass().vertex) {
            if let Some(slots) = slots {
                for k in [0, 2, 5] {
                    values[slots[k] as usize] += mass;
                }
            }
        }
        for (slots, m) in self
            .edge_slots
            .iter()
            .zip(model.mass().edge.iter().flatten())
        {
            if let Some((slots, _)) = slots {
                for k in [0, 4, 8] {
                    values[slots[k] as usize] += m;
                }
            }
        }
    }

    /// Adds the rods at positions `x` (`3V`, metres): `axial[e] = r_e`, `transverse[e] = p_e`.
    pub(crate) fn add_rods(
        &mut self,
        model: &SheetModel,
        x: &[f64],
        axial: &[f64],
        transverse: &[f64],
    ) {
        self.x.copy_from_slice(x);
        self.axial.copy_from_slice(axial);
        let values = self.near.values_mut();
        for (e, &[a, b]) in model.rods().edges().iter().enumerate() {
            let (ia, ib) = (3 * a, 3 * b);
            let d = [x[ia] - x[ib], x[ia + 1] - x[ib + 1], x[ia + 2] - x[ib + 2]];
            let (r, p) = (axial[e], transverse[e]);
            let block = [
                r * d[0] * d[0] + p,
                r * d[1] * d[0],
                r * d[1] * d[1] + p,
                r * d[2] * d[0],
                r * d[2] * d[1],
                r * d[2] * d[2] + p,
            ];
            for v in [a, b] {
                if let Some(slots) = &self.vertex_slots[v] {
                    for k in 0..6 {
                        values[slots[k] as usize] += block[k];
                    }
                }
            }
            if let Some((slots, _)) = &self.edge_slots[model.rod_edges()[e].index()] {
                /// Of each entry of the whole block its place in the lower triangle.
                const SYMMETRIC: [usize; 9] = [0, 1, 3, 1, 2, 4, 3, 4, 5];
                for k in 0..9 {
                    values[slots[k] as usize] -= block[SYMMETRIC[k]];
                }
            }
        }
    }

    /// Largest diagonal entry of the block of a vertex; zero at pinned ones.
    pub(crate) fn largest_diagonal(&self, v: VertexId) -> f64 {
        let values = self.near.values();
        let slots = self.vertex_slots[v.index()].iter();
        let diagonal = slots.flat_map(|slots| [0, 2, 5].map(|k| values[slots[k] as usize]));
        diagonal.fold(0.0, f64::max)
    }

    /// Receives blocks that are added as they are.
    pub(crate) fn sink<'a>(&'a mut self, model: &'a SheetModel) -> impl BlockSink + 'a {
        self.scaled_sink(model, 1.0)
    }

    /// Receives blocks that are added by `scale` times.
    pub(crate) fn scaled_sink<'a>(
        &'a mut self,
        model: &'a SheetModel,
        scale: f64,
    ) -> impl BlockSink + 'a {
        Sink {
            matrix: self,
            model,
            scale,
        }
    }

    /// Factorises the matrix that was assembled last, or without its far couplings.
    ///
    /// # Errors
    /// [`LinalgError::NotPositiveDefinite`], also where terms of rank one alone would make it positive
    /// definite. (Without far couplings some matrices that are not positive definite are factorised;
    /// [`PrimalMatrix::solve_whole`] finds the ones that matter.)
    pub(crate) fn factorize(&mut self) -> Result<(), LinalgError> {
        if self.far.are_zero() {
            self.factorize_near(Factorised::Near)
        } else if self.is_slow || !self.is_iteration_cheaper() {
            self.factorize_whole()
        } else {
            self.add_substitutes(1.0);
            self.factorize_near(Factorised::Substituted)
        }
    }

    fn factorize_near(&mut self, is: Factorised) -> Result<(), LinalgError> {
        self.near.factorize()?;
        self.low_rank.prepare(|b| self.near.solve(b))?;
        self.factorised = is;
        Ok(())
    }

    /// The number of iterations from which a factorisation of the whole matrix is cheaper.
    fn iterations_worth(&self) -> usize {
        let worth = |[near, whole]: [Direct; 2]| {
            let now = Direct::of(&self.near);
            // Contact makes both dearer, by about as much.
            now.iterations_worth(self.far.operations(), whole + (now - near))
        };
        self.costs.map_or(0, worth)
    }

    /// Whether conjugate gradients are expected to be cheaper than a factorisation of the whole matrix.
    fn is_iteration_cheaper(&self) -> bool {
        let substitutes = self.far.substitute_norm();
        let expected = expected_iterations(substitutes, self.masses, GRADIENT_ACCURACY);
        // (A substitute that is not a number is left to the factorisation of the whole matrix.)
        expected <= self.iterations_worth() as f64
    }

    /// Whether a block had no place: one of a pair that nothing has named, or of a vertex or an edge that
    /// there is not.
    pub(crate) fn has_misplaced(&self) -> bool {
        self.has_misplaced
    }

    /// Whether its factorisations are shared among threads, where there are several.
    pub(crate) fn is_shared(&self) -> bool {
        self.near.is_shared()
    }

    /// Forgets that conjugate gradients have been too slow: a step begins.
    pub(crate) fn begin(&mut self) {
        self.is_slow = false;
    }

    fn add_substitutes(&mut self, scale: f64) {
        let values = self.near.values_mut();
        self.far.for_each_substitute(|i, block| {
            for (slot, (r, c)) in self.free_slots[i].iter().zip(LOWER) {
                values[*slot as usize] += scale * block[(r as usize, c as usize)];
            }
        });
    }

    fn factorize_whole(&mut self) -> Result<(), LinalgError> {
        if self.whole.is_none() {
            let pattern = self.near.pattern();
            self.whole = Some(WholeMatrix::new(pattern, self.far.pairs())?);
        }
        let whole = self.whole.as_mut().expect("it has just been made");
        whole.factorize(self.near.values(), &self.far)?;
        self.low_rank.prepare(|b| whole.solve(b))?;
        self.factorised = Factorised::Whole;
        Ok(())
    }

    /// Of the matrix that is factorised; nothing before the first factorisation and after a failed one.
    pub(crate) fn linearisation(&self) -> Option<Linearisation<'_>> {
        (self.factorised != Factorised::Nothing).then_some(Linearisation {
            x: &self.x,
            penalties: &self.axial,
        })
    }

    /// `K v` with the whole matrix `K` assembled last, zero at pinned vertices.
    #[cfg(test)]
    pub(crate) fn product(&mut self, model: &SheetModel, v: &[f64]) -> Vec<f64> {
        gather(model, v, &mut self.rhs);
        let mut packed = vec![0.0; self.rhs.len()];
        let values = self.near.values();
        let pattern = self.near.pattern();
        pattern.sub_symmetric_product(values, &self.rhs, &mut packed);
        packed.iter_mut().for_each(|p| *p = -*p);
        self.far.add_difference(&self.rhs, &mut packed);
        self.low_rank.add_product(&self.rhs, &mut packed);
        if self.factorised != Factorised::Substituted {
            let at = |i: usize| Vector3::from_column_slice(&self.rhs[3 * i..][..3]);
            self.far.for_each_substitute(|i, block| {
                let sum = block * at(i);
                (0..3).for_each(|k| packed[3 * i + k] += sum[k]);
            });
        }
        let mut full = vec![0.0; v.len()];
        scatter(model, &packed, &mut full);
        full
    }

    /// Whether the matrix that was factorised last has no far couplings but their substitutes.
    #[cfg(test)]
    pub(crate) fn is_iterative(&self) -> bool {
        self.factorised == Factorised::Substituted
    }

    /// Has the whole matrix factorised from now on.
    #[cfg(test)]
    pub(crate) fn leave_iteration(&mut self) {
        self.is_slow = true;
    }

    /// `out = K^-1 b` with the matrix `K` that is factorised, zero at pinned vertices.
    pub(crate) fn solve(&mut self, model: &SheetModel, b: &[f64], out: &mut [f64]) {
        gather(model, b, &mut self.rhs);
        match (self.factorised, &mut self.whole) {
            (Factorised::Whole, Some(whole)) => whole.solve(&mut self.rhs),
            _ => self.near.solve(&mut self.rhs),
        }
        self.low_rank.correct(&mut self.rhs);
        scatter(model, &self.rhs, out);
    }

    /// `out = K^-1 b` with the whole matrix `K`, zero at pinned vertices.
    pub(crate) fn solve_whole(
        &mut self,
        model: &SheetModel,
        b: &[f64],
        out: &mut [f64],
        effort: &mut SolverEffort<'_>,
    ) -> Result<(), LinalgError> {
        if self.factorised != Factorised::Substituted {
            self.solve(model, b, out);
            return Ok(());
        }
        gather(model, b, &mut self.rhs);
        let goal = Goal {
            relative: GRADIENT_ACCURACY,
            max_iterations: self.iterations_worth(),
        };
        let Self { near, low_rank, .. } = self;
        let mut solve = |b: &mut [f64]| {
            near.solve(b);
            low_rank.correct(b);
        };
        let (ending, _) = self.iteration.solve(&mut solve, &self.far, &self.rhs, goal);
        match ending {
            IterationEnd::Solved => scatter(model, &self.iteration.x, out),
            IterationEnd::TooSlow if effort.count_factorisation() => {
                self.is_slow = true;
                self.add_substitutes(-1.0);
                self.factorize_whole()?;
                self.solve(model, b, out);
            }
            // The step has been interrupted, and what follows has no meaning.
            IterationEnd::TooSlow => scatter(model, &self.iteration.x, out),
            IterationEnd::NotDefinite => {
                let (order, index) = (self.rhs.len(), 0);
                return Err(LinalgError::NotPositiveDefinite { order, index });
            }
        }
        Ok(())
    }
}

struct Sink<'a> {
    matrix: &'a mut PrimalMatrix,
    model: &'a SheetModel,
    scale: f64,
}

impl HessianSink for Sink<'_> {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        let slots = self.matrix.vertex_slots.get(v.index());
        self.matrix.has_misplaced |= slots.is_none();
        let Some(slots) = slots.copied().flatten() else {
            return;
        };
        let values = self.matrix.near.values_mut();
        let mut k = 0;
        for r in 0..3 {
            for c in 0..=r {
                values[slots[k] as usize] += self.scale * block[(r, c)];
                k += 1;
            }
        }
    }

    fn add_edge(&mut self, e: EdgeId, block: &Matrix3<f64>) {
        // `block` is d2V/dx_a dx_b, rows at a; the stored block has the rows of the later vertex.
        let slots = self.matrix.edge_slots.get(e.index());
        self.matrix.has_misplaced |= slots.is_none();
        if let Some((slots, rows_at_b)) = slots.copied().flatten() {
            let values = self.matrix.near.values_mut();
            for r in 0..3 {
                for c in 0..3 {
                    let entry = if rows_at_b {
                        block[(c, r)]
                    } else {
                        block[(r, c)]
                    };
                    values[slots[3 * r + c] as usize] += self.scale * entry;
                }
            }
        }
    }

    fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
        let free = self.model.free_index();
        let [Some(&i), Some(&j)] = [a, b].map(|v| free.get(v.index())) else {
            self.matrix.has_misplaced = true;
            return;
        };
        let stiff = &self.matrix.stiff;
        if !stiff.is_empty() && stiff.binary_search(&[i.max(j), i.min(j)]).is_ok() {
            self.add(a.0, b.0, block);
            return;
        }
        let far = &mut self.matrix.far;
        if let Err(NotNamed) = far.add(self.model, [a, b], block, self.scale) {
            self.matrix.has_misplaced = true;
        }
    }

    fn add_square(&mut self, factor: f64, gradient: &[(VertexId, Vector3<f64>)]) {
        let mut packed = vec![0.0; self.matrix.rhs.len()];
        for (v, g) in gradient {
            match self.model.free_index().get(v.index()) {
                None => self.matrix.has_misplaced = true,
                Some(&PINNED) => {}
                Some(&i) => add(&mut packed, VertexId(i), g),
            }
        }
        self.matrix.low_rank.add(self.scale * factor, packed);
    }
}

impl CouplingSink for Sink<'_> {
    fn add(&mut self, a: u32, b: u32, block: &Matrix3<f64>) {
        if a == b {
            self.add_vertex(VertexId(a), block);
            return;
        }
        let free = self.model.free_index();
        let places = [a, b].map(|v| free.get(v as usize).copied());
        if places.contains(&Some(PINNED)) {
            return;
        }
        let near = &mut self.matrix.near;
        let [Some(i), Some(j)] = places else {
            self.matrix.has_misplaced = true;
            return;
        };
        let Some(start) = block_start(near.pattern(), i.max(j), i.min(j)) else {
            self.matrix.has_misplaced = true;
            return;
        };
        let values = near.values_mut();
        for c in 0..3 {
            for r in 0..3 {
                let entry = if i > j { block[(r, c)] } else { block[(c, r)] };
                values[start[c] + r] += self.scale * entry;
            }
        }
    }
}

/// Slots of the first row of the block of two free vertices (`row > col`) in each of its three columns;
/// the other two rows follow.
fn block_start(pattern: &Pattern, row: u32, col: u32) -> Option<[usize; 3]> {
    let mut start = [0; 3];
    for (c, s) in start.iter_mut().enumerate() {
        let column = 3 * col as usize + c;
        let first = pattern.col_ptr()[column];
        let rows = &pattern.row_idx()[first..pattern.col_ptr()[column + 1]];
        *s = first + rows.binary_search(&(3 * row as usize)).ok()?;
    }
    Some(start)
}

#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
