//! Gas in a pillow of a given form.

use super::experiment::{Experiment, Job, Measured, Quantity};
use anyhow::Result;
use isosheet_dynamics::{EnclosedGas, Gas, LoadedFaces};
use isosheet_mesh::{FaceId, Sheet, VertexId};
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

/// Two sheets whose rims are joined, which vertices are below, and the pairs of the rim.
fn pillow(flat: &Sheet) -> Result<(Sheet, Vec<bool>, Vec<[VertexId; 2]>)> {
    let t = flat.topology();
    let count = t.vertex_count();
    let below: Vec<bool> = (0..2 * count).map(|v| v >= count).collect();
    let both = Sheet::union(&[flat, flat])?;
    let arched = arched(both.positions(), &below, HEIGHT);
    let rim = t.vertex_ids().filter(|v| t.is_boundary_vertex(*v));
    let pairs = rim.map(|v| [v, VertexId::from_index(count + v.index())]);
    Ok((
        Sheet::new(arched, &both.face_indices())?,
        below,
        pairs.collect(),
    ))
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
    let (sheet, below, pairs) = pillow(&job.rectangle(SIZE)?)?;
    let x = sheet.positions();
    let all: Vec<FaceId> = sheet.topology().face_ids().collect();
    let faces = LoadedFaces::new(sheet.topology(), &all, &pairs)?;
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
