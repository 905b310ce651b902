//! Pressure on faces, which follows them.

#[cfg(test)]
mod tests;

use super::follower::{FaceLoad, Follower, OfCorners};
use super::loaded_faces::{Corners, LoadedFaces};
use super::volume::Volume;
use crate::SheetModel;
use isosheet_materials::hessian::{HessianPart, HessianSink};
use isosheet_materials::potential::{At, Potential};
use isosheet_materials::vectors::add;
use isosheet_motion::{Profile, ProfileError};
use nalgebra::Matrix3;
use std::sync::Arc;

impl SheetModel {
    /// Adds a pressure of a given size (pascals) on faces. A face of the area `A` with the unit normal `n` of
    /// its front feels the force `p A n`, a third of it on each corner: a positive pressure pushes towards
    /// the front.
    ///
    /// Where the faces enclose a volume `V`, the pressure has the potential `-p V`. Elsewhere it is a force,
    /// whose work is a part of `StepReport::work`: BDF2 and implicit Euler take it
    /// at the end of a step, all other methods as it is.
    ///
    /// ```
    /// use isosheet_mesh::{MassKind, generate};
    /// use isosheet_model::{LoadedFaces, SheetModel};
    /// use isosheet_motion::Profile;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let sheet = generate::isotropic_square(1, 0.2)?;
    /// let faces = LoadedFaces::all(sheet.topology())?;
    /// let rising = Profile::Ramp { from: 0.0, to: 2.0, begin: 0.0, end: 0.5 };
    /// let model = SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)?.with_pressure(faces, rising)?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`ProfileError`] if the profile cannot be used.
    pub fn with_pressure(
        self,
        faces: LoadedFaces,
        size: impl Into<Profile>,
    ) -> Result<Self, ProfileError> {
        let size = size.into();
        size.validate()?;
        if faces.rim.is_empty() {
            let volume = Volume::new(&faces);
            return Ok(self.with_potential(ClosedPressure { volume, size }));
        }
        let corners = faces.corners;
        Ok(self.with_implicit_force(Follower(Arc::new(OpenPressure { corners, size }))))
    }
}

/// The potential `-p V` of a pressure in a volume.
#[derive(Debug)]
struct ClosedPressure {
    volume: Volume,
    size: Profile,
}

impl Potential for ClosedPressure {
    fn energy(&self, at: At<'_>) -> f64 {
        -self.size.value(at.t) * self.volume.value(at.x)
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let pressure = self.size.value(at.t);
        for (v, area) in self.volume.gradient(at.x) {
            add(gradient, v, &(-pressure * area));
        }
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let scale = -self.size.value(at.t);
        self.volume
            .add_hessian(at.x, scale, HessianPart::Full, hessian);
    }

    fn add_semidefinite_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let (scale, part) = (-self.size.value(at.t), HessianPart::PositiveSemidefinite);
        self.volume.add_hessian(at.x, scale, part, hessian);
    }

    fn is_driven(&self) -> bool {
        !self.size.is_constant()
    }
}

/// A pressure on faces with a rim.
#[derive(Debug)]
struct OpenPressure {
    corners: Vec<Corners>,
    size: Profile,
}

impl FaceLoad for OpenPressure {
    fn faces(&self) -> &[Corners] {
        &self.corners
    }

    fn forces(&self, _number: usize, t: f64, x: &OfCorners) -> OfCorners {
        let [a, b, c] = x;
        let twice_the_area = (b - a).cross(&(c - a));
        [self.size.value(t) / 6.0 * twice_the_area; 3]
    }

    fn derivatives(&self, _number: usize, t: f64, x: &OfCorners) -> [[Matrix3<f64>; 3]; 3] {
        let factor = self.size.value(t) / 6.0;
        [area_derivatives(x).map(|d| factor * d); 3]
    }
}

/// The derivatives of `(b - a) x (c - a)`, twice the area of a face along its normal, by its corners `a`,
/// `b`, `c`.
pub(super) fn area_derivatives(x: &OfCorners) -> [Matrix3<f64>; 3] {
    let [a, b, c] = x;
    [c - b, a - c, b - a].map(|side| side.cross_matrix())
}
