//! Reference motions, and how long they mean something.

use super::motion::Motion;
use super::problem::{CHECKPOINTS, Problem, Setup};
use super::scheme::{ENERGY_MOMENTUM, REFERENCE, RUNGE_KUTTA, Scheme};
use crate::report::{Effort, Table, columns};
use crate::runs::Plan;
use anyhow::{Context, Result, ensure};
use isosheet_dynamics::leave_flat;
use isosheet_tests::max_difference;

/// Positions that errors are measured against.
#[derive(Clone, Debug)]
pub(super) struct Reference {
    /// Time between checkpoints, seconds.
    pub(super) interval: f64,
    /// Positions at the checkpoints at which it can be trusted.
    pub(super) states: Vec<Vec<f64>>,
    /// Largest distance between it and its second opinion at these checkpoints, metres.
    pub(super) doubt: f64,
    /// Largest kinetic energy at the checkpoints, joules: the scale of energy errors.
    pub(super) energy: f64,
    /// What it is and what it was compared with: by which method, with which steps, seconds, and how far their
    /// last halving moved it, metres.
    sources: [(&'static str, Option<[f64; 2]>); 2],
    /// Mean rate at which neighbouring motions part, `ln(end / start) / time`, 1/s.
    parting: Option<f64>,
}

/// Largest distance between the reference and its second opinion at which it is compared with, metres (sheets
/// are 1 m).
const TRUST: f64 = 1e-5;

impl Reference {
    /// How it was made and how far it goes.
    pub(super) fn table(&self) -> Table {
        Table::of(
            "The reference and its second opinion: two motions by other methods or other steps (those of the energy-momentum method \
             extrapolated to zero), how far the last halving of their steps moved them, the largest distance between them over \
             the time that is compared, and the rate at which a displaced start parts from the reference. After that time the \
             two part, and nothing is compared",
            ["reference", "second opinion"].iter().zip(self.sources),
            columns! { row;
                "motion" => *row.0,
                "made_by" => row.1.0,
                "step_s" => row.1.1.map(|[step, _]| step),
                "last_halving_m" => row.1.1.map(|[_, change]| change),
                "compared_for_s" => self.interval * self.states.len() as f64,
                "distance_m" => self.doubt,
                "rate_of_parting_1_per_s" => self.parting,
            },
        )
    }
}

/// Work of a run: factorisations times vertices. A step counts as at least as many factorisations as a
/// Runge-Kutta step has stages: what factorises less often evaluates forces instead.
type Work = u64;

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

/// A motion in steps that were halved until nothing changed any more, or as far as the work allowed.
struct Refined {
    motion: Motion,
    name: &'static str,
    /// Steps between checkpoints.
    steps: usize,
    /// Distance to the run with half as many steps, metres.
    change: f64,
}

impl Refined {
    fn source(&self, problem: Problem) -> (&'static str, Option<[f64; 2]>) {
        let step = problem.interval() / self.steps as f64;
        (self.name, Some([step, self.change]))
    }
}

/// The reference of a problem; either half of the work may take `budget` units, see [`Work`].
///
/// Neither the reference nor the time over which it is trusted depends on the clock: the work is counted.
pub(super) fn compute(problem: Problem, budget: Work) -> Result<Reference> {
    let interval = problem.interval();
    let times: Vec<f64> = (1..=CHECKPOINTS).map(|k| interval * k as f64).collect();
    let (fine, second) = rayon::join(
        || refine(problem, &Scheme::named(REFERENCE), budget, None),
        || second_opinion(problem, budget),
    );
    let fine = fine?.context("the reference method refused it")?;
    let composition = fine.source(problem);
    let (mut states, other, sources) = match problem.exact(&times) {
        Some(exact) => {
            let exactly = ("the exact solution", None);
            (exact, fine.motion.states, [exactly, composition])
        }
        None => {
            let second = second?.context("no second opinion on the reference")?;
            let sources = [composition, second.source(problem)];
            (fine.motion.states, second.motion.states, sources)
        }
    };
    let pairs = states.iter().zip(&other);
    let doubts: Vec<f64> = pairs.map(|(a, b)| max_difference(a, b)).collect();
    let trusted = doubts.iter().take_while(|d| **d <= TRUST).count();
    // Without a trusted checkpoint there is nothing to compare with.
    ensure!(
        trusted > 0,
        "the reference and its second opinion are {:e} m apart at the first checkpoint",
        doubts[0]
    );
    states.truncate(trusted);
    Ok(Reference {
        interval,
        states,
        doubt: doubts[..trusted].iter().copied().fold(ROUND_OFF, f64::max),
        energy: fine.motion.energy,
        sources,
        parting: parting(problem, trusted, fine.steps.div_ceil(2))?,
    })
}

/// Round-off of positions of sheets of 1 m, metres.
const ROUND_OFF: f64 = 1e-15;

/// Halves the steps until nothing changes any more or the budget is used up; with an `order`, the last two
/// runs are then extrapolated to steps of zero. `None` when there are no two runs.
fn refine(
    problem: Problem,
    scheme: &Scheme,
    budget: Work,
    order: Option<f64>,
) -> Result<Option<Refined>> {
    let (mut spent, mut runs) = (0, Vec::<Refined>::new());
    for k in 2..=14 {
        let steps = 1 << k;
        let (motion, work) = sample(
            scheme,
            problem.setup()?,
            problem.interval(),
            steps,
            CHECKPOINTS,
        )?;
        spent += work;
        match motion {
            Some(motion) => {
                let before = runs.last();
                let change = before.map(|b| distance(&motion.states, &b.motion.states));
                // Once it grows again round-off has taken over.
                let is_worse = |b: &Refined| b.change < ROUNDED && change > Some(b.change);
                if before.is_some_and(is_worse) {
                    break;
                }
                runs.push(Refined {
                    motion,
                    name: scheme.name,
                    steps,
                    change: change.unwrap_or(f64::INFINITY),
                });
            }
            // Steps too coarse for the method may be too coarse no longer.
            None if runs.is_empty() && spent < budget => continue,
            None => break,
        }
        // A run costs about twice the one before. Without two of them there is no reference at all.
        let late = 2 * work > budget.saturating_sub(spent);
        let settled = runs.last().is_some_and(|run| run.change < SETTLED);
        if runs.len() > 1 && (settled || late) {
            break;
        }
    }
    let (Some(mut fine), Some(coarse)) = (runs.pop(), runs.pop()) else {
        return Ok(None);
    };
    if let Some(order) = order {
        richardson(&mut fine.motion.states, &coarse.motion.states, order);
    }
    Ok(Some(fine))
}

/// Change by a halving of the steps at which nothing is left to gain, metres: round-off.
const SETTLED: f64 = 1e-13;

/// Change below which a growing one is due to round-off and not to coarse steps, metres.
const ROUNDED: f64 = 1e-9;

/// `(2^p x(h/2) - x(h)) / (2^p - 1)`, in place of `x(h/2)`.
fn richardson(fine: &mut [Vec<f64>], coarse: &[Vec<f64>], order: f64) {
    let weight = 2f64.powf(order);
    for (f, c) in fine.iter_mut().flatten().zip(coarse.iter().flatten()) {
        *f += (*f - c) / (weight - 1.0);
    }
}

/// Runge-Kutta in a chart where it gets through, else the energy-momentum method, extrapolated.
fn second_opinion(problem: Problem, budget: Work) -> Result<Option<Refined>> {
    let chart = refine(problem, &Scheme::named(RUNGE_KUTTA), budget, None)?;
    match chart.filter(|run| run.change < 1e-7) {
        Some(run) => Ok(Some(run)),
        None => refine(problem, &Scheme::named(ENERGY_MOMENTUM), budget, Some(2.0)),
    }
}

fn distance(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |m, (a, b)| m.max(max_difference(a, b)))
}

/// A run to so many checkpoints with so many steps between two of them, and its work; no run if it failed.
fn sample(
    scheme: &Scheme,
    setup: Setup,
    interval: f64,
    steps: usize,
    checkpoints: usize,
) -> Result<(Option<Motion>, Work)> {
    let plan = Plan::new(interval / steps as f64, interval);
    let Ok(mut run) = scheme.start(setup, plan.step) else {
        return Ok((None, 0));
    };
    let motion = Motion::of(&mut run, plan, checkpoints)?;
    let cost = &motion.course.cost;
    let factorisations = cost.factorisations.max(STAGES * cost.substeps);
    let work = (factorisations * run.state().x.len() / 3) as Work;
    Ok((Some(motion).filter(|m| m.course.is_good()), work))
}

/// Random displacement of the perturbed start, mean edge lengths.
const PERTURBATION: f64 = 1e-7;

/// The mean rate at which a perturbed start parts from the unperturbed one up to the trusted checkpoint where
/// they are farthest apart, by the reference method at a moderate step.
fn parting(problem: Problem, trusted: usize, steps: usize) -> Result<Option<f64>> {
    let (scheme, interval) = (Scheme::named(REFERENCE), problem.interval());
    let (mut starts, mut motions) = (Vec::new(), Vec::new());
    for amplitude in [0.0, PERTURBATION] {
        let mut setup = problem.setup()?;
        leave_flat(&setup.model, &mut setup.state.x, amplitude, 1)?;
        starts.push(setup.state.x.clone());
        let (motion, _) = sample(&scheme, setup, interval, steps, trusted)?;
        motions.extend(motion.map(|motion| motion.states));
    }
    let [unperturbed, perturbed] = &motions[..] else {
        return Ok(None);
    };
    let start = max_difference(&starts[0], &starts[1]);
    let pairs = (1..).zip(unperturbed.iter().zip(perturbed));
    let parted = pairs.map(|(k, (a, b))| (k, max_difference(a, b)));
    let farthest = parted.max_by(|a, b| a.1.total_cmp(&b.1));
    Ok(farthest.map(|(k, end)| (end / start).ln() / (interval * f64::from(k))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Work for some hundred steps of the pendulum between checkpoints.
    const BUDGET: Work = 100_000;

    #[test]
    fn the_exact_pendulum_and_the_reference_method_agree() {
        let reference = compute(Problem::Pendulum, BUDGET).unwrap();
        assert_eq!(reference.states.len(), CHECKPOINTS);
        assert!(reference.doubt < 1e-8, "{:e}", reference.doubt);
        // Neighbouring pendulums part in proportion to time only.
        let rate = reference.parting.unwrap();
        let time = reference.interval * CHECKPOINTS as f64;
        assert!((0.0..100f64.ln() / time).contains(&rate), "{rate}");
    }

    #[test]
    fn more_work_gives_a_finer_reference_and_the_same_work_the_same_bits() {
        let scheme = Scheme::named(REFERENCE);
        let refined = |budget| {
            let run = refine(Problem::Pendulum, &scheme, budget, None).unwrap();
            run.expect("two runs")
        };
        let (coarse, fine, again) = (refined(BUDGET / 50), refined(BUDGET), refined(BUDGET));
        assert!(fine.steps > coarse.steps && fine.change < coarse.change);
        assert!(fine.steps == again.steps && fine.motion.states == again.motion.states);
        // The work of a run grows with its steps.
        let setup = Problem::Pendulum.setup().unwrap();
        let (run, work) = sample(&scheme, setup, 0.1, 8, CHECKPOINTS).unwrap();
        assert!(run.is_some() && work >= (8 * CHECKPOINTS * STAGES * 3) as Work);
    }

    #[test]
    fn extrapolation_removes_the_leading_error() {
        let states = |h: f64| vec![vec![1.0 + h * h]];
        let mut fine = states(0.1);
        richardson(&mut fine, &states(0.2), 2.0);
        assert!((fine[0][0] - 1.0).abs() < 1e-15);
    }
}
