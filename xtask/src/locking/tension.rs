//! Sheets that are pulled while they bend: a cloth on a ball, a strip of cotton, a film that wrinkles.

use super::model::Model;
use super::runs::{EVERY_RUN, Records};
use crate::report::Table;
use crate::runs::{FigureScene, Plan, scene_fingerprint, unseen};
use anyhow::Result;
use isosheet_dynamics::Simulation;
use isosheet_mesh::Sheet;
use serde::{Deserialize, Serialize};

/// The area mean of the height of the cloth, metres: that of sheets which are too soft in their plane to
/// lock, without slack and without a limit that acts (1000 N/m on 16 641 vertices; 300 N/m on 1089 and 4225).
const DRAPED: f64 = -0.354;

/// A run of a scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Job {
    scene: String,
    /// The edges along the side that bends, or across the pull.
    #[serde(rename = "squares across")]
    across: usize,
    #[serde(rename = "E h, N/m")]
    stiffness: f64,
    limit: f64,
    #[serde(skip)]
    edits: Vec<String>,
}

/// What came of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Found {
    model: Model,
    #[serde(rename = "V")]
    vertices: usize,
    ending: String,
    value: Option<f64>,
    reference: Option<f64>,
    #[serde(rename = "relative error")]
    error: Option<f64>,
    #[serde(rename = "area at the limit")]
    at_limit: f64,
    factorisations: usize,
    #[serde(rename = "CPU s")]
    cpu: f64,
    /// Scenes have limits of their own.
    #[serde(rename = "strain of an edge")]
    strain: Option<f64>,
    #[serde(rename = "violation of the equations of isometry")]
    violation: Option<f64>,
    #[serde(rename = "gap, m")]
    gap: Option<f64>,
}

impl Job {
    fn draped(level: u32, stiffness: f64, limit: f64) -> Self {
        Self {
            scene: "cloth-on-ball".into(),
            across: 2 << level,
            stiffness,
            limit,
            edits: vec![
                format!("sheet.mesh.square.level={level}"),
                format!("sheet.isometry.elastic.stiffness={stiffness:?}"),
                format!("sheet.isometry.elastic.limit={limit:?}"),
            ],
        }
    }

    fn pulled(across: usize) -> Self {
        let [columns, rows] = [5 * across, across];
        Self {
            scene: "cotton-pulled".into(),
            across,
            stiffness: COTTON,
            limit: 0.2,
            edits: vec![
                format!("sheet.mesh.rectangle.columns={columns}"),
                format!("sheet.mesh.rectangle.rows={rows}"),
            ],
        }
    }

    fn stretched() -> Self {
        Self {
            scene: "film-stretched".into(),
            across: 40,
            stiffness: 1e4,
            limit: 0.3,
            edits: Vec::new(),
        }
    }

    fn run(&self, plan_for: fn(f64, f64) -> Plan) -> Result<Found> {
        let scene = FigureScene::of(&self.scene, &self.scene, &self.edits)?;
        let Setup {
            sheet,
            mut simulation,
        } = Setup::of(&scene)?;
        let plan = plan_for(scene.frame(), scene.scene().stop.time);
        let course = plan.run(&mut simulation, &mut unseen)?;
        let x = &simulation.state().x;
        let (value, reference) = match self.scene.as_str() {
            "cloth-on-ball" => (mean_height(&sheet, x), Some(DRAPED)),
            "cotton-pulled" => (extension(&sheet, x), Some(PULL / (COTTON * WIDTH) * FREE)),
            _ => (crests(&sheet, x), None),
        };
        let value = course.is_good().then_some(value);
        let error = value.zip(reference).map(|(v, r)| (v / r - 1.0).abs());
        let deformation = simulation.elastic_deformation();
        Ok(Found {
            model: Model::Elastic,
            vertices: sheet.topology().vertex_count(),
            ending: course.ending.name().to_owned(),
            value,
            reference,
            error,
            at_limit: deformation.map_or(0.0, |d| d.at_limit),
            factorisations: course.cost.factorisations,
            cpu: course.cost.cpu,
            strain: None,
            violation: None,
            gap: course.gap,
        })
    }
}

