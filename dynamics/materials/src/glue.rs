//! Glue between pairs of vertices.

use crate::potential::At;
use crate::potential::CouplingKind;
use crate::vectors::point;
use crate::{HessianSink, Potential};
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, Topology, VertexId};
use isosheet_motion::{Profile, ProfileError};
use nalgebra::{Matrix3, Vector3};

#[cfg(test)]
mod tests;

/// Why glue cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GlueError {
    /// A vertex does not exist.
    #[error("{vertex} is glued, but the sheet has {count} vertices")]
    NoVertex {
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        count: usize,
    },
    /// The two vertices of a pair are the same, or ends of an edge.
    #[error("{first} is glued to {second}, which is itself or its neighbour")]
    Neighbours {
        /// The first vertex.
        first: VertexId,
        /// The second.
        second: VertexId,
    },
    /// The stiffness is not positive or not finite.
    #[error("the stiffness of the glue is {stiffness} N/m", stiffness = given(*stiffness))]
    Stiffness {
        /// The stiffness given, N/m.
        stiffness: f64,
    },
    /// The profile of the closing cannot be used.
    #[error("the closing of the glue cannot be used: {0}")]
    Closing(#[from] ProfileError),
}

impl Advice for GlueError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NoVertex { .. } => None,
            Self::Neighbours { .. } => Some("glue vertices that have no edge in common"),
            Self::Stiffness { .. } => Some("give a finite one above 0"),
            Self::Closing(error) => error.advice(),
        }
    }
}

/// Glue: springs that hold pairs of vertices `(a_p, b_p)` together,
///
/// ```text
/// V(t, x) = k/2 sum_p |x_a - x_b - (1 - s(t)) d_p|^2,
/// ```
///
/// with the stiffness `k` of each pair (newtons per metre), the difference `d_p` of its vertices where the
/// glue was made, and the closing `s` from 0 (they stay as far apart as they were) to 1 (they coincide). A
/// pair that carries the force `F` is `F / k` apart. The force is linear in the positions, and steps solve it
/// exactly however stiff the glue is.
///
/// The two sides of a seam may run in opposite directions, and be of one sheet or of two: a strip whose ends
/// are glued is a band, and one that is twisted by half a turn a Moebius band, which no oriented mesh is. A
/// seam along one line of vertices is a hinge without stiffness. Where two lines of vertices, one cell apart,
/// are glued (an overlap), the curvature goes on across the seam.
///
/// ```
/// use isosheet_materials::{At, Glue, Potential};
/// use isosheet_mesh::{VertexId, generate};
/// use isosheet_motion::Profile;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // Vertices 0, 41 and 82 are one end of the strip, 40, 81 and 122 the other one: half a turn.
/// let strip = generate::strip(40, 0.3, 0.02, generate::Diagonals::UnionJack)?;
/// # let (rows, columns) = (strip.topology().vertex_count() / 41, 41u32);
/// let pairs: Vec<[VertexId; 2]> = (0..rows as u32)
///     .map(|j| [VertexId(j * columns), VertexId((rows as u32 - j) * columns - 1)])
///     .collect();
/// let close = Profile::SmoothStep { from: 0.0, to: 1.0, begin: 0.0, end: 1.0 };
/// let glue = Glue::new(strip.topology(), &pairs, 1e4, close, strip.positions())?;
/// // The ends are apart as they were, and are to be together.
/// assert_eq!(glue.energy(At::new(0.0, strip.positions())), 0.0);
/// assert!(glue.energy(At::new(1.0, strip.positions())) > 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Glue {
    pairs: Vec<[VertexId; 2]>,
    /// `d_p`, metres.
    offsets: Vec<Vector3<f64>>,
    stiffness: f64,
    closing: Profile,
}

impl Glue {
    /// Glue between pairs of vertices at positions `x` (`3V`, metres), of the `stiffness` of each pair in
    /// newtons per metre.
    ///
    /// # Errors
    /// [`GlueError`].
    ///
    /// # Panics
    /// If `x` is not of length `3V`.
    pub fn new(
        topology: &Topology,
        pairs: &[[VertexId; 2]],
        stiffness: f64,
        closing: impl Into<Profile>,
        x: &[f64],
    ) -> Result<Self, GlueError> {
        let closing = closing.into();
        closing.validate()?;
        if !(stiffness.is_finite() && stiffness > 0.0) {
            return Err(GlueError::Stiffness { stiffness });
        }
        let count = topology.vertex_count();
        assert_eq!(x.len(), 3 * count, "three coordinates a vertex");
        for &[first, second] in pairs {
            if let Some(vertex) = [first, second].into_iter().find(|v| v.index() >= count) {
                return Err(GlueError::NoVertex { vertex, count });
            }
            if first == second || topology.find_edge(first, second).is_some() {
                return Err(GlueError::Neighbours { first, second });
            }
        }
        let offset = |&[a, b]: &[VertexId; 2]| point(x, a) - point(x, b);
        Ok(Self {
            offsets: pairs.iter().map(offset).collect(),
            pairs: pairs.to_vec(),
            stiffness,
            closing,
        })
    }

    /// The pairs.
    pub fn pairs(&self) -> &[[VertexId; 2]] {
        &self.pairs
    }

    /// The stiffness of each pair, N/m.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// By how much the vertices of a pair are further from each other, or otherwise placed, than they are
    /// meant to be at time `t` (seconds), at most, metres; `x` are the positions, `3V`, metres.
    pub fn opening(&self, t: f64, x: &[f64]) -> f64 {
        let pairs = 0..self.pairs.len();
        pairs.fold(0.0, |most, p| most.max(self.gap(p, t, x).norm()))
    }

    /// The force that each pair carries at time `t` (seconds) and positions `x` (`3V`, metres), newtons.
    pub fn pair_forces(&self, t: f64, x: &[f64]) -> Vec<f64> {
        let pairs = 0..self.pairs.len();
        pairs
            .map(|p| self.stiffness * self.gap(p, t, x).norm())
            .collect()
    }

    /// What is left between the vertices of a pair, less what they are meant to be apart at time `t`, metres.
    fn gap(&self, number: usize, t: f64, x: &[f64]) -> Vector3<f64> {
        let [a, b] = self.pairs[number];
        let open = 1.0 - self.closing.value(t);
        point(x, a) - point(x, b) - open * self.offsets[number]
    }
}

impl Potential for Glue {
    fn energy(&self, at: At<'_>) -> f64 {
        let At { t, x, .. } = at;
        let squares = (0..self.pairs.len()).map(|p| self.gap(p, t, x).norm_squared());
        0.5 * self.stiffness * squares.sum::<f64>()
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let At { t, x, .. } = at;
        for (p, pair) in self.pairs.iter().enumerate() {
            let force = self.stiffness * self.gap(p, t, x);
            let [a, b] = pair.map(|v| 3 * v.index());
            for k in 0..3 {
                gradient[a + k] += force[k];
                gradient[b + k] -= force[k];
            }
        }
    }

    fn add_hessian(&self, _at: At<'_>, hessian: &mut dyn HessianSink) {
        let block = Matrix3::from_diagonal_element(self.stiffness);
        for &[a, b] in &self.pairs {
            hessian.add_vertex(a, &block);
            hessian.add_vertex(b, &block);
            hessian.add_pair(a, b, &-block);
        }
    }

    fn couplings(&self) -> Vec<[VertexId; 2]> {
        self.pairs.clone()
    }

    fn coupling_kind(&self) -> CouplingKind {
        CouplingKind::Stiff
    }

    fn is_driven(&self) -> bool {
        !self.closing.is_constant()
    }
}
