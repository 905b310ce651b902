//! An annulus with a curved crease, whose curvature in space is known.

use super::model::{Model, PAPER, Plate};
use super::nudge::Nudge;
use super::runs::{Ran, Records, samples};
use super::scene::{DAMPING, run, until_rest};
use crate::report::Table;
use crate::runs::Plan;
use crate::runs::meshes::vertices;
use anyhow::Result;
use isosheet_dynamics::{CreaseSpring, CreaseSprings, Profile};
use isosheet_mesh::{EdgeId, Sheet, VertexId, fold_angle, generate};
use isosheet_tests::implicit_euler;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_3, PI, TAU};

/// Radius of the crease, and widths of the two panels beside it, metres. Panels of half the radius fold over:
/// the sheet is pinched at four places, where the crease has corners and no curvature.
const RADIUS: f64 = 0.1;
const HALF: f64 = 0.02;

/// The fold angle at rest, radians.
const REST_ANGLE: f64 = FRAC_PI_3;

/// Torsional stiffness of a metre of crease, N: soft and stiff against `D / h` = 0.05 to 0.2 N.
const STIFFNESSES: [f64; 2] = [0.01, 1.0];

/// How long the rest angle grows, and how long forces choose the saddle, seconds.
const FOLDING: f64 = 1.0;
const NUDGED: f64 = 1.0;

/// The forces that choose the saddle in total over `D / R`.
const NUDGE: f64 = 1.0;

/// The sheet is at rest when no vertex is faster, metres per second: an angle changes by less than 1e-4
/// degrees within a second.
const REST: f64 = 1e-7;

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct CurvedJob {
    /// Squares across one panel.
    #[serde(rename = "squares across")]
    across: usize,
    /// Stiffness of a metre of crease.
    #[serde(rename = "crease, N")]
    stiffness: f64,
}

/// The fold angle, and the relative errors of the curvature of the crease of a sheet at rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Folded {
    #[serde(rename = "angle of the crease, degrees")]
    angle: f64,
    #[serde(rename = "greatest error")]
    largest: Option<f64>,
    #[serde(rename = "error in the mean")]
    mean: Option<f64>,
}

impl CurvedJob {
    fn sheet(self) -> Result<Sheet> {
        let segments = (TAU * RADIUS / HALF * self.across as f64).round() as usize;
        let radii = [RADIUS - HALF, RADIUS + HALF];
        Ok(generate::annulus(
            segments,
            2 * self.across,
            radii[0],
            radii[1],
        )?)
    }

    fn springs(self, sheet: &Sheet, crease: &[EdgeId]) -> Result<CreaseSprings> {
        let rest = Profile::SmoothStep {
            from: 0.0,
            to: REST_ANGLE,
            begin: 0.0,
            end: FOLDING,
        };
        let spring = |&edge: &EdgeId| CreaseSpring {
            edge,
            stiffness: self.stiffness * sheet.lengths()[edge.index()],
            rest: rest.clone().into(),
            yields: None,
            in_series: None,
        };
        let mut springs: Vec<CreaseSpring> = crease.iter().map(spring).collect();
        CreaseSpring::put_in_sheet(&mut springs, sheet, PAPER.rigidity);
        Ok(CreaseSprings::new(sheet.topology(), springs)?)
    }
}

/// The edges of the crease.
fn crease(sheet: &Sheet) -> Vec<EdgeId> {
    let is_on = |v: &VertexId| {
        let [x, y, _] = sheet.position(*v);
        (x.hypot(y) - RADIUS).abs() < 1e-9
    };
    let t = sheet.topology();
    let is_crease = |e: &EdgeId| t.edges()[e.index()].iter().all(is_on);
    t.edge_ids().filter(is_crease).collect()
}

/// Forces that bend the annulus to a saddle: up at both ends of the x axis, down at both ends of the y axis.
fn nudge(sheet: &Sheet) -> Nudge {
    let rim = vertices(sheet, |[x, y, _]| x.hypot(y) > RADIUS + HALF - 1e-9);
    let unit = NUDGE * PAPER.rigidity / RADIUS / rim.len() as f64;
    let force = |v: VertexId| {
        let [x, y, _] = sheet.position(v);
        (v, unit * (2.0 * y.atan2(x)).cos())
    };
    Nudge {
        forces: rim.into_iter().map(force).collect(),
        end: NUDGED,
    }
}

