//! A square that clamps bend to a cylinder, with exact energy and moment.

use super::dots::{Dot, Figure, Panel};
use super::isometry::{Isometry, Material, PAPER_RIGIDITY};
use super::meshes::{Pattern, vertices, with_line};
use super::records::Records;
use super::sample::{OfModel, Sample, requirements};
use super::scene::{End, Scene};
use super::targets::{Target, at_least};
use super::{Findings, order};
use crate::draw::{Axis, Charts};
use crate::report::{Table, number};
use crate::runs::{Course, Plan};
use anyhow::Result;
use isosheet_dynamics::{Profile, SheetModel, Support};
use isosheet_mesh::{Sheet, VertexId};
use isosheet_tests::implicit_euler;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

pub(super) const ABOUT: &str = "A square of office paper (0.2 m, 5e-4 N m, without weight) between two flat clamps is bent by 1 radian: within 1 s \
    the clamps move to the two tangent planes at the ends of a cylinder of curvature κ = 5/m, and stay there. A smooth inextensible sheet takes the shape of that \
    cylinder: it stores D κ² / 2 per area and pulls at a clamp with the moment D κ per width, without boundary layers (Poisson's ratio does not matter: \
    the bending energy of all models is that of the ratio zero). The mesh is turned against the axis of the cylinder; an irregular mesh \
    has no direction, other angles are other seeds. Every mesh has vertices and edges along the lines of the clamps. Measured at rest: the error of the bending \
    energy plus the energy of the membrane (zero in the smooth sheet), both relative to D κ² / 2 per area; the moment of the forces of the pins on one clamp, the root mean square distance of the vertices from their places on the cylinder.";

/// Side of the free square, metres, and length of the clamp at each end: a cell of the coarsest mesh.
const SIDE: f64 = 0.2;
const CLAMP: f64 = 0.05;

/// Curvature of the cylinder, 1/m: a bend by 1 radian.
const CURVATURE: f64 = 1.0 / SIDE;

/// Mass per area, kg/m2, and rate of damping, 1/s.
const DENSITY: f64 = 0.08;
const DAMPING: f64 = 4.0;

/// Steps of implicit Euler, seconds: long ones, which damp all motion. Time within which the clamps move.
const STEP: f64 = 0.05;
const MOVING: f64 = 1.0;

/// The sheet is at rest when no vertex is faster, metres per second. Halving the bound does not change the
/// first four digits of energy and moment.
const REST: f64 = 1e-5;

/// Relative errors below this are those of a sheet that has come to rest to within [`REST`].
const FLOOR: f64 = 1e-5;

/// Directions of the axis against the mesh, degrees.
pub(super) const DIRECTIONS: [f64; 5] = [0.0, 15.0, 22.5, 30.0, 45.0];

/// Squares along the side of the mesh at which the error is limited: M^3.
const JUDGED: usize = 16;

/// A sheet between the clamps, x = 0 and x = [`SIDE`] are their lines.
fn square(pattern: Pattern, cells: usize, degrees: f64) -> Result<Sheet> {
    let cell = SIDE / cells as f64;
    let (low, high) = ([-CLAMP, 0.0], [SIDE + CLAMP, SIDE]);
    let sheet = pattern.rectangle(low, high, cell, degrees.to_radians())?;
    with_line(&with_line(&sheet, 0.0, cell)?, SIDE, cell)
}

fn clamped(sheet: &Sheet) -> Vec<VertexId> {
    vertices(sheet, |[x, ..]| !(1e-9..=SIDE - 1e-9).contains(&x))
}

/// The place of the point (x, y) of the flat sheet when the part between the clamps has the curvature `k`.
fn place(k: f64, [x, y]: [f64; 2]) -> [f64; 3] {
    let s = x.clamp(0.0, SIDE);
    // (sin ks) / k and (1 - cos ks) / k = tan(ks / 2) (sin ks) / k.
    let along = if k == 0.0 { s } else { (k * s).sin() / k };
    let (sin, cos) = (k * s).sin_cos();
    let beyond = x - s;
    [
        along + beyond * cos,
        y,
        (0.5 * k * s).tan() * along + beyond * sin,
    ]
}

/// The sheet with the pins of the clamps, which move so that the exact cylinder fits between them at all
/// times.
fn model(isometry: Isometry, sheet: &Sheet, pins: &[VertexId]) -> Result<SheetModel> {
    let material = Material::plate(sheet, DENSITY, PAPER_RIGIDITY, pins);
    let mut model = isometry.model(sheet, material)?.with_damping(DAMPING)?;
    let curvature = Profile::SmoothStep {
        from: 0.0,
        to: CURVATURE,
        begin: 0.0,
        end: MOVING,
    };
    for &v in pins {
        let [x, y, _] = sheet.position(v);
        if x < 1e-9 {
            model = model.with_pins(&[v])?;
            continue;
        }
        let curvature = curvature.clone();
        model = model.with_moving_pin(v, move |t| place(curvature.value(t), [x, y]))?;
    }
    Ok(model)
}

