//! Drawings that fold: trays, pop-up cards, cuts that open.

use isosheet_dynamics::State;
use isosheet_scenes::{SceneFile, Setup};
use std::fs;
use std::path::Path;

/// A drawing in millimetres whose lower left corner is the origin.
fn svg(shapes: &str) -> String {
    format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='140mm' height='100mm' viewBox='0 0 140 100' fill='none' \
         stroke='black'>{shapes}</svg>"
    )
}

fn setup(folder: &Path, shapes: &str, spacing: f64, rest: &str) -> Setup {
    fs::write(folder.join("sheet.svg"), svg(shapes)).unwrap();
    let text = format!(
        "version = 1\n[sheet]\nmesh = {{ drawing = {{ path = \"sheet.svg\", spacing = {spacing} }} }}\n{rest}"
    );
    let scene = SceneFile::parse(text, &folder.join("scene.toml"), &[]);
    let scene = scene.unwrap_or_else(|e| panic!("{e}"));
    scene.build().unwrap_or_else(|e| panic!("{e}"))
}

/// Where the vertices end that begin at a place of the drawing, millimetres, y upwards.
struct Ends {
    start: Vec<[f64; 3]>,
    end: Vec<[f64; 3]>,
}

impl Ends {
    fn of(setup: Setup, seconds: f64) -> Self {
        let mut simulation = setup.start().unwrap();
        let points = |state: &State| state.vertex_positions().to_vec();
        let start = points(simulation.state());
        let step = 1.0 / 60.0;
        for _ in 0..(seconds / step).round() as usize {
            simulation.step(step).unwrap();
        }
        Self {
            start,
            end: points(simulation.state()),
        }
    }

    fn all_at(&self, x: f64, y: f64) -> Vec<[f64; 3]> {
        let near = |p: &[f64; 3]| (1e3 * p[0] - x).hypot(1e3 * p[1] - y) < 1e-6;
        let found = self.start.iter().zip(&self.end).filter(|(p, _)| near(p));
        found.map(|(_, q)| *q).collect()
    }

    fn at(&self, x: f64, y: f64) -> [f64; 3] {
        let found = self.all_at(x, y);
        assert!(!found.is_empty(), "no vertex at ({x}, {y})");
        found[0]
    }
}

