//! How the volume of a shape is distributed.

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// The volume of a shape with its first and second moments, in its own frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// Volume, cubic metres.
    pub volume: f64,
    /// The centre of the volume, metres.
    pub centre: Vector3<f64>,
    /// The integral of `d d^T` over the volume, with the offset `d` from the centre, m^5. A body of density
    /// `rho` has the inertia `rho (trace(S) I - S)` about its centre, where this is `S`.
    pub second: Matrix3<f64>,
}

/// What is at the ends of a cylinder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Caps {
    /// Nothing: it is cut off flat.
    Flat,
    /// Half balls.
    Balls,
}

impl Moments {
    /// A cylinder of a length about the z axis, with its middle at the origin and what is at its ends:
    ///
    /// ```text
    /// across:  V_c r^2 / 4 + V_b r^2 / 5
    /// along:   V_c l^2 / 12 + V_b (r^2 / 5 + l^2 / 4 + 3 l r / 8)
    /// ```
    ///
    /// with the volumes of the cylinder and of both half balls, whose centres are `3 r / 8` beyond the ends
    /// of the axis.
    pub(super) fn about_axis(radius: f64, length: f64, caps: Caps) -> Self {
        let (r, l) = (radius, length);
        let disk = PI * r * r;
        let cylinder = disk * l;
        let balls = match caps {
            Caps::Balls => 4.0 / 3.0 * disk * r,
            Caps::Flat => 0.0,
        };
        let across = cylinder * r * r / 4.0 + balls * r * r / 5.0;
        let along =
            cylinder * l * l / 12.0 + balls * (r * r / 5.0 + l * l / 4.0 + 3.0 * l * r / 8.0);
        Self {
            volume: cylinder + balls,
            centre: Vector3::zeros(),
            second: Matrix3::from_diagonal(&Vector3::new(across, across, along)),
        }
    }

    /// A box about the origin, by half its edge lengths (metres).
    pub(super) fn of_box(half: [f64; 3]) -> Self {
        let volume = 8.0 * half.iter().product::<f64>();
        Self {
            volume,
            centre: Vector3::zeros(),
            second: Matrix3::from_diagonal(&Vector3::from(half.map(|h| volume * h * h / 3.0))),
        }
    }
}
