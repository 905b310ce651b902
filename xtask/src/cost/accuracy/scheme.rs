//! The methods that are compared.

use super::problem::Setup;
use crate::cost::DEFAULT;
use crate::draw::{Colour, Marker, palette};
use anyhow::Result;
use isosheet_dynamics::chart::MassSolverKind;
use isosheet_dynamics::{Method, Simulation};
use isosheet_io::scene::{
    Chart, ChartEquations, ChartPositions, ChartScheme, ChartSolver, Coordinates, NearSingularity,
    Substep,
};
use isosheet_mesh::Sheet;
use isosheet_tests::{conservative, damped};

/// A method, with everything but its step.
#[derive(Clone, Debug)]
pub(super) struct Scheme {
    /// Name for people and files; unique.
    pub(super) name: &'static str,
    pub(super) kind: Kind,
    /// How it is drawn, if it is: of those in charts, those in one chart only.
    pub(super) look: Option<(Colour, Marker)>,
}

/// What kind of method.
#[derive(Clone, Debug)]
pub(super) enum Kind {
    /// Without a chart.
    Free(Method),
    /// In a chart, in steps that are all alike.
    Fixed(Chart),
    /// In a chart, in the longest steps that change the Hamiltonian by less than a tolerance, as published.
    Adaptive(Chart),
}

/// Largest number of coordinates for which the paper's scheme uses Cramer's rule, as published; beyond, dense
/// LU.
const CRAMER: usize = 16;

/// Most steps in a chart between two checkpoints, a second or so of the paper's scheme. The finest runs that
/// finish take some 10^4.
const CRAWL: usize = 1 << 17;

/// The same of the paper's scheme with more coordinates than [`CRAMER`].
const LARGE_CRAWL: usize = 1 << 14;

/// Methods that take any state, flat ones included.
pub(super) const ROBUST: [&str; 3] = ["implicit Euler", DEFAULT, "projection"];

/// The method by which references are computed, of fourth order.
pub(super) const REFERENCE: &str = "RATTLE composition";

/// The second opinion on references, and that where charts end.
pub(super) const RUNGE_KUTTA: &str = "Runge-Kutta 4, Cartesian chart";
pub(super) const ENERGY_MOMENTUM: &str = "energy-momentum";

impl Scheme {
    /// One of the methods.
    ///
    /// # Panics
    /// If there is none of that name.
    pub(super) fn named(name: &str) -> Self {
        let mut all = Self::all().into_iter();
        all.find(|scheme| scheme.name == name).expect(name)
    }

    /// All methods: chart-free ones, the published scheme, and every method in every chart. Velocities in
    /// charts follow from momenta by the sparse saddle-point system; other solvers are timed by `cargo
    /// bench`.
    pub(super) fn all() -> Vec<Self> {
        let [_, euler, projection] = damped();
        let [momentum, rattle, composition] = conservative();
        let default = (DEFAULT, Method::default());
        let free = [euler, default, projection, momentum, rattle, composition];
        let chart = |coordinates, scheme| Chart {
            coordinates,
            scheme,
            ..Chart::default()
        };
        let published = |coordinates| Chart {
            equations: ChartEquations::Published,
            positions: ChartPositions::Linear,
            solver: ChartSolver::Cramer,
            singular: NearSingularity::Refuse,
            ..chart(coordinates, ChartScheme::ForwardEuler)
        };
        let (cartesian, front) = (
            Coordinates::Cartesian,
            Coordinates::FrontWithStraightCreases,
        );
        let [euler, runge_kutta] = [ChartScheme::ForwardEuler, ChartScheme::RungeKutta4];
        let in_charts = [
            (
                "published scheme",
                Kind::Adaptive(published(Coordinates::Front)),
            ),
            (
                "published scheme, free creases",
                Kind::Adaptive(published(front)),
            ),
            (
                "published scheme, free creases, fixed steps",
                Kind::Fixed(published(front)),
            ),
            (RUNGE_KUTTA, Kind::Fixed(chart(cartesian, runge_kutta))),
            (
                "forward Euler, Cartesian chart",
                Kind::Fixed(chart(cartesian, euler)),
            ),
            (
                "Runge-Kutta 4, front chart",
                Kind::Fixed(chart(front, runge_kutta)),
            ),
            (
                "forward Euler, front chart",
                Kind::Fixed(chart(front, euler)),
            ),
        ];
        let free = free.map(|(name, method)| (name, Kind::Free(method)));
        let mut looks = LOOKS.into_iter();
        let all = free.into_iter().chain(in_charts);
        let drawn = all.map(|(name, kind)| Self {
            name,
            kind,
            look: looks.next(),
        });
        drawn.collect()
    }

