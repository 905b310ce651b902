//! Meshes that are cut open along edges.

use std::collections::VecDeque;

/// The faces of a mesh that is cut along some of its edges: what lies on the two sides of a cut has vertices
/// of its own.
///
/// Faces stay together at a vertex where they are neighbours across edges that are not cut. So a cut that
/// ends inside of the sheet leaves its last vertex whole, and a single edge between two such ends cannot be
/// cut.
///
/// ```
/// use isosheet_mesh::Opened;
/// // A square of four triangles around vertex 4, cut from corner to corner.
/// let faces = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
/// let opened = Opened::along(&faces, |[a, b]| [a, b] == [0, 4] || [a, b] == [2, 4]);
/// assert_eq!(opened.origins, [0, 0, 1, 2, 2, 3, 4, 4]);
/// assert_eq!(opened.parts().len(), 2);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Opened {
    /// The faces in their order, with the new numbers of their corners.
    pub faces: Vec<[u32; 3]>,
    /// The vertex of the mesh before for each vertex, ascending. Vertices without a face are left out.
    pub origins: Vec<u32>,
    /// The faces that were turned over.
    pub reversed: Vec<usize>,
    /// The edges (smaller vertex before the larger one, as numbered before) where more than two faces met or
    /// two windings could not be made to agree: the surface was cut there.
    pub seams: Vec<[u32; 2]>,
}

/// A side of a face: the vertices at its ends, the smaller one first, the face, and its first corner.
type Side = ([u32; 2], usize, usize);

impl Opened {
    /// The faces cut along the edges `[a, b]`, `a < b`, that `is_cut` names, and along edges where more than
    /// two faces meet.
    pub fn along(faces: &[[u32; 3]], is_cut: impl Fn([u32; 2]) -> bool) -> Self {
        let sides = sides(faces);
        let inner = pairs(&sides);
        Self::joined(faces.to_vec(), inner.filter(|pair| !is_cut(pair[0].0)))
    }

    /// An oriented surface of faces that need not be one: faces are turned over where that makes windings
    /// agree. The surface is cut where it does not (around a Moebius band they cannot agree everywhere),
    /// where more than two faces meet at an edge, and where faces meet at a vertex alone.
    pub fn surface(faces: &[[u32; 3]]) -> Self {
        let sides = sides(faces);
        let joined: Vec<[Side; 2]> = pairs(&sides).collect();
        let mut beside = vec![Vec::new(); faces.len()];
        for [one, other] in &joined {
            // Windings agree if the two faces run along their edge in opposite directions.
            let agrees = tail(faces, one) != tail(faces, other);
            beside[one.1].push((other.1, agrees));
            beside[other.1].push((one.1, agrees));
        }
        let mut is_turned: Vec<Option<bool>> = vec![None; faces.len()];
        for first in 0..faces.len() {
            if is_turned[first].is_some() {
                continue;
            }
            is_turned[first] = Some(false);
            let mut open = VecDeque::from([(first, false)]);
            while let Some((face, turned)) = open.pop_front() {
                for &(next, agrees) in &beside[face] {
                    if is_turned[next].is_none() {
                        is_turned[next] = Some(turned == agrees);
                        open.push_back((next, turned == agrees));
                    }
                }
            }
        }
        let is_turned: Vec<bool> = is_turned.into_iter().map(|t| t == Some(true)).collect();
        let turned = faces.iter().zip(&is_turned);
        let turned = turned.map(|(&[a, b, c], turned)| if *turned { [a, c, b] } else { [a, b, c] });
        let turned: Vec<[u32; 3]> = turned.collect();
        let sides = self::sides(&turned);
        let agrees = |pair: &[Side; 2]| tail(&turned, &pair[0]) != tail(&turned, &pair[1]);
        let mut seams: Vec<[u32; 2]> = pairs(&sides)
            .filter(|pair| !agrees(pair))
            .map(|pair| pair[0].0)
            .collect();
        seams.extend(runs(&sides).filter(|run| run.len() > 2).map(|run| run[0].0));
        seams.sort_unstable();
        Self {
            reversed: (0..faces.len()).filter(|f| is_turned[*f]).collect(),
            seams,
            ..Self::joined(turned.clone(), pairs(&sides).filter(agrees))
        }
    }

    /// Faces that hang together across some pairs of their sides alone.
    fn joined(faces: Vec<[u32; 3]>, joined: impl Iterator<Item = [Side; 2]>) -> Self {
        let mut corners = Sets::new(3 * faces.len());
        for [one, other] in joined {
            for v in one.0 {
                let corner = |side: &Side| {
                    let own = faces[side.1].iter().position(|w| *w == v);
                    own.map(|k| 3 * side.1 + k)
                };
                if let (Some(a), Some(b)) = (corner(&one), corner(&other)) {
                    corners.unite(a, b);
                }
            }
        }
        let vertex = |corner: usize| faces[corner / 3][corner % 3];
        let mut first: Vec<usize> = (0..3 * faces.len())
            .filter(|&k| corners.root(k) == k)
            .collect();
        first.sort_by_key(|&k| (vertex(k), k));
        let origins = first.iter().map(|&k| vertex(k)).collect();
        let mut number = vec![0; 3 * faces.len()];
        for (new, &k) in first.iter().enumerate() {
            number[k] = new as u32;
        }
        let numbered = (0..faces.len())
            .map(|f| [0, 1, 2].map(|k| number[corners.root(3 * f + k)]))
            .collect();
        Self {
            faces: numbered,
            origins,
            reversed: Vec::new(),
            seams: Vec::new(),
        }
    }

