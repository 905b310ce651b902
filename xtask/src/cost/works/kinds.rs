//! The kinds of runs.

use super::penetration::Checker;
use crate::cost::DEFAULT;
use crate::report::Effort;
use crate::runs::{Bumped, FigureScene, Pairs, Plan, STEP, displaced};
use anyhow::Result;
use isosheet_dynamics::{ImplicitOptions, Method, ProjectionStepOptions, Simulation};
use isosheet_io::scene::SupportForces;
use isosheet_tests::{Named, energy_momentum, implicit_euler};
use std::path::Path;

/// A kind of run, at several sizes.
#[derive(Debug)]
pub(in crate::cost) struct Work {
    /// Its name on the command line and in tables.
    pub(super) name: &'static str,
    /// What happens, for people.
    pub(super) title: &'static str,
    pub(super) scene: Scene,
    /// Edits of a scene file besides those of the size and of the start.
    edits: &'static [&'static str],
    /// The keys that are the size.
    keys: &'static [&'static str],
    /// Sizes of quick runs, of standard ones, and of full ones.
    sizes: [&'static [u32]; 3],
    /// Random displacements of the start as a part of the mean edge length.
    perturbation: f64,
    pub(super) threads: &'static [usize],
}

/// What a run is made of.
#[derive(Clone, Copy, Debug)]
pub(super) enum Scene {
    /// A file of `xtask/scenes`, or a kind of `isosheet new`.
    File(&'static str),
    /// A scene that other programs have been measured on, by several methods.
    Elsewhere(Bumped),
}

/// A method with its step, seconds.
pub(super) type Stepped = (Named, f64);

/// A run before its first step.
pub(super) struct Start {
    pub(super) simulation: Simulation,
    pub(super) plan: Plan,
    /// Whether the scene ends before.
    pub(super) is_over: Box<dyn Fn(&Simulation) -> bool + Send>,
    /// The check beside the contact code that nothing is penetrated.
    pub(super) checker: Option<Checker>,
}

const LEVEL: &[&str] = &["sheet.mesh.square.level"];
const SQUARES: [&[u32]; 3] = [&[2], &[2, 3, 4], &[2, 3, 4, 5]];
const SMALL_SQUARES: [&[u32]; 3] = [&[1], &[1, 2, 3, 4], &[1, 2, 3, 4]];

/// The crane's mesh in the folder that `ISOSHEET_DATA` names: a crease pattern of the folder is no part of
/// the repository.
const CRANE: &str = "fold/crane_rabbitear.fold";

/// All of them.
pub(super) static WORKS: &[Work] = &[
    // From a random displacement ten times as large 4225 vertices have no way back to their lengths.
    single("w1", "square of rods hangs by a corner", "cost-hanging")
        .sized(LEVEL, SQUARES)
        .displaced(1e-4),
    single(
        "w1e",
        "elastic square hangs by a corner",
        "cost-hanging-elastic",
    )
    .sized(LEVEL, SQUARES),
    single("w2", "square of rods falls flat on a table", "cost-table")
        .sized(LEVEL, [&[2], &[2, 3, 4], &[2, 3, 4]]),
    single(
        "w2e",
        "elastic square falls flat on a table",
        "cost-table-elastic",
    )
    .sized(LEVEL, SQUARES),
    single("star", "star of rods falls on a ball", "cost-star"),
    single("disk", "disk of rods falls on a ball", "cost-disk"),
    single("jam", "strip of paper jams in a guide", "fig16").displaced(1e-4),
    single("stamping", "die punches a blank", "fig13").displaced(1e-4),
    single("crane", "crane is folded flat", "fold").edited(&[
        "sheet.mesh={file={path=\"CRANE\",polygons=\"triangulate\",scale=0.15}}",
        "crease[0].angle.smooth_step.to=175.0",
        "contact={self_contact=true,friction=0.3}",
    ]),
    single(
        "annulus",
        "annulus of paper is folded along a curved crease",
        "cost-annulus",
    ),
    single("miura", "Miura's pattern is folded", "fig17")
        .sized(
            &["sheet.mesh.miura.columns", "sheet.mesh.miura.rows"],
            [&[10], &[42], &[42]],
        )
        .displaced(1e-4),
    single(
        "turnover",
        "gravity on a hanging elastic sheet is turned over",
        "cost-turnover",
    )
    .sized(
        &["sheet.mesh.rectangle.columns", "sheet.mesh.rectangle.rows"],
        [&[32], &[32], &[32, 64, 128]],
    ),
    Work {
        threads: &[1, 2],
        ..single("ball", "plastic film drapes over a ball", "cost-ball")
            .sized(&["sheet.mesh.disk.rings"], [&[14], &[28], &[28, 57]])
    },
    elsewhere("hanging", "hanging sheet", Bumped::Hanging),
    elsewhere(
        "tablecloth",
        "tablecloth, table",
        Bumped::Tablecloth(Pairs::Table),
    ),
    elsewhere(
        "tablecloth-itself",
        "tablecloth, table and itself",
        Bumped::Tablecloth(Pairs::TableAndItself),
    ),
];

/// A scene file of one size on one thread.
pub(super) const fn single(name: &'static str, title: &'static str, file: &'static str) -> Work {
    Work {
        name,
        title,
        scene: Scene::File(file),
        edits: &[],
        keys: &[],
        sizes: [&[0]; 3],
        perturbation: 1e-3,
        threads: &[1],
    }
}

/// A scene that other programs have been measured on.
const fn elsewhere(name: &'static str, title: &'static str, scene: Bumped) -> Work {
    Work {
        scene: Scene::Elsewhere(scene),
        ..single(name, title, "").sized(LEVEL, SMALL_SQUARES)
    }
}

impl Work {
    const fn sized(self, keys: &'static [&'static str], sizes: [&'static [u32]; 3]) -> Self {
        Self {
            keys,
            sizes,
            ..self
        }
    }

