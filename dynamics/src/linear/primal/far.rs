//! Couplings of vertices without a common edge, and what takes their place in a matrix without them.

use crate::{CouplingKind, SheetModel};
use isosheet_linalg::parallel::pieces;
use isosheet_mesh::VertexId;
use isosheet_model::PINNED;
use nalgebra::{Matrix3, Vector3};

/// Part of the square of a block's norm by which the block may differ from one of rank one: round-off.
const ROUND_OFF: f64 = 64.0 * f64::EPSILON;

/// Nanoseconds for the product with a pair, by a profile of a drape of 2437 vertices on one core at 2.4 GHz.
const PAIR_TIME: f64 = 1.6;

/// The blocks `B_ij` of a symmetric matrix for the pairs of free vertices that potentials couple and that
/// have no common edge.
///
/// In a matrix without these blocks the vertices get *substitutes* instead: each pair adds `|B_ij| = (B_ij
/// B_ij^T)^(1/2)` to the block of `i`, and `(B_ij^T B_ij)^(1/2)` to that of `j`. A pair thus differs by the
/// form
///
/// ```text
/// (x_i, x_j) [ |B|  -B ; -B^T  |B^T| ] (x_i, x_j) >= 0,
/// ```
///
/// so that the matrix with substitutes is never less than the one that it replaces. Bending couples vertices
/// far from each other with the sign of a spring that pushes: `B_ij` is positive, and the form is `B (x_i -
/// x_j)^2`. Then translations keep their zero energy, and what is left of the bending energy is that of edges
/// which are springs: as stiff as the sheet for bends of the length of an edge, and stiffer for longer ones.
#[derive(Debug)]
pub(super) struct FarCouplings {
    /// Pairs of free vertices (in free numbers, larger first), sorted.
    pairs: Vec<[u32; 2]>,
    /// What potentials name, in their order.
    named: Vec<Named>,
    /// Of each pair where it is named first.
    first_named: Vec<u32>,
    /// Where the next block is expected.
    next: usize,
    /// Multiples of the identity of each pair.
    multiples: Vec<f64>,
    /// Other blocks of each pair, rows at the first vertex of the pair; empty as long as there are none.
    blocks: Vec<Matrix3<f64>>,
    has_multiples: bool,
    has_blocks: bool,
    /// Substitutes at the free vertices, in the same two parts.
    substitute_multiples: Vec<f64>,
    substitutes: Vec<Matrix3<f64>>,
}

/// A coupling that a potential names.
#[derive(Debug, Clone, Copy)]
struct Named {
    vertices: [VertexId; 2],
    /// The pair, unless a vertex is pinned.
    place: Option<OrientedPair>,
}

/// A pair, and which of its vertices the rows of a block belong to.
#[derive(Debug, Clone, Copy)]
struct OrientedPair {
    pair: u32,
    rows: Rows,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rows {
    First,
    Second,
}

/// No potential has named a pair that one gives a block of.
#[derive(Debug, Clone, Copy)]
pub(super) struct NotNamed;

impl FarCouplings {
    /// Of the potentials of a model.
    pub(super) fn of(model: &SheetModel) -> Self {
        Self::named(model, couplings(model, CouplingKind::Soft))
    }

    /// No couplings.
    pub(super) fn none(model: &SheetModel) -> Self {
        Self::named(model, Vec::new())
    }

    fn named(model: &SheetModel, named: Vec<[VertexId; 2]>) -> Self {
        let pairs = named.iter().filter_map(|n| Some(pair_of(model, *n)?.0));
        let mut pairs: Vec<[u32; 2]> = pairs.collect();
        pairs.sort_unstable();
        pairs.dedup();
        let named = named.into_iter().map(|vertices| Named {
            vertices,
            place: place_of(model, &pairs, vertices),
        });
        let named: Vec<Named> = named.collect();
        let mut first_named = vec![0; pairs.len()];
        for (k, name) in named.iter().enumerate().rev() {
            if let Some(place) = name.place {
                first_named[place.pair as usize] = k as u32;
            }
        }
        Self {
            named,
            first_named,
            next: 0,
            multiples: vec![0.0; pairs.len()],
            blocks: Vec::new(),
            has_multiples: false,
            has_blocks: false,
            substitute_multiples: vec![0.0; model.free_count()],
            substitutes: Vec::new(),
            pairs,
        }
    }

    /// The pairs of free vertices (in free numbers, larger first), sorted.
    pub(super) fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// Whether there are no pairs, or none has got a block.
    pub(super) fn are_zero(&self) -> bool {
        !(self.has_multiples || self.has_blocks)
    }

