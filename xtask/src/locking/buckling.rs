//! Lateral buckling of a strip that is clamped at one end and stands on edge.

use super::Findings;
use super::bisection::{Bracket, Verdict, search};
use super::dots::{Dot, Figure, Panel};
use super::isometry::{Isometry, Material};
use super::meshes::{Pattern, Strip};
use super::records::Records;
use super::sample::{Sample, requirements};
use super::scene::Scene;
use crate::draw::{Axis, Charts};
use crate::report::{Effort, Table};
use crate::runs::{Course, Plan};
use anyhow::Result;
use isosheet_mesh::Sheet;
use isosheet_tests::implicit_euler;

pub(super) const ABOUT: &str = "A strip of 0.30 m x 0.02 m and 80 g/m² is clamped at one end with its width upright; gravity acts in its plane, and one \
    thousandth of it across. Below a critical weight the strip stays upright, above it bends and twists sideways (a test of Romero et al., \
    Physical validation of simulators in computer graphics, ACM Transactions on Graphics 40, 2021). The load is q L³ / (D w), with q the weight per \
    length and w the width; it is changed by way of the rigidity D. For a beam with the stiffnesses B of bending and C of torsion Prandtl and Michell found q L³ = 12.85 √(B C). \
    A strip that cannot stretch is no such beam: it twists only where it bends, since its Gaussian curvature is zero, and stores D w (κ² + τ²)² / (2 κ²) per length (Sadowsky 1930), \
    for |κ| < |τ| four times D w τ² / 2 by fine folds (Freddi, Hornung, Mora and Paroni 2016). This lies between the energies of the \
    beams with B = D w and C = 2 D w and C = 4 D w, so that the critical load lies between 18.2 and 25.7. (C = 2 D w is also \
    that of a thin elastic plate whose Poisson ratio is zero.)";

const STRIP: Strip = Strip {
    free: 0.3,
    clamped: 0.02,
    width: 0.02,
};

/// Mass per area, kg/m2, acceleration of gravity, m/s2, its part across the strip, rate of damping, 1/s.
const DENSITY: f64 = 0.08;
const GRAVITY: f64 = 9.8;
const IMPERFECTION: f64 = 1e-3;
const DAMPING: f64 = 4.0;

/// Steps of implicit Euler, seconds: long ones, which damp all motion.
const STEP: f64 = 0.05;

/// The strip is at rest when no vertex is faster, metres per second: near the critical load it moves aside
/// slowly at first.
const REST: f64 = 2e-5;

/// The strip has buckled when its tip is aside by more than this part of its length. Far below the critical
/// load the imperfection moves the tip by `IMPERFECTION` / 8 of the load, 0.3 % of the length; deflections
/// beyond the critical load grow with its root.
const BUCKLED: f64 = 0.1;

/// Loads between which the critical one is sought, and halvings of their ratio.
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

/// What the strip does under a load, and what its steps kept.
fn verdict(isometry: Isometry, flat: &Sheet, load: f64, plan: &Plan) -> Result<(Verdict, Course)> {
    let rigidity = DENSITY * GRAVITY * STRIP.free.powi(3) / load;
    let clamp = STRIP.clamp(flat);
    let material = Material::plate(flat, DENSITY, rigidity, &clamp);
    let model = isometry
        .model(flat, material)?
        .with_acceleration([0.0, -GRAVITY, -IMPERFECTION * GRAVITY])
        .with_damping(DAMPING)?
        .with_pins(&clamp)?;
    let scene = Scene::flat(model, flat).by(implicit_euler());
    let (course, end) = scene.run(plan)?;
    let aside = end.mean(&STRIP.tip(flat), 2, f64::abs);
    let verdict = if aside > BUCKLED * STRIP.free {
        Verdict::Above
    } else if course.is_good() {
        Verdict::Below
    } else {
        Verdict::Undecided(course.ending.name().to_owned())
    };
    Ok((verdict, course))
}

/// A mesh: its pattern, the angle of its squares against the strip (degrees), squares across.
type Mesh = (Pattern, f64, usize);

/// Where a strip buckles: critical load `q L^3 / (D w)`.
type Buckled = Sample<Mesh, Bracket>;

