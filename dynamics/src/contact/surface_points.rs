//! The points between which contact acts, as linear combinations of vertices.

use super::CouplingSink;
use isosheet_mesh::{Advice, VertexId};
use isosheet_model::CarriedPoint;
use nalgebra::Matrix3;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The points of the surface on which contact acts, `X_p = sum_k b_pk x_k` with the vertices `x_k` of a
/// model: first vertices themselves, by their numbers, then points that vertices carry, such as points of the
/// surface of a rigid body by the four vertices of its [tetrahedron](crate::RigidBody).
///
/// With the constant matrix `B` of the weights forces on the vertices are `B^T` times those on the points,
/// and second derivatives `B^T H B`; straight motions of the vertices are straight motions of the points, so
/// that what is proven about the latter holds for the former.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePoints {
    model_vertices: usize,
    own: usize,
    carried: Vec<CarriedPoint>,
}

/// Why points cannot be carried.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfacePointsError {
    /// A vertex does not exist.
    #[error("point {point} is carried by {vertex} of {count} vertices")]
    Vertex {
        /// The number of the point on the surface.
        point: usize,
        /// The vertex.
        vertex: VertexId,
        /// How many there are.
        count: usize,
    },
    /// The weights of a point do not add up to one.
    #[error("the weights of point {point} add up to {sum}")]
    Weights {
        /// The number of the point on the surface.
        point: usize,
        /// Their sum.
        sum: f64,
    },
}

impl Advice for SurfacePointsError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Vertex { .. } => Some("number the vertices of the model from 0"),
            Self::Weights { .. } => Some("give barycentric coordinates"),
        }
    }
}

/// Deviation of a sum of four weights from one that is round-off, relative to the sum of their magnitudes.
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

impl SurfacePoints {
    /// The vertices `0..own` of a model with so many vertices, and the points `carried`.
    ///
    /// # Errors
    /// [`SurfacePointsError`].
    ///
    /// # Panics
    /// If there are more own points than vertices.
    pub fn new(
        model_vertices: usize,
        own: usize,
        carried: Vec<CarriedPoint>,
    ) -> Result<Self, SurfacePointsError> {
        assert!(
            own <= model_vertices,
            "own points are vertices of the model"
        );
        for (point, carriers) in (own..).zip(&carried) {
            for &(vertex, weight) in carriers {
                if is_used(&(vertex, weight)) && vertex.index() >= model_vertices {
                    let count = model_vertices;
                    return Err(SurfacePointsError::Vertex {
                        point,
                        vertex,
                        count,
                    });
                }
            }
            let sum: f64 = carriers.iter().map(|(_, b)| b).sum();
            let size: f64 = carriers.iter().map(|(_, b)| b.abs()).sum();
            let is_one = (sum - 1.0).abs() <= ROUND_OFF * size;
            if !is_one {
                return Err(SurfacePointsError::Weights { point, sum });
            }
        }
        Ok(Self {
            model_vertices,
            own,
            carried,
        })
    }

    /// With more carried points, after the present ones.
    ///
    /// # Errors
    /// [`SurfacePointsError`].
    pub fn with_carried(
        mut self,
        more: impl IntoIterator<Item = CarriedPoint>,
    ) -> Result<Self, SurfacePointsError> {
        self.carried.extend(more);
        Self::new(self.model_vertices, self.own, self.carried)
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.own + self.carried.len()
    }

    /// Number of points that are vertices; the carried points come after them.
    pub fn own(&self) -> usize {
        self.own
    }

    /// Number of vertices of the model.
    pub fn model_vertices(&self) -> usize {
        self.model_vertices
    }

    /// Sets `out` to the positions or displacements of the points, given the vertices (`3V`).
    pub fn place(&self, x: &[f64], out: &mut Vec<f64>) {
        out.clear();
        out.extend_from_slice(&x[..3 * self.own]);
        for carriers in &self.carried {
            let coordinate = |k: usize| {
                let parts = used(carriers);
                parts.map(|(v, b)| b * x[3 * v.index() + k]).sum::<f64>()
            };
            out.extend((0..3).map(coordinate));
        }
    }

