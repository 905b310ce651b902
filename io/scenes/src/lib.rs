//! Scenes: everything that decides how a run goes, as data that can be written, read and checked.
//!
//! A scene is a TOML file ([`SceneFile`]) or is put together in a program ([`Scene`]). Lengths are in metres,
//! times in seconds, masses in kilograms, **angles in degrees**. `docs/scene.md` lists all keys.
//!
//! The names are the names of the file, so that a scene reads in the same way in both: [`SheetKey`] is what
//! the key `sheet` has, of which a sheet (`isosheet_mesh::Sheet`) is made. This scene is that of
//! [`StartingPoint::Drape`]:
//!
//! ```
//! use isosheet_scenes::*;
//! # use std::path::Path;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut cloth = SheetKey::new(Mesh::Square { side: 0.5, level: 3 });
//! cloth.material = Some(MaterialKey::named("polycarbonate film"));
//! cloth.damping = 2.0;
//! cloth.placement = Pose::at([-0.25, -0.25, 0.0]);
//! let table = ObstacleKey::new(ShapeKey::Cylinder { radius: 0.15, height: 0.2 });
//! let mut scene = Scene::new(cloth);
//! scene.obstacle = vec![ObstacleKey { pose: Pose::at([0.0, 0.0, -0.11]), friction: 0.3.into(), ..table }];
//! let contact = ContactSettings::default();
//! scene.contact = ContactSettings { self_contact: true, friction: 0.3.into(), ..contact };
//! scene.forces.gravity = Some([0.0, 0.0, -9.81]);
//! scene.stop.time = 1.0;
//! # let file = SceneFile::parse(StartingPoint::Drape.text().into(), Path::new("cloth.toml"), &[])?;
//! # assert_eq!(&scene, file.scene());
//! # Ok(())
//! # }
//! ```

// From the ground up: a folder uses those before it alone.

/// What is said of scenes: keys, units, what is wrong and where.
mod words {
    pub(crate) mod edit;
    pub(crate) mod error;
    pub(crate) mod key;
    pub(crate) mod part;
    pub(crate) mod plain_name;
    pub(crate) mod problem;
    pub(crate) mod resolution;
    pub(crate) mod toml_problem;
    pub(crate) mod unit;
    pub(crate) mod warning;
}

/// Functions of time, and motions that are made of them.
mod time {
    pub(crate) mod kinks;
    pub(crate) mod led;
    pub(crate) mod pose;
    pub(crate) mod poses;
    pub(crate) mod profile;
}

/// Meshes: where they come from, and parts of them.
mod meshes {
    pub(crate) mod direction;
    pub(crate) mod drawing;
    pub(crate) mod foreign;
    pub(crate) mod mesh;
    pub(crate) mod mesh_file;
    pub(crate) mod outline;
    pub(crate) mod pattern;
    pub(crate) mod selection;
    pub(crate) mod sequence;
    pub(crate) mod strip_between;
    pub(crate) mod up_axis;
}

/// Sheets: what they are of, how they start, their creases.
mod sheets {
    pub(crate) mod creases;
    pub(crate) mod curl;
    pub(crate) mod fold_group;
    pub(crate) mod folding;
    pub(crate) mod material;
    pub(crate) mod patch;
    pub(crate) mod patched;
    pub(crate) mod refined;
    pub(crate) mod several;
    pub(crate) mod sheet;
    pub(crate) mod size;
    pub(crate) mod start;
    pub(crate) mod weight;
    pub(crate) mod yields;
}

/// Loads: forces, pressures and the air.
mod loads {
    pub(crate) mod air;
    pub(crate) mod attached_flow;
    pub(crate) mod enclosed;
    pub(crate) mod follower_loads;
    pub(crate) mod forces;
}

/// What a sheet meets: obstacles, and bodies that respond.
mod bodies {
    pub(crate) mod body;
    pub(crate) mod carried;
    pub(crate) mod friction;
    pub(crate) mod guides;
    pub(crate) mod obstacle_names;
    pub(crate) mod obstacles;
    pub(crate) mod round_bodies;
}

/// Sheets, bodies and obstacles in their places.
mod placing {
    pub(crate) mod driven;
    pub(crate) mod driven_surface;
    pub(crate) mod in_words;
    pub(crate) mod placed;
    pub(crate) mod placed_bodies;
    pub(crate) mod slots;
}

/// What is read off: measures, and how far targets are reached.
mod measures {
    pub(crate) mod crease_gauge;
    pub(crate) mod facing;
    pub(crate) mod measure;
    pub(crate) mod targets;
    pub(crate) mod yielding;
}

/// What holds and touches: supports, seams and contact, and when they do.
mod holding {
    pub(crate) mod bond;
    pub(crate) mod contact;
    pub(crate) mod glue;
    pub(crate) mod supports;
    pub(crate) mod switch;
}

