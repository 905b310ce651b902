//! Bending that stays: sections that yield under bending moments.

use crate::options::OptionsError;
use nalgebra::{SMatrix, SVector};
use points::points;
use serde::{Deserialize, Serialize};

/// When a section yields in bending, and how it hardens: rate-independent plasticity with linear kinematic
/// hardening (Prager), of the whole section at once or layer by layer (Besseling).
///
/// The curvature `k` of a section (of a crease its fold angle) is the sum of an elastic part, which gives the
/// moment `M = D (k - p)`, and a plastic part `p`, which stays when the moment goes. The section is elastic
/// as long as
///
/// ```text
/// |M - H p| <= M_y,
/// ```
///
/// `D` the rigidity, `M_y` the [moment](Yield::moment) and `H` the [hardening](Yield::hardening). Beyond that
/// `p` follows, and the moment grows with the slope `D H / (D + H)`. A section that was flat at first and is
/// bent to `k > M_y / D` springs back to
///
/// ```text
/// p = (D k - M_y) / (D + H),
/// ```
///
/// which is `k - M_y / D` without hardening. What the section has yielded to one side makes it yield sooner
/// to the other (Bauschinger's effect): from `M` backwards it is elastic over the range `2 M_y`.
///
/// # Layers
///
/// A real section yields from its faces inwards. With `n` [layers](Yield::layers) the integral over each half
/// of it is that of Gauss and Legendre: the layers are at the points `z_i`, in parts of the way from the
/// middle to a face, with the thicknesses `w_i`, and their parts of the rigidity, the moment and the
/// hardening are
///
/// ```text
/// D_i = 3 D w_i z_i^2,    M_i = 2 M_y w_i z_i,    H_i = H D_i / D,    i = 1 .. n,
/// ```
///
/// so that each yields at the curvature `k_y / z_i`. (One layer is the whole section.) All layers have the
/// curvature `k` of the section, each has a plastic curvature `p_i` and yields by itself; `M = sum_i M_i(k)`,
/// and `p` is the mean of the `p_i` weighted by the `D_i`. The moment grows from `2/3 M_y` on, about, to
/// `M_y` (or beyond, by hardening), and is that of an elastic-perfectly plastic material,
///
/// ```text
/// M = M_y (1 - (k_y / k)^2 / 3),    k_y = 2 M_y / (3 D),    k > k_y,
/// ```
///
/// with an error of second order in `1 / n`: at most 15 % of `M_y` for `n = 1`, where the section yields at
/// once as above, and `0.4 / n^2` beyond, of either sign. Between the layers stresses
/// stay when the moment is gone. (F. J. Gardiner, "The spring back of metals", Trans. ASME 79, 1957; J. F.
/// Besseling, "A theory of elastic, plastic, and creep deformations of an initially isotropic material", J.
/// Appl. Mech. 25, 1958.)
///
/// # Moments in several directions
///
/// A moment of three components, that of a plate, is measured by the norm of the elastic energy that it
/// stores, in which the return is radial,
///
/// ```text
/// |M|^2 = [ M_11^2 - 2 nu M_11 M_22 + M_22^2 + 2 (1 + nu) M_12^2 ] / (1 - nu^2),
/// ```
///
/// and curvatures by `|p|^2 = (1 - nu) (p_11^2 + 2 p_12^2 + p_22^2) + nu (p_11 + p_22)^2`. Where a sheet
/// bends in one direction, as a developable surface does, the curvature is `k` and the moments are `D k`
/// along and `nu D k` across: these norms are `D |k|` and `|k|` for every Poisson's ratio. A narrow strip,
/// whose sides are free of moments, yields at `sqrt(1 - nu^2) M_y`. For `nu = 1/2` the norm is `2 / sqrt(3)`
/// times that of von Mises; for other ratios the two differ by up to a fifth in other states than these.
///
/// (J. C. Simo and T. J. R. Hughes, *Computational Inelasticity*, Springer 1998, sections 1.4 and 3.3.)
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Yield {
    /// The moment `M_y` of a section that has yielded in the whole of its thickness: newton metres for a
    /// spring, newton metres per metre of width for a sheet. A sheet of thickness `h` whose material yields
    /// at the stress `s` begins to yield at `s h^2 / 6`, and has yielded in the whole of its section at `s
    /// h^2 / 4`.
    pub moment: f64,
    /// The hardening `H`, what `M_y` is shifted by per plastic curvature: newton metres per radian for a
    /// spring, newton metres for a sheet. Zero for a section that yields without hardening.
    pub hardening: f64,
    /// The number of layers of each half of the section, at the points of Gauss and Legendre. With one, all
    /// of it yields at the same moment.
    #[serde(default = "one")]
    pub layers: usize,
}

