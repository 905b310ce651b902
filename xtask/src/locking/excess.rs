//! A disk with an inserted wedge: the excess cone.

use super::cone_mesh::{Kind, Mesh, RADIUS};
use super::model::{Model, Plate, Tried, at_most};
use super::panels::{BANDS, Panel, charts};
use super::records::Records;
use super::scene::Scene;
use super::{Findings, order};
use crate::draw::{Axis, Charts};
use crate::report::{Cell, Table, extremes, number};
use crate::runs::Plan;
use anyhow::Result;
use isosheet_mesh::{FlatCut, Sheet};
use isosheet_tests::ExcessCone;
use isosheet_tests::implicit_euler;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, TAU};

pub(super) const ABOUT: &str = "A disk of office paper (radius R = 0.1 m, 5e-4 N m, without weight and supports) with a wedge of φ = 0.3 rad inserted, so that the angles about its centre are 2π + φ together. It starts as a pyramid of four flat sectors, whose edges go up and down in turn; the rest lengths \
    are those of the pyramid, and nothing resists its becoming flat at the edges. Inextensible, the disk comes to rest as a cone over an elastic curve of the sphere with two folds up and two down. For small φ its energy between the radii a and b is 3 D φ ln(b / a) (Müller, Ben Amar and Guven, Phys. Rev. Lett. 101, 156104, 2008); for φ = 0.3 the curve is computed. \
    Measured at rest: the elastic energy over D, where faces within R/4 of the centre do not count, those beyond R/2 do, and those between in part, so that the exact value is that of ln(b / a) = 1; and the root mean square of the distances from the nearest exact cone over the height of its folds.";

/// The wedge, radians: 17 degrees. The folds are 14 degrees high.
const EXCESS: f64 = 0.3;

/// Parts of the radius from which faces count and from which they count in full, with a weight between that is linear
/// in the radius: the tip, which no mesh resolves, is left out. The energy of a thin ring is in proportion to
/// `dr / r`, and the integral of the weight over `dr / r` is `(1 - ln 2) + ln 2 = 1`.
const COUNTED: [f64; 2] = [0.25, 0.5];

/// Mass per area (kg/m2), flexural rigidity (N m), rate of damping (1/s).
const DENSITY: f64 = 0.08;
const RIGIDITY: f64 = super::isometry::PAPER_RIGIDITY;
const DAMPING: f64 = 4.0;

/// Steps of implicit Euler, seconds.
const STEP: f64 = 0.05;

/// The disk is at rest when no vertex is faster, metres per second.
const REST: f64 = 1e-5;

/// Relative errors below this are those of a sheet that has come to rest to within [`REST`].
const FLOOR: f64 = 1e-4;

/// Vertices nearer to an axis than this part of the spacing are moved onto it before the disk is cut there.
const SNAP: f64 = 0.25;

/// The place in the disk with the wedge: distance from the centre (metres) and angle (radians, of `2 pi + phi`).
type Place = [f64; 2];

/// A disk with a wedge, folded to a pyramid: the angles of the flat disk are stretched, and every face lies in one of
/// four flat sectors.
fn pyramid(mesh: Mesh) -> Result<(Sheet, Vec<Place>)> {
    let mut cut = FlatCut::of(&mesh.disk()?);
    for normal in [[1.0, 0.0], [0.0, 1.0]] {
        cut.split([0.0; 2], normal, SNAP * RADIUS / mesh.rings as f64);
    }
    let flat = cut.sheet()?;
    let place = |&[x, y, _]: &[f64; 3]| {
        // (The angle of a vertex on the first ray may be -1e-17.)
        let angle = y.atan2(x).rem_euclid(TAU) % TAU;
        [x.hypot(y), angle * (TAU + EXCESS) / TAU]
    };
    let places: Vec<Place> = flat
        .positions()
        .as_chunks::<3>()
        .0
        .iter()
        .map(place)
        .collect();
    let points = places.iter().flat_map(|p| <[f64; 3]>::from(folded(*p)));
    let sheet = Sheet::from_topology(flat.topology().clone(), points.collect())?;
    Ok((sheet, places))
}

/// The place on the pyramid, metres.
fn folded([radius, angle]: Place) -> Vector3<f64> {
    let sector = FRAC_PI_2 + 0.25 * EXCESS;
    // Edges above and below the axes in turn: any two neighbours include the angle of a sector.
    let edge = |k: f64| {
        let (sin, cos) = (k * FRAC_PI_2).sin_cos();
        let height = (-sector.cos()).sqrt() * if k % 2.0 == 0.0 { 1.0 } else { -1.0 };
        let level = (1.0 - height * height).sqrt();
        Vector3::new(level * cos, level * sin, height)
    };
    let number = (angle / sector).floor();
    let [first, second] = [number, number + 1.0].map(edge);
    let across = (second - first * first.dot(&second)).normalize();
    let (sin, cos) = (angle - number * sector).sin_cos();
    radius * (cos * first + sin * across)
}

