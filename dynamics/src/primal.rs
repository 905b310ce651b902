//! The primal matrix of an implicit step: masses, rods as stiff springs, potentials.

use crate::contact::{ContactTerms, CouplingSink};
use crate::layout::{FULL, LOWER, Layout};
use crate::model::PINNED;
use crate::weak_isometry::{Block, BlockRows, RingBlocks, WeakRows};
use crate::{HessianSink, Isometry, SheetModel, State};
use isosheet_coords::linalg::{LinalgError, Pattern, SparseLlt, norm_inf};
use isosheet_mesh::{EdgeId, VertexId};
use nalgebra::Matrix3;

/// Pairs without contact that keep their room, per pair and rod in use: room costs fill, analysing
/// costs about ten factorisations.
const EXTRA_LIMIT: usize = 2;

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
pub(crate) struct PrimalMatrix {
    llt: SparseLlt,
    /// Slots of the lower triangle of each vertex block, row by row.
    vertex_slots: Vec<Option<[u32; 6]>>,
    /// Slots of each edge block and whether its rows belong to end `b` (else to `a`).
    edge_slots: Vec<Option<([u32; 9], bool)>>,
    /// Blocks of the equations of isometry in weak form, of models that have them.
    rings: Option<RingBlocks>,
    rhs: Vec<f64>,
    /// Pairs of free vertices (in free numbers, larger first) that contact couples beyond the mesh's edges,
    /// sorted.
    extra: Vec<[u32; 2]>,
    couplings: Vec<[u32; 2]>,
    /// Positions at the last assembly (`3V`, metres) and the penalties of the equations.
    x: Vec<f64>,
    axial: Vec<f64>,
    /// Whether the matrix of the last assembly is factorised.
    is_factorised: bool,
}

/// Of a matrix `H + G^T r G` the positions at which the equations were linearised (`3V`, metres) and the
/// penalties `r`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Linearisation<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) penalties: &'a [f64],
}

impl PrimalMatrix {
    pub(crate) fn new(model: &SheetModel) -> Result<Self, LinalgError> {
        Self::with_extra(model, Vec::new())
    }

