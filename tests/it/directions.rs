//! Sheets of materials with two directions, by scenes.

use isosheet_dynamics::{
    Material, MaterialDirection, OrthotropicPlate, PlateLaw, SheetModel, Simulation, State,
};
use isosheet_mesh::{VertexId, generate};
use isosheet_scenes::SceneFile;
use isosheet_tests::{Elastica, implicit_euler};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;
use std::path::Path;

/// The rigidity of a narrow strip that is cut at an angle to the direction: one over the compliance in
/// bending along it (S. G. Lekhnitskii, *Anisotropic Plates*, 1968, section 62).
fn strip_rigidity(material: &Material, degrees: f64) -> f64 {
    let direction = MaterialDirection::Uniform([1.0, 0.0, 0.0]);
    let PlateLaw::Orthotropic(plate) = material.plate(Some(&direction)) else {
        panic!("a material with directions");
    };
    let determinant = plate.along * plate.across - plate.coupling * plate.coupling;
    let [s11, s22] = [plate.across, plate.along].map(|d| d / determinant);
    let s12 = -plate.coupling / determinant;
    let s66 = 1.0 / plate.twist;
    let (s, c) = degrees.to_radians().sin_cos();
    let compliance = s11 * c.powi(4) + (2.0 * s12 + s66) * (s * c).powi(2) + s22 * s.powi(4);
    1.0 / compliance
}

/// Narrow strips, whose sides are free to curl, that are cut along the warp, across it and between, and hang
/// out of a clamp by twice their bending length `(D / w)^(1/3)`, so that the line from the clamp to the tip
/// is inclined by 41.5 degrees (F. T. Peirce, "The handle of cloth as a measurable quantity", J. Text. Inst.
/// 21, T377, 1930; ASTM D1388).
#[test]
fn strips_of_cloth_and_paper_have_their_bending_lengths() {
    for (name, material) in [
        ("cotton", Material::cotton()),
        ("office paper", Material::office_paper()),
    ] {
        let mut drops = Vec::new();
        for degrees in [0.0_f64, 45.0, 90.0] {
            let rigidity = strip_rigidity(&material, degrees);
            let weight = 9.81 * material.density;
            let length = 2.0 * (rigidity / weight).cbrt();
            let (s, c) = degrees.to_radians().sin_cos();
            let scene = format!(
                "version = 1
                 sheet.mesh.rectangle = {{ width = {length}, height = {}, columns = 100, rows = 2 }}
                 sheet.material = \"{name}\"
                 sheet.direction = [{c}, {s}, 0]
                 sheet.damping = 20
                 forces.gravity = [0, 0, -9.81]
                 stop.time = 3
                 [[support]]
                 at = {{ box = {{ min = [-1, -1, -1], max = [1e-9, 1, 1] }} }}
                 hold = \"clamp\"",
                0.01 * length
            );
            let setup = SceneFile::parse(scene, Path::new("strip.toml"), &[]).unwrap();
            let setup = setup.build().unwrap();
            let sheet = setup.sheet.clone();
            let mut run = setup.start().unwrap();
            while run.state().v.iter().any(|v| v.abs() > 1e-5) || run.state().t < 0.5 {
                run.step(1.0 / 60.0).unwrap();
                assert!(run.state().t < 8.0, "it comes to rest");
            }
            let points = sheet.positions().as_chunks::<3>().0.iter();
            let ends = points.zip(run.state().x.as_chunks::<3>().0);
            let ends: Vec<[f64; 3]> = ends
                .filter(|(rest, _)| rest[0] > length * (1.0 - 1e-9))
                .map(|(_, x)| *x)
                .collect();
            let mean = |k: usize| ends.iter().map(|x| x[k]).sum::<f64>() / ends.len() as f64;
            let (drop, inclined) = (-mean(2), (-mean(2)).atan2(mean(0)).to_degrees());
            let elastica = Elastica {
                length,
                rigidity,
                weight,
            };
            let error = drop / elastica.drop() - 1.0;
            assert!(error.abs() < 0.02, "{name} {degrees}: {error}");
            assert!(
                (inclined - 41.5).abs() < 2.0,
                "{name} {degrees}: {inclined}"
            );
            drops.push(length);
        }
        assert!(drops[0] > 1.15 * drops[2], "{name}: {drops:?}");
    }
}

/// Functions of Ritz's method along the radius, and waves around.
const ALONG: usize = 6;
const AROUND: usize = 4;

