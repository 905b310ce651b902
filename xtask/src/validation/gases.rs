//! Gas in a pillow of a given form.

use super::experiment::{Experiment, Job, Measured, Quantity};
use anyhow::Result;
use isosheet_dynamics::{EnclosedGas, Gas, LoadedFaces};
use isosheet_mesh::{Sheet, VertexId};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Length and width, metres, and height of the middle over the rim.
const SIZE: [f64; 2] = [1.5, 1.0];
const HEIGHT: f64 = 0.2;

/// Gases.
pub(super) const ENCLOSED: Experiment = Experiment {
    name: "enclosed-gas",
    title: "Gas in a pillow",
    source: "Volume 2 int h sin(pi x / L) sin(pi y / w) = 8 h L w / pi^2; Boyle 1662 and Poisson 1823, p V^n = const",
    about: "A closed surface whose two sides are arched up and down by h sin(pi x / L) sin(pi y / w), held in that \
            form: its volume, and the pressure of the gas in it (absolute) where h has gone down to a half, \
            isothermal (n = 1) and adiabatic (n = 1.4), over that at the start.",
    quantities: || {
        let volume = Quantity::new("volume pi^2 / (8 h L w)", 1.0);
        let pressures =
            EXPONENTS.map(|n| Quantity::new(format!("p / p1, n = {n}"), 2.0_f64.powf(n)));
        [volume].into_iter().chain(pressures).collect()
    },
    measure: enclosed,
};

const EXPONENTS: [f64; 2] = [1.0, 1.4];

/// Two sheets with a common rim, and which vertices are below.
fn pillow(flat: &Sheet) -> Result<(Sheet, Vec<bool>)> {
    let t = flat.topology();
    let mut x = flat.positions().to_vec();
    let mut below = vec![false; t.vertex_count()];
    let mut under = BTreeMap::new();
    for v in t.vertex_ids() {
        let own = match t.is_boundary_vertex(v) {
            true => v,
            false => {
                x.extend(flat.position(v));
                below.push(true);
                VertexId::from_index(below.len() - 1)
            }
        };
        under.insert(v, own);
    }
    let mut faces = flat.face_indices();
    let lower = t
        .faces()
        .iter()
        .map(|[a, b, c]| [a, c, b].map(|v| under[v].0));
    faces.extend(lower.collect::<Vec<_>>());
    // Before it is arched both sides are in a plane, where edges may coincide: the form gives the rest shape.
    let arched = arched(&x, &below, HEIGHT);
    Ok((Sheet::new(arched, &faces)?, below))
}

/// The positions with another height.
fn arched(x: &[f64], below: &[bool], height: f64) -> Vec<f64> {
    let [length, width] = SIZE;
    let mut x = x.to_vec();
    for (p, below) in x.as_chunks_mut::<3>().0.iter_mut().zip(below) {
        let up = height * (PI * p[0] / length).sin() * (PI * p[1] / width).sin();
        p[2] = if *below { -up } else { up };
    }
    x
}

fn enclosed(job: Job) -> Result<Measured> {
    let [length, width] = SIZE;
    let (sheet, below) = pillow(&job.rectangle(SIZE)?)?;
    let x = sheet.positions();
    let faces = LoadedFaces::all(sheet.topology())?;
    let mut values = Vec::new();
    for exponent in EXPONENTS {
        let gas = Gas {
            exponent,
            ..Gas::default()
        };
        let gas = EnclosedGas::new(&faces, gas, x)?;
        let first = gas.state(0.0, x);
        if values.is_empty() {
            values.push(first.volume * PI * PI / (8.0 * HEIGHT * length * width));
        }
        let pressed = gas.state(0.0, &arched(x, &below, 0.5 * HEIGHT));
        values.push(pressed.pressure / first.pressure);
    }
    Ok(Measured {
        values,
        vertices: x.len() / 3,
        ..Measured::default()
    })
}