/// How a scene is run: the method, the end and the files.
mod methods {
    pub(crate) mod chart;
    pub(crate) mod integration;
    pub(crate) mod method;
    pub(crate) mod output;
    pub(crate) mod stop;
}

/// What is found and checked in the scene as a whole.
mod whole {
    pub(crate) mod functions;
    pub(crate) mod named_file;
    pub(crate) mod names;
    pub(crate) mod periods;
    pub(crate) mod selections;
    mod static_scene;
    pub(crate) mod step_path;
    pub(crate) mod switches;
    pub(crate) mod turning_back;
}

/// From a scene to a simulation.
mod building {
    pub(crate) mod build;
    pub(crate) mod engine_problem;
    pub(crate) mod setup;
    pub(crate) mod support_forces;
    pub(crate) mod warnings;
}

/// Texts of scenes: how they are read, written and begun.
mod text {
    pub(crate) mod changed;
    pub(crate) mod fold_scene;
    pub(crate) mod form;
    pub(crate) mod schema;
    pub(crate) mod source;
    pub(crate) mod starting_point;
}

/// Simulations of scenes that go on, and change.
mod running {
    pub(crate) mod courses;
    pub(crate) mod driven_into;
    pub(crate) mod jump;
    pub(crate) mod live;
    pub(crate) mod too_fast;
    pub(crate) mod under_way;
}

#[cfg(test)]
mod found_tests;

pub use bodies::body::BodyKey;
pub use bodies::carried::{CarriedBody, Wrench};
pub use bodies::friction::{FrictionCoefficients, FrictionKey};
pub use bodies::guides::{BodyForceKey, BodyTorqueKey, Guide};
pub use bodies::obstacles::{ObstacleKey, ShapeKey, Wall};
pub use building::engine_problem::Origins;
pub use building::setup::Setup;
pub use building::support_forces::{SupportForces, SupportLoad};
pub use holding::contact::{ContactSettings, SheetPairKey};
pub use holding::glue::{GlueKey, SeamBend, SeamSide};
pub use holding::supports::{CurveKey, Followed, Hold, SupportKey, SurfaceKey, SurfaceSide};
pub use holding::switch::{Condition, Threshold, When};
pub use loads::air::AirKey;
pub use loads::attached_flow::AttachedFlowKey;
pub use loads::follower_loads::{GasKey, Moment, Pressure};
pub use loads::forces::{Acceleration, Forces, Frame, Load};
pub use measures::measure::{Gauge, Measure, Quantity};
pub use measures::targets::{CreaseResidual, DrivenCrease, Residuals, Targets};
pub use measures::yielding::{YieldingAngles, YieldingCrease};
pub use meshes::direction::{Direction, TextureAxis, TextureDirection};
pub use meshes::drawing::DrawingFile;
pub use meshes::mesh::{DiagonalsKey, Mesh};
pub use meshes::mesh_file::{MeshFileKey, PolygonFaces};
pub use meshes::outline::{Outline, OutlineShape};
pub use meshes::pattern::{
    AlikeCreases, DegreeFourKey, Hypar, Kresling, MiuraKey, SquareTwist, Waterbomb, Yoshimura,
};
pub use meshes::selection::Selection;
pub use meshes::sequence::{MeshFrames, Outside, Sequence};
pub use meshes::strip_between::{CurveFile, StripBetween, StripCurve};
pub use meshes::up_axis::UpAxis;
pub use methods::chart::{
    ChartEquations, ChartKey, ChartPositions, ChartScheme, ChartSolver, Coordinates,
    NearSingularity, Substep,
};
pub use methods::integration::Integration;
pub use methods::method::{FallbackKey, Integrator, MethodKey, Taut};
pub use methods::output::Output;
pub use methods::stop::{Rest, Stop};
pub use running::live::{FailedStep, HoldError, LiveScene, Target};
pub use sheets::creases::{Crease, CreaseEdges, PatternEdges};
pub use sheets::curl::CurlKey;
pub use sheets::fold_group::FoldGroup;
pub use sheets::folding::FollowedFolds;
pub use sheets::folding::off_target;
pub use sheets::folding::{FoldResidual, FoldTargets, Folding};
pub use sheets::material::{MaterialKey, Plate};
pub use sheets::patch::Patch;
pub use sheets::sheet::{Bending, Elasticity, IsometryKey, RestShape, SheetKey};
pub use sheets::start::{Spin, StartKey};
pub use sheets::weight::Weight;
pub use sheets::yields::{CreaseYield, SheetYield};
pub use text::fold_scene::{FoldScene, Panels, Touch, path_value, two_digits};
pub use text::schema::{as_written, documented_schema, schema};
pub use text::source::{SceneFile, SceneFileError};
pub use text::starting_point::StartingPoint;
pub use time::pose::{MotionKey, Pose, Rotation, Turn};
pub use time::poses::{FramePose, Poses, TimedPose};
pub use time::profile::{Change, Course, InterpolationKey, ProfileKey};
pub use words::edit::{Edit, EditError};
pub use words::error::{MessageStyle, PlacedProblem, SceneError, SceneText};
pub use words::key::{Key, KeyError, KeyPart};
pub(crate) use words::part::{AnyPart, Part, Place, See, SeeMut};
pub(crate) use words::problem::Checks;
pub use words::problem::Problem;
pub(crate) use words::unit::Unit;
pub use words::unit::{UnitRange, UsualSize};
pub use words::warning::Warning;

