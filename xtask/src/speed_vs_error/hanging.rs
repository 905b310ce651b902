//! A work that other programs have been measured on as well: the hanging sheet.

use super::scheme::DEFAULT;
use crate::methods::{Named, energy_momentum};
use crate::progress::Progress;
use crate::report::{Effort, Table, percent};
use crate::runs::unseen;
use crate::timing::{self, Entry, Limits, Measured, Mesh, Work};
use anyhow::Result;
use isosheet_dynamics::{ImplicitOptions, Method, ProjectionStepOptions};
use std::fmt::Write;

/// What the work is, in words.
pub(crate) const ABOUT: &str = "Square sheet, side 1 m, union-jack mesh M^k, mass 0.1 kg lumped by thirds of the incident areas, horizontal with \
    z = 1e-3 sin(πx) sin(πy), rest lengths those of the start, corner (0, 1) pinned, gravity 9.8 m/s², no bending stiffness, no contact, no \
    damping, 1.0 s.";

/// Name of the method that conserves energy.
const CONSERVATIVE: &str = "energy-momentum";

/// The methods and steps of the work.
fn methods() -> [(Named, f64); 6] {
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
    let loose_bdf2 = "BDF2, lengths to 1e-9, decrement to 1e-3";
    let loose_projection = "projection, lengths to 1e-9";
    [
        ((DEFAULT, Method::default()), 1.0 / 60.0),
        ((DEFAULT, Method::default()), 5e-3),
        ((loose_bdf2, quick), 1.0 / 60.0),
        ((loose_projection, loose.clone()), 1.0 / 60.0),
        ((loose_projection, loose), 5e-3),
        ((CONSERVATIVE, energy_momentum()), 2e-3),
    ]
}

/// Runs the work on all meshes.
pub(crate) fn make(effort: Effort) -> Result<Vec<Measured>> {
    let levels = 1..=effort.quick_or(1, 4);
    // Longest run, seconds of wall time.
    let patience = effort.pick(0.3, 20.0, 240.0);
    let bar = Progress::start("hanging sheet", levels.clone().count() * methods().len());
    let mut rows = Vec::new();
    for level in levels {
        let mesh = Mesh::measured(level)?;
        for method in methods() {
            rows.push(measure(mesh, method, patience)?);
            bar.step();
        }
    }
    bar.finish(&format!("{} runs", rows.len()));
    Ok(rows)
}

fn measure(mesh: Mesh, (method, step): (Named, f64), patience: f64) -> Result<Measured> {
    let limits = Limits {
        patience,
        short: 0.1 * patience,
    };
    Measured::of(Work::Hanging, mesh, method, (1, step), limits, &mut unseen)
}

/// All runs.
pub(super) fn table(rows: &[Measured]) -> Table {
    timing::table(
        "Hanging sheet: wall seconds for a simulated second on one core, as multiples of the fastest run on the mesh that keeps lengths to \
         1e-9 and of one factorisation a step; largest relative edge length error, energy balance at the end as part of the potential \
         energy released (negative: lost), and its largest change on the way",
        &rows.iter().collect::<Vec<_>>(),
        &|r| {
            rows.iter()
                .filter(|o| of_one_mesh(r, o))
                .map(entry)
                .collect()
        },
    )
}

/// The runs of the default with its default step, for the README.
pub(super) fn default(rows: &[Measured]) -> Table {
    let ((method, _), step) = &methods()[0];
    let is_default = |r: &&Measured| r.method == *method && r.step == *step;
    Table::of(
        "A square sheet that hangs by a corner and moves for one second, in steps of 1/60 s on one core.",
        rows.iter().filter(is_default),
        &[
            ("vertices", &|r| r.mesh.vertices.into()),
            ("wall time, s", &|r| r.course.cost.wall.into()),
            ("largest relative error of a length", &|r| {
                r.course.strain.into()
            }),
            ("change of energy, part of that released", &|r| {
                r.balance().into()
            }),
        ],
    )
}

fn of_one_mesh(a: &Measured, b: &Measured) -> bool {
    a.mesh.level == b.mesh.level
}

