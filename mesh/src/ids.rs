//! Typed indices of vertices, edges, half-edges and faces.

use std::fmt;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident, $word:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl $name {
            /// The index as a `usize`, for addressing arrays.
            #[inline]
            pub const fn index(self) -> usize {
                self.0 as usize
            }

            /// The id with the given array index.
            ///
            /// A [`Topology`](crate::Topology) never holds more than `u32::MAX / 2` elements of one kind, so
            /// any index that came from one fits.
            #[inline]
            pub const fn from_index(index: usize) -> Self {
                debug_assert!(index <= u32::MAX as usize, "an id does not fit 32 bits");
                Self(index as u32)
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($word, " {}"), self.0)
            }
        }
    };
}

id!(
    /// A vertex: its rank in the position array.
    VertexId,
    "vertex"
);
id!(
    /// An edge: its rank in [`Topology::edges`](crate::Topology::edges).
    EdgeId,
    "edge"
);
id!(
    /// A face: its rank in the face list that the mesh was built from.
    FaceId,
    "face"
);
id!(
    /// One of the two directions of an edge: half-edge `2 e + s` belongs to edge `e`, running from its first
    /// to its second end for `s = 0` and back for `s = 1`.
    HalfEdgeId,
    "half-edge"
);

impl HalfEdgeId {
    /// The half-edge of `edge` with the given side, 0 (first end to second end) or 1 (back).
    #[inline]
    pub const fn new(edge: EdgeId, side: usize) -> Self {
        debug_assert!(side < 2, "a half-edge has side 0 or 1");
        Self(2 * edge.0 + side as u32)
    }

    /// The edge that this half-edge belongs to.
    #[inline]
    pub const fn edge(self) -> EdgeId {
        EdgeId(self.0 >> 1)
    }

    /// 0 when the half-edge runs with its edge, 1 when it runs against it.
    #[inline]
    pub const fn side(self) -> usize {
        (self.0 & 1) as usize
    }

    /// The other direction of the same edge.
    #[inline]
    pub const fn twin(self) -> Self {
        Self(self.0 ^ 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_edges_pair_up() {
        let e = EdgeId(7);
        let (h0, h1) = (HalfEdgeId::new(e, 0), HalfEdgeId::new(e, 1));
        assert_eq!((h0.0, h1.0), (14, 15));
        assert_eq!(h0.twin(), h1);
        assert_eq!(h1.twin(), h0);
        assert_eq!((h0.edge(), h1.edge()), (e, e));
        assert_eq!((h0.side(), h1.side()), (0, 1));
        assert_eq!(h1.to_string(), "half-edge 15");
        assert_eq!(VertexId::from_index(3), VertexId(3));
    }
}
