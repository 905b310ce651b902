//! The kinds of runs.

use crate::cost::DEFAULT;
use crate::report::Effort;
use crate::runs::{Bumped, FigureScene, Plan, STEP, displaced};
use anyhow::Result;
use isosheet_dynamics::{ImplicitOptions, Method, Simulation};
use isosheet_scenes::SupportForces;
use isosheet_tests::{Named, energy_momentum, implicit_euler};
use serde::Deserialize;
use std::path::Path;

/// A kind of run, at several sizes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::cost) struct Work {
    /// Its name on the command line and in tables.
    pub(super) name: String,
    /// What happens, for people.
    pub(super) title: String,
    scene: KindOfScene,
    /// Edits of a scene file besides the edits of the size and of the start.
    #[serde(default)]
    pub(super) edits: Vec<String>,
    /// The keys that are the size.
    #[serde(default)]
    keys: Vec<String>,
    /// Sizes of quick runs, of standard ones, and of full ones.
    #[serde(default = "one")]
    sizes: [Vec<u32>; 3],
    /// Random displacements of the start as a part of the mean edge length.
    #[serde(default = "small")]
    perturbation: f64,
    #[serde(default = "single")]
    pub(super) threads: Vec<usize>,
}

/// The only size of a scene without keys.
fn one() -> [Vec<u32>; 3] {
    [0; 3].map(|size| vec![size])
}

fn small() -> f64 {
    1e-3
}

fn single() -> Vec<usize> {
    vec![1]
}

/// What a run is made of.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum KindOfScene {
    /// A file of `xtask/scenes`, or a kind of `isosheet new`.
    File(String),
    /// A scene that other programs have been measured on, by several methods: a square M^k of the size k.
    Bumped(Bumped),
}

/// A method with its step, seconds.
pub(super) type Stepped = (Named, f64);

/// A run before its first step.
pub(super) struct PreparedRun {
    pub(super) simulation: Simulation,
    pub(super) plan: Plan,
    /// Whether the scene ends before.
    pub(super) is_over: Box<dyn Fn(&Simulation) -> bool + Send>,
}

/// The crane's mesh in the folder that `ISOSHEET_DATA` names: a crease pattern of the folder is no part of
/// the repository.
const CRANE: &str = "fold/crane_rabbitear.fold";

impl Work {
    /// The sizes that an effort has time for, smallest first.
    pub(super) fn sizes(&self, effort: Effort) -> &[u32] {
        let [quick, standard, full] = &self.sizes;
        effort.pick(quick, standard, full)
    }

    /// A size in words; empty where there is one only.
    pub(super) fn size_name(&self, size: u32) -> String {
        let is_level = |key: &String| key == "sheet.mesh.square.level";
        match &self.scene {
            KindOfScene::File(_) if self.keys.is_empty() => String::new(),
            KindOfScene::File(_) if !self.keys.iter().all(is_level) => size.to_string(),
            _ => format!("M^{size}"),
        }
    }

    /// The methods by which a scene is run that is not a file: for the tablecloth the methods with contact. A
    /// file names its own.
    pub(super) fn methods(&self) -> Vec<Option<Stepped>> {
        let default = (DEFAULT, Method::default());
        let KindOfScene::Bumped(bumped) = &self.scene else {
            return vec![None];
        };
        if let Bumped::Tablecloth(_) = bumped {
            let euler = ("implicit Euler", implicit_euler());
            return vec![Some((default, STEP)), Some((euler, STEP))];
        }
        // For those who look at the sheet and do not compute with it.
        let quick = Method::Bdf2(ImplicitOptions {
            tolerance: Some(1e-3),
            strain_tolerance: 1e-9,
            ..Default::default()
        });
        let quick = ("BDF2, lengths to 1e-9, decrement to 1e-3", quick);
        let stepped = [
            (default.clone(), STEP),
            (default, 5e-3),
            (quick, STEP),
            (("energy-momentum", energy_momentum()), 2e-3),
        ];
        stepped.map(Some).to_vec()
    }

    /// The edits of a size, as `isosheet simulate --set` takes them.
    fn edits(&self, size: u32) -> impl Iterator<Item = String> {
        let fixed = self.edits.iter().cloned();
        fixed.chain(self.keys.iter().map(move |key| format!("{key}={size}")))
    }

    /// The scene file with the edits that make it the row of the table, for people.
    pub(super) fn command(&self, size: u32) -> Option<String> {
        let KindOfScene::File(file) = &self.scene else {
            return None;
        };
        let words: Vec<String> = self.edits(size).collect();
        Some(format!("{file} {}", words.join(" ")).trim_end().to_owned())
    }

    /// The scene file from one of its starts, by number; `None` if there is none, or if its mesh is a file
    /// that is not there.
    ///
    /// # Errors
    /// A scene file that cannot be read or edited.
    pub(super) fn file(&self, size: u32, start: u64) -> Result<Option<FigureScene>> {
        let KindOfScene::File(file) = &self.scene else {
            return Ok(None);
        };
        let mut edits: Vec<String> = self.edits(size).collect();
        if let Some(edit) = edits.iter_mut().find(|e| e.contains("CRANE")) {
            let folder = std::env::var_os("ISOSHEET_DATA");
            let path = folder.map(|folder| Path::new(&folder).join(CRANE));
            let path = path.and_then(|path| path.canonicalize().ok());
            let Some(path) = path.as_deref().and_then(Path::to_str) else {
                return Ok(None);
            };
            *edit = edit.replace("CRANE", path);
        }
        edits.push(displaced(self.perturbation, start));
        FigureScene::named(file, &self.name, &edits).map(Some)
    }

    /// The run from one of its starts, by number; starts of scenes that are no files are alike. `None` if the
    /// mesh is a file that is not there.
    ///
    /// # Errors
    /// Values of which no simulation can be made.
    pub(super) fn start(
        &self,
        size: u32,
        method: Option<&Stepped>,
        start: u64,
    ) -> Result<Option<PreparedRun>> {
        if let (KindOfScene::Bumped(bumped), Some(((_, method), step))) = (&self.scene, method) {
            let simulation = bumped.start(size, method.clone())?;
            return Ok(Some(PreparedRun {
                plan: Plan::new(*step, bumped.duration()),
                is_over: Box::new(|_| false),
                simulation,
            }));
        }
        let Some(scene) = self.file(size, start)? else {
            return Ok(None);
        };
        let setup = scene.setup()?;
        let facts = setup.facts.clone();
        let simulation = setup.start()?;
        let supports = SupportForces::new(facts, &simulation, scene.scene().support.len());
        let stop = scene.scene().stop.clone();
        Ok(Some(PreparedRun {
            plan: Plan::new(scene.frame(), scene.frames() as f64 * scene.frame()),
            is_over: Box::new(move |s| stop.is_force_reached(|| supports.of(s))),
            simulation,
        }))
    }
}
