//! Sheets of several materials in one scene: rods beside elastic sheets, and numbers that each sheet has of
//! its own.

use crate::bodies::{centre, live, play};
use crate::{parse, simulation};
use isosheet_dynamics::{At, Simulation, immobile_vertices};
use isosheet_mesh::VertexId;
use isosheet_scenes::Setup;

const G: f64 = 9.81;

/// Largest relative error of the lengths of a sheet.
fn strain(simulation: &Simulation, setup: &Setup, sheet: usize) -> f64 {
    let edges = setup.parts[sheet].1.edges.clone();
    let model = simulation.model();
    model.edges().max_strain_among(edges, &simulation.state().x)
}

/// A square of rods on an elastic cloth that hangs by its rim.
const CARD_ON_CLOTH: &str = "version = 1\n\
    [[sheet]]\nname = \"cloth\"\nmesh = { square = { side = 0.2, level = 2 } }\n\
    isometry = { elastic = { stiffness = 2e3, limit = 0.05 } }\nbending = { plate = { rigidity = 1e-5 } }\n\
    mass = 0.004\ndamping = 4\n\
    [[sheet]]\nname = \"card\"\nmesh = { square = { side = 0.1, level = 1 } }\nisometry = \"rods\"\nmass = 0.01\n\
    bending = { plate = { rigidity = 1e-3 } }\ndamping = 4\nplacement = { position = [0.051, 0.052, 3e-4] }\n\
    [[support]]\nsheet = \"cloth\"\nat = \"boundary\"\n\
    [forces]\ngravity = [0, 0, -9.81]\n\
    [contact]\nself_contact = true\nfriction = 0.5\n";

#[test]
fn a_card_of_rods_on_an_elastic_cloth_keeps_its_lengths_and_its_weight_reaches_the_supports() {
    let setup = parse(CARD_ON_CLOTH).unwrap().build().unwrap();
    assert!(setup.modelled.iter().any(|words| words == "rigid rods"));
    assert!(
        setup
            .modelled
            .iter()
            .any(|words| words.starts_with("elasticity"))
    );
    let mut card_on_cloth = simulation(CARD_ON_CLOTH);
    for _ in 0..180 {
        let report = card_on_cloth.step(1.0 / 60.0).unwrap();
        assert!(report.gap.is_none_or(|gap| gap > 0.0));
        assert!(strain(&card_on_cloth, &setup, 1) < 2e-12);
        assert!(report.constrained_strain < 2e-12);
    }
    assert!(
        strain(&card_on_cloth, &setup, 0) > 1e-5,
        "the cloth stretches"
    );
    let at_supports = card_on_cloth.support_forces();
    let lift: f64 = at_supports.iter().map(|(_, force)| force[2]).sum();
    assert!((lift / (0.014 * G) - 1.0).abs() < 0.01, "{lift}");
    // The forces of the rods are there, and the edges of the cloth have none.
    let forces = card_on_cloth.rod_forces().unwrap();
    let [cloth, card] = [0, 1].map(|k| &forces[setup.parts[k].1.edges.clone()]);
    assert!(cloth.iter().all(|f| *f == 0.0) && card.iter().any(|f| f.abs() > 1e-6));
}

/// A strip that is pulled by 2 N at its end.
fn pulled(name: &str, y: f64, isometry: &str) -> String {
    format!(
        "[[sheet]]\nname = \"{name}\"\nmass = 1e-3\ndamping = 20\nisometry = {isometry}\n\
         mesh = {{ rectangle = {{ width = 0.1, height = 0.02, columns = 10, rows = 2 }} }}\n\
         placement = {{ position = [0, {y:?}, 0] }}\n\
         [[support]]\nsheet = \"{name}\"\nat = {{ vertices = [0, 11, 22] }}\n\
         [[forces.load]]\nsheet = \"{name}\"\nat = {{ vertices = [10, 21, 32] }}\n\
         direction = [1, 0, 0]\nsize = 2\n"
    )
}

