//! Errors of the engine as problems of the scene.

use crate::placing::driven_surface::{DrivenSurface, rigid_obstacle};
use crate::words::key::{Key, KeyPart};
use crate::words::problem::Problem;
use isosheet_dynamics::contact::{BodyMotionError, ContactError, ContactPair};
use isosheet_dynamics::{
    CheckpointError, Driver, LimitError, Reason, SheetModel, Simulation, SimulationError,
    StepError, Support,
};
use isosheet_mesh::wording::brief;
use isosheet_mesh::{Part, VertexId};
use nalgebra::Vector3;
use std::collections::HashMap;
use std::ops::Range;

/// Which entry of the scene made what in the engine.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Origins {
    /// The support that pins a vertex.
    pub(crate) pins: HashMap<VertexId, usize>,
    /// The support of each vertex constraint.
    pub(crate) constraints: Vec<usize>,
    /// The support of each clamp along a line of vertices.
    pub(crate) clamps: Vec<usize>,
    /// The body that a vertex carries, if it has a guide.
    pub(crate) guides: HashMap<VertexId, usize>,
    /// The points of the surface of each body that responds.
    pub(crate) bodies: Vec<Range<usize>>,
    /// The obstacles that deform.
    pub(crate) driven: Vec<DrivenSurface>,
    /// What each obstacle of the scene is called.
    pub(crate) obstacles: Vec<String>,
}

impl Origins {
    /// Where the surfaces of obstacles that deform are among the sheets and the surfaces of bodies.
    pub fn driven_parts(&self) -> impl ExactSizeIterator<Item = &Part> {
        self.driven.iter().map(|surface| &surface.part)
    }

    /// Whether a vertex of the model belongs to an obstacle that deforms.
    pub fn is_driven(&self, vertex: VertexId) -> bool {
        let mut driven = self.driven.iter();
        driven.any(|surface| surface.vertices.contains(&vertex.index()))
    }

    /// What one of the obstacles that do not deform is called.
    pub fn obstacle_called(&self, rigid: usize) -> String {
        let number = self.obstacle_number(rigid);
        let called = self.obstacles.get(number).cloned();
        called.unwrap_or_else(|| self.obstacle_key(rigid).to_string())
    }

    /// An obstacle in a message at its place, which has its number.
    fn the_obstacle(&self, rigid: usize) -> String {
        let called = self.obstacle_called(rigid);
        match called == self.obstacle_key(rigid).to_string() {
            true => "the obstacle".to_owned(),
            false => format!("the obstacle `{called}`"),
        }
    }

    /// What moves by the motion at a key is called.
    pub(crate) fn called(&self, motion: &Key) -> String {
        let named = match motion.parts() {
            [KeyPart::Name(list), KeyPart::Entry(number), ..] if list == "obstacle" => {
                self.obstacles.get(*number)
            }
            _ => None,
        };
        format!("`{}`", named.cloned().unwrap_or_else(|| motion.to_string()))
    }

    /// A step that failed, in words with the names of obstacles.
    pub(crate) fn in_words(&self, error: &StepError) -> String {
        let named = |body: usize| format!("`{}`", self.obstacle_called(body));
        let text = error.to_string();
        match error {
            StepError::StepTooSmall {
                pressing, cause, ..
            } => {
                let text = text.replace(&cause.to_string(), &self.in_words(cause));
                match pressing {
                    Some(pressing) => text.replace(&pressing.to_string(), &pressing.named(named)),
                    None => text,
                }
            }
            StepError::Unsatisfiable { infeasibility, .. } => {
                text.replace(&infeasibility.to_string(), &infeasibility.named(named))
            }
            _ => text,
        }
    }

    /// The number in the scene of one of the obstacles that do not deform.
    pub fn obstacle_number(&self, rigid: usize) -> usize {
        rigid_obstacle(&self.driven, rigid)
    }
}

/// Two supports that come closer to each other.
struct Meeting {
    supports: [usize; 2],
    /// Metres.
    distance: f64,
    /// By how much the distance shrinks, m/s.
    rate: f64,
}

