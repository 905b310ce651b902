//! What a complete run says of itself.

use super::balance::ForceBalance;
use super::elastic::ElasticSummary;
use super::energy::EnergySummary;
use super::incidence::Incidence;
use super::intervention::Intervention;
use super::kept::KeptAngles;
use super::time_error::TimeError;
use super::vibration::Vibration;
use isosheet_mesh::Part;
use isosheet_scenes::Residuals;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The contents of `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The program.
    pub program: String,
    /// Its version.
    pub version: String,
    /// The commit that it was built from, if the program said so ([`note_commit`](super::note_commit)).
    pub commit: Option<String>,
    /// Hash of the scene and the mesh files that it names; see [`SceneHash`](super::SceneHash).
    pub scene: String,
    /// Wall time of all processes that worked on the run, seconds.
    pub wall_time: f64,
    /// What was modelled, in words.
    pub modelled: Vec<String>,
    /// Of several sheets and bodies the name and the place of each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sheets: Vec<SheetPlace>,
    /// Number of vertices.
    pub vertices: usize,
    /// Number of faces.
    pub faces: usize,
    /// Steps taken.
    pub steps: u64,
    /// Frames recorded, that of the start included.
    pub frames: u64,
    /// Largest relative change of an edge length in any step.
    pub largest_strain: f64,
    /// Largest distance of a vertex from its place at the start after any step, metres.
    pub largest_displacement: f64,
    /// Extremes of the energies, and the largest errors of their balance.
    pub energy: EnergySummary,
    /// The fastest vibration with a tenth of the largest kinetic energy, and a hundredth of the mean edge
    /// length to and fro, where steps are of the second-order backward differentiation formula and no state
    /// of rest is asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vibration: Option<Vibration>,
    /// The largest estimated error that a part of a step added to the positions, with BDF2 and implicit
    /// Euler.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_error: Option<TimeError>,
    /// What the forces of supports left of the balance of forces and torques, with BDF2 and implicit Euler.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub balance: Option<ForceBalance>,
    /// The largest angle between sheet and relative wind after any step, where the flow is attached.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub incidence: Option<Incidence>,
    /// The largest thickness of the sheets, metres, which is taken off gaps.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub thickness: f64,
    /// Smallest gap in any step, metres; none without contact, or if nothing ever came close.
    pub smallest_gap: Option<f64>,
    /// Newton iterations.
    pub iterations: u64,
    /// Matrix factorisations.
    pub factorisations: u64,
    /// Sub-steps that were tried and rejected.
    pub rejected: u64,
    /// How the sheet was stretched and bent, if it is elastic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elastic: Option<ElasticSummary>,
    /// What a program did between the steps that the scene at the beginning did not say.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub control: Vec<Intervention>,
    /// What the measures of the scene showed, by their names.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub measures: BTreeMap<String, Measured>,
    /// The state at the end.
    pub ending: Ending,
}

/// What a measure showed in a run, the start included, in the unit of its quantity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// At the end.
    pub last: f64,
    /// The smallest value.
    pub least: f64,
    /// The largest value.
    pub largest: f64,
}

/// The state at the end of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ending {
    /// Why it ended.
    pub reason: EndReason,
    /// Time, seconds.
    pub t: f64,
    /// Kinetic energy, joules.
    pub kinetic: f64,
    /// Potential energy, joules.
    pub potential: f64,
    /// What yielding has dissipated, joules; none if nothing can yield.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plastic: Option<f64>,
    /// Error of the energy balance, joules: energy less work of supports and forces, plus what damping,
    /// friction and yielding took, minus the energy at the start.
    pub energy_drift: f64,
    /// Largest speed of a vertex, m/s.
    pub largest_speed: f64,
    /// The lowest frequency of small free vibrations about an equilibrium, hertz.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lowest_frequency: Option<f64>,
    /// Force of each support of the scene on the sheet, newtons.
    pub supports: Vec<[f64; 3]>,
    /// Force of the sheet on each obstacle of the scene, newtons.
    pub obstacles: Vec<[f64; 3]>,
    /// Force of all that touches each body of the scene on it, newtons.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<[f64; 3]>,
    /// What asked for more than the lengths allow, where the run ended for that reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub taut: Option<String>,
    /// What was wrong with the step that failed, if one failed after the last one that was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// What stays of the angles that have yielded.
    #[serde(default, skip_serializing_if = "KeptAngles::is_empty")]
    pub kept: KeptAngles,
    /// How far the sheets are from what the scene asks for.
    #[serde(flatten)]
    pub residuals: Residuals,
}

impl Ending {
    /// Whether supports and obstacles pull or push against each other with more than what they hold: then
    /// their forces come from the stiffness of the sheets.
    pub(crate) fn is_squeezed(&self) -> bool {
        let on_obstacles = self.obstacles.iter().map(|f| -Vector3::from(*f));
        let supports = self.supports.iter().map(|f| Vector3::from(*f));
        let forces = supports.chain(on_obstacles);
        let (sizes, sum) = forces.fold((0.0, Vector3::zeros()), |(sizes, sum), f| {
            (sizes + f.norm(), sum + f)
        });
        sizes > 2.0 * sum.norm()
    }
}

impl Summary {
    /// The smallest gap in words, if there is one: whether the thickness of sheets has been taken off.
    pub fn gap_in_words(&self) -> Option<String> {
        let thickness = match self.thickness > 0.0 {
            true => " (thickness taken off)",
            false => "",
        };
        self.smallest_gap
            .map(|gap| format!("{gap:.1e} m{thickness}"))
    }
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// One of several sheets and bodies in the arrays of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SheetPlace {
    /// Its name.
    pub name: String,
    /// Its first vertex, and the one after its last.
    pub vertices: [usize; 2],
    /// Its first face, and the one after its last.
    pub faces: [usize; 2],
    /// Largest relative change of the length of one of its edges in any step; none of a body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_strain: Option<f64>,
}

impl SheetPlace {
    pub(crate) fn new((name, part): &(String, Part), largest_strain: Option<f64>) -> Self {
        let ends = |range: &std::ops::Range<usize>| [range.start, range.end];
        Self {
            name: name.clone(),
            vertices: ends(&part.vertices),
            faces: ends(&part.faces),
            largest_strain,
        }
    }
}

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EndReason {
    /// The whole time has passed (`stop.time`).
    Time,
    /// The sheet is at rest (`stop.rest`).
    Rest,
    /// The force at a support is reached (`stop.support_force`).
    SupportForce,
    /// The supports ask for more than the lengths allow (`method.taut`).
    Taut,
    /// The program that took the steps ended the recording.
    Program,
    /// An error ended the program that took the steps.
    Error,
}
