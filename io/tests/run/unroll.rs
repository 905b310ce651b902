//! `isosheet unroll`, and strips between curves.

use crate::drawings::{area, meshed};
use crate::skip::data_folder;
use crate::{code, run, stderr, stdout, summary};
use isosheet_formats::{
    EdgeAssignment, FoldFrame, MeshFile, MeshOptions, read_mesh, read_mesh_with,
};
use isosheet_mesh::{Sheet, fold_angle};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write;
use std::fs;
use std::path::Path;

const CUBE: &str = "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nv 0 0 0.1\nv 0.1 0 0.1\nv 0.1 0.1 0.1\nv 0 0.1 0.1\n\
    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// A prism of `n` sides around the z axis, open at its ends, in an OBJ file.
fn prism(n: usize, radius: f64, height: f64) -> String {
    let mut text = String::new();
    for k in 0..2 * n {
        let (s, c) = (TAU * (k / 2) as f64 / n as f64).sin_cos();
        let z = height * (k % 2) as f64;
        writeln!(text, "v {} {} {z}", radius * c, radius * s).unwrap();
    }
    for k in 0..n {
        let [a, b] = [2 * k + 1, 2 * ((k + 1) % n) + 1];
        writeln!(text, "f {a} {b} {} {}", b + 1, a + 1).unwrap();
    }
    text
}

/// Unrolls a mesh, and returns what the command said.
fn unrolled(folder: &Path, mesh: &str, out: &str, options: &[&str]) -> String {
    let output = run(folder, &[&["unroll", mesh, "-o", out], options].concat());
    assert_eq!(code(&output), Some(0), "{mesh}: {}", stderr(&output));
    let said = stdout(&output);
    assert!(
        said.lines().last().unwrap().starts_with("unrolled: "),
        "{said}"
    );
    said
}

fn refused(folder: &Path, mesh: &str, options: &[&str], exit: i32) -> String {
    let output = run(
        folder,
        &[&["unroll", mesh, "-o", "no.svg"], options].concat(),
    );
    assert_eq!(
        code(&output),
        Some(exit),
        "{mesh} {options:?}: {}",
        stderr(&output)
    );
    assert!(output.stdout.is_empty() && !folder.join("no.svg").exists());
    stderr(&output)
}

/// The lengths of the edges of a mesh, ascending.
fn lengths(sheet: &Sheet) -> Vec<f64> {
    let mut lengths = sheet.lengths().to_vec();
    lengths.sort_by(f64::total_cmp);
    lengths
}

/// The lengths of the sides of the outline of a drawing's mesh, as far as one edge of the mesh is one side.
fn boundary(mesh: &MeshFile) -> f64 {
    let sheet = mesh.clone().into_sheet().unwrap();
    let t = sheet.topology();
    let rim = t.edge_ids().filter(|e| t.is_boundary_edge(*e));
    rim.map(|e| sheet.lengths()[e.index()]).sum()
}

/// The net of a cube as a drawing becomes a mesh of its area, with outline and creases to nine digits, and
/// its creases fold by the right angles of the cube.
#[test]
fn a_net_is_read_and_folded_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("cube.obj"), CUBE).unwrap();
    for name in ["cube.svg", "cube.dxf"] {
        let said = unrolled(folder, "cube.obj", name, &[]);
        assert!(
            said.contains("8 vertices inside have one, the largest one 90 degrees"),
            "{said}"
        );
        assert!(said.contains("7 edges, 700 mm"), "{said}");
        assert!(
            said.contains("5 edges: 5 mountains, folded by 90 degrees"),
            "{said}"
        );
        let (mesh, said) = meshed(folder, name, &["--spacing", "50mm"]);
        assert!(said.contains("mountain  5 lines, 500 mm"), "{said}");
        assert!((area(&mesh) - 0.06).abs() < 1e-9 * 0.06);
        assert!((boundary(&mesh) - 1.4).abs() < 1e-9 * 1.4);
        let creases = mesh
            .creases
            .iter()
            .filter(|c| c.assignment == EdgeAssignment::Mountain);
        for crease in creases {
            // DXF files have no place for angles, and a mountain without one folds by 180 degrees.
            let expected = if name == "cube.svg" { -FRAC_PI_2 } else { -PI };
            assert!((crease.angle.unwrap() - expected).abs() < 1e-12);
        }
    }
    unrolled(folder, "cube.obj", "cube.fold", &[]);
    for pattern in ["cube.svg", "cube.fold"] {
        let done = run(folder, &["fold", pattern]);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        assert!(
            stdout(&done).contains("every crease ends within 5 degrees of its angle"),
            "{}",
            stdout(&done)
        );
        let found = summary(&folder.join("cube-run"));
        assert!(found.largest_strain < 1e-9, "{}", found.largest_strain);
        fs::remove_dir_all(folder.join("cube-run")).unwrap();
        fs::remove_file(folder.join("cube-run.toml")).ok();
    }
}

