//! Contact of a sheet with bodies and with itself.

mod body;
mod body_pairs;
mod displacements;
mod evaluate;
mod features;
mod limit;
mod motion;
mod neighbours;
mod options;
mod rolling;
mod round;
mod sheet;
mod start;
#[cfg(test)]
mod tests;
mod thickness;

pub use options::{ContactOptions, ContactsError};
pub use round::RoundBody;
use round::Rounds;

use crate::Obstacle;
use body::ContactBody;
use evaluate::{Placed, SheetAt};
use isosheet_dynamics::contact::{
    ActiveContact, ActiveContacts, BodyMotion, BodyPlace, CarriedPoint, Contact, ContactError,
    ContactKey, ContactLaws, Friction, JointMotion, ObstaclePair, SheetPair, StepMotion, StepSpan,
    SurfacePoints,
};
use isosheet_dynamics::{SheetModel, State};
use isosheet_geometry::{CcdOptions, ContactMesh, RigidPath};
use isosheet_mesh::{Topology, VertexId};
use limit::Limit;
use motion::SheetMotion;
use nalgebra::Vector3;
use neighbours::{Neighbours, SelfPairs};
use options::smallest_heights;
use std::ops::Range;
use thickness::{Clearance, Thickness};

/// Length of the first part of a long motion that is searched for pairs, in mean edge lengths, and ratio of
/// the lengths of the following parts: contact mostly ends a long motion early, and the number of pairs whose
/// boxes overlap grows with its length until it is that of all pairs. (A motion of a disk of 688 vertices by
/// 46 000 edge lengths takes 1.1 s in one piece.) A long motion that meets nothing costs one search for each
/// factor of [`NEXT_PART`].
const FIRST_PART: f64 = 4.0;
const NEXT_PART: f64 = 4.0;

/// The geometry of contact of a sheet with bodies and with itself: pairs within reach, distances, and motions
/// that are checked before they are taken. Barrier and friction come from [`isosheet_dynamics::contact`],
/// which says in which order the values are made that a step works with.
///
/// ```
/// # use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
/// # use isosheet_dynamics::SheetModel;
/// # use isosheet_mesh::{MassKind, generate};
/// # use nalgebra::Isometry3;
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let sheet = generate::isotropic_square(2, 1.0)?;
/// let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)?.with_gravity();
/// let table = Shape::Cuboid { half: [0.25, 0.25, 0.05] };
/// let pose = Isometry3::translation(0.5, 0.5, -0.051);
/// let contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))?
///     .with_body(Obstacle::fixed(table, pose)?, Coefficients::equal(0.3))?
///     .with_self_contact(Coefficients::FRICTIONLESS)?;
/// # let _ = contacts;
/// # Ok(())
/// # }
/// ```
///
/// # What repels what
/// Every gap `g`, a distance less the thickness that counts there, has a potential below the activation
/// distance `d`: `-kappa (1 - z)^2 ln z` with `z = (g / d)^2` and the stiffness `kappa` ([`ContactOptions`]).
/// Gaps are:
///
/// * half-space: that of every vertex. A flat face is away if its corners are.
/// * box, ball, cylinder, capsule, and whatever else is [convex](crate::Shape::is_convex): the signed
///   distance of every vertex, and the distances of faces from the body's corners and of edges from its edges
///   ([`crate::Shape::contact_geometry`], without edges inside a flat facet); for a ball and a capsule these
///   are their centre and axis, and the radius is taken off. A cylinder meets edges and faces as a prism
///   inside it: they, unlike vertices, may come closer than the true cylinder by up to `radius (1 - cos(pi /
///   segments))`.
/// * triangle surface, open or closed, and the triangles of a form that is not convex: vertices and its
///   faces, faces and its vertices, edges and its edges. An open one has two sides.
/// * the sheet itself: vertices and faces, edges and edges without a common vertex.
///
/// Two edges have the factor of [`isosheet_dynamics::contact::ParallelEdges`], without which their energy has
/// a kink where they are parallel.
///
/// A gap next to an edge of the mesh belongs to several pairs at once, and counts for each: that
/// stiffens the barrier there by a small factor and keeps it smooth.
///
/// # Bodies
/// Within a step a body moves from its pose at the start to that at the end, the origin on a straight
/// line, turning about a fixed axis the shorter way round. A keyframe inside a step is passed by on
/// that way, so choose steps that end at keyframes where it matters, and shorter than half a turn.
///
/// # Cost
/// What a scene does not name costs nothing: half-spaces need the vertices only; friction without
/// coefficients is not evaluated. Pairs that may meet are searched for in a tree of boxes, which bodies and
/// self-contact share, when the sheet leaves the last motion that was searched by an eighth of an edge; in
/// between a motion is checked against the list of these.
///
/// Between calls only boxes and lists are kept, and memory. The tree of boxes has the shape of the sheet at
/// the first positions it was asked about, which decides about speed and about the order in which pairs are
/// found, not about which.
#[derive(Debug)]
pub struct Contacts {
    options: ContactOptions,
    laws: ContactLaws,
    ccd: CcdOptions,
    mesh: ContactMesh,
    /// The vertices that move in a prescribed way, and do not meet bodies.
    driven: Range<u32>,
    /// The points of the mesh, where these are not the vertices of the model.
    points: Option<SurfacePoints>,
    /// Squared rest lengths of the edges.
    lengths2: Vec<f64>,
    mean_length: f64,
    thickness: Thickness,
    /// The smallest height of each face of a sheet, metres; infinite of what does not touch itself.
    heights: Vec<f64>,
    bodies: Vec<ContactBody>,
    has_self_contact: bool,
    /// Round bodies in the place of polyhedra.
    rounds: Rounds,
    /// Made at the first positions, in scenes that need them.
    neighbours: Option<Neighbours>,
    /// Working memory: the motions of the bodies, displacements of a part of a long motion, and which
    /// candidates are near.
    parts: Vec<RigidPath>,
    part_of_motion: Vec<f64>,
    near: Vec<bool>,
}

