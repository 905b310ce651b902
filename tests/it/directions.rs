//! Sheets of materials with two directions, by scenes.

use isosheet_dynamics::{Material, MaterialDirection, PlateLaw};
use isosheet_io::scene::SceneFile;
use isosheet_tests::Elastica;
use std::path::Path;

/// The rigidity of a narrow strip that is cut at an angle to the direction: one over the compliance in bending along it
/// (S. G. Lekhnitskii, *Anisotropic Plates*, 1968, section 62).
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

/// Narrow strips, whose sides are free to curl, that are cut along the warp, across it and between, and hang out of a clamp by twice their bending length
/// `(D / w)^(1/3)`, so that the line from the clamp to the tip is inclined by 41.5 degrees (F. T. Peirce, "The handle of cloth as a
/// measurable quantity", J. Text. Inst. 21, T377, 1930; ASTM D1388).
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
