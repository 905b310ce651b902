//! `gallery`: scenes that anybody can run, each as a labelled picture, and a film of one of them.
//!
//! `xtask/gallery.toml` says which, and how they are shown. It is read when the command runs, so that the
//! runs that are there are drawn anew without a build.

use crate::progress::Progress;
use crate::report::Options;
use crate::runs::{FigureScene, recorded};
use crate::store::Store;
use anyhow::{Context, Result};
use clap::Args;
use isosheet_films::{Film, FilmOptions, Viewpoint};
use isosheet_pictures::{Labelled, montage};
use isosheet_runs::Recording;
use serde::Deserialize;
use std::fs;

/// Arguments of `gallery`.
#[derive(Debug, Args)]
pub(crate) struct GalleryArgs {
    #[command(flatten)]
    options: Options,
}

/// What is shown.
const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/gallery.toml");

/// The gallery.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Gallery {
    /// Pictures in a row.
    columns: usize,
    /// Width and height of one, pixels.
    size: [usize; 2],
    film: Filmed,
    picture: Vec<Shown>,
}

/// The film.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Filmed {
    /// The scene of a picture.
    scene: String,
    /// From the start to this part of the run.
    until: f64,
    /// Frames of it.
    frames: usize,
    /// Width and height, pixels.
    size: [usize; 2],
}

/// A scene, and how it is shown.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Shown {
    /// `--kind` of `isosheet new`, or the name of a file of `xtask/scenes`.
    scene: String,
    /// What is written below the picture.
    label: String,
    /// Edits of the scene, as `--set` of `isosheet simulate` makes them.
    #[serde(default)]
    set: Vec<String>,
    /// Where the viewer is: azimuth and elevation, degrees.
    view: [f64; 2],
    /// The moment that is shown, as a part of the run.
    moment: f64,
    /// Obstacles that are drawn, by number; all if left out.
    bodies: Option<Vec<usize>>,
}

impl Gallery {
    fn read() -> Result<Self> {
        let text = fs::read_to_string(FILE).context(FILE)?;
        toml::from_str(&text).context(FILE)
    }
}

/// Runs the command.
pub(crate) fn run(args: &GalleryArgs) -> Result<()> {
    let store = args.options.open("gallery")?;
    let gallery = Gallery::read()?;
    for shown in &gallery.picture {
        recorded(&store, &shown.scene(&store)?)?;
    }
    let bar = Progress::start("pictures", gallery.picture.len());
    let mut pictures = Vec::new();
    for shown in &gallery.picture {
        let run = shown.recording(&store)?;
        let frame = at(&run, shown.moment);
        let image = shown.film(&run, vec![frame], gallery.size)?.picture(0)?;
        let label = shown.label.clone();
        pictures.push(Labelled { image, label });
        bar.step();
    }
    let all = montage(&pictures, gallery.columns);
    store.write("gallery.png", &all.to_png()?)?;
    let Filmed {
        scene,
        until,
        frames,
        size,
    } = &gallery.film;
    let shown = gallery.picture.iter().find(|shown| shown.scene == *scene);
    let shown =
        shown.with_context(|| format!("the film shows {scene}, of which there is no picture"))?;
    let run = shown.recording(&store)?;
    let part = |k: usize| until * k as f64 / (frames - 1).max(1) as f64;
    let chosen = (0..*frames).map(|k| at(&run, part(k))).collect();
    let film = shown.film(&run, chosen, *size)?.animation(|_| ())?;
    store.write("film.png", &film)?;
    bar.finish("drawn");
    for file in ["gallery.png", "film.png"] {
        println!("{}", store.path(file).display());
    }
    Ok(())
}

/// The frame at a part of a run.
fn at(run: &Recording, part: f64) -> usize {
    let last = run.trajectory.len().saturating_sub(1);
    (part * last as f64).round() as usize
}

impl Shown {
    fn scene(&self, store: &Store) -> Result<FigureScene> {
        let quick = ["stop.time=0.1".to_owned()];
        let edits = [&self.set[..], store.effort.quick_or(&quick[..], &[])].concat();
        FigureScene::named(&self.scene, &self.scene.replace('/', "-"), &edits)
    }

    /// What is shown of the run: some of the obstacles, and no marks at supports.
    fn recording(&self, store: &Store) -> Result<Recording> {
        let mut run = recorded(store, &self.scene(store)?)?;
        if let Some(bodies) = &self.bodies {
            let mut number = 0..;
            run.obstacles
                .retain(|_| number.next().is_some_and(|k| bodies.contains(&k)));
        }
        run.pins.clear();
        run.immobile.clear();
        Ok(run)
    }

    fn film<'a>(
        &self,
        run: &'a Recording,
        frames: Vec<usize>,
        size: [usize; 2],
    ) -> Result<Film<'a>> {
        let [azimuth, elevation] = self.view;
        let options = FilmOptions {
            width: Some(size[0]),
            height: size[1],
            view: Some(Viewpoint { azimuth, elevation }),
            ..FilmOptions::default()
        };
        Ok(Film::new(run, frames, &options)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_there_with_the_bodies_that_are_drawn() {
        let folder = tempfile::tempdir().unwrap();
        let (effort, remake) = (crate::report::Effort::Quick, crate::store::Remake::Never);
        let store = Store::open(folder.path(), "gallery", effort, remake).unwrap();
        let gallery = Gallery::read().unwrap();
        for shown in &gallery.picture {
            let bodies = shown
                .scene(&store)
                .unwrap()
                .setup()
                .unwrap()
                .obstacles
                .clone();
            for body in shown.bodies.iter().flatten() {
                assert!(*body < bodies.len(), "{}: {body}", shown.scene);
            }
        }
        let filmed = |shown: &Shown| shown.scene == gallery.film.scene;
        assert!(gallery.picture.iter().any(filmed));
    }
}
