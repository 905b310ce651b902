//! Yardstick 8: the angle at which a sheet begins to slide down a plane.

use super::bisection::{Verdict, bisect};
use super::course::{Plan, Scene};
use super::effort::LockingEffort;
use super::findings::Findings;
use super::isometry::Isometry;
use super::meshes::Pattern;
use super::table::Results;
use crate::draw::Drawing;
use crate::progress::Progress;
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::Method;
use isosheet_mesh::Sheet;
use nalgebra::Isometry3;

pub(super) const ABOUT: &str = "A flat square of 0.2 m lies on a plane that is tilted (gravity is turned) and begins to slide where the tangent of the angle is the \
    coefficient of friction, by Coulomb's law. The sheet slides if it is faster than twice the speed of creep that counts as rest after 1 s.";

/// Side of the sheet, metres, and its mass, kilograms.
const SIDE: f64 = 0.2;
const MASS: f64 = 3.2e-3;

const GRAVITY: f64 = 9.8;

/// Part of the activation distance at which the sheet starts above the plane.
const START: f64 = 0.95;

/// Tangents of the angle, over the coefficient, between which the critical one is sought.
const TANGENTS: [f64; 2] = [0.8, 1.2];

/// Whether the sheet slides: above the critical angle it does.
fn slides(
    isometry: Isometry,
    sheet: &Sheet,
    mu: f64,
    tangent: f64,
    plan: &Plan,
) -> Result<Verdict> {
    let (s, c) = tangent.atan().sin_cos();
    let model = isometry
        .model(sheet, MASS)?
        .with_acceleration([GRAVITY * s, 0.0, -GRAVITY * c]);
    let options = ContactOptions::for_sheet(&model);
    let pose = Isometry3::translation(0.0, 0.0, -START * options.activation);
    let plane = Obstacle::fixed(Shape::HalfSpace, pose)?;
    let contacts = Contacts::new(&model, options)?.with_body(plane, Coefficients::equal(mu))?;
    let scene = Scene {
        model,
        start: sheet.positions().to_vec(),
        method: Method::default(),
        contacts: Some(contacts),
    };
    let course = scene.run(plan)?;
    Ok(if !course.ending.is_good() {
        Verdict::Undecided(course.ending.name().to_owned())
    } else if course.speed > 2.0 * options.rest_speed {
        Verdict::Above
    } else {
        Verdict::Below
    })
}

/// Runs the yardstick.
pub(super) fn make(effort: LockingEffort) -> Result<(Findings, Option<Drawing>)> {
    let plan = Plan {
        step: 1.0 / 60.0,
        duration: 1.0,
        rest_speed: None,
        patience: effort.patience(0.5, 3.0),
    };
    let (halvings, cells) = effort.pick((4, 2), (9, 4));
    let coefficients: &[f64] = effort.pick(&[0.3], &[0.1, 0.3, 0.6]);
    let mut table = Results::new(
        "sliding",
        format!(
            "Critical tangent of the tilt over the coefficient of friction, 1 by Coulomb's law: {halvings} halvings"
        ),
        &[
            "mesh",
            "V",
            "model",
            "friction",
            "stays at",
            "slides at",
            "not decided",
        ],
    );
    let bar = Progress::start("sliding", Pattern::ALL.len() * coefficients.len());
    for isometry in Isometry::ALL {
        for pattern in Pattern::ALL {
            let cell = SIDE / cells as f64;
            let sheet = pattern.rectangle([0.0; 2], [SIDE; 2], cell, 0.0)?;
            for &mu in coefficients {
                let found = bisect(TANGENTS, halvings, |part| {
                    slides(isometry, &sheet, mu, mu * part, &plan)
                })?;
                table.push(vec![
                    pattern.to_string().into(),
                    sheet.topology().vertex_count().into(),
                    isometry.to_string().into(),
                    mu.into(),
                    found.below.into(),
                    found.above.into(),
                    found.undecided.into(),
                ]);
                bar.step();
            }
        }
    }
    bar.finish("measured");
    Ok((Findings::table(table), None))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Well below and well above Coulomb's angle the verdict is known.
    #[test]
    fn a_sheet_stays_below_the_angle_and_slides_above() {
        let plan = Plan {
            step: 1.0 / 60.0,
            duration: 0.5,
            rest_speed: None,
            patience: std::time::Duration::from_secs(60),
        };
        let sheet = Pattern::UnionJack
            .rectangle([0.0; 2], [SIDE; 2], 0.5 * SIDE, 0.0)
            .unwrap();
        let at = |tangent: f64| slides(Isometry::Rods, &sheet, 0.3, tangent, &plan).unwrap();
        assert!(matches!(at(0.25), Verdict::Below));
        assert!(matches!(at(0.35), Verdict::Above));
    }
}
