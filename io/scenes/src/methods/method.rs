//! How the motion is computed.

use crate::methods::chart::ChartKey;
use crate::methods::integration::Integration;
use crate::words::key::Key;
use crate::words::part::Part;
use crate::words::problem::Checks;
use crate::words::unit::Unit;
use isosheet_dynamics as engine;
use isosheet_dynamics::{EnergyMomentumOptions, ImplicitOptions, RattleOptions};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Integrator, step and tolerances.
///
/// ```toml
/// [method]
/// integrator = "implicit_euler"
/// step = 0.005
/// fallback = "implicit_euler"
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(default, deny_unknown_fields)]
#[checked]
pub struct MethodKey {
    /// The integrator.
    pub integrator: Integrator,
    /// Length of a step, seconds; the longest one where an accuracy is asked for.
    pub step: f64,
    /// Largest estimated error that a part of a step may add to the positions, metres, as the root of the
    /// mean square over the vertices, with `bdf2` and `implicit_euler`: steps are divided until it is met,
    /// down to `min_fraction`. If left out, steps are as long as `step` says. See "The length of a step" in
    /// the chapter on methods.
    pub accuracy: Option<f64>,
    /// Largest relative length error of an accepted step, from 1e-15 to 0.01; by default the tolerance of the
    /// integrator (1e-12, or 2e-13 for conservative ones).
    pub strain_tolerance: Option<f64>,
    /// Most iterations of a step; by default the number of the integrator.
    pub max_iterations: Option<usize>,
    /// Stiffness of the rods against inertia on the way to a step, for `bdf2` and `implicit_euler`, from 1 to
    /// 1e8; if left out, 1e4. Sheets that are stiff in bending need more.
    pub rod_stiffness: Option<f64>,
    /// Smallest part of a step that is tried where whole steps are rejected, from 1e-12 to 1.
    pub min_fraction: f64,
    /// Most factorisations from one accepted part of a step to the next for sheets of rods with supports at
    /// two vertices or more: then a sheet whose rods block its motion is refused, as it locks. No other
    /// result depends on it.
    pub max_factorisations: usize,
    /// What to do when even that is rejected.
    pub fallback: FallbackKey,
    /// What to do when moving supports ask for more than the lengths allow.
    pub taut: Taut,
    /// How the motion is computed with `integrator = "chart"`.
    pub chart: Option<ChartKey>,
}

/// The integrator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum Integrator {
    /// The second-order backward differentiation formula: lightly damped, takes any state, contact and
    /// isometry.
    #[default]
    Bdf2,
    /// First order, strongly damped, takes any state, contact and isometry.
    ImplicitEuler,
    /// No motion: each step ends at an equilibrium under the loads and supports of its end, with any contact
    /// and isometry, but without wind.
    Static,
    /// Second order, conserves energy and momenta; rods without contact.
    EnergyMomentum,
    /// Second order, symplectic; rods without contact.
    Rattle,
    /// Fourth order, symplectic; rods without contact.
    RattleComposition,
    /// Hamilton's equations in system coordinates, see `method.chart`; rods, no contact, not from a flat
    /// state.
    Chart,
}

/// What to do when even the smallest part of a step is rejected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum FallbackKey {
    /// End the run with an error.
    #[default]
    Refuse,
    /// Take the step with implicit Euler, and carry on.
    ImplicitEuler,
}

/// What to do when moving supports ask for more than the lengths allow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(rename_all = "snake_case")]
pub enum Taut {
    /// End the run with an error.
    #[default]
    Refuse,
    /// End the run at the taut state, complete.
    Stop,
}

/// Step of the default, seconds: that of common displays.
const STEP: f64 = 1.0 / 60.0;

impl Default for MethodKey {
    fn default() -> Self {
        Self {
            integrator: Integrator::default(),
            step: STEP,
            accuracy: None,
            strain_tolerance: None,
            max_iterations: None,
            rod_stiffness: None,
            min_fraction: engine::StepControl::default().min_fraction,
            max_factorisations: engine::StepControl::default().max_factorisations,
            fallback: FallbackKey::default(),
            taut: Taut::default(),
            chart: None,
        }
    }
}

impl Integrator {
    /// Whether steps are minima of an incremental potential: then contact and elastic sheets have a place.
    pub(crate) fn is_minimising(self) -> bool {
        matches!(self, Self::Bdf2 | Self::ImplicitEuler | Self::Static)
    }
}

