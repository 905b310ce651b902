//! Sheets that are pulled: here the stiffness in the plane counts.

use super::experiment::{Experiment, Job, Measured, Quantity};
use super::rest::Rest;
use super::specimen::{Line, with_plate};
use crate::runs::meshes::vertices;
use anyhow::Result;
use isosheet_dynamics::{Material, PlateBending, Profile, SheetModel};
use std::f64::consts::PI;

/// Office paper that does not contract across, so that closed forms of strips hold whatever their width.
fn paper() -> Material {
    let mut paper = Material::office_paper();
    paper.poisson = 0.0;
    paper
}

/// A pull.
pub(super) const PULLED: Experiment = Experiment {
    name: "pulled-strip",
    title: "Strip of paper that is pulled",
    source: "Hooke's law, F L / (E h w)",
    about: "A strip of office paper of 0.3 m x 0.06 m without supports, pulled at both ends with 1 N: its extension, \
            and how much its middle third contracts across (Poisson's ratio 0.3).",
    quantities: || {
        let Material {
            stiffness, poisson, ..
        } = Material::office_paper();
        let [length, width] = STRIP;
        let strain = 1.0 / (stiffness * width);
        vec![
            Quantity::new("extension, m", strain * length),
            Quantity::new("contraction, m", poisson * strain * width),
        ]
    },
    measure: pulled,
};

const STRIP: [f64; 2] = [0.3, 0.06];

fn pulled(job: Job) -> Result<Measured> {
    let [length, width] = STRIP;
    let sheet = job.rectangle(STRIP)?;
    let model = SheetModel::of_material(&sheet, &Material::office_paper()).build()?;
    let ends = [0.0, length].map(|x| Line::at(&sheet, 0, x));
    let sides = [0.0, width].map(|y| {
        let is_there = |p: [f64; 3]| (p[1] - y).abs() < 1e-9 && (0.1..0.2).contains(&p[0]);
        Line::new(&sheet, is_there)
    });
    let model = model
        .with_force(ends[0].load(1.0, [-1.0, 0.0, 0.0])?)
        .with_force(ends[1].load(1.0, [1.0, 0.0, 0.0])?);
    let mut rest = Rest::new(&sheet, 1e-5, 0.1);
    rest.under(model)?;
    let extension = ends[1].moved(&sheet, &rest.x, 0) - ends[0].moved(&sheet, &rest.x, 0);
    let contraction = sides[0].moved(&sheet, &rest.x, 1) - sides[1].moved(&sheet, &rest.x, 1);
    Ok(Measured::at_rest(&rest, vec![extension, contraction]))
}

/// Length between the edges that are pinned, width, metres; acceleration of gravity, m/s2.
const SPAN: [f64; 2] = [0.2, 0.05];
const GRAVITY: f64 = 9.81;

/// A sag.
pub(super) const SAGGING: Experiment = Experiment {
    name: "sagging-paper",
    title: "Paper pinned at two edges",
    source: "Cylindrical bending with tension (Timoshenko and Woinowsky-Krieger 1959, chapter 1)",
    about: "Office paper, Poisson's ratio 0, 0.2 m long, pinned at two edges that do not approach each other: how far \
            it sags under its weight.",
    quantities: || {
        let Material {
            stiffness,
            rigidity,
            density,
            ..
        } = paper();
        let sag = sag(SPAN[0], density * GRAVITY, stiffness, rigidity);
        vec![Quantity::new("sag, m", sag)]
    },
    measure: sagging,
};

/// The sag of a strip between hinges that do not move, metres: the tension `N` satisfies `N / (E h) = 1/(2 L)
/// int w'^2 dx` with `w' = q / N (x - sinh(k x) / (k cosh(k L / 2)))`, `k^2 = N / D`, `x` from the middle.
fn sag(length: f64, load: f64, stiffness: f64, rigidity: f64) -> f64 {
    let half = 0.5 * length;
    let extension = |tension: f64| {
        let k = (tension / rigidity).sqrt();
        // `sinh(k x) / cosh(k L / 2)` by exponentials that do not overflow.
        let ratio = |x: f64| {
            let (near, far) = ((-2.0 * k * x).exp(), (-2.0 * k * half).exp());
            (k * (x - half)).exp() * (1.0 - near) / (1.0 + far)
        };
        let slope = |x: f64| load / tension * (x - ratio(x) / k);
        let panels = 2000;
        let h = half / f64::from(panels);
        // Simpson's rule over a half.
        let sum = (0..panels).map(|i| {
            let a = h * f64::from(i);
            let [p, q, r] = [a, a + 0.5 * h, a + h].map(|x| slope(x).powi(2));
            h / 6.0 * (p + 4.0 * q + r)
        });
        sum.sum::<f64>() / length
    };
    let (mut low, mut high) = (1e-6_f64, 1e6_f64);
    for _ in 0..200 {
        let tension = (low * high).sqrt();
        if tension / stiffness < extension(tension) {
            low = tension;
        } else {
            high = tension;
        }
    }
    let (tension, k) = (low, (low / rigidity).sqrt());
    let shape = half * half / 2.0 - (1.0 - 1.0 / (k * half).cosh()) / (k * k);
    load / tension * shape
}

