//! `isosheet fold`.

use super::composing::Composing;
use super::failure::{Code, Done, Failure};
use super::interrupt;
use super::message::print_progress;
use super::progress::{LINES, go_on};
use crate::MeshOptions;
use crate::format::read_mesh_with;
use crate::run::{FoldTrial, FoldVerdict, Recording};
use crate::scene::{FoldResidual, FoldScene, Panels, SceneFile, Touch, bounds};
use clap::Args;
use std::path::PathBuf;
use std::time::Instant;

const EXAMPLES: &str = "\
Examples:
  isosheet fold crane.svg --open               fold a crease pattern in the folder crane-run, and look at it
  isosheet fold crane.fold --part 0.8          fold it to four fifths of its angles
  isosheet fold crane.cp --contact -o crane.toml
                                               panels touch each other; write the scene that was run";

const NOTES: &str = "\
The pattern is a FOLD file, an SVG drawing by the colours of Origami Simulator (black the outline, red mountains, blue
valleys, green cuts, yellow what stays flat, magenta what folds freely; opacity is the fold angle as a part of 180
degrees), a CP file of ORIPA or Oriedita, or an OPX file of ORIPA. Where it gives no angles, mountains and valleys are
folded by 180 degrees. The sheet is of office paper and 0.2 m long, where nothing else is said.

Rigid panels are tried first. Where they do not close, the panels are an elastic sheet, then one that is soft in its
plane and stretches on the way, and at last an elastic one whose triangles are divided. The last line says which it was, which panels
bend and stretch, and which creases stay open.";

/// Fold a crease pattern, without a scene file
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES, after_help = NOTES)]
pub(crate) struct Fold {
    /// The crease pattern (FOLD, SVG, CP, OPX)
    pattern: PathBuf,
    #[command(flatten)]
    composing: Composing,
    /// Which part of its angle each crease is folded by, above 0 and at most 1
    #[arg(long, value_name = "PART", default_value_t = 1.0, value_parser = part)]
    part: f64,
    /// Panels touch each other, and do not pass through each other
    #[arg(long)]
    contact: bool,
    /// Which frame of a FOLD file, by its number from 0 [default: the first one with vertices]
    #[arg(long, value_name = "NUMBER")]
    frame: Option<usize>,
}

/// A number from 0 to 1 that is not 0.
fn part(text: &str) -> Result<f64, String> {
    let part: Option<f64> = text.parse().ok();
    part.filter(|p| *p > 0.0 && *p <= 1.0)
        .ok_or_else(|| "give a number above 0 and at most 1".to_owned())
}

/// The material and the longest side (metres) of a sheet of which nothing is said.
const MATERIAL: &str = "office paper";
const SIZE: f64 = 0.2;

/// Creases that are so far from their angles in the mean, degrees, are closed: no other panels are tried.
const CLOSED: f64 = 1.0;

/// At most so far no further panels are tried, degrees.
const WELL: f64 = 5.0;

/// Faces of an elastic sheet whose panels are divided, at most.
const MOST_FACES: usize = 3000;

impl Fold {
    pub(crate) fn run(&self) -> Done {
        let format = self.composing.format();
        self.fold().map_err(|failure| failure.in_format(format))
    }

    fn fold(&self) -> Done {
        let scene = self.composed()?;
        self.composing.begin(&self.pattern)?;
        let (scene, rigid) = self.chosen(scene)?;
        let verdict = |recording: &Recording| {
            let verdict = FoldVerdict::of(recording)?;
            Some(verdict.in_words(rigid.as_ref()))
        };
        self.composing.run(&self.pattern, text_of(&scene)?, verdict)
    }