impl Contacts {
    /// Contact of a sheet with nothing yet.
    ///
    /// # Errors
    /// [`ContactsError`] naming the option that makes no sense.
    pub fn new(model: &SheetModel, options: ContactOptions) -> Result<Self, ContactsError> {
        let (topology, lengths) = (model.topology(), model.edges().lengths());
        Self::between(topology, lengths, topology.vertex_count(), options)
    }

    /// Contact of a surface whose points are combinations of the vertices of a model, with nothing yet:
    /// sheets whose vertices these are, and surfaces of [rigid bodies](isosheet_dynamics::RigidBody). The
    /// `points` are the vertices of `surface`, in this order. What belongs to one body does not touch itself
    /// if it is [named](Contacts::with_parts).
    ///
    /// # Errors
    /// [`ContactsError`] naming the option that makes no sense.
    ///
    /// # Panics
    /// If the numbers of points and of vertices of the surface differ.
    pub fn on_surface(
        surface: &isosheet_mesh::Sheet,
        points: SurfacePoints,
        options: ContactOptions,
    ) -> Result<Self, ContactsError> {
        let count = surface.topology().vertex_count();
        assert_eq!(points.count(), count, "a point for each vertex");
        let contacts = Self::between(surface.topology(), surface.lengths(), points.own(), options)?;
        Ok(Self {
            points: Some(points),
            ..contacts
        })
    }

    fn between(
        topology: &Topology,
        lengths: &[f64],
        own: usize,
        options: ContactOptions,
    ) -> Result<Self, ContactsError> {
        options.validate()?;
        Ok(Self {
            options,
            laws: options.laws(),
            ccd: options.ccd(),
            mesh: ContactMesh::from_topology(topology),
            driven: 0..0,
            points: None,
            lengths2: lengths.iter().map(|l| l * l).collect(),
            thickness: Thickness::new(options.thickness, own),
            heights: smallest_heights(topology, lengths, own).collect(),
            bodies: Vec::new(),
            has_self_contact: false,
            rounds: Rounds::default(),
            mean_length: lengths.iter().sum::<f64>() / lengths.len() as f64,
            neighbours: None,
            parts: Vec::new(),
            part_of_motion: Vec::new(),
            near: Vec::new(),
        })
    }

