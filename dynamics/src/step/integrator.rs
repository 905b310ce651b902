//! What all chart-free integrators have in common: they propose, and leave it to the step control to commit.

use crate::contact::ContactState;
use crate::objective::Objective;
use crate::report::effort::SolverEffort;
use crate::report::step_report::StepOutcome;
use crate::step::accepted::{AcceptedStep, Recording, Taken};
use crate::step::history::{BodyChange, History, Multipliers};
use crate::step::local_error::LocalError;
use crate::step::motion::Motion;
use crate::step::reaction::{Balance, ForceTime};
use crate::{SheetModel, State};
use isosheet_materials::potential::{Memories, Settled};
use isosheet_model::StepError;
use isosheet_model::term::Exchange;

/// What an integrator moves: a sheet, with what damped steps minimise.
pub(crate) struct Scene<'a> {
    /// The sheet.
    pub(crate) model: &'a SheetModel,
    pub(crate) objective: &'a mut Objective,
}

/// A sub-step that could be taken.
#[derive(Debug, Clone)]
pub(crate) struct Proposal {
    /// Where the sub-step would end.
    pub(crate) motion: Motion,
    /// What it would achieve.
    pub(crate) account: StepAccount,
    /// What it did to what potentials remember, which is in the motion then; nothing where that is left to
    /// the commit.
    pub(crate) settled: Option<Settled>,
    /// What it was solved from, where accepted sub-steps are handed out.
    pub(crate) taken: Option<Box<Taken>>,
    /// The steps of a search, where they are handed out.
    pub(crate) search: Vec<AcceptedStep>,
}

/// What a proposed sub-step achieves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepAccount {
    /// Relative residual of the momentum balance.
    pub(crate) residual: f64,
    /// How the sub-step was obtained.
    pub(crate) outcome: StepOutcome,
    /// Energy exchanged at the free vertices.
    pub(crate) exchange: Exchange,
    /// Energy that the velocity damping has taken, joules.
    pub(crate) damped: f64,
    /// The estimated error of the positions, by methods that have an estimate.
    pub(crate) error: Option<LocalError>,
    /// The lowest frequency about an equilibrium, hertz.
    pub(crate) lowest_frequency: Option<f64>,
}

impl Proposal {
    /// Room for the proposals of a method.
    pub(crate) fn new(model: &SheetModel, traits: MethodTraits) -> Self {
        let nowhere = State::at_rest(vec![0.0; model.coordinate_count()]);
        Self {
            motion: Motion::at(nowhere, model, traits.balance(model)),
            account: StepAccount::of_forces(0.0, 0.0, StepOutcome::Newton),
            settled: None,
            taken: None,
            search: Vec::new(),
        }
    }
}

impl StepAccount {
    /// Of a step in which forces did work (joules), and nothing else.
    pub(crate) fn of_forces(residual: f64, work: f64, outcome: StepOutcome) -> Self {
        Self {
            residual,
            outcome,
            exchange: Exchange {
                work,
                ..Exchange::default()
            },
            damped: 0.0,
            error: None,
            lowest_frequency: None,
        }
    }
}

/// A sub-step to be proposed: from where, how long, and with how much of the history.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Attempt<'a> {
    /// Where the sub-step begins.
    pub(crate) state: &'a State,
    /// Its length, seconds. (Negative ones occur inside compositions.)
    pub(crate) h: f64,
    /// The phases of a minimisation that may be tried.
    pub(crate) phases: Phases,
    /// What the potentials remember.
    pub(crate) memories: &'a Memories,
    /// The contacts at its beginning.
    pub(crate) contacts: Option<&'a ContactState>,
    history: &'a History,
    memory: Memory,
    recording: Recording,
}

/// The phases of a minimisation that a sub-step of rods among bodies and supports at rest may try.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phases {
    /// The first two, the second one within bounds of the first one: where both fail the step is divided.
    Brief,
    /// All of them.
    All,
    /// All, by a search that takes where their iterations have come to when they are used up.
    Search,
}

/// How much of the history a sub-step begins with. Each refusal of a sub-step takes away from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Memory {
    /// Nothing: the step is that of a one-step method, from a first guess without multipliers.
    Restart,
    /// The state before the present one; the multipliers were no good as a first guess.
    State,
    /// Everything.
    All,
}

/// No multipliers.
static NONE: Multipliers = Multipliers {
    step: 0.0,
    rods: Vec::new(),
    constraints: Vec::new(),
};

