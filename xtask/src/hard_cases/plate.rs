//! The inertia of plates: lumped and consistent mass.

use super::rigid::{SPIN, tetrahedron};
use super::scenes::{apart, at_rest, course, go};
use super::{Case, Findings, Work, log_log};
use crate::draw::{Axis, Chart, Series};
use crate::report::{Bound, Effort};
use anyhow::Result;
use isosheet_dynamics::{Method, SheetModel, Simulation};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use isosheet_tests::{Pendulum, RigidBody, orders};
use isosheet_tests::{conservative, energy_momentum, rattle_composition};
use nalgebra::Vector3;

pub(crate) const PLATE: Case = Case {
    name: "plate",
    title: "Lumped and consistent mass against the rigid plate",
    expected: "A uniform rigid plate has the rotary inertia of its area. The consistent mass matrix gives it exactly. Lumping a third of every face \
               at its corners, as the paper does, gives a triangle four times the inertia about its centroid: it swings slower, and stays \
               the default only because it is the paper's.",
    run: Work::Code(plate),
};

/// Time at which the positions are compared, seconds.
const END: f64 = 2.0;

fn plate(f: &mut Findings, effort: Effort) -> Result<()> {
    held(f)?;
    free(f, effort)?;
    f.here = "Both mass matrices are there; scenes say which one they use. The reference for the shell integrates Euler's equations with the inertia of \
              the uniform faces (a quadrature, not the mass matrix) and a quaternion.";
    Ok(())
}

/// A triangle held at an edge.
fn held(f: &mut Findings) -> Result<()> {
    // A uniform triangle about its edge: a pendulum of half the altitude. Lumped: of the whole altitude.
    let altitude: f64 = 0.7;
    let (s, c) = 1.2_f64.sin_cos();
    let corner = [altitude * s, 0.1, -altitude * c];
    let x = [[0.0, -0.3, 0.0], [0.0, 0.5, 0.0], corner].concat();
    let sheet = Sheet::new(x.clone(), &[[0, 1, 2]])?;
    let exact = |length: f64, t: f64| {
        let pendulum = Pendulum {
            length,
            amplitude: 1.2,
            gravity: 9.8,
        };
        let x = pendulum.exact(t);
        x[6].atan2(-x[8])
    };
    let angle = |kind, steps: usize| -> Result<(f64, Vec<[f64; 2]>)> {
        let model = SheetModel::new(&sheet, 0.3, kind)?
            .with_gravity()
            .with_pins(&[VertexId(0), VertexId(1)])?;
        let mut run = at_rest(model, &x, rattle_composition())?;
        let mut curve = vec![[0.0, 1.2]];
        course(&mut run, END / steps as f64, steps, |r, s| {
            curve.push([r.t, s.x[6].atan2(-s.x[8])]);
        })?;
        Ok((curve[curve.len() - 1][1], curve))
    };
    let (lumped, lumped_curve) = angle(MassKind::Lumped, 400)?;
    let (consistent, consistent_curve) = angle(MassKind::Consistent, 400)?;
    let plate = exact(0.5 * altitude, END);
    let off = (lumped - plate).abs();
    let what = "a triangle held at an edge: angle error after 2 s, rad";
    f.naive("Lumped mass", what, off, Bound::AtMost(0.1));
    let what = "held triangle, consistent mass: angle error after 2 s, rad";
    f.at_most(what, (consistent - plate).abs(), 1e-7);
    let what = "held triangle, lumped mass: error against the pendulum of the whole altitude, rad";
    f.at_most(what, (lumped - exact(altitude, END)).abs(), 1e-7);
    let curve = |k: u32| {
        let t = 0.01 * f64::from(k);
        [t, exact(0.5 * altitude, t)]
    };
    let x = Axis::linear("time, s", [0.0, END]);
    let y = Axis::linear("angle, rad", [-1.5, 1.5]);
    let series = vec![
        Series::curve(1, "lumped", lumped_curve),
        Series::curve(0, "consistent", consistent_curve),
        Series::guide("uniform plate", (0..=200).map(curve).collect()),
    ];
    let swing = Chart::new(x, y, [230.0, 120.0], series);
    let alt =
        "A triangle held at an edge: angle over time, and the exact motion of the uniform plate";
    f.drawing("plate-held", &swing.into(), alt);
    Ok(())
}