fn measure(model: Model, job: CurvedJob, plan: &Plan) -> Result<(Ran, Folded)> {
    let sheet = job.sheet()?;
    let creases = &crease(&sheet)[..];
    let moved = model
        .sheet(&sheet, Plate { creases, ..PAPER })?
        .with_damping(DAMPING)?
        .with_potential(job.springs(&sheet, creases)?)
        .with_potential(nudge(&sheet));
    let (course, end) = run(model, moved, &sheet, implicit_euler(), plan)?;
    let ran = Ran::of(model, &sheet, &course);
    let angles = creases.iter();
    let angles = angles.filter_map(|e| fold_angle(sheet.topology(), &end.x, *e));
    let mean = angles.clone().sum::<f64>() / angles.count() as f64;
    let errors = curvature_errors(&sheet, creases, &end.x);
    let [largest, in_the_mean] = errors.map(|error| ran.if_good(error));
    let folded = Folded {
        angle: mean.to_degrees(),
        largest,
        mean: in_the_mean,
    };
    Ok((ran, folded))
}

fn at(x: &[f64], v: VertexId) -> Vector3<f64> {
    Vector3::from_column_slice(&x[3 * v.index()..3 * v.index() + 3])
}

/// The largest and the mean difference from 1 of curvature times `R sin(theta / 2)` over the vertices of the
/// crease. The curvature is the angle between the two edges at a vertex over their mean length, the dihedral
/// angle `theta` the mean of the angles of both.
fn curvature_errors(sheet: &Sheet, crease: &[EdgeId], x: &[f64]) -> [f64; 2] {
    let t = sheet.topology();
    let mut errors = Vec::new();
    for v in t.vertex_ids() {
        let of = crease.iter().filter(|e| t.edges()[e.index()].contains(&v));
        let edges: Vec<EdgeId> = of.copied().collect();
        let [first, second] = edges[..] else {
            continue;
        };
        let along = [first, second].map(|e| at(x, t.other_end(e, v)) - at(x, v));
        let turn = (-along[0]).angle(&along[1]);
        let curvature = turn / (0.5 * (along[0].norm() + along[1].norm()));
        let folds = [first, second].map(|e| fold_angle(t, x, e).unwrap_or(0.0).abs());
        let dihedral = PI - 0.5 * (folds[0] + folds[1]);
        errors.push((curvature * RADIUS * (0.5 * dihedral).sin() - 1.0).abs());
    }
    let largest = errors.iter().copied().fold(0.0, f64::max);
    [largest, errors.iter().sum::<f64>() / errors.len() as f64]
}

/// The runs of the yardstick.
pub(super) fn runs(records: &Records<'_>) -> Result<Table> {
    let effort = records.store.effort;
    let sizes: &[usize] = effort.quick_or(&[2], &[2, 4, 8]);
    let of = |stiffness| {
        sizes
            .iter()
            .map(move |&across| CurvedJob { across, stiffness })
    };
    let jobs: Vec<CurvedJob> = STIFFNESSES.into_iter().flat_map(of).collect();
    let plan = until_rest(effort.quick_or(2.0, 30.0)).until_rest(REST);
    samples(&records.of_models(&jobs, |model, job| measure(model, *job, &plan))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The crease is the whole circle, and a polygon of 250 corners in the plane has the curvature of its
    /// circle.
    #[test]
    fn flat_annuli_have_the_curvature_of_their_circle() {
        let job = CurvedJob {
            across: 8,
            stiffness: 1.0,
        };
        let sheet = job.sheet().unwrap();
        let crease = crease(&sheet);
        let length: f64 = crease.iter().map(|e| sheet.lengths()[e.index()]).sum();
        assert!((length / (TAU * RADIUS) - 1.0).abs() < 2e-3, "{length}");
        let [largest, _] = curvature_errors(&sheet, &crease, sheet.positions());
        assert!(largest < 1e-3, "{largest}");
    }
}
