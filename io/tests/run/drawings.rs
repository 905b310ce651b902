//! `isosheet mesh`.

use crate::{code, run, stderr};
use isosheet_formats::{EdgeAssignment, MeshFile, read_mesh};
use isosheet_runs::Recording;
use std::fs;
use std::path::Path;

/// Makes a mesh of a drawing and says what the command said.
pub(crate) fn meshed(folder: &Path, drawing: &str, options: &[&str]) -> (MeshFile, String) {
    let mut arguments = vec!["mesh", drawing, "-o", "out.fold"];
    arguments.extend(options);
    let output = run(folder, &arguments);
    assert_eq!(
        code(&output),
        Some(0),
        "{drawing} {options:?}: {}",
        stderr(&output)
    );
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let mesh = read_mesh(&folder.join("out.fold")).unwrap();
    mesh.clone().into_sheet().unwrap();
    (mesh, said)
}

pub(crate) fn refused(folder: &Path, drawing: &str, options: &[&str], exit: i32) -> String {
    let mut arguments = vec!["mesh", drawing, "-o", "refused.fold"];
    arguments.extend(options);
    let output = run(folder, &arguments);
    assert_eq!(
        code(&output),
        Some(exit),
        "{drawing} {options:?}: {}",
        stderr(&output)
    );
    assert!(output.stdout.is_empty() && !folder.join("refused.fold").exists());
    stderr(&output)
}

pub(crate) fn area(mesh: &MeshFile) -> f64 {
    mesh.clone().into_sheet().unwrap().area()
}

/// The faces in an order of their own: in that of the file they are as round-off has them.
fn in_order(mesh: &MeshFile) -> Vec<[u32; 3]> {
    let least_first = |&[a, b, c]: &[u32; 3]| match a.min(b).min(c) {
        least if least == a => [a, b, c],
        least if least == b => [b, c, a],
        _ => [c, a, b],
    };
    let mut faces: Vec<[u32; 3]> = mesh.faces.iter().map(least_first).collect();
    faces.sort_unstable();
    faces
}

/// The length of the edges with an assignment.
pub(crate) fn length(mesh: &MeshFile, assignment: EdgeAssignment) -> f64 {
    let p = mesh.positions.as_chunks::<3>().0;
    let own = mesh.creases.iter().filter(|c| c.assignment == assignment);
    own.map(|c| {
        let [a, b] = c.ends.map(|v| p[v as usize]);
        (a[0] - b[0]).hypot(a[1] - b[1])
    })
    .sum()
}

/// A drawing in millimetres on a page of 200 by 100.
pub(crate) fn svg(shapes: &str) -> String {
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='200mm' height='100mm' viewBox='0 0 200 100' \
         fill='none' stroke='black'>{shapes}</svg>"
    )
}

const FRAME: &str = "<rect x='10' y='10' width='100' height='60'/>";