/// Without contraction across, 2 N stretch a strip of 0.02 m and 1e4 N/m by 1 %.
#[test]
fn each_of_several_sheets_has_its_own_limit_of_strain() {
    let elastic = |limit: f64| {
        format!("{{ elastic = {{ stiffness = 1e4, poisson = 0.0, limit = {limit:?} }} }}")
    };
    let scene = format!(
        "version = 1\n{}{}{}",
        pulled("free", 0.0, &elastic(0.1)),
        pulled("bound", 1.0, &elastic(0.004)),
        pulled("rods", 2.0, "\"rods\"")
    );
    let setup = parse(&scene).unwrap().build().unwrap();
    let mut run = simulation(&scene);
    for _ in 0..240 {
        run.step(1.0 / 60.0).unwrap();
    }
    let x = &run.state().x;
    let stretch = |sheet: usize| {
        let first = setup.parts[sheet].1.vertices.start;
        // The middle of the strip, between its ends, where its corners do not matter.
        (x[3 * (first + 18)] - x[3 * (first + 14)]) / 0.04 - 1.0
    };
    // Green's strain is e + e^2 / 2, and its stress is along the strip as it is then.
    let green = |e: f64| e * (1.0 + 0.5 * e);
    let expected = 0.0099;
    assert!(
        (green(stretch(0)) / expected - 1.0).abs() < 0.02,
        "{}",
        stretch(0)
    );
    let elastic = run.model().elastic_sheet().unwrap();
    let strains = elastic
        .faces()
        .zip(elastic.strains(At::new(0.0, x)).zip(elastic.limits()));
    for (face, (strain, limit)) in strains {
        let is_first = setup.parts[0].1.faces.contains(&face.index());
        assert_eq!(limit, if is_first { 0.1 } else { 0.004 });
        assert!(strain < limit, "{face}: {strain}");
    }
    assert!(stretch(1) > 0.002 && stretch(1) < 0.004, "{}", stretch(1));
    assert!(stretch(2).abs() < 1e-11, "{}", stretch(2));
}

/// The barrier at the limit of a sheet is what carries it here, and is none of a body that is far away.
#[test]
fn a_heavy_body_far_away_changes_nothing_of_a_sheet_at_its_limit() {
    let elastic = "{ elastic = { stiffness = 1e4, poisson = 0.0, limit = 0.004 } }";
    let alone = format!("version = 1\n{}", pulled("bound", 0.0, elastic));
    let beside = alone.clone()
        + "[[body]]\nshape = { box = { size = [0.1, 0.1, 0.1] } }\nmass = 1000\n\
           pose = { position = [2, 2, 2] }\n";
    let [alone, beside] = [alone, beside].map(|scene| {
        let mut run = simulation(&scene);
        for _ in 0..120 {
            run.step(1.0 / 60.0).unwrap();
        }
        run.state().x[3 * 21]
    });
    // The stretch is 0.2 to 0.4 mm. (Scenes with rods, as of the body, have their own tolerance of steps.)
    assert!((alone - beside).abs() < 1e-6, "{alone} {beside}");
}

