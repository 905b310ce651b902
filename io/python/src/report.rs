//! What a step reports.

use crate::value::{Remade, remade};
use isosheet_dynamics as dynamics;
use isosheet_dynamics::StepOutcome;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A class with the values of a report of the engine.
macro_rules! values_of {
    (
        $(#[$of_class:meta])*
        $class:ident of $report:ident: $reported:ty {
            $($(#[$of_value:meta])* $name:ident: $kind:ty = $value:expr;)*
        }
    ) => {
        $(#[$of_class])*
        #[pyclass(frozen, get_all, module = "isosheet")]
        pub(crate) struct $class {
            $($(#[$of_value])* $name: $kind,)*
        }

        impl $class {
            /// The names of its values.
            const NAMES: &[&str] = &[$(stringify!($name)),*];

            /// The report of values by their names.
            fn of(values: &Bound<'_, PyDict>) -> PyResult<Self> {
                Ok(Self { $($name: value(values, stringify!($name))?),* })
            }
        }

        impl From<$reported> for $class {
            fn from($report: $reported) -> Self {
                Self { $($name: $value),* }
            }
        }
    };
}

values_of! {
    /// What a step reports; energies in joules, lengths in metres, times in seconds.
    ///
    ///     >>> report = isosheet.Simulation(isosheet.Scene.new("hanging")).step()
    ///     >>> report.total == report.kinetic + report.potential
    ///     True
    StepReport of report: dynamics::StepReport {
        /// Time at the end of the step.
        time: f64 = report.t;
        /// Length of the step.
        h: f64 = report.h;
        /// Accepted sub-steps.
        substeps: usize = report.substeps;
        /// Rejected sub-steps.
        rejected: usize = report.rejected;
        /// Newton iterations.
        iterations: usize = report.iterations;
        /// Matrix factorisations.
        factorisations: usize = report.factorisations;
        /// The largest estimated error that a sub-step added to the positions, metres, the root of the mean
        /// square over the vertices; None for methods without an estimate.
        error: Option<f64> = report.error;
        /// The lowest frequency of small vibrations about the equilibrium of `integrator = "static"`, hertz;
        /// None where the sheet can move without a force, and for other methods.
        lowest_frequency: Option<f64> = report.lowest_frequency;
        /// Largest relative residual of the sub-steps.
        residual: f64 = report.residual;
        /// Kinetic energy at the end.
        kinetic: f64 = report.kinetic;
        /// Potential energy at the end, contact included.
        potential: f64 = report.potential;
        /// Work since the start of forces, air, moving bodies and supports, and of changes of the scene.
        work: f64 = report.work;
        /// Energy that damping has taken since the start.
        dissipated: f64 = report.dissipated;
        /// Energy lost to friction since the start.
        friction: f64 = report.friction;
        /// Energy that plastic bending has taken since the start.
        plastic: f64 = report.plastic;
        /// Error of the energy balance since the start.
        energy_drift: f64 = report.energy_drift;
        /// Largest relative error of an edge length at the end.
        strain: f64 = report.strain;
        /// Largest violation of the equations of isometry: of rods the strain, of elastic sheets zero.
        constrained_strain: f64 = report.constrained_strain;
        /// Smallest gap at the end; `None` without contact, infinite where nothing is close.
        gap: Option<f64> = report.gap;
        /// Largest distance of a vertex from its curve or surface; `None` without these.
        violation: Option<f64> = report.violation;
        /// The support that asks for more than the rods allow, where the step ended taut.
        taut: Option<String> = report.taut.as_ref().map(|t| t.by.to_string());
        /// What the hardest sub-step needed: "newton", "globalised", "`branch_seeded`", "fallback", "chart"
        /// or "rebased".
        path: String = path(report.outcome).to_owned();
    }
}

/// The name of an outcome.
fn path(outcome: StepOutcome) -> &'static str {
    match outcome {
        StepOutcome::Newton => "newton",
        StepOutcome::Globalised => "globalised",
        StepOutcome::BranchSeeded => "branch_seeded",
        StepOutcome::Fallback => "fallback",
        StepOutcome::Engine(word) => word,
    }
}

#[pymethods]
impl StepReport {
    /// Total energy.
    #[getter]
    fn total(&self) -> f64 {
        self.kinetic + self.potential
    }

    /// The report of the values that `to_dict` gives.
    #[staticmethod]
    fn _of(values: &Bound<'_, PyDict>) -> PyResult<Self> {
        Self::of(values)
    }

    /// For `pickle` and `copy`: all values.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Remade<'py>> {
        remade(slf, "_of", vec![Self::to_dict(slf)?.into_any()])
    }

    /// All values by name.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(slf.py());
        for name in Self::NAMES.iter().chain(&["total"]) {
            dict.set_item(name, slf.getattr(name)?)?;
        }
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        let Self {
            time,
            h,
            substeps,
            iterations,
            strain,
            path,
            ..
        } = self;
        format!(
            "<isosheet.StepReport time={time} h={h} substeps={substeps} iterations={iterations} \
             strain={strain:.1e} path={path}>"
        )
    }
}

/// One of the values of a report.
fn value<T>(values: &Bound<'_, PyDict>, name: &str) -> PyResult<T>
where
    T: for<'a, 'py> FromPyObject<'a, 'py, Error = PyErr>,
{
    let value = values.get_item(name)?;
    let value = value.ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
    value.extract()
}
