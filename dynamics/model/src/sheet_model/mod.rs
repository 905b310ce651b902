//! The mechanical system: rods, masses, pins, potentials and forces.

pub(crate) mod air;
pub(crate) mod breaks;
pub(crate) mod clamps;
mod damped_range;
mod damping;
mod driven;
pub(crate) mod edge_moment;
pub(crate) mod elastic_deformation;
mod error;
mod follower;
pub(crate) mod gas;
pub(crate) mod hand;
mod hands;
pub(crate) mod immobile;
pub(crate) mod load;
pub(crate) mod load_scale;
pub(crate) mod loaded_faces;
mod memory;
mod moving_pin;
pub(crate) mod of_material;
pub(crate) mod part;
mod pressure;
pub(crate) mod round_off;
mod supports;
pub(crate) mod turning_load;
mod volume;

use crate::constraint::VertexConstraint;
use crate::term::ImplicitForce;
use damped_range::Damping;
pub use error::ModelError;
use isosheet_materials::ElasticSheet;
use isosheet_materials::potential::{
    At, Force, Gravity, Memories, PAPER_GRAVITY, Potential, PotentialShape,
};
use isosheet_mesh::{EdgeId, LengthConstraints, MassKind, MassMatrix, Sheet, Topology, VertexId};
use moving_pin::MovingPin;

/// What keeps the lengths of a sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Isometry {
    /// Rigid rods along all edges: lengths are exact, and the sheet folds along the lines of its mesh alone.
    #[default]
    Rods,
    /// The elasticity of the material, an [`ElasticSheet`]: edges stretch up to a limit.
    Elastic,
}

/// Marks a vertex without unknowns in [`SheetModel::free_index`].
pub const PINNED: u32 = u32::MAX;

/// Part of a step over which rates of change are differences: what is not linear over it, and the round-off
/// of the energies over it, are as far below the error of the trapezoidal rule as 1e-4 and 1e-12.
const RATE_PART: f64 = 1.0 / 8192.0;

/// A sheet as a mechanical system: rigid rods between point masses (or with a consistent mass
/// matrix), some vertices pinned, acted on by potentials, forces and velocity damping.
///
/// Only what is added costs anything; a pinned vertex has no unknowns.
#[derive(Debug)]
pub struct SheetModel {
    topology: Topology,
    /// The elasticity in the plane of sheets that have it.
    elastic: Option<ElasticSheet>,
    /// All edges with their rest lengths.
    edges: LengthConstraints,
    /// The edges that have a length to keep, where that are not all.
    measured: Option<LengthConstraints>,
    /// The edges that are rods.
    rods: LengthConstraints,
    rod_edges: Vec<EdgeId>,
    mass: MassMatrix,
    potentials: Vec<Box<dyn Potential>>,
    /// The hands among the potentials, with their numbers.
    hands: Vec<(usize, hand::Hand)>,
    forces: Vec<Box<dyn Force>>,
    /// Forces that damped steps take as terms of their objective.
    implicit: Vec<Box<dyn ImplicitForce>>,
    damping: Vec<Damping>,
    /// When what is prescribed changes abruptly.
    pub breaks: breaks::Breaks,
    /// The vertices of sheets; those after them belong to rigid bodies and to surfaces in prescribed motion.
    sheet_vertices: usize,
    /// The first vertex of surfaces in prescribed motion.
    driven_from: usize,
    free_index: Vec<u32>,
    free_count: usize,
    moving_pins: Vec<MovingPin>,
    constraints: Vec<VertexConstraint>,
    mean_length: f64,
    mean_mass: f64,
    shortest_edges: Vec<f64>,
}

impl SheetModel {
    /// A free sheet of the given total mass (kilograms), spread evenly, without gravity.
    ///
    /// # Errors
    /// [`ModelError::Mesh`] if the mass is not positive and finite.
    pub fn new(sheet: &Sheet, total_mass: f64, kind: MassKind) -> Result<Self, ModelError> {
        let mass = MassMatrix::from_total(sheet, total_mass, kind)?;
        Self::with_mass(sheet, mass)
    }

