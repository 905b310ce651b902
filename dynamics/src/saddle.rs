//! The unsymmetric saddle-point matrix of the conservative integrators.

use crate::constraint::conservative::SaddleBlocks;
use crate::model::PINNED;
use crate::primal::{gather, scatter};
use crate::report::{Effort, Path};
use crate::{HessianSink, SheetModel};
use isosheet_coords::linalg::{LinalgError, Pattern, SparseLu};
use isosheet_mesh::{EdgeId, VertexId};
use nalgebra::{Matrix3, Vector2};
use std::collections::BTreeMap;

/// The matrix
///
/// ```text
/// [ a M + sum_e p_e (Laplacian of edge e) + s d2V/dx2    -G(left)^T ]
/// [ G(right)                                                 -delta ]
/// ```
///
/// over the free vertices and the rods that are not pinned at both ends, with its sparse LU.
///
/// Both block rows are scaled, momenta by the mean mass and lengths by the mean rod, so that
/// partial pivoting compares like with like.
pub(crate) struct SaddleMatrix {
    lu: SparseLu,
    /// Slots of the vertex blocks: nine entries or, without potential Hessians, the diagonal.
    vertex_slots: Vec<[u32; 9]>,
    /// Slots of the blocks (a, b) and (b, a) of each edge.
    edge_slots: Vec<Option<[[u32; 9]; 2]>>,
    /// Slots of the blocks (a, b) and (b, a) of the other pairs of vertices that potentials couple.
    pair_slots: BTreeMap<[VertexId; 2], [[u32; 9]; 2]>,
    /// Slots of the multiplier column and row of each rod: `[end][axis][column or row]`.
    rod_slots: Vec<Option<RodSlots>>,
    /// Row of each rod after the momenta.
    rod_index: Vec<u32>,
    /// Slots of each equation of a vertex constraint.
    constraint_slots: Vec<[Option<EquationSlots>; 2]>,
    width: usize,
    primal: usize,
    rhs: Vec<f64>,
    mass_scale: f64,
    length_scale: f64,
}

/// What to put into a [`SaddleMatrix`].
pub(crate) struct System<'a> {
    /// Factor `a` of the mass matrix.
    pub(crate) mass: f64,
    /// Densities `p` of the rods.
    pub(crate) density: &'a [f64],
    /// Positions at which the columns of `G` are taken.
    pub(crate) left: &'a [f64],
    /// Positions at which its rows are taken.
    pub(crate) right: &'a [f64],
    /// Time, positions and factor `s` of the Hessians of the potentials.
    pub(crate) potentials: Option<(f64, &'a [f64], f64)>,
    /// The vertex constraints.
    pub(crate) constraints: &'a [SaddleBlocks],
}

/// Regularisation of the rod rows that replaces a singular saddle-point matrix, relative to
/// rods of unit length and mean mass. Residuals stay exact, so it costs iterations only.
const REGULARISATION: f64 = 1e-10;

struct RodSlots {
    column: [[u32; 3]; 2],
    row: [[u32; 3]; 2],
    diagonal: u32,
}

/// Slots of an equation at one vertex.
struct EquationSlots {
    column: [u32; 3],
    row: [u32; 3],
    diagonal: u32,
    /// Its row after those of the rods.
    own: u32,
}

/// Marks an end of a rod that has no unknowns.
const NO_SLOT: u32 = u32::MAX;

