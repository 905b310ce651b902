//! One face of an elastic sheet.

mod derivatives;

use super::bend::Bend;
use super::law::{self, Law, Pull};
use super::limit::StrainLimit;
use super::slack::Slack;
use super::swelling::Swelling;
use crate::HessianSink;
use crate::potential::At;
use crate::vectors::point;
use isosheet_mesh::{EdgeId, FaceId, Part, Sheet, VertexId};
use nalgebra::{Complex, Matrix3, Vector2, Vector3};

/// A face with one constant strain.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Face {
    pub(super) id: FaceId,
    edges: [EdgeId; 3],
    /// Across from each edge: edge `i` leads from corner `i + 1` to corner `i + 2`, modulo three.
    corners: [VertexId; 3],
    /// Which of these two is the first end of each edge in the mesh.
    first_ends: [VertexId; 3],
    squared_lengths: [f64; 3],
    /// Rest area, m2.
    area: f64,
    /// The components `(E_11, sqrt(2) E_12, E_22)` of Green's strain, whose Euclidean norm is that of the
    /// strain, by the length errors of the edges; per square metre.
    strains: Matrix3<f64>,
    /// The inverse of `strains`: rows with the components of `e e^T` of each edge vector `e`.
    edge_squares: Matrix3<f64>,
    /// Flexural rigidity of the plate by which its bends are measured, N m; zero if they are not.
    pub(super) rigidity: f64,
    /// Its law by the length errors.
    law: Law,
    limit: StrainLimit,
    swelling: Swelling,
}

/// The state of a face.
#[derive(Debug)]
pub(super) struct Strained {
    /// The square of the factor by which its lengths at rest have grown.
    growth: f64,
    /// Edge vectors, from corner `i + 1` to corner `i + 2`.
    vectors: [Vector3<f64>; 3],
    /// The strain against the grown lengths, by the components of [`Face::strains`].
    strain: Vector3<f64>,
    /// Length errors beyond the chords of arcs, m2.
    beyond: Vector3<f64>,
    slack: Slack,
    pull: Pull,
}

/// What a face adds to a Hessian.
#[derive(Debug)]
pub(super) struct Blocks {
    /// At its corners.
    vertices: [Matrix3<f64>; 3],
    /// Along its edges, as the mesh has them.
    edges: [Matrix3<f64>; 3],
}

/// Part of its distance from the limit that a face keeps in one displacement, at least.
const KEPT_MARGIN: f64 = 0.1;

/// The part of a displacement that is safe is found up to this part of itself.
const BISECTION_WIDTH: f64 = 0.02;

/// The slack that can be paid for is found up to this part of itself.
const SLACK_WIDTH: f64 = 1e-3;

/// Parts of a displacement below this count as zero.
const SMALLEST_PART: f64 = 1e-12;

/// A chord is shorter than its arc of curvature `k` by a part of `(k l)^2 / 24`.
const ARC: f64 = 1.0 / 24.0;

impl Face {
    /// Without stiffness, with a limit of its strain; nothing if the face has no area.
    pub(super) fn new(sheet: &Sheet, face: FaceId, limit: f64) -> Option<Self> {
        let topology = sheet.topology();
        let edges = topology.face_edges(face);
        let ends = edges.map(|e| topology.edges()[e.index()]);
        // An edge and the next one share a corner, which is across from the third one.
        let shared = |[a, b]: [VertexId; 2], other: [VertexId; 2]| match other.contains(&a) {
            true => a,
            false => b,
        };
        let across = |i: usize| shared(ends[(i + 1) % 3], ends[(i + 2) % 3]);
        let lengths = edges.map(|e| sheet.lengths()[e.index()]);
        let area = sheet.face_areas()[face.index()];
        let [a, b, c] = lengths;
        // The edges as vectors that close.
        let along = (a * a + b * b - c * c) / (2.0 * a);
        let first = Vector2::new(a, 0.0);
        let second = Vector2::new(-along, 2.0 * area / a);
        let third = -(first + second);
        // Rows: `e^T E e` by the components of the strain.
        let row = |e: Vector2<f64>| {
            Vector3::new(e.x * e.x, std::f64::consts::SQRT_2 * e.x * e.y, e.y * e.y).transpose()
        };
        let errors = Matrix3::from_rows(&[row(first), row(second), row(third)]);
        let strains = errors.try_inverse()?;
        strains.iter().all(|s| s.is_finite()).then(|| Self {
            id: face,
            edges,
            corners: [across(0), across(1), across(2)],
            first_ends: ends.map(|[a, _]| a),
            squared_lengths: lengths.map(|l| l * l),
            area,
            strains,
            edge_squares: errors,
            rigidity: 0.0,
            law: Law::NONE,
            limit: StrainLimit::new(limit),
            swelling: Swelling::default(),
        })
    }

