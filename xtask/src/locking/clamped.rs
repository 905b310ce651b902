//! Flat sheets that are clamped along lines of any direction.

use super::course::{Course, Plan, Scene};
use super::findings::Findings;
use super::isometry::{Isometry, Material};
use super::plot::{Dot, Figure, Joined, Panel};
use super::records::Records;
use super::targets::{Target, at_least, at_most, kept};
use crate::draw::{Axis, Drawing};
use crate::report::Effort;
use crate::report::Table;
use anyhow::Result;
use isosheet_dynamics::Method;
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{Sheet, VertexId};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
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
            sheet,
            pins: along,
            rigidity,
        })
    }

    fn scene(&self, isometry: Isometry, method: Method) -> Result<Scene> {
        let material = Material {
            mass: MASS,
            rigidity: Some(self.rigidity),
            clamped: &self.pins,
        };
        let model = isometry
            .model(&self.sheet, material)?
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

/// A method of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
enum By {
    Bdf2,
    ImplicitEuler,
    Projection,
}

impl By {
    const ALL: [Self; 3] = [Self::Bdf2, Self::ImplicitEuler, Self::Projection];

    fn name(self) -> &'static str {
        match self {
            Self::Bdf2 => "BDF2",
            Self::ImplicitEuler => "implicit Euler",
            Self::Projection => "projection",
        }
    }

    fn method(self) -> Method {
        match self {
            Self::Bdf2 => Method::default(),
            Self::ImplicitEuler => Method::ImplicitEuler(Default::default()),
            Self::Projection => Method::Projection(Default::default()),
        }
    }

    /// The number of sheets that a model is tried on.
    fn sheets(self, isometry: Isometry, effort: Effort) -> usize {
        match self {
            Self::Bdf2 => effort.quick_or(10, 200),
            Self::ImplicitEuler => effort.quick_or(0, 25),
            // The projection step is one onto the lengths of rods.
            Self::Projection if isometry == Isometry::Rods => effort.quick_or(0, 25),
            Self::Projection => 0,
        }
    }
}

/// A clamped sheet at the end of its run.
#[derive(Serialize, Deserialize)]
struct Fallen {
    isometry: Isometry,
    by: By,
    /// The number in the family.
    number: usize,
    vertices: usize,
    rigidity: f64,
    course: Course,
    /// How far the lowest vertex is below the clamp, metres.
    drop: f64,
}

impl Fallen {
    fn measure(isometry: Isometry, by: By, number: usize, plan: &Plan) -> Result<Self> {
        let clamped = Clamped::new(number)?;
        let course = clamped.scene(isometry, by.method())?.run(plan)?;
        Ok(Self {
            isometry,
            by,
            number,
            vertices: clamped.sheet.topology().vertex_count(),
            rigidity: clamped.rigidity,
            drop: 0.0 - course.lowest(),
            course,
        })
    }

    fn kind(&self) -> usize {
        self.number % KINDS.len()
    }
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Drawing>)> {
    let effort = records.effort;
    let plan = Plan {
        step: 1.0 / 60.0,
        duration: effort.quick_or(0.5, 2.0),
        rest_speed: None,
        patience: effort.patience(0.3, 2.0),
    };
    let jobs = |isometry| -> Vec<(By, usize)> {
        let of = |by: By| (0..by.sheets(isometry, effort)).map(move |number| (by, number));
        By::ALL.into_iter().flat_map(of).collect()
    };
    let all = records.of_models(jobs, |isometry, (by, number)| {
        Fallen::measure(isometry, *by, *number, &plan)
    })?;
    Ok((
        Findings {
            tables: vec![summary(&all)],
            files: vec![runs(&all, &plan)],
            remarks: remarks(&all),
            targets: Isometry::ALL
                .iter()
                .flat_map(|m| targets(*m, &all))
                .collect(),
        },
        Some(plot(&all)),
    ))
}

fn runs(all: &[Fallen], plan: &Plan) -> Table {
    Table::of(
        format!(
            "Every clamped sheet: steps of 1/60 s, {} s simulated, at most {} s of wall time",
            plan.duration,
            plan.patience.as_secs_f64()
        ),
        all,
        &[
            ("number", &|f| f.number.into()),
            ("kind", &|f| KINDS[f.kind()].into()),
            ("V", &|f| f.vertices.into()),
            ("model", &|f| f.isometry.to_string().into()),
            ("method", &|f| f.by.name().into()),
            ("D, N m", &|f| f.rigidity.into()),
            ("ending", &|f| f.course.ending.name().into()),
            ("t at the end, s", &|f| f.course.t.into()),
            ("factorisations per step", &|f| {
                f.course.cost.factorisations_per_step().into()
            }),
            ("most in a step", &|f| f.course.worst.into()),
            ("drop, m", &|f| f.drop.into()),
            ("wall time, s", &|f| f.course.cost.wall.into()),
            ("message", &|f| f.course.ending.message().into()),
        ],
    )
    .named("clamped-runs")
}

