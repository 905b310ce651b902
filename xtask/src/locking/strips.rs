//! Strips whose shape and energy are known in closed form: loaded, hanging, pushed together.

mod case;

use super::grids::Grid;
use super::meshes::vertices;
use super::model::{Model, Tried, at_most};
use super::panels::{BANDS, Panel, charts};
use super::records::Records;
use super::scene::{End, Scene};
use super::{Findings, order};
use crate::draw::{Axis, Charts};
use crate::report::{Cell, Cost, Table, extremes, number};
use crate::runs::Plan;
use anyhow::Result;
use case::{Case, DENSITY, Exact, LENGTH, RIGIDITY, WIDTH, middle, plate};
use isosheet_mesh::Sheet;
use isosheet_tests::implicit_euler;
use serde::{Deserialize, Serialize};

pub(super) const ABOUT: &str = "Strips of paper with a free part of 4 a x a (a = 0.1 m, 5e-4 N m), clamped over 0.5 a. Loaded: one end is clamped, a load of 0.025 D / a³ \
    per area acts upwards and keeps its direction (Bartels, Numer. Math. 124, 2013, ex. 6.1). Heavy: the same with a weight q downwards, Γ = q L³ / D = 1, 10, 100 with L = 4 a. \
    Pushed together: both ends are clamped, and their lines move within 4 s to a distance of 1.2 a (ex. 6.3); an upward force, which is gone after 2 s, chooses the side. The answers are those of the elastica. \
    Measured at rest: the elastic energy minus the work of the load (of the strip that is pushed: the elastic energy), and the mean place of the tip (of the middle), both relative to the exact ones. \
    Every mesh has edges along the lines of the clamps and along the middle of the strip that is pushed.";

/// Steps of implicit Euler, seconds.
const STEP: f64 = 0.05;

/// The sheet is at rest when no vertex is faster, metres per second.
const REST: f64 = 1e-5;

/// Relative errors below this are those of a sheet that has come to rest to within [`REST`], and of answers
/// with four digits.
const FLOOR: f64 = 1e-4;

/// Squares across at which the error is limited.
const JUDGED: usize = 8;

/// A strip of a case on a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Job {
    case: Case,
    grid: Grid,
    across: usize,
}

/// What is measured of a strip at rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Rested {
    /// Energy, and the part of it in the plane of the sheet, joules.
    energy: f64,
    membrane: f64,
    /// The tip or the middle, metres along x and z.
    place: [f64; 2],
    exact: Exact,
}

type Strip = Tried<Job, Rested>;

impl Strip {
    fn spacing(&self) -> f64 {
        WIDTH / self.job.across as f64
    }

    fn energy_error(&self) -> Option<f64> {
        self.if_good(|m| (m.energy / m.exact.energy - 1.0).abs())
    }

    /// Distance of the tip from its exact place, over how far that place is from the flat strip.
    fn place_error(&self) -> Option<f64> {
        let [x, z] = self.measured.exact.place;
        self.if_good(|m| (m.place[0] - x).hypot(m.place[1] - z) / z.abs())
    }
}

/// An error of a strip that came to rest.
type Measure = fn(&Strip) -> Option<f64>;

const ERRORS: [(&str, Measure); 2] = [
    ("energy", Strip::energy_error),
    ("place", Strip::place_error),
];

fn measure(model: Model, job: Job, plan: &Plan) -> Result<Strip> {
    let Job { case, grid, across } = job;
    let sheet = case.sheet(grid, across)?;
    let clamp = case.clamp(&sheet);
    let scene = Scene::flat(case.model(model, &sheet)?, &sheet).by(implicit_euler());
    let (course, end) = scene.run(plan)?;
    let elastic = model.energy(&sheet, plate(&clamp), &end.x)?;
    let bending = model.bending_energy(&sheet, plate(&clamp), &end.x)?;
    Ok(Tried {
        model,
        job,
        vertices: sheet.topology().vertex_count(),
        course,
        measured: Rested {
            energy: elastic - work(case, model, &sheet, &end)?,
            membrane: elastic - bending,
            place: place(case, &sheet, &end),
            exact: case.exact(),
        },
    })
}

/// The work of the load, joules.
fn work(case: Case, model: Model, sheet: &Sheet, end: &End) -> Result<f64> {
    let Some((load, sign)) = case.load() else {
        return Ok(0.0);
    };
    let weightless = model.sheet(sheet, plate(&[]))?;
    let loaded =
        model
            .sheet(sheet, plate(&[]))?
            .with_acceleration([0.0, 0.0, sign * load / DENSITY]);
    let energies = [loaded, weightless].map(|m| m.potential_energy(0.0, &end.x));
    Ok(energies[1] - energies[0])
}

