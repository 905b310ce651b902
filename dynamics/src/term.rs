//! A summand of the objective of a damped step.

use crate::State;
use crate::hessian::{BlockSink, HessianPart, HessianProduct};
use crate::potential::{Force, Memories};
use isosheet_coords::linalg::LinalgError;
use isosheet_mesh::VertexId;
use std::sync::Arc;

/// A summand of what a damped step minimises: inertia, the potentials, contact, the air.
///
/// A term has its energy with gradient and Hessian, and where it needs them the largest part of a displacement
/// that it allows, a correction of second order, quantities that lag behind the iterates, and what it
/// exchanged in the step. It keeps nothing that a later step depends on: [`Term::begin`] forgets the step
/// before.
pub(crate) trait Term: Send {
    /// Begins a step, or begins it anew.
    ///
    /// # Errors
    /// [`Refusal`] if what acts in the step is not finite.
    fn begin(&mut self, step: &StepStart<'_>) -> Result<(), Refusal>;

    /// The energy, infinite where the iterate is forbidden.
    fn value(&mut self, at: Iterate<'_>) -> Value;

    /// Adds `scale` times the gradient (newtons) to `out` (`3V`), at pinned vertices too.
    fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]);

    /// Adds the Hessian (newtons per metre), or a part of it.
    fn add_hessian(&mut self, at: Iterate<'_>, part: HessianPart, sink: &mut dyn BlockSink);

    /// Appends the pairs of vertices, lower number first, that the Hessian couples at the iterate besides edges
    /// and the pairs that potentials name; may append pairs twice and pairs that are edges.
    fn append_couplings(&mut self, _at: Iterate<'_>, _out: &mut Vec<[u32; 2]>) {}

    /// What cuts displacements, if anything does.
    fn barrier(&self) -> Option<Barrier> {
        None
    }

    /// Largest part of the displacement `dx` (`3V`, metres), at most one, that is proven to be allowed, what
    /// is prescribed going on by the same part of the rest of its motion. Until the next call of this or of
    /// [`Term::begin`] the iterates have to stay on that motion.
    fn safe_part(&mut self, _at: Iterate<'_>, _dx: &[f64]) -> f64 {
        1.0
    }

    /// Whether positions `end` are within the limits that a curved way to them is not checked against
    /// otherwise.
    fn stays_within(&mut self, _at: Iterate<'_>, _end: &[f64]) -> bool {
        true
    }

    /// Adds `scale` times the forces by which a displacement `dx`, the motion that was checked last, has to be
    /// corrected to second order; whether there are any.
    fn add_correction(
        &mut self,
        _at: Iterate<'_>,
        _dx: &[f64],
        _scale: f64,
        _out: &mut [f64],
    ) -> bool {
        false
    }

    /// Adds `scale` times what a displacement of second order takes back of the displacement `dx`; whether
    /// there is any, see [`Potential::add_second_order`](crate::Potential::add_second_order).
    fn add_second_order(
        &mut self,
        _at: Iterate<'_>,
        _dx: &[f64],
        _scale: f64,
        _out: &mut [f64],
    ) -> bool {
        false
    }

    /// How far prescribed motions of the term have gone on in the step, from 0 to 1; 1 if there are none.
    fn progress(&self) -> f64 {
        1.0
    }

    /// Goes on by a part of the rest of these motions, to the end exactly for one.
    fn advance(&mut self, _part: f64) {}

    /// Adds the change of the gradient, to first order, by the rest of the prescribed motions: of pins, which
    /// is the vector of the product, and of the term itself.
    fn add_drive(&mut self, at: Iterate<'_>, product: &mut HessianProduct<'_>) {
        self.add_hessian(at, HessianPart::Full, product);
    }

    /// Brings what lags to the iterate, if it has changed by more than `settled`, a relative measure; whether
    /// it has.
    fn renew(&mut self, _at: Iterate<'_>, _settled: f64) -> bool {
        false
    }

    /// Number of contacts that are active.
    fn contact_count(&self) -> usize {
        0
    }

    /// What the term did in a step that ends at the iterate.
    ///
    /// # Errors
    /// [`Refusal`] if the step must not end there.
    fn finish(&mut self, step: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, Refusal>;
}

/// A force that a damped step takes as a term of its objective, and all other methods as it is.
pub(crate) trait ImplicitForce: Force {
    /// The term, in a model with these vertices free.
    fn term(&self, free: Arc<[bool]>) -> Box<dyn Term>;

    /// Whether it is the force of its term alone, and no method without such terms has a place for it.
    fn needs_minimising(&self) -> bool {
        false
    }
}

/// What a step starts from: `x1 = y + h v1`, with `x^ = y + h (a v0 - b v_)` where inertia alone leads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepStart<'a> {
    pub(crate) state: &'a State,
    /// What the potentials remember.
    pub(crate) memories: &'a Memories,
    /// The state before, to which the formula reaches back.
    pub(crate) before: Option<&'a State>,
    /// Length of the step, seconds.
    pub(crate) span: f64,
    /// Effective step `h`, the root of the factor of the forces, seconds.
    pub(crate) h: f64,
    pub(crate) formula: Formula,
    /// `b` of `y = x0 + b (x0 - x_)` with the positions `x_` of the state before.
    pub(crate) back: f64,
    /// `y`, `3V`, metres.
    pub(crate) rest: &'a [f64],
    /// `x^`, `3V`, metres.
    pub(crate) prediction: &'a [f64],
    /// Positions that the velocities at the start lead to, with pins at the ends of their motions; `3V`,
    /// metres.
    pub(crate) ahead: &'a [f64],
}

impl StepStart<'_> {
    /// Adds the velocities that the step is expected to end with (`3V`, metres per second): those at its start, and
    /// of a two-step formula the extrapolation of the last two, whose error is of second order.
    pub(crate) fn add_velocity_ahead(&self, out: &mut [f64]) {
        let now = self.state;
        let ratio = self.before.map_or(0.0, |b| self.span / (now.t - b.t));
        let before = self.before.unwrap_or(now);
        for (o, (v, w)) in out.iter_mut().zip(now.v.iter().zip(&before.v)) {
            *o += v + ratio * (v - w);
        }
    }

    /// Time at the end of the step, seconds.
    pub(crate) fn t(&self) -> f64 {
        self.state.t + self.span
    }

    /// Work of an implicit force at the free vertices in a step that ends at positions `x` with the force `end`
    /// (`3V`, newtons): of implicit Euler with the force at the end, which balances the energy but for what the
    /// method dissipates; of a two-step formula by the trapezoidal rule with the force at the start, at the order
    /// of the formula.
    pub(crate) fn implicit_work(
        &self,
        force: &impl Force,
        free: &[bool],
        x: &[f64],
        end: &mut [f64],
    ) -> Exchange {
        let start = self.state;
        if self.formula == Formula::TwoStep {
            force.add_force(start.t, &start.x, &start.v, end);
            end.iter_mut().for_each(|f| *f *= 0.5);
        }
        let rows = end.as_chunks::<3>().0.iter().zip(free);
        let mut work = 0.0;
        for (v, (row, _)) in rows.enumerate().filter(|(_, (_, is_free))| **is_free) {
            for k in 0..3 {
                work += row[k] * (x[3 * v + k] - start.x[3 * v + k]);
            }
        }
        Exchange::driven(work)
    }
}

/// How far back the formula of a step reaches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Formula {
    /// To its start: implicit Euler.
    OneStep,
    /// To the step before: BDF2.
    TwoStep,
}

