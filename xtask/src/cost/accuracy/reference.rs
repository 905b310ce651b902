//! Reference motions, and how long they mean something.

use super::problem::{CHECKPOINTS, Problem};
use super::scheme::{Fineness, Scheme};
use crate::report::Effort;
use crate::runs::Plan;
use anyhow::{Context, Result};
use isosheet_dynamics::{Method, Simulation, State, StepReport, leave_flat};
use isosheet_tests::max_difference;
use std::ops::ControlFlow;

/// Positions that errors are measured against.
#[derive(Clone, Debug)]
pub(crate) struct Reference {
    duration: f64,
    states: Vec<Vec<f64>>,
    /// How far the second opinion is away at each checkpoint, metres.
    doubts: Vec<f64>,
    usable: usize,
    /// Largest kinetic energy at the checkpoints, joules: the scale of energy errors.
    pub(crate) energy: f64,
    /// What it is and what it was compared with, in words.
    pub(crate) source: String,
    /// How fast neighbouring motions part.
    pub(crate) growth: Option<Growth>,
}

/// Growth of a small difference at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Growth {
    /// Largest distance of a vertex at the start, metres.
    pub(crate) start: f64,
    /// The largest at a checkpoint, metres.
    pub(crate) end: f64,
    /// Mean rate up to there, `ln(end / start) / time`, 1/s.
    pub(crate) rate: f64,
}

/// Largest distance between the reference and its second opinion at which it is compared with, metres (sheets
/// are 1 m).
const TRUST: f64 = 1e-5;

impl Reference {
    /// Time between checkpoints, seconds.
    pub(crate) fn interval(&self) -> f64 {
        self.duration / CHECKPOINTS as f64
    }

    /// Number of checkpoints at which it can be trusted.
    pub(crate) fn usable(&self) -> usize {
        self.usable
    }

    /// The time over which it can be trusted, seconds.
    pub(crate) fn meaningful(&self) -> f64 {
        self.interval() * self.usable as f64
    }

    /// Positions at the checkpoints at which it can be trusted.
    pub(crate) fn positions(&self) -> &[Vec<f64>] {
        &self.states[..self.usable]
    }

    /// Largest distance between it and its second opinion at these checkpoints, metres.
    pub(crate) fn doubt(&self) -> f64 {
        self.doubts[..self.usable]
            .iter()
            .fold(1e-15, |m: f64, d| m.max(*d))
    }
}

/// Work of a run: factorisations times vertices. A step counts as at least as many factorisations as a
/// Runge-Kutta step has stages: what factorises less often evaluates forces instead.
pub(crate) type Work = u64;

/// Work of about a tenth of a second: the energy-momentum method takes 0.14 s for the 1149 factorisations of
/// one second of the hanging sheet M^1, which has 25 vertices, on one core at 2.6 GHz.
const TENTH: Work = 20_000;

/// Most work of the reference of a problem and of its second opinion, each. Counted, so that results do not
/// depend on the clock.
pub(super) fn budget(problem: Problem, effort: Effort) -> Work {
    let tenths = match problem {
        // The search for contacts takes several times as long as the factorisations.
        Problem::Cloth(_) => effort.pick(2, 30, 120),
        Problem::Sheet(2..) => effort.pick(1, 150, 600),
        // Runs in charts, whose steps cost the cube of its links, take most of what they may.
        Problem::Strip(64..) => effort.pick(1, 30, 600),
        _ => effort.pick(1, 50, 600),
    };
    tenths * TENTH
}

/// Stages of a Runge-Kutta step.
const STAGES: usize = 4;

/// A motion sampled at the checkpoints.
struct Track {
    states: Vec<Vec<f64>>,
    energy: f64,
    /// Steps between checkpoints.
    steps: usize,
    /// Distance to the run with half as many steps, metres.
    change: f64,
}

