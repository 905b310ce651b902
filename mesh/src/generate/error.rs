//! Arguments that no sheet can be made from.

use crate::Advice;
use crate::wording::{brief, given};
use thiserror::Error;

use crate::MeshError;

/// Why a sheet could not be generated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// A count is out of range.
    #[error("{name} is {value}, which is not between {min} and {max}")]
    Count {
        /// The name of the argument.
        name: &'static str,
        /// Its value.
        value: usize,
        /// The least value allowed.
        min: usize,
        /// The largest value allowed.
        max: usize,
    },
    /// A length is not a positive number.
    #[error("{name} is {value}", value = given(*value))]
    Size {
        /// The name of the argument.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// An angle is out of range.
    #[error(
        "{name} is {value} rad, which is not between {min} and {max}",
        value = given(*value), min = given(*min), max = given(*max)
    )]
    Angle {
        /// The name of the argument.
        name: &'static str,
        /// Its value.
        value: f64,
        /// It has to be larger than this.
        min: f64,
        /// It has to be smaller than this.
        max: f64,
    },
    /// Mountains and valleys are assigned in a way that cannot be folded.
    #[error("the assignment of mountains and valleys cannot be folded: {problem}")]
    Assignment {
        /// What is wrong.
        problem: &'static str,
    },
    /// Two lengths are in the wrong order.
    #[error(
        "{small} is {small_value} and {large} is {large_value}",
        small_value = brief(*small_value), large_value = brief(*large_value)
    )]
    Order {
        /// The name of the argument that must be smaller.
        small: &'static str,
        /// Its value.
        small_value: f64,
        /// The name of the argument that must be larger.
        large: &'static str,
        /// Its value.
        large_value: f64,
    },
    /// An outline does not bound a simple polygon.
    #[error("the outline is unusable at point {corner} of its boundary: {problem}")]
    Outline {
        /// Which point.
        corner: usize,
        /// What is wrong there.
        problem: &'static str,
    },
    /// Points do not describe a curve.
    #[error("the {name} curve is unusable at point {point}: {problem}")]
    Curve {
        /// Which curve.
        name: &'static str,
        /// Which point, from 0.
        point: usize,
        /// What is wrong there.
        problem: &'static str,
    },
    /// Two curves meet where a strip is to lie between them.
    #[error(
        "the curves meet at ({}, {}, {}): ruling {ruling} between them is {length} m long",
        brief(place[0]), brief(place[1]), brief(place[2]), length = brief(*length)
    )]
    CurvesMeet {
        /// The ruling, from 0.
        ruling: usize,
        /// Where it begins, metres.
        place: [f64; 3],
        /// Its length, metres.
        length: f64,
    },
    /// The result would be too large to handle.
    #[error("the sheet would have {faces} faces, more than the {limit} that are allowed")]
    TooManyFaces {
        /// The number of faces asked for.
        faces: u128,
        /// The largest number allowed.
        limit: u128,
    },
    /// The result is not a valid mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl Advice for GenerateError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Count { .. } | Self::Angle { .. } => Some("give a value in this range"),
            Self::Size { .. } => Some("give a positive, finite number of metres"),
            Self::Order { .. } => Some("give a smaller value for the first"),
            Self::Outline { .. } => Some("give the corners of a simple polygon in order"),
            Self::Curve { .. } => Some(
                "give the points of a curve in order; a closed one has its first point once more at its end",
            ),
            Self::CurvesMeet { .. } => {
                Some("move the curves apart, or end both of them before they meet")
            }
            Self::TooManyFaces { .. } => Some("use fewer cells or a lower level"),
            Self::Mesh(error) => error.advice(),
            Self::Assignment { .. } => None,
        }
    }
}

/// Sixteen million faces, twice as many as M^10. A larger number is taken for a mistake.
const MAX_FACES: u128 = 1 << 24;

pub(crate) fn check_count(
    name: &'static str,
    value: usize,
    min: usize,
) -> Result<(), GenerateError> {
    let max = 1 << 24;
    if (min..=max).contains(&value) {
        Ok(())
    } else {
        Err(GenerateError::Count {
            name,
            value,
            min,
            max,
        })
    }
}

pub(crate) fn check_size(name: &'static str, value: f64) -> Result<(), GenerateError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(GenerateError::Size { name, value })
    }
}

/// Checks that one value is below another.
pub(crate) fn check_order(
    (small, small_value): (&'static str, f64),
    (large, large_value): (&'static str, f64),
) -> Result<(), GenerateError> {
    match small_value < large_value {
        true => Ok(()),
        false => Err(GenerateError::Order {
            small,
            small_value,
            large,
            large_value,
        }),
    }
}

pub(crate) fn check_angle(
    name: &'static str,
    value: f64,
    [min, max]: [f64; 2],
) -> Result<(), GenerateError> {
    if min < value && value < max {
        Ok(())
    } else {
        Err(GenerateError::Angle {
            name,
            value,
            min,
            max,
        })
    }
}

pub(crate) fn check_faces(faces: u128) -> Result<(), GenerateError> {
    if faces <= MAX_FACES {
        Ok(())
    } else {
        Err(GenerateError::TooManyFaces {
            faces,
            limit: MAX_FACES,
        })
    }
}
