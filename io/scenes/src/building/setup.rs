//! Everything that a simulation is made of.

use crate::bodies::carried::{CarriedBody, Wrench};
use crate::holding::bond::Bond;
use crate::measures::targets::Targets;
use crate::methods::integration::Integration;
use crate::time::led::LedMotion;
use crate::whole::switches::{Switches, other_switches};
use crate::words::error::{SceneError, SceneText};
use crate::words::key::Key;
use crate::words::problem::Problem;
use crate::words::warning::Warning;
use crate::{Gauge, Origins};
use isosheet_collide::{Contacts, Obstacle};
use isosheet_coords::ChartError;
use isosheet_dynamics::contact::{Contact, SurfacePoints};
use isosheet_dynamics::{Checkpoint, SheetModel, Simulation, SimulationError, State};
use isosheet_mesh::generate::FoldAssignment;
use isosheet_mesh::{EdgeId, Part, Sheet, VertexId};
use nalgebra::Vector3;
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::ops::{Deref, Range};
use std::sync::Arc;

/// What is known of a scene besides its simulation.
#[derive(Clone, Debug)]
pub struct Facts {
    /// The sheet in its rest shape, placed in space; the union of several, and of the surfaces of bodies.
    pub sheet: Sheet,
    /// The vertices of `sheet` by the vertices of the model, where they differ.
    pub(crate) points: Option<SurfacePoints>,
    /// Of several sheets and bodies the name of each, and where it is in the union.
    pub parts: Vec<(String, Part)>,
    /// Mass of all that moves, kilograms.
    pub mass: f64,
    /// The positions of its vertices at the start.
    pub start: Vec<f64>,
    /// The bodies that respond, in the order of the scene.
    pub bodies: Vec<CarriedBody>,
    /// The obstacles that do not deform, in the order of the scene.
    pub obstacles: Vec<Obstacle>,
    /// What is modelled, in words.
    pub modelled: Vec<String>,
    /// The angles that creases are driven to.
    pub targets: Targets,
    /// What is read off at each step.
    pub measures: Vec<Gauge>,
    /// The places in the scene of what the engine names.
    pub origins: Origins,
    /// The seams of the scene that hold, in its order.
    pub(crate) bonds: Vec<Option<Bond>>,
    /// The motions that a program leads.
    pub(crate) led: Vec<LedMotion>,
    /// Vertices of sheets that are pinned, at rest or in motion.
    pub pins: Vec<VertexId>,
    /// The edges of the sheets that have creases.
    pub creased: Vec<EdgeId>,
    /// What each edge of the sheet, or of all sheets one after the other, is meant to do, if there is a
    /// crease pattern among the meshes; `None` for an edge of which the pattern does not say it.
    pub fold_assignments: Option<Vec<Option<FoldAssignment>>>,
}

impl Facts {
    /// Positions or velocities of what is seen, from the vertices of the model (`3V`).
    pub fn shown<'a>(&self, x: &'a [f64]) -> Cow<'a, [f64]> {
        SurfacePoints::placed(self.points.as_ref(), x)
    }

    /// Values of what is seen from values of the model, so many for each: the values of the sheets, and zero
    /// for bodies and obstacles.
    fn of_sheets(
        &self,
        mut values: Vec<f64>,
        each: usize,
        range: fn(&Part) -> &Range<usize>,
    ) -> Vec<f64> {
        let of_bodies = self.bodies.iter().map(|body| &body.part);
        let of_obstacles = self.origins.driven.iter().map(|surface| &surface.part);
        let mut parts = of_bodies.chain(of_obstacles);
        if let Some(first) = parts.next().filter(|_| !values.is_empty()) {
            let last = parts.last().unwrap_or(first);
            values.truncate(each * range(first).start);
            values.resize(each * range(last).end, 0.0);
        }
        values
    }

    /// The faces of each sheet of this name, or of each one, among the faces of the model.
    pub fn faces_of_sheets(&self, name: Option<&str>) -> Vec<Range<usize>> {
        if self.parts.is_empty() {
            let whole = 0..self.sheet.topology().face_count();
            return [whole].into();
        }
        let others = self.bodies.len() + self.origins.driven.len();
        let sheets = self.parts[..self.parts.len() - others].iter();
        let named = sheets.filter(|(own, _)| name.is_none_or(|name| name == own));
        named.map(|(_, part)| part.faces.clone()).collect()
    }

    /// Values of the edges of what is seen, from the model.
    pub fn of_edges(&self, values: Vec<f64>) -> Vec<f64> {
        self.of_sheets(values, 1, |part| &part.edges)
    }

    /// Pairs of values of the faces of what is seen, from the model.
    pub fn of_faces(&self, pairs: Vec<f64>) -> Vec<f64> {
        self.of_sheets(pairs, 2, |part| &part.faces)
    }

    /// So many values of the vertices of what is seen, from the model.
    pub(crate) fn of_vertices(&self, values: Vec<f64>, each: usize) -> Vec<f64> {
        self.of_sheets(values, each, |part| &part.vertices)
    }
}

