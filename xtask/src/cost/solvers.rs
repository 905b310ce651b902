//! Eq. 21 of the paper, `C qdot = p`, by Cramer's rule as published, by dense LU, and by the sparse
//! saddle-point matrix.

use crate::draw::mesh_name;
use crate::interrupt;
use crate::report::{Bound, Effort, Finding, Part, Record, Table, columns, exponent};
use crate::store::Files;
use anyhow::Result;
use cpu_time::ThreadTime;
use isosheet_charts::{ChartDynamicsError, MassSolverKind};
use isosheet_coords::{CartesianChart, Chart, Choice, Linearised, RodSystem, mass_matrix};
use isosheet_mesh::{MassKind, MassMatrix};
use isosheet_tests::{bumped, corner};
use maud::html;
use nalgebra::DVector;
use serde::Serialize;

/// Name of the part on the command line and in tables.
pub(super) const NAME: &str = "mass-solvers";

const ABOUT: &str = "\
    The paper solves for the velocities by Cramer's rule, and differentiates the Hamiltonian by minors. Here each solver prepares \
    itself at a state and computes velocities and dH/dp once, in chosen Cartesian coordinates of a bumped sheet that is held \
    at a corner; the momenta are those of given velocities, from which the error is measured. The saddle-point matrix is never \
    reduced to C; it is factorised by faer.";

const SOLVERS: [(MassSolverKind, &str); 3] = [
    (MassSolverKind::Cramer, "Cramer's rule"),
    (MassSolverKind::DenseLu, "dense LU"),
    (MassSolverKind::Saddle, "sparse saddle point"),
];

/// Height of the bump, as a part of the side.
const BUMP: f64 = 0.1;

/// Sixteen digits less the digits of the condition number of such coordinates, 1e6 at most
/// (`condition-table`).
const ERROR: f64 = 1e-9;

/// A solver on a mesh. The fields are columns of a table, by their names.
#[derive(Clone, Debug, Serialize)]
struct Solved {
    level: u32,
    coordinates: usize,
    solver: &'static str,
    cpu_s: f64,
    error: f64,
}

/// A solver on `M^level`; nothing where there are too many coordinates for it.
fn solved(
    level: u32,
    (kind, solver): (MassSolverKind, &'static str),
    least: f64,
) -> Result<Option<Solved>> {
    let sheet = bumped(level, BUMP);
    let x = sheet.positions();
    let mass = MassMatrix::from_density(&sheet, 0.1, MassKind::Lumped)?;
    let system = RodSystem::new(&sheet, &[corner(level)])?;
    let chart = CartesianChart::new(system.clone(), Choice::Auto, x)?;
    let mut linear = Linearised::new(&system, chart.pattern())?;
    let jacobian = chart.jacobian(&system, &mut linear, x)?;
    let n = chart.dimension();
    let given = DVector::from_fn(n, |k, _| (1.0 + 1.7 * k as f64).sin());
    let p = mass_matrix(&system, &mass, &jacobian) * &given;
    let mut solver_at_hand = match kind.build(&system, &mass) {
        Err(ChartDynamicsError::TooManyCoordinates { .. }) => return Ok(None),
        built => built?,
    };
    let (mut velocity, mut gradient) = (vec![0.0; n], vec![0.0; n]);
    let (begun, mut times) = (ThreadTime::now(), 0);
    while times == 0 || begun.elapsed().as_secs_f64() < least {
        interrupt::check()?;
        chart.linearise(&system, &mut linear, x)?;
        solver_at_hand.prepare(&system, &chart, &mass, &mut linear, x)?;
        solver_at_hand.velocity(p.as_slice(), &mut velocity)?;
        solver_at_hand.momentum_gradient(p.as_slice(), &mut gradient)?;
        times += 1;
    }
    let cpu_s = begun.elapsed().as_secs_f64() / f64::from(times);
    let away = |found: &[f64]| (DVector::from_column_slice(found) - &given).amax() / given.amax();
    let error = away(&velocity).max(away(&gradient));
    Ok(Some(Solved {
        level,
        coordinates: n,
        solver,
        cpu_s,
        error,
    }))
}

/// Makes the part.
pub(super) fn make(effort: Effort, files: &mut Files<'_>) -> Result<Record> {
    let (finest, least) = effort.pick((2, 0.0), (4, 0.2), (5, 1.0));
    let mut all = Vec::new();
    for level in 0..=finest {
        for solver in SOLVERS {
            all.extend(solved(level, solver, least)?);
        }
    }
    Table::of_fields("", &all)?.named(NAME).write(files)?;
    let of = |level: u32, name: &str| {
        all.iter()
            .find(|s| s.level == level && s.solver == name)
            .cloned()
    };
    let [cramer, dense, sparse] = SOLVERS.map(|(_, name)| name);
    let time = |level: &u32, name: &str| of(*level, name).map(|s| s.cpu_s);
    let error = |level: &u32, name: &str| of(*level, name).map(|s| s.error);
    let levels: Vec<u32> = (0..=finest).collect();
    let table = Table::of(
        "Velocities and dH/dp from momenta, once: CPU seconds, and the largest relative error; Cramer's rule up to 40 coordinates",
        levels,
        columns! { level;
            "mesh" => mesh_name(*level),
            "coordinates" => of(*level, dense).map(|s| s.coordinates),
            "Cramer, s" => time(level, cramer),
            "dense LU, s" => time(level, dense),
            "sparse, s" => time(level, sparse),
            "Cramer, error" => error(level, cramer),
            "dense LU, error" => error(level, dense),
            "sparse, error" => error(level, sparse),
        },
    );
    let growth = SOLVERS.iter().filter_map(|(_, name)| {
        let points: Vec<[f64; 2]> = all
            .iter()
            .filter(|s| s.solver == *name)
            .map(|s| [s.coordinates as f64, s.cpu_s])
            .collect();
        let last = &points[points.len().saturating_sub(3)..];
        exponent(last).map(|e| format!("{name}: n^{e:.1}"))
    });
    let growth = growth.collect::<Vec<_>>().join(", ");
    let findings = SOLVERS.iter().map(|(_, name)| {
        let errors: Vec<Option<f64>> = all
            .iter()
            .filter(|s| s.solver == *name)
            .map(|s| Some(s.error))
            .collect();
        Finding::worst(*name, "error of velocities", Bound::AtMost(ERROR), &errors)
    });
    let inside = html! { h2 { "Solvers of C qdot = p" } p { (ABOUT) } p { "Growth of the CPU time with the coordinates: " (growth) "." } (table) };
    Ok(Record {
        findings: findings.collect(),
        excerpt: vec![Part::table(NAME, &table)],
        ..Record::new(NAME, inside)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solvers_give_the_velocities_that_the_momenta_are_of() {
        for level in 0..=2 {
            for solver in SOLVERS {
                let solved = solved(level, solver, 0.0)
                    .unwrap()
                    .expect("few coordinates");
                assert!(solved.error < ERROR, "{solved:?}");
            }
        }
        let cramer = solved(3, SOLVERS[0], 0.0).unwrap();
        assert!(cramer.is_none(), "too many coordinates");
    }
}