    /// The numbers of the faces of each part that hangs together at vertices, in the order of their first
    /// faces.
    pub fn parts(&self) -> Vec<Vec<usize>> {
        let mut vertices = Sets::new(self.origins.len());
        for [a, b, c] in self.faces.iter().map(|f| f.map(|v| v as usize)) {
            vertices.unite(a, b);
            vertices.unite(a, c);
        }
        let mut part = vec![None; self.origins.len()];
        let mut parts: Vec<Vec<usize>> = Vec::new();
        for (f, face) in self.faces.iter().enumerate() {
            let root = vertices.root(face[0] as usize);
            let number = *part[root].get_or_insert_with(|| {
                parts.push(Vec::new());
                parts.len() - 1
            });
            parts[number].push(f);
        }
        parts
    }
}

/// The vertex from which a face runs along one of its sides.
fn tail(faces: &[[u32; 3]], side: &Side) -> u32 {
    faces[side.1][side.2]
}

/// All sides of all faces, in the order of their edges.
fn sides(faces: &[[u32; 3]]) -> Vec<Side> {
    let of_face = |(f, face): (usize, &[u32; 3])| {
        [0, 1, 2].map(|k| {
            let [a, b] = [face[k], face[(k + 1) % 3]];
            ([a.min(b), a.max(b)], f, k)
        })
    };
    let mut sides: Vec<Side> = faces.iter().enumerate().flat_map(of_face).collect();
    sides.sort_unstable();
    sides
}

/// The sides of each edge.
fn runs(sides: &[Side]) -> impl Iterator<Item = &[Side]> {
    sides.chunk_by(|one, other| one.0 == other.0)
}

/// The two sides of the edges that have two.
fn pairs(sides: &[Side]) -> impl Iterator<Item = [Side; 2]> {
    runs(sides).filter_map(|run| <[Side; 2]>::try_from(run).ok())
}

/// Disjoint sets; the smallest element stands for its set.
struct Sets(Vec<usize>);

impl Sets {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn root(&mut self, mut k: usize) -> usize {
        while self.0[k] != k {
            self.0[k] = self.0[self.0[k]];
            k = self.0[k];
        }
        k
    }

    fn unite(&mut self, a: usize, b: usize) {
        let [a, b] = [a, b].map(|k| self.root(k));
        self.0[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Topology;

    /// The faces of a band of `n` squares, closed after a turn, or half a turn.
    fn band(n: u32, twisted: bool) -> Vec<[u32; 3]> {
        let corner = |k: u32, side: u32| match k < n {
            true => 2 * k + side,
            false => 2 * (k - n) + if twisted { 1 - side } else { side },
        };
        let square = |k| {
            let [a, b] = [corner(k, 0), corner(k + 1, 0)];
            let [d, c] = [corner(k, 1), corner(k + 1, 1)];
            [[a, b, c], [a, c, d]]
        };
        (0..n).flat_map(square).collect()
    }

    #[test]
    fn without_cuts_nothing_changes() {
        let faces = band(6, false);
        let opened = Opened::surface(&faces);
        assert_eq!(opened.faces, faces);
        assert_eq!(opened.origins, (0..12).collect::<Vec<_>>());
        assert!(opened.reversed.is_empty() && opened.seams.is_empty());
        assert_eq!(Opened::along(&faces, |_| false), opened);
    }

    /// A Moebius band is cut once across and is a disk then: as many edges as go across its strip.
    #[test]
    fn a_moebius_band_is_cut_across() {
        let faces = band(7, true);
        assert!(Topology::from_faces(14, &faces).is_err());
        let opened = Opened::surface(&faces);
        let disk = Topology::from_faces(opened.origins.len(), &opened.faces).unwrap();
        disk.check_invariants();
        assert_eq!(disk.euler_characteristic(), 1);
        assert_eq!(opened.seams.len(), 1);
        assert_eq!(opened.origins.len(), 16);
    }

    #[test]
    fn faces_are_turned_and_fans_separated() {
        // The second face is wound the other way, and a third one stands on their edge.
        let opened = Opened::surface(&[[0, 1, 2], [0, 1, 3]]);
        assert_eq!(opened.reversed, [1]);
        assert!(Topology::from_faces(4, &opened.faces).is_ok());
        let fan = Opened::surface(&[[0, 1, 2], [0, 3, 1], [0, 1, 4]]);
        assert_eq!(fan.seams, [[0, 1]]);
        assert_eq!(fan.parts().len(), 3);
        // A bow tie, and vertices without faces.
        let tie = Opened::surface(&[[0, 1, 5], [0, 7, 8]]);
        assert_eq!(tie.origins, [0, 0, 1, 5, 7, 8]);
        assert_eq!(tie.parts(), [[0], [1]]);
    }
}