/// A closed band becomes a rectangle of the perimeter of its polygon; its FOLD file has the lengths of its
/// edges, the fold angles between its sides, and its shape in space as the second frame.
#[test]
fn a_band_is_a_rectangle_with_its_folded_form() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let n = 24;
    fs::write(folder.join("band.obj"), prism(n, 30.0, 80.0)).unwrap();
    let said = unrolled(folder, "band.obj", "band.fold", &["--unit", "mm"]);
    assert!(
        said.contains("none: the angles around each vertex"),
        "{said}"
    );
    let flat = read_mesh(&folder.join("band.fold")).unwrap();
    let perimeter = 0.06 * n as f64 * (PI / n as f64).sin();
    assert!((area(&flat) / (0.08 * perimeter) - 1.0).abs() < 1e-12);
    let inside = flat
        .creases
        .iter()
        .filter(|c| c.assignment == EdgeAssignment::Mountain);
    assert_eq!(inside.clone().count(), n - 1);
    for crease in inside {
        assert!((crease.angle.unwrap() + TAU / n as f64).abs() < 1e-12);
    }
    let second = MeshOptions {
        frame: Some(FoldFrame::Number(1)),
        ..MeshOptions::default()
    };
    let folded = read_mesh_with(&folder.join("band.fold"), &second).unwrap();
    assert_eq!(folded.faces, flat.faces);
    let [flat, folded] = [flat, folded].map(|mesh| mesh.into_sheet().unwrap());
    for (a, b) in flat.lengths().iter().zip(folded.lengths()) {
        assert!((a / b - 1.0).abs() < 1e-12);
    }
    let t = folded.topology();
    let angles = t
        .edge_ids()
        .filter_map(|e| fold_angle(t, folded.positions(), e));
    assert!(
        angles
            .into_iter()
            .all(|a| a.abs() < 1e-9 || (a + TAU / n as f64).abs() < 1e-9)
    );
    // Drawn as creases with a smaller angle, and as rulings without.
    let said = unrolled(folder, "band.obj", "band.svg", &["--unit", "mm"]);
    assert!(said.contains("rulings   23 lines"), "{said}");
    assert!(
        said.contains("23 edges fold less than 30 degrees, by 15 at most"),
        "{said}"
    );
    let said = unrolled(
        folder,
        "band.obj",
        "band.svg",
        &["--unit", "mm", "--crease-angle", "10"],
    );
    assert!(
        said.contains("23 edges: 23 mountains, folded by 15 degrees"),
        "{said}"
    );
    // Between quadrilaterals from rim to rim there is one ruling for each side, whatever their shape.
    fs::write(folder.join("ring.obj"), prism(60, 30.0, 5.0)).unwrap();
    let said = unrolled(folder, "ring.obj", "ring.svg", &["--unit", "mm"]);
    assert!(said.contains("rulings   59 lines"), "{said}");
    // Rulings are not cut, nor part of the mesh.
    unrolled(folder, "band.obj", "band.svg", &["--unit", "mm"]);
    let (mesh, said) = meshed(folder, "band.svg", &["--spacing", "20mm"]);
    assert!((area(&mesh) / (0.08 * perimeter) - 1.0).abs() < 1e-9);
    assert!(said.contains("left out"), "{said}");
}

