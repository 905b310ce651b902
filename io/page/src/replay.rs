//! What the page of a run shows.

use isosheet_mesh::Topology;

use super::body::Body;
use super::check;
use super::field::{Field, TimeSeries};
use super::frames::KeptFrames;
use isosheet_files::DataError;
use isosheet_formats::{FrameData, MotionFrame, MotionFrames};
use serde::Serialize;
use std::ops::ControlFlow;

/// An axis of space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// The x axis.
    X,
    /// The y axis.
    Y,
    /// The z axis.
    #[default]
    Z,
}

/// Everything that the page of a run shows: V vertices, T frames. Positions in metres, times in seconds.
///
/// All fields except [`faces`](Self::faces), [`times`](Self::times), [`positions`](Self::positions) and
/// [`rest`](Self::rest) may be left as [`Default`] makes them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replay {
    /// Title of the page.
    pub title: String,
    /// Corners of the faces, counter-clockwise as seen from the front, counted from 0.
    pub faces: Vec<[u32; 3]>,
    /// Time of each frame (length T, ascending).
    pub times: Vec<f64>,
    /// Of a run that folds a crease pattern the part of the folding in each frame, from 0 to 1 (length T);
    /// empty for others.
    pub folded: Vec<f64>,
    /// Positions in each frame (T lists of length 3V).
    pub positions: Vec<Vec<f64>>,
    /// Positions of the unloaded sheet (length 3V).
    pub rest: Vec<f64>,
    /// The direction that is up on the screen and along which heights are measured.
    pub up: Axis,
    /// The height of a ground that shows nothing but shadows, metres along the direction that is up; none
    /// where the bodies have a floor, or where nothing falls.
    pub ground: Option<f64>,
    /// Of several sheets the number of faces of each, so that each has a colour of its own.
    pub sheets: Vec<usize>,
    /// Bodies that the sheet meets.
    pub bodies: Vec<Body>,
    /// Vertices that are held.
    pub pins: Vec<u32>,
    /// Vertices that rods to held ones keep in place.
    pub immobile: Vec<u32>,
    /// Values at vertices, edges or faces, to colour the sheet by.
    pub fields: Vec<Field>,
    /// The number of the field that the sheet is coloured by at first; none leaves it plain.
    pub colour: Option<usize>,
    /// The number of the field that has the bends beside creases (at creases, degrees, [`Scale::Signed`]),
    /// which the page takes out of the fold angles that it shows; none where nothing bends beside creases.
    ///
    /// [`Scale::Signed`]: super::Scale::Signed
    pub bends: Option<usize>,
    /// Quantities over time, to plot.
    pub series: Vec<TimeSeries>,
    /// Rows of a table: name and value.
    pub summary: Vec<(String, String)>,
    /// The scene as a text.
    pub scene: String,
    /// The command that makes the run again.
    pub reproduce: String,
}

impl Replay {
    /// Checks every length, index and number.
    ///
    /// # Errors
    /// [`DataError`] naming the first list that cannot be shown, the index and the value.
    pub fn validate(&self) -> Result<(), DataError> {
        self.check_lengths()?;
        self.check_frames(self)
    }

    /// Checks that there are positions and values for each of the times.
    pub(super) fn check_lengths(&self) -> Result<(), DataError> {
        if self.positions.is_empty() {
            return Err(check::no_frames());
        }
        let frames = self.positions.len();
        check::length("the times of the frames", self.times.len(), frames)?;
        if !self.folded.is_empty() {
            check::length("the parts of the folding", self.folded.len(), frames)?;
        }
        for (index, field) in self.fields.iter().enumerate() {
            check::length(&field.place_in_page(index), field.values.len(), frames)?;
        }
        Ok(())
    }

    /// Checks everything, with the positions and the values of fields of some frames.
    pub(super) fn check_frames<M: MotionFrames<Error: From<DataError>>>(
        &self,
        frames: &M,
    ) -> Result<(), M::Error> {
        let topology = self.check_still()?;
        let kept = KeptFrames {
            frames: self.times.len(),
            stride: 1,
        };
        kept.try_each(frames, |frame| {
            let positions = || positions_of(frame.number, self.times[frame.number]);
            check::length_of(frame.x.len(), self.rest.len(), positions)?;
            check::finite_of(frame.x, positions)?;
            let fields = self.fields.iter().zip(frame.fields).enumerate();
            for (index, (field, values)) in fields {
                field.check_values(values, index, frame.number, &topology)?;
            }
            Ok(())
        })
    }

    /// Checks everything but the frames, and returns the connectivity of the sheet.
    fn check_still(&self) -> Result<Topology, DataError> {
        if self.times.is_empty() {
            return Err(check::no_frames());
        }
        if self.faces.is_empty() {
            let remedy = "give the triangles of the sheet";
            return Err(DataError::new("the replay has no faces", remedy));
        }
        let vertices = self.rest.len() / 3;
        check::length("the rest positions", self.rest.len(), 3 * vertices)?;
        let topology = check::topology(vertices, &self.faces)?;
        check::finite("the rest positions", &self.rest)?;
        check::times("the times of the frames", &self.times)?;
        if let Some(ground) = self.ground {
            check::finite("the height of the ground", &[ground])?;
        }
        if !self.sheets.is_empty() {
            let of_sheets = self.sheets.iter().sum();
            check::length("the faces of all sheets", self.faces.len(), of_sheets)?;
        }
        check::vertices("the pins", &self.pins, vertices)?;
        check::vertices("the immobile vertices", &self.immobile, vertices)?;
        for (index, body) in self.bodies.iter().enumerate() {
            body.validate(index, self.times.len())?;
        }
        for (index, series) in self.series.iter().enumerate() {
            series.validate(index)?;
        }
        Ok(topology)
    }
}

fn positions_of(frame: usize, time: f64) -> String {
    format!("the positions of frame {frame} at {time} s")
}

impl MotionFrames for Replay {
    type Error = DataError;

    fn each(
        &self,
        show: &mut dyn FnMut(&MotionFrame<'_>) -> ControlFlow<()>,
    ) -> Result<(), DataError> {
        for (number, x) in self.positions.iter().enumerate() {
            let fields: Vec<&[f64]> = self.fields.iter().map(|f| &f.values[number][..]).collect();
            let frame = MotionFrame {
                number,
                t: self.times[number],
                x,
                data: FrameData::default(),
                fields: &fields,
            };
            if show(&frame).is_break() {
                break;
            }
        }
        Ok(())
    }
}
