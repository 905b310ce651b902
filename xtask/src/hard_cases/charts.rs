//! The paper's coordinates and its scheme: condition, an error that does not vanish with the step, the
//! degenerate placement of Fig. 7.

use super::scenes::{STRAIN, apart, course, pinned};
use super::{Case, Findings};
use crate::condition;
use crate::draw::Series;
use crate::interrupt;
use crate::methods::methods;
use crate::report::Effort;
use crate::report::number;
use crate::timing::{bumped, corner, hanging};
use anyhow::Result;
use isosheet_coords::assignment::Degenerate;
use isosheet_coords::placement::{place_f, place_on_line};
use isosheet_coords::{
    AssignmentOptions, BentState, Branch, CartesianChart, Chart, Choice, ConditionRow, FrontChart,
    RodSystem, TableChart, bent_square, condition_table,
};
use isosheet_dynamics::chart::{
    ChartMechanics, ChartMethod, ChartOptions, ChartStepControl, Equations, MassSolverKind,
    PositionUpdate, Rebase,
};
use isosheet_dynamics::{Method, Simulation, State};
use isosheet_mesh::{Sheet, VertexId, generate};
use isosheet_tests::orders;
use nalgebra::Vector3;

pub(crate) const CONDITION: Case = Case {
    name: "chart-condition",
    title: "Condition of the system coordinates",
    expected: "The velocities that belong to given momenta are found to many digits on every mesh. The paper's front marches across the sheet \
               and multiplies errors at every row, so that its mass matrix loses all digits on M^2 or M^3; well-chosen coordinates do not.",
    run: condition,
};

fn condition(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let mut rows: Vec<ConditionRow> = Vec::new();
    for level in 0..=effort.pick(2, 5, 5) {
        interrupt::check()?;
        rows.extend(condition_table([level])?);
    }
    let worst = |chart, level| {
        rows.iter()
            .filter(|r| r.chart == chart && r.level == level)
            .map(|r| r.condition)
            .fold(0.0, f64::max)
    };
    let finest = rows.iter().map(|r| r.level).max().unwrap_or(0);
    for level in 0..=finest {
        f.at_most(
            format!("M^{level}: condition number of the mass matrix, chosen Cartesian coordinates"),
            worst(TableChart::Cartesian, level),
            1e6,
        );
    }
    // The velocity from the momenta, by the published way and by the sparse one, in the paper's coordinates.
    let mut table = Vec::new();
    for level in 0..=effort.pick(1, 3, 3) {
        interrupt::check()?;
        let (dense, _) = velocity_error(level, Coordinates::FrontCorner, MassSolverKind::DenseLu)?;
        let (front, said) =
            velocity_error(level, Coordinates::FrontCorner, MassSolverKind::Saddle)?;
        let (chosen, _) = velocity_error(level, Coordinates::Cartesian, MassSolverKind::Saddle)?;
        f.naive(
            &format!("Dense LU of the mass matrix in the paper's coordinates, M^{level}"),
            match dense {
                Some(e) => format!(
                    "Relative error of the velocities {}; condition number {:.0e}.",
                    number(e),
                    worst(TableChart::FrontCorner, level)
                ),
                None => format!(
                    "Refused; condition number {:.0e}.",
                    worst(TableChart::FrontCorner, level)
                ),
            },
            dense.is_none_or(|e| e > 1e-4),
        );
        let show = |e: Option<f64>| e.map_or("refused".to_owned(), number);
        table.push(vec![
            format!("M^{level}"),
            show(dense),
            show(front),
            show(chosen),
        ]);
        f.at_most(
            format!("M^{level}: relative error of velocities from momenta, saddle point in chosen coordinates"),
            chosen.unwrap_or(f64::NAN),
            1e-9,
        )
        .remark(said.filter(|_| chosen.is_none()));
    }
    f.table(
        "Relative error of the velocities v that belong to the momenta p = J^T M v",
        &[
            "mesh",
            "front, dense LU",
            "front, sparse saddle point",
            "chosen Cartesian, saddle point",
        ],
        table,
    );
    f.here = format!(
        "The mass matrix of any chart is solved with one sparse saddle-point matrix, and coordinates are chosen by a rank-revealing \
         elimination: condition number {} on M^{finest}. A chart whose condition number leaves no digits is refused at the start.",
        number(worst(TableChart::Cartesian, finest))
    );
    f.drawing(
        "chart-condition",
        &condition::plot(&rows),
        "Condition number of the mass matrix of bent sheets by mesh level, in three systems of coordinates",
    );
    Ok(f)
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
        Coordinates::FrontCorner => {
            let options = AssignmentOptions {
                pins: vec![pin],
                ..Default::default()
            };
            match FrontChart::new(&bent, &options, &x) {
                Ok(chart) => Box::new(chart),
                Err(e) => return Ok((None, Some(e.to_string()))),
            }
        }
        Coordinates::Cartesian => Box::new(CartesianChart::new(
            RodSystem::new(&bent, &[pin])?,
            Choice::Auto,
            &x,
        )?),
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
            (
                Some(isosheet_tests::max_difference(&v, &want) / scale),
                None,
            )
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
    run: literal,
};

