//! Sheets made from sheets: unions, other positions.

use crate::{MeshError, Sheet};

impl Sheet {
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

    /// This mesh with every rest position replaced by `map` of it (metres): scaled, moved, turned.
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
