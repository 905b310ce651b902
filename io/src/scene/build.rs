//! From a scene to a simulation.

use super::bodies;
use super::creases::{EdgeFolds, FoldSprings};
use super::error::SceneError;
use super::folding::{FLAT_STIFFNESS, FoldTargets};
use super::guides::Guide;
use super::in_words::{elastic_in_words, materials_in_words};
use super::key::Key;
use super::mesh::Mesh;
use super::mesh_file::Files;
use super::obstacles;
use super::placed::{Form, PlacedSheet, PlacedSheets};
use super::placed_bodies::{JointMotion, PlacedBodies, Surface};
use super::pose::Motion;
use super::problem::Problem;
use super::sheet::{Bending, Elasticity, Isometry, RestShape};
use super::slots::Slots;
use super::step_path::check_step;
use super::supports::{Hold, frame_motion};
use super::targets::{DrivenCrease, Targets};
use super::{Air, Measure, Origins, Scene, Setup};
use isosheet_collide as collide;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, ContactsError, Obstacle};
use isosheet_dynamics::constraint::{Line, Plane, Side};
use isosheet_dynamics::{
    AccelerationField, Attachment, CreaseSprings, ElasticSheet, ElasticSheetError, Glue,
    JointSpring, LineClamp, PAPER_GRAVITY, Patched, PlateBending, PlateEdges, PlateLaw,
    PointMotion, PointProfile, Potential, PotentialOfPart, RigidDisplacement, RigidProfile,
    SheetModel, SimulationError, State, VertexConstraint, VertexLoad, leave_flat_in,
    project_positions, start_of_folding,
};
use isosheet_mesh::wording::counted;
use isosheet_mesh::{Advice, EdgeId, MassMatrix, VertexId};
use nalgebra::{Isometry3, Point3, Vector3};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

impl Scene {
    /// Makes everything that a simulation needs. Masses are lumped: a third of that of each face at each of
    /// its corners. Paths are relative to `folder`.
    ///
    /// # Errors
    /// [`SceneError`], with all problems of the values or the first one of what is made of them.
    pub fn build(&self, folder: &Path) -> Result<Setup, SceneError> {
        self.validate()?;
        self.build_with(&mut Kept::in_folder(folder))
    }

    /// The same for a scene that has been checked, with what is kept of it.
    pub(super) fn build_with(&self, kept: &mut Kept) -> Result<Setup, SceneError> {
        let mut builder = Builder::new(self, kept)?;
        builder.add_forces()?;
        builder.add_supports()?;
        builder.add_guides()?;
        builder.add_body_forces()?;
        builder.mend_lengths();
        builder.add_folds()?;
        builder.add_isometry()?;
        builder.perturb()?;
        builder.add_glue()?;
        let (contacts, obstacles) = builder.contacts()?;
        let gauge = |(k, measure): (usize, &Measure)| {
            let key = Key::root().name("measure").entry(k);
            measure.gauge(&key, &builder.sheets, &builder.bodies)
        };
        let measures = self.measure.iter().enumerate().map(gauge);
        let measures = measures.collect::<Result<_, _>>()?;
        let setup = builder.finish(contacts, obstacles);
        check_step(self, &setup.model, &setup.start.v)?;
        Ok(Setup { measures, ..setup })
    }
}

/// Where a flat sheet of rods starts that folds to angles, by its own numbers, from positions `x`.
fn off_flat(
    own: &PlacedSheet<'_>,
    model: &SheetModel,
    targets: &FoldTargets,
    x: &[f64],
) -> Option<Vec<f64>> {
    let masses = &model.mass().vertex[own.part.vertices.clone()];
    let mass = MassMatrix::from_vertex_masses(masses.to_vec()).ok()?;
    let first = own.part.vertices.start as u32;
    let pins = model.pins().into_iter();
    let pins = pins.filter(|v| own.part.vertices.contains(&v.index()));
    let pins: Vec<VertexId> = pins.map(|v| VertexId(v.0 - first)).collect();
    let driven = targets.creases.iter().map(|(e, angle)| (*e, *angle, 1.0));
    let flat = targets.flat.iter().map(|e| (*e, 0.0, FLAT_STIFFNESS));
    let edges: Vec<_> = driven.chain(flat).collect();
    start_of_folding(&own.form.placed, &mass, &pins, x, &edges)
}

/// Relative error of edge lengths to which positions are projected: that of accepted steps.
const EXACT: f64 = 1e-12;

/// Largest relative error of an edge length that is taken for rounding. A file of six digits rounds the
/// coordinates of a sheet of size 1 by 5e-7, and edges of a hundredth of the sheet by 1e-4 of their length.
const ROUNDING: f64 = 1e-4;

/// The laws of a plate, its clamped vertices and its creases.
type PlateMadeOf = (Patched<PlateLaw>, Vec<VertexId>, Vec<EdgeId>);

/// What is kept of a scene, so that it need not be made again when the scene is built again: while it is the
/// same, or after changes between which the sheets have the same forms.
#[derive(Debug, Default)]
pub(crate) struct Kept {
    pub(crate) files: Files,
    /// Of each sheet, once they have been made.
    forms: Vec<Arc<Form>>,
    /// The plate of each sheet that is flat without stress and clamped by no line.
    plates: Slots<PlateMadeOf, Arc<PlateBending>>,
    /// Those of the obstacles.
    shapes: Slots<obstacles::Shape, collide::Shape>,
}