    /// Contact of a sheet with obstacles and with itself, with the default options and the same friction
    /// everywhere. For options or friction of each of them, see [`Contacts::new`], [`Contacts::with_body`]
    /// and [`Contacts::with_self_contact`].
    ///
    /// # Errors
    /// [`ContactsError`]: friction that makes no sense, or a sheet too small for a barrier.
    pub fn for_sheet(
        model: &SheetModel,
        obstacles: impl IntoIterator<Item = Obstacle>,
        friction: impl Into<Friction>,
    ) -> Result<Self, ContactsError> {
        let friction = friction.into();
        let itself = Self::new(model, ContactOptions::for_sheet(model))?
            .with_self_contact(friction.clone())?;
        let mut obstacles = obstacles.into_iter();
        obstacles.try_fold(itself, |contacts, obstacle| {
            contacts.with_body(obstacle, friction.clone())
        })
    }

    /// Adds contact with a body. Bodies are numbered from zero in the order in which they are added.
    ///
    /// # Errors
    /// [`ContactsError::Friction`]; [`ContactsError::Obstacle`] for a cylinder with too few
    /// [`ContactOptions::segments`].
    pub fn with_body(
        mut self,
        obstacle: Obstacle,
        friction: impl Into<Friction>,
    ) -> Result<Self, ContactsError> {
        let friction = friction.into();
        friction.validate()?;
        let number = u32::try_from(self.bodies.len()).expect("fewer than 2^32 bodies");
        let segments = self.options.segments;
        self.bodies.push(ContactBody::new(
            obstacle,
            number,
            segments,
            self.rounds.ends(),
        )?);
        self.laws.bodies.push(friction);
        self.neighbours = None;
        Ok(self)
    }

    /// Adds contact of the sheet with itself.
    ///
    /// # Errors
    /// [`ContactsError::Friction`]; [`ContactsError::Reach`] if the barrier would act between
    /// neighbours in a flat sheet.
    pub fn with_self_contact(
        mut self,
        friction: impl Into<Friction>,
    ) -> Result<Self, ContactsError> {
        let friction = friction.into();
        friction.validate()?;
        let faces = (0..).zip(self.mesh.faces().iter().zip(&self.heights));
        let of_faces = faces.map(|(face, (&[v, ..], &height))| {
            let thickness = self.thickness.between(v, v);
            let reach = Clearance::new(thickness, self.options.activation).reach;
            (face, height, reach)
        });
        let narrowest = of_faces.min_by(|a, b| (a.1 - a.2).total_cmp(&(b.1 - b.2)));
        if let Some((face, height, reach)) = narrowest
            && reach >= height
        {
            return Err(ContactsError::Reach {
                face,
                height,
                reach,
            });
        }
        self.has_self_contact = true;
        self.laws.itself = friction;
        self.neighbours = None;
        Ok(self)
    }

    /// Tells of pairs of vertices that are glued to each other ([`isosheet_dynamics::Glue`]): what has them
    /// in common does not repel each other, as neighbours in a mesh do not.
    ///
    /// # Panics
    /// If a vertex does not exist.
    #[must_use]
    pub fn with_glue(mut self, pairs: &[[VertexId; 2]]) -> Self {
        let pairs: Vec<[u32; 2]> = pairs.iter().map(|pair| pair.map(|v| v.0)).collect();
        self.mesh = self.mesh.with_glue(&pairs);
        self.neighbours = None;
        self
    }

    /// Tells of parts of the surface, by ranges of their points, that do not touch themselves, such as rigid
    /// bodies; and of points outside of a part that are attached to it, each with the number of the part:
    /// what has them as corners does not touch the part. Comes before [`Contacts::with_self_contact`].
    ///
    /// # Panics
    /// If a point does not exist.
    #[must_use]
    pub fn with_parts(
        mut self,
        parts: &[Range<usize>],
        attached: impl IntoIterator<Item = (VertexId, usize)>,
    ) -> Self {
        for (&[v, ..], height) in self.mesh.faces().iter().zip(&mut self.heights) {
            if parts.iter().any(|part| part.contains(&(v as usize))) {
                // Its neighbours do not repel it.
                *height = f64::INFINITY;
            }
        }
        let attached = attached.into_iter().map(|(v, part)| (v.0, part as u32));
        self.mesh = self.mesh.with_parts(parts, attached);
        self.neighbours = None;
        self
    }

