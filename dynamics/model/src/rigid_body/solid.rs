//! Solids by their surfaces.

use isosheet_mesh::wording::brief;
use isosheet_mesh::{Advice, EdgeId, FaceId, Sheet, VertexId};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// What a closed surface of triangles encloses. Volume, centre and second moments are integrals over the
/// surface, by the divergence theorem; a cavity is a part of the surface inside of another one, with normals
/// that point into the cavity.
#[derive(Debug, Clone)]
pub struct Solid {
    surface: Sheet,
    volume: f64,
    centre: Vector3<f64>,
    second_moments: Matrix3<f64>,
}

/// Why a surface encloses no solid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolidError {
    /// The surface has a boundary.
    #[error("the surface is open at {edge}, between {} and {}", ends[0], ends[1])]
    Open {
        /// An edge of one face.
        edge: EdgeId,
        /// Its ends.
        ends: [VertexId; 2],
    },
    /// A part of the surface is inside out, or lies in another part without being a cavity of it.
    #[error(
        "the part of the surface with {face} has its normals inside (its volume is {volume} m3, and it is inside \
         of {around} other parts)",
        volume = brief(*volume)
    )]
    Inward {
        /// A face of the part.
        face: FaceId,
        /// The volume that it encloses, with the sign of its normals.
        volume: f64,
        /// In how many other parts it is.
        around: i64,
    },
}

impl Advice for SolidError {
    fn advice(&self) -> Option<&'static str> {
        Some(match self {
            Self::Open { .. } => "close the surface there",
            Self::Inward { .. } => {
                "number the corners of its faces counter-clockwise as seen from outside of the material"
            }
        })
    }
}

impl Solid {
    /// The solid in a surface whose faces are counter-clockwise as seen from outside.
    ///
    /// # Errors
    /// [`SolidError`] if the surface is open, or a part of it is inside out.
    pub fn new(surface: Sheet) -> Result<Self, SolidError> {
        let t = surface.topology();
        if let Some(edge) = t.edge_ids().find(|e| t.is_boundary_edge(*e)) {
            let ends = t.edges()[edge.index()];
            return Err(SolidError::Open { edge, ends });
        }
        check_parts(&surface)?;
        // About a point of the surface, so that its place does not matter.
        let origin = Vector3::from(surface.position(VertexId(0)));
        let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
        for corners in corners(&surface) {
            // A tetrahedron with its tip at the origin: the means of `r` and `r r^T` over it are `s / 4` and
            // `(s s^T + sum_i r_i r_i^T) / 20` with the sum `s` of its corners.
            let [a, b, c] = corners.map(|p| p - origin);
            let own = a.dot(&b.cross(&c)) / 6.0;
            let sum = a + b + c;
            volume += own;
            first += own / 4.0 * sum;
            let squares = [a, b, c].map(|r| r * r.transpose());
            second += own / 20.0 * (sum * sum.transpose() + squares[0] + squares[1] + squares[2]);
        }
        let middle = first / volume;
        let second = second - volume * middle * middle.transpose();
        Ok(Self {
            volume,
            centre: origin + middle,
            second_moments: 0.5 * (second + second.transpose()),
            surface,
        })
    }

    /// The surface.
    pub fn surface(&self) -> &Sheet {
        &self.surface
    }

    /// Volume, cubic metres.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Centre of the volume, metres.
    pub fn centre(&self) -> [f64; 3] {
        self.centre.into()
    }

    /// Second moments of the volume about its centre, `integral (r - c)(r - c)^T`, m5.
    pub fn second_moments(&self) -> [[f64; 3]; 3] {
        self.second_moments.into()
    }

    /// Whether a point (metres) is inside of the solid.
    pub fn contains(&self, point: [f64; 3]) -> bool {
        winding(corners(&self.surface), &point.into()) > 0
    }
}

/// The corners of the faces.
fn corners(surface: &Sheet) -> impl Iterator<Item = [Vector3<f64>; 3]> {
    let faces = surface.topology().faces().iter();
    faces.map(|face| face.map(|v| Vector3::from(surface.position(v))))
}

/// How often faces enclose a point that is not on them: the sum of the solid angles at which they are seen
/// (van Oosterom and Strackee, *The solid angle of a plane triangle*, IEEE Trans. Biomed. Eng. 30, 1983).
fn winding(faces: impl Iterator<Item = [Vector3<f64>; 3]>, point: &Vector3<f64>) -> i64 {
    let half_angle = |corners: [Vector3<f64>; 3]| {
        let [a, b, c] = corners.map(|p| p - point);
        let [x, y, z] = [a, b, c].map(|r| r.norm());
        let across = a.dot(&b.cross(&c));
        let along = x * y * z + a.dot(&b) * z + b.dot(&c) * x + c.dot(&a) * y;
        across.atan2(along)
    };
    (faces.map(half_angle).sum::<f64>() / TAU).round() as i64
}

