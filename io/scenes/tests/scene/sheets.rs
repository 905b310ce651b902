//! Scenes of several sheets.

use crate::{parse, simulation};
use isosheet_dynamics::{ImplicitOptions, Method};
use isosheet_mesh::{VertexId, fold_angle};
use isosheet_scenes::{Integration, Scene, SceneFile};
use std::path::Path;

const STRIP: &str = "mesh = { rectangle = { width = 0.1, height = 0.02, columns = 10, rows = 2 } }";

/// Two clamped strips of different materials far from each other.
fn two_strips() -> String {
    format!(
        "version = 1\n\
         [[sheet]]\nname = \"paper\"\n{STRIP}\nmaterial = \"office paper\"\n\
         [[sheet]]\nname = \"film\"\n{STRIP}\nmaterial = \"polycarbonate film\"\n\
         placement = {{ position = [0, 1, 0] }}\n\
         {}\
         [forces]\ngravity = [0, 0, -9.81]\n\
         [[forces.load]]\nsheet = \"film\"\nat = {{ vertices = [10] }}\ndirection = [0, 0, -1]\nsize = 1e-3\n",
        ["paper", "film"].map(support).concat(),
    )
}

/// The first two columns of vertices of a strip.
fn support(sheet: &str) -> String {
    let clamp = "{ vertices = [0, 1, 11, 12, 22, 23] }";
    format!("[[support]]\nsheet = \"{sheet}\"\nat = {clamp}\n")
}

fn one_strip(material: &str, y: f64, load: &str) -> String {
    format!(
        "version = 1\n[sheet]\n{STRIP}\nmaterial = \"{material}\"\nplacement = {{ position = [0, {y:?}, 0] }}\n\
         [[support]]\nat = {{ vertices = [0, 1, 11, 12, 22, 23] }}\n\
         [forces]\ngravity = [0, 0, -9.81]\n{load}"
    )
}

