//! From a scene to a simulation.

use super::creases::{EdgeFolds, FoldSprings};
use super::error::SceneError;
use super::folding::FoldTargets;
use super::key::Key;
use super::material::Material;
use super::mesh::{Mesh, RestMesh};
use super::pose::{Motion, Pose};
use super::problem::Problem;
use super::sheet::{Bending, Elasticity, Isometry};
use super::supports::{Hold, frame_motion};
use super::{Air, Origins, Scene, Setup};
use isosheet_collide::{Coefficients, Contacts, ContactsError, Obstacle};
use isosheet_dynamics::{
    AccelerationField, CreaseSprings, ElasticSheet, PlateBending, PointMotion, PointProfile,
    RigidProfile, SheetModel, SimulationError, State, VertexConstraint, VertexLoad, leave_flat,
    project_positions,
};
use isosheet_mesh::wording::{brief, counted};
use isosheet_mesh::{Advice, EdgeId, MassKind, Sheet, VertexId};
use nalgebra::{Isometry3, Point3};
use std::path::Path;

impl Scene {
    /// Makes everything that a simulation needs. Masses are lumped: a third of that of each face at each of
    /// its corners. Paths are relative to `folder`.
    ///
    /// # Errors
    /// [`SceneError`], with all problems of the values or the first one of what is made of them.
    pub fn build(&self, folder: &Path) -> Result<Setup, SceneError> {
        self.validate()?;
        let mut builder = Builder::new(self, folder)?;
        builder.add_forces()?;
        builder.add_supports()?;
        builder.mend_lengths();
        let springs = builder.fold_springs(folder)?;
        builder.add_bending(&springs.creases())?;
        builder.add_springs(springs)?;
        builder.add_isometry()?;
        builder.perturb()?;
        let (contacts, obstacles) = builder.contacts(folder)?;
        Ok(builder.finish(contacts, obstacles))
    }
}

/// Relative error of edge lengths to which positions are projected: that of accepted steps.
const EXACT: f64 = 1e-12;

/// Largest relative error of an edge length that is taken for rounding. A file of six digits rounds the
/// coordinates of a sheet of size 1 by 5e-7, and edges of a hundredth of the sheet by 1e-4 of their length.
const ROUNDING: f64 = 1e-4;

/// A model on its way.
struct Builder<'a> {
    scene: &'a Scene,
    /// The rest shape, placed in space.
    rest: RestMesh,
    /// The rest shape as its mesh has it.
    unplaced: Sheet,
    /// Positions at the start, `3V`.
    x: Vec<f64>,
    /// Absent only while it is replaced by a changed one.
    model: Option<SheetModel>,
    origins: Origins,
    modelled: Vec<String>,
    folding: Option<FoldTargets>,
}

/// An error of the engine at a key.
fn at<E: Advice>(key: &Key) -> impl Fn(E) -> SceneError {
    let key = key.clone();
    move |error| Problem::from_error(key.clone(), &error).into()
}

