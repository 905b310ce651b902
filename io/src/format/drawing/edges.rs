//! Which edges of the mesh of a drawing follow which lines.

use super::selector::Selector;
use crate::format::vector::Pen;
use crate::format::{DrawnLines, MeshFile};
use isosheet_files::DataError;
use isosheet_mesh::wording::quoted;
use std::collections::BTreeSet;

/// The edges of the mesh of a drawing that follow lines, with how these are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnEdges {
    lines: DrawnLines,
    /// The vertices at the ends of each edge, and the lines that it follows.
    edges: Vec<([u32; 2], Option<u32>)>,
}

impl DrawnEdges {
    /// Those of a mesh; `None` if it does not say of which lines it is made.
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

impl Selector {
    /// Whether one of the lines is meant that an edge follows, by its
    /// [`FileCrease::drawn`](crate::FileCrease::drawn).
    pub fn selects_any(&self, lines: &DrawnLines, drawn: Option<u32>) -> bool {
        lines.pens_of(drawn).any(|pen| self.selects(pen))
    }
}

/// Refuses a selector that selects nothing: what it was meant for would be taken for something else.
pub(crate) fn refuse_idle(selector: &Selector, pens: &[Pen]) -> Result<(), DataError> {
    if pens.iter().any(|pen| selector.selects(pen)) {
        return Ok(());
    }
    let colours: BTreeSet<String> = pens.iter().map(|p| p.colour.to_string()).collect();
    let layers: BTreeSet<&str> = pens
        .iter()
        .flat_map(|p| &p.layers)
        .map(String::as_str)
        .collect();
    let message = format!(
        "{selector} selects no line: the colours are {}, and the layers and names {}",
        listed(colours.into_iter().collect()),
        listed(layers.iter().map(|name| quoted(name)).collect())
    );
    Err(DataError::new(
        message,
        "name lines that the drawing has, or leave it out",
    ))
}

/// Most names that an error lists.
const MOST_LISTED: usize = 12;

/// The first of some names, and the number of the others.
pub(super) fn listed(names: Vec<String>) -> String {
    match names.len() {
        0 => "none".to_owned(),
        n if n > MOST_LISTED => format!(
            "{} and {} more",
            names[..MOST_LISTED].join(", "),
            n - MOST_LISTED
        ),
        _ => names.join(", "),
    }
}
