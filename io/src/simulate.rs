//! `isosheet simulate` and `isosheet resume`.

use super::failure::{Code, Done, Failure, Format};
use super::interrupt;
use super::message::{counted, print_message, print_result, print_warnings, with_advice};
use super::open::open_page;
use super::progress::{Progress, event};
use super::trace::TraceFile;
use clap::Args;
use clap::builder::RangedI64ValueParser;
use isosheet_mesh::wording::brief;
use isosheet_runs::{
    Existing, Outcome, RunError, Summary, extend_folder, resume_folder, simulate, simulate_anew,
};
use isosheet_scenes::SceneFile;
use serde_json::json;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  isosheet simulate cloth.toml --open                  run a scene in the folder cloth-run, and look at it
  isosheet simulate cloth.toml --force                 run it from the start, after an edit for example
  isosheet simulate cloth.toml --set obstacle[0].friction=0.8 -o rough
                                                       run it with another value, in the folder rough";

/// Run a scene
///
/// A folder with a complete run of the same scene is left as it is, and one with a part of it is continued:
/// the same command line may be given again at any time.
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES)]
pub(crate) struct Simulate {
    /// The scene file
    scene: PathBuf,
    /// The folder to write to [default: the name of the scene with `-run`, in the current folder]
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Change a key of the scene, for example `stop.time=0.5` or `obstacle[0].friction=0.3`
    #[arg(long = "set", value_name = "KEY=VALUE")]
    edits: Vec<String>,
    /// Run from the start, and delete the run that the folder holds before: that of a scene that was edited
    /// since, one that failed, or a complete one
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    how: How,
}

const RESUME_EXAMPLES: &str = "\
Examples:
  isosheet resume cloth-run                    continue a run that was stopped, without its scene file
  isosheet resume cloth-run --until 2          let it go on beyond its end, until t = 2 s";

/// Continue a run
#[derive(Debug, Args)]
#[command(before_help = RESUME_EXAMPLES)]
pub(crate) struct Resume {
    /// The folder of the run
    dir: PathBuf,
    /// Let the run go on until this time (seconds), beyond the `stop.time` of its scene, as if the scene had
    /// had it from the start
    #[arg(long, value_name = "T")]
    until: Option<f64>,
    #[command(flatten)]
    how: How,
}

/// How a run is computed and shown.
#[derive(Debug, Args)]
pub(super) struct How {
    /// Write one JSON object a line to stdout instead of text
    #[arg(long)]
    json: bool,
    /// Number of threads, at most 1024; the results do not depend on it
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = threads())]
    threads: u16,
    /// Write what the iterations of every step did to a file, a JSON object a line: see the page "How a
    /// damped step is found" of the book
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Open the page of the run in a browser, at its end
    #[arg(long)]
    open: bool,
}

/// Most threads of a run: more than the cores of any machine with one memory. A larger number is a mistake,
/// and systems end processes that start tens of thousands of threads.
const MOST_THREADS: i64 = 1024;

/// Numbers of threads.
pub(super) fn threads() -> RangedI64ValueParser<u16> {
    clap::value_parser!(u16).range(1..=MOST_THREADS)
}

/// Computes with a number of threads from now on, of which this one is the first: it would otherwise sleep
/// while others do what it shares with them.
pub(super) fn use_threads(number: u16) -> Done {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(usize::from(number));
    let threads = |e| Failure::new(Code::Step, format!("cannot start the threads: {e}"));
    let pool = pool.use_current_thread();
    pool.build_global().map_err(threads)
}

impl How {
    pub(super) fn format(&self) -> Format {
        if self.json {
            Format::Json
        } else {
            Format::Text
        }
    }

    pub(super) fn prepare(&self) -> Done {
        interrupt::install()?;
        use_threads(self.threads)
    }

    /// Runs a scene in a folder, as [`How::show`] shows it.
    pub(super) fn show_scene(&self, scene: &SceneFile, folder: &Path, existing: Existing) -> Done {
        let run = match existing {
            Existing::Continue => simulate,
            Existing::Delete => simulate_anew,
        };
        self.show(folder, existing, |progress| run(scene, folder, progress))
    }

