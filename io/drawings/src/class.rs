//! What the lines of drawings are meant to do.

use std::fmt;

/// What a line of a drawing is meant to do, the strongest first: where lines of several kinds lie on each
/// other, the first of them counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LineClass {
    /// The sheet ends here, or is cut.
    Cut,
    /// It folds away from the viewer of the drawing.
    Mountain,
    /// It folds towards the viewer.
    Valley,
    /// It folds, and the drawing does not say to which side.
    Crease,
    /// It has edges here, which stay flat.
    Flat,
    /// The line is left out.
    Ignored,
}

impl LineClass {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Cut,
        Self::Mountain,
        Self::Valley,
        Self::Crease,
        Self::Flat,
        Self::Ignored,
    ];
}

impl fmt::Display for LineClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Cut => "cut",
            Self::Mountain => "mountain",
            Self::Valley => "valley",
            Self::Crease => "crease",
            Self::Flat => "flat",
            Self::Ignored => "left out",
        })
    }
}
