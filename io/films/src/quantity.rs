//! Quantities as colours of pictures.

use isosheet_files::DataError;
use isosheet_formats::MotionFrames;
use isosheet_page::{Centering, Field, Scale};
use isosheet_pictures::{ColourMap, ColourScale, Colours, PictureError, Spacing};
use isosheet_runs::Recording;
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// The share of values inside the range of colours, where values differ by orders of magnitude. Zeros are
/// apart. Pages have this share, too.
const IN_RANGE: f64 = 0.98;

/// Creases whose value differs from zero by no more than this part of the range of colours show nothing; as
/// in pages.
const FLAT: f64 = 0.01;

/// The values of a quantity in some frames, and which colours they have.
#[derive(Debug)]
pub(super) struct Quantity {
    pub(super) scale: ColourScale,
    place: Centering,
    values: BTreeMap<usize, Vec<f64>>,
}

impl Quantity {
    /// The quantity of a name in some frames of a run, on a scale that has the values in all of them, or
    /// another range.
    ///
    /// # Errors
    /// [`PictureError::Options`] for a name that no quantity has, with the names that exist, and for a range
    /// that makes no sense.
    pub(super) fn of(
        recording: &Recording,
        name: &str,
        frames: &[usize],
        range: Option<[f64; 2]>,
    ) -> Result<Self, PictureError> {
        let fields = recording.coloured();
        let Some(field) = fields
            .iter()
            .find(|field| is_called(&field.head.name, name))
        else {
            return Err(unknown(name, &recording.quantities()));
        };
        let mut values = BTreeMap::new();
        let Ok(()) = recording.trajectory.each(&mut |frame| {
            if frames.contains(&frame.number) {
                values.insert(frame.number, field.values(frame));
            }
            ControlFlow::Continue(())
        });
        let scale = scale(&field.head, values.values().flatten().copied(), range);
        scale.validate()?;
        Ok(Self {
            scale,
            place: field.head.place,
            values,
        })
    }

    /// The colours in one of the frames.
    pub(super) fn colours(&self, frame: usize) -> Option<Colours> {
        let values = self.values.get(&frame)?;
        let colours = values.iter().map(|value| self.scale.colour(*value));
        Some(match self.place {
            Centering::Vertex => Colours::Vertices(colours.collect()),
            Centering::Edge => Colours::Edges(colours.collect()),
            Centering::Face => Colours::Faces(colours.collect()),
            Centering::Crease => {
                let place = |value: f64| self.scale.place(value);
                let is_shown = |value: f64| (place(value) - place(0.0)).abs() > FLAT;
                let shown = values.iter().zip(colours);
                let shown = shown.map(|(value, colour)| is_shown(*value).then_some(colour));
                Colours::Creases(shown.collect())
            }
        })
    }
}

/// Whether a quantity is meant by a name: its own, without what is in parentheses and in letters of any size.
fn is_called(name: &str, asked: &str) -> bool {
    let plain = |name: &str| {
        let (name, _) = name.split_once('(').unwrap_or((name, ""));
        name.trim().to_lowercase()
    };
    plain(name) == plain(asked)
}

fn unknown(name: &str, quantities: &[String]) -> PictureError {
    let names: Vec<String> = quantities.iter().map(|name| format!("`{name}`")).collect();
    let message = format!(
        "the run has no quantity `{name}`; it has {}",
        names.join(", ")
    );
    PictureError::Options(DataError::new(message, "name one of these"))
}

/// The scale of some values of a field, as pages have it.
fn scale(
    field: &Field,
    values: impl Iterator<Item = f64> + Clone,
    range: Option<[f64; 2]>,
) -> ColourScale {
    // Values below the normal numbers are as good as zero, and leave no room for a scale.
    let sizes = || {
        values
            .clone()
            .map(f64::abs)
            .filter(|size| *size >= f64::MIN_POSITIVE)
    };
    let smallest = |values: &mut dyn Iterator<Item = f64>| values.reduce(f64::min).unwrap_or(0.0);
    let largest = |values: &mut dyn Iterator<Item = f64>| values.reduce(f64::max).unwrap_or(0.0);
    let usual = || {
        let mut sizes: Vec<f64> = sizes().collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let inside = (IN_RANGE * sizes.len() as f64).ceil() as usize;
        sizes.get(inside.saturating_sub(1)).copied().unwrap_or(0.0)
    };
    let own = match field.scale {
        Scale::Linear if field.place == Centering::Crease => [0.0, largest(&mut values.clone())],
        Scale::Linear => [smallest(&mut values.clone()), largest(&mut values.clone())],
        Scale::Logarithmic => [smallest(&mut sizes()), largest(&mut sizes())],
        Scale::Signed => [-usual(), usual()],
        Scale::Magnitude => [0.0, usual()],
    };
    let [low, high] = range.unwrap_or_else(|| match own[1] - own[0] >= f64::MIN_POSITIVE {
        true => own,
        false => own.map(|_| if own[1].is_normal() { own[1] } else { 0.0 }),
    });
    // A zero of a logarithmic scale is at its low end.
    let is_logarithmic = field.scale == Scale::Logarithmic;
    let below = |value: f64| value < low && !(is_logarithmic && value == 0.0);
    ColourScale {
        name: field.name.clone(),
        unit: field.unit.clone(),
        range: [low, high],
        is_open: [
            values.clone().any(below),
            values.clone().any(|value| value > high),
        ],
        spacing: match is_logarithmic {
            true => Spacing::Logarithmic,
            false => Spacing::Linear,
        },
        map: match (field.scale, field.place) {
            (Scale::Signed, _) => ColourMap::Diverging,
            (_, Centering::Crease) => ColourMap::Dark,
            _ => ColourMap::Sequential,
        },
    }
}
