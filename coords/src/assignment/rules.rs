//! The outcome of an assignment: which rule places each vertex, and which edges are left over.

use isosheet_mesh::{EdgeId, VertexId};

/// How a vertex gets its position. `q` is the index of its first system coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Pinned; the vertex has no unknowns.
    Pinned,
    /// Start of a free component: three Cartesian coordinates `q`, `q + 1`, `q + 2`.
    Start {
        /// First coordinate.
        q: usize,
    },
    /// One known neighbour: longitude `q` and latitude `q + 1` (Fig. 6a).
    H {
        /// The known neighbour.
        known: VertexId,
        /// The edge to it.
        edge: EdgeId,
        /// First coordinate.
        q: usize,
    },
    /// Two known neighbours: rotation angle `q` about their line (Fig. 6b).
    G {
        /// The known neighbours, in the order of their placing.
        known: [VertexId; 2],
        /// The edges to them.
        edges: [EdgeId; 2],
        /// The coordinate.
        q: usize,
    },
    /// Three known neighbours, no coordinate (Fig. 6c).
    F {
        /// The known neighbours. With a hub the middle one is the other end of the common edge of
        /// the two triangles.
        known: [VertexId; 3],
        /// The edges to them.
        edges: [EdgeId; 3],
        /// The common edge of the two adjacent triangles of Fig. 6(c), when the three known
        /// neighbours are consecutive around the vertex; Eq. 10 is stated at this edge.
        hub: Option<EdgeId>,
    },
    /// Three known neighbours that leave a direction free in the state given to the assignment: they are
    /// on a line (Fig. 7) or coplanar with the vertex. The angle `q` about the line of the first two,
    /// as rule g; the third edge is a closure.
    Turn {
        /// The known neighbours; the first two are those seen under the angle nearest to 90 degrees.
        known: [VertexId; 3],
        /// The edges to them.
        edges: [EdgeId; 3],
        /// The coordinate.
        q: usize,
    },
}

impl Rule {
    /// One letter for drawings: `p` pinned, `s` start, `h`, `g`, `f`, and `t` for [`Rule::Turn`].
    #[must_use]
    pub fn letter(&self) -> char {
        match self {
            Rule::Pinned => 'p',
            Rule::Start { .. } => 's',
            Rule::H { .. } => 'h',
            Rule::G { .. } => 'g',
            Rule::F { .. } => 'f',
            Rule::Turn { .. } => 't',
        }
    }

    /// Number of system coordinates of the rule.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        match self {
            Rule::Pinned | Rule::F { .. } => 0,
            Rule::Start { .. } => 3,
            Rule::H { .. } => 2,
            Rule::G { .. } | Rule::Turn { .. } => 1,
        }
    }

    /// The known neighbours used.
    #[must_use]
    pub fn known(&self) -> &[VertexId] {
        match self {
            Rule::Pinned | Rule::Start { .. } => &[],
            Rule::H { known, .. } => std::slice::from_ref(known),
            Rule::G { known, .. } => known,
            Rule::F { known, .. } | Rule::Turn { known, .. } => known,
        }
    }
}

/// One vertex in assignment order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placing {
    /// The vertex.
    pub vertex: VertexId,
    /// Number of the front it belongs to; pinned and start vertices are front 0.
    pub front: u32,
    /// Its rule.
    pub rule: Rule,
}

/// An edge that no placement uses up: an equation between coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Closure {
    /// The end of the edge that was placed last.
    pub vertex: VertexId,
    /// The edge.
    pub edge: EdgeId,
}

/// The system coordinates of a mesh: the order in which vertices are placed and by which rule.
#[derive(Clone, Debug)]
pub struct Assignment {
    pub(super) order: Vec<Placing>,
    pub(super) position: Vec<u32>,
    pub(super) closures: Vec<Closure>,
    pub(super) coordinates: usize,
    pub(super) fronts: u32,
}

impl Assignment {
    /// The vertices in the order of their placing.
    #[must_use]
    pub fn order(&self) -> &[Placing] {
        &self.order
    }

    /// How vertex `v` is placed.
    ///
    /// # Panics
    /// When the mesh has no such vertex.
    #[must_use]
    pub fn placing(&self, v: VertexId) -> &Placing {
        &self.order[self.position[v.index()] as usize]
    }

    /// Edges that are left over as closure equations.
    #[must_use]
    pub fn closures(&self) -> &[Closure] {
        &self.closures
    }

    /// Number of coordinates assigned.
    #[must_use]
    pub fn coordinate_count(&self) -> usize {
        self.coordinates
    }

    /// Degrees of freedom: coordinates minus closures.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.coordinates - self.closures.len()
    }

    /// Number of fronts, front 0 not counted; the largest over the components.
    #[must_use]
    pub fn front_count(&self) -> u32 {
        self.fronts
    }

    /// Number of vertices placed by the rule with the given letter, see [`Rule::letter`].
    #[must_use]
    pub fn rule_count(&self, letter: char) -> usize {
        self.order
            .iter()
            .filter(|p| p.rule.letter() == letter)
            .count()
    }
}
