//! Charts: system coordinates and the rows that linearise them.
//!
//! A chart assigns n numbers q to a state x that has the right edge lengths, n the degrees of
//! freedom. Its rows `s_k = dq_k/dx` form the sparse matrix S (n x unknowns); with the rows of
//! the length equations they make up the square matrix `A = [G; S]`, and `J = dx/dq = A^-1 [0; I]`.
//! Dynamics needs nothing else: a [`Chart`] gives its rows, their rate along a velocity, the values of its
//! coordinates, and positions from these values.

use crate::assignment::AssignmentError;
use crate::linearised::Linearised;
use crate::placement_error::PlacementError;
use crate::realise::RealiseError;
use crate::row_pattern::RowPattern;
use crate::system::{RodSystem, SystemError};
use isosheet_linalg::LinalgError;
use isosheet_mesh::wording::{brief, given};
use isosheet_mesh::{Advice, MeshError, VertexId};
use nalgebra::DMatrix;
use thiserror::Error;

/// Why a chart cannot be built or used.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ChartError {
    /// Coordinates or positions are not defined.
    #[error(transparent)]
    Realise(#[from] RealiseError),
    /// Pins are not usable.
    #[error(transparent)]
    System(#[from] SystemError),
    /// Coordinates cannot be assigned.
    #[error(transparent)]
    Assignment(#[from] AssignmentError),
    /// A sheet or its masses are not valid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A generated sheet is not valid.
    #[error(transparent)]
    Generate(#[from] isosheet_mesh::generate::GenerateError),
    /// A sparse factorisation failed.
    #[error(
        "the linearised chart [G; S] cannot be factorised (the state is flat, or the chart has left \
         its domain): {0}"
    )]
    Linalg(#[from] LinalgError),
    /// The length equations are dependent, as in every flat state with interior vertices: no
    /// choice of n coordinates is a chart.
    #[error(
        "the {equations} length equations have rank {rank} only at this state (flat sheet or branch \
         point)"
    )]
    RankDeficient {
        /// Number of length equations.
        equations: usize,
        /// Their numerical rank.
        rank: usize,
    },
    /// A coordinate row is not defined at this state.
    #[error("coordinate {coordinate} ({vertex}) has no gradient here: {source}")]
    Row {
        /// The coordinate.
        coordinate: usize,
        /// The vertex it belongs to.
        vertex: VertexId,
        /// The reason.
        source: PlacementError,
    },
    /// Newton's method for positions did not converge.
    #[error(
        "positions were not found in {iterations} Newton steps: residual {residual} (relative), \
         tolerance {tolerance}",
        residual = brief(*residual), tolerance = given(*tolerance)
    )]
    NotConverged {
        /// Steps taken.
        iterations: usize,
        /// Relative residual left.
        residual: f64,
        /// The tolerance.
        tolerance: f64,
    },
    /// The chart is too ill-conditioned to give digits.
    #[error(
        "the mass matrix of the chart has condition number {condition}, above the limit {limit}: \
         the answer would be noise",
        condition = brief(*condition), limit = given(*limit)
    )]
    IllConditioned {
        /// Condition number of C.
        condition: f64,
        /// The limit.
        limit: f64,
    },
}

impl Advice for ChartError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Realise(error) => error.advice(),
            Self::System(error) => error.advice(),
            Self::Assignment(error) => error.advice(),
            Self::Mesh(error) => error.advice(),
            Self::Generate(error) => error.advice(),
            Self::Linalg(..) => Some("rebase the chart or perturb the state"),
            Self::RankDeficient { .. } => Some("perturb the state, or use a chart-free integrator"),
            Self::Row { source, .. } => source.advice(),
            Self::NotConverged { .. } => Some("take a smaller step"),
            Self::IllConditioned { .. } => Some("use a better conditioned chart or a coarser mesh"),
        }
    }
}

