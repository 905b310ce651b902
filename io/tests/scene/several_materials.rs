//! Sheets of several materials in one scene: rods beside elastic sheets, and numbers that each sheet has of its own.

use crate::{parse, simulation};
use isosheet_io::dynamics::Simulation;
use isosheet_io::scene::Setup;

const G: f64 = 9.81;

/// Largest relative error of the lengths of a sheet.
fn strain(simulation: &Simulation, setup: &Setup, sheet: usize) -> f64 {
    let edges = setup.parts[sheet].1.edges.clone();
    let model = simulation.model();
    model
        .edges()
        .max_strain_among(edges, &simulation.state().x)
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
    assert!(setup.modelled.iter().any(|words| words.starts_with("elasticity")));
    let mut card_on_cloth = simulation(CARD_ON_CLOTH);
    for _ in 0..180 {
        let report = card_on_cloth.step(1.0 / 60.0).unwrap();
        assert!(report.gap.is_none_or(|gap| gap > 0.0));
        assert!(strain(&card_on_cloth, &setup, 1) < 2e-12);
        assert!(report.constrained_strain < 2e-12);
    }
    assert!(strain(&card_on_cloth, &setup, 0) > 1e-5, "the cloth stretches");
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
    assert!((green(stretch(0)) / expected - 1.0).abs() < 0.02, "{}", stretch(0));
    let elastic = run.model().elastic_sheet().unwrap();
    let strains = elastic.faces().zip(elastic.strains(x).zip(elastic.limits()));
    for (face, (strain, limit)) in strains {
        let is_first = setup.parts[0].1.faces.contains(&face.index());
        assert_eq!(limit, if is_first { 0.1 } else { 0.004 });
        assert!(strain < limit, "{face}: {strain}");
    }
    assert!(stretch(1) > 0.002 && stretch(1) < 0.004, "{}", stretch(1));
    assert!(stretch(2).abs() < 1e-11, "{}", stretch(2));
}
