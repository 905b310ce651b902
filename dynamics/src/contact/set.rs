//! The pairs within reach on a motion.

use super::{BodyMotions, Contact};
use serde::{Deserialize, Serialize};

/// A motion of the sheet and the bodies that is to be checked: the sheet on straight lines from `x` to
/// `x + dx`, the bodies, at the same time, from one progress of their motions over the step to another.
#[derive(Debug, Clone, Copy)]
pub struct JointMotion<'a> {
    /// The motions of the bodies over the step.
    pub bodies: &'a BodyMotions,
    /// Progress of the bodies at the start and at the end of this motion, from 0 to 1.
    pub progress: [f64; 2],
    /// Positions at its start, `3V`, metres.
    pub x: &'a [f64],
    /// Displacements, `3V`, metres.
    pub dx: &'a [f64],
}

/// Which two primitives make a pair; orders the pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct ContactKey {
    /// Number of the body; `None` for the sheet with itself.
    pub body: Option<u32>,
    /// Of what kind the primitives are.
    pub kind: ContactKind,
    /// Numbers of the primitive of the sheet and of that of the body or the sheet.
    pub pair: [u32; 2],
}

/// The two kinds of primitives of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum ContactKind {
    /// A vertex of the sheet and a body as a whole, by its signed distance; the second number is zero.
    Vertex,
    /// A vertex of the sheet and a face.
    VertexFace,
    /// A face of the sheet and a vertex of a body.
    FaceVertex,
    /// Two edges.
    EdgeEdge,
}

/// The pairs that come within reach on a motion, and the part of the motion that is safe.
///
/// A set holds what can be evaluated at all places of the safe part of its motion
/// ([`super::ActiveContacts`]). It does not depend on what was searched for before: the pairs are sorted.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSet {
    bodies: BodyMotions,
    pairs: Vec<ContactKey>,
    safe_fraction: f64,
}

impl ContactSet {
    /// The set of a motion.
    pub fn of(contact: &mut dyn Contact, motion: JointMotion<'_>) -> Self {
        let mut set = Self {
            bodies: motion.bodies.clone(),
            pairs: Vec::new(),
            safe_fraction: 0.0,
        };
        set.update(contact, motion);
        set
    }

    /// Becomes the set of another motion; reuses memory.
    pub fn update(&mut self, contact: &mut dyn Contact, motion: JointMotion<'_>) {
        self.bodies.copy_from(motion.bodies);
        self.pairs.clear();
        let safe = contact.query(motion, &mut self.pairs);
        self.pairs.sort_unstable();
        let mut coordinates = motion.x.iter().chain(motion.dx);
        let is_finite = coordinates.all(|c| c.is_finite());
        self.safe_fraction = if is_finite { safe } else { 0.0 };
    }

    /// Becomes a set of pairs that are within reach at a place; reuses memory.
    pub(super) fn become_pairs(&mut self, bodies: &BodyMotions, pairs: &[ContactKey]) {
        self.bodies.copy_from(bodies);
        self.pairs.clear();
        self.pairs.extend_from_slice(pairs);
        self.safe_fraction = 1.0;
    }

    /// The motions of the bodies over the step.
    pub fn bodies(&self) -> &BodyMotions {
        &self.bodies
    }

    /// The pairs, sorted. Some of them may stay out of reach.
    pub fn pairs(&self) -> &[ContactKey] {
        &self.pairs
    }

    /// The largest fraction of the motion, at most one, that is proven to bring nothing into contact; zero if
    /// a coordinate is not finite.
    pub fn safe_fraction(&self) -> f64 {
        self.safe_fraction
    }
}
