//! The drag of the air on the faces of a sheet.

#[cfg(test)]
mod step_tests;
#[cfg(test)]
mod tests;

use crate::term::{Exchange, ImplicitForce, Iterate, StartProducts, StepStart, Term, Value};
use crate::{SheetModel, StepError};
use isosheet_materials::NoDerivative;
use isosheet_materials::hessian::{BlockSink, HessianPart};
use isosheet_materials::potential::Force;
use isosheet_materials::vectors::{add, point};
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, EdgeId, Topology, VertexId, area_from_lengths};
use isosheet_motion::{Profile, ProfileError};
use nalgebra::{Matrix3, Vector3};
use std::fmt;
use std::sync::Arc;

/// Part of the size of a face over which derivatives by the places of its corners are central differences.
const DIFFERENCE: f64 = 1e-5;

/// Why there cannot be such air.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AirError {
    /// Density or a coefficient is negative or not finite.
    #[error("{name} of the air is {value}", value = given(*value))]
    Number {
        /// Which one.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The profile of a component of the wind cannot be used.
    #[error("the wind along {axis} cannot be used: {source}")]
    Wind {
        /// The axis: x, y or z.
        axis: char,
        /// What is wrong with its profile.
        source: ProfileError,
    },
}

impl Advice for AirError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Number { .. } => Some("give a finite number of at least 0"),
            Self::Wind { source, .. } => source.advice(),
        }
    }
}

/// A function of a point (metres) and the time (seconds) that returns a velocity (metres per second).
type WindFunction = dyn Fn([f64; 3], f64) -> [f64; 3] + Send + Sync;

/// The velocity of the air.
///
/// Made from a vector (metres per second), from three [`Profile`]s, or from a function of a point (metres)
/// and the time (seconds) that returns the velocity there.
#[derive(Clone)]
pub enum Wind {
    /// A uniform wind; each component follows a profile, metres per second.
    Uniform([Profile; 3]),
    /// Any function of point and time. It has to return the same whenever it is asked for the same.
    Custom(Arc<WindFunction>),
}

impl Default for Wind {
    /// No wind.
    fn default() -> Self {
        [0.0; 3].into()
    }
}

impl fmt::Debug for Wind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Uniform(components) => components.fmt(f),
            Self::Custom(_) => f.write_str("Custom"),
        }
    }
}

impl From<[f64; 3]> for Wind {
    fn from(velocity: [f64; 3]) -> Self {
        Self::Uniform(velocity.map(Profile::Constant))
    }
}

impl From<[Profile; 3]> for Wind {
    fn from(components: [Profile; 3]) -> Self {
        Self::Uniform(components)
    }
}

impl<F: Fn([f64; 3], f64) -> [f64; 3] + Send + Sync + 'static> From<F> for Wind {
    fn from(velocity: F) -> Self {
        Self::Custom(Arc::new(velocity))
    }
}

impl Wind {
    /// Velocity at a point (metres) and a time (seconds), metres per second.
    pub fn velocity(&self, point: [f64; 3], t: f64) -> [f64; 3] {
        match self {
            Self::Uniform(components) => [0, 1, 2].map(|k| components[k].value(t)),
            Self::Custom(velocity) => velocity(point, t),
        }
    }
}

