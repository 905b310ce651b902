//! Frames of a moving sheet that are to be written.

use super::ExportError;
use crate::format::mesh_file::{EdgeAssignment, FileCrease, MeshFile};
use crate::format::{Trajectory, TrajectoryError};
use isosheet_mesh::generate::FoldAssignment;
use isosheet_mesh::{EdgeId, Topology, VertexId, fold_angle};

/// Which frames of a trajectory are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SeriesOptions {
    /// Every so many frames one is taken, beginning with the first: 1 (the default) for all.
    pub every: usize,
}

impl Default for SeriesOptions {
    fn default() -> Self {
        Self { every: 1 }
    }
}

impl SeriesOptions {
    /// Checks the values.
    ///
    /// # Errors
    /// [`ExportError::Every`] for 0.
    pub fn validate(&self) -> Result<(), ExportError> {
        if self.every == 0 {
            return Err(ExportError::Every);
        }
        Ok(())
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
}

/// Numbers on vertices, edges or faces, such as energies or gaps, for formats with data.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesField {
    /// The name.
    pub name: String,
    /// What the values belong to.
    pub support: FieldSupport,
    /// One value (of vectors three) for each vertex, edge or face of each frame of the trajectory, frame
    /// after frame, also of those that are not written.
    pub values: Vec<f64>,
}

/// Frames of a moving sheet that are to be written, with what is known of its edges, strains and fold angles,
/// and where the trajectory has them the fields
///
/// - `rod_force`, the forces of the rods (newtons, tension positive),
/// - `contact_force`, the forces of contact on the vertices (vectors, newtons), and
/// - `gap`, the gaps of the vertices (metres, see [`Trajectory::gaps`]).
///
/// Of frames at the same time only the first is written: most formats cannot hold two.
#[derive(Clone, Debug)]
pub struct Series<'a> {
    trajectory: &'a Trajectory,
    topology: Topology,
    rest_lengths: Vec<f64>,
    frames: Vec<usize>,
    assignments: Option<Vec<Option<FoldAssignment>>>,
    fields: Vec<SeriesField>,
}

impl<'a> Series<'a> {
    /// The frames of a trajectory.
    ///
    /// # Errors
    /// [`ExportError`] if there are no frames, if the faces are no surface, or if an edge has no rest length.
    pub fn new(trajectory: &'a Trajectory, options: &SeriesOptions) -> Result<Self, ExportError> {
        options.validate()?;
        if trajectory.is_empty() {
            return Err(ExportError::NoFrames);
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
                return Err(ExportError::MissingEdge { a, b });
            }
            if length <= 0.0 {
                return Err(ExportError::RestLength { a, b, length });
            }
        }
        let times = trajectory.times();
        let mut frames: Vec<usize> = (0..times.len()).step_by(options.every).collect();
        frames.dedup_by(|later, first| times[*later] == times[*first]);
        let rod_forces = rod_forces(trajectory, &topology).into_iter();
        let fields = rod_forces.chain(contact_fields(trajectory)).collect();
        Ok(Self {
            trajectory,
            topology,
            rest_lengths,
            frames,
            assignments: None,
            fields,
        })
    }

    /// With what the edges are meant to do, for FOLD files: one entry for each edge of the topology.
    ///
    /// # Errors
    /// [`ExportError::Count`] for another number of entries.
    pub fn with_assignments(
        self,
        assignments: Vec<Option<FoldAssignment>>,
    ) -> Result<Self, ExportError> {
        let expected = self.topology.edge_count();
        if assignments.len() != expected {
            return Err(ExportError::Count {
                what: "assignments of edges".to_owned(),
                got: assignments.len(),
                expected,
            });
        }
        Ok(Self {
            assignments: Some(assignments),
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
        if values.len() != expected {
            return Err(ExportError::Count {
                what: format!("the field {name:?}"),
                got: values.len(),
                expected,
            });
        }
        if let Some(index) = values.iter().position(|v| !v.is_finite()) {
            return Err(ExportError::FieldNotFinite {
                name: name.clone(),
                index,
                value: values[index],
            });
        }
        let reserved = ["strain", "fold_angle", "TimeValue"].contains(&&name[..]);
        if reserved || self.fields.iter().any(|f| f.name == *name) {
            return Err(ExportError::FieldName { name: name.clone() });
        }
        self.fields.push(field);
        Ok(self)
    }

    /// The frames that are written as a trajectory of their own.
    pub(super) fn chosen(&self) -> Result<Trajectory, TrajectoryError> {
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

    /// The fold angle of each edge in a frame of the trajectory, in radians ([`fold_angle`]); 0 on the
    /// boundary and where an edge has no length.
    ///
    /// # Panics
    /// If there is no such frame.
    pub fn fold_angles(&self, frame: usize) -> Vec<f64> {
        let (_, x) = self.state(frame);
        let t = &self.topology;
        let angle = |e| fold_angle(t, x, e).filter(|a| a.is_finite()).unwrap_or(0.0);
        t.edge_ids().map(angle).collect()
    }

    /// One frame of the trajectory as a mesh, with its fold angles and what its edges are meant to do.
    ///
    /// # Errors
    /// [`ExportError::NoFrame`] if there is no such frame.
    pub fn mesh(&self, frame: usize) -> Result<MeshFile, ExportError> {
        let count = self.trajectory.len();
        if frame >= count {
            return Err(ExportError::NoFrame { frame, count });
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
            x.expect("frames are those of the trajectory"),
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
        }
    }
}

fn edge_between(topology: &Topology, ends: [u32; 2]) -> Option<EdgeId> {
    let [a, b] = ends.map(VertexId);
    (a != b).then(|| topology.find_edge(a, b)).flatten()
}

/// The forces of the rods as a field, in the order of the edges of the topology.
fn rod_forces(trajectory: &Trajectory, topology: &Topology) -> Option<SeriesField> {
    trajectory.rod_forces(0)?;
    let edges = trajectory.edges().iter();
    let order: Vec<Option<EdgeId>> = edges.map(|ends| edge_between(topology, *ends)).collect();
    let count = topology.edge_count();
    let mut values = vec![0.0; count * trajectory.len()];
    for (frame, values) in values.chunks_exact_mut(count).enumerate() {
        for (edge, force) in order.iter().zip(trajectory.rod_forces(frame)?) {
            if let Some(edge) = edge {
                values[edge.index()] = *force;
            }
        }
    }
    Some(SeriesField {
        name: "rod_force".to_owned(),
        support: FieldSupport::Edges,
        values,
    })
}

/// What the trajectory has of contact as fields.
fn contact_fields(trajectory: &Trajectory) -> Vec<SeriesField> {
    let all = |of: fn(&Trajectory, usize) -> Option<&[f64]>| -> Option<Vec<f64>> {
        let frames = (0..trajectory.len()).map(|k| of(trajectory, k));
        frames.collect::<Option<Vec<_>>>().map(|f| f.concat())
    };
    let forces = (
        "contact_force",
        FieldSupport::VertexVectors,
        all(Trajectory::contact_forces),
    );
    let gaps = ("gap", FieldSupport::Vertices, all(Trajectory::gaps));
    let field = |(name, support, values): (&str, FieldSupport, Option<Vec<f64>>)| {
        Some(SeriesField {
            name: name.to_owned(),
            support,
            values: values?,
        })
    };
    [forces, gaps].into_iter().filter_map(field).collect()
}
