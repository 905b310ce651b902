//! The unsymmetric saddle-point matrix of the conservative integrators.

use crate::conservative::constraints::SaddleBlocks;
use crate::linear::free::{gather, scatter};
use crate::linear::layout::{DIAGONAL, FULL, Layout, Slots};
use crate::report::effort::SolverEffort;
use crate::report::step_report::StepOutcome;
use crate::{HessianSink, SheetModel};
use isosheet_linalg::{LinalgError, SparseLu};
use isosheet_materials::potential::Memories;
use isosheet_mesh::{EdgeId, VertexId};
use isosheet_model::PINNED;
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
    /// Blocks of free vertices.
    vertex_slots: Vec<Option<Block>>,
    /// Blocks (a, b) and (b, a) of each edge with two free ends.
    edge_slots: Vec<Option<[Block; 2]>>,
    /// Blocks (a, b) and (b, a) of the other pairs of free vertices that potentials couple.
    pair_slots: BTreeMap<[VertexId; 2], [Block; 2]>,
    /// Multiplier columns and rows of the rods with a free end.
    rod_slots: Vec<Option<RodSlots>>,
    /// Multiplier column and row of each equation of the vertex constraints.
    constraint_slots: Vec<[Option<EquationSlots>; 2]>,
    width: Width,
    primal: usize,
    rhs: Vec<f64>,
    mass_scale: f64,
    length_scale: f64,
}

/// Which entries of a vertex block are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Width {
    /// The diagonal: enough unless a potential or a constraint may bring a Hessian.
    Diagonal,
    /// All nine.
    Full,
}

/// Slots of a block; of diagonal blocks the first three are in use.
type Block = [u32; 9];

impl Width {
    fn of(model: &SheetModel) -> Self {
        if model.has_constant_forces() && model.constraints().is_empty() {
            Self::Diagonal
        } else {
            Self::Full
        }
    }

    fn block(self, layout: &mut Layout, pair: [u32; 2]) -> Block {
        match self {
            Self::Full => layout.block(pair, FULL),
            Self::Diagonal => {
                let mut block = [0; 9];
                block[..3].copy_from_slice(&layout.block(pair, DIAGONAL));
                block
            }
        }
    }

    /// Blocks of a pair and of the same pair the other way round.
    fn blocks(self, layout: &mut Layout, [i, j]: [u32; 2]) -> [Block; 2] {
        [self.block(layout, [i, j]), self.block(layout, [j, i])]
    }

    /// Places of the diagonal in a block.
    fn diagonal(self) -> [usize; 3] {
        match self {
            Self::Diagonal => [0, 1, 2],
            Self::Full => [0, 4, 8],
        }
    }

    fn resolve(self, block: &mut Block, slots: &Slots) {
        match self {
            Self::Diagonal => slots.resolve(&mut block[..3]),
            Self::Full => slots.resolve(block),
        }
    }
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
    pub(crate) potentials: Option<(&'a Memories, f64, &'a [f64], f64)>,
    /// The vertex constraints.
    pub(crate) constraints: &'a [SaddleBlocks],
}

/// Regularisation of the rod rows that replaces a singular saddle-point matrix, relative to
/// rods of unit length and mean mass. Residuals stay exact, so it costs iterations only.
const REGULARISATION: f64 = 1e-10;

/// Slots of a multiplier's column and row at the vertices that it acts on.
struct RodSlots {
    /// At the two ends; nothing at pinned ones.
    ends: [Option<EndSlots>; 2],
    diagonal: u32,
    /// Its own row.
    own: u32,
}

#[derive(Debug, Clone, Copy)]
struct EndSlots {
    column: [u32; 3],
    row: [u32; 3],
}

/// Slots of an equation at one vertex.
struct EquationSlots {
    end: EndSlots,
    diagonal: u32,
    /// Its own row.
    own: u32,
}

impl EndSlots {
    /// Of the equation in row `own` at the free vertex `i`.
    fn new(layout: &mut Layout, i: u32, own: u32) -> Self {
        Self {
            column: [0, 1, 2].map(|k| layout.entry(3 * i + k, own)),
            row: [0, 1, 2].map(|k| layout.entry(own, 3 * i + k)),
        }
    }

    fn resolve(&mut self, slots: &Slots) {
        slots.resolve(&mut self.column);
        slots.resolve(&mut self.row);
    }
}

fn resolve_one(place: &mut u32, slots: &Slots) {
    slots.resolve(std::slice::from_mut(place));
}