    /// Positions or displacements of the points, given the vertices (`3V`), where the points are not the
    /// vertices themselves.
    pub fn placed<'a>(points: Option<&Self>, x: &'a [f64]) -> Cow<'a, [f64]> {
        match points {
            None => Cow::Borrowed(x),
            Some(points) => {
                let mut placed = Vec::new();
                points.place(x, &mut placed);
                Cow::Owned(placed)
            }
        }
    }

    /// Adds the forces on the vertices (`3V`) that belong to forces on the points.
    pub fn add_forces(&self, forces: &[f64], out: &mut [f64]) {
        let (own, carried) = forces.split_at(3 * self.own);
        for (o, f) in out.iter_mut().zip(own) {
            *o += f;
        }
        for (carriers, f) in self.carried.iter().zip(carried.as_chunks::<3>().0) {
            for (v, b) in used(carriers) {
                for (o, f) in out[3 * v.index()..].iter_mut().zip(f) {
                    *o += b * f;
                }
            }
        }
    }

    /// The vertices that carry a point, with their weights.
    pub(crate) fn carriers(&self, point: u32) -> impl Iterator<Item = (u32, f64)> {
        let itself = [(VertexId(point), 1.0); 4];
        let (list, count) = match (point as usize).checked_sub(self.own) {
            None => (itself, 1),
            Some(number) => (self.carried[number], 4),
        };
        let list = list.into_iter().take(count);
        list.filter(is_used).map(|(v, b)| (v.0, b))
    }

    /// The vertex with the largest weight at a point.
    pub(crate) fn heaviest_carrier(&self, point: u32) -> VertexId {
        let heavier = |a: &(u32, f64), b: &(u32, f64)| a.1.abs().total_cmp(&b.1.abs());
        let heaviest = self.carriers(point).max_by(heavier);
        VertexId(heaviest.map_or(point, |(v, _)| v))
    }

    /// The weights of the vertices that carry points with the given weights, each vertex once.
    pub(crate) fn carried_weights(
        &self,
        stencil: impl Iterator<Item = (u32, f64)>,
    ) -> BTreeMap<u32, f64> {
        let mut weights = BTreeMap::new();
        for (point, w) in stencil {
            for (v, b) in self.carriers(point) {
                *weights.entry(v).or_insert(0.0) += w * b;
            }
        }
        weights
    }

    /// Replaces the pairs of points from `start` on by pairs of the vertices that carry them.
    pub(super) fn carry_couplings(&self, pairs: &mut Vec<[u32; 2]>, start: usize) {
        let of_points = pairs.split_off(start);
        for [p, q] in of_points {
            for (i, _) in self.carriers(p) {
                let others = self.carriers(q).map(|(j, _)| [i.min(j), i.max(j)]);
                pairs.extend(others.filter(|[i, j]| i != j));
            }
        }
    }
}

/// Whether a place among the carriers of a point is used.
fn is_used((_, weight): &(VertexId, f64)) -> bool {
    *weight != 0.0
}

fn used(carriers: &CarriedPoint) -> impl Iterator<Item = (VertexId, f64)> {
    carriers.iter().copied().filter(is_used)
}

/// The vertices of two rigid bodies.
const GATHERED: usize = 8;

/// Receives blocks of points, and hands them on to the vertices that carry these. The blocks of contacts one
/// after the other that the same few vertices carry, as between two bodies, are gathered and handed on once.
pub(super) struct CarriedSink<'a> {
    points: &'a SurfacePoints,
    sink: &'a mut dyn CouplingSink,
    vertices: Vec<u32>,
    /// By the places of the two vertices, the one of the lower number first.
    blocks: [[Option<Matrix3<f64>>; GATHERED]; GATHERED],
}

