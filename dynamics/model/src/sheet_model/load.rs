//! Prescribed forces: loads on vertices and fields of acceleration whose size follows a profile.

use isosheet_materials::potential::Force;
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, EdgeId, FaceId, Topology, VertexId};
use isosheet_motion::{Profile, ProfileError};
use nalgebra::Vector3;

/// Why a load cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The profile cannot be used.
    #[error("the size of the load cannot be used: {0}")]
    Profile(#[from] ProfileError),
    /// The direction is zero or not finite.
    #[error(
        "the direction of the load is [{x}, {y}, {z}]",
        x = given(*x), y = given(*y), z = given(*z)
    )]
    Direction {
        /// Along x.
        x: f64,
        /// Along y.
        y: f64,
        /// Along z.
        z: f64,
    },
    /// A loaded vertex does not exist.
    #[error("{vertex} is loaded, but the sheet has only {vertex_count} vertices")]
    NoSuchVertex {
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        vertex_count: usize,
    },
    /// A weight is not finite.
    #[error("vertex {vertex} has the weight {weight} kg", weight = given(*weight))]
    Weight {
        /// The vertex, from 0.
        vertex: usize,
        /// Its weight, kilograms.
        weight: f64,
    },
    /// There are no edges to act on.
    #[error("a moment acts on no edge")]
    NoEdges,
    /// An edge is across the axis of a moment.
    #[error("{edge} is across the axis of the moment on it")]
    AcrossAxis {
        /// The edge.
        edge: EdgeId,
    },
    /// A loaded face has no area.
    #[error("{face} is loaded and has no area")]
    Sliver {
        /// The face.
        face: FaceId,
    },
}

impl Advice for LoadError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Profile(error) => error.advice(),
            Self::Direction { .. } => Some("give finite numbers, not all zero"),
            Self::Weight { .. } => Some("give finite weights"),
            Self::NoEdges => Some("name edges"),
            Self::AcrossAxis { .. } => Some("give an axis along the edges"),
            Self::Sliver { .. } => Some("mend the mesh"),
            Self::NoSuchVertex { .. } => None,
        }
    }
}

pub(crate) fn direction(direction: [f64; 3]) -> Result<Vector3<f64>, LoadError> {
    let [x, y, z] = direction;
    let unit = Vector3::from(direction).try_normalize(0.0);
    unit.filter(|d| d.iter().all(|c| c.is_finite()))
        .ok_or(LoadError::Direction { x, y, z })
}

/// Equal forces on some vertices, `f_v = p(t) d`: the size `p` (newtons) follows a profile, the unit vector
/// `d` is fixed in space.
///
/// ```
/// use isosheet_mesh::{MassKind, VertexId, generate};
/// use isosheet_model::{SheetModel, VertexLoad};
/// use isosheet_motion::Profile;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let sheet = generate::isotropic_square(1, 0.2)?;
/// let push = Profile::Ramp { from: 0.0, to: 2e-3, begin: 0.0, end: 0.5 };
/// let load = VertexLoad::new(sheet.topology(), &[VertexId(4)], [0.0, 0.0, 1.0], push)?;
/// let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)?.with_force(load);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct VertexLoad {
    vertices: Vec<VertexId>,
    direction: Vector3<f64>,
    size: Profile,
}

impl VertexLoad {
    /// A load on vertices of a mesh in a direction of any length; the profile gives its size on each vertex,
    /// newtons. A vertex that is named twice bears twice the load.
    ///
    /// # Errors
    /// [`LoadError`] naming the first argument that cannot be used.
    pub fn new(
        topology: &Topology,
        vertices: &[VertexId],
        along: [f64; 3],
        size: Profile,
    ) -> Result<Self, LoadError> {
        size.validate()?;
        let vertex_count = topology.vertex_count();
        if let Some(&vertex) = vertices.iter().find(|v| v.index() >= vertex_count) {
            return Err(LoadError::NoSuchVertex {
                vertex,
                vertex_count,
            });
        }
        Ok(Self {
            vertices: vertices.to_vec(),
            direction: direction(along)?,
            size,
        })
    }
}

impl Force for VertexLoad {
    fn add_force(&self, t: f64, _x: &[f64], _v: &[f64], force: &mut [f64]) {
        let load = self.size.value(t) * self.direction;
        for v in &self.vertices {
            for k in 0..3 {
                force[3 * v.index() + k] += load[k];
            }
        }
    }

    fn is_of_time_alone(&self) -> bool {
        true
    }
}

/// A uniform field of acceleration, `f_i = w_i a(t) d`: its size `a` (metres per second squared) follows a
/// profile, the unit vector `d` is fixed in space. In a frame that is shaken with the acceleration `-a(t) d`
/// this is the force of inertia.
#[derive(Debug, Clone, PartialEq)]
pub struct AccelerationField {
    weights: Vec<f64>,
    direction: Vector3<f64>,
    size: Profile,
}

impl AccelerationField {
    /// A field that acts on vertices of the given masses, kilograms (for a consistent mass matrix its row
    /// sums, see [`isosheet_mesh::MassMatrix::row_sums`]), in a direction of any length; the profile gives
    /// its size, metres per second squared.
    ///
    /// # Errors
    /// [`LoadError`] naming the first argument that cannot be used.
    pub fn new(weights: Vec<f64>, along: [f64; 3], size: Profile) -> Result<Self, LoadError> {
        size.validate()?;
        if let Some(vertex) = weights.iter().position(|w| !w.is_finite()) {
            let weight = weights[vertex];
            return Err(LoadError::Weight { vertex, weight });
        }
        Ok(Self {
            weights,
            direction: direction(along)?,
            size,
        })
    }
}

impl Force for AccelerationField {
    fn add_force(&self, t: f64, _x: &[f64], _v: &[f64], force: &mut [f64]) {
        let acceleration = self.size.value(t) * self.direction;
        for (w, row) in self.weights.iter().zip(force.as_chunks_mut::<3>().0) {
            for k in 0..3 {
                row[k] += w * acceleration[k];
            }
        }
    }

    fn is_of_time_alone(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::Sheet;

    fn triangle() -> Sheet {
        let x = vec![0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.2, 0.0];
        Sheet::new(x, &[[0, 1, 2]]).expect("a triangle")
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        let sheet = triangle();
        let load = |vertex: VertexId, along: [f64; 3], size: f64| {
            VertexLoad::new(sheet.topology(), &[vertex], along, size.into()).err()
        };
        let up = [0.0, 0.0, 1.0];
        let vertex = VertexId(99);
        let vertex_count = sheet.topology().vertex_count();
        let missing = LoadError::NoSuchVertex {
            vertex,
            vertex_count,
        };
        assert_eq!(load(vertex, up, 1.0), Some(missing));
        for along in [[0.0; 3], [f64::INFINITY, 0.0, 0.0], [f64::NAN; 3]] {
            let error = load(VertexId(0), along, 1.0);
            assert!(matches!(error, Some(LoadError::Direction { .. })));
        }
        let error = load(VertexId(0), up, f64::NAN);
        assert!(matches!(error, Some(LoadError::Profile(_))), "{error:?}");
        let error = AccelerationField::new(vec![1.0, f64::NAN], up, 1.0.into()).err();
        assert!(
            matches!(error, Some(LoadError::Weight { vertex: 1, .. })),
            "{error:?}"
        );
        assert_eq!(load(VertexId(0), up, 1.0), None);
    }
}
