//! What was taken for what in a drawing, and what was changed.

use super::class::LineClass;
use crate::Length;
use isosheet_mesh::wording::counted;
use std::collections::BTreeMap;
use std::fmt;

/// The lines of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassCount {
    /// The class.
    pub class: LineClass,
    /// How many lines of the drawing there are.
    pub lines: usize,
    /// Their length, metres.
    pub length: f64,
    /// Why they are taken for this: selectors, colours and layers, with the number of the lines.
    pub reasons: BTreeMap<String, usize>,
}

/// What was done in one of several places: how often, and the largest of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Places {
    /// How many there are.
    pub count: usize,
    /// The extent of the largest, metres.
    pub extent: f64,
    /// Where that is, metres.
    pub at: [f64; 2],
}

/// What was taken for what, and what was changed.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawingReport {
    /// Width and height of the sheet, metres.
    pub size: [f64; 2],
    /// Length of the edges of the mesh, about, as it was asked for, metres.
    pub spacing: f64,
    /// The classes that the drawing has.
    pub classes: Vec<ClassCount>,
    /// Ends that were moved to others or onto lines, and by how much.
    pub joined: Option<Places>,
    /// Lines that were drawn twice, and how long they are.
    pub doubled: Option<Places>,
    /// Lines that were drawn twice, as lines of different classes, of which the strongest counts.
    pub contradicting: Option<Places>,
    /// Creases that close the outline where cuts leave it open, and how long they are.
    pub closing: Option<Places>,
    /// Lines beyond the outline or within holes, which were cut off there, and how long they are.
    pub beyond: Option<Places>,
    /// In how many pieces the sheet is.
    pub pieces: usize,
    /// Lines that are shorter than the tolerance for snapping.
    pub too_short: usize,
    /// What is no line, or is drawn in a colour that is not understood, with its number.
    pub left_out: BTreeMap<String, usize>,
    /// What a unit was taken for, where the file does not say it.
    pub assumed_unit: Option<&'static str>,
    /// How many times as large the sheet is by the unit of the file, where another one was given.
    pub by_own_unit: Option<f64>,
}

/// A length in millimetres.
fn mm(metres: f64) -> String {
    Length { metres }.to_string()
}

/// Part by which a unit that was given may differ from that of the file without a word: pages are rounded to
/// tenths of a millimetre, or to whole pixels.
const SAME_UNIT: f64 = 0.01;

impl Places {
    /// The number of places in a list, and the largest one; `None` of an empty list.
    pub fn of(places: impl IntoIterator<Item = (f64, [f64; 2])>) -> Option<Self> {
        let mut found: Option<Self> = None;
        for (extent, at) in places {
            let count = found.map_or(1, |f| f.count + 1);
            found = Some(match found {
                Some(known) if known.extent >= extent => Self { count, ..known },
                _ => Self { count, extent, at },
            });
        }
        found
    }

    fn told(&self) -> String {
        let [x, y] = self.at.map(|c| (1e5 * c).round() / 1e2 + 0.0);
        format!("{} at ({x}, {y}) mm", mm(self.extent))
    }
}

/// A line for each class and for whatever was changed, with its end.
impl fmt::Display for DrawingReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for class in &self.classes {
            let reasons = class
                .reasons
                .iter()
                .map(|(reason, n)| format!("{reason} ({n})"));
            let reasons: Vec<String> = reasons.collect();
            let name = class.class.to_string();
            let count = counted(class.lines, "line", "lines");
            let length = mm(class.length);
            writeln!(f, "{name:9} {count}, {length}: {}", reasons.join(", "))?;
        }
        let told = [
            (
                &self.joined,
                ["end", "ends"],
                "joined over a gap, the widest",
            ),
            (
                &self.doubled,
                ["line", "lines"],
                "drawn more than once, the longest",
            ),
            (
                &self.contradicting,
                ["of them is", "of them are"],
                "of several classes (a cut counts before a fold, and a mountain on a valley is a crease), the longest",
            ),
            (
                &self.closing,
                ["line", "lines"],
                "of creases taken as the outline where cuts leave it open, the longest",
            ),
            (
                &self.beyond,
                ["line", "lines"],
                "beyond the outline or in a hole left out, the longest",
            ),
        ];
        for (places, [one, more], what) in told {
            if let Some(places) = places {
                let count = counted(places.count, one, more);
                writeln!(f, "note: {count} {what} {}", places.told())?;
            }
        }
        if self.pieces > 1 {
            writeln!(f, "note: the sheet is in {} pieces", self.pieces)?;
        }
        if self.too_short > 0 {
            let count = counted(self.too_short, "line", "lines");
            writeln!(
                f,
                "note: {count} shorter than the tolerance for snapping left out"
            )?;
        }
        for (what, count) in &self.left_out {
            writeln!(f, "note: left out: {what} ({count})")?;
        }
        if let Some(unit) = self.assumed_unit {
            let [w, h] = self.size.map(mm);
            writeln!(
                f,
                "note: the file has no unit of length, {unit} is taken, and so the sheet is {w} by {h}"
            )?;
        }
        let [w, h] = self.size;
        if self.spacing > w.hypot(h) {
            writeln!(
                f,
                "note: the spacing is {}, longer than the sheet: the mesh has only the edges that its lines need",
                mm(self.spacing)
            )?;
        }
        let is_other = |factor: &f64| (factor - 1.0).abs() > SAME_UNIT;
        if let Some(factor) = self.by_own_unit.filter(is_other) {
            let [w, h] = self.size.map(mm);
            let [x, y] = self.size.map(|length| mm(factor * length));
            writeln!(
                f,
                "note: the sheet is {w} by {h} in the given unit, and {x} by {y} in the unit of the file"
            )?;
        }
        Ok(())
    }
}
