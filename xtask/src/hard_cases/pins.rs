//! Too many pins, and sheets pulled taut.

use super::naive::{GAUSS_SEIDEL, SWEEPS, gauss_seidel};
use super::scenes::{FRAME, apart, at_rest, go, pinned, top_row, upright};
use super::{Case, Findings, Work};
use crate::report::{Bound, Effort, Shortfall, number};
use crate::runs::bumped;
use anyhow::Result;
use isosheet_dynamics::{Potential, PotentialShape, SheetModel};
use isosheet_mesh::{MassMatrix, Sheet, VertexId, generate};
use isosheet_tests::methods;

/// What a naive method does to a flat sheet that is held all around.
pub(super) fn over_pinned(f: &mut Findings, effort: Effort) -> Result<()> {
    let (n, steps) = (5, effort.pick(15, 60, 240));
    let is_outer = |k: u32| k == 0 || k == n - 1;
    let on_boundary = |v: &VertexId| is_outer(v.0 % n) || is_outer(v.0 / n);
    let pins: Vec<VertexId> = (0..n * n).map(VertexId).filter(on_boundary).collect();
    let flat = bumped(1, 0.0);
    let start = flat.positions();
    let exact = Bound::AtMost(1e-6);
    let (strain, x) = gauss_seidel(&pinned(&flat, &pins)?, start, FRAME, steps, SWEEPS);
    let what = format!("flat M^1 held all around, {steps} steps of 1/60 s");
    f.naive(GAUSS_SEIDEL, format!("{what}: edge strain"), strain, exact);
    f.naive(
        GAUSS_SEIDEL,
        format!("{what}: displacement, m"),
        apart(&x, start),
        exact,
    );
    Ok(())
}

pub(crate) const TAUT: Case = Case {
    name: "taut",
    title: "Taut sheet pulled hard",
    expected: "A strip held at one end and pulled at the other with a million times its weight stays as long as it is, and swings as a taut string does.",
    run: Work::Code(taut),
};

/// A constant force on some vertices: a potential linear in the positions.
#[derive(Debug)]
struct Pull {
    vertices: Vec<VertexId>,
    force: [f64; 3],
}

impl Potential for Pull {
    fn energy(&self, _t: f64, x: &[f64]) -> f64 {
        let along = |v: &VertexId| {
            let terms = (0..3).map(|k| self.force[k] * x[3 * v.index() + k]);
            terms.sum::<f64>()
        };
        -self.vertices.iter().map(along).sum::<f64>()
    }

    fn add_gradient(&self, _t: f64, _x: &[f64], gradient: &mut [f64]) {
        for v in &self.vertices {
            for k in 0..3 {
                gradient[3 * v.index() + k] -= self.force[k];
            }
        }
    }

    fn shape(&self) -> PotentialShape {
        PotentialShape::Linear
    }
}

/// Why a sheet that is pulled hard is refused next to where it was.
const WITHIN_TOLERANCE: &str = "Vertices can move across a taut rod of length l by l sqrt(2e-12) within the tolerance of the lengths. A step ends there, and the \
                                next ones find no minimum, so that the sheet is refused as locked.";

fn taut(f: &mut Findings, effort: Effort) -> Result<()> {
    let weight = 0.1 * 9.8;
    let steps = effort.pick(20, 120, 600);
    let sheet = upright(&generate::isotropic_square(1, 1.0)?)?;
    let pulled = |factor: f64| -> Result<SheetModel> {
        Ok(pinned(&sheet, &top_row())?.with_potential(Pull {
            vertices: (0..5).map(VertexId).collect(),
            force: [0.0, 0.0, -factor * weight / 5.0],
        }))
    };
    let what = "M^1 held at its top side, pulled down with a million times its weight";
    f.swept(what, &pulled(1e6)?, sheet.positions(), 60);
    for &factor in effort.quick_or(&[1e6][..], &[1.0, 1e3, 1e6]) {
        for (name, method) in methods().take(effort.pick(2, 6, 6)) {
            let (c, end) = go(
                at_rest(pulled(factor)?, sheet.positions(), method)?,
                FRAME,
                steps,
            )?;
            let moved = apart(&end, sheet.positions());
            let pull = number(factor);
            let what = format!("hanging M^1 pulled with {pull} times its weight, {name}");
            let mut judge = f.of(&c, what);
            let what = format!("displacement in {steps} steps, m");
            let check = judge.at_most(&what, moved, 1e-9);
            if name == "BDF2" && factor == 1e6 {
                let stops = Shortfall::stops([0.01, 0.2], "the sheet locks");
                check.limited(WITHIN_TOLERANCE, stops);
            }
        }
    }
    taut_strip(f, 1e6 * weight, effort)?;
    f.here = "Rods have no stiffness to overcome: a pull changes the impulses and nothing else. The taut strip swings as the closed form says.";
    Ok(())
}

