//! Exactly flat starts, and passing through states where the rods are dependent.

use super::naive::{TEXTBOOK, textbook, textbook_step};
use super::scenes::{FRAME, STRAIN, apart, at_rest, course, pinned};
use super::{Case, Findings};
use crate::draw::Series;
use crate::interrupt;
use crate::methods::{conservative, damped, methods};
use crate::report::Effort;
use crate::report::Picture;
use crate::timing::{bumped, corner};
use anyhow::Result;
use isosheet_coords::{AssignmentOptions, CartesianChart, Choice, FrontChart, RodSystem};
use isosheet_dynamics::chart::{ChartOptions, Rebase};
use isosheet_dynamics::{Frames, Method, SheetModel, Simulation, State, rod_rank};
use isosheet_io::picture::{Camera, Labelled, Look, SheetPicture, montage, render};
use isosheet_mesh::{MassMatrix, Sheet};
use isosheet_tests::{Flap, orders};
use std::f64::consts::FRAC_PI_2;

pub(crate) const START: Case = Case {
    name: "flat-start",
    title: "Exactly flat start",
    expected: "A flat sheet held at a corner and released falls. In the flat state one rod for every interior vertex depends on the \
               others, so rod forces are not unique and the paper's coordinates do not exist; the motion does.",
    run: start,
};

fn start(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let sheet = bumped(1, 0.0)?;
    let model = pinned(&sheet, &[corner(1)])?;
    let options = AssignmentOptions {
        pins: vec![corner(1)],
        ..Default::default()
    };
    match FrontChart::new(&sheet, &options, sheet.positions()).and_then(|chart| {
        isosheet_coords::mass_condition(
            &RodSystem::new(&sheet, &[corner(1)])?,
            &chart,
            model.mass(),
            sheet.positions(),
        )
    }) {
        Ok(condition) => f.naive(
            "The paper's coordinates",
            format!("Their mass matrix has condition number {condition:.0e}."),
            condition > 1e15,
        ),
        Err(error) => f.naive("The paper's coordinates", format!("{error}."), true),
    };
    let outcome = textbook(&model, sheet.positions(), 1e-3, 1000);
    let failed = !matches!(outcome, Ok((strain, _)) if strain < 1e-2);
    f.naive(
        TEXTBOOK,
        match outcome {
            Ok((strain, _)) => format!("M^1, 1 ms, 1 s: largest edge strain {strain:.0e}."),
            Err(e) => format!("M^1, 1 ms, {e}."),
        },
        failed,
    );
    let levels = effort.pick(1..=1, 1..=3, 1..=4);
    for level in levels {
        let sheet = bumped(level, 0.0)?;
        for (name, method) in damped() {
            let model = pinned(&sheet, &[corner(level)])?;
            let mut run = at_rest(model, sheet.positions(), method)?;
            let mut potential = 0.0_f64;
            let c = course(&mut run, FRAME, 60, |r, _| {
                potential = potential.min(r.potential);
            })?;
            let what = format!("M^{level}, {name}");
            f.at_most(
                format!("{what}: largest edge strain in a second"),
                c.if_finished(c.strain),
                STRAIN,
            )
            .remark(c.said());
            f.at_most(
                format!("{what}: rejected steps"),
                c.if_finished(c.rejected as f64),
                0.0,
            )
            .remark(c.said());
            f.at_least(
                format!("{what}: largest energy released, J"),
                c.if_finished(-potential),
                0.1,
            );
        }
    }
    let rank = rod_rank(&model, sheet.positions());
    f.here = format!(
        "The damped methods minimise an incremental potential over the positions with the right lengths, which has a solution at any \
         rank; a seeded perturbation decides which way the sheet folds. {}",
        rank.map_or(String::new(), |r| format!(
            "At the start of M^1 {} of {} rods are dependent.",
            r.deficiency, r.rods
        ))
    );
    if effort != Effort::Quick {
        f.pictures.push(fall()?);
    }
    Ok(f)
}