/// The air around a sheet, at rest or in motion, which drags at every face by the square of the relative
/// velocity.
///
/// A face of rest area `A` with the unit normal `n`, whose centroid `x` has the velocity `v`, feels the force
///
/// ```text
/// f = rho A / 2 (c_n |u_n| u_n n + c_t |u_t| u_t),   u = w(x, t) - v,   u_n = u . n,   u_t = u - u_n n,
/// ```
///
/// in newtons, along the wind `w` where the sheet is at rest; a third of it acts on each corner. The other
/// unit normal, `-n`, gives the same force: the coefficients are for a plate with its two sides, and each
/// face counts once.
///
/// That the normal force depends on the normal component of the velocity alone is the cross-flow principle
/// (Hoerner, "Fluid-dynamic drag", 1965; Taylor, Proc. R. Soc. A 214, 1952, for slender bodies), which models
/// of flexible plates in wind use face by face (Gosselin, de Langre and Machado-Almeida, J. Fluid Mech. 650,
/// 2010). It holds for separated flow. There is no lift of attached flow, no wake, no air that moves along
/// with the sheet (added mass), and no face shelters another.
///
/// BDF2 and implicit Euler take the force at the end of a step, with the normals that the velocities at its
/// start lead to. So it is never too stiff for a step, and at its order. All other methods take it as an
/// explicit force. Its work is a part of `StepReport::work`.
///
/// ```
/// use isosheet_mesh::{MassKind, generate};
/// use isosheet_model::{Air, SheetModel};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let sheet = generate::isotropic_square(1, 0.2)?;
/// // An updraught of 2 m/s at the ground that fades with the height.
/// let updraught = |[_, _, z]: [f64; 3], _t: f64| [0.0, 0.0, 2.0 * (-z).exp()];
/// let air = Air { wind: updraught.into(), ..Air::default() };
/// let model = SheetModel::new(&sheet, 3.2e-3, MassKind::Lumped)?.with_gravity().with_air(air)?;
/// # let _ = model;
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Air {
    /// Density `rho`, kilograms per cubic metre. Default 1.2: dry air at 20 degrees Celsius and 1013 hPa.
    pub density: f64,
    /// Coefficient `c_n` of the drag along the normal. Default 1.2: square and round plates across the stream
    /// have 1.17 (Hoerner 1965), strips of five times their width 1.2, and long ones up to 2.
    pub normal: f64,
    /// Coefficient `c_t` of the friction along the face, of both sides together. Default 0.02: twice the
    /// `1.33 / sqrt(Re)` of a laminar boundary layer (Blasius 1908), for 0.2 m in a wind of 1.3 m/s.
    pub tangential: f64,
    /// Velocity of the air. Default: at rest.
    pub wind: Wind,
}

impl Default for Air {
    fn default() -> Self {
        Self {
            density: 1.2,
            normal: 1.2,
            tangential: 0.02,
            wind: Wind::default(),
        }
    }
}

impl Air {
    /// Checks density, coefficients and profiles. (A function is checked where it is evaluated.)
    ///
    /// # Errors
    /// [`AirError`] naming the first that makes no sense.
    pub fn validate(&self) -> Result<(), AirError> {
        for (name, value) in [
            ("density", self.density),
            ("normal", self.normal),
            ("tangential", self.tangential),
        ] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(AirError::Number { name, value });
            }
        }
        if let Wind::Uniform(components) = &self.wind {
            for (axis, profile) in ['x', 'y', 'z'].into_iter().zip(components) {
                let checked = profile.validate();
                checked.map_err(|source| AirError::Wind { axis, source })?;
            }
        }
        Ok(())
    }
}

impl SheetModel {
    /// Surrounds the sheet with air.
    ///
    /// # Errors
    /// [`AirError`] if density, a coefficient or a profile makes no sense.
    pub fn with_air(self, air: Air) -> Result<Self, AirError> {
        air.validate()?;
        let mut faces = on_faces(&air, self.topology(), self.edges().lengths());
        faces.retain(|face| face.vertices[0].index() < self.sheet_vertices());
        let wind = air.wind;
        Ok(self.with_implicit_force(Drag(Arc::new(OnFaces { wind, faces }))))
    }
}

/// A face in the air.
#[derive(Debug, Clone, Copy)]
struct Face {
    vertices: [VertexId; 3],
    edges: [EdgeId; 3],
    /// Factors `rho A c / 2` of the drag along the normal and along the face, kilograms per metre.
    factors: [f64; 2],
}

/// The drag on a face whose normal is given, as a function of the relative velocity `u` of the air.
#[derive(Debug, Clone, Copy, Default)]
struct FaceDrag {
    normal: Vector3<f64>,
    factors: [f64; 2],
}

/// The mean of the corners.
fn centroid(values: &[f64], vertices: [VertexId; 3]) -> Vector3<f64> {
    let [a, b, c] = vertices.map(|v| point(values, v));
    (a + b + c) / 3.0
}

impl Face {
    /// The drag on the face at positions `x`. (A face that is a line has no normal: all of its drag is
    /// friction.)
    fn drag(&self, x: &[f64]) -> FaceDrag {
        let [a, b, c] = self.vertices.map(|v| point(x, v));
        let across = (b - a).cross(&(c - a));
        FaceDrag {
            normal: across.try_normalize(0.0).unwrap_or_default(),
            factors: self.factors,
        }
    }
}

