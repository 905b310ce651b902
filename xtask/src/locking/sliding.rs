//! The angle at which a sheet begins to slide down a plane.

use super::Findings;
use super::bisection::{Bracket, Verdict, search};
use super::dots::{Dot, Figure, Panel};
use super::isometry::{Isometry, Material};
use super::meshes::Pattern;
use super::records::Records;
use super::sample::{Sample, requirements};
use super::scene::Scene;
use crate::draw::{Axis, Charts};
use crate::report::Table;
use crate::runs::{Course, Plan};
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
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

/// Whether the sheet slides, which it does above the critical angle, and what its steps kept.
fn slides(
    isometry: Isometry,
    sheet: &Sheet,
    mu: f64,
    tangent: f64,
    plan: &Plan,
) -> Result<(Verdict, Course)> {
    let (s, c) = tangent.atan().sin_cos();
    let model = isometry
        .model(sheet, Material::limp(MASS))?
        .with_acceleration([GRAVITY * s, 0.0, -GRAVITY * c]);
    let options = ContactOptions::for_sheet(&model);
    let pose = Isometry3::translation(0.0, 0.0, -START * options.activation);
    let plane = Obstacle::fixed(Shape::HalfSpace, pose)?;
    let contacts = Contacts::new(&model, options)?.with_body(plane, Coefficients::equal(mu))?;
    let (course, _) = Scene::flat(model, sheet).touching(contacts).run(plan)?;
    let verdict = if !course.is_good() {
        Verdict::Undecided(course.ending.name().to_owned())
    } else if course.speed > 2.0 * options.rest_speed {
        Verdict::Above
    } else {
        Verdict::Below
    };
    Ok((verdict, course))
}

/// Where a sheet begins to slide: tangents of the critical tilt over the coefficient of friction, of a
/// mesh and a coefficient.
type Slide = Sample<(Pattern, f64), Bracket>;

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let plan = Plan::new(1.0 / 60.0, 1.0).within(effort.quick_or(0.5, 3.0));
    let (halvings, cells) = effort.quick_or((4, 2), (9, 4));
    let coefficients: &[f64] = effort.quick_or(&[0.3], &[0.1, 0.3, 0.6]);
    let of = |p: Pattern| coefficients.iter().map(move |mu| (p, *mu));
    let jobs: Vec<(Pattern, f64)> = Pattern::ALL.into_iter().flat_map(of).collect();
    let all: Vec<Slide> = records.of_models(
        |_| jobs.clone(),
        |isometry, &(pattern, mu)| {
            let cell = SIDE / cells as f64;
            let sheet = pattern.rectangle([0.0; 2], [SIDE; 2], cell, 0.0)?;
            let (worst, found) = search(TANGENTS, halvings, |part| {
                slides(isometry, &sheet, mu, mu * part, &plan)
            })?;
            Ok((sheet.topology().vertex_count(), worst, found))
        },
    )?;
    let quantity = "relative error of the critical tangent, every mesh and coefficient";
    let error = |s: &Slide| Some((s.measured.middle()? - 1.0).abs());
    let findings = Findings {
        tables: vec![table(&all, halvings)],
        targets: requirements(&all, |of| vec![of.at_most(quantity, 0.1, error)]),
        ..Findings::default()
    };
    Ok((findings, Some(plot(&all, coefficients))))
}

fn table(all: &[Slide], halvings: usize) -> Table {
    Table::of(
        format!(
            "Critical tangent of the tilt over the coefficient of friction, 1 by Coulomb's law: {halvings} halvings"
        ),
        all,
        &[
            ("mesh", &|s| s.job.0.to_string().into()),
            ("V", &|s| s.vertices.into()),
            ("model", &|s| s.isometry.to_string().into()),
            ("friction", &|s| s.job.1.into()),
            ("stays at", &|s| s.measured.below.into()),
            ("slides at", &|s| s.measured.above.into()),
            ("not decided", &|s| s.measured.undecided.as_str().into()),
        ],
    )
    .named("sliding")
}

/// The critical tangent over the coefficient of friction.
fn plot(all: &[Slide], coefficients: &[f64]) -> Charts {
    let dots = all.iter().map(|s| {
        let (pattern, mu) = s.job;
        // Beside one another: the values differ by less than a symbol.
        let aside = 3.0 * s.isometry.aside() + pattern.number() as f64 - 1.0;
        let place = mu * 1.05_f64.powf(aside);
        Dot::of(s, pattern.number(), place, s.measured.middle())
    });
    let last = coefficients.len() - 1;
    let ends = [coefficients[0] / 1.4, coefficients[last] * 1.4];
    let ticks = coefficients.iter().map(|mu| (*mu, mu.to_string()));
    let x = Axis::at("coefficient of friction μ", ticks.collect());
    let y = Axis::linear("critical tangent of the tilt / μ", [0.98, 1.02]);
    let panel = Panel {
        guides: vec![ends.map(|mu| [mu, 1.0]).to_vec()],
        ..Panel::new("Beginning of sliding", dots.collect())
    };
    let names = Pattern::ALL.map(|p| p.to_string()).to_vec();
    Figure {
        guide: "Coulomb's law".into(),
        ..Figure::of_row(x, y, vec![panel], names, [220.0, 140.0])
    }
    .draw()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Well below and well above Coulomb's angle the verdict is known.
    #[test]
    fn a_sheet_stays_below_the_angle_and_slides_above() {
        let plan = Plan::new(1.0 / 60.0, 0.5).within(60.0);
        let sheet = Pattern::UnionJack
            .rectangle([0.0; 2], [SIDE; 2], 0.5 * SIDE, 0.0)
            .unwrap();
        for isometry in [Isometry::Rods, Isometry::Elastic] {
            let at = |tangent: f64| slides(isometry, &sheet, 0.3, tangent, &plan).unwrap();
            let (below, course) = at(0.25);
            assert!(matches!(below, Verdict::Below) && course.gap.is_some_and(|gap| gap > 0.0));
            assert!(matches!(at(0.35).0, Verdict::Above));
        }
    }
}
