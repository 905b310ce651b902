//! Round bodies that respond: their surface is at a distance from points and edges that they carry.

use super::features::Ends;
use super::options::ContactsError;
use isosheet_dynamics::contact::Round;
use nalgebra::Vector3;
use std::ops::Range;

/// A round body where it is at the start: all points within a radius of a segment, whose ends are the same of a ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundBody {
    /// The ends of the segment, metres.
    pub axis: [[f64; 3]; 2],
    /// The radius, metres.
    pub radius: f64,
}

/// The points of a round body in the place of those of a polyhedron.
#[derive(Debug, Clone, PartialEq, Eq)]
struct InPlace {
    /// Those of the polyhedron.
    replaced: Range<usize>,
    points: Range<usize>,
    /// Whether it has an axis.
    has_axis: bool,
}

impl RoundBody {
    /// # Errors
    /// [`ContactsError::Radius`].
    pub(super) fn validate(&self) -> Result<(), ContactsError> {
        match self.radius > 0.0 && self.radius.is_finite() {
            true => Ok(()),
            false => Err(ContactsError::Radius(self.radius)),
        }
    }

    /// Whether it is a ball.
    pub fn is_ball(&self) -> bool {
        let [a, b] = self.axis;
        a == b
    }

    /// Points that the body carries: each end twice, and three beside the first, which lie with it in no plane.
    pub(super) fn points(&self) -> Vec<[f64; 3]> {
        let [first, last] = self.axis;
        let beside = (0..3).map(|k| {
            let place = Vector3::from(first) + self.radius * Vector3::ith(k, 1.0);
            place.into()
        });
        let ends = match self.is_ball() {
            true => vec![first, first],
            false => vec![first, first, last, last],
        };
        ends.into_iter().chain(beside).collect()
    }
}

impl RoundBody {
    /// Its primitives, by the numbers of these points: which of them are vertices, the edges, and what is round.
    pub(super) fn primitives(&self) -> (&'static [bool], &'static [[u32; 2]], Round) {
        let radius = self.radius;
        match self.is_ball() {
            true => {
                let frame = [0, 2, 3, 4];
                let vertices = &[true, false, false, false, false];
                (vertices, &[[0, 1]], Round { radius, frame })
            }
            false => {
                let frame = [0, 4, 5, 6];
                let vertices = &[true, false, true, false, false, false, false];
                (vertices, &[[0, 1], [2, 3], [0, 2]], Round { radius, frame })
            }
        }
    }
}

/// The round bodies of a scene.
#[derive(Debug, Clone, Default)]
pub(super) struct Rounds(Vec<InPlace>);

impl Rounds {
    /// Adds a body whose points begin at the given one.
    pub(super) fn add(&mut self, body: &RoundBody, replaced: Range<usize>, first: usize) {
        self.0.push(InPlace {
            replaced,
            points: first..first + body.points().len(),
            has_axis: !body.is_ball(),
        });
    }

    /// What the ends of the axes of obstacles are beside them.
    pub(super) fn ends(&self) -> Ends {
        match self.0.iter().any(|round| round.has_axis) {
            true => Ends::Edges,
            false => Ends::Points,
        }
    }

    /// Whether a round body is in the place of a point.
    pub(super) fn replace(&self, point: usize) -> bool {
        self.0.iter().any(|round| round.replaced.contains(&point))
    }

    /// A range of points, and those of the round bodies that are in the place of some of them.
    pub(super) fn with_those_in(&self, range: &Range<usize>) -> Vec<Range<usize>> {
        let is_inside =
            |r: &&InPlace| range.start <= r.replaced.start && r.replaced.end <= range.end;
        let rounds = self.0.iter().filter(is_inside).map(|r| r.points.clone());
        std::iter::once(range.clone()).chain(rounds).collect()
    }
}