    /// Tells of the points from this one on that they move in a prescribed way, as bodies do: they belong to
    /// one [part](Contacts::with_parts), and meet no body.
    #[must_use]
    pub fn with_driven_from(mut self, first: VertexId) -> Self {
        let count = self.mesh.vertex_count();
        self.driven = first.0..u32::try_from(count).expect("vertices are numbered with 32 bits");
        self
    }

    /// Puts a round body in the place of a polyhedron: the points of a range, with all that they are corners
    /// of, take part in contact no more, and the round body does, by its true surface. It belongs to the
    /// [part](Contacts::with_parts) of this number. `carried` says how the model carries a point of it, as
    /// [`RigidBody::carried`](isosheet_dynamics::RigidBody::carried) does.
    ///
    /// Its points come after all others. Whatever is said of the range that it replaces afterwards, such as
    /// friction, is said of it. Comes after [`Contacts::with_parts`] and [`Contacts::with_driven_from`].
    ///
    /// # Errors
    /// [`ContactsError::Radius`], and [`ContactsError::Points`] if the points cannot be carried.
    ///
    /// # Panics
    /// If contact is not [on a surface](Contacts::on_surface).
    pub fn with_round_body(
        mut self,
        part: usize,
        replaced: Range<usize>,
        body: RoundBody,
        carried: impl Fn([f64; 3]) -> CarriedPoint,
    ) -> Result<Self, ContactsError> {
        body.validate()?;
        let places = body.points();
        let points = self.points.take().expect("contact on a surface");
        let first = points.count();
        self.points = Some(points.with_carried(places.iter().map(|p| carried(*p)))?);
        let (vertices, edges) = body.primitives();
        let place = |v: u32| Vector3::from(places[v as usize]);
        let squares = edges
            .iter()
            .map(|&[a, b]| (place(b) - place(a)).norm_squared());
        self.lengths2.extend(squares);
        self.rounds.add(&body, replaced.clone(), first);
        self.mesh = self
            .mesh
            .with_round(replaced, part, vertices, edges, body.radius);
        let flat = self.mesh.edges().iter().zip(&self.lengths2);
        let flat =
            flat.filter(|([v, _], _)| !self.mesh.is_round(*v) && !self.rounds.replace(*v as usize));
        let lengths: Vec<f64> = flat.map(|(_, squared)| squared.sqrt()).collect();
        if !lengths.is_empty() {
            self.mean_length = lengths.iter().sum::<f64>() / lengths.len() as f64;
        }
        for (number, other) in (0..).zip(&mut self.bodies) {
            let obstacle = other.obstacle().clone();
            *other = ContactBody::new(obstacle, number, self.options.segments, self.rounds.ends())?;
        }
        self.neighbours = None;
        Ok(self)
    }

    /// Gives one of several sheets, whose vertices these are, its own thickness in place of that of the
    /// options, metres. Two sheets of thickness `a` and `b` keep the distance `(a + b) / 2` of their middle
    /// surfaces, and each keeps its own thickness from bodies, as from itself. Comes before
    /// [`Contacts::with_self_contact`].
    ///
    /// # Errors
    /// [`ContactsError`] if it makes no sense.
    ///
    /// # Panics
    /// If there is no such vertex of a sheet.
    pub fn with_thickness_of(
        mut self,
        vertices: Range<usize>,
        thickness: f64,
    ) -> Result<Self, ContactsError> {
        let options = ContactOptions {
            thickness,
            ..self.options
        };
        options.validate()?;
        self.thickness.set(vertices, thickness);
        self.neighbours = None;
        Ok(self)
    }

