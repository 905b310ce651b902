//! What a step asks of contact: the sheet against bodies and against itself.

use crate::{SheetModel, State};
use nalgebra::{Matrix3, Vector3};
use std::fmt;

/// Contact of a sheet with bodies and with itself, as a step of an implicit integrator sees it.
///
/// Contact is a barrier potential `B(x, s)` of the positions and of the bodies' poses, infinite where
/// anything touches, and a friction potential `D(x - x0)` with normals and normal forces held fixed
/// ("lagged"; Li et al. 2020, Incremental potential contact). Bodies move by prescribed motions; within
/// a step their progress `s` runs from 0 (the start) to 1 (the end), and they never move without a
/// check that nothing is passed through on the way. This crate knows only this interface; geometry is
/// the business of the implementation.
///
/// The order of calls in a step: [`Contact::begin`]; then per iteration the energies and derivatives at
/// the current positions, [`Contact::safe_fraction`] of the displacement found, [`Contact::advance`]
/// by the part of it that is taken; at the end [`Contact::finish`]. A rejected step simply begins anew.
///
/// Positions `x` and displacements are `3V` coordinates in metres, pinned vertices included.
pub trait Contact: Send {
    /// Begins a step from `t0` (seconds) over `h` seconds at positions `x0`: bodies in their places at `t0`, `s = 0`
    /// (or 1 if none moves in the step), friction lagged at `x0`.
    fn begin(&mut self, t0: f64, h: f64, x0: &[f64]);

    /// Progress `s` of the bodies, from 0 to 1. Exactly 1 if no body moves in this step.
    fn progress(&self) -> f64;

    /// Largest fraction `a <= 1` of the joint motion `x + a dx`, `s + a (1 - s)` that is proven to bring
    /// nothing into contact.
    ///
    /// Also collects the pairs that are within reach anywhere on the whole motion; energies and
    /// derivatives are valid at all its points until the next call of this or of [`Contact::begin`].
    fn safe_fraction(&mut self, x: &[f64], dx: &[f64]) -> f64;

    /// Moves the bodies on: `s <- s + fraction (1 - s)`, to 1 exactly for `fraction = 1`.
    fn advance(&mut self, fraction: f64);

    /// `B + D` at `x` and the present progress, joules; infinite if anything touches.
    fn energy(&self, x: &[f64]) -> f64;

    /// Adds `scale` times the gradient of `B + D` to `out` (`3V`).
    fn add_gradient(&self, x: &[f64], scale: f64, out: &mut [f64]);

    /// Adds `scale` times the change of the gradient of `B` that the rest of the bodies' motion
    /// causes, to first order: with `u` the displacement of the body at a contact, `-d2B/dx2 u`, with the
    /// same semidefinite part of the Hessian as in [`Contact::add_hessian`].
    fn add_drive(&self, x: &[f64], scale: f64, out: &mut [f64]);

    /// Adds the Hessian of `B + D`, each contact's own part made positive semidefinite.
    fn add_hessian(&self, x: &[f64], sink: &mut dyn CouplingSink);

    /// The pairs of vertices, lower number first, that [`Contact::add_hessian`] couples at `x`; may hold pairs twice
    /// and pairs that are mesh edges. Clears `out` first. Contact with bodies couples no vertices
    /// that are not neighbours already and may be left out.
    fn couplings(&self, x: &[f64], out: &mut Vec<[u32; 2]>);

    /// Renews the normals and normal forces of friction at `x`. Returns the largest change of a normal
    /// force relative to the largest normal force: zero without friction.
    fn relag(&mut self, x: &[f64]) -> f64;

    /// Books the step that ends at `x1`, with the bodies at the ends of their motions.
    fn finish(&mut self, x1: &[f64]) -> ContactWork;

    /// `B` at `x` with the bodies where they are now, joules.
    fn potential(&self, x: &[f64]) -> f64;

    /// Smallest distance less thickness over all pairs within reach at `x`, metres; infinite if there are none.
    fn gap(&self, x: &[f64]) -> f64;

