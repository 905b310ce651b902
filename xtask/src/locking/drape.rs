//! A disk on a smaller round table, on several triangulations.

use super::disk::{DISK, Mesh};
use super::dots::{Dot, Figure, Panel};
use super::isometry::{Isometry, Material, PAPER_RIGIDITY};
use super::records::Records;
use super::rim::{Rim, analyse};
use super::sample::{OfModel, Sample, requirements};
use super::scene::Scene;
use super::targets::{Target, at_least};
use super::{Findings, median};
use crate::draw::{Axis, Charts};
use crate::report::{Cell, Table};
use crate::runs::{Course, Plan};
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::{Gravity, ImplicitOptions, Method, SheetModel};
use isosheet_mesh::{Sheet, VertexId};
use nalgebra::Isometry3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

pub(super) const ABOUT: &str = "A flat disk of paper (radius 0.5 m, 80 g/m², 5e-4 N m, damping 4/s) is let go on a round table of half its radius, \
    with contact between disk and table and of the disk with itself, without and with friction. Its weight is uneven by 1 %: by a smooth random function of the place on the disk, which the seed chooses, and which is the same on all meshes, so that \
    folds need not have the symmetry of a mesh. The seed also turns the mesh and perturbs the solver's first choice; of the irregular mesh it \
    is the mesh as well. For a smooth sheet all meshes would give the same folds. Folds are counted on the rim: rises of the height through the middle of its range.";

/// Radius and height of the table, metres.
const TABLE: [f64; 2] = [0.25, 0.1];

/// Mass per area, kg/m2, and rate of damping, 1/s.
const DENSITY: f64 = 0.08;
const DAMPING: f64 = 4.0;

const GRAVITY: f64 = 9.8;

/// Largest part by which the weight is uneven, and the numbers of its waves around the centre.
const UNEVEN: f64 = 0.01;
const WAVES: std::ops::RangeInclusive<u32> = 2..=9;

/// Part of the activation distance that the disk starts above the table: the gap at which a contact carries
/// its own vertex.
const START: f64 = 0.95;

/// Rings of the concentric mesh; the others have rods of about the same length.
const RINGS: usize = 8;

/// Mesh, coefficient of friction and seed.
type Job = (Mesh, f64, u64);

/// What is measured of a drape.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Measured {
    rim: Option<Rim>,
    /// Weight and bending at the end, joules; the flat disk at the height of the table has none.
    energy: f64,
    /// Horizontal distance of the centre from the axis of the table, metres.
    aside: f64,
}

type Drape = Sample<Job, Measured>;

fn measure(
    isometry: Isometry,
    &(mesh, friction, seed): &Job,
    rings: usize,
    plan: &Plan,
) -> Result<(usize, Course, Measured)> {
    let sheet = mesh.disk(rings, seed)?;
    let material = Material::plate(&sheet, DENSITY, PAPER_RIGIDITY, &[]);
    let model = isometry
        .model(&sheet, material)?
        .with_acceleration([0.0, 0.0, -GRAVITY])
        .with_damping(DAMPING)?;
    let weights = model.mass().row_sums(sheet.topology());
    let model = model.with_potential(uneven(&sheet, &weights, seed));
    let contacts = contacts(&model, friction)?;
    let method = Method::Bdf2(ImplicitOptions {
        seed,
        ..ImplicitOptions::default()
    });
    let scene = Scene::flat(model, &sheet).by(method).touching(contacts);
    let (course, end) = scene.run(plan)?;
    let total: f64 = weights.iter().sum();
    let places = || end.x.as_chunks::<3>().0.iter().zip(&weights);
    let centre = |k: usize| places().map(|(p, w)| w * p[k]).sum::<f64>() / total;
    let bending = isometry.bending_energy(&sheet, (PAPER_RIGIDITY, &[]), &end.x)?;
    let measured = Measured {
        rim: rim(&sheet, &end.x),
        energy: total * GRAVITY * centre(2) + bending,
        aside: centre(0).hypot(centre(1)),
    };
    Ok((sheet.topology().vertex_count(), course, measured))
}

