//! Gauss curvature of triangle meshes: what the angles around a vertex lack to a whole turn.

use crate::vec3::{at, cross, dot, norm, sub};
use crate::{Sheet, Topology, VertexId, angle_from_lengths};
use std::f64::consts::TAU;

/// The angle deficit of each vertex at positions `x` (length 3V), radians: `2 pi` less the sum of the angles
/// of the faces around it, the integral of the Gauss curvature over the surface near the vertex (Gauss and
/// Bonnet); 0 at vertices of the boundary. Positive at the apex of a cone, negative at a saddle.
///
/// # Panics
/// If `x` is not of length 3V.
pub fn angle_deficits(t: &Topology, x: &[f64]) -> Vec<f64> {
    assert_eq!(x.len(), 3 * t.vertex_count(), "three numbers per vertex");
    let mut sums = vec![0.0; t.vertex_count()];
    for corners in t.faces() {
        for k in 0..3 {
            let [own, next, last] = [0, 1, 2].map(|j| corners[(k + j) % 3]);
            let [p, q] = [next, last].map(|v| sub(at(x, v), at(x, own)));
            sums[own.index()] += norm(cross(p, q)).atan2(dot(p, q));
        }
    }
    deficits(t, &sums)
}

/// What sums of angles lack to a whole turn at inner vertices.
fn deficits(t: &Topology, sums: &[f64]) -> Vec<f64> {
    let of_vertex = |v: VertexId| match t.is_boundary_vertex(v) {
        true => 0.0,
        false => TAU - sums[v.index()],
    };
    t.vertex_ids().map(of_vertex).collect()
}

/// The Gauss curvature that a sheet has besides that of its rest shape.
///
/// Lengths determine angles, so that the deficits of a mesh whose edges keep their lengths stay as in its
/// rest shape, however it is bent: a flat sheet, and one that is cut as a cone, has none besides. What is
/// left is the stretching of an elastic sheet, which is how far it is from developable.
#[derive(Clone, Debug, PartialEq)]
pub struct GaussCurvature {
    /// Deficits of the rest shape, radians.
    at_rest: Vec<f64>,
    /// A third of the area of the faces around each vertex at rest, square metres.
    areas: Vec<f64>,
    /// Change of the deficit of each vertex by a relative change of one of all lengths, at most.
    sensitivities: Vec<f64>,
    /// Length of the shortest edge, metres.
    shortest: f64,
}

impl GaussCurvature {
    /// Relative error of lengths that are said to be kept.
    pub const KEPT: f64 = 1e-12;

    /// Of a sheet with the lengths of its rest shape.
    pub fn new(sheet: &Sheet) -> Self {
        let t = sheet.topology();
        let count = t.vertex_count();
        let mut sums = vec![0.0; count];
        let (mut areas, mut sensitivities) = (vec![0.0; count], vec![0.0; count]);
        for (f, corners) in t.face_ids().zip(t.faces()) {
            let area = sheet.face_areas()[f.index()];
            for k in 0..3 {
                let [own, next, last] = [0, 1, 2].map(|j| corners[(k + j) % 3]);
                let length = |a, b| {
                    let edge = t.find_edge(a, b);
                    edge.map_or(0.0, |e| sheet.lengths()[e.index()])
                };
                let [b, c, a] = [length(own, next), length(own, last), length(next, last)];
                sums[own.index()] += angle_from_lengths(b, c, a);
                areas[own.index()] += area / 3.0;
                // The parts of `a` beside the foot of the altitude.
                let beside = 0.5 * (a * a + (b * b - c * c).abs()) / a;
                let both = beside + (a - beside).abs();
                sensitivities[own.index()] += a * (a + both) / (2.0 * area);
            }
        }
        let lengths = sheet.lengths().iter().copied();
        Self {
            at_rest: deficits(t, &sums),
            areas,
            sensitivities,
            shortest: lengths.fold(f64::INFINITY, f64::min),
        }
    }

    /// Its density at each vertex at positions `x` (length 3V), 1/m2: the [angle deficit](angle_deficits)
    /// without that of the rest shape over a third of the area of the faces around the vertex; 0 at vertices
    /// of the boundary, and where the deficit is one that an error of the lengths may hide.
    ///
    /// Of a face with the sides `a` opposite of the vertex, `b` and `c`, and the area `A`, the angle between
    /// `b` and `c` changes by `a (da - b' db/b - c' dc/c) / (2 A)`, where the altitude divides `a` in `b'`
    /// and `c'`. With relative errors of the lengths of at most `e` that is `e a (a + |b'| + |c'|) / (2 A)`,
    /// and the sum over the faces around a vertex is the bound. `e` is [`GaussCurvature::KEPT`], or the
    /// round-off of the positions over the shortest edge where that is larger.
    ///
    /// On smooth surfaces the deficits of the vertices of a region add up to the integral of the Gauss
    /// curvature over it, to second order in the size of the faces. On irregular meshes single densities
    /// scatter.
    ///
    /// # Panics
    /// If `x` is not of length 3V.
    pub fn at(&self, t: &Topology, x: &[f64]) -> Vec<f64> {
        let error = self.error_of_lengths(x);
        let now = angle_deficits(t, x).into_iter().zip(&self.at_rest);
        let of_vertex = |((now, rest), (area, sensitivity)): ((f64, &f64), (&f64, &f64))| {
            let left = now - rest;
            match left.abs() > error * sensitivity {
                true => left / area,
                false => 0.0,
            }
        };
        let meshes = self.areas.iter().zip(&self.sensitivities);
        now.zip(meshes).map(of_vertex).collect()
    }

