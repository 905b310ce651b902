//! Pages that play the runs of a figure in 3D.

use super::sequence::{View, thumbnail};
use super::{Context, Play, RenderEffort};
use crate::runs::{self, FigureScene, RunSummary};
use anyhow::Result;
use isosheet_io::view::Replay;

/// The page of a run that has been made, with what tells it from the other runs of the figure.
pub(super) fn play(
    figure: u8,
    label: &str,
    scene: &FigureScene,
    view: &View<'_>,
    context: &Context<'_>,
) -> Result<Play> {
    let summary = runs::summary(context.store, scene)?;
    let trajectory = runs::trajectory(context.store, scene)?;
    let history = runs::history(context.store, scene)?;
    let setup = scene.setup()?;
    let (pins, bodies) = (setup.model.pins(), setup.obstacles);
    let quick = match context.effort {
        RenderEffort::Full => "",
        RenderEffort::Quick => " --quick",
    };
    let replay = Replay {
        title: format!("Figure {figure}: {label}"),
        pins: pins.iter().map(|v| v.0).collect(),
        summary: rows(&summary),
        scene: scene.text().to_owned(),
        reproduce: format!("cargo xtask reproduce-figures --figures {figure}{quick}"),
        ..Replay::of_motion(&setup.sheet, &bodies, &trajectory, &history)?
    };
    let name = format!("fig{figure:02}-{}", scene.name());
    Ok(Play {
        file: format!("{name}.html"),
        thumbnail_file: format!("{name}-end.png"),
        // Where the figure leaves bodies out, they would hide the sheet.
        choices: if view.bodies.len() < bodies.len() {
            "#bodies=glass"
        } else {
            ""
        },
        label: label.to_owned(),
        page: replay.to_html()?,
        thumbnail: thumbnail(scene, &trajectory, view)?,
    })
}

/// The table of the page.
fn rows(run: &RunSummary) -> Vec<(String, String)> {
    let joules = |e: f64| format!("{e:.2e} J");
    [
        (
            "time",
            format!("{:.2} s in {} frames", run.time, run.frames),
        ),
        (
            "sub-steps",
            format!("{}, {} rejected", run.substeps, run.rejected),
        ),
        (
            "solver",
            format!(
                "{} iterations, {} factorisations",
                run.iterations, run.factorisations
            ),
        ),
        ("wall time", format!("{:.1} s", run.wall)),
        ("largest strain", format!("{:.1e}", run.max_strain)),
        ("smallest gap", super::gap(run.smallest_gap)),
        ("potential energy released", joules(run.energy.released)),
        ("work of bodies and forces", joules(run.energy.work)),
        ("taken out by damping", joules(run.energy.damped)),
        ("lost to friction", joules(run.energy.friction)),
        ("error of the energy balance", joules(run.energy.drift)),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .to_vec()
}