impl Kept {
    /// Nothing yet; paths of files are relative to `folder`.
    pub(crate) fn in_folder(folder: &Path) -> Self {
        Self {
            files: Files::in_folder(folder),
            ..Self::default()
        }
    }
}

/// A model on its way.
struct Builder<'a> {
    scene: &'a Scene,
    kept: &'a mut Kept,
    sheets: PlacedSheets<'a>,
    bodies: PlacedBodies<'a>,
    /// What is seen and touches, where it is more than the sheets.
    surface: Option<Surface>,
    /// Vertices that are glued to bodies, each with the number of the body.
    glued_to_bodies: Vec<(VertexId, usize)>,
    /// Positions at the start, `3V`.
    x: Vec<f64>,
    /// Absent only while it is replaced by a changed one.
    model: Option<SheetModel>,
    origins: Origins,
    /// The supports that hold slopes, with their vertices.
    clamps: Vec<(usize, Vec<VertexId>, RigidDisplacement)>,
    modelled: Vec<String>,
    targets: Targets,
    /// As what sheets bend, by their numbers.
    plates: BTreeMap<usize, Arc<PlateBending>>,
}

/// An error of the engine at a key.
fn at<E: Advice>(key: &Key) -> impl Fn(E) -> SceneError {
    let key = key.clone();
    move |error| Problem::from_error(key.clone(), &error).into()
}

impl<'a> Builder<'a> {
    fn new(scene: &'a Scene, kept: &'a mut Kept) -> Result<Self, SceneError> {
        let key = Key::root().name("sheet");
        let sheets = PlacedSheets::new(&scene.sheet, &mut kept.forms, &mut kept.files)?;
        let bodies = PlacedBodies::new(&scene.body, &sheets, &mut kept.files)?;
        let damping = scene.sheet[0].damping;
        let mass = bodies.mass(&sheets.union, sheets.mass(&scene.weight)?);
        let mut model = SheetModel::with_mass(&bodies.mesh(&sheets.union)?, mass)
            .and_then(|m| m.with_damping(damping))
            .map_err(at(&key))?;
        if let Some(first) = bodies.list.first() {
            model = model.with_bodies_from(first.first);
        }
        let mut modelled = Vec::new();
        if damping > 0.0 {
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
            ..Origins::default()
        };
        Ok(Self {
            scene,
            kept,
            x: sheets.start.iter().copied().chain(bodies.start()).collect(),
            surface: bodies.surface(&sheets.union)?,
            glued_to_bodies: Vec::new(),
            sheets,
            bodies,
            model: Some(model),
            origins,
            clamps: Vec::new(),
            modelled,
            targets: Targets::default(),
            plates: BTreeMap::new(),
        })
    }

    /// Replaces the model by what `change` makes of it.
    fn change<E>(
        &mut self,
        change: impl FnOnce(SheetModel) -> Result<SheetModel, E>,
        error: impl Fn(E) -> SceneError,
    ) -> Result<(), SceneError> {
        let model = self.model.take().map(change).transpose();
        self.model = model.map_err(error)?;
        Ok(())
    }

    fn model(&self) -> &SheetModel {
        let model = self.model.as_ref();
        model.expect("a change that fails ends the building")
    }

    fn add_forces(&mut self) -> Result<(), SceneError> {
        let forces = &self.scene.forces;
        let key = Key::root().name("forces");
        if let Some(gravity) = forces.gravity {
            self.change(
                |m| Ok(m.with_acceleration(gravity)),
                at::<SimulationError>(&key),
            )?;
            self.modelled.push("gravity".into());
        }
        for (key, load) in key.name("load").entries(&forces.load) {
            let vertices = self
                .sheets
                .vertices(load.sheet.as_deref(), &load.at, &key)?;
            let size = load.size.scaled(1.0 / vertices.len() as f64);
            let topology = self.model().topology();
            let load = VertexLoad::new(topology, &vertices, load.direction, size);
            let load = load.map_err(at(&key))?;
            self.change(|m| Ok(m.with_force(load)), at::<SimulationError>(&key))?;
        }
        for (key, field) in key.name("acceleration").entries(&forces.acceleration) {
            let weights = self.model().mass().row_sums(self.model().topology());
            let size = field.size.as_given();
            let field = AccelerationField::new(weights, field.direction, size);
            let field = field.map_err(at(&key))?;
            self.change(|m| Ok(m.with_force(field)), at::<SimulationError>(&key))?;
        }
        self.count(forces.load.len(), "load", "loads");
        let fields = ["field of acceleration", "fields of acceleration"];
        self.count(forces.acceleration.len(), fields[0], fields[1]);
        if let Some(air) = self.scene.air.as_ref().map(Air::as_engine) {
            self.change(|m| m.with_air(air), at(&Key::root().name("air")))?;
            self.modelled.push("air".into());
        }
        Ok(())
    }

    /// Names something that is modelled some times, if it is.
    fn count(&mut self, number: usize, one: &str, more: &str) {
        if number > 0 {
            self.modelled.push(counted(number, one, more));
        }
    }

