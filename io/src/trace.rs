//! The file of `--trace`: one line of JSON for each iteration, phase, refusal and accepted part of a step.

use super::failure::{Code, Done, Failure};
use isosheet_dynamics::{TraceEvent, Tuning};
use isosheet_runs::TraceSink;
use serde_json::json;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// A trace that is being written.
#[derive(Clone, Debug)]
pub(crate) struct TraceFile {
    path: PathBuf,
    /// The file, or why nothing more can be written to it.
    file: Arc<Mutex<io::Result<BufWriter<File>>>>,
}

impl TraceFile {
    /// The file, in which a trace of this name stays until the run begins.
    ///
    /// # Errors
    /// [`Failure`] if the file cannot be written, or if there is another file of this name, such as the
    /// scene.
    pub(crate) fn create(path: &Path) -> Result<Self, Failure> {
        if is_another_file(path) {
            let message = format!("{} is a file that is no trace", path.display());
            return Err(
                Failure::misuse(message).remedy("give the trace another name, or remove the file")
            );
        }
        let file = File::options().append(true).create(true).open(path);
        let file = file.map(BufWriter::new);
        let trace = Self {
            path: path.to_owned(),
            file: Arc::new(Mutex::new(file)),
        };
        trace.check().map(|()| trace)
    }

    /// The run begins after so many steps of earlier processes. Of one that is at its start the file has no
    /// steps yet: its first line gets the constants of the solver, and an earlier trace is replaced. That of
    /// a run which goes on is continued.
    pub(crate) fn begin(&self, steps: u64) {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        if let Ok(open) = &mut *file
            && let Err(error) = begin(open, steps)
        {
            *file = Err(error);
        }
    }

    /// What a run tells its events.
    pub(crate) fn sink(&self) -> TraceSink {
        let file = Arc::clone(&self.file);
        Box::new(move |event| {
            let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
            if let Ok(open) = &mut *file
                && let Err(error) = write_line(open, event)
            {
                *file = Err(error);
            }
        })
    }

    /// Refuses a trace that could not be written.
    pub(crate) fn check(&self) -> Done {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let written = match &mut *file {
            Ok(open) => open.flush(),
            Err(error) => Err(io::Error::new(error.kind(), error.to_string())),
        };
        written.map_err(|error| {
            let path = self.path.display();
            let message = format!("cannot write the trace {path}: {error}");
            Failure::new(Code::Output, message)
                .remedy("give a file in a folder that can be written to")
        })
    }
}

/// Whether there is a file of this name, with contents, that no run has written as its trace.
fn is_another_file(path: &Path) -> bool {
    /// Longer than the first line of a trace.
    const LONGEST: u64 = 1 << 16;
    let is_file = fs::metadata(path).is_ok_and(|found| found.is_file() && found.len() > 0);
    let first = || {
        let mut line = String::new();
        let file = BufReader::new(File::open(path)?.take(LONGEST)).read_line(&mut line);
        file.map(|_| line)
    };
    let is_trace = |line: &String| {
        let head: Option<serde_json::Value> = serde_json::from_str(line).ok();
        head.is_some_and(|head| head["event"] == "tuning")
    };
    is_file && !first().is_ok_and(|line| is_trace(&line))
}

fn begin(file: &mut BufWriter<File>, steps: u64) -> io::Result<()> {
    if steps == 0 {
        file.get_ref().set_len(0)?;
    }
    if file.get_ref().metadata()?.len() > 0 {
        return Ok(());
    }
    let head = json!({
        "event": "tuning", "version": env!("CARGO_PKG_VERSION"), "constants": Tuning::default(),
    });
    writeln!(file, "{head}")
}

/// Writes an event. What was decided is on the disk at once: a run that is killed leaves its trace.
fn write_line(file: &mut BufWriter<File>, event: &TraceEvent) -> io::Result<()> {
    serde_json::to_writer(&mut *file, event)?;
    file.write_all(b"\n")?;
    match event {
        TraceEvent::Iteration { .. } | TraceEvent::GoesOn { .. } => Ok(()),
        _ => file.flush(),
    }
}
