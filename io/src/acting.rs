//! What commands share in which the sheet of a file does one thing.

use super::action_scene::{Action, ActionScene};
use super::action_verdict::ActionVerdict;
use super::composing::Composing;
use super::failure::{Code, Done, Failure};
use super::given::GivenSheet;
use clap::{Args, ValueEnum};
use isosheet_scenes::UpAxis;
use std::path::PathBuf;

/// A sheet, and how it is run.
#[derive(Debug, Args)]
pub(super) struct Acting {
    /// The sheet: a mesh file or a drawing
    pub(super) mesh: PathBuf,
    #[command(flatten)]
    pub(super) composing: Composing,
    /// How often each triangle of the sheet is divided into four [default: until there are 400]
    #[arg(long, value_name = "TIMES", value_parser = clap::value_parser!(u8).range(0..=6))]
    refine: Option<u8>,
    /// The time at which the run ends at the latest, seconds [default: by the size of the sheet]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    time: Option<f64>,
    /// The axis that points upwards in the files, other than glTF files, which say it
    #[arg(long, value_name = "AXIS", value_enum, default_value_t)]
    up: Axis,
}

/// The axis of a file that points upwards.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Axis {
    /// z: coordinates are used as they are.
    #[default]
    Z,
    /// y: (x, y, z) becomes (x, -z, y).
    Y,
}

/// A time in seconds.
fn seconds(text: &str) -> Result<f64, String> {
    let time: Option<f64> = text.parse().ok();
    time.filter(|t| (1e-3..=1e4).contains(t))
        .ok_or_else(|| "give a time from 0.001 to 10000 seconds".to_owned())
}

impl Acting {
    /// The axis that points upwards in the files.
    pub(super) fn up(&self) -> UpAxis {
        match self.up {
            Axis::Z => UpAxis::Z,
            Axis::Y => UpAxis::Y,
        }
    }

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
        let sheet = GivenSheet::read(&self.mesh, &self.composing, self.up(), size)?;
        let action = action(&sheet)?;
        self.composing.begin(&self.mesh)?;
        let scene = ActionScene {
            source: sheet.source,
            positions: sheet.positions,
            faces: sheet.faces,
            moments: sheet.moments,
            material: self.composing.material_or(material),
            action,
            refine: self.refine.map(usize::from),
            time: self.time,
        };
        let text = scene.text().map_err(|e| Failure::of(Code::Input, &e))?;
        self.composing.run(&self.mesh, text, |recording| {
            ActionVerdict::of(recording).map(|verdict| words(&verdict))
        })
    }
}
