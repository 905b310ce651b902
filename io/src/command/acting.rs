//! What commands share in which the sheet of a file does one thing.

use super::composing::Composing;
use super::failure::{Code, Done, Failure};
use super::given::GivenSheet;
use crate::run::ActionVerdict;
use crate::scene::{Action, ActionScene, UpAxis};
use clap::Args;
use std::path::PathBuf;

/// A sheet, and how it is run.
#[derive(Debug, Args)]
pub(super) struct Acting {
    /// The sheet: a mesh file or a drawing
    pub(super) mesh: PathBuf,
    #[command(flatten)]
    pub(super) composing: Composing,
    /// The axis that points upwards in the files, other than glTF files, which say it
    #[arg(long, value_name = "AXIS", value_enum, default_value_t)]
    pub(super) up: UpAxis,
}

impl Acting {
    /// Lets a sheet do something: one of a material and a size (metres) where the command line has none.
    pub(super) fn run(
        &self,
        material: &str,
        size: f64,
        action: impl FnOnce(&GivenSheet) -> Result<Action, Failure>,
        words: fn(&ActionVerdict) -> String,
    ) -> Done {
        let acted = self.act(material, size, action, words);
        acted.map_err(|failure| failure.in_format(self.composing.format()))
    }

    fn act(
        &self,
        material: &str,
        size: f64,
        action: impl FnOnce(&GivenSheet) -> Result<Action, Failure>,
        words: fn(&ActionVerdict) -> String,
    ) -> Done {
        let sheet = GivenSheet::read(&self.mesh, &self.composing, self.up, size)?;
        let action = action(&sheet)?;
        self.composing.begin(&self.mesh)?;
        let scene = ActionScene {
            source: sheet.source,
            positions: sheet.positions,
            faces: sheet.faces,
            moments: sheet.moments,
            material: self.composing.material_or(material),
            action,
        };
        let text = scene.text().map_err(|e| Failure::of(Code::Input, &e))?;
        self.composing.run(&self.mesh, text, |recording| {
            ActionVerdict::of(recording).map(|verdict| words(&verdict))
        })
    }
}
