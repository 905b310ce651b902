//! `isosheet drape`, `hang` and `crumple`.

use crate::{code, run, stderr};
use isosheet_formats::read_mesh;
use isosheet_runs::Recording;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// A square of 6 by 6 quads of side 1 in the plane y = 0, as programs write it whose y axis points upwards,
/// beginning at x.
fn cloth(x: f64) -> String {
    let mut text = String::new();
    for (i, j) in (0..7).flat_map(|j| (0..7).map(move |i| (i, j))) {
        let _ = writeln!(text, "v {} 0 {j}", x + f64::from(i));
    }
    for a in (0..6).flat_map(|j| (0..6).map(move |i| 7 * j + i + 1)) {
        let _ = writeln!(text, "f {a} {} {} {}", a + 1, a + 8, a + 7);
    }
    text
}

/// A box of 2 by 2 by 1 in the unit of the cloth.
const BLOCK: &str = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 1\nv 2 0 1\nv 2 2 1\nv 0 2 1\nf 1 4 3 2\nf 5 6 7 8\n\
                     f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// A drawing of a rectangle of 120 by 80 mm with a round hole.
const NAPKIN: &str = "<svg xmlns='http://www.w3.org/2000/svg' width='140mm' height='100mm' viewBox='0 0 140 100' fill='none'>\
                      <rect stroke='black' x='10' y='10' width='120' height='80'/><circle stroke='black' cx='70' cy='50' r='10'/></svg>";

/// What a command says in the end, and the folder `out` that it wrote.
fn done(folder: &Path, words: &[&str]) -> (String, Recording) {
    let output = run(folder, words);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let recording = Recording::read(&folder.join("out")).unwrap();
    (String::from_utf8(output.stdout).unwrap(), recording)
}

fn last(recording: &Recording) -> &[[f64; 3]] {
    let frames = &recording.trajectory;
    frames.frame(frames.len() - 1).unwrap().as_chunks::<3>().0
}

fn lowest(points: &[[f64; 3]]) -> f64 {
    points.iter().map(|p| p[2]).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_cloth_drapes_over_a_table_and_over_a_body() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("cloth.obj"), cloth(0.0)).unwrap();
    fs::write(dir.path().join("block.obj"), BLOCK).unwrap();
    let (said, recording) = done(
        dir.path(),
        &["drape", "cloth.obj", "--out", "out", "--table"],
    );
    // The cloth is 0.5 m wide, and the table 0.3 m.
    assert!((recording.sheet.area() - 0.25).abs() < 1e-6);
    let points = last(&recording);
    assert!(
        points
            .iter()
            .all(|p| p[0].hypot(p[1]) >= 0.15 || p[2] > 0.0)
    );
    let hem = format!(
        "the hem hangs {:.0} mm below the top",
        -1e3 * lowest(points)
    );
    assert!(said.contains(&hem), "{said}");
    assert!(said.contains("vertices touch"), "{said}");

    let words = [
        "drape",
        "cloth.obj",
        "out",
        "--on",
        "block.obj",
        "--force",
        "--scene",
        "scene.toml",
    ];
    let (said, recording) = done(dir.path(), &words);
    // In the unit of the cloth, which is a twelfth of a metre: a block of a sixth of a metre, under its
    // middle.
    let half = 1.0 / 12.0;
    let points = last(&recording);
    let is_within =
        |p: &[f64; 3]| p[0].abs() < half && p[1].abs() < half && p[2] < 0.0 && p[2] > -half;
    assert!(!points.iter().any(is_within));
    assert!(
        lowest(points) < -0.01 && said.contains("draped: the hem hangs"),
        "{said}"
    );
    let scene = fs::read_to_string(dir.path().join("scene.toml")).unwrap();
    let again = run(dir.path(), &["simulate", "scene.toml", "-o", "out"]);
    assert_eq!(code(&again), Some(0), "{scene}{}", stderr(&again));
    assert!(String::from_utf8_lossy(&again.stdout).contains("already complete"));
}

#[test]
fn the_sheet_of_a_drawing_has_its_own_size() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("napkin.svg"), NAPKIN).unwrap();
    let words = [
        "drape",
        "napkin.svg",
        "--out",
        "out",
        "--material",
        "cotton",
    ];
    let (said, recording) = done(dir.path(), &words);
    let area = 0.12 * 0.08 - std::f64::consts::PI * 1e-4;
    assert!((recording.sheet.area() / area - 1.0).abs() < 3e-3, "{said}");
}

