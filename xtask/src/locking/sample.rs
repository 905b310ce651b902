//! What was measured of one model.

use super::bisection::{Bracket, Verdict, bisect};
use super::course::{Course, Kept};
use super::isometry::Isometry;
use super::targets::{self, Target};
use anyhow::Result;
use serde::{Deserialize, Serialize};

/// A job done with one model of isometry: a run or a search `R`, and what it gave beside, `M`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Sample<J, R, M = ()> {
    pub(super) isometry: Isometry,
    pub(super) job: J,
    /// Number of vertices of the mesh.
    pub(super) vertices: usize,
    pub(super) run: R,
    pub(super) measured: M,
}

/// A search for a critical value.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Search {
    pub(super) found: Bracket,
    /// The worst of all steps of all its runs.
    pub(super) kept: Kept,
}

impl Search {
    /// A search by [`bisect`]; `probe` says what the scene does at a value, and what the steps of its run
    /// kept.
    pub(super) fn over(
        range: [f64; 2],
        halvings: usize,
        probe: impl Fn(f64) -> Result<(Verdict, Kept)>,
    ) -> Result<Self> {
        let mut kept = Kept::default();
        let found = bisect(range, halvings, |value| {
            let (verdict, run) = probe(value)?;
            kept.add(run);
            Ok(verdict)
        })?;
        Ok(Self { found, kept })
    }
}

/// What has steps that guarantee something.
pub(super) trait Steps {
    /// The worst of its steps.
    fn kept(&self) -> Kept;
}

impl Steps for Course {
    fn kept(&self) -> Kept {
        self.kept
    }
}

impl Steps for Search {
    fn kept(&self) -> Kept {
        self.kept
    }
}

impl<J, M> Sample<J, Course, M> {
    /// Factorisations a step, of a run that reached its end.
    pub(super) fn cost(&self) -> Option<f64> {
        self.run.factorisations().filter(|_| self.run.is_good())
    }
}

/// The samples of one model.
#[derive(Debug)]
pub(super) struct OfModel<'a, J, R, M> {
    pub(super) isometry: Isometry,
    pub(super) all: Vec<&'a Sample<J, R, M>>,
}

impl<'a, J, R, M> OfModel<'a, J, R, M> {
    /// The samples of a model among all.
    pub(super) fn of(isometry: Isometry, all: &'a [Sample<J, R, M>]) -> Self {
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
        value: impl Fn(&Sample<J, R, M>) -> Option<f64>,
    ) -> Target {
        let values: Vec<Option<f64>> = self.all.iter().map(|s| value(s)).collect();
        targets::at_most(self.isometry, quantity, bound, &values)
    }

    /// A requirement on one value that has to be large enough.
    pub(super) fn at_least(&self, quantity: &str, bound: f64, value: Option<f64>) -> Target {
        targets::at_least(self.isometry, quantity, bound, &[value])
    }
}

impl<J, M> OfModel<'_, J, Course, M> {
    /// The part of the runs that reach their end.
    pub(super) fn share_that_ends(&self) -> f64 {
        let ended = self.all.iter().filter(|s| s.run.is_good()).count();
        ended as f64 / self.all.len() as f64
    }

    /// See [`targets::MOST_STRAIN`].
    pub(super) fn strain(&self) -> Target {
        let (quantity, bound) = targets::MOST_STRAIN;
        self.at_most(quantity, bound, |s| Some(s.run.strain))
    }
}

/// The requirements on every model, and what its steps guarantee, see [`targets::kept`].
pub(super) fn requirements<J, R: Steps, M>(
    all: &[Sample<J, R, M>],
    of_model: impl Fn(&OfModel<'_, J, R, M>) -> Vec<Target>,
) -> Vec<Target> {
    let of = |isometry: Isometry| {
        let of = OfModel::of(isometry, all);
        let mut required = of_model(&of);
        let steps = of.all.iter().map(|s| s.run.kept());
        required.extend(targets::kept(isometry, steps));
        required
    };
    Isometry::ALL.into_iter().flat_map(of).collect()
}
