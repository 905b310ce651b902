//! Shaded pictures of sheets and bodies, seen by one camera that has all of them in view.

use anyhow::Result;
use isosheet_io::picture::{Camera, Image, Labelled, Look, SheetPicture, Solid, montage, render};
use isosheet_mesh::{Sheet, VertexId};

/// What one picture shows.
#[derive(Debug)]
pub(crate) struct Shot<'a> {
    pub(crate) sheet: &'a Sheet,
    /// Positions (3V, metres).
    pub(crate) x: &'a [f64],
    /// Vertices marked with a dot.
    pub(crate) pins: &'a [VertexId],
    pub(crate) solids: Vec<Solid>,
    pub(crate) label: String,
}

/// Where pictures are seen from, and how large they are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Viewpoint {
    /// Where the viewer is, degrees.
    pub(crate) azimuth: f64,
    pub(crate) elevation: f64,
    /// Distance of the viewer, metres.
    pub(crate) distance: f64,
    /// Bodies are framed down to this depth below the start of the sheet, metres.
    pub(crate) depth: f64,
    /// Height of a picture, pixels.
    pub(crate) height: usize,
}

impl Viewpoint {
    /// The pictures, all of one size.
    fn pictures(&self, shots: &[Shot<'_>]) -> Result<Vec<Image>> {
        let sheets = shots.iter().flat_map(|s| s.x.as_chunks::<3>().0);
        let bodies = shots.iter().flat_map(|s| &s.solids);
        let bodies = bodies.flat_map(|b| b.points.iter().copied());
        let bodies = bodies.map(|[x, y, z]| [x, y, z.max(-self.depth)]);
        let points = sheets.copied().chain(bodies);
        let camera = Camera::new([0.0; 3], self.azimuth, self.elevation, 1.0, self.distance);
        let aspect = camera.aspect(points.clone());
        let camera = camera.framing(points, aspect, 0.04);
        let width = (self.height as f64 * aspect).round().max(1.0) as usize;
        let look = Look {
            size: [width, self.height],
            ..Look::default()
        };
        let picture = |shot: &Shot<'_>| {
            let picture = SheetPicture {
                topology: shot.sheet.topology(),
                positions: shot.x,
                pins: shot.pins,
                immobile: &[],
                solids: &shot.solids,
            };
            Ok(render(&picture, &camera, &look)?)
        };
        shots.iter().map(picture).collect()
    }

    /// The pictures with their labels in rows, as a PNG file.
    pub(crate) fn montage(&self, shots: Vec<Shot<'_>>, columns: usize) -> Result<Vec<u8>> {
        let images = self.pictures(&shots)?.into_iter();
        let labels = shots.into_iter().map(|shot| shot.label);
        let labelled = images.zip(labels);
        let labelled = labelled.map(|(image, label)| Labelled { image, label });
        Ok(montage(&labelled.collect::<Vec<_>>(), columns)?.to_png()?)
    }

    /// One picture as a PNG file.
    pub(crate) fn single(&self, shot: Shot<'_>) -> Result<Vec<u8>> {
        let images = self.pictures(&[shot])?;
        Ok(images[0].to_png()?)
    }
}
