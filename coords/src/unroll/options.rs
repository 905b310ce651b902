//! Options of unrolling.

use super::UnrollError;
use isosheet_mesh::EdgeId;
use std::f64::consts::PI;

/// Options of [`unroll`](super::unroll).
#[derive(Clone, Debug, PartialEq)]
pub struct UnrollOptions {
    /// The largest strain of an edge, `|length / rest length - 1|`, that is accepted of a layout, from 1e-12
    /// to 1. Default 1e-3: a tenth of a millimetre in ten centimetres, which is what cutting plotters keep.
    pub strain: f64,
    /// A fold by this angle or more is a crease, radians from 0 to pi. Default 30 degrees: smaller folds may
    /// belong to chords of a curved surface, and drawings are divided into chords that turn by as much at
    /// most. Vertices of creases with an [angle deficit](isosheet_mesh::angle_deficits) are corners, to which
    /// the sheet is cut.
    pub crease: f64,
    /// Edges along which the sheet is cut in any case. Default none.
    pub cuts: Vec<EdgeId>,
    /// The distance between pieces, metres. Default a twentieth of the longest side of all pieces.
    pub gap: Option<f64>,
}

impl Default for UnrollOptions {
    fn default() -> Self {
        Self {
            strain: 1e-3,
            crease: PI / 6.0,
            cuts: Vec::new(),
            gap: None,
        }
    }
}

/// Strains below are round-off of lengths in a sheet of thousands of edges.
const LEAST_STRAIN: f64 = 1e-12;

impl UnrollOptions {
    /// The largest angle deficit, radians, of a vertex to which no cut leads: `4 pi` times the strain.
    ///
    /// Around a vertex with the deficit `d` the rim is shorter by the part `d / 2 pi` than in the plane. The
    /// least strain makes spokes shorter and the rim longer, by half of that part each.
    pub fn largest_deficit(&self) -> f64 {
        4.0 * PI * self.strain
    }

    /// Checks the values. (Edges are checked against a mesh by [`unroll`](super::unroll).)
    ///
    /// # Errors
    /// [`UnrollError::Option`] for a value out of its range.
    pub fn validate(&self) -> Result<(), UnrollError> {
        let check = |name, value: f64, least: f64, most: f64| match (least..=most).contains(&value)
        {
            true => Ok(()),
            false => Err(UnrollError::Option {
                name,
                value,
                least,
                most,
            }),
        };
        check("the strain", self.strain, LEAST_STRAIN, 1.0)?;
        check("the angle of creases", self.crease, 0.0, PI)?;
        check("the gap", self.gap.unwrap_or(0.0), 0.0, f64::MAX)
    }
}
