//! Second derivatives of positions at points of a triangle mesh, from the positions of vertices nearby.

use super::fit::{Clamps, Fit, fit_at, place};
use super::law::Roots;
use super::line_clamp::{Director, HeldEdges, PlateEdges};
use crate::potential::At;
use crate::vectors::point;
use isosheet_mesh::{EdgeId, FaceId, Sheet, VertexId};
use isosheet_motion::RigidMotion;
use nalgebra::{Matrix3, Vector2, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::SQRT_2;
use std::ops::Range;

/// Points of each face at which its second derivatives are taken. The point with the number `p` is one of the
/// face
/// [`face_of`]`(p)`.
pub(super) const POINTS: usize = 3;

/// How much more than the polynomials the second derivatives vary in a face, the root of 5/3.
///
/// Second derivatives of a wave are smoothed by the fits: on a strip with the spacing `h`, the derivatives of
/// a cell and of the polynomials are both `w'' + 5/24 h^2 w''''` in the middle of a cell, so that their
/// squares integrate to `5/12 h^2 |w'''|^2` less than the squares of `w''`. The polynomials at the two ends
/// of a cell differ by `h w'''`, and their squared deviations from the mean are `1/4 h^2 |w'''|^2`. On
/// triangles the factor that gives the energy of waves to fourth order is 1.5 to 5.3 in place of 5/3, by mesh
/// and direction (on the average 2.9); larger ones than 5/3 make supported plates on coarse meshes too stiff:
/// largest errors of the deflection of square plates, simply supported, isotropic and orthotropic, and
/// clamped, on six meshes of 8 squares (`cargo xtask validation`), %:
///
/// | factor | 0 | 1 | **5/3** | 2.25 |
/// |---|---|---|---|---|
/// | isotropic | 3.7 | 1.6 | 1.4 | 2.8 |
/// | orthotropic | 3.4 | 1.1 | 2.7 | 4.2 |
/// | clamped, by fits that did not know the slope of clamps | 23.7 | 20.0 | 18.3 | 16.9 |
const VARIATION: f64 = 1.290_994_448_735_805_6;

/// The face of a point.
pub(super) fn face_of(point: usize) -> usize {
    point / POINTS
}

/// For each point the weights `w_v` with `sqrt(D A) R H x = sum_v w_v x_v`, where the three components of a
/// weight are the components of the symmetric 2 x 2 matrix, `(11, sqrt(2) 12, 22)`, `A` the part of the area
/// of the face that is the point's, and `R` the root of the law of the plate there, see [`Roots`].
#[derive(Debug, Clone)]
pub(super) struct Stencils {
    /// Where the entries of each point begin, and their number.
    starts: Vec<usize>,
    vertices: Vec<u32>,
    weights: Vec<Vector3<f64>>,
    /// The motions of the clamps, and the slopes that they hold, by points.
    clamps: Vec<RigidMotion>,
    directors: BTreeMap<u32, Vec<Director>>,
}

/// The vertices and weights of a point.
#[derive(Clone)]
pub(super) struct Stencil<'a> {
    vertices: &'a [u32],
    weights: &'a [Vector3<f64>],
    directors: &'a [Director],
    clamps: &'a [RigidMotion],
}

impl Stencil<'_> {
    /// `sum_v x_v w_v^T + sum_e d_e w_e^T`, with what clamps hold at a time.
    pub(super) fn apply(&self, At { t, x, .. }: At<'_>) -> Matrix3<f64> {
        let mut sum = self.apply_to_positions(x);
        for (director, weights) in self.directors(t) {
            sum.ger(1.0, &director, &weights, 1.0);
        }
        sum
    }

    /// The slopes that clamps hold at a time, with their weights.
    pub(super) fn directors(&self, t: f64) -> impl Iterator<Item = (Vector3<f64>, Vector3<f64>)> {
        self.directors.iter().map(move |d| {
            let turn = self.clamps[d.clamp].pose(t).rotation;
            (turn * d.rest, d.weights)
        })
    }

    /// The clamps that hold these slopes.
    pub(super) fn clamps(&self) -> impl Iterator<Item = usize> {
        self.directors.iter().map(|d| d.clamp)
    }

    /// `sum_v x_v w_v^T`. (The weights sum to zero; differences keep the round-off that of the shape.)
    fn apply_to_positions(&self, x: &[f64]) -> Matrix3<f64> {
        let Some(&first) = self.vertices.first() else {
            return Matrix3::zeros();
        };
        let origin = point(x, VertexId(first));
        let mut sum = Matrix3::zeros();
        for (v, w) in self.vertices.iter().zip(self.weights) {
            sum.ger(1.0, &(point(x, VertexId(*v)) - origin), w, 1.0);
        }
        sum
    }
}

