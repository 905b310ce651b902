//! Exactly flat starts, and passing through states where the rods are dependent.

use super::naive::{NO_DIGITS, TEXTBOOK, textbook, textbook_steps};
use super::scenes::{FRAME, VIEWPOINT, apart, go, pinned, released};
use super::{Case, Findings, Work, log_log};
use crate::draw::{Series, Shot};
use crate::interrupt;
use crate::report::{Bound, Effort, Picture, Table};
use crate::runs::Course;
use crate::runs::{bumped, corner};
use anyhow::Result;
use isosheet_coords::{
    AssignmentOptions, CartesianChart, ChartError, Choice, FrontChart, RodSystem, mass_condition,
};
use isosheet_dynamics::chart::{ChartOptions, Rebase};
use isosheet_dynamics::{Frames, Method, SheetModel, Simulation, State, rod_rank};
use isosheet_mesh::{MassMatrix, Sheet};
use isosheet_tests::{Flap, orders};
use isosheet_tests::{Named, conservative, methods};
use std::f64::consts::FRAC_PI_2;

/// What naive methods do to a flat sheet, how many of its rods are dependent, and a picture of the fall.
pub(super) fn start(f: &mut Findings, effort: Effort) -> Result<()> {
    let sheet = bumped(1, 0.0);
    let model = pinned(&sheet, &[corner(1)])?;
    let condition = front_condition(&sheet, &model).map_err(|e| e.to_string());
    let what = "condition number of the mass matrix";
    f.naive_run(
        "The paper's coordinates",
        what,
        condition,
        Bound::AtMost(NO_DIGITS),
    );
    let outcome = textbook(&model, sheet.positions(), 1e-3, 1000);
    let what = "M^1, a second of steps of 1 ms: largest edge strain";
    f.naive_run(TEXTBOOK, what, outcome, Bound::AtMost(1e-2));
    if let Some(rank) = rod_rank(&model, sheet.positions()) {
        let columns = ["rods of M¹", "dependent at the start"];
        let row = [rank.rods, rank.deficiency].map(|n| n.to_string());
        let caption = "Rods whose lengths depend on those of the others";
        f.tables
            .push(Table::new(caption, &columns).with_texts([row.to_vec()]));
    }
    if effort != Effort::Quick {
        f.pictures.push(fall()?);
    }
    Ok(())
}

/// The condition number of the mass matrix in the paper's coordinates.
fn front_condition(sheet: &Sheet, model: &SheetModel) -> Result<f64, ChartError> {
    let pins = vec![corner(1)];
    let system = RodSystem::new(sheet, &pins)?;
    let options = AssignmentOptions {
        pins,
        ..Default::default()
    };
    let x = sheet.positions();
    let chart = FrontChart::new(sheet, &options, x)?;
    mass_condition(&system, &chart, model.mass(), x)
}

/// The fall of M^2, rendered.
fn fall() -> Result<Picture> {
    let (sheet, pins) = (bumped(2, 0.0), [corner(2)]);
    let mut run = released(&sheet, &pins, Method::default())?;
    let mut kept = Frames::every(1);
    run.run(1.0, FRAME, &mut [&mut kept, &mut interrupt::observe])?;
    interrupt::check()?;
    let shot = |k: usize| {
        let State { t, x, .. } = &kept.states()[k];
        Shot {
            sheet: &sheet,
            x,
            pins: &pins,
            solids: Vec::new(),
            label: format!("{t:.2} s"),
        }
    };
    let shots = [0, 6, 15, 24, 36, 60].map(shot).into();
    let alt = "M^2 released from exactly flat and horizontal, held at a corner (BDF2, 1/60 s). Warm: the upper side at the start; blue: \
               the lower one.";
    Picture::shaded("flat-start.png", &VIEWPOINT.montage(shots, 6, 400)?, alt)
}

pub(crate) const BRANCH: Case = Case {
    name: "branch-point",
    title: "Passing through a branch point",
    expected: "Four triangles meet at a vertex where two straight crease lines cross. Folded along one line, the sheet swings \
               through flat, where it could as well fold along the other one: by inertia it goes on along the first. The motion is that of two rigid \
               flaps, known in closed form.",
    run: Work::Code(branch),
};

/// The flap of the models with a vertex in the middle of its hinge, so that two creases cross there.
struct Crossing {
    flap: Flap,
    model: SheetModel,
    start: State,
    sheet: Sheet,
}

