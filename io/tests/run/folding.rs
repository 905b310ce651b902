//! Folding to the angles of a FOLD file from the book's scene to the page.

use crate::headless::self_test;
use crate::skip::data_folder;
use crate::{code, run, stderr, summary};
use isosheet_runs::Recording;
use std::fs;
use std::path::Path;

/// The scene of the book that has a table of folding.
fn scene_of_the_book() -> String {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/own-scene.md");
    let page = fs::read_to_string(page).unwrap();
    let blocks = page.split("```toml\n").skip(1);
    let mut blocks = blocks.map(|b| b.split("```").next().unwrap());
    let scene = blocks.find(|b| b.contains("[folding]"));
    scene.expect("a scene with folding").to_owned()
}

/// Somebody else's sheet is folded by one command, its page plays, and the summary says what the text does.
#[test]
fn a_sheet_of_others_is_folded_by_one_command() {
    let Some(data) = data_folder() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let file = data.join("fold/miura_herringbone_8x8_tri.fold");
    fs::copy(file, dir.join("miura.fold")).unwrap();
    fs::write(dir.join("scene.toml"), scene_of_the_book()).unwrap();
    let output = run(dir, &["simulate", "scene.toml"]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(
        said.contains("fold angles differ from their targets by 8.15 degrees"),
        "{said}"
    );
    let folder = dir.join("scene-run");
    let residual = summary(&folder)
        .ending
        .residuals
        .folding
        .expect("the scene folds");
    assert_eq!(residual.creases, 120);
    // With 180 degrees, which do close, nothing is left.
    let whole = [
        "simulate",
        "scene.toml",
        "--out",
        "whole",
        "--set",
        "folding.part=1.0",
    ];
    assert_eq!(code(&run(dir, &whole)), Some(0));
    let whole = summary(&dir.join("whole"))
        .ending
        .residuals
        .folding
        .unwrap();
    assert!(
        whole.largest < 0.01 && residual.largest > 5.0,
        "{whole:?}, {residual:?}"
    );
    assert_eq!(
        code(&run(dir, &["collect", "whole", "--out", "all.csv"])),
        Some(0)
    );
    let table = fs::read_to_string(dir.join("all.csv")).unwrap();
    assert!(table.contains("ending.folding.largest_flat"), "{table}");
    let page = fs::read_to_string(folder.join("index.html")).unwrap();
    self_test(&page, "1100,800");
}

/// The pleated hyperbolic paraboloid of others has no rigid folding. Its panels bend, and it becomes a
/// saddle: the corners of one diagonal are above the middle, and the corners of the other below.
#[test]
fn a_pattern_without_rigid_folding_bends_its_panels() {
    let Some(data) = data_folder() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::copy(data.join("fold/hypar_tri.fold"), dir.join("hypar.fold")).unwrap();
    let scene = "version = 1
        [sheet]
        mesh = { file = { path = \"hypar.fold\", scale = 0.0005 } }
        refine = 1
        material = \"office paper\"
        start = { perturbation = 1e-4, seed = 1 }
        damping = 5.0
        [folding]
        stiffness = 0.01
        time = 2
        part = 0.5
        [method]
        step = 0.02
        [stop]
        time = 4";
    fs::write(dir.join("hypar.toml"), scene).unwrap();
    let output = run(dir, &["simulate", "hypar.toml"]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let residual = summary(&dir.join("hypar-run"))
        .ending
        .residuals
        .folding
        .unwrap();
    // Flat, all creases differ by 90 degrees.
    assert!(residual.rms < 65.0, "{residual:?}");
    let trajectory = Recording::read(&dir.join("hypar-run")).unwrap().trajectory;
    let [flat, folded] =
        [0, trajectory.len() - 1].map(|k| trajectory.frame(k).unwrap().as_chunks::<3>().0);
    let distance = |p: &[f64; 3], [x, y]: [f64; 2]| (p[0] - x).hypot(p[1] - y);
    let height = |place: [f64; 2]| {
        let nearest = |a: &usize, b: &usize| {
            distance(&flat[*a], place).total_cmp(&distance(&flat[*b], place))
        };
        folded[(0..flat.len()).min_by(nearest).unwrap()][2]
    };
    let corners = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]].map(height);
    let above = corners.map(|z| z - height([0.0, 0.0]));
    let side = above[0].signum();
    for (corner, sign) in above.into_iter().zip([1.0, -1.0, 1.0, -1.0]) {
        // A tenth of a side at least.
        assert!(corner * sign * side > 0.02, "{above:?}");
    }
}