    pub(super) const fn edited(self, edits: &'static [&'static str]) -> Self {
        Self { edits, ..self }
    }

    const fn displaced(self, perturbation: f64) -> Self {
        Self {
            perturbation,
            ..self
        }
    }

    /// The sizes that an effort has time for, smallest first.
    pub(super) fn sizes(&self, effort: Effort) -> &'static [u32] {
        let [quick, standard, full] = self.sizes;
        effort.pick(quick, standard, full)
    }

    /// A size in words; empty where there is one only.
    pub(super) fn size_name(&self, size: u32) -> String {
        match self.keys {
            [] => String::new(),
            keys if keys == LEVEL => format!("M^{size}"),
            _ => size.to_string(),
        }
    }

    /// The methods by which a scene is run that is not a file: for the tablecloth those that take contact. A
    /// file names its own.
    pub(super) fn methods(&self) -> Vec<Option<Stepped>> {
        let default = (DEFAULT, Method::default());
        let bumped = match self.scene {
            Scene::File(_) => return vec![None],
            Scene::Elsewhere(bumped) => bumped,
        };
        if let Bumped::Tablecloth(_) = bumped {
            let euler = ("implicit Euler", implicit_euler());
            return vec![Some((default, STEP)), Some((euler, STEP))];
        }
        // For those who look at the sheet and do not compute with it.
        let quick = Method::Bdf2(ImplicitOptions {
            tolerance: 1e-3,
            strain_tolerance: 1e-9,
            ..Default::default()
        });
        let quick = ("BDF2, lengths to 1e-9, decrement to 1e-3", quick);
        let loose = Method::Projection(ProjectionStepOptions {
            strain_tolerance: 1e-9,
            ..Default::default()
        });
        let loose = ("projection, lengths to 1e-9", loose);
        let stepped = [
            (default.clone(), STEP),
            (default, 5e-3),
            (quick, STEP),
            (loose.clone(), STEP),
            (loose, 5e-3),
            (("energy-momentum", energy_momentum()), 2e-3),
        ];
        stepped.map(Some).to_vec()
    }

    /// The edits of a size, as `isosheet simulate --set` takes them.
    fn edits(&self, size: u32) -> impl Iterator<Item = String> {
        let fixed = self.edits.iter().map(|&edit| edit.to_owned());
        fixed.chain(self.keys.iter().map(move |key| format!("{key}={size}")))
    }

    /// The scene file with the edits that make it the row of the table, for people.
    pub(super) fn command(&self, size: u32) -> Option<String> {
        let Scene::File(file) = self.scene else {
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
        let Scene::File(file) = self.scene else {
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
        FigureScene::named(file, self.name, &edits).map(Some)
    }

    /// The run from one of its starts, by number; those of scenes that are no files are alike. `None` if the
    /// mesh is a file that is not there.
    ///
    /// # Errors
    /// Values of which no simulation can be made.
    pub(super) fn start(
        &self,
        size: u32,
        method: Option<&Stepped>,
        start: u64,
    ) -> Result<Option<Start>> {
        if let (Scene::Elsewhere(bumped), Some(((_, method), step))) = (self.scene, method) {
            let simulation = bumped.start(size, method.clone())?;
            let topology = simulation.model().topology();
            let checker = match bumped {
                Bumped::Hanging => None,
                Bumped::Tablecloth(pairs) => Some(Checker::new(topology, pairs)?),
            };
            return Ok(Some(Start {
                checker,
                plan: Plan::new(*step, bumped.duration()),
                is_over: Box::new(|_| false),
                simulation,
            }));
        }
        let Some(scene) = self.file(size, start)? else {
            return Ok(None);
        };
        let setup = scene.setup()?;
        let origins = setup.origins.clone();
        let simulation = setup.start()?;
        let supports = SupportForces::new(origins, &simulation, scene.scene().support.len());
        let stop = scene.scene().stop.clone();
        Ok(Some(Start {
            checker: None,
            plan: Plan::new(scene.frame(), scene.frames() as f64 * scene.frame()),
            is_over: Box::new(move |s| stop.is_force_reached(|| supports.of(s))),
            simulation,
        }))
    }
}
