//! `isosheet rest`.

use super::failure::{Done, Failure};
use super::simulate::{How, default_folder, existing};
use clap::Args;
use isosheet_runs::RunError;
use isosheet_scenes::SceneFile;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  isosheet rest cloth.toml --open              the shape that the sheet takes at rest, in the folder cloth-rest
  isosheet rest strip.toml --set forces.gravity=[0,0,-1.6] -o moon
                                               under another load, in the folder moon";

/// Find the shape that the sheet of a scene takes at rest
///
/// The scene is one of `isosheet simulate`. Where nothing in it is a function of time, the equilibrium is
/// found in one step. Otherwise each step of the scene ends at an equilibrium under the loads and supports of
/// its time, which is a path of loads: `history.csv` and `loads.csv` have the table. The last line has the
/// lowest frequency of small vibrations about the shape: the nearer it is to zero, the softer is the sheet.
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES)]
pub(crate) struct RestArgs {
    /// The scene file
    scene: PathBuf,
    /// The folder to write to [default: the name of the scene with `-rest`, in the current folder]
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Change a key of the scene, for example `forces.gravity=[0,0,-1.6]`
    #[arg(long = "set", value_name = "KEY=VALUE")]
    edits: Vec<String>,
    /// Search from the start, and delete the run that the folder holds before
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    how: How,
}

impl RestArgs {
    pub(crate) fn run(&self) -> Done {
        let format = self.how.format();
        self.rest().map_err(|failure| failure.in_format(format))
    }

    fn rest(&self) -> Done {
        let file = SceneFile::read(&self.scene, &self.edits)?;
        let (scene, keys) = file.scene().at_rest();
        let still = file.changed(scene, keys);
        let still = still.map_err(|error| Failure::from(RunError::Scene(error)))?;
        let default = || default_folder(&self.scene, "rest");
        let folder = self.out.clone().unwrap_or_else(default);
        self.how.prepare()?;
        self.how.show_scene(&still, &folder, existing(self.force))
    }
}
