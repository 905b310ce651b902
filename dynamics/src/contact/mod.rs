//! Contact of a sheet with bodies and with itself.
//!
//! Contact is a barrier potential `B(x, s)` of the positions and of the places of the bodies, infinite where
//! anything touches, and a friction potential `D(x - x0)` with normals and normal forces kept constant
//! ("lagged"; Li et al. 2020, Incremental potential contact). Bodies move by prescribed motions; within a
//! step their progress `s` runs from 0 (the start) to 1 (the end), and neither they nor the sheet move
//! without a check that nothing is passed through on the way.
//!
//! An implementation of [`Contact`] knows the geometry and nothing else. All that happens with it is a chain
//! of values, each of which can only be made from the one before; the solver makes those without a link:
//!
//! | value | made from | what it says |
//! |---|---|---|
//! | [`BodyMotions`] | a span of time | how the bodies move over a step |
//! | `ContactSet` | a motion of sheet and bodies | the pairs within reach on it, the part that is safe |
//! | [`ActiveContacts`] | a set and a place on its motion | distances, normals and weights there |
//! | `BarrierPotential` | the laws, the model and the state at the start | the barrier and its stiffness |
//! | `LaggedFriction` | the active contacts at which friction is lagged | normals and normal forces |
//! | `ContactTerms` | active contacts, barrier and friction | energy, gradient, Hessian, loads of `B + D` |
//!
//! The barrier of a gap `g` below the activation distance `d` is `-kappa (1 - z)^2 ln z` with `z = (g / d)^2`
//! and the stiffness `kappa` of the [laws](ContactLaws), in joules. Its forces are
//! [`Simulation::contact_forces`](crate::Simulation::contact_forces) and
//! [`Simulation::body_loads`](crate::Simulation::body_loads).
//!
//! Positions `x` and displacements are `3V` coordinates in metres, pinned vertices included.

mod active;
mod barrier;
mod body;
#[cfg(test)]
pub(crate) mod contact_tests;
mod coulomb;
mod course;
mod friction;
mod friction_law;
#[doc(hidden)]
pub mod internals;
mod lagged;
mod laws;
mod parallel;
mod set;
mod stencil;
mod surface_points;
mod tangent;
mod term;
mod terms;
mod vertex_data;

pub use active::{ActiveContact, ActiveContacts, Rolling, Round};
pub(crate) use barrier::BarrierPotential;
pub(crate) use body::advanced;
pub use body::{BodyMotion, BodyMotions, BodyPlace, StepMotion, StepSpan};
pub use coulomb::{Coefficients, Coulomb};
pub(crate) use course::Course;
pub use friction::Friction;
pub use friction_law::FrictionLaw;
pub(crate) use friction_law::{check_values, name_of, wrong};
pub use isosheet_model::CarriedPoint;
pub use isosheet_model::{BarrierError, BodyMotionError, ContactError, ContactPair};
pub use isosheet_model::{FrictionError, FrictionLawFault};
pub(crate) use lagged::LaggedFriction;
pub use laws::{ContactLaws, ObstaclePair, SheetPair, Stiffness};
pub use parallel::ParallelEdges;
pub(crate) use set::ContactSet;
pub use set::{ContactKey, ContactKind, JointMotion};
pub use surface_points::{SurfacePoints, SurfacePointsError};
pub(crate) use tangent::LagAt;
pub use tangent::ReachedPairs;
pub(crate) use term::ContactTerm;
pub use terms::BodyLoad;
pub(crate) use terms::{ContactState, ContactTerms};

pub(crate) use isosheet_materials::hessian::CouplingSink;

use crate::{SheetModel, State};
use nalgebra::{Matrix3, Vector3};

/// Part of a gap over which derivatives of contact are central differences: they err by its square, and by
/// the round-off of gaps over it.
const DIFFERENCE: f64 = 1e-4;

