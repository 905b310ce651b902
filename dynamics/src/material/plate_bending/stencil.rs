//! Second derivatives of positions on a triangle mesh, from the positions of vertices nearby.

use super::law::Roots;
use super::line_clamp::{Director, HeldEdges, PlateEdges};
use crate::RigidMotion;
use crate::potential::At;
use crate::vectors::point;
use isosheet_mesh::{EdgeId, FaceId, Sheet, VertexId};
use nalgebra::{DMatrix, Matrix3, Vector2, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::SQRT_2;

/// Smallest singular value of a least-squares fit, in units of the mean length of the edges around, below
/// which further vertices join the fit: those that lie nearly on a conic determine no quadratic polynomial.
const LEAST_SINGULAR: f64 = 0.04;
/// Largest number of rings of faces around an edge that take part in a fit.
const MAX_RINGS: usize = 4;
/// Coefficients of a quadratic polynomial in two variables.
const COEFFICIENTS: usize = 6;

/// For each face the weights `w_v` with `sqrt(D A) R H x = sum_v w_v x_v`, the three components of a weight
/// being those of the symmetric 2 x 2 matrix, `(11, sqrt(2) 12, 22)`, and `R` the root of the
/// law of the plate there, see [`Roots`].
#[derive(Debug, Clone)]
pub(super) struct Stencils {
    /// Where the entries of each face begin, and their number.
    starts: Vec<usize>,
    vertices: Vec<u32>,
    weights: Vec<Vector3<f64>>,
    /// The motions of the clamps, and the slopes that they hold, by faces.
    clamps: Vec<RigidMotion>,
    directors: BTreeMap<u32, Vec<Director>>,
}

/// The vertices and weights of a face.
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

/// A linear combination of the positions of vertices.
type Combination = Vec<(VertexId, f64)>;

impl Stencils {
    pub(super) fn new(sheet: &Sheet, roots: &Roots, edges: &PlateEdges<'_>) -> Self {
        let topology = sheet.topology();
        let clamps = Clamps::new(sheet, edges.pinned);
        let held = HeldEdges::new(sheet, edges.clamps);
        let mut is_creased = vec![false; topology.edge_count()];
        for edge in edges.creases {
            is_creased[edge.index()] = true;
        }
        let slopes: Vec<_> = topology
            .edge_ids()
            .map(|e| slope(sheet, roots, &clamps, &is_creased, e))
            .collect();
        let mut stencils = Self {
            starts: vec![0],
            vertices: Vec::new(),
            weights: Vec::new(),
            clamps: edges.clamps.iter().map(|c| c.motion.clone()).collect(),
            directors: BTreeMap::new(),
        };
        for face in topology.face_ids() {
            let scale = (roots.rigidity(face.index()) * sheet.face_areas()[face.index()]).sqrt()
                * roots.of(face.index());
            let is_clamped = clamps.faces[face.index()];
            let director = |edge| (!is_clamped).then(|| held.director(sheet, face, edge))?;
            let (weights, directors) = face_weights(sheet, &slopes, director, face);
            for (v, w) in weights {
                stencils.vertices.push(v.0);
                stencils.weights.push(scale * w);
            }
            if !directors.is_empty() {
                let scaled = directors.into_iter().map(|d| Director {
                    weights: scale * d.weights,
                    ..d
                });
                stencils.directors.insert(face.0, scaled.collect());
            }
            stencils.starts.push(stencils.vertices.len());
        }
        stencils
    }

    /// Changes the weights such that the second derivatives of the positions of `sheet` have no part along the
    /// faces: by that part, as a multiple of two edges of each face, which stay edges wherever it goes. The
    /// curvatures `R k` that are left, 1/m.
    pub(super) fn straighten(&mut self, sheet: &Sheet, roots: &Roots) -> Vec<Vector3<f64>> {
        let faces = sheet.topology().faces().iter().zip(sheet.face_areas());
        let mut curvatures = Vec::new();
        for (f, (corners, area)) in faces.enumerate() {
            let [along_b, along_c, bent] = self.parts(f, corners, sheet.positions());
            for k in self.starts[f]..self.starts[f + 1] {
                let v = VertexId(self.vertices[k]);
                let place = corners.iter().position(|corner| *corner == v);
                self.weights[k] += match place {
                    Some(0) => along_b + along_c,
                    Some(1) => -along_b,
                    Some(2) => -along_c,
                    _ => Vector3::zeros(),
                };
            }
            curvatures.push(bent / (roots.rigidity(f) * area).sqrt());
        }
        curvatures
    }

    /// The curvatures `R k` of the faces of `sheet` at positions `x`, 1/m.
    pub(super) fn curvatures(&self, sheet: &Sheet, roots: &Roots, x: &[f64]) -> Vec<Vector3<f64>> {
        let faces = sheet.topology().faces().iter().zip(sheet.face_areas());
        let bent = faces.enumerate().map(|(f, (corners, area))| {
            let [_, _, bent] = self.parts(f, corners, x);
            bent / (roots.rigidity(f) * area).sqrt()
        });
        bent.collect()
    }

    /// The second derivatives of a face at positions `x` as multiples of the edges from its first corner to the second
    /// and to the third one, and of its normal.
    fn parts(&self, f: usize, corners: &[VertexId; 3], x: &[f64]) -> [Vector3<f64>; 3] {
        let mut derivatives = self.of(f).apply_to_positions(x);
        for d in self.directors.get(&(f as u32)).into_iter().flatten() {
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
        (0..self.starts.len() - 1).map(|face| self.of(face))
    }

    fn of(&self, face: usize) -> Stencil<'_> {
        let range = self.starts[face]..self.starts[face + 1];
        // (An empty map is looked up at no cost.)
        let directors = self.directors.get(&(face as u32));
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

/// Which faces and vertices clamps hold.
struct Clamps {
    /// Faces with three clamped corners.
    faces: Vec<bool>,
    /// Vertices without any other face: the plate bends outside of them.
    interior: Vec<bool>,
}

impl Clamps {
    fn new(sheet: &Sheet, clamped: &[VertexId]) -> Self {
        let topology = sheet.topology();
        let mut is_clamped = vec![false; topology.vertex_count()];
        for v in clamped {
            is_clamped[v.index()] = true;
        }
        let all = |f: &[VertexId; 3]| f.iter().all(|v| is_clamped[v.index()]);
        let faces: Vec<_> = topology.faces().iter().map(all).collect();
        let inside = |v| topology.vertex_faces(v).iter().all(|f| faces[f.index()]);
        let interior = topology.vertex_ids().map(inside).collect();
        Self { faces, interior }
    }
}

/// A face unfolded into the plane: corners counter-clockwise.
type Unfolded = [(VertexId, Vector2<f64>); 3];

/// The point left of `p -> q` at the given distances from `p` and from `q`.
fn apex(p: Vector2<f64>, q: Vector2<f64>, from_p: f64, from_q: f64) -> Vector2<f64> {
    let base = q - p;
    let squared = base.norm_squared();
    let along = 0.5 * (1.0 + (from_p * from_p - from_q * from_q) / squared);
    let height = (from_p * from_p / squared - along * along).max(0.0).sqrt();
    p + along * base + height * Vector2::new(-base.y, base.x)
}

/// Places the face `f` with two of its corners known, the third one left of `p -> q`.
fn place(
    sheet: &Sheet,
    f: FaceId,
    p: (VertexId, Vector2<f64>),
    q: (VertexId, Vector2<f64>),
) -> Unfolded {
    let topology = sheet.topology();
    let length = |a, b| {
        let edge = topology.find_edge(a, b).expect("two corners of a face");
        sheet.lengths()[edge.index()]
    };
    let corners = topology.faces()[f.index()];
    let third = corners.into_iter().find(|v| *v != p.0 && *v != q.0);
    let third = third.expect("a face has three corners");
    let position = apex(p.1, q.1, length(p.0, third), length(q.0, third));
    [p, q, (third, position)]
}

/// The derivative of the positions at the midpoint of an edge along the normal that points out of its left
/// face; nothing at creases, and at free edges of meshes too small for a fit.
///
/// Where the rigidity of the plate jumps no fit reaches across, but that of the slope at the very edge: there the
/// curvature along the normal jumps such that the moment does not.
fn slope(
    sheet: &Sheet,
    roots: &Roots,
    clamps: &Clamps,
    is_creased: &[bool],
    edge: EdgeId,
) -> Option<Combination> {
    if is_creased[edge.index()] {
        return None;
    }
    let topology = sheet.topology();
    let [a, b] = topology.edges()[edge.index()];
    let half = Vector2::new(0.5 * sheet.lengths()[edge.index()], 0.0);
    let [left, right] = topology.edge_faces(edge);
    let mut patch: Vec<(FaceId, Unfolded)> = Vec::new();
    if let Some(f) = left {
        patch.push((f, place(sheet, f, (a, -half), (b, half))));
    }
    if let Some(f) = right {
        patch.push((f, place(sheet, f, (b, half), (a, -half))));
    }
    if let Some((_, face)) = patch.iter().find(|(f, _)| clamps.faces[f.index()]) {
        return Some(slope_of_face(face));
    }
    let mean = patch_size(sheet, [left, right]);
    let rigidities = [left, right].map(|f| f.map(|f| roots.rigidity(f.index())));
    let softer = match rigidities {
        [Some(left), Some(right)] if left != right => left / right,
        _ => 1.0,
    };
    for _ in 0..MAX_RINGS {
        grow(sheet, roots, is_creased, &mut patch);
        if let Some(slope) = fit(&points(&patch, clamps), mean, softer) {
            return Some(slope);
        }
    }
    // Too small a mesh for a fit: the mean slope of the two faces.
    let [Some(_), Some(_)] = [left, right] else {
        return None;
    };
    let mut slope = Combination::new();
    for (_, face) in &patch[..2] {
        slope.extend(slope_of_face(face).into_iter().map(|(v, w)| (v, 0.5 * w)));
    }
    Some(slope)
}

/// Mean length of the edges of the faces at an edge.
fn patch_size(sheet: &Sheet, faces: [Option<FaceId>; 2]) -> f64 {
    let topology = sheet.topology();
    let lengths = faces.into_iter().flatten().flat_map(|f| {
        let edges = topology.face_edges(f);
        edges.map(|e| sheet.lengths()[e.index()])
    });
    let (sum, count) = lengths.fold((0.0, 0.0), |(s, n), l| (s + l, n + 1.0));
    sum / count
}

/// Derivative along `-y` of the linear function on an unfolded face whose first edge lies on the x-axis.
fn slope_of_face(face: &Unfolded) -> Combination {
    let [(a, pa), (b, pb), (c, pc)] = *face;
    let along = (pc.x - pa.x) / (pb.x - pa.x);
    vec![
        (a, (1.0 - along) / pc.y),
        (b, along / pc.y),
        (c, -1.0 / pc.y),
    ]
}

/// Adds the faces of the same rigidity that share an edge with the patch which is no crease.
fn grow(sheet: &Sheet, roots: &Roots, is_creased: &[bool], patch: &mut Vec<(FaceId, Unfolded)>) {
    let topology = sheet.topology();
    for i in 0..patch.len() {
        let (f, corners) = patch[i];
        for k in 0..3 {
            let (p, q) = (corners[k], corners[(k + 1) % 3]);
            let edge = topology.find_edge(p.0, q.0).expect("an edge of a face");
            let across = topology.edge_faces(edge).into_iter().flatten();
            let is_same = |g: FaceId| roots.rigidity(g.index()) == roots.rigidity(f.index());
            let across = across.filter(|g| *g != f && !is_creased[edge.index()] && is_same(*g));
            for g in across {
                if patch.iter().all(|(other, _)| *other != g) {
                    patch.push((g, place(sheet, g, q, p)));
                }
            }
        }
    }
}

/// The vertices of a patch with their places in the plane, without those inside clamps.
fn points(patch: &[(FaceId, Unfolded)], clamps: &Clamps) -> Vec<(VertexId, Vector2<f64>)> {
    let mut points: Vec<(VertexId, Vector2<f64>)> = Vec::new();
    for (v, p) in patch.iter().flat_map(|(_, corners)| *corners) {
        if !clamps.interior[v.index()] && points.iter().all(|(other, _)| *other != v) {
            points.push((v, p));
        }
    }
    points
}

/// Derivative along `-y` at the origin of the quadratic polynomial that fits the points by least squares,
/// with weights that fall off over the length `size`; nothing if the points do not determine a polynomial. Below the
/// x-axis its second derivative along `y` is so many times that above.
fn fit(points: &[(VertexId, Vector2<f64>)], size: f64, softer: f64) -> Option<Combination> {
    if points.len() < COEFFICIENTS {
        return None;
    }
    let weight = |p: Vector2<f64>| (-0.5 * p.norm_squared() / (size * size)).exp();
    let rows = DMatrix::from_fn(points.len(), COEFFICIENTS, |i, k| {
        let p = points[i].1 / size;
        let bent = if p.y < 0.0 { softer } else { 1.0 };
        weight(points[i].1) * [1.0, p.x, p.y, p.x * p.x, p.x * p.y, bent * p.y * p.y][k]
    });
    let svd = rows.svd(true, true);
    if svd.singular_values.min() <= LEAST_SINGULAR {
        return None;
    }
    let inverse = svd.pseudo_inverse(0.0).ok()?;
    let entry = |(i, (v, p)): (usize, &(VertexId, Vector2<f64>))| {
        (*v, -inverse[(2, i)] * weight(*p) / size)
    };
    Some(points.iter().enumerate().map(entry).collect())
}

/// The second derivatives of a face from the slopes at its edges, those that clamps hold apart.
fn face_weights(
    sheet: &Sheet,
    slopes: &[Option<Combination>],
    director: impl Fn(EdgeId) -> Option<(usize, Vector3<f64>)>,
    face: FaceId,
) -> (Vec<(VertexId, Vector3<f64>)>, Vec<Director>) {
    let topology = sheet.topology();
    let [a, b, _] = topology.faces()[face.index()];
    let base = topology.find_edge(a, b).expect("an edge of a face");
    let base = Vector2::new(sheet.lengths()[base.index()], 0.0);
    let corners = place(sheet, face, (a, Vector2::zeros()), (b, base));
    let area = sheet.face_areas()[face.index()];
    let mut weights: Vec<(VertexId, Vector3<f64>)> = Vec::new();
    let mut add =
        |v: VertexId, w: Vector3<f64>| match weights.iter_mut().find(|(other, _)| *other == v) {
            Some((_, sum)) => *sum += w,
            None => weights.push((v, w)),
        };
    let (mut free, mut directors) = (Vec::new(), Vec::new());
    for k in 0..3 {
        let ((p, xp), (q, xq)) = (corners[k], corners[(k + 1) % 3]);
        let edge = topology.find_edge(p, q).expect("an edge of a face");
        let length = (xq - xp).norm();
        let t = (xq - xp) / length;
        let n = Vector2::new(t.y, -t.x);
        let twist = symmetric(t, n) / area;
        add(q, twist);
        add(p, -twist);
        let bend = symmetric(n, n) * (length / area);
        let is_left = topology.left_face(edge) == face;
        let sign = if is_left { 1.0 } else { -1.0 };
        if let Some((clamp, rest)) = director(edge) {
            let weights = bend;
            directors.push(Director {
                clamp,
                rest,
                weights,
            });
            continue;
        }
        match &slopes[edge.index()] {
            Some(slope) => slope.iter().for_each(|(v, s)| add(*v, sign * s * bend)),
            None => free.push(symmetric(n, n)),
        }
    }
    let of_directors = directors.iter_mut().map(|d| &mut d.weights);
    let of_vertices = weights.iter_mut().map(|(_, w)| w);
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
