//! Rest angles of creases.

use super::CreaseError;
use isosheet_mesh::EdgeId;
use isosheet_motion::Profile;
use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

/// The fold angle at which a spring exerts no moment, radians: positive for a valley as seen from the side
/// from which faces are counter-clockwise, negative for a mountain (the sign of
/// [`isosheet_mesh::fold_angle`]).
///
/// Made from a number, a [`Profile`], or a function of time (seconds). A crease whose rest angle changes is
/// driven.
#[derive(Clone)]
pub enum RestAngle {
    /// By a profile, radians: data that can be written and read.
    Profile(Profile),
    /// Any function of time (seconds).
    Custom(Arc<dyn Fn(f64) -> f64 + Send + Sync>),
}

impl From<Profile> for RestAngle {
    fn from(profile: Profile) -> Self {
        Self::Profile(profile)
    }
}

impl From<f64> for RestAngle {
    fn from(angle: f64) -> Self {
        Self::Profile(angle.into())
    }
}

impl<F: Fn(f64) -> f64 + Send + Sync + 'static> From<F> for RestAngle {
    fn from(angle: F) -> Self {
        Self::Custom(Arc::new(angle))
    }
}

impl RestAngle {
    /// The angle at time `t`, radians.
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Self::Profile(profile) => profile.value(t),
            Self::Custom(angle) => angle(t),
        }
    }

    /// Whether it may change.
    pub fn is_driven(&self) -> bool {
        match self {
            Self::Profile(profile) => !profile.is_constant(),
            Self::Custom(_) => true,
        }
    }

    /// A constant angle lies between a fold shut as a mountain and one shut as a valley; a driven one may
    /// pass both.
    pub(super) fn validate(&self, edge: EdgeId) -> Result<(), CreaseError> {
        let Self::Profile(profile) = self else {
            return Ok(());
        };
        profile
            .validate()
            .map_err(|source| CreaseError::RestAngle { edge, source })?;
        match profile {
            Profile::Constant(value) if !(-PI..=PI).contains(value) => {
                let angle = *value;
                Err(CreaseError::Angle { edge, angle })
            }
            _ => Ok(()),
        }
    }
}

impl fmt::Debug for RestAngle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Profile(profile) => profile.fmt(f),
            Self::Custom(_) => f.write_str("Custom"),
        }
    }
}
