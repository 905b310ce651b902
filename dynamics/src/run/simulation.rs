//! Simulations.

use crate::contact::{
    ActiveContacts, BodyLoad, Contact, ContactError, ContactState, ContactTerms, SurfacePoints,
};
use crate::damped::start::{check_finite, check_motions, check_potentials, check_state};
use crate::engine::substeps::Engine as MethodEngine;
use crate::engine::{Engine, Progress};
use crate::report::checkpoint_error::CheckpointError;
use crate::report::effort::{SolverEffort, StepProgress, TraceSink, Watch};
use crate::report::simulation_error::SimulationError;
use crate::report::step_report::StepReport;
use crate::report::totals::StepTotals;
use crate::run::checkpoint::{Checkpoint, EnergySums, EngineState, SheetFingerprint};
use crate::sensitivity::StepEquations;
use crate::step::accepted::AcceptedStep;
use crate::step::reaction::{Imbalance, Reaction};
use crate::{ElasticDeformation, HandError, Method, SheetModel, State, StepControl};
use isosheet_materials::potential::At;
use isosheet_materials::potential::Memories;
use isosheet_mesh::VertexId;
use isosheet_model::Breaks;
use isosheet_model::StepError;
use isosheet_model::TraceEvent;
use std::any::Any;
use std::ops::ControlFlow;
use std::sync::Arc;

/// A simulation: model, state, integrator, step control and energy balance.
///
/// ```
/// use isosheet_dynamics::{Method, SheetModel, Simulation, State};
/// use isosheet_mesh::{MassKind, VertexId, generate};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let sheet = generate::isotropic_square(1, 0.21)?;
/// let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)?
///     .with_gravity()
///     .with_pins(&[VertexId(20)])?;
/// let start = State::at_rest(sheet.positions().to_vec());
/// let mut simulation = Simulation::new(model, start, Method::default())?;
/// let report = simulation.step(1.0 / 60.0)?;
/// assert!(report.strain < 1e-12);
/// # Ok(())
/// # }
/// ```
pub struct Simulation {
    pub(super) engine: Moved,
    /// Identifies the model that its user built.
    pub(super) sheet: SheetFingerprint,
    energy: EnergySums,
    /// What the program that runs it keeps with it.
    note: Vec<u8>,
    /// Scratch, `3V`.
    force: Vec<f64>,
    /// Receives trace events.
    trace: Option<Box<TraceSink>>,
}

/// A simulation can move to another thread.
const _: fn() = || {
    fn is_send<T: Send>() {}
    is_send::<Simulation>();
};

/// What moves a sheet.
pub(super) enum Moved {
    /// A method of this crate.
    ByMethod(Box<MethodEngine>),
    /// An engine from outside.
    ByEngine(Box<dyn Engine>),
}

impl Simulation {
    /// A chart-free simulation of `model` from `state`.
    ///
    /// Velocities of pinned vertices are set to their motion. Vertices on a straight line of rods between two
    /// pins at rest become pins, see [`Simulation::immobile_vertices`].
    ///
    /// # Errors
    /// [`SimulationError`] if options or state are invalid, or the state does not have the rest lengths to
    /// 1e-8 (see [`project_positions`](crate::project_positions)).
    pub fn new(model: SheetModel, state: State, method: Method) -> Result<Self, SimulationError> {
        Self::with_method(model, state, method, MethodEngine::new)
    }

    /// As [`Simulation::new`], for the [equations](Simulation::step_equations) of its steps alone, by BDF2,
    /// implicit Euler and searches for equilibria: it takes no steps, and costs less.
    ///
    /// # Errors
    /// As [`Simulation::new`].
    pub fn of_equations(
        model: SheetModel,
        state: State,
        method: Method,
    ) -> Result<Self, SimulationError> {
        Self::with_method(model, state, method, MethodEngine::of_equations)
    }

