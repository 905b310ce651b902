//! The terms of the objective of a step: what BDF2 and implicit Euler minimise.
//!
//! A step of these methods minimises
//!
//! ```text
//! Phi(x) = |x - x^|_M^2 / 2 + h^2 sum_k T_k(x)
//! ```
//!
//! over the positions `x` at its end, with the effective step `h` and the positions `x^` where inertia alone
//! leads. A potential is a term without further ado. Whatever depends on velocities, lags behind, or forbids
//! positions is a [`Term`] of its own, which an [`ImplicitForce`] of the model makes: the drag of the air, a
//! wake, a barrier.

use crate::State;
use crate::report::step_error::StepError;
use crate::report::trace::Cut;
pub use isosheet_materials::hessian::{BlockSink, CouplingSink, HessianPart, HessianProduct};
use isosheet_materials::potential::{Force, Memories};
pub use isosheet_materials::{NoDerivative, Refused};
use std::any::Any;
use std::sync::Arc;

/// A summand of what a step of BDF2 or implicit Euler minimises.
///
/// A term has an energy with gradient and Hessian. Where it needs them, it also has the largest part of a
/// displacement that it allows, a correction of second order, quantities that lag behind the iterates, and
/// the energy that it exchanged in the step. It keeps nothing that a later step depends on: [`Term::begin`]
/// forgets the step before. What has to be remembered from step to step is the
/// [memory](isosheet_materials::potential::Remembering) of a potential.
///
/// A velocity force `-c v` of each vertex, for example, has the energy `h |x - y|^2 c / (2 h^2)` with the
/// positions `y` of [`StepStart::rest`], as `v = (x - y) / h`:
///
/// ```
/// use isosheet_model::term::{
///     BlockSink, Exchange, HessianPart, ImplicitForce, Iterate, StepStart, Term, Value,
/// };
/// use isosheet_materials::Force;
/// use isosheet_mesh::VertexId;
/// use isosheet_model::StepError;
/// use nalgebra::Matrix3;
/// use std::sync::Arc;
///
/// /// The coefficient `c`, newton seconds per metre.
/// #[derive(Clone, Debug)]
/// struct Dashpots(f64);
///
/// impl Force for Dashpots {
///     fn add_force(&self, _t: f64, _x: &[f64], v: &[f64], force: &mut [f64]) {
///         force.iter_mut().zip(v).for_each(|(f, v)| *f -= self.0 * v);
///     }
/// }
///
/// impl ImplicitForce for Dashpots {
///     fn term(&self, free: Arc<[bool]>) -> Box<dyn Term> {
///         Box::new(InStep { of: self.clone(), free, rest: Vec::new(), h: 1.0 })
///     }
/// }
///
/// struct InStep {
///     of: Dashpots,
///     free: Arc<[bool]>,
///     rest: Vec<f64>,
///     h: f64,
/// }
///
/// impl Term for InStep {
///     fn begin(&mut self, step: &StepStart<'_>) -> Result<(), StepError> {
///         self.rest = step.rest.to_vec();
///         self.h = step.h;
///         Ok(())
///     }
///
///     fn value(&mut self, at: Iterate<'_>) -> Value {
///         let squares = at.x.iter().zip(&self.rest).map(|(x, y)| (x - y) * (x - y));
///         Value::of(0.5 * self.of.0 / self.h * squares.sum::<f64>())
///     }
///
///     fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]) {
///         for (out, (x, y)) in out.iter_mut().zip(at.x.iter().zip(&self.rest)) {
///             *out += scale * self.of.0 / self.h * (x - y);
///         }
///     }
///
///     fn add_hessian(&mut self, at: Iterate<'_>, _part: HessianPart, sink: &mut dyn BlockSink) {
///         let block = Matrix3::identity() * (self.of.0 / self.h);
///         for v in 0..at.x.len() / 3 {
///             sink.add_vertex(VertexId::from_index(v), &block);
///         }
///     }
///
///     fn finish(&mut self, step: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, StepError> {
///         let mut end = vec![0.0; at.x.len()];
///         self.add_gradient(at, -1.0, &mut end);
///         Ok(step.implicit_work(&self.of, &self.free, at.x, &mut end))
///     }
/// }
/// ```
pub trait Term: Any + Send {
    /// Refuses a span of time, from its first second to its last, that cannot be stepped over from positions
    /// `x` (`3V`, metres). A step asks before it begins, and again with the positions at its end and the time
    /// at its start. The default takes all.
    ///
    /// # Errors
    /// [`StepError`], such as [`StepError::Refused`].
    fn check(&mut self, _span: [f64; 2], _x: &[f64]) -> Result<(), StepError> {
        Ok(())
    }

    /// Whether what it prescribes rests from the first second to the last: then a sheet that finds no step
    /// locks, and has not been moved where it cannot go. The default prescribes nothing.
    fn rests(&mut self, _span: [f64; 2]) -> bool {
        true
    }

