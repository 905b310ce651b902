//! Drawings of crease patterns: what they become, and what is refused.

use crate::mesh_file::{EdgeAssignment, FileCrease};
use crate::{MeshFile, MeshFileError, MeshFormat, MeshOptions, parse_mesh};
use isosheet_mesh::generate::FoldAssignment;
use std::f64::consts::PI;
use std::path::Path;

fn read(format: MeshFormat, text: &str) -> Result<MeshFile, MeshFileError> {
    parse_mesh(
        text.as_bytes(),
        format,
        Path::new("drawing"),
        &MeshOptions::default(),
    )
}

fn refusal(format: MeshFormat, text: &str) -> String {
    read(format, text).unwrap_err().to_string()
}

/// A unit square with a diagonal from the lower left, as CP: y points downwards there.
const SQUARE: &str = "1 0 0 1 0\n1 1 0 1 -1\n1 1 -1 0 -1\n1 0 -1 0 0\n3 0 0 1 -1\n";

fn creases(mesh: &MeshFile, assignment: EdgeAssignment) -> Vec<[[f64; 2]; 2]> {
    let place = |v: u32| [0, 1].map(|k| mesh.positions[3 * v as usize + k]);
    let found = mesh.creases.iter().filter(|c| c.assignment == assignment);
    found.map(|c| c.ends.map(place)).collect()
}

fn area(mesh: &MeshFile) -> f64 {
    mesh.clone().into_sheet().unwrap().area()
}

#[test]
fn a_square_with_a_diagonal_is_the_same_in_all_formats() {
    let cp = read(MeshFormat::Cp, SQUARE).unwrap();
    assert_eq!((cp.vertex_count(), cp.faces.len()), (4, 2));
    assert_eq!(
        creases(&cp, EdgeAssignment::Valley),
        [[[0.0, 0.0], [1.0, 1.0]]]
    );
    assert_eq!(area(&cp), 1.0);

    let line = |kind: u8, [x0, y0, x1, y1]: [i8; 4]| {
        // Java leaves out what is zero.
        let number = |name: &str, value: i8| match value {
            0 => String::new(),
            _ => format!("<void property=\"{name}\"><double>{value}.0</double></void>"),
        };
        format!(
            "<void index=\"0\"><object class=\"oripa.OriLineProxy\"><void property=\"type\"><int>{kind}</int></void>\
             {}{}{}{}</object></void>",
            number("x0", x0),
            number("x1", x1),
            number("y0", y0),
            number("y1", y1)
        )
    };
    let sides = [[0, 0, 1, 0], [1, 0, 1, -1], [1, -1, 0, -1], [0, -1, 0, 0]];
    let lines: String = sides.into_iter().map(|l| line(1, l)).collect();
    let opx = format!(
        "<?xml version=\"1.0\"?><java><object class=\"oripa.DataSet\">{lines}{}</object></java>",
        line(3, [0, 0, 1, -1])
    );
    let opx = read(MeshFormat::Opx, &opx).unwrap();
    assert_eq!((&opx.positions, &opx.faces), (&cp.positions, &cp.faces));
    assert_eq!(opx.creases, cp.creases);
}