impl Iterator for Stencil<'_> {
    type Item = (usize, Vector3<f64>);

    fn next(&mut self) -> Option<Self::Item> {
        let (v, vertices) = self.vertices.split_first()?;
        let (w, weights) = self.weights.split_first()?;
        (self.vertices, self.weights) = (vertices, weights);
        Some((*v as usize, *w))
    }
}

impl Stencils {
    pub(super) fn new(sheet: &Sheet, roots: &Roots, edges: &PlateEdges<'_>) -> Self {
        let topology = sheet.topology();
        let clamps = Clamps::new(sheet, edges.pinned);
        let held = HeldEdges::new(sheet, edges.clamps);
        // No fit reaches across creases and clamps.
        let is_held = |e: EdgeId| held.holds(e) && !topology.is_boundary_edge(e);
        let mut is_closed: Vec<bool> = topology.edge_ids().map(is_held).collect();
        for edge in edges.creases {
            is_closed[edge.index()] = true;
        }
        let fits: Vec<_> = topology
            .edge_ids()
            .map(|e| fit_at(sheet, roots, (&clamps, &held), &is_closed, e))
            .collect();
        let mut stencils = Self {
            starts: vec![0],
            vertices: Vec::new(),
            weights: Vec::new(),
            clamps: edges.clamps.iter().map(|c| c.motion.clone()).collect(),
            directors: BTreeMap::new(),
        };
        for face in topology.face_ids() {
            let scale = scale(sheet, roots, POINTS * face.index()) * roots.of(face.index());
            let is_clamped = clamps.faces[face.index()];
            let director = |edge| (!is_clamped).then(|| held.director(sheet, face, edge))?;
            let (weights, directors) = face_weights(sheet, &fits, director, face);
            for point in 0..POINTS {
                for (v, of_points) in &weights {
                    stencils.vertices.push(v.0);
                    stencils.weights.push(scale * of_points[point]);
                }
                if !directors.is_empty() {
                    let scaled = directors.iter().map(|(clamp, rest, of_points)| Director {
                        clamp: *clamp,
                        rest: *rest,
                        weights: scale * of_points[point],
                    });
                    let number = (stencils.starts.len() - 1) as u32;
                    stencils.directors.insert(number, scaled.collect());
                }
                stencils.starts.push(stencils.vertices.len());
            }
        }
        stencils
    }

    /// Changes the weights such that the second derivatives of the positions of `sheet` have no part along
    /// the faces: by that part, as a multiple of two edges of each face, which stay edges wherever it goes.
    /// The curvatures `R k` that are left, 1/m.
    pub(super) fn straighten(&mut self, sheet: &Sheet, roots: &Roots) -> Vec<Vector3<f64>> {
        let mut curvatures = Vec::new();
        for point in 0..self.count() {
            let corners = sheet.topology().faces()[face_of(point)];
            let [along_b, along_c, bent] = self.parts(point, &corners, sheet.positions());
            for entry in self.starts[point]..self.starts[point + 1] {
                let v = VertexId(self.vertices[entry]);
                let place = corners.iter().position(|corner| *corner == v);
                self.weights[entry] += match place {
                    Some(0) => along_b + along_c,
                    Some(1) => -along_b,
                    Some(2) => -along_c,
                    _ => Vector3::zeros(),
                };
            }
            curvatures.push(bent / scale(sheet, roots, point));
        }
        curvatures
    }

