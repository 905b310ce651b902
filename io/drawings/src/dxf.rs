//! Drawing Exchange Format, as text.
//!
//! Read are LINE, ARC, CIRCLE, ELLIPSE, LWPOLYLINE and POLYLINE with bulges, and SPLINE without weights, with
//! their layers, colours and line types, and blocks wherever INSERT puts them.

mod blocks;
mod entity;
mod groups;
mod layers;
mod spline;
mod writer;

pub(crate) use writer::text;

use super::lines::{Drawing, Pen};
use super::unit::DrawingUnit;
use blocks::{Blocks, Place, compose};
use entity::Entity;
use groups::{Record, section};
use isosheet_files::{Allowance, DataError};
use layers::Layers;

/// Reads the entities of a drawing.
pub(crate) fn parse(
    bytes: &[u8],
    unit: Option<DrawingUnit>,
    scale: f64,
) -> Result<Drawing, DataError> {
    let text = String::from_utf8_lossy(bytes);
    let records = groups::records(&text)?;
    let mut drawing = Drawing::default();
    let unit = match unit {
        Some(unit) => {
            let own = metres(&records).ok().flatten();
            drawing.by_own_unit = own.map(|own| own / unit.metres(1.0));
            unit.metres(1.0)
        }
        None => match metres(&records)? {
            Some(metres) => metres,
            None => {
                drawing.assumed_unit = Some("1 is 1 mm");
                DrawingUnit::Millimetre.metres(1.0)
            }
        },
    };
    let scale = unit * scale;
    let mut reader = Reader {
        layers: Layers::of(&records)?,
        blocks: Blocks::of(&records)?,
        drawing,
        allowance: Allowance::of(bytes.len()),
    };
    let place = [[scale, 0.0], [0.0, scale], [0.0, 0.0]];
    reader.entities(section(&records, "ENTITIES")?, place, &[])?;
    Ok(reader.drawing)
}

/// Blocks in blocks are followed so deep.
const DEEPEST: usize = 200;

/// Bytes of an entity that is drawn, besides its curves and the names of its layers.
const ENTITY: usize = 256;

struct Reader<'a, 'b> {
    layers: Layers<'a>,
    blocks: Blocks<'a, 'b>,
    drawing: Drawing,
    /// What is left for what blocks become.
    allowance: Allowance,
}

impl<'a, 'b> Reader<'a, 'b> {
    /// Draws entities in a place, which a block has that is inserted with some pens, the outermost first.
    fn entities(
        &mut self,
        records: &'b [Record<'a>],
        place: Place,
        inserts: &[Pen],
    ) -> Result<(), DataError> {
        let mut records = records.iter();
        while let Some(record) = records.next() {
            let mut vertices = Vec::new();
            if record.kind == "POLYLINE" {
                vertices = records
                    .by_ref()
                    .take_while(|r| r.kind == "VERTEX")
                    .collect();
            }
            if inserts.len() > DEEPEST {
                return Err(too_deep(record));
            }
            self.spend(ENTITY, record)?;
            let Some(pen) = self.layers.pen(record, inserts.last())? else {
                self.drawing.leave_out("hidden entity");
                continue;
            };
            if record.kind == "INSERT" {
                self.insert(record, place, pen, inserts)?;
                continue;
            }
            let entity = Entity {
                record,
                vertices: &vertices,
            };
            match entity.curves()? {
                Some(curves) => {
                    let names: usize = pen.layers.iter().map(String::len).sum();
                    // A list that grows has up to twice the room.
                    self.spend(names + 2 * size_of_val(&curves[..]), record)?;
                    let curves = curves.iter().map(|c| c.transformed(place));
                    self.drawing.push(pen, curves);
                }
                None => self.drawing.leave_out(match record.kind {
                    "TEXT" | "MTEXT" | "ATTDEF" | "ATTRIB" => "text",
                    "IMAGE" => "image",
                    "DIMENSION" | "LEADER" | "MLEADER" => "dimension",
                    "HATCH" | "SOLID" => "filled area",
                    "POINT" => "point",
                    // The end of the texts of a block.
                    "SEQEND" => continue,
                    _ => "entity of another kind",
                }),
            }
        }
        Ok(())
    }

    /// Draws a block wherever an entity inserts it.
    fn insert(
        &mut self,
        insert: &Record<'a>,
        place: Place,
        mut pen: Pen,
        inserts: &[Pen],
    ) -> Result<(), DataError> {
        let Some(block) = self.blocks.of_insert(insert) else {
            self.drawing.leave_out("block that the file does not have");
            return Ok(());
        };
        // Programs give other blocks names that begin so.
        if !block.name.starts_with('*') {
            pen.layers.insert(1, block.name.to_owned());
        }
        let (entities, places) = (block.entities, block.places(insert)?);
        let inserts = [inserts, &[pen]].concat();
        for copy in places {
            self.spend(ENTITY, insert)?;
            self.entities(entities, compose(place, copy), &inserts)?;
        }
        Ok(())
    }

    fn spend(&mut self, bytes: usize, record: &Record<'_>) -> Result<(), DataError> {
        let spent = self.allowance.spend(bytes, "the blocks that are inserted");
        spent.map_err(|error| error.at(record.line))
    }
}

fn too_deep(Record { kind, line, .. }: &Record<'_>) -> DataError {
    let message =
        format!("line {line}: {kind}: blocks are inserted in each other more than {DEEPEST} deep");
    DataError::new(message, "explode the blocks before the export").at(*line)
}

/// The length of a unit, metres; `None` where the file does not say it.
fn metres(records: &[Record<'_>]) -> Result<Option<f64>, DataError> {
    let header = records
        .iter()
        .find(|r| r.kind == "SECTION" && r.text(2) == Some("HEADER"));
    let Some(code) = header.and_then(|h| h.after("$INSUNITS")) else {
        return Ok(None);
    };
    Ok(Some(match code {
        "0" => return Ok(None),
        "1" => 0.0254,
        "2" => 0.3048,
        "4" => 1e-3,
        "5" => 1e-2,
        "6" => 1.0,
        "9" => 0.0254e-3,
        "13" => 1e-6,
        "14" => 0.1,
        _ => {
            let message = format!("its unit has the number {code} ($INSUNITS), which is not known");
            return Err(DataError::new(
                message,
                "say what a unit of the drawing is: mm, in ...",
            ));
        }
    }))
}
