//! Contact of a sheet with bodies and with itself, for the implicit steps.

mod body;
mod friction;
mod law;
mod options;
mod path;
mod sheet;
mod start;
#[cfg(test)]
mod tests;
mod touch;

pub use options::{Coefficients, ContactOptions, ContactsError, Stiffness};

use crate::{Barrier, BroadPhase, CcdOptions, ContactMesh, Friction, Obstacle};
use body::{Body, SheetMotion};
use friction::Rubbing;
use isosheet_dynamics::contact::{
    BodyLoad, Contact, ContactError, ContactPoint, ContactWork, CouplingSink,
};
use isosheet_dynamics::{PAPER_GRAVITY, SheetModel, State};
use law::GapPotential;
use nalgebra::Vector3;
use options::smallest_height;
use sheet::SelfContact;
use std::cell::{Ref, RefCell};
use touch::Touch;

/// Contact of a sheet with bodies and with itself: barriers, lagged friction, and motions that are
/// checked before they are taken.
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
///     .with_body(Obstacle::still(table, pose)?, Coefficients::equal(0.3))?
///     .with_self_contact(Coefficients::FRICTIONLESS)?;
/// # let _ = contacts;
/// # Ok(())
/// # }
/// ```
///
/// # In a chart
/// The explicit methods in a chart, the paper's among them, take the geometry and answer with impulses in place of the barrier
/// ([`isosheet_dynamics::chart::ChartSimulation::with_contact`]):
///
/// ```
/// # use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
/// # use isosheet_coords::{CartesianChart, Choice, RodSystem};
/// # use isosheet_dynamics::chart::ChartOptions;
/// # use isosheet_dynamics::{SheetModel, Simulation, State};
/// # use isosheet_mesh::{MassKind, generate};
/// # use nalgebra::Isometry3;
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let sheet = generate::strip(2, 0.4, 0.2, generate::Diagonals::UnionJack)?;
/// let model = SheetModel::new(&sheet, 0.01, MassKind::Lumped)?.with_gravity();
/// let floor = Obstacle::still(Shape::HalfSpace, Isometry3::translation(0.0, 0.0, -0.01))?;
/// let contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))?
///     .with_body(floor, Coefficients::equal(0.3))?;
/// let chart = CartesianChart::new(RodSystem::new(&sheet, &[])?, Choice::Auto, sheet.positions())?;
/// let options = ChartOptions { restitution: 0.5, ..ChartOptions::default() };
/// let start = State::at_rest(sheet.positions().to_vec());
/// let mut simulation =
///     Simulation::in_chart(model, start, Box::new(chart), options)?.with_contact(contacts)?;
/// let report = simulation.step(0.1)?;
/// assert!(report.gap.is_some_and(|gap| gap > 0.0) && report.friction > 0.0);
/// # Ok(())
/// # }
/// ```
///
/// # What repels what
/// Every gap `g` below the activation distance has a potential `phi(g) = kappa b(g^2)`, see
/// [`Barrier`] (Li et al. 2020, Incremental potential contact), where the gap is a distance less the
/// thickness of the sheet:
///
/// * half-space: that of every vertex. A flat face is away if its corners are.
/// * box, ball, cylinder, capsule: the signed distance of every vertex, and the distances of faces
///   from the body's corners and of edges from its edges ([`crate::Shape::contact_geometry`], without edges
///   inside a flat facet); for a ball and a capsule these are their centre and axis, and the radius is
///   taken off. A cylinder meets edges and faces as a prism inside it: they, unlike vertices, may come
///   closer than the true cylinder by up to `radius (1 - cos(pi / segments))`.
/// * triangle surface, open or closed: vertices and its faces, faces and its vertices, edges and its
///   edges. An open one has two sides.
/// * the sheet itself: vertices and faces, edges and edges without a common vertex.
///
/// Two edges have the factor of [`crate::ParallelMollifier`], without which their energy has a kink where
/// they are parallel.
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
/// What a scene does not name costs nothing: half-spaces need the vertices only, other bodies one refit
/// of the sheet's boxes per checked motion, which they share with self-contact; friction without
/// coefficients is not evaluated.
#[derive(Debug)]
pub struct Contacts {
    options: ContactOptions,
    ccd: CcdOptions,
    mesh: ContactMesh,
    /// Squared rest lengths of the edges.
    lengths2: Vec<f64>,
    /// The face with the smallest height, and that height.
    lowest: (u32, f64),
    mean_mass: f64,
    law: GapPotential,
    /// Boxes of the sheet; made at the first positions.
    boxes: Option<BroadPhase>,
    bodies: Vec<Body>,
    itself: Option<SelfContact>,
    step: Step,
    rubbing: Vec<Rubbing>,
    rubbing_before: Vec<Rubbing>,
    /// Power of the barriers on the sheet at the start of the step times its duration, joules.
    start_work: f64,
    still: Vec<f64>,
    end: Vec<f64>,
    touched: RefCell<Touched>,
}

