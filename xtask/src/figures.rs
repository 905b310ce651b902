//! The figures, one module each, and what is kept about them.

mod cloths;
mod crescent;
mod crumple;
mod drape;
mod feed;
mod fig01;
mod fig02;
mod fig03;
mod fig04;
mod fig05;
mod fig06;
mod fig07;
mod fig08;
mod fig09;
mod folds;
mod jam;
mod marks;
mod origami;
mod performance;
mod play;
mod sequence;
mod softness;
mod stamping;

pub(crate) use performance::{machine, rounded};
pub(crate) use play::Play;

use crate::draw::{Anchor, Colour, Drawing, Stroke, Vertical, palette};
use crate::store::Store;
use anyhow::Result;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// How much work to put in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum RenderEffort {
    /// What the figures show.
    Full,
    /// Seconds: short runs, small pictures.
    Quick,
}

/// A picture of a figure.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    /// File name without folder.
    pub(crate) file: String,
    /// What it shows, in words.
    pub(crate) alt: String,
    pub(crate) bytes: Vec<u8>,
}

/// A picture as the record of a figure keeps it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PictureRef {
    /// Path relative to the output folder.
    pub(crate) path: String,
    pub(crate) alt: String,
}

/// A page that plays a run, as the record of a figure keeps it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PageRef {
    /// Paths relative to the output folder.
    pub(crate) path: String,
    pub(crate) thumbnail: String,
    /// Choices in the address of the page, empty or from `#` on.
    pub(crate) choices: String,
    pub(crate) label: String,
}

/// A table below a figure.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Table {
    pub(crate) caption: String,
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

/// What is known about a figure.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Record {
    pub(crate) figure: u8,
    pub(crate) title: String,
    /// What the paper shows.
    pub(crate) paper: String,
    /// What is measured here.
    pub(crate) measured: String,
    pub(crate) pictures: Vec<PictureRef>,
    /// Pages that play its runs; in records of earlier versions there are none.
    #[serde(default)]
    pub(crate) pages: Vec<PageRef>,
    pub(crate) tables: Vec<Table>,
    /// The numbers, for programs.
    pub(crate) facts: Value,
}

/// A figure that has been made.
#[derive(Clone, Debug)]
pub(crate) struct Made {
    pub(crate) title: &'static str,
    pub(crate) paper: &'static str,
    pub(crate) measured: String,
    pub(crate) pictures: Vec<Picture>,
    /// Pages that play its runs.
    pub(crate) pages: Vec<Play>,
    pub(crate) tables: Vec<Table>,
    pub(crate) facts: Value,
}

/// What figures are made with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Context<'a> {
    /// Where runs are kept.
    pub(crate) store: &'a Store,
    pub(crate) effort: RenderEffort,
}

/// Makes a figure.
///
/// # Errors
/// [`Interrupted`](crate::interrupt::Interrupted) after Ctrl-C.
pub(crate) fn make(figure: u8, context: &Context<'_>) -> Result<Made> {
    match figure {
        1 => fig01::make(),
        2 => fig02::make(),
        3 => fig03::make(),
        4 => fig04::make(),
        5 => fig05::make(),
        6 => fig06::make(),
        7 => fig07::make(),
        8 => fig08::make(),
        9 => fig09::make(),
        10 => performance::make(context),
        11 => crumple::make(11, 1, context),
        12 => crumple::make(12, 2, context),
        13 => stamping::make(context),
        14 => drape::fig14(context),
        15 => drape::fig15(context),
        16 => jam::make(context),
        17 => origami::make(context),
        _ => anyhow::bail!("figure {figure} cannot be made"),
    }
}

/// A drawing as the picture `figNN.svg`.
fn svg(figure: u8, drawing: &Drawing, alt: &str) -> Result<Vec<Picture>> {
    Ok(vec![Picture {
        file: format!("fig{figure:02}.svg"),
        alt: alt.to_owned(),
        bytes: drawing.to_svg(alt)?.into_bytes(),
    }])
}

/// Line styles that several figures share.
mod style {
    use super::{Colour, Stroke, palette};

    pub(super) const EDGE: Stroke = Stroke::new(palette::INK, 0.7);
    pub(super) const GHOST: Stroke = Stroke::new(palette::GREY, 0.5);
    /// Paper white with a hint of warmth, so that faces differ from the background.
    pub(super) const FACE: Colour = Colour::new(246, 243, 236);
}

/// Centred lines of text below each other, the first hanging from `at`.
fn caption(drawing: &mut Drawing, at: [f64; 2], size: f64, lines: &[String]) {
    for (k, line) in lines.iter().enumerate() {
        let y = at[1] - 1.35 * size * k as f64;
        drawing.text(
            [at[0], y],
            line,
            size,
            Anchor::Middle,
            Vertical::Below,
            palette::INK,
        );
    }
}

/// A smallest gap in words.
fn gap(gap: Option<f64>) -> String {
    match gap {
        None => "none (nothing came within reach)".into(),
        Some(metres) if metres < 1e-3 => format!("{:.1} µm", 1e6 * metres),
        Some(metres) => format!("{:.2} mm", 1e3 * metres),
    }
}

fn degrees(angle: f64) -> String {
    format!("{:.1}°", angle.to_degrees())
}