    /// The relative error of lengths at positions `x`: that of lengths that are kept, or of the round-off of
    /// positions.
    pub fn error_of_lengths(&self, x: &[f64]) -> f64 {
        let largest = x.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        Self::KEPT.max(f64::EPSILON * largest / self.shortest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{self, Diagonals};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use std::f64::consts::PI;

    /// A pyramid of `n` sides with rings of faces: its faces at the apex have the angle
    /// `2 asin(sin(pi / n) sin b)` with the half angle `b` of the cone around it, and no other inner vertex
    /// has a deficit.
    #[test]
    fn a_cone_has_its_deficit_at_the_apex() {
        let (sides, half_angle, rings) = (9_u32, 0.6_f64, 3_u32);
        let mut x = vec![0.0; 3];
        for ring in 1..=rings {
            for k in 0..sides {
                let (s, c) = (TAU * f64::from(k) / f64::from(sides)).sin_cos();
                let r = 0.1 * f64::from(ring);
                let out = r * half_angle.sin();
                x.extend([out * c, out * s, -r * half_angle.cos()]);
            }
        }
        let mut faces = Vec::new();
        let vertex = |ring: u32, k: u32| 1 + ring * sides + k % sides;
        for k in 0..sides {
            faces.push([0, vertex(0, k), vertex(0, k + 1)]);
            for ring in 1..rings {
                let [a, b] = [k, k + 1].map(|k| vertex(ring - 1, k));
                let [c, d] = [k, k + 1].map(|k| vertex(ring, k));
                faces.extend([[a, c, d], [a, d, b]]);
            }
        }
        let sheet = Sheet::new(x, &faces).unwrap();
        let (t, x) = (sheet.topology(), sheet.positions());
        let found = angle_deficits(t, x);
        let side = 2.0 * ((PI / f64::from(sides)).sin() * half_angle.sin()).asin();
        assert!((found[0] - (TAU - f64::from(sides) * side)).abs() < 1e-14);
        assert!(found[1..].iter().all(|d| d.abs() < 1e-14), "{found:?}");
        // Cut as a cone it has nothing besides, flattened it lacks what it had.
        let left = GaussCurvature::new(&sheet);
        assert!(left.at(t, x).iter().all(|k| *k == 0.0));
        let flat: Vec<f64> = x
            .as_chunks::<3>()
            .0
            .iter()
            .flat_map(|p| [p[0], p[1], 0.0])
            .collect();
        let area: f64 = t
            .vertex_faces(VertexId(0))
            .iter()
            .map(|f| sheet.face_areas()[f.index()] / 3.0)
            .sum();
        let apex = left.at(t, &flat)[0];
        assert!(
            (apex + found[0] / area).abs() < 1e-11 * apex.abs(),
            "{apex}"
        );
    }

    /// A flat sheet has none, in any place; nor has one that is rolled up such that its edges keep their
    /// lengths.
    #[test]
    fn lengths_that_are_kept_leave_no_curvature() {
        let sheet = generate::grid(8, 6, 0.3, 0.2, Diagonals::Rising).unwrap();
        let t = sheet.topology();
        let gauss = GaussCurvature::new(&sheet);
        // Folded along grid lines, by an angle that varies, and far from the origin.
        let mut x = sheet.positions().to_vec();
        let step = 0.3 / 8.0;
        for p in x.as_chunks_mut::<3>().0 {
            let (columns, y) = ((p[0] / step).round() as usize, p[1]);
            let (mut at, mut angle) = ([7.0, -3.0], 0.2_f64);
            for k in 0..columns {
                at = [at[0] + step * angle.cos(), at[1] + step * angle.sin()];
                angle += 0.1 + 0.05 * k as f64;
            }
            *p = [at[0], y, at[1]];
        }
        assert!(gauss.at(t, sheet.positions()).iter().all(|k| *k == 0.0));
        assert!(gauss.at(t, &x).iter().all(|k| *k == 0.0));
        // A vertex that leaves the surface changes lengths.
        x[3 * 20 + 1] += 0.01;
        x[3 * 20 + 2] += 0.01;
        assert!(gauss.at(t, &x).iter().any(|k| *k != 0.0));
    }

    /// A grid on a helicoid of the twist `t`, `(u, v) -> (u cos t v, u sin t v, v)`, with the vertices that
    /// are not beside the rim moved at random by a part of a cell.
    fn helicoid(cells: usize, twist: f64, jitter: f64) -> (Sheet, Vec<f64>) {
        let flat = generate::grid(cells, cells, 1.0, 1.0, Diagonals::Falling).unwrap();
        let t = flat.topology();
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut x = flat.positions().to_vec();
        for (v, p) in t.vertex_ids().zip(x.as_chunks_mut::<3>().0) {
            let beside = |v| t.neighbours(v).any(|w| t.is_boundary_vertex(w));
            if !t.is_boundary_vertex(v) && !beside(v) {
                for c in &mut p[..2] {
                    *c += jitter / cells as f64 * rng.random_range(-1.0..1.0);
                }
            }
            let (u, v) = (p[0] - 0.5, p[1] - 0.5);
            let (s, c) = (twist * v).sin_cos();
            *p = [u * c, u * s, v];
        }
        (flat, x)
    }

    /// The Gauss curvature of a helicoid is `-t^2 / (1 + t^2 u^2)^2`: on its axis `-t^2`. Densities on a grid
    /// are of second order there. The sum of the deficits is the integral to second order; by Gauss and
    /// Bonnet it is that of the faces at the rim alone, however irregular the mesh is inside.
    #[test]
    fn deficits_of_a_helicoid_are_its_gauss_curvature() {
        let twist = 0.8_f64;
        let errors = [8, 16, 32].map(|cells| {
            let (flat, x) = helicoid(cells, twist, 0.0);
            let found = angle_deficits(flat.topology(), &x);
            let surface = Sheet::from_topology(flat.topology().clone(), x).unwrap();
            let own = GaussCurvature::new(&surface).areas;
            let middle = flat.vertices_where(|p| (p[0] - 0.5).hypot(p[1] - 0.5) < 1e-9)[0].index();
            (found[middle] / own[middle] / -twist.powi(2) - 1.0).abs()
        });
        assert!(errors[2] < 1e-3, "{errors:?}");
        assert!(
            errors[0] / errors[1] > 3.5 && errors[1] / errors[2] > 3.5,
            "{errors:?}"
        );
        // The integral over |u|, |v| <= a is -2 a t^2 int_{-a}^{a} (1 + t^2 u^2)^(-3/2) du, and that integral
        // is 2 a (1 + t^2 a^2)^(-1/2).
        let errors = [8, 16, 32].map(|cells| {
            let sum = |jitter: f64| -> f64 {
                let (flat, x) = helicoid(cells, twist, jitter);
                angle_deficits(flat.topology(), &x).iter().sum()
            };
            let found = sum(0.0);
            assert!((sum(0.3) - found).abs() < 1e-13 * (cells * cells) as f64);
            // A vertex stands for half a cell around it.
            let a = 0.5 - 0.5 / cells as f64;
            let exact = -4.0 * a * a * twist.powi(2) / (1.0 + (twist * a).powi(2)).sqrt();
            (found / exact - 1.0).abs()
        });
        assert!(errors[2] < 2e-3, "{errors:?}");
        assert!(errors[0] / errors[2] > 8.0, "{errors:?}");
    }

    /// The bound of the noise is one: relative changes of the lengths by `e` change no deficit by more.
    #[test]
    fn errors_of_lengths_do_not_reach_the_bound() {
        let sheet = generate::grid(5, 4, 0.3, 0.1, Diagonals::UnionJack).unwrap();
        let t = sheet.topology();
        let gauss = GaussCurvature::new(&sheet);
        let e = 1e-7;
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        for _ in 0..20 {
            let lengths: Vec<f64> = sheet
                .lengths()
                .iter()
                .map(|l| l * (1.0 + e * if rng.random_bool(0.5) { 1.0 } else { -1.0 }))
                .collect();
            let mut sums = vec![0.0; t.vertex_count()];
            for (f, corners) in t.face_ids().zip(t.faces()) {
                for v in corners {
                    let opposite = t
                        .face_edges(f)
                        .into_iter()
                        .find(|e| !t.edges()[e.index()].contains(v))
                        .unwrap();
                    let [b, c] = {
                        let mut beside = t.face_edges(f).into_iter().filter(|e| *e != opposite);
                        [0, 1].map(|_| lengths[beside.next().unwrap().index()])
                    };
                    sums[v.index()] += angle_from_lengths(b, c, lengths[opposite.index()]);
                }
            }
            for (v, (found, most)) in deficits(t, &sums)
                .iter()
                .zip(&gauss.sensitivities)
                .enumerate()
            {
                assert!(
                    found.abs() <= e * most * (1.0 + 1e-5),
                    "{v}: {found} {most}"
                );
            }
        }
    }
}
