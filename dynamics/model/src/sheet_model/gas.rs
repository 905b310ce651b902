//! Gas that a surface encloses.

#[cfg(test)]
mod tests;

use super::loaded_faces::LoadedFaces;
use super::volume::Volume;
use crate::SheetModel;
use isosheet_materials::hessian::{HessianPart, HessianSink};
use isosheet_materials::potential::{At, Potential};
use isosheet_materials::vectors::add;
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, VertexId};
use isosheet_motion::{Profile, ProfileError};

/// Why there cannot be such a gas.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GasError {
    /// A pressure, the exponent or the volume is not positive or not finite.
    #[error("the {name} of the gas is {value}", value = given(*value))]
    Number {
        /// Which one.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The profile of the gas that is let in cannot be used.
    #[error("the gas that is let in cannot be used: {0}")]
    Added(#[from] ProfileError),
    /// The surface is not closed.
    #[error("the surface around the gas is open at the edge from {from} to {to}")]
    Open {
        /// Where the edge begins.
        from: VertexId,
        /// Where it ends.
        to: VertexId,
    },
    /// Nothing is enclosed at the start.
    #[error("the surface around the gas encloses {volume} m3 at the start", volume = given(*volume))]
    Empty {
        /// The volume, cubic metres.
        volume: f64,
    },
}

impl Advice for GasError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Number { .. } => Some("give a finite number above 0"),
            Self::Added(error) => error.advice(),
            Self::Open { .. } => Some("close the surface, or join the rims of its parts in pairs"),
            Self::Empty { .. } => Some("start with parts that are apart"),
        }
    }
}

/// Gas in a closed surface, which resists a change of its volume `V` and nothing else: its pressure is
///
/// ```text
/// p = p_1 (V_1 / V)^n,   V_1 = V_0 + a(t),
/// ```
///
/// with the exponent `n`, the volume `V_0` at the start and the pressure `p_1` there. What is let in, `a`, is
/// counted by the volume that it would take at the pressure `p_1`; what is let out, with a negative sign,
/// leaves a thousandth. The surface feels the difference of `p` and the ambient pressure. (The weight of the
/// gas is left out, which for air are 1.2 g a litre.)
///
/// ```
/// use isosheet_model::{Gas, LoadedFaces, SheetModel};
/// use isosheet_mesh::{MassKind, Sheet};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1];
/// let tent = Sheet::new(corners, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
/// let faces = LoadedFaces::all(tent.topology())?;
/// let model = SheetModel::new(&tent, 1e-3, MassKind::Lumped)?;
/// let model = model.with_gas(faces, Gas::default(), tent.positions())?;
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Gas {
    /// Pressure outside, pascals. Default 101325: the standard atmosphere.
    pub ambient: f64,
    /// Pressure `p_1` of the gas at the start, pascals. Default 101325.
    pub pressure: f64,
    /// Exponent `n`. Default 1: the temperature stays the same. Air that is compressed too fast to give heat
    /// away has
    /// 1.4.
    pub exponent: f64,
    /// What is let in, `a`, cubic metres. Default: nothing.
    pub added: Profile,
}

impl Default for Gas {
    fn default() -> Self {
        Self {
            ambient: 101_325.0,
            pressure: 101_325.0,
            exponent: 1.0,
            added: Profile::Constant(0.0),
        }
    }
}

/// Part of the volume that the gas would take at its first pressure below which its pressure goes on along a
/// straight line: what no iterate of a step may reach, but not what it has to avoid.
const SMALLEST: f64 = 1e-3;
/// Relative change of the volume up to which the energy is a series.
const NEAR: f64 = 0.1;

impl SheetModel {
    /// Fills closed faces with gas. Their front has to be outside, or inside for all of them; `x` are the
    /// positions at the start, `3V`, metres.
    ///
    /// # Errors
    /// [`GasError`].
    ///
    /// # Panics
    /// If `x` is not of length `3V` or the faces belong to another mesh.
    pub fn with_gas(self, faces: LoadedFaces, gas: Gas, x: &[f64]) -> Result<Self, GasError> {
        Ok(self.with_potential(EnclosedGas::new(&faces, gas, x)?))
    }
}

/// Gas that fills closed faces, as a potential of the model ([`SheetModel::with_gas`]).
#[derive(Debug)]
pub struct EnclosedGas {
    volume: Volume,
    gas: Gas,
    /// `V_0`, cubic metres.
    first: f64,
}

/// What a gauge at a gas shows.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct GasState {
    /// Volume that the surface encloses, cubic metres.
    pub volume: f64,
    /// Pressure of the gas, pascals above vacuum.
    pub pressure: f64,
    /// Pressure of the gas less that outside, pascals: what the surface feels.
    pub gauge_pressure: f64,
}

