//! A scene of five lines with a material: a clamped strip on an irregular mesh is the heavy elastica.

use isosheet_dynamics::Material;
use isosheet_scenes::SceneFile;
use isosheet_tests::Elastica;
use std::path::Path;

/// The free end is at this distance from the clamp, metres.
const FREE: f64 = 0.12;
/// Width of the strip, metres.
const WIDTH: f64 = 0.03;
/// Length that is clamped, metres.
const CLAMPED: f64 = 0.02;

fn scene(seed: u32) -> String {
    format!(
        "version = 1
         sheet.mesh.polygon = {{ outline = [[-0.02, 0], [0.12, 0], [0.12, 0.03], [-0.02, 0.03]], spacing = 0.003, seed = {seed} }}
         sheet.material = \"office paper\"
         support = [{{ at = {{ half_space = {{ point = [0, 0, 0], normal = [-1, 0, 0] }} }} }}]
         forces.gravity = [0, 0, -9.81]"
    )
}

#[test]
fn a_clamped_strip_of_paper_on_an_irregular_mesh_is_the_elastica() {
    for seed in 0..3 {
        let edits = ["sheet.damping=10", "stop.time=3"].map(String::from);
        let file = SceneFile::parse(scene(seed), Path::new("clamp.toml"), &edits).unwrap();
        let setup = file.build().unwrap();
        let sheet = setup.sheet.clone();
        // The clamp ends where its faces do, along a line of edges that is not straight: in the mean over the
        // width at this place.
        let t = sheet.topology();
        let is_clamped = |x: &[f64; 3]| x[0] <= 1e-9;
        let points = sheet.positions().as_chunks::<3>().0;
        let clamped = t.face_ids().filter(|&f| {
            let corners = t.faces()[f.index()];
            corners.iter().all(|v| is_clamped(&points[v.index()]))
        });
        let area: f64 = clamped.map(|f| sheet.face_areas()[f.index()]).sum();
        let paper = Material::office_paper();
        let elastica = Elastica {
            length: FREE + CLAMPED - area / WIDTH,
            rigidity: paper.rigidity,
            weight: 9.81 * paper.density,
        };
        let mut run = setup.start().unwrap();
        let h = 1.0 / 60.0;
        while run.state().v.iter().any(|v| v.abs() > 1e-5) || run.state().t < 0.5 {
            run.step(h).unwrap();
            assert!(run.state().t < 5.0, "it comes to rest");
        }
        let ends = points.iter().zip(run.state().x.as_chunks::<3>().0);
        let ends: Vec<f64> = ends
            .filter(|(rest, _)| rest[0] > FREE - 1e-9)
            .map(|(_, x)| -x[2])
            .collect();
        let drop = ends.iter().sum::<f64>() / ends.len() as f64;
        let error = drop / elastica.drop() - 1.0;
        assert!(
            error.abs() < 0.02,
            "seed {seed}: {drop} m, elastica {} m",
            elastica.drop()
        );
    }
}
