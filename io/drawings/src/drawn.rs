//! How the lines of a drawing are drawn that edges of its mesh follow.

use crate::Pen;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// The lines of the drawing that a mesh is made of: colours, dashes and layers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnLines {
    /// How lines are drawn, each once.
    pens: Vec<Pen>,
    /// Of the lines that lie on each other along an edge the numbers of their pens.
    sets: Vec<BTreeSet<usize>>,
    /// The numbers of the sets.
    of_set: BTreeMap<BTreeSet<usize>, u32>,
}

impl DrawnLines {
    /// No edges yet, of a drawing with some pens; what its pen `k` is here is entry `k` of the list.
    pub fn of_pens(pens: &[Pen]) -> (Self, Vec<usize>) {
        let mut lines = Self::default();
        let mut known = HashMap::new();
        let mut number = |pen: &'_ Pen| {
            lines.pens.push(pen.clone());
            lines.pens.len() - 1
        };
        let numbers = pens.iter().map(|pen| {
            let key = (pen.colour.0, pen.dashed, pen.opacity.to_bits(), &pen.layers);
            *known.entry(key).or_insert_with(|| number(pen))
        });
        let numbers = numbers.collect();
        (lines, numbers)
    }

    /// The number of a set of pens, which is `FileCrease::drawn` of a mesh.
    pub fn set(&mut self, pens: BTreeSet<usize>) -> u32 {
        *self.of_set.entry(pens).or_insert_with_key(|pens| {
            self.sets.push(pens.clone());
            self.sets.len() as u32 - 1
        })
    }

    /// How the lines of the drawing are drawn; none if the mesh is not made of one.
    pub fn pens(&self) -> &[Pen] {
        &self.pens
    }

    /// The numbers of the pens of the lines that an edge follows, by its
    /// `FileCrease::drawn` of a mesh.
    pub fn numbers(&self, drawn: Option<u32>) -> impl Iterator<Item = usize> {
        let set = drawn.and_then(|set| self.sets.get(set as usize));
        set.into_iter().flatten().copied()
    }

    /// The name of a line that an edge follows, by its `FileCrease::drawn` of a mesh: the
    /// innermost of its layers and groups, or its own.
    pub fn name(&self, drawn: Option<u32>) -> Option<&str> {
        let mut pens = self.pens_of(drawn);
        pens.find_map(|pen| pen.layers.first()).map(String::as_str)
    }

    /// The pens of the lines that an edge follows.
    pub fn pens_of(&self, drawn: Option<u32>) -> impl Iterator<Item = &Pen> {
        self.numbers(drawn).map(|pen| &self.pens[pen])
    }
}
