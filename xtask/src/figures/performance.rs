//! Fig. 10: the paper's table of performance, with ours beside it.

use super::{Context, Effort, Made, Picture, Play, Table, cloths, crumple, drape, stamping};
use crate::report::{Cell, machine, rounded};
use crate::runs::{self, ChartSummary, Fate, FigureScene, RunSummary};
use anyhow::Result;
use isosheet_coords::condition_table;
use isosheet_io::scene::{Coordinates, Integrator};
use serde_json::json;

/// A row of the paper's table.
struct Published {
    figure: u8,
    /// Level of the mesh M^level on which the paper's own scheme is tried: scenes without obstacles.
    level: Option<u32>,
    mesh: &'static str,
    frames_per_second: &'static str,
    steps: &'static str,
}

impl Published {
    const fn new(figure: u8, level: Option<u32>, columns: [&'static str; 3]) -> Self {
        let [mesh, frames_per_second, steps] = columns;
        Self {
            figure,
            level,
            mesh,
            frames_per_second,
            steps,
        }
    }
}

const PUBLISHED: [Published; 5] = [
    Published::new(11, Some(1), ["25/32", "33.33", "50/250"]),
    Published::new(12, Some(2), ["81/128", "3.33", "18/150"]),
    Published::new(13, None, ["289/512", "0.152", "0.2/10"]),
    Published::new(14, None, ["81/128", "1.67", "2/150"]),
    Published::new(15, None, ["244/440", "0.435", "1.5/30"]),
];

/// Our run of a figure, with everything that it meets, and without contact of the sheet with itself.
fn runs_of(figure: u8, context: &Context<'_>) -> Result<[RunSummary; 2]> {
    let (store, effort) = (context.store, context.effort);
    let scene = match figure {
        11 | 12 => crumple::scene(u32::from(figure - 10), effort),
        13 => stamping::scene(effort),
        14 => cloths::rectangle(2, effort),
        _ => cloths::octagon(effort),
    }?;
    Ok([
        runs::ensure(store, &scene)?,
        runs::ensure(store, &free(figure, effort)?)?,
    ])
}

/// The scene of a figure without contact of the sheet with itself.
fn free(figure: u8, effort: Effort) -> Result<FigureScene> {
    match figure {
        11 | 12 => crumple::without_contact(u32::from(figure - 10), effort),
        13 => stamping::scene(effort)?.without_self_contact("stamping-free"),
        14 => cloths::rectangle(2, effort)?.without_self_contact("drape-m2-free"),
        _ => cloths::octagon(effort)?.without_self_contact("drape-octagon-free"),
    }
}

/// The pages of the runs without contact of the sheet with itself; Figs. 11 to 15 have those of the others.
fn pages(context: &Context<'_>) -> Result<Vec<Play>> {
    let effort = context.effort;
    Ok(vec![
        crumple::page(10, &free(11, effort)?, context)?,
        crumple::page(10, &free(12, effort)?, context)?,
        stamping::page(10, &free(13, effort)?, context)?,
        drape::page(10, "M²", &free(14, effort)?, context)?,
        drape::page(10, "244/440", &free(15, effort)?, context)?,
    ])
}

/// The paper's scheme on a mesh, with ever more help: the last one is the scene file.
fn variants(level: u32, effort: Effort) -> Result<[(&'static str, FigureScene); 6]> {
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
    Ok([
        (
            "published scheme, from exactly flat",
            scene(&[&published, &flat])?,
        ),
        ("the same, from slightly crumpled", scene(&[&published])?),
        (creases, scene(&straight)?),
        (coarser, scene(&with_coarse)?),
        (formed_anew, scene(&with_reformed)?),
        (
            "and positions projected, in a well-conditioned chart",
            scene(&[])?,
        ),
    ])
}

pub(super) fn make(context: &Context<'_>) -> Result<Made> {
    let mut rows = Vec::new();
    let mut facts = Vec::new();
    let mut contact = Vec::new();
    // Whether the scheme as published is refused at the start on all meshes.
    let mut refused = true;
    let patience = context.effort.quick_or(0.5, 60.0);
    for published in &PUBLISHED {
        let [ours, free] = runs_of(published.figure, context)?;
        rows.push(vec![
            format!("{}", published.figure),
            published.mesh.into(),
            "the paper, its computer".into(),
            published.frames_per_second.into(),
            published.steps.into(),
            String::new(),
        ]);
        let mesh = format!("{}/{}", ours.vertices, ours.faces);
        rows.push(default_row(&mesh, &ours));
        let mut chart = Vec::new();
        if let Some(level) = published.level {
            for (name, scene) in variants(level, context.effort)? {
                let title = format!("published scheme, M^{level}");
                let s = runs::chart_run(&title, &scene, patience)?;
                let chart_of_scene = scene.scene().method.chart.as_ref();
                if chart_of_scene.is_some_and(|c| c.coordinates == Coordinates::Front) {
                    refused &= matches!(s.fate, Fate::Refused { .. });
                }
                rows.push(chart_row(&mesh, name, &s));
                chart.push(serde_json::to_value(&s)?);
            }
        }
        facts.push(
            json!({ "figure": published.figure, "default": ours, "without_self_contact": free, "published_scheme": chart }),
        );
        contact.push((published.figure, ours, free));
    }
    let verdict = if refused {
        "As published, the scheme cannot start on either mesh: in the union jack every inner vertex of degree 4 keeps one of its creases \
         straight, which is the degenerate case of Fig. 7, flat or not. The rows below help it step by step until it runs. "
    } else {
        ""
    };
    let machine = machine();
    // Why the coordinates of the front do not carry far.
    let condition = condition_table(0..context.effort.quick_or(2, 5))?;
    let condition = crate::condition::plot(&condition);
    let alt = "Condition number of the mass matrix in the paper's coordinates and in chosen Cartesian ones, by mesh level";
    Ok(Made {
        title: "Performance".into(),
        paper: "Frames per second and step sizes of the examples, on a Pentium III at 937 MHz."
            .into(),
        measured: format!(
            "{verdict}A frame is the state of the sheet 1/60 s of simulated time after the one before; frames per second are frames over the \
             wall time of the steps on one core, without drawing and writing (the paper does not say how long its frames are). Our runs \
             include contact with obstacles and of the sheet with itself. \
             Machine: {machine}. The published scheme is forward Euler in the coordinates of the front with the mass matrix inverted \
             by Cramer's rule (n ≤ 16) or dense LU, linearised positions, and the largest step up to 250 ms that changes the Hamiltonian \
             by less than 0.1 % of the energy that a fall by half a side releases. Slightly crumpled: exactly flat plus random \
             displacements of up to 10 % of an edge, put back onto the edge lengths. The plot: condition number of the mass matrix of bent sheets; \
             beyond 1/ε nothing is left of a dense solve, whichever method is used."
        ),
        pictures: vec![Picture::svg("fig10-condition", &condition, alt)],
        pages: pages(context)?,
        tables: vec![
            Table::new(
                "Fig. 10: the paper's columns beside ours",
                &[
                    "Fig.",
                    "V/F",
                    "scheme",
                    "frames/s",
                    "step min/max (ms)",
                    "outcome",
                ],
            )
            .with_texts(rows),
            contact_table(&contact),
        ],
        facts: json!({ "machine": machine, "rows": facts }),
    })
}

fn milliseconds(range: [f64; 2]) -> String {
    let text = |s: f64| {
        let ms = 1e3 * s;
        if ms >= 10.0 {
            format!("{ms:.1}")
        } else if ms >= 0.1 {
            format!("{ms:.2}")
        } else {
            format!("{ms:.1e}")
        }
    };
    format!("{}/{}", text(range[0]), text(range[1]))
}

fn default_row(mesh: &str, s: &RunSummary) -> Vec<String> {
    vec![
        String::new(),
        mesh.into(),
        format!(
            "isosheet ({}), from exactly flat, with contact",
            crumple::method_name(Integrator::default())
        ),
        format!("{:.0}", s.frames_per_second),
        s.step_range.map_or("–".into(), milliseconds),
        format!(
            "{:.1} s, {} rejected steps, strain {:.0e}",
            s.time, s.rejected, s.max_strain
        ),
    ]
}

/// What the paper does not report of its runs: figure, run, and run without contact of the sheet with itself.
fn contact_table(runs: &[(u8, RunSummary, RunSummary)]) -> Table {
    let joules = |v: f64| -> Cell {
        if v == 0.0 {
            return "0".into();
        }
        format!("{v:.2e}").replace('-', "−").into()
    };
    let frames = |s: &RunSummary| s.frames.max(1) as f64;
    Table::of(
        "What the paper did not report. Slowness: seconds of wall time per simulated second, on one core, with and without contact of the sheet with \
                  itself (two different motions where it touches itself), and their ratio; a frame is 1/60 s; solves are Newton steps, each with a factorisation. \
                  Energies (J) at the end: potential energy released, work of the die, losses to damping and friction, and what the balance lacks: what \
                  the implicit steps take out of fast motion.",
        runs,
        &[
            ("Fig.", &|r| r.0.to_string().into()),
            ("V/F", &|r| format!("{}/{}", r.1.vertices, r.1.faces).into()),
            ("slowness", &|r| format!("{:.2}", r.1.slowness()).into()),
            ("without self-contact", &|r| {
                format!("{:.2}", r.2.slowness()).into()
            }),
            ("ratio", &|r| {
                let ratio = r.1.slowness() / r.2.slowness().max(1e-12);
                format!("{ratio:.1}").into()
            }),
            ("frame, solves in it", &|r| {
                let (step, solves) = (1e3 * r.1.wall, r.1.iterations as f64);
                let [step, solves] = [step, solves].map(|all| all / frames(&r.1));
                format!("{step:.1} ms, {solves:.0}").into()
            }),
            ("solves/s", &|r| {
                format!("{:.0}", r.1.solves_per_second()).into()
            }),
            ("largest strain", &|r| {
                format!("{:.0e}", r.1.max_strain).replace('-', "−").into()
            }),
            ("smallest gap", &|r| super::gap(r.1.smallest_gap).into()),
            ("released", &|r| joules(r.1.energy.released)),
            ("work", &|r| joules(r.1.energy.work)),
            ("damping", &|r| joules(r.1.energy.damped)),
            ("friction", &|r| joules(r.1.energy.friction)),
            ("drift", &|r| joules(r.1.energy.drift)),
        ],
    )
}

fn chart_row(mesh: &str, name: &str, s: &ChartSummary) -> Vec<String> {
    let outcome = match &s.fate {
        Fate::Finished => format!("{:.1} s, strain {:.0e}", s.time, s.max_strain),
        Fate::Refused { reason } => format!("refused at t = 0: {}", rounded(reason)),
        Fate::Stopped { t, reason } => format!(
            "stopped at t = {t:.3} s, strain {:.0e}: {}",
            s.max_strain,
            rounded(reason)
        ),
        Fate::OutOfPatience { t } => {
            format!(
                "given up at t = {t:.3} s after {:.0} s of wall time, strain {:.0e}",
                s.wall, s.max_strain
            )
        }
    };
    vec![
        String::new(),
        mesh.into(),
        name.into(),
        if s.steps > 0 {
            format!("{:.2}", s.frames_per_second)
        } else {
            "–".into()
        },
        s.step_range.map_or("–".into(), milliseconds),
        outcome,
    ]
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
