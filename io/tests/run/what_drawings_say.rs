//! What drawings of other programs say: names, blocks, dashes, outlines that are creases, several pieces.

use crate::drawings::{area, length, meshed, refused, svg};
use isosheet_formats::{EdgeAssignment, MeshFile};
use std::fs;

const MM: f64 = 1e-3;

/// A frame of 100 by 50 and a line across its middle, in groups with these attributes.
fn named(cut: &str, crease: &str) -> String {
    svg(&format!(
        "<g {cut}><path d='M0 0 H100 V50 H0 Z'/></g><g {crease}><path stroke='green' d='M50 0 V50'/></g>"
    ))
}

/// The length of the edges that fold to either side, millimetres.
fn creased(mesh: &MeshFile) -> f64 {
    length(mesh, EdgeAssignment::Unassigned) / MM
}

#[test]
fn names_and_identifiers_say_what_lines_are() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let label = "xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape' inkscape:label";
    for (cut, crease) in [
        ("id='CUT'", "id='CREASE'".to_owned()),
        ("id='CUT'", "id='CREASE' data-name='摺線'".to_owned()),
        ("id='CUT'", format!("id='CREASE' {label}='Ebene 2'")),
        ("id='CUT'", format!("id='layer2' {label}='crease'")),
        // The name that people see counts before the identifier.
        ("id='CUT'", format!("id='cut-2' {label}='crease'")),
    ] {
        fs::write(dir.join("a.svg"), named(cut, &crease)).unwrap();
        let (mesh, said) = meshed(dir, "a.svg", &["--spacing", "10mm"]);
        assert!((creased(&mesh) - 50.0).abs() < 1e-9, "{crease}: {said}");
    }
    let plain = named("id='a'", "id='b' data-name='摺線'");
    fs::write(dir.join("a.svg"), plain).unwrap();
    for name in ["layer:b", "layer:摺線"] {
        let (mesh, said) = meshed(dir, "a.svg", &["--spacing", "10mm", "--crease", name]);
        assert!((creased(&mesh) - 50.0).abs() < 1e-9, "{name}: {said}");
    }
    // A long name is told by its beginning.
    let long = format!("id='crease {}'", "n".repeat(100_000));
    fs::write(dir.join("a.svg"), named("id='cut'", &long)).unwrap();
    let (_, said) = meshed(dir, "a.svg", &["--spacing", "10mm"]);
    assert!(
        said.contains("... (100007 characters)") && said.len() < 1000,
        "{}",
        said.len()
    );
}

#[test]
fn dashes_in_percent_and_hints_are_no_cuts() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let drawn = |line: &str| svg(&format!("<rect width='100' height='50'/>{line}"));
    fs::write(
        dir.join("a.svg"),
        drawn("<path stroke-dasharray='2%,1%' d='M50 0 V50'/>"),
    )
    .unwrap();
    let (mesh, said) = meshed(dir, "a.svg", &["--spacing", "10mm"]);
    assert!((creased(&mesh) - 50.0).abs() < 1e-9, "{said}");
    fs::write(
        dir.join("b.svg"),
        drawn("<path class='hint' d='M20 10 L30 15'/>"),
    )
    .unwrap();
    let (mesh, said) = meshed(dir, "b.svg", &["--spacing", "10mm"]);
    assert!(
        (length(&mesh, EdgeAssignment::Boundary) / MM - 300.0).abs() < 1e-9,
        "{said}"
    );
    assert!(
        said.contains("left out  1 line") && said.contains("layer \"hint\""),
        "{said}"
    );
}

/// A panel of 100 by 50 with a tab of 80 by 20 on its crease, whose ends are the outline.
#[test]
fn an_outline_may_be_a_crease_in_part() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let drawing =
        svg("<path d='M0 50 V0 H100 V50 M10 50 V70 H90 V50'/><path stroke='blue' d='M0 50 H100'/>");
    fs::write(dir.join("a.svg"), drawing).unwrap();
    let (mesh, said) = meshed(dir, "a.svg", &["--spacing", "10mm"]);
    assert!((area(&mesh) / MM / MM - 6600.0).abs() < 1e-6, "{said}");
    assert!(
        (length(&mesh, EdgeAssignment::Valley) / MM - 80.0).abs() < 1e-9,
        "{said}"
    );
    assert!(
        (length(&mesh, EdgeAssignment::Boundary) / MM - 340.0).abs() < 1e-9,
        "{said}"
    );
    assert!(
        said.contains("2 lines of creases taken as the outline"),
        "{said}"
    );
    assert!(!said.contains("pieces"), "{said}");
}