#[test]
fn one_drawing_in_many_units_is_one_mesh() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let shapes =
        "<path d='M10 10 H110 L95 70 L12 66 Z'/><path stroke='red' d='M40 10 Q60 40 50 68'/>";
    let grown = |f: f64| {
        let t = |x: f64| f * x;
        format!(
            "<path d='M{} {} H{} L{} {} L{} {} Z'/><path stroke='red' d='M{} {} Q{} {} {} {}'/>",
            t(10.),
            t(10.),
            t(110.),
            t(95.),
            t(70.),
            t(12.),
            t(66.),
            t(40.),
            t(10.),
            t(60.),
            t(40.),
            t(50.),
            t(68.)
        )
    };
    let page = |size: &str, view: &str, inner: &str| {
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' {size} {view} fill='none' stroke='#000'>{inner}</svg>"
        )
    };
    let mm = 96.0 / 25.4;
    let drawings = [
        ("mm", svg(shapes), vec![]),
        (
            "in",
            page(
                "width='7.874015748031496in' height='3.937007874015748in'",
                "viewBox='0 0 200 100'",
                shapes,
            ),
            vec![],
        ),
        (
            "px",
            page(
                &format!("width='{}' height='{}'", 200.0 * mm, 100.0 * mm),
                "",
                &grown(mm),
            ),
            vec![],
        ),
        (
            "cm",
            page(
                "width='20cm'",
                "viewBox='5 7 200 100'",
                &format!("<g transform='translate(5 7)'>{shapes}</g>"),
            ),
            vec![],
        ),
        (
            "nested",
            svg(&format!(
                "<svg x='20' y='10' width='180' height='90' viewBox='0 0 360 180'><g transform='translate(-40,-20) \
                 scale(2)'><g transform='rotate(90)'><g transform='rotate(-90)'>{shapes}</g></g></g></svg>"
            )),
            vec![],
        ),
        (
            "css",
            svg(&format!(
                "<style>.moved {{ transform: translate(20px, 10px) }} .half {{ transform: rotate(90deg) scale(.5) }}</style>\
                 <g class='moved' transform='nonsense'><g style='transform: translate(-20px,-10px)'>\
                 <g class='half' style='transform-origin: 0 0'><g transform='scale(2) rotate(-90)'>\
                 <g transform='rotate(180)' transform-origin='30 40'><g transform='translate(60 80) rotate(180)'>\
                 {shapes}</g></g></g></g></g></g>"
            )),
            vec![],
        ),
        (
            "use",
            svg(&format!(
                "<defs><g id='a'>{shapes}</g></defs><use href='#a' x='3' transform='translate(-3)'/>"
            )),
            vec![],
        ),
        (
            "unit",
            page("width='100' height='50'", "viewBox='0 0 200 100'", shapes),
            vec!["--unit", "mm"],
        ),
        (
            "scale",
            page(
                "width='20mm' height='10mm'",
                "viewBox='0 0 200 100'",
                shapes,
            ),
            vec!["--scale", "10"],
        ),
    ];
    let mut first: Option<MeshFile> = None;
    for (name, text, options) in drawings {
        let file = format!("{name}.svg");
        fs::write(dir.join(&file), text).unwrap();
        let (mesh, _) = meshed(dir, &file, &[&["--spacing", "7mm"][..], &options].concat());
        let Some(first) = &first else {
            // The corner at (10, 10) is 90 mm above the lower edge of the page.
            let near = |p: &[f64; 3]| (p[0] - 0.01).hypot(p[1] - 0.09) < 1e-12;
            assert!(mesh.positions.as_chunks::<3>().0.iter().any(near));
            first = Some(mesh);
            continue;
        };
        assert_eq!(in_order(&mesh), in_order(first), "{name}");
        let pairs = mesh.positions.iter().zip(&first.positions);
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-12, "{name}: {off}");
    }
}

/// Where lines lie on each other, the one that says what they are says by how much they fold.
#[test]
fn a_line_on_another_folds_by_its_own_angle() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let line = |look: &str| format!("<line {look} x1='70' x2='70' y1='10' y2='70'/>");
    let half = line("stroke='red' opacity='0.5'");
    let angles = |shapes: &str| {
        fs::write(dir.join("a.svg"), svg(&format!("{FRAME}{shapes}"))).unwrap();
        let (mesh, _) = meshed(dir, "a.svg", &["--spacing", "20mm"]);
        let angles: Vec<_> = mesh.creases.iter().filter_map(|c| c.angle).collect();
        assert!(!angles.is_empty());
        angles
    };
    assert_eq!(angles(&(line("stroke='yellow'") + &half)), angles(&half));
}

