//! Why a picture cannot be made.

use isosheet_files::{DataError, bytes_in_words};
use isosheet_geometry::ShapeError;
use isosheet_mesh::Advice;

/// Why a picture cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// A size, an angle of the viewer or a width of lines is out of range.
    #[error(transparent)]
    Options(DataError),
    /// What is to be drawn does not fit together, or there is nothing to draw.
    #[error(transparent)]
    Data(DataError),
    /// A body has no geometry.
    #[error(transparent)]
    Body(#[from] ShapeError),
    /// A vector drawing cannot be read.
    #[cfg(feature = "labels")]
    #[error("cannot read the vector drawing: {0}")]
    Svg(#[from] resvg::usvg::Error),
    /// A PNG file cannot be made.
    #[error("cannot write the PNG file: {0}")]
    Png(#[from] png::EncodingError),
}

impl PictureError {
    /// Pictures of a size (pixels) cannot be made.
    pub fn size(width: usize, height: usize) -> Self {
        let message = format!("the picture has {width} x {height} pixels");
        let remedy = "give at least one each way, and no more than memory holds";
        Self::Options(DataError::new(message, remedy))
    }

    /// A picture of a size (pixels) takes more bytes than are free.
    pub(crate) fn memory([width, height]: [usize; 2], needed: u64, free: u64) -> Self {
        let [needed, free] = [needed, free].map(|bytes| bytes_in_words(bytes as f64));
        let message = format!(
            "a picture of {width} x {height} pixels takes {needed} of memory, and {free} are free"
        );
        let remedy = "give a smaller size (`--size`), or end other programs";
        Self::Options(DataError::new(message, remedy))
    }

    /// There is no frame to draw.
    pub fn no_frames() -> Self {
        let remedy = "choose frames that the run has";
        Self::Data(DataError::new("there is no such frame", remedy))
    }
}

impl Advice for PictureError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Options(error) | Self::Data(error) => error.advice(),
            Self::Body(error) => error.advice(),
            #[cfg(feature = "labels")]
            Self::Svg(..) => Some("give an SVG document"),
            Self::Png(..) => None,
        }
    }
}
