//! Error against time: the methods without a chart and textbook ones on problems with known solutions, with
//! ever finer steps.

use super::DEFAULT;
use super::baselines::Baseline;
use crate::draw::{Chart, Charts, Legend, Series};
use crate::progress::Progress;
use crate::report::{
    Bound, Effort, Finding, LENGTHS, Part, Record, Table, columns, exponent, plot,
};
use crate::runs::{Course, Plan, unseen};
use crate::store::Files;
use anyhow::{Result, ensure};
use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_tests::{
    Flap, FreeTriangle, Pendulum, bent, bumped, conservative, implicit_euler, max_difference,
    rattle_composition, tumbling, tumbling_from,
};
use maud::html;
use serde::Serialize;

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ExactProblem {
    Pendulum,
    Triangle,
    Flap,
    Bumped,
    Developable,
}

/// What is measured, in words.
pub(super) const ABOUT: &str = "\
    Methods without a chart are run with ever finer steps. Times are CPU seconds for a simulated second on one core, set-up left out; \
    short runs are repeated up to five times and the minimum is taken. Position errors are the largest distance of a vertex from its \
    exact place at the end, energy errors the largest change of T + V as part of the largest kinetic energy, strains the largest \
    relative edge length error. Differences in time below 10 % are noise. Two textbook methods are run with the same steps: \
    accelerations with Lagrange multipliers and Baumgarte's feedback, c'' + 2 g c' + g² c = 0 for every rod, by the classical \
    Runge-Kutta method, with the gain g = 1 / (longest step); and position-based dynamics, whose rods are projected one after \
    the other until all have their lengths to 1e-12. Both are written for this report, with dense matrices and without \
    sparse solvers.";

/// Who takes the steps.
#[derive(Clone, Debug)]
enum Stepping {
    Method(Method),
    Baumgarte,
    PositionBased,
}

/// The methods with the orders that docs/methods.md says.
fn methods() -> impl Iterator<Item = (&'static str, Stepping, f64)> {
    let damped = [
        (DEFAULT, Method::default(), 2.0),
        ("implicit Euler", implicit_euler(), 1.0),
    ];
    let orders = [2.0, 2.0, 4.0];
    let conservative = conservative().into_iter().zip(orders);
    let conservative = conservative.map(|((name, method), order)| (name, method, order));
    let own = damped.into_iter().chain(conservative);
    let textbook = [
        ("multipliers, Baumgarte", Stepping::Baumgarte, 4.0),
        ("position-based, converged", Stepping::PositionBased, 1.0),
    ];
    own.map(|(name, method, order)| (name, Stepping::Method(method), order))
        .chain(textbook)
}

/// A run of a method. The fields are columns of a table, by their names.
#[derive(Clone, Debug, Serialize)]
struct Point {
    method: &'static str,
    step_s: f64,
    cpu_s_per_simulated_s: f64,
    /// Of runs that came to the end with steps as asked for, as are the next two.
    position_error_m: Option<f64>,
    relative_energy_error: Option<f64>,
    strain: Option<f64>,
    factorisations: usize,
    /// Why the run did not come to the end.
    failure: Option<String>,
}

/// An error of a run.
type Error = fn(&Point) -> Option<f64>;

/// Steps of the coarsest run; each has twice as many as the one before.
const COARSEST: usize = 16;

/// Runs that are made however long they take: orders are fitted to the finest of them, and must not depend on
/// how fast the machine is. And most runs.
const RUNS: [u32; 2] = [8, 14];

/// Runs of sheets that are made in any case, which take longer and come to the order with longer steps.
const SHEET_RUNS: u32 = 4;

/// Steps of references: sixteen times as many as the runs that are made in any case have, so that round-off
/// is all of their error.
const REFERENCE: usize = 2048;

/// Most repetitions of short runs.
const REPETITIONS: usize = 5;

/// An order that is fitted to a few runs with finite steps may be smaller by this much.
const FIT: f64 = 0.3;

/// Points that a fitted order rests on, and the error from which they count: ten times the round-off of exact
/// solutions.
const FITTED: usize = 4;
const FLOOR: f64 = 1e-11;