impl<'a> CarriedSink<'a> {
    /// Hands on to `sink` what `add` adds.
    pub(super) fn hand_on(
        points: &'a SurfacePoints,
        sink: &'a mut dyn CouplingSink,
        add: impl FnOnce(&mut dyn CouplingSink),
    ) {
        let mut carried = Self {
            points,
            sink,
            vertices: Vec::with_capacity(GATHERED),
            blocks: Default::default(),
        };
        add(&mut carried);
        carried.flush();
    }

    /// Gathers a block of vertices, that of the lower number first.
    fn gather(&mut self, i: u32, j: u32, block: &Matrix3<f64>) {
        let is_new = |v: &u32| !self.vertices.contains(v);
        let added = usize::from(is_new(&i)) + usize::from(i != j && is_new(&j));
        if self.vertices.len() + added > GATHERED {
            self.flush();
        }
        let [a, b] = [i, j].map(|v| self.place(v));
        *self.blocks[a][b].get_or_insert_with(Matrix3::zeros) += block;
    }

    /// The place of a vertex among the gathered ones.
    fn place(&mut self, vertex: u32) -> usize {
        let found = self.vertices.iter().position(|v| *v == vertex);
        found.unwrap_or_else(|| {
            self.vertices.push(vertex);
            self.vertices.len() - 1
        })
    }

    fn flush(&mut self) {
        for (row, i) in self.blocks.iter_mut().zip(&self.vertices) {
            for (block, j) in row.iter_mut().zip(&self.vertices) {
                if let Some(block) = block.take() {
                    self.sink.add(*i, *j, &block);
                }
            }
        }
        self.vertices.clear();
    }
}

