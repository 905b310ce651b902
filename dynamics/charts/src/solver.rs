//! Solvers for `C qdot = p`, the linear system (21) of Liu, Tang and Joneja 2007.

use super::ChartDynamicsError;
use isosheet_coords::{Chart, Linearised, RodSystem, SaddlePoint, mass_matrix};
use isosheet_mesh::MassMatrix;
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// Largest number of coordinates for [`CramerSolver`]: n^2 determinants of order n take some
/// seconds there.
const CRAMER_LIMIT: usize = 40;

/// Solves `C qdot = p` at a state, C = J^T M J the mass matrix of a chart.
///
/// All implementations give the same velocities, and the same derivative of the Hamiltonian
/// `dH/dp = qdot` (Eq. 18), up to the conditioning of the chart.
pub trait MassSolver: Send {
    /// Prepare for the state x, at which `linear` is factorised.
    ///
    /// # Errors
    /// When the mass matrix cannot be formed or factorised there.
    fn prepare(
        &mut self,
        system: &RodSystem,
        chart: &dyn Chart,
        mass: &MassMatrix,
        linear: &mut Linearised,
        x: &[f64],
    ) -> Result<(), ChartDynamicsError>;

    /// The velocities `qdot = C^-1 p`.
    ///
    /// # Errors
    /// When the mass matrix is singular to working precision.
    fn velocity(&mut self, p: &[f64], qdot: &mut [f64]) -> Result<(), ChartDynamicsError>;

    /// The derivative `dH/dp_j = sum_i p_i d(qdot_i)/dp_j` (Eq. 22). Equal to [`MassSolver::velocity`]
    /// because C is symmetric; the published method computes it separately, from minors.
    ///
    /// # Errors
    /// As [`MassSolver::velocity`].
    fn momentum_gradient(
        &mut self,
        p: &[f64],
        gradient: &mut [f64],
    ) -> Result<(), ChartDynamicsError> {
        self.velocity(p, gradient)
    }
}

/// The solvers at hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum MassSolverKind {
    /// The sparse saddle-point matrix (see [`SaddlePoint`]), for any size: symbolic analysis once, numeric
    /// factorisation at each state, iterative refinement. J and C are never formed, and the accuracy of the
    /// velocities of the vertices does not depend on the chart.
    #[default]
    Saddle,
    /// Dense LU factorisation of C.
    DenseLu,
    /// Cramer's rule with determinants from LU factorisations, exactly as published in Sec. 4.1:
    /// `qdot_i = D_*i / D`, and `d(qdot_i)/dp_j = (-1)^(i+j) M_ji / D` with the minors of D. For at most 40
    /// coordinates.
    Cramer,
}

impl MassSolverKind {
    /// A solver of this kind.
    ///
    /// # Errors
    /// [`ChartDynamicsError::TooManyCoordinates`] for Cramer's rule, and when the symbolic analysis of
    /// the saddle-point matrix fails.
    pub fn build(
        self,
        system: &RodSystem,
        mass: &MassMatrix,
    ) -> Result<Box<dyn MassSolver>, ChartDynamicsError> {
        Ok(match self {
            Self::Saddle => Box::new(SaddleSolver::new(system, mass)?),
            Self::DenseLu => Box::new(DenseLuSolver::default()),
            Self::Cramer => {
                let dimension = system.dof();
                if dimension > CRAMER_LIMIT {
                    return Err(ChartDynamicsError::TooManyCoordinates {
                        dimension,
                        limit: CRAMER_LIMIT,
                    });
                }
                Box::new(CramerSolver::default())
            }
        })
    }
}

/// See [`MassSolverKind::Saddle`].
struct SaddleSolver {
    saddle: SaddlePoint,
    pattern: isosheet_coords::RowPattern,
    rows: Vec<f64>,
    force: Vec<f64>,
    zero: Vec<f64>,
    v: Vec<f64>,
    mu: Vec<f64>,
}

impl SaddleSolver {
    /// Symbolic analysis for a system and its mass matrix.
    ///
    /// # Errors
    /// [`ChartDynamicsError::Chart`] when memory runs out.
    fn new(system: &RodSystem, mass: &MassMatrix) -> Result<Self, ChartDynamicsError> {
        Ok(Self {
            saddle: SaddlePoint::new(system, mass)?,
            pattern: isosheet_coords::RowPattern::new(),
            rows: Vec::new(),
            force: vec![0.0; system.unknowns()],
            zero: vec![0.0; system.equations()],
            v: vec![0.0; system.unknowns()],
            mu: vec![0.0; system.equations()],
        })
    }
}

