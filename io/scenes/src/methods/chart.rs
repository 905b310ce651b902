//! Motion in a chart: Hamilton's equations in system coordinates.

use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_charts::{
    ChartMethod, ChartOptions, ChartStepControl, Equations, MassSolverKind, PositionUpdate, Rebase,
};
use isosheet_coords::assignment::Degenerate;
use isosheet_coords::{
    AssignmentOptions, CartesianChart, Chart, ChartError, Choice, FrontChart, RodSystem,
};
use isosheet_mesh::{Sheet, VertexId};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the motion is computed with `integrator = "chart"`. Neither of the charts exists in a flat state: a
/// sheet that starts flat needs `sheet.start.perturbation`.
///
/// ```toml
/// [sheet.start]
/// perturbation = 0.1
///
/// [method]
/// integrator = "chart"
/// chart = { scheme = "runge_kutta4", substep = { fixed = 0.001 } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(default, deny_unknown_fields)]
pub struct ChartKey {
    /// The coordinates.
    pub coordinates: Coordinates,
    /// The time integration.
    pub scheme: ChartScheme,
    /// The equations of motion.
    pub equations: ChartEquations,
    /// How positions follow from a step of the coordinates.
    pub positions: ChartPositions,
    /// How velocities follow from momenta.
    pub solver: ChartSolver,
    /// The length of a part of a step.
    pub substep: Substep,
    /// What happens where the chart comes close to a singularity.
    pub singular: NearSingularity,
}

/// The coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum Coordinates {
    /// Some of the coordinates of vertices, chosen so that the others depend well on them.
    #[default]
    Cartesian,
    /// The coordinates that the paper's front assigns as it passes over the sheet.
    Front,
    /// The coordinates of the front, with one more for each vertex whose three known neighbours are on a
    /// line.
    FrontWithStraightCreases,
}

/// The time integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum ChartScheme {
    /// The paper's: first order, gains energy.
    ForwardEuler,
    /// The classical method of fourth order, for full equations and exact positions.
    #[default]
    RungeKutta4,
}

/// The equations of motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum ChartEquations {
    /// Hamilton's equations.
    #[default]
    Full,
    /// As published, without the terms of squared velocities, and momenta formed anew after each step.
    Reformed,
    /// As published: this does not converge to the motion as steps become short.
    Published,
}

/// How positions follow from a step of the coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum ChartPositions {
    /// Through the chart: exact lengths.
    #[default]
    Exact,
    /// To first order, then projected onto the lengths.
    Projected,
    /// To first order, as published: lengths drift.
    Linear,
}

/// How velocities follow from momenta.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum ChartSolver {
    /// By a sparse factorisation, for any number of coordinates.
    #[default]
    Sparse,
    /// By LU factorisation of the mass matrix of the chart.
    DenseLu,
    /// By Cramer's rule, as published; for at most 40 coordinates.
    Cramer,
}

/// The length of a part of a step. The last part ends with the step.
///
/// ```toml
/// [method]
/// integrator = "chart"
/// chart = { substep = { adaptive = { tolerance = 1e-4, min = 1e-6, max = 0.001 } } }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Substep {
    /// One length for all, seconds.
    Fixed(f64),
    /// The paper's adaptive step: the longest one that changes the energy by less than a tolerance.
    Adaptive {
        /// Largest change of the energy, joules.
        tolerance: f64,
        /// Shortest part, seconds; where an even shorter one is needed, the run ends with an error.
        min: f64,
        /// Longest part, seconds.
        max: f64,
    },
}

impl Default for Substep {
    /// A millisecond.
    fn default() -> Self {
        Self::Fixed(1e-3)
    }
}

/// What happens where the chart comes close to a singularity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum NearSingularity {
    /// The state there becomes the reference of a new chart.
    #[default]
    Rebase,
    /// The run ends with an error.
    Refuse,
}

/// Most parts of a step: with more of them a step of the smallest sheet takes seconds, in which a run
/// cannot be stopped.
const MOST_PARTS: f64 = 1e4;