    fn with_method(
        model: SheetModel,
        mut state: State,
        method: Method,
        build: fn(SheetModel, Method, State) -> Result<MethodEngine, SimulationError>,
    ) -> Result<Self, SimulationError> {
        check_length(&model, &state)?;
        check_motions(&model, &state)?;
        let sheet = SheetFingerprint::of(&model);
        model.clear_pinned(&mut state.v);
        model.set_pin_velocities(state.t, MOTION_SPAN, &mut state.v);
        check_state(&model, &state)?;
        check_potentials(&model, &model.memories(), &state)?;
        let engine = Moved::ByMethod(Box::new(build(model, method, state)?));
        Ok(Self::start(engine, sheet))
    }

    /// A simulation of `model` from `state` that an engine from outside moves, which `build` makes of the
    /// two.
    ///
    /// # Errors
    /// [`SimulationError`] if the state is invalid, and the errors of `build`.
    pub fn with_engine(
        model: SheetModel,
        state: State,
        build: impl FnOnce(SheetModel, State) -> Result<Box<dyn Engine>, SimulationError>,
    ) -> Result<Self, SimulationError> {
        check_length(&model, &state)?;
        check_motions(&model, &state)?;
        check_state(&model, &state)?;
        let sheet = SheetFingerprint::of(&model);
        Ok(Self::start(Moved::ByEngine(build(model, state)?), sheet))
    }

    fn start(engine: Moved, sheet: SheetFingerprint) -> Self {
        let mut simulation = Self {
            engine,
            sheet,
            energy: EnergySums::default(),
            note: Vec::new(),
            force: Vec::new(),
            trace: None,
        };
        simulation.force = vec![0.0; simulation.state().x.len()];
        simulation.energy.start = simulation.energy();
        simulation
    }

    /// The checkpoint of the present state.
    pub fn checkpoint(&self) -> Checkpoint {
        let motion = match &self.engine {
            Moved::ByMethod(engine) => EngineState::Method(Box::new(engine.kept())),
            Moved::ByEngine(engine) => EngineState::Other {
                name: engine.name().to_owned(),
                bytes: engine.kept(),
            },
        };
        Checkpoint::new(self.sheet, self.energy, motion, self.note.clone())
    }

    /// Keeps a note with the simulation, which its checkpoints have too: what the program that runs it needs
    /// to build the model and the contact again ([`Checkpoint::note`]).
    pub fn set_note(&mut self, note: Vec<u8>) {
        self.note = note;
    }

    /// Resumes a chart-free simulation from a checkpoint bit for bit, with the model and the contact of its
    /// start.
    ///
    /// # Errors
    /// [`SimulationError::Checkpoint`] if the checkpoint is invalid, or of another model or kind of
    /// simulation.
    pub fn resume(
        model: SheetModel,
        contact: Option<Box<dyn Contact>>,
        checkpoint: Checkpoint,
    ) -> Result<Self, SimulationError> {
        checkpoint.check_model(&model)?;
        checkpoint.energy.check()?;
        let kept = match checkpoint.motion {
            EngineState::Method(kept) => kept,
            EngineState::Other { name: found, .. } => {
                return Err(CheckpointError::Engine { found }.into());
            }
        };
        let engine = Moved::ByMethod(Box::new(MethodEngine::resume(model, contact, *kept)?));
        let Checkpoint {
            sheet,
            energy,
            note,
            ..
        } = checkpoint;
        Ok(Self::resumed(engine, sheet, energy, note))
    }