impl SaddleMatrix {
    pub(crate) fn new(model: &SheetModel) -> Result<Self, LinalgError> {
        let free = model.free_index();
        // Scalar blocks suffice unless a potential or a constraint may bring a Hessian.
        let width = if model.has_constant_forces() && model.constraints().is_empty() {
            3
        } else {
            9
        };
        let primal = 3 * model.free_count();
        let mut entries = Vec::new();
        let block = |entries: &mut Vec<(u32, u32)>, i: u32, j: u32| {
            for k in 0..width as u32 {
                let (r, c) = if width == 3 { (k, k) } else { (k / 3, k % 3) };
                entries.push((3 * i + r, 3 * j + c));
            }
        };
        for &i in free.iter().filter(|&&i| i != PINNED) {
            block(&mut entries, i, i);
        }
        let mut rod_index = Vec::with_capacity(model.rods().len());
        let mut rods = 0;
        for &[a, b] in model.rods().edges() {
            let (i, j) = (free[a], free[b]);
            if i == PINNED && j == PINNED {
                rod_index.push(PINNED);
                continue;
            }
            let own = primal as u32 + rods;
            rod_index.push(own);
            rods += 1;
            if i != PINNED && j != PINNED {
                block(&mut entries, i, j);
                block(&mut entries, j, i);
            }
            for end in [i, j] {
                if end != PINNED {
                    for k in 0..3 {
                        entries.push((3 * end + k, own));
                        entries.push((own, 3 * end + k));
                    }
                }
            }
            entries.push((own, own));
        }
        for c in model.constraints() {
            let v = free[c.vertex().index()];
            for _ in 0..if v == PINNED { 0 } else { c.equation_count() } {
                let own = primal as u32 + rods;
                rods += 1;
                for k in 0..3 {
                    entries.push((3 * v + k, own));
                    entries.push((own, 3 * v + k));
                }
                entries.push((own, own));
            }
        }
        let pairs: Vec<[VertexId; 2]> = model
            .potentials()
            .iter()
            .flat_map(|p| p.couplings())
            .collect();
        let both_free = |[a, b]: &[VertexId; 2]| !model.is_pinned(*a) && !model.is_pinned(*b);
        for [a, b] in pairs.iter().copied().filter(|p| both_free(p)) {
            let (i, j) = (free[a.index()], free[b.index()]);
            block(&mut entries, i, j);
            block(&mut entries, j, i);
        }
        let order = primal + rods as usize;
        let (pattern, slots) = Pattern::from_entries(order, order, &entries);
        let mut next = slots.iter().copied();
        let mut take = || next.next().expect("one slot per entry");
        let take_block = |take: &mut dyn FnMut() -> u32| {
            let mut b = [NO_SLOT; 9];
            for k in 0..width {
                b[k] = take();
            }
            b
        };
        let vertex_slots = free
            .iter()
            .map(|&i| {
                if i == PINNED {
                    [NO_SLOT; 9]
                } else {
                    take_block(&mut take)
                }
            })
            .collect();
        let mut edge_slots = Vec::with_capacity(rod_index.len());
        let mut rod_slots = Vec::with_capacity(rod_index.len());
        for (&[a, b], &own) in model.rods().edges().iter().zip(&rod_index) {
            let (i, j) = (free[a], free[b]);
            if own == PINNED {
                edge_slots.push(None);
                rod_slots.push(None);
                continue;
            }
            edge_slots.push(if i != PINNED && j != PINNED {
                Some([take_block(&mut take), take_block(&mut take)])
            } else {
                None
            });
            let mut rod = RodSlots {
                column: [[NO_SLOT; 3]; 2],
                row: [[NO_SLOT; 3]; 2],
                diagonal: 0,
            };
            for (side, end) in [i, j].into_iter().enumerate() {
                if end != PINNED {
                    for k in 0..3 {
                        rod.column[side][k] = take();
                        rod.row[side][k] = take();
                    }
                }
            }
            rod.diagonal = take();
            rod_slots.push(Some(rod));
        }
        let mut own = order as u32;
        for c in model.constraints() {
            if !model.is_pinned(c.vertex()) {
                own -= c.equation_count() as u32;
            }
        }
        let constraint_slots = model
            .constraints()
            .iter()
            .map(|c| {
                let count = if model.is_pinned(c.vertex()) {
                    0
                } else {
                    c.equation_count()
                };
                let mut slots = [None, None];
                for equation in &mut slots[..count] {
                    let (mut column, mut row) = ([0; 3], [0; 3]);
                    for k in 0..3 {
                        column[k] = take();
                        row[k] = take();
                    }
                    *equation = Some(EquationSlots {
                        column,
                        row,
                        diagonal: take(),
                        own,
                    });
                    own += 1;
                }
                slots
            })
            .collect();
        let pair_slots = pairs
            .into_iter()
            .filter(both_free)
            .map(|p| (p, [take_block(&mut take), take_block(&mut take)]))
            .collect();
        Ok(Self {
            constraint_slots,
            pair_slots,
            lu: SparseLu::new(pattern)?,
            vertex_slots,
            edge_slots,
            rod_slots,
            rod_index,
            width,
            primal,
            rhs: vec![0.0; order],
            mass_scale: model.mean_mass(),
            length_scale: model.mean_length(),
        })
    }

