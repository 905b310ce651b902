//! Meshes of other libraries, by their conventions: trimesh, meshio, pyvista.

use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;

/// Vertices and faces of a mesh of another library, as arrays. None of what is no mesh.
///
/// - `vertices` and `faces`: trimesh, and everything like it,
/// - `points` and `cells_dict["triangle"]`: meshio,
/// - `points`, `faces` and `is_all_triangles`: pyvista.
pub(crate) fn arrays<'py>(object: &Bound<'py, PyAny>) -> PyResult<Option<[Bound<'py, PyAny>; 2]>> {
    let py = object.py();
    let both = |vertices, faces: &str| -> PyResult<Option<[Bound<'py, PyAny>; 2]>> {
        match object.getattr_opt(vertices)? {
            Some(vertices) if object.hasattr(faces)? => {
                Ok(Some([vertices, object.getattr(faces)?]))
            }
            _ => Ok(None),
        }
    };
    if let Some(found) = both("vertices", "faces")? {
        return Ok(Some(found));
    }
    let Some(points) = object.getattr_opt(intern!(py, "points"))? else {
        return Ok(None);
    };
    if let Some(cells) = object.getattr_opt(intern!(py, "cells_dict"))? {
        for kind in cells.try_iter()? {
            let kind: String = kind?.extract()?;
            if !["triangle", "line", "vertex"].contains(&kind.as_str()) {
                let message =
                    format!("the mesh has cells of the kind \"{kind}\"; cut them into triangles");
                return Err(PyValueError::new_err(message));
            }
        }
        let Ok(triangles) = cells.get_item("triangle") else {
            return Err(PyValueError::new_err(
                "the mesh has no cells of the kind \"triangle\"",
            ));
        };
        return Ok(Some([points, triangles]));
    }
    if !object.hasattr(intern!(py, "is_all_triangles"))? {
        return Ok(None);
    }
    if !object
        .getattr(intern!(py, "is_all_triangles"))?
        .is_truthy()?
    {
        let message = "the mesh has other faces than triangles; take its `triangulate()`";
        return Err(PyValueError::new_err(message));
    }
    // Each face is the number 3 and its corners.
    let faces = object.getattr(intern!(py, "faces"))?;
    let rows = faces.call_method1(intern!(py, "reshape"), (-1, 4))?;
    let columns = py.import("builtins")?.getattr("slice")?;
    let (all, corners) = (columns.call1((py.None(),))?, columns.call1((1, 4))?);
    Ok(Some([points, rows.get_item((all, corners))?]))
}
