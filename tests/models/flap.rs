//! A free symmetric flap: two triangles hinged at their common edge.

use isosheet_dynamics::{SheetModel, State};
use isosheet_mesh::{MassMatrix, Sheet};

/// Two equal isosceles triangles that share their base, opening freely without gravity.
///
/// With half-angle `a` from the symmetry plane the kinetic energy is
/// `T = m h^2 a'^2 (cos^2 a + M / (M + 2m) sin^2 a)`, so `a(t)` follows by one quadrature.
#[derive(Debug, Clone, Copy)]
pub struct Flap {
    /// Altitude of each triangle over the hinge, metres.
    pub altitude: f64,
    /// Mass of each apex, kilograms.
    pub apex_mass: f64,
    /// Mass of the hinge, half at each end, kilograms.
    pub hinge_mass: f64,
    /// Half-angle at the start, radians.
    pub start_angle: f64,
    /// Its rate at the start, radians per second.
    pub start_rate: f64,
}

impl Default for Flap {
    fn default() -> Self {
        Self {
            altitude: 0.4,
            apex_mass: 0.2,
            hinge_mass: 0.3,
            start_angle: 0.4,
            start_rate: 1.5,
        }
    }
}

impl Flap {
    fn ratio(&self) -> f64 {
        self.hinge_mass / (self.hinge_mass + 2.0 * self.apex_mass)
    }

    fn place(&self, angle: f64) -> Vec<f64> {
        let (s, c) = angle.sin_cos();
        let h = self.altitude;
        // The centre of mass stays at the origin.
        let hinge = -2.0 * self.apex_mass * h * c / (self.hinge_mass + 2.0 * self.apex_mass);
        vec![
            0.0,
            -0.25,
            hinge,
            0.0,
            0.25,
            hinge,
            h * s,
            0.0,
            hinge + h * c,
            -h * s,
            0.0,
            hinge + h * c,
        ]
    }

    /// The sheet: vertices 0 and 1 are the hinge, 2 and 3 the apexes.
    pub fn model(&self) -> SheetModel {
        let sheet = Sheet::new(self.place(self.start_angle), &[[0, 2, 1], [0, 1, 3]])
            .expect("two triangles");
        let (m, hinge) = (self.apex_mass, 0.5 * self.hinge_mass);
        let mass = MassMatrix::from_vertex_masses(vec![hinge, hinge, m, m]).expect("positive");
        SheetModel::with_mass(&sheet, mass).expect("positive masses")
    }

    /// Start positions and velocities.
    pub fn start(&self) -> State {
        let (s, c) = self.start_angle.sin_cos();
        let h = self.altitude * self.start_rate;
        let hinge = 2.0 * self.apex_mass * h * s / (self.hinge_mass + 2.0 * self.apex_mass);
        State::moving(
            self.place(self.start_angle),
            vec![
                0.0,
                0.0,
                hinge,
                0.0,
                0.0,
                hinge,
                h * c,
                0.0,
                hinge - h * s,
                -h * c,
                0.0,
                hinge - h * s,
            ],
        )
    }

    fn speed(&self, angle: f64) -> f64 {
        (angle.cos().powi(2) + self.ratio() * angle.sin().powi(2)).sqrt()
    }

    /// Exact positions at time `t`: the angle solves
    /// `int_{a0}^{a} s(a) da = s(a0) a0' t` with `s = sqrt(cos^2 + M/(M+2m) sin^2)`.
    pub fn exact(&self, t: f64) -> Vec<f64> {
        let goal = self.speed(self.start_angle) * self.start_rate * t;
        let travelled = |angle: f64| {
            // Composite Gauss-Legendre, three points, 400 panels: error far below round-off.
            let panels = 400;
            let width = (angle - self.start_angle) / f64::from(panels);
            (0..panels)
                .map(|p| {
                    let mid = self.start_angle + (f64::from(p) + 0.5) * width;
                    let off = 0.5 * width * 0.6_f64.sqrt();
                    width / 18.0
                        * (5.0 * self.speed(mid - off)
                            + 8.0 * self.speed(mid)
                            + 5.0 * self.speed(mid + off))
                })
                .sum::<f64>()
        };
        let mut angle = self.start_angle + self.start_rate * t;
        for _ in 0..30 {
            angle -= (travelled(angle) - goal) / self.speed(angle);
        }
        self.place(angle)
    }
}
