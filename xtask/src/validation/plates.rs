//! Flat plates under small loads, isotropic and orthotropic.

use super::experiment::{Experiment, Job, Measured, Quantity};
use super::rest::Rest;
use super::specimen::{Line, boundary, clamped_along, material, with_plate};
use crate::runs::meshes::{SNAP, nearest, vertices};
use anyhow::Result;
use isosheet_dynamics::{MaterialDirection, OrthotropicPlate, PlateBending, PlateStiffness};
use isosheet_mesh::{FlatCut, Sheet};
use std::f64::consts::PI;

/// Thickness over the side, and the deflection over the side: a thousandth of the thickness, so that no
/// tension matters.
const THICKNESS: f64 = 1e-2;
const DEFLECTION: f64 = 1e-5;

/// Square plates.
pub(super) const SQUARES: Experiment = Experiment {
    name: "square-plates",
    title: "Square plates under a uniform load",
    source: "Timoshenko and Woinowsky-Krieger 1959, tables 8 and 35; digits: series, Taylor and Govindjee 2004",
    about: "Plates of the side a with the load q per area, Poisson's ratio 0.3: the deflection of the middle over q \
            a^4 / D, with simply supported and with clamped sides.",
    quantities: || {
        vec![
            Quantity::new("simply supported", SIMPLE),
            Quantity::new("clamped", CLAMPED),
        ]
    },
    measure: squares,
};

const SIMPLE: f64 = 4.062_353e-3;
const CLAMPED: f64 = 1.265_319e-3;

fn squares(job: Job) -> Result<Measured> {
    let sheet = square(job)?;
    let law = PlateStiffness {
        rigidity: 1.0,
        poisson: 0.3,
    };
    let simple = deflection(&sheet, PlateBending::new(&sheet, law)?, SIMPLE)?;
    let clamped = clamped_along(&sheet, law, &boundary(&sheet))?;
    let mut measured = simple;
    measured.add(deflection(&sheet, clamped, CLAMPED)?);
    Ok(measured)
}

/// The deflection of the middle over the load; `expected` is about that.
fn deflection(sheet: &Sheet, plate: PlateBending, expected: f64) -> Result<Measured> {
    let load = DEFLECTION / expected;
    let material = material(1.0, 0.3, THICKNESS);
    let model = with_plate(sheet, &material, &boundary(sheet), plate)?;
    let mut rest = Rest::new(sheet, DEFLECTION, 1.0);
    rest.under(model.with_acceleration([0.0, 0.0, -load]))?;
    let middle = rest.x[3 * nearest(sheet, [0.5; 2]).index() + 2];
    Ok(Measured::at_rest(&rest, vec![-middle / load]))
}

/// A square with lines through its middle, which is a vertex.
fn square(job: Job) -> Result<Sheet> {
    let mut flat = FlatCut::of(&job.rectangle([1.0; 2])?);
    for normal in [[1.0, 0.0], [0.0, 1.0]] {
        flat.split([0.5; 2], normal, SNAP / job.across as f64);
    }
    Ok(flat.sheet()?)
}

/// Rigidities along, across, of both together, of twist.
const ORTHOTROPIC: [f64; 4] = [4.0, 1.0, 0.3, 0.8];

fn orthotropic(coupling: f64, direction: [f64; 3]) -> OrthotropicPlate {
    let [along, across, _, twist] = ORTHOTROPIC;
    OrthotropicPlate {
        along,
        across,
        coupling,
        twist,
        direction: MaterialDirection::Uniform(direction),
    }
}

/// Orthotropic plates.
pub(super) const GRAINED: Experiment = Experiment {
    name: "orthotropic",
    title: "Orthotropic plates",
    source: "Timoshenko and Woinowsky-Krieger 1959, section 85, and Lekhnitskii 1968, section 75 (double series)",
    about: "Plates with D11 = 4, D22 = 1, D66 = 0.8: a strip clamped at one end under a force at the other, along and \
            across the direction of the material (D12 = 0), and a simply supported square under a uniform load (D12 = \
            0.3).",
    quantities: || {
        vec![
            Quantity::new("tip, along", 1.0),
            Quantity::new("tip, across", 1.0),
            Quantity::new("middle of the square, D22 = 1", navier()),
        ]
    },
    measure: grained,
};

/// `w D22 / (q a^4)` in the middle of a simply supported square.
fn navier() -> f64 {
    let [along, across, coupling, twist] = ORTHOTROPIC;
    let odd = || (1..200).step_by(2).map(f64::from);
    let term = |m: f64, n: f64| {
        let sign = if (m + n) % 4.0 == 2.0 { 1.0 } else { -1.0 };
        let mixed = 2.0 * (coupling + 2.0 * twist) * m * m * n * n;
        sign * 16.0 / (PI.powi(6) * m * n) / (along * m.powi(4) + mixed + across * n.powi(4))
    };
    odd()
        .flat_map(|m| odd().map(move |n| (m, n)))
        .map(|(m, n)| term(m, n))
        .sum()
}

fn grained(job: Job) -> Result<Measured> {
    let [length, width] = [1.0, 0.25];
    let strip = job.rectangle([length, width])?;
    let clamp = vertices(&strip, |[x, ..]| x < 1e-9);
    let tip = Line::at(&strip, 0, length);
    let material = material(2.0, 0.0, THICKNESS);
    let mut all = Measured::default();
    for (direction, rigidity) in [([1.0, 0.0, 0.0], 4.0), ([0.0, 1.0, 0.0], 1.0)] {
        let force = 3.0 * rigidity * width / length.powi(3) * DEFLECTION;
        let plate = clamped_along(&strip, orthotropic(0.0, direction), &clamp)?;
        let model = with_plate(&strip, &material, &clamp, plate)?;
        let mut rest = Rest::new(&strip, DEFLECTION, 1.0);
        rest.under(model.with_force(tip.load(force, [0.0, 0.0, 1.0])?))?;
        let tip = tip.mean(&rest.x, 2) / DEFLECTION;
        all.add(Measured::at_rest(&rest, vec![tip]));
    }
    let sheet = square(job)?;
    let plate = orthotropic(ORTHOTROPIC[2], [1.0, 0.0, 0.0]);
    all.add(deflection(
        &sheet,
        PlateBending::new(&sheet, plate)?,
        navier(),
    )?);
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of an isotropic plate the series is Timoshenko's 0.00406.
    #[test]
    fn the_series_is_that_of_a_known_plate() {
        let [along, across, ..] = ORTHOTROPIC;
        // Of a plate that is four times as stiff along as across, between the answers for its two rigidities.
        assert!(navier() < SIMPLE / across && navier() > SIMPLE / along);
    }
}
