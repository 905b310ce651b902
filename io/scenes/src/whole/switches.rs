//! What of a scene holds, in the course of a simulation.

use crate::holding::bond::Bond;
use crate::holding::switch::{Condition, Holder, Period, When};
use crate::words::key::Key;
use crate::words::problem::Problem;
use crate::{Scene, SceneError};
use isosheet_dynamics::contact::ContactError;
use isosheet_dynamics::{SimulationError, StepError};
use isosheet_formats::{EventChange, EventKind, EventRow};
use isosheet_mesh::wording::brief;
use serde::{Deserialize, Serialize};

/// What holds of all that does not hold at all times. It is the note that a simulation keeps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Switches(Vec<Switch>);

/// One of the supports, seams or pairs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Switch {
    of: Holder,
    phase: Phase,
    /// Of what was taken up in the course of the simulation the positions that it holds (`3V`, metres), as
    /// they are where its motion is zero.
    rest: Option<Vec<f64>>,
    /// Of a seam the numbers of the pairs that have torn.
    torn: Vec<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    Waiting,
    Holding,
    Released,
}

/// What a step has come to, as far as conditions look at it.
pub(crate) struct Reached<'a> {
    /// Seconds.
    pub(crate) t: f64,
    /// Positions of the vertices of the model, `3V`, metres.
    pub(crate) x: &'a [f64],
    /// What a measure shows.
    pub(crate) measure: &'a dyn Fn(&str) -> Option<f64>,
    /// Size of the force of a support, newtons.
    pub(crate) support: &'a dyn Fn(usize) -> f64,
    /// The seams of the scene.
    pub(crate) bonds: &'a [Option<Bond>],
}

/// Part of a time by which the end of a step may miss it, to allow for round-off.
const ROUND_OFF: f64 = 1e-9;

impl Switches {
    /// At the start.
    pub(crate) fn at_start(scene: &Scene) -> Self {
        let switch = |Period { of, from, .. }: Period<'_>| Switch {
            of,
            phase: match from {
                Some(_) => Phase::Waiting,
                None => Phase::Holding,
            },
            rest: None,
            torn: Vec::new(),
        };
        Self(scene.periods().map(switch).collect())
    }

    /// The note of a simulation that keeps them: nothing where all holds at all times.
    pub(crate) fn note(&self) -> Vec<u8> {
        match self.0.is_empty() {
            true => Vec::new(),
            false => serde_json::to_vec(self).expect("numbers and lists have a form in JSON"),
        }
    }

    /// The switches of a note.
    ///
    /// # Errors
    /// [`SceneError`] if it is not that of a simulation of the scene.
    pub(crate) fn of_note(scene: &Scene, note: &[u8]) -> Result<Self, SceneError> {
        let known = match note.is_empty() {
            true => Ok(Self::default()),
            false => serde_json::from_slice(note),
        };
        known
            .ok()
            .filter(|known: &Self| known.fit(scene))
            .ok_or_else(|| other_switches().into())
    }

    /// Whether they belong to a scene.
    pub(crate) fn fit(&self, scene: &Scene) -> bool {
        let own = self.0.iter().map(|switch| switch.of);
        own.eq(scene.periods().map(|period| period.of))
    }

    /// Whether nothing has been taken up or released yet.
    pub(crate) fn are_at_start(&self, scene: &Scene) -> bool {
        *self == Self::at_start(scene)
    }

    /// Refuses positions of another number of vertices.
    pub(crate) fn check(&self, coordinates: usize) -> Result<(), Problem> {
        let mut rest = self.0.iter().filter_map(|switch| switch.rest.as_ref());
        match rest.all(|x| x.len() == coordinates) {
            true => Ok(()),
            false => Err(other_switches()),
        }
    }

    fn find(&self, of: Holder) -> Option<&Switch> {
        self.0.iter().find(|switch| switch.of == of)
    }

    /// Whether something holds now.
    pub(crate) fn holds(&self, of: Holder) -> bool {
        self.find(of).is_none_or(|s| s.phase == Phase::Holding)
    }

    /// The positions that something holds which was taken up in the course of the simulation.
    pub(crate) fn rest(&self, of: Holder) -> Option<&[f64]> {
        self.find(of)?.rest.as_deref()
    }

    /// The numbers of the pairs of so many that hold.
    pub(crate) fn pairs(&self, of: Holder, count: usize) -> Vec<usize> {
        let Some(switch) = self.find(of) else {
            return (0..count).collect();
        };
        let holds = |pair: &usize| switch.phase == Phase::Holding && !switch.torn.contains(pair);
        (0..count).filter(holds).collect()
    }

    /// Whether a condition is still to be looked at.
    pub(crate) fn wait(&self) -> bool {
        self.0.iter().any(|s| s.phase != Phase::Released)
    }

    /// Whether something is still taken up or released at a time within the run.
    pub(crate) fn are_due(&self, scene: &Scene) -> bool {
        let comes = |when: Option<&When>| match when {
            Some(When::Time(time)) => *time <= scene.stop.time,
            _ => false,
        };
        let mut switches = self.0.iter().zip(scene.periods());
        switches.any(|(switch, period)| match switch.phase {
            Phase::Waiting => comes(period.from) || comes(period.until),
            Phase::Holding => comes(period.until),
            Phase::Released => false,
        })
    }

    /// Takes up and releases what a step asks for; what has happened.
    pub(crate) fn after_step(&mut self, scene: &Scene, reached: &Reached<'_>) -> Vec<EventRow> {
        let switches = self.0.iter_mut().zip(scene.periods());
        let events =
            switches.filter_map(|(switch, period)| switch.after_step(scene, period, reached));
        events.collect()
    }
}