/// The uniform shell as point masses of the same inertia: a third of the mass of every face in the middle
/// of each of its sides, which is exact for quadratic functions.
fn shell(sheet: &Sheet, mass: f64) -> Vec<(f64, Vector3<f64>)> {
    let density = mass / sheet.area();
    let mut all = Vec::new();
    for (f, area) in sheet.topology().faces().iter().zip(sheet.face_areas()) {
        let p = f.map(|v| Vector3::from(sheet.position(v)));
        for k in 0..3 {
            all.push((density * area / 3.0, 0.5 * (p[k] + p[(k + 1) % 3])));
        }
    }
    all
}

/// A free tetrahedral shell: the products of inertia of a uniform one against those of its lumped masses.
fn free(f: &mut Findings, effort: Effort) -> Result<()> {
    let sheet = tetrahedron()?;
    let mass = 0.4;
    let body = RigidBody::of_masses(&shell(&sheet, mass));
    let counts = &[100, 200, 400, 800, 1600][..effort.pick(2, 4, 5)];
    let run = |kind: MassKind, method: &Method, n: usize| -> Result<f64> {
        let model = SheetModel::new(&sheet, mass, kind)?;
        let (c, end) = go(
            Simulation::new(model, body.start(&sheet, SPIN), method.clone())?,
            END / n as f64,
            n,
        )?;
        let exact = body.positions(&sheet, SPIN, END, 20 * n.max(1000));
        Ok(c.if_good(apart(&end, &exact)))
    };
    let errors = |kind, method: &Method| -> Result<Vec<f64>> {
        counts.iter().map(|n| run(kind, method, *n)).collect()
    };
    let line = |k, name: &str, errors: &[f64]| {
        let points = counts
            .iter()
            .zip(errors)
            .map(|(n, e)| [1e3 * END / *n as f64, *e]);
        Series::styled(k, name, points.collect())
    };
    let mut lines = Vec::new();
    for (k, (name, method)) in conservative().into_iter().enumerate() {
        let list = errors(MassKind::Consistent, &method)?;
        lines.push(line(k, &format!("consistent, {name}"), &list));
        let what = format!("free shell, consistent mass, {name}");
        let want = if name == "RATTLE composition" {
            4.0
        } else {
            2.0
        };
        f.at_least(
            format!("{what}: order of convergence to Euler's rigid body (exact: {want})"),
            orders(&list)[0],
            want - 0.3,
        );
        if name == "RATTLE composition" {
            let smallest = list.iter().copied().fold(f64::INFINITY, f64::min);
            let bound = effort.pick(1e-4, 1e-6, 1e-6);
            f.at_most(format!("{what}: smallest error, m"), smallest, bound);
        }
    }
    let lumped = errors(MassKind::Lumped, &rattle_composition())?;
    lines.push(line(3, "lumped, RATTLE composition", &lumped));
    let off = lumped[lumped.len() - 1];
    let what = "a free tetrahedral shell: position error after 2 s with the smallest step, m";
    f.naive("Lumped mass", what, off, Bound::AtMost(1e-3));
    let model = SheetModel::new(&sheet, mass, MassKind::Consistent)?;
    let (c, _) = go(
        Simulation::new(model, body.start(&sheet, SPIN), energy_momentum())?,
        1e-2,
        100,
    )?;
    f.of(&c, "free shell, energy-momentum at 10 ms")
        .strain("edge strain");
    let drawing = log_log("step, ms", "position error after 2 s, m", lines);
    let alt = "A free tetrahedral shell against Euler's rigid body";
    f.drawing("plate-free", &drawing, alt);
    Ok(())
}