    /// This face as one of a sheet that is a part of a union of several.
    pub(super) fn in_union(self, part: &Part) -> Self {
        Self {
            id: part.face(self.id),
            edges: self.edges.map(|e| part.edge(e)),
            corners: self.corners.map(|v| part.vertex(v)),
            first_ends: self.first_ends.map(|v| part.vertex(v)),
            ..self
        }
    }

    /// Sets the law by the components of the strain.
    pub(super) fn set_law(&mut self, law: Law) {
        self.law = law.by(&self.strains);
    }

    pub(super) fn set_swelling(&mut self, swelling: Swelling) {
        self.swelling = swelling;
    }

    pub(super) fn swelling(&self) -> &Swelling {
        &self.swelling
    }

    pub(super) fn corners(&self) -> [VertexId; 3] {
        self.corners
    }

    /// The limit of its strain.
    pub(super) fn limit(&self) -> f64 {
        self.limit.limit()
    }

    /// Sets the limit of its strain.
    pub(super) fn set_limit(&mut self, limit: f64) {
        self.limit = StrainLimit::new(limit);
    }

    /// Measures what is beyond the limit in place of the elasticity, with a stiffness in joules per square
    /// metre.
    pub(super) fn measure_excess(&mut self, stiffness: f64) {
        self.law = Law::NONE;
        self.limit = self.limit.excess(stiffness);
    }

    /// The length errors of the edges as chords of arcs, m2, by the second derivatives of positions `H` (rows
    /// for the components of the positions): `-|H(e, e)|^2 / 24` with the edge vector `e`.
    pub(super) fn chords(&self, second: &Matrix3<f64>) -> Vector3<f64> {
        let along = second * self.edge_squares.transpose();
        Vector3::from_fn(|i, _| -ARC * along.column(i).norm_squared())
    }

    /// The law of the face where it bends.
    fn slack(&self, bend: &Bend) -> Slack {
        if self.rigidity == 0.0 {
            return Slack::NONE;
        }
        let size = self.mean_squared_length();
        Slack::of_bend(self.rigidity, size, bend.squared)
    }

    /// The stress against the lengths at rest, newtons per metre, by components `(s_11, sqrt(2) s_12, s_22)`,
    /// as in [`Face::strains`].
    pub(super) fn stress(&self, here: At<'_>, bend: &Bend) -> Vector3<f64> {
        let at = self.at(here, bend);
        self.edge_squares.tr_mul(&self.law_at(&at).slope())
    }

    /// The part of its slack, from 0 to 1, that a tension around it leaves, newtons per metre.
    pub(super) fn left_by(&self, tension: f64) -> f64 {
        Slack::left_by(tension, self.rigidity, self.mean_squared_length())
    }

    /// `exp(2 i a)`, with the angle `a` from its first axis to one of its edges.
    pub(super) fn direction(&self, edge: EdgeId) -> Complex<f64> {
        let k = self.edges.iter().position(|e| *e == edge);
        let k = k.expect("an edge of the face");
        let squares = self.edge_squares.row(k);
        let twice = std::f64::consts::SQRT_2 * squares[1];
        Complex::new(squares[0] - squares[2], twice) / self.squared_lengths[k]
    }