fn plate() -> Plate<'static> {
    Plate {
        density: DENSITY,
        rigidity: RIGIDITY,
        clamped: &[],
        creases: &[],
    }
}

/// What is measured at rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Saddle {
    /// Elastic energy of the faces that count over `D`.
    energy: f64,
    /// Distance from the exact cone over the height of its folds.
    place: f64,
}

type Wedged = Tried<Mesh, Saddle>;

impl Wedged {
    fn spacing(&self) -> f64 {
        RADIUS / self.job.rings as f64
    }

    fn energy_error(&self) -> Option<f64> {
        let exact = ExcessCone::new(EXCESS).energy();
        self.if_good(|m| (m.energy / exact - 1.0).abs())
    }

    fn place_error(&self) -> Option<f64> {
        self.if_good(|m| m.place)
    }
}

/// An error of a disk that came to rest.
type Measure = fn(&Wedged) -> Option<f64>;

const ERRORS: [(&str, Measure); 2] = [
    ("energy", Wedged::energy_error),
    ("place", Wedged::place_error),
];

fn measure(model: Model, job: Mesh, plan: &Plan) -> Result<Wedged> {
    let (sheet, places) = pyramid(job)?;
    let moved = model.sheet(&sheet, plate())?.with_damping(DAMPING)?;
    let scene = Scene::flat(moved, &sheet).by(implicit_euler());
    let (course, end) = scene.run(plan)?;
    let faces = model.face_energies(&sheet, plate(), &end.x)?;
    let corners = sheet.topology().faces().iter();
    let counted = corners.zip(faces).map(|(f, energy)| {
        let radius = f.iter().map(|v| places[v.index()][0]).sum::<f64>() / 3.0;
        weight(radius / RADIUS) * energy
    });
    Ok(Tried {
        model,
        job,
        vertices: places.len(),
        course,
        measured: Saddle {
            energy: counted.sum::<f64>() / RIGIDITY,
            place: distance(&places, &end.x),
        },
    })
}

/// The part in which the energy at a place counts, by its distance from the centre over the radius.
fn weight(radius: f64) -> f64 {
    ((radius - COUNTED[0]) / (COUNTED[1] - COUNTED[0])).clamp(0.0, 1.0)
}

