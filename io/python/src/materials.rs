//! The catalogue of materials.

use isosheet_dynamics::Material;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The materials that scenes know by name.
///
/// A dictionary from the name, as in ``{"sheet": {"material": "office paper"}}``, to a dictionary with
/// ``density`` (kg/m2), ``stiffness`` (membrane stiffness, N/m), ``rigidity`` (flexural rigidity, N m),
/// ``poisson``, ``strain_limit``, ``form`` and ``source``.
#[pyfunction]
pub(crate) fn materials(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let all = PyDict::new(py);
    for entry in Material::catalogue() {
        let one = PyDict::new(py);
        for (name, value) in [
            ("density", entry.material.density),
            ("stiffness", entry.material.stiffness),
            ("rigidity", entry.material.rigidity),
            ("poisson", entry.material.poisson),
            ("strain_limit", entry.material.strain_limit),
        ] {
            one.set_item(name, value)?;
        }
        one.set_item("form", entry.form)?;
        one.set_item("source", entry.source)?;
        all.set_item(entry.name, one)?;
    }
    Ok(all)
}
