//! Figs. 11 and 12: a sheet of paper held at a corner falls and crumples.

use super::{Context, Effort, Made, Picture};
use crate::interrupt;
use crate::render::{Camera, Labelled, Look, SheetPicture, montage, render};
use crate::runs::{self, RunSummary, Scene};
use anyhow::{Context as _, Result};
use isosheet_io::Trajectory;
use serde_json::json;

/// Times of the pictures, seconds. The fall takes the first third of a second; then the sheet swings, crumples and comes to
/// rest.
const TIMES: [f64; 10] = [0.0, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.6, 8.0];

/// The scene of the figure with mesh M^level.
pub(crate) fn scene(level: u32, effort: Effort) -> Scene {
    match effort {
        Effort::Full => Scene::paper(level, 480),
        Effort::Quick => Scene::paper(level, 12),
    }
}

pub(super) fn make(figure: u8, level: u32, context: &Context<'_>) -> Result<Made> {
    let scene = scene(level, context.effort);
    let summary = runs::ensure(context.store, &scene)?;
    let file = format!("fig{figure:02}.png");
    let mut pictures = vec![picture(file, &scene, context)?];
    if figure == 12 && context.effort == Effort::Full {
        let finer = self::scene(3, context.effort);
        runs::ensure(context.store, &finer)?;
        pictures.push(picture("fig12-m3.png".into(), &finer, context)?);
    }
    let (mut tables, mut softness) = (Vec::new(), serde_json::Value::Null);
    if figure == 12 {
        let part = super::softness::make(context)?;
        pictures.push(part.picture);
        tables.push(part.table);
        softness = part.facts;
    }
    Ok(Made {
        title: if level == 1 {
            "Crumpled paper, M¹"
        } else {
            "Crumpled paper, M²"
        },
        paper: if level == 1 {
            "A piece of paper modelled by M¹ is held at its left-upper corner, falls and crumples."
        } else {
            "The same with the finer mesh M², which looks softer, as more degrees of freedom let it be."
        },
        measured: describe(&summary, figure, context.effort),
        pictures,
        tables,
        facts: json!({ "run": serde_json::to_value(&summary)?, "softness": softness }),
    })
}

fn describe(s: &RunSummary, figure: u8, effort: Effort) -> String {
    let scene = &s.scene;
    let end = match effort {
        Effort::Full => format!(
            "At the end the kinetic energy is {:.0e} of the potential energy released; the centre of mass hangs {:.3} sides below \
             the pin (a rigid plate: {:.3}).",
            s.motion_left,
            s.shape.centre_depth,
            runs::PLATE
        ),
        Effort::Quick => "Cut short.".to_owned(),
    };
    let finer = if figure == 12 && effort == Effort::Full {
        " Below it the same with M³, which the paper does not show, and what softer means in numbers."
    } else {
        ""
    };
    format!(
        "A square of office paper, {:.0} mm, {:.0} g/m² ({:.2} g), lumped masses, {} with velocity damping {:.0}/s, {:.1} s from exactly flat \
         and horizontal; {} frames of 1/60 s with {} rejected steps; largest edge strain {:.0e}. Warm: the side that was above; \
         blue: below. Nothing keeps the sheet from passing through itself in this version. {end}{finer}",
        1e3 * scene.side,
        1e3 * scene.paper,
        1e3 * scene.mass(),
        Scene::method(),
        scene.damping,
        s.time,
        s.frames,
        s.rejected,
        s.max_strain,
    )
}

/// The sequence of a run that has been made.
fn picture(file: String, scene: &Scene, context: &Context<'_>) -> Result<Picture> {
    let trajectory = runs::trajectory(context.store, scene)?;
    let frames = choose(&trajectory);
    Ok(Picture {
        file,
        alt: format!(
            "A sheet of paper held at its left-upper corner falls from flat and crumples, mesh M{}",
            scene.level
        ),
        bytes: sequence(scene, &trajectory, &frames, context.effort)?,
    })
}

/// Frames nearest to the wanted times; a short run shows four evenly spread.
fn choose(trajectory: &Trajectory) -> Vec<usize> {
    let times = trajectory.times();
    let end = times.last().copied().unwrap_or(0.0);
    let nearest = |t: f64| {
        let distance = |k: &usize| (times[*k] - t).abs();
        (0..times.len())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(0)
    };
    if end < 0.5 * TIMES[TIMES.len() - 1] {
        return (0..4).map(|k| nearest(end * f64::from(k) / 3.0)).collect();
    }
    TIMES.iter().map(|t| nearest(*t)).collect()
}

fn sequence(
    scene: &Scene,
    trajectory: &Trajectory,
    frames: &[usize],
    effort: Effort,
) -> Result<Vec<u8>> {
    let sheet = scene.sheet()?;
    let height = match effort {
        Effort::Full => 470,
        Effort::Quick => 170,
    };
    let states: Vec<&[f64]> = frames
        .iter()
        .map(|k| trajectory.frame(*k).context("frame"))
        .collect::<Result<_>>()?;
    let points = states
        .iter()
        .flat_map(|x| x.as_chunks::<3>().0.iter().copied());
    let view = Camera::new([0.0; 3], -62.0, 17.0, scene.side, 6.0 * scene.side);
    let aspect = view.aspect(points.clone());
    let camera = view.framing(points, aspect, 0.04);
    let size = [(height as f64 * aspect).round().max(1.0) as usize, height];
    let look = Look {
        size,
        ..Look::default()
    };
    let mut labelled = Vec::new();
    for (k, x) in frames.iter().zip(&states) {
        interrupt::check()?;
        let picture = SheetPicture {
            topology: sheet.topology(),
            positions: x,
            pins: &[scene.pin()],
        };
        let label = format!("{:.2} s", trajectory.times()[*k]);
        labelled.push(Labelled {
            image: render(&picture, &camera, &look),
            label,
        });
    }
    montage(&labelled, 5).to_png()
}