/// The fall of M^2, rendered.
fn fall() -> Result<Picture> {
    let sheet = bumped(2, 0.0)?;
    let model = pinned(&sheet, &[corner(2)])?;
    let mut run = at_rest(model, sheet.positions(), Method::default())?;
    let mut kept = Frames::every(1);
    run.run(1.0, FRAME, &mut [&mut kept, &mut interrupt::observe])?;
    interrupt::check()?;
    let states = [0, 6, 15, 24, 36, 60].map(|k| &kept.states()[k]);
    let points = states
        .iter()
        .flat_map(|s| s.x.as_chunks::<3>().0.iter().copied());
    let view = Camera::new([0.0; 3], -62.0, 17.0, 1.0, 6.0);
    let aspect = view.aspect(points.clone());
    let camera = view.framing(points, aspect, 0.04);
    let look = Look {
        size: [(400.0 * aspect).round() as usize, 400],
        ..Look::default()
    };
    let mut frames = Vec::new();
    for State { t, x, .. } in states {
        let picture = SheetPicture {
            topology: sheet.topology(),
            positions: x,
            pins: &[corner(2)],
            solids: &[],
        };
        frames.push(Labelled {
            image: render(&picture, &camera, &look)?,
            label: format!("{t:.2} s"),
        });
    }
    Ok(Picture {
        file: "flat-start.png".into(),
        alt: "M^2 released from exactly flat and horizontal, held at a corner (BDF2, 1/60 s). Warm: the upper side at the start; blue: \
              the lower one."
            .into(),
        bytes: montage(&frames, 6)?.to_png()?,
    })
}

pub(crate) const BRANCH: Case = Case {
    name: "branch-point",
    title: "Passing through a branch point",
    expected: "Four triangles meet at a vertex where two straight crease lines cross. Folded along one line, the sheet swings \
               through flat, where it could as well fold along the other one: by inertia it goes on along the first. The motion is that of two rigid \
               flaps, known in closed form.",
    run: branch,
};

/// The flap of the models with a vertex in the middle of its hinge, so that two creases cross there.
struct Crossing {
    flap: Flap,
    model: SheetModel,
    start: State,
    sheet: Sheet,
}

fn crossing(start_angle: f64) -> Result<Crossing> {
    let flap = Flap {
        start_angle,
        ..Flap::default()
    };
    let with_middle = |x: &[f64]| {
        let mut all = x.to_vec();
        all.extend((0..3).map(|k| 0.5 * (x[k] + x[3 + k])));
        all
    };
    let State { x, v, .. } = flap.start();
    let sheet = Sheet::new(
        with_middle(&x),
        &[[0, 2, 4], [4, 2, 1], [0, 4, 3], [4, 1, 3]],
    )?;
    let (m, hinge) = (flap.apex_mass, flap.hinge_mass / 3.0);
    let mass = MassMatrix::from_vertex_masses(vec![hinge, hinge, m, m, hinge])?;
    Ok(Crossing {
        flap,
        model: SheetModel::with_mass(&sheet, mass)?,
        start: State::moving(with_middle(&x), with_middle(&v)),
        sheet,
    })
}

/// Half-angle at the start, radians.
const FOLDED: f64 = 1.1;

/// Time simulated; the sheet is flat after about a third of it, seconds.
const DURATION: f64 = 1.0;