impl Facts {
    /// Where sheets fold: the mountains and valleys of patterns, and creases whose angles change.
    pub fn creases(&self) -> Vec<EdgeId> {
        let folds = |a: &Option<FoldAssignment>| {
            matches!(a, Some(FoldAssignment::Mountain | FoldAssignment::Valley))
        };
        let of_pattern = self.fold_assignments.iter().flatten().enumerate();
        let of_pattern = of_pattern.filter(|(_, a)| folds(a));
        let of_pattern = of_pattern.map(|(e, _)| EdgeId::from_index(e));
        let driven = self.targets.creases.iter().flat_map(|crease| &crease.edges);
        let driven = driven.map(|(e, _)| *e);
        let folded = self
            .targets
            .folding
            .iter()
            .flat_map(|targets| &targets.creases);
        let all = of_pattern.chain(driven).chain(folded.map(|(e, _)| *e));
        all.collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// What the sheet does to the obstacles at the end of the last step, in the order of the scene: torques
    /// on rigid obstacles are about the origins of their frames, and torques on obstacles that deform about
    /// the origin of space.
    pub fn obstacle_loads(&self, simulation: &Simulation) -> Vec<Wrench> {
        let driven = &self.origins.driven[..];
        let rigid = simulation.body_loads().into_iter().enumerate();
        let rigid = rigid.map(|(k, load)| {
            let load = Wrench {
                force: load.force.into(),
                torque: load.torque.into(),
            };
            (self.origins.obstacle_number(k), load)
        });
        let forces = match driven {
            [] => None,
            _ => simulation.contact_forces(),
        };
        let x = &simulation.state().x;
        let of_driven = driven.iter().map(|surface| {
            let load = forces.as_ref().map(|forces| {
                let vertices = surface.vertices.clone().map(VertexId::from_index);
                Wrench::of_vertices(vertices, forces, x, Vector3::zeros())
            });
            (surface.number, load.unwrap_or_default())
        });
        let mut all: Vec<_> = rigid.chain(of_driven).collect();
        all.sort_by_key(|(number, _)| *number);
        all.into_iter().map(|(_, load)| load).collect()
    }
}

/// Everything that a simulation is made of: what is known of its scene, and what begins to move.
#[derive(Debug)]
pub struct Setup {
    /// What is known of the scene, which stays known while the simulation goes on. A setup has its fields.
    pub facts: Arc<Facts>,
    /// The state at the start.
    pub start: State,
    /// What moves.
    pub model: SheetModel,
    /// What it meets, in scenes with contact.
    pub contacts: Option<Contacts>,
    /// How the motion is computed.
    pub integration: Integration,
    /// What the sheet is made of, in words, if the scene names it.
    pub material: Option<String>,
    /// What to know of the sheets before the scene is run.
    pub(crate) of_sheets: Vec<Warning>,
    /// What holds.
    pub(crate) switches: Switches,
    /// The text of the scene, if it is a file.
    pub(crate) text: Option<SceneText>,
}

impl Deref for Setup {
    type Target = Facts;

    fn deref(&self) -> &Facts {
        &self.facts
    }
}

impl Setup {
    /// The sheets without the bodies beside them, in their rest shape, placed in space.
    pub fn sheets_alone(&self) -> Cow<'_, Sheet> {
        let Some(points) = &self.points else {
            return Cow::Borrowed(&self.sheet);
        };
        let own = points.own();
        let faces = self.sheet.topology().faces().iter();
        let is_own = |face: &&[VertexId; 3]| face.iter().all(|v| v.index() < own);
        let faces: Vec<[u32; 3]> = faces.filter(is_own).map(|f| f.map(|v| v.0)).collect();
        let sheets = Sheet::new(self.sheet.positions()[..3 * own].to_vec(), &faces);
        sheets.map_or(Cow::Borrowed(&self.sheet), Cow::Owned)
    }

