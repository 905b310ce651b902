//! Options of the integration in a chart.

use super::{ChartDynamicsError, Equations, MassSolverKind};
use serde::{Deserialize, Serialize};

/// Time integration method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ChartMethod {
    /// Forward Euler, Eq. 20; first order, gains energy.
    #[default]
    ForwardEuler,
    /// The classical Runge-Kutta method of fourth order. Needs [`Equations::Full`] and
    /// [`PositionUpdate::Exact`].
    RungeKutta4,
}

/// How positions follow from the step of the coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PositionUpdate {
    /// To first order, `x + h J qdot` (Eq. 15): edge lengths drift.
    Linear,
    /// Through the chart, with exact edge lengths.
    #[default]
    Exact,
    /// To first order, then projected onto the edge lengths by Newton's method with the
    /// saddle-point matrix (the smallest correction in the mass metric).
    Projected,
}

/// Choice of the time step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ChartStepControl {
    /// A constant step, seconds.
    Fixed(f64),
    /// Sec. 4.2: the largest step that changes the Hamiltonian by less than a tolerance.
    ///
    /// The error of a step grows with its square, so that a rejected step is shortened by the
    /// square root of tolerance over change, and after an accepted one the next is lengthened by it,
    /// at most twofold. The square is that of the remainder of the Taylor series (Eq. 23), which the
    /// paper bounds by the change of the Hamiltonian (Eq. 24).
    Adaptive {
        /// Bound on `|H(t + h) - H(t)|`, joules.
        tolerance: f64,
        /// Smallest step, seconds; below it the run is refused.
        min: f64,
        /// Largest step, seconds.
        max: f64,
    },
}

/// What to do when the chart approaches a singularity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Rebase {
    /// Take the current state as new reference and form the momenta anew from the velocities.
    #[default]
    WhenNeeded,
    /// Return an error.
    Never,
}

/// Options of a [`ChartSimulation`](super::ChartSimulation).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChartOptions {
    /// Method, default forward Euler.
    pub method: ChartMethod,
    /// Equations of motion, default full.
    pub equations: Equations,
    /// Position update, default exact.
    pub position: PositionUpdate,
    /// Step control, default fixed 1 ms.
    pub control: ChartStepControl,
    /// Mass-matrix solver, default sparse saddle point.
    pub solver: MassSolverKind,
    /// Rebasing, default when needed.
    pub rebase: Rebase,
    /// Largest condition number of C, default 1e12: four digits of a dense solve are left there, and
    /// an explicit method needs about as many.
    pub condition_limit: f64,
    /// Steps between condition estimates, default 50. The first step is always checked.
    pub condition_interval: u32,
    /// Growth of the largest eigenvalue of C since the chart's reference state above which the
    /// chart is rebased, default 4: J is about twice as large then, well before a
    /// singularity of the chart. Tracked by one power iteration per step.
    pub growth_limit: f64,
    /// Chart margin ([`Chart::margin`](isosheet_coords::Chart::margin)) below which the chart is rebased,
    /// default 0.1.
    pub margin_limit: f64,
    /// Largest edge strain of the initial state, default 1e-6.
    pub strain_limit: f64,
    /// Edge strain at which a run is given up as diverged, default 0.5. Only the linear position update
    /// ever strains edges.
    pub failure_strain: f64,
    /// Most steps, rejected ones included, in one call of
    /// [`Simulation::step`](isosheet_dynamics::Simulation::step), default 2^20: a step control that crawls
    /// along a singularity ends with an error instead of taking hours.
    pub max_steps: usize,
}

impl ChartStepControl {
    fn validate(self) -> Result<(), ChartDynamicsError> {
        const REMEDY: &str = "give a positive step in seconds";
        match self {
            Self::Fixed(h) => positive("fixed step", h, REMEDY),
            Self::Adaptive {
                tolerance,
                min,
                max,
            } => {
                positive(
                    "energy tolerance",
                    tolerance,
                    "give a positive energy in joules",
                )?;
                positive("smallest step", min, REMEDY)?;
                positive("largest step", max, REMEDY)?;
                if min > max {
                    return Err(ChartDynamicsError::Option {
                        option: "smallest step",
                        value: min,
                        remedy: "give a value below the largest step",
                    });
                }
                Ok(())
            }
        }
    }
}

/// Refuses a value that is not positive and finite.
fn positive(
    option: &'static str,
    value: f64,
    remedy: &'static str,
) -> Result<(), ChartDynamicsError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(ChartDynamicsError::Option {
            option,
            value,
            remedy,
        })
    }
}

impl Default for ChartOptions {
    fn default() -> Self {
        Self {
            method: ChartMethod::default(),
            equations: Equations::default(),
            position: PositionUpdate::default(),
            control: ChartStepControl::Fixed(1e-3),
            solver: MassSolverKind::default(),
            rebase: Rebase::default(),
            condition_limit: 1e12,
            condition_interval: 50,
            growth_limit: 4.0,
            margin_limit: 0.1,
            strain_limit: 1e-6,
            failure_strain: 0.5,
            max_steps: 1 << 20,
        }
    }
}

impl ChartOptions {
    /// Check ranges and combinations.
    ///
    /// # Errors
    /// [`ChartDynamicsError::Option`], [`ChartDynamicsError::Combination`].
    pub fn validate(&self) -> Result<(), ChartDynamicsError> {
        self.control.validate()?;
        positive(
            "condition limit",
            self.condition_limit,
            "give a number above 1",
        )?;
        positive("strain limit", self.strain_limit, "give a positive strain")?;
        positive(
            "failure strain",
            self.failure_strain,
            "give a positive strain",
        )?;
        positive(
            "growth limit",
            self.growth_limit - 1.0,
            "give a number above 1",
        )?;
        let interval = f64::from(self.condition_interval);
        positive(
            "condition interval",
            interval,
            "check at least every so many steps",
        )?;
        positive("most steps", self.max_steps as f64, "allow at least one")?;
        if !(0.0..1.0).contains(&self.margin_limit) {
            return Err(ChartDynamicsError::Option {
                option: "margin limit",
                value: self.margin_limit,
                remedy: "give a value from 0 to below 1",
            });
        }
        if self.method == ChartMethod::RungeKutta4
            && (self.equations != Equations::Full || self.position != PositionUpdate::Exact)
        {
            return Err(ChartDynamicsError::Combination {
                method: "the fourth-order Runge-Kutta method",
                needs: "the full equations of motion and exact positions",
            });
        }
        Ok(())
    }
}
