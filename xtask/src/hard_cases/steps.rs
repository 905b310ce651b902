//! Step sizes, and free fall.

use super::naive::{TEXTBOOK, textbook, textbook_step};
use super::scenes::{STRAIN, apart, course};
use super::{Case, Findings, Shortfall};
use crate::draw::Series;
use crate::methods::{damped, methods};
use crate::report::Effort;
use crate::report::number;
use crate::timing::{bumped, hanging};
use anyhow::Result;
use isosheet_dynamics::{SheetModel, Simulation, State, StepOutcome, leave_flat};
use isosheet_mesh::MassKind;
use isosheet_tests::Pendulum;

pub(crate) const SIZES: Case = Case {
    name: "step-sizes",
    title: "Steps from 1e-6 s to 0.1 s",
    expected: "Very short steps are as good as any: errors go down to round-off and stay there. Very long ones lose accuracy, not exact lengths.",
    run: sizes,
};

/// What tiny steps meet near the flat state.
const TINY_AND_FLAT: &str = "While the folds are still so small that the displacement of a step is near the tolerance of the lengths, the minimisation of a \
                             damped step does not get below its start and refuses it.";

/// Why RATTLE refuses some falls of exactly flat sheets.
const ROUND_OFF: &str = "RATTLE solves for the rods' impulses also where they are zero; dependent rods answer round-off in their lengths with impulses that \
                         buckle the sheet. The energy-momentum method asks first whether the forces alone leave the rods as they are.";

