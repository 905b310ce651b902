//! The scene that folds a crease pattern, and which panels it has.

use super::composing::{named_from, parsed};
use super::failure::{Code, Failure};
use super::interrupt;
use super::message::print_progress;
use super::progress::{LINES, go_on};
use isosheet_formats::{EdgeAssignment, FileCrease, MeshOptions, read_mesh_with};
use isosheet_mesh::wording::brief;
use isosheet_runs::{FoldTrial, FoldVerdict, folds_to};
use isosheet_scenes::{FoldResidual, FoldScene, Panels, SceneFile, Touch, size as extent};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A crease pattern, and the file of the scene that folds it, which need not exist.
#[derive(Debug)]
pub(super) struct Pattern<'a> {
    pub(super) file: &'a Path,
    pub(super) scene: PathBuf,
}

/// What the command needs to know of a pattern.
#[derive(Clone, Copy, Debug)]
pub(super) struct PatternFacts {
    /// The angle that its sharpest creases are folded by, degrees.
    pub(super) sharpest: f64,
    /// Its width and height as it is folded, metres.
    pub(super) size: [f64; 2],
}

impl PatternFacts {
    /// Its size in words: in millimetres up to a metre, as drawings have them.
    pub(super) fn size_in_words(&self) -> String {
        let (factor, unit) = match self.size.iter().all(|length| *length < 1.0) {
            true => (1e3, "mm"),
            false => (1.0, "m"),
        };
        let [width, height] = self.size.map(|length| brief(factor * length));
        format!("{width} by {height} {unit}")
    }
}

/// The angle of the sharpest creases, degrees: mountains and valleys without one are folded by 180.
fn sharpest(creases: &[FileCrease]) -> f64 {
    let angles = creases.iter().map(|crease| match crease.assignment {
        EdgeAssignment::Mountain | EdgeAssignment::Valley => crease.angle.unwrap_or(PI).abs(),
        _ => crease.angle.unwrap_or(0.0).abs(),
    });
    let largest = angles.fold(0.0, f64::max).to_degrees();
    if largest > 0.0 { largest } else { 180.0 }
}

/// The width and the height of positions (three numbers for each vertex).
fn extents(positions: &[f64]) -> [f64; 2] {
    [0, 1].map(|axis| {
        let values = || positions.iter().skip(axis).step_by(3).copied();
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    })
}

/// The material and the longest side (metres) of a sheet of which neither the file nor the command says them.
const MATERIAL: &str = "office paper";
const SIZE: f64 = 0.2;

/// Creases that are so far from their angles in the mean, degrees, are closed: no other panels are tried.
const CLOSED: f64 = 1.0;

/// At most so far no panels with divided triangles are tried, degrees.
const WELL: f64 = 5.0;

/// How stiff soft panels are in their plane ([`Panels::Soft`]): for office paper of 0.2 m a hundred newton a
/// metre, of which paper itself has 3000 times as much, and thirty.
const SOFT: [u32; 2] = [8000, 2400];

/// The panels that are tried after rigid ones, and how far creases may be from their angles, degrees in the
/// mean, for these not to be tried.
const OTHERS: [(Panels, f64); 4] = [
    (Panels::Elastic { refine: 0 }, CLOSED),
    (Panels::Soft { stiffness: SOFT[0] }, CLOSED),
    (Panels::Soft { stiffness: SOFT[1] }, CLOSED),
    (Panels::Elastic { refine: 1 }, WELL),
];

/// Faces of an elastic sheet whose panels are divided, at most.
const MOST_FACES: usize = 3000;

/// The scene whose panels close best, and what was found before it was chosen.
#[derive(Clone, Debug)]
pub(super) struct Chosen {
    pub(super) scene: FoldScene,
    /// How far rigid panels close; `None` if they do not reach an end.
    pub(super) rigid: Option<FoldResidual>,
    /// Panels that stretch, whose creases end nearer to their angles, and where they end, if there are any.
    pub(super) nearer: Option<(Panels, FoldTrial)>,
    /// Where the same pattern ends without contact, if panels with contact do not close.
    pub(super) untouched: Option<FoldTrial>,
}