impl Origins {
    /// The number of the support in the scene, if the scene named it. (Vertices that the engine pins by
    /// itself, because rods hold them in place, belong to none.)
    pub fn support(&self, support: Support) -> Option<usize> {
        match support {
            Support::Pin(vertex) => self.pins.get(&vertex).copied(),
            Support::Constraint { index, .. } => self.constraints.get(index).copied(),
        }
    }

    /// The number of the support in the scene that holds a vertex.
    pub(crate) fn support_of_vertex(&self, model: &SheetModel, vertex: VertexId) -> Option<usize> {
        let constrained = || {
            let index = model
                .constraints()
                .iter()
                .position(|c| c.vertex() == vertex)?;
            self.constraints.get(index).copied()
        };
        self.pins.get(&vertex).copied().or_else(constrained)
    }

    /// The vertices of the first `count` supports, in the order of their numbers.
    pub(crate) fn vertices(&self, model: &SheetModel, count: usize) -> Vec<Vec<VertexId>> {
        let mut vertices = vec![Vec::new(); count];
        let constrained = model.constraints().iter().zip(&self.constraints);
        let constrained = constrained.map(|(constraint, k)| (constraint.vertex(), *k));
        for (v, k) in self.pins.iter().map(|(v, k)| (*v, *k)).chain(constrained) {
            if let Some(list) = vertices.get_mut(k) {
                list.push(v);
            }
        }
        vertices.iter_mut().for_each(|list| list.sort_unstable());
        vertices
    }

    /// One of the obstacles that do not deform.
    fn obstacle_key(&self, body: usize) -> Key {
        Key::root()
            .name("obstacle")
            .entry(self.obstacle_number(body))
    }

    /// What holds a vertex: `hold` of a support, the guide of a body, or the mesh in motion of an obstacle.
    fn support_key(&self, support: Support) -> Key {
        if let Some(body) = self.guides.get(&support.vertex()) {
            return Key::root().name("body").entry(*body).name("guide");
        }
        let vertex = support.vertex().index();
        let mut driven = self.driven.iter();
        if let Some(surface) = driven.find(|surface| surface.vertices.contains(&vertex)) {
            return Key::root()
                .name("obstacle")
                .entry(surface.number)
                .name("shape.sequence");
        }
        let number = self.support(support);
        let list = Key::root().name("support");
        number.map_or(list.clone(), |k| list.entry(k)).name("hold")
    }

    /// A step of a simulation that failed. Supports that leave the sheet no room are named.
    pub fn of_failed_step(&self, error: &StepError, simulation: &Simulation) -> Problem {
        let meeting = is_without_room(error).then(|| self.meeting_supports(simulation));
        let Some(Meeting {
            supports,
            distance,
            rate,
        }) = meeting.flatten()
        else {
            let problem = self.of_step(error);
            let has_rods = simulation.model().has_rods_in_sheets();
            return match reason_of(error) {
                Some(Reason::DependentRods | Reason::NoDescent) if !has_rods => {
                    Problem::new(problem.key, problem.message, OF_ELASTIC)
                }
                _ => problem,
            };
        };
        let list = Key::root().name("support");
        let [first, second] = supports.map(|k| list.entry(k));
        let message = format!(
            "`{first}` and `{second}` are driven into each other: they are {} m apart, less than an edge of the sheet \
             is long, and come closer by {} m/s; {}",
            brief(distance),
            brief(rate),
            self.in_words(error)
        );
        let remedy = "shorten their motions, so that the sheet has room between them";
        Problem::new(second.name("hold"), message, remedy)
    }

    /// Two supports whose pins come closer to each other and are less than the mean length of an edge apart:
    /// rods make no narrower fold. Of several such pairs the one that is closest.
    fn meeting_supports(&self, simulation: &Simulation) -> Option<Meeting> {
        let state = simulation.state();
        let [x, v] = [&state.x, &state.v].map(|a| a.as_chunks::<3>().0);
        let vector = |of: &[[f64; 3]], [a, b]: [VertexId; 2]| {
            Vector3::from(of[b.index()]) - Vector3::from(of[a.index()])
        };
        let edges = simulation.model().topology().edges();
        let mean = edges.iter().map(|&e| vector(x, e).norm()).sum::<f64>() / edges.len() as f64;
        let mut pins: Vec<_> = self.pins.iter().collect();
        pins.sort();
        let mut closest: Option<Meeting> = None;
        for (k, &(&a, &first)) in pins.iter().enumerate() {
            for &(&b, &second) in &pins[k + 1..] {
                let apart = vector(x, [a, b]);
                let distance = apart.norm();
                let limit = closest.as_ref().map_or(mean, |c| c.distance);
                let rate = -vector(v, [a, b]).dot(&apart) / distance;
                if first != second && distance < limit && rate > 0.0 {
                    closest = Some(Meeting {
                        supports: [first.min(second), first.max(second)],
                        distance,
                        rate,
                    });
                }
            }
        }
        closest
    }