/// The table, and contact of the disk with it and with itself.
fn contacts(model: &SheetModel, friction: f64) -> Result<Contacts> {
    let options = ContactOptions::for_sheet(model);
    let (radius, half_height) = (TABLE[0], 0.5 * TABLE[1]);
    let shape = Shape::Cylinder {
        radius,
        half_height,
    };
    let middle = -START * options.activation - half_height;
    let table = Obstacle::fixed(shape, Isometry3::translation(0.0, 0.0, middle))?;
    let coefficients = match friction {
        0.0 => Coefficients::FRICTIONLESS,
        _ => Coefficients::equal(friction),
    };
    Ok(Contacts::new(model, options)?
        .with_body(table, coefficients)?
        .with_self_contact(coefficients)?)
}

impl Drape {
    /// The number of folds at the end of a run that reached it with the disk on the table.
    fn folds(&self) -> Option<usize> {
        let is_on_table = self.measured.aside < TABLE[0];
        let is_good = self.course.is_good() && is_on_table;
        Some(self.measured.rim.filter(|_| is_good)?.folds)
    }
}

/// The weight that a disk has beside its even one: [`UNEVEN`] of it, times a sum of waves around the centre
/// with random amplitudes and phases, `sum_k a_k (r / R)^2 cos(k (angle - phase_k))`. The function belongs to
/// the place in space, not to the mesh.
fn uneven(sheet: &Sheet, weights: &[f64], seed: u64) -> Gravity {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let waves: Vec<[f64; 3]> = WAVES
        .map(|k| {
            let amplitude = rng.random_range(-1.0..1.0);
            [f64::from(k), amplitude, rng.random_range(0.0..TAU)]
        })
        .collect();
    let norm: f64 = waves.iter().map(|w| w[1].abs()).sum();
    let places = sheet.positions().as_chunks::<3>().0.iter().zip(weights);
    let weights = places.map(|([x, y, _], weight)| {
        let (angle, square) = (y.atan2(*x), (x * x + y * y) / (DISK * DISK));
        let wave = |[k, a, phase]: &[f64; 3]| a * (k * (angle - phase)).cos();
        UNEVEN * weight * square * waves.iter().map(wave).sum::<f64>() / norm
    });
    Gravity::new(weights.collect(), [0.0, 0.0, -GRAVITY])
}

/// The rim at positions `x`, over the angle in the flat disk.
fn rim(sheet: &Sheet, x: &[f64]) -> Option<Rim> {
    let loops = sheet.topology().boundary_loops();
    let place = |v: &VertexId| {
        let [a, b, _] = sheet.position(*v);
        [b.atan2(a), x[3 * v.index() + 2]]
    };
    let mut rim: Vec<[f64; 2]> = loops.first()?.iter().map(place).collect();
    rim.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (angles, heights): (Vec<f64>, Vec<f64>) = rim.iter().map(|[a, z]| (*a, *z)).unzip();
    analyse(&angles, &heights)
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let duration = effort.quick_or(0.3, 10.0);
    let plan = Plan::new(1.0 / 60.0, duration)
        .within(effort.quick_or(0.5, 9.0))
        .until_rest(2e-3);
    let rings = effort.quick_or(3, RINGS);
    let meshes: &[Mesh] = effort.quick_or(&Mesh::ALL[..1], &Mesh::ALL);
    let frictions: &[f64] = effort.quick_or(&[0.3], &[0.0, 0.3]);
    let seeds = effort.quick_or(1, 10);
    let mut jobs: Vec<Job> = Vec::new();
    for &mesh in meshes {
        for &friction in frictions {
            jobs.extend((0..seeds).map(|seed| (mesh, friction, seed)));
        }
    }
    let run = |isometry, job: &Job| measure(isometry, job, rings, &plan);
    let all = records.of_models(|_| jobs.clone(), run)?;
    let mut targets = Vec::new();
    for isometry in Isometry::ALL {
        targets.extend(frictions.iter().map(|mu| target(isometry, &all, *mu)));
    }
    targets.extend(requirements(&all, |of| vec![of.strain()]));
    let findings = Findings {
        tables: vec![summary(&all, meshes, frictions, &plan)],
        files: vec![runs(&all)],
        targets,
        remarks: Vec::new(),
    };
    Ok((findings, Some(plot(&all, meshes, frictions))))
}

