//! Polynomials that fit the positions of vertices around an edge, and the slopes that clamps hold there.

use super::law::Roots;
use super::line_clamp::HeldEdges;
use isosheet_mesh::{EdgeId, FaceId, Sheet, VertexId};
use nalgebra::{DMatrix, Vector2, Vector3};
use std::f64::consts::SQRT_2;

/// Smallest singular value of a least-squares fit, in units of the mean length of the edges around, below
/// which further vertices join the fit: vertices that lie nearly on a conic determine no quadratic
/// polynomial.
const LEAST_SINGULAR: f64 = 0.04;
/// Largest number of rings of faces around an edge that take part in a fit.
const MAX_RINGS: usize = 4;
/// Coefficients of a quadratic polynomial in two variables, and with the two cubic ones that are zero at a
/// straight clamp with their slopes: `z^3` and `z^2 s`, with the distance `z` from the clamp and the distance
/// `s` along it.
const QUADRATIC: usize = 6;
const AT_CLAMP: usize = 8;

/// A linear combination of the positions of vertices.
pub(super) type Combination = Vec<(VertexId, f64)>;

/// What a polynomial that fits positions says at the midpoint of an edge.
pub(super) struct Fit {
    /// The derivative along the normal that points out of the left face of the edge.
    pub(super) slope: Combination,
    /// The second derivatives `(11, sqrt(2) 12, 22)`, the first axis along the edge and the second one to its
    /// left; nothing where there is no polynomial, but the slope of a face.
    pub(super) bend: Vec<(VertexId, Vector3<f64>)>,
    /// The parts that slopes held by line clamps have in both.
    pub(super) held: Vec<HeldPart>,
}

/// The part of a slope that a line clamp holds.
pub(super) struct HeldPart {
    pub(super) clamp: usize,
    /// The slope, without rotation of the clamp.
    pub(super) rest: Vector3<f64>,
    pub(super) slope: f64,
    pub(super) bend: Vector3<f64>,
}

impl Fit {
    fn of_slope(slope: Combination) -> Self {
        Self {
            slope,
            bend: Vec::new(),
            held: Vec::new(),
        }
    }
}

/// A slope that is known at a point of a patch.
struct Known {
    at: Vector2<f64>,
    /// The direction along which it is the derivative.
    along: Vector2<f64>,
    slope: KnownSlope,
}

enum KnownSlope {
    /// Of a line clamp, without its rotation.
    Held(usize, Vector3<f64>),
    /// Of a face that is clamped.
    OfFace(Combination),
}

/// Which faces and vertices clamps hold.
pub(super) struct Clamps {
    /// Faces with three clamped corners.
    pub(super) faces: Vec<bool>,
    /// Vertices without any other face: the plate bends outside of them.
    interior: Vec<bool>,
}

