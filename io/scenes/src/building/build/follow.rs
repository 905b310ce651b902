//! Vertices that follow a mesh in motion.

use super::builder::{Builder, at};
use crate::holding::supports::Followed;
use crate::meshes::selection;
use crate::meshes::sequence::Sequence;
use crate::words::error::SceneError;
use crate::words::key::Key;
use crate::words::problem::Problem;
use isosheet_dynamics::PointMotion;
use isosheet_formats::MovingMesh;
use isosheet_mesh::VertexId;
use std::sync::Arc;

impl Builder<'_> {
    /// Pins vertices to a mesh in motion; `key` is the place of `follow`.
    pub(super) fn follow(
        &mut self,
        vertices: &[VertexId],
        (sequence, followed): (&Sequence, &Followed),
        key: &Key,
    ) -> Result<(), SceneError> {
        let (files, end) = (&mut self.kept.files, self.scene.stop.time);
        let mesh = files.sequence(sequence, end, &key.name("sequence"))?;
        let followed = self.followed(vertices, followed, &mesh, key)?;
        for (&v, followed) in vertices.iter().zip(followed) {
            let motion = following(&mesh, followed, self.position(v));
            self.change(|m| m.with_moving_pin(v, motion), at(key))?;
        }
        Ok(())
    }

    /// The vertices of a mesh in motion that some vertices follow.
    fn followed(
        &self,
        vertices: &[VertexId],
        followed: &Followed,
        mesh: &MovingMesh,
        key: &Key,
    ) -> Result<Vec<usize>, Problem> {
        let count = mesh.vertex_count();
        let key = key.name("vertices");
        let in_its_sheet = |v: &VertexId| {
            let mut parts = self.sheets.list.iter().map(|sheet| &sheet.part.vertices);
            let own = parts.find(|vertices| vertices.contains(&v.index()));
            v.index() - own.map_or(0, |vertices| vertices.start)
        };
        let (numbers, key) = match followed {
            Followed::Nearest => {
                let points = mesh.positions(0.0);
                let points = points.as_chunks::<3>().0;
                let nearest =
                    |v: &VertexId| selection::nearest(points, &self.position(*v)).0.index();
                return Ok(vertices.iter().map(nearest).collect());
            }
            Followed::SameNumber => (vertices.iter().map(in_its_sheet).collect(), key),
            Followed::Numbers(numbers) => {
                let (given, held) = (numbers.len(), vertices.len());
                if given != held {
                    let message = format!("{given} vertices are named, and {held} are held");
                    let remedy = "name one for each vertex that is held, in the order of the numbers of these";
                    return Err(Problem::new(key.name("numbers"), message, remedy));
                }
                (numbers.clone(), key.name("numbers"))
            }
        };
        match numbers.iter().find(|&&number| number >= count) {
            Some(number) => {
                let message =
                    format!("there is no vertex {number}: the mesh in motion has {count}");
                Err(Problem::new(
                    key,
                    message,
                    format!("give numbers from 0 to {}", count - 1),
                ))
            }
            None => Ok(numbers),
        }
    }
}

/// The motion of a point that is at a place at the start and follows a vertex.
pub(super) fn following(mesh: &Arc<MovingMesh>, vertex: usize, start: [f64; 3]) -> PointMotion {
    let mesh = Arc::clone(mesh);
    let first = mesh.position(vertex, 0.0);
    let offset: [f64; 3] = std::array::from_fn(|k| start[k] - first[k]);
    PointMotion::from(move |t: f64| -> [f64; 3] {
        let place = mesh.position(vertex, t);
        std::array::from_fn(|k| place[k] + offset[k])
    })
}