impl FaceDrag {
    /// The velocities across and along the face.
    fn split(&self, u: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let across = u.dot(&self.normal);
        (across, u - across * self.normal)
    }

    /// Force of the air on the face, newtons.
    fn force(&self, u: &Vector3<f64>) -> Vector3<f64> {
        let (across, along) = self.split(u);
        let [n, t] = self.factors;
        n * across.abs() * across * self.normal + t * along.norm() * along
    }

    /// The convex function `(n |u_n|^3 + t |u_t|^3) / 3` whose gradient is the force, watts.
    fn potential(&self, u: &Vector3<f64>) -> f64 {
        let (across, along) = self.split(u);
        let [n, t] = self.factors;
        (n * across.abs().powi(3) + t * along.norm().powi(3)) / 3.0
    }

    /// Derivative of the force, kilograms per second: symmetric and positive semidefinite.
    fn derivative(&self, u: &Vector3<f64>) -> Matrix3<f64> {
        let (across, along) = self.split(u);
        let [n, t] = self.factors;
        let normals = self.normal * self.normal.transpose();
        let mut sum = 2.0 * n * across.abs() * normals;
        let speed = along.norm();
        if speed > 0.0 {
            let direction = along / speed;
            let whole = Matrix3::identity() - normals + direction * direction.transpose();
            sum += t * speed * whole;
        }
        sum
    }
}

/// The faces of a sheet in the air, with the rest lengths of its edges, metres.
fn on_faces(air: &Air, topology: &Topology, lengths: &[f64]) -> Vec<Face> {
    let face = |f| {
        let edges = topology.face_edges(f);
        let area = area_from_lengths(edges.map(|e| lengths[e.index()]));
        let factor = |coefficient| 0.5 * air.density * area * coefficient;
        Face {
            vertices: topology.faces()[f.index()],
            edges,
            factors: [factor(air.normal), factor(air.tangential)],
        }
    };
    topology.face_ids().map(face).collect()
}

/// The wind and all faces of a sheet.
#[derive(Debug)]
struct OnFaces {
    wind: Wind,
    faces: Vec<Face>,
}

impl OnFaces {
    /// Velocity of the air at the centroid of a face, metres per second.
    fn wind_at(&self, face: &Face, t: f64, x: &[f64]) -> Vector3<f64> {
        let point = centroid(x, face.vertices);
        self.wind.velocity(point.into(), t).into()
    }
}

/// The force of the air.
#[derive(Debug)]
struct Drag(Arc<OnFaces>);

impl Force for Drag {
    fn add_force(&self, t: f64, x: &[f64], v: &[f64], force: &mut [f64]) {
        for face in &self.0.faces {
            let u = self.0.wind_at(face, t, x) - centroid(v, face.vertices);
            let share = face.drag(x).force(&u) / 3.0;
            for vertex in face.vertices {
                add(force, vertex, &share);
            }
        }
    }
}

impl ImplicitForce for Drag {
    fn term(&self, free: Arc<[bool]>) -> Box<dyn Term> {
        Box::new(AirStep {
            drag: Self(Arc::clone(&self.0)),
            free,
            faces: Vec::new(),
            rest: Vec::new(),
            h: 0.0,
            force: Vec::new(),
        })
    }
}

/// The incremental potential of the drag of the air in a step that makes velocities of positions by `x = y +
/// h v`, over `h`,
///
/// ```text
/// R(x) = h sum_f (n_f |u_n|^3 + t_f |u_t|^3) / 3,   u = w - (x_c - y_c) / h,
/// ```
///
/// with the centroids `x_c`, `y_c` of the faces and the factors `n_f`, `t_f` of [`FaceDrag`]. Its gradient is
/// minus the force at the velocities `v` at the end of the step. Normals and wind `w` are those at the end of
/// the step at the positions that the velocities at its start lead to, which leaves a second-order method its
/// order. With fixed normals `R` is convex, and in air at rest the force takes energy from the sheet,
/// whatever the normals are.
#[derive(Debug)]
struct AirStep {
    drag: Drag,
    /// Which vertices are free.
    free: Arc<[bool]>,
    faces: Vec<FaceInStep>,
    /// `y`, `3V`, metres.
    rest: Vec<f64>,
    /// The effective step `h`, seconds.
    h: f64,
    /// `3V`.
    force: Vec<f64>,
}