impl Clamps {
    pub(super) fn new(sheet: &Sheet, clamped: &[VertexId]) -> Self {
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
pub(super) type Unfolded = [(VertexId, Vector2<f64>); 3];

/// The point left of `p -> q` at the given distances from `p` and from `q`.
fn apex(p: Vector2<f64>, q: Vector2<f64>, from_p: f64, from_q: f64) -> Vector2<f64> {
    let base = q - p;
    let squared = base.norm_squared();
    let along = 0.5 * (1.0 + (from_p * from_p - from_q * from_q) / squared);
    let height = (from_p * from_p / squared - along * along).max(0.0).sqrt();
    p + along * base + height * Vector2::new(-base.y, base.x)
}

/// Places the face `f` with two of its corners known, the third one left of `p -> q`.
pub(super) fn place(
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

/// The fit at an edge; nothing at edges that are closed to fits, and at free edges of meshes too small for a
/// fit.
///
/// Where the rigidity of the plate jumps no fit reaches across, but that of the slope at the very edge: there
/// the curvature along the normal jumps such that the moment does not.
pub(super) fn fit_at(
    sheet: &Sheet,
    roots: &Roots,
    (clamps, held): (&Clamps, &HeldEdges<'_>),
    is_closed: &[bool],
    edge: EdgeId,
) -> Option<Fit> {
    if is_closed[edge.index()] {
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
        return Some(Fit::of_slope(slope_of_face(face)));
    }
    let mean = patch_size(sheet, [left, right]);
    let rigidities = [left, right].map(|f| f.map(|f| roots.rigidity(f.index())));
    let softer = match rigidities {
        [Some(left), Some(right)] if left != right => left / right,
        _ => 1.0,
    };
    for _ in 0..MAX_RINGS {
        grow(sheet, roots, is_closed, &mut patch);
        let points = points(&patch, clamps);
        let known = known(sheet, clamps, held, &patch);
        let cubic = || fit(&points, &known, mean, softer);
        if let Some(fit) = cubic().or_else(|| fit(&points, &[], mean, softer)) {
            return Some(fit);
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
    Some(Fit::of_slope(slope))
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

/// Adds the faces of the same rigidity that share an edge with the patch which is not closed.
fn grow(sheet: &Sheet, roots: &Roots, is_closed: &[bool], patch: &mut Vec<(FaceId, Unfolded)>) {
    let topology = sheet.topology();
    for i in 0..patch.len() {
        let (f, corners) = patch[i];
        for k in 0..3 {
            let (p, q) = (corners[k], corners[(k + 1) % 3]);
            let edge = topology.find_edge(p.0, q.0).expect("an edge of a face");
            let across = topology.edge_faces(edge).into_iter().flatten();
            let is_same = |g: FaceId| roots.rigidity(g.index()) == roots.rigidity(f.index());
            let across = across.filter(|g| *g != f && !is_closed[edge.index()] && is_same(*g));
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

/// The slopes that clamps hold at edges of a patch.
fn known(
    sheet: &Sheet,
    clamps: &Clamps,
    held: &HeldEdges<'_>,
    patch: &[(FaceId, Unfolded)],
) -> Vec<Known> {
    let topology = sheet.topology();
    let mut all = Vec::new();
    for (f, corners) in patch.iter().filter(|(f, _)| !clamps.faces[f.index()]) {
        for k in 0..3 {
            let (p, q) = (corners[k], corners[(k + 1) % 3]);
            let edge = topology.find_edge(p.0, q.0).expect("an edge of a face");
            let across = topology.edge_faces(edge).into_iter().flatten();
            let mut across = across.filter(|g| clamps.faces[g.index()]);
            let slope = match (held.director(sheet, *f, edge), across.next()) {
                (Some((clamp, rest)), _) => KnownSlope::Held(clamp, rest),
                (None, Some(g)) => {
                    let half = Vector2::new(0.5 * (q.1 - p.1).norm(), 0.0);
                    let face = place(sheet, g, (q.0, -half), (p.0, half));
                    let inwards = slope_of_face(&face).into_iter();
                    KnownSlope::OfFace(inwards.map(|(v, w)| (v, -w)).collect())
                }
                (None, None) => continue,
            };
            let side = (q.1 - p.1).normalize();
            all.push(Known {
                at: 0.5 * (p.1 + q.1),
                along: Vector2::new(side.y, -side.x),
                slope,
            });
        }
    }
    all
}

/// The polynomial that fits the points by least squares, with weights that fall off over the length `size`,
/// at the origin: its derivative along `-y`, and its second derivatives; nothing if the points do not
/// determine it. It is quadratic; with slopes that are known it fits them, too, and is exact for all cubic
/// bends at the nearest clamp. Below the x-axis its second derivative along `y` is `softer` times that above;
/// then only its slope is given.
///
/// (The slopes of quadratic polynomials have an error of second order, which cancels in the curvature of a
/// face with such slopes on all sides, but not in that of a face with the exact slope of a clamp on one. With
/// them alone clamped square plates of 8 and of 16 squares bent too much by 18 and 4 %.)
fn fit(
    points: &[(VertexId, Vector2<f64>)],
    known: &[Known],
    size: f64,
    softer: f64,
) -> Option<Fit> {
    let near = known
        .iter()
        .min_by(|a, b| a.at.norm_squared().total_cmp(&b.at.norm_squared()));
    let count = near.map_or(QUADRATIC, |_| AT_CLAMP);
    if points.len() + known.len() < count {
        return None;
    }
    let weight = |p: Vector2<f64>| (-0.5 * p.norm_squared() / (size * size)).exp();
    let bent = |p: Vector2<f64>| if p.y < 0.0 { softer } else { 1.0 };
    // The normal of the clamp, and its direction.
    let n = near.map_or(Vector2::zeros(), |near| near.along);
    let s = Vector2::new(-n.y, n.x);
    let at_point = |at: Vector2<f64>| {
        let p = at / size;
        let (z, s) = (n.dot(&p), s.dot(&p));
        let bend = [p.x * p.x, p.x * p.y, bent(p) * p.y * p.y];
        let row = [
            1.0,
            p.x,
            p.y,
            bend[0],
            bend[1],
            bend[2],
            z.powi(3),
            z * z * s,
        ];
        let weight = weight(at);
        row.map(|value| weight * value)
    };
    let at_clamp = |Known { at, along: d, .. }: &Known| {
        let p = at / size;
        let (z, along) = (n.dot(&p), s.dot(&p));
        let (dz, ds) = (n.dot(d), s.dot(d));
        let bend = [
            2.0 * p.x * d.x,
            p.x * d.y + p.y * d.x,
            2.0 * bent(p) * p.y * d.y,
        ];
        let cubic = [3.0 * z * z * dz, 2.0 * z * dz * along + z * z * ds];
        let row = [0.0, d.x, d.y, bend[0], bend[1], bend[2], cubic[0], cubic[1]];
        let weight = weight(*at);
        row.map(|value| weight * value)
    };
    let of_points = points.iter().map(|(_, at)| at_point(*at));
    let rows: Vec<[f64; AT_CLAMP]> = of_points.chain(known.iter().map(at_clamp)).collect();
    let rows = DMatrix::from_fn(rows.len(), count, |i, k| rows[i][k]);
    let svd = rows.svd(true, true);
    if svd.singular_values.min() <= LEAST_SINGULAR {
        return None;
    }
    let inverse = svd.pseudo_inverse(0.0).ok()?;
    // By the value of a row: the slope and the second derivatives.
    let parts = |i: usize, weight: f64| {
        let row = |k: usize| inverse[(k, i)] * weight;
        let second = Vector3::new(2.0 * row(3), SQRT_2 * row(4), 2.0 * row(5));
        (-row(2) / size, second / (size * size))
    };
    let mut fit = Fit::of_slope(Combination::new());
    let mut add = |v: VertexId, factor: f64, (slope, second): (f64, Vector3<f64>)| {
        fit.slope.push((v, factor * slope));
        fit.bend.push((v, factor * second));
    };
    for (i, (v, at)) in points.iter().enumerate() {
        add(*v, 1.0, parts(i, weight(*at)));
    }
    for (i, known) in known.iter().enumerate() {
        let parts = parts(points.len() + i, weight(known.at) * size);
        match &known.slope {
            KnownSlope::OfFace(of_face) => of_face.iter().for_each(|(v, w)| add(*v, *w, parts)),
            KnownSlope::Held(clamp, rest) => fit.held.push(HeldPart {
                clamp: *clamp,
                rest: *rest,
                slope: parts.0,
                bend: parts.1,
            }),
        }
    }
    if softer != 1.0 {
        fit.bend.clear();
        fit.held
            .iter_mut()
            .for_each(|part| part.bend = Vector3::zeros());
    }
    Some(fit)
}