    /// Begins a step, or begins it anew.
    ///
    /// # Errors
    /// [`StepError`], if what acts in the step is not finite for instance.
    fn begin(&mut self, step: &StepStart<'_>) -> Result<(), StepError>;

    /// The energy, infinite where the iterate is forbidden.
    fn value(&mut self, at: Iterate<'_>) -> Value;

    /// Adds `scale` times the gradient (newtons) to `out` (`3V`), at pinned vertices too.
    fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]);

    /// Adds the Hessian (newtons per metre), or a part of it.
    fn add_hessian(&mut self, at: Iterate<'_>, part: HessianPart, sink: &mut dyn BlockSink);

    /// Appends the pairs of vertices, lower number first, that the Hessian couples at the iterate besides
    /// edges and the pairs that potentials name; may append pairs twice and pairs that are edges. The default
    /// has none.
    fn append_couplings(&mut self, _at: Iterate<'_>, _out: &mut Vec<[u32; 2]>) {}

    /// What cuts displacements, if anything does. The default has no barrier; a term that has one gives
    /// [`Term::safe_part`].
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

    /// Adds `scale` times the forces by which a displacement `dx`, the motion that was checked last, has to
    /// be corrected to second order; whether there are any.
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
    /// there is any, see `Limited::add_second_order`.
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

    /// Brings what lags to the iterate, unless it has settled; whether it had not.
    fn renew(&mut self, _at: Iterate<'_>, _settled: Lagging) -> bool {
        false
    }

    /// Adds `scale` times the derivatives of `w . g`, with the gradient `g` at the iterate and the vector `w`
    /// (`3V`), by what the step starts from, with what lags at the iterate.
    ///
    /// # Errors
    /// [`NoDerivative`], the default.
    fn add_start_products(
        &mut self,
        _step: &StepStart<'_>,
        _at: Iterate<'_>,
        _w: &[f64],
        _scale: f64,
        _out: &mut StartProducts,
    ) -> Result<(), NoDerivative> {
        Err(NoDerivative::of_type::<Self>("what a step starts from"))
    }

    /// Number of contacts that are active.
    fn contact_count(&self) -> usize {
        0
    }

    /// What the term did in a step that ends at the iterate.
    ///
    /// # Errors
    /// [`StepError`] if the step must not end there: it is then divided, or a remedy is looked for.
    fn finish(&mut self, step: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, StepError>;
}

/// A force that BDF2 and implicit Euler take as a term of their objective, and all other methods as a
/// [`Force`]. See
/// [`SheetModel::with_implicit_force`](crate::SheetModel::with_implicit_force).
pub trait ImplicitForce: Force {
    /// The term, in a model with these vertices (`V`) free; the others are pinned.
    fn term(&self, free: Arc<[bool]>) -> Box<dyn Term>;

    /// Whether the force is that of its term alone, so that methods which do not minimise cannot have it. The
    /// default says no.
    fn needs_minimising(&self) -> bool {
        false
    }
}

/// What a step starts from: `x1 = y + h v1`, with `x^ = y + h (a v0 - b v_)` where inertia alone leads.
#[derive(Debug, Clone, Copy)]
pub struct StepStart<'a> {
    /// The state at the start.
    pub state: &'a State,
    /// What the potentials remember.
    pub memories: &'a Memories,
    /// The state before, to which the formula reaches back.
    pub before: Option<&'a State>,
    /// Length of the step, seconds.
    pub span: f64,
    /// Time in which surfaces slide as far as they do in the step, seconds: the length of the step. (Steps of
    /// a search for an equilibrium have a length of their own for it.)
    pub sliding_time: f64,
    /// Effective step `h`, the root of the factor of the forces, seconds.
    pub h: f64,
    /// How far back the formula of the step reaches.
    pub formula: Formula,
    /// `b` of `y = x0 + b (x0 - x_)` with the positions `x_` of the state before.
    pub back: f64,
    /// `y`, `3V`, metres.
    pub rest: &'a [f64],
    /// `x^`, `3V`, metres.
    pub prediction: &'a [f64],
    /// Positions that the velocities at the start lead to, with pins at the ends of their motions; `3V`,
    /// metres.
    pub ahead: &'a [f64],
}

impl StepStart<'_> {
    /// Adds the velocities that the step is expected to end with (`3V`, metres per second): those at its
    /// start, and of a two-step formula the extrapolation of the last two, whose error is of second order.
    pub fn add_velocity_ahead(&self, out: &mut [f64]) {
        let now = self.state;
        let ratio = self.before.map_or(0.0, |b| self.span / (now.t - b.t));
        let before = self.before.unwrap_or(now);
        for (o, (v, w)) in out.iter_mut().zip(now.v.iter().zip(&before.v)) {
            *o += v + ratio * (v - w);
        }
    }

    /// Time at the end of the step, seconds.
    pub fn t(&self) -> f64 {
        self.state.t + self.span
    }

    /// Work of an implicit force at the free vertices in a step that ends at positions `x` with the force
    /// `end` (`3V`, newtons): of implicit Euler with the force at the end, which balances the energy but for
    /// what the method dissipates; of a two-step formula by the trapezoidal rule with the force at the start,
    /// at the order of the formula. `end` is overwritten.
    pub fn implicit_work(
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

/// Relative changes below which what lags in a step counts as settled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lagging {
    /// Of the normal forces of friction.
    pub friction: f64,
    /// Of loads that follow the sheet.
    pub loads: f64,
}

impl Lagging {
    /// Whatever has changed is renewed.
    pub const NOT_AT_ALL: Self = Self {
        friction: 0.0,
        loads: 0.0,
    };
}

/// Derivatives of a number by what a step starts from, `3V` each, per metre.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StartProducts {
    /// By the positions at the start.
    pub start: Vec<f64>,
    /// By [`StepStart::rest`].
    pub rest: Vec<f64>,
    /// By [`StepStart::ahead`].
    pub ahead: Vec<f64>,
    /// By the positions at the end, as far as they are in the gradient and not in the Hessian: of forces that
    /// have no energy.
    pub end: Vec<f64>,
}

impl StartProducts {
    /// Zeros for so many coordinates.
    pub fn zeros(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        Self {
            start: zeros(),
            rest: zeros(),
            ahead: zeros(),
            end: zeros(),
        }
    }
}

/// How far back the formula of a step reaches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Formula {
    /// To its start: implicit Euler.
    OneStep,
    /// To the step before: BDF2.
    TwoStep,
}

