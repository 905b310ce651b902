//! What a step costs where the sheet has to find a pattern of folds.

use super::Findings;
use super::dots::{Dot, Figure, Joined, Panel};
use super::isometry::{Isometry, Material, PAPER_RIGIDITY};
use super::meshes::nearest;
use super::records::Records;
use super::sample::{Sample, requirements};
use super::scene::Scene;
use crate::draw::{Axis, Charts, superscript};
use crate::report::Table;
use crate::runs::Plan;
use crate::runs::{BUMP, raised};
use anyhow::Result;
use isosheet_dynamics::project_positions;
use isosheet_mesh::{Sheet, VertexId, generate};

pub(super) const ABOUT: &str = "A square of 1 m and 0.1 kg, flat but for a bump of 1 mm, hangs by a corner (the hanging sheet of the other reports), with \
    and without the flexural rigidity of paper; default method, steps of 1/60 s. Rods leave a nearly flat sheet few ways to fold, and the solver \
    has to find them: what counts is how the number of iterations grows with the mesh.";

/// The tolerance to which the start satisfies the equations of isometry.
const TOLERANCE: f64 = 1e-12;

/// Mass, kilograms, and the rigidities compared, N m.
const MASS: f64 = 0.1;
const RIGIDITIES: [Option<f64>; 2] = [None, Some(PAPER_RIGIDITY)];

/// A hanging sheet: level of its mesh, and flexural rigidity.
type Hanging = Sample<(u32, Option<f64>)>;

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let duration = effort.quick_or(0.25, 1.0);
    let plan = Plan::new(1.0 / 60.0, duration).within(effort.quick_or(0.5, 150.0));
    let levels: &[u32] = effort.quick_or(&[1, 2], &[2, 3, 4, 5]);
    // The longest runs begin first, so that no core is left alone with one of them.
    let coarser = levels.iter().rev();
    let jobs: Vec<_> = coarser.flat_map(|l| RIGIDITIES.map(|r| (*l, r))).collect();
    let mut all = records.of_models(
        |_| jobs.clone(),
        |isometry, &(level, rigidity)| {
            let sheet = generate::isotropic_square(level, 1.0)?;
            let corner = nearest(&sheet, [0.0, 1.0]);
            let (course, _) = scene(isometry, &sheet, corner, rigidity)?.run(&plan)?;
            Ok((sheet.topology().vertex_count(), course, ()))
        },
    )?;
    all.sort_by_key(|h| (h.isometry, h.job.0));
    let targets = requirements(&all, |of| {
        let mut targets = Vec::new();
        for (level, bound) in [(4, 8.0), (5, 10.0)] {
            for rigidity in RIGIDITIES {
                let of = of.with(|job| *job == (level, rigidity));
                let quantity = format!("factorisations a step at M^{level}, {}", bending(rigidity));
                targets.push(of.at_most(&quantity, bound, Hanging::cost));
            }
        }
        targets.push(of.strain());
        targets
    });
    let findings = Findings {
        tables: vec![table(&all, &plan)],
        targets,
        ..Findings::default()
    };
    Ok((findings, Some(plot(&all, levels))))
}

fn table(all: &[Hanging], plan: &Plan) -> Table {
    Table::of(
        format!(
            "The hanging sheet: {} s simulated, at most {} s of wall time. Counts belong to the steps that were completed, \
             the wall time per step includes the time of one that was not",
            plan.duration,
            plan.patience
        ),
        all,
        &[
            ("mesh", &|h| format!("M^{}", h.job.0).into()),
            ("V", &|h| h.vertices.into()),
            ("D, N m", &|h| h.job.1.unwrap_or(0.0).into()),
            ("model", &|h| h.isometry.to_string().into()),
            ("ending", &|h| h.course.ending.name().into()),
            ("steps", &|h| h.course.cost.steps.into()),
            ("iterations per step", &|h| h.course.cost.iterations_per_step().into()),
            ("factorisations per step", &|h| h.course.cost.factorisations_per_step().into()),
            ("CPU s per simulated s", &|h| h.course.cpu_rate().into()),
            ("most in a step", &|h| h.course.worst.into()),
            ("wall time per step, s", &|h| h.course.cost.wall_per_step().into()),
            ("strain", &|h| h.course.strain.into()),
            ("message", &|h| h.course.ending.message().into()),
        ],
    )
    .named("iterations")
}

fn bending(rigidity: Option<f64>) -> String {
    rigidity.map_or_else(
        || "no bending stiffness".to_owned(),
        |d| format!("D = {d} N m"),
    )
}

/// Factorisations a step against the number of vertices.
fn plot(all: &[Hanging], levels: &[u32]) -> Charts {
    let place = |level: u32| f64::from(1_u32 << (level + 1));
    let panel = |rigidity: Option<f64>| {
        let of = all.iter().filter(|h| h.job.1 == rigidity);
        let dots = of.map(|h| Dot::of(h, 0, place(h.job.0), h.cost()));
        Panel::new(bending(rigidity), dots.collect())
    };
    let ticks = levels
        .iter()
        .map(|l| (place(*l), format!("M{}", superscript(*l))));
    let x = Axis::at("mesh", ticks.collect());
    let y = Axis::decades(
        "factorisations a step",
        all.iter().filter_map(Hanging::cost),
    );
    let (panels, names) = (RIGIDITIES.map(panel).to_vec(), vec!["union jack".into()]);
    Figure {
        joined: Joined::Yes,
        ..Figure::of_row(x, y, panels, names, [140.0, 140.0])
    }
    .draw()
}

fn scene(
    isometry: Isometry,
    sheet: &Sheet,
    corner: VertexId,
    rigidity: Option<f64>,
) -> Result<Scene> {
    let material = Material {
        mass: MASS,
        rigidity,
        clamped: &[],
    };
    let model = isometry.model(sheet, material)?;
    let model = model.with_gravity().with_pins(&[corner])?;
    // The bump lengthens edges by up to 5e-6.
    let points = sheet.positions().as_chunks::<3>().0.iter();
    let mut start: Vec<f64> = points.flat_map(|p| raised(*p, BUMP)).collect();
    project_positions(&model, &mut start, TOLERANCE)?;
    Ok(Scene::flat(model, sheet).from(start))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The iterations of the default method on a coarse mesh are counted, and the sheet hangs by its corner.
    #[test]
    fn a_small_sheet_is_measured() {
        let plan = Plan::new(1.0 / 60.0, 0.1).within(60.0);
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let scene = scene(Isometry::Rods, &sheet, VertexId(20), Some(5e-4)).unwrap();
        assert_eq!(scene.model.pins(), [VertexId(20)]);
        let (course, end) = scene.run(&plan).unwrap();
        assert!(course.is_good() && course.cost.steps == 6, "{course:?}");
        assert!(course.cost.factorisations >= 6 && course.cost.iterations >= 6);
        assert!(end.heights()[0] < -0.01 && course.strain < 1e-11);
    }
}
