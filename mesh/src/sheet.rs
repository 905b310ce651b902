//! A mesh with its rest shape.

use crate::vec3::{at, cross, norm, sub};
use crate::{EdgeId, FaceId, MeshError, Topology, VertexId};

/// A triangle mesh with its rest positions: the edge lengths and face areas that every later state keeps.
///
/// Positions are a flat array `x0 y0 z0 x1 y1 z1 ...` in metres. A sheet need not be planar or developable:
/// see [`Sheet::check_developable`].
///
/// ```
/// let sheet = isosheet_mesh::Sheet::new(
///     vec![0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 4.0, 0.0],
///     &[[0, 1, 2]],
/// )?;
/// assert_eq!(sheet.lengths(), [3.0, 4.0, 5.0]);
/// assert_eq!(sheet.area(), 6.0);
/// # Ok::<(), isosheet_mesh::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    topology: Topology,
    positions: Vec<f64>,
    lengths: Vec<f64>,
    face_areas: Vec<f64>,
}

/// Lengths outside are refused: their fourth powers (squared areas) would leave the range of `f64`.
const LENGTH_RANGE: std::ops::RangeInclusive<f64> = 1e-70..=1e70;

impl Sheet {
    /// A face whose altitude over its longest edge is less than this part of that edge is refused as having
    /// no area.
    ///
    /// The bound is relative, so it does not depend on the unit. It leaves four digits above the round-off of
    /// coordinates that are a hundred times larger than the triangle (1e-14 of its size), and is far below
    /// any triangle that can be computed with: the angles of one at the bound are known to about six digits.
    pub const MIN_RELATIVE_ALTITUDE: f64 = 1e-10;

    /// Builds a sheet from the rest positions (length 3V, metres) and the corners of its faces.
    ///
    /// # Errors
    /// [`MeshError`] when the length of `positions` is not a multiple of three, a coordinate is not finite,
    /// the faces are not an oriented surface, or a face has no area.
    pub fn new(positions: Vec<f64>, faces: &[[u32; 3]]) -> Result<Self, MeshError> {
        if !positions.len().is_multiple_of(3) {
            return Err(MeshError::WrongLength {
                got: positions.len(),
                expected: positions.len().div_ceil(3) * 3,
            });
        }
        let topology = Topology::from_faces(positions.len() / 3, faces)?;
        Self::from_topology(topology, positions)
    }

    /// Builds a sheet from a topology and rest positions.
    ///
    /// # Errors
    /// [`MeshError`] when `positions` does not have length 3V, a coordinate is not finite, or a face has no
    /// area.
    pub fn from_topology(topology: Topology, positions: Vec<f64>) -> Result<Self, MeshError> {
        check_positions(&topology, &positions)?;
        let lengths: Vec<f64> = topology
            .edges()
            .iter()
            .map(|&[a, b]| norm(sub(at(&positions, a), at(&positions, b))))
            .collect();
        let face_areas = topology
            .face_ids()
            .map(|f| face_area(&topology, &positions, &lengths, f))
            .collect::<Result<_, _>>()?;
        if let Some(k) = lengths.iter().position(|l| !LENGTH_RANGE.contains(l)) {
            return Err(MeshError::LengthOutOfRange {
                edge: EdgeId::from_index(k),
                length: lengths[k],
            });
        }
        Ok(Self {
            topology,
            positions,
            lengths,
            face_areas,
        })
    }

    /// The connectivity.
    #[inline]
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The rest positions, length 3V, in metres.
    #[inline]
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// The rest position of a vertex, in metres.
    #[inline]
    pub fn position(&self, v: VertexId) -> [f64; 3] {
        at(&self.positions, v)
    }

