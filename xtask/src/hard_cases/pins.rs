//! Too many pins, and sheets pulled taut.

use super::naive::{GAUSS_SEIDEL, TEXTBOOK, gauss_seidel, textbook};
use super::scenes::{FRAME, STRAIN, apart, at_rest, course, pinned, upright};
use super::{Case, Findings, Shortfall};
use crate::methods::{damped, methods};
use crate::report::Effort;
use crate::report::number;
use crate::timing::bumped;
use anyhow::Result;
use isosheet_dynamics::{Potential, PotentialShape, SheetModel, Simulation};
use isosheet_mesh::{VertexId, generate};

pub(crate) const OVER_PINNED: Case = Case {
    name: "over-pinned",
    title: "Over-constrained pins",
    expected: "More pins than the sheet has room for leave it where it is, to the last bit where nothing is free, and otherwise as far as rounding tells \
               lengths apart; pins that leave room act as such. Nothing blows up, and a refusal names its reason.",
    run: over_pinned,
};

/// What two taut pins do to every method here.
const NO_ROOM: &str = "The two halves of the sheet fall shut on each other and hang taut, in a state without room: displacements d across \
                    taut rods change lengths by d² only, and the iteration closes in linearly.";

/// What is held, the sheet, its pins, the largest displacement allowed, and why it is known to fail.
type Scene<'a> = (
    &'a str,
    &'a isosheet_mesh::Sheet,
    &'a [VertexId],
    f64,
    Option<&'a str>,
);

fn over_pinned(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let level = 1;
    let n = (2_u32 << level) + 1;
    let all: Vec<VertexId> = (0..n * n).map(VertexId).collect();
    let boundary: Vec<VertexId> = all
        .iter()
        .copied()
        .filter(|v| {
            let (i, j) = (v.0 % n, v.0 / n);
            i == 0 || j == 0 || i == n - 1 || j == n - 1
        })
        .collect();
    let corners = [0, n - 1, n * (n - 1), n * n - 1].map(VertexId);
    let steps = effort.pick(15, 60, 240);
    let flat = bumped(level, 0.0)?;
    let outcome = textbook(&pinned(&flat, &boundary)?, flat.positions(), 1e-3, 1000);
    let (text, failed) = match outcome {
        Ok((strain, x)) => {
            let moved = apart(&x, flat.positions());
            (
                format!(
                    "Flat M^1 held all around, 1000 steps of 1 ms: moves by {} m, strain {}.",
                    number(moved),
                    number(strain)
                ),
                strain > 1e-6,
            )
        }
        Err(e) => (format!("Flat M^1 held all around, {e}."), true),
    };
    f.naive(TEXTBOOK, text, failed);
    let (strain, x) = gauss_seidel(&pinned(&flat, &boundary)?, flat.positions(), FRAME, steps);
    f.naive(
        GAUSS_SEIDEL,
        format!(
            "The same, {steps} steps of 1/60 s: sags by {} m, strain {}.",
            number(apart(&x, flat.positions())),
            number(strain)
        ),
        strain > 1e-6,
    );
    // A sheet with exact room: bumped, held at its four corners, and flat ones without any.
    let bump = bumped(level, 0.1)?;
    let two = [corners[0], corners[1]];
    let opposite = [corners[0], corners[3]];
    let three = [corners[0], corners[1], corners[2]];
    let bent = isosheet_mesh::Sheet::new(
        isosheet_coords::bent_square(&flat, level, isosheet_coords::BentState::Cylinder),
        &flat.face_indices(),
    )?;
    let scenes: [Scene<'_>; 9] = [
        ("everything held", &flat, &all, 0.0, None),
        (
            "bumped, held all around",
            &bump,
            &boundary,
            f64::INFINITY,
            None,
        ),
        (
            "bent to a cylinder, held at three corners",
            &bent,
            &three,
            f64::INFINITY,
            None,
        ),
        (
            "bent to a cylinder, held at four corners",
            &bent,
            &corners,
            f64::INFINITY,
            None,
        ),
        (
            "bumped with straight sides, held at three corners",
            &bump,
            &three,
            f64::INFINITY,
            None,
        ),
        (
            "bumped with straight sides, held at four corners",
            &bump,
            &corners,
            f64::INFINITY,
            None,
        ),
        (
            "flat, held along one side by two corners",
            &flat,
            &two,
            f64::INFINITY,
            None,
        ),
        (
            "flat, held at two opposite corners",
            &flat,
            &opposite,
            f64::INFINITY,
            Some(NO_ROOM),
        ),
        ("flat, held all around", &flat, &boundary, 1e-4, None),
    ];
    for (what, sheet, pins, room, limitation) in scenes {
        for (name, method) in damped() {
            let mut run = at_rest(pinned(sheet, pins)?, sheet.positions(), method)?;
            let c = course(&mut run, FRAME, steps, |_, _| {})?;
            let check = f.at_most(
                format!("{what}, {name}: edge strain in {steps} steps"),
                c.if_finished(c.strain),
                STRAIN,
            );
            check.ended(&c);
            // Measured: BDF2 0.140 s, implicit Euler 0.181 s, projection 0.134 s.
            if let Some(why) = limitation {
                check.limited(why, Shortfall::stops([0.08, 0.4], "no step of at least"));
            }
            if room.is_finite() {
                let moved = apart(&run.state().x, sheet.positions());
                f.at_most(
                    format!("{what}, {name}: largest displacement, m"),
                    c.if_finished(moved),
                    room,
                );
            }
        }
    }
    f.here = "Pinned vertices have no unknowns and never move by a bit; vertices on a straight line of rods between two pins are held as they are."
        .into();
    Ok(f)
}

