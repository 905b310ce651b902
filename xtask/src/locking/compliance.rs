//! How elastic sheets approach rigid rods and the inextensible strip, as their membrane becomes stiffer.

use super::cantilever;
use super::isometry::{Material, PAPER, PAPER_RIGIDITY, elastic, rods};
use super::meshes::Pattern;
use super::records::Records;
use super::scene::{End, Scene};
use super::{Findings, order};
use crate::draw::spatial::{norm, sub};
use crate::draw::{Axis, Chart, Charts, Legend, Marker, Missing, Series};
use crate::report::Table;
use crate::runs::{Course, Plan};
use anyhow::Result;
use isosheet_dynamics::{ImplicitOptions, Method};
use isosheet_mesh::{Sheet, VertexId, generate};
use serde::{Deserialize, Serialize};

pub(super) const ABOUT: &str = "Elastic sheets with the membrane stiffness E h from 1e3 to 1e7 N/m. Ladder: a narrow strip of two rows of vertices, pinned at one end, \
    swings in gravity for 0.2 s from a tilted position; rods can move here, and are the limit: the error is the largest distance of a vertex from the \
    same run with rods. Heavy elastica: the strip of that yardstick with D = 5e-4 N m, on meshes without rods that run; the error is the relative one of the \
    drop of the tip against the exact inextensible strip. It is the sum of the mesh's own error, of the stretch, which is proportional to the compliance 1 / (E h), and of \
    locking, which grows with the stiffness.";

/// Membrane stiffnesses, newtons per metre.
const STIFFNESSES: [f64; 9] = [1e3, 3e3, 1e4, 3e4, 1e5, 3e5, 1e6, 3e6, 1e7];

/// Squares of the ladders, each 0.1 m long.
const LADDERS: [usize; 3] = [3, 5, 8];

/// Meshes of the elastica: pattern and angle, degrees.
const MESHES: [(Pattern, f64); 3] = [
    (Pattern::UnionJack, 45.0),
    (Pattern::OneWay, 22.5),
    (Pattern::Delaunay, 0.0),
];

/// Mass of the ladder (kilograms), length of a step and of the run (seconds).
const MASS: f64 = 0.1;
const STEP: f64 = 0.01;
const DURATION: f64 = 0.2;

/// Tolerance of the minimiser for the ladder: what it leaves must be below the error at the largest
/// stiffness.
const TOLERANCE: f64 = 1e-12;

/// Distances below this are those of the tolerance, metres.
const FLOOR: f64 = 1e-9;

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Problem {
    /// A ladder of so many squares.
    Ladder(usize),
    /// The heavy elastica on the mesh of this number, with so many squares across.
    Elastica { mesh: usize, across: usize },
}

impl Problem {
    fn name(self) -> String {
        match self {
            Self::Ladder(squares) => format!("ladder of {squares} squares"),
            Self::Elastica { mesh, across } => {
                let (pattern, degrees) = MESHES[mesh];
                format!("elastica, {pattern} {degrees}°, {across} squares across")
            }
        }
    }

    /// The error, and how the run ended.
    fn measure(self, stiffness: f64, plan: &Plan) -> Result<Run> {
        let (course, error) = match self {
            Self::Ladder(squares) => ladder_error(squares, stiffness, plan)?,
            Self::Elastica { mesh, across } => elastica_error((mesh, across), stiffness, plan)?,
        };
        Ok(Run {
            problem: self,
            stiffness,
            error: error.filter(|_| course.is_good()),
            course,
        })
    }
}

/// A run with a stiffness.
#[derive(Serialize, Deserialize)]
struct Run {
    problem: Problem,
    stiffness: f64,
    /// Metres for a ladder, relative for an elastica.
    error: Option<f64>,
    course: Course,
}

/// The ladder turned out of its plane about the pinned end, so that it bends.
fn tilted(ladder: &Sheet) -> Vec<f64> {
    let points = ladder.positions().as_chunks::<3>().0;
    points
        .iter()
        .flat_map(|p| [p[0], 0.8 * p[1], 0.6 * p[1]])
        .collect()
}