/// Where a term is evaluated: a time, positions (`3V`, metres), and what potentials remember.
#[derive(Debug, Clone, Copy)]
pub struct Iterate<'a> {
    /// Seconds.
    pub t: f64,
    /// Positions, `3V`, metres.
    pub x: &'a [f64],
    /// What the potentials of the model remember.
    pub memories: &'a Memories,
}

/// An energy, and what it says about round-off.
#[derive(Debug, Clone, Copy, Default)]
pub struct Value {
    /// Joules.
    pub energy: f64,
    /// Size of what was summed, joules.
    pub size: f64,
    /// Energy that the round-off of positions makes besides, joules.
    pub round_off: f64,
}

impl Value {
    /// An energy without cancellation.
    pub fn of(energy: f64) -> Self {
        Self {
            energy,
            size: energy.abs(),
            round_off: 0.0,
        }
    }
}

/// What cuts displacements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Barrier {
    /// Contact.
    Contact,
    /// A limit of the strain, which need not hold on the way of a displacement as long as it does at its end.
    StrainLimit,
    /// Another one, by its name in [traces](crate::TraceEvent), that holds on the whole way.
    Other(&'static str),
}

impl Barrier {
    /// Whether it has to hold on the whole way of a displacement.
    pub fn holds_on_the_way(self) -> bool {
        self != Self::StrainLimit
    }
}

impl From<Option<Barrier>> for Cut {
    fn from(barrier: Option<Barrier>) -> Self {
        match barrier {
            None => Self::Nothing,
            Some(Barrier::Contact) => Self::Contact,
            Some(Barrier::StrainLimit) => Self::StrainLimit,
            Some(Barrier::Other(name)) => Self::Barrier(name),
        }
    }
}

/// Energy exchanged in a step, joules. Begin a literal from [`Exchange::default`], since fields may be added.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Exchange {
    /// Work of explicit forces.
    pub work: f64,
    /// Work of all that is known to the accuracy of the trapezoidal rule only: bodies, supports, air.
    pub driven: f64,
    /// Sum of the magnitudes of these.
    pub driven_size: f64,
    /// Energy lost to friction; not negative.
    pub friction: f64,
    /// Energy that would be lost to friction by the normal forces at the end of the step.
    pub settled_friction: f64,
    /// Change of the energy of barriers.
    pub stored: f64,
    /// Energy that the tolerance of the lengths leaves open.
    pub length_slack: f64,
    /// Work of the difference between the forces that were expected at the end of the step and the forces
    /// there, where they are too stiff to be expected; not negative.
    pub misjudged: f64,
}

impl Exchange {
    /// Work known to the accuracy of the trapezoidal rule.
    pub fn driven(work: f64) -> Self {
        Self {
            driven: work,
            driven_size: work.abs(),
            ..Self::default()
        }
    }

    /// Adds what others exchanged.
    pub fn add(&mut self, other: Self) {
        self.work += other.work;
        self.driven += other.driven;
        self.driven_size += other.driven_size;
        self.friction += other.friction;
        self.settled_friction += other.settled_friction;
        self.stored += other.stored;
        self.length_slack += other.length_slack;
        self.misjudged += other.misjudged;
    }
}