/// The geometry of contact of a sheet with bodies and with itself.
///
/// Everything that is returned depends on the arguments alone, not on earlier calls: what an implementation
/// keeps between calls, such as a tree of boxes, saves time and nothing else. `isosheet-collide` has
/// `Contacts`, of meshes and all shapes; this is the ground `z = 0` under the vertices:
///
/// ```
/// use isosheet_dynamics::contact::{
///     ActiveContact, BodyMotion, BodyPlace, Contact, ContactError, ContactKey, ContactKind,
///     ContactLaws, JointMotion, StepMotion, StepSpan,
/// };
/// use isosheet_dynamics::{Method, SheetModel, Simulation, State};
/// use isosheet_mesh::{MassKind, generate};
/// use nalgebra::{Isometry3, Vector3};
///
/// struct Ground(ContactLaws);
///
/// impl Contact for Ground {
///     fn laws(&self) -> &ContactLaws {
///         &self.0
///     }
///
///     fn body_motions(&self, _span: StepSpan, out: &mut Vec<BodyMotion>) {
///         let rest = StepMotion::new(Isometry3::identity(), Isometry3::identity());
///         out.push(BodyMotion { material: rest, surface: rest });
///     }
///
///     fn query(&mut self, motion: JointMotion<'_>, pairs: &mut Vec<ContactKey>) -> f64 {
///         let mut safe: f64 = 1.0;
///         for v in 0..motion.x.len() / 3 {
///             let (gap, rise) = (motion.x[3 * v + 2], motion.dx[3 * v + 2]);
///             if gap + rise.min(0.0) < self.0.activation {
///                 let kind = ContactKind::Vertex;
///                 pairs.push(ContactKey { body: Some(0), kind, pair: [v as u32, 0] });
///                 // A tenth of the gap is left.
///                 safe = if -rise > 0.9 * gap { safe.min(0.9 * gap / -rise) } else { safe };
///             }
///         }
///         safe
///     }
///
///     fn evaluate(
///         &self,
///         pairs: &[ContactKey],
///         x: &[f64],
///         _bodies: &[BodyPlace],
///         out: &mut Vec<ActiveContact>,
///     ) {
///         for key in pairs {
///             let v = key.pair[0];
///             let [x, y, z] = x.as_chunks::<3>().0[v as usize];
///             if z < self.0.activation {
///                 out.push(ActiveContact {
///                     key: *key,
///                     vertices: [v; 4],
///                     weights: [1.0, 0.0, 0.0, 0.0],
///                     normal: Vector3::z(),
///                     gap: z,
///                     closest: Vector3::new(x, y, 0.0),
///                     parallel: None,
///                     rolling: None,
///                     round: [None; 2],
///                 });
///             }
///         }
///     }
///
///     fn check_start(&mut self, _model: &SheetModel, state: &State) -> Result<(), ContactError> {
///         assert!(state.vertex_positions().iter().all(|p| p[2] > 0.0), "it starts above");
///         Ok(())
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let sheet = generate::isotropic_square(1, 0.1)?.map_positions(|[x, y, _]| [x, y, 0.01 + x])?;
/// let model = SheetModel::new(&sheet, 1e-3, MassKind::Lumped)?.with_gravity();
/// let start = State::at_rest(sheet.positions().to_vec());
/// let mut run = Simulation::new(model, start, Method::default())?
///     .with_contact(Ground(ContactLaws::frictionless(1e-3)))?;
/// for _ in 0..30 {
///     let report = run.step(1.0 / 60.0)?;
///     assert!(report.gap.is_none_or(|gap| gap > 0.0));
/// }
/// # Ok(())
/// # }
/// ```
pub trait Contact: Send + Sync {
    /// Activation distance of the barrier, stiffness, friction.
    fn laws(&self) -> &ContactLaws;

    /// The points that contact acts between, where these are not the vertices of the model; positions and
    /// displacements, and the numbers of vertices in contacts, then refer to the points.
    fn points(&self) -> Option<&SurfacePoints> {
        None
    }

    /// Appends the motions of the bodies over a span of time, in the order of the bodies.
    fn body_motions(&self, span: StepSpan, out: &mut Vec<BodyMotion>);

    /// Returns the largest fraction `a <= 1` of a motion that is proven to bring nothing into contact, and
    /// appends all pairs whose gap is below the activation distance at any time of that part of the motion,
    /// in any order and each once. Pairs that stay out of reach may be among them.
    fn query(&mut self, motion: JointMotion<'_>, pairs: &mut Vec<ContactKey>) -> f64;

    /// Appends the contacts of those pairs whose gap is below the activation distance (or not a number) at
    /// positions `x` with the bodies in their places, in the order of the pairs.
    fn evaluate(
        &self,
        pairs: &[ContactKey],
        x: &[f64],
        bodies: &[BodyPlace],
        out: &mut Vec<ActiveContact>,
    );

    /// Checks that a simulation can start at a state.
    ///
    /// # Errors
    /// [`ContactError`] if something touches or passes through at the start, or the implementation was made
    /// for another sheet. The state is that of the vertices of the model.
    fn check_start(&mut self, model: &SheetModel, state: &State) -> Result<(), ContactError>;
}

/// Adds `w_i w_j block` for all pairs of a stencil; the block is symmetric.
pub(crate) fn add_weighted(
    vertices: &[u32],
    weights: &[f64],
    block: &Matrix3<f64>,
    sink: &mut dyn CouplingSink,
) {
    for i in 0..vertices.len() {
        for j in i..vertices.len() {
            let w = weights[i] * weights[j];
            if w != 0.0 {
                add_block(vertices[i], vertices[j], w * block, sink);
            }
        }
    }
}

/// Lower vertex first.
fn add_block(a: u32, b: u32, block: Matrix3<f64>, sink: &mut dyn CouplingSink) {
    if a <= b {
        sink.add(a, b, &block);
    } else {
        sink.add(b, a, &block.transpose());
    }
}

/// Appends the pairs of vertices, lower number first, that a contact of the sheet with itself couples.
fn couple(key: ContactKey, vertices: &[u32], out: &mut Vec<[u32; 2]>) {
    if key.body.is_some() {
        return;
    }
    for i in 0..vertices.len() {
        for j in i + 1..vertices.len() {
            let (a, b) = (vertices[i], vertices[j]);
            out.push([a.min(b), a.max(b)]);
        }
    }
}

/// Adds to the entries of a vertex.
pub(crate) fn add_at(out: &mut [f64], v: u32, g: Vector3<f64>) {
    let i = 3 * v as usize;
    for k in 0..3 {
        out[i + k] += g[k];
    }
}
