//! `isosheet crumple`.

use super::acting::Acting;
use super::action_scene::Action;
use super::action_verdict::ActionVerdict;
use super::failure::Done;
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  isosheet crumple letter.obj --open           a sheet of paper is crumpled, in the folder letter-run
  isosheet crumple letter.svg --material 'aluminium foil' --scene letter.toml";

const NOTES: &str = "\
The sheet is any mesh file that a scene reads (OBJ, PLY, STL, OFF, glTF, FOLD ...), or a drawing (SVG, DXF), which is
meshed. Plates push it together from four sides and from above to half of its extent, on a table, and withdraw.
It is of office paper, and its longest side 0.1 m, where nothing else is said; a drawing has its own size. Sharp bends
stay in materials that yield. Faces of a coarse mesh are divided. The last line says how small it is.";

/// Crumple a sheet, without a scene file
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES, after_help = NOTES)]
pub(crate) struct Crumple {
    #[command(flatten)]
    acting: Acting,
}

impl Crumple {
    pub(crate) fn run(&self) -> Done {
        let action = |_: &_| Ok(Action::Crumple);
        self.acting
            .run("office paper", 0.1, action, ActionVerdict::crumpled)
    }
}