/// A scene where it starts.
struct Setup {
    sheet: Sheet,
    simulation: Simulation,
}

impl Setup {
    fn of(scene: &FigureScene) -> Result<Self> {
        let sheet = scene.sheet()?;
        let simulation = scene.setup()?.start()?;
        Ok(Self { sheet, simulation })
    }
}

/// `E h` of cotton, N/m; the pull, newtons; width and free length of the strip, metres.
const COTTON: f64 = 1.5e4;
const PULL: f64 = 1.0;
const WIDTH: f64 = 0.06;
const FREE: f64 = 0.27;

/// The mean of the height over the area, metres.
fn mean_height(sheet: &Sheet, x: &[f64]) -> f64 {
    let faces = sheet.topology().faces().iter().zip(sheet.face_areas());
    let moment = faces.map(|(corners, area)| {
        let heights = corners.map(|v| x[3 * v.index() + 2]);
        area * heights.iter().sum::<f64>() / 3.0
    });
    moment.sum::<f64>() / sheet.area()
}

/// How far the vertices of the free end have gone along the pull, metres.
fn extension(sheet: &Sheet, x: &[f64]) -> f64 {
    let places = sheet.positions().as_chunks::<3>().0.iter();
    let places = places.zip(x.as_chunks::<3>().0);
    let end: Vec<f64> = places
        .filter(|(from, _)| from[0] > 0.3 - 1e-9)
        .map(|(from, to)| to[0] - from[0])
        .collect();
    end.iter().sum::<f64>() / end.len() as f64
}

/// The crests and troughs across the middle that are at least a quarter as high as the highest.
fn crests(sheet: &Sheet, x: &[f64]) -> f64 {
    let places = sheet.positions().as_chunks::<3>().0.iter();
    let places = places.zip(x.as_chunks::<3>().0);
    let mut line: Vec<[f64; 2]> = places
        .filter(|(from, _)| (from[0] - 0.125).abs() < 1e-9)
        .map(|(from, to)| [from[1], to[2]])
        .collect();
    line.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let heights: Vec<f64> = line.iter().map(|[_, z]| *z).collect();
    let highest = heights.iter().fold(0.0_f64, |most, z| most.max(z.abs()));
    let is_crest = |w: &[f64]| (w[1] - w[0]) * (w[2] - w[1]) < 0.0 && w[1].abs() > 0.25 * highest;
    heights.windows(3).filter(|w| is_crest(w)).count() as f64
}

/// The runs of the yardstick.
pub(super) fn runs(records: &Records<'_>) -> Result<Table> {
    let effort = records.store.effort;
    let mut jobs = vec![Job::draped(3, 3e5, 0.05), Job::pulled(4)];
    jobs.extend(effort.quick_or(
        vec![],
        vec![
            Job::draped(3, 3e5, 0.2),
            Job::draped(4, 3e5, 0.05),
            Job::draped(4, 3e5, 0.2),
            Job::draped(4, 3e4, 0.2),
            Job::draped(4, 3e3, 0.2),
            Job::pulled(8),
            Job::pulled(16),
            Job::stretched(),
        ],
    ));
    let plan: fn(f64, f64) -> Plan = match effort.quick_or(true, false) {
        true => |step, _| Plan::new(step, 10.0 * step),
        false => Plan::new,
    };
    let name = format!("scenes {:x}", scene_fingerprint()?);
    let found = records.runs(&name, &jobs, |job| Ok((job.clone(), job.run(plan)?)))?;
    Table::of_fields(
        EVERY_RUN,
        found.iter().map(|(job, found): &(Job, Found)| (job, found)),
    )
}