    /// Resumes a simulation that an engine from outside moves, bit for bit, with the model of its start. The
    /// engine is of this [name](Engine::name), and `build` makes it of the model and of what it
    /// [kept](Engine::kept).
    ///
    /// # Errors
    /// [`SimulationError::Checkpoint`] if the checkpoint is invalid, or of another model or engine; the
    /// errors of `build`.
    pub fn resume_with_engine(
        model: SheetModel,
        checkpoint: Checkpoint,
        name: &str,
        build: impl FnOnce(SheetModel, &[u8]) -> Result<Box<dyn Engine>, SimulationError>,
    ) -> Result<Self, SimulationError> {
        checkpoint.check_model(&model)?;
        checkpoint.energy.check()?;
        let bytes = match checkpoint.motion {
            EngineState::Other { name: found, bytes } if found == name => bytes,
            EngineState::Other { name: found, .. } => {
                return Err(CheckpointError::Engine { found }.into());
            }
            EngineState::Method(_) => {
                let found = "a method without a chart".to_owned();
                return Err(CheckpointError::Engine { found }.into());
            }
        };
        let engine = Moved::ByEngine(build(model, &bytes)?);
        let Checkpoint {
            sheet,
            energy,
            note,
            ..
        } = checkpoint;
        Ok(Self::resumed(engine, sheet, energy, note))
    }

    fn resumed(engine: Moved, sheet: SheetFingerprint, energy: EnergySums, note: Vec<u8>) -> Self {
        let mut simulation = Self {
            engine,
            sheet,
            energy,
            note,
            force: Vec::new(),
            trace: None,
        };
        simulation.force = vec![0.0; simulation.state().x.len()];
        simulation
    }

    /// Sets the step control of a chart-free method.
    ///
    /// # Errors
    /// [`SimulationError::Options`], [`SimulationError::ChartControl`].
    pub fn with_control(mut self, control: StepControl) -> Result<Self, SimulationError> {
        match &mut self.engine {
            Moved::ByMethod(engine) => engine.set_control(control)?,
            Moved::ByEngine(_) => return Err(SimulationError::ChartControl),
        }
        Ok(self)
    }

