//! Lateral buckling of a strip that is clamped at one end and stands on edge.

use super::model::{Model, PAPER, Plate};
use super::runs::{Ran, Records, samples};
use super::scene::{DAMPING, run};
use crate::report::Table;
use crate::runs::meshes::{Grid, vertices, with_line};
use crate::runs::{Course, Plan};
use anyhow::Result;
use isosheet_mesh::Sheet;
use isosheet_tests::implicit_euler;
use serde::{Deserialize, Serialize};

/// Free and clamped length, and width, metres.
const LENGTH: f64 = 0.3;
const CLAMP: f64 = 0.02;
const WIDTH: f64 = 0.02;

/// Acceleration of gravity, m/s2, and its part across the strip.
const GRAVITY: f64 = 9.8;
const IMPERFECTION: f64 = 1e-3;

/// Steps of implicit Euler, seconds: long ones, which damp all motion.
const STEP: f64 = 0.05;

/// The strip is at rest when no vertex is faster, metres per second: near the critical load it moves aside
/// slowly at first.
const REST: f64 = 2e-5;

/// The strip has buckled when its tip is aside by more than this part of its length. Far below the critical
/// load the imperfection moves the tip by `IMPERFECTION` / 8 of the load, 0.3 % of the length; deflections
/// beyond the critical load grow with its root.
const BUCKLED: f64 = 0.1;

/// Loads between which the critical one is sought.
const LOADS: [f64; 2] = [6.0, 96.0];

