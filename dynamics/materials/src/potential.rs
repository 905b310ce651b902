//! Potential energies (Liu, Tang and Joneja 2007, Eq. 1).

use crate::derivative::NoDerivative;
use crate::hessian::HessianSink;
use crate::limit_error::LimitError;
use crate::vectors::dot;
use isosheet_mesh::{EdgeId, FaceId, VertexId};
use nalgebra::Matrix2;
use serde::{Deserialize, Serialize};
use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

/// Where a potential is evaluated.
#[derive(Debug, Clone, Copy)]
pub struct At<'a> {
    /// Time, seconds.
    pub t: f64,
    /// Positions, `3V`, metres.
    pub x: &'a [f64],
    /// What the potential remembers, see [`Remembering`]; empty for most.
    pub memory: &'a [f64],
}

impl<'a> At<'a> {
    /// At a time (seconds) and positions (`3V`, metres), for potentials without memory.
    pub fn new(t: f64, x: &'a [f64]) -> Self {
        Self { t, x, memory: &[] }
    }

    /// With a memory.
    #[must_use]
    pub fn with_memory(self, memory: &'a [f64]) -> Self {
        Self { memory, ..self }
    }
}

/// A state that a simulation has reached, as far as a potential sees it.
#[derive(Debug, Clone, Copy)]
pub struct Reached<'a> {
    /// Time, seconds.
    pub t: f64,
    /// Positions, `3V`, metres.
    pub x: &'a [f64],
    /// Velocities, `3V`, metres per second.
    pub v: &'a [f64],
}

/// What making a memory that of the end of a step does to the energy of a potential.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Settled {
    /// Energy that has been dissipated in the step, by which the energy falls, joules.
    pub dissipated: f64,
    /// Work by which the energy rises, joules.
    pub work: f64,
}

/// A potential energy of the vertex positions, `V(t, x)`, from which the forces are
/// `f = -dV/dx`.
///
/// A value and a gradient are enough. The Hessian only speeds the implicit integrators up:
/// without it their Newton iterations converge linearly in this term instead of
/// quadratically.
pub trait Potential: Any + Debug + Send + Sync {
    /// Energy, joules.
    fn energy(&self, at: At<'_>) -> f64;

    /// Adds `dV/dx` (`3V`, newtons) to `gradient`.
    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]);

    /// Adds second derivatives to `hessian`. The default adds none.
    fn add_hessian(&self, _at: At<'_>, _hessian: &mut dyn HessianSink) {}

    /// Which parts of another potential have other energies than its own at some time, positions or memory,
    /// as far as that can be told by numbers: whoever compares models evaluates these alone. The default
    /// cannot tell, and says all.
    fn difference(&self, _other: &dyn Potential) -> Difference {
        Difference::Everything
    }

    /// As [`Potential::add_gradient`], of some [parts](Potential::difference) alone. The default has no
    /// parts, and adds all.
    fn add_gradient_of(&self, _parts: &[u32], at: At<'_>, gradient: &mut [f64]) {
        self.add_gradient(at, gradient);
    }

    /// How [`Potential::add_hessian`] is to be taken by whoever needs all second derivatives. The default
    /// says that they are there.
    fn hessian_kind(&self) -> HessianKind {
        HessianKind::Exact
    }

    /// Adds a positive semidefinite part of the second derivatives, for minimisations where the whole Hessian
    /// is indefinite. The default adds what [`Potential::add_hessian`] adds; where that is indefinite too,
    /// the curvature of all potentials is left out.
    fn add_semidefinite_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        self.add_hessian(at, hessian);
    }

    /// The pairs of vertices without a common edge that [`Potential::add_hessian`] couples by
    /// [`HessianSink::add_pair`]; they have to be the same at all times and positions. The default names
    /// none.
    fn couplings(&self) -> Vec<[VertexId; 2]> {
        Vec::new()
    }

    /// How stiff the [`Potential::couplings`] are.
    fn coupling_kind(&self) -> CouplingKind {
        CouplingKind::Soft
    }

    /// Whether the energy depends on time at fixed positions. If it says so, the work of changing it enters
    /// the energy balance; the default says no.
    fn is_driven(&self) -> bool {
        false
    }

    /// Size of the round-off in an energy (joules) where the coordinates are of the given size (metres),
    /// joules, if it is more than that of the energy itself.
    fn round_off(&self, _size: f64, _energy: f64) -> f64 {
        0.0
    }

    /// How the energy depends on the positions.
    fn shape(&self) -> PotentialShape {
        PotentialShape::General
    }

    /// The limit beyond which the energy is infinite, of a potential that has one. The default has none.
    fn limit(&self) -> Option<&dyn Limited> {
        None
    }

    /// What the energy depends on besides time and positions, of a potential that remembers. The default does
    /// not.
    fn remembering(&self) -> Option<&dyn Remembering> {
        None
    }

    /// What it tells of its material, of a potential that bends or creases. The default tells nothing.
    fn report(&self) -> Option<&dyn MaterialReport> {
        None
    }
}

