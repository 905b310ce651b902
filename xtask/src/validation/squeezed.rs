//! A strip between two plates.

use super::experiment::{Experiment, Job, Measured, Quantity};
use super::rest::Rest;
use super::specimen::{Line, material};
use anyhow::Result;
use isosheet_collide::{ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::contact::Coefficients;
use isosheet_dynamics::{Profile, RigidDisplacement, SheetModel};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// The bending test of two plates.
pub(super) const SQUEEZED: Experiment = Experiment {
    name: "between-plates",
    title: "Strip bent to a U between two plates",
    source: "Matthewson, Kurkjian and Gulati 1986 (elastica by elliptic integrals)",
    about: "A strip of 4 x 1 with rigidity D, Poisson's ratio 0, between two plates without friction that are closed to \
            a distance of about its width: their force F on the strip, by the distance d of its sides, F d^2 / (D w).",
    quantities: || vec![Quantity::new("F d^2 / (D w)", FORCE)],
    measure: squeezed,
};

/// `(integral from 0 to pi of sin(a)^(1/2) / 2^(1/2) da)^2`: the force bends the strip by `D k^2 / 2 = F sin
/// a` where it has turned by `a`, and the sides of the U are as far apart as `sin a` summed over its length.
const FORCE: f64 = 2.871_080_04;

const LENGTH: f64 = 4.0;

/// How far the plates are apart at the start and at the end; the distance of the sides of the U at the start.
const PLATES: [f64; 2] = [1.4, 1.0];
const WIDE: f64 = 1.3;

/// Limit of the strain: the chords of a coarse mesh are shorter than their arcs at the start.
const STRAIN: f64 = 0.05;

/// Steps over which the plates move.
const CLOSING: f64 = 20.0;

/// A point of the strip, bent to straight sides and half a circle.
fn bent([s, y, _]: [f64; 3]) -> [f64; 3] {
    let radius = 0.5 * WIDE;
    // From the middle of the arc.
    let s = s - 0.5 * LENGTH;
    let angle = s / radius;
    let [x, z] = match angle.abs() < FRAC_PI_2 {
        true => [radius * (1.0 - angle.cos()), radius * angle.sin()],
        false => {
            let side = s.abs() - FRAC_PI_2 * radius;
            [radius + side, radius * s.signum()]
        }
    };
    [x, y, z]
}

fn squeezed(job: Job) -> Result<Measured> {
    let sheet = job.rectangle([LENGTH, 1.0])?;
    let mut rest = Rest::new(&sheet, 1.0, LENGTH);
    let places = sheet.positions().as_chunks::<3>().0;
    rest.x = places.iter().copied().flat_map(bent).collect();
    let mut material = material(1.0, 0.0, 1e-3);
    material.strain_limit = STRAIN;
    let model = SheetModel::of_material(&sheet, &material).build()?;
    let mut contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))?;
    for (side, turn) in [(-1.0, 0.0), (1.0, PI)] {
        let z = Profile::SmoothStep {
            from: 0.0,
            to: side * 0.5 * (PLATES[1] - PLATES[0]),
            begin: 0.0,
            end: CLOSING * rest.step,
        };
        let turned = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), turn);
        let place = Vector3::new(0.0, 0.0, side * 0.5 * PLATES[0]);
        let plate = RigidDisplacement {
            pose: Isometry3::from_parts(place.into(), turned),
            z,
            ..RigidDisplacement::default()
        };
        let plate = Obstacle::new(Shape::HalfSpace, plate)?;
        contacts = contacts.with_body(plate, Coefficients::FRICTIONLESS)?;
    }
    let mut force = f64::NAN;
    rest.among(model, contacts, |simulation| {
        // Upwards on the upper plate.
        let loads = simulation.body_loads();
        force = 0.5 * (loads[1].force.z - loads[0].force.z);
    })?;
    let sides = [0.0, LENGTH].map(|s| Line::at(&sheet, 0, s).mean(&rest.x, 2));
    let distance = sides[1] - sides[0];
    Ok(Measured::at_rest(&rest, vec![force * distance * distance]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_force_is_that_of_the_elastica() {
        // Simpson's rule in `u` with `a = u^2`, which makes the integrand smooth at 0, up to the middle.
        let panels = 1000;
        let h = FRAC_PI_2.sqrt() / f64::from(panels);
        let integrand = |u: f64| (0.5 * (u * u).sin()).sqrt() * 2.0 * u;
        let sum = (0..panels).map(|i| {
            let u = h * f64::from(i);
            h / 6.0 * (integrand(u) + 4.0 * integrand(u + 0.5 * h) + integrand(u + h))
        });
        let distance = 2.0 * sum.sum::<f64>();
        assert!(
            (distance * distance - FORCE).abs() < 1e-6,
            "{}",
            distance * distance
        );
    }
}
