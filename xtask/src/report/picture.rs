//! Pictures of reports: files, and what pages show of them.

use crate::draw::Vector;
use crate::store::Files;
use anyhow::Result;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use isosheet_pictures::Image;
use maud::{Markup, html};

/// Size of drawings in the page relative to their own: their text is as large as that of the page then.
const ENLARGED: f64 = 1.3;

/// Largest width of the small pictures of a page, pixels: two fit beside each other.
const THUMBNAIL: usize = 640;

/// A picture.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    /// Path relative to the output folder.
    pub(crate) path: String,
    /// The file.
    pub(crate) bytes: Vec<u8>,
    /// The picture inside a page.
    pub(crate) inside: Markup,
}

impl Picture {
    /// A drawing or charts as the SVG file `figures/name.svg`.
    pub(crate) fn svg(name: &str, drawing: &impl Vector, alt: &str) -> Self {
        Self {
            path: format!("figures/{name}.svg"),
            bytes: drawing.to_svg(alt).into_bytes(),
            inside: html! { a href={ "figures/" (name) ".svg" } { (drawing.document(alt, ENLARGED)) } },
        }
    }

    /// A shaded picture as a PNG file, of which the page has a smaller one that opens it.
    ///
    /// # Errors
    /// Errors of making the file.
    pub(crate) fn shaded(file: &str, image: &Image, alt: &str) -> Result<Self> {
        let [width, _] = image.size();
        let small = image.reduced(width.div_ceil(THUMBNAIL).max(1));
        let shown = Self::png(file, small.to_png()?, alt).inside;
        Ok(Self {
            inside: html! { a href={ "figures/" (file) } { (shown) } },
            ..Self::png(file, image.to_png()?, alt)
        })
    }

    /// A PNG file in the folder of pictures.
    pub(crate) fn png(file: &str, bytes: Vec<u8>, alt: &str) -> Self {
        let data = format!("data:image/png;base64,{}", STANDARD.encode(&bytes));
        Self {
            path: format!("figures/{file}"),
            bytes,
            inside: html! { img alt=(alt) src=(data); },
        }
    }

    /// Writes the file.
    pub(crate) fn write(&self, files: &mut Files<'_>) -> Result<()> {
        Ok(files.write(&self.path, &self.bytes)?)
    }
}

/// Writes charts as `plots/name.svg` and `plots/name.png`, and returns what the page shows.
pub(crate) fn plot(
    files: &mut Files<'_>,
    name: &str,
    drawing: &impl Vector,
    alt: &str,
) -> Result<Markup> {
    let svg = drawing.to_svg(alt);
    files.write(&format!("plots/{name}.svg"), svg.as_bytes())?;
    files.write(&format!("plots/{name}.png"), &drawing.to_png(alt)?)?;
    Ok(html! { figure { (drawing.document(alt, ENLARGED)) } })
}