pub(crate) const TAUT: Case = Case {
    name: "taut",
    title: "Taut sheet pulled hard",
    expected: "A strip held at one end and pulled at the other with a million times its weight stays as long as it is, and swings as a taut string does.",
    run: taut,
};

/// A constant force on some vertices: a potential linear in the positions.
#[derive(Debug)]
struct Pull {
    vertices: Vec<VertexId>,
    force: [f64; 3],
}

impl Potential for Pull {
    fn energy(&self, _t: f64, x: &[f64]) -> f64 {
        -self
            .vertices
            .iter()
            .map(|v| {
                (0..3)
                    .map(|k| self.force[k] * x[3 * v.index() + k])
                    .sum::<f64>()
            })
            .sum::<f64>()
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

fn taut(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();

    let weight = 0.1 * 9.8;
    let steps = effort.pick(20, 120, 600);
    let sheet = upright(&generate::isotropic_square(1, 1.0)?)?;
    let top: Vec<VertexId> = (20..25).map(VertexId).collect();
    let bottom: Vec<VertexId> = (0..5).map(VertexId).collect();
    let pulled = |factor: f64| -> Result<SheetModel> {
        Ok(pinned(&sheet, &top)?.with_potential(Pull {
            vertices: bottom.clone(),
            force: [0.0, 0.0, -factor * weight / 5.0],
        }))
    };
    let (strain, _) = gauss_seidel(&pulled(1e6)?, sheet.positions(), FRAME, 60);
    f.naive(
        GAUSS_SEIDEL,
        format!("M^1 held at its top side, pulled down with a million times its weight: edge strain {}.", number(strain)),
        strain > 1e-2,
    );
    for factor in effort.pick(vec![1e6], vec![1.0, 1e3, 1e6], vec![1.0, 1e3, 1e6]) {
        for (name, method) in methods().take(effort.pick(2, 6, 6)) {
            let mut run = at_rest(pulled(factor)?, sheet.positions(), method)?;
            let c = course(&mut run, FRAME, steps, |_, _| {})?;
            f.at_most(
                format!("hanging M^1 pulled with {} times its weight, {name}: displacement in {steps} steps, m", number(factor)),
                c.if_finished(apart(&run.state().x, sheet.positions())),
                1e-9,
            )
            .ended(&c);
        }
    }
    // A taut strip as a string of beads: transverse displacement in its slowest mode.
    let links = 10;
    let spacing = 1.0 / links as f64;
    let force = 1e6 * weight;
    let (mode, frequency) = string_mode(links, force, spacing);
    let amplitude = 1e-6;
    let period = std::f64::consts::TAU / frequency;
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
    let mut faces = Vec::new();
    for i in (0..2 * links as u32).step_by(2) {
        faces.extend([[i, i + 2, i + 1], [i + 1, i + 2, i + 3]]);
    }
    let strip = isosheet_mesh::Sheet::new(place(0.0), &faces)?;
    for (name, method) in methods() {
        let mass = isosheet_mesh::MassMatrix::from_vertex_masses(vec![BEAD; 2 * links + 2])?;
        let last = 2 * links as u32;
        let model = SheetModel::with_mass(&strip, mass)?
            .with_pins(&[VertexId(0), VertexId(1)])?
            .with_potential(Pull {
                vertices: vec![VertexId(last), VertexId(last + 1)],
                force: [0.5 * force, 0.0, 0.0],
            });
        let mut run = Simulation::new(
            model,
            isosheet_dynamics::State::at_rest(place(amplitude)),
            method,
        )?;
        let n = effort.pick(100, 400, 400);
        let c = course(&mut run, 0.25 * period / n as f64, n, |_, _| {})?;
        // After a quarter period the strip is straight.
        let off = run
            .state()
            .x
            .chunks(3)
            .map(|p| p[2].abs())
            .fold(0.0, f64::max);
        let bound = match name {
            "implicit Euler" | "projection" => 2e-2,
            _ => 2e-3,
        };
        f.at_most(
            format!("taut strip of {links} links, {name}: error of the slowest mode after a quarter period, of its amplitude"),
            c.if_finished(off / amplitude),
            bound,
        )
        .ended(&c);
        f.at_most(
            format!("taut strip, {name}: edge strain"),
            c.if_finished(c.strain),
            STRAIN,
        );
    }

    f.here = format!(
        "Rods have no stiffness to overcome: a pull of {} N changes the impulses and nothing else. The taut strip swings at {:.0} rad/s.",
        number(force),
        frequency
    );
    Ok(f)
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