/// A run of a ladder with the stiffness, or with rods.
fn ladder(sheet: &Sheet, stiffness: Option<f64>, plan: &Plan) -> Result<(Course, End)> {
    let material = Material::limp(MASS);
    let model = match stiffness {
        None => rods(sheet, material)?,
        Some(stiffness) => elastic(sheet, material, (stiffness, PAPER.1))?,
    };
    let model = model
        .with_acceleration([0.0, -9.8, 0.0])
        .with_pins(&[VertexId(0), VertexId(1)])?;
    let options = ImplicitOptions {
        tolerance: TOLERANCE,
        ..ImplicitOptions::default()
    };
    let scene = Scene::flat(model, sheet).from(tilted(sheet));
    Ok(scene.by(Method::ImplicitEuler(options)).run(plan)?)
}

fn ladder_error(squares: usize, stiffness: f64, plan: &Plan) -> Result<(Course, Option<f64>)> {
    let sheet = generate::ladder(squares, 0.1, 0.1)?;
    let plan = Plan::new(STEP, DURATION).within(plan.patience);
    let (limit, rigid) = ladder(&sheet, None, &plan)?;
    let (course, end) = ladder(&sheet, Some(stiffness), &plan)?;
    let pairs = end.x.as_chunks::<3>().0.iter();
    let pairs = pairs.zip(rigid.x.as_chunks::<3>().0);
    let distance = |(a, b): (&[f64; 3], &[f64; 3])| norm(&sub(a, b));
    let largest = pairs.map(distance).fold(0.0, f64::max);
    let error = limit.is_good().then_some(largest);
    Ok((course, error))
}

fn elastica_error(
    (mesh, across): (usize, usize),
    stiffness: f64,
    plan: &Plan,
) -> Result<(Course, Option<f64>)> {
    let (pattern, degrees) = MESHES[mesh];
    let sheet = cantilever::STRIP.mesh(pattern, across, degrees)?;
    let clamp = cantilever::STRIP.clamp(&sheet);
    let material = Material::plate(&sheet, cantilever::DENSITY, PAPER_RIGIDITY, &clamp);
    let model = elastic(&sheet, material, (stiffness, PAPER.1))?;
    let (course, end) = cantilever::scene(&sheet, model)?.run(plan)?;
    let exact = cantilever::exact_drop(PAPER_RIGIDITY);
    let error = (cantilever::drop(&sheet, &end) / exact - 1.0).abs();
    Ok((course, Some(error)))
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let plan = Plan::new(cantilever::STEP, 10.0).within(effort.quick_or(0.5, 5.0));
    let plan = plan.until_rest(cantilever::REST);
    let stiffnesses: &[f64] = effort.quick_or(&[1e4, 1e6], &STIFFNESSES);
    let sizes: &[usize] = effort.quick_or(&[2], &[2, 4, 8]);
    let mut problems: Vec<Problem> = LADDERS.map(Problem::Ladder).to_vec();
    for &across in sizes {
        let elastica = |mesh| Problem::Elastica { mesh, across };
        problems.extend((0..MESHES.len()).map(elastica));
    }
    let jobs: Vec<(Problem, f64)> = problems
        .iter()
        .flat_map(|p| stiffnesses.iter().map(|k| (*p, *k)))
        .collect();
    let measure = |job: &(Problem, f64)| job.0.measure(job.1, &plan);
    let all = records.runs("membranes", &jobs, measure)?;
    let findings = Findings {
        tables: vec![orders(&all, &problems)],
        files: vec![table(&all)],
        ..Findings::default()
    };
    Ok((findings, Some(plot(&all, sizes))))
}

/// Errors against the compliance, of the runs that ended.
fn points(all: &[Run], problem: Problem) -> Vec<[f64; 2]> {
    let of = all.iter().filter(|r| r.problem == problem);
    of.filter_map(|r| Some([1.0 / r.stiffness, r.error?]))
        .collect()
}

fn table(all: &[Run]) -> Table {
    Table::of(
        "Every run",
        all,
        &[
            ("problem", &|r| r.problem.name().into()),
            ("stiffness, N/m", &|r| r.stiffness.into()),
            ("ending", &|r| r.course.ending.name().into()),
            ("factorisations per step", &|r| {
                r.course.cost.factorisations_per_step().into()
            }),
            ("CPU s per simulated s", &|r| r.course.cpu_rate().into()),
            ("error", &|r| r.error.into()),
            ("message", &|r| r.course.ending.message().into()),
        ],
    )
    .named("compliance-runs")
}