    /// Room for the blocks of the `extra` pairs of free vertices too.
    fn with_extra(model: &SheetModel, extra: Vec<[u32; 2]>) -> Result<Self, LinalgError> {
        let free = model.free_index();
        let mut layout = Layout::default();
        let mut vertex_slots: Vec<_> = free
            .iter()
            .map(|&i| (i != PINNED).then(|| layout.block([i, i], LOWER)))
            .collect();
        let mut edge_slots: Vec<_> = model
            .rods()
            .edges()
            .iter()
            .map(|&[a, b]| {
                let (i, j) = (free[a], free[b]);
                let both_free = i != PINNED && j != PINNED;
                both_free.then(|| (layout.block([i.max(j), i.min(j)], FULL), j > i))
            })
            .collect();
        for &pair in wide_pairs(model).iter().chain(&extra) {
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
        let rings = model
            .weak_rows()
            .map(|rows| ring_blocks(model, rows, &vertex_slots, &pattern));
        Ok(Self {
            rings,
            llt: SparseLlt::with_blocks(pattern, 3)?,
            vertex_slots,
            edge_slots,
            rhs: vec![0.0; n],
            extra,
            couplings: Vec::new(),
            x: vec![0.0; model.coordinate_count()],
            axial: vec![0.0; model.isometry_rows().len()],
            is_factorised: false,
        })
    }

    /// Makes room for exactly the given pairs of free vertices beyond the edges of the mesh.
    pub(crate) fn reserve(
        &mut self,
        model: &SheetModel,
        pairs: &[[u32; 2]],
    ) -> Result<(), LinalgError> {
        if self.extra != pairs {
            *self = Self::with_extra(model, pairs.to_vec())?;
        }
        Ok(())
    }

    /// The pairs of free vertices (in free numbers, larger first, sorted) beyond the edges of the mesh that
    /// there is room for on account of contact.
    pub(crate) fn extra_pairs(&self) -> &[[u32; 2]] {
        &self.extra
    }

    /// Makes room for what contact couples. The matrix is analysed anew only when a pair
    /// appears that it has no room for; pairs that have parted keep their room until they
    /// outnumber the ones in use.
    pub(crate) fn make_room(
        &mut self,
        model: &SheetModel,
        contact: &ContactTerms<'_>,
    ) -> Result<(), LinalgError> {
        let mut pairs = std::mem::take(&mut self.couplings);
        contact.couplings(&mut pairs);
        let free = model.free_index();
        pairs.retain_mut(|[a, b]| {
            let (i, j) = (free[*a as usize], free[*b as usize]);
            (*a, *b) = (i.max(j), i.min(j));
            i != PINNED && j != PINNED && i != j
        });
        let pattern = self.llt.pattern();
        if pairs
            .iter()
            .any(|&[i, j]| block_start(pattern, i, j).is_none())
        {
            let mut extra = pairs.clone();
            // What was in contact before is likely to be again.
            if self.extra.len() <= EXTRA_LIMIT * (pairs.len() + model.rods().len()) {
                extra.extend_from_slice(&self.extra);
            }
            extra.sort_unstable();
            extra.dedup();
            *self = Self::with_extra(model, extra)?;
        }
        self.couplings = pairs;
        Ok(())
    }

    /// Adds `scale` times the Hessian of contact; call [`PrimalMatrix::make_room`] before.
    pub(crate) fn add_contact(
        &mut self,
        model: &SheetModel,
        contact: &ContactTerms<'_>,
        scale: f64,
    ) {
        contact.add_hessian(&mut Sink {
            matrix: self,
            model,
            scale,
        });
    }

    /// Sets the values: `axial[e] = r_e`, `transverse[e] = p_e`. In weak form `axial` are the penalties of
    /// the equations, whose `J^T r J` takes the place of the rods' `G^T r G`.
    pub(crate) fn assemble(
        &mut self,
        model: &SheetModel,
        x: &[f64],
        axial: &[f64],
        transverse: &[f64],
    ) {
        self.x.copy_from_slice(x);
        self.axial.copy_from_slice(axial);
        self.is_factorised = false;
        let values = self.llt.values_mut();
        values.fill(0.0);
        for (slots, mass) in self.vertex_slots.iter().zip(&model.mass().vertex) {
            if let Some(slots) = slots {
                for k in [0, 2, 5] {
                    values[slots[k] as usize] += mass;
                }
            }
        }
        let off_mass = model.mass().edge.as_deref();
        for (e, &[a, b]) in model.rods().edges().iter().enumerate() {
            let (ia, ib) = (3 * a, 3 * b);
            let d = [x[ia] - x[ib], x[ia + 1] - x[ib + 1], x[ia + 2] - x[ib + 2]];
            let r = if self.rings.is_some() { 0.0 } else { axial[e] };
            let p = transverse[e];
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
            if let Some((slots, _)) = &self.edge_slots[e] {
                /// Of each entry of the whole block its place in the lower triangle.
                const SYMMETRIC: [usize; 9] = [0, 1, 3, 1, 2, 4, 3, 4, 5];
                for k in 0..9 {
                    values[slots[k] as usize] -= block[SYMMETRIC[k]];
                }
                if let Some(m) = off_mass {
                    for k in [0, 4, 8] {
                        values[slots[k] as usize] += m[e];
                    }
                }
            }
        }
        if let Some((rings, rows)) = self.rings.as_mut().zip(model.weak_rows()) {
            rings.add(rows, x, axial, values);
        }
    }

    /// Adds `scale` times the Hessians of the potentials.
    pub(crate) fn add_potentials(&mut self, model: &SheetModel, t: f64, x: &[f64], scale: f64) {
        for p in model.potentials() {
            let matrix = &mut *self;
            p.add_hessian(
                t,
                x,
                &mut Sink {
                    matrix,
                    model,
                    scale,
                },
            );
        }
    }

    /// Adds `scale` times positive semidefinite parts of the Hessians of the potentials.
    pub(crate) fn add_semidefinite_potentials(
        &mut self,
        model: &SheetModel,
        t: f64,
        x: &[f64],
        scale: f64,
    ) {
        for p in model.potentials() {
            let matrix = &mut *self;
            p.add_semidefinite_hessian(
                t,
                x,
                &mut Sink {
                    matrix,
                    model,
                    scale,
                },
            );
        }
    }

    /// Receives blocks that are added as they are.
    pub(crate) fn sink<'a>(&'a mut self, model: &'a SheetModel) -> impl HessianSink + 'a {
        Sink {
            matrix: self,
            model,
            scale: 1.0,
        }
    }

    pub(crate) fn factorize(&mut self) -> Result<(), LinalgError> {
        self.llt.factorize()?;
        self.is_factorised = true;
        Ok(())
    }

    /// Of the matrix that is factorised; nothing before the first factorisation and after a failed one.
    pub(crate) fn linearisation(&self) -> Option<Linearisation<'_>> {
        self.is_factorised.then_some(Linearisation {
            x: &self.x,
            penalties: &self.axial,
        })
    }