/// A mesh: its pattern, squares along the side, and the angle of the axis against it, degrees.
type Mesh = (Pattern, usize, f64);

/// What is measured of a square at rest between the clamps.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Measured {
    /// Elastic energy, its part of bending, over that of the cylinder.
    energy: f64,
    bending: f64,
    /// Moment on the moving clamp, over that of the cylinder; known of a run that reached its end.
    moment: Option<f64>,
    /// Root mean square distance of the free vertices from their places on the cylinder, metres.
    distance: f64,
}

type Bent = Sample<Mesh, Measured>;

fn measure(isometry: Isometry, mesh: Mesh, plan: &Plan) -> Result<(usize, Course, Measured)> {
    let (pattern, cells, degrees) = mesh;
    let sheet = square(pattern, cells, degrees)?;
    let pins = clamped(&sheet);
    let scene = Scene::flat(model(isometry, &sheet, &pins)?, &sheet);
    let (course, end) = scene.by(implicit_euler()).run(plan)?;
    let elastic = model(isometry, &sheet, &pins)?.potential_energy(course.time, &end.x);
    let exact = 0.5 * PAPER_RIGIDITY * CURVATURE * CURVATURE * SIDE * SIDE;
    let bending = isometry.bending_energy(&sheet, (PAPER_RIGIDITY, &pins), &end.x)?;
    let measured = Measured {
        energy: elastic / exact,
        bending: bending / exact,
        moment: course.is_good().then(|| moment(&sheet, &end)),
        distance: distance(&sheet, &end.x),
    };
    Ok((sheet.topology().vertex_count(), course, measured))
}

impl Bent {
    fn spacing(&self) -> f64 {
        SIDE / self.job.1 as f64
    }

    /// The error of the bending energy plus the energy of the membrane, which is zero in the smooth sheet: of
    /// the sum of both energies the two errors would cancel on some meshes.
    fn energy_error(&self) -> Option<f64> {
        let Measured {
            energy, bending, ..
        } = self.measured;
        let error = (bending - 1.0).abs() + (energy - bending).abs();
        self.course.is_good().then_some(error)
    }

    fn moment_error(&self) -> Option<f64> {
        Some((self.measured.moment? - 1.0).abs())
    }
}

/// The moment of the pins on the moving clamp about its line, over D k per width; positive where it bends
/// towards +z.
fn moment(sheet: &Sheet, end: &End) -> f64 {
    let line = Vector3::from(place(CURVATURE, [SIDE, 0.0]));
    let mut moment = 0.0;
    for reaction in &end.reactions {
        let Support::Pin(v) = reaction.support else {
            continue;
        };
        if sheet.position(v)[0] > 0.5 * SIDE {
            let at: [f64; 3] = std::array::from_fn(|k| end.x[3 * v.index() + k]);
            // The right-handed moment about y turns +x towards -z.
            moment -= (Vector3::from(at) - line).cross(&reaction.force).y;
        }
    }
    moment / (PAPER_RIGIDITY * CURVATURE * SIDE)
}

fn distance(sheet: &Sheet, x: &[f64]) -> f64 {
    let free = vertices(sheet, |[x, ..]| x > 1e-9 && x < SIDE - 1e-9);
    let square = |v: &VertexId| {
        let [s, y, _] = sheet.position(*v);
        let exact = place(CURVATURE, [s, y]);
        (0..3)
            .map(|k| (x[3 * v.index() + k] - exact[k]).powi(2))
            .sum::<f64>()
    };
    (free.iter().map(square).sum::<f64>() / free.len() as f64).sqrt()
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let plan = Plan::new(STEP, 6.0)
        .within(effort.quick_or(0.3, 8.0))
        .until_rest(REST);
    let sizes: &[usize] = effort.quick_or(&[4], &[4, 8, 16, 32]);
    let directions: &[f64] = effort.quick_or(&[0.0, 22.5, 45.0], &DIRECTIONS);
    let mut meshes: Vec<Mesh> = Vec::new();
    for pattern in Pattern::ALL {
        for &degrees in directions {
            meshes.extend(sizes.iter().map(|&cells| (pattern, cells, degrees)));
        }
    }
    let run = |isometry, mesh: &Mesh| measure(isometry, *mesh, &plan);
    let all = records.of_models(|_| meshes.clone(), run)?;
    let findings = Findings {
        remarks: Isometry::ALL.map(|m| remark(m, &all)).to_vec(),
        tables: vec![orders(&all, directions), table(&all, &plan)],
        targets: requirements(&all, |of| targets(of, &all, directions)),
        files: Vec::new(),
    };
    Ok((findings, Some(plot(&all, directions, sizes))))
}