fn orders(all: &[Run], problems: &[Problem]) -> Table {
    let error = |p: &[f64; 2]| p[1];
    Table::of(
        "Errors (metres for ladders, relative for the elastica) and their fitted power of the compliance: 1 where the stretch decides, 0 where the mesh \
         does, negative where the sheet locks",
        problems.iter().map(|problem| (problem, points(all, *problem))),
        &[
            ("problem", &|(problem, _)| problem.name().into()),
            ("runs", &|(_, p)| p.len().into()),
            ("error at the softest", &|(_, p)| p.first().map(error).into()),
            ("smallest error", &|(_, p)| p.iter().map(error).reduce(f64::min).into()),
            ("error at the stiffest", &|(_, p)| p.last().map(error).into()),
            ("power", &|(_, p)| order(p, FLOOR).into()),
        ],
    )
    .named("compliance")
}

/// The errors against the compliance: the ladders and the elastica on meshes of every size.
fn plot(all: &[Run], sizes: &[usize]) -> Charts {
    let is_ladder = |r: &&Run| matches!(r.problem, Problem::Ladder(_));
    let ladder_errors = all.iter().filter(is_ladder).filter_map(|r| r.error);
    let errors = all.iter().filter(|r| !is_ladder(r)).filter_map(|r| r.error);
    let y = Axis::decades("relative error of the drop", errors);
    let of = LADDERS.map(|n| (Problem::Ladder(n), format!("ladder, {n} squares")));
    let distance = Axis::decades("distance from rods, m", ladder_errors);
    let mut row = vec![panel((all, &of, 0), "Ladders", distance)];
    let of_size = |(k, &across): (usize, &usize)| {
        let meshes = MESHES.iter().enumerate();
        let named = |(mesh, (p, d)): (usize, &(Pattern, f64))| {
            let problem = Problem::Elastica { mesh, across };
            (problem, format!("{p}, {d}°"))
        };
        let of: Vec<(Problem, String)> = meshes.map(named).collect();
        let legend = if k + 1 == sizes.len() {
            Legend::Right
        } else {
            Legend::None
        };
        let title = format!("Elastica, {across} squares across");
        panel((all, &of, 3), &title, y.clone()).with_legend(legend)
    };
    row.extend(sizes.iter().enumerate().map(of_size));
    Charts(vec![row])
}

/// Some problems with their names, in the styles from the given number on. Guides: the first order for
/// ladders, through the largest compliance.
fn panel(
    (all, problems, style): (&[Run], &[(Problem, String)], usize),
    title: &str,
    y: Axis,
) -> Chart {
    let styled = |(k, (problem, name)): (usize, &(Problem, String))| {
        Series::styled(style + k, name, points(all, *problem))
    };
    let mut series: Vec<Series> = problems.iter().enumerate().map(styled).collect();
    let not_ended = |((problem, _), series): (&(Problem, String), &Series)| {
        let of = all.iter().filter(|r| r.problem == *problem);
        let (colour, marker) = (series.colour, series.marker.unwrap_or(Marker::Disc));
        let mark = |r: &Run| Missing {
            x: 1.0 / r.stiffness,
            beside: 0.0,
            colour,
            marker,
        };
        let lost = of.filter(|r| r.error.is_none());
        lost.map(mark).collect::<Vec<_>>()
    };
    let missing = problems.iter().zip(&series).flat_map(not_ended).collect();
    if let (Problem::Ladder(_), [a, .., b]) = (problems[0].0, series[0].points.as_slice()) {
        let guide = vec![*a, [b[0], a[1] * b[0] / a[0]]];
        series.push(Series::guide("1 / (Eh)", guide));
    }
    let x = Axis::decades("compliance 1 / (Eh), m/N", [1e-7, 1e-3]);
    let chart = Chart::new(x, y, [120.0, 140.0], series);
    chart.titled(title).with_missing(missing)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ladders approach rods to first order in the compliance.
    #[test]
    fn ladders_approach_rods_to_first_order() {
        let plan = Plan::new(STEP, DURATION).within(60.0);
        let run = |stiffness: f64| Problem::Ladder(3).measure(stiffness, &plan).unwrap();
        let all = [1e4, 1e5, 1e6].map(run);
        let power = order(&points(&all, Problem::Ladder(3)), FLOOR).unwrap();
        assert!((power - 1.0).abs() < 0.05, "{power}");
    }
}
