//! Surfaces of triangles, and the distances from them.

use super::contact_geometry::ContactGeometry;
use super::form::{Form, ShapeError};
use super::triangles::Triangles;
use crate::contact_mesh::{ContactMesh, ContactMeshError};
use crate::distance::{Closest, Feature, point_triangle};
use crate::signed_distance::SignedDistance;
use isosheet_mesh::Advice;
use isosheet_mesh::wording::{brief, given};
use nalgebra::{Matrix3, Vector3};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use std::collections::HashMap;
use thiserror::Error;

mod forms;
#[cfg(test)]
mod tests;

pub use forms::rounded_line;

/// A fixed set of triangles that knows its closest points.
///
/// A surface in which every edge joins two faces that run through it in opposite directions encloses
/// a solid: its distances are signed, by the angle-weighted normals of Baerentzen and Aanaes 2005.
/// Any other surface is open: its distances are not negative, and their gradient points away from it
/// on both sides.
#[derive(Clone)]
pub struct TriangleSurface {
    mesh: ContactMesh,
    positions: Vec<Vector3<f64>>,
    face_edges: Vec<[u32; 3]>,
    tree: Bvh,
    closed: bool,
    normals: Normals,
}

/// Directions of which the sign of the offset from the closest point says inside or outside.
#[derive(Debug, Clone)]
struct Normals {
    faces: Vec<Vector3<f64>>,
    edges: Vec<Vector3<f64>>,
    vertices: Vec<Vector3<f64>>,
}

/// Why triangles are no surface.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// There is no face.
    #[error("the surface has no faces")]
    Empty,
    /// The positions are no list of points.
    #[error("{0} coordinates are not three for each vertex")]
    Coordinates(usize),
    /// A coordinate is not finite.
    #[error("coordinate {axis} (0 = x) of vertex {vertex} is {value}", value = given(*value))]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// The axis.
        axis: usize,
        /// The value.
        value: f64,
    },
    /// A face names wrong vertices.
    #[error(transparent)]
    Faces(#[from] ContactMeshError),
    /// A face has no area.
    #[error("face {face} has no area")]
    NoArea {
        /// The face.
        face: usize,
    },
    /// A length of a surface made by formula is not positive.
    #[error("{name} is {value} m", value = given(*value))]
    Length {
        /// The length.
        name: &'static str,
        /// Its value, metres.
        value: f64,
    },
    /// A line or outline of which no surface can be made.
    #[error("the line is unusable at point {index}: {problem}")]
    Line {
        /// The point, from 0.
        index: usize,
        /// What is wrong there.
        problem: &'static str,
    },
    /// A closed surface is inside out.
    #[error(
        "the faces of the closed surface point inwards (volume {volume} m^3)",
        volume = brief(*volume)
    )]
    Inward {
        /// Signed volume.
        volume: f64,
    },
}

impl Advice for SurfaceError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Empty => Some("give at least one face"),
            Self::Coordinates(..) => Some("give three for each vertex"),
            Self::NotFinite { .. } => Some("give finite coordinates"),
            Self::Faces(error) => error.advice(),
            Self::NoArea { .. } => Some("remove it or merge its vertices"),
            Self::Length { .. } => Some("give a positive length"),
            Self::Inward { .. } => Some("reverse them"),
            Self::Line { .. } => None,
        }
    }
}

/// Sine of the smallest angle below which a face has no usable normal: 1e4 units of round-off.
const FLAT_SINE: f64 = 1e4 * f64::EPSILON;

/// Distance from an edge or corner, over the size of the coordinates, that is round-off: its direction says
/// nothing.
const ON_SURFACE: f64 = 4.0 * f64::EPSILON;

impl std::fmt::Debug for TriangleSurface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TriangleSurface")
            .field("vertices", &self.positions.len())
            .field("faces", &self.mesh.faces().len())
            .field("closed", &self.is_closed())
            .finish_non_exhaustive()
    }
}

