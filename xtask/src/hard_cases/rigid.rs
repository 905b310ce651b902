//! Meshes that cannot bend.

use super::naive::{TEXTBOOK, textbook_step};
use super::scenes::{apart, course};
use super::spin::{SPIN, carried, inertia, spinning, turned};
use super::{Case, Findings, Shortfall};
use crate::interrupt;
use crate::methods::methods;
use crate::report::Effort;
use crate::report::number;
use anyhow::Result;
use isosheet_dynamics::{SheetModel, Simulation, State};
use isosheet_mesh::{Dof, MassMatrix, Sheet, fold_angle};
use nalgebra::Vector3;

pub(crate) const CLOSED: Case = Case {
    name: "closed",
    title: "Closed and rigid meshes",
    expected: "A closed surface has six degrees of freedom: it turns as Euler's rigid body and nothing bends, also where rods are dependent \
               without being able to move, as at a vertex inside a flat side.",
    run: closed,
};

/// Its vertices, metres.
const TETRAHEDRON: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.1, 0.0],
    [0.2, 0.8, 0.1],
    [0.3, 0.2, 0.9],
];

/// A tetrahedron without symmetry.
pub(super) fn tetrahedron() -> Result<Sheet> {
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

/// Vertex masses and positions.
fn points(sheet: &Sheet, masses: &[f64]) -> Vec<(f64, Vector3<f64>)> {
    masses
        .iter()
        .zip(sheet.positions().chunks(3))
        .map(|(m, p)| (*m, Vector3::from_column_slice(p)))
        .collect()
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

/// Length of a step, seconds.
const STEP: f64 = 2e-3;

/// A mesh that spins freely.
struct Solid {
    name: &'static str,
    sheet: Sheet,
    /// Largest change of a fold angle that counts as none, radians.
    bound: f64,
}

impl Solid {
    fn model(&self) -> Result<SheetModel> {
        let masses = MassMatrix::from_vertex_masses(self.masses())?;
        Ok(SheetModel::with_mass(&self.sheet, masses)?)
    }

    /// Vertex masses, kilograms.
    fn masses(&self) -> Vec<f64> {
        vec![0.1; self.sheet.topology().vertex_count()]
    }
}

fn closed(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let steps = effort.pick(100, 1000, 10_000);
    let mut rows = Vec::new();
    for (name, sheet, bound) in [
        ("tetrahedron", tetrahedron()?, 1e-9),
        ("icosahedron", icosahedron()?, 1e-9),
        // Moving the middle of a side by d strains its rods by d^2. Lengths therefore determine positions
        // to the square root of the strain.
        ("box with a vertex inside every side", boxed()?, 1e-5),
    ] {
        let (topology, dof) = (sheet.topology(), Dof::of(sheet.topology()));
        rows.push(vec![
            name.to_owned(),
            format!("{}/{}", topology.vertex_count(), topology.face_count()),
            dof.total.to_string(),
            dof.internal.to_string(),
        ]);
        let solid = Solid { name, sheet, bound };
        textbook_spin(&mut f, &solid, steps)?;
        spin(&mut f, &solid, steps)?;
    }
    f.table(
        "Closed meshes",
        &["mesh", "V/F", "3V − E", "internal DOF by counting"],
        rows,
    );
    f.here = "Free spin of 3.2 rad/s about no principal axis, steps of 2 ms. The reference integrates Euler's equations and a quaternion.".into();
    Ok(f)
}

/// What the textbook method makes of the spin.
fn textbook_spin(f: &mut Findings, solid: &Solid, steps: usize) -> Result<()> {
    let model = solid.model()?;
    let (_, centre, _) = inertia(&points(&solid.sheet, &solid.masses()));
    let State { mut x, mut v, .. } = spinning(&solid.sheet, centre);
    let mut ended = None;
    for k in 0..steps {
        if let Err(e) = textbook_step(&model, &mut x, &mut v, STEP) {
            ended = Some(format!("step {}: {e}", k + 1));
            break;
        }
    }
    let bent = bending(&solid.sheet, &x);
    let text = match &ended {
        Some(e) => format!("{e}."),
        None => format!(
            "After {steps} steps of 2 ms the largest fold angle has changed by {} rad.",
            number(bent)
        ),
    };
    f.naive(
        &format!("{TEXTBOOK}, on the {}", solid.name),
        text,
        ended.is_some() || bent > solid.bound,
    );
    Ok(())
}

/// All methods against Euler's rigid body.
fn spin(f: &mut Findings, solid: &Solid, steps: usize) -> Result<()> {
    let Solid { name: what, .. } = *solid;
    let sheet = &solid.sheet;
    let (tensor, centre, _) = inertia(&points(sheet, &solid.masses()));
    let duration = STEP * steps as f64;
    let euler = |n| {
        let turn = turned(tensor, SPIN.into(), duration, n * steps);
        carried(sheet, centre, &turn)
    };
    let exact = euler(20);
    let reference = apart(&exact, &euler(10));
    for (name, method) in methods() {
        interrupt::check()?;
        let mut run = Simulation::new(solid.model()?, spinning(sheet, centre), method)?;
        let mut bent = 0.0_f64;
        let mut n = 0_usize;
        let c = course(&mut run, STEP, steps, |_, s| {
            n += 1;
            if n.is_multiple_of(50) {
                bent = bent.max(bending(sheet, &s.x));
            }
        })?;
        f.at_most(
            format!("{what}, {name}: largest change of a fold angle in {steps} steps, rad"),
            c.if_finished(bent),
            solid.bound,
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
        declare(f);
        if name == "RATTLE composition" {
            // Fourth order: the spin of 3 rad/s turns by 6e-3 rad in a step.
            f.at_most(
                format!(
                    "{what}, {name}: distance from Euler's rigid body (reference good to {}), m",
                    number(reference)
                ),
                c.if_finished(apart(&run.state().x, &exact)),
                1e-6,
            )
            .ended(&c);
            declare(f);
        }
        if name == "energy-momentum" {
            f.at_most(
                format!("{what}, {name}: energy error, of the kinetic energy"),
                c.if_finished(c.drift / c.kinetic),
                1e-10,
            )
            .ended(&c);
            declare(f);
        }
    }
    Ok(())
}