impl SaddleMatrix {
    pub(crate) fn new(model: &SheetModel) -> Result<Self, LinalgError> {
        let free = model.free_index();
        let width = Width::of(model);
        let primal = 3 * model.free_count();
        let mut layout = Layout::default();
        let mut vertex_slots: Vec<_> = free
            .iter()
            .map(|&i| (i != PINNED).then(|| width.block(&mut layout, [i, i])))
            .collect();
        let pairs = model.rods().edges().iter().map(|e| e.map(|v| free[v]));
        let mut edge_slots: Vec<_> = pairs
            .map(|pair| (!pair.contains(&PINNED)).then(|| width.blocks(&mut layout, pair)))
            .collect();
        let mut pair_slots: BTreeMap<_, _> = model
            .potentials()
            .flat_map(|p| p.couplings())
            .filter(|pair| !pair.iter().any(|v| model.is_pinned(*v)))
            .map(|pair| {
                (
                    pair,
                    width.blocks(&mut layout, pair.map(|v| free[v.index()])),
                )
            })
            .collect();
        let mut next = primal as u32;
        let mut rod_slots = rod_slots(model, &mut layout, &mut next);
        let mut constraint_slots = constraint_slots(model, &mut layout, &mut next);
        let order = next as usize;
        let (pattern, slots) = layout.finish(order);
        let vertices = vertex_slots.iter_mut().flatten();
        let edges = edge_slots.iter_mut().flatten().flatten();
        let pairs = pair_slots.values_mut().flatten();
        vertices
            .chain(edges)
            .chain(pairs)
            .for_each(|block| width.resolve(block, &slots));
        for rod in rod_slots.iter_mut().flatten() {
            let ends = rod.ends.iter_mut().flatten();
            ends.for_each(|end| end.resolve(&slots));
            resolve_one(&mut rod.diagonal, &slots);
        }
        for equation in constraint_slots.iter_mut().flatten().flatten() {
            equation.end.resolve(&slots);
            resolve_one(&mut equation.diagonal, &slots);
        }
        Ok(Self {
            lu: SparseLu::new(pattern)?,
            vertex_slots,
            edge_slots,
            pair_slots,
            rod_slots,
            constraint_slots,
            width,
            primal,
            rhs: vec![0.0; order],
            mass_scale: model.mean_mass(),
            length_scale: model.mean_length(),
        })
    }

    /// Assembles, factorises and solves. `momentum` (`3V`), `rods` and `constraints` hold the right-hand
    /// sides and, on success, the solution.
    ///
    /// Where the matrix is singular, the rods being dependent, a regularised one takes its
    /// place, and the outcome returned says so.
    pub(crate) fn solve(
        &mut self,
        model: &SheetModel,
        system: &System<'_>,
        momentum: &mut [f64],
        rods: &mut [f64],
        constraints: &mut [Vector2<f64>],
        effort: &mut SolverEffort<'_>,
    ) -> Result<StepOutcome, LinalgError> {
        let mut attempt = |delta: f64| {
            effort.factorisations += 1;
            self.assemble(model, system, delta);
            self.lu.factorize()?;
            self.back_substitute(model, momentum, rods, constraints)
        };
        match attempt(0.0) {
            Ok(()) => Ok(StepOutcome::Newton),
            Err(_) => attempt(REGULARISATION).map(|()| StepOutcome::Globalised),
        }
    }

    fn assemble(&mut self, model: &SheetModel, system: &System<'_>, delta: f64) {
        self.lu.values_mut().fill(0.0);
        self.add_masses(model, system);
        self.add_rods(model, system, delta);
        self.add_constraints(model, system, delta);
        if self.width == Width::Diagonal {
            return;
        }
        if let Some((memories, t, x, scale)) = system.potentials {
            let scale = scale / self.mass_scale;
            for (p, at) in model.potentials_at(t, x, memories) {
                p.add_hessian(
                    at,
                    &mut Sink {
                        matrix: self,
                        scale,
                    },
                );
            }
        }
    }

    /// Adds `a M + sum_e p_e (Laplacian of edge e)`.
    fn add_masses(&mut self, model: &SheetModel, system: &System<'_>) {
        let (a, p) = (system.mass, system.density);
        let per_mass = 1.0 / self.mass_scale;
        let diagonal = self.width.diagonal();
        let values = self.lu.values_mut();
        let mut add = |block: &Block, value: f64| {
            for k in diagonal {
                values[block[k] as usize] += value;
            }
        };
        for (block, mass) in self.vertex_slots.iter().zip(&model.mass().vertex) {
            if let Some(block) = block {
                add(block, a * mass * per_mass);
            }
        }
        let off_mass = model.mass().edge.as_deref();
        for (e, ends) in model.rods().edges().iter().enumerate() {
            let density = p[e] * per_mass;
            if density != 0.0 {
                let blocks = ends.iter().filter_map(|v| self.vertex_slots[*v].as_ref());
                blocks.for_each(|block| add(block, density));
            }
            if let Some(blocks) = &self.edge_slots[e] {
                let entry = off_mass.map_or(0.0, |m| a * m[e] * per_mass) - density;
                blocks.iter().for_each(|block| add(block, entry));
            }
        }
    }

