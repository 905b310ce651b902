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
    /// None but checkpoints. The sub-steps from one checkpoint to the next are made again for a gradient,
    /// which costs a run more.
    Between {
        /// Steps of the plan from one to the next, at least one.
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
    /// Part of the size of a number over which the derivatives of the equations of a step by it are central
    /// differences. Default 1e-5: what is left out is a part 1e-10, and the round-off as much. It is less
    /// where lengths of elastic sheets at rest would differ by more than a part 1e-8.
    pub difference: f64,
    /// The sizes of the numbers of the scene: by how much each has to change to make another scene, in its
    /// own unit. Of places of bodies that is the distance at which the barrier of contact acts. Default, and
    /// where the list is too short or has zeros: the number itself, and one where that is zero.
    pub sizes: Vec<f64>,
}

impl AdjointOptions {
    /// The size of a number.
    pub(crate) fn size(&self, number: usize, value: f64) -> f64 {
        let given = self.sizes.get(number).copied().unwrap_or(0.0);
        let sizes = [given, value.abs(), 1.0];
        sizes.into_iter().find(|size| *size != 0.0).unwrap_or(1.0)
    }
}

impl Default for AdjointOptions {
    fn default() -> Self {
        Self {
            branches: Branches::default(),
            kept: Kept::default(),
            tolerance: 1e-10,
            patience: 12,
            difference: 1e-5,
            sizes: Vec::new(),
        }
    }
}
