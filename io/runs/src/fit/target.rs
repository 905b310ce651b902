//! What a fit is to reach.

use isosheet_files::DataError;
use isosheet_mesh::wording::given;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// What a run is to end with: `NAME=VALUE`, a value of a measure, or a mesh file with the positions of all
/// vertices (metres). Behind either `+-SIGMA` gives its standard deviation, in its unit.
///
/// ```
/// use isosheet_runs::FitTarget;
/// let target: FitTarget = "tip=-0.05+-0.001".parse()?;
/// let expected = FitTarget::Measure { name: "tip".into(), value: -0.05, sigma: Some(0.001) };
/// assert_eq!(target, expected);
/// # Ok::<(), isosheet_files::DataError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum FitTarget {
    /// The last value of a measure of the scene.
    Measure {
        /// Its name.
        name: String,
        /// The value, in its unit.
        value: f64,
        /// The standard deviation.
        sigma: Option<f64>,
    },
    /// The positions of all vertices at the end.
    Mesh {
        /// A mesh file with as many vertices, in their order.
        path: PathBuf,
        /// The standard deviation of a coordinate, metres.
        sigma: Option<f64>,
    },
}

impl FitTarget {
    /// Its standard deviation.
    pub(super) fn sigma(&self) -> Option<f64> {
        match self {
            Self::Measure { sigma, .. } | Self::Mesh { sigma, .. } => *sigma,
        }
    }
}

impl FromStr for FitTarget {
    type Err = DataError;

    fn from_str(text: &str) -> Result<Self, DataError> {
        let number = |text: &str| {
            let found = text.trim().parse().ok().filter(|n: &f64| n.is_finite());
            found.ok_or_else(|| {
                let message = format!("{:?} is no number", text.trim());
                DataError::new(
                    message,
                    "write for example `tip=-0.05` or `tip=-0.05+-0.001`",
                )
            })
        };
        let (what, sigma) = match text.rsplit_once("+-") {
            Some((what, sigma)) => (what, Some(number(sigma)?)),
            None => (text, None),
        };
        if let Some(sigma) = sigma.filter(|s| *s <= 0.0) {
            let message = format!("the standard deviation is {}", given(sigma));
            return Err(DataError::new(message, "give a positive number"));
        }
        Ok(match what.split_once('=') {
            Some((name, value)) => Self::Measure {
                name: name.trim().to_owned(),
                value: number(value)?,
                sigma,
            },
            None => Self::Mesh {
                path: what.trim().into(),
                sigma,
            },
        })
    }
}

impl fmt::Display for FitTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Measure { name, value, .. } => write!(f, "{name}={}", given(*value)),
            Self::Mesh { path, .. } => write!(f, "{}", path.display()),
        }
    }
}