/// The present step.
#[derive(Debug, Default)]
struct Step {
    t0: f64,
    h: f64,
    s: f64,
    x0: Vec<f64>,
    /// Friction with each body, then of the sheet with itself.
    friction: Vec<Option<Friction>>,
}

/// The contacts at the positions that were asked for last: energy, gradient and Hessian are mostly
/// wanted at the same place.
#[derive(Debug, Default)]
struct Touched {
    x: Vec<f64>,
    valid: bool,
    /// Whether a coordinate is not finite.
    broken: bool,
    list: Vec<Touch>,
}

impl Contacts {
    /// Contact of a sheet with nothing yet.
    ///
    /// # Errors
    /// [`ContactsError`] naming the option that makes no sense.
    pub fn new(model: &SheetModel, options: ContactOptions) -> Result<Self, ContactsError> {
        options.validate()?;
        let n = model.coordinate_count();
        let gravity = Vector3::from(PAPER_GRAVITY).norm();
        let mut contacts = Self {
            options,
            ccd: options.ccd(),
            mesh: ContactMesh::from_topology(model.topology()),
            lengths2: model.rods().lengths().iter().map(|l| l * l).collect(),
            lowest: smallest_height(model),
            mean_mass: model.mean_mass(),
            law: GapPotential::new(Barrier::new(options.activation, 0.0)?, 1.0),
            boxes: None,
            bodies: Vec::new(),
            itself: None,
            step: Step {
                s: 1.0,
                x0: vec![0.0; n],
                ..Step::default()
            },
            rubbing: Vec::new(),
            rubbing_before: Vec::new(),
            start_work: 0.0,
            still: vec![0.0; n],
            end: vec![0.0; n],
            touched: RefCell::default(),
        };
        contacts.set_stiffness(gravity);
        Ok(contacts)
    }

    /// Adds contact with a body. Bodies are numbered from zero in the order in which they are added.
    ///
    /// # Errors
    /// [`ContactsError::Friction`]; [`ContactsError::Obstacle`] for a cylinder with too few
    /// [`ContactOptions::segments`].
    pub fn with_body(
        mut self,
        obstacle: Obstacle,
        coefficients: Coefficients,
    ) -> Result<Self, ContactsError> {
        coefficients.validate()?;
        let number = u32::try_from(self.bodies.len()).expect("fewer than 2^32 bodies");
        let segments = self.options.segments;
        self.bodies
            .push(Body::new(obstacle, number, coefficients, segments)?);
        Ok(self)
    }

    /// Adds contact of the sheet with itself.
    ///
    /// # Errors
    /// [`ContactsError::Friction`]; [`ContactsError::Reach`] if the barrier would act between
    /// neighbours in a flat sheet.
    pub fn with_self_contact(mut self, coefficients: Coefficients) -> Result<Self, ContactsError> {
        coefficients.validate()?;
        let (face, height) = self.lowest;
        let reach = self.options.reach();
        if reach >= height {
            return Err(ContactsError::Reach {
                face,
                height,
                reach,
            });
        }
        self.itself = Some(SelfContact::new(coefficients));
        Ok(self)
    }

    /// The options.
    pub fn options(&self) -> &ContactOptions {
        &self.options
    }

