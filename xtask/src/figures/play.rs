//! Pages that play the runs of a figure in 3D.

use super::sequence::Shown;
use super::{Picture, Play};
use crate::runs::{self, RunSummary};
use anyhow::Result;
use isosheet_io::view::Replay;

impl Shown<'_> {
    /// The page that plays the run, with what tells it from the other runs of the figure.
    pub(super) fn play(&self, figure: u8, label: &str) -> Result<Play> {
        let (store, scene) = (self.context.store, self.scene);
        let summary = runs::summary(store, scene)?;
        let trajectory = runs::trajectory(store, scene)?;
        let history = runs::history(store, scene)?;
        let setup = scene.setup()?;
        let immobile = setup.model.immobile_vertices(&setup.start.x);
        let (pins, bodies) = (setup.model.pins(), setup.obstacles);
        let quick = self.context.effort.quick_or(" --quick", "");
        let replay = Replay {
            title: format!("Figure {figure}: {label}"),
            immobile: immobile.iter().map(|v| v.0).collect(),
            pins: pins.iter().map(|v| v.0).collect(),
            summary: rows(&summary),
            scene: scene.text().to_owned(),
            reproduce: format!("cargo xtask reproduce-figures --figures {figure}{quick}"),
            ..Replay::of_motion(&setup.sheet, &bodies, &trajectory, &history)?
        };
        let name = format!("fig{figure:02}-{}", scene.name());
        // Where the figure leaves bodies out, they would hide the sheet.
        let is_hidden = self.view.bodies.len() < bodies.len();
        let alt = format!("Figure {figure}, {label}, at the end");
        let (file, end) = (format!("{name}-end.png"), self.thumbnail(&trajectory)?);
        Ok(Play {
            path: format!("{name}.html"),
            choices: if is_hidden { "#bodies=glass" } else { "" }.to_owned(),
            label: label.to_owned(),
            page: replay.to_html()?,
            thumbnail: Picture::file(&file, end, &alt),
        })
    }
}

/// The table of the page.
fn rows(run: &RunSummary) -> Vec<(String, String)> {
    let joules = |e: f64| format!("{e:.2e} J");
    let RunSummary { energy: e, .. } = run;
    let frames = format!("{:.2} s in {} frames", run.time, run.frames);
    let substeps = format!("{}, {} rejected", run.substeps, run.rejected);
    let (iterations, factorisations) = (run.iterations, run.factorisations);
    let solver = format!("{iterations} iterations, {factorisations} factorisations");
    [
        ("time", frames),
        ("sub-steps", substeps),
        ("solver", solver),
        ("wall time", format!("{:.1} s", run.wall)),
        ("largest strain", format!("{:.1e}", run.max_strain)),
        ("smallest gap", super::gap(run.smallest_gap)),
        ("potential energy released", joules(e.released)),
        ("work of bodies and forces", joules(e.work)),
        ("taken out by damping", joules(e.damped)),
        ("lost to friction", joules(e.friction)),
        ("error of the energy balance", joules(e.drift)),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .to_vec()
}
