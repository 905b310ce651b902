//! What a step costs where the sheet has to find a pattern of folds.

use super::course::{Course, Plan, Scene};
use super::findings::Findings;
use super::isometry::{Isometry, Material, PAPER_RIGIDITY};
use super::meshes::nearest;
use super::plot::{Dot, Figure, Joined, Panel};
use super::records::Records;
use super::targets::{Target, at_most, kept, strain};
use crate::draw::{Axis, Drawing};
use crate::report::Table;
use anyhow::Result;
use isosheet_dynamics::{Method, project_positions};
use isosheet_mesh::{Sheet, VertexId, generate};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

pub(super) const ABOUT: &str = "A square of 1 m and 0.1 kg, flat but for a bump of 1 mm, hangs by a corner (the hanging sheet of the other reports), with \
    and without the flexural rigidity of paper; default method, steps of 1/60 s. Rods leave a nearly flat sheet few ways to fold, and the solver \
    has to find them: what counts is how the number of iterations grows with the mesh.";

/// Height of the bump, metres, and the tolerance to which the start satisfies the equations of isometry.
const BUMP: f64 = 1e-3;
const TOLERANCE: f64 = 1e-12;

/// Mass, kilograms, and the rigidities compared, N m.
const MASS: f64 = 0.1;
const RIGIDITIES: [Option<f64>; 2] = [None, Some(PAPER_RIGIDITY)];

/// Positions of the flat sheet with the bump, which lengthens edges by up to 5e-6.
fn bumped(flat: &Sheet) -> Vec<f64> {
    let points = flat.positions().as_chunks::<3>().0.iter();
    let bump = |x: f64, y: f64| BUMP * (PI * x).sin() * (PI * y).sin();
    points
        .flat_map(|[x, y, _]| [*x, *y, bump(*x, *y)])
        .collect()
}

/// A hanging sheet.
#[derive(Serialize, Deserialize)]
struct Hanging {
    isometry: Isometry,
    level: u32,
    vertices: usize,
    rigidity: Option<f64>,
    course: Course,
}

impl Hanging {
    fn measure(isometry: Isometry, level: u32, rigidity: Option<f64>, plan: &Plan) -> Result<Self> {
        let sheet = generate::isotropic_square(level, 1.0)?;
        let corner = nearest(&sheet, [0.0, 1.0]);
        Ok(Self {
            isometry,
            level,
            vertices: sheet.topology().vertex_count(),
            rigidity,
            course: scene(isometry, &sheet, corner, rigidity)?.run(plan)?,
        })
    }

    /// Factorisations a step of a run that reached its end.
    fn cost(&self) -> Option<f64> {
        let cost = self.course.cost.factorisations_per_step();
        cost.filter(|_| self.course.ending.is_good())
    }
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Drawing>)> {
    let effort = records.effort;
    let plan = Plan {
        step: 1.0 / 60.0,
        duration: effort.quick_or(0.25, 1.0),
        rest_speed: None,
        patience: effort.patience(0.5, 60.0),
    };
    let levels: &[u32] = effort.quick_or(&[1, 2], &[2, 3, 4, 5]);
    // The longest runs begin first, so that no core is left alone with one of them.
    let jobs: Vec<(u32, Option<f64>)> = levels
        .iter()
        .rev()
        .flat_map(|l| RIGIDITIES.map(|r| (*l, r)))
        .collect();
    let mut all = records.of_models(
        |_| jobs.clone(),
        |isometry, (level, rigidity)| Hanging::measure(isometry, *level, *rigidity, &plan),
    )?;
    all.sort_by_key(|h| (h.isometry, h.level));
    Ok((
        Findings {
            tables: vec![table(&all, &plan)],
            targets: Isometry::ALL
                .iter()
                .flat_map(|m| targets(*m, &all))
                .collect(),
            ..Findings::default()
        },
        Some(plot(&all, levels)),
    ))
}

fn table(all: &[Hanging], plan: &Plan) -> Table {
    let mut table = Table::new(format!(
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
    ).named("iterations");
    for h in all {
        let course = &h.course;
        let per_step = (course.cost.steps > 0).then(|| course.cost.wall / course.cost.steps as f64);
        table.push(vec![
            format!("M^{}", h.level).into(),
            h.vertices.into(),
            h.rigidity.unwrap_or(0.0).into(),
            h.isometry.to_string().into(),
            course.ending.name().into(),
            course.cost.steps.into(),
            course.cost.iterations_per_step().into(),
            course.cost.factorisations_per_step().into(),
            course.worst.into(),
            per_step.into(),
            course.strain.into(),
            course.ending.message().into(),
        ]);
    }
    table
}

fn targets(isometry: Isometry, all: &[Hanging]) -> Vec<Target> {
    let mut targets = Vec::new();
    for (level, bound) in [(4, 8.0), (5, 10.0)] {
        for rigidity in RIGIDITIES {
            let of = all.iter().filter(|h| h.isometry == isometry);
            let of = of.filter(|h| h.level == level && h.rigidity == rigidity);
            let costs: Vec<Option<f64>> = of.map(Hanging::cost).collect();
            let quantity = format!("factorisations a step at M^{level}, {}", bending(rigidity));
            targets.push(at_most(isometry, &quantity, bound, &costs));
        }
    }
    let of = || all.iter().filter(|h| h.isometry == isometry);
    targets.push(strain(isometry, of().map(|h| &h.course)));
    targets.extend(kept(isometry, of().map(|h| h.course.kept)));
    targets
}

fn bending(rigidity: Option<f64>) -> String {
    rigidity.map_or_else(
        || "no bending stiffness".to_owned(),
        |d| format!("D = {d} N m"),
    )
}

/// Factorisations a step against the number of vertices.
fn plot(all: &[Hanging], levels: &[u32]) -> Drawing {
    let panel = |rigidity: Option<f64>| Panel {
        title: bending(rigidity),
        dots: all
            .iter()
            .filter(|h| h.rigidity == rigidity)
            .map(|h| Dot {
                isometry: h.isometry,
                mesh: 0,
                x: f64::from(1_u32 << (h.level + 1)),
                y: h.cost(),
            })
            .collect(),
        guides: Vec::new(),
    };
    let tick = |level: &u32| (f64::from(1_u32 << (level + 1)), format!("M^{{{level}}}"));
    let costs = all.iter().filter_map(Hanging::cost);
    Figure {
        x: Axis::at("mesh", levels.iter().map(tick).collect()),
        rows: vec![(
            Axis::holding("factorisations a step", costs),
            RIGIDITIES.map(panel).to_vec(),
        )],
        meshes: vec!["union jack".into()],
        guide: String::new(),
        joined: Joined::Yes,
        size: [140.0, 140.0],
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
    let mut start = bumped(sheet);
    project_positions(&model, &mut start, TOLERANCE)?;
    Ok(Scene {
        model,
        start,
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
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let scene = scene(Isometry::Rods, &sheet, VertexId(20), Some(5e-4)).unwrap();
        assert_eq!(scene.model.pins(), [VertexId(20)]);
        let course = scene.run(&plan).unwrap();
        assert!(
            course.ending.is_good() && course.cost.steps == 6,
            "{course:?}"
        );
        assert!(course.cost.factorisations >= 6 && course.cost.iterations >= 6);
        assert!(course.lowest() < -0.01 && course.strain < 1e-11);
    }
}