/// Lines by colour, dash, layer, class and style; what is said of them, and the assignments that edges get.
#[test]
fn lines_are_what_colours_layers_and_options_say() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let shapes = format!(
        "<style>.v {{ stroke: #2e3192 }}</style>{FRAME}\
         <g xmlns:i='http://www.inkscape.org/namespaces/inkscape' i:label='Score lines'><line x1='30' x2='30' y1='10' y2='70'/></g>\
         <line class='v' x1='50' x2='50' y1='10' y2='70'/>\
         <line style='stroke:#ed1c24;stroke-opacity:0.5' x1='70' x2='70' y1='10' y2='70'/>\
         <line stroke-dasharray='2 1' x1='90' x2='90' y1='10' y2='70'/>\
         <line stroke='yellow' x1='30' x2='50' y1='40' y2='40'/>\
         <line stroke='white' x1='0' x2='50' y1='0' y2='40'/>\
         <line stroke='lime' x1='55' x2='65' y1='40' y2='40'/>\
         <text x='3' y='4'>Panel 1</text><image href='x.png'/><g display='none'><path d='M0 0 H9'/></g>"
    );
    fs::write(dir.join("a.svg"), svg(&shapes)).unwrap();
    let (mesh, said) = meshed(dir, "a.svg", &["--spacing", "5mm"]);
    for line in [
        "100 mm by 60 mm",
        "cut       5 lines, 330 mm: black (4), green (1)",
        "mountain  1 line, 60 mm: red (1)",
        "valley    1 line, 60 mm: blue (1)",
        "crease    2 lines, 120 mm: dashed (1), layer \"Score lines\" (1)",
        "flat      1 line, 20 mm: yellow (1)",
        "left out  1 line, 64.03 mm: white (1)",
        "left out: text (1)",
        "left out: image (1)",
        "left out: hidden element (1)",
    ] {
        assert!(said.contains(line), "{line}: {said}");
    }
    for (assignment, expected) in [
        (EdgeAssignment::Mountain, 0.06),
        (EdgeAssignment::Valley, 0.06),
        (EdgeAssignment::Unassigned, 0.12),
        // Both sides of the slit.
        (EdgeAssignment::Boundary, 0.32 + 0.02),
    ] {
        let found = length(&mesh, assignment);
        assert!((found - expected).abs() < 1e-12, "{assignment:?}: {found}");
    }
    let mountains = mesh
        .creases
        .iter()
        .filter(|c| c.assignment == EdgeAssignment::Mountain);
    for crease in mountains {
        assert!((crease.angle.unwrap() + std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }
    assert!((area(&mesh) - 0.006).abs() < 1e-14);
    let swapped = [
        "--spacing",
        "5mm",
        "--valley",
        "red",
        "--mountain",
        "#2e3192",
        "--flat",
        "layer:score lines",
    ];
    let (_, said) = meshed(
        dir,
        "a.svg",
        &[&swapped[..], &["--ignore", "dashed"]].concat(),
    );
    for line in [
        "mountain  1 line, 60 mm: #2e3192 (1)",
        "valley    1 line, 60 mm: red (1)",
        "left out  2 lines, 124.03 mm: dashed (1), white (1)",
        "flat      2 lines, 80 mm: layer:score lines (1), yellow (1)",
    ] {
        assert!(said.contains(line), "{line}: {said}");
    }
}

/// The vertices of an arc are on its circle, the vertices of a hole on its own, and an annulus has two
/// boundaries.
#[test]
fn curved_creases_and_holes() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let shapes = "<circle cx='60' cy='50' r='40'/><circle cx='75' cy='50' r='10'/>\
                  <path stroke='blue' d='M 36 18 A 40 40 0 0 1 36 82'/>";
    fs::write(dir.join("a.svg"), svg(shapes)).unwrap();
    let (mesh, _) = meshed(dir, "a.svg", &["--spacing", "4mm"]);
    let sheet = mesh.clone().into_sheet().unwrap();
    assert_eq!(sheet.topology().boundary_loops().len(), 2);
    let p = mesh.positions.as_chunks::<3>().0;
    let off = |v: u32, centre: [f64; 2], radius: f64| {
        let [x, y, _] = p[v as usize];
        ((x - centre[0]).hypot(y - centre[1]) - radius).abs()
    };
    // The chord from (36, 18) to (36, 82) is 64 long, so that the centre of the arc is 24 away from it.
    let mut count = 0;
    for crease in &mesh.creases {
        for v in crease.ends {
            match crease.assignment {
                EdgeAssignment::Valley => assert!(off(v, [0.012, 0.05], 0.04) < 1e-9),
                EdgeAssignment::Boundary => {
                    let outline = off(v, [0.06, 0.05], 0.04);
                    assert!(outline.min(off(v, [0.075, 0.05], 0.01)) < 1e-9);
                }
                _ => continue,
            }
            count += 1;
        }
    }
    assert!(count > 100, "{count}");
    // The circles of crease and outline cross at 74 degrees: cos a = (40^2 + 40^2 - 48^2) / (2 40^2).
    let mut least = f64::INFINITY;
    for f in &mesh.faces {
        for k in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|i| p[f[(k + i) % 3] as usize]);
            let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
            let angle = (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]);
            least = least.min(angle.to_degrees());
        }
    }
    assert!(least >= 20.0, "{least}");
}

