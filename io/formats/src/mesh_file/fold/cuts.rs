//! Cuts: the two sides of a cut edge have vertices of their own.

use super::sides::sorted;
use crate::mesh_file::{EdgeAssignment, FileCrease, MeshFile};
use std::collections::{BTreeMap, BTreeSet, HashMap};

impl MeshFile {
    /// Separates the sheet along the edges that are cut.
    ///
    /// At each end of a cut edge, the faces that are neighbours across edges that are not cut stay together:
    /// those with the first face keep the vertex, the others get copies of it. A cut edge becomes two edges.
    pub(crate) fn separate_cuts(&mut self) {
        let cuts: BTreeSet<[u32; 2]> = self
            .creases
            .iter()
            .filter(|c| c.assignment == EdgeAssignment::Cut)
            .map(|c| sorted(c.ends))
            .collect();
        if cuts.is_empty() {
            return;
        }
        let mut at_edge: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
        let mut at_vertex: BTreeMap<u32, Vec<usize>> =
            cuts.iter().flatten().map(|&v| (v, Vec::new())).collect();
        for (f, &[a, b, c]) in self.faces.iter().enumerate() {
            for side in [[a, b], [b, c], [c, a]] {
                at_edge.entry(sorted(side)).or_default().push(f);
            }
            for v in [a, b, c] {
                if let Some(faces) = at_vertex.get_mut(&v) {
                    faces.push(f);
                }
            }
        }
        let mut copies: HashMap<(usize, u32), u32> = HashMap::new();
        for (&v, faces) in &at_vertex {
            let groups = self.groups(v, faces, &at_edge, &cuts);
            for group in groups.iter().skip(1) {
                let copy = self.vertex_count() as u32;
                let k = 3 * v as usize;
                self.positions.extend_from_within(k..k + 3);
                self.changes.vertices_at_cuts += 1;
                copies.extend(group.iter().map(|&f| ((f, v), copy)));
            }
        }
        let label = |f: usize, v: u32| copies.get(&(f, v)).copied().unwrap_or(v);
        self.creases = self
            .creases
            .iter()
            .flat_map(|crease| {
                let sides = at_edge.get(&sorted(crease.ends)).map_or(&[][..], |f| f);
                let copy = |&f: &usize| FileCrease {
                    ends: crease.ends.map(|v| label(f, v)),
                    ..*crease
                };
                let mut copied: Vec<FileCrease> = sides.iter().map(copy).collect();
                copied.dedup_by_key(|c| c.ends);
                if copied.is_empty() {
                    vec![*crease]
                } else {
                    copied
                }
            })
            .collect();
        for ends in &mut self.diagonals {
            if let Some(&f) = at_edge.get(&sorted(*ends)).and_then(|faces| faces.first()) {
                *ends = ends.map(|v| label(f, v));
            }
        }
        for (f, face) in self.faces.iter_mut().enumerate() {
            *face = face.map(|v| label(f, v));
        }
    }

    /// The faces at a vertex in groups that no cut separates there, each in the order of the faces.
    fn groups(
        &self,
        v: u32,
        faces: &[usize],
        at_edge: &HashMap<[u32; 2], Vec<usize>>,
        cuts: &BTreeSet<[u32; 2]>,
    ) -> Vec<Vec<usize>> {
        let mut left: BTreeSet<usize> = faces.iter().copied().collect();
        let mut groups = Vec::new();
        while let Some(first) = left.pop_first() {
            let mut group = vec![first];
            let mut visited = 0;
            while visited < group.len() {
                let face = self.faces[group[visited]];
                visited += 1;
                for w in face.into_iter().filter(|&w| w != v) {
                    let edge = sorted([v, w]);
                    if cuts.contains(&edge) {
                        continue;
                    }
                    let neighbours = at_edge.get(&edge).into_iter().flatten();
                    group.extend(neighbours.filter(|f| left.remove(f)));
                }
            }
            group.sort_unstable();
            groups.push(group);
        }
        groups
    }
}
