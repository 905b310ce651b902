//! Sheets laid out in the plane: nets and patterns of developable surfaces.

mod cut_graph;
mod disks;
mod error;
mod halving;
mod least_squares;
mod options;
mod overlap;
mod packing;
mod patch;
mod paths;
mod start;
#[cfg(test)]
mod tests;
mod vec2;

pub use error::UnrollError;
pub use options::UnrollOptions;

use disks::{Disks, Laid};
use isosheet_mesh::{EdgeId, FaceId, Part, Sheet, Topology, VertexId, angle_deficits};
use packing::{in_rows, straighten};
use patch::Patch;
use std::collections::HashSet;

/// A sheet in the plane.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Unrolled {
    /// The pieces in the plane z = 0, in metres, side by side: faces are counter-clockwise.
    pub flat: Sheet,
    /// The vertices, edges and faces of each piece.
    pub pieces: Vec<Piece>,
    /// The vertex of the given sheet for each vertex of the flat one; both sides of a cut have the same ones.
    pub vertices: Vec<VertexId>,
    /// The face of the given sheet for each face of the flat one.
    pub faces: Vec<FaceId>,
    /// The edges of the given sheet that are cut.
    pub cuts: Vec<EdgeId>,
    /// The angle deficit of each vertex of the given sheet, radians, 0 on its boundary:
    /// [`angle_deficits`](isosheet_mesh::angle_deficits).
    pub deficits: Vec<f64>,
}

/// A piece of a sheet in the plane.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Piece {
    /// Its vertices, edges and faces in [`Unrolled::flat`].
    pub part: Part,
    /// The sides of its bounding box, metres, the longer one along x.
    pub sides: [f64; 2],
    /// The ends of the edge with the largest strain, as vertices of the given sheet.
    pub ends: [VertexId; 2],
    /// The strain of that edge, `length / rest length - 1`: round-off where the piece is developable.
    pub strain: f64,
}

impl Unrolled {
    /// The largest strain of an edge, by size, `length / rest length - 1`.
    pub fn strain(&self) -> f64 {
        let all = self.pieces.iter().map(|piece| piece.strain);
        all.fold(0.0, |m, s| if s.abs() > m.abs() { s } else { m })
    }

    /// The edge of the given sheet, whose topology is `given`, for an edge of the flat one.
    pub fn given_edge(&self, given: &Topology, e: EdgeId) -> Option<EdgeId> {
        let ends = self.flat.topology().edges()[e.index()];
        let [a, b] = ends.map(|v| self.vertices[v.index()]);
        given.find_edge(a, b)
    }
}