fn literal(effort: Effort) -> Result<Findings> {
    const BUMP: f64 = 0.1;
    const END: f64 = 0.3;
    let mut f = Findings::default();
    let steps: Vec<usize> = effort.pick(
        vec![75, 150, 300],
        vec![75, 150, 300, 600, 1200, 2400],
        vec![75, 150, 300, 600, 1200, 2400, 4800],
    );
    let reference = {
        let mut run = hanging(0, BUMP, Method::RattleComposition(Default::default()))?;
        course(&mut run, 1e-4, 3000, |_, _| {})?;
        run.state().x.clone()
    };
    let chart_error = |method, equations, n: usize| -> Result<f64> {
        interrupt::check()?;
        let sheet = bumped(0, BUMP)?;
        let options = AssignmentOptions {
            pins: vec![corner(0)],
            degenerate: Degenerate::Assign,
            ..Default::default()
        };
        let chart = FrontChart::new(&sheet, &options, sheet.positions())?;
        let options = ChartOptions {
            method,
            equations,
            position: if method == ChartMethod::RungeKutta4 {
                PositionUpdate::Exact
            } else {
                PositionUpdate::Linear
            },
            control: ChartStepControl::Fixed(END / n as f64),
            ..ChartOptions::default()
        };
        let start = State::at_rest(sheet.positions().to_vec());
        let mut run = Simulation::in_chart(
            pinned(&sheet, &[corner(0)])?,
            start,
            Box::new(chart),
            options,
        )?;
        Ok(run
            .step(END)
            .map_or(f64::NAN, |_| apart(&run.state().x, &reference)))
    };
    let mut lines = Vec::new();
    let mut all =
        |k: usize, name: &str, error: &dyn Fn(usize) -> Result<f64>| -> Result<Vec<f64>> {
            let errors = steps
                .iter()
                .map(|n| error(*n))
                .collect::<Result<Vec<f64>>>()?;
            let points = steps
                .iter()
                .zip(&errors)
                .map(|(n, e)| [1e3 * END / *n as f64, *e])
                .collect();
            lines.push(Series::styled(k, name, points));
            Ok(errors)
        };
    let euler = ChartMethod::ForwardEuler;
    let published = all(1, "published", &|n| {
        chart_error(euler, Equations::Published, n)
    })?;
    let reformed = all(3, "momenta re-formed", &|n| {
        chart_error(euler, Equations::Reformed, n)
    })?;
    let full = all(2, "Hamilton, Runge–Kutta", &|n| {
        chart_error(ChartMethod::RungeKutta4, Equations::Full, n)
    })?;
    let em = all(0, "energy-momentum", &|n| {
        let mut run = hanging(0, BUMP, Method::EnergyMomentum(Default::default()))?;
        let c = course(&mut run, END / n as f64, n, |_, _| {})?;
        Ok(c.if_finished(apart(&run.state().x, &reference)))
    })?;
    let last = steps.len() - 1;
    let order = |errors: &[f64]| orders(errors)[errors.len() - 2];
    f.naive(
        "Forward Euler with the published equations, M^0",
        format!(
            "Position error after 0.3 s: {} m with steps of {} ms, {} m with {} ms; observed order {:.2}.",
            number(published[0]),
            number(1e3 * END / steps[0] as f64),
            number(published[last]),
            number(1e3 * END / steps[last] as f64),
            order(&published)
        ),
        order(&published).abs() < 0.2 && published[last] > 0.05,
    );
    f.at_least(
        "momenta formed anew at every step: order (exact: 1)",
        order(&reformed),
        0.9,
    );
    f.at_least("energy-momentum: order (exact: 2)", order(&em), 1.9);
    f.at_most(
        "full Hamilton equations, Runge–Kutta: position error, m",
        full[last],
        1e-7,
    );
    f.at_least(
        "error of the published scheme over that of energy-momentum at the same smallest step",
        published[last] / em[last],
        1e3,
    );
    f.here = "The same sheet with momenta formed anew (first order), the full equations of Hamilton's principle (fourth order), and \
              without a chart (second order), against RATTLE's fourth-order composition at 0.1 ms."
        .into();
    let drawing = super::log_log("step, ms", "position error after 0.3 s, m", lines);
    f.drawing(
        "literal-scheme",
        &drawing,
        "Position error of M^0 held at a corner against the step",
    );
    Ok(f)
}

