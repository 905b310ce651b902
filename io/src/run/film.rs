//! Shaded pictures of the frames of a run.

use super::Recording;
use crate::picture::{
    Camera, Image, Look, PictureError, SheetPicture, Solid, animated_png, render, render_svg,
};

/// How a run is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmOptions {
    /// Height of the pictures, pixels; 480 by default. The width follows from what is seen.
    pub height: usize,
    /// Where the viewer is, degrees counter-clockwise from the x axis as seen from above; -60 by default.
    pub azimuth: f64,
    /// Where the viewer is, degrees above the horizon; 25 by default.
    pub elevation: f64,
}

impl Default for FilmOptions {
    fn default() -> Self {
        Self {
            height: 480,
            azimuth: -60.0,
            elevation: 25.0,
        }
    }
}

impl FilmOptions {
    /// Whether the values make sense.
    ///
    /// # Errors
    /// [`PictureError::Size`] for no pixels or more than 4096, [`PictureError::Angle`] for angles that are
    /// not finite or an elevation beyond 90 degrees.
    pub fn validate(&self) -> Result<(), PictureError> {
        // A picture is drawn with three times as many pixels each way, each of 20 bytes: 4096 need 3 GB, and
        // up to three times as much where the picture is wide.
        if !(1..=4096).contains(&self.height) {
            let (width, height) = (self.height, self.height);
            return Err(PictureError::Size { width, height });
        }
        if !self.azimuth.is_finite() {
            return Err(PictureError::Angle {
                name: "azimuth",
                value: self.azimuth,
            });
        }
        if !(-90.0..=90.0).contains(&self.elevation) {
            return Err(PictureError::Angle {
                name: "elevation",
                value: self.elevation,
            });
        }
        Ok(())
    }
}

/// Some frames of a run, seen by one camera that has the sheet in view in all of them.
#[derive(Debug)]
pub struct Film<'a> {
    recording: &'a Recording,
    frames: Vec<usize>,
    camera: Camera,
    look: Look,
}

/// The viewer is so many times as far away as the sheet is large: little perspective.
const DISTANCE: f64 = 6.0;

/// Margin around the sheet, part of the height of the picture.
const MARGIN: f64 = 0.06;

impl<'a> Film<'a> {
    /// The given frames of a run.
    ///
    /// # Errors
    /// [`PictureError::NoFrames`] without frames or for a frame that the run has not, and those of
    /// [`FilmOptions::validate`].
    pub fn new(
        recording: &'a Recording,
        frames: Vec<usize>,
        options: &FilmOptions,
    ) -> Result<Self, PictureError> {
        options.validate()?;
        let states: Option<Vec<&[f64]>> = frames
            .iter()
            .map(|frame| recording.trajectory.frame(*frame))
            .collect();
        let states = states.filter(|states| !states.is_empty());
        let states = states.ok_or(PictureError::NoFrames)?;
        let points = states
            .iter()
            .flat_map(|x| x.as_chunks::<3>().0.iter().copied());
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in points.clone() {
            for k in 0..3 {
                (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
            }
        }
        let middle = [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]));
        let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let FilmOptions {
            height,
            azimuth,
            elevation,
        } = *options;
        let camera = Camera::new(middle, azimuth, elevation, size, DISTANCE * size);
        let aspect = camera.aspect(points.clone());
        let width = (height as f64 * aspect).round().max(1.0);
        Ok(Self {
            recording,
            frames,
            camera: camera.framing(points, width / height as f64, MARGIN),
            look: Look {
                size: [width as usize, height],
                ..Look::default()
            },
        })
    }

    /// Numbers of the bodies that pictures cannot show: half-spaces, balls and capsules.
    pub fn undrawn(&self) -> Vec<usize> {
        let bodies = self.recording.obstacles.iter().enumerate();
        let undrawn = bodies.filter(|(_, body)| Solid::of(body, 0.0).is_err());
        undrawn.map(|(k, _)| k).collect()
    }

    /// The picture of one of the frames, by its place among them.
    ///
    /// # Errors
    /// [`PictureError::NoFrames`] if there is none, [`PictureError`] if it cannot be drawn.
    pub fn picture(&self, place: usize) -> Result<Image, PictureError> {
        self.draw(place, render)
    }

    /// One of the frames as an SVG document ([`render_svg`]), by its place among them.
    ///
    /// # Errors
    /// As [`picture`](Self::picture).
    pub fn svg(&self, place: usize) -> Result<String, PictureError> {
        self.draw(place, render_svg)
    }

    fn draw<T>(
        &self,
        place: usize,
        draw: impl Fn(&SheetPicture<'_>, &Camera, &Look) -> Result<T, PictureError>,
    ) -> Result<T, PictureError> {
        let frame = *self.frames.get(place).ok_or(PictureError::NoFrames)?;
        let trajectory = &self.recording.trajectory;
        let positions = trajectory.frame(frame).ok_or(PictureError::NoFrames)?;
        let t = trajectory.times()[frame];
        let bodies = self.recording.obstacles.iter();
        let solids: Vec<Solid> = bodies.filter_map(|body| Solid::of(body, t).ok()).collect();
        let picture = SheetPicture {
            topology: self.recording.sheet.topology(),
            positions,
            pins: &self.recording.pins,
            immobile: &self.recording.immobile,
            solids: &solids,
        };
        draw(&picture, &self.camera, &self.look)
    }

    /// All pictures as an animated PNG file, in real time.
    ///
    /// # Errors
    /// [`PictureError`] if a frame cannot be drawn.
    pub fn animation(&self) -> Result<Vec<u8>, PictureError> {
        let times = self.recording.trajectory.times();
        let [first, last] =
            [self.frames.first(), self.frames.last()].map(|f| f.map_or(0.0, |f| times[*f]));
        let steps = (self.frames.len() - 1).max(1);
        let delay = 1000.0 * (last - first) / steps as f64;
        // Conversion from floats saturates: the longest time of a picture is a minute.
        let delay = delay.round().max(1.0) as u16;
        animated_png(self.look.size, delay, self.frames.len(), |k| {
            self.picture(k)
        })
    }
}