fn place(case: Case, sheet: &Sheet, end: &End) -> [f64; 2] {
    let at = match case {
        Case::Pushed => middle(sheet),
        _ => vertices(sheet, |[x, ..]| x > LENGTH - 1e-9),
    };
    [0, 2].map(|k| end.mean(&at, k, |value| value))
}

fn plan(patience: f64) -> Plan {
    Plan::new(STEP, 30.0).within(patience).until_rest(REST)
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let sizes: &[usize] = effort.quick_or(&[2], &[2, 4, 8]);
    let grids: &[Grid] = effort.quick_or(&[Grid::Aligned, Grid::Delaunay(1)], &Grid::ALL);
    let limits = plan(effort.quick_or(0.5, 60.0));
    let mut jobs = Vec::new();
    for case in Case::ALL {
        for &grid in grids {
            jobs.extend(sizes.iter().map(|&across| Job { case, grid, across }));
        }
    }
    let mut all: Vec<Strip> = Vec::new();
    for model in Model::ALL {
        let run = |job: &Job| measure(model, *job, &limits);
        all.extend(records.runs(&model.to_string(), &jobs, run)?);
    }
    let mut targets = Vec::new();
    for model in Model::ALL {
        for (name, error) in ERRORS {
            let judged = all
                .iter()
                .filter(|s| s.model == model && s.job.across == JUDGED);
            let quantity =
                format!("relative error of the {name}, 8 squares across, every strip and mesh");
            let values: Vec<Option<f64>> = judged.map(error).collect();
            targets.push(at_most(model, &quantity, 0.02, &values));
        }
    }
    let findings = Findings {
        tables: vec![
            summary(&all, sizes),
            orders(&all, grids, ERRORS[0]),
            orders(&all, grids, ERRORS[1]),
        ],
        files: vec![table(&all)],
        remarks: Model::ALL
            .map(|m| remark(m, &all))
            .into_iter()
            .chain([BANDS.to_owned()])
            .collect(),
        targets,
    };
    Ok((findings, Some(plot(&all, grids, sizes))))
}

fn summary(all: &[Strip], sizes: &[usize]) -> Table {
    let mut rows = Vec::new();
    for case in Case::ALL {
        for &across in sizes {
            rows.extend(Model::ALL.map(|model| (case, across, model)));
        }
    }
    let of = |&(case, across, model): &(Case, usize, Model)| {
        let is_of = move |s: &&Strip| (s.job.case, s.job.across, s.model) == (case, across, model);
        all.iter().filter(is_of).collect::<Vec<_>>()
    };
    let largest = |strips: &[&Strip], error: Measure| {
        let values = strips.iter().filter_map(|s| error(s));
        values.reduce(f64::max)
    };
    Table::of(
        "Strips with known answers: how many of the meshes come to rest, and the largest errors of those that do",
        rows,
        &[
            ("strip", &|r| r.0.to_string().into()),
            ("squares across", &|r| r.1.into()),
            ("model", &|r| r.2.to_string().into()),
            ("at rest", &|r| of(r).iter().filter(|s| s.course.is_good()).count().into()),
            ("error of the energy", &|r| largest(&of(r), Strip::energy_error).into()),
            ("error of the place", &|r| largest(&of(r), Strip::place_error).into()),
            ("factorisations per step", &|r| {
                let mut cost = Cost::default();
                of(r).iter().for_each(|s| cost.add_run(&s.course.cost));
                cost.factorisations_per_step().into()
            }),
            ("CPU seconds of a run", &|r| {
                let of = of(r);
                (of.iter().map(|s| s.course.cost.cpu).sum::<f64>() / of.len() as f64).into()
            }),
        ],
    )
    .named("strips")
}

fn table(all: &[Strip]) -> Table {
    Table::of(
        format!("Every strip: implicit Euler, steps of {STEP} s, until no vertex is faster than {REST} m/s. Energies are over D, places over the width"),
        all,
        &[
            ("strip", &|s| s.job.case.to_string().into()),
            ("mesh", &|s| s.job.grid.to_string().into()),
            ("squares across", &|s| s.job.across.into()),
            ("V", &|s| s.vertices.into()),
            ("model", &|s| s.model.to_string().into()),
            ("ending", &|s| s.course.ending.name().into()),
            ("factorisations", &|s| s.course.cost.factorisations.into()),
            ("CPU seconds", &|s| s.course.cost.cpu.into()),
            ("energy", &|s| (s.measured.energy / RIGIDITY).into()),
            ("exact energy", &|s| (s.measured.exact.energy / RIGIDITY).into()),
            ("in the plane", &|s| (s.measured.membrane / RIGIDITY).into()),
            ("x", &|s| (s.measured.place[0] / WIDTH).into()),
            ("z", &|s| (s.measured.place[1] / WIDTH).into()),
            ("exact x", &|s| (s.measured.exact.place[0] / WIDTH).into()),
            ("exact z", &|s| (s.measured.exact.place[1] / WIDTH).into()),
            ("error of the energy", &|s| s.energy_error().into()),
            ("error of the place", &|s| s.place_error().into()),
            ("largest strain of an edge", &|s| s.course.strain.into()),
            ("message", &|s| s.course.ending.message().into()),
        ],
    )
    .named("strips-all")
}