/// A taut strip as a string of beads: transverse displacement in its slowest mode.
fn taut_strip(f: &mut Findings, force: f64, effort: Effort) -> Result<()> {
    let links = 10;
    let spacing = 1.0 / links as f64;
    let (mode, frequency) = string_mode(links, force, spacing);
    let amplitude = 1e-6;
    let quarter = 0.25 * std::f64::consts::TAU / frequency;
    let place = |a: f64| -> Vec<f64> {
        let (mut x, mut last) = (vec![0.0, 0.0, 0.0, 0.0, 0.3, 0.0], (0.0, 0.0));
        for &m in &mode {
            let z = a * m;
            let along = last.0 + (spacing * spacing - (z - last.1).powi(2)).sqrt();
            x.extend([along, 0.0, z, along, 0.3, z]);
            last = (along, z);
        }
        x
    };
    let pairs = (0..2 * links as u32).step_by(2);
    let faces = pairs.flat_map(|i| [[i, i + 2, i + 1], [i + 1, i + 2, i + 3]]);
    let strip = Sheet::new(place(0.0), &faces.collect::<Vec<_>>())?;
    for (name, method) in methods() {
        let mass = MassMatrix::from_vertex_masses(vec![BEAD; 2 * links + 2])?;
        let last = 2 * links as u32;
        let model = SheetModel::with_mass(&strip, mass)?
            .with_pins(&[VertexId(0), VertexId(1)])?
            .with_potential(Pull {
                vertices: vec![VertexId(last), VertexId(last + 1)],
                force: [0.5 * force, 0.0, 0.0],
            });
        let n = effort.pick(100, 400, 400);
        let run = at_rest(model, &place(amplitude), method)?;
        let (c, end) = go(run, quarter / n as f64, n)?;
        // After a quarter period the strip is straight.
        let heights = end.chunks(3).map(|p| p[2].abs());
        let off = heights.fold(0.0, f64::max) / amplitude;
        let is_first = ["implicit Euler", "projection"].contains(&name);
        let quantity = "error of the slowest mode after a quarter period, of its amplitude";
        f.of(&c, format!("taut strip of {links} links, {name}"))
            .at_most(quantity, off, if is_first { 2e-2 } else { 2e-3 });
        f.of(&c, format!("taut strip, {name}"))
            .strain("edge strain");
    }
    Ok(())
}

/// Mass of each vertex of the strip, kilograms.
const BEAD: f64 = 0.01;

/// Slowest transverse mode and its frequency of a string with beads, of tension `force` / 2 in each column,
/// fixed at one end and free at the other: `m w^2 = (F / L) x` with x the smallest eigenvalue of the
/// second-difference matrix with one free end, `x = 4 sin^2(pi / (4 n + 2))`, displacement of bead k
/// proportional to `sin(k pi / (2 n + 1))`.
fn string_mode(n: usize, force: f64, spacing: f64) -> (Vec<f64>, f64) {
    let angle = std::f64::consts::PI / (2 * n + 1) as f64;
    let x = 4.0 * (0.5 * angle).sin().powi(2);
    let last = (n as f64 * angle).sin();
    let mode = (1..=n).map(|k| (k as f64 * angle).sin() / last).collect();
    (mode, (x * 0.5 * force / (spacing * BEAD)).sqrt())
}
