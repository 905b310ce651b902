//! Obstacles that deform: meshes in motion beside the sheets.

use crate::bodies::obstacles::{ObstacleKey, ShapeKey};
use crate::meshes::sequence::Sequence;
use crate::placing::driven_surface::DrivenSurface;
use crate::words::key::Key;
use crate::words::problem::Problem;
use crate::words::resolution::check_shape;
use isosheet_dynamics::SheetModel;
use isosheet_dynamics::contact::CarriedPoint;
use isosheet_formats::MovingMesh;
use isosheet_mesh::{MassMatrix, Part, Sheet, VertexId};
use nalgebra::Vector3;
use std::sync::Arc;

/// An obstacle that deforms, in its place.
pub(crate) struct DrivenObstacle {
    pub(crate) surface: DrivenSurface,
    pub(crate) motion: Arc<MovingMesh>,
    /// Its mesh at the start.
    pub(crate) sheet: Sheet,
}

/// All obstacles that deform.
#[derive(Default)]
pub(crate) struct DrivenObstacles {
    pub(crate) list: Vec<DrivenObstacle>,
}

impl DrivenObstacles {
    /// Puts obstacles beside surfaces that end with vertex, edge and face of these numbers, and a model with
    /// so many vertices; `motion` reads a mesh in motion at a place of the scene.
    pub(crate) fn new(
        obstacles: &[ObstacleKey],
        mut end: [usize; 3],
        model_vertices: usize,
        mut motion: impl FnMut(&Sequence, &Key) -> Result<Arc<MovingMesh>, Problem>,
    ) -> Result<Self, Problem> {
        let mut list = Vec::new();
        let mut first = model_vertices;
        for (number, (key, of)) in Key::root().name("obstacle").entries(obstacles).enumerate() {
            let ShapeKey::Sequence(sequence) = &of.shape else {
                continue;
            };
            let key = key.name("shape.sequence");
            let motion = motion(sequence, &key)?;
            let at = key.name("path");
            let motion = Arc::new(MovingMesh::clone(&motion).map(|p| of.pose.place(p)));
            let sheet = Sheet::new(motion.positions(0.0), motion.faces());
            let sheet = sheet.map_err(|e| Problem::from_error(at.clone(), &e))?;
            check_shape(&sheet, &at)?;
            check_faces(&motion, &at)?;
            let t = sheet.topology();
            let counts = [t.vertex_count(), t.edge_count(), t.face_count()];
            let [vertices, edges, faces] = [0, 1, 2].map(|i| end[i]..end[i] + counts[i]);
            end = [vertices.end, edges.end, faces.end];
            let part = Part {
                vertices,
                edges,
                faces,
            };
            list.push(DrivenObstacle {
                surface: DrivenSurface {
                    number,
                    vertices: first..first + counts[0],
                    part,
                },
                motion,
                sheet,
            });
            first += counts[0];
        }
        Ok(Self { list })
    }

    /// Their meshes.
    pub(crate) fn sheets(&self) -> impl Iterator<Item = &Sheet> {
        self.list.iter().map(|obstacle| &obstacle.sheet)
    }

    /// Their first vertex in the model, if there are any.
    pub(crate) fn first(&self) -> Option<VertexId> {
        let first = self.list.first();
        first.map(|obstacle| VertexId::from_index(obstacle.surface.vertices.start))
    }

    /// Their first vertex among the vertices of all surfaces, if there are any.
    pub(crate) fn first_point(&self) -> Option<usize> {
        let first = self.list.first();
        first.map(|obstacle| obstacle.surface.part.vertices.start)
    }

    /// The masses of a model with the masses of their vertices.
    pub(crate) fn mass(&self, others: MassMatrix) -> MassMatrix {
        let Some(last) = self.list.last() else {
            return others;
        };
        let count = last.surface.vertices.end - others.vertex.len();
        let edges = self.sheets().map(|sheet| sheet.topology().edge_count());
        let edges: usize = edges.sum();
        let driven = MassMatrix {
            vertex: vec![SheetModel::DRIVEN_MASS; count],
            edge: others.edge.as_ref().map(|_| vec![0.0; edges]),
        };
        MassMatrix::union(&[others, driven])
    }

    /// Their vertices in the model as points of the surface.
    pub(crate) fn points(&self) -> impl Iterator<Item = CarriedPoint> {
        let vertices = self.list.iter().flat_map(|o| o.surface.vertices.clone());
        vertices.map(|v| {
            let vertex = VertexId::from_index(v);
            [(vertex, 1.0), (vertex, 0.0), (vertex, 0.0), (vertex, 0.0)]
        })
    }

    /// Positions of their vertices at the start.
    pub(crate) fn start(&self) -> impl Iterator<Item = f64> {
        self.sheets()
            .flat_map(|sheet| sheet.positions().iter().copied())
    }
}

/// Refuses faces that lose their area or turn over on the way from one frame to the next.
fn check_faces(mesh: &MovingMesh, at: &Key) -> Result<(), Problem> {
    let edges = |frame: usize, face: &[u32; 3]| {
        let points = mesh.frame(frame);
        let [a, b, c] = face.map(|v| Vector3::from(points[v as usize]));
        [b - a, c - a]
    };
    for frame in 0..mesh.times().len() {
        let next = (frame + 1).min(mesh.times().len() - 1);
        for (face, corners) in mesh.faces().iter().enumerate() {
            let ([u0, v0], [u1, v1]) = (edges(frame, corners), edges(next, corners));
            let (n0, n1) = (u0.cross(&v0), u1.cross(&v1));
            // The normal on the way, from 0 to 1, is (1 - s)^2 n0 + s (1 - s) m + s^2 n1.
            let m = u0.cross(&v1) + u1.cross(&v0);
            let direction = n0.normalize() + n1.normalize();
            let [first, middle, last] = [n0, m, n1].map(|n| n.dot(&direction));
            let is_kept = first > 0.0
                && last > 0.0
                && n0.dot(&n1) > 0.0
                && middle > -2.0 * (first * last).sqrt();
            if !is_kept {
                let what = match [n0, n1].map(|n| n.norm() > 0.0) {
                    [false, _] => format!("has no area in frame {frame}"),
                    [_, false] => format!("has no area in frame {next}"),
                    [true, true] => format!("turns over from frame {frame} to frame {next}"),
                };
                return Err(Problem::new(
                    at.clone(),
                    format!("face {face} of the mesh in motion {what}"),
                    "give more frames, or a mesh whose faces turn by less than 90 degrees from one to the next",
                ));
            }
        }
    }
    Ok(())
}