/// The lower side of the square is open by a fifth, and a crease cuts off the corner there: what is left is a
/// sheet that nobody has drawn.
#[test]
fn an_open_outline_is_told_with_its_place() {
    let open = "1 0 0 0.4 0\n1 0.6 0 1 0\n1 1 0 1 -1\n1 1 -1 0 -1\n1 0 -1 0 0\n3 0 0 1 -1\n";
    let said = refusal(MeshFormat::Cp, open);
    assert!(
        said.contains("the outline is not closed: 2 ends of its lines lead nowhere"),
        "{said}"
    );
    assert!(
        said.contains("(0.4, 0), 0.2 from the next") || said.contains("(0.6, 0), 0.2"),
        "{said}"
    );
    // Without the crease nothing is enclosed, for the same reason.
    let said = refusal(MeshFormat::Cp, &open.replace("3 0 0 1 -1\n", ""));
    assert!(said.contains("0.2 from the next"), "{said}");
    let fold = r#"{"vertices_coords": [[0, 0], [0.4, 0], [0.6, 0], [1, 0], [1, 1], [0, 1]],
        "edges_vertices": [[0, 1], [2, 3], [3, 4], [4, 5], [5, 0], [0, 4]],
        "edges_assignment": ["B", "B", "B", "B", "B", "V"]}"#;
    let said = refusal(MeshFormat::Fold, fold);
    assert!(said.contains("the outline is not closed"), "{said}");
    let svg = |path: &str| {
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' viewBox='0 0 100 100'>\
             <path d='{path}' stroke='black' fill='none'/><path d='M0 0 L100 100' stroke='blue'/></svg>"
        )
    };
    let said = refusal(MeshFormat::Svg, &svg("M60 100 H100 V0 H0 V100 H40"));
    assert!(said.contains("20 mm from the next (T = 0.022)"), "{said}");
    // The tolerance closes it.
    let closed = parse_mesh(
        svg("M60 100 H100 V0 H0 V100 H40").as_bytes(),
        MeshFormat::Svg,
        Path::new("drawing"),
        &MeshOptions {
            weld: Some(0.021),
            ..MeshOptions::default()
        },
    );
    assert!((area(&closed.unwrap()) - 0.01).abs() < 2e-4);
    // A slit within the sheet opens no outline, and is counted.
    let slit = read(MeshFormat::Cp, &format!("{SQUARE}1 0.6 -0.2 0.8 -0.2\n")).unwrap();
    assert_eq!((slit.changes.loose_lines, slit.changes.loose_cuts), (1, 1));
    assert_eq!(area(&slit), 1.0);
}

/// Illustrator writes the data that it edits before the drawing, in a switch.
#[test]
fn of_a_switch_what_needs_no_extension_is_read() {
    let head = "<svg xmlns='http://www.w3.org/2000/svg'>";
    let path = "<path d='M0 0 H9 V9 Z' stroke='black' fill='none'/>";
    let own = "<foreignObject requiredExtensions='x'/>";
    let plain = read(MeshFormat::Svg, &format!("{head}{path}</svg>")).unwrap();
    let text = format!("{head}<switch>{own}<g>{path}</g></switch></svg>");
    let switched = read(MeshFormat::Svg, &text).unwrap();
    assert_eq!(switched.positions, plain.positions);
}

/// A line of the outline that is drawn too far encloses nothing, as does a stray one: they are left out, as
/// creases are that lead nowhere.
#[test]
fn lines_of_the_outline_that_are_drawn_too_far_are_left_out() {
    let far = SQUARE.replace("1 0 0 1 0", "1 -0.3 0 1.5 0");
    let mesh = read(MeshFormat::Cp, &far).unwrap();
    assert_eq!((area(&mesh), mesh.faces.len()), (1.0, 2));
    assert_eq!(
        (mesh.changes.loose_lines, mesh.changes.loose_cuts),
        (2, 0),
        "none of them is inside the sheet"
    );
    let stray = read(MeshFormat::Cp, &format!("{SQUARE}1 2 0 2 1\n")).unwrap();
    assert_eq!((area(&stray), stray.changes.loose_lines), (1.0, 1));
    // A second sheet with a gap is no stray line.
    let second = format!("{SQUARE}1 2 0 3 0\n1 3 0 3 1\n1 3 1 2 1\n");
    let said = refusal(MeshFormat::Cp, &second);
    assert!(said.contains("the outline is not closed: 2 ends"), "{said}");
}

