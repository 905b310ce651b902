//! The equations of the isometry in weak form, by vertices.

use super::columns::{Columns, Edge};
use super::plane::RestPlane;
use super::{FaceId, Sheet, VertexId, WeakIsometryError};
use isosheet_mesh::LengthConstraints;
use nalgebra::{Matrix3, Vector2, Vector3};

/// The equations `C = W d`, two for each vertex in the order of the vertices: `C_i` has the numbers `2 i` and
/// `2 i + 1`. The equations of pinned vertices do not count: whoever uses the rows gives them no penalty.
#[derive(Debug)]
pub(crate) struct WeakRows {
    plane: RestPlane,
    /// Where the terms of each vertex begin, and their number.
    term_starts: Vec<usize>,
    terms: Vec<Term>,
    /// Where the vertices of each ring begin, and their number.
    ring_starts: Vec<usize>,
    /// The vertex itself first, then its neighbours.
    rings: Vec<VertexId>,
    columns: Columns,
    /// The largest of [`WeakRows::scales`].
    largest_scale: [f64; 2],
}

/// The share of an edge in the equations of a vertex.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term {
    pub(super) edge: u32,
    /// The ends, as places in the ring.
    pub(super) ends: [u32; 2],
    /// The column of `W`, 1/m2.
    pub(super) weights: Vector2<f64>,
}

/// The equations of one vertex.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ring<'a> {
    /// The vertex itself first, then its neighbours.
    pub(super) vertices: &'a [VertexId],
    pub(super) terms: &'a [Term],
}

impl WeakRows {
    /// # Errors
    /// [`WeakIsometryError::Folded`] if a face has no area in the plane.
    pub(super) fn new(sheet: &Sheet, plane: RestPlane) -> Result<Self, WeakIsometryError> {
        let topology = sheet.topology();
        let strains = topology.face_ids().map(|f| face_strain(sheet, &plane, f));
        let strains = strains.collect::<Result<Vec<_>, _>>()?;
        let mut rows = Self {
            plane,
            term_starts: vec![0],
            terms: Vec::new(),
            ring_starts: vec![0],
            rings: Vec::new(),
            columns: Columns::default(),
            largest_scale: [0.0; 2],
        };
        for v in topology.vertex_ids() {
            rows.add_ring(sheet, &strains, v);
        }
        rows.columns = Columns::new(sheet, &rows);
        let largest = |m: [f64; 2], s: [f64; 2]| [m[0].max(s[0]), m[1].max(s[1])];
        rows.largest_scale = rows.scales().into_iter().fold([0.0; 2], largest);
        Ok(rows)
    }

    /// Adds the equations of a vertex.
    fn add_ring(&mut self, sheet: &Sheet, strains: &[FaceStrain], v: VertexId) {
        let topology = sheet.topology();
        let first = self.rings.len();
        self.rings.push(v);
        self.rings.extend(topology.neighbours(v));
        let ring = &self.rings[first..];
        let faces = topology.vertex_faces(v);
        let area: f64 = faces.iter().map(|f| strains[f.index()].area).sum();
        let size = (2.0 * area / faces.len() as f64).sqrt();
        let first_term = self.terms.len();
        for f in faces {
            let strain = &strains[f.index()];
            let corner = topology.faces()[f.index()].iter().position(|w| *w == v);
            let gradient = strain.gradients[corner.expect("a face at the vertex")];
            let factor = size * strain.area / area;
            for (k, e) in topology.face_edges(*f).into_iter().enumerate() {
                let weights = factor * strain.by_edge(k, &gradient);
                let known = self.terms[first_term..].iter_mut();
                if let Some(term) = known.into_iter().find(|t| t.edge == e.0) {
                    term.weights += weights;
                    continue;
                }
                let ends = topology.edges()[e.index()].map(|end| {
                    let place = ring.iter().position(|w| *w == end);
                    place.expect("the corners of the faces are the ring") as u32
                });
                self.terms.push(Term {
                    edge: e.0,
                    ends,
                    weights,
                });
            }
        }
        self.term_starts.push(self.terms.len());
        self.ring_starts.push(self.rings.len());
    }

    /// Number of vertices; there are twice as many equations.
    pub(super) fn vertex_count(&self) -> usize {
        self.term_starts.len() - 1
    }

    /// Number of equations.
    pub(crate) fn len(&self) -> usize {
        2 * self.vertex_count()
    }