    /// Forces and torques on the bodies at `x`, in the order of the bodies: barrier and friction.
    fn loads(&self, x: &[f64]) -> Vec<BodyLoad>;

    /// Gap below which [`Contact::contact_points`] names a contact, metres.
    fn activation(&self) -> f64;

    /// Contacts within reach at `x`, for methods that use impulses in place of the barrier. Clears
    /// `out` first.
    fn contact_points(&self, x: &[f64], out: &mut Vec<ContactPoint>);

    /// Checks that a simulation can start here.
    ///
    /// # Errors
    /// [`ContactError`] if something touches or passes through at the start, or the implementation was made for
    /// another sheet.
    fn check_start(&mut self, model: &SheetModel, state: &State) -> Result<(), ContactError>;
}

/// Receives 3x3 blocks of a symmetric Hessian.
pub trait CouplingSink {
    /// Adds `block` to `d2/dx_a dx_b`, rows at `a`; for `a != b` its transpose belongs to `ba` and is not
    /// given again. For `a = b` the block is symmetric.
    fn add(&mut self, a: u32, b: u32, block: &Matrix3<f64>);
}

/// What contact did over a step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContactWork {
    /// Work done on the sheet by the motion of the bodies, joules: trapezoidal rule over the step.
    pub bodies: f64,
    /// Energy lost to friction, joules; not negative.
    pub friction: f64,
    /// Change of the barrier potential `B`, joules. Set by the integrator.
    pub stored: f64,
    /// Energy that the tolerance of the lengths leaves open, joules. Set by the integrator.
    pub play: f64,
}

/// What the sheet does to a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyLoad {
    /// Force on the body, newtons.
    pub force: Vector3<f64>,
    /// Torque on the body about the origin of its own frame, newton metres, in space.
    pub torque: Vector3<f64>,
}

/// A contact within reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Vertices of the sheet that take part and their weights in the relative motion,
    /// `sum_i w_i v_i - body velocity`; unused places have weight zero.
    pub stencil: [(u32, f64); 4],
    /// Unit normal: the distance grows at the rate `n . (sum_i w_i v_i - body velocity)`.
    pub normal: Vector3<f64>,
    /// Distance less thickness, metres.
    pub gap: f64,
    /// Velocity of the body at the contact, metres per second; zero for the sheet with itself.
    pub body_velocity: Vector3<f64>,
    /// Kinetic coefficient of friction.
    pub friction: f64,
}

/// Two things that touch, by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactPair {
    /// The sheet and a body.
    Body {
        /// A vertex of the sheet at the place.
        vertex: u32,
        /// The body, in the order in which they were added.
        body: usize,
    },
    /// Two places of the sheet.
    Sheet {
        /// A vertex at the first place.
        first: u32,
        /// A vertex at the second place.
        second: u32,
    },
}

impl fmt::Display for ContactPair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Body { vertex, body } => write!(f, "the sheet at v{vertex} and body {body}"),
            Self::Sheet { first, second } => {
                write!(f, "the sheet at v{first} and the sheet at v{second}")
            }
        }
    }
}

/// Why contact cannot start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ContactError {
    /// Something touches or passes through.
    #[error(
        "{pair} touch at t = {t} s (gap {gap} m): move them apart; contact keeps a gap, it does not make one"
    )]
    Touching {
        /// What touches.
        pair: ContactPair,
        /// Distance less thickness, metres; zero or negative where one passes through the other.
        gap: f64,
        /// Time, seconds.
        t: f64,
    },
    /// The contact belongs to another sheet.
    #[error(
        "contact was set up for {expected} vertices, the sheet has {found}: set it up for this sheet"
    )]
    Sheet {
        /// Vertices it was made for.
        expected: usize,
        /// Vertices of the sheet.
        found: usize,
    },
    /// The method has no place for contact.
    #[error(
        "this method has no place for contact: use BDF2 or implicit Euler, or a chart simulation with impulses"
    )]
    Method,
}
