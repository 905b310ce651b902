//! The methods that are compared.

use super::problem::Problem;
use crate::cost::DEFAULT;
use anyhow::Result;
use isosheet_coords::assignment::Degenerate;
use isosheet_coords::{
    AssignmentOptions, CartesianChart, Chart, ChartError, Choice, FrontChart, RodSystem,
};
use isosheet_dynamics::chart::{
    ChartMethod, ChartOptions, ChartStepControl, Equations, MassSolverKind, PositionUpdate, Rebase,
};
use isosheet_dynamics::{Method, Simulation, SimulationError};
use isosheet_tests::{conservative, damped, energy_momentum, rattle_composition};

/// A method, with everything but its step.
#[derive(Clone, Debug)]
pub(crate) struct Scheme {
    /// Name for people and files; unique.
    pub(crate) name: String,
    pub(crate) kind: Kind,
}

/// What kind of method.
#[derive(Clone, Debug)]
pub(crate) enum Kind {
    /// Without a chart.
    Free(Method),
    /// In a chart: the full equations of motion with exact positions, or the scheme of Liu, Tang and Joneja
    /// 2007, forward Euler with momenta carried over and positions to first order.
    Chart {
        chart: ChartKind,
        degenerate: Degenerate,
        /// Options with everything but the step control.
        options: ChartOptions,
        stepping: Stepping,
    },
}

/// How the published scheme chooses its steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stepping {
    /// As published: the largest step that changes the Hamiltonian by less than a tolerance.
    Adaptive,
    /// All alike.
    Fixed,
}

/// Which coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChartKind {
    Front,
    Cartesian,
}

/// How fine a run is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fineness {
    /// Fixed steps of so many seconds.
    Step(f64),
    /// Steps that change the Hamiltonian by less than so many joules.
    Tolerance(f64),
}