#[test]
fn a_towel_hangs_by_its_corners() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("towel.obj"), cloth(2_600_000.25)).unwrap();
    let words = [
        "hang",
        "towel.obj",
        "out",
        "--material",
        "cotton",
        "--size",
        "300mm",
    ];
    let (said, recording) = done(dir.path(), &words);
    // It is held by a corner wherever its coordinates are, and the opposite corner is as far down as the
    // diagonal is long, which stretches by a percent at most.
    let diagonal = 0.3 * 2.0_f64.sqrt();
    let depth = -lowest(last(&recording));
    assert!(
        depth > 0.97 * diagonal && depth < 1.01 * diagonal,
        "{depth}"
    );
    let low = format!("its lowest point is {:.0} mm below", 1e3 * depth);
    assert!(said.contains(&low), "{said}");
    assert_eq!(recording.pins.len(), 1);
}

#[test]
fn a_sheet_is_crumpled() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(
        dir.path().join("foil.off"),
        "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
    )
    .unwrap();
    let words = [
        "crumple",
        "foil.off",
        "--out",
        "out",
        "--material",
        "aluminium foil",
    ];
    let (said, recording) = done(dir.path(), &words);
    // Foil yields: it neither spreads out again to its diagonal of 141 mm nor lies flat.
    let points = last(&recording);
    let extent = |k: usize| {
        let along = || points.iter().map(|p| p[k]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    assert!(
        extent(0) < 0.14 && extent(1) < 0.14 && extent(2) > 2e-3,
        "{said}"
    );
    assert!(recording.summary.as_ref().unwrap().ending.plastic > Some(0.0));
    assert!(said.contains("from 100 mm by 100 mm by 0 mm to"), "{said}");
}

/// A sheet that does not yield is flat again, and the words say so.
#[test]
fn a_film_springs_back() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("film.obj"), cloth(0.0)).unwrap();
    let (said, _) = done(
        dir.path(),
        &[
            "crumple",
            "film.obj",
            "--out",
            "out",
            "--material",
            "PET film",
        ],
    );
    let words = "it sprang back, as its material does not yield: from 100 mm by 0 mm by 100 mm to";
    assert!(said.contains(words), "{said}");
}

/// The reader of glTF files has turned a body already: a block of 2 by 2 by 1 stays on its largest side.
#[test]
fn a_body_of_a_gltf_file_stands_upright() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("cloth.obj"), cloth(0.0)).unwrap();
    fs::write(dir.path().join("block.obj"), BLOCK).unwrap();
    let convert = run(dir.path(), &["convert", "block.obj", "block.glb"]);
    assert_eq!(code(&convert), Some(0), "{}", stderr(&convert));
    let words = ["drape", "cloth.obj", "--out", "out", "--on", "block.glb"];
    let (said, recording) = done(dir.path(), &words);
    // In the unit of the cloth, a twelfth of a metre.
    let distance = |x: f64, z: f64| {
        let point = nalgebra::Vector3::new(x / 12.0, 0.0, z / 12.0);
        recording.obstacles[0].signed_distance(0.0, &point).value
    };
    assert!(distance(0.9, -0.9) < 0.0 && distance(0.0, -1.1) > 0.0);
    assert!(said.contains("draped: the hem hangs"), "{said}");
}

/// The middle of the box about a right-angled triangle is on its longest side: it would fall off.
#[test]
fn a_triangle_drapes_about_the_centre_of_its_area() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(
        dir.path().join("triangle.off"),
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
    )
    .unwrap();
    let (said, _) = done(dir.path(), &["drape", "triangle.off", "--out", "out"]);
    assert!(said.contains("draped: the hem hangs"), "{said}");
}

#[test]
fn a_cloth_that_falls_between_two_blocks_is_not_draped() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("cloth.obj"), cloth(0.0)).unwrap();
    let second = BLOCK
        .replace("v 0", "v 20")
        .replace("v 2 ", "v 22 ")
        .replace(
            "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8",
            "",
        )
        + "f -8 -5 -6 -7\nf -4 -3 -2 -1\nf -8 -7 -3 -4\nf -7 -6 -2 -3\nf -6 -5 -1 -2\nf -5 -8 -4 -1\n";
    fs::write(dir.path().join("blocks.obj"), BLOCK.to_owned() + &second).unwrap();
    let words = ["drape", "cloth.obj", "--out", "out", "--on", "blocks.obj"];
    let (said, _) = done(dir.path(), &words);
    let last = said.lines().last().unwrap();
    assert!(last.starts_with("warning: the sheet fell past"), "{said}");
    assert!(!said.contains("draped"), "{said}");
}

