//! Plates with a Poisson's ratio against closed forms and Ritz's method, linear theory.

use super::*;
use crate::ElasticSheet;
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{MassKind, MassMatrix};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A plate in the plane of x and y, clamped along `x = 0` by one more column of cells before it.
struct Cantilever {
    sheet: Sheet,
    pins: Vec<VertexId>,
    /// Columns of the vertices that are not pinned.
    free: Vec<usize>,
}

/// How a mesh runs: its diagonals, and by how many cells inner vertices are displaced at most.
type Pattern = (Diagonals, f64);

const PATTERNS: [Pattern; 4] = [
    (Diagonals::UnionJack, 0.0),
    (Diagonals::Falling, 0.0),
    (Diagonals::UnionJack, 0.2),
    (Diagonals::Rising, 0.2),
];

impl Cantilever {
    fn new([length, width]: [f64; 2], [along, across]: [usize; 2], pattern: Pattern) -> Self {
        let (diagonals, jitter) = pattern;
        let cell = length / along as f64;
        let grid = generate::grid(along + 1, across, length + cell, width, diagonals).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let mut x = grid.positions().to_vec();
        for (v, p) in x.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            p[0] -= cell;
            let is_boundary = grid.topology().is_boundary_vertex(VertexId::from_index(v));
            let is_on_line = p[0].abs() < 1e-9 * length;
            for (c, size) in p.iter_mut().zip([cell, width / across as f64]) {
                let shift = rng.random_range(-1.0..1.0) * jitter * size;
                if !is_boundary && !is_on_line {
                    *c += shift;
                }
            }
        }
        let sheet = Sheet::new(x, &grid.face_indices()).unwrap();
        let pins = sheet.vertices_where(|[x, _, _]| x < 1e-9 * length);
        let count = sheet.topology().vertex_count();
        let free = (0..count).filter(|v| !pins.contains(&VertexId::from_index(*v)));
        let free = free.collect();
        Self { sheet, pins, free }
    }

    fn plate(&self, poisson: f64) -> PlateBending {
        let rigidity = 1.0;
        let stiffness = PlateStiffness { rigidity, poisson };
        PlateBending::clamped(&self.sheet, stiffness, &self.pins).unwrap()
    }

    /// The second derivatives by some components of the positions of the free vertices.
    fn hessian<const N: usize>(
        &self,
        potential: &dyn Potential,
        x: &[f64],
        components: [usize; N],
    ) -> DMatrix<f64> {
        let count = N * self.sheet.topology().vertex_count();
        let mut entries = Entries {
            sheet: &self.sheet,
            components,
            matrix: DMatrix::zeros(count, count),
        };
        let memory = potential
            .remembering()
            .map_or_else(Vec::new, |p| p.memory());
        potential.add_hessian(At::new(0.0, x).with_memory(&memory), &mut entries);
        let free = self
            .free
            .iter()
            .flat_map(|v| (0..N).map(move |k| N * v + k));
        let free: Vec<usize> = free.collect();
        entries.matrix.select_rows(&free).select_columns(&free)
    }

    fn bending(&self, poisson: f64) -> DMatrix<f64> {
        self.hessian(&self.plate(poisson), self.sheet.positions(), [2])
    }

    /// Masses of the free vertices of a sheet of density 1.
    fn masses(&self) -> DVector<f64> {
        let mass = MassMatrix::from_density(&self.sheet, 1.0, MassKind::Lumped).unwrap();
        DVector::from_iterator(self.free.len(), self.free.iter().map(|v| mass.vertex[*v]))
    }
}

struct Entries<'a, const N: usize> {
    sheet: &'a Sheet,
    components: [usize; N],
    matrix: DMatrix<f64>,
}

impl<const N: usize> Entries<'_, N> {
    fn add(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
        for (i, k) in self.components.into_iter().enumerate() {
            for (j, l) in self.components.into_iter().enumerate() {
                self.matrix[(N * a.index() + i, N * b.index() + j)] += block[(k, l)];
            }
        }
    }
}

impl<const N: usize> HessianSink for Entries<'_, N> {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        self.add(v, v, block);
    }

    fn add_edge(&mut self, edge: EdgeId, block: &Matrix3<f64>) {
        let [a, b] = self.sheet.topology().edges()[edge.index()];
        self.add_pair(a, b, block);
    }

    fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
        self.add(a, b, block);
        self.add(b, a, &block.transpose());
    }
}

