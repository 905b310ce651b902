//! A model on its way from a scene.

use crate::bodies::obstacles;
use crate::holding::bond::Bond;
use crate::holding::switch::Holder;
use crate::loads::enclosed::EnclosedGauge;
use crate::measures::crease_gauge::CreaseGauges;
use crate::measures::targets::Targets;
use crate::meshes::mesh_file::Files;
use crate::meshes::sequence::Sequence;
use crate::placing::driven::DrivenObstacles;
use crate::placing::placed::{Form, PlacedSheets};
use crate::placing::placed_bodies::{PlacedBodies, Surface};
use crate::placing::slots::Slots;
use crate::time::led::LedMotions;
use crate::whole::switches::Switches;
use crate::words::error::SceneError;
use crate::words::key::Key;
use crate::words::problem::Problem;
use crate::{Origins, Scene};
use isosheet_dynamics::{Patched, PlateBending, PlateLaw, PointMotion, RigidMotion, SheetModel};
use isosheet_geometry as geometry;
use isosheet_mesh::wording::counted;
use isosheet_mesh::{Advice, EdgeId, VertexId};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// The laws of a plate, its clamped vertices and its creases.
pub(super) type PlateMadeOf = (Patched<PlateLaw>, Vec<VertexId>, Vec<EdgeId>);

/// What is kept of a scene, so that it need not be made again when the scene is built again: while it is the
/// same, or after changes between which the sheets have the same forms.
#[derive(Debug, Default)]
pub struct Kept {
    /// Its files.
    pub files: Files,
    /// Of each sheet, once they have been made.
    pub(super) forms: Vec<Arc<Form>>,
    /// The plate of each sheet that is flat without stress and clamped by no line.
    pub(super) plates: Slots<PlateMadeOf, Arc<PlateBending>>,
    /// The shapes of the obstacles.
    pub(super) shapes: Slots<obstacles::ShapeKey, geometry::Shape>,
    /// The motions that a program leads.
    pub(crate) led: Vec<Key>,
    /// Where the simulation starts, once that is known.
    pub(super) start: Option<StartPlaces>,
}

/// Where the vertices are at the start, `3V`, metres.
#[derive(Clone, Debug, Default)]
pub(super) struct StartPlaces {
    /// With the lengths that a file rounded.
    pub(super) mended: Vec<f64>,
    /// With the random displacements.
    pub(super) perturbed: Vec<f64>,
}

impl Kept {
    /// Nothing yet; paths of files are relative to `folder`.
    pub fn in_folder(folder: &Path) -> Self {
        Self {
            files: Files::in_folder(folder),
            ..Self::default()
        }
    }
}

/// A model on its way.
pub(super) struct Builder<'a> {
    pub(super) scene: &'a Scene,
    pub(super) kept: &'a mut Kept,
    /// What holds.
    pub(super) switches: &'a Switches,
    pub(super) sheets: PlacedSheets<'a>,
    pub(super) bodies: PlacedBodies<'a>,
    pub(super) driven: DrivenObstacles,
    /// What is seen and touches, where it is more than the sheets.
    pub(super) surface: Option<Surface>,
    /// Vertices that are glued to bodies, each with the number of the body.
    pub(super) glued_to_bodies: Vec<(VertexId, usize)>,
    /// Pairs of vertices that are glued to each other at the start.
    pub(super) glued: Vec<[VertexId; 2]>,
    /// The pairs of each seam that hold.
    pub(super) bonds: Vec<Option<Bond>>,
    /// Positions at the start, `3V`.
    pub(super) x: Vec<f64>,
    /// Absent only while it is replaced by a changed one.
    pub(super) model: Option<SheetModel>,
    pub(super) origins: Origins,
    /// The supports that hold slopes, with their vertices.
    pub(super) clamps: Vec<(usize, Vec<VertexId>, RigidMotion)>,
    pub(super) led: LedMotions,
    pub(super) modelled: Vec<String>,
    pub(super) targets: Targets,
    /// The creases of the scene that measures may be of.
    pub(super) creases: CreaseGauges,
    /// The edges at which sheets fold.
    pub(super) creased: Vec<EdgeId>,
    /// Gases and pressures that measures may be of, by their names.
    pub(super) enclosed: BTreeMap<String, EnclosedGauge>,
    /// The gases, with what they are called.
    pub(super) gases: Vec<(String, EnclosedGauge)>,
    /// As what sheets bend, by their numbers.
    pub(super) plates: BTreeMap<usize, Arc<PlateBending>>,
}

/// An error of the engine at a key.
pub(super) fn at<E: Advice>(key: &Key) -> impl Fn(E) -> SceneError {
    let key = key.clone();
    move |error| Problem::from_error(key.clone(), &error).into()
}