impl EnclosedGas {
    /// Gas in closed faces. Their front has to be outside, or inside for all of them; `x` are the positions
    /// at the start, `3V`, metres.
    ///
    /// # Errors
    /// [`GasError`].
    ///
    /// # Panics
    /// If `x` is not of length `3V` or the faces belong to another mesh.
    pub fn new(faces: &LoadedFaces, gas: Gas, x: &[f64]) -> Result<Self, GasError> {
        for (name, value) in [
            ("ambient pressure", gas.ambient),
            ("pressure", gas.pressure),
            ("exponent", gas.exponent),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(GasError::Number { name, value });
            }
        }
        gas.added.validate()?;
        if let Some(&[from, to]) = faces.rim.first() {
            return Err(GasError::Open { from, to });
        }
        let volume = match faces.volume(x) < 0.0 {
            true => Volume::new(&faces.clone().turned_over()),
            false => Volume::new(faces),
        };
        let first = volume.value(x);
        if !(first.is_finite() && first > 0.0) {
            return Err(GasError::Empty { volume: first });
        }
        Ok(Self { volume, gas, first })
    }

    /// Volume and pressure at time `t` (seconds) and positions `x` (`3V`, metres): `p = p_1 (V_1 / V)^n`, as
    /// the energy has it, which goes on along a straight line where the volume is less than a thousandth of
    /// `V_1` ([`Gas`]).
    ///
    /// # Panics
    /// If `x` is shorter than the mesh that the faces are of.
    pub fn state(&self, t: f64, x: &[f64]) -> GasState {
        let volume = self.volume.value(x);
        let gauge_pressure = -self.at_volume(t, volume).slope;
        GasState {
            volume,
            pressure: self.gas.ambient + gauge_pressure,
            gauge_pressure,
        }
    }
}

/// The energy of a gas with its derivatives by the volume.
#[derive(Debug, Clone, Copy, PartialEq)]
struct OfVolume {
    /// Joules.
    energy: f64,
    /// The ambient pressure less that of the gas, pascals.
    slope: f64,
    /// Pascals per cubic metre.
    curvature: f64,
}

impl EnclosedGas {
    /// The energy where the gas fills a volume (cubic metres), less that where it would have its first
    /// pressure.
    fn at_volume(&self, t: f64, volume: f64) -> OfVolume {
        let Gas {
            ambient,
            pressure,
            exponent,
            ..
        } = self.gas;
        let relaxed = (self.first + self.gas.added.value(t)).max(SMALLEST * self.first);
        let part = (volume / relaxed).max(SMALLEST);
        let pressure_there = pressure * part.powf(-exponent);
        let curvature = exponent * pressure_there / (part * relaxed);
        let slope = ambient - pressure_there;
        let beyond = volume - part * relaxed;
        let energy = (ambient - pressure) * (part - 1.0) + pressure * excess(part - 1.0, exponent);
        let energy = relaxed * energy;
        OfVolume {
            energy: energy + (slope + 0.5 * curvature * beyond) * beyond,
            slope: slope + curvature * beyond,
            curvature,
        }
    }

    fn add_part(&self, at: At<'_>, part: HessianPart, hessian: &mut dyn HessianSink) {
        let OfVolume {
            slope, curvature, ..
        } = self.at_volume(at.t, self.volume.value(at.x));
        self.volume.add_hessian(at.x, slope, part, hessian);
        hessian.add_square(curvature, &self.volume.gradient(at.x));
    }
}

/// The integral of `1 - (1 + u)^-n` from zero to `u`, without cancellation.
fn excess(u: f64, n: f64) -> f64 {
    if u.abs() > NEAR {
        let other = 1.0 - n;
        let integral = match other == 0.0 {
            true => u.ln_1p(),
            false => (other * u.ln_1p()).exp_m1() / other,
        };
        return u - integral;
    }
    let (mut sum, mut term, mut k) = (0.0, -u, 1.0);
    while k < 2.0 || f64::abs(term) > f64::EPSILON * f64::abs(sum) {
        term *= -u * (n + k - 1.0) / (k + 1.0);
        sum += term;
        k += 1.0;
    }
    sum
}

impl Potential for EnclosedGas {
    fn energy(&self, at: At<'_>) -> f64 {
        self.at_volume(at.t, self.volume.value(at.x)).energy
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let slope = self.at_volume(at.t, self.volume.value(at.x)).slope;
        for (v, area) in self.volume.gradient(at.x) {
            add(gradient, v, &(slope * area));
        }
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        self.add_part(at, HessianPart::Full, hessian);
    }

    fn add_semidefinite_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        self.add_part(at, HessianPart::PositiveSemidefinite, hessian);
    }

    fn is_driven(&self) -> bool {
        !self.gas.added.is_constant()
    }
}