/// The eigenvalues of `a z = lambda b z`, `b` being positive definite, in rising order.
fn eigenvalues(a: DMatrix<f64>, b: DMatrix<f64>) -> Vec<f64> {
    let root = b.cholesky().expect("positive definite").l();
    let half = root.solve_lower_triangular(&a).unwrap();
    let whole = root.solve_lower_triangular(&half.transpose()).unwrap();
    let values = (0.5 * (&whole + whole.transpose())).symmetric_eigenvalues();
    let mut values: Vec<f64> = values.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Errors below which the errors of the reference count: Ritz's values are bounds from above, up to 0.4 %
/// above what all meshes of 16 cells across agree on (`cargo xtask validation`).
const REFERENCE: f64 = 5e-3;

/// The first frequencies of a square cantilever plate with Poisson's ratio 0.3, `omega a^2 sqrt(rho / D)`:
/// the first bend and the first twist (A. W. Leissa, "The free vibration of rectangular plates", J. Sound
/// Vib. 31, 1973).
#[test]
fn a_cantilever_plate_has_the_frequencies_of_the_literature() {
    for pattern in PATTERNS {
        let errors = [8, 16].map(|cells| {
            let plate = Cantilever::new([1.0; 2], [cells; 2], pattern);
            let mass = DMatrix::from_diagonal(&plate.masses());
            let found = eigenvalues(plate.bending(0.3), mass);
            [3.4718, 8.509].map(|exact| found[usize::from(exact > 4.0)].sqrt() / exact - 1.0)
        });
        let what = format!("{pattern:?}: {errors:?}");
        for [coarse, fine] in [0, 1].map(|k| errors.map(|e| e[k].abs())) {
            assert!(
                coarse < 0.04 && fine < 0.01 && fine < 0.4 * coarse,
                "{what}"
            );
        }
    }
}

/// `P L^3 / (3 E I)` with `E I / w = D (1 - nu^2)`: the tip of a narrow strip under a load at its end. (At
/// the clamp the strip cannot narrow: there, along about half of its width, it is stiffer by `nu^2`, under
/// thrice the mean squared moment.)
#[test]
fn a_narrow_strip_bends_as_a_beam_does() {
    let (length, width) = (1.0, 0.05);
    for pattern in PATTERNS {
        for poisson in [0.0_f64, 0.3, 0.5] {
            let exact = length * length * length / (3.0 * (1.0 - poisson * poisson));
            let errors = [2, 4].map(|across| {
                let strip = Cantilever::new([length, width], [20 * across, across], pattern);
                let x = strip.sheet.positions();
                let part = |v: &usize| {
                    let [x, y] = [x[3 * v], x[3 * v + 1]];
                    let is_inside = (1e-9..width - 1e-9).contains(&y);
                    match x > length - 1e-9 {
                        true if is_inside => 1.0 / across as f64,
                        true => 0.5 / across as f64,
                        false => 0.0,
                    }
                };
                let parts = strip.free.iter().map(part);
                let parts = DVector::from_iterator(strip.free.len(), parts);
                let load = &parts * width;
                let moved = strip.bending(poisson).cholesky().unwrap().solve(&load);
                moved.dot(&parts) / exact - 1.0
            });
            let what = format!("{pattern:?}, {poisson}: {errors:?}");
            let of_clamp = 3.0 * poisson * poisson * 0.5 * width / length;
            assert!(errors.iter().all(|e| e.abs() < of_clamp + 0.005), "{what}");
        }
    }
}

/// A plate on edge, clamped at one end, bends sidewards under its weight from `Gamma = w g L^3 / D` on, with
/// Poisson's ratio 0.3: the values of Ritz's method for three widths. The elastic sheet has the stresses in
/// its plane.
#[test]
fn a_plate_on_edge_buckles_where_ritz_says() {
    for (width, cells, exact) in [
        (0.1, [20, 4], 15.70),
        (0.2, [20, 4], 17.02),
        (0.5, [12, 6], 21.66),
    ] {
        for pattern in PATTERNS {
            let errors = [1, 2].map(|finer| {
                let plate = Cantilever::new([1.0, width], cells.map(|n| finer * n), pattern);
                let x = plate.sheet.positions();
                let membrane = ElasticSheet::new(&plate.sheet, 1.0, 0.3).unwrap();
                let in_plane = plate.hessian(&membrane, x, [0, 1]);
                let masses = plate.masses();
                let weight = masses.iter().flat_map(|m| [0.0, -*m]);
                let weight = DVector::from_iterator(2 * masses.len(), weight);
                let sag = in_plane.cholesky().unwrap().solve(&weight);
                let mut moved = x.to_vec();
                // So small that strains are linear in it.
                let part = 1e-8;
                for (k, v) in plate.free.iter().enumerate() {
                    moved[3 * v] += part * sag[2 * k];
                    moved[3 * v + 1] += part * sag[2 * k + 1];
                }
                let stress = plate.hessian(&membrane, &moved, [2]) / part;
                // `- stress z = (1 / Gamma) bending z`.
                let inverse = eigenvalues(-stress, plate.bending(0.3));
                1.0 / inverse.last().unwrap() / exact - 1.0
            });
            let what = format!("{width} {pattern:?}: {errors:?}");
            let [coarse, fine] = errors.map(f64::abs);
            assert!(
                coarse < 0.07 && fine < 0.02 && fine < (0.6 * coarse).max(REFERENCE),
                "{what}"
            );
        }
    }
}

/// A developable surface, whichever way it bends: the energy `D k^2 / 2` does not depend on Poisson's ratio,
/// at free edges as inside.
#[test]
fn poissons_ratio_means_nothing_where_a_sheet_is_developable() {
    let curvature = 0.4;
    for pattern in PATTERNS {
        for angle in [0.0_f64, 0.4, 1.1] {
            let mut strip = Cantilever::new([1.0, 0.5], [8, 4], pattern);
            strip.pins.clear();
            let bend = |p: &[f64; 3]| {
                let along = angle.cos() * p[0] + angle.sin() * p[1];
                [p[0], p[1], 0.5 * curvature * along * along]
            };
            let x = strip.sheet.positions().as_chunks::<3>().0.iter();
            let x: Vec<f64> = x.flat_map(bend).collect();
            let expected = 0.5 * curvature * curvature * strip.sheet.area();
            for poisson in [0.0, 0.3, 0.5] {
                let energy = strip.plate(poisson).energy(At::new(0.0, &x));
                assert!(
                    (energy / expected - 1.0).abs() < 1e-11,
                    "{pattern:?} {angle} {poisson}"
                );
            }
        }
    }
}