fn branch(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    // In coordinates that do not change on the way.
    let Crossing {
        model,
        start,
        sheet,
        ..
    } = crossing(FOLDED)?;
    let chart = CartesianChart::new(RodSystem::new(&sheet, &[])?, Choice::Auto, &start.x)?;
    let options = ChartOptions {
        rebase: Rebase::Never,
        condition_limit: f64::MAX,
        ..ChartOptions::default()
    };
    let outcome = Simulation::in_chart(model, start.clone(), Box::new(chart), options)
        .map_err(|e| e.to_string())
        .and_then(|mut run| {
            run.run(DURATION, 0.01 * DURATION, &mut [])
                .map_err(|e| e.to_string())?;
            Ok(run.state().x.clone())
        });
    let crossing_at =
        |x: &[f64]| crossing(FOLDED).map(|c| apart(&x[..12], &c.flap.exact(DURATION)));
    match outcome {
        Ok(x) => {
            let error = crossing_at(&x)?;
            f.naive(
                "Explicit steps of 1 ms in fixed coordinates",
                format!("Ends {error:.0e} m from the exact motion."),
                error > 0.05,
            );
        }
        Err(e) => {
            f.naive(
                "Explicit steps of 1 ms in fixed coordinates",
                format!("{e}."),
                true,
            );
        }
    }
    let counts = effort.pick(
        vec![50, 100],
        vec![50, 100, 200, 400, 800],
        vec![50, 100, 200, 400, 800, 1600],
    );
    let mut lines = Vec::new();
    for (k, (name, method)) in methods().enumerate() {
        let mut errors = Vec::new();
        let (mut rejected, mut strain, mut said) = (0, 0.0_f64, None);
        for &n in &counts {
            let Crossing {
                flap, model, start, ..
            } = crossing(FOLDED)?;
            let mut run = Simulation::new(model, start, method.clone())?;
            let c = course(&mut run, DURATION / n as f64, n, |_, _| {})?;
            rejected += c.rejected;
            strain = strain.max(c.strain);
            said = said.or(c.said());
            errors.push(c.if_finished(apart(&run.state().x[..12], &flap.exact(DURATION))));
        }
        let last = errors[errors.len() - 1];
        let order = *orders(&errors).last().unwrap_or(&f64::NAN);
        let expected = match name {
            "implicit Euler" | "projection" => 1.0,
            "RATTLE composition" => 4.0,
            _ => 2.0,
        };
        if name == "RATTLE composition" {
            f.at_most(
                format!("{name}: error with {} steps, m", counts[counts.len() - 1]),
                last,
                1e-7,
            )
            .remark(said.clone());
        } else {
            f.at_least(
                format!("{name}: order of convergence (exact: {expected})"),
                order,
                expected - 0.2,
            )
            .remark(said.clone());
        }
        f.at_most(
            format!("{name}: largest edge strain"),
            if last.is_nan() { last } else { strain },
            STRAIN,
        )
        .remark(said);
        if conservative().iter().any(|c| c.0 == name) {
            f.at_most(format!("{name}: rejected steps"), rejected as f64, 0.0);
        }
        let points = counts
            .iter()
            .zip(&errors)
            .map(|(n, e)| [1e3 * DURATION / *n as f64, *e])
            .collect();
        lines.push(Series::styled(k, name, points));
    }
    // Started exactly there, with the velocities of one of the two ways.
    let Crossing {
        model, start, flap, ..
    } = crossing(FRAC_PI_2)?;
    let (mut x, mut v) = (start.x.clone(), start.v.clone());
    let outcome = (1..=100).try_for_each(|k| {
        textbook_step(&model, &mut x, &mut v, 0.01 * DURATION).map_err(|e| format!("step {k}: {e}"))
    });
    let error = apart(&x[..12], &flap.exact(DURATION));
    f.naive(
        &format!("{TEXTBOOK}, started at the branch point"),
        outcome.clone().map_or_else(
            |e| format!("{e}."),
            |()| format!("Ends {error:.0e} m from the exact motion."),
        ),
        outcome.is_err() || error > 0.05,
    );
    for (name, method) in methods() {
        let Crossing {
            model, start, flap, ..
        } = crossing(FRAC_PI_2)?;
        let mut run = Simulation::new(model, start, method)?;
        let c = course(&mut run, DURATION / 200.0, 200, |_, _| {})?;
        let bound = if ["implicit Euler", "projection"].contains(&name) {
            2e-2
        } else {
            1e-3
        };
        f.at_most(
            format!("started exactly at the branch point, {name}, 200 steps: error, m"),
            c.if_finished(apart(&run.state().x[..12], &flap.exact(DURATION))),
            bound,
        )
        .remark(c.said());
    }
    let flat_at = {
        let c = crossing(FOLDED)?;
        let (mut low, mut high) = (0.0, DURATION);
        for _ in 0..50 {
            let t = 0.5 * (low + high);
            let x = c.flap.exact(t);
            // The apexes are below the hinge line after flat.
            if x[8] > x[2] { low = t } else { high = t }
        }
        low
    };
    f.here = format!(
        "All methods step across the flat state at t = {flat_at:.3} s and converge to the closed form at their orders. The half-angle \
         starts at {:.2} rad and passes {FRAC_PI_2:.2}.",
        crossing(FOLDED)?.flap.start_angle
    );
    let drawing = super::log_log("step, ms", "position error after 1 s, m", lines);
    f.drawing(
        "branch-point",
        &drawing,
        "Error against the closed form after passing through flat",
    );
    Ok(f)
}
