//! Frames of a moving sheet that are to be written.

use super::error::check_count;
use super::flat::flat_coordinates;
use super::moving::{Moving, MovingSheet};
use super::sheets::NamedPart;
use super::{ExportError, SeriesBody};
use crate::Trajectory;
use crate::mesh_file::{EdgeAssignment, FileCrease, MeshFile};
use crate::trajectory::FrameQuantity;
use isosheet_files::DataError;
use isosheet_mesh::generate::FoldAssignment;
use isosheet_mesh::wording::{brief, counted, given};
use isosheet_mesh::{EdgeId, Part, Topology, VertexId, angle_near, fold_angle};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::OnceLock;

/// Which frames of a trajectory are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesOptions {
    /// The first frame; 0 by default.
    pub first: usize,
    /// The last frame; that of the trajectory by default.
    pub last: Option<usize>,
    /// Every so many frames one is taken, beginning with the first: 1 (the default) for all.
    pub every: usize,
    /// Frames a second at which programs for animations show the motion, so that it has its own speed; 24
    /// (the default) is that of films. It changes no frame: [`Trajectory::at_rate`] does.
    pub rate: f64,
}

impl Default for SeriesOptions {
    fn default() -> Self {
        Self {
            first: 0,
            last: None,
            every: 1,
            rate: 24.0,
        }
    }
}

impl SeriesOptions {
    /// Checks the values.
    ///
    /// # Errors
    /// [`ExportError::Data`] for every 0th frame, [`ExportError::Frames`] for a rate that is not positive and
    /// for a last frame before the first one.
    pub fn validate(&self) -> Result<(), ExportError> {
        if self.every == 0 {
            let remedy = "give 1 for all frames, 2 for every second one";
            return Err(DataError::new("every 0th frame was asked for", remedy).into());
        }
        if !(self.rate > 0.0 && self.rate.is_finite()) {
            let message = format!("{} frames a second were asked for", self.rate);
            let error = DataError::new(message, "give a positive number").value(self.rate);
            return Err(ExportError::Frames(error));
        }
        match (self.first, self.last) {
            (first, Some(last)) if last < first => {
                let message = format!("frames from {first} to {last} were asked for");
                let error = DataError::new(message, "name the first one first").at(first);
                Err(ExportError::Frames(error))
            }
            _ => Ok(()),
        }
    }
}

/// What the values of a field belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldSupport {
    /// Vertices.
    Vertices,
    /// Vertices, with a vector of three values for each.
    VertexVectors,
    /// Edges, in the order of [`Series::topology`].
    Edges,
    /// Faces.
    Faces,
    /// Faces, with a vector of three values for each.
    FaceVectors,
}

/// Numbers on vertices, edges or faces, such as energies or gaps, for formats with data.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesField {
    /// The name.
    pub name: String,
    /// What the values belong to.
    pub support: FieldSupport,
    /// One value (of vectors three) for each vertex, edge or face of each frame of the trajectory, frame
    /// after frame, including the frames that are not written.
    pub values: Vec<f64>,
}

/// Frames of a moving sheet that are to be written, with what is known of its edges, strains and fold angles,
/// and where the trajectory has them the fields
///
/// - `rod_force`, the forces of the rods (newtons, tension positive),
/// - `contact_force`, the forces of contact on the vertices (vectors, newtons),
/// - `gap`, the gaps of the vertices (metres, see [`Trajectory::gaps`]),
/// - `plastic_angle`, the plastic angles of the edges (degrees, positive for valleys),
/// - `plastic_curvature_1` and `plastic_curvature_2`, the principal values of the plastic curvature of the
///   faces (1/m, see [`Trajectory::plastic_curvatures`]), and
/// - `ruling` (unit vectors), `ruling_curvature` (1/m) and `gauss_curvature` (1/m2), see
///   [`Trajectory::rulings`].
///
/// Of frames at the same time only the first is written: most formats cannot hold two.
#[derive(Clone, Debug)]
pub struct Series<'a> {
    trajectory: &'a Trajectory,
    topology: Topology,
    rest_lengths: Vec<f64>,
    frames: Vec<usize>,
    assignments: Option<Vec<Option<FoldAssignment>>>,
    /// The fold angles of each frame, radians, once they are asked for.
    followed: OnceLock<Vec<Vec<f64>>>,
    fields: Vec<SeriesField>,
    /// The bends beside creases in each frame, radians, in the order of the edges; empty where there are
    /// none.
    crease_bends: Vec<f64>,
    rate: f64,
    /// Places of the vertices in a picture printed on the flat sheet, if it can be flat.
    uv: Option<Vec<[f64; 2]>>,
    bodies: Vec<SeriesBody>,
    /// The sheets, if there are several.
    sheets: Vec<NamedPart>,
}