    fn add_supports(&mut self) -> Result<(), SceneError> {
        for (k, support) in self.scene.support.iter().enumerate() {
            let key = Key::root().name("support").entry(k);
            let name = support.sheet.as_deref();
            let mut vertices = self.sheets.vertices(name, &support.at, &key)?;
            if let Some(motion) = support.hold.clamp_motion() {
                let slides = matches!(support.hold, Hold::SlidingClamp { .. });
                vertices.extend(self.clamped_faces(&vertices, slides, &key)?);
                let motion = motion.of_body(Isometry3::identity());
                self.clamps.push((k, vertices.clone(), motion));
            }
            for &v in &vertices {
                self.check_free(v, k, &key)?;
            }
            match &support.hold {
                Hold::SlidingClamp { direction, motion } => {
                    for &v in &vertices {
                        let point = self.position(v);
                        let line = Line::new(point, *direction).map_err(at(&key))?;
                        let constraint = VertexConstraint::on_curve(v, line);
                        self.constrain(constraint, motion, k)?;
                    }
                }
                Hold::Pin | Hold::Clamp => self.change(|m| m.with_pins(&vertices), at(&key))?,
                Hold::MovingPin(motion) | Hold::MovingClamp(motion) => {
                    for &v in &vertices {
                        let motion = pin_motion(motion, self.position(v));
                        self.change(|m| m.with_moving_pin(v, motion), at(&key))?;
                    }
                }
                Hold::Curve { shape, motion } => {
                    for &v in &vertices {
                        let constraint = shape.constrain(v).map_err(at(&key))?;
                        self.constrain(constraint, motion, k)?;
                    }
                }
                Hold::Surface {
                    shape,
                    side,
                    motion,
                } => {
                    for &v in &vertices {
                        let constraint = shape.constrain(v, side.as_engine());
                        let constraint = constraint.map_err(at(&key))?;
                        self.constrain(constraint, motion, k)?;
                    }
                }
            }
            if support.hold.is_pin() {
                self.origins.pins.extend(vertices.iter().map(|&v| (v, k)));
            }
        }
        self.count(self.scene.support.len(), "support", "supports");
        self.name_hinges();
        Ok(())
    }

    /// Says which supports are hinges: pins at edges of a sheet with bending stiffness that hold no face, and do
    /// not turn.
    fn name_hinges(&mut self) {
        let topology = self.sheets.union.topology();
        for (k, support) in self.scene.support.iter().enumerate() {
            let turns = match &support.hold {
                Hold::Pin => false,
                Hold::MovingPin(motion) => motion.rotation.is_some(),
                _ => continue,
            };
            let held = |v: &VertexId| self.origins.pins.get(v) == Some(&k);
            let bends = self.sheets.list.iter().any(|sheet| {
                let mut vertices = sheet.part.vertices.clone().map(VertexId::from_index);
                sheet.of.bending() != Bending::None && vertices.any(|v| held(&v))
            });
            let has_edge = || topology.edges().iter().any(|ends| ends.iter().all(held));
            let has_face = || topology.faces().iter().any(|f| f.iter().all(held));
            if bends && !turns && has_edge() && !has_face() {
                self.modelled.push(format!("a hinge at `support[{k}]`"));
            }
        }
    }

    /// What is pinned besides the vertices of a clamp: of a sheet without a plate the third corners of the faces
    /// at the edges between them.
    fn clamped_faces(
        &self,
        vertices: &[VertexId],
        slides: bool,
        key: &Key,
    ) -> Result<Vec<VertexId>, Problem> {
        let topology = self.sheets.union.topology();
        let held: BTreeSet<VertexId> = vertices.iter().copied().collect();
        let is_held = |e: &EdgeId| topology.edges()[e.index()].iter().all(|v| held.contains(v));
        let edges: Vec<EdgeId> = topology.edge_ids().filter(is_held).collect();
        if edges.is_empty() {
            return Err(Problem::new(
                key.name("at"),
                "a clamp needs an edge of the mesh between two of its vertices",
                "name neighbours along the line that is clamped, or use `pin`",
            ));
        }
        let mut third = BTreeSet::new();
        for PlacedSheet { of, part, .. } in &self.sheets.list {
            let own = edges.iter().filter(|e| part.edges.contains(&e.index()));
            let faces = own.flat_map(|e| topology.edge_faces(*e)).flatten();
            let corners = faces.flat_map(|f| topology.faces()[f.index()]);
            let corners: Vec<VertexId> = corners.filter(|v| !held.contains(v)).collect();
            if of.plate().is_some() || corners.is_empty() {
                continue;
            }
            if slides {
                return Err(Problem::new(
                    key.name("hold"),
                    "a sliding clamp holds the slope of a plate, and this sheet has none",
                    "give the sheet `bending` as a `plate`, or a `material`",
                ));
            }
            third.extend(corners);
        }
        Ok(third.into_iter().collect())
    }