/// The reference of a problem; either half of the work may take `budget` units, see [`Work`].
///
/// Neither the reference nor the time over which it is trusted depends on the clock: the work is counted.
pub(crate) fn compute(problem: Problem, budget: Work) -> Result<Reference> {
    let duration = problem.duration();
    let times = (1..=CHECKPOINTS).map(|k| duration * k as f64 / CHECKPOINTS as f64);
    let times: Vec<f64> = times.collect();
    let (fine, second) = rayon::join(
        || refine(problem, &Scheme::reference(), budget, None),
        || second_opinion(problem, budget),
    );
    let fine = fine?.with_context(|| format!("{problem}: the reference method refused it"))?;
    let composition = format!(
        "the fourth-order composition of RATTLE with steps of {:.1e} s (its last halving moved it by {:.0e} m)",
        times[0] / fine.steps as f64,
        fine.change
    );
    let (states, other, source) = match problem.exact(&times) {
        Some(exact) => (
            exact,
            fine.states,
            format!("Reference: the exact solution. Second opinion: {composition}"),
        ),
        None => {
            let (name, second) = second?;
            let source = format!(
                "Reference: {composition}. Second opinion: {name}, steps of {:.1e} s",
                times[0] / second.steps as f64
            );
            (fine.states, second.states, source)
        }
    };
    let pairs = states.iter().zip(&other);
    let doubts: Vec<f64> = pairs.map(|(a, b)| max_difference(a, b)).collect();
    let usable = doubts.iter().take_while(|d| **d <= TRUST).count();
    // Without a trusted checkpoint there is nothing to compare with.
    anyhow::ensure!(
        usable > 0,
        "{problem}: the reference and its second opinion are {:e} m apart at the first checkpoint",
        doubts.first().copied().unwrap_or(f64::INFINITY)
    );
    let growth = growth(problem, times[0], usable, fine.steps.div_ceil(2), budget)?;
    Ok(Reference {
        duration,
        states,
        doubts,
        usable,
        energy: fine.energy,
        source,
        growth,
    })
}

/// Halves the steps until nothing changes any more or the budget is used up; with an `order`, the last two
/// runs are then extrapolated to steps of zero. `None` when there are no two runs.
fn refine(
    problem: Problem,
    scheme: &Scheme,
    budget: Work,
    order: Option<f64>,
) -> Result<Option<Track>> {
    let mut spent = 0;
    let mut tracks: Vec<Track> = Vec::new();
    for k in 2..=14 {
        let limit = if tracks.len() < 2 {
            FIRST * budget
        } else {
            budget.saturating_sub(spent)
        };
        let (track, work) = sample(problem, scheme, 1 << k, limit)?;
        spent += work;
        match track {
            Some(mut track) => {
                if let Some(before) = tracks.last() {
                    track.change = distance(&track.states, &before.states);
                    // Once it grows again round-off has taken over.
                    if before.change < ROUNDED && track.change > before.change {
                        break;
                    }
                }
                tracks.push(track);
            }
            // Steps too coarse for the method may be too coarse no longer.
            None if tracks.is_empty() && spent < budget => continue,
            None => break,
        }
        let late = 2 * work > budget.saturating_sub(spent);
        let settled = tracks.last().is_some_and(|t| t.change < SETTLED);
        if tracks.len() > 1 && (settled || late) {
            break;
        }
    }
    let (Some(mut fine), Some(coarse)) = (tracks.pop(), tracks.pop()) else {
        return Ok(None);
    };
    if let Some(order) = order {
        richardson(&mut fine, &coarse, order);
    }
    Ok(Some(fine))
}

/// Change by a halving of the steps at which nothing is left to gain, metres: round-off.
const SETTLED: f64 = 1e-13;

/// Change below which a growing one is due to round-off and not to coarse steps, metres.
const ROUNDED: f64 = 1e-9;

/// The first two runs may take so many times the budget: without them there is no reference at all.
const FIRST: Work = 10;

/// `(2^p x(h/2) - x(h)) / (2^p - 1)`.
fn richardson(fine: &mut Track, coarse: &Track, order: f64) {
    let weight = 2f64.powf(order);
    for (f, c) in fine.states.iter_mut().zip(&coarse.states) {
        for (f, c) in f.iter_mut().zip(c) {
            *f += (*f - c) / (weight - 1.0);
        }
    }
}

/// Runge-Kutta in a chart where it gets through, else the energy-momentum method, extrapolated.
fn second_opinion(problem: Problem, budget: Work) -> Result<(&'static str, Track)> {
    let chart = refine(problem, &Scheme::runge_kutta(), budget, None)?;
    if let Some(track) = chart
        && track.change < 1e-7
    {
        return Ok(("Runge-Kutta in a Cartesian chart", track));
    }
    let track = refine(problem, &Scheme::energy_momentum(), budget, Some(2.0))?;
    let track = track.with_context(|| format!("{problem}: no second opinion on the reference"))?;
    Ok((
        "the energy-momentum method, its last two step sizes extrapolated to zero",
        track,
    ))
}

fn distance(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |m, (a, b)| m.max(max_difference(a, b)))
}

/// A run and its work; no run if it failed or its work exceeded the limit.
fn sample(
    problem: Problem,
    scheme: &Scheme,
    steps: usize,
    limit: Work,
) -> Result<(Option<Track>, Work)> {
    let interval = problem.duration() / CHECKPOINTS as f64;
    match scheme.start(problem, Fineness::Step(interval / steps as f64))? {
        Ok(mut run) => follow(&mut run, interval, CHECKPOINTS, steps, limit),
        Err(_) => Ok((None, 0)),
    }
}