    /// Assembles, factorises and solves. `momentum` (`3V`), `rods` and `constraints` hold the right-hand sides
    /// and, on success, the solution.
    ///
    /// Where the matrix is singular, the rods being dependent, a regularised one takes its
    /// place, and the path returned says so.
    pub(crate) fn solve(
        &mut self,
        model: &SheetModel,
        system: &System<'_>,
        momentum: &mut [f64],
        rods: &mut [f64],
        constraints: &mut [Vector2<f64>],
        effort: &mut Effort,
    ) -> Result<Path, LinalgError> {
        let mut attempt = |delta: f64| {
            effort.factorisations += 1;
            self.assemble(model, system, delta);
            self.lu.factorize()?;
            self.back_substitute(model, momentum, rods, constraints)
        };
        match attempt(0.0) {
            Ok(()) => Ok(Path::Newton),
            Err(_) => attempt(REGULARISATION).map(|()| Path::Globalised),
        }
    }

    fn assemble(&mut self, model: &SheetModel, system: &System<'_>, delta: f64) {
        let System {
            mass: a,
            density: p,
            left,
            right,
            ..
        } = *system;
        let per_mass = 1.0 / self.mass_scale;
        let per_length = 1.0 / self.length_scale;
        let diagonal: [usize; 3] = if self.width == 3 {
            [0, 1, 2]
        } else {
            [0, 4, 8]
        };
        let values = self.lu.values_mut();
        values.fill(0.0);
        for (v, slots) in self.vertex_slots.iter().enumerate() {
            if slots[0] != NO_SLOT {
                for k in diagonal {
                    values[slots[k] as usize] += a * model.mass().vertex[v] * per_mass;
                }
            }
        }
        let off_mass = model.mass().edge.as_deref();
        for (e, &[i, j]) in model.rods().edges().iter().enumerate() {
            let Some(rod) = &self.rod_slots[e] else {
                continue;
            };
            let density = p[e] * per_mass;
            if density != 0.0 {
                for v in [i, j] {
                    let slots = self.vertex_slots[v];
                    if slots[0] != NO_SLOT {
                        for k in diagonal {
                            values[slots[k] as usize] += density;
                        }
                    }
                }
            }
            if let Some(blocks) = &self.edge_slots[e] {
                let entry = off_mass.map_or(0.0, |m| a * m[e] * per_mass) - density;
                for slots in blocks {
                    for k in diagonal {
                        values[slots[k] as usize] += entry;
                    }
                }
            }
            for k in 0..3 {
                let l = (left[3 * i + k] - left[3 * j + k]) * per_length;
                let r = (right[3 * i + k] - right[3 * j + k]) * per_length;
                for (side, sign) in [(0, 1.0), (1, -1.0)] {
                    if rod.column[side][0] != NO_SLOT {
                        values[rod.column[side][k] as usize] = -sign * l;
                        values[rod.row[side][k] as usize] = sign * r;
                    }
                }
            }
            values[rod.diagonal as usize] = -delta;
        }
        for (c, (slots, entry)) in model
            .constraints()
            .iter()
            .zip(self.constraint_slots.iter().zip(system.constraints))
        {
            for (i, slots) in slots.iter().enumerate() {
                let Some(slots) = slots else { continue };
                for k in 0..3 {
                    values[slots.column[k] as usize] = -entry.left[(i, k)];
                    values[slots.row[k] as usize] = entry.right[(i, k)];
                }
                values[slots.diagonal as usize] = -delta;
            }
            let block = self.vertex_slots[c.vertex().index()];
            if block[0] != NO_SLOT {
                for k in 0..9 {
                    values[block[k] as usize] += entry.block[(k / 3, k % 3)] * per_mass;
                }
            }
        }
        if self.width == 3 {
            return;
        }
        let Some((t, x, scale)) = system.potentials else {
            return;
        };
        let scale = scale / self.mass_scale;
        for p in model.potentials() {
            p.add_hessian(
                t,
                x,
                &mut Sink {
                    matrix: self,
                    scale,
                },
            );
        }
    }