    /// The curvatures `R k` of the points of `sheet` at positions `x`, 1/m.
    pub(super) fn curvatures(&self, sheet: &Sheet, roots: &Roots, x: &[f64]) -> Vec<Vector3<f64>> {
        let bent = (0..self.count()).map(|point| {
            let corners = &sheet.topology().faces()[face_of(point)];
            let [_, _, bent] = self.parts(point, corners, x);
            bent / scale(sheet, roots, point)
        });
        bent.collect()
    }

    /// The second derivatives of a point at positions `x` as multiples of the edges from the first corner of
    /// its face to the second and to the third one, and of the normal.
    fn parts(&self, number: usize, corners: &[VertexId; 3], x: &[f64]) -> [Vector3<f64>; 3] {
        let mut derivatives = self.of(number).apply_to_positions(x);
        for d in self.directors.get(&(number as u32)).into_iter().flatten() {
            derivatives += d.rest * d.weights.transpose();
        }
        let [a, b, c] = corners.map(|v| point(x, v));
        let normal = (b - a).cross(&(c - a)).normalize();
        let axes = Matrix3::from_columns(&[b - a, c - a, normal]);
        let inverse = axes.try_inverse().unwrap_or_else(Matrix3::zeros);
        let parts = inverse * derivatives;
        [0, 1, 2].map(|k| parts.row(k).transpose())
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = Stencil<'_>> {
        (0..self.count()).map(|point| self.of(point))
    }

    /// Whether others are of as many points, and neither has clamps along lines.
    pub(super) fn are_comparable(&self, other: &Self) -> bool {
        self.clamps.is_empty() && other.clamps.is_empty() && self.count() == other.count()
    }

    /// Whether a point has the same entries as that of others, which are comparable.
    pub(super) fn is_same(&self, other: &Self, point: usize) -> bool {
        let [own, other] = [self, other].map(|stencils| stencils.of(point));
        own.vertices == other.vertices && own.weights == other.weights
    }

    /// Number of points.
    pub(super) fn count(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn of(&self, point: usize) -> Stencil<'_> {
        let range = self.starts[point]..self.starts[point + 1];
        // (An empty map is looked up at no cost.)
        let directors = self.directors.get(&(point as u32));
        Stencil {
            vertices: &self.vertices[range.clone()],
            weights: &self.weights[range],
            directors: directors.map_or(&[], Vec::as_slice),
            clamps: &self.clamps,
        }
    }

    /// Number of clamps.
    pub(super) fn clamp_count(&self) -> usize {
        self.clamps.len()
    }

    /// Whether a clamp turns.
    pub(super) fn is_driven(&self) -> bool {
        self.clamps.iter().any(|motion| !motion.is_fixed())
    }
}

/// The weights of vertices at the points of a face.
type PointWeights = Vec<(VertexId, [Vector3<f64>; POINTS])>;

/// The weights of slopes that clamps hold, each with its clamp.
type PointDirectors = Vec<(usize, Vector3<f64>, [Vector3<f64>; POINTS])>;

/// `sqrt(D A)` of a point.
fn scale(sheet: &Sheet, roots: &Roots, point: usize) -> f64 {
    let face = face_of(point);
    let area = sheet.face_areas()[face] / POINTS as f64;
    (roots.rigidity(face) * area).sqrt()
}