/// Millimetres.
fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    1e3 * (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

const FOLDED: &str = "density = 0.3
damping = 20.0
[[crease]]
at = { pattern = \"assigned\" }
stiffness = 0.05
angle = { ramp = { to = 90, end = 1 } }
[[crease]]
at = { pattern = \"flat\" }
stiffness = 2.0
";

/// The walls of a tray stand upright, and those next to each other meet at their upper corners.
#[test]
fn a_tray_folds_to_a_box() {
    let dir = tempfile::tempdir().unwrap();
    let shapes = "<path d='M20 0 H120 V20 H140 V80 H120 V100 H20 V80 H0 V20 H20 Z'/>\
                  <rect stroke='blue' x='20' y='20' width='100' height='60'/>";
    let ends = Ends::of(setup(dir.path(), shapes, 0.02, FOLDED), 3.0);
    let corners = [[20.0, 20.0], [120.0, 20.0], [120.0, 80.0], [20.0, 80.0]];
    let out = [[-20.0, -20.0], [20.0, -20.0], [20.0, 20.0], [-20.0, 20.0]];
    let mut tops = Vec::new();
    for ([x, y], [dx, dy]) in corners.into_iter().zip(out) {
        let (one, other) = (ends.at(x + dx, y), ends.at(x, y + dy));
        assert!(distance(one, other) < 0.2, "{}", distance(one, other));
        assert!((distance(one, ends.at(x, y)) - 20.0).abs() < 1e-6);
        tops.push(one);
    }
    assert!((distance(tops[0], tops[2]) - 100_f64.hypot(60.0)).abs() < 0.3);
    assert!((distance(tops[1], tops[3]) - 100_f64.hypot(60.0)).abs() < 0.3);
}

/// A strip between two slits stands out of a card that is opened by a right angle: its ridge is as far from
/// the fold as the diagonal of the square that it bounds.
#[test]
fn a_card_pops_up() {
    let dir = tempfile::tempdir().unwrap();
    let shapes = "<rect x='10' y='10' width='100' height='60'/>\
                  <path d='M40 30 H80 M40 50 H80'/>\
                  <path stroke='blue' d='M60 10 V30 M60 50 V70 M40 30 V50 M80 30 V50'/>\
                  <path stroke='red' d='M60 30 V50'/>";
    let ends = Ends::of(setup(dir.path(), shapes, 0.02, FOLDED), 3.0);
    // Above the slit at the height 70 of the page.
    let at_slit = ends.all_at(60.0, 70.0);
    assert_eq!(at_slit.len(), 2, "the slit has two sides");
    assert!((distance(at_slit[0], at_slit[1]) - 800_f64.sqrt()).abs() < 0.3);
    assert!((distance(ends.at(10.0, 90.0), ends.at(110.0, 90.0)) - 5000_f64.sqrt()).abs() < 0.5);
}

/// A slit is closed at the start, and opens where its flap hangs down.
#[test]
fn a_slit_opens() {
    let dir = tempfile::tempdir().unwrap();
    let shapes = "<rect x='10' y='10' width='100' height='60'/><path d='M40 20 H80 V60 H40'/>";
    let rest = "material = \"office paper\"
        [forces]
        gravity = [0, 0, -98.1]
        [[support]]
        at = { box = { min = [-1, -1, -1], max = [0.0201, 1, 1] } }
        hold = \"clamp\"
        [[support]]
        at = { box = { min = [0.0999, -1, -1], max = [1, 1, 1] } }
        hold = \"clamp\"
        ";
    let setup = setup(dir.path(), shapes, 0.008, rest);
    let ends = Ends::of(setup, 0.3);
    let at_corner = ends.all_at(80.0, 80.0);
    assert_eq!(at_corner.len(), 2);
    assert!(distance(at_corner[0], at_corner[1]) > 1.0);
}

/// A card with lines of three kinds; the red one is crossed by a slit, where the mesh has vertices twice.
const CARD: &str = "<path d='M0 0 H140 V100 H0 Z'/><g id='Score'><path stroke='blue' d='M40 0 V100'/></g>\
                    <path stroke='#cc0011' d='M90 0 V100'/><path d='M60 50 H120'/>\
                    <path stroke='magenta' stroke-dasharray='2 1' d='M20 0 V100'/>";

/// The length of the driven creases of a scene, millimetres, and the places of their ends along x.
fn driven(setup: &Setup) -> (f64, Vec<f64>) {
    let sheet = &setup.sheet;
    let creases = setup.targets.creases.iter().flat_map(|c| &c.edges);
    let edges: Vec<_> = creases.map(|(edge, _)| *edge).collect();
    let length = edges.iter().map(|e| 1e3 * sheet.lengths()[e.index()]);
    let ends = edges
        .iter()
        .flat_map(|e| sheet.topology().edges()[e.index()]);
    let mut places: Vec<f64> = ends
        .map(|v| (1e6 * sheet.position(v)[0]).round() / 1e3)
        .collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    (length.sum(), places)
}

/// A crease of a scene with its edges as given.
fn crease_at(at: &str) -> String {
    format!("[[crease]]\nat = {at}\nstiffness = 0.01\nangle = {{ ramp = {{ to = 90, end = 1 }} }}")
}

#[test]
fn creases_follow_lines_by_layer_colour_and_dashes() {
    let dir = tempfile::tempdir().unwrap();
    for (lines, length, places) in [
        ("\"layer:score\"", 100.0, vec![40.0]),
        ("\"red\"", 100.0, vec![90.0]),
        ("\"#cc0011\", \"blue\"", 200.0, vec![40.0, 90.0]),
        ("\"dashed\"", 100.0, vec![20.0]),
        // The outline and the slit are no creases.
        ("\"solid\"", 200.0, vec![40.0, 90.0]),
    ] {
        let at = crease_at(&format!("{{ drawn = [{lines}] }}"));
        let found = driven(&setup(dir.path(), CARD, 0.01, &at));
        assert!((found.0 - length).abs() < 1e-9, "{lines}: {found:?}");
        assert_eq!(found.1, places, "{lines}");
    }
    // The mesh may be divided further.
    let refined = format!("refine = 1\n{}", crease_at("{ drawn = [\"red\"] }"));
    let found = driven(&setup(dir.path(), CARD, 0.02, &refined));
    assert!(
        (found.0 - 100.0).abs() < 1e-9 && found.1 == [90.0],
        "{found:?}"
    );
}

/// Drawing programs write hundredths of a point: a line that was meant at 12 mm is at 34.02 points.
#[test]
fn a_line_of_coordinates_finds_what_a_drawing_program_rounded() {
    let dir = tempfile::tempdir().unwrap();
    let drawn = "<path d='M0 0 H140 V100 H0 Z'/><path stroke='blue' d='M12.00166 0 V100'/>";
    let line = |x: f64| {
        let line = format!("{{ line = {{ from = [{x}, 0, 0], to = [{x}, 0.1, 0] }} }}");
        crease_at(&line)
    };
    let found = driven(&setup(dir.path(), drawn, 0.01, &line(0.012)));
    assert!((found.0 - 100.0).abs() < 1e-9, "{found:?}");
    let wrong = |rest: &str| {
        fs::write(dir.path().join("sheet.svg"), svg(drawn)).unwrap();
        let text = format!(
            "version = 1\n[sheet]\nmesh = {{ drawing = {{ path = \"sheet.svg\", spacing = 0.01 }} }}\n{rest}"
        );
        let scene = SceneFile::parse(text, &dir.path().join("scene.toml"), &[]);
        let problem = scene.and_then(|scene| scene.build().map_err(Into::into));
        match problem {
            Ok(_) => panic!("{rest} is accepted"),
            Err(e) => e.to_string(),
        }
    };
    let told = wrong(&line(-0.5));
    assert!(told.contains("the nearest one, from (0.0"), "{told}");
    let told = wrong(&crease_at("{ drawn = [\"layer:Score\"] }"));
    assert!(
        told.contains("layer:Score selects no line: the colours are black, blue"),
        "{told}"
    );
    let told = wrong(&crease_at("{ drawn = [\"scores\"] }"));
    assert!(told.contains("\"scores\" selects no lines"), "{told}");
    let support =
        "[[support]]\nat = { box = { min = [0.2, 0, 0], max = [0.3, 0.1, 0] } }\nhold = \"pin\"";
    let told = wrong(support);
    assert!(
        told.contains("the nearest one, at (0.14, ") && told.contains("is 0.06 m away"),
        "{told}"
    );
    let support = "[[support]]\nat = { half_space = { point = [0, 0.25, 0], normal = [0, 3, 0] } }\nhold = \"pin\"";
    let told = wrong(support);
    assert!(told.contains("is 0.15 m away"), "{told}");
}

#[test]
fn only_a_drawing_has_lines_to_select() {
    let text = format!(
        "version = 1\n[sheet]\nmesh = {{ square = {{ side = 1, level = 1 }} }}\n{}",
        crease_at("{ drawn = [\"red\"] }")
    );
    let scene = SceneFile::parse(text, Path::new("scene.toml"), &[]).unwrap();
    let told = scene.build().unwrap_err().to_string();
    assert!(
        told.contains("the mesh of the sheet is made of no drawing"),
        "{told}"
    );
}
