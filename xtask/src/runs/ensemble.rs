//! The same fall many times, each from another slightly uneven start.

use super::{FigureScene, Hanging, SheetShape, displaced};
use crate::progress::Progress;
use anyhow::Result;

/// What became of one member of an ensemble.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Member {
    /// The shape at the end.
    pub(crate) shape: SheetShape,
    /// Total bending averaged over the run, radians times sides.
    pub(crate) mean_bending: f64,
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
        let mut simulation = setup.start()?;
        let frames = scene.play(&mut simulation)?;
        let mut sum = 0.0;
        for state in &frames.states()[1..] {
            sum += SheetShape::of(&hanging, &state.x)?.bending;
        }
        let end = &simulation.state().x;
        all.push(Member {
            shape: SheetShape::of(&hanging, end)?,
            mean_bending: sum / scene.frames() as f64,
        });
        bar.step();
    }
    bar.finish(&format!("{members} falls"));
    Ok(all)
}