/// Equal lines in DXF and SVG files are the same mesh.
#[test]
fn dxf_is_read_as_svg_is() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let groups = |entity: &str, pairs: &[(i32, f64)]| {
        let layer = match entity {
            "LINE" | "ARC" => "SCORE",
            _ => "CUT",
        };
        let pairs: String = pairs.iter().map(|(c, v)| format!("{c}\n{v}\n")).collect();
        format!("0\n{entity}\n8\n{layer}\n{pairs}")
    };
    let outline = groups(
        "LWPOLYLINE",
        &[
            (70, 1.0),
            (10, 10.0),
            (20, 30.0),
            (10, 110.0),
            (20, 30.0),
            (42, 0.5),
            (10, 110.0),
            (20, 90.0),
            (10, 10.0),
            (20, 90.0),
        ],
    );
    let entities = [
        outline,
        groups("LINE", &[(10, 40.0), (20, 30.0), (11, 40.0), (21, 90.0)]),
        groups(
            "ARC",
            &[(10, 110.0), (20, 60.0), (40, 30.0), (50, 90.0), (51, 270.0)],
        ),
        groups("CIRCLE", &[(10, 25.0), (20, 60.0), (40, 5.0)]),
        groups("TEXT", &[(10, 0.0), (20, 0.0)]),
    ];
    let dxf = |units: i32, entities: &[String]| {
        format!(
            "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{units}\n0\nENDSEC\n0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n\
             0\nLAYER\n2\nOFF\n62\n-1\n0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{}0\nLINE\n8\nOFF\n10\n0\n20\n0\n\
             11\n9\n21\n9\n0\nENDSEC\n0\nEOF\n",
            entities.concat()
        )
    };
    fs::write(dir.join("a.dxf"), dxf(4, &entities)).unwrap();
    let (of_dxf, said) = meshed(dir, "a.dxf", &["--spacing", "5mm"]);
    for line in [
        "layer \"CUT\" (5)",
        "layer \"SCORE\" (2)",
        "text (1)",
        "hidden entity (1)",
    ] {
        assert!(said.contains(line), "{line}: {said}");
    }
    // The bulge 0.5 over a chord of 60 is an arc of the radius 60 (1 + 0.25) / (4 * 0.5).
    let shapes = "<path d='M10 70 H110 A37.5 37.5 0 0 0 110 10 H10 Z'/><circle cx='25' cy='40' r='5'/>\
                  <g stroke='magenta'><line x1='40' x2='40' y1='10' y2='70'/><path d='M110 10 A30 30 0 0 0 110 70'/></g>";
    fs::write(dir.join("a.svg"), svg(shapes)).unwrap();
    let (of_svg, _) = meshed(dir, "a.svg", &["--spacing", "5mm"]);
    assert!((area(&of_dxf) - area(&of_svg)).abs() < 1e-4 * area(&of_svg));
    for assignment in [EdgeAssignment::Boundary, EdgeAssignment::Unassigned] {
        let [a, b] = [&of_dxf, &of_svg].map(|m| length(m, assignment));
        assert!((a - b).abs() < 1e-3 * b, "{assignment:?}: {a} {b}");
    }
    // Without a unit millimetres are taken, and that is said; inches are longer.
    fs::write(dir.join("b.dxf"), dxf(0, &entities)).unwrap();
    let (same, said) = meshed(dir, "b.dxf", &["--spacing", "5mm"]);
    assert!(
        said.contains("no unit of length, 1 is 1 mm is taken"),
        "{said}"
    );
    assert_eq!(same.positions, of_dxf.positions);
    let (inches, _) = meshed(dir, "b.dxf", &["--spacing", "5in", "--unit", "in"]);
    assert!((area(&inches) / area(&of_dxf) / 25.4_f64.powi(2) - 1.0).abs() < 1e-3);
    fs::write(dir.join("c.dxf"), "nonsense\n0\n").unwrap();
    let said = refused(dir, "c.dxf", &["--spacing", "5mm"], 3);
    assert!(
        said.contains("line 1: \"nonsense\" is no number of a group"),
        "{said}"
    );
    fs::write(dir.join("d.dxf"), dxf(4, &[])).unwrap();
    assert!(refused(dir, "d.dxf", &["--spacing", "5mm"], 3).contains("no lines"));
}