/// A potential whose energy is infinite beyond a limit, such as that of the strain of an elastic sheet: the
/// methods keep every iterate within it. For BDF2 and implicit Euler.
pub trait Limited {
    /// Whether what is prescribed leaves a place within the limit at a time and positions, such as lengths
    /// that grow by themselves. The default says so.
    ///
    /// # Errors
    /// [`LimitError`], such as [`LimitError::Refused`].
    fn check(&self, _at: At<'_>) -> Result<(), LimitError> {
        Ok(())
    }

    /// Largest part of the displacement `dx` (`3V`, metres), at most one, that is proven to stay within the
    /// limit.
    fn safe_part(&self, at: At<'_>, dx: &[f64]) -> f64;

    /// Whether the energy at positions `end` is within the limit, of a displacement from where it is,
    /// whatever the way.
    fn stays_within(&self, at: At<'_>, end: &[f64]) -> bool;

    /// Adds `scale` times what is of second order in the displacement `dx` (`3V`, metres) and can be taken
    /// back by a displacement of second order, such as the strain of faces that turn, to the gradient at its
    /// start; whether there is any. The steps of potentials that have it are curved. The default has none.
    fn add_second_order(&self, _at: At<'_>, _dx: &[f64], _scale: f64, _out: &mut [f64]) -> bool {
        false
    }
}

/// A potential whose energy depends on more than time and positions: on plastic deformations, or on the way
/// of what it holds. A simulation keeps the memory, and hands it over as [`At::memory`].
pub trait Remembering {
    /// The memory before anything has happened. Its length never changes.
    fn memory(&self) -> Vec<f64>;

    /// Makes a memory that of a state at which a simulation starts. The default leaves it.
    fn start(&self, _state: Reached<'_>, _memory: &mut [f64]) {}

    /// Makes a memory that of the state at which a step has ended; what that does to the energy. It changes
    /// no force at the state, and as the energy before it is that of the step, nothing is dissipated where a
    /// step is refused. The default leaves it.
    fn settle(&self, _state: Reached<'_>, _memory: &mut [f64]) -> Settled {
        Settled::default()
    }

    /// What [`Remembering::settle`] chooses at a state with a memory, where it would choose otherwise by the
    /// slightest change: numbers that say so to [`Remembering::settle_by`]. The default chooses nothing.
    fn choices(&self, _state: Reached<'_>, _memory: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// As [`Remembering::settle`], with the choices of a potential that is nearly the same. The default has
    /// none.
    fn settle_by(&self, _choices: &[f64], state: Reached<'_>, memory: &mut [f64]) {
        self.settle(state, memory);
    }

    /// Which parts of another potential may make other memories of a state, as far as that can be told. The
    /// default cannot tell, and says all.
    fn memory_difference(&self, _other: &dyn Potential) -> Difference {
        Difference::Everything
    }

    /// The sum of the products of `of` with the memory that [`Remembering::settle_by`] makes of the one that
    /// was found, by its choices: of some [parts](Remembering::memory_difference) alone. The default has
    /// no parts, and sums all.
    fn settled_product(
        &self,
        _parts: Option<&[u32]>,
        state: Reached<'_>,
        (found, choices): (&[f64], &[f64]),
        of: &[f64],
    ) -> f64 {
        let mut memory = found.to_vec();
        self.settle_by(choices, state, &mut memory);
        dot(of, &memory)
    }

    /// Adds to `of_memory` the derivatives of `w . dV/dx` by the numbers of the memory, with the vector `w`
    /// (`3V`).
    ///
    /// # Errors
    /// [`NoDerivative`], the default of a potential that remembers anything.
    fn add_memory_products(
        &self,
        _at: At<'_>,
        _w: &[f64],
        _of_memory: &mut [f64],
    ) -> Result<(), NoDerivative> {
        match self.memory().is_empty() {
            true => Ok(()),
            false => Err(NoDerivative::of_type::<Self>("what it remembers")),
        }
    }

    /// Adds to `of_memory` `scale` times the derivatives of the energy by the numbers of the memory.
    ///
    /// # Errors
    /// [`NoDerivative`], the default of a potential that remembers anything.
    fn add_memory_slopes(
        &self,
        _at: At<'_>,
        _scale: f64,
        _of_memory: &mut [f64],
    ) -> Result<(), NoDerivative> {
        match self.memory().is_empty() {
            true => Ok(()),
            false => Err(NoDerivative::of_type::<Self>("what it remembers")),
        }
    }

    /// Of [`Remembering::settle`] at a state, with the memory that it found and its
    /// [choices](Remembering::choices): makes the derivatives of a
    /// number by the memory that it left those by the memory that it found, and adds those by the positions
    /// to `of_x` (`3V`).
    ///
    /// # Errors
    /// [`NoDerivative`], the default of a potential that remembers anything.
    fn pull_back_settling(
        &self,
        _state: Reached<'_>,
        _found: (&[f64], &[f64]),
        _of_memory: &mut [f64],
        _of_x: &mut [f64],
    ) -> Result<(), NoDerivative> {
        match self.memory().is_empty() {
            true => Ok(()),
            false => Err(NoDerivative::of_type::<Self>("what it remembers")),
        }
    }

    /// Adds to `of_x` (`3V`) the derivatives of a number by the positions at a state where a simulation
    /// starts: those by the memory that [`Remembering::start`] makes there are `of_memory`.
    ///
    /// # Errors
    /// [`NoDerivative`], the default of a potential that remembers anything.
    fn pull_back_start(
        &self,
        _state: Reached<'_>,
        _of_memory: &[f64],
        _of_x: &mut [f64],
    ) -> Result<(), NoDerivative> {
        match self.memory().is_empty() {
            true => Ok(()),
            false => Err(NoDerivative::of_type::<Self>("where a run starts")),
        }
    }

    /// Whether the memory is that of a material that yields. Such potentials are for methods that minimise
    /// them (BDF2, implicit Euler). The default says no.
    fn can_yield(&self) -> bool {
        false
    }

    /// The vertex that the potential holds, of one that may come and go in the course of a run: then its
    /// memory is handed on by this vertex, and else by the order of the potentials. The default holds none.
    fn held_vertex(&self) -> Option<VertexId> {
        None
    }
}

/// What a potential that bends or creases tells of its material, for reports alone. The defaults tell
/// nothing.
pub trait MaterialReport {
    /// Adds the energy of bending of each face (joules) to `faces`, for reports that compare it with that of
    /// stretching (`ElasticDeformation`).
    fn add_bending_energies(&self, _at: At<'_>, _faces: &mut [f64]) {}

    /// The edges that are creases in a sheet that bends, with the bend of the faces beside each, which its
    /// fold angle includes, radians, positive for valleys.
    fn bends_at_creases(&self, _at: At<'_>) -> Vec<(EdgeId, f64)> {
        Vec::new()
    }

    /// The edges at which it can yield, with the plastic angles that stay there by a memory, radians,
    /// positive for valleys.
    fn plastic_angles(&self, _memory: &[f64]) -> Vec<(EdgeId, f64)> {
        Vec::new()
    }

    /// The faces on which it can yield, with the plastic curvature that stays there by a memory, 1/m, the
    /// first axis along the first edge of the face, positive where the sheet is a valley as seen from the
    /// side from which faces are counter-clockwise.
    fn plastic_curvatures(&self, _memory: &[f64]) -> Vec<(FaceId, Matrix2<f64>)> {
        Vec::new()
    }

    /// The moments (newton metres, in space) by which clamps that it knows hold slopes of the sheet, one for
    /// each of its clamps.
    fn clamp_moments(&self, _at: At<'_>) -> Vec<[f64; 3]> {
        Vec::new()
    }
}

/// Memories do not fit a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("potentials remember {found} values or lists where those of the model remember {expected}")]
pub struct OtherMemories {
    /// Values of a potential, or lists of all, that were given.
    pub found: usize,
    /// As many as the model needs.
    pub expected: usize,
}

/// What each of the potentials of a model remembers ([`Remembering::memory`]), in the order of
/// `SheetModel::potentials`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Memories {
    lists: Vec<Vec<f64>>,
    /// The vertices that potentials hold which may come and go, with the numbers of these potentials.
    held: Vec<(u32, usize)>,
}

impl Memories {
    /// Of potentials before anything has happened.
    pub fn of<'a>(potentials: impl Iterator<Item = &'a dyn Potential>) -> Self {
        let mut all = Self::default();
        for (number, potential) in potentials.enumerate() {
            let remembering = potential.remembering();
            all.lists
                .push(remembering.map_or_else(Vec::new, Remembering::memory));
            let vertex = remembering.and_then(Remembering::held_vertex);
            all.held.extend(vertex.map(|v| (v.0, number)));
        }
        all
    }

    /// The lists, to be changed in place.
    pub fn lists_mut(&mut self) -> &mut [Vec<f64>] {
        &mut self.lists
    }

    /// One list of numbers for each potential, most of them empty.
    pub fn lists(&self) -> &[Vec<f64>] {
        &self.lists
    }

    /// The memory of the potential of a number.
    pub fn list_mut(&mut self, number: usize) -> &mut [f64] {
        &mut self.lists[number]
    }

    /// Takes over other memories of the same model, in place.
    pub fn copy_from(&mut self, other: &Self) {
        self.lists.clone_from(&other.lists);
        self.held.clone_from(&other.held);
    }

    /// Takes over the memories of another model of the same sheet: of potentials that come and go by the
    /// vertices that they hold, and of others by their order.
    ///
    /// # Errors
    /// [`OtherMemories`] where there are not as many as this model remembers.
    pub fn take_over(&mut self, other: &Self) -> Result<(), OtherMemories> {
        let held = self.held.iter().enumerate();
        let held = held.filter_map(|(k, (vertex, own))| {
            // The second one at a vertex goes on from the second one.
            let rank = self.held[..k].iter().filter(|(v, _)| v == vertex).count();
            let (_, theirs) = other.held.iter().filter(|(v, _)| v == vertex).nth(rank)?;
            Some((*own, *theirs))
        });
        let others = self.lasting().zip(other.lasting());
        let [found, expected] = [other, &*self].map(|m| m.lasting().count());
        let pairs: Vec<(usize, usize)> = held.chain(others).collect();
        if found != expected {
            return Err(OtherMemories { found, expected });
        }
        for (own, theirs) in pairs {
            let kept = other.lists.get(theirs).map_or(&[][..], Vec::as_slice);
            let own = &mut self.lists[own];
            if kept.len() != own.len() {
                return Err(OtherMemories {
                    found: kept.len(),
                    expected: own.len(),
                });
            }
            own.copy_from_slice(kept);
        }
        Ok(())
    }

    /// The numbers of the potentials that remember and last.
    fn lasting(&self) -> impl Iterator<Item = usize> {
        let goes = |number: &usize| self.held.iter().any(|(_, n)| n == number);
        let remembering = (0..self.lists.len()).filter(|n| !self.lists[*n].is_empty());
        remembering.filter(move |n| !goes(n))
    }
}

/// A potential that several models share: what it remembers belongs to their simulations.
impl<P: Potential + ?Sized> Potential for Arc<P> {
    fn energy(&self, at: At<'_>) -> f64 {
        (**self).energy(at)
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        (**self).add_gradient(at, gradient);
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        (**self).add_hessian(at, hessian);
    }

    fn add_semidefinite_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        (**self).add_semidefinite_hessian(at, hessian);
    }

    fn difference(&self, other: &dyn Potential) -> Difference {
        let other = (other as &dyn Any).downcast_ref::<Self>();
        match other.is_some_and(|other| Self::ptr_eq(self, other)) {
            true => Difference::Nothing,
            false => Difference::Everything,
        }
    }

    fn add_gradient_of(&self, parts: &[u32], at: At<'_>, gradient: &mut [f64]) {
        (**self).add_gradient_of(parts, at, gradient);
    }

    fn hessian_kind(&self) -> HessianKind {
        (**self).hessian_kind()
    }

    fn couplings(&self) -> Vec<[VertexId; 2]> {
        (**self).couplings()
    }

    fn coupling_kind(&self) -> CouplingKind {
        (**self).coupling_kind()
    }

    fn is_driven(&self) -> bool {
        (**self).is_driven()
    }

    fn round_off(&self, size: f64, energy: f64) -> f64 {
        (**self).round_off(size, energy)
    }

    fn shape(&self) -> PotentialShape {
        (**self).shape()
    }

    fn limit(&self) -> Option<&dyn Limited> {
        (**self).limit()
    }

    fn remembering(&self) -> Option<&dyn Remembering> {
        (**self).remembering()
    }

    fn report(&self) -> Option<&dyn MaterialReport> {
        (**self).report()
    }
}

/// How stiff the couplings of vertices without a common edge are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CouplingKind {
    /// Such as the couplings of bending: a matrix may be factorised without them, where that is cheaper, and
    /// they are taken into account by conjugate gradients.
    Soft,
    /// So stiff that conjugate gradients would not converge without them.
    Stiff,
}

/// Which parts of a potential are other ones in another potential.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Difference {
    /// None: the potentials are the same.
    Nothing,
    /// The parts with these numbers, in order, such as faces.
    Parts(Vec<u32>),
    /// All, or which ones cannot be told.
    Everything,
}