fn one() -> usize {
    1
}

/// What a section does to a deformation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flow<const N: usize> {
    /// Growth of the plastic part.
    pub(super) step: SVector<f64, N>,
    /// Derivative of `step` by the deformation: symmetric, between zero and the unit matrix.
    pub(super) slope: SMatrix<f64, N, N>,
    /// The energy beside that of the elastic part of the deformation: of hardening, of the stresses between
    /// layers, and what the growth dissipates.
    pub(super) energy: f64,
}

impl<const N: usize> Flow<N> {
    /// The flow of a section that does not yield: none.
    pub(super) fn none() -> Self {
        Self {
            step: SVector::zeros(),
            slope: SMatrix::zeros(),
            energy: 0.0,
        }
    }
}

/// A layer of a section.
#[derive(Clone, Copy, Debug)]
struct Layer {
    /// Its part of the rigidity.
    share: f64,
    rigidity: f64,
    moment: f64,
    hardening: f64,
}

/// A weighted mean of vectors, and their sum of squares about it (D. H. D. West, "Updating mean and variance
/// estimates", Comm. ACM 22, 1979).
#[derive(Clone, Copy, Debug)]
struct Mean<const N: usize> {
    weight: f64,
    value: SVector<f64, N>,
    spread: f64,
}

impl<const N: usize> Mean<N> {
    const NONE: Self = Self {
        weight: 0.0,
        value: SVector::<f64, N>::from_array_storage(nalgebra::ArrayStorage([[0.0; N]; 1])),
        spread: 0.0,
    };

    fn add(&mut self, weight: f64, value: SVector<f64, N>) {
        self.weight += weight;
        let off = value - self.value;
        self.value += off * (weight / self.weight);
        self.spread += weight * off.dot(&(value - self.value));
    }
}

impl Layer {
    /// The growth of its plastic part `p` and its slope. `e` is the elastic part if nothing yields in the
    /// step.
    fn flow<const N: usize>(
        &self,
        e: SVector<f64, N>,
        p: SVector<f64, N>,
    ) -> (SVector<f64, N>, SMatrix<f64, N, N>) {
        let drive = self.rigidity * e - self.hardening * p;
        let size = drive.norm();
        if size <= self.moment {
            return (SVector::zeros(), SMatrix::zeros());
        }
        let direction = drive / size;
        let along = direction * direction.transpose();
        let turned = (size - self.moment) / size;
        let whole = self.rigidity + self.hardening;
        let step = direction * ((size - self.moment) / whole);
        let slope = along + turned * (SMatrix::identity() - along);
        (step, slope * (self.rigidity / whole))
    }

    /// `H/2 |p + d|^2 + M_y |d|`: what hardening stores, and what the growth `d` of the plastic part `p`
    /// dissipates.
    fn energy<const N: usize>(&self, p: SVector<f64, N>, d: SVector<f64, N>) -> f64 {
        0.5 * self.hardening * (p + d).norm_squared() + self.moment * d.norm()
    }
}

impl Yield {
    /// The number of layers of a sheet unless another is asked for: the smallest with which what is left of
    /// the bend of a cantilever errs by less than 1 % wherever the largest moment was 0.75 to 0.99 of
    /// [`Yield::moment`]. (In layers of equal thickness 16 err by up to 6 %, as all of them have too large a
    /// moment.)
    pub const LAYERS: usize = 11;

    /// The largest number of layers.
    pub const MAX_LAYERS: usize = points::MOST;

