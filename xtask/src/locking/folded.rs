//! Creases with known answers: a strip with one straight crease, an annulus with a curved one.

use super::grids::Grid;
use super::meshes::with_line;
use super::model::{Model, Plate, Tried, at_most};
use super::nudge::Nudge;
use super::records::Records;
use super::scene::Scene;
use super::{Findings, order};
use crate::draw::Charts;
use crate::report::{Table, extremes, number};
use crate::runs::Plan;
use anyhow::Result;
use isosheet_dynamics::{CreaseSpring, CreaseSprings, Potential, Profile};
use isosheet_mesh::{EdgeId, Sheet, VertexId, fold_angle, generate};
use isosheet_tests::implicit_euler;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};
use std::fmt;

pub(super) const ABOUT: &str = "Paper (5e-4 N m, 80 g/m², without weight and supports) with one crease, whose rest angle grows from 0 within 1 s. Straight: a strip of 100 mm x 25 mm with a crease across its \
    middle and a rest angle of 90 degrees; at rest it is folded by 90 degrees, its panels are flat and its energy is zero, whatever the stiffness of crease and sheet. Curved: an annulus with radii of 80 and 120 mm, \
    creased along the circle of R = 100 mm, rest angle 60 degrees; the panels are developable, so that the curvature of the crease in space is 1 / (R sin(θ/2)) with its dihedral angle θ at every place. (The moment of the crease stretches a strip of each panel beside it that is about as wide as the root of thickness times R, so that this is not exact for a sheet of finite thickness.) \
    Measured at rest: the angle between the outermost faces, and the elastic energy over that of the flat strip at the end; the largest and the mean relative error of that product of curvature, R and sin(θ/2) over the vertices of the crease.";

/// Strip and annulus, metres. Panels of half the radius fold over: the sheet is pinched at four places, where the
/// crease has corners and no curvature.
const LENGTH: f64 = 0.1;
const WIDTH: f64 = 0.025;
const RADIUS: f64 = 0.1;
const HALF: f64 = 0.02;

/// Mass per area (kg/m2), flexural rigidity (N m), rate of damping (1/s).
const DENSITY: f64 = 0.08;
const RIGIDITY: f64 = super::isometry::PAPER_RIGIDITY;
const DAMPING: f64 = 4.0;

/// Torsional stiffness of a metre of crease, N: soft and stiff against `D / h` = 0.04 to 0.16 N.
const STIFFNESSES: [f64; 2] = [0.01, 1.0];

/// Steps of implicit Euler, seconds; how long the rest angle grows, and how long forces on the annulus choose
/// its saddle.
const STEP: f64 = 0.05;
const FOLDING: f64 = 1.0;
const NUDGED: f64 = 1.0;

/// The forces on the annulus in total over `D / R`.
const NUDGE: f64 = 1.0;

/// The sheet is at rest when no vertex is faster, metres per second: an angle changes by less than 1e-4
/// degrees within a second.
const REST: f64 = 1e-7;

/// What is folded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Shape {
    Straight(Grid),
    Curved,
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Straight(grid) => write!(f, "strip, {grid}"),
            Self::Curved => f.write_str("annulus"),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Job {
    shape: Shape,
    /// Squares across the strip, or across one panel of the annulus.
    across: usize,
    /// Stiffness of a metre of crease, N.
    stiffness: f64,
}

impl Job {
    fn spacing(self) -> f64 {
        let width = match self.shape {
            Shape::Straight(_) => WIDTH,
            Shape::Curved => HALF,
        };
        width / self.across as f64
    }

    /// The fold angle at rest, radians.
    fn rest(self) -> f64 {
        match self.shape {
            Shape::Straight(_) => 0.5 * PI,
            Shape::Curved => PI / 3.0,
        }
    }

    fn sheet(self) -> Result<Sheet> {
        match self.shape {
            Shape::Straight(grid) => {
                let cell = self.spacing();
                let sheet = grid.rectangle([0.0; 2], [LENGTH, WIDTH], cell)?;
                with_line(&sheet, 0.5 * LENGTH, cell)
            }
            Shape::Curved => {
                let segments = (TAU * RADIUS / self.spacing()).round() as usize;
                let radii = [RADIUS - HALF, RADIUS + HALF];
                Ok(generate::annulus(
                    segments,
                    2 * self.across,
                    radii[0],
                    radii[1],
                )?)
            }
        }
    }

