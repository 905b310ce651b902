//! What was measured of one model.

use super::isometry::Isometry;
use super::targets::{self, Target};
use crate::runs::Course;
use serde::{Deserialize, Serialize};

/// A job done with one model of isometry: a run, or the worst of the runs of a search, and what was measured.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Sample<J, M = ()> {
    pub(super) isometry: Isometry,
    pub(super) job: J,
    /// Number of vertices of the mesh.
    pub(super) vertices: usize,
    pub(super) course: Course,
    pub(super) measured: M,
}

impl<J, M> Sample<J, M> {
    /// Factorisations a step, of a run that reached its end.
    pub(super) fn cost(&self) -> Option<f64> {
        self.course
            .cost
            .factorisations_per_step()
            .filter(|_| self.course.is_good())
    }
}

/// The samples of one model.
#[derive(Debug)]
pub(super) struct OfModel<'a, J, M> {
    pub(super) isometry: Isometry,
    pub(super) all: Vec<&'a Sample<J, M>>,
}

impl<'a, J, M> OfModel<'a, J, M> {
    /// The samples of a model among all.
    pub(super) fn of(isometry: Isometry, all: &'a [Sample<J, M>]) -> Self {
        let all = all.iter().filter(|s| s.isometry == isometry).collect();
        Self { isometry, all }
    }

    /// The samples that pass a test.
    pub(super) fn with(&self, test: impl Fn(&J) -> bool) -> Self {
        let all = self.all.iter().copied().filter(|s| test(&s.job)).collect();
        let isometry = self.isometry;
        Self { isometry, all }
    }

    /// A requirement on the largest of some values, see [`targets::at_most`].
    pub(super) fn at_most(
        &self,
        quantity: &str,
        bound: f64,
        value: impl Fn(&Sample<J, M>) -> Option<f64>,
    ) -> Target {
        let values: Vec<Option<f64>> = self.all.iter().map(|s| value(s)).collect();
        targets::at_most(self.isometry, quantity, bound, &values)
    }

    /// A requirement on one value that has to be large enough.
    pub(super) fn at_least(&self, quantity: &str, bound: f64, value: Option<f64>) -> Target {
        targets::at_least(self.isometry, quantity, bound, &[value])
    }

    /// The part of the runs that reach their end.
    pub(super) fn share_that_ends(&self) -> f64 {
        let ended = self.all.iter().filter(|s| s.course.is_good()).count();
        ended as f64 / self.all.len() as f64
    }

    /// See [`targets::MOST_STRAIN`].
    pub(super) fn strain(&self) -> Target {
        let (quantity, bound) = targets::MOST_STRAIN;
        self.at_most(quantity, bound, |s| Some(s.course.strain))
    }
}

/// The requirements on every model, and what its steps guarantee, see [`targets::kept`].
pub(super) fn requirements<J, M>(
    all: &[Sample<J, M>],
    of_model: impl Fn(&OfModel<'_, J, M>) -> Vec<Target>,
) -> Vec<Target> {
    let of = |isometry: Isometry| {
        let of = OfModel::of(isometry, all);
        let mut required = of_model(&of);
        let courses = of.all.iter().map(|s| &s.course);
        required.extend(targets::kept(isometry, courses));
        required
    };
    Isometry::ALL.into_iter().flat_map(of).collect()
}
