//! Drawings that fold: trays, pop-up cards, cuts that open.

use isosheet_io::dynamics::State;
use isosheet_io::scene::{SceneFile, Setup};
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
