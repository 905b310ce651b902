//! Yardstick 4: the drop of a heavy strip against the exact elastica, on meshes turned against the strip.

use super::course::{Course, Plan, Scene};
use super::cylinder::DIRECTIONS;
use super::effort::LockingEffort;
use super::elastica::Elastica;
use super::findings::Findings;
use super::isometry::Isometry;
use super::meshes::{Pattern, Strip};
use super::plot::{order, panels, series};
use super::table::{Results, number};
use crate::draw::{Drawing, Series};
use crate::progress::Progress;
use anyhow::Result;
use isosheet_dynamics::Method;

pub(super) const ABOUT: &str = "A strip of 0.06 m width and 80 g/m² is clamped horizontally over 0.03 m and hangs free over 0.30 m: the heavy elastica. The \
    exact drop of the tip comes from its differential equation. The squares of the mesh are turned against the strip; an irregular mesh \
    has no direction, other angles are other seeds. Every mesh has vertices and edges along the line of the clamp, so that the clamp \
    itself does not lock. The drop is the mean over the vertices of the free edge.";

const STRIP: Strip = Strip {
    free: 0.3,
    clamped: 0.03,
    width: 0.06,
};

/// Mass per area, kg/m2, acceleration of gravity, m/s2, and rate of damping, 1/s.
const DENSITY: f64 = 0.08;
const GRAVITY: f64 = 9.8;
const DAMPING: f64 = 4.0;

/// Flexural rigidities, N m: cardboard and office paper.
const RIGIDITIES: [f64; 2] = [5e-3, 5e-4];

/// Steps of implicit Euler, seconds: long ones, which damp all motion.
const STEP: f64 = 0.05;

/// The sheet is at rest when no vertex is faster, metres per second.
const REST: f64 = 5e-4;

/// A strip at rest.
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
        let model = isometry
            .bending(
                &sheet,
                DENSITY * sheet.area(),
                rigidity,
                &STRIP.clamp(&sheet),
            )?
            .with_acceleration([0.0, 0.0, -GRAVITY])
            .with_damping(DAMPING)?
            .with_pins(&STRIP.clamp(&sheet))?;
        let scene = Scene {
            model,
            start: sheet.positions().to_vec(),
            method: Method::ImplicitEuler(Default::default()),
            contacts: None,
        };
        let course = scene.run(plan)?;
        let tip = STRIP.tip(&sheet);
        let heights = tip.iter().map(|v| course.x[3 * v.index() + 2]);
        Ok(Self {
            pattern,
            across,
            degrees,
            rigidity,
            vertices: sheet.topology().vertex_count(),
            isometry,
            drop: 0.0 - heights.sum::<f64>() / tip.len() as f64,
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
pub(super) fn make(effort: LockingEffort) -> Result<(Findings, Option<Drawing>)> {
    let plan = Plan {
        step: STEP,
        duration: effort.pick(3.0, 10.0),
        rest_speed: Some(REST),
        patience: effort.patience(0.4, 2.0),
    };
    let sizes: &[usize] = effort.pick(&[2], &[2, 4, 8]);
    let directions: &[f64] = effort.pick(&[0.0, 22.5], &DIRECTIONS);
    let exact = RIGIDITIES.map(|rigidity| {
        let elastica = Elastica {
            length: STRIP.free,
            rigidity,
            weight: DENSITY * GRAVITY,
        };
        (rigidity, elastica.drop())
    });
    let count = Isometry::ALL.len() * 2 * Pattern::ALL.len() * sizes.len() * directions.len();
    let bar = Progress::start("cantilever", count);
    let mut all = Vec::new();
    for isometry in Isometry::ALL {
        for of in exact {
            for pattern in Pattern::ALL {
                for &degrees in directions {
                    for &across in sizes {
                        let mesh = (pattern, degrees);
                        all.push(Hung::measure(isometry, mesh, across, of, &plan)?);
                        bar.step();
                    }
                }
            }
        }
    }
    bar.finish("measured");
    let mut remarks: Vec<String> = exact
        .iter()
        .map(|(rigidity, drop)| format!("Exact drop at D = {rigidity:e} N m: {drop:.4} m."))
        .collect();
    remarks.push(remark(&all));
    Ok((
        Findings {
            remarks,
            tables: vec![table(&all, &plan), orders(&all, directions)],
            files: Vec::new(),
        },
        Some(plot(&all, directions)),
    ))
}

fn table(all: &[Hung], plan: &Plan) -> Results {
    let mut table = Results::new(
        "cantilever",
        format!(
            "Heavy strips: implicit Euler, steps of {STEP} s, until no vertex is faster than {REST} m/s or {} s are simulated; at most {} s of wall \
             time. A negative error is a strip that is too stiff; a positive one comes from the springs along the clamp, which are as soft as those between two \
             free rows of triangles and bend over half the length",
            plan.duration,
            plan.patience.as_secs_f64()
        ),
        &[
            "mesh",
            "turned by, degrees",
            "squares across",
            "D, N m",
            "V",
            "model",
            "ending",
            "t at the end, s",
            "factorisations",
            "speed left, m/s",
            "drop, m",
            "exact, m",
            "error",
            "message",
        ],
    );
    for h in all {
        table.push(vec![
            h.pattern.to_string().into(),
            h.degrees.into(),
            h.across.into(),
            h.rigidity.into(),
            h.vertices.into(),
            h.isometry.to_string().into(),
            h.course.ending.name().into(),
            h.course.t.into(),
            h.course.factorisations.into(),
            h.course.speed.into(),
            h.drop.into(),
            h.exact.into(),
            h.error().into(),
            h.course.ending.message().into(),
        ]);
    }
    table
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

fn orders(all: &[Hung], directions: &[f64]) -> Results {
    let mut table = Results::new(
        "cantilever-orders",
        "Fitted powers of h of the error of the drop, of the runs that reached their end",
        &[
            "mesh",
            "turned by, degrees",
            "D, N m",
            "model",
            "runs",
            "power",
        ],
    );
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

fn remark(all: &[Hung]) -> String {
    let errors: Vec<f64> = all.iter().filter_map(Hung::error).collect();
    if errors.is_empty() {
        return "No strip reaches the end.".into();
    }
    let low = errors.iter().copied().fold(f64::INFINITY, f64::min);
    let high = errors.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    format!(
        "{} of {} strips reach the end, with errors of the drop from {} to {} %.",
        errors.len(),
        all.len(),
        number(100.0 * low),
        number(100.0 * high)
    )
}

/// The error against the spacing for every direction, at the stiffness of paper.
fn plot(all: &[Hung], directions: &[f64]) -> Drawing {
    let [_, paper] = RIGIDITIES;
    let first = points(all, Pattern::UnionJack, Isometry::Rods, paper, 0.0);
    let panel = |pattern: Pattern| {
        let line = |(k, &degrees): (usize, &f64)| {
            let points = points(all, pattern, Isometry::Rods, paper, degrees);
            series(k, &format!("{degrees}°"), points)
        };
        let mut lines: Vec<Series> = directions.iter().enumerate().map(line).collect();
        if let Some(&[h, e]) = first.first() {
            lines.push(Series::guide("~h~", vec![[h, e], [h / 4.0, e / 4.0]]));
        }
        (format!("{pattern}: error of the drop"), lines)
    };
    panels("~h~, m", Pattern::ALL.map(panel).to_vec())
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