impl<'a> Series<'a> {
    /// The frames of a trajectory.
    ///
    /// # Errors
    /// [`ExportError`] if there are no frames, if the faces are no surface, or if an edge has no rest length.
    pub fn new(trajectory: &'a Trajectory, options: &SeriesOptions) -> Result<Self, ExportError> {
        options.validate()?;
        if trajectory.is_empty() {
            let remedy = "let the run take a step, or record a state";
            return Err(DataError::new("the trajectory has no frames", remedy).into());
        }
        let topology = Topology::from_faces(trajectory.vertex_count(), trajectory.faces())?;
        let mut rest_lengths = vec![f64::NAN; topology.edge_count()];
        for (ends, &length) in trajectory.edges().iter().zip(trajectory.rest_lengths()) {
            if let Some(e) = edge_between(&topology, *ends) {
                rest_lengths[e.index()] = length;
            }
        }
        for (&[a, b], &length) in topology.edges().iter().zip(&rest_lengths) {
            if length.is_nan() {
                let message = format!(
                    "the trajectory has no rest length of the edge between {a} and {b}: its edges do not belong \
                     to its faces"
                );
                return Err(DataError::plain(message).into());
            }
            if length <= 0.0 {
                let found = brief(length);
                let message = format!("the edge between {a} and {b} has the rest length {found} m");
                let error = DataError::new(message, "give a positive length");
                return Err(error.value(length).into());
            }
        }
        let times = trajectory.times();
        let last = options.last.unwrap_or(times.len() - 1);
        if let Some(&frame) = [options.first, last].iter().find(|f| **f >= times.len()) {
            return Err(no_frame(frame, times.len()));
        }
        let mut frames: Vec<usize> = (options.first..=last).step_by(options.every).collect();
        frames.dedup_by(|later, first| times[*later] == times[*first]);
        let fields = recorded_fields(trajectory, &topology);
        let bends = trajectory.all(FrameQuantity::CreaseBends);
        let crease_bends = match bends.is_empty() {
            true => Vec::new(),
            false => on_edges(trajectory, &topology, bends),
        };
        let start = trajectory.frame(0).unwrap_or_default();
        Ok(Self {
            uv: flat_coordinates(&topology, &rest_lengths, start),
            trajectory,
            topology,
            rest_lengths,
            frames,
            assignments: None,
            followed: OnceLock::new(),
            fields,
            crease_bends,
            rate: options.rate,
            bodies: Vec::new(),
            sheets: Vec::new(),
        })
    }

    /// With the sheets of which the mesh is the union, each with its name and its place in it, for formats
    /// that tell them apart: objects in USD and glTF files, groups in OBJ files, and cell data `sheet`, the
    /// number of the sheet from 0, in VTK files. Characters of names that formats refuse become `_`.
    ///
    /// # Errors
    /// [`ExportError::Data`] if the sheets are not the whole mesh, one after the other.
    pub fn with_sheets(self, sheets: &[(String, Part)]) -> Result<Self, ExportError> {
        let t = &self.topology;
        let counts = [t.vertex_count(), t.edge_count(), t.face_count()];
        Ok(Self {
            sheets: NamedPart::all(sheets, counts)?,
            ..self
        })
    }

    /// The sheets, if there are several.
    pub(super) fn sheets(&self) -> &[NamedPart] {
        &self.sheets
    }

    /// With the bodies that the sheet meets, for formats that have several meshes.
    ///
    /// # Errors
    /// [`ExportError::Data`] for a number of poses that is neither 1 nor that of the frames of the
    /// trajectory, [`ExportError`] for a mesh that is none.
    pub fn with_bodies(self, bodies: Vec<SeriesBody>) -> Result<Self, ExportError> {
        for body in &bodies {
            body.validate(self.trajectory.len())?;
        }
        Ok(Self { bodies, ..self })
    }

