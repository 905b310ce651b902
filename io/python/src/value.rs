//! Python's values as those of TOML, and back.

use crate::mesh::Mesh;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple, PyType};
use toml::{Table, Value};

/// Deepest nesting of a value: twice that of the deepest scene.
const MOST_LEVELS: usize = 64;

/// Most numbers of an array: those of ten times as many vertices as a sheet may have for its runs to end.
const MOST_NUMBERS: usize = 10_000_000;

/// The value of TOML that stands for one of Python: truth values, numbers, texts, paths, lists, dictionaries,
/// numpy arrays and numbers, and meshes. Entries of dictionaries that are `None` are left out.
pub(crate) fn from_python(value: &Bound<'_, PyAny>) -> PyResult<Value> {
    nested(value, 0)
}

/// The same for a value that is so many levels deep in others.
fn nested(value: &Bound<'_, PyAny>, level: usize) -> PyResult<Value> {
    let py = value.py();
    if level > MOST_LEVELS {
        return Err(PyValueError::new_err(format!(
            "the value contains itself, or is nested deeper than {MOST_LEVELS} levels"
        )));
    }
    if let Ok(mesh) = value.cast::<Mesh>() {
        return Ok(mesh.get().as_value());
    }
    if value.is_instance_of::<PyBool>() {
        return Ok(Value::Boolean(value.extract()?));
    }
    if value.is_instance_of::<PyInt>() {
        let number = value.extract().map_err(|_| {
            PyValueError::new_err(format!(
                "{value} is beyond the whole numbers of scenes, -2^63 to 2^63 - 1"
            ))
        });
        return Ok(Value::Integer(number?));
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(Value::Float(value.extract()?));
    }
    if value.is_instance_of::<PyString>() {
        return Ok(Value::String(value.extract()?));
    }
    if let Ok(dict) = value.cast::<PyDict>() {
        return Ok(Value::Table(nested_table(dict, level)?));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let entries = value.try_iter()?;
        let entries = entries.map(|entry| nested(&entry?, level + 1));
        return Ok(Value::Array(entries.collect::<PyResult<_>>()?));
    }
    // Arrays and numbers of numpy, and of what else there is.
    if let Some(plain) = value.getattr_opt(intern!(py, "tolist"))? {
        refuse_array(value)?;
        return nested(&plain.call0()?, level + 1);
    }
    if value.hasattr(intern!(py, "__fspath__"))? {
        let path = value.call_method0(intern!(py, "__fspath__"))?;
        return Ok(Value::String(path.extract()?));
    }
    let message = format!(
        "{} has no place in a scene; give numbers, texts, lists, dictionaries, arrays or a Mesh",
        value.get_type().name()?
    );
    Err(PyTypeError::new_err(message))
}

/// The table of TOML that stands for a dictionary.
pub(crate) fn table(dict: &Bound<'_, PyDict>) -> PyResult<Table> {
    nested_table(dict, 0)
}

/// Refuses arrays of numpy that have a mask, which a scene has no place for, or more numbers than any scene.
pub(crate) fn refuse_array(value: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = value.py();
    // Of other arrays `mask` is a method.
    let mask = value.getattr_opt(intern!(py, "mask"))?;
    if mask.is_some_and(|mask| !mask.is_callable()) {
        let message = "the array has a mask, and a scene has numbers alone; give those that are meant, by \
                       `array.compressed()` or `array.filled(value)`";
        return Err(PyValueError::new_err(message));
    }
    let Some(size) = value.getattr_opt(intern!(py, "size"))? else {
        return Ok(());
    };
    match size.extract::<usize>() {
        Ok(size) if size > MOST_NUMBERS => Err(PyValueError::new_err(format!(
            "the array has {size} numbers, and at most {MOST_NUMBERS} have a place in a scene"
        ))),
        _ => Ok(()),
    }
}

fn nested_table(dict: &Bound<'_, PyDict>, level: usize) -> PyResult<Table> {
    let mut table = Table::new();
    for (key, value) in dict {
        if !value.is_none() {
            table.insert(key.extract()?, nested(&value, level + 1)?);
        }
    }
    Ok(table)
}

/// The edits `key=value` that stand for a dictionary of keys and values.
pub(crate) fn edits(dict: &Bound<'_, PyDict>) -> PyResult<Vec<String>> {
    let edit = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let key: String = key.extract()?;
        Ok(format!("{key}={}", from_python(&value)?))
    };
    dict.iter().map(edit).collect()
}

/// How `pickle` and `copy` make an object again: what is called with which class.
pub(crate) type Remade<'py> = (Bound<'py, PyAny>, (Bound<'py, PyType>,));

/// An object is made again by a static method of its class with some arguments.
pub(crate) fn remade<'py, T>(
    object: &Bound<'py, T>,
    method: &str,
    arguments: Vec<Bound<'py, PyAny>>,
) -> PyResult<Remade<'py>> {
    let py = object.py();
    let method = PyString::new(py, method).into_any();
    let all = PyTuple::new(
        py,
        std::iter::once(method).chain(arguments).collect::<Vec<_>>(),
    )?;
    let caller = py.import("operator")?.getattr("methodcaller")?;
    Ok((caller.call1(all)?, (object.as_any().get_type(),)))
}

/// The value of Python that stands for one of TOML.
pub(crate) fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::String(text) => PyString::new(py, text).into_any(),
        Value::Integer(number) => number.into_pyobject(py)?.into_any(),
        Value::Float(number) => PyFloat::new(py, *number).into_any(),
        Value::Boolean(truth) => PyBool::new(py, *truth).to_owned().into_any(),
        Value::Datetime(time) => PyString::new(py, &time.to_string()).into_any(),
        Value::Array(entries) => {
            let entries = entries.iter().map(|entry| to_python(py, entry));
            PyList::new(py, entries.collect::<PyResult<Vec<_>>>()?)?.into_any()
        }
        Value::Table(table) => {
            let dict = PyDict::new(py);
            for (key, value) in table {
                dict.set_item(key, to_python(py, value)?)?;
            }
            dict.into_any()
        }
    })
}