    /// The problem at its start, in steps of `fineness` seconds, or of methods that adapt them, which change
    /// the Hamiltonian by less than so many joules.
    ///
    /// # Errors
    /// A start that the method refuses.
    pub(super) fn start(&self, setup: Setup, fineness: f64) -> Result<Simulation> {
        let (settings, substep) = match &self.kind {
            Kind::Free(method @ (Method::Bdf2(_) | Method::ImplicitEuler(_))) => {
                let run = Simulation::new(setup.model, setup.state, method.clone())?;
                return Ok(match setup.contacts {
                    Some(contacts) => run.with_contact(contacts)?,
                    None => run,
                });
            }
            Kind::Free(method) => {
                let (model, state) = setup.with_barrier()?;
                return Ok(Simulation::new(model, state, method.clone())?);
            }
            Kind::Fixed(settings) => (settings, Substep::Fixed(fineness)),
            Kind::Adaptive(settings) => {
                let substep = Substep::Adaptive {
                    tolerance: fineness,
                    // A two-hundredth of the paper's smallest.
                    min: 1e-6,
                    // The paper's largest step.
                    max: 0.25,
                };
                (settings, substep)
            }
        };
        let (model, state) = setup.with_barrier()?;
        let sheet = Sheet::from_topology(model.topology().clone(), state.x.clone())?;
        let settings = Chart {
            substep,
            ..settings.clone()
        };
        let chart = settings.build(&sheet, &model.pins(), &state.x)?;
        let mut options = settings.options();
        options.max_steps = CRAWL;
        if settings.solver == ChartSolver::Cramer && chart.dimension() > CRAMER {
            (options.solver, options.max_steps) = (MassSolverKind::DenseLu, LARGE_CRAWL);
        }
        Ok(Simulation::in_chart(model, state, chart, options)?)
    }
}

/// How the first of the methods are drawn, in their order.
const LOOKS: [(Colour, Marker); 11] = [
    (palette::SKY, Marker::Disc),
    (palette::BLUE, Marker::Disc),
    (palette::GREEN, Marker::Square),
    (palette::ORANGE, Marker::Triangle),
    (palette::VERMILION, Marker::Diamond),
    (palette::PURPLE, Marker::Diamond),
    (palette::BLACK, Marker::Square),
    (palette::GREY, Marker::Square),
    (palette::BLACK, Marker::Diamond),
    (palette::INK, Marker::Triangle),
    (palette::GREY, Marker::Diamond),
];

#[cfg(test)]
mod tests {
    use super::super::problem::Problem;
    use super::*;

    /// Contact as such where the default has a place for it, elsewhere as a potential.
    #[test]
    fn starts_fit_their_models() {
        for (problem, name, _) in Problem::ALL {
            let [damped, free] = [DEFAULT, REFERENCE].map(|scheme| {
                let start = Scheme::named(scheme).start(problem.setup().unwrap(), 1e-3);
                start.unwrap_or_else(|e| panic!("{name}, {scheme}: {e}"))
            });
            let touches = matches!(problem, Problem::Cloth(_));
            assert_eq!(damped.contacts().is_some(), touches, "{name}");
            assert!(free.contacts().is_none(), "{name}");
        }
    }
}
