//! `isosheet fit`.

use super::failure::{Code, Done, Failure};
use super::interrupt;
use super::message::{counted, print_progress, print_result};
use super::write::is_same_file;
use clap::Args;
use isosheet_files::{DataError, write_atomically};
use isosheet_mesh::Advice;
use isosheet_mesh::wording::{brief, given};
use isosheet_runs::{Fit, FitError, FitRange, FitRuns, FitTarget, Fitted};
use isosheet_scenes::SceneFile;
use std::io::Write;
use std::num::{NonZero, NonZeroUsize};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::str::FromStr;

const EXAMPLES: &str = "\
Examples:
  isosheet fit strip.toml --rest --vary sheet.bending.plate.rigidity=1e-5..1e-3 --to tip=-0.042
                                               the rigidity with which the measure `tip` is at -42 mm at rest
  isosheet fit strip.toml --vary sheet.damping=0.1..10 --vary sheet.density=0.05..0.2 --to scan.obj
                                               two values with which a run ends as a scanned mesh
  isosheet fit strip.toml --rest --vary sheet.bending.plate.rigidity=1e-5..1e-3 --to tip=-0.042+-0.0005
                                               with the standard deviation of the measurement";

/// Find values of keys with which the run of a scene ends as is asked for
///
/// A target is the last value of a measure of the scene, or a mesh file with the positions of all vertices at
/// the end. The sum of the squares of the differences becomes as small as it can. The search begins at the
/// values of the scene, and takes a run for each key in each step. The last lines have the values with their
/// standard deviations, and what the run ends with. The scene with these values is written.
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES)]
pub(crate) struct FitArgs {
    /// The scene file
    scene: PathBuf,
    /// A key and the range of its value; if its ends are positive and one is ten times the other, the
    /// logarithm varies
    #[arg(long, value_name = "KEY=FROM..TO", required = true, value_parser = advised::<FitRange>)]
    vary: Vec<FitRange>,
    /// What the run is to end with: NAME=VALUE of a measure, or a mesh file; with +-SIGMA behind it the
    /// standard deviation, which targets of different units need
    #[arg(
        long,
        value_name = "TARGET",
        required = true,
        allow_hyphen_values = true,
        value_parser = advised::<FitTarget>
    )]
    to: Vec<FitTarget>,
    /// Compare the shapes at rest, as `isosheet rest` finds them
    #[arg(long)]
    rest: bool,
    /// Change a key of the scene in all runs
    #[arg(long = "set", value_name = "KEY=VALUE")]
    edits: Vec<String>,
    /// The scene to write, in the folder of the scene that is read [default: its name with `-fit`]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Replace the file that is written
    #[arg(long)]
    force: bool,
    /// Make N runs at a time [default: as many as the machine has cores]
    #[arg(short, long, value_name = "N")]
    jobs: Option<NonZero<usize>>,
}

/// Reads a value, with what to do about a wrong one.
fn advised<T: FromStr<Err = DataError>>(text: &str) -> Result<T, String> {
    text.parse().map_err(|e: DataError| e.with_advice())
}

impl FitArgs {
    pub(crate) fn run(self) -> Done {
        let out = self.out()?;
        let runs = match self.rest {
            true => FitRuns::Rest,
            false => FitRuns::Motion,
        };
        let fit = Fit::new(&self.scene, self.edits, self.vary, self.to, runs)?;
        for note in fit.notes() {
            print_progress(format_args!("note: {note}"));
        }
        let folder = tempfile::tempdir().map_err(|e| {
            Failure::new(Code::Output, format!("cannot make a temporary folder: {e}"))
        })?;
        let cores = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        interrupt::install()?;
        let watch = || match interrupt::requested() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        let write = |scene: &SceneFile| {
            let text = &scene.text().text;
            write_atomically(&out, |file| file.write_all(text.as_bytes()))
                .map_err(|e| Failure::of(Code::Output, &e))
        };
        let mut best = None;
        let fitted = fit.run(
            folder.path(),
            self.jobs.unwrap_or(cores),
            &watch,
            &mut |step| {
                best = step.scene.clone().or(best.take());
                let values = step.values.iter();
                let values = values.map(|(key, value)| format!("{key} = {}", brief(*value)));
                print_progress(format_args!(
                    "{}: {}, rms {}",
                    counted(step.runs, "run", "runs"),
                    values.collect::<Vec<_>>().join(", "),
                    brief(step.rms)
                ));
            },
        );
        let fitted = match (fitted, best) {
            (Err(FitError::Interrupted), Some(best)) => {
                write(&best)?;
                let message = format!("stopped by Ctrl-C; {} has the best values", out.display());
                return Err(Failure::new(Code::Interrupted, message));
            }
            (fitted, _) => fitted?,
        };
        write(&fitted.scene)?;
        print_result(format_args!("{}", lines(&fitted)))?;
        let count = counted(fitted.runs, "run", "runs");
        match missed(&fitted) {
            None => print_result(format_args!("fitted: {count}; see {}", out.display())),
            Some(missed) => {
                let message = format!("{missed}: {count}; see {}", out.display());
                Err(Failure::new(Code::Step, message).remedy(
                    "begin at other values by `--set`, widen the ranges, or choose keys on which the targets depend",
                ))
            }
        }
    }