impl Difference {
    /// Of the parts, `count` in all, that differ.
    pub(crate) fn of_parts(count: usize, differs: impl Fn(usize) -> bool) -> Self {
        let parts: Vec<u32> = (0..count)
            .filter(|k| differs(*k))
            .map(|k| k as u32)
            .collect();
        match parts.is_empty() {
            true => Self::Nothing,
            false => Self::Parts(parts),
        }
    }
}

/// Whether a Hessian has all second derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HessianKind {
    /// It has.
    Exact,
    /// Some are left out, as far as they are not needed to minimise.
    Partial,
}

/// How a potential depends on the positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PotentialShape {
    /// Linear in the positions and independent of time: the force is constant, and midpoint
    /// forces conserve its energy exactly.
    Linear,
    /// Anything else: the energy-momentum integrator uses a discrete gradient.
    General,
}

/// Uniform gravity, `V = -sum_i w_i g . x_i` with the weights `w_i` (kilograms) of the vertices.
#[derive(Debug, Clone, PartialEq)]
pub struct Gravity {
    weights: Vec<f64>,
    acceleration: [f64; 3],
}

/// The acceleration of gravity in the paper's scenes, metres per second squared, z up. (Standard gravity is
/// 9.80665 m/s2; `SheetModel::with_acceleration` takes any.)
pub const PAPER_GRAVITY: [f64; 3] = [0.0, 0.0, -9.8];

