//! A disk with an inserted wedge: the excess cone.

use super::disks::{DiskJob, RADIUS};
use super::model::{Model, PAPER};
use super::runs::{Ran, Records, samples};
use super::scene::{DAMPING, run, until_rest};
use crate::report::Table;
use crate::runs::Plan;
use crate::runs::meshes::SNAP;
use anyhow::Result;
use isosheet_mesh::{FlatCut, Sheet, fold_angle};
use isosheet_tests::{ExcessCone, implicit_euler};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, TAU};

/// The wedge, radians: 17 degrees. The folds are 14 degrees high.
const EXCESS: f64 = 0.3;

/// Parts of the radius from which faces count and from which they count in full, with a weight between that
/// is linear in the radius: the tip, which no mesh resolves, is left out. The energy of a thin ring is in
/// proportion to `dr / r`, and the integral of the weight over `dr / r` is `(1 - ln 2) + ln 2 = 1`.
const COUNTED: [f64; 2] = [0.25, 0.5];

/// The place in the disk with the wedge: distance from the centre (metres) and angle (radians, of `2 pi +
/// phi`).
type PlanePoint = [f64; 2];

/// A disk with a wedge, folded to a pyramid: the angles of the flat disk are stretched, and every face lies
/// in one of four flat sectors.
fn pyramid(job: DiskJob) -> Result<(Sheet, Vec<PlanePoint>)> {
    let mut cut = FlatCut::of(&job.sheet()?);
    for normal in [[1.0, 0.0], [0.0, 1.0]] {
        cut.split([0.0; 2], normal, SNAP * RADIUS / job.rings as f64);
    }
    let flat = cut.sheet()?;
    let place = |&[x, y, _]: &[f64; 3]| {
        // (The angle of a vertex on the first ray may be -1e-17.)
        let angle = y.atan2(x).rem_euclid(TAU) % TAU;
        [x.hypot(y), angle * (TAU + EXCESS) / TAU]
    };
    let places: Vec<PlanePoint> = flat
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
fn folded([radius, angle]: PlanePoint) -> Vector3<f64> {
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

/// What is measured; errors at rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Saddle {
    /// Elastic energy of the faces that count over `D`.
    #[serde(rename = "energy / D")]
    energy: f64,
    #[serde(rename = "error of the energy")]
    energy_error: Option<f64>,
    /// Distance from the exact cone over the height of its folds.
    #[serde(rename = "error of the place")]
    place_error: Option<f64>,
}

fn measure(model: Model, job: DiskJob, plan: &Plan) -> Result<(Ran, Saddle)> {
    let (sheet, places) = pyramid(job)?;
    let moved = model.sheet(&sheet, PAPER)?.with_damping(DAMPING)?;
    let (course, end) = run(model, moved, &sheet, implicit_euler(), plan)?;
    let ran = Ran::of(model, &sheet, &course);
    let faces = face_energies(model, &sheet, &end.x)?;
    let corners = sheet.topology().faces().iter();
    let counted = corners.zip(faces).map(|(f, energy)| {
        let radius = f.iter().map(|v| places[v.index()][0]).sum::<f64>() / 3.0;
        weight(radius / RADIUS) * energy
    });
    let energy = counted.sum::<f64>() / PAPER.rigidity;
    let exact = ExcessCone::new(EXCESS).energy();
    let saddle = Saddle {
        energy,
        energy_error: ran.if_good((energy / exact - 1.0).abs()),
        place_error: ran.if_good(distance(&places, &end.x)),
    };
    Ok((ran, saddle))
}

/// The elastic energy of each face, joules; that of a spring belongs to both faces of its edge in equal
/// parts.
fn face_energies(model: Model, sheet: &Sheet, x: &[f64]) -> Result<Vec<f64>> {
    let built = model.sheet(sheet, PAPER)?;
    if let Some(faces) = built.elastic_deformation(0.0, x, &built.memories_at_rest(0.0, x)) {
        let sums = faces.stretching.iter().zip(&faces.bending);
        return Ok(sums.map(|(s, b)| s + b).collect());
    }
    let t = sheet.topology();
    let mut energies = vec![0.0; t.face_count()];
    for edge in t.edge_ids() {
        if let ([Some(left), Some(right)], Some(angle)) =
            (t.edge_faces(edge), fold_angle(t, x, edge))
        {
            let faces = [left, right].map(|f| f.index());
            let area: f64 = faces.iter().map(|f| sheet.face_areas()[*f]).sum();
            // See [`isosheet_dynamics::CreaseSprings::bending`].
            let stiffness = PAPER.rigidity * sheet.lengths()[edge.index()].powi(2) / area;
            for face in faces {
                energies[face] += 0.25 * stiffness * angle * angle;
            }
        }
    }
    Ok(energies)
}

/// The part in which the energy at a place counts, by its distance from the centre over the radius.
fn weight(radius: f64) -> f64 {
    ((radius - COUNTED[0]) / (COUNTED[1] - COUNTED[0])).clamp(0.0, 1.0)
}

/// Root mean square of the distances from the nearest exact cone, over the height of its folds: the cone may
/// be moved, turned, and its folds may be anywhere in the disk.
fn distance(places: &[PlanePoint], x: &[f64]) -> f64 {
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

/// Shifts of the folds that are tried at first, and how often the interval about the best one is cut to two
/// thirds: to 1e-4 of an angle.
const TRIES: u32 = 12;
const THIRDS: usize = 22;

/// Root mean square of the distances between two sets of points, one of which is moved and turned so that it
/// is least (W. Kabsch, "A solution for the best rotation to relate two sets of vectors", Acta Cryst. A32,
/// 1976).
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

/// The runs of the yardstick.
pub(super) fn runs(records: &Records<'_>) -> Result<Table> {
    let effort = records.store.effort;
    let plan = until_rest(effort.quick_or(2.0, 20.0));
    let jobs = DiskJob::all(effort);
    samples(&records.of_models(&jobs, |model, job| measure(model, *job, &plan))?)
}

#[cfg(test)]
mod tests {
    use super::super::disks::Disk;
    use super::*;
    use isosheet_dynamics::{At, MaterialReport as _, PlateBending, Potential};

    /// The angles about the centre add up to the disk and the wedge, the angles about all other vertices
    /// inside are 2 pi, and the pyramid is folded along four edges alone.
    #[test]
    fn pyramids_are_flat_but_for_the_centre() {
        for mesh in Disk::ALL {
            let (sheet, _) = pyramid(DiskJob { mesh, rings: 6 }).unwrap();
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
                assert!((sum - expected).abs() < 1e-9, "{mesh:?} {v}: {sum}");
            }
        }
    }

    /// A disk that has the exact shape is at no distance from it, however it lies and wherever its folds are;
    /// and its plate has the exact energy.
    #[test]
    fn the_exact_cone_is_recognised() {
        let job = DiskJob {
            mesh: Disk::Concentric,
            rings: 24,
        };
        let (sheet, places) = pyramid(job).unwrap();
        let cone = ExcessCone::new(EXCESS);
        let turn = nalgebra::Rotation3::from_euler_angles(0.4, -0.3, 1.0);
        let point = |[r, angle]: &PlanePoint| *r * (turn * cone.ray(angle + 0.5));
        let x: Vec<f64> = places
            .iter()
            .flat_map(|p| <[f64; 3]>::from(point(p)))
            .collect();
        let distance = distance(&places, &x);
        assert!(distance < 1e-4, "{distance}");
        assert!(super::distance(&places, sheet.positions()) > 0.05);
        let bending = PlateBending::new(&sheet, PAPER.rigidity).unwrap();
        let mut faces = vec![0.0; sheet.topology().face_count()];
        bending.add_bending_energies(At::new(0.0, &x), &mut faces);
        let counted = sheet
            .topology()
            .faces()
            .iter()
            .zip(&faces)
            .map(|(f, energy)| {
                let radius = f.iter().map(|v| places[v.index()][0]).sum::<f64>() / 3.0;
                weight(radius / RADIUS) * energy
            });
        let part = counted.sum::<f64>() / (PAPER.rigidity * cone.energy());
        assert!((part - 1.0).abs() < 0.02, "{part}");
        assert!(bending.energy(At::new(0.0, &x)) > 0.0);
    }

    #[test]
    fn the_energies_of_the_faces_are_that_of_the_sheet() {
        let sheet = isosheet_mesh::generate::isotropic_square(2, 0.1).unwrap();
        let bent = sheet.map_positions(|[x, y, _]| [x, y, 0.1 * x * x + 0.05 * x * y]);
        let bent = bent.unwrap();
        for model in Model::ALL {
            let faces = face_energies(model, &sheet, bent.positions()).unwrap();
            let whole = model.energy(&sheet, PAPER, bent.positions()).unwrap();
            let part = faces.iter().sum::<f64>() / whole;
            assert!((part - 1.0).abs() < 1e-12, "{model}: {part}");
        }
    }
}
