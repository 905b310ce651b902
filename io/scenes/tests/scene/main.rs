//! Scene files: what they mean, and what is said of wrong ones.

mod all_keys;
mod bends;
mod bodies;
mod book;
mod charts;
mod complete;
mod directions;
mod drawings;
mod everyday;
mod files;
mod folding;
mod formulas;
mod groups;
mod guides;
mod keys;
mod live;
mod loads;
mod materials;
mod meaning;
mod messages;
mod pairs;
mod patches;
mod peel;
mod poses;
mod random_bodies;
mod restitution;
mod rolling;
mod seams;
mod sequences;
mod several_materials;
mod sheets;
#[path = "../../../tests/shared/skip.rs"]
mod skip;
mod starts;
mod stiffening;
mod strips;
mod swelling;
mod switches;
mod values;
mod wrong;

use isosheet_dynamics::Simulation;
use isosheet_scenes::{SceneFile, SceneFileError};
use std::path::Path;

/// A scene in memory.
fn parse(text: &str) -> Result<SceneFile, SceneFileError> {
    SceneFile::parse(text.into(), Path::new("test.toml"), &[])
}

fn simulation(text: &str) -> Simulation {
    let scene = parse(text).unwrap_or_else(|e| panic!("{e}"));
    scene
        .build()
        .and_then(|s| s.start())
        .unwrap_or_else(|e| panic!("{e}"))
}