    /// The bodies.
    pub fn bodies(&self) -> &[SeriesBody] {
        &self.bodies
    }

    /// The written frames in which bodies are placed anew: the first alone where all rest, none without
    /// bodies.
    pub(super) fn frames_of_bodies(&self) -> &[usize] {
        let count = match &self.bodies[..] {
            [] => 0,
            bodies if bodies.iter().all(SeriesBody::rests) => 1,
            _ => self.frames.len(),
        };
        &self.frames[..count.min(self.frames.len())]
    }

    /// Places of the vertices in a picture that is printed on the sheet, from 0 to 1 rightwards and upwards:
    /// the flat rest shape, scaled alike in both directions so that its larger side is 1, and turned as the
    /// sheet lies in the first frame of the trajectory. `None` if no flat sheet has the rest lengths, as on
    /// closed cylinders.
    pub fn uv(&self) -> Option<&[[f64; 2]]> {
        self.uv.as_deref()
    }

    /// Some frames of the trajectory for formats with several meshes.
    pub(super) fn moving(&self, frames: &[usize]) -> Moving<'_> {
        let poses = |body: &SeriesBody| match body.poses[..] {
            [pose] => vec![pose],
            _ => frames.iter().map(|&f| body.poses[f]).collect(),
        };
        Moving {
            sheets: match &self.sheets[..] {
                [] => vec![MovingSheet::whole(
                    self.faces(),
                    self.trajectory.vertex_count(),
                )],
                parts => parts
                    .iter()
                    .map(|part| MovingSheet::of(part, self.faces()))
                    .collect(),
            },
            states: frames.iter().map(|&f| self.state(f)).collect(),
            uv: self.uv(),
            bodies: self.bodies.iter().map(|b| (b, poses(b))).collect(),
            rate: self.rate,
        }
    }

    /// With what the edges are meant to do, for FOLD files: one entry for each edge of the topology.
    ///
    /// # Errors
    /// [`ExportError::Data`] for another number of entries.
    pub fn with_assignments(
        self,
        assignments: Vec<Option<FoldAssignment>>,
    ) -> Result<Self, ExportError> {
        let expected = self.topology.edge_count();
        check_count("assignments of edges", assignments.len(), expected)?;
        Ok(Self {
            assignments: Some(assignments),
            followed: OnceLock::new(),
            ..self
        })
    }

    /// With a further field, for formats with data.
    ///
    /// # Errors
    /// [`ExportError`] for a wrong number of values, a value that is not finite, and a name that is taken.
    pub fn with_field(mut self, field: SeriesField) -> Result<Self, ExportError> {
        let SeriesField {
            name,
            support,
            values,
        } = &field;
        let expected = self.trajectory.len() * self.support_size(*support);
        check_count(&format!("the field {name:?}"), values.len(), expected)?;
        if let Some(index) = values.iter().position(|v| !v.is_finite()) {
            let value = values[index];
            let message = format!("value {index} of the field {name:?} is {}", given(value));
            let error = DataError::new(message, "give finite values");
            return Err(error.at(index).value(value).into());
        }
        let reserved = ["strain", "fold_angle", "sheet", "TimeValue", "uv"].contains(&&name[..]);
        if reserved || self.fields.iter().any(|f| f.name == *name) {
            let message = format!("there are two fields with the name {name:?}");
            let remedy = "rename one (strain, fold_angle, sheet, rod_force, contact_force, gap, plastic_angle, \
                          plastic_curvature_1 and _2, ruling, ruling_curvature, gauss_curvature, uv and TimeValue are \
                          taken)";
            return Err(DataError::new(message, remedy).into());
        }
        self.fields.push(field);
        Ok(self)
    }

    /// The frames that are written as a trajectory of their own.
    pub(super) fn chosen(&self) -> Result<Trajectory, DataError> {
        self.trajectory.subset(&self.frames)
    }

    /// The frames of the trajectory that are written.
    pub fn frames(&self) -> &[usize] {
        &self.frames
    }

    /// The mesh.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The strain `l / L - 1` of each edge in a frame of the trajectory, with its length `l` and rest
    /// length `L`.
    ///
    /// # Panics
    /// If there is no such frame.
    pub fn edge_strains(&self, frame: usize) -> Vec<f64> {
        let points = self.state(frame).1.as_chunks::<3>().0;
        let strain = |(ends, rest): (&[VertexId; 2], &f64)| {
            let [a, b] = ends.map(|v| points[v.index()]);
            let length = (b[0] - a[0]).hypot(b[1] - a[1]).hypot(b[2] - a[2]);
            // The difference of two huge coordinates may overflow.
            (length / rest - 1.0).min(f64::MAX)
        };
        self.topology
            .edges()
            .iter()
            .zip(&self.rest_lengths)
            .map(strain)
            .collect()
    }

    /// The fold angle of each edge in a frame of the trajectory, in radians within [-pi, pi]
    /// ([`fold_angle`]); 0 on the boundary and where an edge has no length. At creases in sheets that bend it
    /// is the kink, without the bend of the faces beside them ([`Trajectory::crease_bends`]).
    ///
    /// A fold is followed from frame to frame, where it turns by less than half a turn: one that is pressed
    /// through itself stays a mountain or a valley of half a turn. A mountain that is shut in the first frame
    /// is one by its assignment.
    ///
    /// # Panics
    /// If there is no such frame.
    pub fn fold_angles(&self, frame: usize) -> Vec<f64> {
        let followed = self.followed.get_or_init(|| self.follow_folds());
        let angles = followed[frame].iter();
        angles.map(|angle| angle.clamp(-PI, PI)).collect()
    }

    /// The fold angles in all frames, followed beyond half a turn.
    fn follow_folds(&self) -> Vec<Vec<f64>> {
        let t = &self.topology;
        let mut before: Vec<f64> = t.edge_ids().map(|e| self.side(e) * FRAC_PI_2).collect();
        let mut all = Vec::with_capacity(self.trajectory.len());
        for frame in 0..self.trajectory.len() {
            let (_, x) = self.state(frame);
            let bends = self.crease_bends.get(frame * t.edge_count()..);
            let bend = |e: EdgeId| bends.and_then(|all| all.get(e.index())).copied();
            for (e, angle) in t.edge_ids().zip(&mut before) {
                let now = fold_angle(t, x, e).filter(|a| a.is_finite()).unwrap_or(0.0);
                *angle = angle_near(now - bend(e).unwrap_or(0.0), *angle);
            }
            all.push(before.clone());
        }
        all
    }

    /// 1 for a valley, -1 for a mountain, and 0 for an edge of which nothing is known.
    fn side(&self, edge: EdgeId) -> f64 {
        let known = self.assignments.as_ref().and_then(|a| a[edge.index()]);
        match known {
            Some(FoldAssignment::Mountain) => -1.0,
            Some(FoldAssignment::Valley) => 1.0,
            _ => 0.0,
        }
    }

    /// One frame of the trajectory as a mesh, with its fold angles and what its edges are meant to do.
    ///
    /// # Errors
    /// [`ExportError::Frames`] if there is no such frame.
    pub fn mesh(&self, frame: usize) -> Result<MeshFile, ExportError> {
        let count = self.trajectory.len();
        if frame >= count {
            return Err(no_frame(frame, count));
        }
        let t = &self.topology;
        let crease = |(e, angle): (EdgeId, f64)| {
            let known = self.assignments.as_ref().and_then(|a| a[e.index()]);
            FileCrease {
                ends: t.edges()[e.index()].map(|v| v.0),
                assignment: match known {
                    _ if t.is_boundary_edge(e) => EdgeAssignment::Boundary,
                    Some(FoldAssignment::Mountain) => EdgeAssignment::Mountain,
                    Some(FoldAssignment::Valley) => EdgeAssignment::Valley,
                    Some(FoldAssignment::Flat) => EdgeAssignment::Flat,
                    Some(FoldAssignment::Boundary) | None => EdgeAssignment::Unassigned,
                },
                angle: Some(angle),
                drawn: None,
            }
        };
        let creases = t
            .edge_ids()
            .zip(self.fold_angles(frame))
            .map(crease)
            .collect();
        let positions = self.state(frame).1.to_vec();
        Ok(MeshFile::of_frame(
            positions,
            self.faces().to_vec(),
            creases,
        ))
    }

    /// Time (seconds) and positions (metres) of a frame of the trajectory.
    pub(super) fn state(&self, frame: usize) -> (f64, &'a [f64]) {
        let x = self.trajectory.frame(frame);
        (
            self.trajectory.times()[frame],
            x.expect("frames come from the trajectory"),
        )
    }

    /// The faces.
    pub(super) fn faces(&self) -> &'a [[u32; 3]] {
        self.trajectory.faces()
    }

    /// The further fields with their values in a frame.
    pub(super) fn fields(&self, frame: usize) -> impl Iterator<Item = (&SeriesField, &[f64])> {
        self.fields.iter().map(move |field| {
            let n = self.support_size(field.support);
            (field, &field.values[n * frame..n * (frame + 1)])
        })
    }

    fn support_size(&self, support: FieldSupport) -> usize {
        match support {
            FieldSupport::Vertices => self.topology.vertex_count(),
            FieldSupport::VertexVectors => 3 * self.topology.vertex_count(),
            FieldSupport::Edges => self.topology.edge_count(),
            FieldSupport::Faces => self.topology.face_count(),
            FieldSupport::FaceVectors => 3 * self.topology.face_count(),
        }
    }
}