impl Switch {
    fn after_step(
        &mut self,
        scene: &Scene,
        Period { from, until, .. }: Period<'_>,
        reached: &Reached<'_>,
    ) -> Option<EventRow> {
        match self.phase {
            Phase::Waiting if from.is_some_and(|when| when.has_come(reached)) => {
                self.phase = Phase::Holding;
                self.rest = match self.of {
                    Holder::Support(k) => Some(scene.support[k].hold.at_rest(reached.t, reached.x)),
                    Holder::Glue(_) => Some(reached.x.to_vec()),
                    Holder::Contact(_) => None,
                };
                Some(self.event(reached.t, EventChange::TakenUp, None, None))
            }
            Phase::Holding => self.released(until?, reached),
            _ => None,
        }
    }

    /// Releases it, or some of its pairs, if the time has come.
    fn released(&mut self, until: &When, reached: &Reached<'_>) -> Option<EventRow> {
        let limit = match until {
            When::Condition(Condition::Force(limit)) => *limit,
            _ if until.has_come(reached) => f64::NEG_INFINITY,
            _ => return None,
        };
        let largest = |forces: &[f64]| forces.iter().copied().reduce(f64::max);
        match self.of {
            Holder::Support(k) => {
                let force = (reached.support)(k);
                if force < limit {
                    return None;
                }
                self.phase = Phase::Released;
                Some(self.event(reached.t, EventChange::Released, None, Some(force)))
            }
            Holder::Contact(_) => {
                self.phase = Phase::Released;
                Some(self.event(reached.t, EventChange::Released, None, None))
            }
            Holder::Glue(k) => {
                let bond = reached.bonds.get(k).and_then(Option::as_ref)?;
                let all = bond.forces(reached.t, reached.x);
                let tear: Vec<_> = all.iter().filter(|(_, force)| *force >= limit).collect();
                if tear.is_empty() {
                    return None;
                }
                self.torn.extend(tear.iter().map(|(pair, _)| *pair));
                let change = match tear.len() == all.len() {
                    true => EventChange::Released,
                    false => EventChange::Torn,
                };
                if change == EventChange::Released {
                    self.phase = Phase::Released;
                    self.rest = None;
                }
                let forces: Vec<f64> = tear.iter().map(|(_, force)| *force).collect();
                Some(self.event(reached.t, change, Some(tear.len()), largest(&forces)))
            }
        }
    }

    fn event(
        &self,
        t: f64,
        change: EventChange,
        pairs: Option<usize>,
        force: Option<f64>,
    ) -> EventRow {
        let (on, number) = match self.of {
            Holder::Support(k) => (EventKind::Support, k),
            Holder::Glue(k) => (EventKind::Glue, k),
            Holder::Contact(k) => (EventKind::Contact, k),
        };
        EventRow {
            t,
            on,
            number,
            change,
            pairs,
            force,
        }
    }
}

impl When {
    /// Whether a time has come or a threshold is passed. (Forces are looked at where they are known.)
    fn has_come(&self, reached: &Reached<'_>) -> bool {
        match self {
            Self::Time(time) => reached.t >= time * (1.0 - ROUND_OFF),
            Self::Condition(Condition::Force(_)) => false,
            Self::Condition(Condition::Measure(threshold)) => {
                let value = (reached.measure)(&threshold.name);
                value.is_some_and(|value| threshold.is_passed(value))
            }
        }
    }
}

pub(crate) fn other_switches() -> Problem {
    Problem::new(
        Key::root(),
        "the checkpoint is of a simulation in which other supports, seams or contacts hold",
        "go on with the scene of the checkpoint",
    )
}

/// What could not be taken up, in the words of the scene.
pub(crate) fn not_taken_up(
    events: &[EventRow],
    error: &SimulationError,
    problem: Problem,
) -> Problem {
    let taken_up = events.iter().find(|e| e.change == EventChange::TakenUp);
    let Some(event) = taken_up else {
        return problem;
    };
    let of = match event.on {
        EventKind::Support => Holder::Support(event.number),
        EventKind::Glue => Holder::Glue(event.number),
        EventKind::Contact => Holder::Contact(event.number),
    };
    let key = of.key();
    let message = format!(
        "`{key}` cannot be taken up at {} s: {error}",
        brief(event.t)
    );
    let remedy = match error {
        SimulationError::Contact(ContactError::Touching { .. }) => {
            "let them be apart at that moment: contact keeps a gap, it does not make one"
        }
        SimulationError::Start(StepError::OffSupport { .. }) => {
            "let the curve or surface go through its vertices at that moment"
        }
        _ => "choose another moment",
    };
    Problem::new(key.name("from"), message, remedy)
}
