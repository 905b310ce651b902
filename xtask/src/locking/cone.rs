//! A disk that is pushed into a ring: the developable cone.

use super::Findings;
use super::cone_mesh::{Kind, Mesh, RADIUS, rim};
use super::meshes::{nearest, vertices};
use super::model::{Model, Plate, Tried, at_most};
use super::nudge::{Nudge, Ring};
use super::panels::{BANDS, Panel, charts};
use super::records::Records;
use super::scene::Scene;
use crate::draw::{Axis, Charts};
use crate::report::{Table, extremes, number};
use crate::runs::Plan;
use anyhow::Result;
use isosheet_dynamics::{PointProfile, Profile, SheetModel};
use isosheet_mesh::Sheet;
use isosheet_tests::implicit_euler;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

pub(super) const ABOUT: &str = "A disk of office paper (radius R = 0.1 m, 5e-4 N m, without weight) lies with its rim on a frictionless ring and is pushed into it at its \
    centre by d = 0.1 R within 2 s. It comes to rest as a developable cone: one fold leaves the ring, the other vertices of the rim stay on it. For small d / R the \
    fold spans 139 degrees in theory (Cerda and Mahadevan, Phys. Rev. Lett. 80, 1998); at d / R = 0.1 and with a core of finite size the sector is smaller. Upward forces on a tenth of the rim, which are gone after \
    2.5 s, choose the place of the fold. Measured at rest: folds that lift off by more than 0.1 d, the angle over which the rim is more than 0.02 d above the ring, and the elastic energy over D (d / R)². \
    The reference has the stiffness of the material on an irregular mesh with half the spacing (four times as many vertices); the elastic sheet on that mesh stands beside it.";

/// Depth, metres.
const DEPTH: f64 = 0.1 * RADIUS;

/// Mass per area (kg/m2), flexural rigidity (N m), rate of damping (1/s).
const DENSITY: f64 = 0.08;
const RIGIDITY: f64 = super::isometry::PAPER_RIGIDITY;
const DAMPING: f64 = 4.0;

/// Steps of implicit Euler, seconds; how long the centre moves, and when the forces that choose the place of
/// the fold are gone.
const STEP: f64 = 0.05;
const MOVING: f64 = 2.0;
const NUDGED: f64 = 2.5;

/// The disk is at rest when no vertex is faster, metres per second.
const REST: f64 = 1e-5;

/// Stiffness of the ring at a vertex over `D / R^2`: the forces at the ends of the fold, about 10 D / R,
/// press them by 1e-4 R into the ring, a thousandth of the depth.
const STIFF: f64 = 1e5;

/// The nudge in total over `D / R`: some part of the force that the centre needs, 24 D / R.
const NUDGE: f64 = 3.0;

/// Lifts above the ring, as parts of the depth, that end a fold and that make one.
const ENDS: f64 = 0.02;
const FOLDS: f64 = 0.1;

/// What is measured at rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Cone {
    /// Elastic energy over `D (d / R)^2`, and the part of it that is in the plane.
    energy: f64,
    membrane: f64,
    folds: usize,
    /// Degrees over which the rim is above the ring.
    sector: f64,
    /// Largest lift over the depth.
    lift: f64,
}

type Pushed = Tried<Mesh, Cone>;

fn plate() -> Plate<'static> {
    Plate {
        density: DENSITY,
        rigidity: RIGIDITY,
        clamped: &[],
        creases: &[],
    }
}