fn sizes(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let problem = Pendulum::default();
    let end = 0.1;
    let counts: &[usize] = effort.pick(
        &[1, 10, 100, 1000],
        &[1, 3, 10, 30, 100, 1000, 10_000, 100_000],
        &[1, 3, 10, 30, 100, 1000, 10_000, 100_000],
    );
    let mut lines = Vec::new();
    for (k, (name, method)) in methods().enumerate() {
        let mut points = Vec::new();
        let (mut strain, mut said, mut smallest) = (0.0_f64, None, f64::INFINITY);
        let mut shortest = f64::NAN;
        for &n in counts {
            let mut run = Simulation::new(problem.model(), problem.start(), method.clone())?;
            let h = end / n as f64;
            let c = course(&mut run, h, n, |_, _| {})?;
            strain = strain.max(c.strain);
            said = said.or(c.said());
            let error = c.if_finished(apart(&run.state().x, &problem.exact(end)));
            smallest = smallest.min(error);
            shortest = error;
            points.push([h, error]);
        }
        f.at_most(
            format!(
                "pendulum, {name}: edge strain, steps {} s to 0.1 s",
                number(end / counts[counts.len() - 1] as f64)
            ),
            if said.is_some() { f64::NAN } else { strain },
            STRAIN,
        )
        .remark(said);
        let bound = match (name, effort) {
            (_, Effort::Quick) => 1e-3,
            ("implicit Euler" | "projection", _) => 1e-6,
            // Lengths that err by 1e-12 over a step of 1e-6 s leave velocities of 1e-6 m/s open, for 0.1 s.
            ("BDF2", _) => 1e-7,
            _ => 1e-9,
        };
        f.at_most(
            format!("pendulum, {name}: position error at the shortest step, m"),
            shortest,
            bound,
        );
        lines.push(Series::styled(k, name, points));
    }
    // The sheet at its extremes.
    for (h, steps) in [
        (1e-6, effort.pick(100, 2000, 10_000)),
        (0.1, effort.pick(10, 30, 300)),
    ] {
        for (name, method) in methods() {
            let damping = damped().iter().any(|d| d.0 == name);
            let mut run = hanging(1, 0.05, method)?;
            let (mut v, mut last) = (0.0_f64, 0.0);
            let c = course(&mut run, h, steps, |r, s| {
                last = r.potential + r.kinetic;
                v = s.v.iter().fold(v, |m, v| m.max(v.abs()));
            })?;
            f.at_most(
                format!("M^1, {name}, {steps} steps of {} s: edge strain", number(h)),
                c.if_finished(c.strain),
                STRAIN,
            )
            .ended(&c);
            let scale = c.kinetic.max(1e-12);
            if damping {
                f.at_most(
                    format!(
                        "M^1, {name}, steps of {} s: energy gained, of the largest kinetic energy",
                        number(h)
                    ),
                    c.if_finished(c.gain / scale),
                    0.15,
                );
            } else if name == "energy-momentum" && h > 1e-3 {
                f.at_most(
                    format!(
                        "M^1, {name}, steps of {} s: energy error, of the largest kinetic energy",
                        number(h)
                    ),
                    c.if_finished(c.drift / scale),
                    1e-8,
                );
            }
        }
    }
    for (name, method) in damped() {
        for h in [1e-6, 0.1] {
            let mut run = hanging(1, 0.0, method.clone())?;
            let c = course(
                &mut run,
                h,
                effort.pick(30, if h < 1e-3 { 2000 } else { 30 }, 2000),
                |_, _| {},
            )?;
            let check = f.at_most(
                format!(
                    "M^1 from exactly flat, {name}, steps of {} s: edge strain",
                    number(h)
                ),
                c.if_finished(c.strain),
                STRAIN,
            );
            check.ended(&c);
            // Measured: 1.3e-3 s, 1.8e-4 s, 4.7e-4 s; the quick run ends after 1e-4 s.
            let stops = match name {
                "BDF2" => Shortfall::stops([2e-4, 1.9e-3], "would create"),
                "implicit Euler" => Shortfall::stops([6e-5, 6e-4], "would create"),
                _ => Shortfall::stops([1.5e-4, 1.5e-3], "Newton's method stopped"),
            };
            if h < 1e-3 && effort != Effort::Quick {
                check.limited(TINY_AND_FLAT, stops);
            }
        }
    }
    let model = problem.model();
    for h in [1e-3, 0.1] {
        let (mut x, mut v) = (problem.start().x, vec![0.0; 9]);
        let (mut strain, mut ended) = (0.0_f64, None);
        for k in 0..(10.0 / h) as usize {
            if let Err(e) = textbook_step(&model, &mut x, &mut v, h) {
                ended = Some(format!("stops at step {}: {e}", k + 1));
                break;
            }
            strain = strain.max(model.rods().max_strain(&x));
        }
        f.naive(
            TEXTBOOK,
            format!(
                "The pendulum for 10 s at {} s: edge strain {}{}.",
                number(h),
                number(strain),
                ended.map_or(String::new(), |e| format!("; {e}"))
            ),
            strain > 1e-2,
        );
    }
    f.here = "Conservative steps solve for impulses, which stay moderate when the step goes to zero; lengths are relative. The curves flatten where \
              rounding of the positions takes over."
        .into();
    let drawing = super::log_log("step, s", "position error after 0.1 s, m", lines);
    f.drawing(
        "step-sizes",
        &drawing,
        "A triangle held at an edge (exact pendulum): error against the step",
    );
    Ok(f)
}

pub(crate) const FREE_FALL: Case = Case {
    name: "free-fall",
    title: "Free fall: all rod forces zero",
    expected: "A sheet thrown without spin keeps its shape, flat or crumpled, exactly flat included; its centre follows a parabola and no rod carries a force.",
    run: free_fall,
};