    /// The bodies, in the order in which they were added.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = &Obstacle> {
        self.bodies.iter().map(Body::obstacle)
    }

    fn set_stiffness(&mut self, acceleration: f64) {
        let barrier = Barrier::new(self.options.activation, 0.0);
        let barrier = barrier.expect("the options were validated");
        self.law = match self.options.stiffness {
            Stiffness::Automatic => GapPotential::for_weight(barrier, self.mean_mass, acceleration),
            Stiffness::Joules(kappa) => GapPotential::new(barrier, kappa),
        };
        self.forget();
    }

    fn forget(&mut self) {
        self.touched.get_mut().valid = false;
    }

    fn sheet<'a>(&'a self, x: &'a [f64]) -> SheetMotion<'a> {
        SheetMotion {
            mesh: &self.mesh,
            x,
            dx: &self.still,
            reach: self.options.reach(),
            ccd: &self.ccd,
            lengths2: &self.lengths2,
        }
    }

    /// Bodies to their places at time `t0`, about to move to those at `t0 + h`.
    fn place_bodies(&mut self, t0: f64, h: f64) {
        for body in &mut self.bodies {
            body.begin(t0, t0 + h);
        }
        let moving = self.bodies.iter().any(|b| b.moves());
        self.step.t0 = t0;
        self.step.h = h;
        self.set_progress(if moving { 0.0 } else { 1.0 });
    }

    fn set_progress(&mut self, s: f64) {
        self.step.s = s;
        for body in &mut self.bodies {
            body.place(s);
        }
        self.forget();
    }

    /// Pairs within reach on the way from `x` to `x + dx` and the part of it that is safe.
    fn search(&mut self, x: &[f64], dx: &[f64], bodies: Bodies) -> f64 {
        self.forget();
        let reach = self.options.reach();
        let needs_boxes = self.itself.is_some() || self.bodies.iter().any(Body::has_features);
        if needs_boxes {
            for i in 0..x.len() {
                self.end[i] = x[i] + dx[i];
            }
            let boxes = self
                .boxes
                .get_or_insert_with(|| BroadPhase::new(self.mesh.clone(), x));
            boxes.update(x, &self.end, 0.5 * reach);
        }
        let sheet = SheetMotion {
            mesh: &self.mesh,
            x,
            dx,
            reach,
            ccd: &self.ccd,
            lengths2: &self.lengths2,
        };
        let mut limit = 1.0;
        for body in &mut self.bodies {
            let rest = body.rest(self.step.s);
            let rest = match bodies {
                Bodies::Held => rest.frozen(),
                Bodies::Moving => rest,
            };
            limit = body.search(sheet, self.boxes.as_ref(), &rest, limit);
        }
        if let (Some(itself), Some(boxes)) = (&mut self.itself, &mut self.boxes) {
            limit = itself.search(sheet, boxes, limit);
        }
        limit
    }

    /// The contacts within reach at `x`.
    fn touches(&self, x: &[f64]) -> Ref<'_, Touched> {
        {
            let mut touched = self.touched.borrow_mut();
            if !touched.valid || touched.x != x {
                touched.x.clear();
                touched.x.extend_from_slice(x);
                touched.valid = true;
                touched.broken = !x.iter().all(|c| c.is_finite());
                touched.list.clear();
                for body in &self.bodies {
                    body.touches(self.sheet(x), &mut touched.list);
                }
                if let Some(itself) = &self.itself {
                    itself.touches(self.sheet(x), &mut touched.list);
                }
            }
        }
        self.touched.borrow()
    }

    /// Friction at `x` with the bodies where they are, sorted by key.
    fn lag(&self, x: &[f64], out: &mut Vec<Rubbing>) {
        out.clear();
        if self.step.friction.iter().all(Option::is_none) {
            return;
        }
        for touch in &self.touches(x).list {
            let owner = touch.key.body.map_or(self.bodies.len(), |b| b as usize);
            if let Some(law) = self.step.friction[owner] {
                let rubbing = Rubbing::new(touch, &self.law, law, &self.bodies);
                if rubbing.contact.force > 0.0 {
                    out.push(rubbing);
                }
            }
        }
        out.sort_unstable_by_key(|r| r.key);
    }

    /// Power of the barrier forces on the sheet at `x` times the duration of the step, joules.
    fn barrier_work(&self, x: &[f64]) -> f64 {
        let touched = self.touches(x);
        let body_touches = touched.list.iter().filter_map(|touch| {
            let body = &self.bodies[touch.key.body? as usize];
            let velocity = body.step_velocity(&touch.foot);
            let pushed = touch.force(&self.law) * touch.normal.dot(&velocity);
            Some(pushed - touch.couple(&self.law).dot(&body.step_turn()))
        });
        body_touches.sum()
    }

    fn bodies_move(&self) -> bool {
        self.bodies.iter().any(|b| b.moves())
    }
}

/// Whether bodies move on while the sheet does.
#[derive(Debug, Clone, Copy)]
enum Bodies {
    Held,
    Moving,
}