/// Critical load `q L^3` of a beam that is clamped and stands on edge under its own weight, over `sqrt(B C)`.
///
/// The twist satisfies `phi'' + beta^2 x^4 phi = 0` with `x` the distance from the free end over the length,
/// `phi' = 0` there, `phi = 0` at the clamp and `beta = q L^3 / (2 sqrt(B C))` (Timoshenko and Gere, *Theory
/// of Elastic Stability*, Sec. 6.3). The power series of the solution is summed, and its first zero is found
/// by bisection.
fn prandtl_michell() -> f64 {
    let twist = |beta: f64| {
        let (mut sum, mut term) = (0.0, 1.0);
        for k in 0..60_i32 {
            sum += term;
            let n = f64::from(6 * (k + 1));
            term *= -beta * beta / (n * (n - 1.0));
        }
        sum
    };
    let (mut low, mut high) = (1.0, 8.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if twist(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low + high
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct BucklingJob {
    mesh: Grid,
    #[serde(rename = "squares across")]
    across: usize,
}

/// Where the critical load `q L^3 / (D w)` lies.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Bracket {
    /// The largest load known to be below, the smallest known to be above.
    #[serde(rename = "upright at")]
    below: Option<f64>,
    #[serde(rename = "buckled at")]
    above: Option<f64>,
    /// Critical loads of the beams that bound the strip: its energy lies between theirs.
    #[serde(rename = "lower bound")]
    low: f64,
    #[serde(rename = "upper bound")]
    high: f64,
    /// How far the critical load is from the reference, relative: of rods the nearest load between both
    /// bounds, of the others the load of the plate. (Membranes do not resist the first small twist: strains
    /// are quadratic in it.)
    error: Option<f64>,
    /// Why the search ended early.
    #[serde(rename = "not decided")]
    undecided: String,
}

/// How far the tip of the strip goes aside under a load, over its length.
fn aside(model: Model, flat: &Sheet, load: f64, plan: &Plan) -> Result<(f64, Course)> {
    let clamped = &vertices(flat, |[x, ..]| x < 1e-9)[..];
    let rigidity = PAPER.density * GRAVITY * LENGTH.powi(3) / load;
    let plate = Plate {
        rigidity,
        clamped,
        ..PAPER
    };
    let moved = model
        .sheet(flat, plate)?
        .with_acceleration([0.0, -GRAVITY, -IMPERFECTION * GRAVITY])
        .with_damping(DAMPING)?
        .with_pins(clamped)?;
    let (course, end) = run(model, moved, flat, implicit_euler(), plan)?;
    let tip = vertices(flat, |[x, ..]| x > LENGTH - 1e-9);
    Ok((end.mean(&tip, 2, f64::abs) / LENGTH, course))
}

/// Halves the interval of the logarithms of the loads so many times, or until a run neither moves aside nor
/// ends.
fn search(model: Model, job: BucklingJob, halvings: usize, plan: &Plan) -> Result<(Ran, Bracket)> {
    let cell = WIDTH / job.across as f64;
    let sheet = job.mesh.rectangle([-CLAMP, 0.0], [LENGTH, WIDTH], cell)?;
    let sheet = with_line(&sheet, 0.0, cell)?;
    let [mut low, mut high] = LOADS;
    let [below, above] = [2.0_f64, 4.0].map(|torsion| prandtl_michell() * torsion.sqrt());
    let mut found = Bracket {
        low: below,
        high: above,
        ..Bracket::default()
    };
    let mut worst = Course::default();
    for _ in 0..halvings {
        let load = (low * high).sqrt();
        let (aside, course) = aside(model, &sheet, load, plan)?;
        if aside > BUCKLED {
            (high, found.above) = (load, Some(load));
        } else if course.is_good() {
            (low, found.below) = (load, Some(load));
        } else {
            found.undecided = format!("at {load:.3}: {}", course.ending.name());
        }
        worst.add_run(course);
        if !found.undecided.is_empty() {
            break;
        }
    }
    let bracket = found.below.zip(found.above);
    found.error = bracket
        .filter(|_| found.undecided.is_empty())
        .map(|(a, b)| {
            let load = (a * b).sqrt();
            let reference = match model {
                Model::Rods => load.clamp(below, above),
                _ => below,
            };
            (load / reference - 1.0).abs()
        });
    Ok((Ran::of(model, &sheet, &worst), found))
}

/// The runs of the yardstick.
pub(super) fn runs(records: &Records<'_>) -> Result<Table> {
    let effort = records.store.effort;
    let plan = Plan::new(STEP, effort.quick_or(5.0, 20.0)).until_rest(REST);
    let halvings = effort.quick_or(3, 8);
    let sizes: &[usize] = effort.quick_or(&[2], &[2, 4]);
    let of = |mesh: Grid| {
        sizes
            .iter()
            .map(move |&across| BucklingJob { mesh, across })
    };
    let meshes = effort.quick_or(&Grid::ALL[..2], &Grid::ALL[..5]);
    let jobs: Vec<BucklingJob> = meshes.iter().copied().flat_map(of).collect();
    samples(&records.of_models(&jobs, |model, job| search(model, *job, halvings, &plan))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The constant of the literature, and the bounds of the text.
    #[test]
    fn the_critical_load_of_the_beam_is_that_of_the_literature() {
        let unit = prandtl_michell();
        assert!((unit - 12.85).abs() < 0.005, "{unit}");
        assert!((unit * 2.0_f64.sqrt() - 18.2).abs() < 0.05 && (unit * 2.0 - 25.7).abs() < 0.05);
    }

    /// The energy of the strip lies between the energies of the two beams.
    #[test]
    fn the_energy_of_the_strip_lies_between_two_beams() {
        let strip = |k: f64, t: f64| {
            if k.abs() > t.abs() {
                (k * k + t * t).powi(2) / (k * k)
            } else {
                4.0 * t * t
            }
        };
        for i in 0..=100 {
            let (t, k) = (f64::from(i) * 0.01 * std::f64::consts::FRAC_PI_2).sin_cos();
            let (low, high) = (k * k + 2.0 * t * t, k * k + 4.0 * t * t);
            let energy = strip(k, t);
            assert!((low - 1e-12..=high + 1e-12).contains(&energy), "{k} {t}");
        }
    }
}
