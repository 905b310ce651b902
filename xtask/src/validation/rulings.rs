//! Rulings and Gauss curvature of surfaces that are known.

use super::experiment::{Experiment, Job, Measured, Quantity};
use anyhow::Result;
use isosheet_dynamics::FaceCurvature;
use isosheet_mesh::{Sheet, angle_deficits};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Radius of the cylinder, half angle of the cone, and twist of the helicoid (1/m); the sheets are squares of
/// a metre.
const RADIUS: f64 = 0.8;
const HALF_ANGLE: f64 = 0.7;
const TWIST: f64 = 0.8;

/// Rulings.
pub(super) const RULED: Experiment = Experiment {
    name: "rulings",
    title: "Rulings and Gauss curvature",
    source: "Curvatures 1/R of a cylinder, cot b / r of a cone, and -t^2 / (1 + t^2 u^2)^2 of a helicoid",
    about: "A square of the side 1, rolled to a cylinder of the radius 0.8 across a direction that no edge has, and to a \
            cone of the half angle b = 0.7 whose apex is half a side away: the error of the curvature across the rulings, \
            and the angle in the face of the rulings to the exact ones in radians, roots of the mean squares over the faces \
            inside. And the angle deficits of a square that is twisted by t = 0.8 a metre: the integral of the Gauss \
            curvature of the helicoid times sin(pi x) sin(pi y).",
    quantities: || {
        let of = |shape: &str| {
            [
                Quantity::of_scale(format!("{shape}, curvature"), 0.0, 1.0),
                Quantity::of_scale(format!("{shape}, ruling"), 0.0, 1.0),
            ]
        };
        let shapes = of("cylinder").into_iter().chain(of("cone"));
        shapes
            .chain([Quantity::new("helicoid, Gauss curvature", 1.0)])
            .collect()
    },
    measure: ruled,
};

/// A point of a surface with its ruling and its curvature.
type Point = (Vector3<f64>, Vector3<f64>, f64);

/// Rolled about an axis that lies at half a radian in the sheet.
fn cylinder([x, y]: [f64; 2]) -> Point {
    let (s, c) = 0.5_f64.sin_cos();
    let (along, across) = (c * y - s * x, c * x + s * y);
    let angle = across / RADIUS;
    let place =
        |along: f64, out: f64, up: f64| Vector3::new(c * out - s * along, s * out + c * along, up);
    let at = place(along, RADIUS * angle.sin(), RADIUS * (1.0 - angle.cos()));
    (at, place(1.0, 0.0, 0.0), 1.0 / RADIUS)
}

/// Rolled about an apex half a side below the middle of the lower side.
fn cone([x, y]: [f64; 2]) -> Point {
    let (x, y) = (x - 0.5, y + 0.5);
    let (r, angle) = (x.hypot(y), x.atan2(y) / HALF_ANGLE.sin());
    let (s, c) = angle.sin_cos();
    let ruling = Vector3::new(HALF_ANGLE.sin() * s, HALF_ANGLE.sin() * c, HALF_ANGLE.cos());
    (r * ruling, ruling, 1.0 / (r * HALF_ANGLE.tan()))
}

/// The errors of curvatures and of rulings.
fn errors(flat: &Sheet, map: fn([f64; 2]) -> Point) -> Result<[f64; 2]> {
    let t = flat.topology();
    let plane = |v| {
        let [x, y, _] = flat.position(v);
        [x, y]
    };
    let x: Vec<f64> = t
        .vertex_ids()
        .flat_map(|v| <[f64; 3]>::from(map(plane(v)).0))
        .collect();
    let (mut sums, mut count) = ([0.0; 2], 0.0);
    let found = FaceCurvature::new(flat, &[], &[])?.rulings(&x);
    for (corners, ruling) in t.faces().iter().zip(found) {
        if corners.iter().any(|v| t.is_boundary_vertex(*v)) {
            continue;
        }
        let [a, b, c] = corners.map(plane);
        let (_, exact, curvature) = map([0, 1].map(|k| (a[k] + b[k] + c[k]) / 3.0));
        // Within the face, whose plane is tilted against the surface.
        let [a, b, c] =
            corners.map(|v| Vector3::from_column_slice(&x[3 * v.index()..3 * v.index() + 3]));
        let normal = (b - a).cross(&(c - a)).normalize();
        let exact = (exact - normal * normal.dot(&exact)).normalize();
        // A face without a ruling is off by the whole.
        let own = ruling.map_or([1.0; 2], |own| {
            let across = Vector3::from(own.direction).cross(&exact).norm();
            [own.curvature / curvature - 1.0, across.min(1.0).asin()]
        });
        for (sum, error) in sums.iter_mut().zip(own) {
            *sum += error * error;
        }
        count += 1.0;
    }
    Ok(sums.map(|sum| f64::sqrt(sum / count)))
}

/// The integral of the Gauss curvature `-t^2 / (1 + t^2 u^2)^2` of the helicoid `(u cos t v, u sin t v, v)`
/// times `sin(pi x) sin(pi y)`, over its exact value, with the angle deficits of the vertices.
fn deficits(flat: &Sheet) -> Result<f64> {
    let twisted = flat.map_positions(|[x, y, _]| {
        let (u, v) = (x - 0.5, y - 0.5);
        let (s, c) = (TWIST * v).sin_cos();
        [u * c, u * s, v]
    })?;
    let t = twisted.topology();
    let bump = |[x, y, _]: [f64; 3]| (PI * x).sin() * (PI * y).sin();
    let found = angle_deficits(t, twisted.positions());
    let sum: f64 = t
        .vertex_ids()
        .map(|v| bump(flat.position(v)) * found[v.index()])
        .sum();
    // An area is (1 + t^2 u^2)^(1/2) du dv. Simpson's rule, whose error is 1e-10 here.
    let of_x = |x: f64| (PI * x).sin() * (1.0 + (TWIST * (x - 0.5)).powi(2)).powf(-1.5);
    let step = 1.0 / PARTS as f64;
    let simpson: f64 = (0..PARTS)
        .map(|k| {
            let x = k as f64 * step;
            step / 6.0 * (of_x(x) + 4.0 * of_x(x + 0.5 * step) + of_x(x + step))
        })
        .sum();
    Ok(sum / (-TWIST * TWIST * 2.0 / PI * simpson))
}

/// Parts of the side over which the reference is integrated.
const PARTS: usize = 100;

fn ruled(job: Job) -> Result<Measured> {
    let flat = job.rectangle([1.0, 1.0])?;
    let [cylinder, cone] = [errors(&flat, cylinder)?, errors(&flat, cone)?];
    Ok(Measured {
        values: [&cylinder[..], &cone, &[deficits(&flat)?]].concat(),
        vertices: flat.topology().vertex_count(),
        ..Measured::default()
    })
}
