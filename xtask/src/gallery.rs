//! `gallery`: scenes that anybody can run, each as a labelled picture, and a film of one of them.

use crate::draw::Viewpoint;
use crate::figures::shots;
use crate::progress::Progress;
use crate::report::Options;
use crate::runs::{FigureScene, Run};
use crate::store::Store;
use anyhow::{Context, Result};
use clap::Args;
use isosheet_io::picture::{Labelled, animated_png, montage};

/// Arguments of `gallery`.
#[derive(Debug, Args)]
pub(crate) struct GalleryArgs {
    #[command(flatten)]
    options: Options,
}

/// A scene, and how it is shown.
struct Shown {
    /// `--kind` of `isosheet new`, or the name of a file of `xtask/scenes`.
    scene: &'static str,
    /// What is written below the picture.
    label: &'static str,
    /// Where the viewer is, degrees.
    seen_from: [f64; 2],
    /// The moment that is shown, as a part of the run.
    moment: f64,
    /// Bodies that are drawn, by number.
    bodies: &'static [usize],
}

/// Scene, label, azimuth and elevation, moment and bodies, as [`Shown`] has them.
type GalleryRow = (&'static str, &'static str, [f64; 2], f64, &'static [usize]);

/// The scenes in the order of the picture.
const SCENES: [GalleryRow; 20] = [
    ("drape", "new --kind drape", [-62.0, 24.0], 1.0, &[0]),
    ("stamp", "new --kind stamp", [-65.0, 20.0], 1.0, &[0, 1, 2]),
    ("feed", "new --kind feed", [-70.0, 18.0], 1.0, &[1]),
    ("fig12", "fig12: crumpling", [-62.0, 17.0], 0.125, &[]),
    ("fig13", "fig13: stamping", [-58.0, 30.0], 1.0, &[0, 1]),
    (
        "fig15-rings",
        "fig15-rings: draping",
        [-62.0, 24.0],
        1.0,
        &[0],
    ),
    ("fig16", "fig16: a paper jam", [-72.0, 12.0], 1.0, &[0, 2]),
    ("fig17", "fig17: Miura's folds", [-58.0, 38.0], 0.5, &[]),
    ("clamp", "new --kind clamp", [-62.0, 17.0], 1.0, &[]),
    ("flag", "new --kind flag", [-50.0, 17.0], 0.42, &[]),
    ("leaf", "new --kind leaf", [-62.0, 24.0], 0.4, &[]),
    ("stack", "new --kind stack", [-60.0, 20.0], 0.9, &[1]),
    ("moebius", "new --kind moebius", [-62.0, 30.0], 1.0, &[]),
    ("hypar", "new --kind hypar", [-62.0, 25.0], 1.0, &[]),
    ("hammock", "new --kind hammock", [-62.0, 25.0], 1.0, &[]),
    ("vase", "new --kind vase", [-62.0, 22.0], 0.6, &[0]),
    (
        "book",
        "book: opened by its cover",
        [-60.0, 20.0],
        0.5,
        &[0],
    ),
    ("roller", "roller: driven by paper", [-60.0, 15.0], 1.0, &[]),
    ("pillow", "new --kind pillow", [-62.0, 25.0], 1.0, &[]),
    ("peel", "new --kind peel", [-62.0, 20.0], 0.7, &[]),
];

/// All of them.
fn scenes() -> impl Iterator<Item = Shown> {
    SCENES
        .into_iter()
        .map(|(scene, label, seen_from, moment, bodies)| Shown {
            scene,
            label,
            seen_from,
            moment,
            bodies,
        })
}

/// Pictures in a row, and the size of one, pixels.
const COLUMNS: usize = 5;
const SIZE: [usize; 2] = [480, 400];

/// The scene of the film, by its number, its part of the run, and its frames; the size and the time of one
/// (pixels, milliseconds).
const FILMED: usize = 5;
const END: f64 = 0.1;
const FRAMES: usize = 36;
const FILM: [usize; 2] = [368, 276];
const DELAY: u16 = 50;

/// The viewer is so many times as far away as the sheet is large: little perspective.
const DISTANCE: f64 = 6.0;

/// Runs the command.
pub(crate) fn run(args: &GalleryArgs) -> Result<()> {
    let store = args.options.open("gallery")?;
    let mut runs = Vec::new();
    for shown in scenes() {
        runs.push(Run::of(&store, shown.scene(&store)?)?);
    }
    let bar = Progress::start("pictures", SCENES.len() + FRAMES);
    let mut pictures = Vec::new();
    for (shown, run) in scenes().zip(&runs) {
        let last = run.trajectory.len() - 1;
        let frame = (shown.moment * last as f64).round() as usize;
        let shots = shots(run, &[frame], shown.bodies)?;
        let image = shown.view(run).frame(&shots, SIZE)?.remove(0);
        let label = shown.label.to_owned();
        pictures.push(Labelled { image, label });
        bar.step();
    }
    store.write("gallery.png", &montage(&pictures, COLUMNS)?.to_png()?)?;
    let filmed = scenes().zip(&runs).nth(FILMED);
    let (shown, run) = filmed.context("the scene of the film")?;
    let last = END * (run.trajectory.len() - 1) as f64;
    let frame = |k: usize| (last * k as f64 / (FRAMES - 1) as f64).round() as usize;
    let frames: Vec<usize> = (0..FRAMES).map(frame).collect();
    let shots = shots(run, &frames, shown.bodies)?;
    let images = shown.view(run).frame(&shots, FILM)?;
    let film = animated_png(FILM, DELAY, FRAMES, |k| {
        bar.step();
        Ok(images[k].clone())
    })?;
    store.write("film.png", &film)?;
    bar.finish("drawn");
    for file in ["gallery.png", "film.png"] {
        println!("{}", store.path(file).display());
    }
    Ok(())
}

impl Shown {
    fn scene(&self, store: &Store) -> Result<FigureScene> {
        let quick = ["stop.time=0.1".to_owned()];
        let edits = store.effort.quick_or(&quick[..], &[]);
        FigureScene::named(self.scene, self.scene, edits)
    }

    fn view(&self, run: &Run) -> Viewpoint {
        let points = run.sheet.positions().as_chunks::<3>().0;
        let size = (0..3).map(|k| {
            let along = points.iter().map(|p| p[k]);
            along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min)
        });
        let size = size.fold(0.0, f64::max);
        Viewpoint {
            azimuth: self.seen_from[0],
            elevation: self.seen_from[1],
            distance: DISTANCE * size,
            depth: 0.5 * size,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_io::picture::Solid;

    #[test]
    fn every_scene_is_there_with_the_bodies_that_are_drawn() {
        let folder = tempfile::tempdir().unwrap();
        let (effort, remake) = (crate::report::Effort::Quick, crate::store::Remake::Never);
        let store = Store::open(folder.path(), "gallery", effort, remake).unwrap();
        for shown in scenes() {
            let bodies = shown.scene(&store).unwrap().setup().unwrap().obstacles;
            for body in shown.bodies {
                assert!(Solid::of(&bodies[*body], 0.0).is_ok(), "{}", shown.scene);
            }
        }
    }
}