fn edge_between(topology: &Topology, ends: [u32; 2]) -> Option<EdgeId> {
    let [a, b] = ends.map(VertexId);
    (a != b).then(|| topology.find_edge(a, b)).flatten()
}

/// What a trajectory has besides positions as fields.
fn recorded_fields(trajectory: &Trajectory, topology: &Topology) -> Vec<SeriesField> {
    let field = |name: &str, support, values| SeriesField {
        name: name.to_owned(),
        support,
        values,
    };
    let mut fields = Vec::new();
    for quantity in FrameQuantity::ALL {
        let values = trajectory.all(quantity);
        if values.is_empty() {
            continue;
        }
        fields.extend(match quantity {
            FrameQuantity::RodForces => {
                let values = on_edges(trajectory, topology, values);
                vec![field("rod_force", FieldSupport::Edges, values)]
            }
            FrameQuantity::ContactForces => {
                let support = FieldSupport::VertexVectors;
                vec![field("contact_force", support, values.to_vec())]
            }
            FrameQuantity::Gaps => vec![field("gap", FieldSupport::Vertices, values.to_vec())],
            FrameQuantity::PlasticAngles => {
                let mut values = on_edges(trajectory, topology, values);
                values
                    .iter_mut()
                    .for_each(|angle| *angle = angle.to_degrees());
                vec![field("plastic_angle", FieldSupport::Edges, values)]
            }
            // Of these the fold angles are made.
            FrameQuantity::CreaseBends => Vec::new(),
            FrameQuantity::Rulings => {
                vec![field("ruling", FieldSupport::FaceVectors, values.to_vec())]
            }
            FrameQuantity::RulingCurvatures => {
                vec![field(
                    "ruling_curvature",
                    FieldSupport::Faces,
                    values.to_vec(),
                )]
            }
            FrameQuantity::GaussCurvatures => {
                vec![field(
                    "gauss_curvature",
                    FieldSupport::Vertices,
                    values.to_vec(),
                )]
            }
            FrameQuantity::PlasticCurvatures => {
                let of = |k: usize| values.iter().copied().skip(k).step_by(2).collect();
                let support = FieldSupport::Faces;
                vec![
                    field("plastic_curvature_1", support, of(0)),
                    field("plastic_curvature_2", support, of(1)),
                ]
            }
        });
    }
    fields
}

/// Values of the edges of a trajectory in the order of the edges of the topology.
fn on_edges(trajectory: &Trajectory, topology: &Topology, values: &[f64]) -> Vec<f64> {
    let edges = trajectory.edges();
    let order: Vec<Option<EdgeId>> = edges.iter().map(|e| edge_between(topology, *e)).collect();
    let count = topology.edge_count();
    let mut sorted = vec![0.0; count * trajectory.len()];
    let frames = sorted
        .chunks_exact_mut(count)
        .zip(values.chunks_exact(edges.len()));
    for (sorted, values) in frames {
        for (edge, value) in order.iter().zip(values) {
            if let Some(edge) = edge {
                sorted[edge.index()] = *value;
            }
        }
    }
    sorted
}

/// There is no such frame.
fn no_frame(frame: usize, count: usize) -> ExportError {
    let frames = counted(count, "frame", "frames");
    let message = format!("there is no frame {frame}: the trajectory has {frames}, counted from 0");
    ExportError::Frames(DataError::new(message, "name one of these").at(frame))
}