/// The sheets of a model and a method.
fn of(all: &[Fallen], isometry: Isometry, by: By) -> Vec<&Fallen> {
    let of = all.iter().filter(|f| f.isometry == isometry && f.by == by);
    of.collect()
}

fn ended(fallen: &[&Fallen]) -> usize {
    fallen.iter().filter(|f| f.course.ending.is_good()).count()
}

/// The sheets by model, method and kind.
fn summary(all: &[Fallen]) -> Table {
    let mut table = Table::new("Clamped sheets by kind. Factorisations belong to the steps that were completed, the drop to the runs that reached their end",
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
    ).named("clamped");
    let mut groups: BTreeMap<(Isometry, By, usize), Vec<&Fallen>> = BTreeMap::new();
    for f in all {
        groups
            .entry((f.isometry, f.by, f.kind()))
            .or_default()
            .push(f);
    }
    for ((isometry, by, kind), group) in &groups {
        let (good, bad): (Vec<&Fallen>, Vec<&Fallen>) =
            group.iter().partition(|f| f.course.ending.is_good());
        let over = bad
            .iter()
            .filter(|f| f.course.ending.name() == "wall time over");
        let over = over.count();
        let drop: f64 = good.iter().map(|f| f.drop).sum();
        table.push(vec![
            KINDS[*kind].into(),
            isometry.to_string().into(),
            by.name().into(),
            group.len().into(),
            good.len().into(),
            over.into(),
            (bad.len() - over).into(),
            errors(&bad).into(),
            median(bad.iter().map(|f| f.course.t).collect()).into(),
            factorisations(group).into(),
            group
                .iter()
                .map(|f| f.course.worst)
                .max()
                .unwrap_or(0)
                .into(),
            (drop / good.len() as f64).into(),
        ]);
    }
    table
}

/// Mean number of factorisations in the steps that were completed; nothing where none was.
fn factorisations(fallen: &[&Fallen]) -> Option<f64> {
    let steps: usize = fallen.iter().map(|f| f.course.cost.steps).sum();
    let factorisations: usize = fallen.iter().map(|f| f.course.cost.factorisations).sum();
    (steps > 0).then(|| factorisations as f64 / steps as f64)
}

/// The kinds of errors with their numbers.
fn errors(bad: &[&Fallen]) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for f in bad.iter().filter(|f| !f.course.ending.message().is_empty()) {
        *counts.entry(f.course.ending.name()).or_default() += 1;
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

fn remarks(all: &[Fallen]) -> Vec<String> {
    let mut remarks = Vec::new();
    for isometry in Isometry::ALL {
        for by in By::ALL {
            let of = of(all, isometry, by);
            if !of.is_empty() {
                remarks.push(format!(
                    "{isometry}, {}: {} of {} sheets reach the end.",
                    by.name(),
                    ended(&of),
                    of.len()
                ));
            }
        }
    }
    remarks
}

fn targets(isometry: Isometry, all: &[Fallen]) -> Vec<Target> {
    let of = of(all, isometry, By::Bdf2);
    let share = ended(&of) as f64 / of.len() as f64;
    let mut targets = vec![
        at_least(
            isometry,
            "part of the sheets that reach the end, BDF2",
            1.0,
            &[Some(share)],
        ),
        at_most(
            isometry,
            "mean factorisations a step, BDF2",
            20.0,
            &[factorisations(&of)],
        ),
    ];
    let runs = all.iter().filter(|f| f.isometry == isometry);
    targets.extend(kept(isometry, runs.map(|f| f.course.kept)));
    targets
}

/// Factorisations a step of every sheet against its number of vertices, for the default method.
fn plot(all: &[Fallen]) -> Drawing {
    let panel = |kind: usize| Panel {
        title: KINDS[kind].into(),
        dots: all
            .iter()
            .filter(|f| f.by == By::Bdf2 && f.kind() == kind)
            .map(|f| Dot {
                isometry: f.isometry,
                mesh: 0,
                x: f.vertices as f64,
                y: f.course
                    .cost
                    .factorisations_per_step()
                    .filter(|_| f.course.ending.is_good()),
            })
            .collect(),
        guides: Vec::new(),
    };
    let costs = all.iter().filter(|f| f.course.ending.is_good());
    let costs = costs.filter_map(|f| f.course.cost.factorisations_per_step());
    Figure {
        x: Axis::round("vertices ~V~", [15.0, 135.0], 4),
        rows: vec![(
            Axis::holding("factorisations a step", costs),
            (0..KINDS.len()).map(panel).collect(),
        )],
        meshes: vec!["one sheet".into()],
        guide: String::new(),
        joined: Joined::No,
        size: [96.0, 130.0],
    }
    .draw()
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
