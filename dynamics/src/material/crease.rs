//! Torsion springs at the edges: creases that are folded by driven rest angles, and the bending stiffness of
//! the material.

use crate::motion::profile::{Profile, ProfileError};
use crate::vectors::point;
use crate::{HessianSink, Potential};
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, EdgeId, Sheet, Topology, VertexId};
use nalgebra::Vector3;
use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};
use std::fmt;
use std::sync::Arc;

/// The fold angle at which a spring exerts no moment, radians: positive for a valley as seen from the side
/// from which faces are counter-clockwise, negative for a mountain (the sign of
/// [`isosheet_mesh::fold_angle`]).
///
/// Made from a number, a [`Profile`], or a function of time (seconds). A crease whose rest angle changes is
/// driven.
#[derive(Clone)]
pub enum RestAngle {
    /// By a profile, radians: data that can be written and read.
    Profile(Profile),
    /// Any function of time (seconds).
    Custom(Arc<dyn Fn(f64) -> f64 + Send + Sync>),
}

impl From<Profile> for RestAngle {
    fn from(profile: Profile) -> Self {
        Self::Profile(profile)
    }
}

impl From<f64> for RestAngle {
    fn from(angle: f64) -> Self {
        Self::Profile(angle.into())
    }
}

impl<F: Fn(f64) -> f64 + Send + Sync + 'static> From<F> for RestAngle {
    fn from(angle: F) -> Self {
        Self::Custom(Arc::new(angle))
    }
}

impl RestAngle {
    /// The angle at time `t`, radians.
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Self::Profile(profile) => profile.value(t),
            Self::Custom(angle) => angle(t),
        }
    }

    /// Whether it may change.
    fn is_driven(&self) -> bool {
        match self {
            Self::Profile(profile) => !profile.is_constant(),
            Self::Custom(_) => true,
        }
    }

    /// A constant angle lies between a fold shut as a mountain and one shut as a valley; a driven one may
    /// pass both.
    fn validate(&self, edge: EdgeId) -> Result<(), CreaseError> {
        let Self::Profile(profile) = self else {
            return Ok(());
        };
        profile
            .validate()
            .map_err(|source| CreaseError::RestAngle { edge, source })?;
        match profile {
            Profile::Constant(value) if !(-PI..=PI).contains(value) => {
                let angle = *value;
                Err(CreaseError::Angle { edge, angle })
            }
            _ => Ok(()),
        }
    }
}

impl fmt::Debug for RestAngle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Profile(profile) => profile.fmt(f),
            Self::Custom(_) => f.write_str("Custom"),
        }
    }
}

/// A torsion spring at an interior edge.
#[derive(Debug)]
pub struct CreaseSpring {
    /// The edge.
    pub edge: EdgeId,
    /// Torsional stiffness `k` of the whole edge, newton metres per radian.
    pub stiffness: f64,
    /// The angle at which it exerts no moment.
    pub rest: RestAngle,
}

impl CreaseSpring {
    /// Makes springs those of creases in a sheet with bending stiffness, in place: a crease replaces what
    /// resists bending at its edge.
    ///
    /// The dihedral angle of the two faces at an edge is the fold of the crease and the bend of the sheet over
    /// these faces, `theta = theta_c + M / k_s`, with the stiffness `k_s = D l_e^2 / A_e` of the sheet
    /// ([`CreaseSprings::bending`]). Springs of stiffness `k_i` at the edge, which carry the moment `M = sum k_i
    /// (rest_i - theta_c)` together, act on that angle with `k_i k_s / (k_s + sum k_i)`: springs in series. A
    /// sheet that nothing loads rests at the rest angle of its crease, flat on both sides; a crease that is much
    /// stiffer than the sheet bends like the sheet. The sheet itself is made without stiffness at these edges
    /// ([`CreaseSprings::bending_beside`], [`PlateBending::creased`](crate::PlateBending::creased)).
    ///
    /// `rigidity` is the flexural rigidity `D` in newton metres; with zero the springs stay as they are.
    pub fn put_in_sheet<'a>(
        springs: impl IntoIterator<Item = &'a mut Self>,
        sheet: &Sheet,
        rigidity: f64,
    ) {
        if rigidity == 0.0 {
            return;
        }
        let springs: Vec<&mut Self> = springs.into_iter().collect();
        let mut sums = vec![0.0; sheet.topology().edge_count()];
        for spring in &springs {
            if let Some(sum) = sums.get_mut(spring.edge.index()) {
                *sum += spring.stiffness;
            }
        }
        for spring in springs {
            let sum = sums.get(spring.edge.index());
            if let Some((sum, own)) = sum.zip(sheet_stiffness(sheet, rigidity, spring.edge)) {
                spring.stiffness *= own / (own + sum);
            }
        }
    }
}

