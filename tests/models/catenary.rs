//! A strip that hangs by both ends: the discrete catenary.

use isosheet_dynamics::{SheetModel, State};
use isosheet_mesh::{MassMatrix, Sheet, VertexId};

/// A straight strip of equal cells, one cell wide, hung by the four vertices of its end rungs at the same
/// height. With five or more rods in a chain it is free to find its shape.
///
/// With equal masses `m` at all vertices both long sides are chains of equal rods `l`, and neither rungs
/// nor diagonals are loaded. Each inner vertex asks for `H (tan phi_{k+1} - tan phi_k) = m g` of the rods
/// on its two sides, where `H` is their common horizontal pull and `phi_k` are the slopes of the rods in
/// the order of the chain. By symmetry
///
/// ```text
/// tan phi_k = (k - (n + 1) / 2) m g / H,    k = 1 .. n,    l sum_k cos phi_k = span,
/// ```
///
/// which has one solution `H > 0` for every span below `n l`.
pub struct Catenary {
    /// Rods in each chain.
    pub rods: usize,
    /// Length of a rod, metres.
    pub length: f64,
    /// Distance of the ends, metres; below `rods * length`.
    pub span: f64,
    /// Metres per second squared.
    pub gravity: f64,
}

/// Width of the strip, metres.
const WIDTH: f64 = 0.3;
/// Mass of a vertex, kilograms.
const MASS: f64 = 0.01;

impl Catenary {
    /// The strip, flat: vertices `k` and `n + 1 + k` are the rungs.
    pub fn sheet(&self) -> Sheet {
        let n = self.rods as u32;
        let row = |y: f64| (0..=n).flat_map(move |k| [self.length * f64::from(k), y, 0.0]);
        let quad = |k: u32| {
            let (a, b, c, d) = (k, k + 1, n + 2 + k, n + 1 + k);
            [[a, b, c], [a, c, d]]
        };
        let faces: Vec<[u32; 3]> = (0..n).flat_map(quad).collect();
        Sheet::new(row(0.0).chain(row(WIDTH)).collect(), &faces).expect("a strip")
    }

    /// The model, ends pinned at the span.
    pub fn model(&self) -> SheetModel {
        let sheet = self.sheet();
        let n = self.rods as u32;
        let vertex = vec![MASS; sheet.topology().vertex_count()];
        let mass = MassMatrix::from_vertex_masses(vertex).expect("positive");
        SheetModel::with_mass(&sheet, mass)
            .expect("valid")
            .with_acceleration([0.0, 0.0, -self.gravity])
            .with_pins(&[0, n, n + 1, 2 * n + 1].map(VertexId))
            .expect("the ends exist")
    }

    /// Positions with the given slopes of the rods (radians), from the first end on.
    fn place(&self, angles: &[f64]) -> Vec<f64> {
        let mut p = [0.0, 0.0];
        let mut chain = vec![p];
        for angle in angles {
            p = [
                p[0] + self.length * angle.cos(),
                p[1] + self.length * angle.sin(),
            ];
            chain.push(p);
        }
        let row = |y: f64| chain.iter().flat_map(move |[x, z]| [*x, y, *z]);
        row(0.0).chain(row(WIDTH)).collect()
    }

    /// Angles `k -> angle(k - (n + 1) / 2, parameter)` whose horizontal parts add up to the span. The
    /// parameter, with which the angles grow, is found by bisection.
    fn fit(&self, angle: impl Fn(f64, f64) -> f64, mut range: [f64; 2]) -> (Vec<f64>, f64) {
        let angles = |parameter: f64| -> Vec<f64> {
            let middle = 0.5 * (self.rods as f64 - 1.0);
            (0..self.rods)
                .map(|k| angle(k as f64 - middle, parameter))
                .collect()
        };
        for _ in 0..200 {
            let parameter = 0.5 * (range[0] + range[1]);
            let width: f64 = angles(parameter)
                .iter()
                .map(|a| self.length * a.cos())
                .sum();
            range[usize::from(width < self.span)] = parameter;
        }
        let parameter = 0.5 * (range[0] + range[1]);
        (angles(parameter), parameter)
    }

    /// A start with the right lengths that hangs as an arc of a circle, at rest.
    pub fn start(&self) -> State {
        let most = std::f64::consts::TAU / self.rods as f64;
        State::at_rest(self.place(&self.fit(|k, turn| k * turn, [0.0, most]).0))
    }

    /// Equilibrium: positions, and the horizontal pull `H` of each chain, newtons.
    pub fn exact(&self) -> (Vec<f64>, f64) {
        let (angles, ratio) = self.fit(|k, ratio| (k * ratio).atan(), [0.0, 1e3]);
        (self.place(&angles), MASS * self.gravity / ratio)
    }

    /// Weight of a vertex, newtons.
    pub fn vertex_weight(&self) -> f64 {
        MASS * self.gravity
    }
}
