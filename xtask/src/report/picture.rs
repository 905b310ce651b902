//! Pictures of reports.

use crate::draw::Drawing;
use crate::store::Draft;
use anyhow::Result;
use serde::{Deserialize, Serialize};

/// A picture.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Picture {
    /// Path relative to the output folder.
    pub(crate) path: String,
    /// What it shows, in words.
    pub(crate) alt: String,
    /// The file; it is not part of records.
    #[serde(skip)]
    pub(crate) bytes: Vec<u8>,
}

impl Picture {
    /// A drawing as the SVG file `name.svg`.
    pub(crate) fn svg(name: &str, drawing: &Drawing, alt: &str) -> Self {
        let bytes = drawing.to_svg(alt).into_bytes();
        Self::file(&format!("{name}.svg"), bytes, alt)
    }

    /// A file in the folder of pictures.
    pub(crate) fn file(file: &str, bytes: Vec<u8>, alt: &str) -> Self {
        Self {
            path: format!("figures/{file}"),
            alt: alt.to_owned(),
            bytes,
        }
    }
}

/// Adds a drawing to the files of a unit, as `plots/name.svg` and `plots/name.png`.
pub(crate) fn plot_files(
    draft: &mut Draft,
    name: &str,
    drawing: &Drawing,
    alt: &str,
) -> Result<()> {
    let svg = drawing.to_svg(alt);
    draft.write(&format!("plots/{name}.svg"), svg.as_bytes())?;
    draft.write(&format!("plots/{name}.png"), &drawing.to_png(alt)?)?;
    Ok(())
}
