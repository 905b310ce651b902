//! Step sizes, and free fall.

use super::naive::{TEXTBOOK, textbook, textbook_steps};
use super::scenes::{apart, course, go};
use super::{Case, Findings, Work, log_log};
use crate::draw::Series;
use crate::report::{Bound, Effort, Shortfall, number};
use crate::runs::Course;
use crate::runs::bumped;
use anyhow::Result;
use isosheet_dynamics::{SheetModel, Simulation, State, leave_flat};
use isosheet_mesh::{MassKind, Sheet};
use isosheet_tests::Pendulum;
use isosheet_tests::{Named, methods};

/// Why RATTLE refuses some falls of exactly flat sheets.
const ROUND_OFF: &str = "RATTLE solves for the rods' impulses also where they are zero; dependent rods answer round-off in their lengths with impulses that \
                         buckle the sheet. The energy-momentum method asks first whether the forces alone leave the rods as they are.";

/// Time after which pendulums are compared, seconds.
const END: f64 = 0.1;

/// The pendulum in steps of many sizes, by the methods and by a naive one.
pub(super) fn sizes(f: &mut Findings, effort: Effort) -> Result<()> {
    let counts: &[usize] = effort.quick_or(
        &[1, 10, 100, 1000],
        &[1, 3, 10, 30, 100, 1000, 10_000, 100_000],
    );
    let mut lines = Vec::new();
    for (k, named) in methods().enumerate() {
        let points = pendulum(f, &named, counts, effort)?;
        lines.push(Series::styled(k, named.0, points));
    }
    let problem = Pendulum::default();
    for h in [1e-3, 0.1] {
        let (model, mut x, mut v) = (problem.model(), problem.start().x, vec![0.0; 9]);
        let mut strain = 0.0_f64;
        let watch = |_: usize, x: &[f64], _: &mut [f64]| {
            strain = strain.max(model.rods().max_strain(x));
        };
        let count = (10.0 / h) as usize;
        let outcome = textbook_steps(&model, (&mut x, &mut v), h, count, watch);
        let what = format!(
            "the pendulum for 10 s with steps of {} s: edge strain",
            number(h)
        );
        f.naive_run(
            TEXTBOOK,
            what,
            outcome.map(|()| strain),
            Bound::AtMost(1e-2),
        );
    }
    let drawing = log_log("step, s", "position error after 0.1 s, m", lines);
    let alt = "A triangle held at an edge (exact pendulum): error against the step";
    f.drawing("step-sizes", &drawing, alt);
    Ok(())
}

/// The errors of the pendulum against the step.
fn pendulum(
    f: &mut Findings,
    (name, method): &Named,
    counts: &[usize],
    effort: Effort,
) -> Result<Vec<[f64; 2]>> {
    let problem = Pendulum::default();
    let mut points = Vec::new();
    let mut all = Course::default();
    for &n in counts {
        let h = END / n as f64;
        let run = Simulation::new(problem.model(), problem.start(), method.clone())?;
        let (c, end) = go(run, h, n)?;
        points.push([h, c.if_good(apart(&end, &problem.exact(END)))]);
        all.add_run(c);
    }
    let [smallest, error] = points[points.len() - 1];
    let bound = match (*name, effort) {
        (_, Effort::Quick) => 1e-3,
        ("implicit Euler" | "projection", _) => 1e-6,
        // Lengths that err by 1e-12 over a step of 1e-6 s leave velocities of 1e-6 m/s open, for 0.1 s.
        ("BDF2", _) => 1e-7,
        _ => 1e-9,
    };
    let steps = format!("edge strain, steps {} s to 0.1 s", number(smallest));
    let mut judge = f.of(&all, format!("pendulum, {name}"));
    judge.strain(&steps);
    judge.at_most("position error at the shortest step, m", error, bound);
    Ok(points)
}

pub(crate) const FREE_FALL: Case = Case {
    name: "free-fall",
    title: "Free fall: all rod forces zero",
    expected: "A sheet thrown without spin keeps its shape, flat or crumpled, exactly flat included; its centre follows a parabola and no rod carries a force.",
    run: Work::Code(free_fall),
};

/// Velocity of the throw, m/s; length (seconds) and number of steps.
const THROW: [f64; 3] = [1.0, -0.5, 3.0];
const H: f64 = 1e-2;
const STEPS: usize = 100;

/// The sheet of a throw.
fn thrown(sheet: &Sheet) -> Result<SheetModel> {
    Ok(SheetModel::new(sheet, 0.1, MassKind::Lumped)?.with_gravity())
}