/// Root mean square of the distances from the nearest exact cone, over the height of its folds: the cone may be moved,
/// turned, and its folds may be anywhere in the disk.
fn distance(places: &[Place], x: &[f64]) -> f64 {
    let cone = ExcessCone::new(EXCESS);
    let measured: Vec<Vector3<f64>> = x.as_chunks::<3>().0.iter().map(|p| (*p).into()).collect();
    let off = |shift: f64| {
        let exact: Vec<_> = places
            .iter()
            .map(|[r, angle]| *r * cone.ray(angle + shift))
            .collect();
        apart(&measured, &exact)
    };
    // Two folds up: all is repeated after half of the angles.
    let quarter = 0.25 * cone.length();
    let (mut low, mut high) = (-quarter, quarter);
    let tries = (0..TRIES).map(|k| low + (high - low) * f64::from(k) / f64::from(TRIES));
    let best = tries
        .min_by(|a, b| off(*a).total_cmp(&off(*b)))
        .unwrap_or(0.0);
    let width = 2.0 * quarter / f64::from(TRIES);
    (low, high) = (best - width, best + width);
    for _ in 0..THIRDS {
        let third = (high - low) / 3.0;
        if off(low + third) < off(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    off(0.5 * (low + high)) / (RADIUS * cone.height().sin())
}

/// Shifts of the folds that are tried at first, and how often the interval about the best one is cut to two thirds: to
/// 1e-4 of an angle.
const TRIES: u32 = 12;
const THIRDS: usize = 22;

/// Root mean square of the distances between two sets of points, one of which is moved and turned so that it is least
/// (W. Kabsch, "A solution for the best rotation to relate two sets of vectors", Acta Cryst. A32, 1976).
fn apart(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    let n = a.len() as f64;
    let mean = |points: &[Vector3<f64>]| points.iter().sum::<Vector3<f64>>() / n;
    let centres = [mean(a), mean(b)];
    let mut products = Matrix3::zeros();
    for (p, q) in a.iter().zip(b) {
        products += (p - centres[0]) * (q - centres[1]).transpose();
    }
    let svd = products.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return f64::NAN;
    };
    let sign = (u * v_t).determinant().signum();
    let turn = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t;
    let pairs = a.iter().zip(b);
    let squares = pairs.map(|(p, q)| (p - centres[0] - turn * (q - centres[1])).norm_squared());
    (squares.sum::<f64>() / n).sqrt()
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let sizes: &[usize] = effort.quick_or(&[4], &[6, 10, 16]);
    let kinds = effort.quick_or(&Kind::ALL[2..3], &Kind::ALL[..]);
    let plan = Plan::new(STEP, 20.0)
        .within(effort.quick_or(1.0, 40.0))
        .until_rest(REST);
    let of = |&kind: &Kind| sizes.iter().map(move |&rings| Mesh { kind, rings });
    let meshes: Vec<Mesh> = kinds.iter().flat_map(of).collect();
    let mut all: Vec<Wedged> = Vec::new();
    for model in Model::ALL {
        let run = |mesh: &Mesh| measure(model, *mesh, &plan);
        all.extend(records.runs(&model.to_string(), &meshes, run)?);
    }
    let finest = sizes.last();
    let mut targets = Vec::new();
    for model in Model::ALL {
        for (name, error) in ERRORS {
            let judged = all
                .iter()
                .filter(|w| w.model == model && Some(&w.job.rings) == finest);
            let values: Vec<Option<f64>> = judged.map(error).collect();
            let quantity = format!("relative error of the {name}, finest meshes");
            targets.push(at_most(model, &quantity, 0.02, &values));
        }
    }
    let findings = Findings {
        tables: vec![summary(&all, sizes), orders(&all)],
        files: vec![table(&all)],
        remarks: Model::ALL
            .map(|m| remark(m, &all, finest))
            .into_iter()
            .chain([BANDS.to_owned()])
            .collect(),
        targets,
    };
    Ok((findings, Some(plot(&all, sizes))))
}

fn summary(all: &[Wedged], sizes: &[usize]) -> Table {
    let sizes = sizes.iter();
    let rows = sizes.flat_map(|&rings| Model::ALL.map(|model| (rings, model)));
    let of = |&(rings, model): &(usize, Model)| {
        let is_of = move |w: &&Wedged| (w.job.rings, w.model) == (rings, model);
        all.iter().filter(is_of).collect::<Vec<_>>()
    };
    let largest = |of: &[&Wedged], error: Measure| {
        let values = of.iter().filter_map(|w| error(w));
        values.reduce(f64::max)
    };
    Table::of(
        "Disks with a wedge (R / h: radius over spacing): how many of the five meshes come to rest, and the largest errors of those that do",
        rows,
        &[
            ("R/h", &|r| r.0.into()),
            ("model", &|r| r.1.to_string().into()),
            ("at rest", &|r| of(r).iter().filter(|w| w.course.is_good()).count().into()),
            ("error of the energy", &|r| largest(&of(r), ERRORS[0].1).into()),
            ("error of the place", &|r| largest(&of(r), ERRORS[1].1).into()),
            ("CPU seconds of a run", &|r| {
                let of = of(r);
                (of.iter().map(|w| w.course.cost.cpu).sum::<f64>() / of.len() as f64).into()
            }),
        ],
    )
    .named("e-cone")
}

fn table(all: &[Wedged]) -> Table {
    let cone = ExcessCone::new(EXCESS);
    Table::of(
        format!(
            "Disks with a wedge: implicit Euler, steps of {STEP} s, until no vertex is faster than {REST} m/s. The exact energy is {} (3 φ = {})",
            number(cone.energy()),
            number(3.0 * EXCESS)
        ),
        all,
        &[
            ("mesh", &|w| w.job.kind.to_string().into()),
            ("R/h", &|w| w.job.rings.into()),
            ("V", &|w| w.vertices.into()),
            ("model", &|w| w.model.to_string().into()),
            ("ending", &|w| w.course.ending.name().into()),
            ("energy / D", &|w| w.measured.energy.into()),
            ("error of the energy", &|w| w.energy_error().into()),
            ("error of the place", &|w| w.place_error().into()),
            ("largest strain of an edge", &|w| w.course.strain.into()),
            ("factorisations", &|w| w.course.cost.factorisations.into()),
            ("CPU seconds", &|w| w.course.cost.cpu.into()),
            ("message", &|w| w.course.ending.message().into()),
        ],
    )
    .named("e-cone-all")
}

/// The fitted orders of both errors: a row for each model and mesh.
fn orders(all: &[Wedged]) -> Table {
    let mut rows: Vec<(Model, Kind)> = Vec::new();
    for row in all.iter().map(|w| (w.model, w.job.kind)) {
        if !rows.contains(&row) {
            rows.push(row);
        }
    }
    let fitted = |&row: &(Model, Kind), error: Measure| -> Cell {
        let of = all.iter().filter(|w| (w.model, w.job.kind) == row);
        let points: Option<Vec<_>> = of.map(|w| Some([w.spacing(), error(w)?])).collect();
        points.and_then(|points| order(&points, FLOOR)).into()
    };
    Table::of(
        "Fitted powers of h of the errors of disks with a wedge where the disks of all sizes come to rest",
        &rows,
        &[
            ("mesh", &|r| r.1.to_string().into()),
            ("model", &|r| r.0.to_string().into()),
            ("energy", &|r| fitted(r, ERRORS[0].1)),
            ("place", &|r| fitted(r, ERRORS[1].1)),
        ],
    )
    .named("e-cone-orders")
}

fn remark(model: Model, all: &[Wedged], finest: Option<&usize>) -> String {
    let of: Vec<&Wedged> = all.iter().filter(|w| w.model == model).collect();
    let judged = of.iter().filter(|w| Some(&w.job.rings) == finest);
    let [energy, place] = ERRORS.map(|(_, error)| {
        let worst = extremes(judged.clone().filter_map(|w| error(w))).map(|[_, high]| high);
        worst.map_or("–".into(), |w| number(100.0 * w))
    });
    let ended = of.iter().filter(|w| w.course.is_good()).count();
    format!(
        "{model}: {ended} of {} disks come to rest. On the finest meshes the largest error is {energy} % in the energy and {place} % in the place.",
        of.len()
    )
}

/// Both errors against the spacing.
fn plot(all: &[Wedged], sizes: &[usize]) -> Charts {
    let spacings: Vec<f64> = sizes.iter().map(|&n| RADIUS / n as f64).collect();
    let ticks = spacings.iter().map(|&h| (h, number(1e3 * h)));
    let x = Axis::at("h, mm", ticks.collect());
    let row = ERRORS.map(|(name, error)| {
        let of = |w: &Wedged| Some((w.model, [w.spacing(), error(w)?]));
        Panel {
            title: format!("error of the {name}"),
            axes: [x.clone(), Axis::decades("", all.iter().filter_map(error))],
            points: all.iter().filter_map(of).collect(),
            guides: vec![spacings.iter().map(|h| [*h, 0.02]).collect()],
        }
    });
    charts(vec![row.to_vec()], &Model::ALL, "2 %")
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_dynamics::{PlateBending, Potential};

    /// The angles about the centre are those of the disk and of the wedge, those about all other vertices inside are
    /// 2 pi, and the pyramid is folded along four edges alone.
    #[test]
    fn pyramids_are_flat_but_for_the_centre() {
        for kind in Kind::ALL {
            let (sheet, _) = pyramid(Mesh { kind, rings: 6 }).unwrap();
            let t = sheet.topology();
            let mut sums = vec![0.0; t.vertex_count()];
            for f in t.faces() {
                let p = f.map(|v| Vector3::from(sheet.position(v)));
                for k in 0..3 {
                    let sides = [1, 2].map(|i| p[(k + i) % 3] - p[k]);
                    sums[f[k].index()] += sides[0].angle(&sides[1]);
                }
            }
            let rim = t.boundary_loops().concat();
            for v in t.vertex_ids().filter(|v| !rim.contains(v)) {
                let is_tip = Vector3::from(sheet.position(v)).norm() < 1e-9;
                let expected = if is_tip { TAU + EXCESS } else { TAU };
                let sum = sums[v.index()];
                assert!((sum - expected).abs() < 1e-9, "{kind} {v}: {sum}");
            }
        }
    }

    /// A disk that has the exact shape is at no distance from it, however it lies and wherever its folds are; and its
    /// plate has the exact energy.
    #[test]
    fn the_exact_cone_is_recognised() {
        let mesh = Mesh {
            kind: Kind::Concentric,
            rings: 24,
        };
        let (sheet, places) = pyramid(mesh).unwrap();
        let cone = ExcessCone::new(EXCESS);
        let turn = nalgebra::Rotation3::from_euler_angles(0.4, -0.3, 1.0);
        let point = |[r, angle]: &Place| *r * (turn * cone.ray(angle + 0.5));
        let x: Vec<f64> = places
            .iter()
            .flat_map(|p| <[f64; 3]>::from(point(p)))
            .collect();
        let distance = distance(&places, &x);
        assert!(distance < 1e-4, "{distance}");
        assert!(super::distance(&places, sheet.positions()) > 0.05);
        let bending = PlateBending::new(&sheet, RIGIDITY).unwrap();
        let mut faces = vec![0.0; sheet.topology().face_count()];
        bending.add_bending_energies(&x, &mut faces);
        let counted = sheet
            .topology()
            .faces()
            .iter()
            .zip(&faces)
            .map(|(f, energy)| {
                let radius = f.iter().map(|v| places[v.index()][0]).sum::<f64>() / 3.0;
                weight(radius / RADIUS) * energy
            });
        let part = counted.sum::<f64>() / (RIGIDITY * cone.energy());
        assert!((part - 1.0).abs() < 0.02, "{part}");
        assert!(bending.energy(0.0, &x) > 0.0);
    }
}