impl TriangleSurface {
    /// From `positions` (three per vertex, metres) and `faces`, counter-clockwise seen from outside.
    ///
    /// # Errors
    /// [`SurfaceError`] naming the first vertex or face that cannot be used.
    pub fn new(positions: &[f64], faces: &[[u32; 3]]) -> Result<Self, SurfaceError> {
        let (points, []) = positions.as_chunks::<3>() else {
            return Err(SurfaceError::Coordinates(positions.len()));
        };
        if faces.is_empty() {
            return Err(SurfaceError::Empty);
        }
        for (vertex, p) in points.iter().enumerate() {
            if let Some(axis) = p.iter().position(|c| !c.is_finite()) {
                let value = p[axis];
                return Err(SurfaceError::NotFinite {
                    vertex,
                    axis,
                    value,
                });
            }
        }
        let points: Vec<Vector3<f64>> = points.iter().map(|p| Vector3::from(*p)).collect();
        let mesh = ContactMesh::from_triangles(points.len(), faces)?;
        let mut normals = Vec::with_capacity(faces.len());
        for (face, f) in faces.iter().enumerate() {
            let [a, b, c] = f.map(|v| points[v as usize]);
            let (u, v) = (b - a, c - a);
            let n = u.cross(&v);
            let size = n.norm();
            let longest = u.norm().max(v.norm()).max((c - b).norm());
            // Twice the area over the longest side is the height.
            if size <= FLAT_SINE * longest * longest || size == 0.0 {
                return Err(SurfaceError::NoArea { face });
            }
            normals.push(n / size);
        }
        let numbers: HashMap<[u32; 2], u32> = (0..)
            .zip(mesh.edges())
            .map(|(e, &[a, b])| ([a.min(b), a.max(b)], e))
            .collect();
        let face_edges: Vec<[u32; 3]> = faces
            .iter()
            .map(|f| {
                std::array::from_fn(|k| {
                    let (a, b) = (f[k], f[(k + 1) % 3]);
                    numbers[&[a.min(b), a.max(b)]]
                })
            })
            .collect();
        let closed = is_closed(&mesh, &face_edges);
        if closed {
            let volume = volume(&points, faces);
            if volume <= 0.0 {
                return Err(SurfaceError::Inward { volume });
            }
        }
        let boxes: Vec<Aabb> = faces
            .iter()
            .map(|f| {
                let corners = f.map(|v| points[v as usize]);
                let fold = |g: fn(f64, f64) -> f64| {
                    let [a, b, c] = corners;
                    Vector::from(std::array::from_fn(|k| g(g(a[k], b[k]), c[k])))
                };
                Aabb::new(fold(f64::min), fold(f64::max))
            })
            .collect();
        Ok(Self {
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes),
            normals: Normals::new(&mesh, &points, &face_edges, normals),
            closed,
            face_edges,
            positions: points,
            mesh,
        })
    }

    /// The primitives.
    pub fn mesh(&self) -> &ContactMesh {
        &self.mesh
    }

    /// Positions of the vertices, metres.
    pub fn positions(&self) -> &[Vector3<f64>] {
        &self.positions
    }

    /// Whether the surface encloses a solid, so that distances have a sign.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The face closest to `p` and where on it; `None` if `p` is not a number.
    pub fn closest(&self, p: &Vector3<f64>) -> Option<(u32, Closest<4>)> {
        let to_box = |node: &parry3d_f64::partitioning::BvhNode, _: f64| {
            let (low, high) = (node.mins(), node.maxs());
            let over = |x: f64, low: f64, high: f64| (low - x).max(x - high).max(0.0);
            let d = Vector3::new(
                over(p.x, low.x, high.x),
                over(p.y, low.y, high.y),
                over(p.z, low.z, high.z),
            );
            d.norm_squared()
        };
        let best = self.tree.find_best(f64::INFINITY, to_box, |face, _| {
            let closest = point_triangle(&self.stencil(p, face));
            Some((closest.distance2, closest))
        });
        best.map(|(face, (_, closest))| (face, closest))
    }

    fn stencil(&self, p: &Vector3<f64>, face: u32) -> [Vector3<f64>; 4] {
        let [a, b, c] = self.mesh.faces()[face as usize].map(|v| self.positions[v as usize]);
        [*p, a, b, c]
    }

    /// Distance of `p` with derivatives, signed if the surface is closed. Not a number if `p` is
    /// not.
    pub fn signed_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        let distance = self.oriented_distance(p);
        if self.closed || distance.value > 0.0 || distance.value.is_nan() {
            return distance;
        }
        // On an open surface: any of its sides.
        let side = if distance.value < 0.0 { -1.0 } else { 1.0 };
        SignedDistance {
            value: side * distance.value,
            normal: side * distance.normal,
            hessian: side * distance.hessian,
        }
    }

    /// Distance of `p` with derivatives, negative on the side that the face normals point away from, of an
    /// open surface too. Smooth across the faces; beyond the rim of an open surface it is the distance from
    /// the rim, and changes sign with a jump where the surface would go on. Not a number if `p` is not.
    pub fn oriented_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        let Some((face, closest)) = self.closest(p) else {
            return SignedDistance {
                value: f64::NAN,
                normal: Vector3::repeat(f64::NAN),
                hessian: Matrix3::repeat(f64::NAN),
            };
        };
        let direction = match closest.feature {
            Feature::PointPoint { second, .. } => {
                self.normals.vertices[self.mesh.faces()[face as usize][second - 1] as usize]
            }
            Feature::PointEdge { edge, .. } => {
                self.normals.edges[self.face_edges[face as usize][edge[0] - 1] as usize]
            }
            _ => self.normals.faces[face as usize],
        };
        if closest.feature == Feature::PointTriangle {
            // Without a division by the distance, which may be zero.
            let corner = self.positions[self.mesh.faces()[face as usize][0] as usize];
            return SignedDistance {
                value: direction.dot(&(p - corner)),
                normal: direction,
                hessian: Matrix3::zeros(),
            };
        }
        let d = closest.distance();
        if d <= ON_SURFACE * p.amax() {
            // The offset is round-off: the normal of the feature.
            return SignedDistance {
                value: 0.0,
                normal: direction.normalize(),
                hessian: Matrix3::zeros(),
            };
        }
        let sign = if direction.dot(&closest.difference) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let n = closest.difference / d;
        let square = closest.jet(&self.stencil(p, face)).hessian[0][0];
        SignedDistance {
            value: sign * d,
            normal: sign * n,
            // Of the root of the squared distance.
            hessian: sign * (0.5 * square - n * n.transpose()) / d,
        }
    }
}