    /// A free sheet with the given mass matrix, without gravity.
    ///
    /// # Errors
    /// [`ModelError::MassLength`]; [`ModelError::Mass`] if a vertex mass is not positive and finite.
    pub fn with_mass(sheet: &Sheet, mass: MassMatrix) -> Result<Self, ModelError> {
        let topology = sheet.topology().clone();
        let n = topology.vertex_count();
        let edge_count = topology.edge_count();
        if mass.vertex.len() != n || mass.edge.as_ref().is_some_and(|e| e.len() != edge_count) {
            return Err(ModelError::MassLength {
                masses: mass.vertex.len(),
                vertex_count: n,
            });
        }
        if let Some(i) = mass
            .vertex
            .iter()
            .position(|m| !(m.is_finite() && *m > 0.0))
        {
            return Err(ModelError::Mass {
                vertex: VertexId(i as u32),
                mass: mass.vertex[i],
            });
        }
        let edges = LengthConstraints::new(sheet);
        let mut shortest_edges = vec![f64::INFINITY; n];
        for (e, l) in edges.edges().iter().zip(edges.lengths()) {
            for &v in e {
                shortest_edges[v] = l.min(shortest_edges[v]);
            }
        }
        Ok(Self {
            elastic: None,
            rods: edges.clone(),
            rod_edges: topology.edge_ids().collect(),
            edges,
            measured: None,
            shortest_edges,
            mean_length: sheet.mean_length(),
            mean_mass: mass.total() / n as f64,
            mass,
            potentials: Vec::new(),
            hands: Vec::new(),
            forces: Vec::new(),
            implicit: Vec::new(),
            damping: Vec::new(),
            breaks: breaks::Breaks::default(),
            sheet_vertices: n,
            driven_from: n,
            free_index: (0..n as u32).collect(),
            free_count: n,
            moving_pins: Vec::new(),
            constraints: Vec::new(),
            topology,
        })
    }

    /// Adds uniform gravity of 9.8 m/s2 along -z, the [`PAPER_GRAVITY`].
    #[must_use]
    pub fn with_gravity(self) -> Self {
        self.with_acceleration(PAPER_GRAVITY)
    }

    /// Adds uniform gravity of the given acceleration, m/s2.
    #[must_use]
    pub fn with_acceleration(self, acceleration: [f64; 3]) -> Self {
        let weights = self.mass.row_sums(&self.topology);
        self.with_potential(Gravity::new(weights, acceleration))
    }

    /// Adds a potential.
    #[must_use]
    pub fn with_potential(mut self, potential: impl Potential + 'static) -> Self {
        self.potentials.push(Box::new(potential));
        self
    }

    /// Replaces the rigid rods by the elasticity of the material with a limit of its strain, see
    /// [`ElasticSheet`]; for the [union](ElasticSheet::union) of some of several sheets, the rods of these
    /// sheets.
    ///
    /// For BDF2 and implicit Euler; other methods and charts are refused. [`SheetModel::of_material`] does
    /// this and all else that a material needs; by hand:
    ///
    /// ```
    /// use isosheet_materials::{ElasticSheet, PlateBending, PlateStiffness};
    /// use isosheet_mesh::{MassKind, VertexId, generate};
    /// use isosheet_model::SheetModel;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let sheet = generate::isotropic_square(2, 0.2)?;
    /// let clamp: Vec<VertexId> = (0..18).map(VertexId).collect(); // two rows of vertices
    /// let (stiffness, poisson, rigidity) = (3e5, 0.3, 5e-4); // office paper
    /// let plate = PlateBending::clamped(&sheet, PlateStiffness { rigidity, poisson }, &clamp)?;
    /// let elastic = ElasticSheet::new(&sheet, stiffness, poisson)?.beside(&sheet, &plate);
    /// let model = SheetModel::new(&sheet, 3.2e-3, MassKind::Lumped)?
    ///     .with_gravity()
    ///     .with_pins(&clamp)?
    ///     .with_potential(plate)
    ///     .with_elastic_sheet(elastic)?;
    /// assert!(model.rods().is_empty());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`ModelError::ElasticSheet`] if it was built for another sheet.
    pub fn with_elastic_sheet(mut self, elastic: ElasticSheet) -> Result<Self, ModelError> {
        let (found, face_count) = (elastic.face_count(), self.topology.face_count());
        if found != face_count {
            return Err(ModelError::ElasticSheet { found, face_count });
        }
        let mut is_rod = vec![true; self.edges.len()];
        for face in elastic.faces() {
            for edge in self.topology.face_edges(face) {
                is_rod[edge.index()] = false;
            }
        }
        self.set_rods(|edge| is_rod[edge.index()]);
        self.elastic = Some(elastic);
        Ok(self)
    }

