//! Why contact cannot start or go on.

use isosheet_mesh::Advice;
use isosheet_mesh::wording::{brief, given};
use std::fmt;

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

/// The prescribed motion of a body is not finite.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "the prescribed motion of body {body} gives {value} at t = {t} s (a component of its pose, \
         or of a velocity by differences about that time)",
    value = brief(*value), t = brief(*t)
)]
pub struct BodyMotionError {
    /// The body, in the order in which they were added.
    pub body: usize,
    /// The component that is not finite: metres, metres per second, or a number of a unit quaternion.
    pub value: f64,
    /// Time, seconds.
    pub t: f64,
}

impl Advice for BodyMotionError {
    fn advice(&self) -> Option<&'static str> {
        Some("check the function")
    }
}

/// Why contact cannot start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// The prescribed motion of a body is not finite at the start.
    #[error(transparent)]
    Motion(#[from] BodyMotionError),
    /// Something touches or passes through.
    #[error("{pair} touch at t = {t} s (gap {gap} m)", t = brief(*t), gap = brief(*gap))]
    Touching {
        /// What touches.
        pair: ContactPair,
        /// Distance less thickness, metres; zero or negative where one passes through the other.
        gap: f64,
        /// Time, seconds.
        t: f64,
    },
    /// The contact belongs to another sheet.
    #[error("contact was set up for {expected} vertices, the sheet has {found}")]
    Sheet {
        /// Vertices it was made for.
        expected: usize,
        /// Vertices of the sheet.
        found: usize,
    },
    /// The barrier makes no sense.
    #[error(transparent)]
    Barrier(#[from] BarrierError),
    /// A law of friction makes no sense.
    #[error(transparent)]
    Friction(#[from] FrictionError),
    /// The method has no place for contact.
    #[error("this method has no place for contact")]
    Method,
}

impl Advice for ContactError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Motion(error) => error.advice(),
            Self::Touching { .. } => {
                Some("move them apart: contact keeps a gap, it does not make one")
            }
            Self::Sheet { .. } => Some("set it up for this sheet"),
            Self::Barrier(error) => error.advice(),
            Self::Friction(error) => error.advice(),
            Self::Method => Some("use BDF2 or implicit Euler"),
        }
    }
}

/// A barrier that makes no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BarrierError {
    /// The activation distance is not a positive length.
    #[error("the activation distance is {0} m")]
    Activation(f64),
    /// Powers of the activation distance are too small (or too large) for floating-point numbers.
    #[error("the fourth power of the activation distance {0} m cannot be represented")]
    Range(f64),
    /// The stiffness is not a positive energy.
    #[error("the stiffness of the barrier is {0} J")]
    Stiffness(f64),
}

impl Advice for BarrierError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Activation(..) => Some("give a positive length, for instance 1e-3 of the sheet"),
            Self::Range(..) => Some("give a larger one"),
            Self::Stiffness(..) => Some("give a positive energy, or `Stiffness::Automatic`"),
        }
    }
}

/// Friction that makes no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrictionError {
    /// A coefficient is negative or not a number.
    #[error(
        "the friction coefficients {rest} (static) and {sliding} (kinetic) are not both numbers of \
         at least 0",
        rest = given(*rest), sliding = given(*sliding)
    )]
    Coefficient {
        /// Static coefficient.
        rest: f64,
        /// Kinetic coefficient.
        sliding: f64,
    },
    /// The kinetic coefficient exceeds the static one.
    #[error(
        "the kinetic coefficient {sliding} is above the static coefficient {rest}",
        sliding = given(*sliding), rest = given(*rest)
    )]
    Order {
        /// Static coefficient.
        rest: f64,
        /// Kinetic coefficient.
        sliding: f64,
    },
    /// The smoothing distance is not positive.
    #[error("the smoothing distance is {0} m")]
    Smoothing(f64),
    /// A law of friction from outside cannot be used.
    #[error("the law of friction `{name}` cannot be used: at {speed} m/s {fault}", speed = brief(*speed))]
    Law {
        /// Its type, as [`Debug`](std::fmt::Debug) names it.
        name: String,
        /// Sliding speed, metres per second.
        speed: f64,
        /// What is wrong there.
        fault: FrictionLawFault,
    },
}

/// What is wrong with a law of friction at a sliding speed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrictionLawFault {
    /// A value is not finite.
    #[error("its {quantity} is {value}", value = given(*value))]
    NotFinite {
        /// Which one.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// The coefficient is negative.
    #[error("its coefficient is {value}", value = given(*.0))]
    Negative(f64),
    /// The coefficient at rest is not zero.
    #[error("its coefficient is {value} in place of zero", value = given(*.0))]
    Rest(f64),
    /// The coefficient falls from rest.
    #[error("its slope is {value}, and at rest it is not negative", value = given(*.0))]
    Falls(f64),
    /// The coefficient is not the derivative of the integral, with the difference as a part of it.
    #[error("its coefficient differs from the derivative of its integral by the part {part}", part = brief(*.0))]
    Integral(f64),
    /// The slope is not the derivative of the coefficient, with the difference as a part of it.
    #[error("its slope differs from the derivative of its coefficient by the part {part}", part = brief(*.0))]
    Slope(f64),
}

impl Advice for FrictionLawFault {
    fn advice(&self) -> Option<&'static str> {
        Some(match self {
            Self::NotFinite { .. } => "let the law return numbers at all speeds of at least 0",
            Self::Negative(..) => {
                "let the coefficient be positive: friction acts against the sliding"
            }
            Self::Rest(..) => {
                "let the coefficient rise from zero over the speeds that count as rest"
            }
            Self::Falls(..) => "let the coefficient rise from rest",
            Self::Integral(..) => {
                "let the integral be that of the coefficient, and compare the two by `check_friction_law`"
            }
            Self::Slope(..) => {
                "let the slope be the derivative of the coefficient, or check other speeds than those of kinks"
            }
        })
    }
}

impl Advice for FrictionError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Coefficient { .. } => Some("give numbers of at least 0"),
            Self::Order { .. } => Some("swap them"),
            Self::Smoothing(..) => {
                Some("give a positive length, the speed that counts as rest times the step")
            }
            Self::Law { fault, .. } => fault.advice(),
        }
    }
}