fn model(of: Model, sheet: &Sheet) -> Result<SheetModel> {
    let tip = nearest(sheet, [0.0; 2]);
    let down = Profile::SmoothStep {
        from: 0.0,
        to: -DEPTH,
        begin: 0.0,
        end: MOVING,
    };
    let motion = PointProfile {
        offset: sheet.position(tip),
        z: down,
        ..PointProfile::default()
    };
    let nudged = vertices(sheet, |[x, y, _]| {
        x.hypot(y) > 0.97 * RADIUS && y.atan2(x).abs() < 0.05 * TAU
    });
    let force = NUDGE * RIGIDITY / RADIUS / nudged.len().max(1) as f64;
    let nudge = Nudge {
        forces: nudged.into_iter().map(|v| (v, force)).collect(),
        end: NUDGED,
    };
    let ring = Ring {
        rim: rim(sheet),
        stiffness: STIFF * RIGIDITY / (RADIUS * RADIUS),
    };
    let sheet = of.sheet(sheet, plate())?.with_damping(DAMPING)?;
    Ok(sheet
        .with_potential(ring)
        .with_potential(nudge)
        .with_moving_pin(tip, motion)?)
}

fn measure(of: Model, mesh: Mesh, plan: &Plan) -> Result<Pushed> {
    let sheet = mesh.disk()?;
    let scene = Scene::flat(model(of, &sheet)?, &sheet).by(implicit_euler());
    let (course, end) = scene.run(plan)?;
    let unit = RIGIDITY * (DEPTH / RADIUS).powi(2);
    let energy = of.energy(&sheet, plate(), &end.x)? / unit;
    let bending = of.bending_energy(&sheet, plate(), &end.x)? / unit;
    let lifts: Vec<[f64; 2]> = rim(&sheet)
        .into_iter()
        .map(|v| {
            let [x, y, _] = sheet.position(v);
            [y.atan2(x), end.x[3 * v.index() + 2] / DEPTH]
        })
        .collect();
    Ok(Tried {
        model: of,
        job: mesh,
        vertices: sheet.topology().vertex_count(),
        course,
        measured: Cone {
            energy,
            membrane: energy - bending,
            folds: arcs(&lifts, ENDS).filter(|arc| arc.lift > FOLDS).count(),
            sector: arcs(&lifts, ENDS).fold(0.0, |sum, arc| sum + arc.angle.to_degrees()),
            lift: lifts.iter().map(|l| l[1]).fold(0.0, f64::max),
        },
    })
}

/// A part of the rim above the ring.
#[derive(Clone, Copy, Debug)]
struct Arc {
    /// Radians.
    angle: f64,
    /// The largest lift.
    lift: f64,
}

/// The parts of the rim whose lifts are above `bound`, between places that are interpolated; `lifts` are
/// angles and lifts around the rim, in order.
fn arcs(lifts: &[[f64; 2]], bound: f64) -> impl Iterator<Item = Arc> {
    let n = lifts.len();
    // Begin on the ring, if any vertex is there.
    let start = lifts.iter().position(|l| l[1] <= bound);
    let mut arcs = Vec::new();
    let mut open: Option<Arc> = None;
    for k in 0..n {
        let [(a, low), (b, high)] = [k, k + 1].map(|i| {
            let [angle, lift] = lifts[(start.unwrap_or(0) + i) % n];
            (angle, lift)
        });
        let width = (b - a).rem_euclid(TAU);
        let part = ((bound - low) / (high - low)).clamp(0.0, 1.0);
        match (low > bound, high > bound) {
            (false, false) => {}
            (false, true) => {
                open = Some(Arc {
                    angle: width * (1.0 - part),
                    lift: high,
                });
            }
            (true, _) => {
                let arc = open.get_or_insert(Arc {
                    angle: 0.0,
                    lift: low,
                });
                arc.lift = arc.lift.max(high);
                arc.angle += if high > bound { width } else { width * part };
                if high <= bound {
                    arcs.extend(open.take());
                }
            }
        }
    }
    arcs.extend(open);
    arcs.into_iter()
}

/// The reference: an irregular mesh.
const REFERENCE: Kind = Kind::Delaunay(1);

