//! Which edges of the mesh of a drawing follow which lines.

use super::selector::Selector;
use crate::format::DataError;
use crate::format::vector::Pen;
use std::collections::{BTreeSet, HashMap};

/// The edges of the mesh of a drawing that follow lines, with how these are drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnEdges {
    /// How lines are drawn.
    pens: Vec<Pen>,
    /// The vertices at the ends of each edge, and the pens of the lines that it follows.
    edges: Vec<([u32; 2], BTreeSet<usize>)>,
}

impl DrawnEdges {
    /// Of the pens of edges by their ends, the smaller number first, among the edges that a mesh has.
    pub(super) fn new(
        pens: &[Pen],
        of_edge: &HashMap<[u32; 2], BTreeSet<usize>>,
        ends: impl Iterator<Item = [u32; 2]>,
        original: impl Fn(u32) -> u32,
    ) -> Self {
        let with_pens = |ends: [u32; 2]| {
            let [a, b] = ends.map(&original);
            Some((ends, of_edge.get(&[a.min(b), a.max(b)])?.clone()))
        };
        Self {
            pens: pens.to_vec(),
            edges: ends.filter_map(with_pens).collect(),
        }
    }

    /// The edges along the lines that are selected, by the vertices at their ends.
    ///
    /// # Errors
    /// [`DataError`] if the drawing has no such line.
    pub fn along(&self, selector: &Selector) -> Result<Vec<[u32; 2]>, DataError> {
        refuse_idle(selector, &self.pens)?;
        let is_along =
            |pens: &BTreeSet<usize>| pens.iter().any(|k| selector.selects(&self.pens[*k]));
        let edges = self.edges.iter().filter(|(_, pens)| is_along(pens));
        Ok(edges.map(|(ends, _)| *ends).collect())
    }
}

/// Refuses a selector that selects nothing: what it was meant for would be taken for something else.
pub(super) fn refuse_idle(selector: &Selector, pens: &[Pen]) -> Result<(), DataError> {
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
        listed(layers.iter().map(|name| format!("{name:?}")).collect())
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