#[test]
fn sheets_that_do_not_meet_move_as_each_does_alone() {
    // Steps are solved to a tolerance that follows the size and the mass of the whole: a small one here.
    let exactly = |text: &str| {
        let mut setup = parse(text).unwrap().build().unwrap();
        let Integration::Free { method, .. } = &mut setup.integration else {
            panic!("without a chart");
        };
        *method = Method::Bdf2(ImplicitOptions {
            tolerance: Some(1e-9),
            ..ImplicitOptions::default()
        });
        setup.start().unwrap()
    };
    let mut both = exactly(&two_strips());
    let mut paper = exactly(&one_strip("office paper", 0.0, ""));
    let load = "[[forces.load]]\nat = { vertices = [10] }\ndirection = [0, 0, -1]\nsize = 1e-3\n";
    let mut film = exactly(&one_strip("polycarbonate film", 1.0, load));
    let n = paper.state().x.len();
    for _ in 0..20 {
        for simulation in [&mut both, &mut paper, &mut film] {
            simulation.step(1.0 / 60.0).unwrap();
        }
    }
    let alone = [&paper.state().x[..], &film.state().x[..]].concat();
    let difference = |a: &[f64], b: &[f64]| {
        let pairs = a.iter().zip(b);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let start = simulation(&two_strips()).state().x.clone();
    let bends = [
        difference(&start[..n], &alone[..n]),
        difference(&start[n..], &alone[n..]),
    ];
    assert!(bends.iter().all(|bend| *bend > 1e-3), "{bends:?}");
    let apart = difference(&both.state().x, &alone);
    // A step ends where the round-off of the energy hides a further decrease, and a bend goes with the root
    // of it.
    assert!(apart < 1e-3 * bends[0].min(bends[1]), "{apart}");
}

/// A small sheet on a large one, both tilted by gravity: it stays where friction is larger than the slope,
/// and slides with `g (sin a - mu cos a)` where it is smaller.
#[test]
fn friction_between_two_sheets_is_that_of_their_pair() {
    let slope = 0.3_f64;
    let [down, along] = [slope.cos(), slope.sin()].map(|c| 9.81 * c);
    let scene = |pair: &str| {
        format!(
            "version = 1\n\
             [[sheet]]\nname = \"below\"\nmaterial = \"steel sheet\"\n\
             mesh = {{ rectangle = {{ width = 0.3, height = 0.1, columns = 12, rows = 4 }} }}\n\
             [[sheet]]\nname = \"above\"\nmaterial = \"steel sheet\"\n\
             mesh = {{ rectangle = {{ width = 0.05, height = 0.05, columns = 2, rows = 2 }} }}\n\
             placement = {{ position = [0.021, 0.023, 2e-4] }}\n\
             [[support]]\nsheet = \"below\"\nat = \"all\"\n\
             [forces]\ngravity = [{along}, 0, {}]\n\
             [contact]\nself_contact = true\nfriction = 0.9\n{pair}",
            -down
        )
    };
    let slip = |pair: &str| {
        let mut simulation = simulation(&scene(pair));
        let x = |s: &isosheet_dynamics::Simulation| s.state().x[s.state().x.len() - 3];
        let (steps, h) = (25, 0.01);
        let before = x(&simulation);
        for _ in 0..steps {
            let report = simulation.step(h).unwrap();
            assert!(report.gap.is_some_and(|gap| gap > 0.0));
        }
        (x(&simulation) - before, steps as f64 * h)
    };
    let (held, _) = slip("");
    assert!(held.abs() < 1e-4, "{held}");
    let pair = "[[contact.pair]]\nsheets = [\"above\", \"below\"]\nfriction = 0.1\n";
    let (slid, t) = slip(pair);
    let exact = 0.5 * (along - 0.1 * down) * t * t;
    assert!((slid / exact - 1.0).abs() < 0.05, "{slid} and {exact}");
}

#[test]
fn creases_fold_the_sheet_that_they_name() {
    let scene = "version = 1\n\
        [[sheet]]\nname = \"a\"\nmesh = { rectangle = { width = 0.2, height = 0.1, columns = 2, rows = 1 } }\ndamping = 20\n\
        [[sheet]]\nname = \"b\"\nmesh = { rectangle = { width = 0.2, height = 0.1, columns = 2, rows = 1 } }\ndamping = 20\n\
        placement = { position = [0, 0, 1] }\n\
        [[crease]]\nsheet = \"b\"\nat = { line = { from = [0.1, 0, 0], to = [0.1, 0.1, 0] } }\nstiffness = 0.1\n\
        angle = { smooth_step = { to = 90.0, end = 0.5 } }\n";
    let mut simulation = simulation(scene);
    for _ in 0..120 {
        simulation.step(1.0 / 60.0).unwrap();
    }
    let t = simulation.model().topology();
    // The crease is the edge between the vertices 1 and 4 of each sheet.
    let angle = |from: u32| {
        let edge = t.find_edge(VertexId(from + 1), VertexId(from + 4)).unwrap();
        let angle = fold_angle(t, &simulation.state().x, edge).unwrap();
        angle.to_degrees()
    };
    assert!(angle(0).abs() < 1e-6, "{}", angle(0));
    assert!((angle(6) - 90.0).abs() < 1.0, "{}", angle(6));
}

#[test]
fn a_scene_of_several_sheets_is_written_as_it_was_read() {
    let scene: Scene = parse(&two_strips()).unwrap().scene().clone();
    assert_eq!(scene.sheet.len(), 2);
    let written = SceneFile::of(scene.clone(), Path::new("")).unwrap();
    assert!(written.text().text.contains("[[sheet]]"));
    assert_eq!(parse(&written.text().text).unwrap().scene(), &scene);
    let setup = written.build().unwrap();
    let [(paper, first), (film, second)] = &setup.parts[..] else {
        panic!("{:?}", setup.parts);
    };
    assert_eq!((paper.as_str(), film.as_str()), ("paper", "film"));
    assert_eq!(
        (first.vertices.clone(), second.vertices.clone()),
        (0..33, 33..66)
    );
    // The materials differ in mass.
    let masses = &setup.model.mass().vertex;
    let [paper, film] = [first, second].map(|p| masses[p.vertices.clone()].iter().sum::<f64>());
    assert!((paper - 0.08 * 0.002).abs() < 1e-12);
    assert!(film > 1.2 * paper);
}

#[test]
fn what_is_wrong_with_several_sheets_is_said() {
    let said = |from: &str, to: &str| {
        let text = two_strips();
        assert!(text.contains(from), "{from}");
        let wrong = parse(&text.replacen(from, to, 1)).and_then(|s| {
            s.build()?;
            Ok(())
        });
        wrong.expect_err(to).to_string()
    };
    let cases = [
        ("name = \"film\"\n", "", "the sheet has no name"),
        (
            "name = \"film\"",
            "name = \"paper\"",
            "another sheet has the name `paper`, too",
        ),
        (
            "sheet = \"film\"\nat",
            "sheet = \"foil\"\nat",
            "no sheet has the name `foil`",
        ),
        (
            "[[support]]\nsheet = \"paper\"\n",
            "[[support]]\n",
            "the vertices may be of several sheets",
        ),
        (
            "material = \"office paper\"",
            "material = \"office paper\"\nthickness = -1e-4",
            "thickness",
        ),
        (
            "[forces]",
            "[[contact.pair]]\nsheets = [\"paper\", \"film\"]\nfriction = 0.2\n[forces]",
            "sheets do not meet one another",
        ),
    ];
    for (from, to, message) in cases {
        let text = said(from, to);
        assert!(text.contains(message), "{to}: {text}");
    }
}
