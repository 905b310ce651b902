//! Angles at edges and vertices: fold angles, angle triples, the compatibility condition, flatness.

use crate::Advice;
use std::f64::consts::{PI, TAU};

use thiserror::Error;

use crate::vec3::{at, cross, dot, norm, sub};
use crate::{EdgeId, FaceId, MeshError, Sheet, Topology, VertexId};

/// The angle, in radians, between sides `a` and `b` of a triangle whose third side is `c`.
///
/// Half-angle form `tan^2(angle/2) = (c^2 - (a - b)^2) / ((a + b)^2 - c^2)` with the differences of squares
/// factored, so that no digits are lost near 0 and pi. Where the lengths make no triangle the result is 0
/// (`c < |a - b|`) or pi (`c > a + b`).
pub fn angle_from_lengths(a: f64, b: f64, c: f64) -> f64 {
    let short = (c - (a - b)) * (c + (a - b));
    let long = ((a + b) - c) * ((a + b) + c);
    2.0 * short.max(0.0).sqrt().atan2(long.max(0.0).sqrt())
}

/// The angle that differs from `angle` by whole turns and is nearest to `near`, radians: an angle that is
/// followed beyond half a turn, where it changes by less than that from one state to the next.
pub fn angle_near(angle: f64, near: f64) -> f64 {
    angle + TAU * ((near - angle) / TAU).round()
}

/// The fold angle of an edge at positions `x` (length 3V), in radians within [-pi, pi]; `None` on the
/// boundary.
///
/// Zero when flat, positive for a valley as seen from the side from which faces are counter-clockwise (the
/// sign of the FOLD format). With the edge running along the unit vector e, the left face's normal nL and the
/// right one's nR: `fold = atan2((nR x nL) . e, nL . nR)`, accurate at every angle.
///
/// # Panics
/// If `x` is not of length 3V.
pub fn fold_angle(t: &Topology, x: &[f64], e: EdgeId) -> Option<f64> {
    assert_eq!(x.len(), 3 * t.vertex_count(), "three numbers per vertex");
    let [Some(left), Some(right)] = t.opposite_vertices(e) else {
        return None;
    };
    let [a, b] = t.edges()[e.index()].map(|v| at(x, v));
    let along = sub(b, a);
    let n_left = cross(along, sub(at(x, left), a));
    let n_right = cross(sub(at(x, right), a), along);
    Some((dot(cross(n_right, n_left), along) / norm(along)).atan2(dot(n_left, n_right)))
}

/// The angles at one end of an interior edge (Liu, Tang and Joneja 2007, Sec. 2.4 and Fig. 5).
///
/// Seen from the end, alpha and beta lie between the edge and the sides of its left and right face; they are
/// fixed by the rest lengths. gamma lies between those two sides and changes as the edge folds. On the unit
/// sphere about the end the three are the sides of a triangle whose angle opposite gamma is the dihedral
/// angle, pi - |fold|.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleTriple {
    /// Between the edge and the other side of its left face, in radians.
    pub alpha: f64,
    /// Between the edge and the other side of its right face, in radians.
    pub beta: f64,
    /// Between the two other sides, in radians. Where the distance of the two opposite vertices makes no
    /// triangle with those sides, it is continued beyond pi, or below 0, in proportion to the excess.
    pub gamma: f64,
}

impl AngleTriple {
    /// The largest gamma that a fold can produce, reached when flat: alpha + beta, or 2 pi - alpha - beta
    /// when that sum exceeds pi.
    pub fn flat(&self) -> f64 {
        let sum = self.alpha + self.beta;
        sum.min(TAU - sum)
    }

    /// The smallest gamma that a fold can produce, reached when folded shut: |alpha - beta|.
    pub fn shut(&self) -> f64 {
        (self.alpha - self.beta).abs()
    }

    /// How far gamma is inside its range, in radians; negative when the triple is incompatible.
    pub fn margin(&self) -> f64 {
        (self.gamma - self.shut()).min(self.flat() - self.gamma)
    }

    /// The size of the fold angle, in radians within [0, pi], from the spherical triangle of the three
    /// angles; incompatible triples give that of the nearer end of the range.
    ///
    /// `tan^2(fold/2) = sin s sin(s - gamma) / (sin(s - alpha) sin(s - beta))`,
    /// `s = (alpha + beta + gamma) / 2`.
    pub fn fold(&self) -> f64 {
        let gamma = self.gamma.clamp(self.shut(), self.flat());
        let s = 0.5 * (self.alpha + self.beta + gamma);
        let open = s.sin() * (s - gamma).sin();
        let closed = (s - self.alpha).sin() * (s - self.beta).sin();
        2.0 * open.max(0.0).sqrt().atan2(closed.max(0.0).sqrt())
    }
}

