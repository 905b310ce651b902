//! The drop of a heavy strip against the exact elastica, on meshes turned against the strip.

use super::course::{Course, Plan, Scene};
use super::cylinder::DIRECTIONS;
use super::elastica::Elastica;
use super::findings::Findings;
use super::isometry::{Isometry, Material};
use super::meshes::{Pattern, Strip};
use super::plot::{Dot, Figure, Panel, order};
use super::records::Records;
use super::targets::{Target, at_most, kept};
use crate::draw::{Axis, Drawing};
use crate::report::{Table, number};
use anyhow::Result;
use isosheet_dynamics::{Method, SheetModel};
use isosheet_mesh::Sheet;
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

/// A strip at rest.
#[derive(Serialize, Deserialize)]
struct Hung {
    pattern: Pattern,
    across: usize,
    degrees: f64,
    rigidity: f64,
    vertices: usize,
    isometry: Isometry,
    course: Course,
    drop: f64,
    exact: f64,
}

impl Hung {
    fn measure(
        isometry: Isometry,
        (pattern, degrees): (Pattern, f64),
        across: usize,
        (rigidity, exact): (f64, f64),
        plan: &Plan,
    ) -> Result<Self> {
        let sheet = STRIP.mesh(pattern, across, degrees)?;
        let clamp = STRIP.clamp(&sheet);
        let material = Material {
            mass: DENSITY * sheet.area(),
            rigidity: Some(rigidity),
            clamped: &clamp,
        };
        let model = isometry.model(&sheet, material)?;
        let course = scene(&sheet, model)?.run(plan)?;
        Ok(Self {
            pattern,
            across,
            degrees,
            rigidity,
            vertices: sheet.topology().vertex_count(),
            isometry,
            drop: drop(&sheet, &course),
            exact,
            course,
        })
    }

    fn spacing(&self) -> f64 {
        STRIP.width / self.across as f64
    }

    /// The relative error of the drop, of a run that reached its end.
    fn error(&self) -> Option<f64> {
        let is_good = self.course.ending.is_good();
        is_good.then(|| self.drop / self.exact - 1.0)
    }
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Drawing>)> {
    let effort = records.effort;
    let plan = Plan {
        step: STEP,
        duration: effort.quick_or(3.0, 10.0),
        rest_speed: Some(REST),
        patience: effort.patience(0.3, 4.0),
    };
    let sizes: &[usize] = effort.quick_or(&[2], &[2, 4, 8]);
    let directions: &[f64] = effort.quick_or(&[0.0, 22.5], &DIRECTIONS);
    let exact = RIGIDITIES.map(|rigidity| (rigidity, exact_drop(rigidity)));
    let mut jobs = Vec::new();
    for of in exact {
        for pattern in Pattern::ALL {
            for &degrees in directions {
                jobs.extend(sizes.iter().map(|&across| ((pattern, degrees), across, of)));
            }
        }
    }
    let all = records.of_models(
        |_| jobs.clone(),
        |isometry, (mesh, across, of)| Hung::measure(isometry, *mesh, *across, *of, &plan),
    )?;
    let mut remarks: Vec<String> = exact
        .iter()
        .map(|(rigidity, drop)| format!("Exact drop at D = {rigidity:e} N m: {drop:.4} m."))
        .collect();
    remarks.extend(Isometry::ALL.map(|isometry| remark(isometry, &all)));
    Ok((
        Findings {
            remarks,
            tables: vec![orders(&all, directions), table(&all, &plan)],
            targets: Isometry::ALL
                .iter()
                .flat_map(|m| targets(*m, &all))
                .collect(),
            files: Vec::new(),
        },
        Some(plot(&all, directions, sizes)),
    ))
}

/// A strip of this yardstick with its clamp, weight and damping, from flat.
pub(super) fn scene(sheet: &Sheet, model: SheetModel) -> Result<Scene> {
    let model = model
        .with_acceleration([0.0, 0.0, -GRAVITY])
        .with_damping(DAMPING)?
        .with_pins(&STRIP.clamp(sheet))?;
    Ok(Scene {
        model,
        start: sheet.positions().to_vec(),
        method: Method::ImplicitEuler(Default::default()),
        contacts: None,
    })
}