impl Contact for Contacts {
    fn begin(&mut self, t0: f64, h: f64, x0: &[f64]) {
        self.place_bodies(t0, h);
        self.step.x0.copy_from_slice(x0);
        let smoothing = self.options.rest_speed * h;
        let law = |c: &Coefficients| {
            if c.is_frictionless() {
                None
            } else {
                Friction::new(c.rest, c.sliding, smoothing).ok()
            }
        };
        self.step.friction.clear();
        let laws = self.bodies.iter().map(|b| law(&b.coefficients));
        self.step.friction.extend(laws);
        let own = self.itself.as_ref().and_then(|s| law(&s.coefficients));
        self.step.friction.push(own);
        let still = std::mem::take(&mut self.still);
        self.search(x0, &still, Bodies::Held);
        self.still = still;
        let mut rubbing = std::mem::take(&mut self.rubbing);
        self.lag(x0, &mut rubbing);
        self.rubbing = rubbing;
        self.start_work = if self.bodies_move() {
            self.barrier_work(x0)
        } else {
            0.0
        };
    }

    fn progress(&self) -> f64 {
        self.step.s
    }

    fn safe_fraction(&mut self, x: &[f64], dx: &[f64]) -> f64 {
        let finite = x.iter().chain(dx).all(|c| c.is_finite());
        let limit = self.search(x, dx, Bodies::Moving);
        if finite { limit } else { 0.0 }
    }

    fn advance(&mut self, fraction: f64) {
        let s = self.step.s;
        self.set_progress(if fraction >= 1.0 || s >= 1.0 {
            1.0
        } else {
            s + fraction * (1.0 - s)
        });
    }

    fn energy(&self, x: &[f64]) -> f64 {
        let barrier = self.potential(x);
        let loss = self.rubbing.iter();
        barrier
            + loss
                .map(|r| r.energy(&self.step.x0, x, &self.bodies))
                .sum::<f64>()
    }

    fn add_gradient(&self, x: &[f64], scale: f64, out: &mut [f64]) {
        for touch in &self.touches(x).list {
            touch.gradient(&self.law, |v, g| add(out, v, scale * g));
        }
        for r in &self.rubbing {
            let force = scale * r.force(&self.step.x0, x, &self.bodies);
            for (v, w) in r.vertices.into_iter().zip(r.contact.weights) {
                add(out, v, w * force);
            }
        }
    }

    fn add_drive(&self, x: &[f64], scale: f64, out: &mut [f64]) {
        if self.step.s >= 1.0 {
            return;
        }
        for touch in &self.touches(x).list {
            let Some(b) = touch.key.body else { continue };
            let body = &self.bodies[b as usize];
            let to_come = (1.0 - self.step.s) * body.step_velocity(&touch.foot);
            touch.shift(&self.law, &to_come, |v, g| add(out, v, scale * g));
        }
    }

    fn add_hessian(&self, x: &[f64], sink: &mut dyn CouplingSink) {
        for touch in &self.touches(x).list {
            touch.hessian(&self.law, sink);
        }
        for r in &self.rubbing {
            r.hessian(&self.step.x0, x, &self.bodies, sink);
        }
    }

    fn couplings(&self, x: &[f64], out: &mut Vec<[u32; 2]>) {
        out.clear();
        let touched = self.touches(x);
        let now = touched.list.iter().map(|t| (t.key, t.vertices));
        let lagged = self.rubbing.iter().map(|r| (r.key, r.vertices));
        for (_, v) in now.chain(lagged).filter(|(key, _)| key.body.is_none()) {
            for i in 0..4 {
                for j in i + 1..4 {
                    out.push([v[i].min(v[j]), v[i].max(v[j])]);
                }
            }
        }
    }

    fn relag(&mut self, x: &[f64]) -> f64 {
        std::mem::swap(&mut self.rubbing, &mut self.rubbing_before);
        let mut rubbing = std::mem::take(&mut self.rubbing);
        self.lag(x, &mut rubbing);
        self.rubbing = rubbing;
        friction::change(&self.rubbing_before, &self.rubbing)
    }

    fn finish(&mut self, x1: &[f64]) -> ContactWork {
        let mut work = ContactWork::default();
        let moving = self.bodies_move();
        if moving {
            work.bodies = 0.5 * (self.start_work + self.barrier_work(x1));
        }
        for r in &self.rubbing {
            work.friction += r.loss(&self.step.x0, x1, &self.bodies);
            if let Some(b) = r.key.body.filter(|_| moving) {
                let displacement = self.bodies[b as usize].displacement(&r.point);
                let force = r.force(&self.step.x0, x1, &self.bodies);
                // The sheet pulls the body by this force; the body works against it.
                work.bodies -= force.dot(&displacement);
            }
        }
        work
    }