#[derive(Debug)]
struct FaceInStep {
    face: Face,
    drag: FaceDrag,
    /// Velocity of the air, metres per second.
    wind: Vector3<f64>,
}

impl AirStep {
    /// The faces with the velocity of the air relative to them.
    fn relative(&self, x: &[f64]) -> impl Iterator<Item = (&FaceInStep, Vector3<f64>)> {
        self.faces.iter().map(move |f| {
            let moved = centroid(x, f.face.vertices) - centroid(&self.rest, f.face.vertices);
            (f, f.wind - moved / self.h)
        })
    }
}

impl Term for AirStep {
    fn begin(&mut self, step: &StepStart<'_>) -> Result<(), StepError> {
        let (t, ahead) = (step.t(), step.ahead);
        self.h = step.h;
        self.rest.clear();
        self.rest.extend_from_slice(step.rest);
        self.faces.clear();
        let on_faces = &self.drag.0;
        for face in &on_faces.faces {
            let wind = on_faces.wind_at(face, t, ahead);
            if let Some(&value) = wind.iter().find(|w| !w.is_finite()) {
                let vertex = face.vertices[0];
                return Err(StepError::NonFiniteForce { vertex, value, t });
            }
            self.faces.push(FaceInStep {
                face: *face,
                drag: face.drag(ahead),
                wind,
            });
        }
        Ok(())
    }

    fn value(&mut self, at: Iterate<'_>) -> Value {
        let potentials = self.relative(at.x).map(|(f, u)| f.drag.potential(&u));
        Value::of(self.h * potentials.sum::<f64>())
    }

    fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]) {
        for (f, u) in self.relative(at.x) {
            let share = -scale / 3.0 * f.drag.force(&u);
            for v in f.face.vertices {
                add(out, v, &share);
            }
        }
    }

    /// Positive semidefinite.
    fn add_hessian(&mut self, at: Iterate<'_>, _part: HessianPart, sink: &mut dyn BlockSink) {
        // Each of two corners moves the centroid by a third.
        let scale = 1.0 / (9.0 * self.h);
        for (f, u) in self.relative(at.x) {
            let block = scale * f.drag.derivative(&u);
            for v in f.face.vertices {
                sink.add_vertex(v, &block);
            }
            for e in f.face.edges {
                sink.add_edge(e, &block);
            }
        }
    }

    /// By `y` through the velocities, which the Hessian has with the other sign, and by the places that the
    /// velocities at the start lead to through normals and wind, of each face by central differences.
    fn add_start_products(
        &mut self,
        step: &StepStart<'_>,
        at: Iterate<'_>,
        w: &[f64],
        scale: f64,
        out: &mut StartProducts,
    ) -> Result<(), NoDerivative> {
        let scale = -scale / 3.0;
        let (t, on_faces) = (step.t(), &self.drag.0);
        for (f, u) in self.relative(at.x) {
            let vertices = f.face.vertices;
            let weight: Vector3<f64> = vertices.iter().map(|v| point(w, *v)).sum();
            let moved = f.wind - u;
            // The velocity of the air relative to the face grows with `y / h`.
            let by_rest = scale / (3.0 * self.h) * (f.drag.derivative(&u) * weight);
            let corners = vertices.map(|v| point(step.ahead, v));
            let size = (corners[1] - corners[0]).norm();
            let mut places = step.ahead.to_vec();
            for vertex in vertices {
                add(&mut out.rest, vertex, &by_rest);
                for axis in 0..3 {
                    let i = 3 * vertex.index() + axis;
                    let mut at = |distance: f64| {
                        places[i] = step.ahead[i] + distance;
                        let wind = on_faces.wind_at(&f.face, t, &places);
                        let force = f.face.drag(&places).force(&(wind - moved));
                        places[i] = step.ahead[i];
                        force.dot(&weight)
                    };
                    let distance = DIFFERENCE * size;
                    let slope = (at(distance) - at(-distance)) / (2.0 * distance);
                    out.ahead[i] += scale * slope;
                }
            }
        }
        Ok(())
    }

    fn finish(&mut self, step: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, StepError> {
        let mut force = std::mem::take(&mut self.force);
        force.clear();
        force.resize(at.x.len(), 0.0);
        self.add_gradient(at, -1.0, &mut force);
        let work = step.implicit_work(&self.drag, &self.free, at.x, &mut force);
        self.force = force;
        Ok(work)
    }
}
