//! Sheets that are not flat without stress.

use super::experiment::{Experiment, Job, Measured, Quantity};
use super::rest::Rest;
use super::specimen::{Line, material};
use crate::runs::meshes::{vertices, with_line};
use anyhow::Result;
use isosheet_dynamics::{Curl, Curvature, MaterialDirection, Profile, SheetModel};
use isosheet_mesh::Sheet;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{PI, TAU};

const POISSON: f64 = 0.3;

/// Natural curvature over the length of the strip, whose width is a quarter.
const ALPHA: f64 = 2.0;
const BROAD: f64 = 0.25;

/// Thicknesses of the strip with natural curvature in both directions.
const THICKNESSES: [f64; 2] = [5e-3, 1e-3];

/// Curls.
pub(super) const CURLED: Experiment = Experiment {
    name: "natural-curvature",
    title: "Sheets with natural curvature",
    source: "Timoshenko 1925; strips whose section bends: Lamb 1890, Ashwell 1950",
    about: "A strip four times as long as wide, clamped at one end, with the natural curvature alpha = 2 / L along it, \
            or in both directions (Poisson's ratio 0.3, a fiftieth and a 250th of the width thick): its curvature over \
            alpha, of the circle through its middle half. In both directions its section is straight but for the edges, \
            which bend over the length (R t)^1/2, and the curvature is 1 + nu where that is short; the reference is the \
            least energy of such strips.",
    quantities: || {
        vec![
            Quantity::new("along, curvature / alpha", 1.0),
            Quantity::new(
                "both directions, w / 50 thick, curvature / alpha",
                both(THICKNESSES[0]),
            ),
            Quantity::new(
                "both directions, w / 250 thick, curvature / alpha",
                both(THICKNESSES[1]),
            ),
        ]
    },
    measure: curled,
};

/// Curvature over `alpha` of a long strip of the thickness `t` with the natural curvature `alpha` in both
/// directions.
///
/// Bent to the curvature `k` along its length the strip, `2 b` wide, has the deflection `v(y)` from a
/// cylinder, which stretches it by `k v`: `D v'''' + E t k^2 v = 0` with `v''' = 0` and `v'' = q = alpha - nu
/// (k - alpha)` at its edges, so that `v = A cosh(p y) cos(p y) + B sinh(p y) sin(p y)`, `p^4 = 3 (1 - nu^2)
/// k^2 / t^2`. With it the energy of a unit of length is `D (b (1 - nu^2) (k - alpha)^2 + q (b q - v'(b)))`,
/// of which `k` is the minimum.
fn both(t: f64) -> f64 {
    let b = BROAD / 2.0;
    let rest = 1.0 - POISSON * POISSON;
    let energy = |k: f64| {
        let p = (3.0 * rest).powf(0.25) * (k / t).sqrt();
        let ((s, c), sh, ch) = ((p * b).sin_cos(), (p * b).sinh(), (p * b).cosh());
        // Of A = a (sinh cos - cosh sin) and B = a (cosh sin + sinh cos) v''' is zero.
        let (first, second) = (sh * c - ch * s, ch * s + sh * c);
        let slope = p * (first * (sh * c - ch * s) + second * (ch * s + sh * c));
        let bend = 2.0 * p * p * (second * ch * c - first * sh * s);
        let q = ALPHA - POISSON * (k - ALPHA);
        b * rest * (k - ALPHA).powi(2) + q * q * (b - slope / bend)
    };
    // Golden section; the energy has one minimum between.
    let (mut low, mut high) = (ALPHA, (1.0 + POISSON) * ALPHA);
    let part = (3.0 - 5.0_f64.sqrt()) / 2.0;
    while high - low > 1e-6 * ALPHA {
        let (left, right) = (low + part * (high - low), high - part * (high - low));
        if energy(left) < energy(right) {
            high = right;
        } else {
            low = left;
        }
    }
    (low + high) / 2.0 / ALPHA
}