    /// Forgets all blocks.
    pub(super) fn clear(&mut self) {
        self.next = 0;
        if self.has_multiples {
            self.multiples.fill(0.0);
            self.substitute_multiples.fill(0.0);
            self.has_multiples = false;
        }
        if self.has_blocks {
            self.blocks.fill(Matrix3::zeros());
            self.substitutes.fill(Matrix3::zeros());
            self.has_blocks = false;
        }
    }

    /// Adds `scale` times a block, rows at the first of the two vertices.
    ///
    /// # Errors
    /// [`NotNamed`] if no potential has named the pair.
    pub(super) fn add(
        &mut self,
        model: &SheetModel,
        vertices: [VertexId; 2],
        block: &Matrix3<f64>,
        scale: f64,
    ) -> Result<(), NotNamed> {
        let Some(OrientedPair { pair, rows }) = self.find(model, vertices)? else {
            return Ok(());
        };
        let pair = pair as usize;
        let [i, j] = self.pairs[pair].map(|i| i as usize);
        if let Some(value) = multiple_of_identity(block) {
            let value = scale * value;
            self.multiples[pair] += value;
            self.substitute_multiples[i] += value.abs();
            self.substitute_multiples[j] += value.abs();
            self.has_multiples = true;
            return Ok(());
        }
        if self.blocks.is_empty() {
            self.blocks = vec![Matrix3::zeros(); self.pairs.len()];
            self.substitutes = vec![Matrix3::zeros(); self.substitute_multiples.len()];
        }
        let block = match rows {
            Rows::First => scale * block,
            Rows::Second => scale * block.transpose(),
        };
        self.blocks[pair] += block;
        let [first, second] = absolute(&block);
        self.substitutes[i] += first;
        self.substitutes[j] += second;
        self.has_blocks = true;
        Ok(())
    }

    /// The place of a block; none for a pinned vertex. Potentials give blocks in the order in which they name
    /// pairs, as a rule.
    fn find(
        &mut self,
        model: &SheetModel,
        vertices: [VertexId; 2],
    ) -> Result<Option<OrientedPair>, NotNamed> {
        let expected = self.named.get(self.next);
        if let Some(named) = expected.filter(|named| named.vertices == vertices) {
            self.next += 1;
            return Ok(named.place);
        }
        if pair_of(model, vertices).is_none() {
            return Ok(None);
        }
        let place = place_of(model, &self.pairs, vertices).ok_or(NotNamed)?;
        self.next = self.first_named[place.pair as usize] as usize + 1;
        Ok(Some(place))
    }

    /// Hands the substitute of each free vertex to `add`.
    pub(super) fn for_each_substitute(&self, mut add: impl FnMut(usize, &Matrix3<f64>)) {
        for (i, value) in self.substitute_multiples.iter().enumerate() {
            let mut sum = Matrix3::from_diagonal_element(*value);
            if self.has_blocks {
                sum += self.substitutes[i];
            }
            add(i, &sum);
        }
    }

    /// Adds to `y` the product of `x` (free coordinates) with the blocks less their substitutes.
    pub(super) fn add_difference(&self, x: &[f64], y: &mut [f64]) {
        if self.has_multiples {
            let (x, y) = (x.as_chunks::<3>().0, y.as_chunks_mut::<3>().0);
            let each = PAIR_TIME * self.pairs.len() as f64 / y.len().max(1) as f64;
            pieces(y, each, |first, y| self.add_multiples(x, first, y));
        }
        if self.has_blocks {
            let at = |x: &[f64], i: usize| Vector3::from_column_slice(&x[3 * i..3 * i + 3]);
            let mut add = |i: usize, sum: Vector3<f64>| {
                for k in 0..3 {
                    y[3 * i + k] += sum[k];
                }
            };
            for (i, block) in self.substitutes.iter().enumerate() {
                add(i, -(block * at(x, i)));
            }
            for (&[i, j], block) in self.pairs.iter().zip(&self.blocks) {
                let (i, j) = (i as usize, j as usize);
                add(i, block * at(x, j));
                add(j, block.tr_mul(&at(x, i)));
            }
        }
    }