/// A mountain on a valley is a crease to either side, as for `isosheet mesh`, whatever the order of the
/// lines.
#[test]
fn creases_that_contradict_each_other_fold_freely() {
    let square = SQUARE.lines().take(4).collect::<Vec<_>>().join("\n");
    let [mountain, valley] = ["2 0 0 1 -1", "3 1 -1 0 0"];
    for lines in [vec![mountain, valley], vec![valley, mountain, mountain]] {
        let text = format!("{square}\n{}\n", lines.join("\n"));
        let mesh = read(MeshFormat::Cp, &text).unwrap();
        assert_eq!(mesh.changes.contradicting_lines, 1);
        let free = creases(&mesh, EdgeAssignment::Unassigned);
        assert_eq!(free.len(), 1, "{:?}", mesh.creases);
        let crease = mesh.creases.iter().find(|c| c.angle.is_some());
        assert_eq!(crease, None);
        assert!(mesh.changes.to_string().contains("1 edge folds freely"));
    }
    // A cut on both is a cut.
    let text = format!("{square}\n{mountain}\n{valley}\n1 0 0 1 -1\n");
    let mesh = read(MeshFormat::Cp, &text).unwrap();
    assert_eq!(
        (mesh.changes.contradicting_lines, mesh.vertex_count()),
        (0, 6)
    );
}

/// A valley leaves a mountain a thousandth of the drawing from where both begin: their ends meet, as nothing
/// contradicts itself then.
#[test]
fn ends_meet_where_creases_would_contradict_each_other_otherwise() {
    let square = SQUARE.lines().take(4).collect::<Vec<_>>().join("\n");
    let hook = "3 0 0 0.0006 -0.0006\n3 0.0006 -0.0006 0.5 -1\n";
    let mesh = read(MeshFormat::Cp, &format!("{square}\n2 0 0 1 -1\n{hook}")).unwrap();
    assert_eq!(
        (mesh.changes.contradicting_lines, mesh.vertex_count()),
        (0, 5)
    );
    assert_eq!(creases(&mesh, EdgeAssignment::Mountain).len(), 1);
    assert_eq!(creases(&mesh, EdgeAssignment::Valley).len(), 1);
}

#[test]
fn lines_of_other_colours_are_counted() {
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 1 1' fill='none'><rect width='1' height='1' stroke='black'/>\
               <path d='M0 0 L1 1' stroke='blue'/><path d='M0 1 L1 0' stroke='#00ffff'/><text>a</text></svg>";
    let mesh = read(MeshFormat::Svg, svg).unwrap();
    assert_eq!(
        mesh.what_reading_did().unwrap(),
        "1 line left out, of colours that mean nothing in a crease pattern, left out: text (1)"
    );
}

/// The mesh of a unit square with some more elements.
fn of_square(more: &str) -> MeshFile {
    let square = "<rect width='1' height='1' stroke='black' fill='none'/>";
    let head = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 1 1'>";
    read(MeshFormat::Svg, &format!("{head}{square}{more}</svg>")).unwrap()
}

/// The opacities of a line, of its colour and of its groups are multiplied.
#[test]
fn a_colour_that_lets_light_through_folds_by_a_part() {
    for (style, part) in [
        ("stroke='red'", 1.0),
        ("stroke='red' stroke-opacity='0.5'", 0.5),
        ("stroke='red' opacity='50%'", 0.5),
        ("stroke='rgba(255,0,0,0.5)'", 0.5),
        ("stroke='#ff000080'", 128.0 / 255.0),
        ("stroke='hsla(0,100%,50%,.5)'", 0.5),
        ("stroke='rgb(255 0 0 / 0.5)'", 0.5),
        ("style='stroke: rgb(255 0 0 / 50%)'", 0.5),
        (
            "stroke='rgb(255 0 0 / 50%)' stroke-opacity='0.5' opacity='0.5'",
            0.125,
        ),
        ("color='rgb(255 0 0 / 50%)' stroke='currentColor'", 0.5),
        ("stroke='red' fill-opacity='0.5'", 1.0),
    ] {
        let mesh = of_square(&format!("<path d='M0 0 L1 1' fill='none' {style}/>"));
        let folds = mesh.creases.iter();
        let folds: Vec<&FileCrease> = folds
            .filter(|crease| crease.assignment == EdgeAssignment::Mountain)
            .collect();
        assert_eq!(folds.len(), 1, "{style}");
        let angle = folds[0].angle.unwrap();
        assert!((angle + part * PI).abs() < 1e-12, "{style}: {angle}");
        assert_eq!(mesh.what_reading_did(), None, "{style}");
    }
}

