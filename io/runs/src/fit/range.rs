//! The keys that a fit varies.

use isosheet_files::DataError;
use isosheet_mesh::wording::given;
use isosheet_scenes::Key;
use std::str::FromStr;

/// A key of a scene and the range of its value, written as `key=from..to`. If both ends are positive and one
/// is ten times the other or more, the logarithm of the value varies.
///
/// ```
/// use isosheet_runs::FitRange;
/// let range: FitRange = "sheet.density=0.05..0.2".parse()?;
/// assert_eq!((range.key(), range.ends()), ("sheet.density", [0.05, 0.2]));
/// # Ok::<(), isosheet_files::DataError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FitRange {
    key: String,
    place: Key,
    ends: [f64; 2],
}

impl FitRange {
    /// The key, as it was written.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// The least and the largest value.
    pub fn ends(&self) -> [f64; 2] {
        self.ends
    }

    pub(super) fn place(&self) -> &Key {
        &self.place
    }

    fn is_logarithmic(&self) -> bool {
        let [from, to] = self.ends;
        from > 0.0 && to / from >= 10.0
    }

    /// The value at a part of the range, from 0 to 1.
    pub(super) fn value(&self, part: f64) -> f64 {
        let [from, to] = self.ends;
        // The ends themselves are met exactly.
        match part {
            ..=0.0 => from,
            1.0.. => to,
            _ if self.is_logarithmic() => from * (to / from).powf(part),
            _ => from + (to - from) * part,
        }
    }

    /// The part of the range at which a value is.
    pub(super) fn part(&self, value: f64) -> f64 {
        let [from, to] = self.ends;
        let part = match self.is_logarithmic() {
            true => (value / from).ln() / (to / from).ln(),
            false => (value - from) / (to - from),
        };
        part.clamp(0.0, 1.0)
    }

    /// How much the value changes for each change of the part.
    pub(super) fn slope(&self, part: f64) -> f64 {
        let [from, to] = self.ends;
        match self.is_logarithmic() {
            true => self.value(part) * (to / from).ln(),
            false => to - from,
        }
    }
}

impl FromStr for FitRange {
    type Err = DataError;

    fn from_str(text: &str) -> Result<Self, DataError> {
        let form = || {
            let message = format!("`{text}` is not of the form key=from..to");
            DataError::new(message, "write for example `sheet.density=0.05..0.2`")
        };
        let (key, range) = text.split_once('=').ok_or_else(form)?;
        let key = key.trim().to_owned();
        let (from, to) = range.split_once("..").ok_or_else(form)?;
        let number = |text: &str| text.trim().parse::<f64>().map_err(|_| form());
        let ends = [number(from)?, number(to)?];
        let place = key.parse()?;
        let [from, to] = ends;
        if !(from < to && (to - from).is_finite()) {
            let message = format!(
                "the range of `{key}` goes from {} to {}",
                given(from),
                given(to)
            );
            let remedy = match from < to {
                true => "give finite ends",
                false => "give the smaller end first",
            };
            return Err(DataError::new(message, remedy));
        }
        Ok(Self { key, place, ends })
    }
}