    /// Where the scene is written: its paths are relative to its folder.
    fn out(&self) -> Result<PathBuf, Failure> {
        let folder = self.scene.parent().unwrap_or(Path::new(""));
        let out = self.out.clone().unwrap_or_else(|| {
            let stem = self.scene.file_stem().unwrap_or_default().to_string_lossy();
            folder.join(format!("{stem}-fit.toml"))
        });
        if out.parent() != Some(folder) {
            let message = format!("{} is not in the folder of the scene", out.display());
            return Err(Failure::misuse(message).remedy("its paths are relative to that folder"));
        }
        if is_same_file(&self.scene, &out) {
            let message = format!("{} is the scene that is read", out.display());
            return Err(Failure::misuse(message).remedy("choose another name"));
        }
        if out.extension().is_none_or(|e| e != "toml") {
            let message = format!("{} is no name of a scene", out.display());
            return Err(Failure::misuse(message).remedy("choose one that ends with .toml"));
        }
        if out.exists() && !self.force {
            let message = format!("{} is there already", out.display());
            return Err(Failure::misuse(message).remedy("choose another name, or give `--force`"));
        }
        Ok(out)
    }
}

/// The values, what the run ends with, and the runs that failed.
fn lines(fitted: &Fitted) -> String {
    let mut lines = Vec::new();
    for value in &fitted.values {
        let deviation = match value.deviation {
            Some(deviation) => format!(" +- {}", brief(deviation)),
            None => String::new(),
        };
        let besides = match (value.is_at_end, value.is_determined) {
            (true, _) => ", an end of its range",
            (_, false) => ", not determined: other values do as well, with others of other keys",
            _ => "",
        };
        lines.push(format!(
            "{} = {}{deviation}{besides}",
            value.key,
            six_digits(value.value)
        ));
    }
    for reached in &fitted.targets {
        let (found, unit) = (six_digits(reached.found), &reached.unit);
        lines.push(match &reached.target {
            FitTarget::Measure { name, value, .. } => {
                format!("{name} ends at {found} {unit} for {} {unit}", given(*value))
            }
            FitTarget::Mesh { path, .. } => {
                format!("vertices end {found} m (rms) from {}", path.display())
            }
        });
    }
    if let Some((count, why)) = &fitted.failed {
        let count = counted(*count, "run", "runs");
        lines.push(format!("{count} failed, the last of them: {why}"));
    }
    lines.join("\n")
}

/// What was asked for and is not met, if anything.
fn missed(fitted: &Fitted) -> Option<String> {
    let missed = fitted.targets.iter().filter(|target| !target.is_met());
    let missed: Vec<String> = missed.map(|t| format!("`{}`", t.target)).collect();
    match (missed.is_empty(), fitted.is_found) {
        (false, true) => Some(format!(
            "not met, and as near as it gets: {}",
            missed.join(", ")
        )),
        (false, false) => Some(format!("not met in the most steps: {}", missed.join(", "))),
        (true, false) => Some("not settled in the most steps".to_owned()),
        (true, true) => None,
    }
}

/// A number with six significant digits: fits are right to fewer.
fn six_digits(value: f64) -> String {
    let rounded = format!("{value:.5e}").parse().unwrap_or(value);
    given(rounded).to_string()
}