/// The plan of a run, with at most so many seconds of wall time.
fn plan(patience: f64) -> Plan {
    Plan::new(STEP, 20.0).within(patience).until_rest(REST)
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let sizes: &[usize] = effort.quick_or(&[4], &[6, 10, 16]);
    let judged = sizes.last().copied().unwrap_or(1);
    let kinds = effort.quick_or(&Kind::ALL[2..3], &Kind::ALL[..]);
    let meshes: Vec<Mesh> = kinds
        .iter()
        .flat_map(|&kind| sizes.iter().map(move |&rings| Mesh { kind, rings }))
        .collect();
    let finest = Mesh {
        kind: REFERENCE,
        rings: 2 * judged,
    };
    let limits = plan(effort.quick_or(1.0, 40.0));
    let reference = records.runs("reference", &[finest], |mesh| {
        measure(Model::Material, *mesh, &plan(effort.quick_or(5.0, 1200.0)))
    })?;
    let mut all: Vec<Pushed> = Vec::new();
    for of in Model::ALL {
        let run = |mesh: &Mesh| measure(of, *mesh, &limits);
        all.extend(records.runs(&of.to_string(), &meshes, run)?);
    }
    let best = reference.first().filter(|r| r.course.is_good());
    let best = best.map(|r| r.measured.clone());
    let off = |value: fn(&Cone) -> f64, of: &Pushed| {
        let exact = best.as_ref().map(value)?;
        of.if_good(|cone| (value(cone) / exact - 1.0).abs())
    };
    let targets = Model::ALL.into_iter().flat_map(|model| {
        let of: Vec<&Pushed> = all
            .iter()
            .filter(|p| p.model == model && p.job.rings == judged)
            .collect();
        let worst = |quantity: &str, bound: f64, value: &dyn Fn(&Pushed) -> Option<f64>| {
            let values: Vec<Option<f64>> = of.iter().map(|p| value(p)).collect();
            at_most(model, quantity, bound, &values)
        };
        [
            worst(
                "folds besides the one of theory, finest meshes",
                0.0,
                &|p| p.if_good(|cone| (cone.folds as f64 - 1.0).abs()),
            ),
            worst(
                "difference of the sector from the reference, finest meshes",
                0.1,
                &|p| off(|cone| cone.sector, p),
            ),
            worst(
                "difference of the energy from the reference, finest meshes",
                0.1,
                &|p| off(|cone| cone.energy, p),
            ),
        ]
    });
    let targets = targets.collect();
    all.extend(
        records.runs("elastic beside the reference", &[finest], |mesh| {
            measure(Model::Elastic, *mesh, &plan(effort.quick_or(5.0, 1200.0)))
        })?,
    );
    all.extend(reference);
    let sizes = [sizes, &[finest.rings]].concat();
    let findings = Findings {
        tables: vec![table(&all)],
        files: Vec::new(),
        remarks: Model::ALL
            .map(|m| remark(m, &all))
            .into_iter()
            .chain([BANDS.to_owned()])
            .collect(),
        targets,
    };
    Ok((findings, Some(plot(&all, &sizes))))
}

fn table(all: &[Pushed]) -> Table {
    Table::of(
        format!("Disks pushed into a ring: implicit Euler, steps of {STEP} s, until no vertex is faster than {REST} m/s. The last row is the reference"),
        all,
        &[
            ("mesh", &|p| p.job.kind.to_string().into()),
            ("R/h", &|p| p.job.rings.into()),
            ("V", &|p| p.vertices.into()),
            ("model", &|p| p.model.to_string().into()),
            ("ending", &|p| p.course.ending.name().into()),
            ("folds", &|p| p.measured.folds.into()),
            ("sector, degrees", &|p| p.measured.sector.into()),
            ("lift / d", &|p| p.measured.lift.into()),
            ("energy / (D (d/R)²)", &|p| p.measured.energy.into()),
            ("in the plane", &|p| p.measured.membrane.into()),
            ("largest strain of an edge", &|p| p.course.strain.into()),
            ("factorisations", &|p| p.course.cost.factorisations.into()),
            ("CPU seconds", &|p| p.course.cost.cpu.into()),
            ("message", &|p| p.course.ending.message().into()),
        ],
    )
    .named("d-cone")
}

