//! Shaded pictures of the frames of a run.

use super::Viewpoint;
use super::quantity::Quantity;
use isosheet_files::DataError;
use isosheet_mesh::wording::given;
use isosheet_mesh::{Part, VertexId};
use isosheet_pictures::{
    Camera, DrawnSolid, Image, Look, PictureError, SheetPicture, animated_png, at_once,
    render_folded, strip,
};
use isosheet_runs::Recording;
use isosheet_scenes::bounds;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How a run is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmOptions {
    /// Height of the pictures, pixels; 480 by default.
    pub height: usize,
    /// Width of the pictures, pixels; by default an even number that follows from what is seen.
    pub width: Option<usize>,
    /// Where the viewer is; by default -60 degrees from the x axis and 25 degrees above the horizon, or
    /// elsewhere if bodies hide the sheet from there.
    pub view: Option<Viewpoint>,
    /// What is drawn on the sheet; the edges of the mesh and the pins by default.
    pub marks: Marks,
    /// The quantity that the sheet is coloured by, one of [`Recording::quantities`], with a scale of colours
    /// below; none by default.
    pub colour: Option<String>,
    /// The values at both ends of the scale of colours; by default those in all frames of the film, without
    /// the largest 2 % of quantities that differ by orders of magnitude.
    pub range: Option<[f64; 2]>,
}

/// What pictures have on the sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Marks {
    /// The edges of the mesh, unless it is fine, creases, and the vertices that are held.
    #[default]
    MeshAndPins,
    /// Nothing.
    Nothing,
}

impl Default for FilmOptions {
    fn default() -> Self {
        Self {
            height: 480,
            width: None,
            view: None,
            marks: Marks::default(),
            colour: None,
            range: None,
        }
    }
}

/// The largest side of a picture, pixels: four times that of a screen. A picture of this size each way takes
/// 7 GB and more.
const LARGEST: usize = 16_384;

/// Milliseconds for which browsers show no picture of an animation: they take 100 instead.
const TOO_SHORT: u16 = 10;

impl FilmOptions {
    /// Whether the values make sense.
    ///
    /// # Errors
    /// [`PictureError::Options`] for no pixels or more than 16 384 each way, for angles that are not finite
    /// or an elevation beyond 90 degrees, and for a range whose width is 0 or too small for a normal number.
    pub fn validate(&self) -> Result<(), PictureError> {
        let (width, height) = (self.width.unwrap_or(self.height), self.height);
        if !(1..=LARGEST).contains(&width) || !(1..=LARGEST).contains(&height) {
            return Err(PictureError::size(width, height));
        }
        let Viewpoint { azimuth, elevation } = self.view.unwrap_or_default();
        if let (None, Some([low, high])) = (&self.colour, self.range) {
            let message = format!(
                "the range of colours is {}..{}, and the sheet is coloured by no quantity",
                given(low),
                given(high)
            );
            let remedy = "name a quantity, or leave the range out";
            return Err(PictureError::Options(DataError::new(message, remedy)));
        }
        if let Some([low, high]) = self.range.filter(|[low, high]| is_void(high - low)) {
            let message = format!(
                "the range of colours is {}..{}, which has no width",
                given(low),
                given(high)
            );
            let remedy =
                "give two values that are further apart (by a normal floating-point number)";
            return Err(PictureError::Options(
                DataError::new(message, remedy).value(high),
            ));
        }
        let wrong = match (azimuth.is_finite(), (-90.0..=90.0).contains(&elevation)) {
            (true, true) => return Ok(()),
            (false, _) => ("azimuth", azimuth),
            _ => ("elevation", elevation),
        };
        let message = format!("the {} is {} degrees", wrong.0, given(wrong.1));
        let remedy = "give a finite one, and an elevation from -90 to 90";
        let error = DataError::new(message, remedy).value(wrong.1);
        Err(PictureError::Options(error))
    }
}

/// Whether the ends of a range of colours are equal, or so near that no values fit between them.
fn is_void(width: f64) -> bool {
    (0.0..f64::MIN_POSITIVE).contains(&width)
}