#[test]
fn several_pieces_are_told() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::write(
        dir.join("a.svg"),
        svg("<path d='M0 0 H100 V50 H0 Z M0 60 H100 V70 H0 Z'/>"),
    )
    .unwrap();
    let (_, said) = meshed(dir, "a.svg", &["--spacing", "10mm"]);
    assert!(said.contains("note: the sheet is in 2 pieces"), "{said}");
}

/// The message of a drawing that makes no sheet names a tolerance with which it does, if there is one.
#[test]
fn a_tolerance_that_helps_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    // A corner that is overrun by 0.15 mm, as saw kerfs do, and one that is left open by as much.
    for drawing in [
        "<path d='M0 0.1 H100 V50 H0.1 V0'/>",
        "<path d='M0 0 H100 V50 H0 V0.15'/>",
    ] {
        fs::write(dir.join("a.svg"), svg(drawing)).unwrap();
        let said = refused(dir, "a.svg", &["--spacing", "10mm"], 3);
        let snap = said
            .split("`--snap ")
            .nth(1)
            .and_then(|rest| rest.split('`').next());
        let snap = snap.unwrap_or_else(|| panic!("{drawing}: {said}"));
        let (mesh, _) = meshed(dir, "a.svg", &["--spacing", "10mm", "--snap", snap]);
        assert!(
            (area(&mesh) / MM / MM - 5000.0).abs() < 30.0,
            "{snap}: {}",
            area(&mesh)
        );
    }
    // A gap that is no fault of digits has no such remedy.
    fs::write(dir.join("a.svg"), svg("<path d='M0 0 H100 V50 H0 V20'/>")).unwrap();
    let said = refused(dir, "a.svg", &["--spacing", "10mm"], 3);
    assert!(said.contains("a length of at least the gap"), "{said}");
}

/// Groups of a DXF file, as a number and a value.
fn groups(pairs: &[(i32, &str)]) -> String {
    pairs
        .iter()
        .map(|(code, value)| format!("{code}\n{value}\n"))
        .collect()
}

fn triangle(layer: &str) -> String {
    let corners = [("0", "0"), ("30", "0"), ("0", "10")];
    let lines = (0..3).map(|k| {
        let ((x, y), (u, v)) = (corners[k], corners[(k + 1) % 3]);
        groups(&[(0, "LINE"), (8, layer), (10, x), (20, y), (11, u), (21, v)])
    });
    lines.collect()
}

fn block(name: &str, base: [&str; 2], entities: &str) -> String {
    let head = groups(&[(0, "BLOCK"), (2, name), (10, base[0]), (20, base[1])]);
    head + entities + &groups(&[(0, "ENDBLK")])
}

fn insert(name: &str, layer: &str, more: &[(i32, &str)]) -> String {
    groups(&[(0, "INSERT"), (8, layer), (2, name)]) + &groups(more)
}

fn dxf(blocks: &[String], entities: &str) -> String {
    let section = |name: &str, body: &str| {
        groups(&[(0, "SECTION"), (2, name)]) + body + &groups(&[(0, "ENDSEC")])
    };
    let header = section("HEADER", &groups(&[(9, "$INSUNITS"), (70, "4")]));
    header
        + &section("BLOCKS", &blocks.concat())
        + &section("ENTITIES", entities)
        + &groups(&[(0, "EOF")])
}

