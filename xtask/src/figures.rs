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
mod sketch;
mod softness;
mod stamping;
mod style;

use crate::draw::{Anchor, Drawing, Vertical, palette};
use crate::report::{Effort, Picture, PictureRef, Table};
use crate::store::Store;
use anyhow::Result;
use serde::{Deserialize, Serialize};
use serde_json::Value;

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

/// A page that plays a run.
#[derive(Clone, Debug)]
pub(crate) struct Play {
    /// Names of page and picture without folder.
    pub(crate) file: String,
    pub(crate) thumbnail_file: String,
    /// Choices in the address of the page, empty or from `#` on.
    pub(crate) choices: &'static str,
    /// What tells it from the other pages of the figure.
    pub(crate) label: String,
    pub(crate) page: String,
    /// The last frame as a PNG file.
    pub(crate) thumbnail: Vec<u8>,
}

/// A figure that has been made.
#[derive(Clone, Debug, Default)]
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
    pub(crate) effort: Effort,
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
fn svg(figure: u8, drawing: &Drawing, alt: &str) -> Vec<Picture> {
    vec![Picture::svg(&format!("fig{figure:02}"), drawing, alt)]
}

/// Centred lines of text below each other, the first hanging from `at`.
fn caption(drawing: &mut Drawing, at: [f64; 2], size: f64, lines: &[String]) {
    for (k, line) in lines.iter().enumerate() {
        let place = [at[0], at[1] - 1.35 * size * k as f64];
        let (anchor, ink) = (Anchor::Middle, palette::INK);
        drawing.text(place, line, size, anchor, Vertical::Below, ink);
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

/// A part as a percentage without decimals.
fn whole_percent(part: f64) -> String {
    format!("{:.0} %", 100.0 * part)
}

fn degrees(angle: f64) -> String {
    format!("{:.1}°", angle.to_degrees())
}
