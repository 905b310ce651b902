//! The frames of a run as a grid of shaded pictures.

use super::{Context, Picture};
use crate::interrupt;
use crate::runs::{self, FigureScene};
use anyhow::{Context as _, Result};
use isosheet_io::Trajectory;
use isosheet_io::picture::{Camera, Image, Labelled, Look, SheetPicture, Solid, montage, render};
use isosheet_mesh::VertexId;

/// How a run is shown.
#[derive(Clone, Debug)]
pub(super) struct View {
    /// Where the viewer is, degrees.
    pub(super) azimuth: f64,
    pub(super) elevation: f64,
    /// Distance of the viewer, metres.
    pub(super) distance: f64,
    /// Pictures in a row.
    pub(super) columns: usize,
    /// Vertices marked with a dot.
    pub(super) pins: Vec<VertexId>,
    /// Bodies to draw, by number.
    pub(super) bodies: &'static [usize],
    /// Bodies are framed down to this depth below the start of the sheet, metres.
    pub(super) depth: f64,
}

/// Frames nearest to the wanted times; a run that ends before half of the last shows four evenly spread.
fn choose(trajectory: &Trajectory, wanted: &[f64]) -> Vec<usize> {
    let times = trajectory.times();
    let end = times.last().copied().unwrap_or(0.0);
    let nearest = |t: f64| {
        let distance = |k: &usize| (times[*k] - t).abs();
        (0..times.len())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(0)
    };
    let last = wanted.last().copied().unwrap_or(0.0);
    if end < 0.5 * last {
        return (0..4).map(|k| nearest(end * f64::from(k) / 3.0)).collect();
    }
    wanted.iter().map(|t| nearest(*t)).collect()
}

/// Height of a thumbnail, pixels.
const THUMBNAIL: usize = 130;

/// A run that has been made, and how it is shown.
#[derive(Clone, Debug)]
pub(super) struct Shown<'a> {
    pub(super) scene: &'a FigureScene,
    pub(super) view: View,
    pub(super) context: &'a Context<'a>,
}

impl Shown<'_> {
    /// The frames nearest to some times (seconds) as a picture.
    pub(super) fn picture(&self, file: &str, alt: &str, times: &[f64]) -> Result<Picture> {
        let trajectory = runs::trajectory(self.context.store, self.scene)?;
        let frames = choose(&trajectory, times);
        let height = self.context.effort.quick_or(170, 470);
        let images = pictures(self.scene, &trajectory, &frames, &self.view, height)?;
        let labelled = images.into_iter().zip(&frames);
        let labelled = labelled.map(|(image, k)| Labelled {
            image,
            label: format!("{:.2} s", trajectory.times()[*k]),
        });
        let all = montage(&labelled.collect::<Vec<_>>(), self.view.columns)?;
        Ok(Picture::file(file, all.to_png()?, alt))
    }

    /// The last frame as a small PNG file.
    pub(super) fn thumbnail(&self, trajectory: &Trajectory) -> Result<Vec<u8>> {
        let last = [trajectory.len() - 1];
        let images = pictures(self.scene, trajectory, &last, &self.view, THUMBNAIL)?;
        Ok(images.first().context("a picture")?.to_png()?)
    }
}

/// The chosen frames, seen by one camera that holds them all.
fn pictures(
    scene: &FigureScene,
    trajectory: &Trajectory,
    frames: &[usize],
    view: &View,
    height: usize,
) -> Result<Vec<Image>> {
    let setup = scene.setup()?;
    let (sheet, bodies) = (setup.sheet, setup.obstacles);
    let states: Vec<&[f64]> = frames
        .iter()
        .map(|k| trajectory.frame(*k).context("frame"))
        .collect::<Result<_>>()?;
    let mut solids = Vec::new();
    for k in frames {
        let t = trajectory.times()[*k];
        let shown = view.bodies.iter().map(|b| Solid::of(&bodies[*b], t));
        solids.push(shown.collect::<Result<Vec<_>, _>>()?);
    }
    let of_sheet = states
        .iter()
        .flat_map(|x| x.as_chunks::<3>().0.iter().copied());
    let of_bodies = solids
        .iter()
        .flatten()
        .flat_map(|s| s.points.iter().copied());
    let of_bodies = of_bodies.map(|[x, y, z]| [x, y, z.max(-view.depth)]);
    let points = of_sheet.chain(of_bodies);
    let camera = Camera::new([0.0; 3], view.azimuth, view.elevation, 1.0, view.distance);
    let aspect = camera.aspect(points.clone());
    let camera = camera.framing(points, aspect, 0.04);
    let look = Look {
        size: [(height as f64 * aspect).round().max(1.0) as usize, height],
        ..Look::default()
    };
    let mut images = Vec::new();
    for (x, solids) in states.iter().zip(&solids) {
        interrupt::check()?;
        let picture = SheetPicture {
            topology: sheet.topology(),
            positions: x,
            pins: &view.pins,
            immobile: &[],
            solids,
        };
        images.push(render(&picture, &camera, &look)?);
    }
    Ok(images)
}