impl<'a> Builder<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        kept: &'a mut Kept,
        switches: &'a Switches,
    ) -> Result<Self, SceneError> {
        let key = Key::root().name("sheet");
        let sheets = PlacedSheets::new(&scene.sheet, &mut kept.forms, &mut kept.files)?;
        let bodies = PlacedBodies::new(&scene.body, &sheets, &mut kept.files)?;
        let (end, model_vertices) = bodies.counts(&sheets.union);
        let mut motion =
            |sequence: &Sequence, key: &Key| kept.files.sequence(sequence, scene.stop.time, key);
        let driven = DrivenObstacles::new(&scene.obstacle, end, model_vertices, &mut motion)?;
        let mass = driven.mass(bodies.mass(&sheets.union, sheets.mass(&scene.weight)?));
        let mut model = SheetModel::with_mass(&bodies.mesh(&sheets.union, &driven)?, mass)
            .and_then(|m| m.with_dampings(sheets.dampings()))
            .map_err(at(&key))?;
        let first_body = bodies.list.first().map(|body| body.first);
        if let Some(first) = first_body.or(driven.first()) {
            model = model.with_bodies_from(first);
        }
        if let Some(first) = driven.first() {
            model = model.with_driven_from(first);
        }
        for obstacle in &driven.list {
            for (number, vertex) in obstacle.surface.vertices.clone().enumerate() {
                let mesh = Arc::clone(&obstacle.motion);
                let motion = PointMotion::from(move |t: f64| mesh.position(number, t));
                let pinned = model.with_moving_pin(VertexId::from_index(vertex), motion);
                model = pinned.map_err(at(&Key::root().name("obstacle")))?;
            }
        }
        let mut modelled = Vec::new();
        if scene.sheet.iter().any(|sheet| sheet.damping > 0.0) {
            modelled.push("velocity damping".to_owned());
        }
        if !scene.weight.is_empty() {
            modelled.push(counted(scene.weight.len(), "weight", "weights"));
        }
        if !scene.body.is_empty() {
            modelled.push(counted(scene.body.len(), "rigid body", "rigid bodies"));
        }
        let surfaces = bodies.list.iter().map(|body| body.part.vertices.clone());
        let origins = Origins {
            bodies: surfaces.collect(),
            driven: driven.list.iter().map(|o| o.surface.clone()).collect(),
            obstacles: scene
                .obstacle
                .iter()
                .enumerate()
                .map(|(k, o)| o.called(k))
                .collect(),
            ..Origins::default()
        };
        let led = LedMotions::of(&kept.led);
        Ok(Self {
            scene,
            kept,
            switches,
            x: sheets
                .start
                .iter()
                .copied()
                .chain(bodies.start())
                .chain(driven.start())
                .collect(),
            surface: bodies.surface(&sheets.union, &driven)?,
            glued_to_bodies: Vec::new(),
            glued: Vec::new(),
            bonds: Vec::new(),
            sheets,
            bodies,
            driven,
            model: Some(model),
            origins,
            clamps: Vec::new(),
            led,
            modelled,
            targets: Targets::default(),
            creases: CreaseGauges::default(),
            creased: Vec::new(),
            enclosed: BTreeMap::new(),
            gases: Vec::new(),
            plates: BTreeMap::new(),
        })
    }

    pub(super) fn change<E>(
        &mut self,
        change: impl FnOnce(SheetModel) -> Result<SheetModel, E>,
        error: impl Fn(E) -> SceneError,
    ) -> Result<(), SceneError> {
        let model = self.model.take().map(change).transpose();
        self.model = model.map_err(error)?;
        Ok(())
    }

    pub(super) fn model(&self) -> &SheetModel {
        let model = self.model.as_ref();
        model.expect("a change that fails ends the building")
    }

    pub(super) fn count(&mut self, number: usize, one: &str, more: &str) {
        if number > 0 {
            self.modelled.push(counted(number, one, more));
        }
    }

    pub(super) fn position(&self, v: VertexId) -> [f64; 3] {
        self.x.as_chunks::<3>().0[v.index()]
    }

    /// The positions that a support holds, as they are where its motion is zero.
    pub(super) fn held_positions(&self, number: usize) -> &[f64] {
        let of = Holder::Support(number);
        self.switches.rest(of).unwrap_or(&self.x)
    }

    /// The position of a vertex that a support holds, as it is where its motion is zero.
    pub(super) fn held_position(&self, number: usize, v: VertexId) -> [f64; 3] {
        self.held_positions(number).as_chunks::<3>().0[v.index()]
    }
}