fn table(all: &[Bent], plan: &Plan) -> Table {
    Table::of(
        format!(
            "Squares bent by clamps: implicit Euler, steps of {STEP} s, until no vertex is faster than {REST} m/s or {} s are simulated; at most \
             {} s of wall time. Energies are over D κ² / 2 times the area, the moment is over D κ times the width",
            plan.duration,
            plan.patience
        ),
        all,
        &[
            ("mesh", &|b| b.job.0.to_string().into()),
            ("axis, degrees", &|b| b.job.2.into()),
            ("h, m", &|b| b.spacing().into()),
            ("V", &|b| b.vertices.into()),
            ("model", &|b| b.isometry.to_string().into()),
            ("ending", &|b| b.course.ending.name().into()),
            ("t at the end, s", &|b| b.course.time.into()),
            ("factorisations per step", &|b| b.course.cost.factorisations_per_step().into()),
            ("CPU s per simulated s", &|b| b.course.cpu_rate().into()),
            ("energy", &|b| b.measured.energy.into()),
            ("bending energy", &|b| b.measured.bending.into()),
            ("moment", &|b| b.measured.moment.into()),
            ("distance, m", &|b| b.measured.distance.into()),
            ("speed left, m/s", &|b| b.course.speed.into()),
            ("message", &|b| b.course.ending.message().into()),
        ],
    )
    .named("cylinder")
}

/// An error of a square that came to rest.
type Measure = fn(&Bent) -> Option<f64>;

/// The errors that are judged and drawn.
const ERRORS: [(&str, Measure); 2] = [
    ("energy", Bent::energy_error),
    ("moment", Bent::moment_error),
];

/// Fitted order of an error; nothing unless every mesh came to rest.
fn fitted(
    all: &[Bent],
    (isometry, pattern, degrees): (Isometry, Pattern, f64),
    error: Measure,
) -> Option<f64> {
    let of = OfModel::of(isometry, all).with(|job| (job.0, job.2) == (pattern, degrees));
    let points = of.all.iter().map(|b| Some([b.spacing(), error(b)?]));
    order(&points.collect::<Option<Vec<_>>>()?, FLOOR)
}

/// A model with every pattern in every direction.
fn combinations(isometry: Isometry, directions: &[f64]) -> Vec<(Isometry, Pattern, f64)> {
    let of = |p: Pattern| directions.iter().map(move |d| (isometry, p, *d));
    Pattern::ALL.into_iter().flat_map(of).collect()
}

fn orders(all: &[Bent], directions: &[f64]) -> Table {
    let models = Isometry::ALL.into_iter();
    Table::of(
        "Fitted powers of h of the errors of energy and moment where all runs came to rest; values below 1e-5 are left out",
        models.flat_map(|m| combinations(m, directions)),
        &[
            ("mesh", &|of| of.1.to_string().into()),
            ("axis, degrees", &|of| of.2.into()),
            ("model", &|of| of.0.to_string().into()),
            ("energy", &|of| fitted(all, *of, ERRORS[0].1).into()),
            ("moment", &|of| fitted(all, *of, ERRORS[1].1).into()),
        ],
    )
    .named("cylinder-orders")
}

fn targets(of: &OfModel<'_, Mesh, Measured>, all: &[Bent], directions: &[f64]) -> Vec<Target> {
    let judged = of.with(|job| job.1 == JUDGED);
    let two = |(name, error): (&str, Measure)| {
        let combinations = combinations(of.isometry, directions).into_iter();
        let powers: Vec<_> = combinations.map(|key| fitted(all, key, error)).collect();
        let order = format!("order of the error of the {name}, every mesh and direction");
        let size = format!("relative error of the {name} at M^3, every mesh and direction");
        [
            at_least(of.isometry, &order, 1.5, &powers),
            judged.at_most(&size, 0.05, error),
        ]
    };
    ERRORS.into_iter().flat_map(two).collect()
}