    /// Sets the friction between two of several sheets, whose vertices these are, or of one of them with
    /// itself, in place of that of [`Contacts::with_self_contact`].
    ///
    /// # Errors
    /// [`ContactsError::Friction`].
    pub fn with_friction_between(
        mut self,
        vertices: [Range<usize>; 2],
        friction: impl Into<Friction>,
    ) -> Result<Self, ContactsError> {
        let friction = friction.into();
        friction.validate()?;
        let [first, second] = vertices
            .each_ref()
            .map(|range| self.rounds.with_those_in(range));
        for a in &first {
            self.laws.pairs.extend(second.iter().map(|b| SheetPair {
                vertices: [a.clone(), b.clone()],
                friction: friction.clone(),
            }));
        }
        Ok(self)
    }

    /// Lets two of several sheets, whose vertices these are, or one of them and itself, pass through each
    /// other.
    #[must_use]
    pub fn without_contact_between(mut self, vertices: [Range<usize>; 2]) -> Self {
        let [first, second] = vertices
            .each_ref()
            .map(|range| self.rounds.with_those_in(range));
        for a in &first {
            for b in &second {
                self.mesh = self.mesh.with_passing([a.clone(), b.clone()]);
            }
        }
        self.neighbours = None;
        self
    }

    /// Sets the friction of one of several sheets, whose vertices these are, with a body, in place of that of
    /// [`Contacts::with_body`].
    ///
    /// # Errors
    /// [`ContactsError::Friction`].
    pub fn with_friction_on(
        mut self,
        obstacle: u32,
        vertices: Range<usize>,
        friction: impl Into<Friction>,
    ) -> Result<Self, ContactsError> {
        let friction = friction.into();
        friction.validate()?;
        let ranges = self.rounds.with_those_in(&vertices).into_iter();
        self.laws
            .obstacle_pairs
            .extend(ranges.map(|vertices| ObstaclePair {
                obstacle,
                vertices,
                friction: friction.clone(),
            }));
        Ok(self)
    }

    /// The options.
    pub fn options(&self) -> &ContactOptions {
        &self.options
    }

    /// The bodies, in the order in which they were added.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = &Obstacle> {
        self.bodies.iter().map(ContactBody::obstacle)
    }

    /// Largest distance below which the barrier acts between any two parts, metres.
    fn reach(&self) -> f64 {
        Clearance::new(self.thickness.largest(), self.options.activation).reach
    }

    /// Whether pairs are searched for in a tree of boxes.
    fn needs_boxes(&self) -> bool {
        self.has_self_contact || self.bodies.iter().any(|b| b.features().is_some())
    }

    /// [`Contact::query`] in one piece.
    fn query_whole(&mut self, motion: JointMotion<'_>, pairs: &mut Vec<ContactKey>) -> f64 {
        let JointMotion {
            progress, x, dx, ..
        } = motion;
        let sheet = SheetMotion {
            mesh: &self.mesh,
            driven: &self.driven,
            x,
            dx,
            thickness: &self.thickness,
            activation: self.options.activation,
            reach: self.reach(),
            ccd: &self.ccd,
        };
        self.parts.clear();
        let motions = motion.bodies.list().iter();
        self.parts
            .extend(motions.map(|m| path(&m.surface, progress)));
        if self.needs_boxes() {
            let own = if self.has_self_contact {
                SelfPairs::Listed
            } else {
                SelfPairs::Ignored
            };
            let (length, bodies) = (self.mean_length, self.bodies.len());
            self.neighbours
                .get_or_insert_with(|| Neighbours::new(sheet, length, bodies, own))
                .update(sheet, &mut self.bodies, &self.parts);
        }
        let neighbours = self.neighbours.as_ref();
        let (limit, near) = (Limit::new(1.0), &mut self.near);
        for (body, part) in self.bodies.iter().zip(&self.parts) {
            body.query(sheet, neighbours, part, &limit, near, pairs);
        }
        if let Some(neighbours) = neighbours.filter(|_| self.has_self_contact) {
            sheet::query(sheet, neighbours, &limit, near, pairs);
        }
        limit.part()
    }
}

