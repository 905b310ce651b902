//! Faces that a load acts on, and how they are oriented together.

#[cfg(test)]
mod tests;

use isosheet_mesh::{Advice, EdgeId, FaceId, Topology, VertexId};
use std::collections::{BTreeMap, VecDeque};

/// Why faces cannot be loaded together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LoadedFacesError {
    /// There are no faces.
    #[error("no face is loaded")]
    Empty,
    /// A face does not exist.
    #[error("{face} is loaded, but the sheet has only {face_count} faces")]
    NoSuchFace {
        /// The face.
        face: FaceId,
        /// Number of faces.
        face_count: usize,
    },
    /// A joined vertex does not exist.
    #[error("{vertex} is joined, but the sheet has only {vertex_count} vertices")]
    NoSuchVertex {
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        vertex_count: usize,
    },
    /// The faces have no two sides, as on a Moebius band.
    #[error("the faces around the edge from {from} to {to} have no common side")]
    OneSided {
        /// Where an edge of the seam begins.
        from: VertexId,
        /// Where it ends.
        to: VertexId,
    },
    /// More than two rims meet in a seam.
    #[error("more than two rims meet in the edge from {from} to {to}")]
    Branching {
        /// Where an edge of the seam begins.
        from: VertexId,
        /// Where it ends.
        to: VertexId,
    },
}

impl Advice for LoadedFacesError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Empty => Some("name at least one face"),
            Self::OneSided { .. } => Some("load each of the parts by itself"),
            Self::Branching { .. } => Some("load the faces of two sheets at each seam"),
            Self::NoSuchFace { .. } | Self::NoSuchVertex { .. } => None,
        }
    }
}

/// A side of a face: the edge between a corner and the next one, and whether it is directed in this way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Side {
    pub(super) edge: EdgeId,
    pub(super) is_forward: bool,
}

/// The corners of a face in the order of its orientation, with its three sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Corners {
    pub(super) vertices: [VertexId; 3],
    pub(super) sides: [Side; 3],
}

impl Corners {
    /// Of a face as the mesh has it.
    pub(super) fn of(topology: &Topology, face: FaceId) -> Self {
        let vertices = topology.faces()[face.index()];
        let edges = topology.face_edges(face);
        let side = |k: usize| Side {
            edge: edges[k],
            is_forward: topology.edges()[edges[k].index()][0] == vertices[k],
        };
        Self {
            vertices,
            sides: [0, 1, 2].map(side),
        }
    }

    /// This face with one of its edges as its first side.
    pub(super) fn beginning_with(self, edge: EdgeId) -> Self {
        let first = self.sides.iter().position(|side| side.edge == edge);
        let first = first.expect("the edge is one of the face");
        Self {
            vertices: [0, 1, 2].map(|k| self.vertices[(first + k) % 3]),
            sides: [0, 1, 2].map(|k| self.sides[(first + k) % 3]),
        }
    }

    /// The face seen from its other side.
    fn turned_over(self) -> Self {
        let ([a, b, c], [ab, bc, ca]) = (self.vertices, self.sides);
        let back = |side: Side| Side {
            is_forward: !side.is_forward,
            ..side
        };
        Self {
            vertices: [a, c, b],
            sides: [ca, bc, ab].map(back),
        }
    }

    /// The ends of a side, from where it begins.
    pub(super) fn ends(&self, side: usize) -> [VertexId; 2] {
        [self.vertices[side], self.vertices[(side + 1) % 3]]
    }
}

/// Some faces of a mesh that a pressure or a gas acts on, with one side that is their front.
///
/// The front of a face is the side from which its corners are counter-clockwise. Vertices of rims may be
/// joined in pairs, as by `Glue`: then the faces on both sides of such a seam get a common
/// front, that of the first face. Edges of rims that are joined to no other are free.
#[derive(Debug, Clone)]
pub struct LoadedFaces {
    pub(super) corners: Vec<Corners>,
    pub(super) rim: Vec<[VertexId; 2]>,
    pub(super) seams: Vec<Seam>,
}

/// Two edges of rims that are joined: one in the direction of its face, and the ends of the other one in the
/// same order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Seam {
    pub(super) one: [VertexId; 2],
    pub(super) other: [VertexId; 2],
}