/// Critical loads of the beams that bound the strip: its energy lies between theirs.
fn bounds() -> [f64; 2] {
    [2.0_f64, 4.0].map(|torsion| prandtl_michell() * torsion.sqrt())
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let duration = effort.quick_or(5.0, 20.0);
    let plan = Plan::new(STEP, duration)
        .within(effort.quick_or(0.2, 6.0))
        .until_rest(REST);
    let halvings = effort.quick_or(3, 8);
    let sizes: &[usize] = effort.quick_or(&[2], &[2, 4]);
    let mut patterns: Vec<(Pattern, f64)> = Pattern::ALL.map(|p| (p, 0.0)).to_vec();
    if effort != Effort::Quick {
        patterns.extend([(Pattern::UnionJack, 45.0), (Pattern::OneWay, 22.5)]);
    }
    let of_size = |n: &usize| {
        let n = *n;
        patterns.iter().map(move |(p, d)| (*p, *d, n))
    };
    let meshes: Vec<Mesh> = sizes.iter().rev().flat_map(of_size).collect();
    let mut all: Vec<Buckled> = records.of_models(
        |_| meshes.clone(),
        |isometry, &(pattern, degrees, across)| {
            let sheet = STRIP.mesh(pattern, across, degrees)?;
            let (worst, found) = search(LOADS, halvings, |load| {
                verdict(isometry, &sheet, load, &plan)
            })?;
            Ok((sheet.topology().vertex_count(), worst, found))
        },
    )?;
    all.sort_by_key(|b| (b.isometry, b.job.0.number(), b.job.1 as usize, b.job.2));
    let finest = sizes.iter().max();
    let quantity = "relative error of the critical load on the finest of every mesh";
    let findings = Findings {
        tables: vec![table(&all, &plan, halvings)],
        targets: requirements(&all, |of| {
            let judged = of.with(|mesh| Some(&mesh.2) == finest);
            vec![judged.at_most(quantity, 0.1, error)]
        }),
        ..Findings::default()
    };
    Ok((findings, Some(plot(&all, &patterns, sizes))))
}

fn table(all: &[Buckled], plan: &Plan, halvings: usize) -> Table {
    let bounds = bounds();
    Table::of(
        format!(
            "Critical load q L³ / (D w), between the largest load that leaves the strip upright and the smallest that moves its tip aside by more than \
             {BUCKLED} of its length: at most {halvings} halvings of the ratio of the loads. Every run ends at rest, after {} s, or after {} s of wall time; the \
             search ends where a run neither moves aside nor reaches its end",
            plan.duration,
            plan.patience
        ),
        all,
        &[
            ("mesh", &|b| b.job.0.to_string().into()),
            ("turned by, degrees", &|b| b.job.1.into()),
            ("squares across", &|b| b.job.2.into()),
            ("V", &|b| b.vertices.into()),
            ("model", &|b| b.isometry.to_string().into()),
            ("upright at", &|b| b.measured.below.into()),
            ("buckled at", &|b| b.measured.above.into()),
            ("lower bound", &|_| bounds[0].into()),
            ("upper bound", &|_| bounds[1].into()),
            ("not decided", &|b| b.measured.undecided.as_str().into()),
        ],
    )
    .named("buckling")
}

/// How far the critical load is from the reference, relative: of rods the nearest load between both
/// bounds, of the others the load of the plate, see [`ABOUT`]. (Membranes do not resist the first
/// small twist: strains are quadratic in it.)
fn error(b: &Buckled) -> Option<f64> {
    let ([low, high], load) = (bounds(), b.measured.middle()?);
    let reference = match b.isometry {
        Isometry::Rods => load.clamp(low, high),
        _ => low,
    };
    Some((load / reference - 1.0).abs())
}

/// The critical loads over the meshes, with the two bounds.
fn plot(all: &[Buckled], patterns: &[(Pattern, f64)], sizes: &[usize]) -> Charts {
    let dots = all.iter().filter_map(|b| {
        let (pattern, degrees, across) = b.job;
        let place = patterns.iter().position(|p| *p == (pattern, degrees))? as f64;
        let mesh = sizes.iter().position(|n| *n == across)?;
        // Models and sizes beside one another.
        let aside = 0.2 * b.isometry.aside() + 0.09 * (mesh as f64 - 0.5);
        Some(Dot::of(b, mesh, place + aside, b.measured.middle()))
    });
    let name = |(p, degrees): &(Pattern, f64)| match degrees {
        0.0 => p.to_string(),
        _ => format!("{p} {degrees}°"),
    };
    let ticks = patterns
        .iter()
        .enumerate()
        .map(|(k, p)| (k as f64, name(p)));
    let ends = [-0.6, patterns.len() as f64 - 0.4];
    let loads = [15.0, 20.0, 25.0, 30.0, 40.0, 60.0].map(|l| (l, format!("{l}")));
    let x = Axis::named("mesh", ends, ticks.collect());
    let y = Axis::at("critical load qL³ / (Dw)", loads.to_vec());
    let panel = Panel {
        guides: bounds().map(|b| ends.map(|x| [x, b]).to_vec()).to_vec(),
        ..Panel::new("Lateral buckling", dots.collect())
    };
    let names = sizes
        .iter()
        .map(|n| format!("{n} squares across"))
        .collect();
    let size = [74.0 * patterns.len() as f64, 150.0];
    Figure {
        guide: "bounds of the load".into(),
        ..Figure::of_row(x, y, vec![panel], names, size)
    }
    .draw()
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

    /// The energy of the strip lies between those of the two beams.
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