/// Every part of a surface encloses either a solid in free space, or a cavity in one.
fn check_parts(surface: &Sheet) -> Result<(), SolidError> {
    let t = surface.topology();
    let parts = t.components();
    let mut part_of = vec![0; t.vertex_count()];
    for (number, vertices) in parts.iter().enumerate() {
        for v in vertices {
            part_of[v.index()] = number;
        }
    }
    let part_of_face = |f: FaceId| part_of[t.faces()[f.index()][0].index()];
    let faces: Vec<_> = t.face_ids().zip(corners(surface)).collect();
    for (number, vertices) in parts.iter().enumerate() {
        let (own, others): (Vec<_>, Vec<_>) = faces
            .iter()
            .copied()
            .partition(|(f, _)| part_of_face(*f) == number);
        let Some(&(face, _)) = own.first() else {
            continue;
        };
        let origin = Vector3::from(surface.position(vertices[0]));
        let around = winding(others.into_iter().map(|(_, corners)| corners), &origin);
        let own = own
            .into_iter()
            .map(|(_, corners)| corners.map(|p| p - origin));
        let volume = own.map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum::<f64>();
        let is_right = if volume > 0.0 {
            around == 0
        } else {
            around == 1 && volume < 0.0
        };
        if !is_right {
            return Err(SolidError::Inward {
                face,
                volume,
                around,
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACES: [[u32; 3]; 12] = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];

    /// Boxes with their middles and sides; those with the sign -1 inside out.
    fn boxes(list: &[([f64; 3], [f64; 3], i8)]) -> Sheet {
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        for (k, (middle, sides, sign)) in list.iter().enumerate() {
            for i in 0..8_u32 {
                let side = |axis: usize| if i >> axis & 1 == 0 { -0.5 } else { 0.5 };
                positions.extend((0..3).map(|axis| middle[axis] + side(axis) * sides[axis]));
            }
            let first = 8 * k as u32;
            faces.extend(FACES.map(|[a, b, c]| match sign {
                1 => [a, b, c].map(|v| v + first),
                _ => [a, c, b].map(|v| v + first),
            }));
        }
        Sheet::new(positions, &faces).unwrap()
    }

    /// A box of 1 x 2 x 3 with a cavity of 0.5 x 0.5 x 1 beside its middle, far from the origin.
    #[test]
    fn moments_are_those_of_a_box_less_a_cavity() {
        let at = [10.0, -20.0, 30.0];
        let hole = [10.1, -20.3, 30.5];
        let (sides, hollow) = ([1.0, 2.0, 3.0], [0.5, 0.5, 1.0]);
        let solid = Solid::new(boxes(&[(at, sides, 1), (hole, hollow, -1)])).unwrap();
        let volume = 6.0 - 0.25;
        assert!((solid.volume() - volume).abs() < 1e-12);
        let [at, hole] = [at, hole].map(Vector3::from);
        let centre = (6.0 * at - 0.25 * hole) / volume;
        assert!((Vector3::from(solid.centre()) - centre).norm() < 1e-12);
        let own = |volume: f64, sides: [f64; 3], middle: Vector3<f64>| {
            let r = middle - centre;
            let own = Matrix3::from_diagonal(&Vector3::from(sides).map(|a: f64| a * a / 12.0));
            volume * (own + r * r.transpose())
        };
        let expected = own(6.0, sides, at) - own(0.25, hollow, hole);
        let error = Matrix3::from(solid.second_moments()) - expected;
        assert!(error.norm() < 1e-11, "{error}");
        // Inside, in the cavity, outside.
        let is_in =
            [[10.0, -20.0, 29.0], hole.into(), [10.6, -20.0, 30.0]].map(|p| solid.contains(p));
        assert_eq!(is_in, [true, false, false]);
    }

    #[test]
    fn surfaces_that_enclose_nothing_are_refused() {
        let unit = ([0.0; 3], [1.0; 3], 1);
        let error = |list: &[_]| Solid::new(boxes(list)).unwrap_err();
        let inward = |error, part: usize| matches!(error, SolidError::Inward { face, .. } if face.index() == 12 * part);
        assert!(inward(error(&[([0.0; 3], [1.0; 3], -1)]), 0));
        // Beside another one: the sum of the volumes is positive.
        assert!(inward(error(&[unit, ([2.0, 0.0, 0.0], [0.5; 3], -1)]), 1));
        // A solid in a solid is there twice.
        assert!(inward(error(&[unit, ([0.0; 3], [0.5; 3], 1)]), 1));
        let mut open = FACES.to_vec();
        open.pop();
        let positions = boxes(&[unit]).positions().to_vec();
        let open = Solid::new(Sheet::new(positions, &open).unwrap()).unwrap_err();
        assert!(matches!(open, SolidError::Open { .. }), "{open}");
    }
}
