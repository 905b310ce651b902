//! Round bodies that respond: their surface is at a distance from points and edges that they carry.

use super::features::Ends;
use super::options::ContactsError;
use isosheet_dynamics::contact::Round;
use nalgebra::Vector3;
use std::ops::Range;

/// A round body where it is at the start: all points within a radius of a segment, whose ends are the same of
/// a ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundBody {
    /// The ends of the segment, metres.
    pub axis: [[f64; 3]; 2],
    /// The radius, metres.
    pub radius: f64,
}

/// The points of a round body in place of the points of a polyhedron.
#[derive(Debug, Clone, PartialEq)]
struct InPlace {
    /// The points of the polyhedron.
    replaced: Range<usize>,
    points: Range<usize>,
    round: Round,
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

    /// Points that the body carries: each end twice, and three beside the first, which lie with it in no
    /// plane.
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
    /// Its primitives, by the numbers of these points: which of them are vertices, and the edges.
    pub(super) fn primitives(&self) -> (&'static [bool], &'static [[u32; 2]]) {
        match self.is_ball() {
            true => (&[true, false, false, false, false], &[[0, 1]]),
            false => (
                &[true, false, true, false, false, false, false],
                &[[0, 1], [2, 3], [0, 2]],
            ),
        }
    }

    /// What is round, where the points begin at the given one: the frame is the first end and the points
    /// beside it.
    fn round(&self, first: usize) -> Round {
        let beside = match self.is_ball() {
            true => [0, 2, 3, 4],
            false => [0, 4, 5, 6],
        };
        Round {
            radius: self.radius,
            frame: beside.map(|k| first as u32 + k),
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
            round: body.round(first),
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

    /// What is round about a point.
    pub(super) fn of(&self, point: u32) -> Option<Round> {
        // The points of the bodies are in the order of the bodies.
        let point = point as usize;
        let before = self.0.partition_point(|body| body.points.end <= point);
        let body = self.0.get(before)?;
        body.points.contains(&point).then_some(body.round)
    }

    /// Whether a round body is in the place of a point.
    pub(super) fn replace(&self, point: usize) -> bool {
        self.0.iter().any(|round| round.replaced.contains(&point))
    }

    /// A range of points, and the points of round bodies that replace some of them.
    pub(super) fn with_those_in(&self, range: &Range<usize>) -> Vec<Range<usize>> {
        let is_inside =
            |r: &&InPlace| range.start <= r.replaced.start && r.replaced.end <= range.end;
        let rounds = self.0.iter().filter(is_inside).map(|r| r.points.clone());
        std::iter::once(range.clone()).chain(rounds).collect()
    }
}
