//! Scenes: everything that decides how a run goes, as data that can be written, read and checked.
//!
//! A scene is a TOML file ([`SceneFile`]) or is put together in a program ([`Scene`]). Lengths are in metres,
//! times in seconds, masses in kilograms, **angles in degrees**. `docs/scene.md` lists all keys.
//!
//! The names are those of the file, so that a scene reads in the same way in both. This one is that of
//! [`StartingPoint::Drape`]:
//!
//! ```
//! use isosheet_scenes::*;
//! # use std::path::Path;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut cloth = Sheet::new(Mesh::Square { side: 0.5, level: 3 });
//! cloth.material = Some(Material::named("polycarbonate film"));
//! cloth.damping = 2.0;
//! cloth.placement = Pose::at([-0.25, -0.25, 0.0]);
//! let table = Obstacle::new(Shape::Cylinder { radius: 0.15, height: 0.2 });
//! let mut scene = Scene::new(cloth);
//! scene.obstacle = vec![Obstacle { pose: Pose::at([0.0, 0.0, -0.11]), friction: 0.3.into(), ..table }];
//! scene.contact = Contact { self_contact: true, friction: 0.3.into(), ..Contact::default() };
//! scene.forces.gravity = Some([0.0, 0.0, -9.81]);
//! scene.stop.time = 1.0;
//! # let file = SceneFile::parse(StartingPoint::Drape.text().into(), Path::new("cloth.toml"), &[])?;
//! # assert_eq!(&scene, file.scene());
//! # Ok(())
//! # }
//! ```

mod air;
mod attached_flow;
mod bodies;
mod bond;
mod build;
mod carried;
mod changed;
mod chart;
mod contact;
mod courses;
mod creases;
mod curl;
mod direction;
mod drawing;
mod driven;
mod driven_into;
mod driven_surface;
mod edit;
mod enclosed;
mod engine_problem;
mod error;
mod fold_group;
mod fold_scene;
mod folding;
mod follower_loads;
mod forces;
mod foreign;
mod form;
#[cfg(test)]
mod found_tests;
mod friction;
mod functions;
mod glue;
mod guides;
mod in_words;
mod integration;
mod jump;
mod key;
mod kinks;
mod led;
mod live;
mod material;
mod measure;
mod mesh;
mod mesh_file;
mod method;
mod named_file;
mod names;
mod obstacle_names;
mod obstacles;
mod outline;
mod output;
mod part;
mod patch;
mod patched;
mod pattern;
mod periods;
mod placed;
mod placed_bodies;
mod plain_name;
mod pose;
mod poses;
mod problem;
mod profile;
mod refined;
mod resolution;
mod round_bodies;
mod schema;
mod selection;
mod selections;
mod sequence;
mod setup;
mod sheet;
mod sheets;
mod size;
mod slots;
mod source;
mod start;
mod starting_point;
mod step_path;
mod stop;
mod support_forces;
mod supports;
mod switch;
mod switches;
mod targets;
mod toml_problem;
mod too_fast;
mod turning_back;
mod under_way;
mod unit;
mod up_axis;
mod warning;
mod warnings;
mod weight;
mod yields;

