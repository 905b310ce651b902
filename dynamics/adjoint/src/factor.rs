//! The factorised matrix that solutions are improved with.

use crate::blocks::Blocks;
use crate::rows::Rows;
use isosheet_linalg::{LinalgError, Pattern, SparseLlt};
use isosheet_model::{PINNED, SheetModel};
use nalgebra::Matrix3;

/// How much stiffer equations are than the matrix at their vertices: what the factorised matrix leaves of
/// them are so many parts.
pub(crate) const STIFFNESS: f64 = 1e12;

/// Growth of a diagonal that makes a matrix positive definite, and its first part of the diagonal.
const GROWTH: f64 = 10.0;
const FIRST_SHIFT: f64 = 1e-3;

/// Most systems that are not tried with the factorisation of another step.
const MOST_SKIPPED: u32 = 16;

/// Largest part of the diagonal.
const LAST_SHIFT: f64 = 1e6;

/// The inverse of
///
/// ```text
/// [ H  G^T ; G  -1/r ],
/// ```
///
/// by a Cholesky factorisation of `H + G^T r G`. It is that of one step, and serves those near it, too.
pub(crate) struct Factor {
    llt: SparseLlt,
    /// Number of pairs when the pattern was made.
    pairs: usize,
    at_vertices: Vec<Option<[u32; 6]>>,
    /// Of each block off the diagonal its slots, row by row, and whether its rows are those of the second
    /// vertex.
    off_diagonal: Vec<Option<([u32; 9], bool)>>,
    /// `r` of each row.
    pub(crate) penalties: Vec<f64>,
    /// Effective step of the factorised matrix, seconds.
    pub(crate) h: f64,
    /// How many factorisations there were.
    pub(crate) count: usize,
    /// Systems in a row that were not solved by the factorisation of another step, and how many of those to
    /// come are not tried.
    failures: u32,
    skipped: u32,
}

impl Factor {
    /// Room for the blocks of a matrix.
    pub(crate) fn new(model: &SheetModel, blocks: &Blocks) -> Result<Self, LinalgError> {
        let free = model.free_index();
        let mut entries: Vec<(u32, u32)> = Vec::new();
        let mut block = |i: u32, j: u32, list: &mut dyn Iterator<Item = (u32, u32)>| {
            let first = entries.len() as u32;
            entries.extend(list.map(|(r, c)| (3 * i + r, 3 * j + c)));
            first
        };
        let lower = || (0..3).flat_map(|r| (0..=r).map(move |c| (r, c)));
        let full = || (0..3).flat_map(|r| (0..3).map(move |c| (r, c)));
        let vertices: Vec<Option<u32>> = free
            .iter()
            .map(|&i| (i != PINNED).then(|| block(i, i, &mut lower())))
            .collect();
        let others: Vec<Option<(u32, bool)>> = blocks
            .off_diagonal()
            .map(|([a, b], _)| {
                let (i, j) = (free[a], free[b]);
                let is_free = i != PINNED && j != PINNED;
                is_free.then(|| (block(i.max(j), i.min(j), &mut full()), j > i))
            })
            .collect();
        let order = 3 * model.free_count();
        let (pattern, slots) = Pattern::from_entries(order, order, &entries);
        let slot = |first: u32, k: usize| slots[first as usize + k];
        Ok(Self {
            llt: SparseLlt::with_blocks(pattern, 3)?,
            pairs: blocks.pair_count(),
            at_vertices: vertices
                .into_iter()
                .map(|first| first.map(|f| std::array::from_fn(|k| slot(f, k))))
                .collect(),
            off_diagonal: others
                .into_iter()
                .map(|o| o.map(|(f, at_b)| (std::array::from_fn(|k| slot(f, k)), at_b)))
                .collect(),
            penalties: Vec::new(),
            h: 0.0,
            count: 0,
            failures: 0,
            skipped: 0,
        })
    }

    /// Whether it has room for all blocks of a matrix.
    pub(crate) fn has_room(&self, blocks: &Blocks) -> bool {
        self.pairs == blocks.pair_count()
    }

    /// Factorises a matrix with its equations, and with more on its diagonal where that is not positive
    /// definite.
    pub(crate) fn factorize(
        &mut self,
        model: &SheetModel,
        blocks: &Blocks,
        rows: &Rows<'_>,
        h: f64,
    ) -> Result<(), LinalgError> {
        self.h = h;
        let stiffness = |v: usize| blocks.at_vertices[v].diagonal().amax();
        self.penalties.clear();
        let rods = model.rods();
        for (ends, l) in rods.edges().iter().zip(rods.lengths()) {
            let [a, b] = ends.map(stiffness);
            self.penalties.push(STIFFNESS * a.max(b) / (l * l));
        }
        for (v, _) in rows.supports() {
            let penalty = STIFFNESS * stiffness(v.index());
            self.penalties.extend([penalty; 3]);
        }
        let mut shift = 0.0;
        loop {
            self.assemble(model, blocks, rows, shift);
            self.count += 1;
            match self.llt.factorize() {
                Ok(()) => return Ok(()),
                Err(error) if shift >= LAST_SHIFT => return Err(error),
                Err(_) => shift = FIRST_SHIFT.max(GROWTH * shift),
            }
        }
    }