    /// Sets the rows and columns of the rods.
    fn add_rods(&mut self, model: &SheetModel, system: &System<'_>, delta: f64) {
        let (left, right) = (system.left, system.right);
        let per_length = 1.0 / self.length_scale;
        let values = self.lu.values_mut();
        for (rod, &[i, j]) in self.rod_slots.iter().zip(model.rods().edges()) {
            let Some(rod) = rod else { continue };
            for k in 0..3 {
                let l = (left[3 * i + k] - left[3 * j + k]) * per_length;
                let r = (right[3 * i + k] - right[3 * j + k]) * per_length;
                for (end, sign) in rod.ends.iter().zip([1.0, -1.0]) {
                    if let Some(end) = end {
                        values[end.column[k] as usize] = -sign * l;
                        values[end.row[k] as usize] = sign * r;
                    }
                }
            }
            values[rod.diagonal as usize] = -delta;
        }
    }

    /// Sets the rows and columns of the vertex constraints and adds their curvature.
    fn add_constraints(&mut self, model: &SheetModel, system: &System<'_>, delta: f64) {
        let per_mass = 1.0 / self.mass_scale;
        let values = self.lu.values_mut();
        let slots = self.constraint_slots.iter().zip(system.constraints);
        for (c, (equations, blocks)) in model.constraints().iter().zip(slots) {
            for (i, slots) in equations.iter().enumerate() {
                let Some(slots) = slots else { continue };
                for k in 0..3 {
                    values[slots.end.column[k] as usize] = -blocks.left[(i, k)];
                    values[slots.end.row[k] as usize] = blocks.right[(i, k)];
                }
                values[slots.diagonal as usize] = -delta;
            }
            if let Some(block) = &self.vertex_slots[c.vertex().index()] {
                for k in 0..9 {
                    values[block[k] as usize] += blocks.block[(k / 3, k % 3)] * per_mass;
                }
            }
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
        for (rod, l) in self.rod_slots.iter().zip(multipliers) {
            if let Some(rod) = rod {
                packed[rod.own as usize] = l * self.length_scale / self.mass_scale;
            }
        }
        let mut out = vec![0.0; packed.len()];
        self.lu
            .pattern()
            .sub_product(self.lu.values(), &packed, &mut out);
        let mut momentum = vec![0.0; direction.len()];
        scatter(model, &out[..self.primal], &mut momentum);
        momentum.iter_mut().for_each(|m| *m *= -self.mass_scale);
        let rod = |rod: &RodSlots| -out[rod.own as usize] * self.length_scale;
        let rods = self.rod_slots.iter();
        let rods = rods.map(|slots| slots.as_ref().map_or(0.0, rod)).collect();
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
        for (rod, &r) in self.rod_slots.iter().zip(rods.iter()) {
            if let Some(rod) = rod {
                self.rhs[rod.own as usize] = r / self.length_scale;
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
        for (rod, r) in self.rod_slots.iter().zip(rods.iter_mut()) {
            *r = rod.as_ref().map_or(0.0, |rod| {
                self.rhs[rod.own as usize] * self.mass_scale / self.length_scale
            });
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
        let Some(slots) = self.matrix.vertex_slots[v.index()] else {
            return;
        };
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
    fn add_both(&mut self, [ab, ba]: &[Block; 2], block: &Matrix3<f64>) {
        let values = self.matrix.lu.values_mut();
        for k in 0..9 {
            values[ab[k] as usize] += self.scale * block[(k / 3, k % 3)];
            values[ba[k] as usize] += self.scale * block[(k % 3, k / 3)];
        }
    }
}

/// Multiplier rows of the rods that are not pinned at both ends, from row `next` on.
fn rod_slots(model: &SheetModel, layout: &mut Layout, next: &mut u32) -> Vec<Option<RodSlots>> {
    let free = model.free_index();
    let rods = model.rods().edges().iter().map(|e| e.map(|v| free[v]));
    rods.map(|ends| {
        if ends == [PINNED; 2] {
            return None;
        }
        let own = *next;
        *next += 1;
        Some(RodSlots {
            ends: ends.map(|i| (i != PINNED).then(|| EndSlots::new(layout, i, own))),
            diagonal: layout.entry(own, own),
            own,
        })
    })
    .collect()
}

/// Rows of the equations of vertex constraints, from row `next` on.
fn constraint_slots(
    model: &SheetModel,
    layout: &mut Layout,
    next: &mut u32,
) -> Vec<[Option<EquationSlots>; 2]> {
    let free = model.free_index();
    let mut equation = |i: u32| {
        let own = *next;
        *next += 1;
        EquationSlots {
            end: EndSlots::new(layout, i, own),
            diagonal: layout.entry(own, own),
            own,
        }
    };
    let constraints = model.constraints().iter();
    constraints
        .map(|c| {
            let i = free[c.vertex().index()];
            let count = if i == PINNED { 0 } else { c.equation_count() };
            [0, 1].map(|k| (k < count).then(|| equation(i)))
        })
        .collect()
}