    /// The scene of rigid panels.
    fn composed(&self) -> Result<FoldScene, Failure> {
        let options = MeshOptions {
            frame: self.frame.map(crate::FoldFrame::Number),
            ..MeshOptions::default()
        };
        let mesh = read_mesh_with(&self.pattern, &options);
        let mesh = mesh.map_err(|e| Failure::of(Code::Input, &e))?;
        if mesh.creases.is_empty() {
            let message = format!("{} has no creases", self.pattern.display());
            let remedy = "give a crease pattern: a FOLD, SVG, CP or OPX file";
            return Err(Failure::new(Code::Input, message).remedy(remedy));
        }
        if !mesh.changes.is_nothing() {
            print_progress(format_args!("note: {}", mesh.changes));
        }
        let [low, high] = bounds(mesh.positions.as_chunks::<3>().0);
        let side = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        if side <= 0.0 {
            let message = format!("{} has no extent", self.pattern.display());
            return Err(Failure::new(Code::Input, message).remedy("correct its coordinates"));
        }
        let size = self.composing.size().unwrap_or(SIZE);
        Ok(FoldScene {
            pattern: self
                .composing
                .named_from_scene(&self.pattern, &self.pattern)?,
            frame: self.frame,
            scale: size / side,
            size,
            material: self.composing.material_or(MATERIAL),
            panels: Panels::Rigid,
            part: self.part,
            touch: match self.contact {
                true => Touch::Touches,
                false => Touch::Passes,
            },
        })
    }

    /// The scene whose panels close best, and how far rigid ones do; `None` if these do not reach an end.
    fn chosen(&self, rigid: FoldScene) -> Result<(FoldScene, Option<FoldResidual>), Failure> {
        let first = self.tried(&rigid)?;
        let residual = first.map(|trial| trial.residual);
        let closes = |trial: &FoldTrial, rms: f64| {
            let FoldTrial {
                residual: r,
                strain,
            } = *trial;
            let is_of_paper = 100.0 * strain <= FoldVerdict::STRETCHES;
            is_of_paper && r.rms <= rms && r.largest <= 5.0 * rms
        };
        let mut best = (first, rigid.clone());
        if first.is_some_and(|trial| closes(&trial, CLOSED)) {
            return Ok((rigid, residual));
        }
        let faces = self.parsed(&rigid)?.build()?;
        let faces = faces.model.topology().face_count();
        let refined = (faces * 4 <= MOST_FACES).then_some(Panels::Elastic { refine: 1 });
        let others = [
            Some(Panels::Elastic { refine: 0 }),
            Some(Panels::Soft),
            refined,
        ];
        for panels in others.into_iter().flatten() {
            let scene = FoldScene {
                panels,
                ..rigid.clone()
            };
            let found = self.tried(&scene)?;
            let rank = |trial: Option<FoldTrial>| match trial {
                Some(trial) => (!closes(&trial, WELL), trial.error()),
                None => (true, f64::INFINITY),
            };
            let is_first = best.1.panels == Panels::Rigid && best.0.is_none();
            if is_first || rank(found) < rank(best.0) {
                best = (found, scene);
            }
            if best.0.is_some_and(|trial| closes(&trial, WELL)) {
                break;
            }
        }
        Ok((best.1, residual))
    }

    fn parsed(&self, scene: &FoldScene) -> Result<SceneFile, Failure> {
        self.composing.parsed(&self.pattern, text_of(scene)?)
    }

    /// How far the creases of a scene are from their angles in the end, without contact.
    fn tried(&self, scene: &FoldScene) -> Result<Option<FoldTrial>, Failure> {
        let alone = FoldScene {
            touch: Touch::Passes,
            ..scene.clone()
        };
        let what = match scene.panels {
            Panels::Rigid => "rigid panels",
            Panels::Elastic { refine: 0 } => "elastic panels",
            Panels::Elastic { .. } => "elastic panels with divided triangles",
            Panels::Soft => "soft panels",
        };
        let mut told = Instant::now();
        let mut watch = |done: f64| {
            if told.elapsed() >= LINES {
                told = Instant::now();
                print_progress(format_args!("{what}: {:.0} % of the trial", 100.0 * done));
            }
            go_on()
        };
        let found = self.parsed(&alone)?.folds_to(&mut watch)?;
        if interrupt::requested() {
            return Err(Failure::new(Code::Interrupted, "stopped by Ctrl-C"));
        }
        match found {
            Some(FoldTrial { residual, strain }) => print_progress(format_args!(
                "{what}: creases end {:.1} degrees rms from their angles, with strains of {:.1} % at most",
                residual.rms,
                100.0 * strain
            )),
            None => print_progress(format_args!("{what}: no end is reached")),
        }
        Ok(found)
    }
}

fn text_of(scene: &FoldScene) -> Result<String, Failure> {
    scene.text().map_err(|e| Failure::of(Code::Input, &e))
}
