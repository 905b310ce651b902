//! System coordinate assignment by front propagation: `sys_coord_assnmt_single`
//! (Liu, Tang and Joneja 2007, Sec. 3.2 and 3.3, Fig. 8).
//!
//! Starting from a set H of known vertices, the front is the set of unknown neighbours of H. Within
//! a front, the vertex with the most known neighbours is placed next: three known neighbours need no
//! coordinate (rule f), two need one (rule g), one needs two (rule h). When the front is exhausted,
//! its unknown neighbours form the next one.
//!
//! **Counting.** A vertex with k known neighbours takes `max(3 - k, 0)` coordinates and uses up
//! `min(k, 3)` edge lengths. With four or more known neighbours `k - 3` edges are left over; they are
//! kept as *closures*, equations between the coordinates assigned so far. Every edge is counted when
//! its second end is placed, so for any mesh
//!
//! ```text
//! coordinates - closures = 3 (free vertices) - (edges with a free end) = DOF.
//! ```
//!
//! The union-jack sheets of the paper have no closures from any start vertex; a general mesh does.

mod propagation;

use isosheet_mesh::{EdgeId, Sheet, VertexId};
use propagation::Propagation;
use thiserror::Error;

/// Where the propagation of `sys_coord_assnmt_single` starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// The external point constraint of the paper: the vertex is held, its three coordinates are removed.
    Pinned(VertexId),
    /// A free vertex with its three Cartesian coordinates.
    Free(VertexId),
}

/// How a vertex gets its position. `q` is the index of its first system coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Held from outside, no unknowns.
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

/// What to do where three known neighbours do not determine a position.
///
/// Fig. 7 shows the case that they are on a line. The other one is a vertex coplanar with the three: its
/// two mirror images coincide there, which happens whenever a fold passes through flat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Degenerate {
    /// Keep rule f. Realisation carries the angle about the line over from the previous state
    /// ([`crate::placement::place_on_line`]) for as long as the three are on a line. The number of
    /// coordinates does not depend on the state; derivatives do not exist at the degenerate state itself.
    #[default]
    Carry,
    /// Assign one coordinate ([`Rule::Turn`]) and keep the third edge as a closure, which makes another
    /// coordinate dependent. Needed wherever a crease line stays straight while the sheet folds along
    /// it: in the union-jack squares every inner vertex of degree 4 keeps one of its two crease lines
    /// straight at any state with the right lengths, and rule f is singular for one of the two choices.
    Assign,
}

/// Options of [`assign`].
#[derive(Clone, Debug)]
pub struct AssignmentOptions {
    /// Vertices held in place; default none.
    pub pins: Vec<VertexId>,
    /// Start vertices of components without a pin; a component that has neither starts from its
    /// lowest vertex. Default none.
    pub starts: Vec<VertexId>,
    /// Treatment of Fig. 7; default [`Degenerate::Carry`].
    pub degenerate: Degenerate,
    /// With [`Degenerate::Assign`], volume spanned by the unit vectors along the three edges below which
    /// rule f is given up. Default 0.2 (a fold of about 12 degrees): the rule with a closure is
    /// valid away from the degenerate state as well and better conditioned near it, and with less an
    /// explicit step easily runs past the turning point of a vertex.
    pub volume: f64,
}

impl Default for AssignmentOptions {
    fn default() -> Self {
        Self {
            pins: Vec::new(),
            starts: Vec::new(),
            degenerate: Degenerate::default(),
            volume: 0.2,
        }
    }
}

/// Why coordinates cannot be assigned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum AssignmentError {
    /// A pin or start names a vertex that the mesh does not have.
    #[error("{vertex} does not exist, the mesh has {count} vertices")]
    NoSuchVertex {
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        count: usize,
    },
    /// A vertex is listed twice among pins and starts.
    #[error("{vertex} is listed twice among pins and starts; list it once")]
    Repeated {
        /// The vertex.
        vertex: VertexId,
    },
    /// A start vertex lies in a component that already has a pin or a start.
    #[error("start {vertex} lies in a component that has a pin or another start; remove it")]
    UnusedStart {
        /// The vertex.
        vertex: VertexId,
    },
    /// The state has the wrong number of values.
    #[error("the state has {found} values, expected {expected} (three per vertex)")]
    StateLength {
        /// Values given.
        found: usize,
        /// Values needed.
        expected: usize,
    },
}

/// The system coordinates of a mesh: the order in which vertices are placed and by which rule.
#[derive(Clone, Debug)]
pub struct Assignment {
    order: Vec<Placing>,
    position: Vec<u32>,
    closures: Vec<Closure>,
    coordinates: usize,
    fronts: u32,
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

/// `sys_coord_assnmt_single`: assign system coordinates from one start vertex
/// (Liu, Tang and Joneja 2007, Sec. 3.3).
///
/// Further components of the mesh start freely from their lowest vertex. Runs in O(E log V).
///
/// # Errors
/// [`AssignmentError::NoSuchVertex`].
pub fn sys_coord_assnmt_single(sheet: &Sheet, start: Start) -> Result<Assignment, AssignmentError> {
    let options = match start {
        Start::Pinned(v) => AssignmentOptions {
            pins: vec![v],
            ..Default::default()
        },
        Start::Free(v) => AssignmentOptions {
            starts: vec![v],
            ..Default::default()
        },
    };
    assign(sheet, sheet.positions(), &options)
}

/// Assign system coordinates with any number of pins and components.
///
/// With several pins H starts as the set of all of them; edges between pins constrain nothing and
/// are left out. `state` (three values per vertex) decides which three of four or more known
/// neighbours are used and whether three are on a line.
///
/// # Errors
/// See [`AssignmentError`].
pub fn assign(
    sheet: &Sheet,
    state: &[f64],
    options: &AssignmentOptions,
) -> Result<Assignment, AssignmentError> {
    let count = sheet.topology().vertex_count();
    if state.len() != 3 * count {
        return Err(AssignmentError::StateLength {
            found: state.len(),
            expected: 3 * count,
        });
    }
    let mut listed = vec![false; count];
    for &vertex in options.pins.iter().chain(&options.starts) {
        if vertex.index() >= count {
            return Err(AssignmentError::NoSuchVertex { vertex, count });
        }
        if std::mem::replace(&mut listed[vertex.index()], true) {
            return Err(AssignmentError::Repeated { vertex });
        }
    }
    let mut front = Propagation::new(sheet, state, options);
    for &v in &options.pins {
        front.mark(v, 0, Rule::Pinned);
    }
    front.run(&options.pins);
    for &v in &options.starts {
        if front.known[v.index()] {
            return Err(AssignmentError::UnusedStart { vertex: v });
        }
        front.start(v);
    }
    for i in 0..count {
        if !front.known[i] {
            front.start(VertexId(i as u32));
        }
    }
    Ok(front.done)
}

#[cfg(test)]
mod tests;