impl Chosen {
    /// Which other panels end nearer to their angles, a sentence.
    pub(super) fn others(&self) -> Option<String> {
        let (panels, trial) = self.nearer?;
        Some(format!(
            "With {} creases end nearer to their angles, {:.1} degrees rms, with strains of {:.0} %.",
            named(panels),
            trial.residual.rms,
            100.0 * trial.strain
        ))
    }

    /// Why panels with contact do not close that do without, a sentence.
    pub(super) fn obstruction(&self) -> Option<String> {
        let FoldTrial {
            residual, passing, ..
        } = self.untouched.filter(|trial| closes(trial, WELL))?;
        let order = match self.scene.order.is_empty() {
            true => "all creases fold at once",
            false => "creases fold in this order",
        };
        Some(format!(
            "Panels are in each other's way as {order}: without contact they pass through each other \
             from {:.0} % of the folding on, and creases end {:.1} degrees rms from their angles.",
            100.0 * passing?,
            residual.rms
        ))
    }
}

impl Pattern<'_> {
    /// The scene of rigid panels of a size (metres) if one is given, and what the pattern is like.
    pub(super) fn rigid(
        &self,
        frame: Option<usize>,
        size: Option<f64>,
    ) -> Result<(FoldScene, PatternFacts), Failure> {
        let options = MeshOptions {
            frame: frame.map(isosheet_formats::FoldFrame::Number),
            ..MeshOptions::default()
        };
        let mesh = read_mesh_with(self.file, &options);
        let mesh = mesh.map_err(|e| Failure::of(Code::Input, &e))?;
        if mesh.creases.is_empty() {
            let message = format!("{} has no creases", self.file.display());
            let remedy = "give a crease pattern: a FOLD, SVG, CP or OPX file";
            return Err(Failure::new(Code::Input, message).remedy(remedy));
        }
        if let Some(did) = mesh.what_reading_did() {
            print_progress(format_args!("note: {did}"));
        }
        let side = extent(mesh.positions.as_chunks::<3>().0);
        if side <= 0.0 {
            let message = format!("{} has no extent", self.file.display());
            return Err(Failure::new(Code::Input, message).remedy("correct its coordinates"));
        }
        let size = size.unwrap_or_else(|| {
            if mesh.in_metres {
                return side;
            }
            print_progress(format_args!(
                "note: the file has no unit of length, and the longest side of the sheet is {SIZE} m (`--size` says another)"
            ));
            SIZE
        });
        let facts = PatternFacts {
            sharpest: sharpest(&mesh.creases),
            size: extents(&mesh.positions).map(|length| length * size / side),
        };
        let scene = FoldScene {
            pattern: named_from(&self.scene, self.file)?,
            frame,
            scale: size / side,
            size,
            material: MATERIAL.to_owned(),
            panels: Panels::Rigid,
            part: 1.0,
            touch: Touch::Passes,
            order: Vec::new(),
        };
        Ok((scene, facts))
    }

    /// The texts of the scenes of which one is chosen.
    pub(super) fn candidates(&self, rigid: &FoldScene) -> Result<Vec<String>, Failure> {
        let of = |panels: Panels| {
            text_of(&FoldScene {
                panels,
                ..rigid.clone()
            })
        };
        let others = OTHERS.into_iter().map(|(panels, _)| panels);
        std::iter::once(Panels::Rigid)
            .chain(others)
            .map(of)
            .collect()
    }

    /// The scene whose panels close best.
    pub(super) fn chosen(&self, rigid: FoldScene) -> Result<Chosen, Failure> {
        let (chosen, trial) = self.best(rigid)?;
        let closes = trial.is_some_and(|trial| closes(&trial, WELL));
        let untouched = match chosen.scene.touch {
            Touch::Touches if !closes => {
                print_progress(format_args!("without contact:"));
                let free = FoldScene {
                    touch: Touch::Passes,
                    panels: Panels::Rigid,
                    ..chosen.scene.clone()
                };
                self.best(free)?.1
            }
            Touch::Touches | Touch::Passes => None,
        };
        Ok(Chosen {
            untouched,
            ..chosen
        })
    }

    /// The scene whose panels close best, with its trial.
    fn best(&self, rigid: FoldScene) -> Result<(Chosen, Option<FoldTrial>), Failure> {
        let first = self.tried(&rigid)?;
        let residual = first.map(|trial| trial.residual);
        let mut best = (first, rigid.clone());
        let chosen = |scene, nearer| Chosen {
            scene,
            rigid: residual,
            nearer,
            untouched: None,
        };
        if first.is_some_and(|trial| closes(&trial, CLOSED)) {
            return Ok((chosen(rigid, None), first));
        }
        let mut nearest = first.map(|trial| (Panels::Rigid, trial));
        let faces = self.parsed(&rigid)?.build()?;
        let faces = faces.model.topology().face_count();
        let is_coarse = |panels: &Panels| match panels {
            Panels::Elastic { refine } => faces << (2 * refine) <= MOST_FACES || *refine == 0,
            Panels::Rigid | Panels::Soft { .. } => true,
        };
        for (panels, enough) in OTHERS.into_iter().filter(|(panels, _)| is_coarse(panels)) {
            if best.0.is_some_and(|trial| closes(&trial, enough)) {
                break;
            }
            let scene = FoldScene {
                panels,
                ..rigid.clone()
            };
            let found = self.tried(&scene)?;
            let rms = |trial: &FoldTrial| trial.residual.rms;
            if let Some(trial) = found
                && nearest.is_none_or(|(_, known)| rms(&trial) < rms(&known))
            {
                nearest = Some((panels, trial));
            }
            let rank = |trial: Option<FoldTrial>| match trial {
                Some(trial) => (!closes(&trial, WELL), trial.error()),
                None => (true, f64::INFINITY),
            };
            // Soft panels come to an end, if it takes longer.
            let is_only = best.0.is_none() && matches!(panels, Panels::Soft { .. });
            if is_only || rank(found) < rank(best.0) {
                best = (found, scene);
            }
        }
        let (trial, scene) = best;
        let is_nearer = |(_, other): &(Panels, FoldTrial)| {
            trial.is_some_and(|trial| other.residual.rms < trial.residual.rms - CLOSED)
        };
        Ok((chosen(scene, nearest.filter(is_nearer)), trial))
    }

    fn parsed(&self, scene: &FoldScene) -> Result<SceneFile, Failure> {
        parsed(&self.scene, text_of(scene)?)
    }

    /// How far the creases of a scene are from their angles in the end.
    fn tried(&self, scene: &FoldScene) -> Result<Option<FoldTrial>, Failure> {
        let what = named(scene.panels);
        let mut told = Instant::now();
        let mut watch = |done: f64| {
            if told.elapsed() >= LINES {
                told = Instant::now();
                print_progress(format_args!("{what}: {:.0} % of the trial", 100.0 * done));
            }
            go_on()
        };
        let found = folds_to(&self.parsed(scene)?, &mut watch)?;
        if interrupt::requested() {
            return Err(Failure::new(Code::Interrupted, "stopped by Ctrl-C"));
        }
        match found {
            Some(FoldTrial {
                residual, strain, ..
            }) => print_progress(format_args!(
                "{what}: creases end {:.1} degrees rms from their angles, with strains of {:.1} % at most",
                residual.rms,
                100.0 * strain
            )),
            None => print_progress(format_args!("{what}: no end is reached")),
        }
        Ok(found)
    }
}

/// What panels are, in words.
fn named(panels: Panels) -> &'static str {
    match panels {
        Panels::Rigid => "rigid panels",
        Panels::Elastic { refine: 0 } => "elastic panels",
        Panels::Elastic { .. } => "elastic panels with divided triangles",
        Panels::Soft { stiffness } if stiffness == SOFT[0] => "soft panels",
        Panels::Soft { .. } => "softer panels",
    }
}

/// Whether creases end so near their angles (degrees in the mean) without stretched panels.
fn closes(trial: &FoldTrial, rms: f64) -> bool {
    let FoldTrial {
        residual: r,
        strain,
        ..
    } = *trial;
    let is_of_paper = 100.0 * strain <= FoldVerdict::STRETCHES;
    is_of_paper && r.rms <= rms && r.largest <= 5.0 * rms
}

/// The text of a scene.
pub(super) fn text_of(scene: &FoldScene) -> Result<String, Failure> {
    scene.text().map_err(|e| Failure::of(Code::Input, &e))
}
