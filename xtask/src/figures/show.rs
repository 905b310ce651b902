//! How a run is shown: its frames as a grid of shaded pictures, and a page that plays it in 3D.

use super::{Picture, Play, nearest, rows};
use crate::draw::{Shot, Viewpoint};
use crate::report::Effort;
use crate::runs::{Run, RunSummary};
use anyhow::Result;
use isosheet_dynamics::immobile_vertices;
use isosheet_mesh::VertexId;
use isosheet_page::Replay;
use isosheet_pictures::DrawnSolid;
use isosheet_runs::replay_of;

/// How a run is shown.
#[derive(Clone, Debug)]
pub(super) struct View {
    pub(super) from: Viewpoint,
    /// Pictures in a row.
    pub(super) columns: usize,
    /// Vertices marked with a dot.
    pub(super) pins: Vec<VertexId>,
    /// Bodies to draw, by number.
    pub(super) bodies: &'static [usize],
}

/// Frames nearest to the wanted times; a run that ends before half of the last shows four evenly spread.
fn choose(times: &[f64], wanted: &[f64]) -> Vec<usize> {
    let end = times.last().copied().unwrap_or(0.0);
    let nearest = |t: f64| nearest(times.iter().copied(), t);
    let last = wanted.last().copied().unwrap_or(0.0);
    if end < 0.5 * last {
        return (0..4).map(|k| nearest(end * f64::from(k) / 3.0)).collect();
    }
    wanted.iter().map(|t| nearest(*t)).collect()
}

/// Frames of a run with some of its bodies, by number.
///
/// # Errors
/// As [`FigureScene::setup`](crate::runs::FigureScene::setup); a body that cannot be drawn.
fn shots<'a>(run: &'a Run, frames: &[usize], bodies: &[usize]) -> Result<Vec<Shot<'a>>> {
    let all = run.scene.setup()?.obstacles.clone();
    let shot = |&k: &usize| {
        let t = run.trajectory.times()[k];
        let solids = bodies.iter().map(|b| DrawnSolid::of(&all[*b], t));
        Ok(Shot {
            sheet: &run.sheet,
            x: run.trajectory.frame(k).unwrap_or_default(),
            pins: &[],
            solids: solids.collect::<Result<_, _>>()?,
            label: format!("{t:.2} s"),
        })
    };
    frames.iter().map(shot).collect()
}

/// Height of a thumbnail, pixels.
const THUMBNAIL: usize = 130;

impl View {
    fn shots<'a>(&'a self, run: &'a Run, frames: &[usize]) -> Result<Vec<Shot<'a>>> {
        let shots = shots(run, frames, self.bodies)?.into_iter();
        let pins = &self.pins[..];
        Ok(shots.map(|shot| Shot { pins, ..shot }).collect())
    }

    /// The frames of a run nearest to some times (seconds) as a picture.
    pub(super) fn picture(
        &self,
        run: &Run,
        effort: Effort,
        [file, alt]: [&str; 2],
        times: &[f64],
    ) -> Result<Picture> {
        let shots = self.shots(run, &choose(run.trajectory.times(), times))?;
        self.montage(shots, effort, [file, alt])
    }

    /// The last frames of runs, which have labels, as a picture.
    pub(super) fn ends(
        &self,
        runs: &[(String, &Run)],
        effort: Effort,
        texts: [&str; 2],
    ) -> Result<Picture> {
        let mut shots = Vec::new();
        for (label, run) in runs {
            for shot in self.shots(run, &[run.trajectory.len() - 1])? {
                let label = label.clone();
                shots.push(Shot { label, ..shot });
            }
        }
        self.montage(shots, effort, texts)
    }

    fn montage(
        &self,
        shots: Vec<Shot<'_>>,
        effort: Effort,
        [file, alt]: [&str; 2],
    ) -> Result<Picture> {
        let height = effort.quick_or(170, 470);
        Picture::shaded(file, &self.from.montage(shots, self.columns, height)?, alt)
    }

    /// The page that plays a run, with what tells it from the other runs of the figure.
    pub(super) fn play(&self, run: &Run, effort: Effort, figure: u8, label: &str) -> Result<Play> {
        let Run {
            scene, trajectory, ..
        } = run;
        let setup = scene.setup()?;
        let immobile = immobile_vertices(&setup.model, &setup.start.x);
        let bodies = &setup.obstacles;
        let quick = effort.quick_or(" --quick", "");
        let replay = Replay {
            title: format!("Figure {figure}: {label}"),
            immobile: immobile.iter().map(|v| v.0).collect(),
            pins: setup.model.pins().iter().map(|v| v.0).collect(),
            summary: rows(&run.summary),
            scene: scene.text().to_owned(),
            reproduce: format!("cargo xtask reproduce-figures --figures {figure}{quick}"),
            ..replay_of(&setup.sheet, bodies, trajectory, &run.history)?
        };
        let name = format!("fig{figure:02}-{}", scene.name());
        // Where the figure leaves bodies out, they would hide the sheet.
        let is_hidden = self.bodies.len() < bodies.len();
        let last = self.shots(run, &[trajectory.len() - 1])?.remove(0);
        let end = self.from.single(last, THUMBNAIL)?;
        let alt = format!("Figure {figure}, {label}, at the end");
        Ok(Play {
            scene: (
                format!("scenes/{}.toml", scene.name()),
                scene.text().to_owned(),
            ),
            path: format!("{name}.html"),
            choices: if is_hidden { "#bodies=glass" } else { "" },
            label: label.to_owned(),
            page: replay.to_html()?,
            thumbnail: Picture::png(&format!("{name}-end.png"), end, &alt),
        })
    }
}

/// The table of the page.
fn rows(run: &RunSummary) -> Vec<(String, String)> {
    let joules = |e: f64| format!("{e:.2e} J");
    let (course, cost, e) = (&run.course, &run.course.cost, &run.energy);
    rows! {
        "time" => format!("{:.2} s in {} frames", course.time, cost.steps),
        "sub-steps" => format!("{}, {} rejected", cost.substeps, cost.rejected),
        "solver" => format!("{} iterations, {} factorisations", cost.iterations, cost.factorisations),
        "wall time" => format!("{:.1} s", cost.wall),
        "CPU time" => format!("{:.1} s", cost.cpu),
        "largest strain" => format!("{:.1e}", course.strain),
        "smallest gap" => super::gap(course.gap),
        "potential energy released" => joules(e.released),
        "work of bodies and forces" => joules(e.work),
        "taken out by damping" => joules(e.damped),
        "lost to friction" => joules(e.friction),
        "dissipated by yielding" => joules(e.plastic),
        "error of the energy balance" => joules(e.drift),
    }
    .into_iter()
    .map(|(name, value): (&str, String)| (name.to_owned(), value))
    .collect()
}