/// The part of the seeds for which all meshes have the same number of folds.
fn target(isometry: Isometry, all: &[Drape], friction: f64) -> Target {
    let mut folds: BTreeMap<u64, Vec<Option<usize>>> = BTreeMap::new();
    let of = OfModel::of(isometry, all).with(|job| job.1 == friction);
    for d in of.all {
        folds.entry(d.job.2).or_default().push(d.folds());
    }
    let agree = |f: &&Vec<Option<usize>>| f.iter().all(|n| n.is_some() && *n == f[0]);
    let share = folds.values().filter(agree).count() as f64 / folds.len() as f64;
    let quantity = format!(
        "part of the seeds with the same number of folds on all meshes, friction {friction}"
    );
    at_least(isometry, &quantity, 0.8, &[Some(share)])
}

/// Numbers of folds of every run, over the meshes.
fn plot(all: &[Drape], meshes: &[Mesh], frictions: &[f64]) -> Charts {
    let dot = |d: &Drape| {
        let (mesh, _, seed) = d.job;
        let place = meshes.iter().position(|m| *m == mesh)? as f64;
        // Models and seeds beside one another: numbers of folds are whole.
        let aside = 0.22 * d.isometry.aside() + 0.017 * (seed as f64 - 4.5);
        let folds = d.folds().map(|n| n as f64);
        Some(Dot::of(d, mesh as usize, place + aside, folds))
    };
    let panel = |&friction: &f64| {
        let dots = all.iter().filter(|d| d.job.1 == friction).filter_map(dot);
        Panel::new(
            format!("coefficient of friction {friction}"),
            dots.collect(),
        )
    };
    let ticks = meshes
        .iter()
        .enumerate()
        .map(|(k, m)| (k as f64, m.name().to_owned()));
    let range = [-0.6, meshes.len() as f64 - 0.4];
    let most = all
        .iter()
        .filter_map(Drape::folds)
        .max()
        .unwrap_or(0)
        .max(6);
    let folds = (0..=most).step_by(if most > 12 { 2 } else { 1 });
    let folds = folds.map(|n| (n as f64, n.to_string())).collect();
    let x = Axis::named("mesh", range, ticks.collect());
    let y = Axis::named("folds", [0.0, most as f64 + 0.5], folds);
    let names = Mesh::ALL.map(|m| m.name().to_owned()).to_vec();
    let panels = frictions.iter().map(panel).collect();
    Figure::of_row(x, y, panels, names, [200.0, 150.0]).draw()
}

fn runs(all: &[Drape]) -> Table {
    let rim = |d: &Drape, of: fn(Rim) -> f64| Cell::from(d.measured.rim.map(of));
    Table::of(
        "Every drape",
        all,
        &[
            ("mesh", &|d| d.job.0.name().into()),
            ("friction", &|d| d.job.1.into()),
            ("seed", &|d| (d.job.2 as usize).into()),
            ("V", &|d| d.vertices.into()),
            ("model", &|d| d.isometry.to_string().into()),
            ("ending", &|d| d.course.ending.name().into()),
            ("t at the end, s", &|d| d.course.time.into()),
            ("factorisations per step", &|d| {
                d.course.cost.factorisations_per_step().into()
            }),
            ("CPU s per simulated s", &|d| d.course.cpu_rate().into()),
            ("folds", &|d| rim(d, |r| r.folds as f64)),
            ("largest wave", &|d| rim(d, |r| r.wave as f64)),
            ("its share", &|d| rim(d, |r| r.share)),
            ("rim, m", &|d| rim(d, |r| r.mean)),
            ("energy, J", &|d| d.measured.energy.into()),
            ("strain", &|d| d.course.strain.into()),
            ("centre off by, m", &|d| d.measured.aside.into()),
            ("speed left, m/s", &|d| d.course.speed.into()),
            ("message", &|d| d.course.ending.message().into()),
        ],
    )
    .named("drape-runs")
}

/// Drapes that differ in the seed alone: all of them, and those that reached their end.
struct Group<'a> {
    all: Vec<&'a Drape>,
    good: Vec<&'a Drape>,
}

impl Group<'_> {
    /// A value of the drapes that reached their end, where they have one.
    fn values(&self, value: impl Fn(&Drape) -> Option<f64>) -> Vec<f64> {
        self.good.iter().filter_map(|d| value(d)).collect()
    }

    fn median(&self, value: impl Fn(&Drape) -> Option<f64>) -> Cell {
        median(self.values(value)).into()
    }

    fn range(&self, value: impl Fn(&Drape) -> Option<f64>) -> Cell {
        range(&self.values(value)).into()
    }
}