/// System coordinates of a rod system (Liu, Tang and Joneja 2007, Sec. 2.1).
///
/// A chart assigns n numbers q to a state x that has the right edge lengths, n the degrees of freedom. Its
/// rows `s_k = dq_k/dx` form the sparse matrix S (n x unknowns); with the rows G of the length equations they
/// make up the square matrix `A = [G; S]`, and `J = dx/dq = A^-1 [0; I]`.
///
/// States x and velocities v are full slices, three values per vertex, with zero velocity at pinned
/// vertices; entries of S refer to the unknowns of the [`crate::RodSystem`].
pub trait Chart: Send {
    /// The rod system that the chart was built for.
    fn system(&self) -> &RodSystem;

    /// Number n of coordinates; the degrees of freedom of the system.
    fn dimension(&self) -> usize;

    /// Pattern of S.
    fn pattern(&self) -> &RowPattern;

    /// Values of S at x, in pattern order.
    ///
    /// # Errors
    /// [`ChartError::Row`] where a coordinate has no gradient.
    fn rows(&self, x: &[f64], values: &mut [f64]) -> Result<(), ChartError>;

    /// Rate of change of the values of S along the velocity v: `d/d eps S(x + eps v)` at 0.
    ///
    /// # Errors
    /// As [`Chart::rows`].
    fn rows_rate(&self, x: &[f64], v: &[f64], values: &mut [f64]) -> Result<(), ChartError>;

    /// Coordinate values of the state x.
    ///
    /// # Errors
    /// [`ChartError::Realise`] where a coordinate is not defined.
    fn coordinates(&self, x: &[f64], q: &mut [f64]) -> Result<(), ChartError>;

    /// `out = q1 - q0` with angles taken to (-pi, pi].
    fn difference(&self, q1: &[f64], q0: &[f64], out: &mut [f64]);

    /// Positions with the right edge lengths and coordinates q (Eq. 4), on the branch of the state `near`.
    ///
    /// # Errors
    /// [`ChartError::Realise`] or [`ChartError::NotConverged`] when there is none near by.
    fn realise(
        &self,
        linear: &mut Linearised,
        q: &[f64],
        near: &[f64],
        x: &mut [f64],
    ) -> Result<(), ChartError>;

    /// Factorise `A = [G; S]` at x, with the rods of `system`.
    ///
    /// # Errors
    /// [`ChartError::Row`] where a coordinate has no gradient, [`ChartError::Linalg`].
    fn linearise(
        &self,
        system: &RodSystem,
        linear: &mut Linearised,
        x: &[f64],
    ) -> Result<(), ChartError> {
        self.rows(x, linear.rows_mut())?;
        Ok(linear.factorize(system, x)?)
    }

    /// The dense Jacobian `J = dx/dq` at x, unknowns x n. Leaves `linear` factorised at x.
    ///
    /// # Errors
    /// [`ChartError::Row`], [`ChartError::Linalg`] where the chart is singular.
    fn jacobian(
        &self,
        system: &RodSystem,
        linear: &mut Linearised,
        x: &[f64],
    ) -> Result<DMatrix<f64>, ChartError> {
        self.linearise(system, linear, x)?;
        Ok(linear.jacobian()?)
    }

    /// Distance of the state from a singularity of the coordinates themselves, 1 or more far away
    /// and 0 at it. Below about 0.1 a [`Chart::rebased`] chart is due.
    ///
    /// # Errors
    /// [`ChartError::Realise`] for a malformed state.
    fn margin(&self, x: &[f64]) -> Result<f64, ChartError>;

    /// A chart of this kind with the reference state x. Coordinate values and rows may differ from this
    /// chart, and for a chart that selects its coordinates so may the pattern: build [`Linearised`] and what
    /// depends on it anew.
    ///
    /// # Errors
    /// As for building the chart at that state.
    fn rebased(&self, x: &[f64]) -> Result<Box<dyn Chart>, ChartError>;
}
