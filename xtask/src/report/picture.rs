//! Pictures of reports.

use crate::draw::Drawing;
use crate::store::Draft;
use anyhow::Result;
use serde::{Deserialize, Serialize};

/// A picture that has been made.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    /// File name without folder.
    pub(crate) file: String,
    /// What it shows, in words.
    pub(crate) alt: String,
    pub(crate) bytes: Vec<u8>,
}

/// A picture as a record keeps it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PictureRef {
    /// Path relative to the output folder.
    pub(crate) path: String,
    pub(crate) alt: String,
}

impl Picture {
    /// A drawing as the SVG file `name.svg`.
    pub(crate) fn svg(name: &str, drawing: &Drawing, alt: &str) -> Self {
        Self {
            file: format!("{name}.svg"),
            alt: alt.to_owned(),
            bytes: drawing.to_svg(alt).into_bytes(),
        }
    }

    /// Adds the picture to the files of a unit.
    pub(crate) fn keep(&self, draft: &mut Draft) -> Result<PictureRef> {
        let path = format!("figures/{}", self.file);
        draft.write(&path, &self.bytes)?;
        Ok(PictureRef {
            path,
            alt: self.alt.clone(),
        })
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