/// Some frames of a run, seen by one camera that has the sheet in view in all of them.
#[derive(Debug)]
pub struct Film<'a> {
    recording: &'a Recording,
    frames: Vec<usize>,
    solids: Vec<DrawnSolid>,
    /// Of several sheets where each is in the union.
    parts: Vec<Part>,
    camera: Camera,
    look: Look,
    marks: Marks,
    /// The height of the ground that shows shadows.
    ground: Option<f64>,
    quantity: Option<Quantity>,
    /// What is below the sheet: the scale of colours.
    strip: Option<Image>,
}

/// The viewer is so many times as far away as the sheet is large: little perspective.
const DISTANCE: f64 = 6.0;

/// Margin around the sheet, part of the height of the picture.
const MARGIN: f64 = 0.06;

/// Corners of bodies that are outside of the box around the sheet by no more than this part of its size are
/// in view too: a table below a cloth, a ball that falls on it, but not the far ends of a floor.
const BESIDE: f64 = 0.35;

/// Of what is lower above the ground than this part of the size of the sheet the shadow is in view.
const NEAR_GROUND: f64 = 0.3;

impl<'a> Film<'a> {
    /// The given frames of a run.
    ///
    /// # Errors
    /// [`PictureError::Data`] without frames or for a frame that the run has not, [`PictureError::Options`]
    /// for pictures that memory does not hold, and the errors of [`FilmOptions::validate`].
    pub fn new(
        recording: &'a Recording,
        frames: Vec<usize>,
        options: &FilmOptions,
    ) -> Result<Self, PictureError> {
        options.validate()?;
        let trajectory = &recording.trajectory;
        let states: Option<Vec<&[f64]>> = frames
            .iter()
            .map(|frame| trajectory.frame(*frame))
            .collect();
        let states = states.filter(|states| !states.is_empty());
        let states = states.ok_or_else(PictureError::no_frames)?;
        let bodies = recording
            .obstacles
            .iter()
            .map(|body| DrawnSolid::of(body, 0.0));
        let solids: Vec<DrawnSolid> = bodies.collect::<Result<_, _>>()?;
        let mut points: Vec<[f64; 3]> = states
            .iter()
            .flat_map(|x| x.as_chunks::<3>().0.iter().copied())
            .collect();
        let [low, high] = bounds(&points);
        let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let all = (0..trajectory.len()).filter_map(|k| trajectory.frame(k));
        let corners = bounds(all.flat_map(|x| x.as_chunks::<3>().0));
        let ground = recording.ground(trajectory.times(), corners);
        for frame in &frames {
            for solid in placed(&solids, recording, trajectory.times()[*frame]) {
                points.extend(solid.outline().filter(|p| {
                    let room = BESIDE * size;
                    (0..3).all(|k| p[k] >= low[k] - room && p[k] <= high[k] + room)
                }));
            }
        }
        // What is near to the ground is in view with the place below it.
        let feet = |ground: f64| {
            let near = points
                .iter()
                .filter(move |p| p[2] < ground + NEAR_GROUND * size);
            near.map(|p| [p[0], p[1], ground]).collect::<Vec<_>>()
        };
        points.extend(ground.map(feet).into_iter().flatten());
        let [low, high] = bounds(&points);
        let middle = [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]));
        let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let FilmOptions {
            height,
            width,
            view,
            marks,
            ref colour,
            range,
        } = *options;
        let quantity = colour
            .as_ref()
            .map(|name| Quantity::of(recording, name, &frames, range));
        let quantity = quantity.transpose()?;
        let look = Look::default();
        let wire = match marks {
            Marks::MeshAndPins => look.wire,
            Marks::Nothing => 0.0,
        };
        let sight = || Viewpoint::of_sight(recording, &frames, size, DISTANCE * size);
        let Viewpoint { azimuth, elevation } = view.unwrap_or_else(sight);
        let camera = Camera::new(middle, azimuth, elevation, size, DISTANCE * size);
        let seen = || points.iter().copied();
        // Films are encoded in squares of two pixels.
        let natural = || {
            2 * (0.5 * height as f64 * camera.aspect(seen()))
                .round()
                .max(1.0) as usize
        };
        let width = width.unwrap_or_else(natural);
        if width > LARGEST {
            return Err(PictureError::size(width, height));
        }
        at_once([width, height], 1)?;
        let strip = quantity.as_ref().map(|q| strip(&q.scale, [width, height]));
        let strip = strip.transpose()?;
        let height = height - strip.as_ref().map_or(0, |strip| strip.size()[1]);
        Ok(Self {
            recording,
            frames,
            solids,
            parts: recording
                .parts
                .iter()
                .map(|(_, part)| part.clone())
                .collect(),
            camera: camera.framing(seen(), width as f64 / height as f64, MARGIN),
            look: Look {
                size: [width, height],
                wire,
                ..look
            },
            marks,
            ground,
            quantity,
            strip,
        })
    }

    /// The number of frames.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Width and height of the pictures, pixels.
    pub fn size(&self) -> [usize; 2] {
        let [width, height] = self.look.size;
        let below = self.strip.as_ref().map_or(0, |strip| strip.size()[1]);
        [width, height + below]
    }

    /// As many pictures as memory holds at a time, `most` at most.
    pub fn at_once(&self, most: usize) -> Result<usize, PictureError> {
        at_once(self.size(), most)
    }

    /// Pictures a second, in real time; one for a single picture.
    pub fn rate(&self) -> f64 {
        let times = self.recording.trajectory.times();
        let [first, last] =
            [self.frames.first(), self.frames.last()].map(|f| f.map_or(0.0, |f| times[*f]));
        let duration = last - first;
        match duration > 0.0 {
            true => (self.frames.len() - 1) as f64 / duration,
            false => 1.0,
        }
    }

    /// Whether there are no frames; a film has at least one.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// The picture of one of the frames, by its place among them.
    ///
    /// # Errors
    /// [`PictureError`] if there is none, or it cannot be drawn.
    pub fn picture(&self, place: usize) -> Result<Image, PictureError> {
        let frame = *self.frames.get(place).ok_or_else(PictureError::no_frames)?;
        let trajectory = &self.recording.trajectory;
        let positions = trajectory
            .frame(frame)
            .ok_or_else(PictureError::no_frames)?;
        let solids = placed(&self.solids, self.recording, trajectory.times()[frame]);
        let (pins, immobile): (&[VertexId], &[VertexId]) = match self.marks {
            Marks::MeshAndPins => (&self.recording.pins, &self.recording.immobile),
            Marks::Nothing => (&[], &[]),
        };
        let colours = self.quantity.as_ref().and_then(|q| q.colours(frame));
        let picture = SheetPicture {
            topology: self.recording.sheet.topology(),
            positions,
            pins,
            immobile,
            solids: &solids.collect::<Vec<_>>(),
            parts: &self.parts,
            colours: colours.as_ref(),
            ground: self.ground,
        };
        let picture = render_folded(
            &picture,
            &self.recording.creases(),
            &self.camera,
            &self.look,
        )?;
        Ok(match &self.strip {
            Some(strip) => picture.above(strip),
            None => picture,
        })
    }

    /// All pictures as an animated PNG file, in real time. `drawn` is told the number of pictures that are
    /// drawn, from whatever thread.
    ///
    /// # Errors
    /// [`PictureError`] if a frame cannot be drawn, and of more pictures a second than browsers show.
    pub fn animation(&self, drawn: impl Fn(usize) + Sync) -> Result<Vec<u8>, PictureError> {
        let delay = 1000.0 / self.rate();
        // Conversion from floats saturates: the longest time of a picture is a minute.
        let delay = delay.round().max(1.0) as u16;
        if delay <= TOO_SHORT {
            let message = format!("the animation has {} pictures a second", given(self.rate()));
            let remedy = "take 50 at most, for example `--fps 50` (`fps=50` in Python): browsers show them in slow motion";
            return Err(PictureError::Options(DataError::new(message, remedy)));
        }
        let count = AtomicUsize::new(0);
        animated_png(self.size(), delay, self.frames.len(), |k| {
            let picture = self.picture(k);
            drawn(count.fetch_add(1, Ordering::Relaxed) + 1);
            picture
        })
    }
}

/// The bodies in their places at time `t`, seconds.
fn placed<'a>(
    solids: &'a [DrawnSolid],
    recording: &'a Recording,
    t: f64,
) -> impl Iterator<Item = DrawnSolid> + 'a {
    let bodies = solids.iter().zip(&recording.obstacles);
    bodies.map(move |(solid, body)| solid.moved_to(body.motion().pose(t)))
}