impl Form for TriangleSurface {
    fn name(&self) -> &'static str {
        "surface"
    }

    fn signed_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        self.signed_distance(p)
    }

    fn oriented_distance(&self, p: &Vector3<f64>) -> SignedDistance {
        self.oriented_distance(p)
    }

    /// Its own, whatever the number of sides.
    fn triangles(&self, _: usize) -> Result<Option<Triangles>, ShapeError> {
        Ok(Some(Triangles {
            points: self.positions.iter().map(|p| (*p).into()).collect(),
            faces: self.mesh.faces().to_vec(),
        }))
    }

    fn contact_geometry(&self, _: usize) -> Result<Option<ContactGeometry>, ShapeError> {
        Ok(Some(ContactGeometry {
            mesh: self.mesh.clone(),
            positions: self.positions.iter().flatten().copied().collect(),
            radius: 0.0,
        }))
    }

    fn bounds(&self) -> Option<[Vector3<f64>; 2]> {
        let points = || self.positions.iter().copied();
        let low = points().reduce(|a, b| a.inf(&b))?;
        Some([low, points().reduce(|a, b| a.sup(&b))?])
    }

    fn is_solid(&self) -> bool {
        self.is_closed()
    }
}

impl Normals {
    fn new(
        mesh: &ContactMesh,
        points: &[Vector3<f64>],
        face_edges: &[[u32; 3]],
        faces: Vec<Vector3<f64>>,
    ) -> Self {
        let mut edges = vec![Vector3::zeros(); mesh.edges().len()];
        let mut vertices = vec![Vector3::zeros(); points.len()];
        for ((corners, sides), n) in mesh.faces().iter().zip(face_edges).zip(&faces) {
            for k in 0..3 {
                edges[sides[k] as usize] += n;
                let [p, q, r] = [0, 1, 2].map(|i| points[corners[(k + i) % 3] as usize]);
                let (u, v) = (q - p, r - p);
                vertices[corners[k] as usize] += u.cross(&v).norm().atan2(u.dot(&v)) * n;
            }
        }
        Self {
            faces,
            edges,
            vertices,
        }
    }
}

/// Whether every edge is run through once in each direction.
fn is_closed(mesh: &ContactMesh, face_edges: &[[u32; 3]]) -> bool {
    let mut uses = vec![[0_u32; 2]; mesh.edges().len()];
    for (corners, sides) in mesh.faces().iter().zip(face_edges) {
        for k in 0..3 {
            let e = sides[k] as usize;
            uses[e][usize::from(mesh.edges()[e][0] != corners[k])] += 1;
        }
    }
    uses.iter().all(|u| *u == [1, 1])
}

/// Signed volume enclosed by a closed surface.
fn volume(points: &[Vector3<f64>], faces: &[[u32; 3]]) -> f64 {
    // About one of its points, so that the place does not matter.
    let origin = points[faces[0][0] as usize];
    faces
        .iter()
        .map(|f| {
            let [a, b, c] = f.map(|v| points[v as usize] - origin);
            a.dot(&b.cross(&c)) / 6.0
        })
        .sum()
}
