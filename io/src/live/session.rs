//! A scene that is played: what pages ask for is done here, between its steps.

use super::message::{HandFrame, LiveCommand, LiveFrame, Notice, NoticeKind};
use super::slider::Slider;
use isosheet_dynamics::{StepError, StepProgress};
use isosheet_formats::{BodyPose, HistoryRow};
use isosheet_mesh::wording::brief;
use isosheet_mesh::{Advice, VertexId};
use isosheet_page::TimeSeries;
use isosheet_runs::{HoldingBody, row_of_start, row_of_step};
use isosheet_scenes::{Key, LiveScene, ProfileKey, SceneError, SceneFile, bounds};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// The steps in which a slider drives its function of time from one value to the next: enough to be resolved.
const DRIVING_STEPS: f64 = 10.0;

/// A scene that is played.
pub(super) struct Session {
    live: LiveScene,
    sliders: Vec<Slider>,
    holding: Vec<HoldingBody>,
    /// The names of the series that are plotted.
    series: Vec<String>,
    is_playing: bool,
    /// Where the hand is led, while there is one.
    aim: Option<[f64; 3]>,
    /// Where sliders have been put since the last step.
    put: BTreeMap<usize, f64>,
    /// The time at which it pauses, seconds: first that of the scene.
    until: f64,
    start_energy: f64,
    row: HistoryRow,
    notice: Option<Notice>,
}

/// How an attempt to take a step ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stepped {
    /// By a step of this length, seconds.
    By(f64),
    /// There was none: the time of the scene is over, or the step failed. The run pauses, and says so.
    Paused,
    /// The watch has ended it.
    Interrupted,
}

/// The scene with the course of its folding, which has a slider then.
fn with_course(file: SceneFile) -> Result<SceneFile, SceneError> {
    let mut scene = file.scene().clone();
    let Some(folding) = scene
        .folding
        .as_mut()
        .filter(|folding| folding.order.is_empty())
    else {
        return Ok(file);
    };
    folding
        .course
        .get_or_insert(ProfileKey::smooth_step(1.0, folding.time));
    let key = Key::root().name("folding.course");
    file.changed(scene, [key])
}

impl Session {
    /// The scene at its start. It does not play yet.
    ///
    /// # Errors
    /// [`SceneError`] if it cannot be built.
    pub(super) fn start(file: SceneFile) -> Result<Self, SceneError> {
        let file = with_course(file)?;
        let live = LiveScene::start(file)?;
        let scene = live.file().scene();
        let corners = bounds(live.positions().as_chunks::<3>().0);
        let holding = HoldingBody::all(scene, corners);
        let row = row_of_start(live.simulation());
        let mut session = Self {
            sliders: Slider::all(scene),
            holding,
            series: Vec::new(),
            is_playing: false,
            aim: None,
            put: BTreeMap::new(),
            until: scene.stop.time,
            start_energy: row.total,
            row,
            notice: None,
            live,
        };
        session.series = session.plotted().into_iter().map(|s| s.name).collect();
        Ok(session)
    }

    pub(super) fn live(&self) -> &LiveScene {
        &self.live
    }

    pub(super) fn sliders(&self) -> &[Slider] {
        &self.sliders
    }

    pub(super) fn holding(&self) -> &[HoldingBody] {
        &self.holding
    }

    pub(super) fn is_playing(&self) -> bool {
        self.is_playing
    }

    /// The series that are plotted, at the present state: energies, strain, and the gap in scenes with
    /// contact, which has no value while nothing is close.
    pub(super) fn plotted(&self) -> Vec<TimeSeries> {
        let series = |gap: Option<f64>| {
            let row = HistoryRow {
                h: 0.0,
                gap,
                ..self.row
            };
            let all = TimeSeries::of_history(&[row]).into_iter();
            all.filter(|series| !series.times.is_empty())
        };
        let is_contact = self.live.simulation().contacts().is_some();
        let known: Vec<TimeSeries> = series(self.row.gap).collect();
        let named = series(is_contact.then_some(0.0));
        let with_value = |named: TimeSeries| {
            let known = known.iter().find(|series| series.name == named.name);
            known.cloned().unwrap_or(TimeSeries {
                times: Vec::new(),
                values: Vec::new(),
                ..named
            })
        };
        named.map(with_value).collect()
    }