    /// Adds a non-conservative force.
    #[must_use]
    pub fn with_force(mut self, force: impl Force + 'static) -> Self {
        self.forces.push(Box::new(force));
        self
    }

    /// Adds a force that BDF2 and implicit Euler take as a [term](crate::term::Term) of their objective, and
    /// other methods as it is: one that is too stiff to be taken as it is expected at the end of a step, or
    /// has a barrier.
    #[must_use]
    pub fn with_implicit_force(mut self, force: impl ImplicitForce + 'static) -> Self {
        self.implicit.push(Box::new(force));
        self
    }

    /// Says when velocities or accelerations of prescribed motions, or forces, change abruptly (seconds, in
    /// any order; what is not finite is left out), see `Profile::breaks`. Scenes do so for all their
    /// functions of time.
    ///
    /// Methods without a chart end a sub-step there and give pins the velocities of the motion that begins. A
    /// method that uses earlier steps begins anew: a formula of second order over a jump of the acceleration
    /// `a` leaves an error `h a / 2` in the velocities. Of breaks that follow one another within a step the
    /// first one counts, since the steps do not resolve the others: keyframes of a motion that was sampled as
    /// often cost nothing.
    #[must_use]
    pub fn with_breaks(mut self, times: impl IntoIterator<Item = f64>) -> Self {
        self.breaks = self.breaks.and(times);
        self
    }

    /// Whether a potential has a limit.
    pub fn has_limit(&self) -> bool {
        self.potentials().any(|p| p.limit().is_some())
    }

    /// Whether there are forces that only steps which minimise have.
    pub fn needs_minimising(&self) -> bool {
        self.implicit.iter().any(|force| force.needs_minimising())
    }

    /// The forces that damped steps take as terms of their objective.
    pub fn implicit_forces(&self) -> impl Iterator<Item = &dyn ImplicitForce> {
        self.implicit.iter().map(Box::as_ref)
    }

    /// Says that the vertices from this one on belong to [rigid bodies](crate::RigidBody): neither the
    /// velocity damping nor [air](crate::Air) that is added later acts on them, and their edges say nothing
    /// about the lengths of the sheets.
    ///
    /// # Panics
    /// If no vertex is before it.
    #[must_use]
    pub fn with_bodies_from(mut self, first: VertexId) -> Self {
        let of_sheets = |ends: &&[usize; 2]| ends.iter().all(|v| *v < first.index());
        let edges = self.edges.edges().iter().zip(self.edges.lengths());
        let lengths = edges.filter(|(ends, _)| of_sheets(ends)).map(|(_, l)| *l);
        let lengths: Vec<f64> = lengths.collect();
        assert!(!lengths.is_empty(), "there are sheets before the bodies");
        self.mean_length = lengths.iter().sum::<f64>() / lengths.len() as f64;
        self.sheet_vertices = first.index();
        self
    }

    /// Connectivity.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// All edges with their rest lengths, rods or not.
    pub fn edges(&self) -> &LengthConstraints {
        &self.edges
    }

    /// The rods: the edges that no elastic face has.
    pub fn rods(&self) -> &LengthConstraints {
        &self.rods
    }

    /// Which edges the rods are.
    pub fn rod_edges(&self) -> &[EdgeId] {
        &self.rod_edges
    }

    /// Largest strain of an edge at positions `x` (`3V`, metres); edges of surfaces in prescribed motion have
    /// none.
    ///
    /// # Panics
    /// If `x` is not of length `3V`.
    pub fn max_strain(&self, x: &[f64]) -> f64 {
        self.measured.as_ref().unwrap_or(&self.edges).max_strain(x)
    }

    /// Whether an edge is a rod.
    pub(crate) fn is_rod(&self, edge: EdgeId) -> bool {
        self.rod_edges.binary_search(&edge).is_ok()
    }

    /// Whether there are rods in sheets, and not in rigid bodies alone.
    pub fn has_rods_in_sheets(&self) -> bool {
        let of_sheets = |ends: &[usize; 2]| ends.iter().all(|v| *v < self.sheet_vertices);
        self.rods.edges().iter().any(of_sheets)
    }

    /// Largest violation of the equations of isometry at positions `x` (`3V`, metres), which an accepted step
    /// keeps below its tolerance: the largest strain of a rod, zero without rods. Not a number if a
    /// position is not.
    ///
    /// # Panics
    /// If `x` is not of length `3V`.
    pub fn constrained_strain(&self, x: &[f64]) -> f64 {
        self.rods.max_strain(x)
    }