fn remark(isometry: Isometry, all: &[Bent]) -> String {
    let of = OfModel::of(isometry, all).all;
    let ended: Vec<&&Bent> = of.iter().filter(|b| b.course.is_good()).collect();
    let error = |b: &Bent| b.energy_error().unwrap_or(0.0);
    let worst = ended.iter().max_by(|a, b| error(a).total_cmp(&error(b)));
    let worst = worst.map_or(String::new(), |b| {
        let (pattern, cells, degrees) = b.job;
        format!(
            "; the worst energy is {} times the exact one ({pattern}, {cells} cells, axis at {degrees} degrees)",
            number(b.measured.energy)
        )
    });
    let (ended, all) = (ended.len(), of.len());
    format!("{isometry}: {ended} of {all} squares come to rest{worst}.")
}

/// The errors of energy and moment against the spacing, a panel for every direction.
fn plot(all: &[Bent], directions: &[f64], sizes: &[usize]) -> Charts {
    let rows = ERRORS.map(|(name, error)| {
        let panel = |&degrees: &f64| {
            let of = all.iter().filter(|b| b.job.2 == degrees);
            let dots = of.map(|b| Dot::of(b, b.job.0.number(), b.spacing(), error(b)));
            Panel::of_second_order(format!("axis at {degrees}°"), dots.collect())
        };
        let values = all.iter().filter_map(error).filter(|e| *e > FLOOR);
        let y = Axis::decades(&format!("error of the {name}"), values);
        (y, directions.iter().map(panel).collect())
    });
    let spacings: Vec<f64> = sizes.iter().map(|&n| SIDE / n as f64).collect();
    Figure::of_spacings(&spacings, rows.to_vec()).draw()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lengths along the sheet are kept, and the clamps stay flat, at every curvature.
    #[test]
    fn the_cylinder_is_isometric_and_the_clamps_are_flat() {
        for k in [0.0, 1e-9, 1.0, CURVATURE] {
            let n = 4000;
            let length: f64 = (0..n)
                .map(|i| {
                    let [a, b] = [i, i + 1].map(|i| {
                        let x = -CLAMP + (SIDE + 2.0 * CLAMP) * f64::from(i) / f64::from(n);
                        Vector3::from(place(k, [x, 0.3]))
                    });
                    (b - a).norm()
                })
                .sum();
            assert!((length - SIDE - 2.0 * CLAMP).abs() < 1e-7, "{k} {length}");
            let [a, b, c] =
                [0.0, 0.5, 1.0].map(|part| Vector3::from(place(k, [SIDE + part * CLAMP, 0.0])));
            assert!((0.5 * (a + c) - b).norm() < 1e-15);
        }
        // The curvature of the circle through three points of the arc.
        let [a, b, c] =
            [0.2, 0.5, 0.8].map(|part| Vector3::from(place(CURVATURE, [part * SIDE, 0.0])));
        let twice = (b - a).cross(&(c - a)).norm();
        let curvature = 2.0 * twice / ((b - a).norm() * (c - b).norm() * (c - a).norm());
        assert!((curvature / CURVATURE - 1.0).abs() < 1e-9);
    }

    /// The plate's energy at the exact places is that of the cylinder, to second order in the spacing.
    #[test]
    fn the_bending_energy_of_the_exact_places_converges() {
        let exact = 0.5 * PAPER_RIGIDITY * CURVATURE * CURVATURE * SIDE * SIDE;
        let error = |cells: usize| {
            let sheet = square(Pattern::UnionJack, cells, 22.5).unwrap();
            let pins = clamped(&sheet);
            let points = sheet.positions().as_chunks::<3>().0.iter();
            let x: Vec<f64> = points
                .flat_map(|p| place(CURVATURE, [p[0], p[1]]))
                .collect();
            let energy = Isometry::Paper.bending_energy(&sheet, (PAPER_RIGIDITY, &pins), &x);
            (energy.unwrap() / exact - 1.0).abs()
        };
        let [coarse, fine] = [8, 16].map(error);
        assert!(coarse < 0.03 && fine < 0.4 * coarse, "{coarse} {fine}");
    }

    /// On mesh lines a coarse elastic sheet has the energy of the cylinder, and pulls with its moment.
    #[test]
    fn an_aligned_sheet_has_energy_and_moment_of_the_cylinder() {
        let plan = Plan::new(STEP, 4.0).within(60.0).until_rest(REST);
        let job = (Pattern::UnionJack, 8, 0.0);
        let (vertices, course, measured) = measure(Isometry::Elastic, job, &plan).unwrap();
        let isometry = Isometry::Elastic;
        let bent = Bent {
            isometry,
            job,
            vertices,
            course,
            measured,
        };
        assert!(bent.course.is_good(), "{:?}", bent.course.ending);
        assert!(bent.moment_error().unwrap() < 0.05, "{bent:?}");
        assert!(bent.energy_error().unwrap() < 0.05, "{bent:?}");
    }
}
