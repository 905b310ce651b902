//! Shaded pictures of sheets and bodies, seen by one camera that has all of them in view.

use anyhow::Result;
use isosheet_mesh::{Sheet, VertexId};
use isosheet_pictures::{Camera, DrawnSolid, Image, Labelled, Look, SheetPicture, montage, render};

/// What one picture shows.
#[derive(Debug)]
pub(crate) struct Shot<'a> {
    pub(crate) sheet: &'a Sheet,
    /// Positions (3V, metres).
    pub(crate) x: &'a [f64],
    /// Vertices marked with a dot.
    pub(crate) pins: &'a [VertexId],
    pub(crate) solids: Vec<DrawnSolid>,
    pub(crate) label: String,
}

/// Where pictures are seen from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Viewpoint {
    /// Where the viewer is, degrees.
    pub(crate) azimuth: f64,
    pub(crate) elevation: f64,
    /// Distance of the viewer, metres.
    pub(crate) distance: f64,
    /// Bodies are framed down to this depth below the start of the sheet, metres.
    pub(crate) depth: f64,
}

impl Viewpoint {
    /// The camera that has everything in view, and the ratio of width to height that fits.
    fn camera(&self, shots: &[Shot<'_>], aspect: Option<f64>) -> (Camera, f64) {
        let sheets = shots.iter().flat_map(|s| s.x.as_chunks::<3>().0);
        let bodies = shots.iter().flat_map(|s| &s.solids);
        let bodies = bodies.flat_map(DrawnSolid::outline);
        let bodies = bodies.map(|[x, y, z]| [x, y, z.max(-self.depth)]);
        let points = sheets.copied().chain(bodies);
        let camera = Camera::new([0.0; 3], self.azimuth, self.elevation, 1.0, self.distance);
        let aspect = aspect.unwrap_or_else(|| camera.aspect(points.clone()));
        (camera.framing(points, aspect, 0.04), aspect)
    }

    /// The pictures of a height (pixels) and of the width that fits.
    fn pictures(&self, shots: &[Shot<'_>], height: usize) -> Result<Vec<Image>> {
        let (_, aspect) = self.camera(shots, None);
        let width = (height as f64 * aspect).round().max(1.0) as usize;
        self.frame(shots, [width, height])
    }

    /// The pictures in a size, pixels.
    pub(crate) fn frame(&self, shots: &[Shot<'_>], size: [usize; 2]) -> Result<Vec<Image>> {
        let (camera, _) = self.camera(shots, Some(size[0] as f64 / size[1] as f64));
        let look = Look {
            size,
            ..Look::default()
        };
        let picture = |shot: &Shot<'_>| {
            let picture = SheetPicture {
                pins: shot.pins,
                solids: &shot.solids,
                ..SheetPicture::of(shot.sheet.topology(), shot.x)
            };
            Ok(render(&picture, &camera, &look)?)
        };
        shots.iter().map(picture).collect()
    }

    /// The pictures with their labels in rows, each of a height in pixels.
    pub(crate) fn montage(
        &self,
        shots: Vec<Shot<'_>>,
        columns: usize,
        height: usize,
    ) -> Result<Image> {
        let images = self.pictures(&shots, height)?.into_iter();
        let labels = shots.into_iter().map(|shot| shot.label);
        let labelled = images.zip(labels);
        let labelled = labelled.map(|(image, label)| Labelled { image, label });
        Ok(montage(&labelled.collect::<Vec<_>>(), columns))
    }

    /// One picture of a height in pixels as a PNG file.
    pub(crate) fn single(&self, shot: Shot<'_>, height: usize) -> Result<Vec<u8>> {
        let images = self.pictures(&[shot], height)?;
        Ok(images[0].to_png()?)
    }
}