    /// Holds the corners of guided bodies.
    fn add_guides(&mut self) -> Result<(), SceneError> {
        for k in 0..self.bodies.list.len() {
            let body = &self.bodies.list[k];
            let Some(guide) = &body.of.guide else {
                continue;
            };
            let (key, vertices) = (body.key.name("guide").name(guide.name()), body.vertices());
            let motion = body.guided_motion(guide, &self.x)?;
            self.origins.guides.extend(vertices.map(|v| (v, k)));
            match guide {
                Guide::Ball { .. } => self.change(|m| m.with_pins(&vertices[..1]), at(&key))?,
                Guide::Hinge { .. } => self.change(|m| m.with_pins(&vertices[..2]), at(&key))?,
                Guide::Slider { direction, .. } => {
                    for v in [vertices[0], vertices[1]] {
                        let line = Line::new(self.position(v), *direction).map_err(at(&key))?;
                        let constraint = VertexConstraint::on_curve(v, line);
                        self.change(|m| m.with_constraint(constraint), at(&key))?;
                    }
                    // The third corner is beside the line of the other two.
                    let [a, b, c] = [0, 1, 2].map(|i| Vector3::from(self.position(vertices[i])));
                    let normal = (b - a).cross(&(c - a));
                    let plane = Plane::new(c.into(), normal.into()).map_err(at(&key))?;
                    let constraint = VertexConstraint::on_surface(vertices[2], plane, Side::On);
                    self.change(|m| m.with_constraint(constraint), at(&key))?;
                }
            }
            if let Some(JointMotion {
                coordinate,
                stiffness,
                rest,
                damping,
            }) = motion
            {
                if stiffness > 0.0 {
                    let spring = JointSpring::new(coordinate.clone(), stiffness, rest);
                    let spring = spring.map_err(at(&key))?;
                    self.change(
                        |m| Ok(m.with_potential(spring)),
                        at::<SimulationError>(&key),
                    )?;
                }
                if damping > 0.0 {
                    self.change(|m| m.with_joint_damper(coordinate, damping), at(&key))?;
                }
            }
        }
        let guided = self
            .bodies
            .list
            .iter()
            .filter(|body| body.of.guide.is_some());
        self.count(guided.count(), "guide of a body", "guides of bodies");
        Ok(())
    }

    fn add_body_forces(&mut self) -> Result<(), SceneError> {
        let (mut forces, mut torques) = (0, 0);
        for k in 0..self.bodies.list.len() {
            let of = self.bodies.list[k].of;
            for (i, force) in of.force.iter().enumerate() {
                let (key, force) = self.bodies.list[k].force(i, force)?;
                self.change(|m| Ok(m.with_force(force)), at::<SimulationError>(&key))?;
            }
            for (i, torque) in of.torque.iter().enumerate() {
                let (key, torque) = self.bodies.list[k].torque(i, torque)?;
                self.change(|m| Ok(m.with_force(torque)), at::<SimulationError>(&key))?;
            }
            forces += of.force.len();
            torques += of.torque.len();
        }
        self.count(forces, "force on a body", "forces on bodies");
        self.count(torques, "torque on a body", "torques on bodies");
        Ok(())
    }

    /// A vertex may be pinned twice at rest; with anything else a pin would decide silently.
    fn check_free(&self, v: VertexId, number: usize, key: &Key) -> Result<(), Problem> {
        let supports = &self.scene.support;
        let constrained = self
            .model()
            .constraints()
            .iter()
            .position(|c| c.vertex() == v);
        let constrained = constrained.map(|c| self.origins.constraints[c]);
        let pins = supports[number].hold.is_pin();
        let other = match self.origins.pins.get(&v) {
            Some(&k) if [k, number].iter().any(|k| !supports[*k].hold.is_at_rest()) => Some(k),
            _ => constrained.filter(|_| pins),
        };
        match other {
            None => Ok(()),
            Some(k) => Err(Problem::new(
                key.name("at"),
                format!("vertex {} is held by `support[{k}]` already", v.index()),
                "let the selections of the two supports have no vertex in common",
            )),
        }
    }

    fn position(&self, v: VertexId) -> [f64; 3] {
        self.x.as_chunks::<3>().0[v.index()]
    }

    fn constrain(
        &mut self,
        constraint: VertexConstraint,
        motion: &Motion,
        number: usize,
    ) -> Result<(), SceneError> {
        let key = Key::root().name("support").entry(number).name("hold");
        let constraint = match frame_motion(motion) {
            None => constraint,
            Some(motion) => constraint.moving(motion),
        };
        self.change(|m| m.with_constraint(constraint), at(&key))?;
        self.origins.constraints.push(number);
        Ok(())
    }

    /// Bending stiffness and the springs of folds, sheet by sheet.
    fn add_folds(&mut self) -> Result<(), SceneError> {
        let mut modelled = BTreeSet::new();
        for number in 0..self.sheets.list.len() {
            let springs = self.fold_springs(number)?;
            modelled.extend(self.add_bending(number, &springs.creases())?);
            self.add_springs(number, springs)?;
        }
        self.modelled
            .extend(modelled.into_iter().map(str::to_owned));
        self.count(self.scene.crease.len(), "crease", "creases");
        if self.targets.folding.is_some() {
            self.modelled.push("folding to given angles".into());
        }
        Ok(())
    }