    /// The edges of the crease.
    fn crease(self, sheet: &Sheet) -> Vec<EdgeId> {
        let is_on = |v: VertexId| {
            let [x, y, _] = sheet.position(v);
            let off = match self.shape {
                Shape::Straight(_) => x - 0.5 * LENGTH,
                Shape::Curved => x.hypot(y) - RADIUS,
            };
            off.abs() < 1e-9
        };
        let t = sheet.topology();
        let edges = t.edge_ids();
        edges
            .filter(|e| t.edges()[e.index()].iter().all(|v| is_on(*v)))
            .collect()
    }

    fn springs(self, sheet: &Sheet, crease: &[EdgeId]) -> Result<CreaseSprings> {
        let spring = |&edge: &EdgeId| CreaseSpring {
            edge,
            stiffness: self.stiffness * sheet.lengths()[edge.index()],
            rest: Profile::SmoothStep {
                from: 0.0,
                to: self.rest(),
                begin: 0.0,
                end: FOLDING,
            }
            .into(),
            yields: None,
        };
        let mut springs: Vec<CreaseSpring> = crease.iter().map(spring).collect();
        CreaseSpring::put_in_sheet(&mut springs, sheet, RIGIDITY);
        Ok(CreaseSprings::new(sheet.topology(), springs)?)
    }

    /// Forces that bend the annulus to a saddle: up at both ends of the x axis, down at those of the y axis.
    fn nudge(self, sheet: &Sheet) -> Nudge {
        let rim = sheet.topology().vertex_ids().filter(|v| {
            let [x, y, _] = sheet.position(*v);
            self.shape == Shape::Curved && x.hypot(y) > RADIUS + HALF - 1e-9
        });
        let rim: Vec<VertexId> = rim.collect();
        let unit = NUDGE * RIGIDITY / RADIUS / rim.len().max(1) as f64;
        let force = |v: VertexId| {
            let [x, y, _] = sheet.position(v);
            (v, unit * (2.0 * y.atan2(x)).cos())
        };
        Nudge {
            forces: rim.into_iter().map(force).collect(),
            end: NUDGED,
        }
    }
}

/// What is measured of a folded sheet at rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Folded {
    /// Mean fold angle of the crease, and of a strip that between its ends, degrees.
    crease: f64,
    ends: Option<f64>,
    /// Elastic energy with that of the crease, over that of the flat sheet.
    energy: f64,
    /// Of an annulus: the largest and the mean error of the curvature of the crease.
    curvature: Option<[f64; 2]>,
}

type Fold = Tried<Job, Folded>;

fn plate(creases: &[EdgeId]) -> Plate<'_> {
    Plate {
        density: DENSITY,
        rigidity: RIGIDITY,
        clamped: &[],
        creases,
    }
}

fn measure(model: Model, job: Job, plan: &Plan) -> Result<Fold> {
    let sheet = job.sheet()?;
    let crease = job.crease(&sheet);
    let moved = model
        .sheet(&sheet, plate(&crease))?
        .with_damping(DAMPING)?
        .with_potential(job.springs(&sheet, &crease)?)
        .with_potential(job.nudge(&sheet));
    let scene = Scene::flat(moved, &sheet).by(implicit_euler());
    let (course, end) = scene.run(plan)?;
    let springs = job.springs(&sheet, &crease)?;
    let elastic = model.energy(&sheet, plate(&crease), &end.x)? + springs.energy(FOLDING, &end.x);
    let angles = crease
        .iter()
        .filter_map(|e| fold_angle(sheet.topology(), &end.x, *e));
    let mean = angles.clone().sum::<f64>() / angles.count() as f64;
    Ok(Tried {
        model,
        job,
        vertices: sheet.topology().vertex_count(),
        course,
        measured: Folded {
            crease: mean.to_degrees(),
            ends: matches!(job.shape, Shape::Straight(_)).then(|| between_ends(&sheet, &end.x)),
            energy: elastic / springs.energy(FOLDING, sheet.positions()),
            curvature: (job.shape == Shape::Curved)
                .then(|| curvature_errors(&sheet, &crease, &end.x)),
        },
    })
}

fn at(x: &[f64], v: VertexId) -> Vector3<f64> {
    Vector3::from_column_slice(&x[3 * v.index()..3 * v.index() + 3])
}