    fn potential(&self, x: &[f64]) -> f64 {
        let touched = self.touches(x);
        if touched.broken {
            return f64::INFINITY;
        }
        touched.list.iter().map(|t| t.energy(&self.law)).sum()
    }

    fn gap(&self, x: &[f64]) -> f64 {
        let touched = self.touches(x);
        if touched.broken {
            return f64::NAN;
        }
        let gaps = touched.list.iter().map(|t| t.gap);
        // A gap that is not a number must not pass for a wide one.
        gaps.fold(f64::INFINITY, |a, b| {
            if a.is_nan() || b.is_nan() {
                f64::NAN
            } else {
                a.min(b)
            }
        })
    }

    fn loads(&self, x: &[f64]) -> Vec<BodyLoad> {
        let none = BodyLoad {
            force: Vector3::zeros(),
            torque: Vector3::zeros(),
        };
        let mut loads = vec![none; self.bodies.len()];
        let mut push = |b: u32, force: Vector3<f64>, place: Vector3<f64>| {
            let load = &mut loads[b as usize];
            load.force += force;
            load.torque += (place - self.bodies[b as usize].origin()).cross(&force);
        };
        for touch in &self.touches(x).list {
            if let Some(b) = touch.key.body {
                push(b, -touch.force(&self.law) * touch.normal, touch.foot);
            }
        }
        for r in &self.rubbing {
            if let Some(b) = r.key.body {
                let place = self.bodies[b as usize].material_place(&r.point);
                push(b, r.force(&self.step.x0, x, &self.bodies), place);
            }
        }
        for touch in &self.touches(x).list {
            if let Some(b) = touch.key.body {
                loads[b as usize].torque += touch.couple(&self.law);
            }
        }
        loads
    }

    fn activation(&self) -> f64 {
        self.options.activation
    }

    fn contact_points(&self, x: &[f64], out: &mut Vec<ContactPoint>) {
        out.clear();
        let t = self.step.t0 + self.step.s * self.step.h;
        for touch in &self.touches(x).list {
            let (body_velocity, friction) = match touch.key.body {
                Some(b) => {
                    let body = &self.bodies[b as usize];
                    let velocity = body.obstacle().velocity(t, &touch.foot);
                    (velocity, body.coefficients.sliding)
                }
                None => {
                    let own = self.itself.as_ref();
                    (
                        Vector3::zeros(),
                        own.map_or(0.0, |s| s.coefficients.sliding),
                    )
                }
            };
            out.push(ContactPoint {
                stencil: std::array::from_fn(|i| (touch.vertices[i], touch.weights[i])),
                normal: touch.normal,
                gap: touch.gap,
                body_velocity,
                friction,
            });
        }
    }

    fn check_start(&mut self, model: &SheetModel, state: &State) -> Result<(), ContactError> {
        let expected = self.mesh.vertex_count();
        let found = model.topology().vertex_count();
        if found != expected || state.x.len() != 3 * expected {
            return Err(ContactError::Sheet { expected, found });
        }
        let (t, x) = (state.t, &state.x);
        let mut force = vec![0.0; x.len()];
        model.potential_force(t, x, &mut force);
        let per_mass = force.as_chunks::<3>().0.iter().zip(&model.mass().vertex);
        let acceleration = per_mass
            .map(|(f, m)| Vector3::from(*f).norm() / m)
            .fold(0.0, f64::max);
        if acceleration > 0.0 && acceleration.is_finite() {
            self.set_stiffness(acceleration);
        }
        self.place_bodies(t, 0.0);
        self.step.x0.copy_from_slice(x);
        self.step.friction.clear();
        self.rubbing.clear();
        self.start_work = 0.0;
        let still = std::mem::take(&mut self.still);
        self.search(x, &still, Bodies::Held);
        self.still = still;
        start::check_gaps(&self.touches(x).list, t)?;
        let Some(boxes) = &mut self.boxes else {
            return Ok(());
        };
        for (number, body) in self.bodies.iter().enumerate() {
            start::check_body(body, number, boxes, x, self.options.segments, t)?;
        }
        if self.itself.is_some() {
            start::check_itself(boxes, x, t)?;
        }
        Ok(())
    }
}

fn add(out: &mut [f64], v: u32, g: Vector3<f64>) {
    let i = 3 * v as usize;
    for k in 0..3 {
        out[i + k] += g[k];
    }
}

#[cfg(test)]
const _: fn() = || {
    fn is_send<T: Send>() {}
    is_send::<Contacts>();
};