fn curled(job: Job) -> Result<Measured> {
    let strip = job.cantilever([1.0, BROAD])?;
    let mut all = Measured::default();
    let [thick, thin] = THICKNESSES;
    for (across, thickness) in [(0.0, thin), (ALPHA, thick), (ALPHA, thin)] {
        let curl = Curl {
            direction: MaterialDirection::Uniform([1.0, 0.0, 0.0]),
            curvature: Curvature {
                along: ALPHA,
                across,
                twist: 0.0,
            }
            .into(),
            profile: Profile::Ramp {
                from: 0.0,
                to: 1.0,
                begin: 0.0,
                end: 10.0,
            },
        };
        let material = material(1.0, POISSON, thickness);
        let model = SheetModel::of_material(&strip.sheet, &material);
        let model = model.clamped(&strip.clamp).curled(curl).build()?;
        let mut rest = Rest::new(&strip.sheet, 1.0, 1.0);
        rest.under(model)?;
        let curvature = middle_curvature(&strip.sheet, &rest.x);
        all.add(Measured::at_rest(&rest, vec![curvature / ALPHA]));
    }
    Ok(all)
}

/// Curvature of the circle in the plane of x and z that fits the vertices of the middle half of the strip by
/// least squares of `x^2 + z^2 + a x + c z + d` (Kasa 1976).
fn middle_curvature(sheet: &Sheet, x: &[f64]) -> f64 {
    let places = sheet.positions().as_chunks::<3>().0.iter();
    let middle = places.zip(x.as_chunks::<3>().0);
    let middle = middle.filter(|(rest, _)| (rest[0] - 0.5).abs() < 0.25);
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (_, &[x, _, z]) in middle {
        let row = Vector3::new(x, z, 1.0);
        normal += row * row.transpose();
        right -= row * (x * x + z * z);
    }
    let fit = normal.lu().solve(&right).unwrap_or_default();
    1.0 / (fit.xy().norm_squared() / 4.0 - fit.z).sqrt()
}

/// Radius and width of the ring, and how far it is opened.
const RADIUS: f64 = 1.0;
const WIDTH: f64 = 0.5;
const OPENING: f64 = 1e-2;

/// A ring.
pub(super) const RING: Experiment = Experiment {
    name: "split-ring",
    title: "Ring with a slit",
    source: "Bending of curved beams, 3 pi P R^3 / (E I) (Timoshenko, Strength of Materials)",
    about: "A ring of the radius R and the width R / 2 that is round without stress, Poisson's ratio 0, clamped on one \
            side of its slit: how far a force along the other side opens it.",
    quantities: || vec![Quantity::new("opening E I / (3 pi P R^3)", 1.0)],
    measure: ring,
};

fn ring(job: Job) -> Result<Measured> {
    let arc = TAU * RADIUS;
    let cell = WIDTH / job.across as f64;
    // The clamp overlaps the other end in space: nothing touches here.
    let flat = job.mesh.rectangle([-cell, 0.0], [arc, WIDTH], cell)?;
    let flat = with_line(&flat, 0.0, cell)?;
    let clamp = vertices(&flat, |[x, ..]| x < 1e-9);
    let round = |[x, y, _]: [f64; 3]| {
        let (s, c) = (x / RADIUS).sin_cos();
        [RADIUS * s, y, RADIUS * (1.0 - c)]
    };
    let sheet = flat.map_positions(round)?;
    let end = Line::at(&flat, 0, arc);
    let force = OPENING * WIDTH / (3.0 * PI * RADIUS.powi(3));
    let material = material(1.0, 0.0, 0.01);
    let model = SheetModel::of_material(&sheet, &material);
    let model = model.clamped(&clamp).curved().build()?;
    let mut rest = Rest::new(&sheet, OPENING, arc * arc);
    rest.under(model.with_force(end.load(force, [-1.0, 0.0, 0.0])?))?;
    let opened = -end.moved(&sheet, &rest.x, 0);
    Ok(Measured::at_rest(&rest, vec![opened / OPENING]))
}