    /// Whether these are equations of a sheet with the given edges.
    pub(crate) fn fits(&self, edges: &LengthConstraints) -> bool {
        let of_ring = |(v, ring): (usize, Ring<'_>)| {
            ring.vertices[0].index() == v
                && ring.terms.iter().all(|t| {
                    let ends = t.ends.map(|end| ring.vertices[end as usize].index());
                    edges.edges().get(t.edge as usize) == Some(&ends)
                })
        };
        self.vertex_count() == edges.vertex_count() && self.iter().enumerate().all(of_ring)
    }

    pub(super) fn ring(&self, vertex: usize) -> Ring<'_> {
        Ring {
            vertices: &self.rings[self.ring_starts[vertex]..self.ring_starts[vertex + 1]],
            terms: &self.terms[self.term_starts[vertex]..self.term_starts[vertex + 1]],
        }
    }

    fn iter(&self) -> impl Iterator<Item = Ring<'_>> {
        (0..self.vertex_count()).map(|v| self.ring(v))
    }

    /// `C(x)`, strains, for positions `x` (`3V`, metres).
    pub(crate) fn residual_into(&self, x: &[f64], out: &mut [f64]) {
        self.columns.product_into(|edge| edge.error(x), out);
    }

    /// `J(x) v = W G(x) v` for displacements `v` (`3V`, metres).
    pub(crate) fn apply(&self, x: &[f64], v: &[f64], out: &mut [f64]) {
        let rate = |edge: &Edge| edge.difference(x).dot(&edge.difference(v));
        self.columns.product_into(rate, out);
    }

    /// `W^T m`, one entry for each edge: `J^T m = G^T W^T m`, and the Hessian of `m . C` is that of springs
    /// with these force densities.
    pub(crate) fn densities_into(&self, multipliers: &[f64], out: &mut [f64]) {
        self.columns.transpose_product_into(multipliers, out);
    }

    /// Largest `|C_i|` of the vertices that are free at positions `x`; not a number if any is.
    pub(crate) fn largest_violation(&self, x: &[f64], is_free: impl Fn(usize) -> bool) -> f64 {
        let free = (0..self.vertex_count()).filter(|v| is_free(*v));
        largest(free.map(|v| self.residual(v, x).norm()))
    }

    /// The same of values `C` that are known already.
    pub(crate) fn largest_of(&self, c: &[f64], is_free: impl Fn(usize) -> bool) -> f64 {
        let all = c.as_chunks::<2>().0.iter().enumerate();
        let free = all.filter(|(v, _)| is_free(*v));
        largest(free.map(|(_, c)| Vector2::from(*c).norm()))
    }

    /// `C_i(x)` of one vertex.
    fn residual(&self, vertex: usize, x: &[f64]) -> Vector2<f64> {
        let term = |t: &Term| self.columns.edge(t.edge).error(x) * t.weights;
        self.ring(vertex).terms.iter().map(term).sum()
    }

    /// The vertex with the largest `|C_i|` of those that are free.
    pub(crate) fn worst_vertex(&self, x: &[f64], is_free: impl Fn(usize) -> bool) -> VertexId {
        let free = (0..self.vertex_count()).filter(|v| is_free(*v));
        let worst = free
            .map(|v| (v, self.residual(v, x).norm()))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        VertexId(worst.map_or(0, |(v, _)| v as u32))
    }

    /// Of each equation the sums of `|W| l^2` and of `|W| l` (1/m) over the edges: round-off of coordinates
    /// of the size `X` is `eps` times the first plus `X` times the second.
    pub(crate) fn scales(&self) -> Vec<[f64; 2]> {
        let scales = self.iter().flat_map(|ring| {
            let sum = |power: i32| {
                let length = |t: &Term| self.columns.edge(t.edge).length;
                let term = |t: &Term| t.weights.norm() * length(t).powi(power);
                ring.terms.iter().map(term).sum()
            };
            [[sum(2), sum(1)]; 2]
        });
        scales.collect()
    }

    /// A bound on the round-off of all equations for coordinates of the given size, in units of the machine's
    /// precision.
    pub(crate) fn round_off(&self, size: f64) -> f64 {
        self.largest_scale[0] + size * self.largest_scale[1]
    }

    /// Of each equation the inverse of `J M^-1 J^T` at rest, the mean over the two of its vertex, kilograms
    /// square metres: a penalty of this size is as stiff as the masses. Zero at pinned vertices
    /// (`inverse_mass` zero).
    pub(crate) fn unit_penalties(&self, inverse_mass: impl Fn(VertexId) -> f64) -> Vec<f64> {
        let mut jacobian = Vec::new();
        let penalties = (0..self.vertex_count()).flat_map(|v| {
            let ring = self.ring(v);
            if inverse_mass(VertexId(v as u32)) == 0.0 {
                return [0.0; 2];
            }
            let rest = |w: VertexId| self.plane.at(w).push(0.0);
            ring.jacobian_into(rest, &mut jacobian);
            let gain = |(w, [a, b]): (&VertexId, &[Vector3<f64>; 2])| {
                inverse_mass(*w) * (a.norm_squared() + b.norm_squared())
            };
            let gain: f64 = ring.vertices.iter().zip(&jacobian).map(gain).sum();
            [2.0 / gain; 2]
        });
        penalties.collect()
    }

    /// The pairs of vertices without a common edge that share a ring; some of them several times.
    pub(crate) fn couplings(&self) -> impl Iterator<Item = [VertexId; 2]> + '_ {
        self.iter().flat_map(|ring| {
            let neighbours = &ring.vertices[1..];
            let pairs = |(i, a): (usize, &VertexId)| {
                let a = *a;
                neighbours[..i].iter().map(move |b| [a, *b])
            };
            neighbours
                .iter()
                .enumerate()
                .flat_map(pairs)
                .collect::<Vec<_>>()
        })
    }
}