impl MethodKey {
    pub(crate) fn check(&self, key: &Key, checks: &mut Checks) {
        checks.positive(key.name("step"), self.step, Unit::Second);
        checks.within(key.name("min_fraction"), self.min_fraction, [1e-12, 1.0]);
        if let Some(accuracy) = self.accuracy {
            checks.positive(key.name("accuracy"), accuracy, Unit::Metre);
            if !self.integrator.is_minimising() || self.integrator == Integrator::Static {
                checks.report(
                    key.name("accuracy"),
                    "this integrator does not estimate the errors of its steps",
                    "leave the key out, or choose `bdf2` or `implicit_euler`",
                );
            }
        }
        checks.within(
            key.name("strain_tolerance"),
            self.strain_tolerance,
            [1e-15, 1e-2],
        );
        checks.count(key.name("max_factorisations"), self.max_factorisations, 1);
        if let Some(iterations) = self.max_iterations {
            checks.count(key.name("max_iterations"), iterations, 1);
        }
        if let Some(stiffness) = self.rod_stiffness {
            checks.within(key.name("rod_stiffness"), stiffness, [1.0, 1e8]);
            if !self.integrator.is_minimising() {
                checks.report(
                    key.name("rod_stiffness"),
                    "this integrator has no stiffness of rods",
                    "leave the key out, or choose `bdf2` or `implicit_euler`",
                );
            }
        }
        self.check_chart(key, checks);
    }

    /// Keys that a chart has and others have not, and the other way round.
    fn check_chart(&self, key: &Key, checks: &mut Checks) {
        if self.integrator != Integrator::Chart {
            if self.chart.is_some() {
                let message = "this integrator has no chart";
                let remedy = "leave the table out, or choose `integrator = \"chart\"`";
                checks.report(key.name("chart"), message, remedy);
            }
            return;
        }
        if let Some(chart) = &self.chart {
            chart.check(self.step, &key.name("chart"), checks);
        }
        let usual = Self::default();
        let given = [
            ("strain_tolerance", self.strain_tolerance.is_some()),
            ("max_iterations", self.max_iterations.is_some()),
            ("min_fraction", self.min_fraction != usual.min_fraction),
            (
                "max_factorisations",
                self.max_factorisations != usual.max_factorisations,
            ),
            ("fallback", self.fallback != usual.fallback),
            ("taut", self.taut != usual.taut),
        ];
        for (name, _) in given.iter().filter(|(_, given)| *given) {
            let message = format!("a chart has no `{name}`");
            let remedy = "leave the key out; `method.chart` has the keys of a chart";
            checks.report(key.name(name), message, remedy);
        }
    }

    fn implicit(&self) -> ImplicitOptions {
        let usual = ImplicitOptions::default();
        ImplicitOptions {
            stiffness: self.rod_stiffness.unwrap_or(usual.stiffness),
            strain_tolerance: self.strain_tolerance.unwrap_or(usual.strain_tolerance),
            max_iterations: self.max_iterations.unwrap_or(usual.max_iterations),
            ..usual
        }
    }

    fn rattle(&self) -> RattleOptions {
        let usual = RattleOptions::default();
        RattleOptions {
            strain_tolerance: self.strain_tolerance.unwrap_or(usual.strain_tolerance),
            max_iterations: self.max_iterations.unwrap_or(usual.max_iterations),
        }
    }

    /// The integrator with its options.
    pub(crate) fn build(&self) -> Integration {
        let method = match self.integrator {
            Integrator::Chart => {
                return Integration::InChart(self.chart.clone().unwrap_or_default());
            }
            Integrator::Bdf2 => engine::Method::Bdf2(self.implicit()),
            Integrator::ImplicitEuler => engine::Method::ImplicitEuler(self.implicit()),
            Integrator::Static => engine::Method::Equilibrium(self.implicit()),
            Integrator::EnergyMomentum => {
                let usual = EnergyMomentumOptions::default();
                engine::Method::EnergyMomentum(EnergyMomentumOptions {
                    strain_tolerance: self.strain_tolerance.unwrap_or(usual.strain_tolerance),
                    max_iterations: self.max_iterations.unwrap_or(usual.max_iterations),
                    ..usual
                })
            }
            Integrator::Rattle => engine::Method::Rattle(self.rattle()),
            Integrator::RattleComposition => engine::Method::RattleComposition(self.rattle()),
        };
        Integration::Free {
            method,
            control: self.control(),
        }
    }

    /// What happens to rejected steps.
    fn control(&self) -> engine::StepControl {
        engine::StepControl {
            accuracy: self.accuracy,
            min_fraction: self.min_fraction,
            max_factorisations: self.max_factorisations,
            fallback: match self.fallback {
                FallbackKey::Refuse => engine::Fallback::Refuse,
                FallbackKey::ImplicitEuler => {
                    engine::Fallback::ImplicitEuler(ImplicitOptions::default())
                }
            },
            unsatisfiable: match self.taut {
                Taut::Refuse => engine::Unsatisfiable::Refuse,
                Taut::Stop => engine::Unsatisfiable::StopTaut,
            },
        }
    }
}