/// The second derivatives at the points of a face, from the slopes at its edges; slopes that clamps hold are
/// apart. Their mean is the mean over the face.
fn face_weights(
    sheet: &Sheet,
    fits: &[Option<Fit>],
    director: impl Fn(EdgeId) -> Option<(usize, Vector3<f64>)>,
    face: FaceId,
) -> (PointWeights, PointDirectors) {
    let topology = sheet.topology();
    let [a, b, _] = topology.faces()[face.index()];
    let base = topology.find_edge(a, b).expect("an edge of a face");
    let base = Vector2::new(sheet.lengths()[base.index()], 0.0);
    let corners = place(sheet, face, (a, Vector2::zeros()), (b, base));
    let area = sheet.face_areas()[face.index()];
    let mut weights = PointWeights::new();
    let mut add = |points: Range<usize>, v: VertexId, w: Vector3<f64>| {
        let known = weights.iter().position(|(other, _)| *other == v);
        let place = known.unwrap_or_else(|| {
            weights.push((v, [Vector3::zeros(); POINTS]));
            weights.len() - 1
        });
        weights[place].1[points]
            .iter_mut()
            .for_each(|sum| *sum += w);
    };
    let mut directors = PointDirectors::new();
    let mut hold = |points: Range<usize>, clamp: usize, rest: Vector3<f64>, w: Vector3<f64>| {
        let known = directors
            .iter()
            .position(|(c, r, _)| (*c, *r) == (clamp, rest));
        let place = known.unwrap_or_else(|| {
            directors.push((clamp, rest, [Vector3::zeros(); POINTS]));
            directors.len() - 1
        });
        directors[place].2[points]
            .iter_mut()
            .for_each(|sum| *sum += w);
    };
    let (mut free, mut varying) = (Vec::new(), Vec::new());
    for k in 0..POINTS {
        let ((p, xp), (q, xq)) = (corners[k], corners[(k + 1) % 3]);
        let edge = topology.find_edge(p, q).expect("an edge of a face");
        let length = (xq - xp).norm();
        let t = (xq - xp) / length;
        let n = Vector2::new(t.y, -t.x);
        let twist = symmetric(t, n) / area;
        add(0..POINTS, q, twist);
        add(0..POINTS, p, -twist);
        let bend = symmetric(n, n) * (length / area);
        let is_left = topology.left_face(edge) == face;
        let sign = if is_left { 1.0 } else { -1.0 };
        let fit = fits[edge.index()].as_ref();
        match (director(edge), fit) {
            (Some((clamp, rest)), _) => hold(0..POINTS, clamp, rest, bend),
            (None, Some(fit)) => {
                for (v, s) in &fit.slope {
                    add(0..POINTS, *v, sign * s * bend);
                }
                for part in &fit.held {
                    hold(0..POINTS, part.clamp, part.rest, sign * part.slope * bend);
                }
            }
            (None, None) => free.push(symmetric(n, n)),
        }
        if let Some(fit) = fit.filter(|fit| !fit.bend.is_empty()) {
            // The axes of the edge, both turned by half a turn or none.
            let axes = [symmetric(t, t), SQRT_2 * symmetric(t, -n), symmetric(n, n)];
            varying.push((k, VARIATION * Matrix3::from_columns(&axes), fit));
        }
    }
    let part = 1.0 / varying.len() as f64;
    for (k, axes, fit) in &varying {
        // The point itself, and the mean of all.
        let own = std::iter::once((*k, 1.0));
        let points = own.chain(varying.iter().map(|(other, ..)| (*other, -part)));
        for (point, factor) in points {
            for (v, second) in &fit.bend {
                add(point..point + 1, *v, factor * axes * second);
            }
            for held in &fit.held {
                let second = factor * axes * held.bend;
                hold(point..point + 1, held.clamp, held.rest, second);
            }
        }
    }
    let of_directors = directors.iter_mut().flat_map(|(.., w)| w);
    let of_vertices = weights.iter_mut().flat_map(|(_, w)| w);
    without(of_vertices.chain(of_directors), free);
    (weights, directors)
}

/// The symmetric part of `u v^T` as the vector `(11, sqrt(2) 12, 22)`, which has the norm of the matrix.
fn symmetric(u: Vector2<f64>, v: Vector2<f64>) -> Vector3<f64> {
    Vector3::new(u.x * v.x, (u.x * v.y + u.y * v.x) / SQRT_2, u.y * v.y)
}

/// Takes the components along `directions` out of all weights: the slopes at these edges are those for which
/// the face is not bent across them.
fn without<'a>(weights: impl Iterator<Item = &'a mut Vector3<f64>>, directions: Vec<Vector3<f64>>) {
    let mut basis: Vec<Vector3<f64>> = Vec::new();
    for mut d in directions {
        for b in &basis {
            d -= b * b.dot(&d);
        }
        basis.push(d.normalize());
    }
    for w in weights {
        for b in &basis {
            *w -= b * b.dot(w);
        }
    }
}
