//! Values of options for frames and pictures.

use isosheet_films::Viewpoint;
use std::str::FromStr;

/// Frames of a run, `A..B`, both included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct FrameRange {
    /// The first frame, if it is not that of the run.
    pub(crate) first: Option<usize>,
    /// The last frame, if it is not that of the run.
    pub(crate) last: Option<usize>,
}

impl FrameRange {
    /// The first and the last one of so many frames.
    pub(crate) fn of(self, count: usize) -> [usize; 2] {
        let last = self.last.unwrap_or(count.saturating_sub(1));
        [self.first.unwrap_or(0), last]
    }
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let help =
            || "give two frames with .. between them, such as 10..20, 10.. or ..20".to_owned();
        let (first, last) = text.split_once("..").ok_or_else(help)?;
        let number = |text: &str| match text.trim() {
            "" => Ok(None),
            text => text.parse().map(Some).map_err(|_| help()),
        };
        let (first, last) = (number(first)?, number(last)?);
        match (first, last) {
            (Some(first), Some(last)) if last < first => {
                Err("the last frame is before the first one".to_owned())
            }
            _ => Ok(Self { first, last }),
        }
    }
}

/// The number of a frame, from 0, or the last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FrameNumber {
    Number(usize),
    Last,
}

impl FrameNumber {
    /// Its number among so many frames.
    pub(crate) fn of(self, count: usize) -> usize {
        match self {
            Self::Number(number) => number,
            Self::Last => count.saturating_sub(1),
        }
    }
}

impl FromStr for FrameNumber {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.trim() {
            "last" => Ok(Self::Last),
            number => match number.parse() {
                Ok(number) => Ok(Self::Number(number)),
                Err(_) => Err("give the number of a frame, from 0, or `last`"),
            },
        }
    }
}

/// The size of pictures, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: Option<usize>,
    pub(crate) height: usize,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let help =
            |_| "give WIDTHxHEIGHT in pixels, such as 1280x720, or the height alone".to_owned();
        match text.split_once('x') {
            Some((width, height)) => Ok(Self {
                width: Some(width.parse().map_err(help)?),
                height: height.parse().map_err(help)?,
            }),
            None => Ok(Self {
                width: None,
                height: text.parse().map_err(help)?,
            }),
        }
    }
}

/// Where the viewer is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View(pub(crate) Viewpoint);

impl FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (azimuth, elevation) = match text {
            "front" => (-90.0, 0.0),
            "back" => (90.0, 0.0),
            "left" => (180.0, 0.0),
            "right" => (0.0, 0.0),
            "top" => (-90.0, 90.0),
            "bottom" => (-90.0, -90.0),
            _ => {
                let help = || {
                    "give front, back, left, right, top, bottom, or two angles in degrees, such as -60,25".to_owned()
                };
                let (azimuth, elevation) = text.split_once(',').ok_or_else(help)?;
                let angle = |text: &str| text.trim().parse().map_err(|_| help());
                (angle(azimuth)?, angle(elevation)?)
            }
        };
        Ok(Self(Viewpoint { azimuth, elevation }))
    }
}

/// The values at both ends of a scale of colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColourRange(pub(crate) [f64; 2]);

impl FromStr for ColourRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let help = || "give two values with .. between them, such as 0..0.01".to_owned();
        let (low, high) = text.split_once("..").ok_or_else(help)?;
        let value = |text: &str| text.trim().parse().map_err(|_| help());
        Ok(Self([value(low)?, value(high)?]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read() {
        let range = |text: &str| text.parse::<FrameRange>().map(|r| r.of(30));
        assert_eq!(range("3..7"), Ok([3, 7]));
        assert_eq!(range("3.."), Ok([3, 29]));
        assert_eq!(range("..7"), Ok([0, 7]));
        for wrong in ["3", "7..3", "a..b", "1...2", "-1..2"] {
            assert!(range(wrong).is_err(), "{wrong}");
        }
        let size = |text: &str| text.parse::<Size>().map(|s| (s.width, s.height));
        assert_eq!(size("640x480"), Ok((Some(640), 480)));
        assert_eq!(size("720"), Ok((None, 720)));
        assert!(size("720p").is_err() && size("x").is_err());
        let view = |text: &str| text.parse::<View>().map(|View(v)| (v.azimuth, v.elevation));
        assert_eq!(view("-30,12.5"), Ok((-30.0, 12.5)));
        assert_eq!(view("top"), Ok((-90.0, 90.0)));
        let colours = |text: &str| text.parse::<ColourRange>().map(|ColourRange(r)| r);
        assert_eq!(colours("-1e-3..0.5"), Ok([-1e-3, 0.5]));
        assert!(colours("0").is_err() && colours("0..").is_err());
        assert!(view("above").is_err() && view("1,2,3").is_err());
    }
}
