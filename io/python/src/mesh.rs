//! Meshes from arrays, generators and files.

use crate::arrays::{array, refuse_array, rows, vectors};
use crate::error::{of_scene, plain};
use crate::foreign;
use crate::value::table;
use isosheet_formats::{Series, SeriesOptions, Trajectory, write_frame};
use isosheet_mesh::Sheet;
use isosheet_scenes as scene;
use isosheet_scenes::{Key, Problem};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Vertices and faces.
type Arrays<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// A mesh of triangles, whose edges have their lengths here as rest lengths.
///
///     >>> isosheet.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).area
///     0.5
///
/// vertices: array of shape (V, 3), metres.
/// faces: array of whole numbers of shape (F, 3), the corners of each triangle, all counter-clockwise as seen
///     from the same side.
///
/// A mesh of trimesh, meshio or pyvista may be given alone: ``Mesh(trimesh.load("cloth.ply"))``; it is known
/// by its attributes. What these libraries make of one:
///
///     trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
///     meshio.Mesh(mesh.vertices, [("triangle", mesh.faces)])
///     pyvista.PolyData.from_regular_faces(mesh.vertices, mesh.faces)
///
/// A mesh, also one of these libraries, takes the place of a mesh in a scene:
/// ``Scene(sheet={"mesh": mesh, ...})``. Raises Error for what is no oriented surface.
#[pyclass(frozen, module = "isosheet")]
pub(crate) struct Mesh {
    sheet: Sheet,
}

impl Mesh {
    /// A mesh of Python as a scene has it.
    pub(crate) fn value_of(object: &Bound<'_, PyAny>) -> PyResult<Option<Value>> {
        if let Ok(mesh) = object.cast::<Self>() {
            return Ok(Some(mesh.get().as_value()));
        }
        match foreign::arrays(object)? {
            Some([vertices, faces]) => {
                let mesh = Self::of_arrays(&vertices, &faces)?;
                Ok(Some(mesh.as_value()))
            }
            None => Ok(None),
        }
    }

    /// The mesh as a scene has it.
    fn as_value(&self) -> Value {
        let vertices = self.sheet.positions().as_chunks::<3>().0;
        let vertex = |x: &[f64; 3]| Value::Array(x.iter().map(|&c| Value::Float(c)).collect());
        let face =
            |f: &[u32; 3]| Value::Array(f.iter().map(|&v| Value::Integer(v.into())).collect());
        let triangles = Table::from_iter([
            (
                "vertices".to_owned(),
                Value::Array(vertices.iter().map(vertex).collect()),
            ),
            (
                "faces".to_owned(),
                Value::Array(self.sheet.face_indices().iter().map(face).collect()),
            ),
        ]);
        Value::Table(Table::from_iter([(
            "triangles".to_owned(),
            Value::Table(triangles),
        )]))
    }

    fn of_arrays(vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = vertices.py();
        let numpy = py.import("numpy")?;
        refuse_array(vertices)?;
        refuse_array(faces)?;
        let vertices = numpy.call_method1("asarray", (vertices, "float64"))?;
        let given = numpy.call_method1("asarray", (faces,))?;
        // Whole numbers that are too large or negative are refused here, and parts of numbers are not cut
        // off.
        let kind: String = given.getattr("dtype")?.getattr("kind")?.extract()?;
        if !matches!(kind.as_str(), "i" | "u") {
            return Err(PyValueError::new_err(
                "faces have to be an array of whole numbers",
            ));
        }
        let faces = given.call_method1("astype", ("int64",))?;
        let vertices: PyReadonlyArray2<'_, f64> = vertices.extract()?;
        let faces: PyReadonlyArray2<'_, i64> = faces.extract()?;
        let (vertices, faces) = (vertices.as_array(), faces.as_array());
        if vertices.ncols() != 3 || faces.ncols() != 3 {
            let message = "vertices have to be of shape (V, 3), faces of shape (F, 3)";
            return Err(PyValueError::new_err(message));
        }
        let number = |v: &i64| {
            u32::try_from(*v)
                .map_err(|_| PyValueError::new_err(format!("no vertex has the number {v}")))
        };
        let faces = faces.iter().map(number).collect::<PyResult<Vec<u32>>>()?;
        let sheet = Sheet::new(vertices.iter().copied().collect(), faces.as_chunks::<3>().0);
        let sheet = sheet.map_err(|e| plain(py, &e))?;
        Ok(Self { sheet })
    }