impl<'a> Attempt<'a> {
    /// A sub-step of `h` seconds from a motion that may try all phases.
    pub(crate) fn new(start: &'a Motion, h: f64, memory: Memory) -> Self {
        Self {
            state: &start.state,
            h,
            phases: Phases::All,
            memories: &start.memories,
            contacts: start.contacts.as_ref(),
            history: &start.history,
            memory,
            recording: Recording::Off,
        }
    }

    /// As part of a run whose accepted sub-steps are handed out.
    pub(crate) fn recorded(self, recording: Recording) -> Self {
        Self { recording, ..self }
    }

    /// Whether the run is one of those.
    pub(crate) fn recording(&self) -> Recording {
        self.recording
    }

    /// Whether it says what it was solved from.
    pub(crate) fn is_recorded(&self) -> bool {
        self.recording == Recording::On
    }

    /// From another state.
    pub(crate) fn from(self, state: &'a State) -> Self {
        Self { state, ..self }
    }

    /// With these phases of a minimisation alone.
    pub(crate) fn with(self, phases: Phases) -> Self {
        Self { phases, ..self }
    }

    /// The state before the present one, for methods that look back.
    pub(crate) fn previous(&self) -> Option<&'a State> {
        match self.memory {
            Memory::Restart => None,
            Memory::State | Memory::All => self.history.previous.as_ref(),
        }
    }

    /// What contact made of the last change of the velocities of rigid bodies.
    pub(crate) fn body_changes(&self) -> &'a [BodyChange] {
        &self.history.body_changes
    }

    /// Multipliers of the step before, as a first guess.
    pub(crate) fn multipliers(&self) -> &'a Multipliers {
        match self.memory {
            Memory::Restart | Memory::State => &NONE,
            Memory::All => &self.history.multipliers,
        }
    }

    /// Pairs of vertices that the matrix had room for at the start.
    pub(crate) fn couplings(&self) -> &'a [[u32; 2]] {
        &self.history.couplings
    }

    /// Stiffness of the rods in the linear systems of the step before; zero if there were none.
    pub(crate) fn rod_stiffness(&self) -> f64 {
        self.history.rod_stiffness
    }

    /// Impulses of the step before and their factor in this one, the ratio of the steps: zero if there are
    /// none.
    pub(crate) fn scaled_multipliers(&self) -> (f64, &'a Multipliers) {
        let last = self.multipliers();
        let ratio = if last.step == 0.0 {
            0.0
        } else {
            self.h / last.step
        };
        (ratio, last)
    }
}

/// A one-step or multistep method, as a function from a motion to a proposal.
///
/// An integrator owns work arrays and factorisations, and nothing that a later step depends on: after a
/// refusal, and after a proposal that is not committed, it answers the same question with the same bits.
pub(crate) trait Integrator: Send {
    /// Proposes a sub-step. On success `proposal` is complete; after an error its contents have no meaning.
    ///
    /// `effort` is counted up in either case.
    ///
    /// # Errors
    /// [`StepError`] says why there is no such step.
    fn propose(
        &mut self,
        scene: Scene<'_>,
        attempt: Attempt<'_>,
        proposal: &mut Proposal,
        effort: &mut SolverEffort<'_>,
    ) -> Result<(), StepError>;

    /// What the method asks of a scene and what it can take.
    fn traits(&self) -> MethodTraits;
}

/// What a method asks of a scene, and what it can take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct MethodTraits {
    /// What the method asks of the rods.
    pub(crate) demand: RodDemand,
    /// How the method takes contact.
    pub(crate) contact: ContactSupport,
}

impl MethodTraits {
    /// Room for the forces of supports in the steps of the method.
    pub(crate) fn balance(self, model: &SheetModel) -> Balance {
        match self.demand {
            RodDemand::Independent => Balance::new(model, ForceTime::Mean),
            RodDemand::Nothing => Balance::with_residual(model, ForceTime::End),
        }
    }

    /// BDF2 and implicit Euler: minimisations, at any rank of the rods, with contact as a barrier.
    pub(crate) fn minimising() -> Self {
        Self {
            demand: RodDemand::Nothing,
            contact: ContactSupport::Barrier,
        }
    }

    /// Energy-momentum and RATTLE.
    pub(crate) fn conservative() -> Self {
        Self {
            demand: RodDemand::Independent,
            contact: ContactSupport::None,
        }
    }
}

/// How a method takes contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ContactSupport {
    /// As a barrier potential within the step.
    Barrier,
    /// Not at all.
    None,
}

/// What an integrator asks of the rods' rigidity matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RodDemand {
    /// Loaded rods have to be independent: the method solves for their impulses and keeps the energy.
    Independent,
    /// Nothing: the method minimises, at any rank, and dissipates energy. One-sided constraints have a place.
    Nothing,
}