pub(crate) const COLLINEAR: Case = Case {
    name: "collinear",
    title: "Three collinear known vertices",
    expected: "Placing a vertex from three known neighbours fails where these are on a line (Fig. 7 of the paper): the angle about the line is \
               free. It is refused with the reason, carried over from the state before, or given a coordinate; sheets whose crease lines \
               stay straight run.",
    run: collinear,
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

fn collinear(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let known = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.25, 0.0, 0.0]];
    let vertex: [f64; 3] = [0.5, 0.6, 0.2];
    let length = |k: usize| {
        (0..3)
            .map(|i| (vertex[i] - known[k][i]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let lengths = [length(0), length(1), length(2)];
    let points = known.map(Vector3::from);
    let place = trilateration(points, lengths);
    let off = (place - Vector3::from(vertex)).norm();
    f.naive(
        "Trilateration",
        format!(
            "With three known vertices on the x axis the place is ({}, {}, {}).",
            place.x, place.y, place.z
        ),
        off.is_nan() || off > 1e-6,
    );
    let refs = [&known[0], &known[1], &known[2]];
    let refused = place_f(refs, lengths, Branch::Above, 1e-9);
    f.at_least(
        "rule f refuses the exactly collinear case with a reason (1 yes, 0 no)",
        f64::from(u8::from(refused.is_err())),
        1.0,
    )
    .remark(refused.err().map(|e| e.to_string()));
    let near = [0.52, 0.58, 0.21];
    let carried = place_on_line(
        [&known[0], &known[1]],
        [lengths[0], lengths[1]],
        &near,
        1e-9,
    )?;
    let error = (0..3)
        .map(|k| {
            let d: f64 = (0..3)
                .map(|i| (carried.position[i] - known[k][i]).powi(2))
                .sum();
            (d.sqrt() / lengths[k] - 1.0).abs()
        })
        .fold(0.0, f64::max);
    f.at_most(
        "carrying the angle over: relative error of the three lengths",
        error,
        1e-14,
    );
    // Every interior vertex of degree 4 keeps one straight crease; the bumped M^1 has four of them next to
    // its boundary.
    let sheet = bumped(1, 0.1)?;
    let chart = |degenerate| {
        let options = AssignmentOptions {
            pins: vec![corner(1)],
            degenerate,
            ..Default::default()
        };
        FrontChart::new(&sheet, &options, sheet.positions())
    };
    let run = |chart: FrontChart, rebase| -> Result<Result<f64, String>> {
        let options = ChartOptions {
            method: ChartMethod::RungeKutta4,
            control: ChartStepControl::Fixed(1e-3),
            rebase,
            ..ChartOptions::default()
        };
        let start = State::at_rest(sheet.positions().to_vec());
        let model = pinned(&sheet, &[corner(1)])?;
        Ok(Simulation::in_chart(model, start, Box::new(chart), options)
            .map_err(|e| e.to_string())
            .and_then(|mut run| run.step(0.1).map(|r| r.strain).map_err(|e| e.to_string())))
    };
    let square = {
        // Exactly folded along one crease, so that all others are straight.
        let flat = generate::isotropic_square(1, 1.0)?;
        flat.map_positions(|[x, y, _]| {
            let (s, c) = 0.7_f64.sin_cos();
            if x > 0.5 {
                [0.5 + c * (x - 0.5), y, s * (x - 0.5)]
            } else {
                [x, y, 0.0]
            }
        })?
    };
    let options = AssignmentOptions {
        pins: vec![corner(1)],
        ..Default::default()
    };
    let outcome = FrontChart::new(&square, &options, square.positions())
        .map_err(|e| e.to_string())
        .and_then(|chart| {
            let options = ChartOptions {
                equations: Equations::Published,
                rebase: Rebase::Never,
                ..ChartOptions::default()
            };
            let model = pinned(&square, &[corner(1)]).map_err(|e| e.to_string())?;
            Simulation::in_chart(
                model,
                State::at_rest(square.positions().to_vec()),
                Box::new(chart),
                options,
            )
            .map_err(|e| e.to_string())?
            .step(0.1)
            .map_err(|e| e.to_string())
        });
    f.naive(
        "The paper's assignment on M^1 folded along its middle line",
        match &outcome {
            Ok(r) => format!("Runs; edge strain {}.", number(r.strain)),
            Err(e) => format!("{e}."),
        },
        outcome.is_err(),
    );
    match chart(Degenerate::Assign) {
        Ok(chart) => {
            let result = run(chart, Rebase::WhenNeeded)?;
            let strain = result.as_ref().copied().unwrap_or(f64::NAN);
            f.at_most("a coordinate for every free angle: edge strain after 0.1 s of M^1 in the front's chart", strain, 1e-11)
                .remark(result.err());
        }
        Err(e) => {
            f.at_most("a coordinate for every free angle", f64::NAN, 1e-11)
                .remark(Some(e.to_string()));
        }
    }
    for (name, method) in methods().take(effort.pick(2, 3, 3)) {
        let mut run =
            super::scenes::at_rest(pinned(&square, &[corner(1)])?, square.positions(), method)?;
        let c = course(&mut run, super::scenes::FRAME, 60, |_, _| {})?;
        f.at_most(
            format!("M^1 folded along its middle line, {name}: edge strain in 1 s"),
            c.if_finished(c.strain),
            STRAIN,
        )
        .remark(c.said());
    }
    f.here = "Placement has a typed refusal for the case and two ways on; the chart-free methods do not know it at all.".into();
    Ok(f)
}