    fn of(py: Python<'_>, mesh: &scene::Mesh) -> PyResult<Self> {
        let sheet = py.detach(|| mesh.sheet(Path::new("")));
        let sheet = sheet.map_err(|e| of_scene(py, &e))?;
        Ok(Self { sheet })
    }
}

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (vertices, faces = None))]
    fn new(vertices: &Bound<'_, PyAny>, faces: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        if let Some(faces) = faces {
            return Self::of_arrays(vertices, faces);
        }
        let Some([vertices, faces]) = foreign::arrays(vertices)? else {
            let message = "give vertices and faces, or a mesh of trimesh, meshio or pyvista";
            return Err(PyTypeError::new_err(message));
        };
        Self::of_arrays(&vertices, &faces)
    }

    /// A mesh of a generator of scenes: ``Mesh.generate("square", side=0.2, level=3)``.
    ///
    /// Names and parameters are as in ``sheet.mesh`` of scenes. Raises `SceneError` for wrong ones.
    #[staticmethod]
    #[pyo3(signature = (name, **parameters))]
    fn generate(
        py: Python<'_>,
        name: &str,
        parameters: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let parameters =
            parameters.map_or_else(|| Ok(Table::new()), |given| table(given, |_| Ok(None)))?;
        let value = Table::from_iter([(name.to_owned(), Value::Table(parameters))]);
        let mesh = value.try_into();
        let mesh: scene::Mesh = mesh.map_err(|e: toml::de::Error| {
            let remedy = "names and parameters are as in `sheet.mesh` of scenes";
            of_scene(py, &Problem::new(Key::root(), e.message(), remedy).into())
        })?;
        Self::of(py, &mesh)
    }

    /// A mesh of a file: OBJ, OFF, STL, PLY, FOLD, glTF or VTK. `scale` is the length of one unit of the file
    /// in metres.
    #[staticmethod]
    #[pyo3(signature = (path, scale = 1.0))]
    fn read(py: Python<'_>, path: PathBuf, scale: f64) -> PyResult<Self> {
        let mut file = scene::MeshFileKey::new(path);
        file.scale = scale;
        Self::of(py, &scene::Mesh::File(file))
    }

    /// Writes the mesh to a file, whose format the extension says: .obj, .off, .ply or .fold with all digits,
    /// .stl, .glb or .usda.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let written = py.detach(|| {
            let mut still = Trajectory::new(&self.sheet);
            still.push(0.0, self.sheet.positions())?;
            write_frame(&path, &Series::new(&still, &SeriesOptions::default())?, 0)
        });
        written.map_err(|e| plain(py, &e))
    }

    /// For `pickle` and `copy`: vertices and faces.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyType>, Arrays<'py>)> {
        Ok((
            slf.get_type(),
            (slf.getattr("vertices")?, slf.getattr("faces")?),
        ))
    }

    /// Positions of the vertices, metres, of shape (V, 3).
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors(py, self.sheet.positions())
    }

    /// Corners of the triangles, of shape (F, 3).
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        rows(py, &self.sheet.face_indices())
    }

    /// Ends of the edges, of shape (E, 2).
    #[getter]
    fn edges<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        rows(py, &edges(&self.sheet))
    }

    /// Lengths of the edges, metres, of shape (E,).
    #[getter]
    fn rest_lengths<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.sheet.lengths())
    }

    /// Area, m2.
    #[getter]
    fn area(&self) -> f64 {
        self.sheet.area()
    }

    fn __repr__(&self) -> String {
        let t = self.sheet.topology();
        format!(
            "<isosheet.Mesh of {} vertices and {} faces>",
            t.vertex_count(),
            t.face_count()
        )
    }
}

/// Ends of the edges of a sheet.
pub(crate) fn edges(sheet: &Sheet) -> Vec<[u32; 2]> {
    let edges = sheet.topology().edges().iter();
    edges.map(|ends| ends.map(|v| v.0)).collect()
}