    /// Iterations by the factorisation of another step that are worth while: fewer and fewer systems are
    /// tried where that has failed.
    pub(crate) fn patience(&mut self, patience: usize) -> usize {
        if self.skipped > 0 {
            self.skipped -= 1;
            return 0;
        }
        patience
    }

    /// The factorisation of another step was no good.
    pub(crate) fn give_up(&mut self) {
        self.failures = (self.failures + 1).min(MOST_SKIPPED.ilog2());
        self.skipped = 1 << self.failures;
    }

    fn assemble(&mut self, model: &SheetModel, blocks: &Blocks, rows: &Rows<'_>, shift: f64) {
        let mut own = blocks.at_vertices.clone();
        for block in &mut own {
            for k in 0..3 {
                block[(k, k)] += shift * block[(k, k)].abs();
            }
        }
        let rods = model.rods();
        let mut of_edges: Vec<Matrix3<f64>> = Vec::new();
        for (e, [a, b]) in rods.edges().iter().enumerate() {
            let d = rows.rod(e);
            let block = self.penalties[e] * d * d.transpose();
            own[*a] += block;
            own[*b] += block;
            of_edges.push(block);
        }
        for (k, (v, jacobian)) in rows.supports().iter().enumerate() {
            let penalty = self.penalties[rods.len() + 3 * k];
            own[v.index()] += penalty * jacobian.tr_mul(jacobian);
        }
        let values = self.llt.values_mut();
        values.fill(0.0);
        for (slots, block) in self.at_vertices.iter().zip(&own) {
            let Some(slots) = slots else { continue };
            let mut k = 0;
            for r in 0..3 {
                for c in 0..=r {
                    values[slots[k] as usize] += block[(r, c)];
                    k += 1;
                }
            }
        }
        let mut add = |place: &Option<([u32; 9], bool)>, block: &Matrix3<f64>, factor: f64| {
            let Some((slots, is_second)) = place else {
                return;
            };
            for r in 0..3 {
                for c in 0..3 {
                    let entry = match is_second {
                        true => block[(c, r)],
                        false => block[(r, c)],
                    };
                    values[slots[3 * r + c] as usize] += factor * entry;
                }
            }
        };
        for (place, (_, block)) in self.off_diagonal.iter().zip(blocks.off_diagonal()) {
            add(place, block, 1.0);
        }
        for (edge, block) in model.rod_edges().iter().zip(&of_edges) {
            add(&self.off_diagonal[edge.index()], block, -1.0);
        }
    }

    /// Solves in place: `a` (free coordinates) becomes `w`, and `b` (rows) becomes the multipliers.
    pub(crate) fn solve(&mut self, rows: &Rows<'_>, space: &mut Space<'_>, z: &mut [f64]) {
        let split = space.free();
        if rows.len() > 0 {
            let (a, b) = z.split_at_mut(split);
            space.full.fill(0.0);
            for (m, (b, r)) in space.rows.iter_mut().zip(b.iter().zip(&self.penalties)) {
                *m = r * b;
            }
            rows.add_transpose(&space.rows, &mut space.full);
            space.gather_add(a);
        }
        self.llt.solve(&mut z[..split]);
        if rows.len() > 0 {
            let (a, b) = z.split_at_mut(split);
            space.scatter(a);
            rows.apply(&space.full, &mut space.rows);
            for ((b, g), r) in b.iter_mut().zip(&space.rows).zip(&self.penalties) {
                *b = r * (g - *b);
            }
        }
    }
}

/// Room for vectors of all vertices, and which of them are free.
#[derive(Debug)]
pub(crate) struct Space<'a> {
    pub(crate) model: &'a SheetModel,
    /// `3V`.
    pub(crate) full: Vec<f64>,
    pub(crate) rows: Vec<f64>,
}

impl<'a> Space<'a> {
    pub(crate) fn new(model: &'a SheetModel, rows: usize) -> Self {
        Self {
            model,
            full: vec![0.0; model.coordinate_count()],
            rows: vec![0.0; rows],
        }
    }

    /// Number of free coordinates.
    pub(crate) fn free(&self) -> usize {
        3 * self.model.free_count()
    }

    /// Adds the free entries to a packed vector.
    pub(crate) fn gather_add(&self, packed: &mut [f64]) {
        for (v, i) in self.model.free_index().iter().enumerate() {
            if *i != PINNED {
                for k in 0..3 {
                    packed[3 * *i as usize + k] += self.full[3 * v + k];
                }
            }
        }
    }

    /// Sets the free entries to those of a packed vector, and the others to zero.
    pub(crate) fn scatter(&mut self, packed: &[f64]) {
        for (v, i) in self.model.free_index().iter().enumerate() {
            let row = &mut self.full[3 * v..3 * v + 3];
            match *i == PINNED {
                true => row.fill(0.0),
                false => row.copy_from_slice(&packed[3 * *i as usize..3 * *i as usize + 3]),
            }
        }
    }
}
