//! How drawings become sheets.

use super::rules::LineRules;
use crate::DrawingUnit;
use isosheet_files::DataError;
use isosheet_mesh::wording::given;

/// How a drawing becomes a sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawingOptions {
    /// Length of the edges of the mesh, about, metres.
    pub spacing: f64,
    /// Ends of lines that are at most so far apart, metres, are joined, ends that are as near to a line are
    /// moved onto it, and lines that run along each other as near as this become one. `None` (the default) is
    /// a ten-thousandth of the diagonal of the drawing.
    pub snap: Option<f64>,
    /// The length of a unit of the file, where it is not the one that the file says.
    pub unit: Option<DrawingUnit>,
    /// The drawing is made larger by this factor.
    pub scale: f64,
    /// What lines are taken for.
    pub rules: LineRules,
    /// Another number gives another triangulation.
    pub seed: u64,
}

impl DrawingOptions {
    /// Options with a spacing, metres, and defaults for all else.
    pub fn with_spacing(spacing: f64) -> Self {
        Self {
            spacing,
            snap: None,
            unit: None,
            scale: 1.0,
            rules: LineRules::default(),
            seed: 0,
        }
    }

    /// Checks the values.
    ///
    /// # Errors
    /// [`DataError`] for a length or a factor that is not positive and finite.
    pub fn validate(&self) -> Result<(), DataError> {
        let values = [
            ("the spacing", Some(self.spacing)),
            ("the tolerance for snapping", self.snap),
            ("the scale", Some(self.scale)),
        ];
        for (name, value) in values {
            if let Some(value) = value.filter(|v| !(*v > 0.0 && v.is_finite())) {
                let message = format!("{name} is {}", given(value));
                return Err(DataError::new(message, "give a positive, finite one").value(value));
            }
        }
        Ok(())
    }
}
