//! One run of a method: its time and its errors.

use super::problem::Problem;
use super::reference::Reference;
use super::scheme::{Fineness, Scheme};
use crate::report::Cost;
use crate::runs::{Course, Ending, Plan, unseen};
use anyhow::Result;
use isosheet_dynamics::Simulation;
use isosheet_tests::max_difference;
use std::time::Instant;

/// What one run of a method gave.
#[derive(Clone, Debug, Default)]
pub(crate) struct Point {
    /// Name of the method.
    pub(crate) scheme: String,
    /// Step asked for, seconds, or of adaptive methods the bound on the change of energy, parts of the energy
    /// scale.
    pub(crate) fineness: f64,
    /// Mean step taken, seconds.
    pub(crate) step: f64,
    /// Whether all steps were taken as asked for, so that errors show the order.
    pub(crate) uniform: bool,
    /// CPU seconds for a simulated second, the minimum over the repetitions.
    pub(crate) cpu: f64,
    pub(crate) repetitions: usize,
    /// What the run cost; up to the last checkpoint where it did not come to the end, but for counts other
    /// than those of sub-steps.
    pub(crate) cost: Cost,
    /// Errors, of runs that came to the end.
    pub(crate) errors: Option<Errors>,
    /// Whether the run came to a checkpoint.
    pub(crate) got_going: bool,
    /// Simulated time, seconds; of runs that did not come to the end that of the last checkpoint that was
    /// reached, if any, to which the time belongs as well.
    pub(crate) reached: f64,
    /// Why a run did not come to the end.
    pub(crate) failure: Option<String>,
}

/// Largest errors over a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Errors {
    /// Distance of a vertex from the reference at the checkpoints, metres.
    pub(crate) position: f64,
    /// Change of the energy, as part of the largest kinetic energy.
    pub(crate) energy: f64,
    /// Relative edge length error.
    pub(crate) strain: f64,
}

/// One pass over the checkpoints.
#[derive(Default)]
struct Pass {
    course: Course,
    /// Largest distance from the reference, metres.
    position: f64,
    failure: Option<String>,
    /// Whether a checkpoint was reached.
    got_going: bool,
}

/// Most repetitions of short runs.
const REPETITIONS: usize = 5;

/// Measures a method at a fineness. Runs that take longer than `patience` seconds are given up; those that
/// took less than `again` seconds together are repeated.
pub(crate) fn point(
    problem: Problem,
    scheme: &Scheme,
    reference: &Reference,
    asked: Asked,
    patience: f64,
    again: f64,
) -> Result<Point> {
    let mut best: Option<Pass> = None;
    let mut repetitions = 0;
    let clock = Instant::now();
    while repetitions < REPETITIONS {
        let mut simulation = match scheme.start(problem, asked.fineness(reference))? {
            Ok(simulation) => simulation,
            Err(error) => {
                let failure = format!("refused at the start: {error}");
                return Ok(refused(scheme, asked.value(reference), failure));
            }
        };
        let pieces = match asked {
            Asked::Steps(n) if !scheme.steps_itself() => n,
            _ => 1,
        };
        let pass = run(&mut simulation, reference, pieces, patience)?;
        repetitions += 1;
        let stop = pass.failure.is_some();
        if best
            .as_ref()
            .is_none_or(|b| pass.course.cost.cpu < b.course.cost.cpu)
        {
            best = Some(pass);
        }
        if stop || clock.elapsed().as_secs_f64() > again {
            break;
        }
    }
    let Some(mut pass) = best else {
        return Ok(refused(scheme, asked.value(reference), "not run".into()));
    };
    // Differences smaller than the doubt of the reference mean nothing.
    pass.position = pass.position.max(reference.doubt());
    Ok(of_pass(pass, scheme, reference, asked, repetitions))
}

/// The point of a method that took no step.
fn refused(scheme: &Scheme, fineness: f64, failure: String) -> Point {
    Point {
        scheme: scheme.name.clone(),
        fineness,
        failure: Some(failure),
        ..Point::default()
    }
}

