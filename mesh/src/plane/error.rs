//! Drawings that no mesh can be made of.

use crate::Advice;
use crate::wording::{brief, given};
use std::fmt;
use thiserror::Error;

/// An end of a line of the outline to which nothing is joined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// The end, metres.
    pub at: [f64; 2],
    /// The distance to the next open end, metres; infinite where there is no other.
    pub width: f64,
}

/// A place of a drawing in millimetres, the unit that drawings of sheets are measured in.
struct Place([f64; 2]);

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.0.map(|c| (1e6 * c).round() / 1e3 + 0.0);
        write!(f, "({x}, {y}) mm")
    }
}

impl fmt::Display for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", Place(self.at))?;
        match self.width.is_finite() {
            true => write!(f, ", {} mm from the next", brief(1e3 * self.width)),
            false => Ok(()),
        }
    }
}

/// Why no mesh can be made of lines in the plane.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlaneError {
    /// A length is not a positive number.
    #[error("{name} is {value}", value = given(*value))]
    Size {
        /// What it is.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A curve has a number that is not finite.
    #[error("curve {curve}, counted from 0, has a coordinate that is not finite")]
    NotFinite {
        /// Its number.
        curve: usize,
    },
    /// Lines of the outline end outside of the sheet.
    #[error("the outline is not closed: {} end at {}", counted(gaps.len()), listed(gaps))]
    Open {
        /// The open ends, the narrowest gap first.
        gaps: Vec<Gap>,
    },
    /// No line bounds an area.
    #[error("no line bounds an area: there is no outline")]
    NoOutline,
    /// Two lines come too near to each other to be told apart.
    #[error("two lines touch at {} without a common point", Place(*at))]
    Touching {
        /// Where, metres.
        at: [f64; 2],
    },
    /// More lines cross or touch each other than a drawing of so many lines has.
    #[error("the lines of the drawing meet more than {limit} times")]
    TooManyMeetings {
        /// The largest number allowed.
        limit: usize,
    },
    /// The result would be too large to handle.
    #[error("the mesh would have about {} triangles, more than the {limit} that are allowed", brief(*faces))]
    TooManyFaces {
        /// About so many.
        faces: f64,
        /// The largest number allowed.
        limit: usize,
    },
}

fn counted(ends: usize) -> String {
    crate::wording::counted(ends, "line", "lines")
}

/// The first of some gaps, and the number of the others.
fn listed(gaps: &[Gap]) -> String {
    /// As many as a reader takes in.
    const NAMED: usize = 4;
    let named: Vec<String> = gaps.iter().take(NAMED).map(Gap::to_string).collect();
    match gaps.len().saturating_sub(NAMED) {
        0 => named.join("; "),
        more => format!("{}; and {more} more", named.join("; ")),
    }
}

impl Advice for PlaneError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Size { .. } => Some("give a positive, finite length"),
            Self::NotFinite { .. } => Some("correct the drawing"),
            Self::Open { .. } => Some(
                "close the outline there, or give a tolerance for snapping of at least the gap",
            ),
            Self::NoOutline => Some("draw the outline as cut lines, or say which lines are"),
            Self::Touching { .. } => {
                Some("move them apart, or give a larger tolerance for snapping")
            }
            Self::TooManyMeetings { .. } => Some(
                "draw fewer lines, each of them once: the sheet would have too many edges to fold",
            ),
            Self::TooManyFaces { .. } => Some("give a larger spacing"),
        }
    }
}