/// The fitted orders of an error: a row for each strip and model, a column for each mesh.
fn orders(all: &[Strip], grids: &[Grid], (name, error): (&str, Measure)) -> Table {
    let models = |case: Case| Model::ALL.map(|model| (case, model));
    let rows: Vec<(Case, Model)> = Case::ALL.into_iter().flat_map(models).collect();
    let fitted = |&(case, model): &(Case, Model), grid: Grid| {
        let key = (case, grid, model);
        let of = all
            .iter()
            .filter(|s| (s.job.case, s.job.grid, s.model) == key);
        let points: Option<Vec<_>> = of.map(|s| Some([s.spacing(), error(s)?])).collect();
        order(&points?, FLOOR)
    };
    let caption = format!(
        "Fitted powers of h of the error of the {name} where all three strips come to rest; errors below 1e-4 are left out"
    );
    let mut table = Table::of(
        caption,
        &rows,
        &[
            ("strip", &|r| r.0.to_string().into()),
            ("model", &|r| r.1.to_string().into()),
        ],
    );
    for &grid in grids {
        let cells: Vec<Cell> = rows.iter().map(|row| fitted(row, grid).into()).collect();
        table = table.with_column(&grid.to_string(), cells.into_iter());
    }
    table.named(&format!("strips-orders-{name}"))
}

fn remark(model: Model, all: &[Strip]) -> String {
    let of: Vec<&Strip> = all.iter().filter(|s| s.model == model).collect();
    let judged = of.iter().filter(|s| s.job.across == JUDGED);
    let [energy, place] = ERRORS.map(|(_, error)| {
        let worst = extremes(judged.clone().filter_map(|s| error(s))).map(|[_, high]| high);
        worst.map_or("–".into(), |w| number(100.0 * w))
    });
    let ended = of.iter().filter(|s| s.course.is_good()).count();
    format!(
        "{model}: {ended} of {} strips come to rest. With 8 squares across the largest error is {energy} % in the energy and {place} % in the place.",
        of.len()
    )
}

/// The errors against the spacing: a row for each error, a panel for each strip.
fn plot(all: &[Strip], grids: &[Grid], sizes: &[usize]) -> Charts {
    let ticks = sizes.iter().map(|&n| {
        let h = WIDTH / n as f64;
        (h, number(1e3 * h))
    });
    let x = Axis::at("h, mm", ticks.collect());
    let ends = [sizes.first(), sizes.last()].into_iter().flatten();
    let ends: Vec<f64> = ends.map(|&n| WIDTH / n as f64).collect();
    let rows = ERRORS.map(|(name, error)| {
        let y = Axis::decades(
            &format!("error of the {name}"),
            all.iter().filter_map(error),
        );
        let panel = |case: Case| {
            let of = all
                .iter()
                .filter(|s| s.job.case == case && grids.contains(&s.job.grid));
            let point = |s: &Strip| Some((s.model, [s.spacing(), error(s)?]));
            let two = ends.iter().map(|h| [*h, 0.02]).collect();
            Panel {
                title: case.to_string(),
                axes: [x.clone(), y.clone()],
                points: of.filter_map(point).collect(),
                guides: vec![two],
            }
        };
        Case::ALL.map(panel).to_vec()
    });
    charts(rows.to_vec(), &Model::ALL, "2 %")
}

/// Strips that bend much on meshes without lines across the bend, with another bound of the stiffness: the
/// largest errors of energy and place; nothing where one of the strips does not come to rest.
pub(super) fn with_bound(bound: Model, across: usize, patience: f64) -> Result<[Option<f64>; 2]> {
    let mut worst = [Some(0.0_f64); 2];
    for case in [Case::Heavy(100.0), Case::Pushed] {
        let seeds = [1, 2, 3].map(Grid::Delaunay);
        for grid in [Grid::UnionJack, Grid::OneWay].into_iter().chain(seeds) {
            let job = Job { case, grid, across };
            let strip = measure(bound, job, &plan(patience))?;
            for (worst, (_, error)) in worst.iter_mut().zip(ERRORS) {
                *worst = worst.zip(error(&strip)).map(|(a, b)| a.max(b));
            }
        }
    }
    Ok(worst)
}