    /// The bend with slack for a squared bend of `wanted`, or as near to it as energy allows: slack that
    /// grows lets energy go, and slack that closes takes up what it had let go, and no more. So the slack of
    /// a face gives nothing to the motion, however the sheet bends to and fro.
    pub(super) fn with_slack(&self, here: At<'_>, bend: Bend, wanted: f64) -> Bend {
        if wanted == bend.squared {
            return bend;
        }
        let energy = |squared: f64| {
            let at = self.at(here, &Bend { squared, ..bend });
            self.area * self.law_at(&at).energy()
        };
        let before = energy(bend.squared);
        let cost = energy(wanted) - before;
        if cost <= bend.credit {
            return Bend {
                squared: wanted,
                credit: bend.credit - cost,
                ..bend
            };
        }
        // The energy falls with the slack: the least slack that can be paid for.
        let (mut dear, mut paid) = (wanted, bend.squared);
        while paid - dear > SLACK_WIDTH * paid {
            let middle = 0.5 * (dear + paid);
            match energy(middle) - before <= bend.credit {
                true => paid = middle,
                false => dear = middle,
            }
        }
        Bend {
            squared: paid,
            credit: bend.credit - (energy(paid) - before),
            ..bend
        }
    }

    /// The largest difference of the lengths of its edges at rest from those of another face at a time, as a
    /// part.
    pub(super) fn rest_difference(&self, other: &Self, t: f64) -> f64 {
        let squares = [self, other].map(|face| {
            let growth = face.swelling.growth(t);
            face.squared_lengths.map(|squared| growth * squared)
        });
        let parts = (0..3).map(|k| (0.5 * (squares[0][k] / squares[1][k] - 1.0)).abs());
        parts.fold(0.0, f64::max)
    }

    pub(super) fn area(&self) -> f64 {
        self.area
    }

    pub(super) fn mean_squared_length(&self) -> f64 {
        self.squared_lengths.iter().sum::<f64>() * (1.0 / 3.0)
    }

    /// `(12 D / K)^1/2`, metres.
    pub(super) fn thickness(&self) -> f64 {
        (12.0 * self.rigidity / self.law.stiffness()).sqrt()
    }

    /// From corner `i + 1` to corner `i + 2`, of positions or displacements.
    fn edge_vectors(&self, x: &[f64]) -> [Vector3<f64>; 3] {
        let [a, b, c] = self.corners.map(|v| point(x, v));
        [c - b, a - c, b - a]
    }

    /// Length errors of edges whose squares have grown, m2.
    fn errors(&self, vectors: &[Vector3<f64>; 3], growth: f64) -> Vector3<f64> {
        let squared = self.squared_lengths;
        let error = |k: usize| 0.5 * (vectors[k].norm_squared() - growth * squared[k]);
        Vector3::new(error(0), error(1), error(2))
    }

    /// Green's strain against the grown lengths, by the components of [`Face::strains`]; its Euclidean norm
    /// is Frobenius'.
    pub(super) fn strain(&self, At { t, x, .. }: At<'_>) -> Vector3<f64> {
        let growth = self.swelling.growth(t);
        self.strains * self.errors(&self.edge_vectors(x), growth) / growth
    }

    pub(super) fn at(&self, At { t, x, .. }: At<'_>, bend: &Bend) -> Strained {
        let growth = self.swelling.growth(t);
        let vectors = self.edge_vectors(x);
        let errors = self.errors(&vectors, growth);
        let (beyond, slack) = (errors - bend.chords, self.slack(bend));
        Strained {
            growth,
            strain: self.strains * errors / growth,
            vectors,
            pull: self.law.pull(&beyond, &slack),
            beyond,
            slack,
        }
    }

    fn law_at<'a>(&'a self, at: &'a Strained) -> law::At<'a> {
        law::At {
            law: &self.law,
            strain: &at.beyond,
            slack: &at.slack,
            pull: at.pull,
        }
    }

    /// Joules, with a `barrier` at the limit of this stiffness, joules per square metre; infinite at the
    /// limit and beyond.
    pub(super) fn energy(&self, at: &Strained, barrier: f64) -> f64 {
        let limit = self.limit.with_barrier(barrier);
        let elastic = self.law_at(at).energy();
        self.area * (elastic + limit.value(at.strain.norm_squared()))
    }

    /// What the slack has of it, joules.
    pub(super) fn slack_energy(&self, at: &Strained) -> f64 {
        self.area * self.law_at(at).stored()
    }

    /// Size of the round-off in the energy of a face at rest whose coordinates are of the given size,
    /// metres.
    pub(super) fn round_off(&self, size: f64) -> f64 {
        let squared = self.mean_squared_length();
        let error = f64::EPSILON * (squared.sqrt() * size + squared);
        self.area * self.law.trace() * error * error
    }