pub use building::build::Kept;
pub use building::setup::Facts;
pub use holding::supports::frame_motion;
pub use meshes::mesh_file::Files;
pub use meshes::selection::{bounds, size};
pub use running::under_way::UnderWay;
pub use sheets::size::MEMORY_OF_FACE;
pub use whole::functions::{Function, Moved};
pub use whole::named_file::{FileKind, NamedFile};
pub use words::resolution::check_positions;

use bodies::body;
use bodies::obstacle_names;
use measures::measure;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sheets::creases;
use sheets::several;
use words::part;

/// The version of the format of scene files.
pub const VERSION: u32 = 1;

/// A scene.
///
/// ```
/// use isosheet_scenes::{Mesh, Scene, Selection, SheetKey, SupportKey};
/// use std::path::Path;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut scene = Scene::new(SheetKey::new(Mesh::Square { side: 0.21, level: 1 }));
/// scene.support.push(SupportKey::pin(Selection::Vertices(vec![20])));
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
    #[serde(with = "several")]
    #[schemars(with = "several::OneOrSeveral")]
    pub sheet: Vec<SheetKey>,
    /// Creases with rest angles.
    #[serde(default)]
    pub crease: Vec<Crease>,
    /// Folding to the angles of the FOLD file that is the mesh.
    #[serde(default)]
    pub folding: Option<Folding>,
    /// Seams: vertices that are glued to each other.
    #[serde(default)]
    pub glue: Vec<GlueKey>,
    /// Weights that are fixed to vertices.
    #[serde(default)]
    pub weight: Vec<Weight>,
    /// What holds the sheet.
    #[serde(default)]
    pub support: Vec<SupportKey>,
    /// Bodies that the sheet meets.
    #[serde(default)]
    pub obstacle: Vec<ObstacleKey>,
    /// Rigid bodies that respond.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub body: Vec<BodyKey>,
    /// Forces on the sheet.
    #[serde(default)]
    pub forces: Forces,
    /// The air around the sheet. Without it there is none.
    #[serde(default)]
    pub air: Option<AirKey>,
    /// Contact of the sheet with itself and with obstacles.
    #[serde(default)]
    pub contact: ContactSettings,
    /// Lengths that are read off the sheet at each step.
    #[serde(default)]
    pub measure: Vec<Measure>,
    /// How the motion is computed.
    #[serde(default)]
    pub method: MethodKey,
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
    pub fn new(sheet: SheetKey) -> Self {
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
            contact: ContactSettings::default(),
            measure: Vec::new(),
            method: MethodKey::default(),
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

    /// Numbers that are possible, and larger or smaller than for any sheet of this world.
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
        several::check(&self.sheet, &mut checks);
        part::check_all(self, &Place::of(root.clone()), &mut checks);
        self.check_names(&mut checks);
        if let Some(folding) = &self.folding {
            let key = root.name("folding");
            match several::one_of(&self.sheet, folding.sheet.as_deref(), &key, "the creases") {
                Ok(k) => folding.check(&self.sheet[k].mesh, &key, &mut checks),
                Err(problem) => checks.problems.push(problem),
            }
        }
        for (key, glue) in root.name("glue").entries(&self.glue) {
            glue.check(&self.sheet, &self.body, &key, &mut checks);
        }
        obstacle_names::check_names(&self.obstacle, &self.sheet, &self.body, &mut checks);
        body::check(&self.body, &self.sheet, &mut checks);
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
        if self.method.integrator == Integrator::Static && !self.body.is_empty() {
            checks.report(
                Key::root().name("method.integrator"),
                "rigid bodies that move by themselves have no place in a search for an equilibrium",
                "make them obstacles (`[[obstacle]]`), or choose `bdf2`",
            );
        }
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
        let differs = |(_, sheet): &(usize, &SheetKey)| sheet.damping != self.sheet[0].damping;
        if self.method.integrator == Integrator::Chart
            && let Some((number, _)) = others.find(differs)
        {
            let key = several::sheet_key(self.sheet.len(), number).name("damping");
            let message = "a chart damps all sheets alike, and the first one has another rate";
            checks.report(
                key,
                message,
                "give all sheets the same `damping`, or choose `bdf2`",
            );
        }
        let mut sheets = self.sheet.iter();
        if let Some(elastic) = sheets.find(|sheet| sheet.isometry() != IsometryKey::Rods) {
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