    /// The mass matrix.
    pub fn mass(&self) -> &MassMatrix {
        &self.mass
    }

    /// The elasticity in the plane, of sheets that have it.
    pub fn elastic_sheet(&self) -> Option<&ElasticSheet> {
        self.elastic.as_ref()
    }

    /// The potentials in the order in which they were added, and after them that of an elastic sheet, for an
    /// energy balance of each of them.
    pub fn potentials(&self) -> impl Iterator<Item = &dyn Potential> {
        let elastic = self.elastic.iter().map(|e| e as &dyn Potential);
        self.potentials.iter().map(Box::as_ref).chain(elastic)
    }

    /// The place in `Memories::lists` of the potential that is added next: that of an elastic
    /// sheet stays the last one.
    pub fn next_potential(&self) -> usize {
        self.potentials.len()
    }

    /// The non-conservative forces in the order in which they were added.
    pub fn forces(&self) -> &[Box<dyn Force>] {
        &self.forces
    }

    /// The number of vertices of sheets; vertices of rigid bodies come after them.
    pub fn sheet_vertices(&self) -> usize {
        self.sheet_vertices
    }

    /// The first vertices of rigid bodies and of surfaces in prescribed motion.
    pub fn sheets_end(&self) -> [usize; 2] {
        [self.sheet_vertices, self.driven_from]
    }

    /// Number of vertices that are not pinned.
    pub fn free_count(&self) -> usize {
        self.free_count
    }

    /// Position of each vertex among the free ones.
    pub fn free_index(&self) -> &[u32] {
        &self.free_index
    }

    /// Number of coordinates `3V`.
    pub fn coordinate_count(&self) -> usize {
        3 * self.free_index.len()
    }

    /// Mean rest length of the edges, metres: the length scale of tolerances.
    pub fn mean_length(&self) -> f64 {
        self.mean_length
    }

    /// Length of the shortest edge at a vertex, metres: the scale of displacements that must not
    /// turn a face over.
    pub fn shortest_edge(&self, vertex: usize) -> f64 {
        self.shortest_edges[vertex]
    }

    /// Mean vertex mass, kilograms: the mass scale of tolerances.
    pub fn mean_mass(&self) -> f64 {
        self.mean_mass
    }

    /// Total potential energy, joules, where a simulation starts at rest.
    pub fn potential_energy(&self, t: f64, x: &[f64]) -> f64 {
        self.energy_with(&self.memories_at_rest(t, x), t, x)
    }

    /// Total potential energy with memories, joules.
    pub fn energy_with(&self, memories: &Memories, t: f64, x: &[f64]) -> f64 {
        let potentials = self.potentials_at(t, x, memories);
        potentials.map(|(p, at)| p.energy(at)).sum()
    }

    /// Whether a potential depends on time.
    pub fn has_driven_potentials(&self) -> bool {
        self.potentials().any(|p| p.is_driven())
    }

    /// Work of changing the driven potentials while the sheet moves from `x0` at `t0` to `x1` at `t1`,
    /// joules: the integral of `dV/dt` at fixed positions by the trapezoidal rule.
    ///
    /// The rates are differences over a small part of the step, that of the start forwards and that of the
    /// end backwards, since functions of time may break at its ends. (Differences over the whole step at
    /// positions of one of its ends would bend and yield as nothing does.)
    pub fn potential_work(
        &self,
        memories: &Memories,
        (t0, x0): (f64, &[f64]),
        (t1, x1): (f64, &[f64]),
    ) -> f64 {
        let part = RATE_PART * (t1 - t0);
        let change = |[from, to]: [f64; 2], x: &[f64]| -> f64 {
            let driven = self.potentials_at(from, x, memories);
            let driven = driven.filter(|(p, _)| p.is_driven());
            driven
                .map(|(p, at)| p.energy(At { t: to, ..at }) - p.energy(at))
                .sum()
        };
        let sum = change([t0, t0 + part], x0) + change([t1 - part, t1], x1);
        0.5 * sum / RATE_PART
    }

    /// Kinetic energy `v^T M v / 2` (Eq. 2), joules.
    pub fn kinetic_energy(&self, v: &[f64]) -> f64 {
        self.mass.kinetic_energy(&self.topology, v)
    }

