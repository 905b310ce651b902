//! Points and edges with a radius: round bodies.

use std::ops::Range;

/// The round bodies of a mesh, whose vertices come after all others.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Rounds {
    /// The first of their vertices.
    first: u32,
    /// Of each of these its body, and whether it takes part in contact as a vertex.
    vertices: Vec<(u32, bool)>,
    /// The radii of the bodies, metres.
    radii: Vec<f64>,
    /// Vertices that take no part, because round bodies are in the place of them.
    replaced: Vec<Range<usize>>,
}

impl Rounds {
    /// Adds a body, with whether each of its vertices takes part by itself, where the first of these
    /// has this number.
    pub(super) fn add(
        &mut self,
        first: u32,
        replaced: Range<usize>,
        vertices: &[bool],
        radius: f64,
    ) {
        if self.radii.is_empty() {
            self.first = first;
        }
        let number = self.radii.len() as u32;
        self.vertices
            .extend(vertices.iter().map(|own| (number, *own)));
        self.radii.push(radius);
        self.replaced.push(replaced);
    }

    /// The radius about a vertex of one of the bodies, metres.
    #[inline]
    pub(super) fn radius(&self, vertex: u32) -> Option<f64> {
        let place = vertex.checked_sub(self.first)?;
        let (number, _) = self.vertices.get(place as usize)?;
        self.radii.get(*number as usize).copied()
    }

    /// Whether an edge is a point: both ends are at the same place.
    #[inline]
    pub(super) fn is_point(&self, [first, second]: [u32; 2]) -> bool {
        self.radius(first).is_some() && self.takes_part(first) && !self.takes_part(second)
    }

    /// Whether a vertex takes part in contact.
    #[inline]
    pub(super) fn takes_part(&self, vertex: u32) -> bool {
        if self.radii.is_empty() {
            return true;
        }
        match vertex.checked_sub(self.first) {
            Some(place) => self
                .vertices
                .get(place as usize)
                .is_some_and(|(_, own)| *own),
            None => {
                let mut replaced = self.replaced.iter();
                !replaced.any(|range| range.contains(&(vertex as usize)))
            }
        }
    }
}