impl ExactProblem {
    /// All of them with their names.
    pub(super) fn named() -> Vec<(&'static str, Self)> {
        let exact = [Self::Pendulum, Self::Triangle, Self::Flap];
        let sheets = [Self::Bumped, Self::Developable];
        let all = exact.into_iter().chain(sheets);
        all.map(|problem| (problem.name(), problem)).collect()
    }

    /// Name on the command line and in tables.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Pendulum => "pendulum",
            Self::Triangle => "triangle",
            Self::Flap => "flap",
            Self::Bumped => "bumped",
            Self::Developable => "developable",
        }
    }

    fn about(self) -> &'static str {
        match self {
            Self::Pendulum => {
                "A triangle pinned along an edge: a pendulum of 0.7 m released at 2 rad, seven tenths of a period, so that it moves at the end; exact by Jacobi functions."
            }
            Self::Triangle => {
                "A tumbling triangle without gravity, one period of its spin; exact by Jacobi functions and a quadrature."
            }
            Self::Flap => {
                "Two triangles that open about their hinge, 0.6 s; exact by a quadrature."
            }
            Self::Bumped => {
                "A tumbling sheet M^1 whose rest shape has a bump of a tenth of its side, so that it is not developable, 0.375 s; \
                 compared with the composition of RATTLE at 2048 steps."
            }
            Self::Developable => {
                "A tumbling sheet M^1 that is flat at rest, and starts bent by 0.3 rad at each line of edges along one side, 0.375 s; \
                 compared with the composition of RATTLE at 2048 steps."
            }
        }
    }

    fn start(self) -> (SheetModel, State) {
        match self {
            Self::Pendulum => (Pendulum::default().model(), Pendulum::default().start()),
            Self::Triangle => {
                let triangle = FreeTriangle::default();
                (triangle.model(), triangle.start())
            }
            Self::Flap => (Flap::default().model(), Flap::default().start()),
            Self::Bumped => tumbling(&bumped(1, 0.1)),
            Self::Developable => {
                let (sheet, x) = bent(1, 0.3);
                tumbling_from(&sheet, x)
            }
        }
    }

    /// Runs that are made however long they take.
    fn least_runs(self) -> u32 {
        match self {
            Self::Bumped | Self::Developable => SHEET_RUNS,
            _ => RUNS[0],
        }
    }

    /// The time that is simulated, seconds.
    fn duration(self) -> f64 {
        match self {
            Self::Pendulum => 0.7 * Pendulum::default().period(),
            Self::Triangle => FreeTriangle::default().period(),
            Self::Flap => 0.6,
            Self::Bumped | Self::Developable => 0.375,
        }
    }

    /// The positions at the end: exact ones, or of a reference.
    fn end(self) -> Result<Vec<f64>> {
        let end = self.duration();
        Ok(match self {
            Self::Pendulum => Pendulum::default().exact(end),
            Self::Triangle => FreeTriangle::default().positions(&[end]).remove(0),
            Self::Flap => Flap::default().exact(end),
            Self::Bumped | Self::Developable => self.reference()?,
        })
    }

    fn reference(self) -> Result<Vec<f64>> {
        let method = Stepping::Method(rattle_composition());
        let (course, end) = self.course(&method, REFERENCE)?;
        ensure!(
            course.is_good(),
            "the reference of {}: {:?}",
            self.name(),
            course.ending
        );
        Ok(end)
    }

    /// So many steps: their course, and the positions at the end.
    fn course(self, stepping: &Stepping, steps: usize) -> Result<(Course, Vec<f64>)> {
        let step = self.duration() / steps as f64;
        let (model, mut state) = self.start();
        let baseline = match stepping {
            Stepping::Method(method) => {
                let mut run = Simulation::new(model, state, method.clone())?;
                let course = Plan::new(step, self.duration()).run(&mut run, &mut unseen)?;
                return Ok((course, run.state().x.clone()));
            }
            Stepping::Baumgarte => Baseline::Baumgarte {
                gain: COARSEST as f64 / self.duration(),
            },
            Stepping::PositionBased => Baseline::PositionBased,
        };
        let course = baseline.run(&model, &mut state, (steps, step))?;
        Ok((course, state.x))
    }

    /// Runs a method with so many steps, and again while it takes less than `again` CPU seconds.
    fn point(
        self,
        (name, stepping): (&'static str, &Stepping),
        (steps, known): (usize, &[f64]),
        again: f64,
    ) -> Result<Point> {
        let (mut fastest, mut end, mut spent) = (None::<Course>, Vec::new(), 0.0);
        for _ in 0..REPETITIONS {
            let (course, positions) = self.course(stepping, steps)?;
            end = positions;
            spent += course.cost.cpu;
            if fastest
                .as_ref()
                .is_none_or(|f| course.cost.cpu < f.cost.cpu)
            {
                fastest = Some(course);
            }
            if spent > again {
                break;
            }
        }
        let course = fastest.unwrap_or_default();
        let is_as_asked = course.is_good() && course.cost.substeps == steps;
        let if_good = |value: f64| is_as_asked.then_some(value);
        Ok(Point {
            method: name,
            step_s: self.duration() / steps as f64,
            cpu_s_per_simulated_s: course.cpu_rate().unwrap_or(0.0),
            position_error_m: if_good(max_difference(&end, known)),
            relative_energy_error: if_good(course.drift / course.most_kinetic),
            strain: if_good(course.strain),
            factorisations: course.cost.factorisations,
            failure: course.failure(),
        })
    }
}

