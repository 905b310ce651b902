//! The points of a study: runs of a method in ever finer steps, their times and their errors.

use super::motion::Motion;
use super::problem::Problem;
use super::reference::Reference;
use super::scheme::{Kind, Scheme};
use crate::report::{exponent, rounded};
use crate::runs::Plan;
use anyhow::{Context, Result};
use cpu_time::ThreadTime;
use isosheet_tests::max_difference;
use serde::Serialize;

/// What one run of a method gave, up to the last checkpoint of a run that did not come to the end. The fields
/// are columns of a table, by their names.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Point {
    pub(super) method: &'static str,
    /// Step asked for, seconds, or of adaptive methods the bound on the change of energy, parts of the energy
    /// scale.
    step_or_tolerance: f64,
    mean_step_s: f64,
    /// The least of the repetitions; 0 without a step.
    pub(super) cpu_s_per_simulated_s: f64,
    /// Largest distance of a vertex from the reference at the checkpoints, of runs that came to the end.
    position_error_m: Option<f64>,
    /// Largest change of the energy, as part of the largest kinetic energy, of runs that came to the end.
    relative_energy_error: Option<f64>,
    /// Largest relative edge length error, of runs that came to the end.
    strain: Option<f64>,
    /// Parts of steps, where steps were divided.
    steps: usize,
    rejected: usize,
    factorisations: usize,
    repetitions: usize,
    /// Simulated time, seconds.
    reached_s: f64,
    /// Why the run did not come to the end.
    pub(super) failure: Option<String>,
    /// Whether all steps were taken as asked for, so that errors show the order.
    #[serde(skip)]
    uniform: bool,
    /// Whether the run came to a checkpoint.
    #[serde(skip)]
    got_going: bool,
}

/// Which error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measure {
    pub(super) name: &'static str,
    /// The largest error that is of use, a power of ten: coarser runs are cheap, but no motion. Position
    /// errors of sheets of 1 m.
    pub(super) useful: i32,
    /// The error of a run that came to the end.
    pub(super) of: fn(&Point) -> Option<f64>,
}

pub(super) const POSITION: Measure = Measure {
    name: "position, m",
    useful: -2,
    of: |point| point.position_error_m,
};
pub(super) const ENERGY: Measure = Measure {
    name: "energy",
    useful: -1,
    of: |point| point.relative_energy_error,
};
pub(super) const STRAIN: Measure = Measure {
    name: "strain",
    useful: -2,
    of: |point| point.strain,
};

/// Points that a fitted order rests on: the finest ones, before floors are reached.
const FITTED: usize = 4;

/// Order of a method: the slope of its error over its step, from the finest runs whose error is ten times
/// above `floor` and whose steps were taken as asked for.
pub(super) fn order(points: &[Point], method: &str, measure: Measure, floor: f64) -> Option<f64> {
    let uniform = points.iter().filter(|p| p.method == method && p.uniform);
    let errors = uniform.filter_map(|p| Some([p.mean_step_s, (measure.of)(p)?]));
    let usable: Vec<[f64; 2]> = errors.filter(|[_, e]| *e > 10.0 * floor).collect();
    let finest = usable.len().saturating_sub(FITTED);
    exponent(&usable[finest..]).filter(|_| usable.len() - finest >= 3)
}

/// The cheapest point whose error is at most `level`.
pub(super) fn cheapest<'a>(
    points: impl IntoIterator<Item = &'a Point>,
    measure: Measure,
    level: f64,
) -> Option<&'a Point> {
    let points = points.into_iter();
    let good = points.filter(|p| (measure.of)(p).is_some_and(|e| e <= level));
    good.min_by(|a, b| a.cpu_s_per_simulated_s.total_cmp(&b.cpu_s_per_simulated_s))
}

/// Most repetitions of short runs.
const REPETITIONS: usize = 5;

/// Change of energy, as part of the largest kinetic energy, that is no motion any more.
const BLOWN_UP: f64 = 100.0;

/// What is said of such a run.
const LOST: &str =
    "blown up: its energy changes by more than a hundred times the largest kinetic energy";

