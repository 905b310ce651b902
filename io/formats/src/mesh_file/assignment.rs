//! What the edges of crease patterns are meant to do.

use std::fmt;

/// What an edge of a FOLD file is meant to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeAssignment {
    /// `B`: the boundary of the sheet.
    Boundary,
    /// `M`: folds away from the side from which faces are counter-clockwise.
    Mountain,
    /// `V`: folds towards that side.
    Valley,
    /// `F`: stays flat.
    Flat,
    /// `U`, or not said.
    Unassigned,
    /// `C`: the sheet is cut here; its two sides have vertices of their own.
    Cut,
    /// `J`: joins two triangles of one panel; stays flat.
    Join,
}

impl fmt::Display for EdgeAssignment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Boundary => "is on the boundary",
            Self::Mountain => "is a mountain",
            Self::Valley => "is a valley",
            Self::Flat => "stays flat",
            Self::Unassigned => "is unassigned",
            Self::Cut => "is cut",
            Self::Join => "joins two faces of a flat panel",
        })
    }
}