/// A triangle of 30 by 10 mm that is inserted.
#[test]
fn blocks_are_inserted() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let made = |blocks: &[String], entities: &str| {
        fs::write(dir.join("a.dxf"), dxf(blocks, entities)).unwrap();
        meshed(dir, "a.dxf", &["--spacing", "20mm"])
    };
    let has = |mesh: &MeshFile, [x, y]: [f64; 2]| {
        let mut places = mesh.positions.as_chunks::<3>().0.iter();
        places.any(|p| (p[0] - x * MM).hypot(p[1] - y * MM) < 1e-9)
    };
    // The point (10, 0) comes to (100, 50), all is scaled by 2 and 3, then turned by 90 degrees.
    let part = [block("Part", ["10", "0"], &triangle("0"))];
    let placed = [(10, "100"), (20, "50"), (41, "2"), (42, "3"), (50, "90")];
    let (mesh, said) = made(&part, &insert("PART", "0", &placed));
    assert!((area(&mesh) / MM / MM - 900.0).abs() < 1e-6, "{said}");
    for corner in [[100.0, 30.0], [100.0, 110.0 - 20.0], [70.0, 30.0]] {
        assert!(has(&mesh, corner), "{corner:?} {:?}", mesh.positions);
    }
    // Mirrored by a factor, and as it is seen from below.
    let mirrored = [(10, "0"), (20, "0"), (41, "-1")];
    let (mesh, _) = made(&part, &insert("Part", "0", &mirrored));
    assert!(has(&mesh, [10.0, 0.0]) && has(&mesh, [-20.0, 0.0]) && has(&mesh, [10.0, 10.0]));
    let below = [(10, "5"), (20, "0"), (210, "0"), (220, "0"), (230, "-1")];
    let (mesh, _) = made(&part, &insert("Part", "0", &below));
    assert!(has(&mesh, [5.0, 0.0]) && has(&mesh, [-25.0, 0.0]) && has(&mesh, [5.0, 10.0]));
    // An array of 3 by 2 in a block that is inserted twice, larger.
    let rows = [
        (10, "0"),
        (20, "0"),
        (70, "3"),
        (71, "2"),
        (44, "40"),
        (45, "15"),
    ];
    let all = block("All", ["0", "0"], &insert("Part", "0", &rows));
    let two = insert("All", "0", &[(10, "0"), (20, "0")])
        + &insert("All", "0", &[(10, "0"), (20, "100"), (41, "2"), (42, "2")]);
    let (mesh, said) = made(&[&part[..], &[all]].concat(), &two);
    assert!(said.contains("in 12 pieces"), "{said}");
    assert!(
        (area(&mesh) / MM / MM - 6.0 * 150.0 * 5.0).abs() < 1e-6,
        "{said}"
    );
    assert!(has(&mesh, [200.0, 130.0]) && has(&mesh, [140.0, 150.0]));
    // What is on the layer 0 is on that of the insertion.
    let line = |x: &str| {
        groups(&[
            (0, "LINE"),
            (8, "0"),
            (10, x),
            (20, "0"),
            (11, "0"),
            (21, "10"),
        ])
    };
    let crease = block("Line", ["0", "0"], &line("10"));
    let entities = triangle("Cut") + &insert("Line", "Crease", &[(10, "0"), (20, "0")]);
    let (mesh, said) = made(&[crease], &entities);
    assert!((creased(&mesh) - 200.0_f64.sqrt()).abs() < 1e-9, "{said}");
    // A block that is not in the file is told.
    let entities = triangle("Cut") + &insert("Other", "0", &[(10, "0"), (20, "0")]);
    let (_, said) = made(&[], &entities);
    assert!(
        said.contains("left out: block that the file does not have (1)"),
        "{said}"
    );
}

/// Blocks that insert each other draw no more than is in proportion to the file.
#[test]
fn what_blocks_draw_is_bounded() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let refused = |blocks: &[String], entities: &str| {
        fs::write(dir.join("a.dxf"), dxf(blocks, entities)).unwrap();
        refused(dir, "a.dxf", &["--spacing", "20mm"], 3)
    };
    let too_much = "the blocks that are inserted of the file would take more than";
    let at = [(10, "0"), (20, "0")];
    let ten =
        |name: &str, inner: &str| block(name, ["0", "0"], &insert(inner, "0", &at).repeat(10));
    let names = ["a", "b", "c", "d", "e", "f", "g", "h", "i"];
    let mut blocks = vec![block("a", ["0", "0"], &triangle("0"))];
    blocks.extend(names.windows(2).map(|pair| ten(pair[1], pair[0])));
    let said = refused(&blocks, &insert("i", "0", &at));
    assert!(said.contains(too_much), "{said}");
    let many = [(10, "0"), (20, "0"), (70, "30000"), (71, "30000")];
    let said = refused(&[block("a", ["0", "0"], "")], &insert("a", "0", &many));
    assert!(said.contains(too_much), "{said}");
    // A line of 3 000 corners is one entity, and not one line.
    let corners: String = (0..3000)
        .map(|k| groups(&[(10, &k.to_string()), (20, "0")]))
        .collect();
    let long = groups(&[(0, "LWPOLYLINE"), (8, "0"), (90, "3000")]) + &corners;
    let many = [(10, "0"), (20, "0"), (70, "100"), (71, "100"), (45, "9")];
    let said = refused(&[block("a", ["0", "0"], &long)], &insert("a", "0", &many));
    assert!(said.contains(too_much), "{said}");
    // A short file may have many parts.
    let parts = [
        (10, "0"),
        (20, "0"),
        (70, "45"),
        (71, "45"),
        (44, "40"),
        (45, "15"),
    ];
    let text = dxf(
        &[block("a", ["0", "0"], &triangle("0"))],
        &insert("a", "0", &parts),
    );
    fs::write(dir.join("a.dxf"), text).unwrap();
    let (_, said) = meshed(dir, "a.dxf", &["--spacing", "50mm"]);
    assert!(said.contains("in 2025 pieces"), "{said}");
    let said = refused(
        &[block("a", ["0", "0"], &insert("a", "0", &at))],
        &insert("a", "0", &at),
    );
    assert!(said.contains("in each other more than 200 deep"), "{said}");
}
