//! The drop of a heavy strip against the exact elastica, on meshes turned against the strip.

use super::cylinder::DIRECTIONS;
use super::dots::{Dot, Figure, Panel};
use super::isometry::{Isometry, Material};
use super::meshes::{Pattern, Strip};
use super::records::Records;
use super::sample::{OfModel, Sample, requirements};
use super::scene::{End, Scene};
use super::{Findings, order};
use crate::draw::{Axis, Charts};
use crate::report::{Table, extremes, number};
use crate::runs::Plan;
use anyhow::Result;
use isosheet_dynamics::SheetModel;
use isosheet_mesh::Sheet;
use isosheet_tests::Elastica;
use isosheet_tests::implicit_euler;
use serde::{Deserialize, Serialize};

pub(super) const ABOUT: &str = "A strip of 0.06 m width and 80 g/m² is clamped horizontally over 0.03 m and hangs free over 0.30 m: the heavy elastica. The \
    exact drop of the tip comes from its differential equation. The squares of the mesh are turned against the strip; an irregular mesh \
    has no direction, other angles are other seeds. Every mesh has vertices and edges along the line of the clamp, so that the clamp \
    itself does not lock. The drop is the mean over the vertices of the free edge.";

pub(super) const STRIP: Strip = Strip {
    free: 0.3,
    clamped: 0.03,
    width: 0.06,
};

/// Mass per area, kg/m2, acceleration of gravity, m/s2, and rate of damping, 1/s.
pub(super) const DENSITY: f64 = 0.08;
const GRAVITY: f64 = 9.8;
const DAMPING: f64 = 4.0;

/// Flexural rigidities, N m: cardboard and office paper.
const RIGIDITIES: [f64; 2] = [5e-3, 5e-4];

/// Steps of implicit Euler, seconds: long ones, which damp all motion.
pub(super) const STEP: f64 = 0.05;

/// The sheet is at rest when no vertex is faster, metres per second.
pub(super) const REST: f64 = 5e-4;

/// Squares across at which the error is limited.
const JUDGED: usize = 8;

/// A mesh and a rigidity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Job {
    pattern: Pattern,
    degrees: f64,
    across: usize,
    rigidity: f64,
}

/// A strip at rest, its drop, and the exact one (metres).
type Hung = Sample<Job, [f64; 2]>;

impl Hung {
    fn spacing(&self) -> f64 {
        STRIP.width / self.job.across as f64
    }

    /// The relative error of the drop, of a run that reached its end.
    fn error(&self) -> Option<f64> {
        let [drop, exact] = self.measured;
        self.course.is_good().then(|| drop / exact - 1.0)
    }

    /// Its size.
    fn size(&self) -> Option<f64> {
        self.error().map(f64::abs)
    }
}

/// All combinations of rigidities, patterns and directions, without the size of the mesh.
fn combinations(directions: &[f64]) -> Vec<Job> {
    let mut jobs = Vec::new();
    for rigidity in RIGIDITIES {
        for pattern in Pattern::ALL {
            jobs.extend(directions.iter().map(|&degrees| Job {
                pattern,
                degrees,
                across: 0,
                rigidity,
            }));
        }
    }
    jobs
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let plan = Plan::new(STEP, effort.quick_or(3.0, 10.0)).within(effort.quick_or(0.3, 4.0));
    let plan = plan.until_rest(REST);
    let sizes: &[usize] = effort.quick_or(&[2], &[2, 4, 8]);
    let directions: &[f64] = effort.quick_or(&[0.0, 22.5], &DIRECTIONS);
    let of_sizes = |job: Job| sizes.iter().map(move |&across| Job { across, ..job });
    let jobs: Vec<Job> = combinations(directions)
        .into_iter()
        .flat_map(of_sizes)
        .collect();
    let all = records.of_models(
        |_| jobs.clone(),
        |isometry, job| {
            let sheet = STRIP.mesh(job.pattern, job.across, job.degrees)?;
            let clamp = STRIP.clamp(&sheet);
            let material = Material::plate(&sheet, DENSITY, job.rigidity, &clamp);
            let (course, end) = scene(&sheet, isometry.model(&sheet, material)?)?.run(&plan)?;
            let drop = [drop(&sheet, &end), exact_drop(job.rigidity)];
            Ok((sheet.topology().vertex_count(), course, drop))
        },
    )?;
    let of_exact = |rigidity: f64| {
        let drop = exact_drop(rigidity);
        format!("Exact drop at D = {rigidity:e} N m: {drop:.4} m.")
    };
    let mut remarks = RIGIDITIES.map(of_exact).to_vec();
    remarks.extend(Isometry::ALL.map(|isometry| remark(isometry, &all)));
    let quantity = "relative error of the drop, 8 squares across, every mesh, direction and D";
    let findings = Findings {
        remarks,
        tables: vec![orders(&all, directions), table(&all, &plan)],
        targets: requirements(&all, |of| {
            let judged = of.with(|job| job.across == JUDGED);
            vec![judged.at_most(quantity, 0.02, Hung::size)]
        }),
        files: Vec::new(),
    };
    Ok((findings, Some(plot(&all, directions, sizes))))
}

/// A strip of this yardstick with its clamp, weight and damping, from flat.
pub(super) fn scene(sheet: &Sheet, model: SheetModel) -> Result<Scene> {
    let model = model
        .with_acceleration([0.0, 0.0, -GRAVITY])
        .with_damping(DAMPING)?
        .with_pins(&STRIP.clamp(sheet))?;
    Ok(Scene::flat(model, sheet).by(implicit_euler()))
}