/// What is filled and has no stroke, as shapes of SVG are that say nothing, is no line of a pattern.
#[test]
fn shapes_without_a_stroke_are_no_lines() {
    let crease = "<path d='M0 0 L1 1' fill='none' stroke='blue'/>";
    let folded = of_square(crease);
    let printed = [
        "<path d='M0.25 0V1'/>",
        "<rect width='1' height='1'/>",
        "<rect width='1' height='1' fill='white'/>",
        "<path d='M0.1 0.7 L0.3 0.7 L0.2 0.9 Z' fill='red'/>",
        "<circle cx='0.5' cy='0.5' r='0.2' stroke='none' fill='#0000ff80'/>",
        "<line x1='0' y1='0.5' x2='1' y2='0.5'/>",
        "<path d='M0.25 0V1' fill='none'/>",
    ];
    for shape in printed {
        for with in [format!("{shape}{crease}"), format!("{crease}{shape}")] {
            let mesh = of_square(&with);
            assert_eq!(
                (&mesh.positions, &mesh.faces, &mesh.creases),
                (&folded.positions, &folded.faces, &folded.creases),
                "{shape}"
            );
            let told = mesh.what_reading_did().unwrap();
            assert_eq!(told, "left out: shape without a stroke (1)", "{shape}");
        }
    }
    let told = of_square(&printed.concat()).what_reading_did().unwrap();
    let count = printed.len();
    assert_eq!(told, format!("left out: shape without a stroke ({count})"));
}

#[test]
fn colours_that_are_not_understood_are_named() {
    for colour in ["rebeccapurple", "color(srgb 1 0 0)"] {
        let crease = format!("<path d='M0 0 L1 1' fill='none' stroke='{colour}'/>");
        let mesh = of_square(&crease);
        assert_eq!(
            mesh.what_reading_did().unwrap(),
            format!("left out: shape of the colour {colour:?}, which is not understood (1)")
        );
    }
}

#[test]
fn texts_may_begin_with_the_mark_of_their_order() {
    let fold = r#"{"vertices_coords": [[0, 0], [1, 0], [0, 1]], "faces_vertices": [[0, 1, 2]]}"#;
    let svg =
        "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0 H9 V9 Z' stroke='black'/></svg>";
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    for (format, text) in [
        (MeshFormat::Cp, SQUARE),
        (MeshFormat::Fold, fold),
        (MeshFormat::Svg, svg),
        (MeshFormat::Obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        (
            MeshFormat::Off,
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        ),
        (MeshFormat::Stl, stl),
        (MeshFormat::Ply, ply),
    ] {
        let plain = read(format, text).unwrap();
        let marked = read(format, &format!("\u{feff}{text}"));
        assert_eq!(marked.unwrap(), plain, "{format:?}");
    }
}

#[test]
fn inner_edges_of_the_boundary_are_told() {
    let fold = r#"{"vertices_coords": [[0, 0], [1, 0], [1, 1], [0, 1]], "faces_vertices": [[0, 1, 2], [0, 2, 3]],
        "edges_vertices": [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]], "edges_assignment": ["B", "B", "B", "B", "B"]}"#;
    let mesh = read(MeshFormat::Fold, fold).unwrap();
    assert_eq!(mesh.changes.inner_boundaries, 1);
    assert_eq!(mesh.vertex_count(), 4);
}