fn free_fall(f: &mut Findings, effort: Effort) -> Result<()> {
    let level = effort.pick(1, 2, 3);
    let sheet = bumped(level, 0.0);
    for (state, displaced) in [("exactly flat", 0.0), ("crumpled", 0.3)] {
        let mut x = sheet.positions().to_vec();
        if displaced > 0.0 {
            leave_flat(&thrown(&sheet)?, &mut x, displaced, 2)?;
        }
        let what = format!("M^{level}, {state}");
        let outcome = textbook(&thrown(&sheet)?, &x, H, STEPS);
        f.naive_run(
            TEXTBOOK,
            format!("{what}: edge strain"),
            outcome,
            Bound::AtMost(1e-6),
        );
        for named in methods() {
            // M^1 does not stop. M^2 stops, as measured, after 0.02125 s (RATTLE) and at the start (its
            // composition). M^3 does not stop with RATTLE, and stops after 0.428 s with its composition.
            let stops = match (named.0, effort) {
                ("RATTLE", Effort::Standard) => Some([5e-3, 0.1]),
                ("RATTLE composition", Effort::Standard) => Some([0.0, 0.02]),
                ("RATTLE composition", Effort::Full) => Some([0.1, 0.99]),
                _ => None,
            };
            let what = format!("M^{level} {state}, {}", named.0);
            throw(f, what, named, (thrown(&sheet)?, &x))?;
            let from = f.checks.len() - 3;
            if let Some(at) = stops.filter(|_| displaced == 0.0) {
                let stops = Shortfall::stops(at, "the length constraints are dependent");
                for check in &mut f.checks[from..] {
                    check.limited(ROUND_OFF, stops.clone());
                }
            }
        }
    }
    f.here = "A sheet thrown with 3.2 m/s, 100 steps of 10 ms. The parabola of the first-order methods is that of their discrete time.";
    Ok(())
}

/// The mean place of all vertices, metres.
fn centre(x: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|k| x.iter().skip(k).step_by(3).sum::<f64>() * 3.0 / x.len() as f64)
}

/// Throws a sheet by a method and makes three checks.
fn throw(
    f: &mut Findings,
    what: String,
    (name, method): Named,
    (model, x): (SheetModel, &[f64]),
) -> Result<()> {
    let v = (0..x.len()).map(|i| THROW[i % 3]).collect();
    let mut run = Simulation::new(model, State::moving(x.to_vec(), v), method)?;
    let mut before = run.state().v.clone();
    let (mut force, mut n) = (0.0_f64, 0);
    let c = course(&mut run, H, STEPS, |_, s| {
        n += 1;
        let pairs = s.v.iter().zip(&before).enumerate();
        // BDF2 looks back one step: its velocities change by gravity only after its start.
        for (i, (new, old)) in pairs.filter(|_| n > 2) {
            let g = if i % 3 == 2 { -9.8 } else { 0.0 };
            force = force.max(((new - old) / H - g).abs() / 9.8);
        }
        before.clone_from(&s.v);
    })?;
    let now = &run.state().x;
    let (there, start) = (centre(now), centre(x));
    let moved = now.iter().zip(x).enumerate();
    let shape = moved.map(|(i, (a, b))| ((a - there[i % 3]) - (b - start[i % 3])).abs());
    let t = H * STEPS as f64;
    // Backward Euler falls by g h^2 n (n + 1) / 2 in its own discrete time; BDF2 starts with one such step.
    let fall = match name {
        "implicit Euler" | "projection" => 4.9 * t * (t + H),
        "BDF2" => 4.9 * (t * t + 1.5 * H * H),
        _ => 4.9 * t * t,
    };
    let off = |k: usize| there[k] - start[k] - THROW[k] * t + if k == 2 { fall } else { 0.0 };
    let off = (0..3).map(|k| off(k).abs()).fold(0.0, f64::max);
    let mut judge = f.of(&c, what);
    // Lengths exact to 1e-12 leave accelerations of 1e-12 m / h^2 undetermined, and larger ones along weak
    // directions.
    judge.at_most(
        "largest net rod force on a vertex, of its weight",
        force,
        1e-6,
    );
    judge.at_most(
        "change of shape after 1 s, m",
        shape.fold(0.0, f64::max),
        1e-9,
    );
    judge.at_most("centre off the method's parabola, m", off, 1e-9);
    Ok(())
}
