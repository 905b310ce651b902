//! Isometry in weak form: two equations for each vertex, and a soft membrane for what they leave free.

mod blocks;
mod columns;
mod plane;
mod rows;
#[cfg(test)]
mod tests;

pub(crate) use blocks::{Block, BlockRows, RingBlocks};
pub(crate) use rows::WeakRows;

use crate::membrane::{Membrane, MembraneError};
use isosheet_mesh::wording::{brief, given};
use isosheet_mesh::{Advice, FaceId, Sheet, VertexId};
use plane::RestPlane;

/// Stiffness of the membrane in units of `D / h^2`, with the flexural rigidity `D` and the size `h` of the
/// squares of the mesh.
///
/// On a smooth bend of curvature `c` the strains that the equations leave free are of the order of `(c h)^2`.
/// Their energy relative to that of bending is of the order of this number times `(c h)^2`, so that it
/// vanishes with the mesh for any value. Measured with 10, 100, 1000 and 1e4: a hanging sheet of 512 faces
/// (1 m, 0.1 kg, `D` = 5e-4 N m) stretches by at most 34, 14, 3 and 0.6 % and takes 3.9, 4.5, 6.1 and 7.6
/// factorisations a step, one of 2048 faces 5.9, 9.2 and 15.8 from 100 on; heavy strips with eight squares
/// across are within 0.1, 0.1, 0.1 and 0.7 % of the elastica.
const MEMBRANE_PER_BENDING: f64 = 100.0;

/// Why a sheet cannot be isometric in weak form.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WeakIsometryError {
    /// The rest shape is not flat.
    #[error(
        "the rest shape is not a plane: {vertex} is {distance} m away from the plane of the others",
        distance = brief(*distance)
    )]
    NotFlat {
        /// The vertex furthest from the plane.
        vertex: VertexId,
        /// Its distance, metres.
        distance: f64,
    },
    /// The rest shape is folded over.
    #[error("the rest shape lies in a plane, but {face} is turned over in it")]
    Folded {
        /// The face.
        face: FaceId,
    },
    /// The stiffness of the membrane is not positive or not finite.
    #[error(transparent)]
    Membrane(#[from] MembraneError),
    /// The flexural rigidity is not positive or not finite.
    #[error("the flexural rigidity is {rigidity} N m", rigidity = given(*rigidity))]
    Rigidity {
        /// The rigidity given, N m.
        rigidity: f64,
    },
}

impl Advice for WeakIsometryError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NotFlat { .. } => Some(
                "build the sheet from flat positions, and start the simulation from the bent ones",
            ),
            Self::Folded { .. } => Some("build the sheet from unfolded positions"),
            Self::Membrane(error) => error.advice(),
            Self::Rigidity { .. } => Some(
                "give a finite one above 0, or the stiffness of the membrane with `WeakIsometry::new`",
            ),
        }
    }
}