impl Gravity {
    /// Gravity acting on vertices of the given masses (for a consistent mass matrix its row
    /// sums, see [`isosheet_mesh::MassMatrix::row_sums`]).
    pub fn new(weights: Vec<f64>, acceleration: [f64; 3]) -> Self {
        Self {
            weights,
            acceleration,
        }
    }
}

impl Potential for Gravity {
    fn energy(&self, at: At<'_>) -> f64 {
        let At { x, .. } = at;
        let g = self.acceleration;
        -self
            .weights
            .iter()
            .zip(x.as_chunks::<3>().0)
            .map(|(w, p)| w * (g[0] * p[0] + g[1] * p[1] + g[2] * p[2]))
            .sum::<f64>()
    }

    fn add_gradient(&self, _at: At<'_>, gradient: &mut [f64]) {
        for (w, row) in self.weights.iter().zip(gradient.as_chunks_mut::<3>().0) {
            for k in 0..3 {
                row[k] -= w * self.acceleration[k];
            }
        }
    }

    fn shape(&self) -> PotentialShape {
        PotentialShape::Linear
    }

    fn difference(&self, other: &dyn Potential) -> Difference {
        match (other as &dyn Any).downcast_ref() == Some(self) {
            true => Difference::Nothing,
            false => Difference::Everything,
        }
    }
}