fn follow(
    run: &mut Simulation,
    interval: f64,
    checkpoints: usize,
    steps: usize,
    limit: Work,
) -> Result<(Option<Track>, Work)> {
    let mut track = Track {
        states: Vec::new(),
        energy: run.model().kinetic_energy(&run.state().v),
        steps,
        change: f64::INFINITY,
    };
    let h = interval / steps as f64;
    let vertices = run.state().x.len() / 3;
    let mut work = 0;
    for _ in 0..checkpoints {
        let mut look = |_: &Simulation, report: &StepReport| {
            let factorisations = report.factorisations.max(STAGES * report.substeps);
            work += (factorisations * vertices) as Work;
            if work > limit {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        };
        if !Plan::new(h, interval).run(run, &mut look)?.is_good() {
            return Ok((None, work));
        }
        track.energy = track.energy.max(run.model().kinetic_energy(&run.state().v));
        track.states.push(run.state().x.clone());
    }
    Ok((Some(track), work))
}

/// Random displacement of the perturbed start, mean edge lengths.
const PERTURBATION: f64 = 1e-7;

/// How a perturbed start parts from the unperturbed one, by the reference method at a moderate step.
fn growth(
    problem: Problem,
    interval: f64,
    usable: usize,
    steps: usize,
    budget: Work,
) -> Result<Option<Growth>> {
    let mut tracks = Vec::new();
    let mut starts = Vec::new();
    for amplitude in [0.0, PERTURBATION] {
        let State { mut x, v, .. } = problem.start()?;
        leave_flat(&problem.model()?, &mut x, amplitude, 1)?;
        starts.push(x.clone());
        let method = Method::RattleComposition(Default::default());
        let Ok(mut run) = problem.simulation(&method, State::moving(x, v))? else {
            return Ok(None);
        };
        match follow(&mut run, interval, usable, steps.max(1), budget)?.0 {
            Some(track) => tracks.push(track.states),
            None => return Ok(None),
        }
    }
    let start = max_difference(&starts[0], &starts[1]);
    let parted = (1..).zip(tracks[0].iter().zip(&tracks[1]));
    let largest = parted
        .map(|(k, (a, b))| (k, max_difference(a, b)))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    Ok(largest.map(|(k, end)| Growth {
        start,
        end,
        rate: (end / start).ln() / (interval * f64::from(k)),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exact_pendulum_and_the_reference_method_agree() {
        let reference = compute(Problem::Pendulum, BUDGET).unwrap();
        assert_eq!(reference.usable(), CHECKPOINTS);
        assert!(reference.doubt() < 1e-8, "{:e}", reference.doubt());
        let growth = reference.growth.unwrap();
        // Neighbouring pendulums part in proportion to time only.
        assert!((1.0..100.0).contains(&(growth.end / growth.start)));
    }

    /// Work for some hundred steps of the pendulum between checkpoints.
    const BUDGET: Work = 100_000;

    #[test]
    fn more_work_gives_a_finer_reference_and_the_same_work_the_same_bits() {
        let scheme = Scheme::reference();
        let track = |budget| {
            refine(Problem::Pendulum, &scheme, budget, None)
                .unwrap()
                .unwrap()
        };
        let (coarse, fine, again) = (track(BUDGET / 50), track(BUDGET), track(BUDGET));
        assert!(
            fine.steps > coarse.steps && fine.change < coarse.change,
            "{} {}",
            fine.steps,
            coarse.steps
        );
        assert!(fine.steps == again.steps && fine.states == again.states);
        // The work of a run grows with its steps, and a run beyond its limit is given up.
        let (run, work) = sample(Problem::Pendulum, &scheme, 8, Work::MAX).unwrap();
        assert!(run.is_some() && work >= (8 * CHECKPOINTS * STAGES * 3) as Work);
        let (run, cut) = sample(Problem::Pendulum, &scheme, 8, work / 2).unwrap();
        assert!(run.is_none() && cut > work / 2 && cut < work);
    }

    #[test]
    fn extrapolation_removes_the_leading_error() {
        let track = |h: f64| Track {
            states: vec![vec![1.0 + h * h]],
            energy: 0.0,
            steps: 1,
            change: 0.0,
        };
        let mut fine = track(0.1);
        richardson(&mut fine, &track(0.2), 2.0);
        assert!((fine.states[0][0] - 1.0).abs() < 1e-15);
    }
}