impl Seam {
    /// Two triangles that close the gap between the edges, with the front of the faces.
    pub(super) fn strip(&self) -> [[VertexId; 3]; 2] {
        let ([a, b], [c, d]) = (self.one, self.other);
        [[b, a, c], [b, c, d]]
    }

    fn turned_over(self) -> Self {
        let back = |[a, b]: [VertexId; 2]| [b, a];
        Self {
            one: back(self.one),
            other: back(self.other),
        }
    }
}

impl LoadedFaces {
    /// Faces of a mesh, the first of which says where the front is, with pairs of vertices that are joined.
    ///
    /// # Errors
    /// [`LoadedFacesError`].
    pub fn new(
        topology: &Topology,
        faces: &[FaceId],
        joined: &[[VertexId; 2]],
    ) -> Result<Self, LoadedFacesError> {
        let face_count = topology.face_count();
        if let Some(&face) = faces.iter().find(|f| f.index() >= face_count) {
            return Err(LoadedFacesError::NoSuchFace { face, face_count });
        }
        let vertex_count = topology.vertex_count();
        if let Some(&vertex) = joined.iter().flatten().find(|v| v.index() >= vertex_count) {
            return Err(LoadedFacesError::NoSuchVertex {
                vertex,
                vertex_count,
            });
        }
        if faces.is_empty() {
            return Err(LoadedFacesError::Empty);
        }
        let parts = connected(topology, faces);
        let rims: Vec<RimEdge> = parts.rim(topology);
        let seams = Seams::new(&rims, &places(vertex_count, joined))?;
        let is_turned = seams.orientations(&rims, parts.count)?;
        let oriented = |&(face, part): &(FaceId, usize)| {
            let corners = Corners::of(topology, face);
            match is_turned[part] {
                true => corners.turned_over(),
                false => corners,
            }
        };
        Ok(Self {
            corners: parts.faces.iter().map(oriented).collect(),
            rim: seams.free.iter().map(|k| rims[*k].ends).collect(),
            seams: seams.oriented(&rims, &is_turned),
        })
    }

    /// All faces of a mesh.
    ///
    /// # Errors
    /// [`LoadedFacesError::Empty`] if it has none.
    pub fn all(topology: &Topology) -> Result<Self, LoadedFacesError> {
        let faces: Vec<FaceId> = topology.face_ids().collect();
        Self::new(topology, &faces, &[])
    }

    /// With the other side as front.
    #[must_use]
    pub fn turned_over(mut self) -> Self {
        self.corners = self.corners.into_iter().map(Corners::turned_over).collect();
        self.seams = self.seams.into_iter().map(Seam::turned_over).collect();
        self
    }

    /// The edges of the rim that are joined to no other.
    pub fn rim(&self) -> &[[VertexId; 2]] {
        &self.rim
    }
}

/// Faces with the numbers of the connected parts that they belong to.
struct Parts {
    faces: Vec<(FaceId, usize)>,
    count: usize,
}

/// An edge of a rim, in the direction of its face.
struct RimEdge {
    ends: [VertexId; 2],
    part: usize,
}

/// The parts of some faces that edges connect; the first face belongs to the first part.
fn connected(topology: &Topology, faces: &[FaceId]) -> Parts {
    let mut part_of: BTreeMap<FaceId, Option<usize>> = faces.iter().map(|f| (*f, None)).collect();
    let mut count = 0;
    for &first in faces {
        if part_of[&first].is_some() {
            continue;
        }
        let mut queue = VecDeque::from([first]);
        part_of.insert(first, Some(count));
        while let Some(face) = queue.pop_front() {
            let edges = topology.face_edges(face);
            for next in edges
                .into_iter()
                .flat_map(|e| topology.edge_faces(e))
                .flatten()
            {
                if let Some(part @ None) = part_of.get_mut(&next) {
                    *part = Some(count);
                    queue.push_back(next);
                }
            }
        }
        count += 1;
    }
    let faces = part_of.into_iter();
    let faces = faces.filter_map(|(face, part)| Some((face, part?)));
    Parts {
        faces: faces.collect(),
        count,
    }
}