    /// Whether the simulation gives the forces of the rods ([`Simulation::rod_forces`]).
    pub fn has_rod_forces(&self) -> bool {
        matches!(self.integration, Integration::Free { .. }) && self.model.has_rods_in_sheets()
    }

    /// Whether the fold angles of some creases include a bend of the sheet
    /// ([`SheetModel::bends_at_creases`]).
    pub fn has_creases_in_sheets(&self) -> bool {
        let (t, x) = (self.start.t, &self.start.x);
        let memories = self.model.memories();
        self.model.bends_at_creases(t, x, &memories).is_some()
    }

    /// Whether what holds at a checkpoint is what holds here.
    pub fn is_at(&self, checkpoint: &Checkpoint) -> bool {
        checkpoint.note() == self.switches.note()
    }

    /// The simulation at the start.
    ///
    /// # Errors
    /// [`SceneError`] at the place of the scene that is to blame.
    pub fn start(self) -> Result<Simulation, SceneError> {
        let Self {
            facts,
            model,
            start,
            contacts,
            integration,
            switches,
            text,
            ..
        } = self;
        let place = |e: SimulationError| placed(facts.origins.of_start(&e), text.as_ref());
        let simulation = match integration {
            Integration::Free { method, control } => {
                Simulation::new(model, start, method).and_then(|s| s.with_control(control))
            }
            Integration::InChart(settings) => {
                let chart = settings.build(&facts.sheet, &model.pins(), &start.x);
                let chart = chart.map_err(|e| no_chart(&e, text.as_ref()))?;
                isosheet_charts::in_chart(model, start, chart, settings.options())
            }
        };
        let simulation = simulation.map_err(place)?;
        let mut simulation = match contacts {
            Some(contacts) => simulation.with_contact(contacts).map_err(place)?,
            None => simulation,
        };
        simulation.set_note(switches.note());
        Ok(simulation)
    }

    /// The simulation at a checkpoint, for which the scene was built ([`SceneFile::build_at`]) where it takes
    /// up or releases something.
    ///
    /// [`SceneFile::build_at`]: crate::SceneFile::build_at
    ///
    /// # Errors
    /// [`SceneError`] if the checkpoint belongs to another scene, or to another one of its phases.
    pub fn resume(self, checkpoint: Checkpoint) -> Result<Simulation, SceneError> {
        self.resume_or(checkpoint, Origins::of_start)
    }

    /// The simulation at a checkpoint of one of another scene that has been changed to this one.
    ///
    /// # Errors
    /// [`SceneError`] if the change is none that a simulation can go on with.
    pub(crate) fn resume_changed(self, checkpoint: Checkpoint) -> Result<Simulation, SceneError> {
        self.resume_or(checkpoint, Origins::of_change)
    }

    fn resume_or(
        self,
        checkpoint: Checkpoint,
        problem: fn(&Origins, &SimulationError) -> Problem,
    ) -> Result<Simulation, SceneError> {
        if !self.is_at(&checkpoint) {
            return Err(placed(other_switches(), self.text.as_ref()));
        }
        let contact = self.contacts.map(|c| Box::new(c) as Box<dyn Contact>);
        let resumed = match self.integration {
            Integration::Free { .. } => Simulation::resume(self.model, contact, checkpoint),
            Integration::InChart(settings) => {
                let chart = settings.build(&self.facts.sheet, &self.model.pins(), &self.start.x);
                let chart = chart.map_err(|e| no_chart(&e, self.text.as_ref()))?;
                isosheet_charts::resume_in_chart(self.model, chart, checkpoint)
            }
        };
        resumed.map_err(|e| placed(problem(&self.facts.origins, &e), self.text.as_ref()))
    }
}

fn no_chart(error: &ChartError, text: Option<&SceneText>) -> SceneError {
    let key = Key::root().name("method.chart.coordinates");
    let problem = Problem::from_error(key, error);
    placed(problem, text)
}

fn placed(problem: Problem, text: Option<&SceneText>) -> SceneError {
    let error = SceneError::from(problem);
    match text {
        Some(text) => error.in_text(text),
        None => error,
    }
}
