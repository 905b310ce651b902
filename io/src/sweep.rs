//! `isosheet sweep`.

use super::failure::{Code, Done, Failure};
use super::message::{counted, print_progress};
use super::simulate::default_folder;
use super::workers;
use super::write::to_stdout;
use clap::{Args, ValueEnum};
use isosheet_runs::{Sweep, SweepRunner, Variation};
use std::ffi::OsStr;
use std::num::{NonZero, NonZeroUsize};
use std::path::{Path, PathBuf};

/// What the command does, as `--help` shows it.
const HELP: &str = "\
The folder has runs.csv (a row for each run) and commands.txt (a line of shell for each run). With --engine nothing
is run: what the other program needs is printed.
The same line again, after a kill or a failure, leaves complete runs as they are and continues the others.
`isosheet collect DIR` makes one table of the results. The exit code is 0 if all runs are complete, 130 after
Ctrl-C or if a run was killed, and otherwise that of the first run that failed.";

const EXAMPLES: &str = "\
Examples:
  isosheet sweep s.toml --over sheet.density=0.1,0.2         two runs, on all cores
  isosheet sweep s.toml --over stop.time=1,2 --over contact.friction=0,0.3 -j 1 -o study
                                                             four runs, one at a time, in the folder study
  isosheet sweep s.toml --over stop.time=1,2 --engine parallel | sh
  isosheet sweep s.toml --over stop.time=1,2 --engine slurm > job.sh && sbatch job.sh
  isosheet sweep s.toml --over stop.time=1,2 --engine snakemake > Snakefile && snakemake -j 8";

/// Run a scene with all combinations of some values
///
/// All runs are checked before anything is written or run.
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES, after_help = HELP)]
pub(crate) struct SweepArgs {
    /// The scene file
    scene: PathBuf,
    /// A key and its values, which are values of TOML, for example `stop.time=0.5,1` or
    /// `method.integrator=bdf2,implicit_euler`; the last key changes fastest
    #[arg(long = "over", value_name = "KEY=A,B,...", required = true)]
    over: Vec<Variation>,
    /// Change a key of the scene in all runs, as `isosheet simulate` does
    #[arg(long = "set", value_name = "KEY=VALUE")]
    edits: Vec<String>,
    /// The folder to write to [default: the name of the scene with `-sweep`, in the current folder]
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Run N of the runs at a time, each in a process of its own [default: as many as the machine has cores]
    #[arg(short, long, value_name = "N")]
    jobs: Option<NonZero<usize>>,
    /// Run nothing, and print what this program needs to run the sweep
    #[arg(long, value_enum, conflicts_with = "jobs")]
    engine: Option<EngineName>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum EngineName {
    /// A line of shell for GNU parallel
    Parallel,
    /// The script of a Slurm job array
    Slurm,
    /// A Snakefile
    Snakemake,
}

impl EngineName {
    fn engine(self) -> SweepRunner {
        match self {
            Self::Parallel => SweepRunner::Parallel,
            Self::Slurm => SweepRunner::Slurm,
            Self::Snakemake => SweepRunner::Snakemake,
        }
    }
}

impl SweepArgs {
    pub(crate) fn run(self, program: &Path) -> Done {
        let folder = self
            .out
            .unwrap_or_else(|| default_folder(&self.scene, "sweep"));
        let sweep = Sweep::new(&self.scene, &folder, self.edits, self.over)?;
        sweep.check()?;
        sweep.write(&word_for(program)?)?;
        let count = counted(sweep.len(), "run", "runs");
        print_progress(format_args!("{count} in {}", folder.display()));
        match self.engine {
            Some(engine) => to_stdout(&engine.engine().text(&sweep)),
            None => workers::run(&sweep, program, self.jobs.unwrap_or_else(all_cores)),
        }
    }
}

/// The number of cores that the process may use; one where the system does not say.
fn all_cores() -> NonZero<usize> {
    std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)
}

/// What a shell calls the program by: `isosheet` if that is the same program, its whole path otherwise.
fn word_for(program: &Path) -> Result<String, Failure> {
    const NAME: &str = "isosheet";
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let mut known = std::env::split_paths(&folders).map(|folder| folder.join(NAME));
    let found = known.find(|path| path.is_file());
    let same = found.and_then(|path| path.canonicalize().ok()) == program.canonicalize().ok();
    if same && program.file_name() == Some(OsStr::new(NAME)) {
        return Ok(NAME.to_owned());
    }
    program.to_str().map(str::to_owned).ok_or_else(|| {
        let message = format!(
            "the path {} of the program is not valid UTF-8",
            program.display()
        );
        Failure::new(Code::Input, message).remedy("install it elsewhere")
    })
}
