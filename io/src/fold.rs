//! `isosheet fold`.

use super::composing::Composing;
use super::failure::Done;
use super::fold_options::FoldOptions;
use super::panels::{Pattern, text_of};
use clap::Args;
use isosheet_runs::{FoldVerdict, Recording};
use isosheet_scenes::FoldScene;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  isosheet fold crane.svg --open               fold a crease pattern in the folder crane-run, and look at it
  isosheet fold crane.fold --part 0.8          fold it to four fifths of its angles
  isosheet fold crane.fold --angle 90 --swap   fold it by at most 90 degrees, to the other side
  isosheet fold crane.cp --contact --scene crane.toml
                                               panels touch each other; write the scene that was run
  isosheet fold crane.fold --order 'valleys; 3 7 12; mountains'
                                               three groups of creases, one after the other";

const NOTES: &str = "\
The pattern is a FOLD file, an SVG drawing by the colours of Origami Simulator (black the outline, red mountains, blue
valleys, green cuts, yellow what stays flat, magenta what folds freely; opacity is the fold angle as a part of 180
degrees), a CP file of ORIPA or Oriedita, or an OPX file of ORIPA. Where it gives no angles, mountains and valleys are
folded by 180 degrees. The sheet is of office paper, where nothing else is said, and as large as the file says; of a file
without a unit of length it is 0.2 m long.

Rigid panels are tried first. Where they do not close, the panels are an elastic sheet, then one that is soft in its
plane and stretches on the way, and at last an elastic one whose triangles are divided. The last line says which creases
stay open, which panels bend and stretch, and what stands against the folding, and how large the flat sheet is; notes before it say more. `isosheet convert RUN layers.svg`
draws the layers of what is folded flat with `--contact`.";

/// As many sentences has the last line at most; notes before it have the others.
const SENTENCES: usize = 3;

/// Fold a crease pattern, without a scene file
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES, after_help = NOTES)]
pub(crate) struct Fold {
    /// The crease pattern (FOLD, SVG, CP, OPX)
    pattern: PathBuf,
    #[command(flatten)]
    composing: Composing,
    #[command(flatten)]
    options: FoldOptions,
}

impl Fold {
    pub(crate) fn run(&self) -> Done {
        let format = self.composing.format();
        self.fold().map_err(|failure| failure.in_format(format))
    }

    fn fold(&self) -> Done {
        let pattern = Pattern {
            file: &self.pattern,
            scene: self.composing.scene_path(&self.pattern),
        };
        let (scene, facts) = pattern.rigid(self.options.frame, self.composing.size())?;
        let scene = FoldScene {
            material: self.composing.material_or(&scene.material),
            ..scene
        };
        let scene = self.options.of(scene, facts.sharpest)?;
        self.composing
            .begin_one_of(&self.pattern, &pattern.candidates(&scene)?)?;
        let chosen = pattern.chosen(scene)?;
        let verdict = |recording: &Recording| {
            let verdict = FoldVerdict::of(recording)?;
            let mut words = verdict.in_words(chosen.rigid.as_ref());
            // What no paper does needs no contact to stand against it.
            let obstruction = chosen.obstruction();
            words.extend(obstruction.filter(|_| verdict.unfoldable.is_empty()));
            words.extend(chosen.others());
            let more = words.split_off(SENTENCES.min(words.len()));
            let notes: String = more
                .iter()
                .map(|words| format!("note: {words}\n"))
                .collect();
            let words = words.join(" ");
            let words = words.trim_end_matches('.');
            let size = facts.size_in_words();
            Some(format!("{notes}folded: {words}; the flat sheet is {size}."))
        };
        let text = text_of(&chosen.scene)?;
        self.composing.run(&self.pattern, text, verdict)
    }
}