/// The stiffness `D l_e^2 / A_e` of a sheet across an edge, newton metres per radian; nothing where there is
/// one face or no edge.
fn sheet_stiffness(sheet: &Sheet, rigidity: f64, edge: EdgeId) -> Option<f64> {
    let length = sheet.lengths().get(edge.index())?;
    let [Some(left), Some(right)] = sheet.topology().edge_faces(edge) else {
        return None;
    };
    let area = sheet.face_areas()[left.index()] + sheet.face_areas()[right.index()];
    Some(rigidity * length.powi(2) / area)
}

/// Why springs cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CreaseError {
    /// An edge does not exist or has one face only.
    #[error("{edge} has no fold angle")]
    NotInterior {
        /// The edge.
        edge: EdgeId,
    },
    /// A stiffness is negative or not finite.
    #[error("the spring at {edge} has stiffness {stiffness} N m", stiffness = given(*stiffness))]
    Stiffness {
        /// The edge.
        edge: EdgeId,
        /// The stiffness given, N m/rad.
        stiffness: f64,
    },
    /// The profile of a rest angle cannot be used.
    #[error("the rest angle of the spring at {edge} cannot be used: {source}")]
    RestAngle {
        /// The edge.
        edge: EdgeId,
        /// What is wrong with its profile.
        source: ProfileError,
    },
    /// A constant rest angle is beyond a fold that is shut.
    #[error("the spring at {edge} rests at {angle} rad", angle = given(*angle))]
    Angle {
        /// The edge.
        edge: EdgeId,
        /// The angle given, radians.
        angle: f64,
    },
    /// A flexural rigidity is negative or not finite.
    #[error("the flexural rigidity is {rigidity} N m", rigidity = given(*rigidity))]
    Rigidity {
        /// The rigidity given, N m.
        rigidity: f64,
    },
}

impl Advice for CreaseError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NotInterior { .. } => Some("put springs on edges between two faces"),
            Self::Stiffness { .. } | Self::Rigidity { .. } => {
                Some("give a finite one of at least 0")
            }
            Self::RestAngle { source, .. } => source.advice(),
            Self::Angle { .. } => Some("give an angle from -pi to pi"),
        }
    }
}

/// Torsion springs at edges, with the energy
///
/// ```text
/// V(t, x) = sum_e k_e / 2 [theta_e(x) - rest_e(t)]^2,
/// ```
///
/// `theta_e` the fold angle of edge `e` in radians. The difference is taken the short way round, so an angle
/// that passes pi (a fold shut) stays continuous; the energy has a kink only half a turn away from the rest
/// angle.
///
/// In a flat sheet the force is normal to it, upwards or downwards by the sign of the rest angle: the
/// assignment of mountains and valleys chooses the branch, no perturbation is needed.
///
/// The work of driving a rest angle, the integral of `dV/dt` at fixed positions, enters the energy balance.
/// The derivatives of the angle are those of Bridson, Marino and Fedkiw, *Simulation of clothing with folds
/// and wrinkles* (2003), Eq. 3; of the Hessian the semidefinite part `k grad theta grad theta^T` is given,
/// exact where the spring is at rest.
#[derive(Debug)]
pub struct CreaseSprings {
    hinges: Vec<Hinge>,
}

