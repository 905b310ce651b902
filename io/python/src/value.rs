//! Python's values as values of TOML, and back.

use crate::arrays::refuse_array;
use crate::error::of_file;
use isosheet_scenes::{Edit, EditError, SceneFileError};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple, PyType};
use toml::{Table, Value};

/// Deepest nesting of a value: twice that of the deepest scene.
const MOST_LEVELS: usize = 64;

/// The values of further classes: of meshes, or none.
pub(crate) type Further = fn(&Bound<'_, PyAny>) -> PyResult<Option<Value>>;

/// The value of TOML that stands for one of Python: truth values, numbers, texts, paths, lists, dictionaries,
/// objects of dataclasses, numpy arrays and numbers, and what `further` knows. Entries of dictionaries that
/// are `None` are left out. It is so many levels deep in others.
fn nested(value: &Bound<'_, PyAny>, further: Further, level: usize) -> PyResult<Value> {
    let py = value.py();
    if level > MOST_LEVELS {
        return Err(PyValueError::new_err(format!(
            "the value contains itself, or is nested deeper than {MOST_LEVELS} levels"
        )));
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
        return Ok(Value::Table(nested_table(dict, further, level)?));
    }
    if let Some(fields) = value.getattr_opt(intern!(py, "__dataclass_fields__"))? {
        let dict = PyDict::new(py);
        for name in fields.try_iter()? {
            let name = name?.cast_into::<PyString>()?;
            dict.set_item(&name, value.getattr(&name)?)?;
        }
        return Ok(Value::Table(nested_table(&dict, further, level)?));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let entries = value.try_iter()?;
        let entries = entries.map(|entry| nested(&entry?, further, level + 1));
        return Ok(Value::Array(entries.collect::<PyResult<_>>()?));
    }
    if let Some(value) = further(value)? {
        return Ok(value);
    }
    // Arrays and numbers of numpy, and of what else there is.
    if let Some(plain) = value.getattr_opt(intern!(py, "tolist"))? {
        refuse_array(value)?;
        return nested(&plain.call0()?, further, level + 1);
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
pub(crate) fn table(dict: &Bound<'_, PyDict>, further: Further) -> PyResult<Table> {
    nested_table(dict, further, 0)
}

fn nested_table(dict: &Bound<'_, PyDict>, further: Further, level: usize) -> PyResult<Table> {
    let mut table = Table::new();
    for (key, value) in dict {
        if !value.is_none() {
            table.insert(key.extract()?, nested(&value, further, level + 1)?);
        }
    }
    Ok(table)
}

/// The edits that stand for a dictionary of keys and values.
pub(crate) fn edits(dict: &Bound<'_, PyDict>, further: Further) -> PyResult<Vec<Edit>> {
    let edit = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let (text, value): (String, Value) = (key.extract()?, nested(&value, further, 0)?);
        match text.parse() {
            Ok(key) => Ok(Edit { key, value }),
            Err(error) => {
                let error = EditError {
                    edit: format!("{text}={value}"),
                    problem: error.into(),
                };
                Err(of_file(dict.py(), &SceneFileError::Edit(error)))
            }
        }
    };
    dict.iter().map(edit).collect()
}

/// The edits of a dictionary as texts `key=value`.
pub(crate) fn edits_as_texts(dict: &Bound<'_, PyDict>, further: Further) -> PyResult<Vec<String>> {
    Ok(edits(dict, further)?.iter().map(Edit::to_string).collect())
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