    /// Sets a sink for the [`TraceEvent`]s of the steps to come: iterations, phases, refusals and accepted
    /// sub-steps. Results do not depend on it. Charts have no events.
    ///
    /// ```
    /// # use isosheet_dynamics::{Method, SheetModel, Simulation, State, TraceEvent};
    /// # use isosheet_mesh::{MassKind, VertexId, generate};
    /// # use std::sync::mpsc;
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let sheet = generate::isotropic_square(1, 0.21)?;
    /// # let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)?
    /// #     .with_gravity()
    /// #     .with_pins(&[VertexId(20)])?;
    /// # let start = State::at_rest(sheet.positions().to_vec());
    /// let (sender, events) = mpsc::channel();
    /// let mut simulation = Simulation::new(model, start, Method::default())?
    ///     .with_trace(move |event| drop(sender.send(event.clone())));
    /// let report = simulation.step(1.0 / 60.0)?;
    /// let iterations = events.try_iter().filter(|e| matches!(e, TraceEvent::Iteration { .. }));
    /// assert!((1..=report.iterations).contains(&iterations.count()));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn with_trace(mut self, sink: impl FnMut(&TraceEvent) + Send + 'static) -> Self {
        self.set_trace(sink);
        self
    }

    /// As [`Simulation::with_trace`], in place.
    pub fn set_trace(&mut self, sink: impl FnMut(&TraceEvent) + Send + 'static) {
        self.trace = Some(Box::new(sink));
    }

    /// Sets a sink for the accepted sub-steps to come of BDF2, implicit Euler and equilibria; results do not
    /// depend on it. Other methods hand out none.
    pub fn set_recorder(&mut self, sink: impl FnMut(AcceptedStep) + Send + 'static) {
        if let Moved::ByMethod(engine) = &mut self.engine {
            engine.set_recorder(Box::new(sink));
        }
    }

    /// The equations of its steps, which it evaluates wherever it is asked to; the state stays as it is.
    /// Nothing in charts.
    pub fn step_equations(&mut self) -> Option<StepEquations<'_>> {
        match &mut self.engine {
            Moved::ByMethod(engine) => {
                let (model, objective) = engine.parts();
                Some(StepEquations::new(model, objective))
            }
            Moved::ByEngine(_) => None,
        }
    }

    /// Adds contact: a barrier potential that keeps every gap positive.
    ///
    /// # Errors
    /// [`SimulationError::Contact`] if the method does not support contact or the state is in contact.
    pub fn with_contact(self, contact: impl Contact + 'static) -> Result<Self, SimulationError> {
        self.with_boxed_contact(Box::new(contact))
    }

    /// As [`Simulation::with_contact`], of a contact whose type is not known.
    ///
    /// # Errors
    /// As [`Simulation::with_contact`].
    pub fn with_boxed_contact(
        mut self,
        contact: Box<dyn Contact>,
    ) -> Result<Self, SimulationError> {
        match &mut self.engine {
            Moved::ByMethod(engine) => engine.set_contact(contact)?,
            Moved::ByEngine(_) => return Err(ContactError::Method.into()),
        }
        self.energy.start = self.energy();
        Ok(self)
    }

    /// Free vertices that rods to fixed vertices hold in place and that became pins at the start (see
    /// [`immobile_vertices`](crate::immobile_vertices)). Empty in charts.
    pub fn immobile_vertices(&self) -> &[VertexId] {
        match &self.engine {
            Moved::ByMethod(engine) => engine.immobile(),
            Moved::ByEngine(_) => &[],
        }
    }

    /// The contacts of the present state; `None` without contact.
    pub fn contacts(&self) -> Option<&ActiveContacts> {
        match &self.engine {
            Moved::ByMethod(engine) => engine.contacts().map(|contacts| &contacts.active),
            Moved::ByEngine(_) => None,
        }
    }

    /// Loads of the sheet on the bodies, in order of addition; empty without contact.
    pub fn body_loads(&self) -> Vec<BodyLoad> {
        self.barrier().map_or_else(Vec::new, |contacts| {
            let x = SurfacePoints::placed(self.surface_points(), &self.state().x);
            ContactTerms::of(contacts, &x).loads()
        })
    }

    /// Contact forces on the vertices, newtons (`3V`), normal forces and friction of bodies and of the sheet
    /// with itself; `None` without contact.
    ///
    /// BDF2 and implicit Euler: `-d(B + D)/dx` at the end of the last accepted sub-step, with the barrier
    /// potential `B` and the potential `D` of lagged friction. Forces on edges and faces are distributed to
    /// their corners by the weights of the closest point. The sum over the vertices is minus that of
    /// [`Simulation::body_loads`].
    ///
    /// Before the first step there is no friction. With rigid rods the final
    /// projection changes the forces to second order, about a percent for a flat sheet at rest.
    pub fn contact_forces(&self) -> Option<Vec<f64>> {
        match &self.engine {
            Moved::ByMethod(engine) => {
                let points = self.surface_points();
                let x = SurfacePoints::placed(points, &self.state().x);
                Some(ContactTerms::of(engine.contacts()?, &x).vertex_forces(points))
            }
            Moved::ByEngine(_) => None,
        }
    }

    /// Contact forces on the points of the surface where that is not the sheet ([`SurfacePoints`]), newtons:
    /// three components for each point.
    pub fn surface_forces(&self) -> Option<Vec<f64>> {
        match &self.engine {
            Moved::ByMethod(engine) => {
                let x = SurfacePoints::placed(self.surface_points(), &self.state().x);
                Some(ContactTerms::of(engine.contacts()?, &x).vertex_forces(None))
            }
            Moved::ByEngine(_) => None,
        }
    }

    /// Smallest gap of each vertex, or of each point of the surface where that is not the sheet
    /// ([`SurfacePoints`]), and of its edges and faces, metres: a distance less the thickness of the
    /// sheet and the radius of a rounded body, and at most the activation distance of the barrier. `None`
    /// without contact.
    pub fn vertex_gaps(&self) -> Option<Vec<f64>> {
        let reach = match &self.engine {
            Moved::ByMethod(engine) => engine.contacts()?.barrier.activation(),
            Moved::ByEngine(_) => return None,
        };
        let count = match self.surface_points() {
            None => self.model().topology().vertex_count(),
            Some(points) => points.count(),
        };
        Some(self.contacts()?.point_gaps(count, reach))
    }

    /// The points between which contact acts, where these are not the vertices.
    fn surface_points(&self) -> Option<&SurfacePoints> {
        match &self.engine {
            Moved::ByMethod(engine) => engine.surface_points(),
            Moved::ByEngine(_) => None,
        }
    }

    /// Contact by a barrier.
    fn barrier(&self) -> Option<&ContactState> {
        match &self.engine {
            Moved::ByMethod(engine) => engine.contacts(),
            Moved::ByEngine(_) => None,
        }
    }

    /// Forces of the pins, then of the vertex constraints, on the sheet in the last accepted sub-step,
    /// newtons; in charts at the end of the step. Empty before the first step.
    ///
    /// At a pin `R = M a - f + G^T lambda` with the discrete acceleration `a` and the multipliers `lambda`
    /// (tension positive), at a vertex constraint with Jacobian `J` and multipliers `mu` `R = -J^T mu`.
    /// Reactions, contact forces, weight and other forces add up to a rate of the momentum `p = sum M v`, for
    /// a sub-step of `h` seconds without velocity damping ([`Simulation::imbalance`] says what is left of
    /// it):
    ///
    /// | method | rate of `p` | weight and other forces |
    /// |---|---|---|
    /// | BDF2 | `(p1 - (1 + b) p0 + b p_) / (k h)`, see [`Method::Bdf2`] | at the end |
    /// | implicit Euler | `(p1 - p0) / h` | at the end |
    /// | energy-momentum, RATTLE | `(p1 - p0) / h` | over the step |
    ///
    /// The conservative methods keep this balance to round-off; the damped methods to the tolerance of
    /// Newton's method, and in contact to the second-order change of contact forces by the final projection.
    ///
    /// With damped methods a call costs one factorisation per iteration of the last projection.
    pub fn reactions(&self) -> Vec<Reaction> {
        match &self.engine {
            Moved::ByMethod(engine) => {
                let balance = engine.balance();
                balance.map_or_else(Vec::new, |b| b.reactions(&engine.model, engine.state().t))
            }
            Moved::ByEngine(engine) => engine.reactions(),
        }
    }

    /// Says anew when what is prescribed changes abruptly (seconds), as [`SheetModel::with_breaks`] does,
    /// where a motion is led otherwise than it was foreseen.
    pub fn set_breaks(&mut self, times: impl IntoIterator<Item = f64>) {
        if let Moved::ByMethod(engine) = &mut self.engine {
            engine.breaks = Breaks::at(times);
        }
    }

    /// What all forces of the last accepted sub-step leave of the balance of forces and torques; nothing
    /// before the first step, without supports, in charts, and by the conservative methods, which keep the
    /// balance of forces to round-off.
    ///
    /// Of sheets without rods it costs next to nothing, of others as much as [`Simulation::reactions`].
    pub fn imbalance(&self) -> Option<Imbalance> {
        match &self.engine {
            Moved::ByMethod(engine) => engine.balance()?.imbalance(&engine.model, engine.state()),
            Moved::ByEngine(_) => None,
        }
    }

    /// Moments by which clamps along lines of vertices ([`LineClamp`](crate::LineClamp)) hold the slopes of
    /// the sheet at the present state, newton metres, in the order of the potentials and of their clamps.
    /// With the forces of the pins ([`Simulation::reactions`]) they are all that such a clamp does.
    pub fn clamp_moments(&self) -> Vec<[f64; 3]> {
        let State { t, x, .. } = self.state();
        let at = |memory| At::new(*t, x).with_memory(memory);
        let reports = self.model().reports(self.memories());
        reports
            .flat_map(|(p, memory)| p.clamp_moments(at(memory)))
            .collect()
    }

    /// Forces of the rods in the last accepted sub-step, newtons, tension positive, in the order of the
    /// edges; zero of edges of elastic sheets. `None` in charts, and where all sheets are elastic.
    ///
    /// | method | time of the forces |
    /// |---|---|
    /// | BDF2, implicit Euler | end of the sub-step |
    /// | energy-momentum | mean over the sub-step |
    /// | RATTLE | start of the sub-step, in compositions of the last part |
    ///
    /// Zero before the first step, after a [`Fallback`](crate::Fallback), and between vertices that cannot
    /// move. Forces of dependent rods, as in a flat sheet, are not unique: BDF2 and implicit Euler give the
    /// forces of least squares with the same loads on the free vertices, without loads across folds flatter
    /// than 0.3 degrees, at the cost of one factorisation. (Where that fails, as with bodies whose masses
    /// differ by more than arithmetic can take, they give one of the sets of forces with these loads.)
    pub fn rod_forces(&self) -> Option<Vec<f64>> {
        match &self.engine {
            Moved::ByMethod(engine) => engine.rod_forces(),
            Moved::ByEngine(_) => None,
        }
    }

    /// The model, which may be kept when the simulation is gone.
    pub fn model(&self) -> &Arc<SheetModel> {
        match &self.engine {
            Moved::ByMethod(engine) => &engine.model,
            Moved::ByEngine(engine) => engine.model(),
        }
    }

    /// The engine from outside, if it is of this type.
    pub fn engine<T: Engine>(&self) -> Option<&T> {
        match &self.engine {
            Moved::ByMethod(_) => None,
            Moved::ByEngine(engine) => (&**engine as &dyn Any).downcast_ref(),
        }
    }

    /// Time, positions and velocities.
    pub fn state(&self) -> &State {
        match &self.engine {
            Moved::ByMethod(engine) => engine.state(),
            Moved::ByEngine(engine) => engine.state(),
        }
    }

    /// What the potentials of the model remember ([`Remembering`](crate::Remembering)).
    pub fn memories(&self) -> &Memories {
        match &self.engine {
            Moved::ByMethod(engine) => engine.memories(),
            Moved::ByEngine(engine) => engine.memories(),
        }
    }

    /// Leads the hand that holds a vertex ([`Hand`](crate::Hand)) from where it is to a point (metres) until
    /// time `end` (seconds), on a straight way with a constant speed. The energy does not jump.
    ///
    /// ```
    /// use isosheet_dynamics::{Hand, Method, SheetModel, Simulation, State};
    /// use isosheet_mesh::{MassKind, VertexId, generate};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let sheet = generate::isotropic_square(1, 0.21)?;
    /// let corner = VertexId(20);
    /// let hand = Hand::new(sheet.topology(), corner, 10.0, sheet.position(corner))?;
    /// let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)?.with_hand(hand);
    /// let start = State::at_rest(sheet.positions().to_vec());
    /// let mut simulation = Simulation::new(model, start, Method::default())?;
    /// for _ in 0..60 {
    ///     // The hand rises by 0.1 m/s.
    ///     let t = simulation.state().t;
    ///     let mut to = simulation.hand_target(corner)?;
    ///     to[2] += 0.1 / 60.0;
    ///     simulation.lead_hand(corner, to, t + 1.0 / 60.0)?;
    ///     simulation.step(1.0 / 60.0)?;
    /// }
    /// assert!((simulation.state().x[62] - 0.1).abs() < 0.01);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`HandError`] if there is no such hand, or the point is not finite; then nothing has changed.
    pub fn lead_hand(&mut self, vertex: VertexId, to: [f64; 3], end: f64) -> Result<(), HandError> {
        match &mut self.engine {
            Moved::ByMethod(engine) => engine.lead_hand(vertex, to, end),
            Moved::ByEngine(engine) => {
                let mut memories = engine.memories().clone();
                let (number, hand) = engine.model().hand(vertex)?;
                hand.lead(to, [engine.state().t, end], memories.list_mut(number))?;
                *engine.memories_mut() = memories;
                Ok(())
            }
        }
    }

    /// Where the hand is now that holds a vertex, metres.
    ///
    /// # Errors
    /// [`HandError::NoHand`].
    pub fn hand_target(&self, vertex: VertexId) -> Result<[f64; 3], HandError> {
        let (number, hand) = self.model().hand(vertex)?;
        let memory = &self.memories().lists()[number];
        Ok(hand.target(self.state().t, memory).into())
    }

    /// The plastic angle of each edge now, see [`SheetModel::plastic_angles`].
    pub fn plastic_angles(&self) -> Option<Vec<f64>> {
        self.model().plastic_angles(self.memories())
    }

    /// The bend of the faces beside each crease now, see [`SheetModel::bends_at_creases`].
    pub fn bends_at_creases(&self) -> Option<Vec<f64>> {
        let State { t, x, .. } = self.state();
        self.model().bends_at_creases(*t, x, self.memories())
    }

    /// The principal values of the plastic curvature of each face now, see
    /// [`SheetModel::plastic_curvatures`].
    pub fn plastic_curvatures(&self) -> Option<Vec<[f64; 2]>> {
        self.model().plastic_curvatures(self.memories())
    }

    /// How an elastic sheet is deformed now, see [`SheetModel::elastic_deformation`].
    pub fn elastic_deformation(&self) -> Option<ElasticDeformation> {
        let State { t, x, .. } = self.state();
        self.model().elastic_deformation(*t, x, self.memories())
    }

    /// Total energy `T + V`, contact included, joules.
    pub fn energy(&self) -> f64 {
        self.model().kinetic_energy(&self.state().v) + self.potential_energy()
    }

    /// Adds work (joules) that no step has done to the energy balance.
    pub(super) fn count_work(&mut self, work: f64) {
        self.energy.work += work;
    }

    fn potential_energy(&self) -> f64 {
        let State { t, x, .. } = self.state();
        let potential = self.model().energy_with(self.memories(), *t, x);
        match self.barrier() {
            None => potential,
            Some(contacts) => potential + contacts.active.barrier_energy(&contacts.barrier),
        }
    }

    /// Advances by exactly `h` seconds, in sub-steps where the step control asks for them.
    ///
    /// # Errors
    /// [`StepError`]; the state is that of the last accepted sub-step.
    pub fn step(&mut self, h: f64) -> Result<StepReport, StepError> {
        self.advance(h, None)
    }

    /// As [`Simulation::step`]. Before each factorisation, in a chart before each sub-step, `watch` receives
    /// the progress and may end the step. Results do not depend on it otherwise.
    ///
    /// ```
    /// # use isosheet_dynamics::{Method, SheetModel, Simulation, State, StepError};
    /// # use isosheet_mesh::{MassKind, VertexId, generate};
    /// # use std::ops::ControlFlow;
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let sheet = generate::isotropic_square(1, 0.21)?;
    /// # let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)?
    /// #     .with_gravity()
    /// #     .with_pins(&[VertexId(20)])?;
    /// # let start = State::at_rest(sheet.positions().to_vec());
    /// let mut simulation = Simulation::new(model, start, Method::default())?;
    /// let mut watch = |progress: &isosheet_dynamics::StepProgress| match progress.factorisations {
    ///     0 => ControlFlow::Continue(()),
    ///     _ => ControlFlow::Break(()),
    /// };
    /// let step = simulation.step_watched(1.0 / 60.0, &mut watch);
    /// assert_eq!(step, Err(StepError::Interrupted { t: 0.0 }));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Simulation::step`]; [`StepError::Interrupted`] if the watch ended the step.
    pub fn step_watched(
        &mut self,
        h: f64,
        watch: &mut dyn FnMut(&StepProgress) -> ControlFlow<()>,
    ) -> Result<StepReport, StepError> {
        self.advance(h, Some(watch))
    }

    /// Advances with the trace.
    fn advance(&mut self, h: f64, watch: Option<Watch<'_>>) -> Result<StepReport, StepError> {
        let mut trace = self.trace.take();
        let watch = watch.map(|watch| &mut *watch as _);
        let totals = StepTotals {
            effort: SolverEffort::new(watch, trace.as_deref_mut()),
            ..StepTotals::default()
        };
        let report = self.advance_traced(h, totals);
        self.trace = trace;
        report
    }

    fn advance_traced(
        &mut self,
        h: f64,
        mut totals: StepTotals<'_>,
    ) -> Result<StepReport, StepError> {
        let start = self.state().t;
        check_finite(self.state())?;
        if !(h.is_finite() && h > 0.0) || start + h <= start {
            return Err(StepError::StepSize { h, t: start });
        }
        self.check_forces()?;
        let end = start + h;
        let done = match &mut self.engine {
            Moved::ByMethod(engine) => engine.advance(h, &mut totals),
            Moved::ByEngine(engine) => engine.advance(end, &mut Progress(&mut totals)),
        };
        self.energy.work += totals.work;
        self.energy.dissipated += totals.dissipated;
        self.energy.friction += totals.friction;
        self.energy.plastic += totals.plastic;
        done?;
        self.check_energies()?;
        Ok(self.report(h, &totals))
    }

    /// Refuses energies that are not finite.
    fn check_energies(&self) -> Result<(), StepError> {
        let State { t, v, .. } = self.state();
        for (quantity, value) in [
            ("the potential energy", self.potential_energy()),
            ("the kinetic energy", self.model().kinetic_energy(v)),
            ("the work of the applied forces", self.energy.work),
        ] {
            if !value.is_finite() {
                return Err(StepError::NonFiniteEnergy {
                    quantity,
                    value,
                    t: *t,
                });
            }
        }
        Ok(())
    }

    /// The report of a step of `h` seconds.
    fn report(&self, h: f64, totals: &StepTotals<'_>) -> StepReport {
        let model = self.model();
        let State { t, x, v } = self.state();
        let (kinetic, potential) = (model.kinetic_energy(v), self.potential_energy());
        let EnergySums {
            start,
            work,
            dissipated,
            friction,
            plastic,
        } = self.energy;
        StepReport {
            t: *t,
            h,
            substeps: totals.substeps,
            rejected: totals.rejected,
            iterations: totals.effort.iterations,
            factorisations: totals.effort.factorisations,
            residual: totals.residual,
            error: totals.error,
            lowest_frequency: totals.lowest_frequency,
            kinetic,
            potential,
            work,
            dissipated,
            friction,
            plastic,
            energy_drift: kinetic + potential - work + dissipated + friction + plastic - start,
            strain: model.max_strain(x),
            constrained_strain: model.constrained_strain(x),
            taut: totals.taut.clone(),
            violation: model.largest_violation(*t, x),
            gap: self.contacts().map(ActiveContacts::gap),
            outcome: totals.outcome,
        }
    }

    /// Refuses potentials and forces that are not finite at the state.
    fn check_forces(&mut self) -> Result<(), StepError> {
        let mut sum = std::mem::take(&mut self.force);
        let State { t, x, v } = self.state();
        let model = self.model();
        model.acting_force(self.memories(), *t, x, &mut sum);
        model.add_applied_force(*t, x, v, &mut sum);
        let bad = sum.iter().position(|f| !f.is_finite());
        let result = match bad {
            None => Ok(()),
            Some(i) => Err(StepError::NonFiniteForce {
                vertex: VertexId((i / 3) as u32),
                value: sum[i],
                t: *t,
            }),
        };
        self.force = sum;
        result
    }
}

/// Time over which initial velocities of moving pins are differences, seconds.
pub(super) const MOTION_SPAN: f64 = 1e-2;

fn check_length(model: &SheetModel, state: &State) -> Result<(), SimulationError> {
    let expected = model.coordinate_count();
    if state.x.len() == expected && state.v.len() == expected {
        Ok(())
    } else {
        Err(SimulationError::StateLength {
            positions: state.x.len(),
            velocities: state.v.len(),
            expected,
        })
    }
}
