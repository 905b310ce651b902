//! A work that other programs have been measured on as well: the hanging sheet.

use super::scheme::DEFAULT;
use crate::methods::{Named, energy_momentum};
use crate::progress::Progress;
use crate::report::{Effort, Table, percent};
use crate::timing::{self, COLUMNS, Entry, Measured, Mesh, Work};
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
    let levels = 1..=effort.hanging_level();
    let bar = Progress::start("hanging sheet", levels.clone().count() * methods().len());
    let mut rows = Vec::new();
    for level in levels {
        let mesh = Mesh::measured(level)?;
        for method in methods() {
            rows.push(measure(mesh, method, effort.hanging())?);
            bar.step();
        }
    }
    bar.finish(&format!("{} runs", rows.len()));
    Ok(rows)
}

fn measure(mesh: Mesh, (method, step): (Named, f64), patience: f64) -> Result<Measured> {
    let limits = [patience, 0.1 * patience];
    Measured::of(
        Work::Hanging,
        mesh,
        method,
        (1, step),
        limits,
        &mut |_, _| {},
    )
}

/// All runs, for programs.
pub(crate) fn data(rows: &[Measured]) -> Table {
    Table::of(
        "",
        rows,
        &[
            ("mesh", &|r| r.mesh().into()),
            ("method", &|r| r.method.as_str().into()),
            ("step_s", &|r| r.step.into()),
            ("wall_s_per_simulated_s", &|r| r.run.rate().into()),
            ("strain", &|r| r.run.strain.into()),
            ("energy_balance", &|r| r.run.balance().into()),
            ("largest_energy_change", &|r| r.run.relative_drift().into()),
            ("factorisations", &|r| r.run.cost.factorisations.into()),
            ("steps", &|r| r.run.cost.substeps.into()),
            ("rejected", &|r| r.run.cost.rejected.into()),
            ("factorisation_s", &|r| r.factorisation.into()),
            ("reached_s", &|r| r.run.reached.into()),
            ("repetitions", &|r| r.run.repetitions.into()),
            ("failure", &|r| r.run.failure.clone().into()),
        ],
    )
}

/// The table for people.
pub(crate) fn table(rows: &[Measured]) -> Table {
    let rows = rows.chunk_by(|a, b| a.level == b.level).flat_map(|mesh| {
        let entries = entries(mesh);
        let with = move |r| (r, entry(r).cells(&entries));
        mesh.iter().map(with)
    });
    Table::of(
        "Hanging sheet: wall seconds for a simulated second on one core, as multiples of the fastest run on the mesh that keeps lengths to \
         1e-9 and of one factorisation a step; largest relative edge length error, energy balance at the end as part of the potential \
         energy released (negative: lost), and its largest change on the way",
        rows,
        &[
            ("mesh", &|(r, _)| r.mesh().into()),
            ("method", &|(r, _)| r.method.as_str().into()),
            ("step (ms)", &|(r, _)| format!("{:.1}", 1e3 * r.step).into()),
            ("s/s", &|(r, _)| r.rate().into()),
            (COLUMNS[0], &|(_, c)| c[0].as_str().into()),
            (COLUMNS[1], &|(_, c)| c[1].as_str().into()),
            ("strain", &|(r, _)| format!("{:.0e}", r.run.strain).into()),
            ("energy", &|(r, _)| percent(r.run.balance()).into()),
            ("largest change", &|(r, _)| {
                percent(r.run.relative_drift()).into()
            }),
            ("factorisations", &|(r, _)| r.run.cost.factorisations.into()),
            ("steps", &|(r, _)| r.run.cost.substeps.into()),
            ("rejected", &|(r, _)| r.run.cost.rejected.into()),
            ("remark", &|(r, _)| r.remark().into()),
        ],
    )
}

/// What the rows say.
pub(crate) fn conclusions(rows: &[Measured]) -> Vec<String> {
    let finished: Vec<&Measured> = rows.iter().filter(|r| r.run.ended()).collect();
    let mut all = Vec::new();
    if let Some(strain) = finished.iter().map(|r| r.run.strain).reduce(f64::max) {
        all.push(format!(
            "{} of {} runs of the hanging sheet came to the end; none of these strains an edge by more than {strain:.0e}.",
            finished.len(),
            rows.len()
        ));
    }
    let mut levels: Vec<u32> = rows.iter().map(|r| r.level).collect();
    levels.dedup();
    for level in levels {
        let here = || finished.iter().filter(|r| r.level == level);
        let damped = here()
            .filter(|r| r.method != CONSERVATIVE)
            .min_by(|a, b| a.run.cost.wall.total_cmp(&b.run.cost.wall));
        let mut text = match damped {
            Some(r) => format!(
                "M^{level}: the cheapest damped run is {} at {:.1} ms, {} s/s with strain {:.0e}",
                r.method,
                1e3 * r.step,
                r.rate(),
                r.run.strain
            ),
            None => format!("M^{level}: no damped run came to the end"),
        };
        match here().find(|r| r.method == CONSERVATIVE) {
            Some(r) => {
                let _ = write!(
                    text,
                    "; the conservative one takes {} s/s and keeps the energy to {:.0e}.",
                    r.rate(),
                    r.run.relative_drift()
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
            percent(r.run.balance())
        )
    };
    let gains = finished.iter().filter(|r| r.run.balance() > GAIN).map(gain);
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
    rows.chunk_by(|a, b| a.level == b.level)
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
    fn the_coarsest_mesh_hangs() {
        let row = measure(Mesh::measured(1).unwrap(), methods()[0].clone(), 1.0).unwrap();
        assert_eq!(row.run.failure, None);
        assert!((row.run.reached - 1.0).abs() < 1e-9);
        assert!(row.run.strain < 1e-11 && row.run.cost.factorisations > 60);
        let csv = String::from_utf8(data(std::slice::from_ref(&row)).csv().unwrap()).unwrap();
        assert!(csv.contains("M^1,BDF2 (default),"), "{csv}");
        assert!(conclusions(&[row])[1].starts_with("M^1: the cheapest damped run is BDF2"));
    }

    #[test]
    fn comparisons_follow_the_numbers() {
        let mut row = measure(Mesh::measured(1).unwrap(), methods()[0].clone(), 1.0).unwrap();
        row.run.cost.wall = 0.6 * row.run.reached;
        row.factorisation = 0.1 * row.step;
        let mut other = row.clone();
        other.method = CONSERVATIVE.into();
        other.run.cost.wall *= 3.0;
        let mut finer = row.clone();
        finer.level = 2;
        let all = [row, other, finer];
        let text = comparisons(&all);
        assert_eq!(text.len(), 2, "one for each mesh");
        for part in [
            "BDF2 (default) at 16.7 ms: 0.60 s/s, 6.0 times the 0.10 s/s of one factorisation",
            "energy-momentum at 16.7 ms takes 3.0 times as long, 18 times one factorisation",
        ] {
            assert!(text[0].contains(part), "{part} is missing in {text:?}");
        }
        let row = &table(&all).rows[1];
        assert_eq!(row[4..6], [Cell::from("3.0"), Cell::from("18")]);
    }
}