/// The lines of the layer `guide` of a drawing in SVG, millimetres.
fn guides(drawing: &Path) -> Vec<[[f64; 2]; 2]> {
    let text = fs::read_to_string(drawing).unwrap();
    let (_, from) = text.split_once("id=\"guide\"").unwrap();
    let (layer, _) = from.split_once("</g>").unwrap();
    let paths = layer
        .split(" d=\"")
        .skip(1)
        .map(|path| path.split('"').next().unwrap());
    let lines = paths.flat_map(|path| path.split('M').skip(1));
    let line = |line: &str| {
        let numbers = line.split([' ', 'L']).map(|c| c.parse().unwrap());
        let [a, b, c, d] = numbers.collect::<Vec<f64>>()[..] else {
            panic!("{line}");
        };
        [[a, b], [c, d]]
    };
    lines.map(line).collect()
}

/// A ring of a cone, of quadrilaterals: its rulings are whole lines from rim to rim, which would meet at the
/// apex.
#[test]
fn rulings_of_a_cone_go_from_rim_to_rim_and_meet_at_its_apex() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (n, m, turn) = (64, 8, 0.75 * TAU);
    let mut text = String::new();
    for j in 0..=m {
        let height = j as f64 / m as f64;
        for i in 0..=n {
            let (s, c) = (turn * i as f64 / n as f64).sin_cos();
            let r = 0.05 * (1.0 + height);
            writeln!(text, "v {} {} {}", r * c, r * s, 0.1 * height).unwrap();
        }
    }
    for (i, j) in (0..m).flat_map(|j| (0..n).map(move |i| (i, j))) {
        let a = j * (n + 1) + i + 1;
        writeln!(text, "f {a} {} {} {}", a + 1, a + n + 2, a + n + 1).unwrap();
    }
    fs::write(folder.join("cone.obj"), text).unwrap();
    unrolled(folder, "cone.obj", "cone.svg", &["--unit", "m"]);
    let lines = guides(&folder.join("cone.svg"));
    // As many as there are columns, but for those at the two straight sides.
    assert!((n - 4..=n).contains(&lines.len()), "{}", lines.len());
    // The layout has sectors of a ring: 100 mm further out and 50 mm to the side, about an apex at which the
    // radius of the cone is 0.
    let slant = 50.0_f64.hypot(100.0);
    let width = turn * 50.0 / n as f64;
    let unit = |[p, q]: &[[f64; 2]; 2]| {
        let d = [q[0] - p[0], q[1] - p[1]];
        let length = d[0].hypot(d[1]);
        (length, d.map(|c| c / length))
    };
    // The point that is nearest to all of them.
    let (mut matrix, mut right) = (nalgebra::Matrix2::zeros(), nalgebra::Vector2::zeros());
    for line in &lines {
        let (length, [x, y]) = unit(line);
        // Chords of the rims are nearer to each other than the rims.
        let least = slant * (turn / n as f64 / 2.0).cos();
        assert!(length > least && length < 1.01 * slant, "{length}");
        let normal = nalgebra::Vector2::new(-y, x);
        let at = nalgebra::Vector2::from(line[0]);
        matrix += normal * normal.transpose();
        right += normal * normal.dot(&at);
    }
    let apex = matrix.try_inverse().unwrap() * right;
    for line in &lines {
        let (_, [x, y]) = unit(line);
        let off = (nalgebra::Vector2::from(line[0]) - apex).dot(&nalgebra::Vector2::new(-y, x));
        assert!(off.abs() < width / 4.0, "{line:?}: {off} mm from the apex");
    }
}

