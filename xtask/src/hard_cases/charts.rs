//! The paper's coordinates and its scheme: condition, an error that does not vanish with the step, the
//! degenerate placement of Fig. 7.

use super::naive::NO_DIGITS;
use super::scenes::{FRAME, apart, go, pinned, released};
use super::{Case, Findings, Work, log_log};
use crate::condition;
use crate::draw::Series;
use crate::draw::spatial::{norm, sub};
use crate::interrupt;
use crate::report::{Bound, Cell, Effort, Table, number};
use crate::runs::{bumped, corner, hanging};
use anyhow::Result;
use isosheet_coords::assignment::Degenerate;
use isosheet_coords::placement::{place_f, place_on_line};
use isosheet_coords::{
    AssignmentOptions, BentState, Branch, CartesianChart, Chart, ChartError, Choice, ConditionRow,
    FrontChart, RodSystem, TableChart, bent_square, condition_table,
};
use isosheet_dynamics::chart::{
    ChartMechanics, ChartMethod, ChartOptions, ChartStepControl, Equations, MassSolverKind,
    PositionUpdate, Rebase,
};
use isosheet_dynamics::{Method, Simulation, State};
use isosheet_mesh::{Sheet, VertexId, generate};
use isosheet_tests::orders;
use isosheet_tests::{energy_momentum, methods, rattle_composition};
use nalgebra::Vector3;

pub(crate) const CONDITION: Case = Case {
    name: "chart-condition",
    title: "Condition of the system coordinates",
    expected: "The velocities that belong to given momenta are found to many digits on every mesh. The paper's front marches across the sheet \
               and multiplies errors at every row, so that its mass matrix loses all digits on M^2 or M^3; well-chosen coordinates do not.",
    run: Work::Code(condition),
};

fn condition(f: &mut Findings, effort: Effort) -> Result<()> {
    let mut rows: Vec<ConditionRow> = Vec::new();
    for level in 0..=effort.pick(2, 5, 5) {
        interrupt::check()?;
        rows.extend(condition_table([level])?);
    }
    let worst = |chart, level| {
        let of = rows.iter().filter(|r| r.chart == chart && r.level == level);
        of.map(|r| r.condition).fold(0.0, f64::max)
    };
    let finest = rows.iter().map(|r| r.level).max().unwrap_or(0);
    for level in 0..=finest {
        let what =
            format!("M^{level}: condition number of the mass matrix, chosen Cartesian coordinates");
        f.at_most(what, worst(TableChart::Cartesian, level), 1e6);
    }
    // The velocity from the momenta, by the published way and by the sparse one, in the paper's coordinates.
    let mut all = Vec::new();
    for level in 0..=effort.pick(1, 3, 3) {
        interrupt::check()?;
        let front = Coordinates::FrontCorner;
        let (dense, _) = velocity_error(level, front, MassSolverKind::DenseLu)?;
        let (sparse, said) = velocity_error(level, front, MassSolverKind::Saddle)?;
        let chosen = velocity_error(level, Coordinates::Cartesian, MassSolverKind::Saddle)?.0;
        let method = "Dense LU of the mass matrix in the paper's coordinates";
        let what = format!("M^{level}: relative error of the velocities");
        let refused = dense.is_none().then(|| "refused".to_owned());
        f.naive(method, what, dense.unwrap_or(f64::NAN), Bound::AtMost(1e-4))
            .remark(refused);
        let condition = worst(TableChart::FrontCorner, level);
        let what = format!("M^{level}: condition number of the mass matrix");
        f.naive(method, what, condition, Bound::AtMost(NO_DIGITS));
        let what = format!(
            "M^{level}: relative error of velocities from momenta, saddle point in chosen coordinates"
        );
        f.at_most(what, chosen.unwrap_or(f64::NAN), 1e-9)
            .remark(said.filter(|_| chosen.is_none()));
        all.push((level, [dense, sparse, chosen]));
    }
    let show = |e: Option<f64>| Cell::from(e.map_or("refused".to_owned(), number));
    f.tables.push(Table::of(
        "Relative error of the velocities v that belong to the momenta p = J^T M v",
        all,
        &[
            ("mesh", &|r| format!("M^{}", r.0).into()),
            ("front, dense LU", &|r| show(r.1[0])),
            ("front, sparse saddle point", &|r| show(r.1[1])),
            ("chosen Cartesian, saddle point", &|r| show(r.1[2])),
        ],
    ));
    f.here = "The mass matrix of any chart is solved with one sparse saddle-point matrix, and coordinates are chosen by a rank-revealing \
              elimination. A chart whose condition number leaves no digits is refused at the start.";
    let alt = "Condition number of the mass matrix of bent sheets by mesh level, in three systems of coordinates";
    f.drawing("chart-condition", &condition::plot(&rows), alt);
    Ok(())
}