/// How far the free edge is below the clamp at the end, metres: the mean over its vertices.
pub(super) fn drop(sheet: &Sheet, course: &Course) -> f64 {
    let tip = STRIP.tip(sheet);
    let heights = tip.iter().map(|v| course.x[3 * v.index() + 2]);
    0.0 - heights.sum::<f64>() / tip.len() as f64
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
            plan.patience.as_secs_f64()
        ),
        all,
        &[
            ("mesh", &|h| h.pattern.to_string().into()),
            ("turned by, degrees", &|h| h.degrees.into()),
            ("squares across", &|h| h.across.into()),
            ("D, N m", &|h| h.rigidity.into()),
            ("V", &|h| h.vertices.into()),
            ("model", &|h| h.isometry.to_string().into()),
            ("ending", &|h| h.course.ending.name().into()),
            ("t at the end, s", &|h| h.course.t.into()),
            ("factorisations", &|h| h.course.cost.factorisations.into()),
            ("speed left, m/s", &|h| h.course.speed.into()),
            ("drop, m", &|h| h.drop.into()),
            ("exact, m", &|h| h.exact.into()),
            ("error", &|h| h.error().into()),
            ("message", &|h| h.course.ending.message().into()),
        ],
    )
    .named("cantilever")
}

/// Errors against the spacing, of the runs that reached their end.
fn points(
    all: &[Hung],
    pattern: Pattern,
    isometry: Isometry,
    rigidity: f64,
    degrees: f64,
) -> Vec<[f64; 2]> {
    all.iter()
        .filter(|h| h.pattern == pattern && h.isometry == isometry)
        .filter(|h| h.rigidity == rigidity && h.degrees == degrees)
        .filter_map(|h| Some([h.spacing(), h.error()?.abs()]))
        .collect()
}

fn orders(all: &[Hung], directions: &[f64]) -> Table {
    let mut table = Table::new(
        "Fitted powers of h of the error of the drop, of the runs that reached their end",
        &[
            "mesh",
            "turned by, degrees",
            "D, N m",
            "model",
            "runs",
            "power",
        ],
    )
    .named("cantilever-orders");
    for isometry in Isometry::ALL {
        for rigidity in RIGIDITIES {
            for pattern in Pattern::ALL {
                for &degrees in directions {
                    let points = points(all, pattern, isometry, rigidity, degrees);
                    table.push(vec![
                        pattern.to_string().into(),
                        degrees.into(),
                        rigidity.into(),
                        isometry.to_string().into(),
                        points.len().into(),
                        order(&points, 0.0).into(),
                    ]);
                }
            }
        }
    }
    table
}

fn remark(isometry: Isometry, all: &[Hung]) -> String {
    let of: Vec<&Hung> = all.iter().filter(|h| h.isometry == isometry).collect();
    let errors: Vec<f64> = of.iter().filter_map(|h| h.error()).collect();
    if errors.is_empty() {
        return format!("{isometry}: no strip reaches the end.");
    }
    let low = errors.iter().copied().fold(f64::INFINITY, f64::min);
    let high = errors.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    format!(
        "{isometry}: {} of {} strips reach the end, with errors of the drop from {} to {} %.",
        errors.len(),
        of.len(),
        number(100.0 * low),
        number(100.0 * high)
    )
}

fn targets(isometry: Isometry, all: &[Hung]) -> Vec<Target> {
    let of = || all.iter().filter(|h| h.isometry == isometry);
    let judged = of().filter(|h| h.across == JUDGED);
    let errors: Vec<Option<f64>> = judged.map(|h| Some(h.error()?.abs())).collect();
    let quantity = "relative error of the drop, 8 squares across, every mesh, direction and D";
    let mut targets = vec![at_most(isometry, quantity, 0.02, &errors)];
    targets.extend(kept(isometry, of().map(|h| h.course.kept)));
    targets
}

/// The error against the spacing, a panel for every direction and a row for every rigidity.
fn plot(all: &[Hung], directions: &[f64], sizes: &[usize]) -> Drawing {
    let rows = RIGIDITIES.map(|rigidity| {
        let panel = |&degrees: &f64| {
            let of = all.iter();
            let of = of.filter(|h| h.rigidity == rigidity && h.degrees == degrees);
            let dots: Vec<Dot> = of
                .map(|h| Dot {
                    isometry: h.isometry,
                    mesh: h.pattern.number(),
                    x: h.spacing(),
                    y: h.error().map(f64::abs),
                })
                .collect();
            Panel::of_second_order(format!("mesh turned by {degrees}°"), dots)
        };
        let errors = all.iter().filter_map(Hung::error).map(f64::abs);
        let label = format!("error of the drop, ~D~ = {rigidity} N m");
        (
            Axis::holding(&label, errors),
            directions.iter().map(panel).collect(),
        )
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
