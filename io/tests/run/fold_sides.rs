//! How far, to which side and in which layers `isosheet fold` folds.

use crate::fold::folded;
use crate::{code, run, stderr};
use isosheet_mesh::fold_angle;
use isosheet_runs::{Layers, LayersError, Recording};
use std::fs;
use std::path::Path;

/// A sheet of 100 by 50 mm with two parallel creases at its thirds, a valley and a mountain.
const LETTER: &str = "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='50mm' viewBox='0 0 100 50' \
    fill='none'><rect width='90' height='50' stroke='#000'/><path stroke='#00f' d='M30 0 V50'/>\
    <path stroke='#f00' d='M60 0 V50'/></svg>";

/// The fold angles of the two creases at the end, degrees, from left to right.
fn angles(folder: &Path) -> [f64; 2] {
    let recording = Recording::read(&folder.join("out")).unwrap();
    let last = recording.trajectory.len() - 1;
    let x = recording.trajectory.frame(last).unwrap();
    let topology = recording.sheet.topology();
    let targets = recording.targets.folding.as_ref().unwrap();
    let mut creases: Vec<(f64, f64)> = targets
        .creases
        .iter()
        .map(|(e, _)| {
            let end = recording.sheet.position(topology.edges()[e.index()][0]);
            (end[0], fold_angle(topology, x, *e).unwrap().to_degrees())
        })
        .collect();
    creases.sort_by(|a, b| a.0.total_cmp(&b.0));
    [creases[0].1, creases[1].1]
}

#[test]
fn angles_and_sides_are_those_that_are_asked_for() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("letter.svg"), LETTER).unwrap();
    let words = ["letter.svg", "--out", "out", "--force", "--angle", "60"];
    // Springs without a load end at their angles: two parallel creases do not hinder each other.
    for (swap, expected) in [(&[][..], [60.0, -60.0]), (&["--swap"], [-60.0, 60.0])] {
        let (said, ..) = folded(dir.path(), &[&words[..], swap].concat());
        let found = angles(dir.path());
        assert!(
            (0..2).all(|k| (found[k] - expected[k]).abs() < 1.0),
            "{found:?} in place of {expected:?}"
        );
        let last = said.lines().last().unwrap();
        assert!(last.ends_with("; the flat sheet is 90 by 50 mm."), "{last}");
    }
    let mild = LETTER.replace("stroke='#00f'", "stroke='#00f' opacity='0.5'");
    let mild = mild.replace("stroke='#f00'", "stroke='#f00' opacity='0.25'");
    fs::write(dir.path().join("letter.svg"), mild).unwrap();
    // The sharpest crease has the angle, and the other one is in proportion.
    folded(dir.path(), &words);
    let found = angles(dir.path());
    assert!(
        (found[0] - 60.0).abs() < 1.0 && (found[1] + 30.0).abs() < 1.0,
        "{found:?}"
    );
    let refused = run(
        dir.path(),
        &["fold", "letter.svg", "--out", "out", "--angle", "120"],
    );
    assert_eq!(code(&refused), Some(2), "{}", stderr(&refused));
    assert!(stderr(&refused).contains("at most 90 degrees"));
}

#[test]
fn a_letter_that_is_folded_flat_has_three_layers() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("letter.svg"), LETTER).unwrap();
    let words = ["letter.svg", "--out", "out", "--force", "--contact"];
    folded(dir.path(), &words);
    let recording = Recording::read(&dir.path().join("out")).unwrap();
    let layers = Layers::of(&recording).unwrap();
    // A valley and a mountain fold the sheet to a Z: each panel covers the other two.
    assert_eq!((layers.count(), layers.covers.len()), (3, 3));
    assert_eq!(layers.levels[layers.panels[0]] % 2, 0, "an end of the Z");
    let middle = (0..3).find(|k| layers.levels[*k] == 1).unwrap();
    let fronts = layers.shows_front.iter().filter(|front| **front).count();
    assert_eq!(layers.shows_front[middle], fronts == 1);
    // At a valley the fronts of the two panels meet, as `faceOrders` of the FOLD format has it.
    let topology = recording.sheet.topology();
    for (e, angle) in &recording.targets.folding.as_ref().unwrap().creases {
        let panel = |k: usize| layers.panels[topology.edge_faces(*e)[k].unwrap().index()];
        let pair = [panel(0), panel(1)];
        let orders = layers.face_orders();
        let order = orders.iter().find(|[f, g, _]| {
            let found = [f, g].map(|f| layers.panels[usize::try_from(*f).unwrap()]);
            found == pair || found == [pair[1], pair[0]]
        });
        assert_eq!(order.unwrap()[2] == 1, *angle > 0.0);
    }
    let drawn = run(dir.path(), &["convert", "out", "layers.svg"]);
    assert_eq!(code(&drawn), Some(0), "{}", stderr(&drawn));
    let said = String::from_utf8(drawn.stdout).unwrap();
    assert!(said.contains("3 panels in 3 layers"), "{said}");
    let svg = fs::read_to_string(dir.path().join("layers.svg")).unwrap();
    assert_eq!(svg.matches("<text ").count(), 3);
    // What is half open has no layers.
    folded(dir.path(), &[&words[..], &["--part", "0.5"]].concat());
    let recording = Recording::read(&dir.path().join("out")).unwrap();
    let found = Layers::of(&recording);
    assert!(
        matches!(found, Err(LayersError::NotFlat { .. })),
        "{found:?}"
    );
}