    /// Does what a page asks for. A single step is not taken here.
    pub(super) fn obey(&mut self, command: &LiveCommand) {
        match command {
            LiveCommand::Play => {
                self.is_playing = true;
                self.notice = None;
                if self.live.next_step(self.until).is_none() {
                    self.until = f64::INFINITY;
                }
            }
            LiveCommand::Pause | LiveCommand::End => self.is_playing = false,
            LiveCommand::Step => {
                self.obey(&LiveCommand::Play);
                self.is_playing = false;
            }
            LiveCommand::Grab { vertex } => match self.live.hold(VertexId(*vertex)) {
                Ok(at) => {
                    self.aim = Some(at);
                    self.notice = None;
                }
                Err(error) => self.refuse(&error),
            },
            LiveCommand::Drag { to } => self.aim = self.aim.map(|_| *to),
            LiveCommand::Release => {
                self.aim = None;
                if let Err(error) = self.live.let_go() {
                    self.refuse(&error);
                }
            }
            LiveCommand::Set { slider, value } => {
                if let Some(slide) = self.sliders.get(*slider) {
                    self.put.insert(*slider, slide.allowed(*value));
                }
            }
        }
    }

    /// Takes a step, after what has been asked for before it. After a failure the state is that of the last
    /// accepted part of the step.
    pub(super) fn step(
        &mut self,
        watch: &mut dyn FnMut(&StepProgress) -> ControlFlow<()>,
    ) -> Stepped {
        let Some(h) = self.live.next_step(self.until) else {
            self.pause(format!(
                "The {} s of the scene are over. Play goes on beyond them.",
                brief(self.until)
            ));
            return Stepped::Paused;
        };
        let t = self.live.simulation().state().t;
        self.drive(t, h);
        if let Some(to) = self.aim
            && let Err(error) = self.live.lead(to, t + h)
        {
            self.refuse(&error);
        }
        match self.live.step_watched(h, watch) {
            Ok(report) => {
                let model = self.live.simulation().model();
                self.row = row_of_step(&report, model, self.start_energy);
                if report.taut.is_some() {
                    let what = "The supports ask for more than the lengths of the sheet allow.";
                    self.pause(what.into());
                }
                Stepped::By(h)
            }
            Err(error) if matches!(error.step, Some(StepError::Interrupted { .. })) => {
                Stepped::Interrupted
            }
            Err(error) => {
                self.is_playing = false;
                self.refuse(&error);
                Stepped::Paused
            }
        }
    }

    /// Lets the scene follow the sliders from time `t` on, in steps of `h` seconds.
    fn drive(&mut self, t: f64, h: f64) {
        let until = t + DRIVING_STEPS * h;
        for (number, value) in std::mem::take(&mut self.put) {
            let slider = &mut self.sliders[number];
            match self
                .live
                .drive(&[(slider.key.clone(), value.into())], until)
            {
                Ok(()) => slider.driven(value, t, until),
                Err(error) => self.refuse(&error),
            }
        }
    }

    fn pause(&mut self, text: String) {
        self.is_playing = false;
        self.notice = Some(Notice {
            kind: NoticeKind::Note,
            text,
        });
    }

    fn refuse(&mut self, error: &(impl Advice + ?Sized)) {
        let text = match error.advice() {
            Some(advice) => format!("{error}\n{advice}"),
            None => error.to_string(),
        };
        self.notice = Some(Notice {
            kind: NoticeKind::Problem,
            text,
        });
    }

    /// What pages show of the present state, at a pace.
    pub(super) fn frame(&self, pace: Option<f64>) -> LiveFrame<'_> {
        let (state, scene) = (self.live.simulation().state(), self.live.file().scene());
        let bodies = self.live.facts().obstacles.iter();
        let bodies = bodies.map(|body| body.motion().pose(state.t));
        let holding = self.holding.iter().map(|body| body.pose(scene, state.t));
        let numbers = |pose: BodyPose| {
            let ([a, b, c, d], [x, y, z]) = (pose.rotation, pose.translation);
            [a, b, c, d, x, y, z]
        };
        let plotted = self.plotted();
        let value = |name: &String| {
            let series = plotted.iter().find(|series| series.name == *name);
            series.and_then(|series| series.values.last().copied())
        };
        let slide = |(k, slider): (usize, &Slider)| {
            let put = self.put.get(&k).copied();
            put.unwrap_or_else(|| slider.value(state.t))
        };
        LiveFrame {
            t: state.t,
            playing: self.is_playing,
            pace: pace.filter(|_| self.is_playing),
            x: self.live.positions(),
            bends: self.live.crease_bends(),
            poses: bodies.chain(holding).map(|p| numbers(p.into())).collect(),
            series: self.series.iter().map(value).collect(),
            hand: self.live.hand().map(|(vertex, at)| HandFrame {
                vertex: vertex.0,
                to: self.aim.unwrap_or(at),
            }),
            sliders: self.sliders.iter().enumerate().map(slide).collect(),
            notice: self.notice.as_ref(),
        }
    }
}
