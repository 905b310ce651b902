//! Sheets made from sheets: parts, unions, other positions.

use crate::{FaceId, MeshError, Sheet, VertexId};

impl Sheet {
    /// The sheet of the faces for which `keep` holds; vertices that are then in no face are dropped, the
    /// others keep their order.
    ///
    /// # Errors
    /// [`MeshError`] when no face is left or the rest hangs together at a vertex only.
    pub fn keep_faces(&self, mut keep: impl FnMut(FaceId) -> bool) -> Result<Self, MeshError> {
        let t = self.topology();
        let kept: Vec<[VertexId; 3]> = t
            .face_ids()
            .filter(|&f| keep(f))
            .map(|f| t.faces()[f.index()])
            .collect();
        let mut renumbered = vec![u32::MAX; t.vertex_count()];
        for v in kept.iter().flatten() {
            renumbered[v.index()] = 0;
        }
        let mut positions = Vec::new();
        for v in t
            .vertex_ids()
            .filter(|v| renumbered[v.index()] == 0)
            .collect::<Vec<_>>()
        {
            renumbered[v.index()] = (positions.len() / 3) as u32;
            positions.extend(self.position(v));
        }
        let faces: Vec<[u32; 3]> = kept
            .iter()
            .map(|f| f.map(|v| renumbered[v.index()]))
            .collect();
        Self::new(positions, &faces)
    }

    /// All the given sheets as one mesh of several components; vertices and faces follow one another in the
    /// order given.
    ///
    /// # Errors
    /// [`MeshError`] when `sheets` is empty or too large.
    pub fn union(sheets: &[&Self]) -> Result<Self, MeshError> {
        let mut positions = Vec::new();
        let mut faces = Vec::new();
        for s in sheets {
            let offset = (positions.len() / 3) as u32;
            positions.extend_from_slice(s.positions());
            faces.extend(s.topology().faces().iter().map(|f| f.map(|v| v.0 + offset)));
        }
        Self::new(positions, &faces)
    }

    /// The same mesh with every rest position replaced by `map` of it (metres): scaled, moved, turned.
    ///
    /// ```
    /// let flat = isosheet_mesh::generate::isotropic_square(0, 1.0)?;
    /// let upright = flat.map_positions(|[x, y, z]| [x, -z, y])?;
    /// assert_eq!(upright.lengths(), flat.lengths());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError`] when `map` makes a face vanish or gives a coordinate that is not finite.
    pub fn map_positions(&self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Result<Self, MeshError> {
        let positions = self
            .positions()
            .chunks_exact(3)
            .flat_map(|p| map([p[0], p[1], p[2]]))
            .collect();
        Self::from_topology(self.topology().clone(), positions)
    }
}