    /// Runs, shows the progress and says how it ended. An `existing` run of the folder was deleted before, or
    /// continued.
    pub(super) fn show(
        &self,
        folder: &Path,
        existing: Existing,
        run: impl FnOnce(&mut Progress) -> Result<Outcome, RunError>,
    ) -> Done {
        let format = self.format();
        let trace = self.trace.as_deref().map(TraceFile::create).transpose()?;
        let mut progress = Progress::new(format, trace.clone());
        let outcome = run(&mut progress);
        progress.end();
        let outcome = outcome.map_err(Failure::from)?;
        if let Some(trace) = trace {
            trace.check()?;
        }
        let (event_name, summary) = match outcome {
            Outcome::AlreadyComplete(summary) => ("already complete", summary),
            Outcome::Complete(summary) => ("complete", summary),
            Outcome::Interrupted => {
                let failure = Failure::new(Code::Interrupted, "stopped by Ctrl-C");
                return Err(failure.remedy(match existing {
                    Existing::Continue => "the same command continues",
                    Existing::Delete => "the same command without --force continues",
                }));
            }
        };
        let page = page(folder);
        let warnings = summary.warnings();
        if self.json {
            event(&json!({
                "event": event_name, "folder": folder, "page": page, "summary": summary,
                "warnings": with_advice(&warnings),
            }));
        } else {
            print_result(format_args!("{}", sentence(event_name, folder, &summary)))?;
            print_warnings(&warnings);
            if let Some(page) = &page {
                print_result(format_args!("page: {}", page.display()))?;
            }
        }
        match page {
            Some(page) if self.open => open_page(&page),
            None if self.open => print_message(format_args!(
                "warning: the run has no page to open\n  = help: `isosheet page {}` makes one, or says why there is none",
                folder.display()
            )),
            _ => {}
        }
        Ok(())
    }
}

/// What becomes of a run that is there, by `--force`.
pub(super) fn existing(is_forced: bool) -> Existing {
    match is_forced {
        true => Existing::Delete,
        false => Existing::Continue,
    }
}

/// The page of a run, where there is one.
fn page(folder: &Path) -> Option<PathBuf> {
    let page = folder.join("index.html");
    page.is_file().then_some(page)
}

fn sentence(what: &str, folder: &Path, summary: &Summary) -> String {
    let gap = summary.gap_in_words();
    let gap = gap.map_or(String::new(), |gap| format!(", smallest gap {gap}"));
    let ending = &summary.ending;
    let taut = ending
        .taut
        .iter()
        .map(|demand| format!(", ended since {demand}"));
    let frequency = ending.lowest_frequency.iter();
    let frequency = frequency.map(|f| format!(", lowest frequency {} Hz", brief(*f)));
    let residuals = ending.residuals.in_words().into_iter();
    let told: String = taut
        .chain(frequency)
        .chain(residuals.map(|words| format!(", {words}")))
        .chain(
            ending
                .kept
                .in_words()
                .iter()
                .map(|words| format!(", {words}")),
        )
        .collect();
    format!(
        "{what}: {} to t = {:.4} s in {:.1} s, largest strain {:.1e}{gap}{told}; see {}",
        counted(summary.steps as usize, "step", "steps"),
        summary.ending.t,
        summary.wall_time,
        summary.largest_strain,
        folder.display()
    )
}

impl Simulate {
    pub(crate) fn run(&self) -> Done {
        let format = self.how.format();
        self.simulate().map_err(|failure| failure.in_format(format))
    }

    fn simulate(&self) -> Done {
        let scene = SceneFile::read(&self.scene, &self.edits)?;
        let folder = self
            .out
            .clone()
            .unwrap_or_else(|| default_folder(&self.scene, "run"));
        self.how.prepare()?;
        self.how.show_scene(&scene, &folder, existing(self.force))
    }
}

/// The folder of a scene without `--out`: `drape-run` in the current folder for `scenes/drape.toml`, and what
/// it is of, `run`.
pub(super) fn default_folder(scene: &Path, of: &str) -> PathBuf {
    let name = scene.file_stem().unwrap_or_default().to_string_lossy();
    PathBuf::from(format!("{name}-{of}"))
}

impl Resume {
    pub(crate) fn run(&self) -> Done {
        let format = self.how.format();
        self.resume().map_err(|failure| failure.in_format(format))
    }

    fn resume(&self) -> Done {
        self.how.prepare()?;
        let existing = Existing::Continue;
        self.how
            .show(&self.dir, existing, |progress| match self.until {
                Some(until) => extend_folder(&self.dir, until, progress),
                None => resume_folder(&self.dir, progress),
            })
    }
}