/// The paper's coordinates of a sheet that is held at a vertex, at positions `x`.
fn front_chart(
    sheet: &Sheet,
    pin: VertexId,
    degenerate: Degenerate,
    x: &[f64],
) -> Result<FrontChart, ChartError> {
    let options = AssignmentOptions {
        pins: vec![pin],
        degenerate,
        ..Default::default()
    };
    FrontChart::new(sheet, &options, x)
}

#[derive(Clone, Copy)]
enum Coordinates {
    FrontCorner,
    Cartesian,
}

/// Known velocities are turned into momenta and found from these again. Returns the relative error of the
/// result in the largest norm, or the reason why there is none.
fn velocity_error(
    level: u32,
    coordinates: Coordinates,
    solver: MassSolverKind,
) -> Result<(Option<f64>, Option<String>)> {
    let sheet = generate::isotropic_square(level, 1.0)?;
    let pin = VertexId(0);
    let x = bent_square(&sheet, level, BentState::Noise);
    let bent = Sheet::new(x.clone(), &sheet.face_indices())?;
    // Velocities that keep the lengths: a smooth field, projected by a short step, at the positions at the
    // end of this step.
    let field = x
        .chunks(3)
        .flat_map(|p| [0.3 * p[1], 0.5 * p[2], p[0] * p[1]])
        .collect();
    let mut settle = Simulation::new(
        pinned(&bent, &[pin])?,
        State::moving(x.clone(), field),
        Method::Projection(Default::default()),
    )?;
    settle.step(1e-6)?;
    let State { x, v: want, .. } = settle.state().clone();
    let model = pinned(&bent, &[pin])?;
    let chart: Box<dyn Chart> = match coordinates {
        Coordinates::FrontCorner => match front_chart(&bent, pin, Degenerate::default(), &x) {
            Ok(chart) => Box::new(chart),
            Err(e) => return Ok((None, Some(e.to_string()))),
        },
        Coordinates::Cartesian => {
            let system = RodSystem::new(&bent, &[pin])?;
            Box::new(CartesianChart::new(system, Choice::Auto, &x)?)
        }
    };
    let found = (|| {
        let mut mechanics = ChartMechanics::new(model, chart, solver)?;
        mechanics.at(&x)?;
        let mut p = vec![0.0; mechanics.dimension()];
        mechanics.momenta(&want, &mut p)?;
        let mut qdot = vec![0.0; p.len()];
        let mut v = vec![0.0; x.len()];
        mechanics.velocity(&p, &mut qdot, &mut v)?;
        Ok::<_, isosheet_dynamics::chart::ChartDynamicsError>(v)
    })();
    Ok(match found {
        Ok(v) if v.iter().all(|v| v.is_finite()) => {
            let scale = want.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let error = isosheet_tests::max_difference(&v, &want) / scale;
            (Some(error), None)
        }
        Ok(_) => (None, Some("the velocities are not finite".into())),
        Err(e) => (None, Some(e.to_string())),
    })
}

pub(crate) const LITERAL: Case = Case {
    name: "literal-scheme",
    title: "The literal scheme's error does not go away",
    expected: "Halving the step of a first-order scheme halves its error. The paper carries the momenta over from step to step while it treats \
               the Jacobian as constant, which leaves out the velocity-squared forces: its error stays as it is, however small the step.",
    run: Work::Code(literal),
};

/// Height of the bump (metres) and duration of the runs (seconds).
const BUMP: f64 = 0.1;
const END: f64 = 0.3;