/// The way of a body from one progress of its motion over a step to another.
fn path(motion: &StepMotion, [from, to]: [f64; 2]) -> RigidPath {
    let part = to - from;
    RigidPath::new(
        &motion.pose(from),
        part * motion.shift(),
        part * motion.turn(),
    )
}

impl Contact for Contacts {
    fn laws(&self) -> &ContactLaws {
        &self.laws
    }

    fn points(&self) -> Option<&SurfacePoints> {
        self.points.as_ref()
    }

    fn body_motions(&self, span: StepSpan, out: &mut Vec<BodyMotion>) {
        out.extend(self.bodies.iter().map(|b| b.motion_over(span)));
    }

    fn query(&mut self, motion: JointMotion<'_>, pairs: &mut Vec<ContactKey>) -> f64 {
        let longest = motion.dx.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
        if !(self.needs_boxes() && longest.is_finite()) {
            return self.query_whole(motion, pairs);
        }
        let mut part = FIRST_PART * self.mean_length / longest;
        let mut dx = std::mem::take(&mut self.part_of_motion);
        let before = pairs.len();
        let safe = loop {
            if part >= 1.0 {
                break self.query_whole(motion, pairs);
            }
            dx.clear();
            dx.extend(motion.dx.iter().map(|d| part * d));
            let [from, to] = motion.progress;
            let shorter = JointMotion {
                progress: [from, from + part * (to - from)],
                dx: &dx,
                ..motion
            };
            let safe = self.query_whole(shorter, pairs);
            if safe < 1.0 {
                break part * safe;
            }
            pairs.truncate(before);
            part *= NEXT_PART;
        };
        self.part_of_motion = dx;
        safe
    }

    fn evaluate(
        &self,
        pairs: &[ContactKey],
        x: &[f64],
        bodies: &[BodyPlace],
        out: &mut Vec<ActiveContact>,
    ) {
        let sheet = SheetAt {
            mesh: &self.mesh,
            rounds: &self.rounds,
            x,
            lengths2: &self.lengths2,
            thickness: &self.thickness,
            activation: self.options.activation,
        };
        out.extend(pairs.iter().filter_map(|&key| match key.body {
            None => sheet.with_itself(key),
            Some(b) => {
                let (body, place) = (&self.bodies[b as usize], &bodies[b as usize]);
                sheet.with_body(key, Placed { body, place })
            }
        }));
    }

    fn check_start(&mut self, model: &SheetModel, state: &State) -> Result<(), ContactError> {
        let expected = match &self.points {
            None => self.mesh.vertex_count(),
            Some(points) => points.model_vertices(),
        };
        let found = model.topology().vertex_count();
        if found != expected || state.x.len() != 3 * expected {
            return Err(ContactError::Sheet { expected, found });
        }
        let mut surface = Vec::new();
        let x = match &self.points {
            None => &state.x,
            Some(points) => {
                points.place(&state.x, &mut surface);
                &surface
            }
        };
        let t = state.t;
        let active = ActiveContacts::at_rest(self, t, x);
        start::check_gaps(active.list(), t)?;
        let reach = self.reach();
        let Some(neighbours) = &mut self.neighbours else {
            return Ok(());
        };
        let boxes = neighbours.at_rest(x, reach);
        let (mesh, driven) = (&self.mesh, &self.driven);
        let meets_bodies = |v: u32| !driven.contains(&v) && mesh.takes_part(v);
        let places = active.bodies().iter();
        for (number, (body, place)) in self.bodies.iter().zip(places).enumerate() {
            start::check_body(
                number,
                Placed { body, place },
                self.options.segments,
                boxes,
                x,
                meets_bodies,
            )
            .map_err(|(pair, gap)| ContactError::Touching { pair, gap, t })?;
        }
        if self.has_self_contact {
            start::check_itself(boxes, x).map_err(|pair| ContactError::Touching {
                pair,
                gap: 0.0,
                t,
            })?;
        }
        Ok(())
    }
}

const _: fn() = || {
    fn is_send_and_sync<T: Send + Sync>() {}
    is_send_and_sync::<Contacts>();
};
