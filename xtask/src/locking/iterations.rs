//! Yardstick 5: what a step costs where the sheet has to find a pattern of folds.

use super::course::{Plan, Scene};
use super::effort::LockingEffort;
use super::findings::Findings;
use super::isometry::Isometry;
use super::meshes::nearest;
use super::table::Results;
use crate::draw::Drawing;
use crate::progress::Progress;
use anyhow::Result;
use isosheet_dynamics::Method;
use isosheet_mesh::{Sheet, VertexId, generate};
use std::f64::consts::PI;

pub(super) const ABOUT: &str = "A square of 1 m and 0.1 kg, flat but for a bump of 1 mm, hangs by a corner (the hanging sheet of the other reports), with \
    and without the flexural rigidity of paper; default method, steps of 1/60 s. Rods leave a nearly flat sheet few ways to fold, and the solver \
    has to find them: what counts is how the number of iterations grows with the mesh.";

/// Height of the bump, metres.
const BUMP: f64 = 1e-3;

/// Mass, kilograms, and the rigidities compared, N m.
const MASS: f64 = 0.1;
const RIGIDITIES: [f64; 2] = [0.0, 5e-4];

/// The square M^level with its bump.
fn bumped(level: u32) -> Result<Sheet> {
    let flat = generate::isotropic_square(level, 1.0)?;
    Ok(flat.map_positions(|[x, y, _]| [x, y, BUMP * (PI * x).sin() * (PI * y).sin()])?)
}

/// Runs the yardstick.
pub(super) fn make(effort: LockingEffort) -> Result<(Findings, Option<Drawing>)> {
    let plan = Plan {
        step: 1.0 / 60.0,
        duration: effort.pick(0.25, 1.0),
        rest_speed: None,
        patience: effort.patience(1.0, 15.0),
    };
    let mut table = Results::new(
        "iterations",
        format!(
            "The hanging sheet: {} s simulated, at most {} s of wall time. Counts belong to the steps that were completed, \
             the wall time per step includes the time of one that was not",
            plan.duration,
            plan.patience.as_secs_f64()
        ),
        &[
            "mesh",
            "V",
            "D, N m",
            "model",
            "ending",
            "steps",
            "iterations per step",
            "factorisations per step",
            "most in a step",
            "wall time per step, s",
            "strain",
            "message",
        ],
    );
    let levels = effort.pick(1..=2, 2..=5);
    let bar = Progress::start("iterations", 2 * levels.clone().count());
    for isometry in Isometry::ALL {
        for level in levels.clone() {
            for rigidity in RIGIDITIES {
                let sheet = bumped(level)?;
                let corner = nearest(&sheet, [0.0, 1.0]);
                let course = scene(isometry, &sheet, corner, rigidity)?.run(&plan)?;
                table.push(vec![
                    format!("M^{level}").into(),
                    sheet.topology().vertex_count().into(),
                    rigidity.into(),
                    isometry.to_string().into(),
                    course.ending.name().into(),
                    course.steps.into(),
                    course.iterations_per_step().into(),
                    course.factorisations_per_step().into(),
                    course.worst.into(),
                    (course.steps > 0)
                        .then(|| course.wall / course.steps as f64)
                        .into(),
                    course.strain.into(),
                    course.ending.message().into(),
                ]);
                bar.step();
            }
        }
    }
    bar.finish("measured");
    Ok((Findings::table(table), None))
}

fn scene(isometry: Isometry, sheet: &Sheet, corner: VertexId, rigidity: f64) -> Result<Scene> {
    let model = if rigidity > 0.0 {
        isometry.bending(sheet, MASS, rigidity, &[])?
    } else {
        isometry.model(sheet, MASS)?
    };
    Ok(Scene {
        model: model.with_gravity().with_pins(&[corner])?,
        start: sheet.positions().to_vec(),
        method: Method::default(),
        contacts: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The iterations of the default method on a coarse mesh are counted, and the sheet hangs by its corner.
    #[test]
    fn a_small_sheet_is_measured() {
        let plan = Plan {
            step: 1.0 / 60.0,
            duration: 0.1,
            rest_speed: None,
            patience: std::time::Duration::from_secs(60),
        };
        let sheet = bumped(1).unwrap();
        let scene = scene(Isometry::Rods, &sheet, VertexId(20), 5e-4).unwrap();
        assert_eq!(scene.model.pins(), [VertexId(20)]);
        let course = scene.run(&plan).unwrap();
        assert!(course.ending.is_good() && course.steps == 6, "{course:?}");
        assert!(course.factorisations >= 6 && course.iterations >= 6);
        assert!(course.lowest() < -0.01 && course.strain < 1e-11);
    }
}