    /// Adds a potential that was made for one of the sheets.
    fn add_potential_of(&mut self, number: usize, potential: impl Potential + 'static) {
        let part = match &self.sheets.list[..] {
            [_] => None,
            list => Some(&list[number].part),
        };
        let model = self.model.take();
        self.model = model.map(|model| match part {
            None => model.with_potential(potential),
            Some(part) => model.with_potential(PotentialOfPart::new(potential, part)),
        });
    }

    /// Returns what is modelled, in words.
    fn add_bending(
        &mut self,
        number: usize,
        creases: &[EdgeId],
    ) -> Result<Vec<&'static str>, SceneError> {
        let sheet = &self.sheets.list[number];
        let PlacedSheet { of, key, form, .. } = sheet;
        let (of, placed) = (*of, &form.placed);
        let yields = of.yields();
        let laws = sheet.patched.map(|own| own.plate());
        let [key, yield_key] = ["bending", "yield"].map(|name| key.name(name));
        let mut modelled = Vec::new();
        if yields.is_some() {
            modelled.push("bends that stay");
        }
        match (of.bending(), of.plate()) {
            (Bending::Hinges { rigidity }, _) => {
                let springs = CreaseSprings::bending_beside(placed, rigidity, creases);
                let mut springs = springs.map_err(at(&key))?;
                if of.rest == RestShape::Mesh {
                    springs = springs.curved(placed);
                }
                if let Some(yields) = yields {
                    let yielding = springs.with_yield(placed, yields);
                    springs = yielding.map_err(at(&yield_key))?;
                }
                modelled.push("bending stiffness at edges");
                if of.elasticity().is_some() {
                    let law = Patched::everywhere(rigidity.into());
                    self.plate(number, law, creases, &[])?;
                }
                self.add_potential_of(number, springs);
            }
            (_, None) => {}
            (_, Some(ground)) => {
                let law = laws.map(|law| law.clone().unwrap_or_else(|| ground.clone()));
                modelled.push("bending stiffness of a plate");
                let curls = of.curl.is_some();
                let (supports, clamps): (Vec<usize>, Vec<LineClamp>) =
                    self.line_clamps(number).into_iter().unzip();
                self.origins.clamps.extend(supports);
                let own = self.plate(number, law, creases, &clamps)?;
                if curls {
                    modelled.push("curl");
                }
                self.add_potential_of(number, own);
            }
        }
        Ok(modelled)
    }

    /// The pinned vertices of one of the sheets, by its own numbers.
    fn clamped(&self, number: usize) -> Vec<VertexId> {
        let part = &self.sheets.list[number].part;
        let pins = self.model().pins().into_iter();
        let own = pins.filter(|v| part.vertices.contains(&v.index()));
        own.map(|v| part.local_vertex(v)).collect()
    }

    /// The clamps of a sheet along lines of its vertices, each with the number of its support.
    fn line_clamps(&self, number: usize) -> Vec<(usize, LineClamp)> {
        let part = &self.sheets.list[number].part;
        let of_clamp = |(support, vertices, motion): &(usize, Vec<VertexId>, RigidDisplacement)| {
            let own = vertices
                .iter()
                .filter(|v| part.vertices.contains(&v.index()));
            let clamp = LineClamp {
                vertices: own.map(|v| part.local_vertex(*v)).collect(),
                positions: self.x[part.coordinates()].to_vec(),
                motion: motion.clone().into(),
            };
            (!clamp.vertices.is_empty()).then_some((*support, clamp))
        };
        self.clamps.iter().filter_map(of_clamp).collect()
    }

    /// The plate as which a sheet bends, which its elasticity in the plane knows, too. One that is flat without
    /// stress, stays so, and has no clamps along lines is kept.
    fn plate(
        &mut self,
        number: usize,
        law: Patched<PlateLaw>,
        creases: &[EdgeId],
        clamps: &[LineClamp],
    ) -> Result<Arc<PlateBending>, SceneError> {
        let clamped = self.clamped(number);
        let PlacedSheet {
            of,
            key,
            form,
            patched,
            ..
        } = &self.sheets.list[number];
        let placed = &form.placed;
        let held = |law: &Patched<PlateLaw>, pinned: &[VertexId], creases: &[EdgeId]| {
            let edges = PlateEdges {
                pinned,
                creases,
                clamps,
            };
            PlateBending::patched(placed, law, &edges).map_err(at(&key.name("bending")))
        };
        let (curl, yields) = (of.natural_curvature(), of.yields());
        let stays_flat = curl.is_none() && of.rest == RestShape::Flat && yields.is_none();
        let plate = if stays_flat && clamps.is_empty() {
            let made_of = (law, clamped, creases.to_vec());
            let make =
                |(law, clamped, creases): &PlateMadeOf| held(law, clamped, creases).map(Arc::new);
            self.kept.plates.get(number, made_of, make)?
        } else {
            let mut plate = held(&law, &clamped, creases)?;
            if of.rest == RestShape::Mesh {
                plate = plate.curved(placed);
            }
            if let Some(curl) = curl {
                let curled = match &form.curled {
                    Some(shape) => plate.curled_as(placed, shape, curl.profile),
                    None => plate.with_curl(placed, curl),
                };
                plate = curled.map_err(at(&key.name("curl")))?;
            }
            if let Some(yields) = yields {
                let yields = patched.map(|own| own.yields().unwrap_or(yields));
                let yielding = plate.with_yields(placed, &yields);
                plate = yielding.map_err(at(&key.name("yield")))?;
            }
            Arc::new(plate)
        };
        self.plates.insert(number, Arc::clone(&plate));
        Ok(plate)
    }

    /// The springs of the creases and of `[folding]` in one of the sheets, by its own edges.
    fn fold_springs(&mut self, number: usize) -> Result<FoldSprings, SceneError> {
        let mut springs = FoldSprings::default();
        let own = &self.sheets.list[number];
        let is_own = |name: Option<&str>, key: &Key, what| {
            self.sheets
                .one(name, key, what)
                .map(|named| std::ptr::eq(named, own))
        };
        for (k, crease) in self.scene.crease.iter().enumerate() {
            let key = Key::root().name("crease").entry(k);
            if is_own(crease.sheet.as_deref(), &key, "the edges")? {
                let found = crease.springs(&key, &own.form.unplaced, own.form.roles.as_ref())?;
                let driven = DrivenCrease::of(k, &found, |e| own.part.edge(e));
                self.targets.creases.extend(driven);
                springs.add(key, crease.folds(), found);
            }
        }
        if let (Some(folding), Mesh::File(file)) = (&self.scene.folding, &own.of.mesh) {
            let key = Key::root().name("folding");
            if is_own(folding.sheet.as_deref(), &key, "the creases")? {
                let mut targets =
                    folding.targets(&key, file, &own.form.unplaced, &mut self.kept.files)?;
                let model = self.model.as_ref().expect("it is there between changes");
                let x = &mut self.x[own.part.coordinates()];
                if own.of.isometry() == Isometry::Rods
                    && let Some(start) = off_flat(own, model, &targets, x)
                {
                    x.copy_from_slice(&start);
                    self.modelled
                        .push("a start off the flat state, towards the angles".into());
                }
                let [driven, flat] = folding.springs(&targets, own.of, &own.form.placed, x);
                springs.add(key.clone(), EdgeFolds::Yes, driven);
                springs.add(key, EdgeFolds::No, flat);
                targets.renumber(|e| own.part.edge(e));
                self.targets.folding = Some(targets);
            }
        }
        springs.put_in_sheet(&own.form.placed, own.of.bending().rigidity());
        Ok(springs)
    }

    fn add_springs(&mut self, number: usize, springs: FoldSprings) -> Result<(), SceneError> {
        for (key, springs) in springs.into_groups() {
            let topology = self.sheets.list[number].form.placed.topology();
            let springs = CreaseSprings::new(topology, springs);
            self.add_potential_of(number, springs.map_err(at(&key))?);
        }
        Ok(())
    }

    fn add_isometry(&mut self) -> Result<(), SceneError> {
        let mut elastic = Vec::new();
        for (number, placed) in self.sheets.list.iter().enumerate() {
            let PlacedSheet { of, key, part, .. } = placed;
            let Some(elasticity) = of.elasticity() else {
                continue;
            };
            let key = key.name(match of.isometry {
                Some(_) => "isometry",
                None => "material",
            });
            let plate = self.plates.get(&number).map(Arc::as_ref);
            let sheet = elastic_sheet(placed, elasticity, plate);
            let sheet = sheet.map_err(at(&key))?;
            let words = elastic_in_words(&sheet);
            if !self.modelled.contains(&words) {
                self.modelled.push(words);
            }
            elastic.push((sheet, part.clone()));
        }
        if elastic.is_empty() {
            self.modelled.push("rigid rods".into());
            return Ok(());
        }
        let key = Key::root().name("sheet");
        let faces = self.model().topology().face_count();
        let elastic = ElasticSheet::union(elastic, faces).map_err(at(&key))?;
        self.change(|m| m.with_elastic_sheet(elastic), at(&key))
    }

    /// Gives the positions of a start file the rest lengths that the few digits of the file have rounded.
    /// What is further off, or has no such positions nearby, stays as it is, and the engine says what is
    /// wrong with it.
    fn mend_lengths(&mut self) {
        let sheets = &self.scene.sheet;
        let is_rigid = sheets[0].isometry() == Isometry::Rods;
        if !is_rigid || sheets.iter().all(|sheet| sheet.start.file.is_none()) {
            return;
        }
        if (EXACT..=ROUNDING).contains(&self.model().rods().max_strain(&self.x)) {
            let mut mended = self.x.clone();
            if project_positions(self.model(), &mut mended, EXACT).is_ok() {
                self.x = mended;
            }
        }
    }

    fn perturb(&mut self) -> Result<(), SceneError> {
        let mut x = std::mem::take(&mut self.x);
        let mut is_perturbed = false;
        for PlacedSheet { of, part, .. } in &self.sheets.list {
            let (size, seed) = (of.start.perturbation, of.start.seed);
            if size > 0.0 {
                leave_flat_in(self.model(), part.vertices.clone(), &mut x, size, seed)
                    .map_err(|e| SceneError::from(self.origins.of_start(&e)))?;
                is_perturbed = true;
            }
        }
        self.x = x;
        if is_perturbed {
            self.modelled
                .push("random displacement at the start".into());
        }
        Ok(())
    }

    fn add_glue(&mut self) -> Result<(), SceneError> {
        let rigidity = self.scene.sheet.iter().map(|s| s.bending().rigidity());
        let rigidity = rigidity.fold(0.0, f64::max);
        let norm = |g: [f64; 3]| g.iter().map(|c| c * c).sum::<f64>().sqrt();
        let gravity = self.scene.forces.gravity.map(norm).filter(|g| *g > 0.0);
        let gravity = gravity.unwrap_or(norm(PAPER_GRAVITY));
        for (key, seam) in Key::root().name("glue").entries(&self.scene.glue) {
            let model = self.model();
            let (mass, length) = (model.mass().total(), self.sheets.union.mean_length());
            let stiffness = seam.stiffness(mass, gravity, rigidity, length);
            let number = seam
                .body()
                .and_then(|name| bodies::number_of(&self.scene.body, name));
            if let Some(number) = number {
                let body = &self.bodies.list[number];
                let vertices = seam.first_vertices(&self.sheets, &key)?;
                let glued = vertices.iter().map(|v| (*v, number));
                self.glued_to_bodies.extend(glued);
                let carried = |v: VertexId| (v, body.body.carried(self.position(v), body.first));
                let pairs = vertices.into_iter().map(carried).collect();
                let attachment = Attachment::new(pairs, stiffness).map_err(at(&key))?;
                self.change(
                    |m| Ok(m.with_potential(attachment)),
                    at::<SimulationError>(&key),
                )?;
                continue;
            }
            let pairs = seam.pairs(&self.sheets, &key)?;
            let model = self.model();
            let closing = seam.closing.as_given();
            let glue = Glue::new(model.topology(), &pairs, stiffness, closing, &self.x);
            let glue = glue.map_err(at(&key))?;
            self.targets.seams.push(glue.clone());
            self.change(|m| Ok(m.with_potential(glue)), at::<SimulationError>(&key))?;
        }
        self.count(self.scene.glue.len(), "seam", "seams");
        Ok(())
    }

    /// The state at the start. Pinned vertices move with their pins.
    fn start(&mut self) -> State {
        let mut v = vec![0.0; self.x.len()];
        for PlacedSheet { of, part, .. } in &self.sheets.list {
            if !of.start.is_moving() {
                continue;
            }
            let points = self.x[part.coordinates()].as_chunks::<3>().0;
            let masses = &self.model().mass().vertex[part.vertices.clone()];
            let moment = points
                .iter()
                .zip(masses)
                .map(|(p, m)| *m * Vector3::from(*p));
            let centre = moment.sum::<Vector3<f64>>() / masses.iter().sum::<f64>();
            let velocities = of.start.velocities(points, centre);
            v[part.coordinates()].copy_from_slice(velocities.as_flattened());
        }
        for body in &self.bodies.list {
            let first = 3 * body.first.index();
            v[first..first + 12].copy_from_slice(body.velocities().as_flattened());
        }
        for pin in self.model().pins() {
            v[3 * pin.index()..3 * pin.index() + 3].fill(0.0);
        }
        if v.iter().any(|v| *v != 0.0) {
            self.modelled.push("velocities at the start".into());
        }
        State::moving(std::mem::take(&mut self.x), v)
    }

    fn finish(mut self, contacts: Option<Contacts>, obstacles: Vec<Obstacle>) -> Setup {
        let start = self.start();
        let model = self.model.take();
        let sheets = &self.sheets.list;
        let part = |sheet: &PlacedSheet<'_>| {
            let name = sheet.of.name.clone();
            (name.unwrap_or_else(|| "sheet".into()), sheet.part.clone())
        };
        let of_bodies = self.bodies.list.iter().enumerate();
        let of_bodies = of_bodies.map(|(k, body)| (body.of.name(k), body.part.clone()));
        let parts: Vec<_> = match &sheets[..] {
            [_] if self.bodies.list.is_empty() => Vec::new(),
            several => several.iter().map(part).chain(of_bodies).collect(),
        };
        let of_sheets = self.sheets.warnings(self.scene);
        let mut fold_assignments = self.sheets.fold_assignments();
        let (sheet, points) = match self.surface {
            None => (self.sheets.union, None),
            Some(Surface { sheet, points }) => (sheet, Some(points)),
        };
        if let Some(of_edges) = &mut fold_assignments {
            of_edges.resize(sheet.topology().edge_count(), None);
        }
        Setup {
            start,
            parts,
            material: materials_in_words(sheets),
            sheet,
            points,
            bodies: self.bodies.carried(),
            model: model.expect("a change that fails ends the building"),
            contacts,
            obstacles,
            integration: self.scene.method.build(),
            modelled: self.modelled,
            targets: self.targets,
            measures: Vec::new(),
            fold_assignments,
            of_sheets,
            origins: self.origins,
            text: None,
        }
    }

    /// Pairs of vertices at the two sides of cuts that are closed at the start: at the boundary of a sheet, in
    /// one place at rest and at the start. What has them in common may stay together, and part.
    fn cuts(&self) -> Vec<[VertexId; 2]> {
        let mut pairs = Vec::new();
        for PlacedSheet { form, part, .. } in &self.sheets.list {
            let placed = &form.placed;
            let start = self.x[part.coordinates()].as_chunks::<3>().0;
            let rest = placed.positions().as_chunks::<3>().0;
            let mut first_there = HashMap::new();
            let t = placed.topology();
            for v in t.vertex_ids().filter(|v| t.is_boundary_vertex(*v)) {
                // (A zero may have either sign.)
                let bits = |p: [f64; 3]| p.map(|c| (c + 0.0).to_bits());
                let place = [rest, start].map(|x| bits(x[v.index()]));
                if let Some(first) = first_there.get(&place) {
                    pairs.push([part.vertex(*first), part.vertex(v)]);
                } else {
                    first_there.insert(place, v);
                }
            }
        }
        pairs
    }

    fn contacts(&mut self) -> Result<(Option<Contacts>, Vec<Obstacle>), SceneError> {
        let (scene, key) = (self.scene, Key::root());
        if !scene.has_contact() {
            return Ok((None, Vec::new()));
        }
        let automatic = match &self.surface {
            None => ContactOptions::for_sheet(self.model()),
            Some(surface) => ContactOptions::for_surface(&surface.sheet, &surface.points),
        };
        let options = scene.contact.options(automatic, scene.sheet[0].thickness);
        let contacts = match &self.surface {
            None => Contacts::new(self.model(), options),
            Some(Surface { sheet, points }) => Contacts::on_surface(sheet, points.clone(), options),
        };
        let mut contacts = contacts
            .map_err(at(&key.name("contact")))?
            .with_glue(&[self.targets.glued(), self.cuts()].concat());
        if !self.bodies.list.is_empty() {
            let mut parts: Vec<_> = self.origins.bodies.clone();
            if !scene.contact.self_contact {
                // Sheets meet bodies, and not one another.
                parts.push(0..self.sheets.union.topology().vertex_count());
            }
            contacts = contacts.with_parts(&parts, self.glued_to_bodies.iter().copied());
        }
        let mut obstacles = Vec::new();
        for (k, obstacle) in scene.obstacle.iter().enumerate() {
            let key = key.name("obstacle").entry(k);
            let Kept { files, shapes, .. } = &mut *self.kept;
            let shape = shapes.get(k, obstacle.shape.clone(), |shape| {
                shape.build(&key.name("shape"), files)
            });
            let body = obstacle.body(shape?, &key)?;
            obstacles.push(body.clone());
            let coefficients = Coefficients::equal(obstacle.friction);
            contacts = contacts.with_body(body, coefficients).map_err(at(&key))?;
        }
        self.count(obstacles.len(), "obstacle", "obstacles");
        self.bodies.check_empty(&self.sheets, &obstacles)?;
        if scene.contact.self_contact || !self.bodies.list.is_empty() {
            let coefficients = Coefficients::equal(scene.contact.friction);
            contacts = contacts
                .with_self_contact(coefficients)
                .map_err(|e| SceneError::from(self_contact_problem(&e)))?;
            for (key, pair) in key.name("contact.pair").entries(&scene.contact.pair) {
                let [first, second] = &pair.sheets;
                let vertices = [self.points_of(first, &key)?, self.points_of(second, &key)?];
                let coefficients = Coefficients::equal(pair.friction);
                contacts = contacts
                    .with_friction_between(vertices, coefficients)
                    .map_err(at(&key))?;
            }
        }
        if scene.contact.self_contact {
            self.modelled.push("self-contact".into());
        }
        Ok((Some(contacts), obstacles))
    }

    /// The vertices of the sheet or of the surface of the body of a name.
    fn points_of(&self, name: &str, key: &Key) -> Result<Range<usize>, Problem> {
        let part = match self.bodies.named(name) {
            Some(body) => &body.part,
            None => &self.sheets.one(Some(name), key, "the contacts")?.part,
        };
        Ok(part.vertices.clone())
    }
}

