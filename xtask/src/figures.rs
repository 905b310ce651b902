//! The figures, one module each, and what is kept about them.

mod balance;
mod cloths;
mod crumple;
mod drape;
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
mod performance;
mod show;
mod sketch;
mod softness;
mod stamping;
mod style;

use crate::draw::{Anchor, Drawing, Vertical, palette};
use crate::report::{Effort, Picture, Table};
use crate::runs::{RunSummary, about_ensembles};
use crate::store::{Files, Store};
use anyhow::Result;

/// A page that plays a run.
#[derive(Clone, Debug)]
pub(crate) struct Play {
    /// Path of the page relative to the output folder.
    pub(crate) path: String,
    /// Choices in the address of the page, empty or from `#` on.
    pub(crate) choices: &'static str,
    /// What tells it from the other pages of the figure.
    pub(crate) label: String,
    pub(crate) page: String,
    /// Path and text of its scene file.
    pub(crate) scene: (String, String),
    /// The last frame as a PNG file.
    pub(crate) thumbnail: Picture,
}

/// A figure that has been made.
#[derive(Clone, Debug, Default)]
pub(crate) struct Made {
    pub(crate) title: &'static str,
    /// What the paper shows.
    pub(crate) paper: &'static str,
    /// What is seen here.
    pub(crate) here: &'static str,
    pub(crate) pictures: Vec<Picture>,
    /// Pages that play its runs.
    pub(crate) pages: Vec<Play>,
    /// What was measured; all but the first are folded away on the page.
    pub(crate) tables: Vec<Table>,
}

impl Made {
    /// Writes its files.
    pub(crate) fn write(&self, figure: u8, files: &mut Files<'_>) -> Result<()> {
        for (k, table) in (1..).zip(&self.tables) {
            table
                .clone()
                .named(&format!("fig{figure:02}-{k}"))
                .write(files)?;
        }
        for picture in &self.pictures {
            picture.write(files)?;
        }
        for play in &self.pages {
            files.write(&play.path, play.page.as_bytes())?;
            files.write(&play.scene.0, play.scene.1.as_bytes())?;
            play.thumbnail.write(files)?;
        }
        Ok(())
    }
}

/// Makes a figure.
///
/// # Errors
/// [`Interrupted`](crate::interrupt::Interrupted) after Ctrl-C.
pub(crate) fn make(figure: u8, store: &Store) -> Result<Made> {
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
        10 => performance::make(store),
        11 => crumple::make(11, 1, store),
        12 => crumple::make(12, 2, store),
        13 => stamping::make(store),
        14 => drape::fig14(store),
        15 => drape::fig15(store),
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

/// The place of the value that is nearest to another one, 0 if there are none.
fn nearest(values: impl IntoIterator<Item = f64>, wanted: f64) -> usize {
    let off = values.into_iter().map(|v| (v - wanted).abs()).enumerate();
    off.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(k, _)| k)
}

/// A quantity, and what was measured of it.
type FigureRow = (&'static str, String);

/// Quantities, and what was measured of them: `rows! { "quantity" => text, ... }`.
macro_rules! rows {
    ($($quantity:expr => $text:expr),* $(,)?) => { vec![$(($quantity, String::from($text))),*] };
}
use rows;

/// Quantities with what was measured of them.
fn measured(rows: impl IntoIterator<Item = FigureRow>) -> Table {
    compared(&["value"], &[rows.into_iter().collect()])
}

/// Quantities with what was measured of them in several runs, whose names and columns are given.
fn compared(names: &[&str], columns: &[Vec<FigureRow>]) -> Table {
    let rows = columns.first().map_or(0, Vec::len);
    let row = |k: usize| {
        let values = columns.iter().map(|column| column[k].1.clone());
        [columns[0][k].0.to_owned()]
            .into_iter()
            .chain(values)
            .collect()
    };
    Table::new("Measured", &[&["quantity"], names].concat()).with_texts((0..rows).map(row))
}

/// A table of the runs that are shown, of which some rows are of ensembles.
fn of_ensembles(table: Table) -> Table {
    Table {
        caption: format!("{}. {}", table.caption, about_ensembles()),
        ..table
    }
}

/// What the course of a run was.
fn course(run: &RunSummary) -> Vec<FigureRow> {
    let course = &run.course;
    let steps = format!(
        "{} frames, {} rejected steps",
        course.cost.steps, course.cost.rejected
    );
    let rods = || "none: rods".into();
    rows! {
        "simulated" => format!("{:.1} s, {steps}", course.time),
        "CPU seconds for a simulated second" => format!("{:.2}", course.cpu_rate().unwrap_or_default()),
        "factorisations for a frame" =>
            format!("{:.1}", course.cost.factorisations_per_step().unwrap_or_default()),
        "largest strain" => format!("{:.0e}", run.strain()),
        "membrane stiffness" => run.stiffness().unwrap_or_else(rods),
        "smallest gap" => gap(course.gap),
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