    /// `K v` with the values assembled last, zero at pinned vertices.
    #[cfg(test)]
    pub(crate) fn product(&mut self, model: &SheetModel, v: &[f64]) -> Vec<f64> {
        gather(model, v, &mut self.rhs);
        let mut packed = vec![0.0; self.rhs.len()];
        self.llt
            .pattern()
            .sub_symmetric_product(self.llt.values(), &self.rhs, &mut packed);
        packed.iter_mut().for_each(|p| *p = -*p);
        let mut full = vec![0.0; v.len()];
        scatter(model, &packed, &mut full);
        full
    }

    /// `out = K^-1 b`, zero at pinned vertices.
    pub(crate) fn solve(&mut self, model: &SheetModel, b: &[f64], out: &mut [f64]) {
        gather(model, b, &mut self.rhs);
        self.llt.solve(&mut self.rhs);
        scatter(model, &self.rhs, out);
    }
}

struct Sink<'a> {
    matrix: &'a mut PrimalMatrix,
    model: &'a SheetModel,
    scale: f64,
}

impl HessianSink for Sink<'_> {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        let Some(slots) = self.matrix.vertex_slots[v.index()] else {
            return;
        };
        let values = self.matrix.llt.values_mut();
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
        if let Some((slots, rows_at_b)) = self.matrix.edge_slots[e.index()] {
            let values = self.matrix.llt.values_mut();
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
        CouplingSink::add(self, a.0, b.0, block);
    }
}

/// Pairs of free vertices (in free numbers, larger first) that potentials and the equations of isometry
/// couple beyond the mesh's edges.
fn wide_pairs(model: &SheetModel) -> Vec<[u32; 2]> {
    let free = model.free_index();
    let pairs = model.potentials().flat_map(|p| p.couplings());
    let rings = model.weak_rows().into_iter().flat_map(WeakRows::couplings);
    pairs
        .chain(rings)
        .map(|[a, b]| [free[a.index()], free[b.index()]])
        .filter(|[i, j]| *i != PINNED && *j != PINNED && i != j)
        .map(|[i, j]| [i.max(j), i.min(j)])
        .collect()
}

/// Where the blocks of the equations in weak form are.
fn ring_blocks(
    model: &SheetModel,
    rows: &WeakRows,
    vertex_slots: &[Option<[u32; 6]>],
    pattern: &Pattern,
) -> RingBlocks {
    let free = model.free_index();
    RingBlocks::new(rows, |a, b| {
        let (i, j) = (free[a.index()], free[b.index()]);
        if i == PINNED || j == PINNED {
            return None;
        }
        if i == j {
            return vertex_slots[a.index()].map(Block::Diagonal);
        }
        let start = block_start(pattern, i.max(j), i.min(j))?;
        let rows = if i > j {
            BlockRows::First
        } else {
            BlockRows::Second
        };
        Some(Block::Pair(start.map(|s| s as u32), rows))
    })
}