impl CouplingSink for CarriedSink<'_> {
    fn add(&mut self, p: u32, q: u32, block: &Matrix3<f64>) {
        let points = self.points;
        for (i, b) in points.carriers(p) {
            for (j, c) in points.carriers(q) {
                let weighted = b * c * block;
                if i == j && p == q {
                    self.gather(i, i, &weighted);
                } else if i == j {
                    self.gather(i, i, &(weighted + weighted.transpose()));
                } else if i < j {
                    self.gather(i, j, &weighted);
                } else if p != q {
                    self.gather(j, i, &weighted.transpose());
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, Vector3};

    /// A vertex, and two points of one tetrahedron.
    fn points() -> SurfacePoints {
        let carried =
            |weights: [f64; 4]| std::array::from_fn(|k| (VertexId(1 + k as u32), weights[k]));
        let points = vec![
            carried([0.4, 0.3, 0.2, 0.1]),
            carried([1.5, -0.5, 0.0, 0.0]),
        ];
        SurfacePoints::new(5, 1, points).unwrap()
    }

    struct Dense(DMatrix<f64>);

    impl CouplingSink for Dense {
        fn add(&mut self, a: u32, b: u32, block: &Matrix3<f64>) {
            assert!(a <= b, "the lower vertex first");
            let (a, b) = (3 * a as usize, 3 * b as usize);
            let mut at = self.0.fixed_view_mut::<3, 3>(a, b);
            at += block;
            if a != b {
                let mut at = self.0.fixed_view_mut::<3, 3>(b, a);
                at += block.transpose();
            }
        }
    }

    /// The matrix `B`, column by column.
    fn weights(points: &SurfacePoints) -> DMatrix<f64> {
        let n = 3 * points.model_vertices();
        let mut matrix = DMatrix::zeros(3 * points.count(), n);
        let mut placed = Vec::new();
        for i in 0..n {
            let mut unit = vec![0.0; n];
            unit[i] = 1.0;
            points.place(&unit, &mut placed);
            matrix.column_mut(i).copy_from_slice(&placed);
        }
        matrix
    }

    #[test]
    fn forces_and_second_derivatives_are_those_of_the_combinations() {
        let points = points();
        let weights = weights(&points);
        let forces: Vec<f64> = (0..9).map(|i| f64::from(i) - 3.5).collect();
        let mut on_vertices = vec![0.0; 15];
        points.add_forces(&forces, &mut on_vertices);
        let expected = weights.transpose() * nalgebra::DVector::from_vec(forces);
        assert!((nalgebra::DVector::from_vec(on_vertices) - expected).norm() < 1e-14);
        // A block for each pair of points.
        let vector = |k: u32| Vector3::new(1.0 + f64::from(k), 2.0 - f64::from(k * k), 0.5);
        let block = |p: u32, q: u32| vector(p) * vector(q).transpose() + Matrix3::identity();
        let (mut of_points, mut of_vertices) =
            (Dense(DMatrix::zeros(9, 9)), Dense(DMatrix::zeros(15, 15)));
        for (p, q) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
            of_points.add(p, q, &block(p, q));
            CarriedSink::hand_on(&points, &mut of_vertices, |sink| {
                sink.add(p, q, &block(p, q));
            });
        }
        let expected = weights.transpose() * of_points.0 * weights;
        assert!((of_vertices.0 - &expected).norm() < 1e-13 * expected.norm());
    }

    /// Blocks of more bodies than are gathered at a time, some of them twice, are equal to the blocks that
    /// are handed on one by one.
    #[test]
    fn gathered_blocks_are_all_handed_on() {
        let body = |first: u32| std::array::from_fn(|k| (VertexId(first + k as u32), 0.25));
        let bodies = (0..4).map(|k| body(4 * k)).collect();
        let points = SurfacePoints::new(16, 0, bodies).unwrap();
        let pairs = [(0, 1), (0, 1), (2, 3), (1, 2), (0, 3), (3, 3), (0, 1)];
        let block = |p: u32, q: u32| {
            let half = Matrix3::from_fn(|i, j| f64::from(p * 5 + q * 3 + 1) + (3 * i + j) as f64);
            if p == q {
                half + half.transpose()
            } else {
                half
            }
        };
        let mut whole = Dense(DMatrix::zeros(48, 48));
        CarriedSink::hand_on(&points, &mut whole, |sink| {
            pairs
                .iter()
                .for_each(|(p, q)| sink.add(*p, *q, &block(*p, *q)));
        });
        let mut one_by_one = Dense(DMatrix::zeros(48, 48));
        for (p, q) in pairs {
            CarriedSink::hand_on(&points, &mut one_by_one, |sink| {
                sink.add(p, q, &block(p, q));
            });
        }
        assert!((whole.0 - &one_by_one.0).norm() < 1e-13 * one_by_one.0.norm());
    }

    /// An unused place may name a vertex that there is not.
    #[test]
    fn places_without_weight_are_not_used() {
        let mut point = [(VertexId(9), 0.0); 4];
        point[0] = (VertexId(1), 1.0);
        let points = SurfacePoints::new(2, 0, vec![point]).unwrap();
        let mut forces = vec![0.0; 6];
        points.add_forces(&[1.0, 2.0, 3.0], &mut forces);
        assert_eq!(forces, [0.0, 0.0, 0.0, 1.0, 2.0, 3.0]);
    }

    #[test]
    fn couplings_are_those_of_the_carriers() {
        let mut pairs = vec![[7, 8], [0, 1], [1, 2]];
        points().carry_couplings(&mut pairs, 1);
        assert_eq!(pairs[..5], [[7, 8], [0, 1], [0, 2], [0, 3], [0, 4]]);
        assert!(pairs[5..].iter().all(|[i, j]| 1 <= *i && i < j && *j <= 4));
        assert_eq!(points().heaviest_carrier(2), VertexId(1));
    }

    #[test]
    fn weights_that_make_no_sense_are_refused() {
        let point = |v: u32, b: f64| vec![[(VertexId(v), b); 4]];
        assert_eq!(
            SurfacePoints::new(3, 3, point(0, 0.5)),
            Err(SurfacePointsError::Weights { point: 3, sum: 2.0 })
        );
        assert!(matches!(
            SurfacePoints::new(3, 3, point(0, f64::NAN)),
            Err(SurfacePointsError::Weights { .. })
        ));
        assert_eq!(
            SurfacePoints::new(3, 3, point(3, 0.25)),
            Err(SurfacePointsError::Vertex {
                point: 3,
                vertex: VertexId(3),
                count: 3
            })
        );
    }
}