    /// The derivatives of the energy by the length errors, newtons per metre.
    fn densities(&self, at: &Strained, barrier: f64) -> Vector3<f64> {
        let limit = self.limit.with_barrier(barrier);
        let [slope, _] = limit.derivatives(at.strain.norm_squared());
        let barrier = 2.0 * slope * (self.strains.transpose() * at.strain) / at.growth;
        self.area * (self.law_at(at).slope() + barrier)
    }

    /// The second derivatives of the energy by the length errors, newtons per cubic metre.
    fn tangent_law(&self, at: &Strained, barrier: f64) -> Matrix3<f64> {
        let limit = self.limit.with_barrier(barrier);
        let mut law = self.law_at(at).curvature();
        let [slope, curvature] = limit.derivatives(at.strain.norm_squared());
        if slope != 0.0 {
            let along = self.strains.transpose() * at.strain;
            let barrier = 2.0 * slope * self.strains.transpose() * self.strains
                + 4.0 * curvature * along * along.transpose();
            law += barrier / (at.growth * at.growth);
        }
        self.area * law
    }

    pub(super) fn add_gradient(&self, at: &Strained, barrier: f64, gradient: &mut [f64]) {
        self.add_forces(at, &self.densities(at, barrier), gradient);
    }

    /// Adds what force densities of the edges (newtons per metre) do to the gradient.
    fn add_forces(&self, at: &Strained, densities: &Vector3<f64>, gradient: &mut [f64]) {
        let forces = [0, 1, 2].map(|i| densities[i] * at.vectors[i]);
        for (i, corner) in self.corners.into_iter().enumerate() {
            let force = forces[(i + 1) % 3] - forces[(i + 2) % 3];
            for c in 0..3 {
                gradient[3 * corner.index() + c] += force[c];
            }
        }
    }

    /// Adds `scale` times the change of the gradient by the part of the length errors that is of second order
    /// in the displacement `dx`, `|dx_a - dx_b|^2 / 2`.
    pub(super) fn add_second_order(
        &self,
        at: &Strained,
        dx: &[f64],
        barrier: f64,
        scale: f64,
        gradient: &mut [f64],
    ) {
        let changes = self.edge_vectors(dx);
        let second = Vector3::from(changes.map(|d| 0.5 * d.norm_squared()));
        let densities = scale * self.tangent_law(at, barrier) * second;
        self.add_forces(at, &densities, gradient);
    }

    /// The strain that a displacement from `x` may end with: it keeps its distance from the limit but for
    /// [`KEPT_MARGIN`] of it.
    fn bound(&self, strain: f64) -> f64 {
        let limit = self.limit();
        limit - KEPT_MARGIN * (limit - strain)
    }

    /// Whether a displacement from where it is ends within the limit, and keeps a part of the distance from
    /// it; `end` is the face there.
    pub(super) fn stays_within(&self, at: At<'_>, end: &Strained) -> bool {
        let strain = end.strain.norm();
        // Most faces stay within what any strain at the start allows.
        strain <= self.bound(0.0) || strain <= self.bound(self.strain(at).norm())
    }

    /// Its part of the Hessian; `part` says which part of the force density of an edge counts for its
    /// curvature.
    pub(super) fn blocks(&self, at: &Strained, barrier: f64, part: fn(f64) -> f64) -> Blocks {
        let law = self.tangent_law(at, barrier);
        let densities = self.densities(at, barrier).map(part);
        // Products of the derivatives of two length errors, `law_ij v_i v_j^T`.
        let product = |i: usize, j: usize| {
            let v = &at.vectors;
            law[(i, j)] * v[i] * v[j].transpose()
        };
        let own = [0, 1, 2].map(|i| product(i, i) + Matrix3::from_diagonal_element(densities[i]));
        let mixed = [0, 1, 2].map(|i| product((i + 1) % 3, (i + 2) % 3));
        let others = |i: usize| ((i + 1) % 3, (i + 2) % 3);
        Blocks {
            vertices: [0, 1, 2].map(|i| {
                let (j, k) = others(i);
                own[j] + own[k] - mixed[i] - mixed[i].transpose()
            }),
            edges: [0, 1, 2].map(|i| {
                // Rows at corner `j`, columns at corner `k`.
                let (j, k) = others(i);
                let block = mixed[k] + mixed[j] - own[i] - mixed[i].transpose();
                let is_first = self.first_ends[i] == self.corners[j];
                if is_first { block } else { block.transpose() }
            }),
        }
    }

