//! `isosheet hang`.

use super::acting::Acting;
use super::action_scene::{Action, HeldCorners};
use super::action_verdict::ActionVerdict;
use super::failure::Done;
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  isosheet hang towel.obj --open               a sheet swings down from one corner, in the folder towel-run
  isosheet hang towel.obj --by two-corners --material cotton --size 0.8";

const NOTES: &str = "\
The sheet is any mesh file that a scene reads (OBJ, PLY, STL, OFF, glTF, FOLD ...), or a drawing (SVG, DXF), which is
meshed. A flat one begins level, and swings down from the vertices that are nearest to corners of the box about it. It
is of office paper, and its longest side 0.2 m, where nothing else is said; a drawing has its own size. Faces of a
coarse mesh are divided. The run ends when the sheet is at rest, or after a time. The last line says how far it
hangs.";

/// Hang a sheet by its corners, without a scene file
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES, after_help = NOTES)]
pub(crate) struct Hang {
    #[command(flatten)]
    acting: Acting,
    /// What holds it
    #[arg(long, value_enum, default_value_t = HeldCorners::Corner)]
    by: HeldCorners,
}

impl Hang {
    pub(crate) fn run(&self) -> Done {
        let action = |_: &_| Ok(Action::Hang(self.by));
        self.acting
            .run("office paper", 0.2, action, ActionVerdict::hung)
    }
}
