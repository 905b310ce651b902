//! The curvature of the faces of a sheet, from positions alone.

#[cfg(test)]
mod tests;

use super::error::PlateBendingError;
use super::law::{PlateLaw, Roots};
use super::line_clamp::PlateEdges;
use super::second_derivatives::SecondDerivatives;
use super::stencil::Stencils;
use crate::patched::Patched;
use crate::potential::At;
use crate::vectors::point;
use isosheet_mesh::{EdgeId, FaceId, GaussCurvature, Ruling, Sheet, VertexId};
use std::collections::BTreeMap;
use std::sync::Arc;

/// How a sheet is curved, face by face: the second derivatives of positions of
/// [`PlateBending`](crate::PlateBending), for any sheet and without stiffness.
///
/// ```
/// use isosheet_materials::FaceCurvature;
/// use isosheet_mesh::generate;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // A strip that is rolled about the y axis, to a radius of 0.5 m.
/// let sheet = generate::isotropic_square(3, 0.2)?;
/// let mut x = sheet.positions().to_vec();
/// for p in x.as_chunks_mut::<3>().0 {
///     let angle = p[0] / 0.5;
///     (p[0], p[2]) = (0.5 * angle.sin(), 0.5 * (1.0 - angle.cos()));
/// }
/// let curvature = FaceCurvature::new(&sheet, &[], &[])?;
/// let ruling = curvature.rulings(&x)[40].expect("a bent face");
/// assert!((ruling.curvature - 2.0).abs() < 0.02 && ruling.direction[1] > 0.999);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct FaceCurvature {
    /// Of the sheet that is cut along its creases.
    derivatives: SecondDerivatives,
    /// Of each vertex of that sheet the one that it is of the whole sheet.
    places: Vec<VertexId>,
    corners: Vec<[VertexId; 3]>,
    gauss: GaussCurvature,
}

impl FaceCurvature {
    /// Of a sheet of which the edge lengths count. At `creases`, and around faces all corners of which are
    /// `held`, the curvature jumps, and no fit of slopes reaches across: the sheet is cut along its creases,
    /// and faces that are held are flat.
    ///
    /// # Errors
    /// [`PlateBendingError`] for a vertex or an edge that the sheet has not.
    pub fn new(
        sheet: &Sheet,
        held: &[VertexId],
        creases: &[EdgeId],
    ) -> Result<Self, PlateBendingError> {
        let t = sheet.topology();
        let count = t.vertex_count();
        if let Some(&vertex) = held.iter().find(|v| v.index() >= count) {
            return Err(PlateBendingError::NoVertex { vertex, count });
        }
        let count = t.edge_count();
        if let Some(&edge) = creases.iter().find(|e| e.index() >= count) {
            return Err(PlateBendingError::NoEdge { edge, count });
        }
        let gauss = GaussCurvature::new(sheet);
        let corners = t.faces().to_vec();
        let (cut, places) = cut_along(sheet, creases);
        let is_held = |k: &usize| held.contains(&places[*k]);
        let held: Vec<_> = (0..places.len())
            .filter(is_held)
            .map(VertexId::from_index)
            .collect();
        let edges = PlateEdges {
            pinned: &held,
            ..PlateEdges::default()
        };
        let roots = Roots::new(&cut, &Patched::everywhere(PlateLaw::from(1.0)))?;
        let stencils = Arc::new(Stencils::new(&cut, &roots, &edges));
        let derivatives = SecondDerivatives::new(&stencils, &roots, cut.face_areas());
        Ok(Self {
            derivatives,
            places,
            corners,
            gauss,
        })
    }