#[test]
fn lines_are_divided_where_they_cross_and_united_where_they_coincide() {
    // A waterbomb: both diagonals and a middle line in one piece each, and the diagonal twice.
    let base =
        "1 0 0 2 0\n1 2 0 2 2\n1 2 2 0 2\n1 0 2 0 0\n3 0 0 2 2\n3 2 2 0 0\n3 0 2 2 0\n2 0 1 2 1\n";
    let mesh = read(MeshFormat::Cp, base).unwrap();
    assert_eq!((mesh.vertex_count(), mesh.faces.len()), (7, 6));
    assert_eq!(creases(&mesh, EdgeAssignment::Valley).len(), 4);
    assert_eq!(creases(&mesh, EdgeAssignment::Mountain).len(), 2);
    assert_eq!(creases(&mesh, EdgeAssignment::Boundary).len(), 6);
    assert_eq!(mesh.changes.double_lines, 2, "both halves of the diagonal");
    assert_eq!(area(&mesh), 4.0);

    // Ends that miss each other by a thousandth of a millimetre of a sheet of 200 mm meet.
    let near = SQUARE.replace("3 0 0 1 -1", "3 1e-5 0 1 -0.99999");
    let mesh = read(MeshFormat::Cp, &near).unwrap();
    assert_eq!((mesh.vertex_count(), mesh.faces.len()), (4, 2));

    // A line that leads nowhere is no crease.
    let loose = format!("{SQUARE}2 0 0 0.5 -0.2\n");
    let mesh = read(MeshFormat::Cp, &loose).unwrap();
    assert_eq!((mesh.changes.loose_lines, mesh.vertex_count()), (1, 4));
    let told = mesh.what_reading_did().unwrap();
    assert!(
        told.contains("1 line that leads nowhere left out"),
        "{told}"
    );
}

#[test]
fn what_is_no_pattern_is_refused_with_a_remedy() {
    let cp = |text: &str| refusal(MeshFormat::Cp, text);
    let open = SQUARE.lines().take(3).collect::<Vec<_>>().join("\n");
    assert!(
        cp(&open).contains("the outline is not closed: 2 ends"),
        "{}",
        cp(&open)
    );
    let crossing = "2 0 0 1 1\n3 0 1 1 0\n";
    assert!(cp(crossing).contains("the outline of the sheet is missing"));
    assert!(cp("# nothing\n").contains("the drawing has no lines"));
    assert!(cp("a poem\n").contains("line 1: \"a poem\" is no line of a crease pattern"));
    assert!(cp("7 0 0 1 1\n").contains("is no line of a crease pattern"));
    assert!(cp("1 0 0 nan 1\n").contains("is no line of a crease pattern"));
    let inner = format!("{SQUARE}1 0.6 -0.2 0.8 -0.2\n1 0.8 -0.2 0.8 -0.4\n1 0.8 -0.4 0.6 -0.2\n");
    assert!(
        cp(&inner).contains("inside of another one"),
        "{}",
        cp(&inner)
    );
    let opx = |text: &str| refusal(MeshFormat::Opx, text);
    assert!(opx("a poem").contains("not valid XML"));
    assert!(opx("<java/>").contains("the drawing has no lines"));
}

/// Drawings are read in metres.
const PIXEL: f64 = 0.0254 / 96.0;

#[test]
fn colours_and_opacity_of_svg_drawings_are_assignments_and_angles() {
    let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100">
        <style>.m { stroke: red }</style>
        <g transform="translate(10 10)">
        <rect width="80" height="80" fill="none" stroke="#000"/>
        <line class="m" x1="0" y1="40" x2="80" y2="40" opacity="0.5"/>
        <path d="M 40 0 V 80" style="fill:none;stroke:rgb(0,0,255);stroke-opacity:0.25"/>
        <polyline points="0,0 40,40" fill="none" stroke="yellow"/>
        <line x1="80" y1="80" x2="40" y2="40" stroke="magenta"/>
        <line x1="0" y1="10" x2="80" y2="20" stroke="#888"/>
        </g></svg>"##;
    let mesh = read(MeshFormat::Svg, svg).unwrap();
    assert!((area(&mesh) / (PIXEL * PIXEL) - 6400.0).abs() < 1e-2);
    let angles = |assignment: EdgeAssignment| -> Vec<Option<f64>> {
        let found = mesh.creases.iter().filter(|c| c.assignment == assignment);
        found.map(|c| c.angle).collect()
    };
    let near = |found: Vec<Option<f64>>, expected: f64| {
        assert_eq!(found.len(), 2, "the lines cross: {found:?}");
        assert!(
            found.iter().all(|a| (a.unwrap() - expected).abs() < 1e-6),
            "{found:?}"
        );
    };
    near(angles(EdgeAssignment::Mountain), -0.5 * PI);
    near(angles(EdgeAssignment::Valley), 0.25 * PI);
    assert_eq!(angles(EdgeAssignment::Unassigned).len(), 1);
    // The yellow line, and the diagonals of the two quads that are left.
    assert_eq!(angles(EdgeAssignment::Flat).len(), 3);
    // As seen on the screen: the first line is in the upper left.
    let [flat, ..] = creases(&mesh, EdgeAssignment::Flat)[..] else {
        panic!("no flat edge");
    };
    let middle = [0, 1].map(|k| 0.5 * (flat[0][k] + flat[1][k]));
    assert!(
        middle[0] < 50.0 * PIXEL && middle[1] > 50.0 * PIXEL,
        "{middle:?}"
    );
    assert!(refusal(MeshFormat::Svg, "a poem").contains("not valid XML"));
}

