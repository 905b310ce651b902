//! Parts of a sheet that know where they come from.

use isosheet_mesh::{EdgeId, MeshError, Opened, Sheet, VertexId};

/// A part of a sheet, with the numbers that its faces and vertices have in the whole.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    /// The part in its place in space.
    pub(super) sheet: Sheet,
    /// The face of the whole for each face.
    pub(super) faces: Vec<u32>,
    /// The vertex of the whole for each vertex. Both sides of a cut have the same ones.
    pub(super) vertices: Vec<u32>,
}

impl Patch {
    /// All of a sheet.
    pub(super) fn whole(sheet: &Sheet) -> Self {
        let t = sheet.topology();
        Self {
            sheet: sheet.clone(),
            faces: (0..t.face_count() as u32).collect(),
            vertices: (0..t.vertex_count() as u32).collect(),
        }
    }

    /// The parts that hang together when it is cut along some of its edges.
    pub(super) fn opened(&self, is_cut: &[bool]) -> Result<Vec<Self>, MeshError> {
        let t = self.sheet.topology();
        let opened = Opened::along(&self.sheet.face_indices(), |[a, b]| {
            let edge = t.find_edge(VertexId(a), VertexId(b));
            edge.is_some_and(|e| is_cut[e.index()])
        });
        let parts = opened.parts();
        parts.iter().map(|part| self.part(&opened, part)).collect()
    }

    /// Some of its faces when it is cut.
    fn part(&self, opened: &Opened, part: &[usize]) -> Result<Self, MeshError> {
        let mut used: Vec<u32> = part.iter().flat_map(|f| opened.faces[*f]).collect();
        used.sort_unstable();
        used.dedup();
        let number = |v: u32| used.binary_search(&v).map_or(0, |k| k as u32);
        let faces: Vec<[u32; 3]> = part.iter().map(|f| opened.faces[*f].map(number)).collect();
        let own = |v: &u32| opened.origins[*v as usize];
        let place = |v: &u32| self.sheet.position(VertexId(own(v)));
        Ok(Self {
            sheet: Sheet::new(used.iter().flat_map(place).collect(), &faces)?,
            faces: part.iter().map(|f| self.faces[*f]).collect(),
            vertices: used
                .iter()
                .map(|v| self.vertices[own(v) as usize])
                .collect(),
        })
    }

    /// Its edge between two vertices of the whole, of a face of the whole that it has.
    pub(super) fn whole_ends(&self, e: EdgeId) -> [VertexId; 2] {
        let ends = self.sheet.topology().edges()[e.index()];
        ends.map(|v| VertexId(self.vertices[v.index()]))
    }
}
