//! Layers with their colours and line types.

use super::groups::{Record, section};
use crate::colour::Colour;
use crate::lines::Pen;
use isosheet_files::DataError;
use std::collections::HashMap;

/// What entities of a layer look like.
#[derive(Clone, Copy, Debug)]
struct Layer {
    colour: Colour,
    dashed: bool,
    hidden: bool,
}

const DEFAULT: Layer = Layer {
    colour: Colour::BLACK,
    dashed: false,
    hidden: false,
};

/// The layers by their names.
pub(super) struct Layers<'a>(HashMap<&'a str, Layer>);

impl<'a> Layers<'a> {
    pub(super) fn of(records: &[Record<'a>]) -> Result<Self, DataError> {
        let entries = section(records, "TABLES")?
            .iter()
            .filter(|r| r.kind == "LAYER");
        let mut layers = HashMap::new();
        for record in entries {
            let index = record.flags(62)?;
            let layer = Layer {
                colour: own_colour(record)?.unwrap_or(Colour::BLACK),
                dashed: record.text(6).is_some_and(is_dashed),
                // A negative colour says that it is switched off, and the flag that it is frozen.
                hidden: index < 0 || record.flags(70)? & 1 != 0,
            };
            layers.insert(record.text(2).unwrap_or_default(), layer);
        }
        Ok(Self(layers))
    }

    /// How an entity is drawn, of a block with the pen with which this is inserted; `None` if it is hidden or
    /// not on the sheet. Entities of a block on the layer `0` are on the layer on which it is inserted.
    pub(super) fn pen(
        &self,
        entity: &Record<'_>,
        inserted: Option<&Pen>,
    ) -> Result<Option<Pen>, DataError> {
        let around = inserted.map_or(&[][..], |pen| &pen.layers);
        let name = match (entity.text(8).unwrap_or("0"), around) {
            ("0", [outer, ..]) => outer,
            (own, _) => own,
        };
        let layer = self.0.get(name).copied().unwrap_or(DEFAULT);
        if layer.hidden || entity.flags(60)? == 1 || entity.flags(67)? == 1 {
            return Ok(None);
        }
        let of_block = inserted.filter(|_| entity.text(62) == Some("0"));
        let colour = own_colour(entity)?.or(of_block.map(|pen| pen.colour));
        let mut layers = vec![name.to_owned()];
        layers.extend(around.iter().filter(|outer| *outer != name).cloned());
        Ok(Some(Pen {
            colour: colour.unwrap_or(layer.colour),
            dashed: match (entity.text(6), inserted) {
                (None, _) => layer.dashed,
                (Some(name), _) if name.eq_ignore_ascii_case("BYLAYER") => layer.dashed,
                (Some(name), Some(pen)) if name.eq_ignore_ascii_case("BYBLOCK") => pen.dashed,
                (Some(name), _) => is_dashed(name),
            },
            opacity: 1.0,
            layers,
        }))
    }
}

/// The colour that a record gives, true or by its index.
fn own_colour(record: &Record<'_>) -> Result<Option<Colour>, DataError> {
    if record.text(420).is_some() {
        let [.., r, g, b] = (record.flags(420)? as u32).to_be_bytes();
        return Ok(Some(Colour([r, g, b])));
    }
    Ok(match record.flags(62)?.unsigned_abs() {
        0 | 256.. => None,
        index => Some(of_index(index as u8)),
    })
}

/// The colours of `AutoCAD` by their index, about: six of them, black, greys, and 24 hues in five shades,
/// each full and half.
fn of_index(index: u8) -> Colour {
    let hue = |degrees: f64, chroma: f64, value: f64| {
        Colour([5.0, 3.0, 1.0].map(|n| {
            let k = (n + degrees / 60.0) % 6.0;
            let dip = k.min(4.0 - k).clamp(0.0, 1.0);
            (255.0 * value * (1.0 - chroma * dip)).round() as u8
        }))
    };
    match index {
        1..=6 => hue(60.0 * f64::from(index - 1), 1.0, 1.0),
        8 | 9 => Colour([if index == 8 { 128 } else { 192 }; 3]),
        10..=249 => {
            let degrees = 15.0 * f64::from((index - 10) / 10);
            let shade = [1.0, 0.65, 0.5, 0.3, 0.15][usize::from(index % 10 / 2)];
            let chroma = if index.is_multiple_of(2) { 1.0 } else { 0.5 };
            hue(degrees, chroma, shade)
        }
        250.. => Colour([51 + 40 * (index - 250); 3]),
        _ => Colour::BLACK,
    }
}

fn is_dashed(line_type: &str) -> bool {
    let name = line_type.to_uppercase();
    let words = [
        "DASH", "HIDDEN", "DOT", "CENTER", "PHANTOM", "PERF", "DIVIDE", "BORDER",
    ];
    words.iter().any(|word| name.contains(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_by_index() {
        for (index, name) in [
            (1, "red"),
            (2, "yellow"),
            (3, "green"),
            (4, "cyan"),
            (5, "blue"),
            (6, "magenta"),
            (7, "black"),
            (9, "grey"),
            (170, "blue"),
            (250, "black"),
        ] {
            assert_eq!(of_index(index).name(), Some(name), "{index}");
        }
        assert_eq!(of_index(1), Colour([255, 0, 0]));
        assert_eq!(of_index(255), Colour([251; 3]));
    }
}