#[derive(Debug)]
struct Hinge {
    /// First and second end, opposite vertex of the left and of the right face.
    vertices: [VertexId; 4],
    /// The edges between pairs of these, with the places of their first and second end.
    edges: [(EdgeId, usize, usize); 5],
    stiffness: f64,
    rest: RestAngle,
}

impl CreaseSprings {
    /// Springs on a mesh.
    ///
    /// # Errors
    /// [`CreaseError`] naming the first edge that has no fold angle, or whose stiffness or rest angle cannot
    /// be used.
    pub fn new(topology: &Topology, springs: Vec<CreaseSpring>) -> Result<Self, CreaseError> {
        let hinges = springs.into_iter().map(|s| Hinge::new(topology, s));
        Ok(Self {
            hinges: hinges.collect::<Result<_, _>>()?,
        })
    }

    /// The bending stiffness of a uniform material on all interior edges, at rest when flat:
    /// `k_e = D l_e^2 / A_e` with the flexural rigidity `D` (newton metres; office paper has about 5e-4) and
    /// the area `A_e` of the two faces.
    ///
    /// On a union-jack grid of squares a bend along grid lines has exactly the energy `D kappa^2 / 2` per
    /// area, one along diagonals twice that. A sheet of rigid rods bends at its edges only: how stiff it is
    /// in other directions depends on the mesh.
    ///
    /// # Errors
    /// [`CreaseError::Rigidity`].
    pub fn bending(sheet: &Sheet, rigidity: f64) -> Result<Self, CreaseError> {
        Self::bending_beside(sheet, rigidity, &[])
    }

    /// As [`CreaseSprings::bending`], without springs at the edges of creases, where the springs of
    /// [`CreaseSpring::put_in_sheet`] take their place.
    ///
    /// # Errors
    /// [`CreaseError::Rigidity`].
    pub fn bending_beside(
        sheet: &Sheet,
        rigidity: f64,
        creases: &[EdgeId],
    ) -> Result<Self, CreaseError> {
        if !(rigidity.is_finite() && rigidity >= 0.0) {
            return Err(CreaseError::Rigidity { rigidity });
        }
        let t = sheet.topology();
        let creases: BTreeSet<EdgeId> = creases.iter().copied().collect();
        let beside = t.edge_ids().filter(|edge| !creases.contains(edge));
        let springs = beside.filter_map(|edge| {
            Some(CreaseSpring {
                edge,
                stiffness: sheet_stiffness(sheet, rigidity, edge)?,
                rest: 0.0.into(),
            })
        });
        Self::new(t, springs.collect())
    }

    /// Moments `k (rest - theta)` of the springs at time `t` and positions `x`, newton metres, in the order
    /// given: positive where a spring folds towards a valley.
    pub fn moments(&self, t: f64, x: &[f64]) -> Vec<f64> {
        let moment = |h: &Hinge| -h.stiffness * h.excess(t, Fold::at(x, &h.vertices).angle());
        self.hinges.iter().map(moment).collect()
    }
}

impl Hinge {
    fn new(topology: &Topology, spring: CreaseSpring) -> Result<Self, CreaseError> {
        let CreaseSpring {
            edge,
            stiffness,
            rest,
        } = spring;
        if edge.index() >= topology.edge_count() {
            return Err(CreaseError::NotInterior { edge });
        }
        let [Some(left), Some(right)] = topology.opposite_vertices(edge) else {
            return Err(CreaseError::NotInterior { edge });
        };
        if !(stiffness.is_finite() && stiffness >= 0.0) {
            return Err(CreaseError::Stiffness { edge, stiffness });
        }
        rest.validate(edge)?;
        let [a, b] = topology.edges()[edge.index()];
        let vertices = [a, b, left, right];
        let between = |i: usize, j: usize| {
            let e = topology.find_edge(vertices[i], vertices[j]);
            let e = e.expect("two corners of a face share an edge");
            if topology.edges()[e.index()][0] == vertices[i] {
                (e, i, j)
            } else {
                (e, j, i)
            }
        };
        Ok(Self {
            vertices,
            edges: [(0, 1), (0, 2), (1, 2), (0, 3), (1, 3)].map(|(i, j)| between(i, j)),
            stiffness,
            rest,
        })
    }