/// A sheet of felt of 3 mm on a table and a card of 1 mm on it: middle surfaces lie 3 mm above the table and
/// (3 + 1) / 2 mm above the felt, and what the barrier leaves.
#[test]
fn a_stack_of_sheets_of_several_thicknesses_has_its_height() {
    let activation = 2e-4;
    let [felt, card] = [3e-3, 1e-3];
    let scene = format!(
        "version = 1\n\
         [[sheet]]\nname = \"felt\"\nmaterial = \"polycarbonate film\"\nthickness = {felt:?}\ndamping = 10\n\
         mesh = {{ square = {{ side = 0.1, level = 1 }} }}\nplacement = {{ position = [0, 0, 3.3e-3] }}\n\
         [[sheet]]\nname = \"card\"\nmaterial = \"office paper\"\nthickness = {card:?}\ndamping = 5\n\
         mesh = {{ square = {{ side = 0.05, level = 1 }} }}\nplacement = {{ position = [0.021, 0.022, 5.6e-3] }}\n\
         [[obstacle]]\nshape = \"half_space\"\n\
         [forces]\ngravity = [0, 0, -9.81]\n\
         [contact]\nself_contact = true\nactivation = {activation:?}\n"
    );
    let mut stack = simulation(&scene);
    for _ in 0..120 {
        let report = stack.step(1.0 / 60.0).unwrap();
        assert!(report.gap.is_none_or(|gap| gap > 0.0));
    }
    let heights = |vertices: std::ops::Range<usize>| {
        let x = stack.state().vertex_positions();
        x[vertices].iter().map(|p| p[2]).collect::<Vec<f64>>()
    };
    let (below, above) = (heights(0..25), heights(25..50));
    let slack = 1e-5; // of bends between vertices
    for z in &below {
        assert!((felt..felt + activation).contains(z), "{z}");
    }
    for z in &above {
        let apart = z - below.iter().sum::<f64>() / 25.0;
        let kept = 0.5 * (felt + card);
        assert!(
            apart > kept - slack && apart < kept + activation + slack,
            "{apart}"
        );
    }
}

/// A sheet that is thrown at another one at several metres per second stays away by the mean of both
/// thicknesses.
#[test]
fn a_thick_sheet_that_is_thrown_keeps_its_distance() {
    let scene = "version = 1\n\
        [[sheet]]\nname = \"target\"\nmaterial = \"office paper\"\nthickness = 4e-3\n\
        mesh = { square = { side = 0.2, level = 1 } }\n\
        [[support]]\nsheet = \"target\"\nat = \"all\"\n\
        [[sheet]]\nname = \"thrown\"\nmaterial = \"office paper\"\n\
        mesh = { square = { side = 0.05, level = 1 } }\nplacement = { position = [0.06, 0.07, 0.05] }\n\
        start = { velocity = [0, 0, -5] }\n\
        [contact]\nself_contact = true\n";
    let mut run = simulation(scene);
    let mut lowest = f64::INFINITY;
    for _ in 0..60 {
        run.step(1e-3).unwrap();
        let thrown = &run.state().vertex_positions()[25..];
        lowest = thrown.iter().map(|p| p[2]).fold(lowest, f64::min);
    }
    // (4 mm + 0) / 2, and no further away than the barrier reaches: 1 % of the mean edge.
    assert!(lowest > 2e-3 && lowest < 2e-3 + 1e-3, "{lowest}");
}

/// Two bodies keep no distance by the thickness of a sheet that is elsewhere.
#[test]
fn the_thickness_of_a_sheet_is_none_of_bodies() {
    let scene = "version = 1\n\
        [sheet]\nmaterial = \"office paper\"\nthickness = 5e-3\nmesh = { square = { side = 0.1, level = 1 } }\n\
        placement = { position = [1, 1, 1] }\n[[support]]\nat = \"all\"\n\
        [[body]]\nname = \"below\"\nshape = { box = { size = [0.1, 0.1, 0.02] } }\nmass = 0.1\n\
        pose = { position = [0, 0, 0.0101] }\n\
        [[body]]\nname = \"above\"\nshape = { box = { size = [0.05, 0.05, 0.02] } }\nmass = 0.1\n\
        pose = { position = [0.003, 0.002, 0.0302] }\n\
        [[obstacle]]\nshape = \"half_space\"\n\
        [forces]\ngravity = [0, 0, -9.81]\n\
        [contact]\nactivation = 2e-4\n";
    let mut run = live(scene);
    play(&mut run, 1.0);
    let [below, above] = [0, 1].map(|k| centre(&run, k).z);
    assert!(below > 0.01 && below < 0.01 + 2e-4, "{below}");
    assert!(
        above - below > 0.02 && above - below < 0.02 + 2e-4,
        "{above}"
    );
}