/// How far a ring that is clamped at its inner circle hangs down at its outer one, metres, at an angle
/// (radians) to the direction of the material, under a load per area: Ritz's method with
/// `s^(i + 2) cos(2 j a)`, `s` from 0 to 1 across the ring.
fn ring_under_load(plate: &OrthotropicPlate, radii: [f64; 2], load: f64, angle: f64) -> f64 {
    let width = radii[1] - radii[0];
    let functions =
        || (0..ALONG).flat_map(|i| (0..AROUND).map(move |j| (i as i32 + 2, 2.0 * j as f64)));
    let count = ALONG * AROUND;
    let (mut stiffness, mut force) = (DMatrix::zeros(count, count), DVector::zeros(count));
    // Midpoints: 200 across and 64 around, where cosines are integrated exactly.
    let (across, around) = (200, 64);
    for p in 0..across {
        let s = (f64::from(p) + 0.5) / f64::from(across);
        let r = radii[0] + s * width;
        for q in 0..around {
            let a = TAU * f64::from(q) / f64::from(around);
            let area = r * width / f64::from(across) * TAU / f64::from(around);
            let (sine, cosine) = a.sin_cos();
            let mut curvatures = DMatrix::zeros(3, count);
            for (k, (power, wave)) in functions().enumerate() {
                let radial = |order: i32| {
                    let falling: f64 = (0..order).map(|n| f64::from(power - n)).product();
                    falling * s.powi(power - order) / width.powi(order)
                };
                let (c, d) = ((wave * a).cos(), -wave * (wave * a).sin());
                force[k] += load * area * radial(0) * c;
                let rr = radial(2) * c;
                let tt = radial(1) * c / r - radial(0) * wave * wave * c / (r * r);
                let rt = radial(1) * d / r - radial(0) * d / (r * r);
                let (c2, s2, cs) = (cosine * cosine, sine * sine, cosine * sine);
                curvatures[(0, k)] = c2 * rr + s2 * tt - 2.0 * cs * rt;
                curvatures[(1, k)] = s2 * rr + c2 * tt + 2.0 * cs * rt;
                curvatures[(2, k)] = 2.0 * (cs * (rr - tt) + (c2 - s2) * rt);
            }
            let law = DMatrix::from_row_slice(
                3,
                3,
                &[
                    [plate.along, plate.coupling, 0.0],
                    [plate.coupling, plate.across, 0.0],
                    [0.0, 0.0, plate.twist],
                ]
                .concat(),
            );
            stiffness += area * curvatures.transpose() * law * &curvatures;
        }
    }
    let solved = stiffness
        .cholesky()
        .expect("positive definite")
        .solve(&force);
    let at_rim = functions().zip(solved.iter());
    at_rim.map(|((_, wave), c)| c * (wave * angle).cos()).sum()
}

/// A disk of orthotropic paper on a round pedestal that holds its middle: how far the rim hangs down along
/// the direction, across it and between, against Ritz's method for Kirchhoff's plate, clamped along the
/// circle. (The drape of G. E. Cusick, "The dependence of fabric drape on bending and shear stiffness", J.
/// Text. Inst. 56, T596, 1965, before it buckles to folds.)
#[test]
fn a_disk_on_a_pedestal_hangs_down_least_along_its_direction() {
    let (radius, pedestal, rings) = (0.15, 0.09, 20);
    let material = Material::office_paper();
    let direction = MaterialDirection::Uniform([1.0, 0.0, 0.0]);
    let PlateLaw::Orthotropic(plate) = material.plate(Some(&direction)) else {
        panic!("a material with directions");
    };
    let sheet = generate::disk(rings, radius).unwrap();
    let distance = |v: VertexId| {
        let [x, y, _] = sheet.position(v);
        x.hypot(y)
    };
    let inside = sheet
        .topology()
        .vertex_ids()
        .filter(|v| distance(*v) < pedestal * (1.0 + 1e-9));
    let held: Vec<VertexId> = inside.collect();
    // So small a weight that nothing stretches.
    let load = 1e-3 * plate.along / radius.powi(3);
    let model = SheetModel::of_material(&sheet, &material)
        .along(direction)
        .clamped(&held);
    let model = model.build().unwrap();
    let model = model.with_acceleration([0.0, 0.0, -load / material.density]);
    let slowest = (radius - pedestal).powi(2) * (material.density / plate.across).sqrt();
    let model = model.with_damping(10.0 / slowest).unwrap();
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = Simulation::new(model, start, implicit_euler()).unwrap();
    for _ in 0..60 {
        run.step(slowest).unwrap();
    }
    let x = &run.state().x;
    for degrees in [0.0_f64, 45.0, 90.0, 180.0] {
        let angle = degrees.to_radians();
        let (s, c) = angle.sin_cos();
        let rim = sheet.topology().vertex_ids().find(|v| {
            let [x, y, _] = sheet.position(*v);
            (x - radius * c).hypot(y - radius * s) < 1e-9
        });
        let found = -x[3 * rim.unwrap().index() + 2];
        let expected = ring_under_load(&plate, [pedestal, radius], load, angle);
        let error = found / expected - 1.0;
        assert!(error.abs() < 0.03, "{degrees}: {found} {expected} {error}");
    }
}
