//! Long runs: rest stays rest, and energy over a million steps.

use super::case::number;
use super::naive::{GAUSS_SEIDEL, TEXTBOOK, gauss_seidel, textbook, textbook_step};
use super::scenes::{FRAME, apart, at_rest, course, energy_momentum, hanging, held, methods, upright};
use super::{Case, Effort, Findings, plot};
use anyhow::Result;
use isosheet_dynamics::StepControl;
use isosheet_mesh::{VertexId, generate};

pub(crate) const REST: Case = Case {
    name: "rest",
    title: "Rest stays rest",
    expected: "A flat sheet that hangs upright from its top edge is at rest in a state with dependent rods, and stays there for as long as one \
               looks: no drift, no spin, no creeping.",
    run: rest,
};

fn rest(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let sheet = upright(&generate::isotropic_square(1, 1.0)?)?;
    let top: Vec<VertexId> = (20..25).map(VertexId).collect();
    let model = || held(&sheet, &top);
    let start = sheet.positions();
    match textbook(&model()?, start, FRAME, 1000) {
        Ok((_, x)) => {
            let moved = apart(&x, start);
            f.naive(TEXTBOOK, format!("Moves by {} m in 1000 steps.", number(moved)), moved > 1e-6)
        }
        Err(e) => f.naive(TEXTBOOK, format!("{e}."), true),
    };
    let (strain, x) = gauss_seidel(&model()?, start, FRAME, 1000);
    let moved = apart(&x, start);
    f.naive(
        GAUSS_SEIDEL,
        format!("Sags by {} m and stretches its edges by {} in 1000 steps.", number(moved), number(strain)),
        moved > 1e-6,
    );
    let steps = effort.pick(1000, 100_000, 1_000_000);
    let mut lines = Vec::new();
    for (k, (name, method)) in methods().enumerate() {
        let mut run = at_rest(model()?, start, method)?;
        let (mut worst, mut n, mut points) = (0.0_f64, 0_usize, Vec::new());
        let c = course(&mut run, FRAME, steps, |_, state| {
            n += 1;
            worst = worst.max(apart(&state.x, start));
            if is_sample(n) {
                points.push([n as f64, worst.max(1e-18)]);
            }
        })?;
        f.at_most(
            format!("{name}: largest displacement in {steps} steps, m"),
            c.if_finished(worst),
            1e-9,
        )
        .remark(c.said());
        lines.push(plot::series(k, name, points));
    }
    f.here = format!(
        "{:.0} s of simulated time, vertex by vertex compared with the start.",
        steps as f64 * FRAME
    );
    let drawing = plot::log_log("steps", "largest displacement, m", lines);
    f.drawing("rest", &drawing, "Displacement of a hanging sheet at rest (1e-18 stands for none)")?;
    Ok(f)
}

/// Whether a step is one of about four in each octave.
fn is_sample(n: usize) -> bool {
    let unit = (n.max(1).ilog2()).saturating_sub(2);
    n.is_multiple_of(1 << unit)
}

pub(crate) const MILLION: Case = Case {
    name: "million-steps",
    title: "Energy over a million steps",
    expected: "M^1 hangs from a corner and crumples without end; nothing takes energy out. A conservative method keeps the energy \
               and the lengths to round-off that accumulates slowly, over any number of steps.",
    run: million,
};

/// Smallest sub-step of the long run, of a step: over so long a time the sheet comes very near to states with dependent rods.
const MIN_FRACTION: f64 = 1.0 / (1_u64 << 30) as f64;

/// Step of the long run, seconds.
const STEP: f64 = 5e-3;

fn million(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let (mut x, mut v) = {
        let run = hanging(1, 0.05, energy_momentum())?;
        (run.state().x.clone(), run.state().v.clone())
    };
    let control = StepControl {
        min_fraction: MIN_FRACTION,
        ..StepControl::default()
    };
    let mut run = hanging(1, 0.05, energy_momentum())?.with_control(control)?;
    let start = run.energy();
    let released = 0.1 * 9.8 * 0.5_f64.sqrt();
    // The textbook method at the same step.
    let mut naive = Vec::new();
    let mut end = "reaches 20 000 steps".to_owned();
    for n in 1..=effort.pick(500, 20_000, 20_000) {
        if let Err(e) = textbook_step(run.model(), &mut x, &mut v, STEP) {
            end = format!("stops at step {n}: {e}");
            break;
        }
        let energy = run.model().kinetic_energy(&v) + run.model().potential_energy(0.0, &x);
        if is_sample(n) {
            naive.push([n as f64, ((energy - start) / released).abs()]);
        }
    }
    let last = naive.last().map_or(f64::NAN, |p| p[1]);
    f.naive(
        TEXTBOOK,
        format!(
            "It {end}; its energy is then off by {} of the energy that the centre of mass can release, its edges strained by {}.",
            number(last),
            number(run.model().rods().max_strain(&x))
        ),
        last.is_nan() || last > 1e-2,
    );
    let steps = effort.pick(2000, 1_000_000, 10_000_000);
    let (mut n, mut worst, mut points, mut fastest) = (0_usize, 0.0_f64, Vec::new(), 0.0_f64);
    let mut iterations = 0;
    let c = course(&mut run, STEP, steps, |r, _| {
        n += 1;
        worst = worst.max(r.energy_drift.abs() / released);
        fastest = fastest.max(r.kinetic);
        iterations += r.iterations;
        if is_sample(n) {
            points.push([n as f64, worst]);
        }
    })?;
    f.at_least(format!("steps taken of {steps}"), c.steps as f64, steps as f64)
        .remark(c.said());
    f.at_most(
        "largest energy error, of the energy that the centre of mass can release",
        worst,
        1e-8,
    );
    f.at_most("largest edge strain", c.strain, 1e-12);
    f.at_least("largest kinetic energy, of the same", fastest / released, 0.3);
    f.here = format!(
        "{} steps of 5 ms of the energy-momentum method, {:.2} Newton iterations a step, {} sub-steps rejected on the way.",
        c.steps,
        iterations as f64 / c.steps.max(1) as f64,
        c.rejected
    );
    let drawing = plot::log_log(
        "steps",
        "largest relative energy error so far",
        vec![
            plot::curve(0, "energy-momentum", points),
            plot::curve(1, "textbook multipliers", naive),
        ],
    );
    f.drawing("million-steps", &drawing, "Energy error of M^1 hanging from a corner, 5 ms steps")?;
    Ok(f)
}