    /// Conservative force `f = -dV/dx` where a simulation starts at rest, overwriting `f`; zero at pinned
    /// vertices.
    pub fn potential_force(&self, t: f64, x: &[f64], f: &mut [f64]) {
        self.acting_force(&self.memories_at_rest(t, x), t, x, f);
    }

    /// Conservative force with memories, overwriting `f`; zero at pinned vertices.
    pub fn acting_force(&self, memories: &Memories, t: f64, x: &[f64], f: &mut [f64]) {
        self.force_with(memories, t, x, f);
        self.clear_pinned(f);
    }

    /// Conservative force with memories, overwriting `f`, at pinned vertices too.
    pub fn force_with(&self, memories: &Memories, t: f64, x: &[f64], f: &mut [f64]) {
        f.fill(0.0);
        for (p, at) in self.potentials_at(t, x, memories) {
            p.add_gradient(at, f);
        }
        f.iter_mut().for_each(|v| *v = -*v);
    }

    /// Sum of the non-conservative forces (`3V`, newtons) at time `t` (seconds), positions `x` and velocities
    /// `v` (`3V`), that of the air included, overwriting `f`; zero at pinned vertices.
    pub fn applied_force(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        f.fill(0.0);
        self.add_applied_force(t, x, v, f);
        self.clear_pinned(f);
    }

    /// Adds the non-conservative forces, at pinned vertices too.
    pub fn add_applied_force(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.add_explicit_force(t, x, v, f);
        for force in self.implicit_forces() {
            force.add_force(t, x, v, f);
        }
    }

    /// Adds the non-conservative forces that damped steps take as they are expected at their end, at pinned
    /// vertices too.
    pub fn add_explicit_force(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        for force in &self.forces {
            force.add_force(t, x, v, f);
        }
    }

    /// Whether anything but potentials acts on the sheet.
    pub fn has_applied_forces(&self) -> bool {
        !self.forces.is_empty() || !self.implicit.is_empty()
    }

    /// Whether every potential is linear, so that its force is constant.
    pub fn has_constant_forces(&self) -> bool {
        self.potentials()
            .all(|p| p.shape() == PotentialShape::Linear)
    }

    /// `out = M v`, zero at pinned vertices.
    pub fn apply_mass(&self, v: &[f64], out: &mut [f64]) {
        self.mass.apply(&self.topology, v, out);
        self.clear_pinned(out);
    }

    /// Sets the entries of pinned vertices to zero.
    pub fn clear_pinned(&self, f: &mut [f64]) {
        if self.free_count == self.free_index.len() {
            return;
        }
        for (i, row) in self.free_index.iter().zip(f.as_chunks_mut::<3>().0) {
            if *i == PINNED {
                *row = [0.0; 3];
            }
        }
    }

    /// Largest `|f_i| / m_i` of forces, momenta or impulses: the size of a residual that weighs
    /// light and heavy vertices alike. Infinite if any is not a number.
    pub fn largest_acceleration(&self, f: &[f64]) -> f64 {
        f.iter().enumerate().fold(0.0, |m: f64, (i, f)| {
            // `max` would pass over a value that is not a number.
            let a = f.abs() / self.mass.vertex[i / 3];
            if a.is_nan() { f64::INFINITY } else { m.max(a) }
        })
    }

    /// Linear momentum, kg m/s.
    pub fn linear_momentum(&self, v: &[f64]) -> [f64; 3] {
        let mut p = vec![0.0; v.len()];
        self.mass.apply(&self.topology, v, &mut p);
        p.as_chunks::<3>()
            .0
            .iter()
            .fold([0.0; 3], |s, r| [s[0] + r[0], s[1] + r[1], s[2] + r[2]])
    }

    /// Angular momentum about the origin, kg m2/s.
    pub fn angular_momentum(&self, x: &[f64], v: &[f64]) -> [f64; 3] {
        let mut p = vec![0.0; v.len()];
        self.mass.apply(&self.topology, v, &mut p);
        let mut l = [0.0; 3];
        for (r, p) in x.as_chunks::<3>().0.iter().zip(p.as_chunks::<3>().0) {
            l[0] += r[1] * p[2] - r[2] * p[1];
            l[1] += r[2] * p[0] - r[0] * p[2];
            l[2] += r[0] * p[1] - r[1] * p[0];
        }
        l
    }
}