    /// Adds the product of `x` with the multiples of the identity, less their substitutes, to the rows from
    /// `first` on.
    fn add_multiples(&self, x: &[[f64; 3]], first: usize, y: &mut [[f64; 3]]) {
        let own = x[first..].iter().zip(&self.substitute_multiples[first..]);
        for (y, (x, value)) in y.iter_mut().zip(own) {
            for k in 0..3 {
                y[k] -= value * x[k];
            }
        }
        // Pairs before have both vertices before.
        let begin = self.pairs.partition_point(|[i, _]| (*i as usize) < first);
        let mut add = |row: usize, value: f64, x: &[f64; 3]| {
            if let Some(y) = y.get_mut(row.wrapping_sub(first)) {
                for k in 0..3 {
                    y[k] += value * x[k];
                }
            }
        };
        for (&[i, j], value) in self.pairs.iter().zip(&self.multiples).skip(begin) {
            let (i, j) = (i as usize, j as usize);
            add(i, *value, &x[j]);
            add(j, *value, &x[i]);
        }
    }

    /// Hands each block to `add`, with the number of its pair.
    pub(super) fn for_each(&self, mut add: impl FnMut(usize, &Matrix3<f64>)) {
        for (k, value) in self.multiples.iter().enumerate() {
            let mut sum = Matrix3::from_diagonal_element(*value);
            if self.has_blocks {
                sum += self.blocks[k];
            }
            add(k, &sum);
        }
    }

    /// Multiplications of [`FarCouplings::add_difference`].
    pub(super) fn operations(&self) -> f64 {
        let (pairs, vertices) = (
            self.pairs.len() as f64,
            self.substitute_multiples.len() as f64,
        );
        let count = |is_there: bool, each: f64| if is_there { each } else { 0.0 };
        count(self.has_multiples, 6.0 * pairs + 3.0 * vertices)
            + count(self.has_blocks, 18.0 * pairs + 9.0 * vertices)
    }

    /// Sum of the norms of the substitutes.
    pub(super) fn substitute_norm(&self) -> f64 {
        let multiples: f64 = self.substitute_multiples.iter().sum();
        if !self.has_blocks {
            return multiples;
        }
        multiples + self.substitutes.iter().map(Matrix3::norm).sum::<f64>()
    }
}

/// The pairs of free vertices (in free numbers, larger first) with stiff couplings, sorted.
pub(super) fn stiff_pairs(model: &SheetModel) -> Vec<[u32; 2]> {
    let named = couplings(model, CouplingKind::Stiff).into_iter();
    let mut pairs: Vec<[u32; 2]> = named.filter_map(|n| Some(pair_of(model, n)?.0)).collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

fn couplings(model: &SheetModel, kind: CouplingKind) -> Vec<[VertexId; 2]> {
    let potentials = model.potentials().filter(|p| p.coupling_kind() == kind);
    potentials.flat_map(|p| p.couplings()).collect()
}

/// The pair of two free vertices, and which of these is the first of the pair.
fn pair_of(model: &SheetModel, vertices: [VertexId; 2]) -> Option<([u32; 2], Rows)> {
    let [i, j] = vertices.map(|v| model.free_index()[v.index()]);
    let rows = if i > j { Rows::First } else { Rows::Second };
    (i != PINNED && j != PINNED && i != j).then_some(([i.max(j), i.min(j)], rows))
}

fn place_of(
    model: &SheetModel,
    pairs: &[[u32; 2]],
    vertices: [VertexId; 2],
) -> Option<OrientedPair> {
    let (pair, rows) = pair_of(model, vertices)?;
    let pair = pairs.binary_search(&pair).ok()? as u32;
    Some(OrientedPair { pair, rows })
}

fn multiple_of_identity(block: &Matrix3<f64>) -> Option<f64> {
    let value = block[(0, 0)];
    (*block == Matrix3::from_diagonal_element(value)).then_some(value)
}

/// `(B B^T)^(1/2)` and `(B^T B)^(1/2)`.
fn absolute(block: &Matrix3<f64>) -> [Matrix3<f64>; 2] {
    let squared = block.norm_squared();
    if squared == 0.0 || !squared.is_finite() {
        return [Matrix3::from_element(squared); 2];
    }
    let rows = block * block.transpose();
    // A single fold angle gives a block `u v^T`, whose only singular value is its norm.
    if squared * squared - rows.norm_squared() <= ROUND_OFF * squared * squared {
        let norm = squared.sqrt();
        return [rows / norm, block.tr_mul(block) / norm];
    }
    let svd = block.svd(true, true);
    match (svd.u, svd.v_t) {
        (Some(u), Some(v)) => {
            let values = Matrix3::from_diagonal(&svd.singular_values);
            [u * values * u.transpose(), v.tr_mul(&(values * v))]
        }
        _ => [Matrix3::from_diagonal_element(squared.sqrt()); 2],
    }
}