    /// Without hardening, at one moment.
    pub const fn perfect(moment: f64) -> Self {
        Self {
            moment,
            hardening: 0.0,
            layers: 1,
        }
    }

    /// With a number of layers.
    #[must_use]
    pub const fn in_layers(self, layers: usize) -> Self {
        Self { layers, ..self }
    }

    /// Checks the numbers; the ranges are far wider than for any sheet.
    ///
    /// # Errors
    /// [`OptionsError`] naming the number that makes no sense.
    pub fn validate(&self) -> Result<(), OptionsError> {
        OptionsError::check_range("moment", self.moment, 1e-18, 1e18)?;
        OptionsError::check_range("hardening", self.hardening, 0.0, 1e18)?;
        let most = Self::MAX_LAYERS as f64;
        OptionsError::check_range("layers", self.layers as f64, 1.0, most)
    }

    /// The layers of a section with a rigidity, the innermost first.
    fn of_section(&self, rigidity: f64) -> impl Iterator<Item = Layer> {
        let Self {
            moment,
            hardening,
            layers,
        } = *self;
        points(layers).iter().map(move |point| Layer {
            share: point.rigidity,
            rigidity: point.rigidity * rigidity,
            moment: point.moment * moment,
            hardening: point.rigidity * hardening,
        })
    }

    /// The plastic part of a section, the mean over its layers, which are `N` numbers in `layers` each.
    pub(super) fn plastic<const N: usize>(&self, layers: &[f64]) -> SVector<f64, N> {
        let mut mean = Mean::NONE;
        for (layer, p) in self.of_section(1.0).zip(layers.as_chunks::<N>().0) {
            mean.add(layer.share, SVector::from(*p));
        }
        mean.value
    }

    /// What a section does in a step of time, from the elastic part `e` (of a section with stiffness `k`)
    /// that there is if nothing yields in the step, the deformation less the [plastic part](Self::plastic),
    /// and the plastic parts `p_i` of the layers before, which grow by
    ///
    /// ```text
    /// argmin_d_i  sum_i k_i/2 |e_i - d_i|^2 + H_i/2 |p_i + d_i|^2 + M_i |d_i|,    e_i = e + p - p_i,
    /// ```
    ///
    /// the minimum being the incremental energy of the section (M. Ortiz and L. Stainier, "The variational
    /// formulation of viscoplastic constitutive updates", Comput. Methods Appl. Mech. Eng. 171, 1999). Of `e`
    /// it is convex and has a continuous gradient `k (e - d)`, the moment, with the mean `d` of the `d_i`,
    /// and the Hessian `k (1 - slope)`. It is `k/2 |e - d|^2` and [`Flow::energy`], of which
    /// `sum_i k_i/2 |p_i + d_i - p - d|^2` is that of the stresses between layers.
    pub(super) fn flow<const N: usize>(
        &self,
        k: f64,
        e: SVector<f64, N>,
        layers: &[f64],
    ) -> Flow<N> {
        let before = self.plastic(layers);
        let mut flow = Flow::none();
        let mut after = Mean::NONE;
        for (layer, p) in self.of_section(k).zip(layers.as_chunks::<N>().0) {
            let p = SVector::from(*p);
            let (step, slope) = layer.flow(e + (before - p), p);
            flow.step += layer.share * step;
            flow.slope += layer.share * slope;
            flow.energy += layer.energy(p, step);
            after.add(layer.share, p + step);
        }
        flow.energy += 0.5 * k * after.spread;
        flow
    }

    /// Makes the plastic parts of the layers those after the step; what it dissipates.
    pub(super) fn settle<const N: usize>(
        &self,
        k: f64,
        e: SVector<f64, N>,
        layers: &mut [f64],
    ) -> f64 {
        let before = self.plastic(layers);
        let mut dissipated = 0.0;
        for (layer, p) in self.of_section(k).zip(layers.as_chunks_mut::<N>().0) {
            let old = SVector::from(*p);
            let (step, _) = layer.flow(e + (before - old), old);
            *p = (old + step).into();
            dissipated += layer.moment * step.norm();
        }
        dissipated
    }
}

mod points;
#[cfg(test)]
mod tests;