/// Lays a sheet out in the plane such that its edges keep their lengths, cutting it where it has to be cut.
///
/// Each part that is no disk (a cylinder, a closed surface, one with handles) is cut open along short edges,
/// creases before others and flat edges last. It is cut to its corners: vertices with an angle deficit of
/// more than [`UnrollOptions::largest_deficit`] that are on a crease or alone, as the apex of a cone and the
/// corners of a polyhedron. A part that lies flat around a hole is not cut there.
///
/// The positions minimise `sum w (|p - q|^2 / l^2 - 1)^2` over the edges, with the areas that belong to the
/// edges as weights, by Gauss and Newton's method from triangles that are laid side by side. Where no
/// deficits are left all lengths are met to round-off. Otherwise the strain that is left says how far the
/// sheet is from developable. No triangle is turned over. A piece that would lie on itself is divided
/// further. Pieces are turned such that their bounding boxes have the least area, and lie in rows.
///
/// ```
/// use isosheet_coords::{UnrollOptions, unroll};
/// use isosheet_mesh::Sheet;
/// // Three faces of a tetrahedron with edges of length 1, around the vertex 0.
/// let (h, r) = ((2.0_f64 / 3.0).sqrt(), (1.0_f64 / 3.0).sqrt());
/// let x = vec![0.0, 0.0, h, r, 0.0, 0.0, -r / 2.0, 0.5, 0.0, -r / 2.0, -0.5, 0.0];
/// let sheet = Sheet::new(x, &[[0, 1, 2], [0, 2, 3], [0, 3, 1]])?;
/// let unrolled = unroll(&sheet, &UnrollOptions::default())?;
/// assert_eq!(unrolled.cuts.len(), 1);
/// assert!((unrolled.deficits[0] - std::f64::consts::PI).abs() < 1e-14);
/// assert!(unrolled.strain().abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`UnrollError`]: the strain of an edge is larger than [`UnrollOptions::strain`], with the vertex that has
/// the largest deficit; an option is out of range; or a piece cannot be laid out.
pub fn unroll(sheet: &Sheet, options: &UnrollOptions) -> Result<Unrolled, UnrollError> {
    options.validate()?;
    let t = sheet.topology();
    let mut is_cut = vec![false; t.edge_count()];
    for &edge in &options.cuts {
        let count = t.edge_count();
        match is_cut.get_mut(edge.index()) {
            Some(cut) => *cut = true,
            None => return Err(UnrollError::NoEdge { edge, count }),
        }
    }
    let deficits = angle_deficits(t, sheet.positions());
    let is_named = |[a, b]: [VertexId; 2]| t.find_edge(a, b).is_some_and(|e| is_cut[e.index()]);
    let disks = Disks {
        options,
        deficits: &deficits,
        is_named: &is_named,
    };
    let mut laid = Vec::new();
    for part in Patch::whole(sheet).opened(&is_cut)? {
        laid.extend(disks.of(&part)?);
    }
    let (flat, pieces) = placed(&mut laid, options.gap)?;
    let vertices = laid.iter().flat_map(|l| &l.patch.vertices).copied();
    let faces = laid.iter().flat_map(|l| &l.patch.faces).copied();
    let mut unrolled = Unrolled {
        flat,
        pieces,
        vertices: vertices.map(VertexId).collect(),
        faces: faces.map(FaceId).collect(),
        cuts: Vec::new(),
        deficits,
    };
    let own = unrolled.flat.topology();
    let rim = own.edge_ids().filter(|e| own.is_boundary_edge(*e));
    let cuts: HashSet<EdgeId> = rim
        .filter_map(|e| unrolled.given_edge(t, e))
        .filter(|e| !t.is_boundary_edge(*e))
        .collect();
    unrolled.cuts = cuts.into_iter().collect();
    unrolled.cuts.sort_unstable();
    Ok(unrolled)
}

/// The pieces side by side.
fn placed(laid: &mut [Laid], gap: Option<f64>) -> Result<(Sheet, Vec<Piece>), UnrollError> {
    /// The default gap, as a part of the longest side.
    const GAP: f64 = 1.0 / 20.0;
    let sides: Vec<[f64; 2]> = laid.iter_mut().map(|l| straighten(&mut l.points)).collect();
    let longest = sides.iter().fold(0.0_f64, |m, s| m.max(s[0]));
    let places = in_rows(&sides, gap.unwrap_or(GAP * longest));
    let mut sheets = Vec::with_capacity(laid.len());
    for (own, place) in laid.iter().zip(&places) {
        let points = own.points.iter();
        let x = points.flat_map(|p| [p[0] + place[0], p[1] + place[1], 0.0]);
        sheets.push(Sheet::from_topology(
            own.patch.sheet.topology().clone(),
            x.collect(),
        )?);
    }
    let sheets: Vec<&Sheet> = sheets.iter().collect();
    let parts = Part::of_union(&sheets);
    let pieces = laid.iter().zip(parts).zip(sides);
    let pieces = pieces.map(|((own, part), sides)| Piece {
        part,
        sides,
        ends: own.patch.whole_ends(own.strain.0),
        strain: own.strain.1,
    });
    Ok((Sheet::union(&sheets)?, pieces.collect()))
}