fn summary(all: &[Drape], meshes: &[Mesh], frictions: &[f64], plan: &Plan) -> Table {
    let mut groups = Vec::new();
    for isometry in Isometry::ALL {
        for &mesh in meshes {
            for &friction in frictions {
                let of = OfModel::of(isometry, all);
                let all = of.with(|job| (job.0, job.1) == (mesh, friction)).all;
                let good = all.iter().copied().filter(|d| d.course.is_good()).collect();
                groups.push(Group { all, good });
            }
        }
    }
    let over = |g: &Group<'_>| {
        let over = g
            .all
            .iter()
            .filter(|d| d.course.ending.name() == "wall time over");
        over.count()
    };
    let rim = |d: &Drape| Some(d.measured.rim?.mean);
    let energy = |d: &Drape| Some(d.measured.energy);
    Table::of(
        format!(
            "Disks on a round table: default method, steps of 1/60 s, {} s simulated, at most {} s of wall time. Numbers of folds with how often \
             they occur, of the disks that are still on the table, medians and ranges (largest minus smallest) are of the runs that reached their end",
            plan.duration,
            plan.patience
        ),
        groups,
        &[
            ("mesh", &|g| g.all[0].job.0.name().into()),
            ("friction", &|g| g.all[0].job.1.into()),
            ("model", &|g| g.all[0].isometry.to_string().into()),
            ("runs", &|g| g.all.len().into()),
            ("reached their end", &|g| g.good.len().into()),
            ("wall time over", &|g| over(g).into()),
            ("folds", &|g| folds(&g.good).into()),
            ("rim, m", &|g| g.median(rim)),
            ("range, m", &|g| g.range(rim)),
            ("energy, J", &|g| g.median(energy)),
            ("range, J", &|g| g.range(energy)),
            ("speed left, m/s", &|g| g.median(|d| Some(d.course.speed))),
            ("centre off by, m", &|g| g.median(|d| Some(d.measured.aside))),
        ],
    )
    .named("drape")
}

/// Numbers of folds with how often they occur, such as "4 x 7, 5 x 3".
fn folds(drapes: &[&Drape]) -> String {
    let mut counts = BTreeMap::<usize, usize>::new();
    for folds in drapes.iter().filter_map(|d| d.folds()) {
        *counts.entry(folds).or_default() += 1;
    }
    let texts: Vec<String> = counts.iter().map(|(k, n)| format!("{k} × {n}")).collect();
    texts.join(", ")
}

/// The largest value less the smallest; NaN of nothing.
fn range(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::NAN, f64::min);
    values.iter().copied().fold(f64::NAN, f64::max) - low
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_dynamics::Potential;

    #[test]
    fn three_waves_of_the_rim_are_three_folds() {
        for mesh in Mesh::ALL {
            let sheet = mesh.disk(4, 1).unwrap();
            let points = sheet.positions().as_chunks::<3>().0.iter();
            let bumped: Vec<f64> = points
                .flat_map(|[x, y, _]| [*x, *y, (3.0 * y.atan2(*x)).cos()])
                .collect();
            assert_eq!(rim(&sheet, &bumped).unwrap().folds, 3);
        }
        assert_eq!(range(&[2.0, 5.0, 3.0]), 3.0);
        assert!(range(&[]).is_nan());
    }

    /// The uneven weight is a function of the place, the same on every mesh, within its bound.
    #[test]
    fn the_uneven_weight_does_not_depend_on_the_mesh() {
        let unit = |mesh: Mesh| {
            let sheet = mesh.disk(4, 0).unwrap();
            let ones = vec![1.0; sheet.topology().vertex_count()];
            let mut force = vec![0.0; sheet.positions().len()];
            uneven(&sheet, &ones, 3).add_gradient(0.0, sheet.positions(), &mut force);
            let at = super::super::meshes::nearest(&sheet, [DISK, 0.0]).index();
            force[3 * at + 2] / GRAVITY
        };
        let concentric = unit(Mesh::Concentric);
        assert!((concentric - unit(Mesh::UnionJack)).abs() < 1e-12);
        assert!(concentric.abs() < UNEVEN && concentric != 0.0);
    }
}
