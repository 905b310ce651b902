//! The options of a gradient.

/// What becomes of steps that have no derivative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Branches {
    /// They are an error, which names them with their time.
    #[default]
    Refuse,
    /// What has no derivative counts as constant, and is named beside the gradient.
    PassBy,
}

/// Which sub-steps are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kept {
    /// All of them: some twenty numbers for each coordinate and sub-step.
    #[default]
    All,
    /// Those from one checkpoint to the next, so many steps of the plan, which are made again for a gradient:
    /// a gradient costs a run more.
    Between {
        /// Steps of the plan, at least one.
        checkpoints: usize,
    },
}

/// The options of the adjoint of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct AdjointOptions {
    /// What becomes of steps that have no derivative. Default: they are refused.
    pub branches: Branches,
    /// Which sub-steps are kept. Default: all.
    pub kept: Kept,
    /// Error of the solutions of linear systems, relative to the right-hand side and preconditioned. Default
    /// 1e-10.
    pub tolerance: f64,
    /// Iterations of a linear system after which its own matrix is factorised in place of that of another
    /// step. Default 12: at 1089 vertices a factorisation takes as long as some twenty solves.
    pub patience: usize,
    /// Part of a number over which the derivatives of the equations of a step by it are central differences;
    /// of numbers smaller than one in size the distance. Default 1e-5: what is left out is a part 1e-10, and
    /// the round-off as much.
    pub difference: f64,
}

impl Default for AdjointOptions {
    fn default() -> Self {
        Self {
            branches: Branches::default(),
            kept: Kept::default(),
            tolerance: 1e-10,
            patience: 12,
            difference: 1e-5,
        }
    }
}