#[test]
fn gaps_and_double_lines_are_told() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let shapes = "<path d='M10 10 H110 V70 H10 V10.2'/><line stroke='red' x1='50' x2='50' y1='10' y2='69.9'/>\
                  <line stroke='red' x1='50.01' x2='50.01' y1='20' y2='40'/>\
                  <line stroke='blue' x1='50' x2='50' y1='40' y2='50'/>\
                  <line stroke='blue' x1='80' x2='80' y1='0' y2='90'/>";
    fs::write(dir.join("a.svg"), svg(shapes)).unwrap();
    let said = refused(dir, "a.svg", &["--spacing", "5mm"], 3);
    assert!(said.contains("(10, 90) mm, 0.2 mm from the next"), "{said}");
    assert!(said.contains("--snap"), "{said}");
    let (mesh, said) = meshed(dir, "a.svg", &["--spacing", "5mm", "--snap", "0.25mm"]);
    for line in [
        "joined over a gap, the widest 0.2 mm at (10, ",
        "note: 2 lines drawn more than once, the longest 20 mm at (50, 70) mm",
        "note: 1 of them is of several classes",
        "note: 2 lines beyond the outline or in a hole left out, the longest 20 mm at (80, 20) mm",
    ] {
        assert!(said.contains(line), "{line}: {said}");
    }
    assert!((length(&mesh, EdgeAssignment::Valley) - 0.06).abs() < 1e-9);
    // A mountain on a valley is a fold to either side.
    assert!((length(&mesh, EdgeAssignment::Unassigned) - 0.01).abs() < 1e-9);
}

/// A line of ten thousand parts is a line, though each of them is shorter than the tolerance for snapping.
#[test]
fn fine_lines_are_kept() {
    let dir = tempfile::tempdir().unwrap();
    let points: Vec<String> = (0..=10_000)
        .map(|k| format!("50,{}", 0.01 * f64::from(k)))
        .collect();
    let shapes = format!(
        "<rect width='100' height='100' fill='none' stroke='black'/>\
         <polyline points='{}' fill='none' stroke='blue'/>",
        points.join(" ")
    );
    fs::write(dir.path().join("fine.svg"), svg(&shapes)).unwrap();
    let (mesh, said) = meshed(dir.path(), "fine.svg", &["--spacing", "10mm"]);
    let found = length(&mesh, EdgeAssignment::Valley);
    assert!((found - 0.1).abs() < 1e-6, "{found} {said}");
}

#[test]
fn what_is_no_sheet_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let spacing = ["--spacing", "5mm"];
    for (shapes, expected) in [
        ("", "the drawing has no lines"),
        ("<text>hello</text><image/>", "the drawing has no lines"),
        (
            "<line x1='0' y1='0' x2='50' y2='50'/>",
            "the outline is not closed: 2 lines end at",
        ),
        (
            "<path d='M10 10 L90 70 V10 L10 70 Z'/>",
            "an outline crosses itself at (50, 60) mm",
        ),
        (
            "<rect width='50' height='50' stroke='red'/>",
            "there is no outline",
        ),
        (
            "<rect width='50' height='50'/><line x1='0' y1='0' x2='50' y2='50' stroke='#ff8000'/>",
            "not known what the lines of the colour #ff8000 are",
        ),
        (
            "<g transform='nonsense'><path d='M0 0 H9'/></g>",
            "\"nonsense\" is no transform",
        ),
    ] {
        fs::write(dir.join("a.svg"), svg(shapes)).unwrap();
        let said = refused(dir, "a.svg", &spacing, 3);
        assert!(said.contains(expected), "{expected}: {said}");
        assert!(said.contains("= help:"), "{said}");
    }
    for (text, expected) in [
        ("", "the file is not valid XML"),
        ("<html/>", "its root is <html>"),
        (
            "<svg xmlns='http://www.w3.org/2000/svg'><g id='a'><use href='#a'/></g></svg>",
            "nested or used too often",
        ),
    ] {
        fs::write(dir.join("b.svg"), text).unwrap();
        let said = refused(dir, "b.svg", &spacing, 3);
        assert!(said.contains(expected), "{expected}: {said}");
    }
    fs::write(dir.join("a.svg"), svg(FRAME)).unwrap();
    for options in [
        ["--spacing", "0"],
        ["--spacing", "-1mm"],
        ["--spacing", "five"],
        ["--spacing", "5parsec"],
        ["--spacing", "nanmm"],
    ] {
        refused(dir, "a.svg", &options, 2);
    }
    for more in [
        ["--snap", "0"],
        ["--scale", "0"],
        ["--cut", "layer"],
        ["--unit", "yd"],
    ] {
        refused(dir, "a.svg", &[&spacing[..], &more].concat(), 2);
    }
    // 6000 mm2 in triangles of 1/2.31 of 0.0372 mm squared.
    let said = refused(dir, "a.svg", &["--spacing", "0.0372mm"], 2);
    assert!(said.contains("about 1e7 triangles"), "{said}");
    refused(dir, "none.svg", &spacing, 3);
    fs::write(dir.join("a.png"), "").unwrap();
    assert!(refused(dir, "a.png", &spacing, 3).contains("no drawing"));
    // Wider than the sheet: as few triangles as it takes.
    let (mesh, _) = meshed(dir, "a.svg", &["--spacing", "5m"]);
    assert!(mesh.faces.len() < 10 && (area(&mesh) - 0.006).abs() < 1e-15);
}

