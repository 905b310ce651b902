//! Yardstick 1: flat sheets that are clamped along lines of any direction.

use super::course::{Course, Plan, Scene};
use super::effort::LockingEffort;
use super::findings::Findings;
use super::isometry::Isometry;
use super::table::Results;
use crate::draw::Drawing;
use crate::progress::Progress;
use anyhow::Result;
use isosheet_dynamics::Method;
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{Sheet, VertexId};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

pub(super) const ABOUT: &str = "Flat sheets of 25 to 127 vertices and about 1 m lie in a horizontal plane. Every vertex of the quarter of the \
    sheet that lies furthest along a random direction is pinned; the rest falls (0.1 kg, 9.8 m/s², damping 2/s, flexural rigidity 10^U(−4, 0) N m with U uniform). \
    A smooth sheet bends along the straight edge of the clamp. A sheet of rods bends along mesh lines only, and the edge of the clamp \
    is one only by chance. The drop is that of the lowest vertex at the end.";

/// Kinds of sheets, one after another in the family.
const KINDS: [&str; 5] = ["union jack", "one-way", "Delaunay", "disk", "rectangle"];

/// Mass of a sheet, kilograms, and rate of its damping, 1/s.
const MASS: f64 = 0.1;
const DAMPING: f64 = 2.0;

/// Numbers of vertices of the family.
const VERTICES: std::ops::RangeInclusive<usize> = 25..=127;

/// Seed of the family.
const SEED: u64 = 20;

/// A sheet of the family.
#[derive(Debug)]
pub(super) struct Clamped {
    pub(super) kind: &'static str,
    pub(super) sheet: Sheet,
    pub(super) pins: Vec<VertexId>,
    /// Flexural rigidity, N m.
    pub(super) rigidity: f64,
}

impl Clamped {
    /// The sheet of the given number in the family.
    pub(super) fn new(number: usize) -> Result<Self> {
        let mut rng = ChaCha8Rng::seed_from_u64(SEED + number as u64);
        let kind = KINDS[number % KINDS.len()];
        let sheet = loop {
            let sheet = random_sheet(kind, &mut rng)?;
            if VERTICES.contains(&sheet.topology().vertex_count()) {
                break sheet;
            }
        };
        let (s, c) = rng.random_range(0.0..TAU).sin_cos();
        let mut along: Vec<VertexId> = sheet.topology().vertex_ids().collect();
        let place = |v: &VertexId| {
            let [x, y, _] = sheet.position(*v);
            c * x + s * y
        };
        along.sort_by(|a, b| place(b).total_cmp(&place(a)));
        along.truncate(sheet.topology().vertex_count().div_ceil(4));
        let rigidity = 10f64.powf(rng.random_range(-4.0..0.0));
        Ok(Self {
            kind,
            sheet,
            pins: along,
            rigidity,
        })
    }

    fn scene(&self, isometry: Isometry, method: Method) -> Result<Scene> {
        let model = isometry
            .bending(&self.sheet, MASS, self.rigidity, &self.pins)?
            .with_gravity()
            .with_damping(DAMPING)?
            .with_pins(&self.pins)?;
        Ok(Scene {
            model,
            start: self.sheet.positions().to_vec(),
            method,
            contacts: None,
        })
    }
}

fn random_sheet(kind: &str, rng: &mut ChaCha8Rng) -> Result<Sheet> {
    Ok(match kind {
        "union jack" => generate::isotropic_square(rng.random_range(1..=2), 1.0)?,
        "one-way" => {
            let cells = rng.random_range(4..=10);
            generate::anisotropic_grid(cells, cells, 1.0, 1.0)?
        }
        "Delaunay" => generate::delaunay_square(1.0, rng.random_range(0.1..0.24), rng.random())?,
        "disk" => generate::disk(rng.random_range(3..=6), 0.5)?,
        _ => {
            let (columns, rows) = (rng.random_range(6..=14), rng.random_range(3..=7));
            let height = rows as f64 / columns as f64;
            generate::grid(columns, rows, 1.0, height, Diagonals::UnionJack)?
        }
    })
}

/// The methods of the table with the number of sheets that each is tried on.
fn methods(effort: LockingEffort) -> Vec<(&'static str, Method, usize)> {
    let mut methods = vec![("BDF2", Method::default(), effort.pick(15, 200))];
    if effort == LockingEffort::Full {
        methods.push((
            "implicit Euler",
            Method::ImplicitEuler(Default::default()),
            25,
        ));
        methods.push(("projection", Method::Projection(Default::default()), 25));
    }
    methods
}

