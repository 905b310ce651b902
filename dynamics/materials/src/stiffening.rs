//! Stiffness that changes by itself.

use crate::derivative::NoDerivative;
use crate::hessian::HessianSink;
use crate::potential::{
    At, CouplingKind, HessianKind, Limited, MaterialReport, Potential, Reached, Remembering,
    Settled,
};
use isosheet_mesh::{EdgeId, FaceId, VertexId};
use isosheet_motion::{Profile, ProfileError};
use nalgebra::{Matrix2, Matrix3, Vector3};

/// A potential times a function of time, `f(t) V(x)`: a sheet that hardens as its glue dries, or softens as
/// it is heated. The work of the change, `f' V`, enters the energy balance; where it yields, the moments at
/// which it does are multiplied too.
///
/// ```
/// use isosheet_materials::{At, PlateBending, Potential, Stiffening};
/// use isosheet_mesh::generate;
/// use isosheet_motion::Profile;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let sheet = generate::isotropic_square(2, 0.2)?;
/// let dries = Profile::Ramp { from: 0.1, to: 1.0, begin: 0.0, end: 60.0 };
/// let plate = Stiffening::new(PlateBending::new(&sheet, 5e-4)?, dries)?;
/// let points = sheet.positions().as_chunks::<3>().0.iter();
/// let bent: Vec<f64> = points.flat_map(|p| [p[0], p[1], p[0] * p[0]]).collect();
/// let [wet, dry] = [0.0, 60.0].map(|t| plate.energy(At::new(t, &bent)));
/// assert!((dry / wet - 10.0).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Stiffening<P> {
    potential: P,
    factor: Profile,
}

impl<P: Potential> Stiffening<P> {
    /// A potential and the factor, which has to stay above 0 for the potential to keep its sign.
    ///
    /// # Errors
    /// [`ProfileError`] for a profile that makes no sense.
    pub fn new(potential: P, factor: impl Into<Profile>) -> Result<Self, ProfileError> {
        let factor = factor.into();
        factor.validate()?;
        Ok(Self { potential, factor })
    }

    fn scaled<'a>(&self, at: At<'_>, sink: &'a mut dyn HessianSink) -> Multiplied<'a> {
        let factor = self.factor.value(at.t);
        Multiplied { factor, sink }
    }
}

impl<P: Potential> Potential for Stiffening<P> {
    fn energy(&self, at: At<'_>) -> f64 {
        self.factor.value(at.t) * self.potential.energy(at)
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let mut own = vec![0.0; gradient.len()];
        self.potential.add_gradient(at, &mut own);
        add_scaled(gradient, self.factor.value(at.t), &own);
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let hessian = &mut self.scaled(at, hessian);
        self.potential.add_hessian(at, hessian);
    }

    fn add_semidefinite_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let hessian = &mut self.scaled(at, hessian);
        self.potential.add_semidefinite_hessian(at, hessian);
    }

    fn hessian_kind(&self) -> HessianKind {
        self.potential.hessian_kind()
    }

    fn couplings(&self) -> Vec<[VertexId; 2]> {
        self.potential.couplings()
    }

    fn coupling_kind(&self) -> CouplingKind {
        self.potential.coupling_kind()
    }

    fn is_driven(&self) -> bool {
        self.potential.is_driven() || !self.factor.is_constant()
    }

    fn limit(&self) -> Option<&dyn Limited> {
        self.potential.limit()
    }

    fn remembering(&self) -> Option<&dyn Remembering> {
        self.potential.remembering().map(|_| self as _)
    }

    fn report(&self) -> Option<&dyn MaterialReport> {
        self.potential.report().map(|_| self as _)
    }
}

impl<P: Potential> Stiffening<P> {
    fn remembers(&self) -> &dyn Remembering {
        let own = self.potential.remembering();
        own.expect("it remembers where its potential does")
    }

    fn reports(&self) -> &dyn MaterialReport {
        let own = self.potential.report();
        own.expect("it reports where its potential does")
    }
}

impl<P: Potential> Remembering for Stiffening<P> {
    fn memory(&self) -> Vec<f64> {
        self.remembers().memory()
    }