    /// A step that failed, at the place of the scene that is to blame as far as that is known.
    pub fn of_step(&self, error: &StepError) -> Problem {
        let root = Key::root();
        let (key, remedy) = match error {
            StepError::StepTooSmall {
                pressing: Some(pressing),
                cause,
                ..
            } => (
                self.obstacle_key(pressing.body).name("motion"),
                remedy_of_press(cause),
            ),
            StepError::StepTooSmall { cause, .. } => {
                let message = self.in_words(error);
                return Problem {
                    message,
                    ..self.of_step(cause)
                };
            }
            StepError::NoEquilibrium { why, .. } => (root.name("method.integrator"), why.advice()),
            StepError::NotConverged { reason, .. } => remedy_of(*reason),
            StepError::Friction { .. } => (
                root.name("contact"),
                "friction jams the sheet: lower `friction`, or give the sheet more damping or a finer mesh",
            ),
            StepError::EnergyGain { .. } => (
                root.name("method.step"),
                "take a smaller step or more `sheet.damping`; rods in compression snap less where the sheet has its \
                 own stiffness, `sheet.material`",
            ),
            StepError::Locked { .. } => (
                root.name("sheet.isometry"),
                "name what the sheet is made of, `sheet.material`, which makes it elastic; or make a mesh with a line of \
                 edges along each clamp, or allow more `method.max_factorisations`",
            ),
            StepError::OffSupport { support, .. } => (
                self.support_key(*support),
                "a motion has to be zero at the start, and a curve or surface has to go through the vertex",
            ),
            StepError::NonFiniteMotion { support, .. } => (
                self.support_key(*support),
                "check the profiles of the motion",
            ),
            StepError::Unsatisfiable { infeasibility, .. } => {
                let key = match infeasibility.by {
                    Driver::Support(support) => self.support_key(support),
                    Driver::Body(body) => self.obstacle_key(body).name("motion"),
                };
                let remedy = match infeasibility.strain_limit {
                    Some(_) => {
                        "shorten the motion, raise the limit, `sheet.isometry.elastic.limit`, or end there with \
                         `method.taut = \"stop\"`"
                    }
                    None => "shorten the motion, or end there with `method.taut = \"stop\"`",
                };
                (key, remedy)
            }
            StepError::Body(error) => return self.of_body_motion(error),
            StepError::OffConstraints { .. } => (
                root.name("sheet.start"),
                "the positions at the start need the rest lengths of `sheet.mesh`",
            ),
            StepError::BeyondStrainLimit { .. } => (
                root.name("sheet.start"),
                "start from a shape whose lengths are nearer to those of `sheet.mesh`, choose a smaller \
                 `sheet.start.perturbation`, let `sheet.swell` begin near zero, or raise the limit, `isometry = { elastic = { limit = ... } }`",
            ),
            StepError::AtStrainLimit { .. } => (
                root.name("sheet"),
                "pull less, hold more than a vertex where the sheet is pulled, or raise the limit, `isometry = { elastic = { \
                 limit = ... } }`",
            ),
            StepError::Limit(LimitError::SwellingBeyondLimit { .. }) => (
                root.name("sheet.swell"),
                "let it change more slowly, or less where the sheet is held, or raise the limit, `isometry = { elastic = { \
                 limit = ... } }`",
            ),
            StepError::Limit(LimitError::Swelling { .. }) => (
                root.name("sheet.swell"),
                "end the run before that, or give a function of time from -0.2 to 0.2",
            ),
            StepError::RankDeficient { .. } => (
                root.name("method.integrator"),
                "use `bdf2`, set `sheet.start.perturbation`, or `method.fallback = \"implicit_euler\"`",
            ),
            StepError::Projection { .. } => (
                root.name("sheet.start.perturbation"),
                "choose a smaller perturbation",
            ),
            StepError::NonFiniteForce { .. } | StepError::NonFiniteEnergy { .. } => (
                root.name("forces"),
                "check the sizes of forces and stiffnesses",
            ),
            StepError::StepSize { .. } | StepError::Time { .. } => {
                return Problem::from_error(root.name("method"), error);
            }
            _ => (
                root.name("method"),
                "take a smaller `method.step` or more damping",
            ),
        };
        Problem::new(key, self.in_words(error), remedy)
    }