    pub(super) fn add_hessian(&self, blocks: &Blocks, hessian: &mut dyn HessianSink) {
        for i in 0..3 {
            hessian.add_vertex(self.corners[i], &blocks.vertices[i]);
            hessian.add_edge(self.edges[i], &blocks.edges[i]);
        }
    }

    /// The strains along the displacement `dx` from a state, unless all of it keeps the distance from the
    /// limit but for [`KEPT_MARGIN`] of it.
    pub(super) fn course(&self, at: &Strained, dx: &[f64]) -> Option<StrainCourse> {
        let Strained {
            growth,
            vectors,
            strain: e0,
            ..
        } = at;
        let changes = self.edge_vectors(dx);
        let first = Vector3::from_fn(|k, _| vectors[k].dot(&changes[k]));
        let second = Vector3::from_fn(|k, _| 0.5 * changes[k].norm_squared());
        let [e1, e2] = [first, second].map(|errors| self.strains * errors / *growth);
        let bound = self.bound(e0.norm());
        let course = StrainCourse {
            strains: [*e0, e1, e2],
            bound,
        };
        (!course.is_within(1.0)).then_some(course)
    }
}

/// The strain of a face along a displacement.
#[derive(Debug)]
pub(super) struct StrainCourse {
    /// Coefficients of its powers of the part of the displacement.
    strains: [Vector3<f64>; 3],
    /// What its norm may be.
    bound: f64,
}

impl StrainCourse {
    /// Whether norms alone show that it stays within its bound up to a part.
    fn is_within(&self, part: f64) -> bool {
        let [e0, e1, e2] = self.strains.map(|e| e.norm());
        e0 + part * (e1 + part * e2) <= self.bound
    }

    /// Largest part of the displacement, at most `most`, along which it stays within its bound.
    ///
    /// Along the displacement the square of the norm is a polynomial of degree four. Where its coefficients
    /// in Bernstein's basis on an interval are below a bound, it is below the bound; otherwise the interval
    /// is halved.
    pub(super) fn safe_part(&self, most: f64) -> f64 {
        if self.is_within(most) {
            return most;
        }
        let Self {
            strains: [e0, e1, e2],
            bound,
        } = self;
        let powers = [
            e0.norm_squared() - bound * bound,
            2.0 * e0.dot(e1),
            e1.norm_squared() + 2.0 * e0.dot(e2),
            2.0 * e1.dot(e2),
            e2.norm_squared(),
        ];
        let (mut from, mut to) = (0.0, most);
        while from < most {
            if is_negative(&powers, from, to) {
                from = to;
                to = most;
            } else {
                to = 0.5 * (from + to);
                if to - from <= BISECTION_WIDTH * from {
                    break;
                }
                if to < SMALLEST_PART {
                    return 0.0;
                }
            }
        }
        from
    }
}

/// Whether the polynomial with the coefficients `powers` is proven to be negative on the interval.
fn is_negative(powers: &[f64; 5], from: f64, to: f64) -> bool {
    /// Binomial coefficients `4 over k`.
    const OVER: [f64; 5] = [1.0, 4.0, 6.0, 4.0, 1.0];
    // Taylor's coefficients at the start of the interval, by repeated synthetic division, in units of its
    // length.
    let mut taylor = *powers;
    for k in 0..5 {
        for i in (k..4).rev() {
            taylor[i] += from * taylor[i + 1];
        }
    }
    let length = to - from;
    let mut scale = 1.0;
    for t in &mut taylor {
        *t *= scale;
        scale *= length;
    }
    // Bernstein's coefficients: `b_i = sum_j (i over j) / (4 over j) t_j`.
    (0..5).all(|i| {
        let (mut over, mut sum) = (1.0, 0.0);
        for j in 0..=i {
            sum += over / OVER[j] * taylor[j];
            over *= (i - j) as f64 / (j + 1) as f64;
        }
        sum < 0.0
    })
}