    /// The second fundamental form of each face at positions `x` (`3V`, metres), `(k11, k12, k22)`, 1/m: the
    /// first axis along the first edge of the face, the second one counter-clockwise across, positive where
    /// the sheet is a valley as seen from the side from which faces are counter-clockwise.
    ///
    /// It is the part of the second derivatives along the normal of the face. Derivatives are by the lengths
    /// of the rest shape, of which an isometric sheet has the same ones.
    ///
    /// # Panics
    /// If `x` is not of length `3V`.
    pub fn forms(&self, x: &[f64]) -> Vec<[f64; 3]> {
        let cut: Vec<f64> = self
            .places
            .iter()
            .flat_map(|v| <[f64; 3]>::from(point(x, *v)))
            .collect();
        let derivatives = self.derivatives.at(At::new(0.0, &cut)).zip(&self.corners);
        let form = derivatives.map(|(second, corners)| {
            let [a, b, c] = corners.map(|v| point(x, v));
            let normal = (b - a).cross(&(c - a)).normalize();
            let [k11, twist, k22] = [0, 1, 2].map(|k| normal.dot(&second.column(k)));
            [k11, twist / std::f64::consts::SQRT_2, k22]
        });
        form.collect()
    }

    /// The ruling of each face at positions `x` (`3V`, metres), with the curvature across it; nothing where
    /// the sheet is not bent beyond the noise of lengths ([`Ruling::of_face`],
    /// [`GaussCurvature::error_of_lengths`]).
    ///
    /// # Panics
    /// If `x` is not of length `3V`.
    pub fn rulings(&self, x: &[f64]) -> Vec<Option<Ruling>> {
        let error = self.gauss.error_of_lengths(x);
        let forms = self.forms(x).into_iter().zip(&self.corners);
        let ruling = |(form, corners): ([f64; 3], &[VertexId; 3])| {
            let corners = corners.map(|v| point(x, v).into());
            Ruling::of_face(&corners, form, error)
        };
        forms.map(ruling).collect()
    }

    /// The Gauss curvature besides that of the rest shape.
    pub fn gauss(&self) -> &GaussCurvature {
        &self.gauss
    }
}

/// The sheet cut along edges, with the vertex of the whole sheet for each of its own; faces and their corners
/// keep their order. A line of edges that ends inside of the sheet is cut up to the edge at its end.
fn cut_along(sheet: &Sheet, edges: &[EdgeId]) -> (Sheet, Vec<VertexId>) {
    let t = sheet.topology();
    let whole = || (sheet.clone(), t.vertex_ids().collect());
    if edges.is_empty() {
        return whole();
    }
    let mut is_cut = vec![false; t.edge_count()];
    for e in edges {
        is_cut[e.index()] = true;
    }
    // Of each corner of each face another one at the same vertex, on the way to the first one of its side.
    let mut of_corner: Vec<usize> = (0..3 * t.face_count()).collect();
    let corner = |f: FaceId, v: VertexId| {
        let place = t.faces()[f.index()].iter().position(|w| *w == v);
        3 * f.index() + place.unwrap_or_default()
    };
    for e in t.edge_ids().filter(|e| !is_cut[e.index()]) {
        let [Some(left), Some(right)] = t.edge_faces(e) else {
            continue;
        };
        for v in t.edges()[e.index()] {
            let [a, b] = [left, right].map(|f| root(&mut of_corner, corner(f, v)));
            of_corner[a.max(b)] = a.min(b);
        }
    }
    let (mut numbers, mut places, mut x) = (BTreeMap::new(), Vec::new(), Vec::new());
    let mut faces = Vec::with_capacity(t.face_count());
    for (f, corners) in t.faces().iter().enumerate() {
        faces.push([0, 1, 2].map(|k| {
            let first = root(&mut of_corner, 3 * f + k);
            *numbers.entry(first).or_insert_with(|| {
                places.push(corners[k]);
                x.extend(sheet.position(corners[k]));
                places.len() as u32 - 1
            })
        }));
    }
    Sheet::new(x, &faces).map_or_else(|_| whole(), |cut| (cut, places))
}

/// The first corner of the side that a corner is on, with the path to it halved.
fn root(of_corner: &mut [usize], mut corner: usize) -> usize {
    while of_corner[corner] != corner {
        of_corner[corner] = of_corner[of_corner[corner]];
        corner = of_corner[corner];
    }
    corner
}