    /// A change that a simulation cannot go on with: what it keeps is not that of the changed scene.
    pub(crate) fn of_change(&self, error: &SimulationError) -> Problem {
        let SimulationError::Checkpoint(error) = error else {
            return self.of_start(error);
        };
        let root = Key::root();
        let (key, message) = match error {
            CheckpointError::Contact { expected: false } => (
                root.name("contact"),
                "contact does not begin during a simulation".to_owned(),
            ),
            CheckpointError::Contact { expected: true } => (
                root.name("contact"),
                "contact does not end during a simulation".to_owned(),
            ),
            CheckpointError::OtherSheet { what } => (
                root,
                format!("the {what} of the sheet do not change during a simulation"),
            ),
            _ => {
                let message = "the change gives the simulation other supports, creases or sheets than it began with";
                (root, message.to_owned())
            }
        };
        Problem::new(
            key,
            message,
            "begin a new simulation with the changed scene",
        )
    }

    /// A simulation that cannot start, at the place of the scene that is to blame as far as that is known.
    pub fn of_start(&self, error: &SimulationError) -> Problem {
        let root = Key::root();
        match error {
            SimulationError::Start(error) => self.of_step(error),
            SimulationError::Contact(error) => self.of_contact(error),
            SimulationError::OneSided { index } => {
                let number = self.constraints.get(*index).copied().unwrap_or(0);
                let key = root.name("support").entry(number).name("hold.surface.side");
                Problem::from_error(key, error)
            }
            SimulationError::Elastic => Problem::from_error(root.name("sheet.isometry"), error),
            SimulationError::Plastic | SimulationError::NeedsMinimising => {
                Problem::from_error(root.name("method"), error)
            }
            SimulationError::Options(_) => Problem::from_error(root.name("method"), error),
            SimulationError::Engine(_) => Problem::from_error(root.name("method.chart"), error),
            _ => Problem::from_error(root, error),
        }
    }

    /// The body, or the obstacle that deforms, whose surface has a point.
    fn solid_of(&self, point: u32) -> Option<Key> {
        let (root, point) = (Key::root(), point as usize);
        let of_bodies = self.bodies.iter().enumerate();
        let of_bodies = of_bodies.map(|(k, surface)| (surface, root.name("body").entry(k)));
        let of_obstacles = self.driven.iter();
        let of_obstacles =
            of_obstacles.map(|o| (&o.part.vertices, root.name("obstacle").entry(o.number)));
        let mut surfaces = of_bodies.chain(of_obstacles);
        let found = surfaces.find(|(surface, _)| surface.contains(&point));
        found.map(|(_, key)| key)
    }

    /// A point of what touches, in words.
    fn point_in_words(&self, point: u32) -> String {
        match self.solid_of(point) {
            None => format!("the sheet at vertex {point}"),
            Some(key) => format!("`{key}`"),
        }
    }

    fn of_body_motion(&self, error: &BodyMotionError) -> Problem {
        let named = format!("`{}`", self.obstacle_called(error.body));
        let problem = Problem::from_error(self.obstacle_key(error.body).name("motion"), error);
        Problem {
            message: problem
                .message
                .replace(&format!("body {}", error.body), &named),
            ..problem
        }
    }

