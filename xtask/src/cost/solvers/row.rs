//! What is measured of a linear solver.

/// One solver on one matrix. Times in seconds.
#[derive(Clone, Debug, Default)]
pub(crate) struct SolverRow {
    pub(crate) solver: String,
    pub(crate) mesh: String,
    /// Degrees of freedom.
    pub(crate) n: usize,
    /// Order of the matrix that is factorised.
    pub(crate) order: usize,
    /// Forming C, for the dense solvers.
    pub(crate) form: f64,
    pub(crate) first: f64,
    pub(crate) again: f64,
    pub(crate) solve: f64,
    /// `None` when the solver failed.
    pub(crate) backward: Option<f64>,
    pub(crate) velocity: Option<f64>,
    pub(crate) failure: Option<String>,
}

impl SolverRow {
    /// A solver on a mesh, of which nothing is measured yet.
    pub(super) fn new(solver: &str, mesh: &str, n: usize) -> Self {
        Self {
            solver: solver.to_owned(),
            mesh: mesh.to_owned(),
            n,
            ..Self::default()
        }
    }

    /// What a step pays: forming, factorising again, solving.
    pub(super) fn step(&self) -> f64 {
        self.form + self.again + self.solve
    }
}

/// Names of the solvers, dense ones first.
pub(super) const SOLVERS: [&str; 8] = [
    MINORS, CRAMER, DENSE_LU, CHOLESKY, SPARSE_LU, LDLT, SCHUR, PRIMAL,
];
pub(super) const MINORS: &str = "Cramer, minors as published";
pub(super) const CRAMER: &str = "Cramer's rule";
pub(super) const DENSE_LU: &str = "dense LU";
pub(super) const CHOLESKY: &str = "dense Cholesky";
pub(super) const SPARSE_LU: &str = "sparse LU, saddle point";
pub(super) const LDLT: &str = "sparse LDL^T, saddle point";
pub(super) const SCHUR: &str = "sparse Cholesky, Schur complement";
pub(super) const PRIMAL: &str = "sparse Cholesky, primal";