/// Measures all methods on a problem, coarse to fine, until a run takes longer than so many CPU seconds.
fn measure(problem: ExactProblem, limit: f64) -> Result<Vec<Point>> {
    let bar = Progress::start(problem.name(), methods().count());
    let known = problem.end()?;
    let mut points = Vec::new();
    for (name, stepping, _) in methods() {
        for k in 0..RUNS[1] {
            let point = problem.point((name, &stepping), (COARSEST << k, &known), 0.2 * limit)?;
            let spent = point.cpu_s_per_simulated_s * problem.duration();
            let is_exact = point.position_error_m.is_some_and(|e| e < 0.1 * FLOOR);
            points.push(point);
            if is_exact || k + 1 >= problem.least_runs() && spent > limit {
                break;
            }
        }
        bar.step();
    }
    bar.finish(&format!("{} runs", points.len()));
    Ok(points)
}

/// The points of a method.
fn of<'a>(points: &'a [Point], method: &'a str) -> impl Iterator<Item = &'a Point> {
    points.iter().filter(move |p| p.method == method)
}

/// Order of a method: the slope of its error over its step in the finest runs above the floor. Runs that are
/// made in any case count; `None` from fewer than three.
///
/// (The round-off of damped methods grows as steps get shorter, since an acceleration is a difference of
/// positions over the square of the step: below some 1e-5 s it exceeds their error.)
fn order(problem: ExactProblem, points: &[Point], method: &str) -> Option<f64> {
    let made = of(points, method).take(problem.least_runs() as usize);
    let errors = made.filter_map(|p| Some([p.step_s, p.position_error_m?]));
    let usable: Vec<[f64; 2]> = errors.filter(|[_, error]| *error > FLOOR).collect();
    let finest = &usable[usable.len().saturating_sub(FITTED)..];
    exponent(finest).filter(|_| finest.len() > 2)
}

/// Methods, their fitted orders, and the time they take for given errors.
fn table(problem: ExactProblem, points: &[Point]) -> Table {
    let cost = |name: &str, level: f64| {
        let good = of(points, name).filter(|p| p.position_error_m.is_some_and(|e| e <= level));
        good.map(|p| p.cpu_s_per_simulated_s).reduce(f64::min)
    };
    let least = |name: &str, error: Error| of(points, name).filter_map(error).reduce(f64::min);
    // The finest run that is made in any case.
    let made = problem.least_runs() - 1;
    let steps = COARSEST << made;
    let at = |name: &str, value: Error| of(points, name).nth(made as usize).and_then(value);
    Table::of(
        format!(
            "Error against time, {}: fitted orders; with {steps} steps CPU seconds for a simulated second, position error and \
             largest strain; CPU seconds for a simulated second to get below a position error",
            problem.name()
        ),
        methods(),
        columns! { row;
            "method" => row.0,
            "order" => order(problem, points, row.0),
            "s/s" => at(row.0, |p| Some(p.cpu_s_per_simulated_s)),
            "position error, m" => at(row.0, |p| p.position_error_m),
            "strain" => at(row.0, |p| p.strain),
            "s/s for 1e-4 m" => cost(row.0, 1e-4),
            "s/s for 1e-6 m" => cost(row.0, 1e-6),
            "s/s for 1e-8 m" => cost(row.0, 1e-8),
            "best position error, m" => least(row.0, |p| p.position_error_m),
            "best energy error" => least(row.0, |p| p.relative_energy_error),
            "not finished" => of(points, row.0).filter(|p| p.failure.is_some()).count(),
        },
    )
}