    fn of_contact(&self, error: &ContactError) -> Problem {
        let root = Key::root();
        match error {
            ContactError::Motion(error) => self.of_body_motion(error),
            ContactError::Touching {
                pair: ContactPair::Body { vertex, body },
                gap,
                ..
            } => Problem::new(
                self.obstacle_key(*body),
                format!(
                    "{} touches {} at the start (gap {} m, thickness of the \
                     sheet taken off)",
                    self.the_obstacle(*body),
                    self.point_in_words(*vertex),
                    brief(*gap)
                ),
                "move the obstacle or the sheet (`sheet.placement`): contact keeps a gap, it does not make one",
            ),
            ContactError::Touching {
                pair: ContactPair::Sheet { first, second },
                gap,
                ..
            } if self.solid_of(*first).or(self.solid_of(*second)).is_some() => {
                let (solid, other) = match self.solid_of(*first) {
                    Some(solid) => (solid, second),
                    None => (self.solid_of(*second).unwrap_or(root), first),
                };
                let what = match solid.parts().first() {
                    Some(KeyPart::Name(name)) if name == "obstacle" => "obstacle",
                    _ => "body",
                };
                Problem::new(
                    solid.name("pose"),
                    format!(
                        "the {what} touches {} at the start (gap {} m, thickness of the sheet taken off)",
                        self.point_in_words(*other),
                        brief(*gap)
                    ),
                    "move one of them: contact keeps a gap, it does not make one",
                )
            }
            ContactError::Touching {
                pair: ContactPair::Sheet { first, second },
                gap,
                ..
            } => Problem::new(
                root.name("contact.self_contact"),
                format!(
                    "the sheet touches itself at the vertices {first} and {second} at the start (gap {} m, \
                     thickness taken off)",
                    brief(*gap)
                ),
                "open the sheet there, give it less `sheet.thickness`, or leave out self-contact",
            ),
            ContactError::Method => Problem::from_error(root.name("method.integrator"), error),
            // The barrier, or another sheet.
            _ => Problem::from_error(root.name("contact"), error),
        }
    }
}

/// Whether no step was found that leaves the sheet room.
pub(crate) fn is_without_room(error: &StepError) -> bool {
    matches!(
        error,
        StepError::StepTooSmall { .. } | StepError::Contact { .. } | StepError::NotConverged { .. }
    )
}

/// Where a body presses the sheet and no step is found.
fn remedy_of_press(cause: &StepError) -> &'static str {
    match cause {
        StepError::Friction { .. } => {
            "end the motion before the sheet jams, lower the friction of obstacles and sheet, or choose a finer mesh, \
             which gives way where it bends"
        }
        _ => {
            "end the motion before that, give the sheet room to give way, or a finer mesh; with less friction it slides \
             earlier"
        }
    }
}

/// Why the iteration of a step failed, if that is what failed.
fn reason_of(error: &StepError) -> Option<Reason> {
    match error {
        StepError::StepTooSmall { cause, .. } => reason_of(cause),
        StepError::NotConverged { reason, .. } => Some(*reason),
        _ => None,
    }
}

/// What helps where the iteration fails without rods.
const OF_ELASTIC: &str = "forces or stiffnesses there differ by too many orders of magnitude: take a smaller \
                          `method.step`, and look for a load, a mass or a stiffness that is not of the size meant";

/// The key that is to blame for a failed iteration, and what to do.
fn remedy_of(reason: Reason) -> (Key, &'static str) {
    let root = Key::root();
    match reason {
        Reason::DependentRods | Reason::NoDescent => (
            root.name("sheet"),
            "rods lock or depend on each other there: name what the sheet is made of, `sheet.material`, which makes it \
             elastic; or start off the flat state, `sheet.start.perturbation`; a smaller step seldom helps",
        ),
        Reason::Blocked => (
            root.name("contact"),
            "contact or the limit of the strain is in the way: give the sheet room, shorten what drives it, or raise \
             `sheet.isometry.elastic.limit`",
        ),
        Reason::LinearAlgebra => (
            root.name("sheet"),
            "sizes differ too much for the arithmetic: check masses, stiffnesses and lengths for their units",
        ),
        // Iterations, a minimum above the start, an attempt that was ended.
        _ => (
            root.name("method"),
            "take a smaller `method.step` or more `sheet.damping`; where the sheet starts exactly flat, \
             `sheet.start.perturbation` says to which side it goes",
        ),
    }
}