pub use air::Air;
pub use attached_flow::AttachedFlow;
pub use bodies::Body;
pub use carried::{BodyLoad, CarriedBody};
pub use chart::{
    Chart, ChartEquations, ChartPositions, ChartScheme, ChartSolver, Coordinates, NearSingularity,
    Substep,
};
pub use contact::{Contact, SheetPair};
pub use creases::{Crease, CreaseEdges, PatternEdges};
pub use curl::Curl;
pub use direction::{Direction, TextureAxis, TextureDirection};
pub use drawing::DrawingFile;
pub use edit::{Edit, EditError};
pub use engine_problem::Origins;
pub use error::{Colours, PlacedProblem, SceneError, SceneText};
pub use fold_group::FoldGroup;
pub use fold_scene::{FoldScene, Panels, Touch, path_value, two_digits};
pub use folding::FollowedFolds;
pub use folding::off_target;
pub use folding::{FoldResidual, FoldTargets, Folding};
pub use follower_loads::{Gas, Moment, Pressure};
pub use forces::{Acceleration, Forces, Frame, Load};
pub use friction::{Friction, FrictionCoefficients};
pub use glue::{Glue, SeamBend, SeamSide};
pub use guides::{BodyForce, BodyTorque, Guide};
pub use integration::Integration;
pub use key::{Key, KeyError, KeyPart};
pub use live::{FailedStep, HoldError, LiveScene, Target};
pub use material::{Material, Plate};
pub use measure::{Gauge, Measure, Quantity};
pub use mesh::{Diagonals, Mesh};
pub use mesh_file::{MeshFile, PolygonFaces};
pub use method::{Fallback, Integrator, Method, Taut};
pub use obstacles::{Obstacle, Shape, Wall};
pub use outline::{Outline, OutlineShape};
pub use output::Output;
pub(crate) use part::{AnyPart, Part, Place, See, SeeMut};
pub use patch::Patch;
pub use pattern::{
    AlikeCreases, DegreeFour, Hypar, Kresling, Miura, SquareTwist, Waterbomb, Yoshimura,
};
pub use pose::{Motion, Pose, Rotation, Turn};
pub use poses::{FramePose, Poses, TimedPose};
pub(crate) use problem::Checks;
pub use problem::Problem;
pub use profile::{Change, Course, Interpolation, Profile};
pub use schema::{as_written, documented_schema, schema};
pub use selection::Selection;
pub use sequence::{MeshFrames, Outside, Sequence};
pub use setup::Setup;
pub use sheet::{Bending, Elasticity, Isometry, RestShape, Sheet};
pub use source::{SceneFile, SceneFileError};
pub use start::{Spin, Start};
pub use starting_point::StartingPoint;
pub use stop::{Rest, Stop};
pub use support_forces::{SupportForces, SupportLoad};
pub use supports::{Curve, Followed, Hold, Support, Surface, SurfaceSide};
pub use switch::{Condition, Threshold, When};
pub use targets::{CreaseResidual, DrivenCrease, Residuals, Targets};
pub(crate) use unit::Unit;
pub use unit::{UnitRange, UsualSize};
pub use up_axis::UpAxis;
pub use warning::Warning;
pub use weight::Weight;
pub use yields::{CreaseYield, SheetYield};

pub use build::Kept;
pub use functions::{Function, Moved};
pub use mesh_file::Files;
pub use named_file::{FileKind, NamedFile};
pub use resolution::check_positions;
pub use selection::{bounds, size};
pub use setup::Facts;
pub use size::MEMORY_OF_FACE;
pub use supports::frame_motion;
pub use under_way::UnderWay;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The version of the format of scene files.
pub const VERSION: u32 = 1;

/// A scene.
///
/// ```
/// use isosheet_scenes::{Mesh, Scene, Selection, Sheet, Support};
/// use std::path::Path;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut scene = Scene::new(Sheet::new(Mesh::Square { side: 0.21, level: 1 }));
/// scene.support.push(Support::pin(Selection::Vertices(vec![20])));
/// scene.forces.gravity = Some([0.0, 0.0, -9.81]);
/// let mut simulation = scene.build(Path::new("."))?.start()?;
/// assert!(simulation.step(scene.method.step)?.strain < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Part)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Version of the format: 1.
    pub version: u32,
    /// The sheet, or several, each with a name: `[[sheet]]`.
    #[serde(with = "sheets")]
    #[schemars(with = "sheets::OneOrSeveral")]
    pub sheet: Vec<Sheet>,
    /// Creases with rest angles.
    #[serde(default)]
    pub crease: Vec<Crease>,
    /// Folding to the angles of the FOLD file that is the mesh.
    #[serde(default)]
    pub folding: Option<Folding>,
    /// Seams: vertices that are glued to each other.
    #[serde(default)]
    pub glue: Vec<Glue>,
    /// Weights that are fixed to vertices.
    #[serde(default)]
    pub weight: Vec<Weight>,
    /// What holds the sheet.
    #[serde(default)]
    pub support: Vec<Support>,
    /// Bodies that the sheet meets.
    #[serde(default)]
    pub obstacle: Vec<Obstacle>,
    /// Rigid bodies that respond.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub body: Vec<Body>,
    /// Forces on the sheet.
    #[serde(default)]
    pub forces: Forces,
    /// The air around the sheet. Without it there is none.
    #[serde(default)]
    pub air: Option<Air>,
    /// Contact of the sheet with itself and with obstacles.
    #[serde(default)]
    pub contact: Contact,
    /// Lengths that are read off the sheet at each step.
    #[serde(default)]
    pub measure: Vec<Measure>,
    /// How the motion is computed.
    #[serde(default)]
    pub method: Method,
    /// When the run ends.
    #[serde(default)]
    pub stop: Stop,
    /// What the run writes.
    #[serde(default)]
    pub output: Output,
}

impl Scene {
    /// The thickness of the thickest sheet, metres.
    pub fn largest_thickness(&self) -> f64 {
        let sheets = self.sheet.iter().map(|sheet| sheet.thickness);
        sheets.fold(0.0, f64::max)
    }