/// The angle triples of an interior edge and the distance that both come from.
///
/// # The compatibility condition
///
/// The paper asks for `gamma(t) <= alpha + beta = gamma(0)` (Eq. 10). A fold produces exactly the gammas of
///
/// `|alpha - beta| <= gamma <= min(alpha + beta, 2 pi - alpha - beta)`,
///
/// the triangle inequalities of the sphere. The bound of Eq. 10 alone is necessary but not sufficient: it
/// lacks the reverse inequality, and where alpha + beta > pi it says nothing at all, since gamma never
/// exceeds pi.
///
/// # The two triples of an edge are equivalent
///
/// Let the edge have length l, and let the vertices opposite to it in the left and right face have the
/// distances `h_L, h_R > 0` from the edge's line and the coordinates `s_L, s_R` along it. Folding by the
/// angle f puts the two vertices at the distance d with
///
/// `d^2 = (s_L - s_R)^2 + h_L^2 + h_R^2 + 2 h_L h_R cos f`,
///
/// so a fold angle exists if and only if d lies between its values for f = pi (shut) and f = 0 (flat).
///
/// **Claim.** The triple at either end is compatible if and only if d lies in that range. Hence one is if and
/// only if the other is.
///
/// *Proof.* Take an end and let `r_L`, `r_R` be the lengths of the sides from it to the two opposite
/// vertices, which the rest shape fixes. By the law of cosines gamma is a strictly increasing function of d
/// (continued as such beyond the d that make a triangle), and it is the angle between two rays that make the
/// angles alpha and beta with the edge's line and enclose the dihedral angle pi - f there. So gamma takes its
/// smallest value |alpha - beta| at the d of f = pi and its largest, min(alpha + beta, 2 pi - alpha - beta),
/// at the d of f = 0. Being increasing, it lies between these values exactly when d lies between those
/// distances. The range of d does not depend on the end chosen. ∎
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeAngles {
    /// The edge.
    pub edge: EdgeId,
    /// The triples at the edge's first and second end.
    pub ends: [AngleTriple; 2],
    /// The present distance of the two vertices opposite the edge, in metres.
    pub distance: f64,
    /// The least and the largest distance that a fold can produce, in metres.
    pub range: [f64; 2],
}

impl EdgeAngles {
    /// The angles of an interior edge at positions `x` (length 3V); `None` on the boundary.
    ///
    /// alpha, beta and the sides come from the rest lengths; only the distance of the two opposite vertices
    /// is taken from `x`, so that the answer is defined in strained states too.
    ///
    /// # Panics
    /// If `x` is not of length 3V.
    pub fn at(sheet: &Sheet, x: &[f64], e: EdgeId) -> Option<Self> {
        let t = sheet.topology();
        assert_eq!(x.len(), 3 * t.vertex_count(), "three numbers per vertex");
        let [Some(left), Some(right)] = t.opposite_vertices(e) else {
            return None;
        };
        Self::with_distance(sheet, e, norm(sub(at(x, left), at(x, right))))
    }

    /// The angles of an interior edge when the two vertices opposite to it are `distance` metres apart.
    pub(crate) fn with_distance(sheet: &Sheet, e: EdgeId, distance: f64) -> Option<Self> {
        let t = sheet.topology();
        let [Some(left), Some(right)] = t.edge_faces(e) else {
            return None;
        };
        let l = sheet.lengths()[e.index()];
        let sides =
            t.edges()[e.index()].map(|v| (side_at(sheet, left, e, v), side_at(sheet, right, e, v)));
        let ends = [0, 1].map(|k| {
            let ((to_left, to_right), (far_left, far_right)) = (sides[k], sides[1 - k]);
            AngleTriple {
                alpha: angle_from_lengths(l, to_left, far_left),
                beta: angle_from_lengths(l, to_right, far_right),
                gamma: continued_angle(to_left, to_right, distance),
            }
        });
        let (h_left, h_right) = (
            2.0 * sheet.face_areas()[left.index()] / l,
            2.0 * sheet.face_areas()[right.index()] / l,
        );
        let along = sides[0].0 * ends[0].alpha.cos() - sides[0].1 * ends[0].beta.cos();
        let range = [along.hypot(h_left - h_right), along.hypot(h_left + h_right)];
        Some(Self {
            edge: e,
            ends,
            distance,
            range,
        })
    }

    /// How far the distance lies inside its range, relative to the largest distance; negative when
    /// incompatible.
    pub fn margin(&self) -> f64 {
        (self.distance - self.range[0]).min(self.range[1] - self.distance) / self.range[1]
    }
}

/// Length of the side of `f` that is not `e` and ends in `v`.
fn side_at(sheet: &Sheet, f: FaceId, e: EdgeId, v: VertexId) -> f64 {
    let t = sheet.topology();
    let side = t
        .face_edges(f)
        .into_iter()
        .find(|&s| s != e && t.edges()[s.index()].contains(&v));
    side.map_or(f64::NAN, |s| sheet.lengths()[s.index()])
}

/// [`angle_from_lengths`], continued beyond pi and below 0 where there is no triangle.
fn continued_angle(a: f64, b: f64, c: f64) -> f64 {
    let (least, most) = ((a - b).abs(), a + b);
    if c > most {
        PI * (c / most)
    } else if c < least {
        c / least - 1.0
    } else {
        angle_from_lengths(a, b, c)
    }
}

