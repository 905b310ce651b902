//! Gradients of runs.

use crate::error::plain;
use crate::signals::Signals;
use isosheet_adjoint::{
    AdjointError, AdjointOptions, Energies, Loss, Moment, OfMoments, OfState, Run, Share, View,
};
use isosheet_runs::SceneFamily;
use isosheet_scenes::SceneFile;
use numpy::{AllowTypeChange, PyArray1, PyArrayLikeDyn, PyArrayMethods};
use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::cell::RefCell;
use std::ffi::CString;

/// The value of a loss with its derivatives by keys.
pub(crate) type Differentiated<'py> = (f64, Bound<'py, PyDict>);

/// What a loss gets of each moment of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Quantity {
    Positions,
    Velocities,
    SupportForces,
    Energies,
}

impl Quantity {
    /// By the name that `also` has for it.
    ///
    /// # Errors
    /// A `ValueError` that lists the names.
    pub(crate) fn named(name: &str) -> PyResult<Self> {
        let others = [Self::Velocities, Self::SupportForces, Self::Energies];
        others
            .into_iter()
            .find(|own| own.name() == name)
            .ok_or_else(|| {
                let names = others.map(|own| format!("{:?}", own.name())).join(", ");
                PyValueError::new_err(format!("also has {name:?}; give some of {names}"))
            })
    }

    fn name(self) -> &'static str {
        match self {
            Self::Positions => "positions",
            Self::Velocities => "velocities",
            Self::SupportForces => "support_forces",
            Self::Energies => "energies",
        }
    }

    fn view(self) -> View {
        match self {
            Self::Positions | Self::Velocities => View::State,
            Self::SupportForces | Self::Energies => View::All,
        }
    }

    /// Its numbers at a moment.
    fn numbers(self, moment: &Moment<'_>) -> Vec<f64> {
        match self {
            Self::Positions => moment.state.x.clone(),
            Self::Velocities => moment.state.v.clone(),
            Self::SupportForces => moment.support_forces.as_flattened().to_vec(),
            Self::Energies => {
                let Energies {
                    kinetic,
                    potentials,
                } = moment.energies;
                vec![*kinetic, potentials.iter().sum()]
            }
        }
    }

    /// The shape of these numbers, with so many moments and vertices.
    fn shape(self, moments: usize, vertices: usize) -> Vec<usize> {
        match self {
            Self::Energies => vec![moments, 2],
            _ => vec![moments, vertices, 3],
        }
    }

    /// Adds derivatives by its numbers at a moment to a share.
    fn add(self, of: &[f64], moment: &Moment<'_>, share: &mut Share) {
        match self {
            Self::Positions => share.of.x.copy_from_slice(of),
            Self::Velocities => share.of.v.copy_from_slice(of),
            Self::SupportForces => share.of_forces = of.as_chunks::<3>().0.to_vec(),
            Self::Energies => {
                share.of_energies = Energies {
                    kinetic: of[0],
                    potentials: vec![of[1]; moment.energies.potentials.len()],
                }
            }
        }
    }
}

/// A loss that Python has differentiated by some quantities: of each one the derivatives at all moments.
struct Derivatives<'a> {
    quantities: &'a [Quantity],
    of: Vec<Vec<f64>>,
    moments: usize,
    view: View,
}

impl Loss for Derivatives<'_> {
    fn share(&self, n: usize, moment: &Moment<'_>) -> Option<Share> {
        let mut share = Share::of_state(0.0, OfState::zeros(moment.state.x.len()));
        let mut is_zero = true;
        for (quantity, of) in self.quantities.iter().zip(&self.of) {
            let width = of.len() / self.moments;
            let own = &of[n * width..(n + 1) * width];
            is_zero &= own.iter().all(|slope| *slope == 0.0);
            quantity.add(own, moment, &mut share);
        }
        (!is_zero).then_some(share)
    }

    fn view(&self, _n: usize) -> View {
        self.view
    }
}

