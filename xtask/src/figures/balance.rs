//! What the balance of energy of a run lacks, by the length of its steps.

use super::Table;
use crate::report::columns;
use crate::runs::{Energy, FigureScene, Run};
use crate::store::Store;
use anyhow::{Result, ensure};

/// The energy of a run at its end.
pub(super) struct Balance {
    label: String,
    /// Length of the steps, seconds.
    step: f64,
    energy: Energy,
}

impl Balance {
    /// Of a scene with steps that are shorter by some factors, the first of which is 1.
    ///
    /// # Errors
    /// Errors of the runs.
    pub(super) fn by_step(
        store: &Store,
        label: &str,
        scene: &FigureScene,
        factors: &[u32],
    ) -> Result<Vec<Self>> {
        let of = |&factor: &u32| {
            let step = scene.frame() / f64::from(factor);
            let name = format!("{}-steps-{factor}", scene.name());
            let shorter = || scene.edited(&name, &[format!("method.step={step:?}")]);
            let scene = if factor == 1 {
                scene.clone()
            } else {
                shorter()?
            };
            Ok(Self {
                label: label.to_owned(),
                step,
                energy: Run::of(store, scene)?.summary.energy,
            })
        };
        factors.iter().map(of).collect()
    }

    /// What gravity and moving bodies put in, joules.
    fn input(&self) -> f64 {
        self.energy.released + self.energy.work
    }

    /// The part of it that the balance lacks.
    fn lacking(&self) -> f64 {
        -self.energy.drift / self.input()
    }
}

/// Whether what the balance lacks is the time integration's: shorter steps lack less.
///
/// # Errors
/// They do not.
pub(super) fn check(all: &[Balance]) -> Result<()> {
    let parts: Vec<f64> = all.iter().map(Balance::lacking).collect();
    ensure!(
        parts.windows(2).all(|pair| pair[1] < pair[0]),
        "the part of the energy that is lacking does not fall with the step: {parts:?}"
    );
    Ok(())
}

/// The balances of runs.
pub(super) fn table(all: &[Balance]) -> Table {
    Table::of(
        "Where the energy goes that gravity and moving bodies put in, by the length of the steps. Lacking: neither stored nor accounted \
         for. What falls with the steps is taken out by the time integration, as BDF2 damps what its steps do not resolve.",
        all,
        columns! { row;
            "run" => row.label.as_str(),
            "step, ms" => 1e3 * row.step,
            "put in, mJ" => 1e3 * row.input(),
            "velocity damping, mJ" => 1e3 * row.energy.damped,
            "friction, mJ" => 1e3 * row.energy.friction,
            "yielding, mJ" => 1e3 * row.energy.plastic,
            "lacking, mJ" => -1e3 * row.energy.drift,
            "lacking, part" => super::whole_percent(row.lacking()),
        },
    )
}