/// A state in which the two faces of an edge cannot be where the other edges want them.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum AngleError {
    /// The angles violate the compatibility condition (Eq. 10 with both triangle inequalities).
    #[error(
        "{edge} between {} and {} cannot fold so: its opposite vertices are {distance:.9e} m apart, \
         but a fold reaches {:.9e} to {:.9e} m; at {} alpha = {:.9}, beta = {:.9} and gamma = {:.9} \
         rad, and gamma must lie between {:.9} and {:.9} (Liu, Tang and Joneja 2007, Eq. 10)",
        ends[0], ends[1], range[0], range[1], ends[*worse],
        triples[*worse].alpha, triples[*worse].beta, triples[*worse].gamma, triples[*worse].shut(), triples[*worse].flat()
    )]
    Incompatible {
        /// The edge.
        edge: EdgeId,
        /// Its ends.
        ends: [VertexId; 2],
        /// The triples at its ends.
        triples: [AngleTriple; 2],
        /// 0 or 1: the end whose triple is violated more.
        worse: usize,
        /// The distance of the opposite vertices, in metres.
        distance: f64,
        /// The distances that a fold reaches, in metres.
        range: [f64; 2],
    },
}

impl Advice for AngleError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Incompatible { .. } => Some("project the state onto the edge lengths first"),
        }
    }
}

/// Relative tolerance of [`check_compatibility`] that suits states computed in `f64`: exactly flat and shut
/// folds lie on the bounds, which rounding passes by about 1e-15.
pub const COMPATIBILITY_TOLERANCE: f64 = 1e-9;

/// Checks the compatibility condition of every interior edge at positions `x` (length 3V); the edge violated
/// most is reported.
///
/// A distance may lie outside its range by `tolerance` times its largest value, see
/// [`COMPATIBILITY_TOLERANCE`].
///
/// # Errors
/// [`AngleError::Incompatible`] with edge and angles.
///
/// # Panics
/// If `x` is not of length 3V.
pub fn check_compatibility(sheet: &Sheet, x: &[f64], tolerance: f64) -> Result<(), AngleError> {
    let t = sheet.topology();
    let all = t.edge_ids().filter_map(|e| EdgeAngles::at(sheet, x, e));
    let worst = all
        .filter(|a| a.margin().is_nan() || a.margin() < -tolerance)
        .reduce(|w, a| if a.margin() < w.margin() { a } else { w });
    match worst {
        None => Ok(()),
        Some(a) => Err(AngleError::Incompatible {
            edge: a.edge,
            ends: t.edges()[a.edge.index()],
            triples: a.ends,
            worse: usize::from(a.ends[1].margin() < a.ends[0].margin()),
            distance: a.distance,
            range: a.range,
        }),
    }
}

impl Sheet {
    /// The angles of a face at its three corners, in radians, from its edge lengths.
    pub fn corner_angles(&self, f: FaceId) -> [f64; 3] {
        let l = self
            .topology()
            .face_edges(f)
            .map(|e| self.lengths()[e.index()]);
        [0, 1, 2].map(|i| angle_from_lengths(l[i], l[(i + 2) % 3], l[(i + 1) % 3]))
    }

    /// The sum of the angles of all faces at a vertex, in radians: 2 pi at an interior vertex of a
    /// developable sheet.
    pub fn angle_sum(&self, v: VertexId) -> f64 {
        let t = self.topology();
        let at_v = |&f: &FaceId| {
            let corner = t.faces()[f.index()]
                .iter()
                .position(|&w| w == v)
                .unwrap_or(0);
            self.corner_angles(f)[corner]
        };
        t.vertex_faces(v).iter().map(at_v).sum()
    }

    /// The interior vertex whose angle sum differs most from 2 pi, with the defect 2 pi - sum in radians;
    /// `None` without an interior vertex.
    ///
    /// The defect is the Gaussian curvature at the vertex. It depends on the lengths alone, so it is the same
    /// in every state. A sheet can be laid flat near every vertex if and only if all defects vanish; a
    /// component without holes can then be laid flat as a whole. (A cone cut off at its tip has no defect,
    /// one hole, and cannot.)
    pub fn flatness_defect(&self) -> Option<(VertexId, f64)> {
        let t = self.topology();
        let interior = t.vertex_ids().filter(|&v| !t.is_boundary_vertex(v));
        let defects = interior.map(|v| (v, TAU - self.angle_sum(v)));
        defects.reduce(|worst, d| if d.1.abs() > worst.1.abs() { d } else { worst })
    }

    /// Refuses a sheet that cannot be laid flat near some vertex.
    ///
    /// # Errors
    /// [`MeshError::NotDevelopable`] when a defect exceeds `tolerance` radians.
    pub fn check_developable(&self, tolerance: f64) -> Result<(), MeshError> {
        match self.flatness_defect() {
            Some((vertex, defect)) if defect.abs() > tolerance => Err(MeshError::NotDevelopable {
                vertex,
                defect,
                tolerance,
            }),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests;