/// The angle between the mean normals of the outermost quarters of the strip, degrees.
fn between_ends(sheet: &Sheet, x: &[f64]) -> f64 {
    let mean = |is_there: fn(f64) -> bool| {
        let faces = sheet.topology().faces().iter();
        let there = faces.filter(|f| f.iter().all(|v| is_there(sheet.position(*v)[0])));
        let normal = |f: &[VertexId; 3]| {
            let [a, b, c] = f.map(|v| at(x, v));
            (b - a).cross(&(c - a))
        };
        there.map(normal).sum::<Vector3<f64>>()
    };
    let [low, high] = [mean(|x| x < 0.26 * LENGTH), mean(|x| x > 0.74 * LENGTH)];
    low.angle(&high).to_degrees()
}

/// The largest and the mean difference from 1 of curvature times `R sin(theta / 2)` over the vertices of the
/// crease. The curvature is the angle between the two edges at a vertex over their mean length, the dihedral
/// angle `theta` the mean of those of both.
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

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let sizes: &[usize] = effort.quick_or(&[2], &[2, 4, 8]);
    let grids: &[Grid] = effort.quick_or(&[Grid::Delaunay(1)], &Grid::ALL);
    let plan = Plan::new(STEP, 30.0)
        .within(effort.quick_or(1.0, 120.0))
        .until_rest(REST);
    let mut jobs = Vec::new();
    for shape in grids
        .iter()
        .map(|g| Shape::Straight(*g))
        .chain([Shape::Curved])
    {
        for stiffness in STIFFNESSES {
            jobs.extend(sizes.iter().map(|&across| Job {
                shape,
                across,
                stiffness,
            }));
        }
    }
    let mut all: Vec<Fold> = Vec::new();
    for model in Model::ALL {
        let run = |job: &Job| measure(model, *job, &plan);
        all.extend(records.runs(&model.to_string(), &jobs, run)?);
    }
    let mut targets = Vec::new();
    for model in Model::ALL {
        let of: Vec<&Fold> = all.iter().filter(|f| f.model == model).collect();
        let straight = || of.iter().filter(|f| f.job.shape != Shape::Curved);
        let angles: Vec<Option<f64>> = straight()
            .map(|f| f.if_good(|m| (m.ends.unwrap_or(f64::NAN) - 90.0).abs()))
            .collect();
        let energies: Vec<Option<f64>> = straight().map(|f| f.if_good(|m| m.energy)).collect();
        let finest = sizes.last();
        let curved: Vec<Option<f64>> = of
            .iter()
            .filter(|f| f.job.shape == Shape::Curved && Some(&f.job.across) == finest)
            .map(|f| f.if_good(|m| m.curvature.map_or(f64::NAN, |c| c[1])))
            .collect();
        targets.extend([
            at_most(
                model,
                "error of the angle of straight creases, degrees",
                1e-3,
                &angles,
            ),
            at_most(
                model,
                "energy of folded strips over that of flat ones",
                1e-6,
                &energies,
            ),
            at_most(
                model,
                "mean error of the curvature of the curved crease, finest meshes",
                0.02,
                &curved,
            ),
        ]);
    }
    let findings = Findings {
        tables: vec![straight(&all, sizes), curved(&all)],
        files: vec![table(&all)],
        remarks: Model::ALL.map(|m| remark(m, &all)).to_vec(),
        targets,
    };
    Ok((findings, None))
}

fn straight(all: &[Fold], sizes: &[usize]) -> Table {
    let mut rows = Vec::new();
    for stiffness in STIFFNESSES {
        for &across in sizes {
            rows.extend(Model::ALL.map(|model| (stiffness, across, model)));
        }
    }
    let of = |&(stiffness, across, model): &(f64, usize, Model)| {
        let is_of = move |f: &&Fold| {
            let job = &f.job;
            let same = (job.stiffness, job.across, f.model) == (stiffness, across, model);
            same && job.shape != Shape::Curved
        };
        all.iter().filter(is_of).collect::<Vec<_>>()
    };
    let ends = |folds: &[&Fold]| {
        extremes(
            folds
                .iter()
                .filter_map(|f| f.if_good(|m| m.ends.unwrap_or(f64::NAN))),
        )
    };
    let energy = |folds: &[&Fold]| extremes(folds.iter().filter_map(|f| f.if_good(|m| m.energy)));
    Table::of(
        "Strips with one crease of rest angle 90 degrees: the angle between the ends on all kinds of meshes",
        rows,
        &[
            ("crease, N", &|r| r.0.into()),
            ("squares across", &|r| r.1.into()),
            ("model", &|r| r.2.to_string().into()),
            ("at rest", &|r| of(r).iter().filter(|f| f.course.is_good()).count().into()),
            ("least angle", &|r| ends(&of(r)).map(|e| e[0]).into()),
            ("largest angle", &|r| ends(&of(r)).map(|e| e[1]).into()),
            ("largest energy", &|r| energy(&of(r)).map(|e| e[1]).into()),
        ],
    )
    .named("creases")
}