#[test]
fn misuse_is_answered_before_anything_is_run() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("cloth.obj"), cloth(0.0)).unwrap();
    fs::write(dir.path().join("block.obj"), BLOCK).unwrap();
    fs::write(
        dir.path().join("open.svg"),
        NAPKIN
            .replace("/></svg>", "/>")
            .replace("<rect", "<path d='M0 0 H9'")
            + "</svg>",
    )
    .unwrap();
    let vast = BLOCK.replace("v 2", "v 2000");
    fs::write(dir.path().join("vast.obj"), vast).unwrap();
    let square = |x: u32| format!("v {x} 0 0\nv {} 0 0\nv {x} 1 0\nf -3 -2 -1\n", x + 1);
    fs::write(dir.path().join("pieces.obj"), square(0) + &square(3)).unwrap();
    let second = "<rect stroke='black' x='200' y='10' width='20' height='80'/></svg>";
    fs::write(
        dir.path().join("pieces.svg"),
        NAPKIN.replace("</svg>", second),
    )
    .unwrap();
    fs::create_dir(dir.path().join("full")).unwrap();
    fs::write(dir.path().join("full/letter.txt"), "x").unwrap();
    let refused = |words: &[&str], exit: i32, expected: &[&str]| {
        let output = run(dir.path(), words);
        let said = stderr(&output);
        assert_eq!(code(&output), Some(exit), "{words:?}: {said}");
        for part in expected {
            assert!(said.contains(part), "{words:?}: {said}");
        }
        assert!(!said.contains(" steps"), "{words:?}: {said}");
    };
    refused(
        &["drape", "cloth.obj", "--material", "coton"],
        2,
        &["cotton"],
    );
    refused(&["drape", "cloth.obj", "--size=-1"], 2, &["0.1mm to 1000m"]);
    refused(
        &["drape", "cloth.obj", "--size", "200"],
        2,
        &["without a unit this is 200 metres", "200mm"],
    );
    refused(
        &["drape", "cloth.obj", "--table", "--on", "block.obj"],
        2,
        &["cannot be used with"],
    );
    refused(&["drape", "none.obj"], 3, &["none.obj"]);
    let far = [
        "drape",
        "cloth.obj",
        "--on",
        "block.obj",
        "--tool-size",
        "100m",
    ];
    refused(
        &far,
        2,
        &["as if it had another unit", "give another length"],
    );
    let unsaid = ["drape", "cloth.obj", "--on", "vast.obj"];
    refused(&unsaid, 2, &["say how long it is by `--tool-size`"]);
    for command in ["drape", "hang", "crumple"] {
        refused(
            &[command, "pieces.obj"],
            3,
            &["2 separate pieces", "one piece"],
        );
        refused(
            &[command, "pieces.svg"],
            3,
            &["2 separate pieces", "one piece"],
        );
    }
    let own = "version = 1\n[sheet]\nmesh = { square = { side = 1, level = 1 } }\n";
    fs::write(dir.path().join("own.toml"), own).unwrap();
    let files = ["cloth.obj", "block.obj", "own.toml"];
    let contents = || files.map(|name| fs::read(dir.path().join(name)).unwrap());
    let before = contents();
    let over = ["drape", "cloth.obj", "--on", "block.obj", "--scene"];
    for (name, what) in files.iter().zip(["no scene", "no scene", "another scene"]) {
        let words = [&over[..], &[name]].concat();
        refused(&words, 2, &[what, "another name"]);
        let words = ["hang", "cloth.obj", "--trace", name];
        refused(&words, 2, &["no trace", "another name"]);
    }
    assert_eq!(contents(), before, "files that were there are as they were");
    refused(
        &["drape", "cloth.obj", "--out", "full"],
        4,
        &["holds files", "help: choose an empty or a new folder"],
    );
    refused(
        &[
            "hang",
            "cloth.obj",
            "--out",
            "out",
            "--scene",
            "out/scene.toml",
        ],
        2,
        &["in the folder of the run"],
    );
    refused(&["crumple", "open.svg"], 3, &["not closed", "help:"]);
    assert_eq!(
        read_mesh(&dir.path().join("cloth.obj"))
            .unwrap()
            .vertex_count(),
        49
    );
    assert!(!dir.path().join("out").exists() && !dir.path().join("cloth-run").exists());
}