impl CouplingSink for Sink<'_> {
    fn add(&mut self, a: u32, b: u32, block: &Matrix3<f64>) {
        if a == b {
            self.add_vertex(VertexId(a), block);
            return;
        }
        let free = self.model.free_index();
        let (i, j) = (free[a as usize], free[b as usize]);
        if i == PINNED || j == PINNED {
            return;
        }
        let llt = &mut self.matrix.llt;
        let start = block_start(llt.pattern(), i.max(j), i.min(j))
            .expect("the pair was named before: by a potential, or by contact in make_room");
        let values = llt.values_mut();
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

/// Copies the free entries of `full` (`3V`) into `packed`.
pub(crate) fn gather(model: &SheetModel, full: &[f64], packed: &mut [f64]) {
    for (v, &i) in model.free_index().iter().enumerate() {
        if i != PINNED {
            let i = 3 * i as usize;
            packed[i..i + 3].copy_from_slice(&full[3 * v..3 * v + 3]);
        }
    }
}

/// Copies `packed` to the free entries of `full` (`3V`) and zeroes the others.
pub(crate) fn scatter(model: &SheetModel, packed: &[f64], full: &mut [f64]) {
    for (v, &i) in model.free_index().iter().enumerate() {
        let row = &mut full[3 * v..3 * v + 3];
        if i == PINNED {
            row.fill(0.0);
        } else {
            let i = 3 * i as usize;
            row.copy_from_slice(&packed[i..i + 3]);
        }
    }
}

/// Penalty of each equation of isometry, `kappa` times the inverse of `J M^-1 J^T` at rest: scale free, so
/// that slivers and heavy vertices are treated alike. For a rod `kappa m_e / l_e^2` with `m_e` the reduced
/// mass of its free ends, kilograms per square metre; in weak form kilogram square metres.
pub(crate) fn penalties(model: &SheetModel, kappa: f64) -> Vec<f64> {
    let rods = model.rods();
    let inverse = |v: usize| {
        if model.free_index()[v] == PINNED {
            0.0
        } else {
            1.0 / model.mass().vertex[v]
        }
    };
    if let Some(weak) = model.weak_rows() {
        let unit = weak.unit_penalties(|v| inverse(v.index()));
        return unit.into_iter().map(|p| kappa * p).collect();
    }
    if model.isometry() == Isometry::Elastic {
        return vec![0.0; rods.len()];
    }
    rods.edges()
        .iter()
        .zip(rods.lengths())
        .map(|(&[a, b], l)| {
            let sum = inverse(a) + inverse(b);
            if sum == 0.0 {
                0.0
            } else {
                kappa / (sum * l * l)
            }
        })
        .collect()
}

/// Smallest edge strain, or strain of the isometry in weak form, that round-off in the coordinates allows to
/// ask for.
pub(crate) fn strain_floor(model: &SheetModel, state: &State) -> f64 {
    let size = norm_inf(&state.x);
    if let Some(weak) = model.weak_rows() {
        return 4.0 * f64::EPSILON * weak.round_off(size);
    }
    let shortest = model
        .rods()
        .lengths()
        .iter()
        .fold(f64::INFINITY, |m, l| m.min(*l));
    4.0 * f64::EPSILON * (size / shortest + 1.0)
}

/// Inner product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Velocities below this are round-off: of the speed, and of positions over a step.
pub(crate) fn velocity_round_off(state: &State, h: f64) -> f64 {
    16.0 * f64::EPSILON * (norm_inf(&state.x) / h.abs() + norm_inf(&state.v))
}