/// The point that a pass over the checkpoints makes.
fn of_pass(
    mut pass: Pass,
    scheme: &Scheme,
    reference: &Reference,
    asked: Asked,
    repetitions: usize,
) -> Point {
    let (course, cost) = (&pass.course, &pass.course.cost);
    let energy = course.drift / reference.energy;
    let errors = Errors {
        position: pass.position,
        energy,
        strain: course.strain,
    };
    if pass.failure.is_none() && energy > BLOWN_UP {
        pass.failure = Some(format!(
            "blown up: its energy changes by {energy:.0e} of the largest kinetic energy"
        ));
    }
    let finished = pass.failure.is_none();
    let expected = match asked {
        Asked::Steps(n) => n * reference.usable(),
        Asked::Tolerance(_) => cost.substeps,
    };
    // Round-off may leave a rest of a step at every checkpoint.
    let rests = if scheme.steps_itself() {
        reference.usable()
    } else {
        0
    };
    let as_asked = (expected..=expected + rests).contains(&cost.substeps) && cost.rejected == 0;
    Point {
        scheme: scheme.name.clone(),
        fineness: asked.value(reference),
        step: match asked.fineness(reference) {
            Fineness::Step(h) if rests > 0 => h,
            _ => course.time / cost.substeps.max(1) as f64,
        },
        uniform: finished && as_asked,
        cpu: course.cpu_rate().unwrap_or(0.0),
        repetitions,
        cost: *cost,
        errors: finished.then_some(errors),
        got_going: pass.got_going && energy <= BLOWN_UP,
        reached: course.time,
        failure: pass.failure,
    }
}

/// How fine a run is asked to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Asked {
    /// Steps between two checkpoints.
    Steps(usize),
    /// Change of energy in a step, parts of the energy scale.
    Tolerance(f64),
}

impl Asked {
    /// The step in seconds or the tolerance in joules.
    fn fineness(self, reference: &Reference) -> Fineness {
        match self {
            Self::Steps(n) => Fineness::Step(reference.interval() / n as f64),
            Self::Tolerance(part) => Fineness::Tolerance(part * reference.energy),
        }
    }

    /// The step in seconds or the tolerance as asked for, see [`Point::fineness`].
    fn value(self, reference: &Reference) -> f64 {
        match self {
            Self::Steps(n) => reference.interval() / n as f64,
            Self::Tolerance(part) => part,
        }
    }
}

fn run(
    simulation: &mut Simulation,
    reference: &Reference,
    pieces: usize,
    patience: f64,
) -> Result<Pass> {
    let mut pass = Pass::default();
    let interval = reference.interval();
    let mut at_last_checkpoint = None;
    for want in reference.positions() {
        let left = patience - pass.course.cost.wall;
        let plan = Plan::new(interval / pieces as f64, interval).within(left);
        plan.go_on(simulation, &mut pass.course, &mut unseen)?;
        let course = &mut pass.course;
        pass.failure = match course.ending {
            Ending::WallTime(_) => Some(format!("given up after {patience} s of wall time")),
            _ => course.failure(),
        };
        if pass.failure.is_some() {
            // What a run spent on its way from the last checkpoint to its failure is not counted.
            if let Some((cpu, time, substeps)) = at_last_checkpoint {
                (course.cost.cpu, course.time, course.cost.substeps) = (cpu, time, substeps);
            }
            break;
        }
        pass.position = pass
            .position
            .max(max_difference(&simulation.state().x, want));
        pass.got_going = true;
        at_last_checkpoint = Some((course.cost.cpu, course.time, course.cost.substeps));
    }
    Ok(pass)
}

/// Change of energy, as part of the largest kinetic energy, that is no motion any more.
const BLOWN_UP: f64 = 100.0;

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

/// Measures a method over its steps or tolerances, coarse to fine, until a run takes longer than `limit`
/// seconds or refining makes no difference. On the smooth problems the first [`RUNS_FOR_ORDERS`] are
/// made whatever they take.
pub(crate) fn sweep(
    problem: Problem,
    scheme: &Scheme,
    reference: &Reference,
    limit: f64,
) -> Result<Vec<Point>> {
    let mut points: Vec<Point> = Vec::new();
    let mut failures = 0;
    let total = Instant::now();
    for k in 0..=HALVINGS {
        let asked = if scheme.is_adaptive() {
            Asked::Tolerance(0.3 * 10f64.powf(-0.5 * f64::from(k)))
        } else {
            Asked::Steps(1 << k)
        };
        let clock = Instant::now();
        let needed = problem.is_smooth() && !scheme.is_adaptive() && k < RUNS_FOR_ORDERS;
        // A run costs about twice the one before.
        let patience = if needed { f64::INFINITY } else { 2.0 * limit };
        let point = point(problem, scheme, reference, asked, patience, 0.2 * limit)?;
        let spent = clock.elapsed().as_secs_f64() / point.repetitions.max(1) as f64;
        failures = if point.got_going { 0 } else { failures + 1 };
        let refused = point.cost.substeps == 0;
        // Below the doubt of the reference nothing is learnt.
        let settled = point
            .errors
            .is_some_and(|e| e.position <= reference.doubt());
        // A run that fails early says nothing about how long a finer one takes.
        let slow = !needed
            && (point.errors.is_some() && spent > limit
                || total.elapsed().as_secs_f64() > MOST * limit);
        points.push(point);
        if refused || settled || failures == FAILURES || slow {
            break;
        }
    }
    Ok(points)
}