fn remark(model: Model, all: &[Pushed]) -> String {
    let of: Vec<&Pushed> = all.iter().filter(|p| p.model == model).collect();
    let ended = of.iter().filter(|p| p.course.is_good());
    let one = ended.clone().filter(|p| p.measured.folds == 1).count();
    let energies = extremes(ended.clone().map(|p| p.measured.energy));
    let energies = energies.map_or(String::new(), |[low, high]| {
        format!(", with energies from {} to {}", number(low), number(high))
    });
    format!(
        "{model}: {} of {} disks come to rest, {one} of them with one fold{energies}.",
        ended.count(),
        of.len()
    )
}

/// Energy and sector against the spacing.
fn plot(all: &[Pushed], sizes: &[usize]) -> Charts {
    let ticks = sizes.iter().map(|&n| {
        let h = RADIUS / n as f64;
        (h, number(1e3 * h))
    });
    let x = Axis::at("h, mm", ticks.collect());
    let panel = |title: &str, y: Axis, value: fn(&Cone) -> f64| {
        let point = |p: &Pushed| {
            let at = [RADIUS / p.job.rings as f64, p.if_good(value)?];
            Some((p.model, at))
        };
        let exact = all.last().and_then(|p| p.if_good(value));
        let ends = |exact: f64| {
            let ends = [sizes.first(), sizes.last()].into_iter().flatten();
            ends.map(|&n| [RADIUS / n as f64, exact]).collect()
        };
        Panel {
            title: title.to_owned(),
            axes: [x.clone(), y],
            points: all.iter().filter_map(point).collect(),
            guides: exact.map(ends).into_iter().collect(),
        }
    };
    let row = vec![
        panel(
            "energy / (D (d/R)²)",
            Axis::linear("", [0.0, 250.0]),
            |c| c.energy,
        ),
        panel("sector, degrees", Axis::linear("", [0.0, 180.0]), |c| {
            c.sector
        }),
    ];
    charts(vec![row], &Model::ALL, "reference")
}

/// The disk on the irregular mesh with another bound of the stiffness.
pub(super) fn with_bound(bound: Model, rings: usize, patience: f64) -> Result<Bounded> {
    let mesh = Mesh {
        kind: REFERENCE,
        rings,
    };
    let pushed = measure(bound, mesh, &plan(patience))?;
    Ok(Bounded {
        vertices: pushed.vertices,
        energy: pushed.if_good(|c| c.energy),
        membrane: pushed.if_good(|c| c.membrane),
        sector: pushed.if_good(|c| c.sector),
        folds: pushed.measured.folds,
        factorisations: pushed.course.cost.factorisations,
    })
}

/// What [`with_bound`] finds; no numbers where the disk does not come to rest.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Bounded {
    pub(super) vertices: usize,
    pub(super) energy: Option<f64>,
    pub(super) membrane: Option<f64>,
    pub(super) sector: Option<f64>,
    pub(super) folds: usize,
    pub(super) factorisations: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two parts of a rim of eight vertices are above, one of them over the end of the list.
    #[test]
    fn arcs_are_counted_around_the_rim() {
        let lifts = [1.0, 1.0, 0.0, 0.0, 3.0, 0.0, 0.0, 1.0];
        let around: Vec<[f64; 2]> = lifts
            .iter()
            .enumerate()
            .map(|(k, &lift)| [TAU * k as f64 / 8.0, lift])
            .collect();
        let found: Vec<Arc> = arcs(&around, 0.5).collect();
        assert_eq!(found.len(), 2);
        let eighth = TAU / 8.0;
        assert!((found[0].angle - eighth * (5.0 / 6.0) * 2.0).abs() < 1e-12);
        assert!((found[1].angle - eighth * 3.0).abs() < 1e-12, "{found:?}");
        assert_eq!((found[0].lift, found[1].lift), (3.0, 1.0));
        assert_eq!(arcs(&around, 4.0).count(), 0);
        let whole: Vec<Arc> = arcs(&around, -1.0).collect();
        assert!((whole[0].angle - TAU).abs() < 1e-12);
    }
}