impl Ring<'_> {
    /// The derivatives of the two equations by the position of each vertex of the ring, 1/m.
    pub(super) fn jacobian_into(
        &self,
        position: impl Fn(VertexId) -> Vector3<f64>,
        out: &mut Vec<[Vector3<f64>; 2]>,
    ) {
        out.clear();
        out.resize(self.vertices.len(), [Vector3::zeros(); 2]);
        for term in self.terms {
            let [a, b] = term.ends.map(|end| end as usize);
            let d = position(self.vertices[a]) - position(self.vertices[b]);
            for k in 0..2 {
                let row = term.weights[k] * d;
                out[a][k] += row;
                out[b][k] -= row;
            }
        }
    }
}

/// The largest of some numbers that are not negative; not a number if any is.
fn largest(mut values: impl Iterator<Item = f64>) -> f64 {
    // `max` would pass over a value that is not a number.
    let sum = |m: f64, v: f64| if v.is_nan() { Err(v) } else { Ok(m.max(v)) };
    values.try_fold(0.0, sum).unwrap_or_else(|nan| nan)
}

/// Green's strain of a face by the length errors of its edges, and the gradients of the hat functions.
struct FaceStrain {
    area: f64,
    /// `(E_11, E_12, E_22)` by the errors of the three edges, 1/m2.
    inverse: Matrix3<f64>,
    /// Of the three corners, 1/m.
    gradients: [Vector2<f64>; 3],
}

impl FaceStrain {
    /// `E g` for an error of one in the edge `k`.
    fn by_edge(&self, k: usize, g: &Vector2<f64>) -> Vector2<f64> {
        let s = self.inverse.column(k);
        Vector2::new(s[0] * g.x + s[1] * g.y, s[1] * g.x + s[2] * g.y)
    }
}

fn face_strain(
    sheet: &Sheet,
    plane: &RestPlane,
    face: FaceId,
) -> Result<FaceStrain, WeakIsometryError> {
    let topology = sheet.topology();
    let corners = topology.faces()[face.index()].map(|v| plane.at(v));
    let opposite = |k: usize| corners[(k + 2) % 3] - corners[(k + 1) % 3];
    let area = 0.5 * opposite(0).perp(&opposite(1));
    let rows = topology.face_edges(face).map(|e| {
        let [a, b] = topology.edges()[e.index()];
        let e = plane.at(a) - plane.at(b);
        Vector3::new(e.x * e.x, 2.0 * e.x * e.y, e.y * e.y).transpose()
    });
    let inverse = Matrix3::from_rows(&rows).try_inverse();
    Ok(FaceStrain {
        area,
        inverse: inverse.ok_or(WeakIsometryError::Folded { face })?,
        gradients: [0, 1, 2].map(|k| {
            let e = opposite(k);
            Vector2::new(-e.y, e.x) / (2.0 * area)
        }),
    })
}