/// A cone whose mesh is a grid of squares, which no ruling follows: its lines do not cross.
#[test]
fn rulings_that_no_edge_follows_do_not_cross() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (n, side, sine) = (24, 0.1, 0.5);
    let mut text = String::new();
    for (i, j) in (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j))) {
        // Around the apex in the plane, and in space around the axis by `1 / sine` times the angle.
        let [x, y] = [i, j].map(|k| side * k as f64 / n as f64);
        let (r, angle) = (
            (x + 0.02).hypot(y - 0.04),
            (y - 0.04).atan2(x + 0.02) / sine,
        );
        let cosine = f64::sqrt(1.0 - sine * sine);
        let (s, c) = angle.sin_cos();
        writeln!(text, "v {} {} {}", r * sine * c, r * sine * s, -r * cosine).unwrap();
    }
    for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
        let a = j * (n + 1) + i + 1;
        writeln!(text, "f {a} {} {}", a + 1, a + n + 2).unwrap();
        writeln!(text, "f {a} {} {}", a + n + 2, a + n + 1).unwrap();
    }
    fs::write(folder.join("cone.obj"), text).unwrap();
    let strain = ["--unit", "m", "--strain", "0.01"];
    unrolled(folder, "cone.obj", "cone.svg", &strain);
    let lines = guides(&folder.join("cone.svg"));
    assert!(lines.len() > n, "{}", lines.len());
    let side_of = |[p, q]: &[[f64; 2]; 2], x: &[f64; 2]| {
        (q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0])
    };
    // Lines may end at each other, to round-off of drawings.
    let parts = |a: &[[f64; 2]; 2], b: &[[f64; 2]; 2]| {
        let [one, other] = [0, 1].map(|k| side_of(a, &b[k]));
        one * other < 0.0 && one.abs().min(other.abs()) > 1e-6
    };
    for (k, a) in lines.iter().enumerate() {
        for b in &lines[..k] {
            assert!(!(parts(a, b) && parts(b, a)), "{a:?} crosses {b:?}");
        }
    }
}

/// What is asked for and cannot be is refused with what to do, and no file is written.
#[test]
fn what_cannot_be_unrolled_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("cube.obj"), CUBE).unwrap();
    let mut ball = String::new();
    for j in 0..=8 {
        for i in 0..=8 {
            let [x, y] = [i, j].map(|k| 0.1 * (f64::from(k) - 4.0));
            writeln!(ball, "v {x} {y} {}", (1.0 - x * x - y * y).sqrt()).unwrap();
        }
    }
    for k in 0..64 {
        let a = k / 8 * 9 + k % 8 + 1;
        writeln!(
            ball,
            "f {a} {} {}\nf {a} {} {}",
            a + 1,
            a + 10,
            a + 10,
            a + 9
        )
        .unwrap();
    }
    fs::write(folder.join("ball.obj"), ball).unwrap();
    let message = refused(folder, "ball.obj", &[], 3);
    assert!(
        message.contains("49 vertices inside have an angle deficit"),
        "{message}"
    );
    assert!(
        message.contains("--cut") && message.contains("--strain"),
        "{message}"
    );
    let strain = message.rsplit("--strain ").next().unwrap();
    let strain: String = strain.chars().take_while(|c| *c != '`').collect();
    let said = unrolled(folder, "ball.obj", "ball.ply", &["--strain", &strain]);
    assert!(said.contains("not all edges keep their lengths"), "{said}");
    for (options, exit, expected) in [
        (&["--strain", "0"][..], 2, "the strain is 0"),
        (&["--crease-angle", "200"], 2, "the angle of creases"),
        (&["--scale", "-1"], 2, "the scale is -1"),
        (&["--gap", "-1mm"], 2, "the gap is -0.001"),
        (&["--cut", "0-6"], 2, "no edge joins the vertices 0 and 6"),
        (&["--cut", "0-99"], 2, "no edge joins the vertices 0 and 99"),
        (&["--cut", "0"], 2, "is no edge"),
        (&["--weld", "-1"], 2, "the tolerance for welding"),
    ] {
        let message = refused(folder, "cube.obj", options, exit);
        assert!(message.contains(expected), "{options:?}: {message}");
    }
    let same = run(folder, &["unroll", "cube.obj", "-o", "cube.obj"]);
    assert_eq!(code(&same), Some(2));
    let other = run(folder, &["unroll", "cube.obj", "-o", "cube.pdf"]);
    assert_eq!(code(&other), Some(2));
    assert!(
        stderr(&other).contains(".svg, .dxf, .obj"),
        "{}",
        stderr(&other)
    );
}