/// How far the free edge is below the clamp at the end, metres: the mean over its vertices.
pub(super) fn drop(sheet: &Sheet, end: &End) -> f64 {
    0.0 - end.mean(&STRIP.tip(sheet), 2, |z| z)
}

/// The exact drop of the tip, metres.
pub(super) fn exact_drop(rigidity: f64) -> f64 {
    Elastica {
        length: STRIP.free,
        rigidity,
        weight: DENSITY * GRAVITY,
    }
    .drop()
}

fn table(all: &[Hung], plan: &Plan) -> Table {
    Table::of(
        format!(
            "Heavy strips: implicit Euler, steps of {STEP} s, until no vertex is faster than {REST} m/s or {} s are simulated; at most {} s of wall \
             time. A negative error is a strip that is too stiff; a positive one comes from the springs along the clamp, which are as soft as those between two \
             free rows of triangles and bend over half the length",
            plan.duration,
            plan.patience
        ),
        all,
        &[
            ("mesh", &|h| h.job.pattern.to_string().into()),
            ("turned by, degrees", &|h| h.job.degrees.into()),
            ("squares across", &|h| h.job.across.into()),
            ("D, N m", &|h| h.job.rigidity.into()),
            ("V", &|h| h.vertices.into()),
            ("model", &|h| h.isometry.to_string().into()),
            ("ending", &|h| h.course.ending.name().into()),
            ("t at the end, s", &|h| h.course.time.into()),
            ("factorisations", &|h| h.course.cost.factorisations.into()),
            ("CPU s per simulated s", &|h| h.course.cpu_rate().into()),
            ("speed left, m/s", &|h| h.course.speed.into()),
            ("drop, m", &|h| h.measured[0].into()),
            ("exact, m", &|h| h.measured[1].into()),
            ("error", &|h| h.error().into()),
            ("message", &|h| h.course.ending.message().into()),
        ],
    )
    .named("cantilever")
}

fn orders(all: &[Hung], directions: &[f64]) -> Table {
    // Errors against the spacing, of the runs that reached their end.
    let points = |(isometry, of): &(Isometry, Job)| -> Vec<[f64; 2]> {
        let across = |job: &Job| Job { across: 0, ..*job };
        let of = OfModel::of(*isometry, all).with(|job| across(job) == *of);
        let points = of.all.iter().filter_map(|h| Some([h.spacing(), h.size()?]));
        points.collect()
    };
    let all_models = Isometry::ALL.into_iter();
    let of_model = |m| {
        combinations(directions)
            .into_iter()
            .map(move |job| (m, job))
    };
    Table::of(
        "Fitted powers of h of the error of the drop, of the runs that reached their end",
        all_models.flat_map(of_model),
        &[
            ("mesh", &|(_, job)| job.pattern.to_string().into()),
            ("turned by, degrees", &|(_, job)| job.degrees.into()),
            ("D, N m", &|(_, job)| job.rigidity.into()),
            ("model", &|(isometry, _)| isometry.to_string().into()),
            ("runs", &|of| points(of).len().into()),
            ("power", &|of| order(&points(of), 0.0).into()),
        ],
    )
    .named("cantilever-orders")
}

fn remark(isometry: Isometry, all: &[Hung]) -> String {
    let of = OfModel::of(isometry, all).all;
    let errors = || of.iter().filter_map(|h| h.error());
    let Some(range) = extremes(errors()) else {
        return format!("{isometry}: no strip reaches the end.");
    };
    let ([low, high], ended, all) = (range.map(|e| number(100.0 * e)), errors().count(), of.len());
    format!(
        "{isometry}: {ended} of {all} strips reach the end, with errors of the drop from {low} to {high} %."
    )
}

/// The error against the spacing, a panel for every direction and a row for every rigidity.
fn plot(all: &[Hung], directions: &[f64], sizes: &[usize]) -> Charts {
    let rows = RIGIDITIES.map(|rigidity| {
        let panel = |&degrees: &f64| {
            let is_here = |h: &&Hung| (h.job.rigidity, h.job.degrees) == (rigidity, degrees);
            let dot = |h: &Hung| Dot::of(h, h.job.pattern.number(), h.spacing(), h.size());
            let dots = all.iter().filter(is_here).map(dot).collect();
            Panel::of_second_order(format!("mesh turned by {degrees}°"), dots)
        };
        let label = format!("error of the drop, D = {rigidity} N m");
        let y = Axis::decades(&label, all.iter().filter_map(Hung::size));
        (y, directions.iter().map(panel).collect())
    });
    let spacings: Vec<f64> = sizes.iter().map(|&n| STRIP.width / n as f64).collect();
    Figure::of_spacings(&spacings, rows.to_vec()).draw()
}

#[cfg(test)]
mod tests {
    use super::super::meshes::vertices;
    use super::*;

    #[test]
    fn every_strip_has_its_clamp_and_its_tip() {
        for pattern in Pattern::ALL {
            for degrees in DIRECTIONS {
                for across in [2, 4, 8] {
                    let sheet = STRIP.mesh(pattern, across, degrees).unwrap();
                    assert!((sheet.area() - 0.33 * 0.06).abs() < 1e-9);
                    let on = |x: f64| vertices(&sheet, |p| (p[0] - x).abs() < 1e-9).len();
                    assert!(on(0.0) > across / 2 && STRIP.tip(&sheet).len() > across / 2);
                    let clamp = STRIP.clamp(&sheet).len();
                    assert!(clamp > on(0.0) && on(-STRIP.clamped) > across / 2);
                }
            }
        }
    }
}
