//! Progress of runs and of drawings: a bar on a terminal, plain lines elsewhere, JSON lines for programs.

use super::failure::Format;
use super::interrupt;
use super::message::{counted, is_quiet, is_verbose, print_progress, print_warnings, with_advice};
use super::printable::printable;
use super::trace::TraceFile;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use isosheet_runs::{Beginning, StepPart, Tick, TraceSink, Watch};
use serde_json::{Value, json};
use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two lines where there is no terminal: a log of a long run stays readable.
pub(super) const LINES: Duration = Duration::from_secs(5);

/// Time between two JSON lines, which programs read.
const EVENTS: Duration = Duration::from_secs(1);

/// Progress of a run.
pub(crate) struct Progress {
    format: Format,
    bar: Option<ProgressBar>,
    begun: Instant,
    last: Instant,
    /// When the last step ended.
    stepped: Instant,
    /// Steps that other processes took before.
    before: u64,
    trace: Option<TraceFile>,
}

impl Progress {
    pub(crate) fn new(format: Format, trace: Option<TraceFile>) -> Self {
        Self {
            format,
            bar: None,
            begun: Instant::now(),
            last: Instant::now(),
            stepped: Instant::now(),
            before: 0,
            trace,
        }
    }

    /// Takes the bar away.
    pub(crate) fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    /// Steps per second of this process, and seconds that are left at that rate.
    fn rate(&self, tick: &Tick) -> [f64; 2] {
        let seconds = self.begun.elapsed().as_secs_f64().max(1e-9);
        let rate = (tick.steps - self.before) as f64 / seconds;
        [rate, (tick.of - tick.steps) as f64 / rate]
    }
}

/// Writes an event as a line of JSON. A closed stdout ends nothing: the run is worth more than its log.
pub(crate) fn event(event: &Value) {
    let line = event.to_string();
    let _ = writeln!(std::io::stdout(), "{}", printable(&line, &[]));
}

impl Watch for Progress {
    fn begin(&mut self, beginning: &Beginning) {
        self.begun = Instant::now();
        (self.last, self.stepped) = (self.begun, self.begun);
        self.before = beginning.steps;
        if let Some(trace) = &self.trace {
            trace.begin(beginning.steps);
        }
        let modelled = beginning.modelled.join(", ");
        let Beginning {
            steps,
            of,
            vertices,
            ..
        } = beginning;
        if self.format == Format::Json {
            event(&json!({
                "event": "begin", "steps": steps, "of": of, "vertices": vertices,
                "modelled": beginning.modelled,
                "warnings": with_advice(&beginning.warnings),
            }));
            return;
        }
        let from = match steps {
            0 => String::new(),
            n => format!(", continued after step {n}"),
        };
        print_progress(format_args!(
            "{}: {modelled}; {}{from}",
            counted(*vertices, "vertex", "vertices"),
            counted(*of as usize, "step", "steps")
        ));
        print_warnings(&beginning.warnings);
        if std::io::stderr().is_terminal() && !is_quiet() && !is_verbose() {
            let bar = ProgressBar::with_draw_target(Some(*of), ProgressDrawTarget::stderr());
            let template = "{wide_bar} {pos}/{len} steps, {per_sec}, {eta} left {msg}";
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar.set_position(*steps);
            bar.reset_eta();
            self.bar = Some(bar);
        }
    }

    fn trace(&mut self) -> Option<TraceSink> {
        self.trace.as_ref().map(TraceFile::sink)
    }

    fn within_step(&mut self, part: &StepPart) -> ControlFlow<()> {
        if let Some(bar) = &self.bar
            && self.stepped.elapsed() >= EVENTS
        {
            bar.set_message(in_words(part));
        }
        let shows = match self.format {
            Format::Json => self.last.elapsed() >= EVENTS,
            Format::Text => self.bar.is_none() && self.last.elapsed() >= LINES,
        };
        if shows {
            self.last = Instant::now();
            match self.format {
                Format::Json => event(&json!({
                    "event": "within step", "step": part.step, "of": part.of, "part": part.part,
                    "substeps": part.substeps, "factorisations": part.factorisations,
                })),
                Format::Text => print_progress(format_args!(
                    "step {} of {} is under way: {}",
                    part.step,
                    part.of,
                    in_words(part)
                )),
            }
        }
        go_on()
    }

    fn step(&mut self, tick: &Tick) -> ControlFlow<()> {
        if let Some(bar) = &self.bar {
            bar.set_position(tick.steps);
            bar.set_message("");
        }
        self.stepped = Instant::now();
        let [rate, left] = self.rate(tick);
        match self.format {
            Format::Json if self.last.elapsed() >= EVENTS || tick.steps == tick.of => {
                self.last = Instant::now();
                event(&json!({
                    "event": "step", "steps": tick.steps, "of": tick.of, "t": tick.t,
                    "strain": tick.strain, "gap": tick.gap, "rate": rate, "left": left,
                }));
            }
            Format::Text
                if self.bar.is_none() && (is_verbose() || self.last.elapsed() >= LINES) =>
            {
                self.last = Instant::now();
                print_progress(format_args!(
                    "step {} of {}, t = {:.4} s, {rate:.1} steps/s, {left:.0} s left",
                    tick.steps, tick.of, tick.t
                ));
            }
            _ => {}
        }
        go_on()
    }
}

/// How far a step has come.
fn in_words(part: &StepPart) -> String {
    format!(
        "{:.0} % in {}, {}",
        100.0 * part.part,
        counted(part.substeps, "sub-step", "sub-steps"),
        counted(part.factorisations, "factorisation", "factorisations")
    )
}

/// Whether Ctrl-C was not pressed.
pub(super) fn go_on() -> ControlFlow<()> {
    match interrupt::requested() {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    }
}

/// Progress of the pictures of a film.
pub(crate) struct DrawingProgress {
    count: usize,
    bar: Option<ProgressBar>,
    last: Mutex<Instant>,
}

impl DrawingProgress {
    /// For so many pictures; a single one has no progress.
    pub(crate) fn new(count: usize) -> Self {
        let is_shown = count > 1 && !is_quiet() && std::io::stderr().is_terminal();
        let bar = is_shown.then(|| {
            let target = ProgressDrawTarget::stderr();
            let bar = ProgressBar::with_draw_target(Some(count as u64), target);
            let template = "{wide_bar} {pos}/{len} pictures, {eta} left";
            match ProgressStyle::with_template(template) {
                Ok(style) => bar.with_style(style),
                Err(_) => bar,
            }
        });
        Self {
            count,
            bar,
            last: Mutex::new(Instant::now()),
        }
    }

    /// Tells that so many pictures are drawn.
    pub(crate) fn drawn(&self, count: usize) {
        if let Some(bar) = &self.bar {
            bar.set_position(count as u64);
            return;
        }
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if last.elapsed() >= LINES {
            *last = Instant::now();
            print_progress(format_args!("picture {count} of {}", self.count));
        }
    }

    /// Takes the bar away.
    pub(crate) fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
