//! Fig. 10: the paper's table of performance, with ours beside it.

use super::{Effort, Made, Picture, Table, cloths, crumple, stamping};
use crate::report::{machine, rounded};
use crate::runs::{
    self, ChartSummary, Course, Ending, FigureScene, Run, RunSummary, Spread, members,
};
use crate::store::Store;
use anyhow::{Result, ensure};
use isosheet_coords::condition_table;
use isosheet_scenes::Coordinates;

/// A row of the paper's table.
type Published = (u8, Option<u32>, [&'static str; 3]);

/// Figure, level of the mesh M^level on which the paper's own scheme is tried (in scenes without obstacles),
/// and the paper's mesh, frames per second and steps.
const PUBLISHED: [Published; 5] = [
    (11, Some(1), ["25/32", "33.33", "50/250"]),
    (12, Some(2), ["81/128", "3.33", "18/150"]),
    (13, None, ["289/512", "0.152", "0.2/10"]),
    (14, None, ["81/128", "1.67", "2/150"]),
    (15, None, ["244/440", "0.435", "1.5/30"]),
];

/// Parts of a mean edge length by which vertices are displaced in the plane of the sheet: the paper's remedy
/// for straight creases (its Fig. 7).
const JITTERS: [(f64, &str); 3] = [
    (
        0.01,
        "the same, vertices moved in the plane by up to 1 % of an edge",
    ),
    (0.05, "the same, by up to 5 %"),
    (0.2, "the same, by up to 20 %"),
];

/// The scene of a figure, with everything that the sheet meets.
fn ours(figure: u8, effort: Effort) -> Result<FigureScene> {
    match figure {
        11 | 12 => crumple::scene(u32::from(figure - 10), effort),
        13 => stamping::scene(effort),
        14 => cloths::rectangle(2, effort),
        _ => cloths::octagon(effort),
    }
}

/// A form of the paper's scheme, and its scenes: one, or an ensemble of meshes.
type Variant<T> = (&'static str, Vec<T>);

/// The paper's scheme on a mesh, with ever more help: the last one is the scene file.
fn variants(level: u32, effort: Effort) -> Result<Vec<Variant<FigureScene>>> {
    let published = [
        "method.chart.coordinates=front",
        "method.chart.equations=published",
        "method.chart.positions=linear",
        "method.chart.singular=refuse",
    ];
    let flat = ["sheet.start.perturbation=0.0"];
    let free_creases = ["method.chart.coordinates=front_with_straight_creases"];
    // Half the energy that a fall by half a side releases: this takes steps of the size that the paper
    // reports.
    let coarse = ["method.chart.substep.adaptive.tolerance=1.815156e-3"];
    let reformed = ["method.chart.equations=reformed"];
    let scene = |edits: &[&[&str]]| {
        let mut all: Vec<String> = edits.concat().iter().map(|e| (*e).to_owned()).collect();
        if level != 1 {
            all.push(format!("sheet.mesh.square.level={level}"));
            // Cramer's rule is used for the 16 coordinates of M^1 alone.
            all.push("method.chart.solver=dense_lu".to_owned());
        }
        if effort == Effort::Quick {
            all.push("stop.time=0.2".to_owned());
        }
        FigureScene::of("fig10", "chart", &all)
    };
    let creases = "and a coordinate for every straight crease (Fig. 7)";
    let coarser = "the same, ε = 50 % (steps of the paper's size)";
    let formed_anew = "ε = 0.1 %, and momenta formed anew at each step";
    let straight: [&[&str]; 2] = [&published, &free_creases];
    let [with_coarse, with_reformed] =
        [&coarse, &reformed].map(|last| [straight[0], straight[1], last]);
    let crumpled = scene(&[&published])?;
    let mut all = vec![
        (
            "published scheme, from exactly flat",
            vec![scene(&[&published, &flat])?],
        ),
        ("the same, from slightly crumpled", vec![crumpled.clone()]),
    ];
    for (part, name) in JITTERS {
        let seeds = 1..=members(effort) as u64;
        let meshes = seeds.map(|seed| crumpled.jittered("chart", part, seed));
        all.push((name, meshes.collect::<Result<_>>()?));
    }
    all.extend([
        (creases, vec![scene(&straight)?]),
        (coarser, vec![scene(&with_coarse)?]),
        (formed_anew, vec![scene(&with_reformed)?]),
        (
            "and positions projected, in a well-conditioned chart",
            vec![scene(&[])?],
        ),
    ]);
    Ok(all)
}

/// The runs of a row of the paper's table.
struct Tried {
    figure: u8,
    /// The paper's mesh, frames per second and steps.
    published: [&'static str; 3],
    ours: RunSummary,
    /// The paper's scheme with ever more help.
    charts: Vec<Variant<ChartSummary>>,
}

impl Tried {
    fn of(&(figure, level, published): &Published, store: &Store) -> Result<Self> {
        let effort = store.effort;
        let patience = effort.quick_or(0.5, 60.0);
        let mut charts = Vec::new();
        if let Some(level) = level {
            let title = format!("published scheme, M^{level}");
            for (name, scenes) in variants(level, effort)? {
                let runs = scenes.iter();
                let runs = runs.map(|scene| runs::chart_run(&title, scene, patience));
                charts.push((name, runs.collect::<Result<_>>()?));
            }
        }
        Ok(Self {
            figure,
            published,
            ours: Run::of(store, ours(figure, effort)?)?.summary,
            charts,
        })
    }

    /// Whether the scheme as published was refused at the start on the meshes as they are, and did not reach
    /// the end on any of those with the paper's remedy, if it was tried.
    fn is_published_stuck(&self) -> bool {
        self.charts.iter().all(|(name, all)| {
            let is_jittered = JITTERS.iter().any(|(_, jittered)| jittered == name);
            all.iter().all(|s| {
                let chart = s.run.scene().method.chart.as_ref();
                let is_published = chart.is_some_and(|c| c.coordinates == Coordinates::Front);
                match (is_published, is_jittered) {
                    (true, false) => is_refused(&s.course),
                    (true, true) => !s.course.is_good(),
                    (false, _) => true,
                }
            })
        })
    }

    /// Rows of the table: the paper's, ours, and the paper's scheme.
    fn rows(&self) -> Vec<Vec<String>> {
        let [mesh, rate, steps] = self.published;
        let figure = self.figure.to_string();
        let paper = [&figure, mesh, "the paper, its computer", rate, steps, ""].map(str::to_owned);
        let mesh = self.ours.mesh();
        let charts = self.charts.iter();
        [paper, default_row(&mesh, &self.ours)]
            .into_iter()
            .chain(charts.map(|(name, all)| chart_row(&mesh, name, all)))
            .map(Vec::from)
            .collect()
    }
}

/// Whether a run was refused at its start.
fn is_refused(course: &Course) -> bool {
    !course.is_good() && course.cost.steps == 0
}

/// What the rows of the table are.
const ABOUT: &str = "Fig. 10: the paper's columns beside ours. A frame is the state of the sheet 1/60 s of simulated time after the one before; \
                     frames per second are frames over the wall time of the steps on one core, without drawing and writing (the paper does not say \
                     how long its frames are). Our runs include contact with obstacles and of the sheet with itself. The published scheme is forward \
                     Euler in the coordinates of the front with the mass matrix inverted by Cramer's rule (n ≤ 16) or dense LU, linearised positions, \
                     and the largest step up to 250 ms that changes the Hamiltonian by less than 0.1 % of the energy that a fall by half a side \
                     releases; each row helps it more. Where vertices are moved in the plane, numbers are medians, leasts and greatests of ensembles of meshes. Slightly crumpled: exactly flat plus random displacements of up to 10 % of an edge, put \
                     back onto the edge lengths.";

pub(super) fn make(store: &Store) -> Result<Made> {
    let all = PUBLISHED
        .iter()
        .map(|published| Tried::of(published, store));
    let all: Vec<Tried> = all.collect::<Result<_>>()?;
    ensure!(
        all.iter().all(Tried::is_published_stuck),
        "the scheme as published was not refused at the start, or ran to the end on a mesh without straight creases"
    );
    let head = [
        "Fig.",
        "V/F",
        "scheme",
        "frames/s",
        "step min/max (ms)",
        "outcome",
    ];
    let machine = machine();
    let table = Table::new(format!("{ABOUT} Machine: {machine}."), &head);
    // Why the coordinates of the front do not carry far.
    let condition = condition_table(0..store.effort.quick_or(2, 5))?;
    let condition = crate::condition::plot(&condition);
    let alt = "Condition number of the mass matrix in the paper's coordinates and in chosen Cartesian ones, by mesh level";
    Ok(Made {
        title: "Performance",
        paper: "Frames per second and step sizes of the examples, on a Pentium III at 937 MHz.",
        here: "As published, the scheme cannot start on either mesh as it is, as inner vertices of degree 4 keep one crease straight \
               (Fig. 7); with vertices moved in the plane of the sheet, the paper's remedy, no run of the ensembles reaches the end. Condition numbers are of the mass matrix of bent sheets: beyond 1/ε nothing is left of a dense solve.",
        pictures: vec![Picture::svg("fig10-condition", &condition, alt)],
        tables: vec![table.with_texts(all.iter().flat_map(Tried::rows))],
        ..Made::default()
    })
}

fn milliseconds(range: [f64; 2]) -> String {
    let text = |s: f64| match 1e3 * s {
        ms if ms >= 10.0 => format!("{ms:.1}"),
        ms if ms >= 0.1 => format!("{ms:.2}"),
        ms => format!("{ms:.1e}"),
    };
    range.map(text).join("/")
}

fn default_row(mesh: &str, s: &RunSummary) -> [String; 6] {
    let Course {
        time, strain, cost, ..
    } = &s.course;
    [
        String::new(),
        mesh.into(),
        "isosheet (BDF2), from exactly flat, with contact".to_owned(),
        format!("{:.0}", s.frames_per_second),
        s.step_range.map_or("–".into(), milliseconds),
        format!(
            "{time:.1} s, {} rejected steps, strain {strain:.0e}",
            cost.rejected
        ),
    ]
}

fn chart_row(mesh: &str, name: &str, all: &[ChartSummary]) -> [String; 6] {
    let outcome = match all {
        [one] => outcome(&one.course),
        _ => outcomes(all),
    };
    let started = || all.iter().filter(|s| s.course.cost.steps > 0);
    let steps = started().filter_map(|s| s.step_range);
    let steps = steps.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
    let rate = Spread::of(started().map(|s| s.frames_per_second));
    [
        String::new(),
        mesh.into(),
        name.into(),
        match steps {
            Some(_) => rate.text(|r| format!("{r:.2}")),
            None => "–".into(),
        },
        steps.map_or("–".into(), milliseconds),
        outcome,
    ]
}

/// How a run ended.
fn outcome(course: &Course) -> String {
    let (t, strain) = (course.time, course.strain);
    match &course.ending {
        Ending::Error { message, .. } if is_refused(course) => {
            format!("refused at t = 0: {}", rounded(message))
        }
        Ending::Error { message, .. } => {
            let reason = rounded(message);
            format!("stopped at t = {t:.3} s, strain {strain:.0e}: {reason}")
        }
        Ending::CpuTime(_) => {
            let cpu = course.cost.cpu;
            format!("given up at t = {t:.3} s after {cpu:.0} s of CPU time, strain {strain:.0e}")
        }
        _ => format!("{t:.1} s, strain {strain:.0e}"),
    }
}

/// How the runs of an ensemble ended: how many in which way, and when.
fn outcomes(all: &[ChartSummary]) -> String {
    let courses = || all.iter().map(|s| &s.course);
    let parts = [
        (
            "refused at t = 0",
            courses().filter(|c| is_refused(c)).collect(),
        ),
        ("stopped", courses().filter(|c| is_stopped(c)).collect()),
        ("given up", courses().filter(|c| is_given_up(c)).collect()),
        (
            "at the end",
            courses().filter(|c| c.is_good()).collect::<Vec<_>>(),
        ),
    ];
    let parts = parts.iter().filter(|(_, some)| !some.is_empty());
    let parts = parts.map(|(how, some)| {
        let number = format!("{} of {} {how}", some.len(), all.len());
        let times = Spread::of(some.iter().map(|c| c.time));
        match times.range {
            [0.0, 0.0] => number,
            _ => format!("{number}, t = {} s", times.text(|t| format!("{t:.3}"))),
        }
    });
    parts.collect::<Vec<_>>().join("; ")
}

/// Whether a run began and could not go on.
fn is_stopped(course: &Course) -> bool {
    matches!(course.ending, Ending::Error { .. }) && !is_refused(course)
}

/// Whether a run took too long.
fn is_given_up(course: &Course) -> bool {
    matches!(course.ending, Ending::CpuTime(_))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_in_milliseconds() {
        assert_eq!(milliseconds([1e-6, 0.25]), "1.0e-3/250.0");
        assert_eq!(milliseconds([2.2e-4, 0.0179]), "0.22/17.9");
    }
}