#[test]
fn curves_of_svg_drawings_become_lines_near_them() {
    let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100">
        <circle cx="50" cy="50" r="50" fill="none" stroke="black"/></svg>"#;
    let mesh = read(MeshFormat::Svg, svg).unwrap();
    let share = area(&mesh) / (PI * 2500.0 * PIXEL * PIXEL);
    assert!((0.99..1.0).contains(&share), "{share}");
}

/// A line of the kind of the outline with the sheet on both of its sides is a cut.
#[test]
fn outlines_inside_the_sheet_are_cuts() {
    let square = "1 0 0 2 0\n1 2 0 2 2\n1 2 2 0 2\n1 0 2 0 0\n";
    let vertices = |text: &str| read(MeshFormat::Cp, text).unwrap().positions.len() / 3;
    let whole = vertices(&format!("{square}3 0 1 2 1\n"));
    let cut = vertices(&format!("{square}1 0 1 2 1\n"));
    assert_eq!([whole, cut], [6, 8]);
}

/// Each line of this square has vertices of its own, as programs write them that do not join lines: those at
/// one place are one vertex, within round-off or where faces would touch themselves otherwise.
#[test]
fn vertices_at_one_place_of_patterns_without_faces_are_one() {
    let square = |off: f64, more: &str| {
        format!(
            r#"{{"vertices_coords": [[0,0],[1,0], [1,0],[1,1], [1,1],[0,1], [0,1],[0,0], [{off},{off}],[1,1]]{more},
            "edges_vertices": [[0,1],[2,3],[4,5],[6,7],[8,9]], "edges_assignment": ["B","B","B","B","V"]}}"#
        )
    };
    for off in [0.0, 1e-15, 4e-4, 3e-3] {
        let mesh = read(MeshFormat::Fold, &square(off, "")).unwrap();
        assert_eq!(mesh.changes.welded_vertices, 6, "{off}");
        assert_eq!((mesh.vertex_count(), mesh.faces.len()), (4, 2), "{off}");
        let sheet = mesh.clone().into_sheet().unwrap();
        assert!((sheet.area() - 1.0).abs() < 1e-12, "{off}");
        let assignments = mesh.fold_assignments(sheet.topology()).unwrap();
        let valleys = assignments
            .iter()
            .filter(|a| **a == Some(FoldAssignment::Valley));
        assert_eq!(valleys.count(), 1, "{off}");
    }
    // What ends inside leads nowhere, and no line is moved for it.
    let mesh = read(MeshFormat::Fold, &square(0.1, "")).unwrap();
    let changes = mesh.changes;
    assert_eq!((changes.loose_lines, changes.welded_vertices), (1, 5));
    // The tolerance that is asked for counts.
    let welded = |text: &str, weld| {
        let options = MeshOptions {
            weld: Some(weld),
            ..MeshOptions::default()
        };
        parse_mesh(
            text.as_bytes(),
            MeshFormat::Fold,
            Path::new("x.fold"),
            &options,
        )
    };
    assert_eq!(welded(&square(0.1, ""), 0.15).unwrap().faces.len(), 2);
    // An edge between two vertices at one place is none.
    let point = r#"{"vertices_coords": [[0,0],[1,0],[1,1],[0,1],[0,0]],
        "edges_vertices": [[0,1],[1,2],[2,3],[3,0],[0,4]]}"#;
    let mesh = read(MeshFormat::Fold, point).unwrap();
    assert_eq!((mesh.changes.welded_vertices, mesh.faces.len()), (1, 2));
    // Faces that fit and folded forms keep different vertices, as a slit does.
    let slit = r#"{"vertices_coords": [[0,0],[1,0],[1,1],[0,1],[1,1]], "faces_vertices": [[0,1,2],[0,4,3]],
        "edges_vertices": [[0,1],[1,2],[0,2],[4,3],[3,0],[0,4]], "edges_assignment": ["B","B","B","B","B","B"]}"#;
    let slit = read(MeshFormat::Fold, slit).unwrap();
    assert_eq!((slit.vertex_count(), slit.changes.welded_vertices), (5, 0));
    let folded = square(0.0, r#", "frame_classes": ["foldedForm"]"#);
    assert!(read(MeshFormat::Fold, &folded).is_err());
}

