//! The same fall many times, each from another slightly uneven start.

use super::{Scene, Shape, Staged};
use crate::interrupt;
use crate::progress::Progress;
use anyhow::Result;
use isosheet_dynamics::{Frames, Method, Simulation, State, leave_flat};
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
pub(crate) fn ensemble(scene: &Scene, bump: f64, members: u64) -> Result<Vec<Member>> {
    let sheet = scene.sheet()?;
    let bar = Progress::start(format!("falls of M^{}", scene.level), members as usize);
    let mut all = Vec::new();
    for seed in 1..=members {
        let model = scene.model(&sheet)?;
        let mut x = sheet.positions().to_vec();
        leave_flat(&model, &mut x, bump, seed)?;
        let start = model.potential_energy(0.0, &x);
        let mut simulation = Simulation::new(model, State::at_rest(x), Method::default())?;
        let mut frames = Frames::every(1);
        simulation.run(
            scene.frames as f64 * scene.frame,
            scene.frame,
            &mut [&mut frames, &mut interrupt::observe],
        )?;
        interrupt::check()?;
        let mut sum = 0.0;
        for state in &frames.states()[1..] {
            sum += Shape::of(scene, &sheet, &state.x)?.bending;
        }
        let State { t, x, v } = simulation.state();
        let model = simulation.model();
        let released = start - model.potential_energy(*t, x);
        all.push(Member {
            seed,
            shape: Shape::of(scene, &sheet, x)?,
            mean_bending: sum / scene.frames as f64,
            motion_left: model.kinetic_energy(v) / released.max(1e-12),
        });
        bar.step();
    }
    bar.finish(&format!("{members} falls"));
    Ok(all)
}