impl<'a> Builder<'a> {
    fn new(scene: &'a Scene, folder: &Path) -> Result<Self, SceneError> {
        let key = Key::root().name("sheet");
        let mesh_key = key.name("mesh");
        let RestMesh { sheet, roles } = scene.sheet.mesh.build(&mesh_key, folder)?;
        let pose = &scene.sheet.placement;
        let placed = sheet
            .map_positions(|p| place(pose, p))
            .map_err(at(&mesh_key))?;
        let x = match &scene.sheet.start.file {
            None => placed.positions().to_vec(),
            Some(file) => {
                let key = key.name("start.file");
                let start = file.read(&key, folder)?;
                if triangles(&start.faces) != triangles(&placed.face_indices()) {
                    let message = "the file does not have the vertices and faces of `sheet.mesh`";
                    let remedy = "export both shapes from the same mesh, without reordering";
                    return Err(Problem::new(key.name("path"), message, remedy).into());
                }
                let points = start.positions.as_chunks::<3>().0.iter();
                points.flat_map(|&p| place(pose, p)).collect()
            }
        };
        let by_area = scene.sheet.areal_density() * placed.area();
        let mass = scene.sheet.mass.unwrap_or(by_area);
        let model = SheetModel::new(&placed, mass, MassKind::Lumped)
            .and_then(|m| m.with_damping(scene.sheet.damping))
            .map_err(at(&key))?;
        let mut modelled = Vec::new();
        if scene.sheet.damping > 0.0 {
            modelled.push("velocity damping".to_owned());
        }
        Ok(Self {
            scene,
            rest: RestMesh {
                sheet: placed,
                roles,
            },
            unplaced: sheet,
            x,
            model: Some(model),
            origins: Origins::default(),
            modelled,
            folding: None,
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

    fn vertices(&self, selection: &super::Selection, key: &Key) -> Result<Vec<VertexId>, Problem> {
        selection.resolve(key, self.rest.sheet.topology(), &self.x)
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
        for (k, load) in forces.load.iter().enumerate() {
            let key = key.name("load").entry(k);
            let vertices = self.vertices(&load.at, &key.name("at"))?;
            let size = load.size.scaled(1.0 / vertices.len() as f64);
            let topology = self.rest.sheet.topology();
            let load = VertexLoad::new(topology, &vertices, load.direction, size);
            let load = load.map_err(at(&key))?;
            self.change(|m| Ok(m.with_force(load)), at::<SimulationError>(&key))?;
        }
        for (k, field) in forces.acceleration.iter().enumerate() {
            let key = key.name("acceleration").entry(k);
            let weights = self.model().mass().row_sums(self.rest.sheet.topology());
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
            let vertices = self.vertices(&support.at, &key.name("at"))?;
            for &v in &vertices {
                self.check_free(v, k, &key)?;
            }
            match &support.hold {
                Hold::Pin => self.change(|m| m.with_pins(&vertices), at(&key))?,
                Hold::MovingPin(motion) => {
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
            if matches!(support.hold, Hold::Pin | Hold::MovingPin(_)) {
                self.origins.pins.extend(vertices.iter().map(|&v| (v, k)));
            }
        }
        self.count(self.scene.support.len(), "support", "supports");
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
        let pins = matches!(supports[number].hold, Hold::Pin | Hold::MovingPin(_));
        let other = match self.origins.pins.get(&v) {
            Some(&k) if supports[k].hold != Hold::Pin || supports[number].hold != Hold::Pin => {
                Some(k)
            }
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

    fn add_bending(&mut self, creases: &[EdgeId]) -> Result<(), SceneError> {
        let key = Key::root().name("sheet.bending");
        let yields = self.scene.sheet.yields();
        if yields.is_some() {
            self.modelled.push("bends that stay".into());
        }
        match self.scene.sheet.bending() {
            Bending::None => Ok(()),
            Bending::Plate { rigidity } => {
                let clamped = self.model().pins();
                let plate = PlateBending::creased(&self.rest.sheet, rigidity, &clamped, creases);
                let mut plate = plate.map_err(at(&key))?;
                if let Some(yields) = yields {
                    let yielding = plate.with_yield(&self.rest.sheet, yields);
                    plate = yielding.map_err(at(&Key::root().name("sheet.yield")))?;
                }
                self.modelled.push("bending stiffness of a plate".into());
                self.change(|m| Ok(m.with_potential(plate)), at::<SimulationError>(&key))
            }
            Bending::Hinges { rigidity } => {
                let springs = CreaseSprings::bending_beside(&self.rest.sheet, rigidity, creases);
                let mut springs = springs.map_err(at(&key))?;
                if let Some(yields) = yields {
                    let yielding = springs.with_yield(&self.rest.sheet, yields);
                    springs = yielding.map_err(at(&Key::root().name("sheet.yield")))?;
                }
                self.modelled.push("bending stiffness at edges".into());
                self.change(
                    |m| Ok(m.with_potential(springs)),
                    at::<SimulationError>(&key),
                )
            }
        }
    }

    /// The springs of the creases and of `[folding]`.
    fn fold_springs(&mut self, folder: &Path) -> Result<FoldSprings, SceneError> {
        let mut springs = FoldSprings::default();
        for (k, crease) in self.scene.crease.iter().enumerate() {
            let key = Key::root().name("crease").entry(k);
            let roles = self.rest.roles.as_ref();
            let found = crease.springs(&key, &self.unplaced, roles)?;
            springs.add(key, crease.folds(), found);
        }
        if let (Some(folding), Mesh::File(file)) = (&self.scene.folding, &self.scene.sheet.mesh) {
            let key = Key::root().name("folding");
            let targets = folding.targets(&key, file, &self.unplaced, folder)?;
            let [driven, flat] = folding.springs(&targets, &self.rest.sheet, &self.x);
            springs.add(key.clone(), EdgeFolds::Yes, driven);
            springs.add(key, EdgeFolds::No, flat);
            self.folding = Some(targets);
        }
        let rigidity = self.scene.sheet.bending().rigidity();
        springs.put_in_sheet(&self.rest.sheet, rigidity);
        Ok(springs)
    }

    fn add_springs(&mut self, springs: FoldSprings) -> Result<(), SceneError> {
        for (key, springs) in springs.into_groups() {
            let springs = CreaseSprings::new(self.rest.sheet.topology(), springs);
            let springs = springs.map_err(at(&key))?;
            self.change(
                |m| Ok(m.with_potential(springs)),
                at::<SimulationError>(&key),
            )?;
        }
        self.count(self.scene.crease.len(), "crease", "creases");
        if self.folding.is_some() {
            self.modelled.push("folding to given angles".into());
        }
        Ok(())
    }

    fn add_isometry(&mut self) -> Result<(), SceneError> {
        let of_sheet = &self.scene.sheet;
        let Some(elasticity) = of_sheet.elasticity() else {
            self.modelled.push("rigid rods".into());
            return Ok(());
        };
        let name = match of_sheet.isometry {
            Some(_) => "sheet.isometry",
            None => "sheet.material",
        };
        let key = Key::root().name(name);
        let Elasticity {
            stiffness,
            poisson,
            limit,
        } = elasticity;
        let rigidity = of_sheet.bending().rigidity();
        let elastic = ElasticSheet::new(&self.rest.sheet, stiffness, poisson)
            .and_then(|e| e.softened(rigidity))
            .and_then(|e| e.with_limit(limit))
            .map_err(at(&key))?;
        self.modelled.push(elastic_in_words(&elastic));
        self.change(|m| m.with_elastic_sheet(elastic), at(&key))
    }

    /// Gives the positions of a start file the rest lengths that the few digits of the file have rounded.
    /// What is further off, or has no such positions nearby, stays as it is, and the engine says what is
    /// wrong with it.
    fn mend_lengths(&mut self) {
        let is_rigid = self.scene.sheet.isometry() == Isometry::Rods;
        if !is_rigid || self.scene.sheet.start.file.is_none() {
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
        let start = &self.scene.sheet.start;
        if start.perturbation > 0.0 {
            let (size, seed) = (start.perturbation, start.seed);
            let mut x = std::mem::take(&mut self.x);
            leave_flat(self.model(), &mut x, size, seed)
                .map_err(|e| SceneError::from(self.origins.of_start(&e)))?;
            self.x = x;
            self.modelled
                .push("random displacement at the start".into());
        }
        Ok(())
    }

    fn finish(mut self, contacts: Option<Contacts>, obstacles: Vec<Obstacle>) -> Setup {
        let model = self.model.take();
        Setup {
            start: State::at_rest(self.x),
            sheet: self.rest.sheet,
            model: model.expect("a change that fails ends the building"),
            contacts,
            obstacles,
            integration: self.scene.method.build(),
            modelled: self.modelled,
            material: self
                .scene
                .sheet
                .material
                .as_ref()
                .and_then(Material::in_words),
            folding: self.folding,
            origins: self.origins,
            text: None,
        }
    }

    fn contacts(&mut self, folder: &Path) -> Result<(Option<Contacts>, Vec<Obstacle>), SceneError> {
        let (scene, key) = (self.scene, Key::root());
        if !scene.has_contact() {
            return Ok((None, Vec::new()));
        }
        let options = scene.contact.options(self.model(), scene.sheet.thickness);
        let mut contacts =
            Contacts::new(self.model(), options).map_err(at(&key.name("contact")))?;
        let mut obstacles = Vec::new();
        for (k, obstacle) in scene.obstacle.iter().enumerate() {
            let key = key.name("obstacle").entry(k);
            let body = obstacle.build(&key, folder)?;
            obstacles.push(body.clone());
            let coefficients = Coefficients::equal(obstacle.friction);
            contacts = contacts.with_body(body, coefficients).map_err(at(&key))?;
        }
        self.count(obstacles.len(), "obstacle", "obstacles");
        if scene.contact.self_contact {
            let coefficients = Coefficients::equal(scene.contact.friction);
            contacts = contacts
                .with_self_contact(coefficients)
                .map_err(|e| SceneError::from(self_contact_problem(&e)))?;
            self.modelled.push("self-contact".into());
        }
        Ok((Some(contacts), obstacles))
    }
}

/// What an elastic sheet is on its mesh.
fn elastic_in_words(elastic: &ElasticSheet) -> String {
    let used = elastic.face_stiffnesses();
    let [least, most] = used.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], k| {
        [least.min(k), most.max(k)]
    });
    let softened = if least == elastic.stiffness() {
        String::new()
    } else if brief(least).to_string() == brief(most).to_string() {
        format!(", softened on this mesh to {} N/m", brief(least))
    } else {
        let [least, most] = [brief(least), brief(most)];
        format!(", softened on this mesh to between {least} and {most} N/m")
    };
    format!(
        "elasticity in the plane ({} N/m{softened}; strain below {} %)",
        brief(elastic.stiffness()),
        brief(100.0 * elastic.limit())
    )
}

fn self_contact_problem(error: &ContactsError) -> Problem {
    let key = Key::root().name("contact.self_contact");
    let remedy = "choose a smaller `sheet.thickness` or `contact.activation`, or a mesh without narrow faces";
    Problem::new(key, error.to_string(), remedy)
}

/// The triangles without order and orientation: frames of a FOLD file may list the same faces in other ways.
fn triangles(faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut triangles = faces.to_vec();
    for corners in &mut triangles {
        corners.sort_unstable();
    }
    triangles.sort_unstable();
    triangles
}

/// A point of the mesh in space.
fn place(pose: &Pose, p: [f64; 3]) -> [f64; 3] {
    if *pose == Pose::default() {
        return p;
    }
    (pose.isometry() * Point3::from(p)).coords.into()
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