/// Named edges are cut, parts that touch are told apart, and vertices in the same place are mentioned.
#[test]
fn cuts_and_duplicates() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("cube.obj"), CUBE).unwrap();
    // Around the top of the cube: it is a piece of its own then.
    let said = unrolled(folder, "cube.obj", "a.svg", &["--cut", "4-5,5-6,6-7,7-4"]);
    assert!(said.starts_with("a.svg: 2 pieces of 12 faces"), "{said}");
    let mut split = String::new();
    let corners = [
        [0, 3, 2, 1],
        [4, 5, 6, 7],
        [0, 1, 5, 4],
        [1, 2, 6, 5],
        [2, 3, 7, 6],
        [3, 0, 4, 7],
    ];
    for v in corners.iter().flatten() {
        let place = [[0, 0], [1, 0], [1, 1], [0, 1]][v % 4];
        writeln!(split, "v {} {} {}", place[0], place[1], v / 4).unwrap();
    }
    for k in 0..6 {
        writeln!(
            split,
            "f {} {} {} {}",
            4 * k + 1,
            4 * k + 2,
            4 * k + 3,
            4 * k + 4
        )
        .unwrap();
    }
    fs::write(folder.join("split.obj"), split).unwrap();
    let said = unrolled(folder, "split.obj", "b.svg", &[]);
    assert!(
        said.contains("6 pieces") && said.contains("--weld 0"),
        "{said}"
    );
    let said = unrolled(folder, "split.obj", "b.svg", &["--weld", "0"]);
    assert!(said.contains("b.svg: 1 piece of 12 faces"), "{said}");
}

/// The strip between two circles of different size in tilted planes, from files of points, is developable,
/// and unrolls.
#[test]
fn a_strip_between_curves_is_unrolled() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let circle = |radius: f64, tilt: f64, z: f64| -> String {
        let point = |k: usize| {
            let (s, c) = (TAU * (k % 300) as f64 / 300.0).sin_cos();
            let x = radius * c;
            format!(
                "{}, {}, {}\n",
                x * tilt.cos(),
                radius * s,
                z + x * tilt.sin()
            )
        };
        (0..=300).map(point).collect()
    };
    fs::write(folder.join("lower.csv"), circle(60.0, 0.0, 0.0)).unwrap();
    fs::write(folder.join("upper.csv"), circle(35.0, 0.4, 110.0)).unwrap();
    let words = ["--columns", "60", "--unit", "mm", "-o", "strip.obj"];
    let made = run(
        folder,
        &[
            &["mesh", "lower.csv", "--strip-to", "upper.csv"][..],
            &words,
        ]
        .concat(),
    );
    assert_eq!(code(&made), Some(0), "{}", stderr(&made));
    assert!(
        stdout(&made).contains("60 rulings\ndevelopable: "),
        "{}",
        stdout(&made)
    );
    let said = unrolled(folder, "strip.obj", "strip.fold", &[]);
    assert!(
        said.contains("1 piece of 120 faces") && said.contains("all edges keep"),
        "{said}"
    );
    let [flat, strip] = ["strip.fold", "strip.obj"]
        .map(|name| read_mesh(&folder.join(name)).unwrap().into_sheet().unwrap());
    assert!((flat.area() / strip.area() - 1.0).abs() < 1e-12);
    assert_eq!(lengths(&flat).len(), lengths(&strip).len() + 1);
    let scene = "version = 1\n[sheet]\nmesh = { strip_between = { first = { path = \"lower.csv\", scale = 0.001 }, \
        second = { path = \"upper.csv\", scale = 0.001 }, columns = 60 } }\nmaterial = \"card\"\n[stop]\ntime = 0.01\n";
    fs::write(folder.join("strip.toml"), scene).unwrap();
    let info = run(folder, &["info", "strip.toml"]);
    assert_eq!(code(&info), Some(0), "{}", stderr(&info));
    assert!(
        stdout(&info).contains("faces            120"),
        "{}",
        stdout(&info)
    );
    for (words, exit, expected) in [
        (
            &["lower.csv", "--strip-to", "none.csv", "--columns", "60"][..],
            3,
            "none.csv",
        ),
        (
            &["lower.csv", "--strip-to", "upper.csv", "--columns", "2"],
            2,
            "columns is 2",
        ),
        (&["lower.csv", "--strip-to", "upper.csv"], 2, "--columns"),
        (
            &["lower.csv", "--strip-to", "strip.toml", "--columns", "60"],
            3,
            "three finite numbers",
        ),
    ] {
        let output = run(folder, &[&["mesh", "-o", "no.obj"][..], words].concat());
        assert_eq!(code(&output), Some(exit), "{words:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
        assert!(!folder.join("no.obj").exists());
    }
}

