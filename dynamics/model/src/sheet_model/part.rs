//! Potentials of one of several sheets.

use isosheet_materials::hessian::HessianSink;
use isosheet_materials::potential::{
    At, CouplingKind, Difference, HessianKind, Limited, MaterialReport, Potential, PotentialShape,
    Reached, Remembering, Settled,
};
use isosheet_materials::{LimitError, NoDerivative};
use isosheet_mesh::{EdgeId, FaceId, Part, VertexId};
use nalgebra::{Matrix2, Matrix3, Vector3};
use std::any::Any;

/// A potential that was made for one sheet, in a model of the [union](isosheet_mesh::Sheet::union) of
/// several: it sees the coordinates of its own vertices, and its derivatives go to the places that these have
/// in the union.
///
/// ```
/// use isosheet_materials::PlateBending;
/// use isosheet_mesh::{MassKind, MassMatrix, Part, Sheet, generate};
/// use isosheet_model::{PotentialOfPart, SheetModel};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let paper = generate::isotropic_square(2, 0.2)?;
/// let card = generate::isotropic_square(1, 0.1)?.map_positions(|[x, y, z]| [x, y, z + 0.01])?;
/// let parts = Part::of_union(&[&paper, &card]);
/// let masses = [
///     MassMatrix::from_density(&paper, 0.08, MassKind::Lumped)?,
///     MassMatrix::from_density(&card, 0.25, MassKind::Lumped)?,
/// ];
/// let both = Sheet::union(&[&paper, &card])?;
/// let model = SheetModel::with_mass(&both, MassMatrix::union(&masses))?
///     .with_potential(PotentialOfPart::new(PlateBending::new(&paper, 5e-4)?, &parts[0]))
///     .with_potential(PotentialOfPart::new(PlateBending::new(&card, 1e-2)?, &parts[1]));
/// # let _ = model;
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct PotentialOfPart<P> {
    potential: P,
    part: Part,
}

impl<P: Potential> PotentialOfPart<P> {
    /// A potential of the sheet that is this part of a union.
    pub fn new(potential: P, part: &Part) -> Self {
        let part = part.clone();
        Self { potential, part }
    }

    fn own<'a>(&self, at: At<'a>) -> At<'a> {
        let x = &at.x[self.part.coordinates()];
        At { x, ..at }
    }

    fn reached<'a>(&self, Reached { t, x, v }: Reached<'a>) -> Reached<'a> {
        let own = self.part.coordinates();
        let (x, v) = (&x[own.clone()], &v[own]);
        Reached { t, x, v }
    }
}

impl<P: Potential> Potential for PotentialOfPart<P> {
    fn energy(&self, at: At<'_>) -> f64 {
        self.potential.energy(self.own(at))
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let own = &mut gradient[self.part.coordinates()];
        self.potential.add_gradient(self.own(at), own);
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let part = &self.part;
        let hessian = &mut Shifted { part, hessian };
        self.potential.add_hessian(self.own(at), hessian);
    }

    fn add_semidefinite_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let part = &self.part;
        let hessian = &mut Shifted { part, hessian };
        self.potential
            .add_semidefinite_hessian(self.own(at), hessian);
    }

    fn difference(&self, other: &dyn Potential) -> Difference {
        let other: Option<&Self> = (other as &dyn Any).downcast_ref();
        match other.filter(|other| self.part == other.part) {
            Some(other) => self.potential.difference(&other.potential),
            None => Difference::Everything,
        }
    }

    fn add_gradient_of(&self, parts: &[u32], at: At<'_>, gradient: &mut [f64]) {
        let own = &mut gradient[self.part.coordinates()];
        self.potential.add_gradient_of(parts, self.own(at), own);
    }

    fn hessian_kind(&self) -> HessianKind {
        self.potential.hessian_kind()
    }

    fn couplings(&self) -> Vec<[VertexId; 2]> {
        let pairs = self.potential.couplings().into_iter();
        pairs
            .map(|pair| pair.map(|v| self.part.vertex(v)))
            .collect()
    }

    fn coupling_kind(&self) -> CouplingKind {
        self.potential.coupling_kind()
    }

    fn is_driven(&self) -> bool {
        self.potential.is_driven()
    }

    fn round_off(&self, size: f64, energy: f64) -> f64 {
        self.potential.round_off(size, energy)
    }

    fn shape(&self) -> PotentialShape {
        self.potential.shape()
    }

    fn limit(&self) -> Option<&dyn Limited> {
        self.potential.limit().map(|_| self as _)
    }

    fn remembering(&self) -> Option<&dyn Remembering> {
        self.potential.remembering().map(|_| self as _)
    }

    fn report(&self) -> Option<&dyn MaterialReport> {
        self.potential.report().map(|_| self as _)
    }
}

/// Why the wrapped potential has what the wrapper is asked for.
const ASKED: &str = "a wrapper has what its potential has";

impl<P: Potential> Limited for PotentialOfPart<P> {
    fn check(&self, at: At<'_>) -> Result<(), LimitError> {
        self.potential.limit().expect(ASKED).check(self.own(at))
    }

    fn safe_part(&self, at: At<'_>, dx: &[f64]) -> f64 {
        let dx = &dx[self.part.coordinates()];
        let limit = self.potential.limit().expect(ASKED);
        limit.safe_part(self.own(at), dx)
    }

    fn stays_within(&self, at: At<'_>, end: &[f64]) -> bool {
        let end = &end[self.part.coordinates()];
        let limit = self.potential.limit().expect(ASKED);
        limit.stays_within(self.own(at), end)
    }

