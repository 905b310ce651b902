//! Progress on stderr: bars on a terminal, plain lines elsewhere.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Progress of one piece of work.
pub(crate) struct Progress {
    name: String,
    bar: Option<ProgressBar>,
    started: Instant,
}

impl Progress {
    /// Starts a piece of work of `length` steps.
    pub(crate) fn start(name: impl Into<String>, length: usize) -> Self {
        let name = name.into();
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar =
                ProgressBar::with_draw_target(Some(length as u64), ProgressDrawTarget::stderr());
            let style =
                ProgressStyle::with_template("{prefix:<28} {wide_bar} {pos}/{len} {elapsed}");
            if let Ok(style) = style {
                bar.set_style(style);
            }
            bar.set_prefix(name.clone());
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        Self {
            name,
            bar,
            started: Instant::now(),
        }
    }

    /// One more step is done.
    pub(crate) fn step(&self) {
        if let Some(bar) = &self.bar {
            bar.inc(1);
        }
    }

    /// Ends the bar and leaves one line.
    pub(crate) fn finish(self, how: &str) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        eprintln!(
            "{:<28} {how} ({:.1} s)",
            self.name,
            self.started.elapsed().as_secs_f64()
        );
    }
}

/// One line about something that needed no work.
pub(crate) fn note(name: &str, text: &str) {
    eprintln!("{name:<28} {text}");
}
