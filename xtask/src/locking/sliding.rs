//! The angle at which a sheet begins to slide down a plane.

use super::bisection::{Bracket, Verdict, bisect};
use super::course::{Kept, Plan, Scene};
use super::findings::Findings;
use super::isometry::{Isometry, Material};
use super::meshes::Pattern;
use super::plot::{Dot, Figure, Joined, Panel};
use super::records::Records;
use super::targets::{Target, at_most, kept};
use crate::draw::{Axis, Drawing};
use crate::report::Table;
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::Method;
use isosheet_mesh::Sheet;
use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};

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

/// Whether the sheet slides, which it does above the critical angle, and what its steps kept.
fn slides(
    isometry: Isometry,
    sheet: &Sheet,
    mu: f64,
    tangent: f64,
    plan: &Plan,
) -> Result<(Verdict, Kept)> {
    let (s, c) = tangent.atan().sin_cos();
    let material = Material {
        mass: MASS,
        rigidity: None,
        clamped: &[],
    };
    let model =
        isometry
            .model(sheet, material)?
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
    let verdict = if !course.ending.is_good() {
        Verdict::Undecided(course.ending.name().to_owned())
    } else if course.speed > 2.0 * options.rest_speed {
        Verdict::Above
    } else {
        Verdict::Below
    };
    Ok((verdict, course.kept))
}

/// Where a sheet begins to slide.
#[derive(Serialize, Deserialize)]
struct Slide {
    isometry: Isometry,
    pattern: Pattern,
    vertices: usize,
    /// Coefficient of friction.
    mu: f64,
    /// Tangents of the critical tilt over the coefficient.
    found: Bracket,
    kept: Kept,
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Drawing>)> {
    let effort = records.effort;
    let plan = Plan {
        step: 1.0 / 60.0,
        duration: 1.0,
        rest_speed: None,
        patience: effort.patience(0.5, 3.0),
    };
    let (halvings, cells) = effort.quick_or((4, 2), (9, 4));
    let coefficients: &[f64] = effort.quick_or(&[0.3], &[0.1, 0.3, 0.6]);
    let jobs: Vec<(Pattern, f64)> = Pattern::ALL
        .iter()
        .flat_map(|p| coefficients.iter().map(|mu| (*p, *mu)))
        .collect();
    let all = records.of_models(
        |_| jobs.clone(),
        |isometry, &(pattern, mu)| {
            let cell = SIDE / cells as f64;
            let sheet = pattern.rectangle([0.0; 2], [SIDE; 2], cell, 0.0)?;
            let mut kept = Kept::default();
            let found = bisect(TANGENTS, halvings, |part| {
                let (verdict, run) = slides(isometry, &sheet, mu, mu * part, &plan)?;
                kept.add(run);
                Ok(verdict)
            })?;
            Ok(Slide {
                isometry,
                pattern,
                vertices: sheet.topology().vertex_count(),
                mu,
                found,
                kept,
            })
        },
    )?;
    Ok((
        Findings {
            tables: vec![table(&all, halvings)],
            targets: Isometry::ALL
                .iter()
                .flat_map(|m| targets(*m, &all))
                .collect(),
            ..Findings::default()
        },
        Some(plot(&all, coefficients)),
    ))
}

fn table(all: &[Slide], halvings: usize) -> Table {
    Table::of(
        format!(
            "Critical tangent of the tilt over the coefficient of friction, 1 by Coulomb's law: {halvings} halvings"
        ),
        all,
        &[
            ("mesh", &|s| s.pattern.to_string().into()),
            ("V", &|s| s.vertices.into()),
            ("model", &|s| s.isometry.to_string().into()),
            ("friction", &|s| s.mu.into()),
            ("stays at", &|s| s.found.below.into()),
            ("slides at", &|s| s.found.above.into()),
            ("not decided", &|s| s.found.undecided.as_str().into()),
        ],
    )
    .named("sliding")
}

fn targets(isometry: Isometry, all: &[Slide]) -> Vec<Target> {
    let of = || all.iter().filter(|s| s.isometry == isometry);
    let errors: Vec<Option<f64>> = of()
        .map(|s| Some((s.found.middle()? - 1.0).abs()))
        .collect();
    let quantity = "relative error of the critical tangent, every mesh and coefficient";
    let mut targets = vec![at_most(isometry, quantity, 0.1, &errors)];
    targets.extend(kept(isometry, of().map(|s| s.kept)));
    targets
}

/// The critical tangent over the coefficient of friction.
fn plot(all: &[Slide], coefficients: &[f64]) -> Drawing {
    let dots = all.iter().map(|s| Dot {
        isometry: s.isometry,
        mesh: s.pattern.number(),
        // Beside one another: the values differ by less than a symbol.
        x: s.mu * 1.05_f64.powf(3.0 * s.isometry.aside() + s.pattern.number() as f64 - 1.0),
        y: s.found.middle(),
    });
    let ends = [
        coefficients[0] / 1.4,
        coefficients[coefficients.len() - 1] * 1.4,
    ];
    let ticks = coefficients.iter().map(|mu| (*mu, mu.to_string()));
    Figure {
        x: Axis::at("coefficient of friction ~μ~", ticks.collect()),
        rows: vec![(
            Axis::round("critical tangent of the tilt / ~μ~", [0.98, 1.02], 4),
            vec![Panel {
                title: "Beginning of sliding".into(),
                dots: dots.collect(),
                guides: vec![ends.map(|mu| [mu, 1.0]).to_vec()],
            }],
        )],
        meshes: Pattern::ALL.map(|p| p.to_string()).to_vec(),
        guide: "Coulomb's law".into(),
        joined: Joined::No,
        size: [220.0, 140.0],
    }
    .draw()
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
        for isometry in [Isometry::Rods, Isometry::Weak] {
            let at = |tangent: f64| slides(isometry, &sheet, 0.3, tangent, &plan).unwrap();
            let (below, kept) = at(0.25);
            assert!(matches!(below, Verdict::Below) && kept.gap.is_some_and(|gap| gap > 0.0));
            assert!(matches!(at(0.35).0, Verdict::Above));
        }
    }
}