fn literal(f: &mut Findings, effort: Effort) -> Result<()> {
    let counts = [75, 150, 300, 600, 1200, 2400, 4800];
    let counts = &counts[..effort.pick(3, 6, 7)];
    let (_, reference) = go(hanging(0, BUMP, rattle_composition())?, 1e-4, 3000)?;
    let reference = &reference;
    let chart = |method, equations| {
        let errors = counts
            .iter()
            .map(|n| chart_error((method, equations), *n, reference));
        errors.collect::<Result<Vec<f64>>>()
    };
    let published = chart(ChartMethod::ForwardEuler, Equations::Published)?;
    let reformed = chart(ChartMethod::ForwardEuler, Equations::Reformed)?;
    let full = chart(ChartMethod::RungeKutta4, Equations::Full)?;
    let em = counts.iter().map(|n| {
        let (c, end) = go(hanging(0, BUMP, energy_momentum())?, END / *n as f64, *n)?;
        Ok(c.if_good(apart(&end, reference)))
    });
    let em: Vec<f64> = em.collect::<Result<_>>()?;
    let last = counts.len() - 1;
    let order = |errors: &[f64]| orders(errors)[errors.len() - 2];
    let method = "Forward Euler with the published equations, M^0";
    let what = "position error after 0.3 s with the smallest step, m";
    f.naive(method, what, published[last], Bound::AtMost(0.05));
    let what = "observed order (exact: 1)";
    f.naive(method, what, order(&published), Bound::AtLeast(0.2));
    let what = "momenta formed anew at every step: order (exact: 1)";
    f.at_least(what, order(&reformed), 0.9);
    f.at_least("energy-momentum: order (exact: 2)", order(&em), 1.9);
    let what = "full Hamilton equations, Runge–Kutta: position error, m";
    f.at_most(what, full[last], 1e-7);
    let what =
        "error of the published scheme over that of energy-momentum at the same smallest step";
    f.at_least(what, published[last] / em[last], 1e3);
    f.here = "The same sheet with momenta formed anew (first order), the full equations of Hamilton's principle (fourth order), and \
              without a chart (second order), against RATTLE's fourth-order composition at 0.1 ms.";
    let line = |(k, name, errors): (usize, &str, Vec<f64>)| {
        let points = counts
            .iter()
            .zip(errors)
            .map(|(n, e)| [1e3 * END / *n as f64, e]);
        Series::styled(k, name, points.collect())
    };
    let lines = [
        (1, "published", published),
        (3, "momenta re-formed", reformed),
        (2, "Hamilton, Runge–Kutta", full),
        (0, "energy-momentum", em),
    ];
    let lines = lines.map(line).to_vec();
    let drawing = log_log("step, ms", "position error after 0.3 s, m", lines);
    let alt = "Position error of M^0 held at a corner against the step";
    f.drawing("literal-scheme", &drawing, alt);
    Ok(())
}

/// The distance from the reference of a run in the paper's coordinates, metres; NaN of one that does not end.
fn chart_error(
    (method, equations): (ChartMethod, Equations),
    n: usize,
    reference: &[f64],
) -> Result<f64> {
    interrupt::check()?;
    let sheet = bumped(0, BUMP);
    let chart = front_chart(&sheet, corner(0), Degenerate::Assign, sheet.positions())?;
    let position = match method {
        ChartMethod::RungeKutta4 => PositionUpdate::Exact,
        ChartMethod::ForwardEuler => PositionUpdate::Linear,
    };
    let options = ChartOptions {
        method,
        equations,
        position,
        control: ChartStepControl::Fixed(END / n as f64),
        ..ChartOptions::default()
    };
    let start = State::at_rest(sheet.positions().to_vec());
    let model = pinned(&sheet, &[corner(0)])?;
    let mut run = Simulation::in_chart(model, start, Box::new(chart), options)?;
    let end = run.step(END);
    Ok(end.map_or(f64::NAN, |_| apart(&run.state().x, reference)))
}

pub(crate) const COLLINEAR: Case = Case {
    name: "collinear",
    title: "Three collinear known vertices",
    expected: "Placing a vertex from three known neighbours fails where these are on a line (Fig. 7 of the paper): the angle about the line is \
               free. It is refused with the reason, carried over from the state before, or given a coordinate; sheets whose crease lines \
               stay straight run.",
    run: Work::Code(collinear),
};

/// Trilateration as textbooks have it (Fang 1986 and others), in the frame of the three known points.
fn trilateration(p: [Vector3<f64>; 3], r: [f64; 3]) -> Vector3<f64> {
    let d = (p[1] - p[0]).norm();
    let ex = (p[1] - p[0]) / d;
    let i = ex.dot(&(p[2] - p[0]));
    let ey = (p[2] - p[0] - i * ex).normalize();
    let j = ey.dot(&(p[2] - p[0]));
    let x = (r[0] * r[0] - r[1] * r[1] + d * d) / (2.0 * d);
    let y = (r[0] * r[0] - r[2] * r[2] + i * i + j * j - 2.0 * i * x) / (2.0 * j);
    let z = (r[0] * r[0] - x * x - y * y).sqrt();
    p[0] + x * ex + y * ey + z * ex.cross(&ey)
}