/// Measures a method on a problem whose step or tolerance was halved or divided by the root of ten `k` times.
/// Runs that take longer than `patience` CPU seconds are given up; those that took no more than `again` of them
/// together are repeated, and the fastest counts.
fn point(
    problem: Problem,
    scheme: &Scheme,
    reference: &Reference,
    k: u32,
    [patience, again]: [f64; 2],
) -> Result<Point> {
    let (asked, is_adaptive) = match scheme.kind {
        Kind::Adaptive(_) => (0.3 * 10f64.powf(-0.5 * f64::from(k)), true),
        _ => (reference.interval / f64::from(1 << k), false),
    };
    let (step, fineness) = match is_adaptive {
        true => (reference.interval, asked * reference.energy),
        false => (asked, asked),
    };
    let mut point = Point {
        method: scheme.name,
        step_or_tolerance: asked,
        ..Point::default()
    };
    let plan = Plan::new(step, reference.interval).within(patience);
    let checkpoints = reference.states.len();
    let clock = ThreadTime::now();
    let mut fastest: Option<Motion> = None;
    loop {
        let mut run = match scheme.start(problem.setup()?, fineness) {
            Ok(run) => run,
            Err(error) => {
                point.failure = Some(format!("refused at the start: {error}"));
                return Ok(point);
            }
        };
        let motion = Motion::of(&mut run, plan, checkpoints)?;
        point.repetitions += 1;
        let cpu = |motion: &Motion| motion.course.cost.cpu;
        let is_last = !motion.course.is_good() || point.repetitions == REPETITIONS;
        if fastest.as_ref().is_none_or(|f| cpu(&motion) < cpu(f)) {
            fastest = Some(motion);
        }
        if is_last || clock.elapsed().as_secs_f64() > again {
            break;
        }
    }
    let Motion { course, states, .. } = fastest.context("no run")?;
    let (cost, energy) = (&course.cost, course.drift / reference.energy);
    point.mean_step_s = course.time / cost.substeps.max(1) as f64;
    point.cpu_s_per_simulated_s = course.cpu_rate().unwrap_or(0.0);
    (point.steps, point.rejected) = (cost.substeps, cost.rejected);
    (point.factorisations, point.reached_s) = (cost.factorisations, course.time);
    point.got_going = !states.is_empty() && energy <= BLOWN_UP;
    point.failure = course.failure().as_deref().map(rounded);
    if point.failure.is_none() && energy > BLOWN_UP {
        point.failure = Some(LOST.to_owned());
    }
    if point.failure.is_none() {
        let as_asked = is_adaptive || cost.substeps == checkpoints << k;
        point.uniform = as_asked && cost.rejected == 0;
        let pairs = states.iter().zip(&reference.states);
        let distances = pairs.map(|(x, want)| max_difference(x, want));
        // Differences smaller than the doubt of the reference mean nothing.
        point.position_error_m = Some(distances.fold(reference.doubt, f64::max));
        point.relative_energy_error = Some(energy);
        point.strain = Some(course.strain);
    }
    Ok(point)
}

/// Most halvings of the step.
const HALVINGS: u32 = 14;

/// Runs that are made on the smooth problems however long they take, each with half the step of the one
/// before: the orders that are required of the methods are fitted to the finest of them, and must not depend
/// on how fast the machine is.
const RUNS_FOR_ORDERS: u32 = 10;

/// All runs of a method together may take so many times the longest.
const MOST: f64 = 5.0;

/// Runs that fail in a row, before the first checkpoint, after which finer ones are not tried.
const FAILURES: usize = 5;

/// Measures a method over its steps or tolerances, coarse to fine, until a run takes longer than `limit` CPU
/// seconds or refining makes no difference. On the smooth problems the first [`RUNS_FOR_ORDERS`] are
/// made whatever they take.
pub(super) fn sweep(
    problem: Problem,
    scheme: &Scheme,
    reference: &Reference,
    limit: f64,
) -> Result<Vec<Point>> {
    let mut points: Vec<Point> = Vec::new();
    let mut failures = 0;
    let total = ThreadTime::now();
    for k in 0..=HALVINGS {
        let is_adaptive = matches!(scheme.kind, Kind::Adaptive(_));
        let needed = problem.is_smooth() && !is_adaptive && k < RUNS_FOR_ORDERS;
        // A run costs about twice the one before.
        let patience = if needed { f64::INFINITY } else { 2.0 * limit };
        let clock = ThreadTime::now();
        let point = point(problem, scheme, reference, k, [patience, 0.2 * limit])?;
        let spent = clock.elapsed().as_secs_f64() / point.repetitions.max(1) as f64;
        failures = if point.got_going { 0 } else { failures + 1 };
        let refused = point.steps == 0;
        // Below the doubt of the reference nothing is learnt.
        let settled = point.position_error_m.is_some_and(|e| e <= reference.doubt);
        // A run that fails early says nothing about how long a finer one takes.
        let slow = point.failure.is_none() && spent > limit
            || total.elapsed().as_secs_f64() > MOST * limit;
        points.push(point);
        if refused || settled || failures == FAILURES || slow && !needed {
            break;
        }
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Vec<Point> {
        let point = |method, step, cpu, error| Point {
            method,
            mean_step_s: step,
            uniform: true,
            position_error_m: Some(error),
            cpu_s_per_simulated_s: cpu,
            ..Point::default()
        };
        let steps = (0..6).map(|k| 0.1 * 0.5f64.powi(k));
        let of_step = |h: f64| {
            [
                point("one", h, 0.01 / h, h),
                point("four", h, 0.1 / h, h.powi(4)),
                point("bad", h, 1.0 / h, h),
            ]
        };
        steps.flat_map(of_step).collect()
    }

    #[test]
    fn orders_are_slopes_above_the_floor() {
        let points = sample();
        let o = |name, floor| order(&points, name, POSITION, floor);
        assert!((o("one", 1e-12).unwrap() - 1.0).abs() < 1e-12);
        assert!((o("four", 1e-12).unwrap() - 4.0).abs() < 1e-12);
        assert_eq!(o("four", 1e-5), None, "too few points are left");
    }

    #[test]
    fn the_cheapest_is_the_first_below_a_level() {
        let points = sample();
        let name = |level| cheapest(&points, POSITION, level).map(|p| p.method);
        assert_eq!(name(0.1), Some("one"));
        assert_eq!(name(1e-4), Some("four"));
        assert_eq!(name(1e-20), None);
    }
}