/// Runs the yardstick.
pub(super) fn make(effort: LockingEffort) -> Result<(Findings, Option<Drawing>)> {
    let plan = Plan {
        step: 1.0 / 60.0,
        duration: effort.pick(0.5, 2.0),
        rest_speed: None,
        patience: effort.patience(0.3, 3.0),
    };
    let mut runs = Results::new(
        "clamped-runs",
        format!(
            "Every clamped sheet: steps of 1/60 s, {} s simulated, at most {} s of wall time",
            plan.duration,
            plan.patience.as_secs_f64()
        ),
        &[
            "number",
            "kind",
            "V",
            "model",
            "method",
            "D, N m",
            "ending",
            "t at the end, s",
            "factorisations per step",
            "most in a step",
            "drop, m",
            "wall time, s",
            "message",
        ],
    );
    let mut groups: BTreeMap<(&str, String, usize), Vec<Course>> = BTreeMap::new();
    for isometry in Isometry::ALL {
        for (method_name, method, count) in methods(effort) {
            if isometry == Isometry::Elastic && matches!(method, Method::Projection(_)) {
                // The projection step is one onto the lengths of rods.
                continue;
            }
            let bar = Progress::start(format!("clamped, {method_name}"), count);
            for number in 0..count {
                let clamped = Clamped::new(number)?;
                let course = clamped.scene(isometry, method.clone())?.run(&plan)?;
                runs.push(vec![
                    number.into(),
                    clamped.kind.into(),
                    clamped.sheet.topology().vertex_count().into(),
                    isometry.to_string().into(),
                    method_name.into(),
                    clamped.rigidity.into(),
                    course.ending.name().into(),
                    course.t.into(),
                    course.factorisations_per_step().into(),
                    course.worst.into(),
                    (0.0 - course.lowest()).into(),
                    course.wall.into(),
                    course.ending.message().into(),
                ]);
                let kind = number % KINDS.len();
                let key = (method_name, isometry.to_string(), kind);
                groups.entry(key).or_default().push(course);
                bar.step();
            }
            bar.finish("measured");
        }
    }
    let summary = summary(&groups);
    let remarks = remarks(&groups);
    Ok((
        Findings {
            tables: vec![summary],
            files: vec![runs],
            remarks,
        },
        None,
    ))
}

type Groups<'a> = BTreeMap<(&'a str, String, usize), Vec<Course>>;

/// The sheets by method, model and kind.
fn summary(groups: &Groups<'_>) -> Results {
    let mut table = Results::new(
        "clamped",
        "Clamped sheets by kind. Factorisations belong to the steps that were completed, the drop to the runs that reached their end",
        &[
            "kind",
            "model",
            "method",
            "sheets",
            "complete",
            "wall time over",
            "errors",
            "kinds of errors",
            "median t at the end of the others, s",
            "factorisations per step",
            "most in a step",
            "mean drop, m",
        ],
    );
    for ((method, model, kind), courses) in groups {
        let (good, bad): (Vec<&Course>, Vec<&Course>) =
            courses.iter().partition(|c| c.ending.is_good());
        let over = bad.iter().filter(|c| c.ending.name() == "wall time over");
        let over = over.count();
        let steps: usize = courses.iter().map(|c| c.steps).sum();
        let factorisations: usize = courses.iter().map(|c| c.factorisations).sum();
        let drop: f64 = good.iter().map(|c| -c.lowest()).sum();
        table.push(vec![
            KINDS[*kind].into(),
            model.as_str().into(),
            (*method).into(),
            courses.len().into(),
            good.len().into(),
            over.into(),
            (bad.len() - over).into(),
            errors(&bad).into(),
            median(bad.iter().map(|c| c.t).collect()).into(),
            (factorisations as f64 / steps as f64).into(),
            courses.iter().map(|c| c.worst).max().unwrap_or(0).into(),
            (drop / good.len() as f64).into(),
        ]);
    }
    table
}

/// The kinds of errors with their numbers.
fn errors(bad: &[&Course]) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for course in bad.iter().filter(|c| !c.ending.message().is_empty()) {
        *counts.entry(course.ending.name()).or_default() += 1;
    }
    let texts: Vec<String> = counts.iter().map(|(k, n)| format!("{n} {k}")).collect();
    texts.join(", ")
}

/// The median; NaN of nothing.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    if n == 0 {
        return f64::NAN;
    }
    0.5 * (values[(n - 1) / 2] + values[n / 2])
}

fn remarks(groups: &Groups<'_>) -> Vec<String> {
    let mut totals: BTreeMap<(&str, &str), [usize; 2]> = BTreeMap::new();
    for ((method, model, _), courses) in groups {
        let total = totals.entry((*method, model.as_str())).or_default();
        total[0] += courses.iter().filter(|c| c.ending.is_good()).count();
        total[1] += courses.len();
    }
    totals
        .iter()
        .map(|((method, model), [good, all])| {
            format!("{model}, {method}: {good} of {all} sheets reach the end.")
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_family_is_what_it_says() {
        for number in 0..50 {
            let c = Clamped::new(number).unwrap();
            let count = c.sheet.topology().vertex_count();
            assert!(VERTICES.contains(&count), "{number}: {count}");
            assert_eq!(c.kind, KINDS[number % 5]);
            assert_eq!(c.pins.len(), count.div_ceil(4));
            assert!((1e-4..1.0).contains(&c.rigidity));
            let again = Clamped::new(number).unwrap();
            assert_eq!((c.sheet, c.pins), (again.sheet, again.pins));
        }
    }

    #[test]
    fn medians() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0]), 2.5);
        assert!(median(Vec::new()).is_nan());
    }
}
