//! Undirected graphs, as elimination orders need them.

use super::Pattern;

/// Distance of a vertex that is not connected.
pub(super) const UNREACHED: u32 = u32::MAX;

/// An undirected graph without loops, in compressed adjacency.
#[derive(Debug, Clone)]
pub(super) struct Graph {
    start: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Graph {
    /// The graph of a symmetric matrix given by its lower triangle, with each group of `block` consecutive
    /// unknowns as one vertex.
    pub(super) fn of_blocks(pattern: &Pattern, block: usize) -> Self {
        let n = pattern.cols().div_ceil(block);
        let mut edges = Vec::new();
        for c in 0..pattern.cols() {
            for k in pattern.col_ptr()[c]..pattern.col_ptr()[c + 1] {
                let (i, j) = (pattern.row_idx()[k] / block, c / block);
                if i != j {
                    edges.push((i as u32, j as u32));
                }
            }
        }
        edges.sort_unstable();
        edges.dedup();
        Self::from_edges(n, &edges)
    }

    /// The graph with the given edges, each listed once.
    pub(super) fn from_edges(n: usize, edges: &[(u32, u32)]) -> Self {
        let mut start = vec![0u32; n + 1];
        for &(i, j) in edges {
            start[i as usize + 1] += 1;
            start[j as usize + 1] += 1;
        }
        for v in 0..n {
            start[v + 1] += start[v];
        }
        let mut next = start.clone();
        let mut neighbours = vec![0u32; 2 * edges.len()];
        for &(i, j) in edges {
            for (v, w) in [(i, j), (j, i)] {
                neighbours[next[v as usize] as usize] = w;
                next[v as usize] += 1;
            }
        }
        Self { start, neighbours }
    }

    /// Number of vertices.
    pub(super) fn len(&self) -> usize {
        self.start.len() - 1
    }

    /// Neighbours of a vertex.
    pub(super) fn of(&self, v: u32) -> &[u32] {
        let v = v as usize;
        &self.neighbours[self.start[v] as usize..self.start[v + 1] as usize]
    }

    /// The graph of some vertices, numbered as listed; `index` is scratch of the length of this graph.
    pub(super) fn induced(&self, vertices: &[u32], index: &mut [u32]) -> Self {
        for (k, &v) in vertices.iter().enumerate() {
            index[v as usize] = k as u32;
        }
        let mut start = Vec::with_capacity(vertices.len() + 1);
        let mut neighbours = Vec::new();
        start.push(0);
        for &v in vertices {
            // Stale entries of `index` name other vertices, or none.
            neighbours.extend(
                self.of(v)
                    .iter()
                    .filter(|&&w| vertices.get(index[w as usize] as usize) == Some(&w))
                    .map(|&w| index[w as usize]),
            );
            start.push(neighbours.len() as u32);
        }
        Self { start, neighbours }
    }

    /// Number of edges from a vertex to all others, [`UNREACHED`] in other components.
    pub(super) fn distances(&self, from: usize) -> Vec<u32> {
        let mut distance = vec![UNREACHED; self.len()];
        if distance.is_empty() {
            return distance;
        }
        distance[from] = 0;
        let mut queue = vec![from as u32];
        let mut head = 0;
        while head < queue.len() {
            let v = queue[head];
            head += 1;
            for &w in self.of(v) {
                if distance[w as usize] == UNREACHED {
                    distance[w as usize] = distance[v as usize] + 1;
                    queue.push(w);
                }
            }
        }
        distance
    }

    /// The vertices of each connected component, by first vertex.
    pub(super) fn components(&self) -> Vec<Vec<u32>> {
        let mut seen = vec![false; self.len()];
        let mut all = Vec::new();
        for first in 0..self.len() {
            if seen[first] {
                continue;
            }
            seen[first] = true;
            let mut list = vec![first as u32];
            let mut head = 0;
            while head < list.len() {
                for &w in self.of(list[head]) {
                    if !seen[w as usize] {
                        seen[w as usize] = true;
                        list.push(w);
                    }
                }
                head += 1;
            }
            all.push(list);
        }
        all
    }
}
