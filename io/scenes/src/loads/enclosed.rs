//! Pressures and volumes that are measured.

use isosheet_dynamics::{EnclosedGas, LoadedFaces, Profile};
use std::sync::Arc;

/// A gas in a closed surface, or a pressure on faces, that is measured.
#[derive(Clone, Debug)]
pub(crate) enum EnclosedGauge {
    Gas(Arc<EnclosedGas>),
    /// A prescribed pressure (pascals) on faces.
    Pressure(LoadedFaces, Profile),
}

/// What is measured of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OfEnclosed {
    /// Pascals above vacuum.
    Pressure,
    /// Pascals above the pressure outside.
    GaugePressure,
    /// Cubic metres.
    Volume,
}

impl OfEnclosed {
    pub(crate) const ALL: [Self; 3] = [Self::Pressure, Self::GaugePressure, Self::Volume];

    /// Its name in scenes.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Pressure => "pressure",
            Self::GaugePressure => "gauge_pressure",
            Self::Volume => "volume",
        }
    }

    pub(crate) fn unit(self) -> &'static str {
        match self {
            Self::Pressure | Self::GaugePressure => "Pa",
            Self::Volume => "m3",
        }
    }
}

impl EnclosedGauge {
    /// Whether there is a volume.
    pub(crate) fn is_closed(&self) -> bool {
        match self {
            Self::Gas(_) => true,
            Self::Pressure(faces, _) => faces.rim().is_empty(),
        }
    }

    /// What it shows at time `t` (seconds) and positions `x` (metres), which begin with the sheets. (A scene
    /// names the pressure above vacuum of gases alone.)
    pub(crate) fn value(&self, of: OfEnclosed, t: f64, x: &[f64]) -> f64 {
        match (self, of) {
            (Self::Gas(gas), OfEnclosed::Pressure) => gas.state(t, x).pressure,
            (Self::Gas(gas), OfEnclosed::GaugePressure) => gas.state(t, x).gauge_pressure,
            (Self::Gas(gas), OfEnclosed::Volume) => gas.state(t, x).volume,
            (Self::Pressure(faces, _), OfEnclosed::Volume) => faces.volume(x).abs(),
            (Self::Pressure(_, size), _) => size.value(t),
        }
    }
}