/// The distance of the corners from their exact places at the end, metres.
fn off_exact(flap: &Flap, x: &[f64]) -> f64 {
    apart(&x[..12], &flap.exact(DURATION))
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

fn branch(f: &mut Findings, effort: Effort) -> Result<()> {
    let (off, near) = (
        "distance from the exact motion at the end, m",
        Bound::AtMost(0.05),
    );
    let method = "Explicit steps of 1 ms in fixed coordinates";
    f.naive_run(method, off, in_fixed_coordinates()?, near);
    let counts = [50, 100, 200, 400, 800, 1600];
    let counts = &counts[..effort.pick(2, 5, 6)];
    let mut lines = Vec::new();
    for (k, named) in methods().enumerate() {
        let points = converges(f, &named, counts)?;
        lines.push(Series::styled(k, named.0, points));
    }
    // Started exactly there, with the velocities of one of the two ways.
    let c = crossing(FRAC_PI_2)?;
    let (mut x, mut v) = (c.start.x.clone(), c.start.v.clone());
    let h = 0.01 * DURATION;
    let outcome = textbook_steps(&c.model, (&mut x, &mut v), h, 100, |_, _, _| {});
    let outcome = outcome.map(|()| off_exact(&c.flap, &x));
    f.naive_run(
        TEXTBOOK,
        format!("started at the branch point: {off}"),
        outcome,
        near,
    );
    for (name, method) in methods() {
        let Crossing {
            flap, model, start, ..
        } = crossing(FRAC_PI_2)?;
        let (c, end) = go(
            Simulation::new(model, start, method)?,
            DURATION / 200.0,
            200,
        )?;
        let is_first = ["implicit Euler", "projection"].contains(&name);
        let bound = if is_first { 2e-2 } else { 1e-3 };
        let what = format!("started exactly at the branch point, {name}, 200 steps");
        f.of(&c, what)
            .at_most("error, m", off_exact(&flap, &end), bound);
    }
    let head = ["half-angle at the start, rad", "flat (π/2) at, s"];
    let row = [crossing(FOLDED)?.flap.start_angle, flat_at()?].map(|n| format!("{n:.3}"));
    let exact = Table::new("The exact motion", &head).with_texts([row.to_vec()]);
    f.tables.push(exact);
    f.here =
        "All methods step across the flat state and converge to the closed form at their orders.";
    let drawing = log_log("step, ms", "position error after 1 s, m", lines);
    let alt = "Error against the closed form after passing through flat";
    f.drawing("branch-point", &drawing, alt);
    Ok(())
}

/// How far the motion in coordinates that do not change on the way ends from the exact one, metres, or why it
/// does not end.
fn in_fixed_coordinates() -> Result<Result<f64, String>> {
    let Crossing {
        flap,
        model,
        start,
        sheet,
    } = crossing(FOLDED)?;
    let chart = CartesianChart::new(RodSystem::new(&sheet, &[])?, Choice::Auto, &start.x)?;
    let options = ChartOptions {
        rebase: Rebase::Never,
        condition_limit: f64::MAX,
        ..ChartOptions::default()
    };
    let run = Simulation::in_chart(model, start, Box::new(chart), options);
    let mut run = match run {
        Ok(run) => run,
        Err(e) => return Ok(Err(e.to_string())),
    };
    let end = run.run(DURATION, 0.01 * DURATION, &mut []);
    let error = off_exact(&flap, &run.state().x);
    Ok(end.map(|_| error).map_err(|e| e.to_string()))
}

/// The errors of a method against its steps (milliseconds), and its checks.
fn converges(f: &mut Findings, named: &Named, counts: &[usize]) -> Result<Vec<[f64; 2]>> {
    let (name, method) = named;
    let mut points = Vec::new();
    let mut all = Course::default();
    for &n in counts {
        let Crossing {
            flap, model, start, ..
        } = crossing(FOLDED)?;
        let (c, end) = go(
            Simulation::new(model, start, method.clone())?,
            DURATION / n as f64,
            n,
        )?;
        let error = c.if_good(off_exact(&flap, &end));
        points.push([1e3 * DURATION / n as f64, error]);
        all.add_run(c);
    }
    let errors: Vec<f64> = points.iter().map(|p| p[1]).collect();
    let expected = match *name {
        "implicit Euler" | "projection" => 1.0,
        "RATTLE composition" => 4.0,
        _ => 2.0,
    };
    let mut judge = f.of(&all, *name);
    if *name == "RATTLE composition" {
        let quantity = format!("error with {} steps, m", counts[counts.len() - 1]);
        judge.at_most(&quantity, errors[errors.len() - 1], 1e-7);
    } else {
        let order = *orders(&errors).last().unwrap_or(&f64::NAN);
        let quantity = format!("order of convergence (exact: {expected})");
        judge.at_least(&quantity, order, expected - 0.2);
    }
    judge.strain("largest edge strain");
    if conservative().iter().any(|c| c.0 == *name) {
        judge.at_most("rejected steps", all.cost.rejected as f64, 0.0);
    }
    Ok(points)
}

/// When the sheet is flat, seconds.
fn flat_at() -> Result<f64> {
    let flap = crossing(FOLDED)?.flap;
    let (mut low, mut high) = (0.0, DURATION);
    for _ in 0..50 {
        let t = 0.5 * (low + high);
        let x = flap.exact(t);
        // The apexes are below the hinge line after flat.
        if x[8] > x[2] { low = t } else { high = t }
    }
    Ok(low)
}