/// Isometry in weak form: lengths are kept in the mean over the faces around each vertex, to the tolerance of
/// a constraint, and single edges stretch a little.
///
/// # Equations
/// With the length errors `d_e = (|x_a - x_b|^2 - l_e^2) / 2` of the edges, Green's strain of a face `T` at
/// rest in a plane is the solution `E_T` of `e^T E_T e = d_e` for its three edge vectors `e`. A sheet deforms
/// isometrically if `E = 0`. In weak form that is the virtual work of `E` with all displacements of the rest
/// plane that are linear in each face: for each vertex `i` that is not pinned, with its hat function `phi_i`,
///
/// ```text
/// C_i(x) = h_i / A_i sum_{T at i} A_T E_T grad phi_i = 0    (two components),
/// ```
///
/// with the areas `A_T`, the area `A_i` of the `n_i` faces at the vertex and `h_i = sqrt(2 A_i / n_i)`. `C_i`
/// is a strain. At the boundary and at pins nothing changes but the number of faces. `C = W d` with a
/// constant matrix `W`: every equation is quadratic in the positions, like that of a rod.
///
/// The equations leave those strains free that are in equilibrium without load (Airy's stress functions, one
/// for each interior vertex); these ask for the curvature of the surface to vanish at the scale of the mesh.
/// Rods demand that, too, and lock where the mesh cannot follow. Here a membrane does so softly,
///
/// ```text
/// V(x) = k/2 sum_T A_T |E_T|^2,
/// ```
///
/// the [`Membrane`] with Poisson's ratio zero, by default with `k = 100 D / h^2` for the flexural rigidity
/// `D` and `h^2` twice the mean area of the faces. On a smooth bend `E` is of the order of `h^2`, so that
/// the energy of the membrane vanishes against that of bending as the mesh is refined. The bending
/// stiffness is that of [`PlateBending`](crate::PlateBending), which couples the same vertices: beside it
/// the equations and the membrane cost no further entries in the matrix of a step.
///
/// # What is guaranteed
/// Every accepted step has `|C_i| <= 1e-12` (or the tolerance that was asked for, or round-off where that
/// is larger) at every vertex that is not pinned. Where the sheet is flat all equations are independent
/// once two vertices are pinned; with a single pin one depends on the others, without pins three do (rigid
/// motions of the rest plane). The rank was found to be the same in bent states. Unlike the lengths of rods
/// the equations can be met where pins move apart: they are those of the equilibrium of an elastic sheet in
/// its plane, and the sheet stretches as its membrane does.
///
/// Not guaranteed are the lengths of single edges. [`StepReport::strain`](crate::StepReport::strain) tells by
/// how much they stretch. Measured with the default stiffness: 1e-6 to 2e-3 in heavy strips with eight
/// squares across, whose bends the mesh resolves; 23, 14, 6 and 4 % in a hanging square of 128, 512, 2048 and
/// 8192 faces that crumples at the scale of its mesh; up to 70 % at clamps of sheets of 25 to 127 vertices
/// that bend more sharply than the mesh can. Ten times the stiffness stretches a fifth to a third as much,
/// for up to 1.6 times the factorisations. Where the sheet would have to take double curvature the
/// result depends on the stiffness of the membrane.
///
/// # When to use it
/// For sheets that bend smoothly in any direction on a mesh of moderate size, are clamped, or hang freely:
/// where rods lock, and where a membrane of the stiffness of the material
/// ([`SheetModel::with_membrane`](crate::SheetModel::with_membrane)) is too stiff for the bends of a coarse
/// mesh. A soft membrane alone takes fewer factorisations and stretches several times as much. Rods remain
/// the choice for exact lengths and folds along the lines of the mesh, and for conservative methods and
/// charts.
///
/// (The equations are derived here; constraints that hold against test functions are those of mixed finite
/// elements, see D. Boffi, F. Brezzi and M. Fortin, "Mixed Finite Element Methods and Applications", 2013.
/// Another relaxation of the lengths of a mesh: E. English and R. Bridson, "Animating developable surfaces
/// using nonconforming elements", ACM Transactions on Graphics 27, 2008.)
#[derive(Debug)]
pub struct WeakIsometry {
    rows: WeakRows,
    membrane: Membrane,
}

impl WeakIsometry {
    /// Isometry of a sheet that is flat at rest, with a membrane of the given stiffness (newtons per metre).
    ///
    /// # Errors
    /// [`WeakIsometryError::NotFlat`], [`WeakIsometryError::Folded`]; [`WeakIsometryError::Membrane`] if the
    /// stiffness is not positive and finite.
    pub fn new(sheet: &Sheet, stiffness: f64) -> Result<Self, WeakIsometryError> {
        let plane = RestPlane::new(sheet)?;
        Ok(Self {
            rows: WeakRows::new(sheet, plane)?,
            membrane: Membrane::new(sheet, stiffness, 0.0)?,
        })
    }

    /// Isometry of a plate that is flat at rest; `rigidity` is its flexural rigidity in newton metres, from
    /// which
    /// [`WeakIsometry::stiffness_for`] makes that of the membrane.
    ///
    /// # Errors
    /// [`WeakIsometryError`].
    pub fn of_plate(sheet: &Sheet, rigidity: f64) -> Result<Self, WeakIsometryError> {
        if !(rigidity.is_finite() && rigidity > 0.0) {
            return Err(WeakIsometryError::Rigidity { rigidity });
        }
        Self::new(sheet, Self::stiffness_for(sheet, rigidity))
    }

    /// The stiffness `100 D / h^2` (newtons per metre) of the membrane that belongs to the flexural rigidity
    /// `D` (newton metres), with `h^2` twice the mean area of the faces.
    pub fn stiffness_for(sheet: &Sheet, rigidity: f64) -> f64 {
        let squared = 2.0 * sheet.area() / sheet.topology().face_count() as f64;
        MEMBRANE_PER_BENDING * rigidity / squared
    }

    /// The equations and the potential.
    pub(crate) fn into_parts(self) -> (WeakRows, Membrane) {
        (self.rows, self.membrane)
    }
}