impl Parts {
    fn rim(&self, topology: &Topology) -> Vec<RimEdge> {
        let of: BTreeMap<FaceId, usize> = self.faces.iter().copied().collect();
        let mut rim = Vec::new();
        for &(face, part) in &self.faces {
            let corners = Corners::of(topology, face);
            for (k, side) in corners.sides.iter().enumerate() {
                let both = topology.edge_faces(side.edge);
                if !both.iter().all(|f| f.is_some_and(|f| of.contains_key(&f))) {
                    let ends = corners.ends(k);
                    rim.push(RimEdge { ends, part });
                }
            }
        }
        rim
    }
}

/// For each vertex the smallest number of the vertices that it is joined to.
fn places(vertex_count: usize, joined: &[[VertexId; 2]]) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..vertex_count).collect();
    let root = |parent: &[usize], mut v: usize| {
        while parent[v] != v {
            v = parent[v];
        }
        v
    };
    for [a, b] in joined {
        let [a, b] = [a, b].map(|v| root(&parent, v.index()));
        parent[a.max(b)] = a.min(b);
    }
    (0..vertex_count).map(|v| root(&parent, v)).collect()
}

/// The edges of rims that coincide in pairs, and the others.
struct Seams {
    /// Numbers of two edges, and whether they run in the same direction.
    pairs: Vec<([usize; 2], bool)>,
    free: Vec<usize>,
}

impl Seams {
    fn new(rims: &[RimEdge], places: &[usize]) -> Result<Self, LoadedFacesError> {
        let mut at: BTreeMap<[usize; 2], Vec<(usize, bool)>> = BTreeMap::new();
        for (k, edge) in rims.iter().enumerate() {
            let [a, b] = edge.ends.map(|v| places[v.index()]);
            // (An edge whose ends are joined has no length.)
            if a != b {
                let found = at.entry([a.min(b), a.max(b)]).or_default();
                found.push((k, a < b));
            }
        }
        let (mut pairs, mut free) = (Vec::new(), Vec::new());
        for found in at.values() {
            match found[..] {
                [(k, _)] => free.push(k),
                [(k, one), (l, other)] => pairs.push(([k, l], one == other)),
                _ => {
                    let [from, to] = rims[found[0].0].ends;
                    return Err(LoadedFacesError::Branching { from, to });
                }
            }
        }
        free.sort_unstable();
        Ok(Self { pairs, free })
    }

    /// The seams, by which parts are turned over.
    fn oriented(&self, rims: &[RimEdge], is_turned: &[bool]) -> Vec<Seam> {
        let seam = |&([k, l], is_same): &([usize; 2], bool)| {
            let (one, [c, d]) = (rims[k].ends, rims[l].ends);
            let other = if is_same { [c, d] } else { [d, c] };
            let seam = Seam { one, other };
            match is_turned[rims[k].part] {
                true => seam.turned_over(),
                false => seam,
            }
        };
        self.pairs.iter().map(seam).collect()
    }

    /// Which parts have to be turned over for a common front.
    fn orientations(
        &self,
        rims: &[RimEdge],
        part_count: usize,
    ) -> Result<Vec<bool>, LoadedFacesError> {
        let mut turned: Vec<Option<bool>> = vec![None; part_count];
        for first in 0..part_count {
            if turned[first].is_some() {
                continue;
            }
            turned[first] = Some(false);
            // Each pass goes on from what the passes before reached.
            for _ in 0..part_count {
                for &([k, l], is_same) in &self.pairs {
                    let [one, other] = [rims[k].part, rims[l].part];
                    match [turned[one], turned[other]] {
                        [Some(a), Some(b)] if (a != b) != is_same => {
                            let [from, to] = rims[k].ends;
                            return Err(LoadedFacesError::OneSided { from, to });
                        }
                        [Some(a), None] => turned[other] = Some(a != is_same),
                        [None, Some(b)] => turned[one] = Some(b != is_same),
                        _ => {}
                    }
                }
            }
        }
        Ok(turned.into_iter().map(|t| t == Some(true)).collect())
    }
}