/// Runs a scene, hands times and quantities to `loss`, and goes back over the run.
pub(crate) fn gradient<'py>(
    py: Python<'py>,
    file: &SceneFile,
    loss: &Bound<'py, PyAny>,
    of: Vec<String>,
    also: &[Quantity],
    mut options: AdjointOptions,
) -> PyResult<Differentiated<'py>> {
    let text = file.text();
    let family = SceneFamily::of_text(&text.text, &text.path, Vec::new(), of);
    let family = family.map_err(|e| plain(py, &e))?;
    let plan = family.plan().map_err(|e| plain(py, &e))?;
    let values = family.values().map_err(|e| plain(py, &e))?;
    let sizes = family.sizes().map_err(|e| plain(py, &e))?;
    for (given, size) in options.sizes.iter_mut().zip(sizes) {
        if *given == 0.0 {
            *given = size;
        }
    }
    let mut signals = Signals::default();
    let watched =
        py.detach(|| Run::record_watched(&family, &values, plan, options, &mut || signals.ask()));
    let run = watched.map_err(|e| failed(py, &e, &mut signals))?;
    let quantities: Vec<Quantity> = [Quantity::Positions].iter().chain(also).copied().collect();
    let needs_all = quantities.iter().any(|own| own.view() == View::All);
    let view = if needs_all { View::All } else { View::State };
    let seen = seen(&run, &quantities, view).map_err(|e| failed(py, &e, &mut signals))?;
    let moments = run.states().len();
    let vertices = run.states()[0].x.len() / 3;
    let times = run.states().iter().map(|state| state.t).collect();
    let mut arguments = vec![PyArray1::from_vec(py, times).into_any()];
    for (quantity, numbers) in quantities.iter().zip(seen) {
        let array = PyArray1::from_vec(py, numbers);
        arguments.push(array.reshape(quantity.shape(moments, vertices))?.into_any());
    }
    let returned = loss.call1(PyTuple::new(py, arguments)?)?;
    let returned: Vec<Bound<'py, PyAny>> = returned.try_iter()?.collect::<PyResult<_>>()?;
    if returned.len() != 1 + quantities.len() {
        let (found, expected) = (returned.len(), 1 + quantities.len());
        let message = format!(
            "the loss returns {found} values, and is to return {expected}: a number, and its \
             derivatives by each array"
        );
        return Err(PyValueError::new_err(message));
    }
    let value: f64 = returned[0].extract()?;
    if !value.is_finite() {
        return Err(PyValueError::new_err(format!("the loss is {value}")));
    }
    let mut slopes = Vec::new();
    for (quantity, returned) in quantities.iter().zip(&returned[1..]) {
        let name = quantity.name();
        let own: PyArrayLikeDyn<'_, f64, AllowTypeChange> = returned.extract().map_err(|_| {
            PyValueError::new_err(format!("the derivatives by {name} are no array of numbers"))
        })?;
        let (own, expected) = (own.as_array(), quantity.shape(moments, vertices));
        if own.shape() != expected {
            let found = own.shape();
            let message =
                format!("the derivatives by {name} have the shape {found:?}, and not {expected:?}");
            return Err(PyValueError::new_err(message));
        }
        slopes.push(own.iter().copied().collect());
    }
    let derivatives = Derivatives {
        quantities: &quantities,
        of: slopes,
        moments,
        view,
    };
    let watched = py.detach(|| run.gradient_watched(&derivatives, &mut || signals.ask()));
    let gradient = watched.map_err(|e| failed(py, &e, &mut signals))?;
    for passed in &gradient.passed_by {
        let message = CString::new(format!("it counted as constant: {}", passed.what))?;
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 1)?;
    }
    let by_keys = PyDict::new(py);
    for (key, slope) in family.keys().iter().zip(&gradient.of_numbers) {
        by_keys.set_item(key, slope)?;
    }
    Ok((value, by_keys))
}

/// The exception of an error; after Ctrl-C that of the handler of signals.
fn failed(py: Python<'_>, error: &AdjointError, signals: &mut Signals) -> PyErr {
    match signals.raised.take() {
        Some(raised) => raised,
        None => plain(py, error),
    }
}

/// The quantities at all moments of a run, one list for each.
fn seen(run: &Run<'_>, quantities: &[Quantity], view: View) -> Result<Vec<Vec<f64>>, AdjointError> {
    let all = RefCell::new(vec![Vec::new(); quantities.len()]);
    let add = |moment: &Moment<'_>| {
        for (quantity, list) in quantities.iter().zip(all.borrow_mut().iter_mut()) {
            list.extend(quantity.numbers(moment));
        }
        None
    };
    match view {
        View::All => run.value(&OfMoments(|_: usize, moment: &Moment<'_>| add(moment)))?,
        View::State => run.value(&|_: usize, state: &_| {
            add(&Moment {
                state,
                support_forces: &[],
                energies: &Energies::default(),
            })
        })?,
    };
    Ok(all.into_inner())
}