    /// `theta - rest`, the short way round.
    fn excess(&self, t: f64, theta: f64) -> f64 {
        let d = theta - self.rest.at(t);
        if d.abs() <= PI {
            return d;
        }
        d - TAU * (d / TAU).round()
    }
}

/// The two faces at an edge.
struct Fold {
    along: Vector3<f64>,
    to_left: Vector3<f64>,
    to_right: Vector3<f64>,
    /// Normals of the left and of the right face, twice their areas long.
    left: Vector3<f64>,
    right: Vector3<f64>,
}

impl Fold {
    fn at(x: &[f64], vertices: &[VertexId; 4]) -> Self {
        let [a, b, l, r] = vertices;
        let [a, b, l, r] = [point(x, *a), point(x, *b), point(x, *l), point(x, *r)];
        let (along, to_left, to_right) = (b - a, l - a, r - a);
        Self {
            left: along.cross(&to_left),
            right: to_right.cross(&along),
            along,
            to_left,
            to_right,
        }
    }

    /// The fold angle.
    fn angle(&self) -> f64 {
        let sine = self.right.cross(&self.left).dot(&self.along) / self.along.norm();
        sine.atan2(self.left.dot(&self.right))
    }

    /// The derivatives of the fold angle by the two ends and the two opposite vertices.
    fn gradient(&self) -> [Vector3<f64>; 4] {
        let squared = self.along.norm_squared();
        let length = squared.sqrt();
        // Per unit of height of an opposite vertex the angle grows by the inverse of its distance from the
        // edge.
        let (g_l, g_r) = (
            self.left * (length / self.left.norm_squared()),
            self.right * (length / self.right.norm_squared()),
        );
        let s_l = self.to_left.dot(&self.along) / squared;
        let s_r = self.to_right.dot(&self.along) / squared;
        [
            (s_l - 1.0) * g_l + (s_r - 1.0) * g_r,
            -s_l * g_l - s_r * g_r,
            g_l,
            g_r,
        ]
    }
}

impl Potential for CreaseSprings {
    fn energy(&self, t: f64, x: &[f64]) -> f64 {
        let energy = |h: &Hinge| {
            let excess = h.excess(t, Fold::at(x, &h.vertices).angle());
            0.5 * h.stiffness * excess * excess
        };
        self.hinges.iter().map(energy).sum()
    }

    fn add_gradient(&self, t: f64, x: &[f64], gradient: &mut [f64]) {
        for h in &self.hinges {
            let fold = Fold::at(x, &h.vertices);
            let moment = h.stiffness * h.excess(t, fold.angle());
            for (v, g) in h.vertices.iter().zip(&fold.gradient()) {
                for k in 0..3 {
                    gradient[3 * v.index() + k] += moment * g[k];
                }
            }
        }
    }

    fn add_hessian(&self, _t: f64, x: &[f64], hessian: &mut dyn HessianSink) {
        for h in &self.hinges {
            let g = Fold::at(x, &h.vertices).gradient();
            let block = |i: usize, j: usize| h.stiffness * g[i] * g[j].transpose();
            for (i, &v) in h.vertices.iter().enumerate() {
                hessian.add_vertex(v, &block(i, i));
            }
            for &(e, i, j) in &h.edges {
                hessian.add_edge(e, &block(i, j));
            }
            hessian.add_pair(h.vertices[2], h.vertices[3], &block(2, 3));
        }
    }

    fn couplings(&self) -> Vec<[VertexId; 2]> {
        self.hinges
            .iter()
            .map(|h| [h.vertices[2], h.vertices[3]])
            .collect()
    }

    fn is_driven(&self) -> bool {
        self.hinges.iter().any(|h| h.rest.is_driven())
    }
}

#[cfg(test)]
mod tests;
