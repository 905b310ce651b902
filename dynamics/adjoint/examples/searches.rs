//! What inverse problems cost in CPU seconds, led by gradients and by differences of runs: `cargo run -p
//! isosheet-adjoint --example searches`.

#[path = "../tests/it/problems.rs"]
mod problems;
#[path = "../tests/it/search.rs"]
mod search;

use cpu_time::ProcessTime;
use isosheet_adjoint::{
    AdjointOptions, Family, Loss, Plan, Run, SceneError, coordinate, squared_distances,
};
use problems::{TIP, at_rest, by_clamp, by_curls, by_heights, by_rigidity, squared_heights};
use search::{Found, lead_by_gradients, minimise, solve};

/// The part of a size over which differences of runs are taken.
const DIFFERENCE: f64 = 1e-6;

fn value(family: &dyn Family, plan: &Plan, numbers: &[f64], loss: &dyn Loss) -> Option<f64> {
    let run = Run::record(family, numbers, plan.clone(), AdjointOptions::default()).ok()?;
    run.value(loss).ok()
}

/// The secant method: the number with which a loss has a value, and how many runs that takes.
fn secant(family: &dyn Family, loss: &dyn Loss, start: f64, target: f64) -> (f64, usize) {
    let plan = at_rest();
    let miss = |number: f64| value(family, &plan, &[number], loss).map(|found| found - target);
    let (mut before, mut number) = (start, 0.9 * start);
    let mut at_before = miss(before).unwrap_or(f64::NAN);
    for runs in 2..40 {
        let here = miss(number).unwrap_or(f64::NAN);
        let step = here * (number - before) / (here - at_before);
        (before, at_before) = (number, here);
        number -= step.clamp(-0.5 * number.abs(), 0.5 * number.abs());
        if step.abs() <= 1e-9 * number.abs() {
            return (number, runs);
        }
    }
    (f64::NAN, 40)
}

fn report(name: &str, led: &str, begin: ProcessTime, runs: usize, found: &str) {
    let seconds = begin.elapsed().as_secs_f64();
    println!("{name}, led by {led}: {runs} runs, {seconds:.2} CPU s, {found}");
}

fn number(name: &str, family: &dyn Family, start: f64, target: f64) {
    let loss = coordinate(TIP, 2, 1);
    let begin = ProcessTime::now();
    let found = solve(family, &at_rest(), &loss, start, target);
    report(
        name,
        "gradients",
        begin,
        found.runs,
        &found.number.to_string(),
    );
    let begin = ProcessTime::now();
    let (found, runs) = secant(family, &loss, start, target);
    report(name, "secants", begin, runs, &found.to_string());
}

fn minimum(
    name: &str,
    family: &dyn Family,
    loss: &dyn Loss,
    start: &[f64],
    (scale, goal): (f64, f64),
) {
    let plan = at_rest();
    let told = |found: &Found| {
        let least = found.losses.iter().copied().fold(f64::INFINITY, f64::min);
        format!("loss {least:.1e}, first number {}", found.numbers[0])
    };
    let begin = ProcessTime::now();
    let found = minimise(
        lead_by_gradients(family, &plan, loss),
        start,
        scale,
        40,
        goal,
    );
    report(name, "gradients", begin, found.losses.len(), &told(&found));
    let mut runs = 0;
    let begin = ProcessTime::now();
    let by_differences = |numbers: &[f64]| {
        runs += 1;
        let here = value(family, &plan, numbers, loss)?;
        let slope = |k: usize| {
            let mut moved = numbers.to_vec();
            moved[k] += DIFFERENCE;
            runs += 1;
            Some((value(family, &plan, &moved, loss)? - here) / DIFFERENCE)
        };
        let slopes: Option<Vec<f64>> = (0..numbers.len()).map(slope).collect();
        Some((here, slopes?))
    };
    let found = minimise(by_differences, start, scale, 40, goal);
    report(name, "differences", begin, runs, &told(&found));
}

fn main() -> Result<(), SceneError> {
    let plan = at_rest();
    let height = coordinate(TIP, 2, 1);
    let measured = value(&by_rigidity, &plan, &[4.2e-4], &height).ok_or("no run")?;
    number("rigidity", &by_rigidity, 8e-4, measured);
    number("clamp", &by_clamp, 0.1, 0.05);
    let run = Run::record(
        &by_curls,
        &[2.0, -1.0, 3.0],
        at_rest(),
        AdjointOptions::default(),
    )?;
    let end = run.states()[1].vertex_positions();
    let targets = (1..=TIP).map(|v| (v, end[v])).collect();
    let distances = squared_distances(targets, 1);
    minimum("curls", &by_curls, &distances, &[0.1; 3], (100.0, 1e-16));
    minimum(
        "heights",
        &by_heights,
        &squared_heights(30),
        &[0.0; 30],
        (1.0, 1e-10),
    );
    Ok(())
}
