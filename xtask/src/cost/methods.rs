//! The methods on two scenes that other programs have been measured on as well: a hanging sheet and a
//! tablecloth.

mod penetration;
mod report;
mod run;

use super::{DEFAULT, Record};
use crate::progress::Progress;
use crate::report::{Effort, Part as Excerpt};
use crate::runs::{Pairs, STEP, Work};
use crate::store::Files;
use anyhow::Result;
use isosheet_dynamics::{ImplicitOptions, Method, ProjectionStepOptions};
use isosheet_tests::{Named, energy_momentum, implicit_euler};
use maud::html;
use run::{Mesh, Run};

/// What the hanging sheet is, in words.
const HANGING: &str = "\
    Square sheet, side 1 m, union-jack mesh M^k, mass 0.1 kg lumped by thirds of the incident areas, \
    horizontal with z = 1e-3 sin(πx) sin(πy), rest lengths those of the start, corner (0, 1) pinned, \
    gravity 9.8 m/s², no bending stiffness, no contact, no damping, 1.0 s.";

/// What the tablecloth is, in words.
const TABLECLOTH: &str = "\
    The sheet of the hanging work, all vertices free, 1 mm above a square table of half its side (a \
    box), 1.5 s, without friction, by the methods that take contact with steps of 1/60 s; once without \
    and once with contact of the sheet with itself. That nothing penetrates is checked every tenth of a \
    second apart from the contact code: depth of every vertex in the box, and every edge against every \
    face of the box and, with self-contact, of the sheet. The energy of the barriers counts: where the \
    sheet starts within their reach they push it up at first.";

/// Page of the repository on what other programs took for the same scenes.
const ELSEWHERE: &str = "\
    What other programs took for this scene was measured elsewhere, and not by this command: see \
    docs/measured-elsewhere.md in the repository.";

/// One of the two scenes, the second one with two kinds of contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scene {
    Hanging,
    Tablecloth,
}

impl Scene {
    fn works(self) -> &'static [Work] {
        match self {
            Self::Hanging => &[Work::Hanging],
            Self::Tablecloth => &[
                Work::Tablecloth(Pairs::Table),
                Work::Tablecloth(Pairs::TableAndItself),
            ],
        }
    }

    /// The methods with their steps, seconds: for the tablecloth those that take contact.
    fn methods(self) -> Vec<(Named, f64)> {
        let default = (DEFAULT, Method::default());
        if self == Self::Tablecloth {
            return vec![
                (default, STEP),
                (("implicit Euler", implicit_euler()), STEP),
            ];
        }
        // For those who look at the sheet and do not compute with it.
        let quick = Method::Bdf2(ImplicitOptions {
            tolerance: 1e-3,
            strain_tolerance: 1e-9,
            ..Default::default()
        });
        let loose = Method::Projection(ProjectionStepOptions {
            strain_tolerance: 1e-9,
            ..Default::default()
        });
        let projection = ("projection, lengths to 1e-9", loose);
        vec![
            (default.clone(), STEP),
            (default, 5e-3),
            (("BDF2, lengths to 1e-9, decrement to 1e-3", quick), STEP),
            (projection.clone(), STEP),
            (projection, 5e-3),
            (("energy-momentum", energy_momentum()), 2e-3),
        ]
    }

    /// Runs the scene by all methods on all meshes.
    fn runs(self, name: &str, effort: Effort) -> Result<Vec<Run>> {
        let levels = effort.quick_or(1..=1, 1..=4);
        // Longest run, seconds of wall time.
        let patience = effort.pick(0.5, 30.0, 240.0);
        let (works, methods) = (self.works(), self.methods());
        let all = levels.clone().count() * works.len() * methods.len();
        let bar = Progress::start(name, all);
        let mut runs = Vec::new();
        for level in levels {
            let mesh = Mesh::of(level);
            for work in works {
                for (method, step) in methods.clone() {
                    runs.push(Run::of(*work, mesh, method, step, patience)?);
                    bar.step();
                }
            }
        }
        bar.finish(&format!("{} runs", runs.len()));
        Ok(runs)
    }
}

/// Makes the part of a scene.
pub(super) fn make(
    scene: Scene,
    name: &str,
    effort: Effort,
    files: &mut Files<'_>,
) -> Result<Record> {
    let runs = scene.runs(name, effort)?;
    let table = report::table(&runs).named(name);
    table.write(files)?;
    let columns = match scene {
        Scene::Hanging => report::IN_THE_BOOK.to_owned(),
        Scene::Tablecloth => format!("contact {} smallest_gap_m", report::IN_THE_BOOK),
    };
    let mut excerpt = vec![Excerpt::table(
        name,
        &table.select(&table.caption, &columns),
    )];
    if scene == Scene::Hanging {
        excerpt.push(Excerpt::table("default", &report::default(&runs)));
    }
    let title = match scene {
        Scene::Hanging => "The hanging sheet",
        Scene::Tablecloth => "The tablecloth",
    };
    let inside = html! {
        h2 { (title) }
        p { (if scene == Scene::Hanging { HANGING } else { TABLECLOTH }) }
        (table.select(&table.caption, report::SHOWN))
        p { (ELSEWHERE) }
    };
    Ok(Record {
        excerpt,
        findings: report::required(&runs),
        ..Record::new(name, inside)
    })
}