fn free_fall(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let level = effort.pick(1, 2, 3);
    let (h, steps) = (1e-2, 100);
    for (state, displaced) in [("exactly flat", 0.0), ("crumpled", 0.3)] {
        let sheet = bumped(level, 0.0)?;
        let model = || -> Result<SheetModel> {
            Ok(SheetModel::new(&sheet, 0.1, MassKind::Lumped)?.with_gravity())
        };
        let mut x = sheet.positions().to_vec();
        if displaced > 0.0 {
            leave_flat(&model()?, &mut x, displaced, 2)?;
        }
        let outcome = textbook(&model()?, &x, h, steps);
        let (text, failed) = match outcome {
            Ok((strain, _)) => (
                format!("M^{level}, {state}: edge strain {}.", number(strain)),
                strain > 1e-6,
            ),
            Err(e) => (format!("M^{level}, {state}, {e}."), true),
        };
        f.naive(TEXTBOOK, text, failed);
        for (name, method) in methods() {
            let throw = [1.0, -0.5, 3.0];
            let v: Vec<f64> = (0..x.len()).map(|i| throw[i % 3]).collect();
            let mut run = Simulation::new(model()?, State::moving(x.clone(), v), method)?;
            let mut before = run.state().v.clone();
            // BDF2 looks back one step: its velocities change by gravity only after its start.
            let mut force = 0.0_f64;
            let mut n = 0;
            let mut newton = true;
            let c = course(&mut run, h, steps, |r, s| {
                n += 1;
                newton &= r.outcome == StepOutcome::Newton;
                if n > 2 {
                    for (i, (new, old)) in s.v.iter().zip(&before).enumerate() {
                        let g = if i % 3 == 2 { -9.8 } else { 0.0 };
                        force = force.max(((new - old) / h - g).abs() / 9.8);
                    }
                }
                before.clone_from(&s.v);
            })?;
            let centre = |x: &[f64]| {
                [0, 1, 2].map(|k| x.iter().skip(k).step_by(3).sum::<f64>() * 3.0 / x.len() as f64)
            };
            let (now, start) = (centre(&run.state().x), centre(&x));
            let shape = run
                .state()
                .x
                .iter()
                .zip(&x)
                .enumerate()
                .map(|(i, (a, b))| ((a - now[i % 3]) - (b - start[i % 3])).abs())
                .fold(0.0, f64::max);
            let what = format!("M^{level} {state}, {name}");
            f.at_most(
                format!("{what}: largest net rod force on a vertex, of its weight"),
                c.if_finished(force),
                // Lengths exact to 1e-12 leave accelerations of 1e-12 m / h^2 undetermined, and larger ones
                // along weak directions.
                1e-6,
            )
            .ended(&c);
            f.at_most(
                format!("{what}: change of shape after 1 s, m"),
                c.if_finished(shape),
                1e-9,
            );
            let t = h * steps as f64;
            let first = ["implicit Euler", "projection"].contains(&name);
            // Backward Euler falls by g h^2 n (n + 1) / 2 in its own discrete time; BDF2 starts with one
            // such step.
            let fall = match name {
                _ if first => 4.9 * t * (t + h),
                "BDF2" => 4.9 * (t * t + 1.5 * h * h),
                _ => 4.9 * t * t,
            };
            // M^1 does not stop. M^2 stops, as measured, after 0.02125 s (RATTLE) and at the start (its
            // composition). M^3 does not stop with RATTLE, and stops after 0.428 s with its composition.
            let stops = match (name, effort) {
                ("RATTLE", Effort::Standard) => Some([5e-3, 0.1]),
                ("RATTLE composition", Effort::Standard) => Some([0.0, 0.02]),
                ("RATTLE composition", Effort::Full) => Some([0.1, 0.99]),
                _ => None,
            };
            let stops = stops.filter(|_| displaced == 0.0);
            let off = (0..3)
                .map(|k| now[k] - start[k] - throw[k] * t + if k == 2 { fall } else { 0.0 })
                .fold(0.0_f64, |m, d| m.max(d.abs()));
            f.at_most(
                format!("{what}: centre off the method's parabola, m"),
                c.if_finished(off),
                1e-9,
            );
            if let Some(at) = stops {
                let from = f.checks.len() - 3;
                f.checks[from..].iter_mut().for_each(|check| {
                    let stops = Shortfall::stops(at, "the length constraints are dependent");
                    check.limited(ROUND_OFF, stops).ended(&c);
                });
            }
        }
    }
    f.here = format!(
        "M^{level} thrown with 3.2 m/s, {steps} steps of 10 ms. The parabola of the first-order methods is that of their discrete time."
    );
    Ok(f)
}
