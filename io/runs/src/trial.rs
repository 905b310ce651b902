//! How far a scene folds, found without a folder.

use super::passing::Passing;
use super::steps::step_count;
use isosheet_dynamics::StepProgress;
use isosheet_scenes::{FoldResidual, FollowedFolds, SceneError, SceneFile};
use std::ops::ControlFlow;

/// Most factorisations of a trial times vertices: about a second for each hundred thousand. (Of 40 patterns
/// of 117 to 1120 vertices whose panels came to an end, all but one took less.)
const MOST_WORK: usize = 1_000_000;

/// Factorisations for each step that a trial may take in any case: soft panels that fold without snapping
/// take two to three.
const AT_LEAST: usize = 4;

/// Where a scene that folds a pattern ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoldTrial {
    /// How far creases are from their angles.
    pub residual: FoldResidual,
    /// The largest strain of an edge.
    pub strain: f64,
    /// The part of the folding that is done when panels first pass through each other.
    pub passing: Option<f64>,
}

impl FoldTrial {
    /// How far the end is from the folded shape of a sheet that does not stretch: the angles (radians, root
    /// of the mean square) and the largest strain together. A strain is an angle by which a face has the
    /// wrong form.
    pub fn error(&self) -> f64 {
        self.residual.rms.to_radians().hypot(self.strain)
    }
}

/// How far the creases are from the angles that a scene folds to at its end. `None` if it cannot start, a
/// step fails, or the end takes too much work; the clock has no part in that. `watch` is told the part of the
/// time that is done, and ends the trial.
///
/// # Errors
/// [`SceneError`] if the scene cannot be built.
pub fn folds_to(
    file: &SceneFile,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Option<FoldTrial>, SceneError> {
    let setup = file.build()?;
    let targets = setup.targets.folding.clone();
    let Ok(mut simulation) = setup.start() else {
        return Ok(None);
    };
    let Some(targets) = targets else {
        return Ok(None);
    };
    let topology = simulation.model().topology();
    let mut folds = FollowedFolds::begin(&targets, topology, &simulation.state().x);
    let mut passing = Passing::begin(topology, &simulation.state().x);
    let scene = file.scene();
    let vertices = simulation.model().topology().vertex_count();
    let mut left = (MOST_WORK / vertices.max(1)).max(AT_LEAST * step_count(scene) as usize);
    while simulation.state().t < scene.stop.time {
        let done = simulation.state().t / scene.stop.time;
        let mut within = |progress: &StepProgress| match progress.factorisations > left {
            true => ControlFlow::Break(()),
            false => watch(done),
        };
        match simulation.step_watched(scene.method.step, &mut within) {
            Ok(report) => left = left.saturating_sub(report.factorisations),
            Err(_) => return Ok(None),
        }
        let topology = simulation.model().topology();
        let state = simulation.state();
        folds.follow(&targets, topology, &state.x);
        passing.follow(state.t, &state.x);
    }
    let topology = simulation.model().topology();
    let x = &simulation.state().x;
    let strain = simulation.model().max_strain(x);
    Ok(Some(FoldTrial {
        residual: folds.residual(&targets, topology, x),
        strain,
        passing: passing.part_of(scene.folding.as_ref()),
    }))
}
