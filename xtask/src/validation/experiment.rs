//! Experiments: what is done to a sheet, what is read off, and what the literature says.

use super::rest::Rest;
use crate::runs::meshes::Grid;
use anyhow::Result;
use serde::{Deserialize, Serialize};

/// A mesh of an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Job {
    pub(super) mesh: Grid,
    /// Squares across the smaller side of the sheet, or what the experiment says.
    #[serde(rename = "squares across")]
    pub(super) across: usize,
}

/// The meshes that are compared.
pub(super) const MESHES: [Grid; 6] = [
    Grid::Aligned,
    Grid::UnionJack,
    Grid::OneWay,
    Grid::Delaunay1,
    Grid::Delaunay2,
    Grid::Delaunay3,
];

/// A number that the literature gives.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Quantity {
    pub(super) name: String,
    pub(super) reference: f64,
    /// What errors are parts of.
    pub(super) scale: f64,
}

impl Quantity {
    pub(super) fn new(name: impl Into<String>, reference: f64) -> Self {
        Self {
            name: name.into(),
            reference,
            scale: reference.abs(),
        }
    }

    /// A number that may be near zero: its errors are parts of another.
    pub(super) fn of_scale(name: impl Into<String>, reference: f64, scale: f64) -> Self {
        Self {
            scale,
            ..Self::new(name, reference)
        }
    }

    /// Per cent.
    pub(super) fn error(&self, value: f64) -> f64 {
        100.0 * (value - self.reference) / self.scale
    }
}

/// What was measured of one mesh.
#[derive(Clone, Debug, Default)]
pub(super) struct Measured {
    /// The quantities in their order.
    pub(super) values: Vec<f64>,
    /// Vertices of the mesh.
    pub(super) vertices: usize,
    /// Seconds of the processor and factorisations of the steps.
    pub(super) cpu: f64,
    pub(super) factorisations: usize,
    /// Why the run did not reach its end.
    pub(super) failure: Option<String>,
}

impl Measured {
    /// Of sheets that were brought to rest.
    pub(super) fn at_rest(rest: &Rest, values: Vec<f64>) -> Self {
        Self {
            values,
            vertices: rest.x.len() / 3,
            cpu: rest.course.cost.cpu,
            factorisations: rest.course.cost.factorisations,
            failure: rest.course.failure(),
        }
    }

    /// Adds the quantities of another sheet.
    pub(super) fn add(&mut self, other: Self) {
        self.values.extend(other.values);
        self.vertices = self.vertices.max(other.vertices);
        self.cpu += other.cpu;
        self.factorisations += other.factorisations;
        self.failure = self.failure.take().or(other.failure);
    }
}

/// An experiment.
#[derive(Debug)]
pub(super) struct Experiment {
    /// Its name on the command line and in file names.
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    /// Author, year and table of the reference.
    pub(super) source: &'static str,
    /// The set-up in words.
    pub(super) about: &'static str,
    pub(super) quantities: fn() -> Vec<Quantity>,
    pub(super) measure: fn(Job) -> Result<Measured>,
}

/// What was measured of one quantity on one mesh; a line of the table of all runs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Row {
    pub(super) quantity: String,
    pub(super) reference: f64,
    pub(super) mesh: Grid,
    #[serde(rename = "squares across")]
    pub(super) across: usize,
    #[serde(rename = "V")]
    pub(super) vertices: usize,
    pub(super) value: Option<f64>,
    #[serde(rename = "error, %")]
    pub(super) error: Option<f64>,
    /// Of the run, whose other quantities have the same.
    #[serde(rename = "CPU s")]
    pub(super) cpu: f64,
    pub(super) factorisations: usize,
    pub(super) message: String,
}

impl Experiment {
    /// The lines of one mesh.
    pub(super) fn rows(&self, job: Job) -> Result<Vec<Row>> {
        let measured = (self.measure)(job)?;
        let quantities = (self.quantities)();
        let row = |(k, quantity): (usize, &Quantity)| {
            let value = measured.values.get(k).copied();
            let value = value.filter(|v| measured.failure.is_none() && v.is_finite());
            Row {
                quantity: quantity.name.clone(),
                reference: quantity.reference,
                mesh: job.mesh,
                across: job.across,
                vertices: measured.vertices,
                value,
                error: value.map(|v| quantity.error(v)),
                cpu: measured.cpu,
                factorisations: measured.factorisations,
                message: measured.failure.clone().unwrap_or_default(),
            }
        };
        Ok(quantities.iter().enumerate().map(row).collect())
    }
}