/// Meshes of other people: folded states become flat patterns with the lengths of their edges, solids become
/// nets without strain, what is curved or broken is refused, and nothing panics.
#[test]
fn meshes_of_other_people() {
    let Some(data) = data_folder() else { return };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for group in ["fold", "fold_reference", "nasty", "planar", "svg", "tools"] {
        for entry in fs::read_dir(data.join(group)).unwrap() {
            let path = entry.unwrap().path();
            let name = path.display().to_string();
            // It has 13 000 faces of a curved surface, and takes its time to be refused.
            if name.ends_with("table.obj") || isosheet_formats::MeshFormat::of(&path).is_none() {
                continue;
            }
            let output = run(folder, &["unroll", &name, "-o", "out.fold"]);
            assert!(
                matches!(code(&output), Some(0 | 3)),
                "{name}: {}",
                stderr(&output)
            );
            if code(&output) != Some(0) {
                let said = stderr(&output);
                assert!(
                    said.starts_with("error: ") && said.contains("= help: "),
                    "{name}: {said}"
                );
                continue;
            }
            let options = |frame| MeshOptions {
                frame: Some(FoldFrame::Number(frame)),
                ..MeshOptions::default()
            };
            let [flat, folded] = [0, 1].map(|frame| {
                let mesh = read_mesh_with(&folder.join("out.fold"), &options(frame)).unwrap();
                mesh.into_sheet().unwrap()
            });
            for (a, b) in flat.lengths().iter().zip(folded.lengths()) {
                assert!((a / b - 1.0).abs() <= 1e-3, "{name}: {a} {b}");
            }
            assert!(
                flat.positions()
                    .iter()
                    .skip(2)
                    .step_by(3)
                    .all(|z| *z == 0.0)
            );
        }
    }
    // Solids and folded states, as the page on patterns lists them: pieces, and the largest strain.
    for (name, options, pieces, strain) in [
        ("tools/cone.obj", &[][..], 1, 1e-14),
        ("tools/cylinder.obj", &[], 1, 1e-12),
        ("nasty/closed_tet.obj", &[], 1, 1e-14),
        ("nasty/closed_pentagons.obj", &[], 1, 1e-14),
        ("fold/edemaine_simple.fold", &[], 1, 1e-14),
        ("fold/edemaine_squaretwist_3d.fold", &[], 1, 1e-6),
        ("fold_reference/simpleVertex_50.fold", &[], 1, 1e-14),
        ("tools/skirt_annulus_nonplanar.obj", &[], 1, 1e-7),
        ("tools/punching_press_fixed.off", &[], 4, 1e-12),
        ("tools/punching_press_p2.off", &[], 6, 1e-12),
        ("tools/punching_press_p5.off", &[], 13, 1e-3),
        ("tools/plate_holes.STL", &["--crease-angle", "10"], 12, 1e-3),
    ] {
        let path = data.join(name).display().to_string();
        let said = unrolled(folder, &path, "out.obj", options);
        let words = if pieces == 1 {
            " piece of"
        } else {
            " pieces of"
        };
        assert!(
            said.contains(&format!("out.obj: {pieces}{words}")),
            "{name}: {said}"
        );
        let [flat, given] = [folder.join("out.obj"), path.into()].map(|path| {
            let options = MeshOptions {
                weld: name.ends_with("STL").then_some(0.0),
                ..MeshOptions::default()
            };
            read_mesh_with(&path, &options)
                .unwrap()
                .into_sheet()
                .unwrap()
        });
        let error = flat.area() / given.area() - 1.0;
        // Areas have the strains of both directions.
        assert!(error.abs() <= 2.0 * strain, "{name}: {error}");
    }
    // A folded state of a pattern, and the pattern itself, which is a square of the side 1 in nine panels.
    let folded = data
        .join("fold/edemaine_squaretwist_3d.fold")
        .display()
        .to_string();
    let said = unrolled(folder, &folded, "twist.fold", &[]);
    assert!(
        said.contains("1 piece of 18 faces, 1000 mm by 1000 mm"),
        "{said}"
    );
    assert!(said.contains("12 edges: 6 mountains, 6 valleys"), "{said}");
}
