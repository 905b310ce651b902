//! Sheets that swell and shrink.

use crate::{parse, simulation};
use isosheet_scenes::{LiveScene, SupportForces};

/// A strip of 0.2 m by 0.05 m, held at both ends or not.
fn strip(lines: &str, supports: &str) -> String {
    format!(
        "version = 1\n[sheet]\nmesh = {{ rectangle = {{ width = 0.2, height = 0.05, columns = 16, rows = 4 }} }}\n\
         damping = 20\n{lines}\n{supports}\n"
    )
}

const ELASTIC: &str = "isometry = { elastic = { stiffness = 3e5, poisson = 0 } }";

const ENDS: &str = "[[support]]\nat = { box = { min = [-1, -1, -1], max = [1e-6, 1, 1] } }\nhold = \"pin\"\n\
                    [[support]]\nat = { box = { min = [0.199999, -1, -1], max = [1, 1, 1] } }\nhold = \"pin\"\n";

/// Each support pulls with `E h w s`, but for terms of second order in `s`.
#[test]
fn a_strip_that_shrinks_pulls_at_its_supports() {
    let text = strip(
        &format!("{ELASTIC}\nswell = {{ smooth_step = {{ to = -0.002, end = 1 }} }}"),
        ENDS,
    );
    let setup = parse(&text).unwrap().build().unwrap();
    let facts = setup.facts.clone();
    let mut simulation = setup.start().unwrap();
    let supports = SupportForces::new(facts, &simulation, 2);
    for _ in 0..90 {
        simulation.step(1.0 / 60.0).unwrap();
    }
    let expected = 3e5 * 0.05 * 0.002;
    for (load, pull) in supports.loads(&simulation).zip([-expected, expected]) {
        assert!((load.force[0] / pull - 1.0).abs() < 5e-3, "{load:?} {pull}");
    }
}

/// One of two sheets, with the plate of its material.
#[test]
fn one_of_two_sheets_swells() {
    let sheet = |name: &str, lines: &str| {
        format!(
            "[[sheet]]\nname = \"{name}\"\nmaterial = \"office paper\"\ndamping = 20\n{lines}\n\
             mesh = {{ rectangle = {{ width = 0.2, height = 0.05, columns = 8, rows = 2 }} }}\n"
        )
    };
    let swells = "swell = { smooth_step = { to = 0.01, end = 0.5 } }\nplacement = { position = [0, 0, 0.1] }";
    let text = format!(
        "version = 1\n{}{}[forces]\ngravity = [0, 0, 0]\n",
        sheet("stays", ""),
        sheet("swells", swells)
    );
    let mut simulation = simulation(&text);
    for _ in 0..60 {
        simulation.step(1.0 / 60.0).unwrap();
    }
    let edges = simulation.model().edges();
    let (x, half) = (&simulation.state().x, edges.len() / 2);
    for (k, (&[a, b], length)) in edges.edges().iter().zip(edges.lengths()).enumerate() {
        let squared: f64 = (0..3).map(|c| (x[3 * a + c] - x[3 * b + c]).powi(2)).sum();
        let expected = if k < half { 1.0 } else { 1.01 };
        let found = squared.sqrt() / length;
        assert!((found - expected).abs() < 1e-5, "{found} {expected}");
    }
}

#[test]
fn what_cannot_swell_is_refused() {
    for (lines, reason) in [
        ("swell = 0.01", "rigid rods"),
        (
            &format!("{ELASTIC}\nswell = {{ ramp = {{ to = 0.3, end = 1 }} }}"),
            "from -0.2 to 0.2",
        ),
        (
            &format!("{ELASTIC}\nswell = {{ sine = {{ amplitude = 0.3, frequency = 1 }} }}"),
            "from -0.2 to 0.2",
        ),
        (
            &format!("{ELASTIC}\nswell = {{ ramp = {{ to = 0.1, end = -1 }} }}"),
            "`sheet.swell` cannot be used",
        ),
    ] {
        let error = parse(&strip(lines, "")).err().map(|e| e.to_string());
        let error = error.unwrap_or_else(|| panic!("accepted: {lines}"));
        assert!(error.contains(reason), "{error}");
    }
}

/// Swelling that a sheet cannot follow is found in a step, and the error names the key.
#[test]
fn what_a_sheet_cannot_follow_names_the_key() {
    for (swell, supports, reason) in [
        (
            "{ smooth_step = { to = -0.1, end = 1 } }",
            ENDS,
            "and the limit is 0.05",
        ),
        (
            "{ run_up = { rate = 0.5, end = 0.1 } }",
            "",
            "would grow by the part",
        ),
    ] {
        let scene = parse(&strip(&format!("{ELASTIC}\nswell = {swell}"), supports)).unwrap();
        let setup = scene.build().unwrap();
        let origins = setup.origins.clone();
        let mut simulation = setup.start().unwrap();
        let error = (0..120)
            .find_map(|_| simulation.step(1.0 / 60.0).err())
            .unwrap();
        let problem = origins.of_failed_step(&error, &simulation);
        let text = problem.to_string();
        assert!(
            text.contains("sheet.swell") && text.contains(reason),
            "{text}"
        );
    }
}

/// A simulation goes on with curls and swelling that are led to other values.
#[test]
fn curls_and_swelling_are_driven_by_hand() {
    let lines =
        "material = \"office paper\"\nswell = 0\ncurl = { along = [1, 0, 0], radius = 0.5 }";
    let text = strip(lines, "[forces]\ngravity = [0, 0, 0]\n");
    let mut live = LiveScene::start(parse(&text).unwrap()).unwrap();
    let key = |text: &str| text.parse().unwrap();
    let targets = [
        (key("sheet.swell"), 0.01.into()),
        (key("sheet.curl.profile"), 0.0.into()),
    ];
    live.drive(&targets, 0.5).unwrap();
    for _ in 0..60 {
        live.step(1.0 / 60.0).unwrap();
    }
    let edges = live.simulation().model().edges();
    let strain = edges.max_strain(&live.simulation().state().x);
    assert!((strain - 0.01).abs() < 1e-4, "{strain}");
}