/// Where a term is evaluated: a time, positions (`3V`, metres), and what potentials remember.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Iterate<'a> {
    pub(crate) t: f64,
    pub(crate) x: &'a [f64],
    pub(crate) memories: &'a Memories,
}

/// An energy, and what it says about round-off.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Value {
    /// Joules.
    pub(crate) energy: f64,
    /// Size of what was summed, joules.
    pub(crate) size: f64,
    /// Energy that the round-off of positions makes besides, joules.
    pub(crate) round_off: f64,
}

impl Value {
    /// An energy without cancellation.
    pub(crate) fn of(energy: f64) -> Self {
        Self {
            energy,
            size: energy.abs(),
            round_off: 0.0,
        }
    }
}

/// What cuts displacements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Barrier {
    /// Contact.
    Contact,
    /// A limit of the strain.
    StrainLimit,
}

/// Why a term refuses a step.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Refusal {
    /// A force is not finite.
    NonFiniteForce {
        vertex: VertexId,
        value: f64,
        t: f64,
    },
    /// The step would end in contact, with this gap (metres).
    Contact { gap: f64 },
    /// Loads that follow the sheet are not those of the end of the step, by so much of the largest.
    UnsettledLoads { error: f64 },
    /// A linear system has no solution.
    Linalg(LinalgError),
}

/// Energy exchanged in a step, joules.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Exchange {
    /// Work of explicit forces.
    pub(crate) work: f64,
    /// Work of all that is known to the accuracy of the trapezoidal rule only: bodies, supports, air.
    pub(crate) driven: f64,
    /// Sum of the magnitudes of these.
    pub(crate) driven_size: f64,
    /// Energy lost to friction; not negative.
    pub(crate) friction: f64,
    /// The same by the normal forces at the end of the step.
    pub(crate) settled_friction: f64,
    /// Change of the energy of barriers.
    pub(crate) stored: f64,
    /// Energy that the tolerance of the lengths leaves open.
    pub(crate) length_slack: f64,
}

impl Exchange {
    /// Work known to the accuracy of the trapezoidal rule.
    pub(crate) fn driven(work: f64) -> Self {
        Self {
            driven: work,
            driven_size: work.abs(),
            ..Self::default()
        }
    }

    /// Adds what others exchanged.
    pub(crate) fn add(&mut self, other: Self) {
        self.work += other.work;
        self.driven += other.driven;
        self.driven_size += other.driven_size;
        self.friction += other.friction;
        self.settled_friction += other.settled_friction;
        self.stored += other.stored;
        self.length_slack += other.length_slack;
    }
}
