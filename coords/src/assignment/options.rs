//! Options of an assignment.

use super::AssignmentError;
use isosheet_mesh::VertexId;

/// What to do where three known neighbours do not determine a position.
///
/// Fig. 7 shows the case that they are on a line. The other one is a vertex coplanar with the three: its
/// two mirror images coincide there, which happens whenever a fold passes through flat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Degenerate {
    /// Keep rule f. Realisation carries the angle about the line over from the previous state
    /// ([`crate::placement::place_on_line`]) for as long as the three are on a line. The number of
    /// coordinates does not depend on the state; derivatives do not exist at the degenerate state itself.
    #[default]
    Carry,
    /// Assign one coordinate ([`Rule::Turn`](super::Rule::Turn)) and keep the third edge as a closure, which
    /// makes another coordinate dependent. Needed wherever a crease line stays straight while the sheet folds
    /// along it: in the union-jack squares every inner vertex of degree 4 keeps one of its two crease lines
    /// straight at any state with the right lengths, and rule f is singular for one of the two choices.
    Assign,
}

/// Options of [`assign`](super::assign).
#[derive(Clone, Debug)]
pub struct AssignmentOptions {
    /// Pinned vertices; default none.
    pub pins: Vec<VertexId>,
    /// Start vertices of components without a pin; a component that has neither starts from its
    /// lowest vertex. Default none.
    pub starts: Vec<VertexId>,
    /// Treatment of Fig. 7; default [`Degenerate::Carry`].
    pub degenerate: Degenerate,
    /// With [`Degenerate::Assign`], volume spanned by the unit vectors along the three edges below which
    /// rule f is given up. Default 0.2 (a fold of about 12 degrees): the rule with a closure is
    /// valid away from the degenerate state as well and better conditioned near it. With a smaller volume an
    /// explicit step easily passes the turning point of a vertex. From 0 to 1, the volumes that unit vectors
    /// can span: 0 gives rule f up only where the edges are exactly coplanar, 1 gives it up everywhere.
    pub volume: f64,
}

impl Default for AssignmentOptions {
    fn default() -> Self {
        Self {
            pins: Vec::new(),
            starts: Vec::new(),
            degenerate: Degenerate::default(),
            volume: 0.2,
        }
    }
}

impl AssignmentOptions {
    /// Checks [`AssignmentOptions::volume`]. (Pins and starts are checked against a mesh by
    /// [`assign`](super::assign).)
    ///
    /// # Errors
    /// [`AssignmentError::Volume`] unless it is from 0 to 1.
    pub fn validate(&self) -> Result<(), AssignmentError> {
        if (0.0..=1.0).contains(&self.volume) {
            Ok(())
        } else {
            Err(AssignmentError::Volume {
                volume: self.volume,
            })
        }
    }
}