fn curved(all: &[Fold]) -> Table {
    let of = |f: &&Fold| f.job.shape == Shape::Curved;
    let power = |f: &&Fold| {
        let same = |g: &&Fold| {
            (g.model, g.job.shape, g.job.stiffness) == (f.model, f.job.shape, f.job.stiffness)
        };
        let point = |g: &Fold| {
            Some([
                g.job.spacing(),
                g.if_good(|m| m.curvature.map_or(f64::NAN, |c| c[1]))?,
            ])
        };
        let points: Vec<[f64; 2]> = all.iter().filter(same).filter_map(point).collect();
        order(&points, 0.0)
    };
    Table::of(
        "Annuli with a curved crease: curvature of the crease times R sin(θ/2), minus 1; with the fitted power of h of its mean",
        all.iter().filter(of),
        &[
            ("crease, N", &|f| f.job.stiffness.into()),
            ("h, mm", &|f| (1e3 * f.job.spacing()).into()),
            ("V", &|f| f.vertices.into()),
            ("model", &|f| f.model.to_string().into()),
            ("ending", &|f| f.course.ending.name().into()),
            ("fold, degrees", &|f| f.measured.crease.into()),
            ("largest error", &|f| f.measured.curvature.map(|c| c[0]).into()),
            ("mean error", &|f| f.measured.curvature.map(|c| c[1]).into()),
            ("power", &|f| power(f).into()),
        ],
    )
    .named("curved-creases")
}

fn table(all: &[Fold]) -> Table {
    Table::of(
        "Every fold",
        all,
        &[
            ("sheet", &|f| f.job.shape.to_string().into()),
            ("crease, N", &|f| f.job.stiffness.into()),
            ("across", &|f| f.job.across.into()),
            ("V", &|f| f.vertices.into()),
            ("model", &|f| f.model.to_string().into()),
            ("ending", &|f| f.course.ending.name().into()),
            ("factorisations", &|f| f.course.cost.factorisations.into()),
            ("crease, degrees", &|f| f.measured.crease.into()),
            ("ends, degrees", &|f| f.measured.ends.into()),
            ("energy", &|f| f.measured.energy.into()),
            ("largest strain of an edge", &|f| f.course.strain.into()),
            ("message", &|f| f.course.ending.message().into()),
        ],
    )
    .named("creases-all")
}

fn remark(model: Model, all: &[Fold]) -> String {
    let of: Vec<&Fold> = all.iter().filter(|f| f.model == model).collect();
    let ended = of.iter().filter(|f| f.course.is_good()).count();
    let off = of
        .iter()
        .filter_map(|f| f.if_good(|m| m.ends.map_or(0.0, |e| (e - 90.0).abs())));
    let worst = extremes(off).map_or(String::new(), |[_, high]| {
        format!(
            "; straight creases rest at 90 degrees to within {}",
            number(high)
        )
    });
    format!(
        "{model}: {ended} of {} sheets come to rest{worst}.",
        of.len()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn creases_are_whole_lines() {
        for shape in Grid::ALL
            .map(Shape::Straight)
            .into_iter()
            .chain([Shape::Curved])
        {
            let job = Job {
                shape,
                across: 4,
                stiffness: 1.0,
            };
            let sheet = job.sheet().unwrap();
            let crease = job.crease(&sheet);
            let length: f64 = crease.iter().map(|e| sheet.lengths()[e.index()]).sum();
            let whole = match shape {
                Shape::Straight(_) => WIDTH,
                Shape::Curved => TAU * RADIUS,
            };
            assert!((length / whole - 1.0).abs() < 2e-3, "{shape}: {length}");
        }
    }

    /// A polygon of 100 corners in the plane has the curvature of its circle.
    #[test]
    fn flat_annuli_have_the_curvature_of_their_circle() {
        let job = Job {
            shape: Shape::Curved,
            across: 8,
            stiffness: 1.0,
        };
        let sheet = job.sheet().unwrap();
        let [largest, _] = curvature_errors(&sheet, &job.crease(&sheet), sheet.positions());
        assert!(largest < 1e-3, "{largest}");
    }
}