/// Time against each error.
fn charts(points: &[Point]) -> Charts {
    let panel = |(label, error, legend): (&str, Error, Legend)| {
        let series = methods().enumerate().map(|(k, (name, ..))| {
            let place = |p: &Point| Some([p.cpu_s_per_simulated_s, error(p)?]);
            Series::styled(k, name, of(points, name).filter_map(place).collect())
        });
        let x = "CPU time / simulated time";
        Chart::log_log(x, label, [200.0, 160.0], series.collect()).with_legend(legend)
    };
    let energy: Error = |p| p.relative_energy_error;
    Charts::row([
        panel(("position error (m)", |p| p.position_error_m, Legend::None)),
        panel(("energy error", energy, Legend::Right)),
    ])
}

/// The orders and the lengths that docs/methods.md and README.md claim.
fn findings(problem: ExactProblem, points: &[Point]) -> Vec<Finding> {
    let mut all = Vec::new();
    for (name, _, theory) in methods() {
        let order = order(problem, points, name).map(Some);
        let bound = Bound::AtLeast(theory - FIT);
        let quantity = "order of the position error";
        all.extend(order.map(|order| Finding::worst(name, quantity, bound, &[order])));
    }
    for name in [DEFAULT, "implicit Euler"] {
        let strains: Vec<_> = of(points, name).map(|p| p.strain).collect();
        let (quantity, bound) = ("largest strain of an edge", Bound::AtMost(LENGTHS));
        all.push(Finding::worst(name, quantity, bound, &strains));
    }
    all
}

/// Makes the part of a problem.
pub(super) fn make(problem: ExactProblem, effort: Effort, files: &mut Files<'_>) -> Result<Record> {
    let name = problem.name();
    let points = measure(problem, effort.pick(0.01, 1.0, 8.0))?;
    Table::of_fields("", &points)?.named(name).write(files)?;
    let alt = format!("{name}: errors against CPU time, by method");
    let figure = plot(files, name, &charts(&points), &alt)?;
    let table = table(problem, &points);
    let inside = html! { h2 { (name) } p { (problem.about()) } (figure) (table) };
    Ok(Record {
        findings: findings(problem, &points),
        excerpt: vec![Part::table(format!("accuracy-{name}"), &table)],
        ..Record::new(name, inside)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_slopes_above_the_floor() {
        let point = |k: i32| Point {
            method: "four",
            step_s: 0.5_f64.powi(k),
            cpu_s_per_simulated_s: 1.0,
            // Round-off in the runs that are made where there is time.
            position_error_m: Some(if k < 8 {
                0.1 * 0.5_f64.powi(4 * k)
            } else {
                1e-8
            }),
            relative_energy_error: None,
            strain: None,
            factorisations: 0,
            failure: None,
        };
        let points: Vec<Point> = (0..14).map(point).collect();
        let order = |points: &[Point], name| order(ExactProblem::Flap, points, name);
        let found = order(&points, "four").expect("enough points");
        assert!((found - 4.0).abs() < 1e-12, "{found}");
        assert_eq!(order(&points[..2], "four"), None, "too few points");
        assert_eq!(order(&points, "none"), None);
    }

    #[test]
    fn a_quick_study_shows_orders_and_lengths() {
        for (_, problem) in ExactProblem::named() {
            let all = findings(problem, &measure(problem, 0.0).expect("runs"));
            assert_eq!(all.len(), methods().count() + 2, "{all:?}");
            assert!(all.iter().all(|f| !f.verdict().is_failure()), "{all:?}");
        }
    }
}