    fn start(&self, state: Reached<'_>, memory: &mut [f64]) {
        self.remembers().start(state, memory);
    }

    fn settle(&self, state: Reached<'_>, memory: &mut [f64]) -> Settled {
        let Settled { dissipated, work } = self.remembers().settle(state, memory);
        let [dissipated, work] = [dissipated, work].map(|part| self.factor.value(state.t) * part);
        Settled { dissipated, work }
    }

    fn choices(&self, state: Reached<'_>, memory: &[f64]) -> Vec<f64> {
        self.remembers().choices(state, memory)
    }

    fn settle_by(&self, choices: &[f64], state: Reached<'_>, memory: &mut [f64]) {
        self.remembers().settle_by(choices, state, memory);
    }

    fn add_memory_products(
        &self,
        at: At<'_>,
        w: &[f64],
        of_memory: &mut [f64],
    ) -> Result<(), NoDerivative> {
        let factor = self.factor.value(at.t);
        let w: Vec<f64> = w.iter().map(|w| factor * w).collect();
        self.remembers().add_memory_products(at, &w, of_memory)
    }

    fn add_memory_slopes(
        &self,
        at: At<'_>,
        scale: f64,
        of_memory: &mut [f64],
    ) -> Result<(), NoDerivative> {
        let scale = self.factor.value(at.t) * scale;
        self.remembers().add_memory_slopes(at, scale, of_memory)
    }

    fn pull_back_settling(
        &self,
        state: Reached<'_>,
        found: (&[f64], &[f64]),
        of_memory: &mut [f64],
        of_x: &mut [f64],
    ) -> Result<(), NoDerivative> {
        self.remembers()
            .pull_back_settling(state, found, of_memory, of_x)
    }

    fn pull_back_start(
        &self,
        state: Reached<'_>,
        of_memory: &[f64],
        of_x: &mut [f64],
    ) -> Result<(), NoDerivative> {
        self.remembers().pull_back_start(state, of_memory, of_x)
    }

    fn can_yield(&self) -> bool {
        self.remembers().can_yield()
    }

    fn held_vertex(&self) -> Option<VertexId> {
        self.remembers().held_vertex()
    }
}

impl<P: Potential> MaterialReport for Stiffening<P> {
    fn add_bending_energies(&self, at: At<'_>, faces: &mut [f64]) {
        let mut own = vec![0.0; faces.len()];
        self.reports().add_bending_energies(at, &mut own);
        add_scaled(faces, self.factor.value(at.t), &own);
    }

    fn bends_at_creases(&self, at: At<'_>) -> Vec<(EdgeId, f64)> {
        self.reports().bends_at_creases(at)
    }

    fn plastic_angles(&self, memory: &[f64]) -> Vec<(EdgeId, f64)> {
        self.reports().plastic_angles(memory)
    }

    fn plastic_curvatures(&self, memory: &[f64]) -> Vec<(FaceId, Matrix2<f64>)> {
        self.reports().plastic_curvatures(memory)
    }

    fn clamp_moments(&self, at: At<'_>) -> Vec<[f64; 3]> {
        let factor = self.factor.value(at.t);
        let moments = self.reports().clamp_moments(at).into_iter();
        moments.map(|m| m.map(|part| factor * part)).collect()
    }
}

fn add_scaled(sum: &mut [f64], factor: f64, values: &[f64]) {
    for (sum, value) in sum.iter_mut().zip(values) {
        *sum += factor * value;
    }
}

/// A sink that multiplies what it is given.
struct Multiplied<'a> {
    factor: f64,
    sink: &'a mut dyn HessianSink,
}

impl HessianSink for Multiplied<'_> {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        self.sink.add_vertex(v, &(block * self.factor));
    }

    fn add_edge(&mut self, e: EdgeId, block: &Matrix3<f64>) {
        self.sink.add_edge(e, &(block * self.factor));
    }

    fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
        self.sink.add_pair(a, b, &(block * self.factor));
    }

    fn add_square(&mut self, factor: f64, gradient: &[(VertexId, Vector3<f64>)]) {
        self.sink.add_square(self.factor * factor, gradient);
    }
}
