//! What a step has come to.

use isosheet_model::Infeasibility;

/// The solver that the hardest sub-step needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StepOutcome {
    /// Newton's method with full steps.
    Newton,
    /// Newton's method with a line search or a modified, positive definite Hessian.
    Globalised,
    /// As `Globalised`, after a seeded perturbation at a saddle point.
    BranchSeeded,
    /// Implicit Euler, after the chosen integrator had rejected every sub-step.
    Fallback,
    /// What an [engine](crate::engine::Engine) from outside did, in its own word. Of the words of several
    /// sub-steps it is the last in the order of the alphabet.
    #[serde(untagged)]
    Engine(&'static str),
}

/// Result of one call of [`Simulation::step`](crate::Simulation::step).
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct StepReport {
    /// Time at the end of the step, seconds.
    pub t: f64,
    /// Length of the step, seconds.
    pub h: f64,
    /// Accepted sub-steps.
    pub substeps: usize,
    /// Rejected sub-steps.
    pub rejected: usize,
    /// Newton iterations, rejected sub-steps included.
    pub iterations: usize,
    /// Matrix factorisations, rejected sub-steps included.
    pub factorisations: usize,
    /// Largest relative residual over the sub-steps: for conservative methods the largest unbalanced
    /// acceleration over the largest acceleration; for BDF2 and implicit Euler the Newton decrement before
    /// the last iteration, as the root of its energy over the inertia term; for projection the length rates
    /// over the speed.
    pub residual: f64,
    /// The largest estimated error that a sub-step added to the positions, metres, the root of the mean
    /// square over the vertices that are not pinned; `None` for methods other than BDF2 and implicit Euler.
    /// See
    /// [`StepControl::accuracy`](crate::StepControl::accuracy).
    pub error: Option<f64>,
    /// The lowest frequency of small free vibrations about the equilibrium at the end, hertz, of
    /// [`Method::Equilibrium`](crate::Method::Equilibrium); `None` for other methods, and where the sheet can
    /// move without a force or was not found to be stable.
    pub lowest_frequency: Option<f64>,
    /// Kinetic energy at the end, joules.
    pub kinetic: f64,
    /// Potential energy at the end, contact included, joules.
    pub potential: f64,
    /// Work since the start, joules, of non-conservative forces, air, moving bodies and supports, and
    /// [driven](crate::Potential::is_driven) potentials.
    pub work: f64,
    /// Energy dissipated by velocity damping since the start, joules.
    pub dissipated: f64,
    /// Energy lost to friction since the start, joules.
    pub friction: f64,
    /// Energy dissipated by plastic bending ([`Yield`](crate::Yield)) since the start, joules.
    pub plastic: f64,
    /// Energy error `T + V - work + dissipated + friction + plastic` relative to its value at the start,
    /// joules.
    pub energy_drift: f64,
    /// Largest relative edge length error at the end.
    pub strain: f64,
    /// Largest violation of the constraints of isometry at the end
    /// ([`SheetModel::constrained_strain`](crate::SheetModel::constrained_strain)): the edge strain of rods,
    /// zero for elastic sheets.
    pub constrained_strain: f64,
    /// Smallest gap at the end, metres; `None` without contact.
    pub gap: Option<f64>,
    /// Largest distance of a vertex from its constraint at the end, metres; `None` without constraints.
    pub violation: Option<f64>,
    /// What asks for too much where the step stopped at a taut state
    /// ([`Unsatisfiable`](crate::Unsatisfiable)).
    pub taut: Option<Infeasibility>,
    /// The solver that the hardest sub-step needed.
    pub outcome: StepOutcome,
}

impl StepReport {
    /// Total energy `T + V` (Liu, Tang and Joneja 2007, Eq. 17), joules.
    pub fn hamiltonian(&self) -> f64 {
        self.kinetic + self.potential
    }
}
