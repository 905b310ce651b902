//! `isosheet drape`.

use super::acting::Acting;
use super::action_scene::{Action, Below, DrapedBody, SheetSource};
use super::action_verdict::ActionVerdict;
use super::composing::length;
use super::failure::{Done, Failure};
use super::given::{Given, GivenSheet, moments, scaled};
use clap::Args;
use isosheet_scenes::{bounds, size as extent};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  isosheet drape cloth.obj --open              a tablecloth falls on a round table, in the folder cloth-run
  isosheet drape cloth.obj --on vase.glb --material cotton
                                               over a body, which has the unit of the cloth
  isosheet drape napkin.svg --scene napkin.toml
                                               the sheet of a drawing; write the scene that was run";

const NOTES: &str = "\
The sheet is any mesh file that a scene reads (OBJ, PLY, STL, OFF, glTF, FOLD ...), or a drawing (SVG, DXF), which is
meshed. A flat one lies on its face, the centre of its area above that of the table or of the body, and falls. It is of polycarbonate
film, and its longest side 0.5 m, where nothing else is said; a drawing has its own size. Faces of a coarse mesh are
divided. The run ends when the sheet is at rest, or after a time. The last line says how deep the hem hangs.";

/// Let a sheet fall on a table or a body, without a scene file
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES, after_help = NOTES)]
pub(crate) struct Drape {
    #[command(flatten)]
    acting: Acting,
    /// The body that it falls on: a mesh file
    #[arg(long, value_name = "TOOL")]
    on: Option<PathBuf>,
    /// It falls on a round table, six tenths as wide as the sheet, as it does without `--on`
    #[arg(long, conflicts_with = "on")]
    table: bool,
    /// A floor below the body, on which the hem may lie
    #[arg(long)]
    floor: bool,
    /// The longest side of the body, such as 300mm [default: it has the unit of the sheet, and metres where
    /// that is a drawing]
    #[arg(long, value_name = "LENGTH", value_parser = length, requires = "on")]
    tool_size: Option<f64>,
}

/// The body may be so many times longer or shorter than the sheet: what is beyond that has another unit.
const LARGEST: f64 = 50.0;

impl Drape {
    pub(crate) fn run(&self) -> Done {
        let below = match self.floor {
            true => Below::Floor,
            false => Below::Nothing,
        };
        let action = |sheet: &GivenSheet| Ok(Action::Drape(self.body(sheet)?, below));
        self.acting
            .run("polycarbonate film", 0.5, action, ActionVerdict::draped)
    }

    fn body(&self, sheet: &GivenSheet) -> Result<DrapedBody, Failure> {
        let Some(tool) = &self.on else {
            return Ok(DrapedBody::Table);
        };
        let given = Given::read(tool, self.acting.up())?;
        let scale = match (self.tool_size, &sheet.source) {
            (Some(size), _) => size / extent(&given.positions),
            (None, SheetSource::File(file)) => file.scale,
            (None, SheetSource::Drawing(_)) => 1.0,
        };
        let positions = scaled(&given.positions, scale);
        let [of_body, of_sheet] = [&positions, &sheet.positions].map(|p| extent(p));
        if of_body > LARGEST * of_sheet || of_sheet > LARGEST * of_body {
            let message = format!(
                "{} is {of_body:.3} m long beside a sheet of {of_sheet:.3} m, as if it had another unit",
                tool.display()
            );
            let remedy = match self.tool_size {
                None => "say how long it is by `--tool-size`",
                Some(_) => "give another length by `--tool-size`, or of the sheet by `--size`",
            };
            return Err(Failure::misuse(message).remedy(remedy));
        }
        let path = self
            .acting
            .composing
            .named_from_scene(&self.acting.mesh, tool)?;
        Ok(DrapedBody::Tool {
            file: given.file(&path, scale),
            centre: moments(tool, &positions, &given.faces)?.centre,
            heights: bounds(&positions).map(|corner| corner[2]),
        })
    }
}
