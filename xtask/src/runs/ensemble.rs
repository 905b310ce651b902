//! The same fall many times, each from another slightly uneven start.

use super::{FigureScene, Hanging, Shape, displaced};
use crate::progress::Progress;
use anyhow::Result;
use isosheet_dynamics::State;
use serde::{Deserialize, Serialize};

/// What became of one member of an ensemble.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Member {
    pub(crate) seed: u64,
    /// The shape at the end.
    pub(crate) shape: Shape,
    /// Total bending averaged over the run, radians times sides.
    pub(crate) mean_bending: f64,
    /// Kinetic energy at the end as part of the potential energy released.
    pub(crate) motion_left: f64,
}

/// Runs a scene from starts that differ by random displacements of up to `bump` mean edge lengths.
///
/// # Errors
/// Ctrl-C and errors of the simulation.
pub(crate) fn ensemble(scene: &FigureScene, bump: f64, members: u64) -> Result<Vec<Member>> {
    let hanging = Hanging::of(scene)?;
    let bar = Progress::start(format!("falls of M^{}", hanging.level), members as usize);
    let mut all = Vec::new();
    for seed in 1..=members {
        let uneven = scene.edited(scene.name(), &[displaced(bump, seed)])?;
        let setup = uneven.setup()?;
        let start = setup.model.potential_energy(0.0, &setup.start.x);
        let mut simulation = setup.start()?;
        let frames = scene.play(&mut simulation)?;
        let mut sum = 0.0;
        for state in &frames.states()[1..] {
            sum += Shape::of(&hanging, &state.x)?.bending;
        }
        let State { t, x, v } = simulation.state();
        let model = simulation.model();
        let released = start - model.potential_energy(*t, x);
        all.push(Member {
            seed,
            shape: Shape::of(&hanging, x)?,
            mean_bending: sum / scene.frames() as f64,
            motion_left: model.kinetic_energy(v) / released.max(1e-12),
        });
        bar.step();
    }
    bar.finish(&format!("{members} falls"));
    Ok(all)
}
