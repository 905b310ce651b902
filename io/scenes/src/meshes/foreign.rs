//! The forms that values of other crates have in scene files, for the schema: those crates know of none.

use schemars::JsonSchema;

/// The length that a unit of a drawing means.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "only its schema is used")]
pub(crate) enum DrawingUnit {
    /// Metres.
    #[schemars(rename = "m")]
    Metre,
    /// Centimetres.
    #[schemars(rename = "cm")]
    Centimetre,
    /// Millimetres.
    #[schemars(rename = "mm")]
    Millimetre,
    /// Inches.
    #[schemars(rename = "in")]
    Inch,
    /// Points of printers, 1/72 inch.
    #[schemars(rename = "pt")]
    Point,
    /// Pixels of pages, 1/96 inch.
    #[schemars(rename = "px")]
    Pixel,
}

/// A frame of a FOLD file: its number, from 0, or its title in quotes. Frame 0 is the key frame, with the
/// keys of the file itself; frame 1 is the first entry of `file_frames`. A title is the `frame_title` of one
/// frame.
///
/// ```toml
/// [sheet.mesh]
/// file = { path = "crane.fold", frame = "flat pattern" }
/// ```
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
pub(crate) enum FoldFrame {
    /// The number, from 0.
    Number(usize),
    /// The title.
    Title(String),
}