    fn add_second_order(&self, at: At<'_>, dx: &[f64], scale: f64, out: &mut [f64]) -> bool {
        let own = self.part.coordinates();
        let (dx, out) = (&dx[own.clone()], &mut out[own]);
        let limit = self.potential.limit().expect(ASKED);
        limit.add_second_order(self.own(at), dx, scale, out)
    }
}

impl<P: Potential> PotentialOfPart<P> {
    fn remembers(&self) -> &dyn Remembering {
        self.potential.remembering().expect(ASKED)
    }

    fn reports(&self) -> &dyn MaterialReport {
        self.potential.report().expect(ASKED)
    }
}

impl<P: Potential> Remembering for PotentialOfPart<P> {
    fn memory(&self) -> Vec<f64> {
        self.remembers().memory()
    }

    fn start(&self, state: Reached<'_>, memory: &mut [f64]) {
        self.remembers().start(self.reached(state), memory);
    }

    fn settle(&self, state: Reached<'_>, memory: &mut [f64]) -> Settled {
        self.remembers().settle(self.reached(state), memory)
    }

    fn choices(&self, state: Reached<'_>, memory: &[f64]) -> Vec<f64> {
        self.remembers().choices(self.reached(state), memory)
    }

    fn settle_by(&self, choices: &[f64], state: Reached<'_>, memory: &mut [f64]) {
        self.remembers()
            .settle_by(choices, self.reached(state), memory);
    }

    fn memory_difference(&self, other: &dyn Potential) -> Difference {
        let other: Option<&Self> = (other as &dyn Any).downcast_ref();
        match other.filter(|other| self.part == other.part) {
            Some(other) => self.remembers().memory_difference(&other.potential),
            None => Difference::Everything,
        }
    }

    fn settled_product(
        &self,
        parts: Option<&[u32]>,
        state: Reached<'_>,
        found: (&[f64], &[f64]),
        of: &[f64],
    ) -> f64 {
        self.remembers()
            .settled_product(parts, self.reached(state), found, of)
    }

    fn add_memory_products(
        &self,
        at: At<'_>,
        w: &[f64],
        of_memory: &mut [f64],
    ) -> Result<(), NoDerivative> {
        let w = &w[self.part.coordinates()];
        self.remembers()
            .add_memory_products(self.own(at), w, of_memory)
    }

    fn add_memory_slopes(
        &self,
        at: At<'_>,
        scale: f64,
        of_memory: &mut [f64],
    ) -> Result<(), NoDerivative> {
        self.remembers()
            .add_memory_slopes(self.own(at), scale, of_memory)
    }

    fn pull_back_settling(
        &self,
        state: Reached<'_>,
        found: (&[f64], &[f64]),
        of_memory: &mut [f64],
        of_x: &mut [f64],
    ) -> Result<(), NoDerivative> {
        let of_x = &mut of_x[self.part.coordinates()];
        self.remembers()
            .pull_back_settling(self.reached(state), found, of_memory, of_x)
    }

    fn pull_back_start(
        &self,
        state: Reached<'_>,
        of_memory: &[f64],
        of_x: &mut [f64],
    ) -> Result<(), NoDerivative> {
        let of_x = &mut of_x[self.part.coordinates()];
        self.remembers()
            .pull_back_start(self.reached(state), of_memory, of_x)
    }

    fn can_yield(&self) -> bool {
        self.remembers().can_yield()
    }

    fn held_vertex(&self) -> Option<VertexId> {
        let vertex = self.remembers().held_vertex();
        vertex.map(|v| self.part.vertex(v))
    }
}

impl<P: Potential> MaterialReport for PotentialOfPart<P> {
    fn add_bending_energies(&self, at: At<'_>, faces: &mut [f64]) {
        let own = &mut faces[self.part.faces.clone()];
        self.reports().add_bending_energies(self.own(at), own);
    }

    fn bends_at_creases(&self, at: At<'_>) -> Vec<(EdgeId, f64)> {
        let own = self.reports().bends_at_creases(self.own(at)).into_iter();
        own.map(|(e, bend)| (self.part.edge(e), bend)).collect()
    }

    fn plastic_angles(&self, memory: &[f64]) -> Vec<(EdgeId, f64)> {
        let own = self.reports().plastic_angles(memory).into_iter();
        own.map(|(e, angle)| (self.part.edge(e), angle)).collect()
    }

    fn plastic_curvatures(&self, memory: &[f64]) -> Vec<(FaceId, Matrix2<f64>)> {
        let first = self.part.faces.start;
        let own = self.reports().plastic_curvatures(memory).into_iter();
        own.map(|(f, curvature)| (FaceId::from_index(first + f.index()), curvature))
            .collect()
    }

    fn clamp_moments(&self, at: At<'_>) -> Vec<[f64; 3]> {
        self.reports().clamp_moments(self.own(at))
    }
}

/// A sink that takes the numbers of a part.
struct Shifted<'a> {
    part: &'a Part,
    hessian: &'a mut dyn HessianSink,
}

impl HessianSink for Shifted<'_> {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        self.hessian.add_vertex(self.part.vertex(v), block);
    }

    fn add_edge(&mut self, e: EdgeId, block: &Matrix3<f64>) {
        self.hessian.add_edge(self.part.edge(e), block);
    }

    fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
        let [a, b] = [a, b].map(|v| self.part.vertex(v));
        self.hessian.add_pair(a, b, block);
    }

    fn add_square(&mut self, factor: f64, gradient: &[(VertexId, Vector3<f64>)]) {
        let shifted = gradient.iter().map(|(v, g)| (self.part.vertex(*v), *g));
        self.hessian
            .add_square(factor, &shifted.collect::<Vec<_>>());
    }
}
