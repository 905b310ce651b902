//! Flat sheets that are clamped along lines of any direction.

use super::dots::{Dot, Figure, Panel};
use super::isometry::{Isometry, Material};
use super::records::Records;
use super::sample::{OfModel, Sample, requirements};
use super::scene::Scene;
use super::ways::{BDF2, EULER, ways};
use super::{Findings, median};
use crate::draw::{Axis, Charts};
use crate::report::{Effort, Table};
use crate::runs::{Course, Plan};
use anyhow::Result;
use isosheet_dynamics::{Method, SheetModel};
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

pub(super) const ABOUT: &str = "Flat sheets of 25 to 127 vertices and about 1 m lie in a horizontal plane. Every vertex of the quarter of the \
    sheet that lies furthest along a random direction is pinned; the rest falls (0.1 kg, 9.8 m/s², damping 2/s, flexural rigidity 10^U(−4, 0) N m with U uniform). \
    A smooth sheet bends along the straight edge of the clamp. A sheet of rods bends along mesh lines only, and the edge of the clamp \
    is one only by chance. The drop is that of the lowest vertex at the end. \
    A sheet of rods that locks is refused after a bounded number of factorisations.";

/// Kinds of sheets, one after another in the family.
const KINDS: [&str; 5] = ["union jack", "one-way", "Delaunay", "disk", "rectangle"];

/// Mass of a sheet, kilograms, and rate of its damping, 1/s.
pub(crate) const MASS: f64 = 0.1;
pub(crate) const DAMPING: f64 = 2.0;

/// Numbers of vertices of the family.
const VERTICES: std::ops::RangeInclusive<usize> = 25..=127;

/// Seed of the family.
const SEED: u64 = 20;

/// A sheet of the family.
#[derive(Debug)]
pub(crate) struct Clamped {
    pub(crate) sheet: Sheet,
    pub(crate) pins: Vec<VertexId>,
    /// Flexural rigidity, N m.
    pub(crate) rigidity: f64,
}