fn elastic_sheet(
    sheet: &PlacedSheet<'_>,
    ground: Elasticity,
    plate: Option<&PlateBending>,
) -> Result<ElasticSheet, ElasticSheetError> {
    let placed = &sheet.form.placed;
    let all = sheet.patched.map(|own| own.elasticity());
    let all = all.map(|own| own.clone().unwrap_or_else(|| ground.clone()));
    let laws = all.map(|own| own.law.clone());
    let sheet = ElasticSheet::patched(placed, &laws)?.with_limit(ground.limit)?;
    Ok(match plate {
        Some(plate) => sheet.beside(placed, plate),
        None => sheet,
    })
}

fn self_contact_problem(error: &ContactsError) -> Problem {
    let key = Key::root().name("contact.self_contact");
    let remedy = "choose a smaller `sheet.thickness` or `contact.activation`, or a mesh without narrow faces";
    Problem::new(key, error.to_string(), remedy)
}

/// The motion of a pinned vertex that starts at `p`.
fn pin_motion(motion: &Motion, p: [f64; 3]) -> PointMotion {
    if motion.rotation.is_none() {
        return PointMotion::from(PointProfile {
            offset: p,
            x: motion.x.as_given(),
            y: motion.y.as_given(),
            z: motion.z.as_given(),
        });
    }
    let rigid = RigidProfile::from(motion.of_body(Isometry3::identity()));
    PointMotion::from(move |t: f64| -> [f64; 3] {
        (rigid.kinematics(t).pose * Point3::from(p)).coords.into()
    })
}
