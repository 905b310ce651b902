//! What a step reports.

use crate::value::{Remade, remade};
use isosheet_io::dynamics::{self, StepOutcome};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What a step reports; energies in joules, lengths in metres, times in seconds.
#[pyclass(frozen, get_all, module = "isosheet")]
pub(crate) struct StepReport {
    /// Time at the end of the step.
    time: f64,
    /// Length of the step.
    h: f64,
    /// Accepted sub-steps.
    substeps: usize,
    /// Rejected sub-steps.
    rejected: usize,
    /// Newton iterations.
    iterations: usize,
    /// Matrix factorisations.
    factorisations: usize,
    /// Largest relative residual of the sub-steps.
    residual: f64,
    /// Kinetic energy at the end.
    kinetic: f64,
    /// Potential energy at the end, contact included.
    potential: f64,
    /// Work since the start of forces, air, moving bodies and supports, and of changes of the scene.
    work: f64,
    /// Energy that damping has taken since the start.
    dissipated: f64,
    /// Energy lost to friction since the start.
    friction: f64,
    /// Energy that plastic bending has taken since the start.
    plastic: f64,
    /// Error of the energy balance since the start.
    energy_drift: f64,
    /// Largest relative error of an edge length at the end.
    strain: f64,
    /// Largest violation of the equations of isometry: of rods the strain, of elastic sheets zero.
    constrained_strain: f64,
    /// Smallest gap at the end; `None` without contact, infinite where nothing is close.
    gap: Option<f64>,
    /// Largest distance of a vertex from its curve or surface; `None` without these.
    violation: Option<f64>,
    /// The support that asks for more than the rods allow, where the step ended taut.
    taut: Option<String>,
    /// What the hardest sub-step needed: "newton", "globalised", "`branch_seeded`", "fallback", "chart" or
    /// "rebased".
    path: String,
}

impl From<dynamics::StepReport> for StepReport {
    fn from(report: dynamics::StepReport) -> Self {
        Self {
            time: report.t,
            h: report.h,
            substeps: report.substeps,
            rejected: report.rejected,
            iterations: report.iterations,
            factorisations: report.factorisations,
            residual: report.residual,
            kinetic: report.kinetic,
            potential: report.potential,
            work: report.work,
            dissipated: report.dissipated,
            friction: report.friction,
            plastic: report.plastic,
            energy_drift: report.energy_drift,
            strain: report.strain,
            constrained_strain: report.constrained_strain,
            gap: report.gap,
            violation: report.violation,
            taut: report.taut.map(|t| t.by.to_string()),
            path: match report.outcome {
                StepOutcome::Newton => "newton",
                StepOutcome::Globalised => "globalised",
                StepOutcome::BranchSeeded => "branch_seeded",
                StepOutcome::Fallback => "fallback",
                StepOutcome::Chart => "chart",
                StepOutcome::Rebased => "rebased",
            }
            .to_owned(),
        }
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
        Ok(Self {
            time: value(values, "time")?,
            h: value(values, "h")?,
            substeps: value(values, "substeps")?,
            rejected: value(values, "rejected")?,
            iterations: value(values, "iterations")?,
            factorisations: value(values, "factorisations")?,
            residual: value(values, "residual")?,
            kinetic: value(values, "kinetic")?,
            potential: value(values, "potential")?,
            work: value(values, "work")?,
            dissipated: value(values, "dissipated")?,
            friction: value(values, "friction")?,
            plastic: value(values, "plastic")?,
            energy_drift: value(values, "energy_drift")?,
            strain: value(values, "strain")?,
            constrained_strain: value(values, "constrained_strain")?,
            gap: value(values, "gap")?,
            violation: value(values, "violation")?,
            taut: value(values, "taut")?,
            path: value(values, "path")?,
        })
    }

    /// For `pickle` and `copy`: all values.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Remade<'py>> {
        remade(slf, "_of", vec![Self::to_dict(slf)?.into_any()])
    }

    /// All values by name.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(slf.py());
        for name in NAMES {
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

/// The names of all values.
const NAMES: [&str; 21] = [
    "time",
    "h",
    "substeps",
    "rejected",
    "iterations",
    "factorisations",
    "residual",
    "kinetic",
    "potential",
    "total",
    "work",
    "dissipated",
    "friction",
    "plastic",
    "energy_drift",
    "strain",
    "constrained_strain",
    "gap",
    "violation",
    "taut",
    "path",
];
