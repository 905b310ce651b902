//! Which edges of the mesh of a drawing follow which lines.

use crate::MeshFile;
use isosheet_drawings::{DrawnLines, Selector, refuse_idle};
use isosheet_files::DataError;

/// The edges of the mesh of a drawing that follow lines, with how these are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnEdges {
    lines: DrawnLines,
    /// The vertices at the ends of each edge, and the lines that it follows.
    edges: Vec<([u32; 2], Option<u32>)>,
}

impl DrawnEdges {
    /// The drawn edges of a mesh; `None` if it does not say of which lines it is made.
    pub fn of(mesh: &MeshFile) -> Option<Self> {
        let edges = mesh.creases.iter().filter(|crease| crease.drawn.is_some());
        (!mesh.drawn.pens().is_empty()).then(|| Self {
            lines: mesh.drawn.clone(),
            edges: edges.map(|crease| (crease.ends, crease.drawn)).collect(),
        })
    }

    /// The edges along the lines that are selected, by the vertices at their ends.
    ///
    /// # Errors
    /// [`DataError`] if the drawing has no such line.
    pub fn along(&self, selector: &Selector) -> Result<Vec<[u32; 2]>, DataError> {
        refuse_idle(selector, self.lines.pens())?;
        let is_along = |drawn| selector.selects_any(&self.lines, drawn);
        let edges = self.edges.iter().filter(|(_, drawn)| is_along(*drawn));
        Ok(edges.map(|(ends, _)| *ends).collect())
    }
}