#[test]
fn other_formats_have_the_mesh_alone() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("a.svg"), svg(FRAME)).unwrap();
    let arguments = ["mesh", "a.svg", "-o", "a.obj", "--spacing", "5mm"];
    let output = run(dir, &arguments);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains(".fold has"));
    assert!((area(&read_mesh(&dir.join("a.obj")).unwrap()) - 0.006).abs() < 1e-12);
    for wrong in ["a.step", "a.svg"] {
        let output = run(dir, &["mesh", "a.svg", "-o", wrong, "--spacing", "5mm"]);
        assert_eq!(code(&output), Some(2), "{wrong}");
    }
}

/// A symbol is drawn in the size that its use gives it, as its `viewBox` says, and so is a page within the
/// page.
#[test]
fn symbols_have_their_own_coordinates() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let page = |content: &str| {
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100' fill='none'>{content}</svg>"
        )
    };
    let rectangle = "<rect width='1' height='1' stroke='black'/>";
    let symbol = format!("<symbol id='a' viewBox='0 0 2 2'>{rectangle}</symbol>");
    let nested = format!(
        "<defs><svg id='a' viewBox='0 0 2 2' width='7' height='7'>{rectangle}</svg></defs>"
    );
    for (name, content, side) in [
        ("whole", format!("{symbol}<use href='#a'/>"), 0.05),
        (
            "sized",
            format!("{symbol}<use href='#a' x='10' width='80' height='80'/>"),
            0.04,
        ),
        // The smaller side counts, and the drawing is in the middle of the other one.
        (
            "wide",
            format!("{symbol}<use href='#a' width='80' height='40'/>"),
            0.02,
        ),
        (
            "page",
            format!("{nested}<use href='#a' width='60' height='60'/>"),
            0.03,
        ),
        ("own", format!("{nested}<use href='#a'/>"), 0.0035),
    ] {
        fs::write(dir.join("a.svg"), page(&content)).unwrap();
        let (mesh, said) = meshed(dir, "a.svg", &["--spacing", "10mm"]);
        assert!(
            (area(&mesh) / (side * side) - 1.0).abs() < 1e-9,
            "{name}: {said}"
        );
    }
}

/// Whatever cannot be read of a shape is refused with its line: no line of the sheet is lost.
#[test]
fn broken_shapes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    for (shape, expected) in [
        (
            "<path d='M0 0 H9 V nan H0 Z' stroke='black'/>",
            "`d` is no path data",
        ),
        (
            "<path d='M0 0 H9 V9 L 1' stroke='black'/>",
            "`d` is no path data",
        ),
        (
            "<polygon points='0,0 9,0 9' stroke='black'/>",
            "an odd number",
        ),
        (
            "<polygon points='0,0 9,x' stroke='black'/>",
            "no list of numbers",
        ),
        (
            "<rect width='9' height='nine' stroke='black'/>",
            "`height` is \"nine\"",
        ),
        ("<circle r='' stroke='black'/>", "`r` is \"\""),
        ("<svg viewBox='0 0 a b'/>", "`viewBox` is \"0 0 a b\""),
        ("<g transform='turn(1)'/>", "no transform"),
        (
            "<g transform='scale(2)' transform-origin='50% center'/>",
            "which is no point of two numbers",
        ),
    ] {
        let text =
            format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'>\n{shape}</svg>");
        fs::write(dir.join("a.svg"), text).unwrap();
        let said = refused(dir, "a.svg", &["--spacing", "5mm"], 3);
        assert!(
            said.contains(expected) && said.contains("line 2"),
            "{shape}: {said}"
        );
    }
}

