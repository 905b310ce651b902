//! A hanging strip: normal modes given by the zeros of the Laguerre polynomials.

use isosheet_dynamics::{SheetModel, State};
use isosheet_mesh::{MassMatrix, Sheet, VertexId};

/// Laguerre polynomial `L_n(x)`.
pub fn laguerre(n: usize, x: f64) -> f64 {
    let (mut last, mut now) = (0.0, 1.0);
    for k in 0..n {
        let k = k as f64;
        (last, now) = (now, ((2.0 * k + 1.0 - x) * now - k * last) / (k + 1.0));
    }
    now
}

/// The zeros of `L_n`, increasing, by bisection.
pub fn laguerre_zeros(n: usize) -> Vec<f64> {
    let mut zeros = Vec::new();
    let (steps, end) = (4000 * n, 4.0 * n as f64 + 2.0);
    for k in 0..steps {
        let (mut a, mut b) = (
            end * k as f64 / steps as f64,
            end * (k + 1) as f64 / steps as f64,
        );
        if laguerre(n, a) * laguerre(n, b) > 0.0 {
            continue;
        }
        for _ in 0..80 {
            let c = 0.5 * (a + b);
            if laguerre(n, a) * laguerre(n, c) <= 0.0 {
                b = c;
            } else {
                a = c;
            }
        }
        zeros.push(0.5 * (a + b));
    }
    zeros
}

/// The faces of a strip of rows of two vertices, `rows` of them below the first: each of its quadrilaterals
/// is cut by a diagonal.
pub fn strip_faces(rows: u32) -> Vec<[u32; 3]> {
    let between = |row: u32| {
        let i = 2 * row;
        [[i, i + 2, i + 1], [i + 1, i + 2, i + 3]]
    };
    (0..rows).flat_map(between).collect()
}

/// A strip of rows of two vertices hanging from its pinned top row, equal vertex masses.
///
/// Its side rods carry the weight of the rows below, so out of the plane each column is a
/// hanging chain: frequencies `sqrt(x_k g / L)` with `L_n(x_k) = 0`, displacement of the row
/// `i` from the bottom proportional to the Laguerre polynomial `L_i(x_k)`.
#[derive(Debug, Clone, Copy)]
pub struct HangingStrip {
    /// Rows below the pinned one.
    pub rows: usize,
    /// Distance between rows, metres.
    pub spacing: f64,
    /// Acceleration of gravity along -z, m/s2.
    pub gravity: f64,
    /// Displacement of the bottom row at the start, metres.
    pub amplitude: f64,
    /// Which mode, 0 for the slowest.
    pub mode: usize,
}

impl HangingStrip {
    fn zero(&self) -> f64 {
        laguerre_zeros(self.rows)[self.mode]
    }

    /// Circular frequency of the mode, rad/s.
    pub fn frequency(&self) -> f64 {
        (self.zero() * self.gravity / self.spacing).sqrt()
    }

    /// Positions with the bottom row displaced by `displacement`, exact lengths.
    fn place(&self, displacement: f64) -> Vec<f64> {
        let x = self.zero();
        let shape = |row: usize| displacement * laguerre(self.rows - row, x);
        let (mut z, mut positions) = (0.0, Vec::new());
        for row in 0..=self.rows {
            let y = if row == 0 { 0.0 } else { shape(row) };
            if row > 0 {
                let above = if row == 1 { 0.0 } else { shape(row - 1) };
                z -= (self.spacing.powi(2) - (y - above).powi(2)).sqrt();
            }
            positions.extend([0.0, y, z, 0.3, y, z]);
        }
        positions
    }

    /// The sheet; vertices 0 and 1 are pinned.
    pub fn model(&self) -> SheetModel {
        let faces = strip_faces(self.rows as u32);
        let sheet = Sheet::new(self.place(0.0), &faces).expect("a strip");
        let mass = MassMatrix::from_vertex_masses(vec![0.01; 2 * self.rows + 2]).expect("positive");
        SheetModel::with_mass(&sheet, mass)
            .expect("positive masses")
            .with_acceleration([0.0, 0.0, -self.gravity])
            .with_pins(&[VertexId(0), VertexId(1)])
            .expect("vertices exist")
    }

    /// Displaced in the mode, at rest.
    pub fn start(&self) -> State {
        State::at_rest(self.place(self.amplitude))
    }

    /// Displacements y of all vertices at time `t`, exact to second order in the amplitude.
    pub fn displacements(&self, t: f64) -> Vec<f64> {
        self.place(self.amplitude * (self.frequency() * t).cos())
            .chunks(3)
            .map(|p| p[1])
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_zeros() {
        let two = laguerre_zeros(2);
        assert!((two[0] - (2.0 - 2.0_f64.sqrt())).abs() < 1e-13);
        assert!((two[1] - (2.0 + 2.0_f64.sqrt())).abs() < 1e-13);
        let three = laguerre_zeros(3);
        for (got, want) in three.iter().zip([0.415_774_56, 2.294_280_36, 6.289_945_08]) {
            assert!((got - want).abs() < 1e-8, "{got} {want}");
        }
    }
}
