//! What leaves no place within a limit.

use isosheet_mesh::wording::{brief, given};
use isosheet_mesh::{Advice, FaceId};

/// Why what is prescribed leaves no place within the limit of a potential, see
/// [`Limited::check`](crate::Limited::check).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LimitError {
    /// A sheet swells or shrinks faster than it can follow, or more than its supports allow.
    #[error(
        "as the elastic sheet swells or shrinks, {face} comes to the strain {strain} at t = {t} s, and the limit \
         is {limit}",
        strain = brief(*strain), limit = given(*limit), t = brief(*t)
    )]
    SwellingBeyondLimit {
        /// The face with the largest strain.
        face: FaceId,
        /// The norm of its strain ([`ElasticSheet`](crate::ElasticSheet)).
        strain: f64,
        /// The limit.
        limit: f64,
        /// Time, seconds.
        t: f64,
    },
    /// A sheet would swell or shrink by a part that is out of [bounds](crate::ElasticSheet::SWELLING).
    #[error(
        "the lengths of an elastic sheet would grow by the part {part} at t = {t} s",
        part = brief(*part), t = brief(*t)
    )]
    Swelling {
        /// The part.
        part: f64,
        /// Time, seconds.
        t: f64,
    },
    /// A potential refuses for a reason of its own.
    #[error("{} refuses a step at t = {t} s: {}", .refused.by, .refused.why, t = brief(*t))]
    Refused {
        /// Time, seconds.
        t: f64,
        /// What refuses, and why.
        refused: Box<Refused>,
    },
}

impl Advice for LimitError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::SwellingBeyondLimit { .. } => Some(
                "let it swell or shrink more slowly, or less where it is held, or raise the limit of the strain",
            ),
            Self::Swelling { .. } => Some("give a function of time from -0.2 to 0.2"),
            Self::Refused { refused, .. } => refused.remedy,
        }
    }
}

/// What a potential, or a term of a step, says where it refuses one.
#[derive(Debug, Clone, PartialEq)]
pub struct Refused {
    /// What refuses, such as "the drag of the water".
    pub by: String,
    /// Why, in a clause.
    pub why: String,
    /// What to do, in the imperative.
    pub remedy: Option<&'static str>,
}
