//! The state of a sheet in motion.

/// Time, positions and velocities.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct State {
    /// Time, seconds.
    pub t: f64,
    /// Positions, `3V`, metres.
    pub x: Vec<f64>,
    /// Velocities, `3V`, metres per second; zero at pinned vertices.
    pub v: Vec<f64>,
}

impl State {
    /// Takes over another state of the same sheet, in place.
    pub fn copy_from(&mut self, other: &Self) {
        self.t = other.t;
        self.x.copy_from_slice(&other.x);
        self.v.copy_from_slice(&other.v);
    }

    /// Positions of the vertices, metres.
    pub fn vertex_positions(&self) -> &[[f64; 3]] {
        self.x.as_chunks().0
    }

    /// Velocities of the vertices, metres per second.
    pub fn vertex_velocities(&self) -> &[[f64; 3]] {
        self.v.as_chunks().0
    }

    /// The given positions at rest, at time zero.
    pub fn at_rest(x: Vec<f64>) -> Self {
        let v = vec![0.0; x.len()];
        Self { t: 0.0, x, v }
    }

    /// The given positions and velocities at time zero.
    pub fn moving(x: Vec<f64>, v: Vec<f64>) -> Self {
        Self { t: 0.0, x, v }
    }
}