    /// A sheet alone in space, free and without gravity.
    pub fn new(sheet: Sheet) -> Self {
        Self {
            version: VERSION,
            sheet: vec![sheet],
            crease: Vec::new(),
            folding: None,
            glue: Vec::new(),
            weight: Vec::new(),
            support: Vec::new(),
            obstacle: Vec::new(),
            body: Vec::new(),
            forces: Forces::default(),
            air: None,
            contact: Contact::default(),
            measure: Vec::new(),
            method: Method::default(),
            stop: Stop::default(),
            output: Output::default(),
        }
    }

    /// Checks everything that can be checked without reading other files.
    ///
    /// # Errors
    /// [`SceneError`] with all problems that were found.
    pub fn validate(&self) -> Result<(), SceneError> {
        SceneError::of(self.checks().problems)
    }

    /// Numbers that are possible, and larger or smaller than those of any sheet of this world.
    pub(crate) fn doubts(&self) -> Vec<Warning> {
        let mut doubts = self.checks().doubts;
        doubts.extend(creases::in_radians(&self.crease));
        doubts
    }

    fn checks(&self) -> Checks {
        let (root, mut checks) = (Key::root(), Checks::default());
        if self.version != VERSION {
            let message = format!("version {} of scene files is not known", self.version);
            checks.report(root.name("version"), message, "write `version = 1`");
        }
        sheets::check(&self.sheet, &mut checks);
        part::check_all(self, &Place::of(root.clone()), &mut checks);
        self.check_names(&mut checks);
        if let Some(folding) = &self.folding {
            let key = root.name("folding");
            match sheets::one_of(&self.sheet, folding.sheet.as_deref(), &key, "the creases") {
                Ok(k) => folding.check(&self.sheet[k].mesh, &key, &mut checks),
                Err(problem) => checks.problems.push(problem),
            }
        }
        for (key, glue) in root.name("glue").entries(&self.glue) {
            glue.check(&self.sheet, &self.body, &key, &mut checks);
        }
        obstacle_names::check_names(&self.obstacle, &self.sheet, &self.body, &mut checks);
        bodies::check(&self.body, &self.sheet, &mut checks);
        let contact = root.name("contact");
        self.contact
            .check(&self.body, &self.obstacle, &contact, &mut checks);
        for (key, measure) in root.name("measure").entries(&self.measure) {
            let of = (&self.crease[..], self.folding.as_ref(), &self.forces);
            measure.check(&key, of, &mut checks);
        }
        measure::check_names(&self.measure, &root, &mut checks);
        Crease::check_names(&self.crease, &mut checks);
        self.check_periods(&mut checks);
        self.check_steps_resolve(&mut checks);
        self.check_method_fits(&mut checks);
        let step = self.method.step;
        self.stop.check(step, &root.name("stop"), &mut checks);
        checks
    }

    /// Sheets without rods need a method whose steps are minima, contact such a method or a chart.
    fn check_method_fits(&self, checks: &mut Checks) {
        if self.method.integrator.is_minimising() {
            return;
        }
        let key = Key::root().name("method.integrator");
        let remedy = "choose `bdf2` or `implicit_euler`";
        if !self.body.is_empty() {
            checks.report(key, "this integrator has no place for bodies", remedy);
            return;
        }
        if self.has_contact() && self.method.integrator != Integrator::Chart {
            checks.report(
                key.clone(),
                "this integrator has no place for contact",
                remedy,
            );
        }
        let mut others = self.sheet.iter().enumerate();
        let differs = |(_, sheet): &(usize, &Sheet)| sheet.damping != self.sheet[0].damping;
        if self.method.integrator == Integrator::Chart
            && let Some((number, _)) = others.find(differs)
        {
            let key = sheets::sheet_key(self.sheet.len(), number).name("damping");
            let message = "a chart damps all sheets alike, and the first one has another rate";
            checks.report(
                key,
                message,
                "give all sheets the same `damping`, or choose `bdf2`",
            );
        }
        let mut sheets = self.sheet.iter();
        if let Some(elastic) = sheets.find(|sheet| sheet.isometry() != Isometry::Rods) {
            checks.report(
                key,
                "this integrator needs rigid rods, and the sheet has none",
                match (&elastic.isometry, &elastic.material) {
                    (None, Some(_)) => {
                        "choose `bdf2` or `implicit_euler`, or write `isometry = \"rods\"` beside `sheet.material`"
                    }
                    _ => remedy,
                },
            );
        }
    }

    /// Whether contact is modelled.
    pub fn has_contact(&self) -> bool {
        !self.obstacle.is_empty() || !self.body.is_empty() || self.contact.self_contact
    }
}

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