impl ChartKey {
    /// Checks the values for steps of `step` seconds.
    pub(crate) fn check(&self, step: f64, key: &Key, checks: &mut Checks) {
        let (Substep::Fixed(longest) | Substep::Adaptive { max: longest, .. }) = self.substep;
        if longest > 0.0 && step / longest > MOST_PARTS {
            let message =
                format!("parts of at most {longest:e} s are too many in a step of {step:e} s");
            let remedy =
                "choose longer parts or a shorter `method.step`, for at most 10000 parts in a step";
            checks.report(key.name("substep"), message, remedy);
        }
        match self.substep {
            Substep::Fixed(h) => checks.positive(key.name("substep.fixed"), h, Unit::Second),
            Substep::Adaptive {
                tolerance,
                min,
                max,
            } => {
                let key = key.name("substep.adaptive");
                checks.positive(key.name("tolerance"), tolerance, Unit::Joule);
                checks.positive(key.name("min"), min, Unit::Second);
                checks.positive(key.name("max"), max, Unit::Second);
                if min > max {
                    let message =
                        format!("the shortest part of {min} s is longer than the longest");
                    checks.report(key.name("min"), message, "give at most `max`");
                }
            }
        }
        let exact =
            self.equations == ChartEquations::Full && self.positions == ChartPositions::Exact;
        if self.scheme == ChartScheme::RungeKutta4 && !exact {
            let message = "the method of fourth order needs full equations and exact positions";
            let remedy = "choose `forward_euler`, or leave out `equations` and `positions`";
            checks.report(key.name("scheme"), message, remedy);
        }
    }

    /// The chart of a sheet that is held at some vertices, at positions `x` (`3V`, metres).
    ///
    /// # Errors
    /// [`ChartError`] if there is none at these positions.
    pub fn build(
        &self,
        sheet: &Sheet,
        pins: &[VertexId],
        x: &[f64],
    ) -> Result<Box<dyn Chart>, ChartError> {
        let degenerate = match self.coordinates {
            Coordinates::Cartesian => {
                let system = RodSystem::new(sheet, pins)?;
                return Ok(Box::new(CartesianChart::new(system, Choice::Auto, x)?));
            }
            Coordinates::Front => Degenerate::Carry,
            Coordinates::FrontWithStraightCreases => Degenerate::Assign,
        };
        let options = AssignmentOptions {
            pins: pins.to_vec(),
            degenerate,
            ..AssignmentOptions::default()
        };
        Ok(Box::new(FrontChart::new(sheet, &options, x)?))
    }

    /// The options of the engine.
    pub fn options(&self) -> ChartOptions {
        ChartOptions {
            method: match self.scheme {
                ChartScheme::ForwardEuler => ChartMethod::ForwardEuler,
                ChartScheme::RungeKutta4 => ChartMethod::RungeKutta4,
            },
            equations: match self.equations {
                ChartEquations::Full => Equations::Full,
                ChartEquations::Reformed => Equations::Reformed,
                ChartEquations::Published => Equations::Published,
            },
            position: match self.positions {
                ChartPositions::Exact => PositionUpdate::Exact,
                ChartPositions::Projected => PositionUpdate::Projected,
                ChartPositions::Linear => PositionUpdate::Linear,
            },
            control: match self.substep {
                Substep::Fixed(h) => ChartStepControl::Fixed(h),
                Substep::Adaptive {
                    tolerance,
                    min,
                    max,
                } => ChartStepControl::Adaptive {
                    tolerance,
                    min,
                    max,
                },
            },
            solver: match self.solver {
                ChartSolver::Sparse => MassSolverKind::Saddle,
                ChartSolver::DenseLu => MassSolverKind::DenseLu,
                ChartSolver::Cramer => MassSolverKind::Cramer,
            },
            rebase: match self.singular {
                NearSingularity::Rebase => Rebase::WhenNeeded,
                NearSingularity::Refuse => Rebase::Never,
            },
            ..ChartOptions::default()
        }
    }
}
