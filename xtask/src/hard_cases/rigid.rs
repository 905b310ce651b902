//! Meshes that cannot bend, and the inertia of plates.

use super::case::number;
use super::naive::{TEXTBOOK, textbook_step};
use super::scenes::{STRAIN, apart, conservative, course, methods};
use super::{Case, Effort, Findings, Shortfall, plot};
use crate::interrupt;
use anyhow::Result;
use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::{Dof, MassKind, MassMatrix, Sheet, VertexId, fold_angle};
use isosheet_tests::{complete_k, jacobi, orders};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

pub(crate) const CLOSED: Case = Case {
    name: "closed",
    title: "Closed and rigid meshes",
    expected: "A closed surface has six degrees of freedom: it turns as Euler's rigid body and nothing bends, also where rods are dependent \
               without being able to move, as at a vertex inside a flat side.",
    run: closed,
};

/// A tetrahedron without symmetry.
const TETRAHEDRON: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.1, 0.0],
    [0.2, 0.8, 0.1],
    [0.3, 0.2, 0.9],
];

fn tetrahedron() -> Result<Sheet> {
    let x = TETRAHEDRON.concat();
    Ok(Sheet::new(
        x,
        &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
    )?)
}

fn icosahedron() -> Result<Sheet> {
    let p = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut x = Vec::new();
    for (a, b) in [(1.0, p), (-1.0, p), (1.0, -p), (-1.0, -p)] {
        x.extend([
            0.0,
            0.3 * a,
            0.3 * b,
            0.3 * a,
            0.3 * b,
            0.0,
            0.3 * b,
            0.0,
            0.3 * a,
        ]);
    }
    // Faces: three vertices an edge length apart, oriented outwards.
    let at = |i: usize| Vector3::from_column_slice(&x[3 * i..3 * i + 3]);
    let near = |i: usize, j: usize| (at(i) - at(j)).norm() < 0.61;
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(i, k) {
                    let out = (at(j) - at(i)).cross(&(at(k) - at(i))).dot(&at(i)) > 0.0;
                    let [a, b, c] = if out { [i, j, k] } else { [i, k, j] };
                    faces.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    Ok(Sheet::new(x, &faces)?)
}

/// A box with a vertex in the middle of each side: infinitesimally flexible there, and rigid.
fn boxed() -> Result<Sheet> {
    let (size, mut x) = ([0.7, 0.9, 1.1], Vec::new());
    for k in 0..8 {
        x.extend((0..3).map(|i| {
            if k >> i & 1 == 1 {
                0.5 * size[i]
            } else {
                -0.5 * size[i]
            }
        }));
    }
    let mut faces = Vec::new();
    for axis in 0..3 {
        for side in 0..2_u32 {
            let middle = (x.len() / 3) as u32;
            let mut p = [0.0; 3];
            p[axis] = (f64::from(side) - 0.5) * size[axis];
            x.extend(p);
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let corner = |a: u32, b: u32| side << axis | a << u | b << v;
            let mut ring = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            if side == 0 {
                ring.reverse();
            }
            for k in 0..4 {
                faces.push([ring[k], ring[(k + 1) % 4], middle]);
            }
        }
    }
    Ok(Sheet::new(x, &faces)?)
}

/// Inertia tensor about the centre of mass, and the centre, of given masses.
fn inertia(points: &[(f64, Vector3<f64>)]) -> (Matrix3<f64>, Vector3<f64>, f64) {
    let mass: f64 = points.iter().map(|p| p.0).sum();
    let centre = points.iter().map(|(m, r)| *m * r).sum::<Vector3<f64>>() / mass;
    let tensor = points
        .iter()
        .map(|(m, r)| {
            let d = r - centre;
            *m * (Matrix3::identity() * d.norm_squared() - d * d.transpose())
        })
        .sum();
    (tensor, centre, mass)
}

/// A rigid body that turns freely, by Euler's equations and the quaternion of its attitude. They are
/// integrated by the classical Runge-Kutta method with a step whose halving changes nothing (checked by the
/// caller).
fn turned(tensor: Matrix3<f64>, spin: Vector3<f64>, t: f64, steps: usize) -> UnitQuaternion<f64> {
    // In the frame of the start, which is the body frame.
    let inverse = tensor.try_inverse().unwrap_or_else(Matrix3::zeros);
    let h = t / steps as f64;
    let (mut w, mut q) = (spin, Quaternion::identity());
    let rate = |w: Vector3<f64>, q: Quaternion<f64>| {
        let dq = q * Quaternion::from_imag(w) * 0.5;
        (inverse * (tensor * w).cross(&w), dq)
    };
    for _ in 0..steps {
        let (a1, b1) = rate(w, q);
        let (a2, b2) = rate(w + 0.5 * h * a1, q + b1 * (0.5 * h));
        let (a3, b3) = rate(w + 0.5 * h * a2, q + b2 * (0.5 * h));
        let (a4, b4) = rate(w + h * a3, q + b3 * h);
        w += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        q += (b1 + b2 * 2.0 + b3 * 2.0 + b4) * (h / 6.0);
    }
    UnitQuaternion::from_quaternion(q)
}

const SPIN: [f64; 3] = [1.0, 3.0, 0.5];

/// Positions turning with the spin about the centre of mass.
fn spinning(sheet: &Sheet, centre: Vector3<f64>) -> State {
    let x = sheet.positions().to_vec();
    let v = x
        .chunks(3)
        .flat_map(|p| {
            let v = Vector3::from(SPIN).cross(&(Vector3::from_column_slice(p) - centre));
            [v.x, v.y, v.z]
        })
        .collect();
    State::moving(x, v)
}

/// Where the vertices are after the rotation.
fn carried(sheet: &Sheet, centre: Vector3<f64>, q: &UnitQuaternion<f64>) -> Vec<f64> {
    sheet
        .positions()
        .chunks(3)
        .flat_map(|p| {
            let r = centre + q * (Vector3::from_column_slice(p) - centre);
            [r.x, r.y, r.z]
        })
        .collect()
}

/// Vertex masses and positions.
fn points(sheet: &Sheet, masses: &[f64]) -> Vec<(f64, Vector3<f64>)> {
    masses
        .iter()
        .zip(sheet.positions().chunks(3))
        .map(|(m, p)| (*m, Vector3::from_column_slice(p)))
        .collect()
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

/// Largest change of a fold angle, radians.
fn bending(sheet: &Sheet, x: &[f64]) -> f64 {
    let t = sheet.topology();
    t.edge_ids()
        .filter_map(|e| {
            let d = fold_angle(t, x, e)? - fold_angle(t, sheet.positions(), e)?;
            Some(d.sin().atan2(d.cos()).abs())
        })
        .fold(0.0, f64::max)
}

/// Why the conservative methods refuse some rigid meshes.
const DEPENDENT: &str = "The rods at a vertex inside a flat side are dependent for ever, and loaded by its own inertia: the conservative methods solve for rod \
                         forces, which are not unique or unbounded there, and refuse. The damped methods do not need them.";

fn closed(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let steps = effort.pick(100, 1000, 10_000);
    let h = 2e-3;
    let solids = [
        ("tetrahedron", tetrahedron()?, 1e-9),
        ("icosahedron", icosahedron()?, 1e-9),
        // Moving the middle of a side by d strains its rods by d^2. Lengths therefore determine positions
        // to the square root of the strain.
        ("box with a vertex inside every side", boxed()?, 1e-5),
    ];
    let mut rows = Vec::new();
    for (what, sheet, bound) in &solids {
        let masses = vec![0.1; sheet.topology().vertex_count()];
        let model = || {
            SheetModel::with_mass(sheet, MassMatrix::from_vertex_masses(masses.clone())?)
                .map_err(anyhow::Error::from)
        };
        let (tensor, centre, _) = inertia(&points(sheet, &masses));
        let start = spinning(sheet, centre);
        let dof = Dof::of(sheet.topology());
        rows.push(vec![
            (*what).to_owned(),
            format!(
                "{}/{}",
                sheet.topology().vertex_count(),
                sheet.topology().face_count()
            ),
            dof.total.to_string(),
            dof.internal.to_string(),
        ]);
        let (mut x, mut v) = (start.x.clone(), start.v.clone());
        let m = model()?;
        let mut ended = None;
        for k in 0..steps {
            if let Err(e) = textbook_step(&m, &mut x, &mut v, h) {
                ended = Some(format!("step {}: {e}", k + 1));
                break;
            }
        }
        let bent = bending(sheet, &x);
        f.naive(
            &format!("{TEXTBOOK}, on the {what}"),
            ended.clone().map_or_else(
                || {
                    format!(
                        "After {steps} steps of 2 ms the largest fold angle has changed by {} rad.",
                        number(bent)
                    )
                },
                |e| format!("{e}."),
            ),
            ended.is_some() || bent > *bound,
        );
        let (mut x, mut v) = (start.x.clone(), start.v.clone());
        for _ in 0..steps {
            super::naive::gauss_seidel_step(&m, &mut x, &mut v, h);
        }
        let (tensor_, spin) = (tensor, Vector3::from(SPIN));
        let fine = turned(tensor_, spin, h * steps as f64, 20 * steps);
        let coarse = turned(tensor_, spin, h * steps as f64, 10 * steps);
        let exact = carried(sheet, centre, &fine);
        let reference = apart(&exact, &carried(sheet, centre, &coarse));
        for (name, method) in methods() {
            interrupt::check()?;
            let mut run = Simulation::new(model()?, start.clone(), method)?;
            let mut bent = 0.0_f64;
            let mut n = 0;
            let c = course(&mut run, h, steps, |_, s| {
                n += 1;
                if n % 50 == 0 {
                    bent = bent.max(bending(sheet, &s.x));
                }
            })?;
            f.at_most(
                format!("{what}, {name}: largest change of a fold angle in {steps} steps, rad"),
                c.if_finished(bent),
                *bound,
            )
            .ended(&c);
            // Measured: 1.2e-7 s, 0.068 s, 0 s.
            let stops = match name {
                "energy-momentum" => Some([0.0, 1e-4]),
                "RATTLE" => Some([0.02, 0.15]),
                "RATTLE composition" => Some([0.0, 1e-3]),
                _ => None,
            };
            let dependent = stops
                .filter(|_| what.starts_with("box"))
                .map(|at| Shortfall::stops(at, "the length constraints are dependent"));
            let declare = |f: &mut Findings| {
                if let (Some(check), Some(declared)) = (f.checks.last_mut(), &dependent) {
                    check.limited(DEPENDENT, declared.clone());
                }
            };
            declare(&mut f);
            if name == "RATTLE composition" {
                // Fourth order: the spin of 3 rad/s turns by 6e-3 rad in a step.
                f.at_most(
                    format!("{what}, {name}: distance from Euler's rigid body (reference good to {}), m", number(reference)),
                    c.if_finished(apart(&run.state().x, &exact)),
                    1e-6,
                )
                .ended(&c);
                declare(&mut f);
            }
            if name == "energy-momentum" {
                f.at_most(
                    format!("{what}, {name}: energy error, of the kinetic energy"),
                    c.if_finished(c.drift / c.kinetic),
                    1e-10,
                )
                .ended(&c);
                declare(&mut f);
            }
        }
    }
    f.table(
        "Closed meshes",
        &["mesh", "V/F", "3V − E", "internal DOF by counting"],
        rows,
    );
    f.here = "Free spin of 3.2 rad/s about no principal axis, steps of 2 ms. The reference integrates Euler's equations and a quaternion.".into();
    Ok(f)
}

pub(crate) const PLATE: Case = Case {
    name: "plate",
    title: "Lumped and consistent mass against the rigid plate",
    expected: "A uniform rigid plate has the rotary inertia of its area. The consistent mass matrix gives it exactly. Lumping a third of every face \
               at its corners, as the paper does, gives a triangle four times the inertia about its centroid: it swings slower, and stays \
               the default only because it is the paper's.",
    run: plate,
};

fn plate(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    // A uniform triangle about its edge: a pendulum of half the altitude. Lumped: of the whole altitude.
    let altitude: f64 = 0.7;
    let (s, c) = 1.2_f64.sin_cos();
    let x = vec![
        0.0,
        -0.3,
        0.0,
        0.0,
        0.5,
        0.0,
        altitude * s,
        0.1,
        -altitude * c,
    ];
    let sheet = Sheet::new(x.clone(), &[[0, 1, 2]])?;
    let exact = |length: f64, t: f64| {
        let k = 0.6_f64.sin();
        let (sn, _, _) = jacobi(complete_k(k * k) - t * (9.8 / length).sqrt(), k * k);
        2.0 * (k * sn).asin()
    };
    let end = 2.0;
    let angle = |kind, steps: usize| -> Result<(f64, Vec<[f64; 2]>)> {
        let model = SheetModel::new(&sheet, 0.3, kind)?
            .with_gravity()
            .with_pins(&[VertexId(0), VertexId(1)])?;
        let mut run = Simulation::new(
            model,
            State::at_rest(x.clone()),
            Method::RattleComposition(Default::default()),
        )?;
        let mut curve = vec![[0.0, 1.2]];
        course(&mut run, end / steps as f64, steps, |r, s| {
            curve.push([r.t, s.x[6].atan2(-s.x[8])]);
        })?;
        Ok((curve[curve.len() - 1][1], curve))
    };
    let (lumped, lumped_curve) = angle(MassKind::Lumped, 400)?;
    let (consistent, consistent_curve) = angle(MassKind::Consistent, 400)?;
    let plate = exact(0.5 * altitude, end);
    f.naive(
        "Lumped mass, a triangle held at an edge",
        format!(
            "It swings as a pendulum of its altitude, not of half of it: its period is {:.3} of the plate's; after 2 s it is {} rad away from it.",
            2.0_f64.sqrt(),
            number((lumped - plate).abs())
        ),
        (lumped - plate).abs() > 0.1,
    );
    f.at_most(
        "held triangle, consistent mass: angle error after 2 s, rad",
        (consistent - plate).abs(),
        1e-7,
    );
    f.at_most(
        "held triangle, lumped mass: error against the pendulum of the whole altitude, rad",
        (lumped - exact(altitude, end)).abs(),
        1e-7,
    );
    // A free shell: the products of inertia of a uniform one against those of its lumped masses.
    let sheet = tetrahedron()?;
    let mass = 0.4;
    let (tensor, centre, _) = inertia(&shell(&sheet, mass));
    let steps_of = |n: usize| 20 * n;
    let counts = effort.pick(
        vec![100, 200],
        vec![100, 200, 400, 800],
        vec![100, 200, 400, 800, 1600],
    );
    let run = |kind: MassKind, method: Method, n: usize| -> Result<f64> {
        let model = SheetModel::new(&sheet, mass, kind)?;
        let mut run = Simulation::new(model, spinning(&sheet, centre), method)?;
        let c = course(&mut run, end / n as f64, n, |_, _| {})?;
        let q = turned(tensor, Vector3::from(SPIN), end, steps_of(n.max(1000)));
        Ok(c.if_finished(apart(&run.state().x, &carried(&sheet, centre, &q))))
    };
    let mut errors = Vec::new();
    let mut lines = Vec::new();
    for (k, (name, method)) in conservative().into_iter().enumerate() {
        let list = counts
            .iter()
            .map(|n| run(MassKind::Consistent, method.clone(), *n))
            .collect::<Result<Vec<f64>>>()?;
        let points = counts
            .iter()
            .zip(&list)
            .map(|(n, e)| [1e3 * end / *n as f64, *e])
            .collect();
        lines.push(plot::series(k, &format!("consistent, {name}"), points));
        errors.push((name, list));
    }
    let lumped: Vec<f64> = counts
        .iter()
        .map(|n| run(MassKind::Lumped, conservative()[2].1.clone(), *n))
        .collect::<Result<_>>()?;
    let points = counts
        .iter()
        .zip(&lumped)
        .map(|(n, e)| [1e3 * end / *n as f64, *e])
        .collect();
    lines.push(plot::series(3, "lumped, RATTLE composition", points));
    f.naive(
        "Lumped mass, a free tetrahedral shell",
        format!(
            "After 2 s of tumbling its vertices are {} m from those of the uniform shell with the same spin at the start, at any step.",
            number(lumped[lumped.len() - 1])
        ),
        lumped[lumped.len() - 1] > 1e-3,
    );
    for (name, list) in &errors {
        let want = if *name == "RATTLE composition" {
            4.0
        } else {
            2.0
        };
        f.at_least(
            format!("free shell, consistent mass, {name}: order of convergence to Euler's rigid body (exact: {want})"),
            orders(list)[0],
            want - 0.3,
        );
    }
    f.at_most(
        "free shell, consistent mass, RATTLE composition: smallest error, m",
        errors[2].1.iter().copied().fold(f64::INFINITY, f64::min),
        effort.pick(1e-4, 1e-6, 1e-6),
    );
    f.at_most(
        "free shell, energy-momentum at 10 ms: edge strain",
        {
            let model = SheetModel::new(&sheet, mass, MassKind::Consistent)?;
            let mut run =
                Simulation::new(model, spinning(&sheet, centre), conservative()[0].1.clone())?;
            course(&mut run, 1e-2, 100, |_, _| {})?.strain
        },
        STRAIN,
    );
    f.here = "Both mass matrices are there; scenes say which one they use. The reference for the shell integrates Euler's equations with the inertia of \
              the uniform faces (a quadrature, not the mass matrix) and a quaternion."
        .into();
    let swing = crate::draw::Plot {
        x: crate::draw::Axis::round("time, s", [0.0, end], 4),
        y: crate::draw::Axis::round("angle, rad", [-1.5, 1.5], 6),
        size: [230.0, 120.0],
        series: vec![
            plot::curve(1, "lumped", lumped_curve),
            plot::curve(0, "consistent", consistent_curve),
            plot::guide(
                "uniform plate",
                (0..=200)
                    .map(|k| {
                        [
                            0.01 * f64::from(k),
                            exact(0.5 * altitude, 0.01 * f64::from(k)),
                        ]
                    })
                    .collect(),
            ),
        ],
        legend: crate::draw::Legend::Right,
    };
    f.drawing(
        "plate-held",
        &swing.draw(),
        "A triangle held at an edge: angle over time, and the exact motion of the uniform plate",
    )?;
    f.drawing(
        "plate-free",
        &plot::log_log("step, ms", "position error after 2 s, m", lines),
        "A free tetrahedral shell against Euler's rigid body",
    )?;
    Ok(f)
}