fn collinear(f: &mut Findings, effort: Effort) -> Result<()> {
    placements(f)?;
    let outcome = paper_on_fold()?;
    let method = "The paper's assignment on M^1 folded along its middle line";
    f.naive_run(method, "edge strain", outcome, Bound::AtMost(1e-6));
    // Every interior vertex of degree 4 keeps one straight crease; the bumped M^1 has four of them next to
    // its boundary.
    let sheet = bumped(1, 0.1);
    let options = ChartOptions {
        method: ChartMethod::RungeKutta4,
        control: ChartStepControl::Fixed(1e-3),
        rebase: Rebase::WhenNeeded,
        ..ChartOptions::default()
    };
    let result = front_strain(&sheet, Degenerate::Assign, options)?;
    let what =
        "a coordinate for every free angle: edge strain after 0.1 s of M^1 in the front's chart";
    f.at_most(what, result.as_ref().copied().unwrap_or(f64::NAN), 1e-11)
        .remark(result.err());
    let square = folded_square()?;
    for (name, method) in methods().take(effort.pick(2, 3, 3)) {
        let (c, _) = go(released(&square, &[corner(1)], method)?, FRAME, 60)?;
        f.of(&c, format!("M^1 folded along its middle line, {name}"))
            .strain("edge strain in 1 s");
    }
    f.here = "Placement has a typed refusal for the case and two ways on; the chart-free methods do not know it at all.";
    Ok(())
}

/// What the rules of placement do where the three known vertices are on a line.
fn placements(f: &mut Findings) -> Result<()> {
    let known = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.25, 0.0, 0.0]];
    let vertex: [f64; 3] = [0.5, 0.6, 0.2];
    let lengths = known.map(|k| norm(&sub(&vertex, &k)));
    let place = trilateration(known.map(Vector3::from), lengths);
    let off = (place - Vector3::from(vertex)).norm();
    let what = "three known vertices on a line: error of the place, m";
    f.naive("Trilateration", what, off, Bound::AtMost(1e-6));
    let refused = place_f(known.each_ref(), lengths, Branch::Above, 1e-9);
    let what = "rule f refuses the exactly collinear case with a reason (1 yes, 0 no)";
    f.at_least(what, f64::from(u8::from(refused.is_err())), 1.0)
        .remark(refused.err().map(|e| e.to_string()));
    let (ends, near) = ([&known[0], &known[1]], [0.52, 0.58, 0.21]);
    let carried = place_on_line(ends, [lengths[0], lengths[1]], &near, 1e-9)?.position;
    let errors = known.iter().zip(lengths);
    let errors = errors.map(|(k, length)| (norm(&sub(&carried, k)) / length - 1.0).abs());
    let what = "carrying the angle over: relative error of the three lengths";
    f.at_most(what, errors.fold(0.0, f64::max), 1e-14);
    Ok(())
}

/// `M^1` exactly folded along one crease, so that all others are straight.
fn folded_square() -> Result<Sheet> {
    let (s, c) = 0.7_f64.sin_cos();
    let flat = generate::isotropic_square(1, 1.0)?;
    Ok(flat.map_positions(|[x, y, _]| {
        let beyond = (x - 0.5).max(0.0);
        [x - beyond + c * beyond, y, s * beyond]
    })?)
}

/// The edge strain of the folded square after a step of the paper's scheme, or why there is none.
fn paper_on_fold() -> Result<Result<f64, String>> {
    let options = ChartOptions {
        equations: Equations::Published,
        rebase: Rebase::Never,
        ..ChartOptions::default()
    };
    front_strain(&folded_square()?, Degenerate::default(), options)
}

/// The edge strain of `M^1` after 0.1 s in the paper's coordinates, or why there is none.
fn front_strain(
    sheet: &Sheet,
    degenerate: Degenerate,
    options: ChartOptions,
) -> Result<Result<f64, String>> {
    let chart = match front_chart(sheet, corner(1), degenerate, sheet.positions()) {
        Ok(chart) => chart,
        Err(e) => return Ok(Err(e.to_string())),
    };
    let start = State::at_rest(sheet.positions().to_vec());
    let model = pinned(sheet, &[corner(1)])?;
    let run = Simulation::in_chart(model, start, Box::new(chart), options);
    let run = run.map_err(|e| e.to_string());
    Ok(run.and_then(|mut run| run.step(0.1).map(|r| r.strain).map_err(|e| e.to_string())))
}