    /// The matrix times a direction and multipliers, in the units of the right-hand sides.
    #[cfg(test)]
    pub(crate) fn product(
        &mut self,
        model: &SheetModel,
        system: &System<'_>,
        direction: &[f64],
        multipliers: &[f64],
    ) -> (Vec<f64>, Vec<f64>) {
        self.assemble(model, system, 0.0);
        let mut packed = vec![0.0; self.rhs.len()];
        gather(model, direction, &mut packed[..self.primal]);
        for (&i, l) in self.rod_index.iter().zip(multipliers) {
            packed[i as usize] = l * self.length_scale / self.mass_scale;
        }
        let mut out = vec![0.0; packed.len()];
        self.lu
            .pattern()
            .sub_product(self.lu.values(), &packed, &mut out);
        let mut momentum = vec![0.0; direction.len()];
        scatter(model, &out[..self.primal], &mut momentum);
        momentum.iter_mut().for_each(|m| *m *= -self.mass_scale);
        let rods = self
            .rod_index
            .iter()
            .map(|&i| -out[i as usize] * self.length_scale)
            .collect();
        (momentum, rods)
    }

    /// Replaces right-hand sides by the solution; leaves them alone on failure.
    fn back_substitute(
        &mut self,
        model: &SheetModel,
        momentum: &mut [f64],
        rods: &mut [f64],
        constraints: &mut [Vector2<f64>],
    ) -> Result<(), LinalgError> {
        gather(model, momentum, &mut self.rhs[..self.primal]);
        self.rhs[..self.primal]
            .iter_mut()
            .for_each(|r| *r /= self.mass_scale);
        for (&i, &r) in self.rod_index.iter().zip(rods.iter()) {
            if i != PINNED {
                self.rhs[i as usize] = r / self.length_scale;
            }
        }
        for (slots, c) in self.constraint_slots.iter().zip(constraints.iter()) {
            for (slots, c) in slots.iter().zip(c.iter()) {
                if let Some(slots) = slots {
                    self.rhs[slots.own as usize] = *c;
                }
            }
        }
        self.lu.solve_refined(&mut self.rhs)?;
        for (slots, c) in self.constraint_slots.iter().zip(constraints.iter_mut()) {
            for (slots, c) in slots.iter().zip(c.iter_mut()) {
                *c = slots
                    .as_ref()
                    .map_or(0.0, |s| self.rhs[s.own as usize] * self.mass_scale);
            }
        }
        scatter(model, &self.rhs[..self.primal], momentum);
        for (&i, r) in self.rod_index.iter().zip(rods.iter_mut()) {
            *r = if i == PINNED {
                0.0
            } else {
                self.rhs[i as usize] * self.mass_scale / self.length_scale
            };
        }
        Ok(())
    }
}

struct Sink<'a> {
    matrix: &'a mut SaddleMatrix,
    scale: f64,
}

impl HessianSink for Sink<'_> {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        let slots = self.matrix.vertex_slots[v.index()];
        if slots[0] == NO_SLOT {
            return;
        }
        let values = self.matrix.lu.values_mut();
        for k in 0..9 {
            values[slots[k] as usize] += self.scale * block[(k / 3, k % 3)];
        }
    }

    fn add_edge(&mut self, e: EdgeId, block: &Matrix3<f64>) {
        if let Some(slots) = self.matrix.edge_slots[e.index()] {
            self.add_both(&slots, block);
        }
    }

    fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
        if let Some(slots) = self.matrix.pair_slots.get(&[a, b]).copied() {
            self.add_both(&slots, block);
        }
    }
}

impl Sink<'_> {
    /// Adds a block and its transpose.
    fn add_both(&mut self, [ab, ba]: &[[u32; 9]; 2], block: &Matrix3<f64>) {
        let values = self.matrix.lu.values_mut();
        for k in 0..9 {
            values[ab[k] as usize] += self.scale * block[(k / 3, k % 3)];
            values[ba[k] as usize] += self.scale * block[(k % 3, k / 3)];
        }
    }
}
