//! Plays a scene in real time, or as fast as it can be computed.

use super::board::Board;
use super::clock::Clock;
use super::message::LiveCommand;
use super::session::{Session, Stepped};
use isosheet_dynamics::StepProgress;
use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// How often pages get a new state at most, as often as screens show one: seconds.
const SHOWN: f64 = 1.0 / 60.0;

/// How long the player sleeps at most, so that it hears of the end.
const NAP: Duration = Duration::from_millis(50);

/// Why the player ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ended {
    /// A page asked for it.
    ByPage,
    /// The process is to end.
    ByProcess,
}

/// A session with all that it has to hear and to tell.
pub(super) struct Player<'a> {
    pub(super) session: Session,
    pub(super) board: &'a Board,
    pub(super) commands: Receiver<LiveCommand>,
    /// Whether the process is to end, asked between and within steps.
    pub(super) is_over: &'a dyn Fn() -> bool,
    /// Whether a page has asked for the end, asked within steps.
    pub(super) end_is_asked: &'a dyn Fn() -> bool,
}

impl Player<'_> {
    /// Plays until the end.
    pub(super) fn play(mut self) -> Ended {
        let origin = Instant::now();
        let now = || origin.elapsed().as_secs_f64();
        let mut clock: Option<Clock> = None;
        let mut shown = f64::NEG_INFINITY;
        self.show(None);
        loop {
            if (self.is_over)() {
                return Ended::ByProcess;
            }
            let wait = match (&clock, self.session.is_playing()) {
                (Some(clock), true) => clock.wait(now()),
                (None, true) => 0.0,
                (_, false) => NAP.as_secs_f64(),
            };
            let wait = Duration::from_secs_f64(wait).min(NAP);
            match self.commands.recv_timeout(wait) {
                Ok(LiveCommand::End) => return Ended::ByPage,
                Ok(command) => {
                    self.session.obey(&command);
                    if command == LiveCommand::Step {
                        self.step();
                    }
                    // A hand that is led while the run plays is shown with the next step.
                    if !self.session.is_playing() || clock.is_none() {
                        clock = None;
                        self.show(None);
                    }
                    continue;
                }
                Err(RecvTimeoutError::Disconnected) => return Ended::ByPage,
                Err(RecvTimeoutError::Timeout) => {}
            }
            if !self.session.is_playing() {
                clock = None;
                continue;
            }
            let playing = clock.get_or_insert_with(|| Clock::start(now()));
            if playing.wait(now()) > 0.0 {
                continue;
            }
            let began = now();
            let stepped = self.step();
            if let Stepped::By(h) = stepped {
                playing.stepped(h, began, now());
            }
            // Steps that are shorter than what a screen shows are not all shown.
            if now() - shown >= 0.9 * SHOWN || !self.session.is_playing() {
                let pace = playing.pace();
                self.show(pace);
                shown = now();
            }
        }
    }

    fn step(&mut self) -> Stepped {
        let (is_over, end_is_asked) = (self.is_over, self.end_is_asked);
        let mut watch = |_: &StepProgress| match is_over() || end_is_asked() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        self.session.step(&mut watch)
    }

    /// Tells pages the present state.
    fn show(&self, pace: Option<f64>) {
        let frame = serde_json::to_string(&self.session.frame(pace));
        self.board
            .publish(frame.expect("a frame has texts as keys"));
    }
}