    /// The vertices whose rest positions (metres) meet a condition, in the order of their numbers.
    ///
    /// ```
    /// # use isosheet_mesh::generate;
    /// let sheet = generate::anisotropic_grid(4, 1, 0.4, 0.1)?;
    /// let left = sheet.vertices_where(|[x, _, _]| x < 0.15);
    /// assert_eq!(left.len(), 4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn vertices_where(&self, condition: impl Fn([f64; 3]) -> bool) -> Vec<VertexId> {
        let all = self.topology.vertex_ids();
        all.filter(|&v| condition(self.position(v))).collect()
    }

    /// The rest length of every edge, in metres.
    #[inline]
    pub fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// The area of every face, in square metres.
    #[inline]
    pub fn face_areas(&self) -> &[f64] {
        &self.face_areas
    }

    /// The area of the sheet, in square metres.
    pub fn area(&self) -> f64 {
        self.face_areas.iter().sum()
    }

    /// The mean edge length, in metres.
    pub fn mean_length(&self) -> f64 {
        self.lengths.iter().sum::<f64>() / self.lengths.len() as f64
    }

    /// The faces as index triples, as [`Sheet::new`] takes them.
    pub fn face_indices(&self) -> Vec<[u32; 3]> {
        self.topology
            .faces()
            .iter()
            .map(|f| f.map(|v| v.0))
            .collect()
    }
}

/// Refuses positions of the wrong length or with a coordinate that is not finite.
pub(crate) fn check_positions(topology: &Topology, x: &[f64]) -> Result<(), MeshError> {
    let expected = 3 * topology.vertex_count();
    if x.len() != expected {
        return Err(MeshError::WrongLength {
            got: x.len(),
            expected,
        });
    }
    match x.iter().position(|c| !c.is_finite()) {
        Some(k) => Err(MeshError::NonFinite {
            vertex: VertexId::from_index(k / 3),
            axis: k % 3,
            value: x[k],
        }),
        None => Ok(()),
    }
}

