//! Where a sheet is in a union of several.

use crate::{EdgeId, FaceId, Sheet, VertexId};
use std::ops::Range;

/// The vertices, edges and faces of one sheet in a [union](Sheet::union) of several: each of the three is one
/// range of numbers, because vertices and faces follow one another, and edges are numbered by their vertices.
///
/// ```
/// use isosheet_mesh::{Part, Sheet, VertexId, generate};
///
/// let (first, second) = (generate::isotropic_square(0, 1.0)?, generate::isotropic_square(1, 1.0)?);
/// let parts = Part::of_union(&[&first, &second]);
/// let both = Sheet::union(&[&first, &second])?;
/// assert_eq!(parts[1].vertices.end, both.topology().vertex_count());
/// assert_eq!(parts[1].vertex(VertexId(0)), VertexId(9));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Part {
    /// Numbers of its vertices in the union.
    pub vertices: Range<usize>,
    /// Numbers of its edges.
    pub edges: Range<usize>,
    /// Numbers of its faces.
    pub faces: Range<usize>,
}

impl Part {
    /// The parts of the union of some sheets, in their order.
    pub fn of_union(sheets: &[&Sheet]) -> Vec<Self> {
        let next = |from: &mut usize, count: usize| {
            let range = *from..*from + count;
            *from = range.end;
            range
        };
        let [mut vertices, mut edges, mut faces] = [0; 3];
        let parts = sheets.iter().map(|sheet| {
            let topology = sheet.topology();
            Self {
                vertices: next(&mut vertices, topology.vertex_count()),
                edges: next(&mut edges, topology.edge_count()),
                faces: next(&mut faces, topology.face_count()),
            }
        });
        parts.collect()
    }

    /// A vertex of the sheet in the union.
    pub fn vertex(&self, v: VertexId) -> VertexId {
        VertexId::from_index(self.vertices.start + v.index())
    }

    /// A vertex of the union in the sheet.
    ///
    /// # Panics
    /// If it is before the first of the part.
    pub fn local_vertex(&self, v: VertexId) -> VertexId {
        VertexId::from_index(v.index() - self.vertices.start)
    }

    /// An edge of the sheet in the union.
    pub fn edge(&self, e: EdgeId) -> EdgeId {
        EdgeId::from_index(self.edges.start + e.index())
    }

    /// A face of the sheet in the union.
    pub fn face(&self, f: FaceId) -> FaceId {
        FaceId::from_index(self.faces.start + f.index())
    }

    /// The numbers of its coordinates: three for each vertex.
    pub fn coordinates(&self) -> Range<usize> {
        3 * self.vertices.start..3 * self.vertices.end
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate;

    #[test]
    fn a_part_has_the_edges_and_faces_of_its_sheet() {
        let sheets = [
            generate::isotropic_square(1, 1.0).unwrap(),
            generate::disk(3, 0.5).unwrap(),
            generate::delaunay(&[[0.0, 0.0], [2.0, 0.0], [1.0, 1.5]], 0.3, 4).unwrap(),
        ];
        let sheets: Vec<&Sheet> = sheets.iter().collect();
        let union = Sheet::union(&sheets).unwrap();
        let parts = Part::of_union(&sheets);
        for (part, sheet) in parts.iter().zip(&sheets) {
            let (own, all) = (sheet.topology(), union.topology());
            for e in own.edge_ids() {
                let ends = own.edges()[e.index()].map(|v| part.vertex(v));
                assert_eq!(all.edges()[part.edge(e).index()], ends);
                assert_eq!(
                    union.lengths()[part.edge(e).index()],
                    sheet.lengths()[e.index()]
                );
            }
            for f in own.face_ids() {
                let edges = own.face_edges(f).map(|e| part.edge(e));
                assert_eq!(all.face_edges(part.face(f)), edges);
            }
            assert_eq!(&union.positions()[part.coordinates()], sheet.positions());
        }
        let last = parts.last().unwrap();
        assert_eq!(last.vertices.end, union.topology().vertex_count());
        assert_eq!(last.edges.end, union.topology().edge_count());
        assert_eq!(last.faces.end, union.topology().face_count());
    }
}