#[test]
fn a_dxf_file_that_ends_too_early_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    let line =
        |[a, b, c, d]: [i32; 4]| format!("0\nLINE\n8\nCUT\n10\n{a}\n20\n{b}\n11\n{c}\n21\n{d}\n");
    let sides = [
        [0, 0, 50, 0],
        [50, 0, 50, 50],
        [50, 50, 0, 50],
        [0, 50, 0, 0],
    ];
    let lines: String = sides.into_iter().map(line).collect();
    let begin = "0\nSECTION\n2\nENTITIES\n";
    fs::write(
        dir.join("a.dxf"),
        format!("\u{feff}{begin}{lines}0\nENDSEC\n0\nEOF\n"),
    )
    .unwrap();
    let (mesh, _) = meshed(dir, "a.dxf", &["--spacing", "10mm"]);
    assert!((area(&mesh) - 0.0025).abs() < 1e-12);
    // What is there is a whole sheet, but the rest of the file is missing.
    fs::write(dir.join("b.dxf"), format!("{begin}{lines}0\nLINE\n8\n")).unwrap();
    fs::write(dir.join("c.dxf"), format!("{begin}{lines}")).unwrap();
    for name in ["b.dxf", "c.dxf"] {
        let said = refused(dir, name, &["--spacing", "10mm"], 3);
        assert!(said.contains("ends in the middle of a section"), "{said}");
        assert!(said.contains("not complete"), "{said}");
    }
}

#[test]
fn selectors_that_select_nothing_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    fs::write(
        dir.join("a.svg"),
        svg("<rect width='20' height='20' stroke='black' id='frame'/>"),
    )
    .unwrap();
    for selector in ["layer:FOLDS", "cyan", "#123456", "dashed"] {
        let said = refused(dir, "a.svg", &["--spacing", "5mm", "--crease", selector], 3);
        assert!(
            said.contains(&format!("{selector} selects no line")),
            "{said}"
        );
        assert!(
            said.contains("the colours are black") && said.contains("\"frame\""),
            "{said}"
        );
    }
    meshed(dir, "a.svg", &["--spacing", "5mm", "--cut", "layer:FRAME"]);
}

/// A unit that makes another size than the page says is told with both; one that is that of the page is not.
#[test]
fn a_unit_that_is_not_that_of_the_file_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    // As drawing programs write it: points in the drawing, millimetres on the page.
    let points = "<svg xmlns='http://www.w3.org/2000/svg' width='211.5mm' height='100mm' \
                  viewBox='0 0 599.53 283.46' fill='none' stroke='black'><rect width='599.53' height='141.73'/></svg>";
    fs::write(dir.join("a.svg"), points).unwrap();
    let spacing = ["--spacing", "20mm"];
    let (_, said) = meshed(dir, "a.svg", &spacing);
    assert!(said.contains(", 211.5 mm by 50 mm\n"), "{said}");
    assert!(!said.contains("in the unit of the file"), "{said}");
    let (_, said) = meshed(dir, "a.svg", &["--spacing", "50mm", "--unit", "mm"]);
    let told =
        "599.53 mm by 141.73 mm in the given unit, and 211.5 mm by 50 mm in the unit of the file";
    assert!(said.contains(told), "{said}");
    let (_, said) = meshed(dir, "a.svg", &["--spacing", "20mm", "--unit", "pt"]);
    assert!(!said.contains("in the unit of the file"), "{said}");
    // A page of pixels has no unit that could be another one.
    let pixels = "<svg xmlns='http://www.w3.org/2000/svg' width='200' height='100' fill='none' stroke='black'>\
                  <rect width='100' height='50'/></svg>";
    fs::write(dir.join("a.svg"), pixels).unwrap();
    let (_, said) = meshed(dir, "a.svg", &["--spacing", "20mm", "--unit", "mm"]);
    assert!(!said.contains("in the unit of the file"), "{said}");
    let dxf = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n1\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\n\
               50\n0\nENDSEC\n0\nEOF\n";
    fs::write(dir.join("a.dxf"), dxf).unwrap();
    let (_, said) = meshed(dir, "a.dxf", &["--spacing", "20mm", "--unit", "mm"]);
    let told = "100 mm by 100 mm in the given unit, and 2540 mm by 2540 mm in the unit of the file";
    assert!(said.contains(told), "{said}");
}