/// Area of a face. The longest edge is checked first, so that no square under- or overflows.
fn face_area(t: &Topology, x: &[f64], lengths: &[f64], f: FaceId) -> Result<f64, MeshError> {
    let edges = t.face_edges(f);
    let (side, longest) =
        edges
            .iter()
            .map(|e| lengths[e.index()])
            .enumerate()
            .fold(
                (0, 0.0),
                |best, (k, l)| if l > best.1 { (k, l) } else { best },
            );
    if longest == 0.0 {
        return Err(MeshError::ZeroAreaFace {
            face: f,
            relative_altitude: 0.0,
            longest,
            limit: Sheet::MIN_RELATIVE_ALTITUDE,
        });
    }
    if !LENGTH_RANGE.contains(&longest) {
        return Err(MeshError::LengthOutOfRange {
            edge: edges[side],
            length: longest,
        });
    }
    let [a, b, c] = t.faces()[f.index()].map(|v| at(x, v));
    let parallelogram = norm(cross(sub(b, a), sub(c, a)));
    let relative_altitude = parallelogram / (longest * longest);
    if relative_altitude < Sheet::MIN_RELATIVE_ALTITUDE {
        return Err(MeshError::ZeroAreaFace {
            face: f,
            relative_altitude,
            longest,
            limit: Sheet::MIN_RELATIVE_ALTITUDE,
        });
    }
    Ok(0.5 * parallelogram)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [f64; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.3, 0.8, 0.0];

    #[test]
    fn bad_coordinates_are_named() {
        let mut x = TRIANGLE.to_vec();
        x[7] = f64::NAN;
        let error = Sheet::new(x, &[[0, 1, 2]]).unwrap_err();
        assert!(matches!(
            error,
            MeshError::NonFinite {
                vertex: VertexId(2),
                axis: 1,
                ..
            }
        ));
        assert!(
            error
                .to_string()
                .contains("coordinate y of vertex 2 is NaN"),
            "{error}"
        );
        assert!(matches!(
            Sheet::new(TRIANGLE[..8].to_vec(), &[[0, 1, 2]]),
            Err(MeshError::WrongLength {
                got: 8,
                expected: 9
            })
        ));
        let t = Topology::from_faces(3, &[[0, 1, 2]]).unwrap();
        assert!(matches!(
            Sheet::from_topology(t, vec![0.0; 12]),
            Err(MeshError::WrongLength {
                got: 12,
                expected: 9
            })
        ));
        assert!(matches!(
            Sheet::new(TRIANGLE.to_vec(), &[[0, 1, 3]]),
            Err(MeshError::Topology(
                crate::TopologyError::IndexOutOfRange { .. }
            ))
        ));
        let mut x = TRIANGLE.to_vec();
        x[0] = 1e200;
        assert!(matches!(
            Sheet::new(x, &[[0, 1, 2]]),
            Err(MeshError::LengthOutOfRange { .. })
        ));
    }

    #[test]
    fn zero_area_is_relative() {
        for unit in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
            let x: Vec<f64> = TRIANGLE.iter().map(|c| unit * c).collect();
            let s = Sheet::new(x, &[[0, 1, 2]]).unwrap();
            assert!((s.area() / (0.4 * unit * unit) - 1.0).abs() < 1e-14);
            // Corners on a line, as well as the rounding of the coordinates allows.
            let line = vec![
                0.1 * unit,
                0.2 * unit,
                0.3 * unit,
                0.2 * unit,
                0.4 * unit,
                0.6 * unit,
                0.7 * unit,
                1.4 * unit,
                2.1 * unit,
            ];
            let error = Sheet::new(line, &[[0, 1, 2]]).unwrap_err();
            assert!(
                matches!(
                    error,
                    MeshError::ZeroAreaFace {
                        face: FaceId(0),
                        ..
                    }
                ),
                "{error}"
            );
            let same = vec![unit; 9];
            assert!(matches!(
                Sheet::new(same, &[[0, 1, 2]]),
                Err(MeshError::ZeroAreaFace { .. })
            ));
            // Two coincident corners.
            let mut x: Vec<f64> = TRIANGLE.iter().map(|c| unit * c).collect();
            x.copy_within(0..3, 3);
            assert!(matches!(
                Sheet::new(x, &[[0, 1, 2]]),
                Err(MeshError::ZeroAreaFace { .. })
            ));
            // A needle of aspect ratio 1e-6 is still a triangle.
            let mut x: Vec<f64> = TRIANGLE.iter().map(|c| unit * c).collect();
            x[7] = 1e-6 * unit;
            assert!(Sheet::new(x, &[[0, 1, 2]]).is_ok());
        }
    }

    #[test]
    fn parts_and_unions() {
        let s = crate::generate::isotropic_square(0, 1.0).unwrap();
        let moved = s.map_positions(|[x, y, z]| [x + 2.0, y, z]).unwrap();
        let both = Sheet::union(&[&s, &moved]).unwrap();
        both.topology().check_invariants();
        assert_eq!(both.topology().component_count(), 2);
        assert!((both.area() - 2.0).abs() < 1e-15);
        let second = both.keep_faces(|f| f.index() >= 8).unwrap();
        assert_eq!(second, moved);
        assert!(s.keep_faces(|_| false).is_err());
        assert!(Sheet::union(&[]).is_err());
        assert!(matches!(
            s.map_positions(|[_, y, z]| [0.0, y, z]),
            Err(MeshError::ZeroAreaFace { .. })
        ));
        assert!(matches!(
            s.map_positions(|_| [f64::NAN; 3]),
            Err(MeshError::NonFinite { .. })
        ));
        // Two triangles that meet at the centre only.
        let cross = s.keep_faces(|f| matches!(f.index(), 0 | 6));
        assert!(matches!(
            cross,
            Err(MeshError::Topology(
                crate::TopologyError::BowTieVertex { .. }
            ))
        ));
        assert_eq!(s.face_indices().len(), 8);
        assert!((s.mean_length() - (12.0 * 0.5 + 4.0 * 0.5f64.hypot(0.5)) / 16.0).abs() < 1e-15);
    }
}