/// Why a run could not start, which is a result.
#[derive(Debug, thiserror::Error)]
pub(crate) enum StartError {
    #[error(transparent)]
    Chart(#[from] ChartError),
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

/// Largest number of coordinates for which the paper's scheme uses Cramer's rule, as published; beyond, dense
/// LU.
const CRAMER: usize = 16;

/// Most steps of the paper's scheme between two checkpoints, a second or so. The finest runs that finish take
/// some 10^4.
const CRAWL: usize = 1 << 17;

/// The same with more coordinates than [`CRAMER`].
const LARGE_CRAWL: usize = 1 << 14;

/// Methods that take any state, flat ones included.
pub(crate) const ROBUST: [&str; 3] = ["implicit Euler", DEFAULT, "projection"];

/// Whether a name is that of a variant of the paper's scheme.
pub(crate) fn is_paper(name: &str) -> bool {
    name.starts_with("published scheme")
}

impl Scheme {
    fn free(name: &str, method: Method) -> Self {
        Self {
            name: name.into(),
            kind: Kind::Free(method),
        }
    }

    /// The fourth-order composition of RATTLE, by which references are computed.
    pub(crate) fn reference() -> Self {
        Self::free("RATTLE composition", rattle_composition())
    }

    /// The energy-momentum method, the second opinion on references where charts end.
    pub(crate) fn energy_momentum() -> Self {
        Self::free("energy-momentum", energy_momentum())
    }

    /// Runge-Kutta in a chart, the second opinion on references.
    pub(crate) fn runge_kutta() -> Self {
        chart(ChartKind::Cartesian, ChartMethod::RungeKutta4)
    }

    /// All methods: chart-free ones, the published scheme, and every method in every chart.
    pub(crate) fn all() -> Vec<Self> {
        let [_, euler, projection] = damped();
        let mut all: Vec<Self> = [euler, (DEFAULT, Method::default()), projection]
            .into_iter()
            .chain(conservative())
            .map(|(name, method)| Self::free(name, method))
            .collect();
        let creases = "published scheme, free creases";
        let fixed = "published scheme, free creases, fixed steps";
        all.extend([
            paper("published scheme", Degenerate::Carry, Stepping::Adaptive),
            paper(creases, Degenerate::Assign, Stepping::Adaptive),
            paper(fixed, Degenerate::Assign, Stepping::Fixed),
        ]);
        for (kind, _) in CHARTS {
            all.extend(METHODS.map(|(method, _)| chart(kind, method)));
        }
        all
    }

    /// Whether the method adapts its steps to a tolerance.
    pub(crate) fn is_adaptive(&self) -> bool {
        matches!(self.kind, Kind::Chart { stepping, .. } if stepping == Stepping::Adaptive)
    }

    /// Whether the method, asked to go on for some time, takes fixed steps of its own on the way.
    pub(crate) fn steps_itself(&self) -> bool {
        matches!(self.kind, Kind::Chart { stepping, .. } if stepping == Stepping::Fixed)
    }

    /// The problem at its start. The inner error is that of the method.
    pub(crate) fn start(
        &self,
        problem: Problem,
        fineness: Fineness,
    ) -> Result<Result<Simulation, StartError>> {
        let state = problem.start()?;
        let (chart, degenerate, mut options) = match &self.kind {
            Kind::Free(method) => {
                return Ok(problem.simulation(method, state)?.map_err(Into::into));
            }
            Kind::Chart {
                chart,
                degenerate,
                options,
                ..
            } => (*chart, *degenerate, *options),
        };
        options.control = match fineness {
            Fineness::Step(h) => ChartStepControl::Fixed(h),
            Fineness::Tolerance(tolerance) => ChartStepControl::Adaptive {
                tolerance,
                // A two-hundredth of the paper's smallest.
                min: 1e-6,
                // The paper's largest step.
                max: 0.25,
            },
        };
        if is_paper(&self.name) && freedoms(problem)? > CRAMER {
            (options.solver, options.max_steps) = (MassSolverKind::DenseLu, LARGE_CRAWL);
        }
        let model = problem.model()?;
        Ok(
            build(problem, chart, degenerate, &state.x)?.and_then(|chart| {
                Simulation::in_chart(model, state, chart, options).map_err(Into::into)
            }),
        )
    }
}

fn freedoms(problem: Problem) -> Result<usize> {
    Ok(RodSystem::new(&problem.sheet()?, &problem.pins())?.dof())
}

fn build(
    problem: Problem,
    kind: ChartKind,
    degenerate: Degenerate,
    x: &[f64],
) -> Result<Result<Box<dyn Chart>, StartError>> {
    let (sheet, pins) = (problem.sheet()?, problem.pins());
    let chart: Result<Box<dyn Chart>, ChartError> = match kind {
        ChartKind::Cartesian => {
            let system = RodSystem::new(&sheet, &pins)?;
            CartesianChart::new(system, Choice::Auto, x).map(|c| Box::new(c) as _)
        }
        ChartKind::Front => {
            let options = AssignmentOptions {
                pins,
                degenerate,
                ..Default::default()
            };
            FrontChart::new(&sheet, &options, x).map(|c| Box::new(c) as _)
        }
    };
    Ok(chart.map_err(Into::into))
}

/// The scheme as published.
fn paper(name: &str, degenerate: Degenerate, stepping: Stepping) -> Scheme {
    let options = ChartOptions {
        method: ChartMethod::ForwardEuler,
        equations: Equations::Published,
        position: PositionUpdate::Linear,
        solver: MassSolverKind::Cramer,
        rebase: Rebase::Never,
        max_steps: CRAWL,
        ..ChartOptions::default()
    };
    Scheme {
        name: name.into(),
        kind: Kind::Chart {
            chart: ChartKind::Front,
            degenerate,
            options,
            stepping,
        },
    }
}

/// The charts and methods with their names. Velocities follow from momenta by the sparse saddle-point system;
/// other solvers are timed by `cargo bench`.
const CHARTS: [(ChartKind, &str); 2] = [
    (ChartKind::Cartesian, "Cartesian chart"),
    (ChartKind::Front, "front chart"),
];
const METHODS: [(ChartMethod, &str); 2] = [
    (ChartMethod::RungeKutta4, "Runge-Kutta 4"),
    (ChartMethod::ForwardEuler, "forward Euler"),
];
/// The name of something that has one.
fn named<T: PartialEq>(all: &[(T, &'static str)], one: &T) -> &'static str {
    let found = all.iter().find(|(other, _)| other == one);
    found.map_or("", |(_, name)| name)
}

fn chart(chart: ChartKind, method: ChartMethod) -> Scheme {
    let (steps, coordinates) = (named(&METHODS, &method), named(&CHARTS, &chart));
    Scheme {
        name: format!("{steps}, {coordinates}"),
        kind: Kind::Chart {
            chart,
            degenerate: Degenerate::Assign,
            options: ChartOptions {
                method,
                solver: MassSolverKind::Saddle,
                ..ChartOptions::default()
            },
            stepping: Stepping::Fixed,
        },
    }
}