impl Clamped {
    /// The sheet of the given number in the family.
    pub(crate) fn new(number: usize) -> Result<Self> {
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
        let scene = Scene::flat(model, &self.sheet);
        Ok(scene.by(method))
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

/// The number of a way among [`ways`], and the number of a sheet in the family.
type Job = (usize, usize);

/// The number of sheets that a model is tried on by a method.
fn sheets(isometry: Isometry, by: usize, effort: Effort) -> usize {
    match by {
        BDF2 => effort.quick_or(10, 200),
        EULER => effort.quick_or(0, 25),
        // The projection step is one onto the lengths of rods.
        _ if isometry == Isometry::Rods => effort.quick_or(0, 25),
        _ => 0,
    }
}

/// A clamped sheet at the end of its run, its rigidity (N m), and how far its lowest vertex is below the
/// clamp (metres).
type Fallen = Sample<Job, (f64, f64)>;

fn method(f: &Fallen) -> &'static str {
    ways()[f.job.0].name
}

fn kind(f: &Fallen) -> usize {
    f.job.1 % KINDS.len()
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let duration = effort.quick_or(0.5, 2.0);
    let plan = Plan::new(1.0 / 60.0, duration).within(effort.quick_or(0.3, 2.0));
    let jobs = |isometry| -> Vec<Job> {
        let of = |by| (0..sheets(isometry, by, effort)).map(move |number| (by, number));
        (0..ways().len()).flat_map(of).collect()
    };
    let all = records.of_models(jobs, |isometry, &(by, number)| {
        let clamped = Clamped::new(number)?;
        let method = ways().swap_remove(by).method;
        let (course, end) = clamped.scene(isometry, method)?.run(&plan)?;
        let vertices = clamped.sheet.topology().vertex_count();
        let drop = 0.0 - end.heights()[0];
        Ok((vertices, course, (clamped.rigidity, drop)))
    })?;
    let targets = requirements(&all, |of| {
        let of = of.with(|job| job.0 == BDF2);
        let (ended, cost) = (of.share_that_ends(), factorisations(&of.all));
        vec![
            of.at_least("part of the sheets that reach the end", 1.0, Some(ended)),
            super::targets::at_most(of.isometry, "mean factorisations a step", 20.0, &[cost]),
        ]
    });
    let findings = Findings {
        tables: vec![totals(&all), summary(&all), foretold(&all)?],
        files: vec![runs(&all, &plan)],
        remarks: remarks(&all),
        targets,
    };
    Ok((findings, Some(plot(&all))))
}

fn runs(all: &[Fallen], plan: &Plan) -> Table {
    Table::of(
        format!(
            "Every clamped sheet: steps of 1/60 s, {} s simulated, at most {} s of wall time",
            plan.duration, plan.patience
        ),
        all,
        &[
            ("number", &|f| f.job.1.into()),
            ("kind", &|f| KINDS[kind(f)].into()),
            ("V", &|f| f.vertices.into()),
            ("model", &|f| f.isometry.to_string().into()),
            ("method", &|f| method(f).into()),
            ("D, N m", &|f| f.measured.0.into()),
            ("ending", &|f| f.course.ending.name().into()),
            ("t at the end, s", &|f| f.course.time.into()),
            ("factorisations per step", &|f| {
                f.course.cost.factorisations_per_step().into()
            }),
            ("CPU s per simulated s", &|f| f.course.cpu_rate().into()),
            ("most in a step", &|f| f.course.worst.into()),
            ("factorisations before the refusal", &|f| {
                f.course.in_vain.into()
            }),
            ("drop, m", &|f| f.measured.1.into()),
            ("wall time, s", &|f| f.course.cost.wall.into()),
            ("message", &|f| f.course.ending.message().into()),
        ],
    )
    .named("clamped-runs")
}

/// A group, those of it that reached their end, and those that did not.
fn split(group: Vec<&Fallen>) -> (Vec<&Fallen>, Vec<&Fallen>, Vec<&Fallen>) {
    let (good, bad) = group.iter().partition(|f| f.course.is_good());
    (group, good, bad)
}

/// The sheets by model, method and kind.
fn summary(all: &[Fallen]) -> Table {
    let mut groups: BTreeMap<(Isometry, usize, usize), Vec<&Fallen>> = BTreeMap::new();
    for f in all {
        let key = (f.isometry, f.job.0, kind(f));
        groups.entry(key).or_default().push(f);
    }
    let late = |bad: &[&Fallen]| {
        let over = bad
            .iter()
            .filter(|f| f.course.ending.name() == "wall time over");
        over.count()
    };
    let most = |group: &[&Fallen]| group.iter().map(|f| f.course.worst).max().unwrap_or(0);
    let drop =
        |good: &[&Fallen]| good.iter().map(|f| f.measured.1).sum::<f64>() / good.len() as f64;
    let time = |bad: &[&Fallen]| median(bad.iter().map(|f| f.course.time).collect());
    Table::of(
        "Clamped sheets by kind. Factorisations belong to the steps that were completed, the drop to the runs that reached their end",
        groups.into_values().map(split),
        &[
            ("kind", &|(g, ..)| KINDS[kind(g[0])].into()),
            ("model", &|(g, ..)| g[0].isometry.to_string().into()),
            ("method", &|(g, ..)| method(g[0]).into()),
            ("sheets", &|(g, ..)| g.len().into()),
            ("complete", &|(_, good, _)| good.len().into()),
            ("wall time over", &|(.., bad)| late(bad).into()),
            ("errors", &|(.., bad)| (bad.len() - late(bad)).into()),
            ("kinds of errors", &|(.., bad)| errors(bad).into()),
            ("median t at the end of the others, s", &|(.., bad)| time(bad).into()),
            ("factorisations per step", &|(g, ..)| factorisations(g).into()),
            ("CPU s per simulated s", &|(g, ..)| cpu_rate(g).into()),
            ("most in a step", &|(g, ..)| most(g).into()),
            ("most factorisations before a refusal", &|(g, ..)| in_vain(g).into()),
            ("mean drop, m", &|(_, good, _)| drop(good).into()),
        ],
    )
    .named("clamped")
}

/// Depth of a sheet against that of the same sheet of elastic paper: from the first on it hangs as paper does,
/// below the second it hardly moves.
const AS_DEEP: f64 = 0.8;
const HARDLY: f64 = 0.1;

/// The sheets by model and method, and how deep they hang.
fn totals(all: &[Fallen]) -> Table {
    let depth = |f: &Fallen| f.course.is_good().then_some(f.measured.1);
    let papers = all
        .iter()
        .filter(|f| f.isometry == Isometry::Paper && f.job.0 == BDF2);
    let paper: BTreeMap<usize, f64> = papers.filter_map(|f| Some((f.job.1, depth(f)?))).collect();
    let mut groups: BTreeMap<(Isometry, usize), Vec<&Fallen>> = BTreeMap::new();
    for f in all {
        groups.entry((f.isometry, f.job.0)).or_default().push(f);
    }
    let share = |f: &&&Fallen| Some(depth(f)? / paper.get(&f.job.1)?);
    let count = |group: &[&Fallen], is_such: fn(f64) -> bool| {
        let shares = group.iter().filter_map(|f| share(&f));
        shares.filter(|s| is_such(*s)).count()
    };
    Table::of(
        format!(
            "Clamped sheets by model. Sheets that end at {AS_DEEP} of the depth of the same sheet of elastic paper or deeper hang \
             as paper does; those at less than {HARDLY} hardly move"
        ),
        groups.into_values().map(split),
        &[
            ("model", &|(g, ..)| g[0].isometry.to_string().into()),
            ("method", &|(g, ..)| method(g[0]).into()),
            ("sheets", &|(g, ..)| g.len().into()),
            ("reach the end", &|(_, good, _)| good.len().into()),
            ("hang as paper", &|(g, ..)| count(g, |s| s >= AS_DEEP).into()),
            ("hardly move", &|(g, ..)| count(g, |s| s < HARDLY).into()),
            ("factorisations per step", &|(g, ..)| factorisations(g).into()),
            ("CPU s per simulated s", &|(g, ..)| cpu_rate(g).into()),
            ("refused as locked", &|(.., bad)| locked(bad).into()),
        ],
    )
    .named("clamped-totals")
}

/// Mean of a count over the steps that were completed; nothing where none was.
fn per_step(fallen: &[&Fallen], count: impl Fn(&Course) -> usize) -> Option<f64> {
    let steps: usize = fallen.iter().map(|f| f.course.cost.steps).sum();
    let counted: usize = fallen.iter().map(|f| count(&f.course)).sum();
    (steps > 0).then(|| counted as f64 / steps as f64)
}

/// Seconds of the processor for a simulated second of all runs together.
fn cpu_rate(fallen: &[&Fallen]) -> Option<f64> {
    let time: f64 = fallen.iter().map(|f| f.course.time).sum();
    let spent: f64 = fallen.iter().map(|f| f.course.cost.cpu).sum();
    (time > 0.0).then(|| spent / time)
}

fn factorisations(fallen: &[&Fallen]) -> Option<f64> {
    per_step(fallen, |course| course.cost.factorisations)
}

/// The most factorisations before a sheet was refused because it locks.
fn in_vain(fallen: &[&Fallen]) -> Option<usize> {
    fallen.iter().filter_map(|f| f.course.in_vain).max()
}

/// The number of sheets that were refused because they lock.
fn locked(fallen: &[&Fallen]) -> usize {
    fallen.iter().filter(|f| f.course.in_vain.is_some()).count()
}

/// How often [`SheetModel::clamps_across_the_mesh`] is right about the sheets of rods.
fn foretold(all: &[Fallen]) -> Result<Table> {
    let rods = all
        .iter()
        .filter(|f| f.isometry == Isometry::Rods && f.job.0 == BDF2);
    let mut counts = [[0_usize; 3]; 2];
    for f in rods {
        let clamped = Clamped::new(f.job.1)?;
        let model = SheetModel::new(&clamped.sheet, MASS, MassKind::Lumped)?;
        let model = model.with_pins(&clamped.pins)?;
        let found = model.clamps_across_the_mesh(clamped.sheet.positions());
        let end = match (f.course.in_vain, f.course.is_good()) {
            (Some(_), _) => 0,
            (None, true) => 1,
            (None, false) => 2,
        };
        counts[usize::from(found.is_empty())][end] += 1;
    }
    let rows = [
        "no line of edges runs along the clamp",
        "a line of edges runs along it",
    ];
    Ok(Table::of(
        "Sheets of rods: what the geometry of the clamp foretells, and what becomes of them with BDF2",
        rows.into_iter().zip(counts),
        &[
            ("clamp", &|(name, _)| (*name).into()),
            ("sheets", &|(_, counts)| counts.iter().sum::<usize>().into()),
            ("refused as locked", &|(_, counts)| counts[0].into()),
            ("reach the end", &|(_, counts)| counts[1].into()),
            ("other endings", &|(_, counts)| counts[2].into()),
        ],
    )
    .named("clamped-foretold"))
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

fn remarks(all: &[Fallen]) -> Vec<String> {
    let mut remarks = Vec::new();
    for isometry in Isometry::ALL {
        for (by, name) in ways().into_iter().map(|way| way.name).enumerate() {
            let of = OfModel::of(isometry, all).with(|job| job.0 == by).all;
            let ended = of.iter().filter(|f| f.course.is_good()).count();
            if !of.is_empty() {
                let sheets = of.len();
                remarks.push(format!(
                    "{isometry}, {name}: {ended} of {sheets} sheets reach the end."
                ));
            }
        }
    }
    remarks
}

/// Factorisations a step of every sheet against its number of vertices, for the default method.
fn plot(all: &[Fallen]) -> Charts {
    let panel = |k: usize| {
        let shown = all.iter().filter(|f| kind(f) == k && f.job.0 == BDF2);
        let dots = shown.map(|f| Dot::of(f, 0, f.vertices as f64, f.cost()));
        Panel::new(KINDS[k], dots.collect())
    };
    let x = Axis::linear("vertices V", [15.0, 135.0]);
    let y = Axis::decades("factorisations a step", all.iter().filter_map(Fallen::cost));
    let panels = (0..KINDS.len()).map(panel).collect();
    let names = vec![ways()[BDF2].name.to_owned()];
    Figure::of_row(x, y, panels, names, [96.0, 130.0]).draw()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Depths are compared with those of the same sheet of paper.
    #[test]
    fn totals_count_sheets_that_hang_as_paper_does() {
        let fallen = |isometry, number, drop| Fallen {
            isometry,
            job: (BDF2, number),
            vertices: 25,
            course: Course::default(),
            measured: (1e-3, drop),
        };
        let of = |isometry, drops: [f64; 3]| {
            let numbered = (0..).zip(drops);
            let all = numbered.map(|(number, drop)| fallen(isometry, number, drop));
            all.collect::<Vec<_>>()
        };
        let paper = of(Isometry::Paper, [0.4, 0.5, 0.2]);
        let all = [of(Isometry::Rods, [0.39, 0.04, 0.1]), paper].concat();
        let table = totals(&all);
        let counts = |row: usize| table.rows[row][2..6].to_vec();
        assert_eq!(counts(0), [3, 3, 1, 1_usize].map(Into::into));
        assert_eq!(counts(1), [3, 3, 3, 0_usize].map(Into::into));
    }

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
}
