//! The runs of a sweep on this machine, each in a process of its own: a run that is killed or crashes leaves
//! the others as they are.

use super::failure::{Code, Done, Failure};
use super::interrupt;
use super::message::{counted, is_verbose, print_message, print_progress, print_result};
use isosheet_files::input;
use isosheet_runs::{Sweep, SweepRun};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::num::NonZero;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How a run ended that is not complete.
struct Failed {
    run: SweepRun,
    code: Code,
    message: String,
}

/// Runs a sweep, so many runs at a time. After Ctrl-C no other run is begun.
pub(crate) fn run(sweep: &Sweep, program: &Path, jobs: NonZero<usize>) -> Done {
    interrupt::install()?;
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let failed = Mutex::new(Vec::new());
    let work = || {
        while !interrupt::requested() {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= sweep.len() {
                break;
            }
            let run = sweep.run(number);
            let outcome = simulate(sweep, &run, program);
            let count = done.fetch_add(1, Ordering::Relaxed) + 1;
            let (folder, edits) = (&run.folder, run.edits.join(", "));
            let head = format!("{count} of {}: run {folder} ({edits})", sweep.len());
            match outcome {
                Ok(()) => print_progress(format_args!("{head}: complete")),
                Err((code, message)) => {
                    print_message(format_args!("{head}: {message}"));
                    let entry = Failed { run, code, message };
                    failed.lock().unwrap_or_else(|e| e.into_inner()).push(entry);
                }
            }
        }
    };
    std::thread::scope(|scope| {
        let most = sweep.len().min(jobs.get());
        for _ in 0..most {
            scope.spawn(work);
        }
    });
    let failed = failed.into_inner().unwrap_or_else(|e| e.into_inner());
    ending(sweep, done.into_inner(), failed)
}

/// The end of a sweep of which so many runs have ended, some of them failed.
fn ending(sweep: &Sweep, done: usize, mut failed: Vec<Failed>) -> Done {
    failed.sort_by_key(|f| f.run.number);
    let stopped = failed.iter().any(|f| f.code == Code::Interrupted);
    if done < sweep.len() || stopped {
        let message = "the sweep or one of its runs was stopped";
        return Err(Failure::new(Code::Interrupted, message).remedy("the same command continues"));
    }
    let Some(first) = failed.first() else {
        return print_result(format_args!(
            "complete: {} in {}",
            counted(sweep.len(), "run", "runs"),
            sweep.folder().display()
        ));
    };
    let message = format!(
        "{} of {} runs failed, the first one is run {}: {}",
        failed.len(),
        sweep.len(),
        first.run.folder,
        first.message
    );
    Err(Failure::new(first.code, message))
}

/// Simulates a run in a process of its own. What it says is added to a log beside its folder.
fn simulate(sweep: &Sweep, run: &SweepRun, program: &Path) -> Result<(), (Code, String)> {
    let path = sweep.folder().join(format!("{}.log", run.folder));
    let unwritable = |e: io::Error| {
        let message = format!("cannot write {}: {e}; check the free space", path.display());
        (Code::Output, message)
    };
    let log = input::reopen(&path, File::options().create(true).append(true));
    let log = log.map_err(unwritable)?;
    let before = log.metadata().map_err(unwritable)?.len();
    let results = log.try_clone().map_err(unwritable)?;
    let mut command = Command::new(program);
    command.args(sweep.arguments(run));
    if is_verbose() {
        command.arg("--verbose");
    }
    command.stdin(Stdio::null()).stdout(results).stderr(log);
    let status = command.status().map_err(|e| {
        let message = format!(
            "cannot start {}: {e}; run the sweep anew",
            program.display()
        );
        (Code::Step, message)
    })?;
    if status.success() {
        return Ok(());
    }
    Err(failure(status, &path, before))
}

/// Why a process failed: its last words, and the code that the sweep ends with.
fn failure(status: ExitStatus, log: &Path, before: u64) -> (Code, String) {
    let Some(code) = status.code() else {
        return (
            Code::Interrupted,
            format!("{status}; the same command continues it"),
        );
    };
    let said = tail(log, before).unwrap_or_default();
    match said.find("error: ") {
        Some(start) => (Code::of(code), said[start..].trim_end().to_owned()),
        None => (Code::of(code), format!("{status}; see {}", log.display())),
    }
}

/// What was added to a file.
fn tail(path: &Path, before: u64) -> io::Result<String> {
    let mut file = File::open(path)?;
    file.seek(SeekFrom::Start(before))?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