/// A grid of 400 lines each way crosses more often than what is allowed of so many lines, and that is told at
/// once.
#[test]
fn lines_that_meet_too_often_are_refused() {
    let grid = |count: u32| {
        let lines = (1..count).map(|k| format!("2 0 {k} {count} {k}\n3 {k} 0 {k} {count}\n"));
        let frame = format!(
            "1 0 0 {count} 0\n1 {count} 0 {count} {count}\n1 {count} {count} 0 {count}\n1 0 {count} 0 0\n"
        );
        frame + &lines.collect::<String>()
    };
    let message = refusal(MeshFormat::Cp, &grid(400));
    let limit = (1 << 17) + 8 * (4 + 2 * 399);
    let expected = format!("the lines of the drawing meet more than {limit} times");
    assert!(message.contains(&expected), "{message}");
    let mesh = read(MeshFormat::Cp, &grid(40)).unwrap();
    assert_eq!(mesh.faces.len(), 2 * 40 * 40);
}

/// What small files made of XML may become is bounded by the length of the file: its elements that are used,
/// the curves of them and the styles that are compared.
#[test]
fn svg_drawings_are_in_proportion_to_their_file() {
    let file = |inside: &str| {
        format!("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'>{inside}</svg>")
    };
    let entity = "M0 0L1 1 ".repeat(300);
    let entities = format!(
        "<!DOCTYPE svg [<!ENTITY a '{entity}'>]>{}",
        file(&format!("<path stroke='black' d='{}'/>", "&a;".repeat(800)))
    );
    let path = format!(
        "<path id='p' stroke='black' d='M0 0{}'/>",
        "h1".repeat(10_000)
    );
    let used = file(&(path + &"<use href='#p'/>".repeat(1000)));
    // Nine groups, each of which uses the one before ten times.
    let group = |k: u32| {
        let uses = format!("<use href='#g{}'/>", k - 1).repeat(10);
        format!("<g id='g{k}'>{uses}</g>")
    };
    let groups: String = (1..10).map(group).collect();
    let groups = file(&format!("<path id='g0'/>{groups}"));
    for (text, says) in [
        (
            entities,
            "its entities would become a text of 2160000 bytes",
        ),
        (used, "and a file of this length may have no more"),
        (groups, "the elements of the file would take more than"),
    ] {
        let message = refusal(MeshFormat::Svg, &text);
        assert!(message.contains(says), "{message}");
    }
}

/// Each line has a name of its own, as drawing programs give it.
#[test]
fn lines_of_many_names_are_read() {
    let line = |k: u32| format!("<path id='p{k}' stroke='red' d='M0 {k}H9000'/>");
    let lines: String = (1..9000).map(line).collect();
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9000 9000'>\
         <rect width='9000' height='9000' stroke='black'/>{lines}</svg>"
    );
    let options = MeshOptions {
        weld: Some(0.1 * PIXEL),
        ..MeshOptions::default()
    };
    let mesh = parse_mesh(
        svg.as_bytes(),
        MeshFormat::Svg,
        Path::new("x.svg"),
        &options,
    )
    .unwrap();
    assert_eq!(mesh.faces.len(), 2 * 9000);
    assert_eq!(mesh.drawn.pens().len(), 9000);
}