/// A generalised, not necessarily conservative force (Liu, Tang and Joneja 2007, Sec. 5).
///
/// The force is given on the vertices; its generalised components follow by virtual work,
/// `Q_k = f . dx/dq_k`. The work it does enters the energy balance.
///
/// BDF2 and implicit Euler ask for it once in a step: at the time of its end, which is exact for forces of
/// time alone, and at positions and velocities extrapolated to it, at the order of the method. A force of
/// velocities that takes more than about `4/3` of the momentum in a step is too stiff for that: the step is
/// refused (`StepError::StiffForce`) and divided. As an `ImplicitForce` it may be as stiff as it likes.
/// Energy-momentum asks for it at the middle of a step, RATTLE at both ends, charts at their stages.
pub trait Force: Debug + Send + Sync {
    /// Adds the force (`3V`, newtons) at time `t`, positions `x` and velocities `v` to `force`.
    fn add_force(&self, t: f64, x: &[f64], v: &[f64], force: &mut [f64]);

    /// Whether the force is a function of time alone. The default says that it is not.
    fn is_of_time_alone(&self) -> bool {
        false
    }

    /// Adds to `of_x` and `of_v` (`3V`) the derivatives of `w . f` by positions and velocities, with the
    /// vector `w` (`3V`).
    ///
    /// # Errors
    /// [`NoDerivative`], the default of a force that is not a function of time alone.
    fn add_state_products(
        &self,
        _t: f64,
        _x: &[f64],
        _v: &[f64],
        _w: &[f64],
        _of_x: &mut [f64],
        _of_v: &mut [f64],
    ) -> Result<(), NoDerivative> {
        match self.is_of_time_alone() {
            true => Ok(()),
            false => Err(NoDerivative::of_type::<Self>("positions and velocities")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_gradient_matches_differences() {
        let g = Gravity::new(vec![0.3, 2.0], [1.0, -2.0, -9.8]);
        let x = [0.1, 0.7, -0.4, 1.0, 2.0, 3.0];
        let mut gradient = [0.0; 6];
        g.add_gradient(At::new(0.0, &x), &mut gradient);
        for i in 0..6 {
            let (mut up, mut down) = (x, x);
            up[i] += 0.5;
            down[i] -= 0.5;
            let slope = g.energy(At::new(0.0, &up)) - g.energy(At::new(0.0, &down));
            assert!((slope - gradient[i]).abs() < 1e-13, "coordinate {i}");
        }
    }
}