/// What the rows say.
pub(crate) fn conclusions(rows: &[Measured]) -> Vec<String> {
    let finished: Vec<&Measured> = rows.iter().filter(|r| r.course.is_good()).collect();
    let mut all = Vec::new();
    if let Some(strain) = finished.iter().map(|r| r.course.strain).reduce(f64::max) {
        all.push(format!(
            "{} of {} runs of the hanging sheet came to the end; none of these strains an edge by more than {strain:.0e}.",
            finished.len(),
            rows.len()
        ));
    }
    for mesh in rows.chunk_by(of_one_mesh) {
        let name = mesh[0].mesh();
        let here = || mesh.iter().filter(|r| r.course.is_good());
        let damped = here()
            .filter(|r| r.method != CONSERVATIVE)
            .min_by(|a, b| a.course.cost.wall.total_cmp(&b.course.cost.wall));
        let mut text = match damped {
            Some(r) => format!(
                "{name}: the cheapest damped run is {} at {:.1} ms, {} s/s with strain {:.0e}",
                r.method,
                1e3 * r.step,
                r.rate(),
                r.course.strain
            ),
            None => format!("{name}: no damped run came to the end"),
        };
        match here().find(|r| r.method == CONSERVATIVE) {
            Some(r) => {
                let _ = write!(
                    text,
                    "; the conservative one takes {} s/s and keeps the energy to {:.0e}.",
                    r.rate(),
                    r.relative_drift()
                );
            }
            None => text.push_str("; the conservative one did not come to the end."),
        }
        all.push(text);
    }
    let gain = |r: &&Measured| {
        let (method, mesh, step) = (&r.method, r.mesh(), 1e3 * r.step);
        format!(
            "{method} on {mesh} at {step:.1} ms by {}",
            percent(r.balance())
        )
    };
    let gains = finished.iter().filter(|r| r.balance() > GAIN).map(gain);
    let gains: Vec<String> = gains.collect();
    if !gains.is_empty() {
        all.push(format!(
            "These runs end with more energy than they started with, as part of the energy released: {}.",
            gains.join("; ")
        ));
    }
    all
}

/// How the runs on each mesh compare in time.
pub(crate) fn comparisons(rows: &[Measured]) -> Vec<String> {
    rows.chunk_by(of_one_mesh)
        .map(|mesh| {
            let scene = format!("Hanging sheet {}", mesh[0].mesh());
            timing::words(&scene, &entries(mesh))
        })
        .collect()
}

fn entry(r: &Measured) -> Entry {
    r.entry(format!("{} at {:.1} ms", r.method, 1e3 * r.step))
}

fn entries(mesh: &[Measured]) -> Vec<Entry> {
    mesh.iter().map(entry).collect()
}

/// Gain of energy, as part of the potential energy released, that is worth a word.
const GAIN: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Cell;

    #[test]
    fn the_coarsest_mesh_hangs_and_comparisons_follow_the_numbers() {
        let mut row = measure(Mesh::measured(1).unwrap(), methods()[0].clone(), 1.0).unwrap();
        let course = &mut row.course;
        assert!(course.is_good() && (course.time - 1.0).abs() < 1e-9);
        assert!(course.strain < 1e-11 && course.cost.factorisations > 60);
        course.cost.wall = 0.6 * course.time;
        row.mesh.factorisation = 0.1 * row.step;
        let mut other = row.clone();
        other.method = CONSERVATIVE.into();
        other.course.cost.wall *= 3.0;
        let mut finer = row.clone();
        finer.mesh.level = 2;
        let all = [row, other, finer];
        assert!(conclusions(&all)[1].starts_with("M^1: the cheapest damped run is BDF2"));
        let text = comparisons(&all);
        assert_eq!(text.len(), 2, "one for each mesh");
        for part in [
            "BDF2 (default) at 16.7 ms: 0.60 s/s, 6.0 times the 0.10 s/s of one factorisation",
            "energy-momentum at 16.7 ms takes 3.0 times as long, 18 times one factorisation",
        ] {
            assert!(text[0].contains(part), "{part} is missing in {text:?}");
        }
        let table = table(&all);
        let Cell::Number(times) = table.rows[1][9] else {
            panic!("{table:?}")
        };
        assert!((times - 3.0).abs() < 1e-9);
        let csv = String::from_utf8(table.csv().unwrap()).unwrap();
        assert!(
            csv.contains("hanging sheet,,M^1,25,BDF2 (default),"),
            "{csv}"
        );
    }
}
