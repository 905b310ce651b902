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

mod error;
mod options;
mod propagation;
mod rules;

pub use error::AssignmentError;
pub use options::{AssignmentOptions, Degenerate};
pub use rules::{Assignment, Closure, Placing, Rule};

use isosheet_mesh::{Sheet, VertexId};
use propagation::Propagation;

/// Where the propagation of `sys_coord_assnmt_single` starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartVertex {
    /// The external point constraint of the paper: the vertex is pinned, its three coordinates are removed.
    Pinned(VertexId),
    /// A free vertex with its three Cartesian coordinates.
    Free(VertexId),
}

/// `sys_coord_assnmt_single`: assign system coordinates from one start vertex
/// (Liu, Tang and Joneja 2007, Sec. 3.3).
///
/// Further components of the mesh start freely from their lowest vertex. Runs in O(E log V).
///
/// # Errors
/// [`AssignmentError::NoSuchVertex`].
pub fn sys_coord_assnmt_single(
    sheet: &Sheet,
    start: StartVertex,
) -> Result<Assignment, AssignmentError> {
    let options = match start {
        StartVertex::Pinned(v) => AssignmentOptions {
            pins: vec![v],
            ..Default::default()
        },
        StartVertex::Free(v) => AssignmentOptions {
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
    options.validate()?;
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