/// A clamped strip with a load at its end stays bent where the moment at the clamp was beyond that at which
/// it yields, and springs back where it was not. Both have the same stiffness.
#[test]
fn each_of_several_sheets_yields_by_itself() {
    let strip = |name: &str, y: f64, moment: f64| {
        format!(
            "[[sheet]]\nname = \"{name}\"\nmesh = {{ rectangle = {{ width = 0.1, height = 0.02, columns = 10, rows = 2 }} }}\n\
             isometry = {{ elastic = {{ stiffness = 3e5 }} }}\nbending = {{ plate = {{ rigidity = 1e-3 }} }}\n\
             yield = {{ moment = {moment:?} }}\ndamping = 10\nplacement = {{ position = [0, {y:?}, 0] }}\n\
             [[support]]\nsheet = \"{name}\"\nat = {{ vertices = [0, 1, 11, 12, 22, 23] }}\n\
             [[forces.load]]\nsheet = \"{name}\"\nat = {{ vertices = [10, 21, 32] }}\ndirection = [0, 0, 1]\n\
             size = {{ keyframes = {{ keys = [[0, 0], [0.5, 1e-3], [1, 1e-3], [1.5, 0]] }} }}\n"
        )
    };
    // The moment at the clamp is 1e-3 N 0.09 m / 0.02 m = 4.5e-3 N m / m.
    let scene = format!(
        "version = 1\n{}{}",
        strip("strong", 0.0, 9e-3),
        strip("weak", 1.0, 2.2e-3)
    );
    let mut run = simulation(&scene);
    for _ in 0..150 {
        run.step(1.0 / 50.0).unwrap();
    }
    let tip = |first: usize| run.state().vertex_positions()[first + 21][2];
    assert!(tip(0).abs() < 1e-5, "{}", tip(0));
    assert!(tip(33) > 1e-3, "{}", tip(33));
}

/// A strip that hangs by two corners, taut between them: of rods its upper rim cannot move.
#[test]
fn rods_that_hold_one_another_are_found_beside_an_elastic_sheet() {
    let strip = |name: &str, y: f64, isometry: &str| {
        format!(
            "[[sheet]]\nname = \"{name}\"\nmass = 1e-3\nisometry = {isometry}\n\
             mesh = {{ rectangle = {{ width = 0.1, height = 0.02, columns = 10, rows = 2 }} }}\n\
             placement = {{ position = [0, {y:?}, 0] }}\n\
             [[support]]\nsheet = \"{name}\"\nat = {{ vertices = [0, 10] }}\n"
        )
    };
    let elastic = strip("elastic", 0.0, "{ elastic = { stiffness = 1e4 } }");
    let scene = format!("version = 1\n{elastic}{}", strip("rods", 1.0, "\"rods\""));
    let setup = parse(&scene).unwrap().build().unwrap();
    let mut found = immobile_vertices(&setup.model, &setup.start.x);
    found.sort_unstable();
    let expected: Vec<VertexId> = (34..43).map(VertexId).collect();
    assert_eq!(found, expected);
}

/// No line of edges of an irregular mesh runs along a clamp, which matters to rods alone.
#[test]
fn clamps_across_the_mesh_are_warned_of_where_the_sheet_is_of_rods() {
    let sheet = |name: &str, y: f64, isometry: &str| {
        format!(
            "[[sheet]]\nname = \"{name}\"\nisometry = {isometry}\nplacement = {{ position = [0, {y:?}, 0] }}\n\
             mesh = {{ polygon = {{ outline = [[0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]], spacing = 0.02 }} }}\n\
             [[support]]\nsheet = \"{name}\"\nat = {{ half_space = {{ point = [0.05, 0, 0], normal = [-1, 0, 0] }} }}\n"
        )
    };
    let elastic = sheet("elastic", 0.0, "{ elastic = { stiffness = 1e4 } }");
    let scene = format!("version = 1\n{elastic}{}", sheet("rods", 1.0, "\"rods\""));
    let warnings = parse(&scene).unwrap().build().unwrap().warnings();
    let [warning] = &warnings[..] else {
        panic!("{warnings:?}");
    };
    let text = format!("{warning:?}");
    assert!(
        text.contains("`support[1]`") && !text.contains("`support[0]`"),
        "{text}"
    );
}