impl MassSolver for SaddleSolver {
    fn prepare(
        &mut self,
        system: &RodSystem,
        chart: &dyn Chart,
        _mass: &MassMatrix,
        linear: &mut Linearised,
        x: &[f64],
    ) -> Result<(), ChartDynamicsError> {
        self.saddle.factorize(system, x)?;
        if self.pattern != *chart.pattern() {
            self.pattern = chart.pattern().clone();
        }
        self.rows.clear();
        self.rows.extend_from_slice(linear.rows());
        Ok(())
    }

    fn velocity(&mut self, p: &[f64], qdot: &mut [f64]) -> Result<(), ChartDynamicsError> {
        self.force.fill(0.0);
        self.pattern.add_transpose(&self.rows, p, &mut self.force);
        self.saddle
            .solve(&self.force, &self.zero, &mut self.v, &mut self.mu)?;
        self.pattern.apply(&self.rows, &self.v, qdot);
        Ok(())
    }
}

/// The dense mass matrix of the chart at x.
fn dense(
    system: &RodSystem,
    chart: &dyn Chart,
    mass: &MassMatrix,
    linear: &mut Linearised,
    x: &[f64],
) -> Result<DMatrix<f64>, ChartDynamicsError> {
    let jacobian = chart.jacobian(system, linear, x)?;
    Ok(mass_matrix(system, mass, &jacobian))
}

/// See [`MassSolverKind::DenseLu`].
#[derive(Default)]
struct DenseLuSolver {
    factor: Option<LU<f64, Dyn, Dyn>>,
}

impl MassSolver for DenseLuSolver {
    fn prepare(
        &mut self,
        system: &RodSystem,
        chart: &dyn Chart,
        mass: &MassMatrix,
        linear: &mut Linearised,
        x: &[f64],
    ) -> Result<(), ChartDynamicsError> {
        self.factor = Some(dense(system, chart, mass, linear, x)?.lu());
        Ok(())
    }

    fn velocity(&mut self, p: &[f64], qdot: &mut [f64]) -> Result<(), ChartDynamicsError> {
        let mut b = DVector::from_column_slice(p);
        let solved = self.factor.as_ref().is_some_and(|f| f.solve_mut(&mut b));
        store(b.as_slice(), solved, qdot)
    }
}

/// See [`MassSolverKind::Cramer`].
#[derive(Default)]
struct CramerSolver {
    c: DMatrix<f64>,
    determinant: f64,
    scale: f64,
}

impl MassSolver for CramerSolver {
    fn prepare(
        &mut self,
        system: &RodSystem,
        chart: &dyn Chart,
        mass: &MassMatrix,
        linear: &mut Linearised,
        x: &[f64],
    ) -> Result<(), ChartDynamicsError> {
        let c = dense(system, chart, mass, linear, x)?;
        // One common factor, so that determinants neither underflow nor overflow.
        self.scale = c.trace() / c.nrows() as f64;
        self.c = c / self.scale;
        self.determinant = self.c.determinant();
        if self.determinant.is_normal() {
            Ok(())
        } else {
            Err(ChartDynamicsError::SingularMass {
                dimension: chart.dimension(),
            })
        }
    }

    fn velocity(&mut self, p: &[f64], qdot: &mut [f64]) -> Result<(), ChartDynamicsError> {
        for (i, value) in qdot.iter_mut().enumerate() {
            let mut replaced = self.c.clone();
            replaced.column_mut(i).copy_from_slice(p);
            *value = replaced.determinant() / self.determinant / self.scale;
        }
        check(qdot)
    }

    fn momentum_gradient(
        &mut self,
        p: &[f64],
        gradient: &mut [f64],
    ) -> Result<(), ChartDynamicsError> {
        for (j, value) in gradient.iter_mut().enumerate() {
            *value = 0.0;
            for (i, pi) in p.iter().enumerate() {
                // Row j and column i are struck out.
                let minor = if p.len() == 1 {
                    1.0
                } else {
                    self.c.clone().remove_row(j).remove_column(i).determinant()
                };
                let sign = if (i + j) % 2 == 0 { 1.0 } else { -1.0 };
                *value += pi * sign * minor / self.determinant / self.scale;
            }
        }
        check(gradient)
    }
}

fn store(b: &[f64], solved: bool, qdot: &mut [f64]) -> Result<(), ChartDynamicsError> {
    if !solved {
        return Err(ChartDynamicsError::SingularMass {
            dimension: qdot.len(),
        });
    }
    qdot.copy_from_slice(b);
    check(qdot)
}

fn check(qdot: &[f64]) -> Result<(), ChartDynamicsError> {
    if qdot.iter().all(|v| v.is_finite()) {
        Ok(())
    } else {
        Err(ChartDynamicsError::SingularMass {
            dimension: qdot.len(),
        })
    }
}
