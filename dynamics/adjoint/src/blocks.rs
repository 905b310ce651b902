//! The symmetric matrix of a step, in blocks of all vertices.

use isosheet_materials::hessian::{CouplingSink, HessianSink};
use isosheet_mesh::{EdgeId, VertexId};
use isosheet_model::SheetModel;
use nalgebra::{Matrix3, Vector3};
use std::collections::HashMap;

/// A symmetric matrix of 3 x 3 blocks, at vertices, along edges and for other pairs, with terms of rank one.
#[derive(Debug, Clone, Default)]
pub(crate) struct Blocks {
    edges: Vec<[usize; 2]>,
    pub(crate) at_vertices: Vec<Matrix3<f64>>,
    /// Of each edge, rows at its first end.
    along_edges: Vec<Matrix3<f64>>,
    /// The pairs without an edge, with their blocks, rows at the first vertex.
    pairs: Vec<([u32; 2], Matrix3<f64>)>,
    places: HashMap<[u32; 2], u32>,
    /// Where the next pair is expected.
    next: usize,
    squares: Vec<Square>,
}

/// `factor g g^T`.
#[derive(Debug, Clone)]
struct Square {
    factor: f64,
    gradient: Vec<(VertexId, Vector3<f64>)>,
}

impl Blocks {
    /// A matrix of zeros for a model.
    pub(crate) fn of(model: &SheetModel) -> Self {
        let edges = model.edges().edges();
        let places = edges.iter().enumerate().map(|(e, ends)| {
            let [a, b] = ends.map(|v| v as u32);
            ([a.min(b), a.max(b)], e as u32)
        });
        Self {
            edges: edges.to_vec(),
            at_vertices: vec![Matrix3::zeros(); model.free_index().len()],
            along_edges: vec![Matrix3::zeros(); edges.len()],
            pairs: Vec::new(),
            // (Pairs follow the edges.)
            places: places.collect(),
            next: 0,
            squares: Vec::new(),
        }
    }

    /// Becomes zero.
    pub(crate) fn clear(&mut self) {
        self.at_vertices.fill(Matrix3::zeros());
        self.along_edges.fill(Matrix3::zeros());
        self.pairs
            .iter_mut()
            .for_each(|(_, b)| *b = Matrix3::zeros());
        self.next = 0;
        self.squares.clear();
    }

    /// Number of pairs without an edge.
    pub(crate) fn pair_count(&self) -> usize {
        self.pairs.len()
    }

    /// The blocks off the diagonal: two vertices, and the block with the rows of the first.
    pub(crate) fn off_diagonal(&self) -> impl Iterator<Item = ([usize; 2], &Matrix3<f64>)> {
        let edges = self.edges.iter().copied().zip(&self.along_edges);
        let pairs = self.pairs.iter().map(|(p, b)| (p.map(|v| v as usize), b));
        edges.chain(pairs)
    }

    /// Adds the product with `w` (`3V`) to `out`.
    pub(crate) fn add_product(&self, w: &[f64], out: &mut [f64]) {
        let at = |v: usize| Vector3::new(w[3 * v], w[3 * v + 1], w[3 * v + 2]);
        let mut add = |v: usize, sum: Vector3<f64>| {
            for k in 0..3 {
                out[3 * v + k] += sum[k];
            }
        };
        for (v, block) in self.at_vertices.iter().enumerate() {
            add(v, block * at(v));
        }
        for ([a, b], block) in self.off_diagonal() {
            add(a, block * at(b));
            add(b, block.tr_mul(&at(a)));
        }
        for square in &self.squares {
            let slopes = square.gradient.iter().map(|(v, g)| g.dot(&at(v.index())));
            let slope = square.factor * slopes.sum::<f64>();
            for (v, g) in &square.gradient {
                add(v.index(), slope * g);
            }
        }
    }

    fn add_pair_of(&mut self, a: u32, b: u32, block: &Matrix3<f64>) {
        if let Some((pair, own)) = self.pairs.get_mut(self.next)
            && *pair == [a, b]
        {
            *own += block;
            self.next += 1;
            return;
        }
        let key = [a.min(b), a.max(b)];
        let edge_count = self.edges.len();
        let place = *self.places.entry(key).or_insert_with(|| {
            self.pairs.push(([a, b], Matrix3::zeros()));
            (edge_count + self.pairs.len() - 1) as u32
        }) as usize;
        let (first, own) = match place.checked_sub(edge_count) {
            None => (self.edges[place][0], &mut self.along_edges[place]),
            Some(k) => {
                self.next = k + 1;
                let (pair, own) = &mut self.pairs[k];
                (pair[0] as usize, own)
            }
        };
        match first == a as usize {
            true => *own += block,
            false => *own += block.transpose(),
        }
    }
}

impl HessianSink for Blocks {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        self.at_vertices[v.index()] += block;
    }

    fn add_edge(&mut self, e: EdgeId, block: &Matrix3<f64>) {
        self.along_edges[e.index()] += block;
    }

    fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
        self.add_pair_of(a.0, b.0, block);
    }

    fn add_square(&mut self, factor: f64, gradient: &[(VertexId, Vector3<f64>)]) {
        self.squares.push(Square {
            factor,
            gradient: gradient.to_vec(),
        });
    }
}

impl CouplingSink for Blocks {
    fn add(&mut self, a: u32, b: u32, block: &Matrix3<f64>) {
        match a == b {
            true => self.at_vertices[a as usize] += block,
            false => self.add_pair_of(a, b, block),
        }
    }
}