fn sagging(job: Job) -> Result<Measured> {
    let [length, width] = SPAN;
    let sheet = job.rectangle([length, width])?;
    let sheet = crate::runs::meshes::with_line(&sheet, 0.5 * length, width / job.across as f64)?;
    let pins = vertices(&sheet, |[x, ..]| x < 1e-9 || x > length - 1e-9);
    let plate = PlateBending::new(&sheet, &paper())?;
    let model = with_plate(&sheet, &paper(), &pins, plate)?;
    let mut rest = Rest::new(&sheet, 1e-3, 0.5);
    rest.under(model.with_acceleration([0.0, 0.0, -GRAVITY]))?;
    let sag = -Line::at(&sheet, 0, 0.5 * length).mean(&rest.x, 2);
    Ok(Measured::at_rest(&rest, vec![sag]))
}

/// Length and width of the ribbon, metres; turns of its end.
const RIBBON: [f64; 2] = [0.3, 0.01];
const TURNS: [f64; 2] = [0.5, 1.0];

/// A twist.
pub(super) const TWISTED: Experiment = Experiment {
    name: "twisted-ribbon",
    title: "Ribbon that is twisted",
    source: "Helicoid, E h w^3 (turn / L)^2 / 24 (Green 1936)",
    about: "A ribbon of 0.3 m x 0.01 m of office paper whose ends are held at their distance and turned against each \
            other: the force along it. (Its limit of strain is 5 %: that of paper would add a force.)",
    quantities: || {
        let [length, width] = RIBBON;
        let of = |turns: f64| {
            let twist = 2.0 * PI * turns / length;
            let force = Material::office_paper().stiffness * width.powi(3) * twist * twist / 24.0;
            Quantity::new(format!("force after {turns} turns, N"), force)
        };
        TURNS.map(of).to_vec()
    },
    measure: twisted,
};

/// Steps over which an end turns.
const TURNING: f64 = 20.0;

fn twisted(job: Job) -> Result<Measured> {
    let [length, width] = RIBBON;
    let sheet = job.rectangle([length, width])?;
    let ends = vertices(&sheet, |[x, ..]| x < 1e-9 || x > length - 1e-9);
    let mut material = Material::office_paper();
    material.strain_limit = 0.05;
    let mut rest = Rest::new(&sheet, width, 0.5);
    let (mut values, mut before) = (Vec::new(), 0.0);
    for turns in TURNS {
        let plate = PlateBending::new(&sheet, &material)?;
        let mut model = with_plate(&sheet, &material, &ends, plate)?;
        let angle = Profile::SmoothStep {
            from: 2.0 * PI * before,
            to: 2.0 * PI * turns,
            begin: 0.0,
            end: TURNING * rest.step,
        };
        for &v in &ends {
            let [x, y, _] = sheet.position(v);
            if x > 0.5 * length {
                let (angle, y) = (angle.clone(), y - 0.5 * width);
                model = model.with_moving_pin(v, move |t| {
                    let (s, c) = angle.value(t).sin_cos();
                    [x, 0.5 * width + y * c, y * s]
                })?;
            }
        }
        let mut force = f64::NAN;
        rest.then(model, |simulation| {
            let all = simulation.reactions().into_iter();
            let at_end = all.filter(|r| sheet.position(r.support.vertex())[0] > 0.5 * length);
            force = at_end.map(|r| r.force.x).sum();
        })?;
        values.push(force);
        before = turns;
    }
    Ok(Measured::at_rest(&rest, values))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without rigidity a parabola: `s^3 = 3 q L^4 / (64 E h)`.
    #[test]
    fn a_limp_sheet_sags_as_a_parabola() {
        let (length, load, stiffness) = (0.2_f64, 0.7848, 3e5);
        let parabola = (3.0 * load * length.powi(4) / (64.0 * stiffness)).cbrt();
        let found = sag(length, load, stiffness, 1e-9);
        assert!((found / parabola - 1.0).abs() < 1e-3, "{found} {parabola}");
        // With so much rigidity that tension does nothing it is a beam, 5 q L^4 / (384 D).
        let beam = 5.0 * load * length.powi(4) / (384.0 * 1e3);
        let found = sag(length, load, 1e13, 1e3);
        assert!((found / beam - 1.0).abs() < 1e-3, "{found} {beam}");
    }
}