/// Lengths in another unit than was meant are told with what they are compared with.
#[test]
fn lengths_that_are_larger_than_the_drawing_are_told() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("a.svg"), svg(FRAME)).unwrap();
    let (_, said) = meshed(dir, "a.svg", &["--spacing", "5"]);
    assert!(
        said.contains("note: the spacing is 5000 mm, longer than the sheet"),
        "{said}"
    );
    let said = refused(dir, "a.svg", &["--spacing", "5mm", "--snap", "0.35"], 2);
    assert!(
        said.contains("once ends that are 0.35 m apart are joined")
            && said.contains("give a smaller tolerance"),
        "{said}"
    );
}

#[test]
fn all_colours_of_unknown_lines_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let lines = "<path stroke='#ff8000' d='M20 10 V70'/><path stroke='#009fe3' stroke-dasharray='2 1' d='M40 10 V70'/>";
    fs::write(dir.join("a.svg"), svg(&format!("{FRAME}{lines}"))).unwrap();
    let said = refused(dir, "a.svg", &["--spacing", "5mm"], 3);
    let told = "what the lines of the colours #ff8000, dashed cyan are";
    assert!(said.contains(told), "{said}");
}

/// The carton of the book is glued while its creases are folded by 90 degrees, and stays closed when they
/// spring back.
#[test]
fn a_flap_is_glued_while_the_carton_is_folded() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/drawing.md");
    let page = fs::read_to_string(page).unwrap();
    let block = |begin: &str, has: &str| {
        let blocks = page.split(begin).skip(1);
        let mut blocks = blocks.map(|b| b.split("```").next().unwrap());
        blocks.find(|b| b.contains(has)).unwrap().to_owned()
    };
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(dir.join("sleeve.svg"), block("```xml\n", "M160 0 V60")).unwrap();
    // How far apart the ends of the four sides are at two times, metres.
    let apart = |name: &str, text: &str| {
        fs::write(dir.join("sleeve.toml"), text).unwrap();
        let done = run(dir, &["simulate", "sleeve.toml", "-o", name]);
        assert_eq!(code(&done), Some(0), "{}", stderr(&done));
        let recording = Recording::read(&dir.join(name)).unwrap();
        let points = recording.sheet.positions().as_chunks::<3>().0;
        let at = |x: f64| {
            let mut vertices = points.iter();
            let near = |p: &[f64; 3]| (p[0] - x).hypot(p[1] - 0.06) < 1e-9;
            3 * vertices.position(near).unwrap()
        };
        let [a, b] = [0.0, 0.16].map(at);
        let times = recording.trajectory.times();
        [1.5, 4.0].map(|t| {
            let k = times.iter().position(|time| *time >= t - 1e-9).unwrap();
            let x = recording.trajectory.frame(k).unwrap();
            (0..3)
                .map(|k| (x[a + k] - x[b + k]).powi(2))
                .sum::<f64>()
                .sqrt()
        })
    };
    let text = block("```toml\n", "sleeve.svg\"");
    let [glue, after] = ["[[glue]]", "[[measure]]"].map(|key| text.find(key).unwrap());
    let [folded, end] = apart("glued", &text);
    assert!(folded < 1e-4 && end < 1e-4, "{folded} {end}");
    // Four sides of 40 mm that turn by 60 degrees are four of a hexagon.
    let [_, end] = apart("open", &[&text[..glue], &text[after..]].concat());
    assert!((end - 0.04 * 3.0_f64.sqrt()).abs() < 1e-3, "{end}");
}
